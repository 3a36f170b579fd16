"""Random models of toy bricks; each brick is connected to an earlier brick or to the base."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.assembly.bricks import BrickModel
from kilter.assembly.bricks.brick_library import STATED, brick_mass, studded_all_over
from kilter.assembly.part import BRICK_PLATES
from kilter.scenes.pieces import block, floor
from kilter.scenes.registry import listed

# Random piles of boxes on a grid; each box is lowered onto the highest box below it.


@listed("box-pile", "thirty boxes put down at random", source="pile", answer="stable")
def box_pile(
    count: int = 30, *, seed: int = 0, cells: int = 6, level: bool = True, friction: float = 0.0
) -> Assembly:
    """A pile of boxes with sides of 1 to 3 cells, lowered at random places.

    Touching faces lie on common grid planes, so that they touch exactly and no parts overlap.

    Arguments: `cells` [cells of 1 m]; `friction` [-].

    Examples
    --------
    >>> len(box_pile(10, seed=3).parts)
    11
    """
    random = np.random.default_rng(seed)
    heights = np.zeros((cells, cells))
    parts: list[Part] = []
    while len(parts) < count:
        low = random.integers(0, cells, size=2)
        high = np.minimum(low + random.integers(1, 4, size=2), cells)
        below = heights[low[0] : high[0], low[1] : high[1]]
        if level and np.ptp(below) > 0:
            continue
        bottom = float(below.max())
        top = bottom + 0.5 * int(random.integers(1, 5))
        parts.append(block(f"box-{len(parts)}", [*low, bottom], [*high, top]))
        below[:] = top
    return Assembly([floor([-1, -1], [cells + 1, cells + 1]), *parts], friction=friction)


ON_BASE = 0.1
"""Probability that a brick is placed on the baseplate."""
ABOVE = 0.8
"""Probability that a brick is placed on an earlier brick and not under it."""
COLORS = (1, 2, 4, 14, 15, 25)
"""LDraw codes of blue, green, red, yellow, white and orange."""
SIZES = [*STATED, *((b, a) for a, b in STATED if a != b)]
"""Sizes of bricks with stated weights, in both orientations [cell]."""


def random_bricks(count: int, *, seed: int, spread: int | None = None) -> BrickModel:
    """Build a random model of toy bricks whose masses the brick libraries state.

    Parameters
    ----------
    count : int
        Number of bricks, at least 1.
    seed : int
        Seed of the random numbers.
    spread : int, optional
        Side of the square in which bricks are placed on the base [cell]; by default a side that
        gives a model of a few layers.

    Examples
    --------
    >>> len(random_bricks(10, seed=0))
    10
    """
    rng = np.random.default_rng(seed)
    side = int(3 + 1.5 * count**0.5) if spread is None else spread
    taken: set[tuple[int, int, int]] = set()
    bricks: list[tuple[int, int, int, int, int]] = []
    while len(bricks) < count:
        across, along = SIZES[rng.integers(len(SIZES))]
        if not bricks or rng.random() < ON_BASE:
            x, y = (int(k) for k in rng.integers(0, side, 2))
            z = 0
        else:
            x0, y0, z0, across0, along0 = bricks[rng.integers(len(bricks))]
            x = int(rng.integers(x0 - across + 1, x0 + across0))
            y = int(rng.integers(y0 - along + 1, y0 + along0))
            z = z0 + (1 if rng.random() < ABOVE else -1)
        cells = {(x + i, y + j, z) for i in range(across) for j in range(along)}
        if z < 0 or cells & taken:
            continue
        taken |= cells
        bricks.append((x, y, z, across, along))
    rows = np.array(bricks)
    zero, number = np.zeros(count, dtype=np.int64), np.arange(1, count + 1)
    return BrickModel(
        corner=rows[:, :3] * [1, 1, BRICK_PLATES],
        size=np.column_stack([rows[:, 3:], zero + BRICK_PLATES]),
        mass=np.array([brick_mass(a, b) for a, b in rows[:, 3:].tolist()]),
        color=rng.choice(COLORS, count),
        held=zero > 0,
        number=number,
        line=number,
        studded=studded_all_over(rows[:, 3:]),
    )
