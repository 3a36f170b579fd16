"""Random bonded blocks in any orientation, with their contact areas computed from the sizes."""

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Bond, FrictionPair, Load, Part
from kilter.assembly.bonds import KINDS
from kilter.rigid import Pose
from kilter.shape.primitives import Box

THIN = 0.05
"""Least side of the contact rectangle of two blocks [length unit]."""
PLANE = 1e-9
"""Largest distance of two coplanar sides [length unit]."""
GIVEN_KINDS = (*KINDS, None, None)
"""Kinds of bond, from which a random kind is drawn."""


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """Contact rectangle of two blocks, before the assembly is rotated.

    Attributes
    ----------
    parts : pair of int
    axis : int
        Axis of the normal, which points from the first block to the second.
    corners : ndarray, shape (4, 3)
        Corners of the rectangle [length unit].
    """

    parts: tuple[int, int]
    axis: int
    corners: Array

    @property
    def area(self) -> float:
        """Area of the rectangle [length unit^2]."""
        across = np.ptp(self.corners, axis=0)
        return float(np.prod(np.delete(across, self.axis)))


@dataclass(frozen=True, slots=True, eq=False)
class Bonded:
    """A bonded assembly, its contact rectangles before the rotation, and the rotation."""

    family: str
    assembly: Assembly
    touches: tuple[Touch, ...]
    turn: Pose


def random_bonded(seed: int) -> Bonded:
    """Random bonded blocks near a limit: "courses" of a wall, or "grown" from block to block.

    Courses may be planar. Most pairs have a bond with a strength per point, per area, or at given
    points. Friction and loads are random, too.

    Parameters
    ----------
    seed : int
        The same seed gives the same assembly.

    Examples
    --------
    >>> made = random_bonded(3)
    >>> made.family, made.assembly, len(made.assembly.bonds)
    ('grown', <Assembly: 4 parts, 1 held, in m>, 2)
    """
    random = np.random.default_rng(seed)
    family, make = (("courses", _courses), ("grown", _grown))[int(random.integers(2))]
    blocks = make(random)
    while _has_slivers(blocks):
        blocks = make(random)
    planar = bool(family == "courses" and random.random() < 0.3)
    kept = np.array([1, 0, 1] if planar else [1, 1, 1])
    turn = Pose(rotation=random.normal(size=4) * ([1, 0, 1, 0] if planar else [1, 1, 1, 1]))
    down = random.normal(size=3)
    if random.random() < 0.6:
        down = turn.apply([0.0, 0, -1]) + 0.2 * down
    down = down * kept
    parts = [
        Part(
            f"p{k}",
            Box(high - low),
            Pose(turn.apply((low + high) / 2), turn.rotation),
            grounded=k == 0,
            density=float(random.uniform(300, 3000)),
        )
        for k, (low, high) in enumerate(blocks)
    ]
    made = Assembly(parts, gravity=9.81 * down / np.linalg.norm(down), planar=planar)
    touches = tuple(_touching(blocks))
    return Bonded(family, _finished(random, made, touches, turn, kept), touches, turn)


def _courses(random: np.random.Generator) -> Array:
    """Lower and upper corners, shape (N, 2, 3), of a wall of 2 to 4 courses on the first block."""
    blocks = [[[-0.5, -1, -1], [3.5, 1, 0]]]
    height = 0.0
    for _ in range(random.integers(2, 5)):
        x, rise = random.uniform(-0.3, 0.3), random.uniform(0.4, 0.9)
        aside = random.uniform(-0.1, 0.1)
        for _ in range(random.integers(2, 4)):
            wide = random.uniform(0.6, 1.3)
            blocks.append([[x, aside - 0.4, height], [x + wide, aside + 0.4, height + rise]])
            x += wide + random.choice([0.0, 0.2])
        height += rise
    return np.array(blocks)


def _grown(random: np.random.Generator) -> Array:
    """Lower and upper corners, shape (N, 2, 3), of blocks that each touch an earlier block."""
    size = random.uniform(0.5, 1.5, 3)
    blocks = np.array([[-size / 2, size / 2]])
    count = random.integers(4, 10)
    while len(blocks) < count:
        on = random.integers(len(blocks))
        low, high = blocks[on]
        size, axis = random.uniform(0.5, 1.5, 3), random.integers(3)
        start = low - size + random.uniform(0.2, 0.8, 3) * (size + high - low)
        start[axis] = high[axis] if random.random() < 0.5 else low[axis] - size[axis]
        others = np.delete(blocks, on, axis=0)
        apart = np.maximum(start - others[:, 1], others[:, 0] - start - size).max(axis=1)
        if (apart > 0.1).all():
            blocks = np.concatenate([blocks, [[start, start + size]]])
    return blocks


def _touching(blocks: Array) -> list[Touch]:
    """Contact rectangles of all pairs of blocks with sides above `THIN`."""
    touches = []
    for first, (low, high) in enumerate(blocks):
        for second, (start, end) in enumerate(blocks):
            bottom, top = np.maximum(low, start), np.minimum(high, end)
            for axis in range(3):
                u, v = (k for k in range(3) if k != axis)
                lap = min(top[u] - bottom[u], top[v] - bottom[v])
                if first == second or abs(high[axis] - start[axis]) > PLANE or lap <= THIN:
                    continue
                corners = np.tile(bottom, (4, 1))
                corners[:, axis] = high[axis]
                corners[[1, 2], u], corners[[2, 3], v] = top[u], top[v]
                touches.append(Touch((first, second), axis, corners))
    return touches


def _has_slivers(blocks: Array) -> bool:
    """Whether two blocks touch, or nearly touch, in a rectangle narrower than `THIN`."""
    low, high = blocks[:, 0], blocks[:, 1]
    lap = np.minimum(high[:, None], high) - np.maximum(low[:, None], low)
    lap = np.sort(lap[np.triu_indices(len(blocks), 1)], axis=1)
    return bool(((np.abs(lap[:, 0]) < PLANE) & (np.abs(lap[:, 1]) <= THIN)).any())


def _finished(
    random: np.random.Generator,
    made: Assembly,
    touches: tuple[Touch, ...],
    turn: Pose,
    kept: Array,
) -> Assembly:
    """Add random friction, loads and bonds to an assembly of blocks."""
    weight = 9.81 * float(made.geometry.mass[1:].sum())
    smooth, whole = random.random() < 0.15, random.random() < 0.6
    bonds, rubbing = [], []
    for touch in touches:
        one, other = (made.names[k] for k in touch.parts)
        if random.random() < 0.8 or whole:
            bonds.append(_bond(random, (one, other), touch, turn, weight))
        if random.random() < 0.3:
            mu = 0.0 if smooth else float(random.uniform(0, 1))
            rubbing.append(FrictionPair((one, other), mu))
    loads = [
        Load(made.names[random.integers(1, len(made.parts))], 0.2 * weight * kept * force)
        for force in random.normal(size=(random.choice([0, 0, 1, 2]), 3))
    ]
    return dataclasses.replace(
        made,
        friction=0.0 if smooth else float(random.uniform(0.1, 0.9)),
        friction_pairs=rubbing,
        loads=loads,
        bonds=bonds,
    )


def _bond(
    random: np.random.Generator, pair: tuple[str, str], touch: Touch, turn: Pose, weight: float
) -> Bond:
    """A random bond between two blocks, with a strength near the weight of the assembly [N]."""
    given = pair if random.random() < 0.5 else pair[::-1]
    strength = weight * 10 ** random.uniform(-1, 1)
    more: dict[str, Any] = {"kind": GIVEN_KINDS[random.integers(len(GIVEN_KINDS))]}
    more["shear"] = "mu" if random.random() < 0.25 else None
    way = random.random()
    if way < 0.4:
        return Bond(given, pull=strength / 4, **more)
    if way < 0.8:
        return Bond(given, pull_per_area=strength / touch.area, **more)
    low, high = touch.corners[0], touch.corners[2]
    points = turn.apply(random.uniform(low, high, size=(random.integers(1, 5), 3)))
    normal = turn.matrix[:, touch.axis] * (1 if given == pair else -1)
    return Bond(given, pull=strength / len(points), points=points, normal=normal, **more)
