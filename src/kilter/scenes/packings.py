"""Random piles of boxes on a grid; each box is lowered onto the highest box below it."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.scenes.pieces import block, floor
from kilter.scenes.registry import listed

__all__ = ["box_pile"]


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
