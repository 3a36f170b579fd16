"""Brick: what a part is as a toy brick, beside its box."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from kilter.errors import InputError

__all__ = ["BRICK_PLATES", "COLOR_CODES", "Brick"]

BRICK_PLATES = 3
"""Plates as high as one brick."""

MOST = 10_000
"""Cells along a side, and plates, that a brick may have."""
COLOR_CODES = 2**32
"""Codes of LDraw's colours are below."""


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

    Raises
    ------
    InputError
        If a number is not whole, or out of range.

    Examples
    --------
    >>> Brick((2, 4)).studs
    8
    >>> Brick((2, 0))
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: cells of a brick are (2, 0); give two whole numbers from 1 to 10000
    """

    cells: tuple[int, int]
    plates: int = BRICK_PLATES
    color: int | None = None

    def __post_init__(self) -> None:
        cells = tuple(self.cells) if isinstance(self.cells, tuple | list) else ()
        if len(cells) != 2 or not all(_whole(one, 1, MOST) for one in cells):
            hint = f"give two whole numbers from 1 to {MOST}"
            raise InputError(f"cells of a brick are {self.cells!r:.60}", hint=hint)
        if not _whole(self.plates, 1, MOST):
            hint = f"give a whole number from 1 to {MOST}"
            raise InputError(f"height of a brick in plates is {self.plates!r:.60}", hint=hint)
        if self.color is not None and not _whole(self.color, 0, COLOR_CODES - 1):
            hint = "give a code of LDraw's colours"
            raise InputError(f"colour of a brick is {self.color!r:.60}", hint=hint)
        object.__setattr__(self, "cells", cells)

    @property
    def studs(self) -> int:
        """How many studs it has on top."""
        return math.prod(self.cells)


def _whole(value: Any, low: int, high: int) -> bool:
    return type(value) is int and low <= value <= high
