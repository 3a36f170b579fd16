"""Changes of a model of bricks: the weakest stud, the brick to add or to take away.

At the least share s of the strength of all studs with which it holds, a mechanism starts. To
remove a brick whose weight drives it may help, and so may a further brick that spans studs which
the mechanism moves apart. The mechanism only names candidates: the best of each kind are added or
removed, and s is computed again. If no strength is enough, the mechanism is the motion of the fall.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.margins.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.margins.load_limit import finite
from kilter.analysis.turning_tolerances import MOVES
from kilter.arrays import Array
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks import BrickModel, assembly_of_bricks
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import STATED, brick_mass
from kilter.assembly.bricks.brick_model import NO_COLOR, cells_of
from kilter.contact.detect import contacts
from kilter.mechanics.program import Program, build_program
from kilter.tell.improve_words import improve_sentence
from kilter.threads import on_one_thread

__all__ = ["BrickChange", "Improvement", "improve"]

TRIED = 8
"""Bricks of each kind that are tried."""
WEAKEST = 3
"""Bonds about which bricks are put in; twice as many bricks where no strength is enough."""
SAME_DIGITS = 9
"""Shares that agree to so many decimals count as one: of those a brick more comes first."""
Cell = tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class BrickChange:
    """A brick that is added or removed, and the share of strength that is needed afterwards.

    Attributes
    ----------
    what : {"add", "remove"}
    name : str
        Name of the brick in the changed assembly, or in the given assembly if it is removed.
    corner : tuple of int
        Its lowest cell: x, y [cells], z [plates].
    cells : tuple of int
        Along x and y.
    share : float
        Of the strength of studs that is needed then [-]; below 1 it stands.
    assembly : Assembly
        With this change.
    """

    what: str
    name: str
    corner: Cell
    cells: tuple[int, int]
    share: float
    assembly: Assembly

    def to_dict(self) -> dict[str, Any]:
        """The change as JSON data."""
        return {
            "what": self.what,
            "name": self.name,
            "corner": list(self.corner),
            "layer": self.corner[2] / BRICK_PLATES,
            "cells": list(self.cells),
            "share": finite(self.share),
        }


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Improvement:
    """The share that is needed as it is, the weakest studs, and the change that helps most.

    Attributes
    ----------
    assembly : Assembly
        The given assembly.
    verdict : str
        Of `kilter.check` as it is.
    share : float
        Share of the strength of the studs that is needed [-]; infinite if no strength is enough.
    weakest : tuple of str or None
        The two bricks whose studs give way first.
    best : BrickChange or None
        None if no tried change helps.
    tried : tuple of BrickChange
        All that were tried, the best first.
    warnings : tuple of str
    """

    assembly: Assembly
    verdict: str
    share: float
    weakest: tuple[str, str] | None
    best: BrickChange | None
    tried: tuple[BrickChange, ...]
    warnings: tuple[str, ...]

    @property
    def stands(self) -> bool:
        """Whether it stands as it is, or with the best change."""
        with_it = self.best is not None and self.best.share < 1
        return self.verdict != "unstable" or with_it

    @property
    def sentence(self) -> str:
        """The recommended change, in a sentence."""
        return improve_sentence(self.to_dict())

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data, that of ``kilter improve --json``."""
        return {
            "verdict": self.verdict,
            "stands": self.stands,
            "bricks": sum(not part.grounded for part in self.assembly.parts),
            "share": finite(self.share),
            "weakest": None if self.weakest is None else list(self.weakest),
            "best": None if self.best is None else self.best.to_dict(),
            "tried": [one.to_dict() for one in self.tried],
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        best = "nothing" if self.best is None else f"{self.best.what} {self.best.name}"
        return f"Improvement({self.verdict}, needs {self.share:.6g}, {best})"


@on_one_thread
def improve(assembly: Assembly, *, progress: Callable[[str], None] | None = None) -> Improvement:
    """Find the brick whose addition or removal helps most.

    Parameters
    ----------
    assembly : Assembly
        Of bricks, as `kilter.load` reads them.
    progress : callable, optional

    Raises
    ------
    InputError
        If a part is no brick, or no cell of the grid is its own.

    Examples
    --------
    >>> import kilter
    >>> from kilter.scenes.random_bricks import random_bricks
    >>> found = improve(assembly_of_bricks(random_bricks(5, seed=3)))
    >>> found.stands, found.best is None or found.best.share < found.share
    (True, True)
    """
    tell = progress or (lambda stage: None)
    require_assembly(assembly, "improve")
    model, rules, cell = bricks_of(assembly)
    tell("weakest studs")
    verdict = check(assembly)
    program = build_program(assembly, verdict.contacts)
    found = find_bond_factor(program, verdict.contacts)
    share, weakest, motion, near = np.inf, None, None, list[int]()
    if isinstance(found, BondFactor):
        share = found.value
        weakest = assembly.bonds[found.opens[0][0]].parts if found.opens else None
        motion = None if found.limit.mechanism is None else found.limit.mechanism.motion
        near = _about(assembly, found)
    elif verdict.judgement.motion is not None:
        motion = verdict.judgement.motion.motion
        near = _fastest(motion)
    tried: list[BrickChange] = []
    trials = [] if motion is None else _trials(model, program, cell, motion, near)
    for what, row, other in trials:
        tell(f"changes: {len(tried)} of {len(trials)}")
        changed = assembly_of_bricks(other, rules=rules, cell=cell)
        changed = replace(changed, gravity=assembly.gravity, friction=assembly.friction)
        own = (assembly if what == "remove" else changed).names[row]
        brick = (model if what == "remove" else other).take([row])
        x, y, z = brick.corner[0].tolist()
        a, b, _ = brick.size[0].tolist()
        tried.append(BrickChange(what, own, (x, y, z), (a, b), _share(changed), changed))
    tried.sort(key=lambda change: round(change.share, SAME_DIGITS))
    best = tried[0] if tried and tried[0].share < share else None
    return Improvement(
        assembly, verdict.verdict, share, weakest, best, tuple(tried), tuple(verdict.warnings)
    )


def _share(assembly: Assembly) -> float:
    touching = contacts(assembly)
    found = find_bond_factor(build_program(assembly, touching), touching)
    return found.value if isinstance(found, BondFactor) else np.inf


def _about(assembly: Assembly, found: BondFactor) -> list[int]:
    """The bricks of the bonds that give way first."""
    bonds = [assembly.bonds[k] for k, _ in found.opens[:WEAKEST]]
    return sorted({assembly.index_of(name) for bond in bonds for name in bond.parts})


def _fastest(motion: Array) -> list[int]:
    """The bricks that move most in a motion."""
    speed = np.linalg.norm(motion[:, :3], axis=1)
    order = np.argsort(-speed, kind="stable")[: 2 * WEAKEST]
    return sorted(k for k in order.tolist() if speed[k] > 0)


Try = tuple[str, int, BrickModel]


def _trials(
    model: BrickModel, program: Program, cell: float, motion: Array, near: list[int]
) -> list[Try]:
    """Candidates for a change, from the motion."""
    return [*_with(model, cell, motion, near), *_without(model, program, motion)]


def _without(model: BrickModel, program: Program, motion: Array) -> Iterator[Try]:
    """Without each of the bricks whose weight drives the motion most."""
    power = program.mass * (motion[:, :3] @ program.gravity)
    power[model.held] = 0.0
    for k in np.argsort(-power, kind="stable")[:TRIED].tolist():
        if power[k] > MOVES * power.max() and np.count_nonzero(~model.held) > 1:
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
