"""BrickModel: bricks on their grid, one row per brick.

Positions along x and y are counted in cells, heights in plates. Therefore overlaps, studs below a
brick, and neighbours follow from integers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, counted
from kilter.errors import InputError

__all__ = ["NO_COLOR", "BrickModel", "Cells", "cells_of"]

NO_COLOR = -1
"""Value of `BrickModel.color` for a brick without a stated colour."""


@dataclass(frozen=True, slots=True, eq=False)
class BrickModel(Rows):
    """N toy bricks on a grid, as arrays."""

    corner: Index = columns(3)
    """Lowest cell of each brick, shape (N, 3): x, y [cells], z [plates]."""
    size: Index = columns(3)
    """Size along x, y [cells] and z [plates], shape (N, 3)."""
    mass: Array = columns()
    """Masses [kg], shape (N,)."""
    color: Index = columns()
    """LDraw colour codes, shape (N,); `NO_COLOR` if none is stated."""
    held: Mask = columns()
    """Whether each brick is held, shape (N,); true for baseplates."""
    number: Index = columns()
    """Number of the brick in the file, shape (N,): its key, or its line."""
    line: Index = columns()
    """Line of the file, shape (N,); 0 for a brick that is in no file."""

    @property
    def top(self) -> Index:
        """Height of the top of each brick [plates], shape (N,)."""
        top: Index = self.corner[:, 2] + self.size[:, 2]
        return top

    def require_apart(self) -> None:
        """Raise an InputError if two bricks occupy the same grid cell.

        Raises `InputError` if two bricks overlap; the error names the lines of both, and the cell.
        """
        cells = cells_of(self)
        low, high = self.corner[cells.brick, 2], self.top[cells.brick]
        clash = np.flatnonzero(cells.same_column & (low[1:] < high[:-1]))
        if not len(clash):
            return
        pairs = np.sort(self.line[np.column_stack([cells.brick[clash], cells.brick[clash + 1]])])
        k = np.lexsort(pairs.T)[0]
        x, y = cells.xy[clash[k]]
        other, line = pairs[k]
        raise InputError(
            f"line {line}: cell ({x}, {y}) is occupied by the brick in line {other}",
            hint="move either brick",
        )


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Grid cells that the bricks cover, sorted by column and height."""

    brick: Index
    """Brick of each cell, shape (C,)."""
    xy: Index
    """Position of each cell, shape (C, 2)."""
    same_column: Mask
    """Whether cell k + 1 is above cell k, shape (C - 1,)."""


def cells_of(model: BrickModel) -> Cells:
    """List the grid cells that the bricks of a model cover."""
    brick, place = counted(model.size[:, 0] * model.size[:, 1])
    along = model.size[brick, 1]
    xy = model.corner[brick, :2] + np.column_stack([place // along, place % along])
    order = np.lexsort((model.corner[brick, 2], xy[:, 1], xy[:, 0]))
    xy = xy[order]
    return Cells(brick[order], xy, (xy[1:] == xy[:-1]).all(axis=1))
