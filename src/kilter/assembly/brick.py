"""Brick: what a part is as a toy brick, beside its box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Brick"]


@dataclass(frozen=True, slots=True)
class Brick:
    """Cells and colour of a part that is a brick: what it is drawn with, and its place by.

    Its box is ``cells`` along x and y; a stud stands on each, in the middle of the cell.

    Attributes
    ----------
    cells : tuple of int
        Studs along x and along y.
    plates : int
        Height in plates: 3 of a brick.
    color : int or None
        Code of LDraw's colours; None where the file states none.
    """

    cells: tuple[int, int]
    plates: int = 3
    color: int | None = None

    @property
    def studs(self) -> int:
        """How many studs it has on top."""
        return int(np.prod(self.cells))
