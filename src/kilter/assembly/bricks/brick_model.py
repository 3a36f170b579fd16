"""BrickModel: bricks on their grid, one row a brick.

Cells are numbered along x and y, heights in plates, so that all is whole: two bricks in one cell,
a stud under a cell, a neighbour beside it are questions about whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, counted
from kilter.errors import InputError

__all__ = ["NO_COLOR", "BrickModel", "Cells", "cells_of"]

NO_COLOR = -1
"""No colour is stated."""


@dataclass(frozen=True, slots=True, eq=False)
class BrickModel(Rows):
    """N bricks, struct of arrays.

    Attributes
    ----------
    corner : ndarray of int, shape (N, 3)
        The lowest cell: x, y [cells], z [plates].
    size : ndarray of int, shape (N, 3)
        Along x, y [cells] and z [plates].
    mass : ndarray, shape (N,)
        [kg]
    color : ndarray of int, shape (N,)
        Codes of LDraw's colours; `NO_COLOR` where none is stated.
    held : ndarray of bool, shape (N,)
        Baseplates.
    number : ndarray of int, shape (N,)
        What the file calls it: its key, or its line.
    line : ndarray of int, shape (N,)
        The line of the file that it stands in; 0 where it is of none.
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
        """Height of each brick's top, shape (N,) [plates]."""
        top: Index = self.corner[:, 2] + self.size[:, 2]
        return top

    def require_apart(self) -> None:
        """Refuse two bricks in one cell.

        Raises
        ------
        InputError
            Naming the line of the later one, the line of the other and the cell.
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
            f"line {line}: cell ({x}, {y}) is taken by the brick of line {other}",
            hint="move one of the two bricks",
        )


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The cells that bricks stand on, ordered by column and by height.

    Attributes
    ----------
    brick : ndarray of int, shape (C,)
    xy : ndarray of int, shape (C, 2)
    same_column : ndarray of bool, shape (C - 1,)
        Cell k + 1 is over cell k.
    """

    brick: Index
    xy: Index
    same_column: Mask


def cells_of(model: BrickModel) -> Cells:
    """The cells of all bricks."""
    brick, place = counted(model.size[:, 0] * model.size[:, 1])
    along = model.size[brick, 1]
    xy = model.corner[brick, :2] + np.column_stack([place // along, place % along])
    order = np.lexsort((model.corner[brick, 2], xy[:, 1], xy[:, 0]))
    xy = xy[order]
    return Cells(brick[order], xy, (xy[1:] == xy[:-1]).all(axis=1))
