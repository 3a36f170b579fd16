"""The proof that no motion can start as JSON data, written and read.

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

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.friction.exclusion_check import power_not_excluded
from kilter.friction.exclusion_steps import (
    CaseStep,
    ExclusionStep,
    PowerStep,
    Quantity,
    ShrinkStep,
)
from kilter.friction.moment_bound import SQUARES, MomentStep
from kilter.mechanics.program import Program
from kilter.solvers.semidefinite import Multipliers

if TYPE_CHECKING:  # who reads a proof needs no solver
    from kilter.friction.exclusion import Exclusion

__all__ = ["exclusion_data", "recheck_exclusion"]


def exclusion_data(exclusion: Exclusion) -> dict[str, Any]:
    """The proof as JSON data."""
    opening = exclusion.opening
    return {
        "kind": exclusion.kind,
        "programs": exclusion.programs,
        "assumes": exclusion.assumes,
        "opening": None if opening is None else opening.tolist(),
        "steps": [_step(step) for step in exclusion.steps],
    }


def recheck_exclusion(program: Program, data: dict[str, Any]) -> tuple[list[str], list[str]]:
    """Objections to a proof as data, and notes on it, after its repetition on a program.

    Parameters
    ----------
    program : Program
        Of the assembly, with contacts found anew.
    data : dict
        In the form of `exclusion_data`; malformed data are an objection.
    """
    try:
        opening = None if data["opening"] is None else _floats(data["opening"])
        steps = [_read(step) for step in data["steps"]]
        left, none = power_not_excluded(program, opening, steps)
    except (KeyError, TypeError, ValueError, IndexError, OverflowError, np.linalg.LinAlgError):
        return ["the steps that exclude every motion cannot be repeated"], []
    if not left <= none:
        return [f"its steps leave motions of {left:.3g} of the power of free fall"], []
    note = f"no motion obeys Coulomb's law: {len(steps)} steps by {data['kind']} repeated"
    return [], [note + (f", assuming {data['assumes']}" if data["assumes"] else "")]


def _step(step: ExclusionStep) -> dict[str, Any]:
    if isinstance(step, MomentStep):
        given = step.multipliers
        return {"moments": {
            "scale": step.scale,
            "squares": step.squares,
            "equal": given.equal.tolist(),
            "positive": given.positive.tolist(),
            "cones": given.cones.tolist(),
            "matrices": [one.T[np.tril_indices(len(one))].tolist() for one in given.squares],
        }}  # fmt: skip
    if isinstance(step, PowerStep):
        return {"power": _power(step)}
    if isinstance(step, ShrinkStep):
        return {"shrink": [
            {"number": one.number, **_power(one.multipliers)} for one in step.quantities
        ]}  # fmt: skip
    return {"cases": list(_tree(step))}


def _power(step: PowerStep) -> dict[str, Any]:
    tangent = None if step.tangent is None else step.tangent.tolist()
    return {"rows": step.rows.tolist(), "values": step.values.tolist(), "tangent": tangent}


def _tree(root: CaseStep) -> Iterator[dict[str, Any]]:
    """Every case before the cases into which it is divided."""
    ready = [root]
    while ready:
        case = ready.pop()
        ready += case.cases[::-1]
        yield {
            "powers": [_power(one) for one in case.powers],
            "point": case.point,
            "patch": case.patch,
            "cases": len(case.cases),
        }


def _read(data: dict[str, Any]) -> ExclusionStep:
    ((kind, own),) = data.items()
    if kind == "moments":
        if own["squares"] not in SQUARES:
            raise ValueError("unknown matrices")
        multipliers = Multipliers(
            _floats(own["equal"]),
            _floats(own["positive"]),
            _floats(own["cones"]),
            tuple(_matrix(_floats(one)) for one in own["matrices"]),
        )
        return MomentStep(float(own["scale"]), own["squares"], multipliers)
    if kind == "power":
        return _read_power(own)
    if kind == "shrink":
        return ShrinkStep(tuple(Quantity(_place(one["number"]), _read_power(one)) for one in own))
    if kind == "cases":
        return _read_tree(own)
    raise ValueError("unknown step")


def _read_power(data: dict[str, Any]) -> PowerStep:
    rows = np.array([_place(row) for row in data["rows"]], dtype=np.int64)
    values = _floats(data["values"])
    if rows.shape != values.shape:
        raise ValueError("not one value a row")
    return PowerStep(rows, values, None if data["tangent"] is None else _floats(data["tangent"]))


def _read_tree(data: list[dict[str, Any]]) -> CaseStep:
    """The first case of a list, with the cases below it."""
    root = CaseStep()
    ready = [root]
    for own in data:
        case = ready.pop()
        case.powers = [_read_power(one) for one in own["powers"]]
        case.point, case.patch = int(own["point"]), int(own["patch"])
        case.cases = [CaseStep() for _ in range(_place(own["cases"]))]
        ready += case.cases[::-1]
    if ready:
        raise ValueError("cases are missing")
    return root


def _place(value: int) -> int:
    """An index, which is a nonnegative whole number."""
    if value < 0 or int(value) != value:
        raise ValueError("no place")
    return int(value)


def _floats(values: list[float]) -> Array:
    """An array of finite numbers, shape (n,)."""
    array = np.array(values, dtype=np.float64)
    if array.ndim != 1 or not np.isfinite(array).all():
        raise ValueError("no row of numbers")
    return array


def _matrix(triangle: Array) -> Array:
    """Symmetric matrix from its upper triangle."""
    order = round((float(np.sqrt(8.0 * len(triangle) + 1.0)) - 1.0) / 2.0)
    column, row = np.tril_indices(order)
    matrix = np.zeros((order, order))
    matrix[row, column] = triangle
    matrix[column, row] = triangle
    return matrix
