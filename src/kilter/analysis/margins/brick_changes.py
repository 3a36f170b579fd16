"""Changes that strengthen a brick model: bricks to add or to remove, each tried.

Let s be the least share of the strength of all studs with which the model holds. At s a mechanism
starts. Removing a brick helps if its weight drives the mechanism; adding a brick helps if it spans
studs that the mechanism moves apart.

The mechanism only selects candidates: the best few changes of each kind are made, and s is computed
again. If no strength is enough, the motion of the fall takes the place of the mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np

from kilter.analysis.analysis_tolerances import MOVES
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.decision.cascade import decide
from kilter.analysis.margins.tried_changes import LISTED, TriedChange
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.bricks import BrickModel, assembly_of_bricks
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import NO_COLOR, STATED, brick_mass, cells_of
from kilter.assembly.part import BRICK_PLATES
from kilter.contact.detect import contacts
from kilter.mechanics.program import Program, build_program
from kilter.tell.numbers import number, plain
from kilter.work import Work

TRIED = 8
"""Maximum number of bricks to try for addition, and as many for removal."""
WEAKEST = 3
"""Number of weakest bonds near which bricks are added. If no strength is enough, bricks are added
near twice this number of the fastest bricks."""
SAME_DIGITS = 9
"""Shares that agree to this number of decimals count as equal; additions then come first."""
NEAR = 1e-3
"""Shares within this distance of 1 are shown with more digits [-]."""
Cell = tuple[int, int, int]


def brick_changes(
    assembly: Assembly, verdict: Verdict, program: Program, factor: BondFactor | None, *, work: Work
) -> tuple[TriedChange, ...]:
    """Bricks whose addition or removal lowers the needed strength of studs most, the best first.

    Arguments: `factor`: least share of the strength; None if no strength is enough; `work`: work of
    each decision whether the changed model stands. Raises `InputError` if a part is not in the
    cells of the common grid, or if the model has loads or joints.
    """
    model, rules, cell = bricks_of(assembly)
    share, motion, near = np.inf, None, list[int]()
    if factor is not None:
        share = factor.value
        motion = None if factor.limit.motion is None else factor.limit.motion.motion
        near = _weakest_bricks(assembly, factor)
    elif verdict.judgement.motion is not None:
        motion = verdict.judgement.motion.motion
        near = _fastest_bricks(motion)
    found: list[TriedChange] = []
    for what, row, other in [] if motion is None else _trials(model, program, cell, motion, near):
        changed = assembly_of_bricks(other, rules=rules, cell=cell)
        changed = replace(changed, gravity=assembly.gravity, friction=assembly.friction)
        needed = _needed_share(changed)
        if not round(needed, SAME_DIGITS) < round(share, SAME_DIGITS):
            continue
        name = (assembly if what == "remove" else changed).names[row]
        words = _change_words(what, (model if what == "remove" else other).take([row]), name)
        found.append(
            TriedChange(
                of="strength",
                what=what,
                parts=(name,),
                by=None,
                along=None,
                size=None,
                limit=needed,
                gain=share - needed,
                verdict="",
                sentence=f"{words}: needed strength {_percent(share)} -> {_percent(needed)}",
                changed=changed,
            )
        )
    found.sort(key=lambda change: round(change.limit, SAME_DIGITS))
    first: dict[tuple[str, float], TriedChange] = {}
    for change in found:  # of bricks with the same effect one is enough
        first.setdefault((change.what, round(change.limit, SAME_DIGITS)), change)
    listed = list(first.values())[:LISTED]
    return tuple(replace(each, verdict=_verdict(each.changed, work)) for each in listed)


def _verdict(assembly: Assembly, work: Work) -> str:
    """The verdict on a changed model, at the level "equilibrium"."""
    return decide(
        assembly, contacts(assembly), require="equilibrium", work=work.beside(work.allowed),
        second_order=False, question=False,
    ).verdict  # fmt: skip


def _change_words(what: str, brick: BrickModel, name: str) -> str:
    """A brick to add or to remove in words: its place in cells and in layers of bricks."""
    (x, y, z), (a, b, _) = brick.corner[0].tolist(), brick.size[0].tolist()
    added = f"add a brick of {a} x {b}"
    words = added if what == "add" else f"remove {plain(name)}"
    return f"{words} in layer {number(z / BRICK_PLATES, 4)} at cell ({x}, {y})"


def _percent(share: float) -> str:
    """A share of the strength in percent, with enough digits to distinguish it from 100 %."""
    if np.isinf(share):
        return "(none is enough)"
    return f"{number(100 * share, 4 if abs(share - 1) > NEAR else 7)} %"


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
    # equal places are in the order of their corners, whatever the rounding of the motion
    most = max((score for score, _, _ in scored), default=1.0) or 1.0
    scored = [(round(score / most, SAME_DIGITS), corner, size) for score, corner, size in scored]
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
