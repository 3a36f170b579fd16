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
    """N toy bricks on a grid, as arrays.

    Attributes
    ----------
    corner : ndarray of int, shape (N, 3)
        Lowest cell of each brick: x, y [cells], z [plates].
    size : ndarray of int, shape (N, 3)
        Size along x, y [cells] and z [plates].
    mass : ndarray, shape (N,)
        Masses [kg].
    color : ndarray of int, shape (N,)
        LDraw colour codes; `NO_COLOR` if none is stated.
    held : ndarray of bool, shape (N,)
        Whether each brick is held; true for baseplates.
    number : ndarray of int, shape (N,)
        Number of the brick in the file: its key, or its line.
    line : ndarray of int, shape (N,)
        Line of the file; 0 for a brick that is in no file.
    """

    corner: Index = columns(3)
    size: Index = columns(3)
    mass: Array = columns()
    color: Index = columns()
    held: Mask = columns()
    number: Index = columns()
    line: Index = columns()

    @property
    def top(self) -> Index:
        """Height of the top of each brick [plates], shape (N,)."""
        top: Index = self.corner[:, 2] + self.size[:, 2]
        return top

    def require_apart(self) -> None:
        """Raise an InputError if two bricks occupy the same grid cell.

        Raises
        ------
        InputError
            If two bricks overlap; the error names the lines of both, and the cell.
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
    """Grid cells that the bricks cover, sorted by column and height.

    Attributes
    ----------
    brick : ndarray of int, shape (C,)
        Brick of each cell.
    xy : ndarray of int, shape (C, 2)
        Position of each cell.
    same_column : ndarray of bool, shape (C - 1,)
        Whether cell k + 1 is above cell k.
    """

    brick: Index
    xy: Index
    same_column: Mask


def cells_of(model: BrickModel) -> Cells:
    """List the grid cells that the bricks of a model cover."""
    brick, place = counted(model.size[:, 0] * model.size[:, 1])
    along = model.size[brick, 1]
    xy = model.corner[brick, :2] + np.column_stack([place // along, place % along])
    order = np.lexsort((model.corner[brick, 2], xy[:, 1], xy[:, 0]))
    xy = xy[order]
    return Cells(brick[order], xy, (xy[1:] == xy[:-1]).all(axis=1))
