"""Random models of toy bricks, seeded: each brick has a stud in one that stands, or on the base."""

from __future__ import annotations

import numpy as np

from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks import BrickModel
from kilter.assembly.bricks.brick_library import STATED, brick_mass

__all__ = ["random_bricks"]

ON_BASE = 0.1
"""Chance of a brick on the baseplate."""
ABOVE = 0.8
"""Chance that a brick is put on another, not under it."""
COLORS = (1, 2, 4, 14, 15, 25)
"""Blue, green, red, yellow, white, orange."""
SIZES = [*STATED, *((b, a) for a, b in STATED if a != b)]
"""Bricks either way round."""


def random_bricks(count: int, *, seed: int, spread: int | None = None) -> BrickModel:
    """A model of `count` bricks whose weights the libraries state.

    Parameters
    ----------
    count : int
        At least 1.
    seed : int
    spread : int, optional
        Cells along either side of the square in which bricks are put on the base; about as many
        as keep a model a few layers high where not given.

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
    none, number = np.zeros(count, dtype=np.int64), np.arange(1, count + 1)
    return BrickModel(
        corner=rows[:, :3] * [1, 1, BRICK_PLATES],
        size=np.column_stack([rows[:, 3:], none + BRICK_PLATES]),
        mass=np.array([brick_mass(a, b) for a, b in rows[:, 3:].tolist()]),
        color=rng.choice(COLORS, count),
        held=none > 0,
        number=number,
        line=number,
    )
