"""Two plates that leave only as one."""

from __future__ import annotations

import numpy as np

from kilter import Assembly, Part
from kilter.scenes.pieces import block, cells, floor

TONGUE = np.zeros((4, 4, 1), dtype=bool)
"""Cells of a plate that reaches by a tongue into a notch of the other."""
TONGUE[:2], TONGUE[2, 1] = True, True


def hooked(*, lid: bool = True) -> Assembly:
    """Two plates that hook into each other sideways, in a channel with ledges over their rims."""
    ledges = [block("ledge-w", [-1, 0, 1], [1, 4, 2]), block("ledge-e", [3, 0, 1], [5, 4, 2])]
    walls = [
        block("west", [-1, 0, 0], [0, 4, 1]), block("east", [4, 0, 0], [5, 4, 1]),
        block("back", [-1, -1, 0], [5, 0, 1]), *(ledges if lid else []),
    ]  # fmt: skip
    grid = np.arange(5.0)
    return Assembly(
        [
            floor([-3, -3], [7, 7]),
            *(Part(p.name, p.shape, p.pose, grounded=True) for p in walls),
            Part("A", cells(grid, grid, [0, 1], TONGUE)),
            Part("B", cells(grid, grid, [0, 1], ~TONGUE)),
        ]
    )
