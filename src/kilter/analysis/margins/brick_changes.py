"""What to change in a model of bricks: the weakest stud, the brick to add or to take away.

At the least share s of the strength of all studs with which it holds, a mechanism starts. A brick
whose weight drives it is worth taking away; one that spans studs which the mechanism moves apart
is worth adding. The mechanism only says which bricks to try: of each kind the best few are put in,
or taken out, and s is found anew.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.margins.bond_factor import BondFactor, find_bond_factor
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks import BrickModel, assembly_of_bricks
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import STATED, brick_mass
from kilter.assembly.bricks.brick_model import NO_COLOR, cells_of
from kilter.contact.detect import contacts
from kilter.mechanics.program import Program, build_program

__all__ = ["BrickChange", "BrickChanges", "what_to_change"]

TRIED = 8
"""Bricks of each kind that are tried."""
WEAKEST = 3
"""Bonds about which bricks are put in."""
Cell = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class BrickChange:
    """One brick put in or taken out, and the share of strength that is then needed.

    Attributes
    ----------
    what : {"add", "remove"}
    name : str
        Of the brick in the changed assembly, or in the given one where it is taken out.
    corner : tuple of int
        Its lowest cell: x, y [cells], z [plates].
    cells : tuple of int
        Along x and y.
    share : float
        Of the strength of studs that is needed then [-]; below 1 it stands.
    """

    what: str
    name: str
    corner: Cell
    cells: tuple[int, int]
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class BrickChanges:
    """The share that is needed as it is, the weakest studs, and the change that helps most.

    Attributes
    ----------
    share : float
        Of the strength of studs [-]; infinite where no strength is enough.
    weakest : tuple of str or None
        The two bricks whose studs give way first.
    best : BrickChange or None
        None where nothing that was tried helps.
    tried : tuple of BrickChange
        All that were tried, the best first.
    """

    share: float
    weakest: tuple[str, str] | None
    best: BrickChange | None
    tried: tuple[BrickChange, ...]


def what_to_change(assembly: Assembly) -> BrickChanges:
    """The one brick whose addition or removal helps most.

    Parameters
    ----------
    assembly : Assembly
        Of bricks, as `kilter.load` reads them.

    Raises
    ------
    InputError
        If a part is no brick.
    """
    model, rules, cell = bricks_of(assembly)
    touching = contacts(assembly)
    program = build_program(assembly, touching)
    found = find_bond_factor(program, touching)
    if not isinstance(found, BondFactor) or found.limit.mechanism is None:
        share = found.value if isinstance(found, BondFactor) else np.inf
        return BrickChanges(share, None, None, ())
    motion = found.limit.mechanism.motion
    weakest = assembly.bonds[found.opens[0][0]].parts if found.opens else None
    tried = []
    for what, row, other in [
        *_without(model, program, motion),
        *_with(model, cell, motion, _about(assembly, found)),
    ]:
        changed = assembly_of_bricks(other, rules=rules, cell=cell)
        changed = replace(changed, gravity=assembly.gravity, friction=assembly.friction)
        own = (assembly if what == "remove" else changed).names[row]
        brick = (model if what == "remove" else other).take([row])
        x, y, z = brick.corner[0].tolist()
        a, b, _ = brick.size[0].tolist()
        tried.append(BrickChange(what, own, (x, y, z), (a, b), _share(changed)))
    tried.sort(key=lambda change: change.share)
    best = tried[0] if tried and tried[0].share < found.value else None
    return BrickChanges(found.value, weakest, best, tuple(tried))


def _share(assembly: Assembly) -> float:
    touching = contacts(assembly)
    found = find_bond_factor(build_program(assembly, touching), touching)
    return found.value if isinstance(found, BondFactor) else np.inf


def _about(assembly: Assembly, found: BondFactor) -> list[int]:
    """The bricks of the bonds that give way first."""
    bonds = [assembly.bonds[k] for k, _ in found.opens[:WEAKEST]]
    return sorted({assembly.index_of(name) for bond in bonds for name in bond.parts})


Try = tuple[str, int, BrickModel]


def _without(model: BrickModel, program: Program, motion: Array) -> Iterator[Try]:
    """Without each of the bricks whose weight drives the motion most."""
    power = program.mass * (motion[:, :3] @ program.gravity)
    power[model.held] = 0.0
    for k in np.argsort(-power, kind="stable")[:TRIED].tolist():
        if power[k] > 0 and np.count_nonzero(~model.held) > 1:
            yield "remove", k, model.take(np.arange(len(model)) != k)


def _with(model: BrickModel, cell: float, motion: Array, near: list[int]) -> Iterator[Try]:
    """With each of the bricks that the motion would tear most, about some bricks."""
    scored = [
        (_torn(speeds), corner, size)
        for corner, size, speeds in _places(model, cell, motion, near)
        if len(speeds) > 1
    ]
    number = int(model.number.max()) + 1
    for _, corner, (a, b) in sorted(scored, key=lambda one: (-one[0], one[1:]))[:TRIED]:
        one = BrickModel(
            np.array([corner]),
            np.array([[a, b, BRICK_PLATES]]),
            np.array([brick_mass(a, b)]),
            np.array([NO_COLOR]),
            np.zeros(1, dtype=bool),
            np.array([number]),
            np.zeros(1, dtype=np.int64),
        )
        yield "add", len(model), BrickModel.join([model, one])


def _torn(speeds: list[float]) -> float:
    """How far studs of these vertical velocities are moved apart."""
    return float(np.std(speeds)) * len(speeds)


def _places(
    model: BrickModel, cell: float, motion: Array, near: list[int]
) -> Iterator[tuple[Cell, tuple[int, int], list[float]]]:
    """Free places over or under bricks, with the vertical velocities of the studs there."""
    cells = cells_of(model)
    at = list(zip(cells.brick.tolist(), cells.xy.tolist(), strict=True))
    middle = model.corner[:, :2] + model.size[:, :2] / 2
    rise = {}
    for k, (x, y) in at:
        across, along = cell * (np.array([x, y]) + 0.5 - middle[k])
        speed = motion[k, 2] + motion[k, 3] * along - motion[k, 4] * across
        for z in range(int(model.corner[k, 2]), int(model.top[k])):
            rise[x, y, z] = float(speed)
    sizes = [*STATED, *((b, a) for a, b in STATED if a != b)]
    levels = {
        (x, y, z)
        for k, (x, y) in at
        if k in near
        for z in (int(model.top[k]), int(model.corner[k, 2]) - BRICK_PLATES)
        if z >= 0
    }
    tried = {
        ((x - i, y - j, z), (a, b))
        for x, y, z in levels
        for a, b in sizes
        for i in range(a)
        for j in range(b)
    }
    for (x0, y0, z0), (a, b) in sorted(tried):
        under = [(x, y) for x in range(x0, x0 + a) for y in range(y0, y0 + b)]
        if any((x, y, z0 + h) in rise for x, y in under for h in range(BRICK_PLATES)):
            continue
        ends = ((x, y, z) for x, y in under for z in (z0 - 1, z0 + BRICK_PLATES))
        yield (x0, y0, z0), (a, b), [rise[end] for end in ends if end in rise]
