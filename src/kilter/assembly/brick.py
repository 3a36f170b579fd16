"""Brick: the studs, height and colour of a part that is a toy brick."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from kilter.errors import InputError

__all__ = ["BRICK_PLATES", "COLOR_CODES", "Brick"]

BRICK_PLATES = 3
"""Height of a brick [plates]."""

MOST = 10_000
"""Largest number of cells along a side, and largest height in plates."""
COLOR_CODES = 2**32
"""Upper bound of the LDraw colour codes, exclusive."""


@dataclass(frozen=True, slots=True)
class Brick:
    """Size, height and colour of a part that is a toy brick.

    Its box has ``cells`` along x and y, and a stud in the middle of each cell.

    Raises `InputError` if a number is not an integer, or out of range.

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
    """Number of studs along x and along y."""
    plates: int = BRICK_PLATES
    """Height [plates]; a brick has 3."""
    color: int | None = None
    """LDraw colour code; None if the file states none."""

    def __post_init__(self) -> None:
        cells = tuple(self.cells) if isinstance(self.cells, tuple | list) else ()
        if len(cells) != 2 or not all(_is_integer(count, 1, MOST) for count in cells):
            hint = f"give two whole numbers from 1 to {MOST}"
            raise InputError(f"cells of a brick are {self.cells!r:.60}", hint=hint)
        if not _is_integer(self.plates, 1, MOST):
            hint = f"give a whole number from 1 to {MOST}"
            raise InputError(f"height of a brick in plates is {self.plates!r:.60}", hint=hint)
        if self.color is not None and not _is_integer(self.color, 0, COLOR_CODES - 1):
            hint = "give an LDraw colour code"
            raise InputError(f"colour of a brick is {self.color!r:.60}", hint=hint)
        object.__setattr__(self, "cells", cells)

    @property
    def studs(self) -> int:
        """Number of studs on top of the brick."""
        return math.prod(self.cells)


def _is_integer(value: Any, low: int, high: int) -> bool:
    """Whether a value is an int from `low` to `high`."""
    return type(value) is int and low <= value <= high
