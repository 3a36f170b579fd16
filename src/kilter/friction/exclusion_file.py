"""Write a proof that no motion can start as JSON data, and read it.

    {"kind", "programs", "assumes",
     "opening": [..],                          the motion that bounds all forces, or null
     "steps": [{"moments": {"scale", "squares", "equal", "positive", "cones", "matrices"}},
               {"power": {"rows", "values", "tangent"}},
               {"shrink": [{"number", "rows", "values"}, ..]},
               {"cases": [{"powers", "point", "patch", "cases"}, ..]}]}

Numbers are unscaled. A matrix is stored as its upper triangle, column by column. A tree of cases is
a list, each case before the cases into which it is divided, with their number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.friction.canonical import canonical
from kilter.friction.enclosure import Enclosure, cases, rescaled, width
from kilter.friction.exclusion_bounds import (
    CaseStep,
    ExclusionStep,
    PowerStep,
    Quantity,
    ShrinkStep,
    first_bounds,
    largest_forces,
    no_power,
    power_by,
    shrunk_by,
)
from kilter.friction.friction_tolerances import NARROWEST_CONE
from kilter.friction.moment_bound import SQUARES, MomentStep, power_left
from kilter.friction.reduced_law import ReducedLaw, reduced_law, refusal
from kilter.friction.relaxation import Relaxation
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import (
    COUNT,
    NUMBER,
    WORD,
    MalformedProof,
    every,
    keys,
    list_of,
    nullable,
    one_of,
)
from kilter.solvers.semidefinite import Multipliers
from kilter.threads import on_one_thread

if TYPE_CHECKING:
    from kilter.friction.exclusion import Exclusion


# Repeat the steps of a proof that no motion can start, without a solver.


@on_one_thread
def power_not_excluded(
    program: Program, opening: Array | None, steps: Sequence[ExclusionStep]
) -> tuple[float, float]:
    """Power of the load that a proof does not exclude, and the power that counts as zero [-].

    Raises `MalformedProof` if a step refers to points, rows or quantities that the law does not
    have.
    """
    if not program.free.any() or not program.load[program.free].any():
        return 0.0, 0.0
    program = canonical(program)
    if refusal(program):
        return 1.0, 0.0
    law = reduced_law(program)
    again = _ProofState(law, opening, no_power(program))
    for step in steps:
        again.step(step)
    return again.power, again.tolerance


class _ProofState:
    """State of the repetition of a proof: current bounds of the motions, and the largest power."""

    def __init__(self, law: ReducedLaw, opening: Array | None, tolerance: float) -> None:
        self.law, self.tolerance = law, tolerance
        self.forces = largest_forces(law, opening)
        self.relaxation = Relaxation(law)
        self.bounds = first_bounds(law, self.relaxation, opening)
        self.power = 1.0
        self.patches = range(len(law.twist))

    def step(self, step: ExclusionStep) -> None:
        """Apply one more step of the proof to the bounds and the power."""
        if isinstance(step, MomentStep):
            if step.scale < self.bounds.scale * (1 - 1e-12):
                raise MalformedProof("a step at a size to which motions are not bounded")
            self._leaves(power_left(self.law, step, self.forces))
        elif isinstance(step, PowerStep):
            self.bounds, power = power_by(self.relaxation, self.bounds, step)
            self._leaves(self.bounds.scale * power)
        elif isinstance(step, ShrinkStep):
            self.bounds = shrunk_by(self.law, self.relaxation, self.bounds, step)
        elif self._is_closed(self.bounds, step):
            self.power = min(self.power, self.tolerance)

    def _leaves(self, power: float) -> None:
        self.power = min(self.power, power)
        self.bounds = rescaled(self.relaxation.fastest, self.bounds, power / self.bounds.scale)

    def _is_closed(self, bounds: Enclosure, root: CaseStep) -> bool:
        """True if a proof excludes power in a case, or in all of its subcases."""
        ready = [(bounds, root)]
        while ready:
            closed, case = ready.pop()
            left = self._left(closed, case)
            if left is None:
                continue
            if not self._divisible(left, case):
                return False
            below = cases(self.law, left, case.point, case.patch)
            if len(below) != len(case.cases):
                raise MalformedProof(
                    f"a case is divided into {len(case.cases)} cases, not {len(below)}"
                )
            ready += zip(below, case.cases, strict=True)
        return True

    def _divisible(self, bounds: Enclosure, case: CaseStep) -> bool:
        """True if a case can be divided: its point or patch exists, and its cone is wide enough."""
        if case.point >= 0:
            return case.point < len(self.law.group)
        if case.patch not in self.patches:
            return False
        cone = bounds.cones[case.patch]
        return cone is None or width(cone) >= NARROWEST_CONE

    def _left(self, bounds: Enclosure, case: CaseStep) -> Enclosure | None:
        """Bounds of a case after its linear programs; None if these exclude all power."""
        for step in case.powers:
            bounds, power = power_by(self.relaxation, bounds, step)
            if bounds.scale * power <= self.tolerance:
                return None
            bounds = rescaled(self.relaxation.fastest, bounds, power)
        return bounds


LARGEST_INDEX = 2**31
"""Number of rows that no program of a proof reaches; larger indices would not fit in an array."""


def exclusion_data(exclusion: Exclusion) -> dict[str, Any]:
    """JSON data of a proof that no motion can start."""
    opening = exclusion.opening
    return {
        "kind": exclusion.kind,
        "programs": exclusion.programs,
        "assumes": exclusion.assumes,
        "opening": None if opening is None else opening.tolist(),
        "steps": [_step(step) for step in exclusion.steps],
    }


def recheck_exclusion(program: Program, data: dict[str, Any]) -> tuple[list[str], list[str]]:
    """Repeat a proof that no motion can start, from its data; returns objections and notes."""
    fault = EXCLUSION(data, "exclusion")
    if fault:
        return [f"the steps that exclude every motion cannot be repeated ({fault})"], []
    opening = None if data["opening"] is None else _floats(data["opening"])
    try:
        steps = [_read(step) for step in data["steps"]]
        left, none = power_not_excluded(program, opening, steps)
    except MalformedProof as error:
        return [f"the steps that exclude every motion cannot be repeated ({error})"], []
    if not left <= none:
        return [f"its steps do not exclude motions with {left:.3g} of the power of free fall"], []
    note = f"no motion obeys Coulomb's law: {len(steps)} steps by {data['kind']} repeated"
    return [], [note + (f", assuming {data['assumes']}" if data["assumes"] else "")]


def _step(step: ExclusionStep) -> dict[str, Any]:
    """JSON data of a step of the proof."""
    if isinstance(step, MomentStep):
        given = step.multipliers
        return {"moments": {
            "scale": step.scale,
            "squares": step.squares,
            "equal": given.equal.tolist(),
            "positive": given.positive.tolist(),
            "cones": given.cones.tolist(),
            "matrices": [entry.T[np.tril_indices(len(entry))].tolist() for entry in given.squares],
        }}  # fmt: skip
    if isinstance(step, PowerStep):
        return {"power": _power(step)}
    if isinstance(step, ShrinkStep):
        return {"shrink": [
            {"number": entry.number, **_power(entry.multipliers)} for entry in step.quantities
        ]}  # fmt: skip
    return {"cases": list(_tree(step))}


def _power(step: PowerStep) -> dict[str, Any]:
    tangent = None if step.tangent is None else step.tangent.tolist()
    return {"rows": step.rows.tolist(), "values": step.values.tolist(), "tangent": tangent}


def _tree(root: CaseStep) -> Iterator[dict[str, Any]]:
    """JSON data of a tree of cases, each before the cases into which it is divided."""
    ready = [root]
    while ready:
        case = ready.pop()
        ready += case.cases[::-1]
        yield {
            "powers": [_power(power) for power in case.powers],
            "point": case.point,
            "patch": case.patch,
            "cases": len(case.cases),
        }


def _index(value: Any, place: str) -> str:
    """Check that a value is an index (a small int >= 0); return the fault, or an empty text."""
    return COUNT(value, place) or ("" if value >= 0 else f"{place} is {value!r:.40}")


NUMBERS = list_of(NUMBER)
POWER = keys(rows=list_of(_index), values=NUMBERS, tangent=nullable(NUMBERS))
"""Form of the multipliers of a linear program."""
STEPS = {
    "moments": keys(
        scale=NUMBER,
        squares=one_of(*SQUARES),
        equal=NUMBERS,
        positive=NUMBERS,
        cones=NUMBERS,
        matrices=list_of(NUMBERS),
    ),
    "power": POWER,
    "shrink": list_of(every(keys(number=_index), POWER)),
    "cases": list_of(keys(powers=list_of(POWER), point=COUNT, patch=COUNT, cases=_index)),
}
"""Form of each kind of step."""
EXCLUSION = keys(opening=nullable(NUMBERS), steps=list_of(keys()), kind=WORD, assumes=WORD)


def _read(data: dict[str, Any]) -> ExclusionStep:
    """Read a step of the proof from its JSON data.

    Raises `MalformedProof` if the data do not have the form of a step.
    """
    if len(data) != 1 or not STEPS.keys() >= data.keys():
        raise MalformedProof(f"a step has the keys {sorted(data)!r:.40}")
    ((kind, content),) = data.items()
    fault = STEPS[kind](content, kind)
    if fault:
        raise MalformedProof(fault)
    if kind == "moments":
        multipliers = Multipliers(
            _floats(content["equal"]),
            _floats(content["positive"]),
            _floats(content["cones"]),
            tuple(_matrix(_floats(triangle)) for triangle in content["matrices"]),
        )
        return MomentStep(float(content["scale"]), content["squares"], multipliers)
    if kind == "power":
        return _read_power(content)
    if kind == "shrink":
        return ShrinkStep(tuple(Quantity(entry["number"], _read_power(entry)) for entry in content))
    return _read_tree(content)


def _read_power(data: dict[str, Any]) -> PowerStep:
    """Read the multipliers of a linear program from JSON data of a valid form."""
    rows, values = data["rows"], _floats(data["values"])
    if len(rows) != len(values):
        raise MalformedProof("rows and values differ in number")
    if any(row >= LARGEST_INDEX for row in rows):
        raise MalformedProof("a row does not exist")
    tangent = None if data["tangent"] is None else _floats(data["tangent"])
    return PowerStep(np.array(rows, dtype=np.int64), values, tangent)


def _read_tree(data: list[dict[str, Any]]) -> CaseStep:
    """Read a tree of cases from a list in which each case precedes its subcases."""
    root = CaseStep()
    ready = [root]
    count = 1
    for entry in data:
        if not ready:
            raise MalformedProof("a list has more cases than its tree")
        count += entry["cases"]
        if count > len(data):
            raise MalformedProof("cases are missing")
        case = ready.pop()
        case.powers = [_read_power(power) for power in entry["powers"]]
        case.point, case.patch = entry["point"], entry["patch"]
        case.cases = [CaseStep() for _ in range(entry["cases"])]
        ready += case.cases[::-1]
    if ready:
        raise MalformedProof("cases are missing")
    return root


def _floats(values: list[float]) -> Array:
    """Array of the numbers of a JSON list, shape (n,)."""
    return np.array(values, dtype=np.float64)


def _matrix(triangle: Array) -> Array:
    """Symmetric matrix from its upper triangle, column by column."""
    order = round((float(np.sqrt(8.0 * len(triangle) + 1.0)) - 1.0) / 2.0)
    if order * (order + 1) // 2 != len(triangle):
        raise MalformedProof("a matrix has no triangle of numbers")
    column, row = np.tril_indices(order)
    matrix = np.zeros((order, order))
    matrix[row, column] = triangle
    matrix[column, row] = triangle
    return matrix
