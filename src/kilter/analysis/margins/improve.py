"""Changes that strengthen a brick model: the weakest studs, and bricks to add or to remove.

Let s be the least share of the strength of all studs with which the model holds. At s a mechanism
starts. Removing a brick helps if its weight drives the mechanism; adding a brick helps if it spans
studs that the mechanism moves apart.

The mechanism only selects candidates: the best few changes of each kind are made, and s is computed
again. If no strength is enough, the motion of the fall takes the place of the mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import MOVES
from kilter.analysis.check import check
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.bricks import BrickModel, assembly_of_bricks
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import NO_COLOR, STATED, brick_mass, cells_of
from kilter.assembly.part import BRICK_PLATES
from kilter.assembly.question import Question, question
from kilter.contact.detect import contacts
from kilter.mechanics.program import Program, build_program
from kilter.tell.plan_words import improve_sentence
from kilter.tell.record import Answer, InPython, OrNull, PairNames, Record, Word
from kilter.work import facts_of, stop_after

TRIED = 8
"""Maximum number of bricks to try for addition, and as many for removal."""
WEAKEST = 3
"""Number of weakest bonds near which bricks are added. If no strength is enough, bricks are added
near twice this number of the fastest bricks."""
SAME_DIGITS = 9
"""Shares that agree to this number of decimals count as equal; additions then come first."""
Cell = tuple[int, int, int]


class BrickChange(Record):
    """A brick to add or to remove, and the share of stud strength that is then needed."""

    what: Literal["add", "remove"]
    """Kind of the change."""
    name: str
    """Name of the brick: in the changed assembly if it is added, else in the given assembly."""
    corner: tuple[int, int, int]
    """Lowest cell of the brick: x, y [cells], z [plates]."""
    layer: float
    """Height of the corner in bricks [-]."""
    cells: tuple[int, int]
    """Size along x and y [cells]."""
    share: OrNull
    """Least share of the strength of studs that holds the changed assembly [-]. If it is below 1,
    the changed assembly stands."""
    assembly: InPython[Assembly]
    """The changed assembly."""


class Improvement(Answer):
    """Answer of `kilter.improve`: the weakest studs of a brick model, and the best change."""

    answer: ClassVar[str] = "improve"

    assembly: InPython[Assembly]
    """The given assembly."""
    verdict: Word
    """Verdict of `kilter.check` on the given assembly."""
    stands: bool
    """True if the brick model stands as given, or would stand with the best change."""
    bricks: int
    """Number of bricks that are not held."""
    share: OrNull
    """Least share of the strength of studs that the given assembly needs [-]. It is infinite if
    no strength is enough, or if no limit was found."""
    weakest: PairNames | None
    """The two bricks whose studs give way first."""
    best: BrickChange | None
    """The change with the least share; None if no change lowers the share."""
    tried: tuple[BrickChange, ...]
    """All changes that were tried, the best first."""
    warnings: tuple[str, ...]
    """Warnings of `kilter.check`."""

    @property
    def sentence(self) -> str:
        """Describe the weakest studs and the best change of the brick model in a sentence."""
        return improve_sentence(self.to_dict())

    def __repr__(self) -> str:
        best = "nothing" if self.best is None else f"{self.best.what} {self.best.name}"
        return f"Improvement({self.verdict}, needs {self.share:.6g}, {best})"


@question(lacks="contacts tolerance require")
def improve(
    asked: Question,
) -> Improvement:
    """Find the brick whose addition or removal lowers the required strength of studs most.

    Parameters
    ----------
    assembly : Assembly, or path
        Assembly of bricks, as `kilter.load` reads it.

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If a part is not a brick or not in the cells of the common grid, or if the assembly has
        loads, joints or no bonds.

    See Also
    --------
    kilter.margin : limits of any assembly.
    kilter.check : the verdict on the model.

    Examples
    --------
    >>> import kilter
    >>> from kilter.scenes.random_bricks import random_bricks
    >>> found = improve(assembly_of_bricks(random_bricks(5, seed=3)))
    >>> found.stands, found.best is None or found.best.share < found.share
    (True, True)
    """
    with stop_after(asked.seconds_left):
        return _improve(asked)


def _improve(asked: Question) -> Improvement:
    """The answer of `improve`, within the time of the caller."""
    assembly, report = asked.assembly, asked.tell
    model, rules, cell = bricks_of(assembly)
    report("weakest studs")
    verdict = check(asked)
    report_fact = facts_of(asked.progress)
    if report_fact is not None:
        report_fact("verdict", f"the given model is {verdict.verdict.replace('-', ' ')}")
    program = build_program(assembly, verdict.contact_set)
    factor = find_bond_factor(program, verdict.contact_set)
    share, weakest, motion, near = np.inf, None, None, list[int]()
    if isinstance(factor, BondFactor):
        share = factor.value
        weakest = factor.opens[0].parts if factor.opens else None
        motion = None if factor.limit.motion is None else factor.limit.motion.motion
        near = _weakest_bricks(assembly, factor)
    elif verdict.judgement.motion is not None:
        motion = verdict.judgement.motion.motion
        near = _fastest_bricks(motion)
    tried: list[BrickChange] = []
    trials = [] if motion is None else _trials(model, program, cell, motion, near)
    for what, row, other in trials:
        report(f"changes: {len(tried)} of {len(trials)}")
        changed = assembly_of_bricks(other, rules=rules, cell=cell)
        changed = replace(changed, gravity=assembly.gravity, friction=assembly.friction)
        name = (assembly if what == "remove" else changed).names[row]
        brick = (model if what == "remove" else other).take([row])
        x, y, z = brick.corner[0].tolist()
        a, b, _ = brick.size[0].tolist()
        tried.append(
            BrickChange(
                what=what,
                name=name,
                corner=(x, y, z),
                layer=z / BRICK_PLATES,
                cells=(a, b),
                share=_needed_share(changed),
                assembly=changed,
            )
        )
    tried.sort(key=lambda change: round(change.share, SAME_DIGITS))
    best = tried[0] if tried and tried[0].share < share else None
    return Improvement(
        assembly=assembly,
        verdict=verdict.verdict,
        stands=verdict.verdict != "unstable" or (best is not None and best.share < 1),
        bricks=sum(not part.grounded for part in assembly.parts),
        share=share,
        weakest=weakest,
        best=best,
        tried=tuple(tried),
        warnings=verdict.notes,
    )


def _needed_share(assembly: Assembly) -> float:
    """Least fraction of stud strength that holds a brick model [-]; infinite if none suffices."""
    touching = contacts(assembly)
    factor = find_bond_factor(build_program(assembly, touching), touching)
    return factor.value if isinstance(factor, BondFactor) else np.inf


def _weakest_bricks(assembly: Assembly, factor: BondFactor) -> list[int]:
    """Indices of the bricks at the bonds that break first."""
    opens = factor.opens[:WEAKEST]
    return sorted({assembly.index_of(name) for bond in opens for name in bond.parts})


def _fastest_bricks(motion: Array) -> list[int]:
    """Indices of the `2 * WEAKEST` fastest bricks in a motion, without bricks at rest."""
    speed = np.linalg.norm(motion[:, :3], axis=1)
    order = np.argsort(-speed, kind="stable")[: 2 * WEAKEST]
    return sorted(k for k in order.tolist() if speed[k] > 0)


Try = tuple[Literal["add", "remove"], int, BrickModel]


def _trials(
    model: BrickModel, program: Program, cell: float, motion: Array, near: list[int]
) -> list[Try]:
    """Candidate changes of a model (kind, row of the brick, changed model), additions first."""
    return [*_additions(model, cell, motion, near), *_removals(model, program, motion)]


def _removals(model: BrickModel, program: Program, motion: Array) -> Iterator[Try]:
    """Yield models without one of the bricks whose weight drives the motion most."""
    power = program.mass * (motion[:, :3] @ program.gravity)
    power[model.held] = 0.0
    for k in np.argsort(-power, kind="stable")[:TRIED].tolist():
        if power[k] > MOVES * power.max() and np.count_nonzero(~model.held) > 1:
            yield "remove", k, model.take(np.arange(len(model)) != k)


def _additions(model: BrickModel, cell: float, motion: Array, near: list[int]) -> Iterator[Try]:
    """Yield models with a new brick near given bricks, where a motion tears studs apart most."""
    scored = [
        (_tearing(speeds), corner, size)
        for corner, size, speeds in _places(model, cell, motion, near)
        if len(speeds) > 1
    ]
    number = int(model.number.max()) + 1
    for _, corner, (a, b) in sorted(scored, key=lambda place: (-place[0], place[1:]))[:TRIED]:
        brick = BrickModel(
            np.array([corner]),
            np.array([[a, b, BRICK_PLATES]]),
            np.array([brick_mass(a, b)]),
            np.array([NO_COLOR]),
            np.zeros(1, dtype=bool),
            np.array([number]),
            np.zeros(1, dtype=np.int64),
            np.array([[0, 0, a, b]]),
        )
        yield "add", len(model), BrickModel.join([model, brick])


def _tearing(speeds: list[float]) -> float:
    """Measure how strongly a motion tears n studs apart: n times the spread of their speeds."""
    return float(np.std(speeds)) * len(speeds)


def _places(
    model: BrickModel, cell: float, motion: Array, near: list[int]
) -> Iterator[tuple[Cell, tuple[int, int], list[float]]]:
    """Free places directly above or below given bricks: corner, size, vertical velocities of studs.

    The velocities are vertical, at the cells directly below and above the place.
    """
    rise = _rise_of_cells(model, cell, motion)
    for (x0, y0, z0), (a, b) in sorted(_candidate_places(model, near)):
        under = [(x, y) for x in range(x0, x0 + a) for y in range(y0, y0 + b)]
        occupied = any((x, y, z0 + h) in rise for x, y in under for h in range(BRICK_PLATES))
        if not occupied:
            ends = ((x, y, z) for x, y in under for z in (z0 - 1, z0 + BRICK_PLATES))
            yield (x0, y0, z0), (a, b), [rise[end] for end in ends if end in rise]


def _rise_of_cells(model: BrickModel, cell: float, motion: Array) -> dict[Cell, float]:
    """Vertical velocity of the middle of every cell that a brick occupies, by cell."""
    cells = cells_of(model)
    middle = model.corner[:, :2] + model.size[:, :2] / 2
    rise = {}
    for k, (x, y) in zip(cells.brick.tolist(), cells.xy.tolist(), strict=True):
        across, along = cell * (np.array([x, y]) + 0.5 - middle[k])
        speed = motion[k, 2] + motion[k, 3] * along - motion[k, 4] * across
        for z in range(int(model.corner[k, 2]), int(model.top[k])):
            rise[x, y, z] = float(speed)
    return rise


def _candidate_places(model: BrickModel, near: list[int]) -> set[tuple[Cell, tuple[int, int]]]:
    """Corner and size of every possible new brick directly above or below a brick of `near`."""
    cells = cells_of(model)
    sizes = [*STATED, *((b, a) for a, b in STATED if a != b)]
    levels = {
        (x, y, z)
        for k, (x, y) in zip(cells.brick.tolist(), cells.xy.tolist(), strict=True)
        if k in near
        for z in (int(model.top[k]), int(model.corner[k, 2]) - BRICK_PLATES)
        if z >= 0
    }
    return {
        ((x - i, y - j, z), (a, b))
        for x, y, z in levels
        for a, b in sizes
        for i in range(a)
        for j in range(b)
    }
