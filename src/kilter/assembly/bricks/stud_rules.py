"""StudRules: the strength of studs, and the contacts between neighbouring bricks.

A stud acts at three or four points of its cell. At each point it resists pull up to `pull`, and
compression without limit. It resists shear without limit, up to a force, or by friction
mu (f_n + pull). Two bricks side by side have contacts without friction at their lower edge.

References
----------
StableLego: Stability Analysis of Block Stacking Assembly, arXiv 2402.10711, and its code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.validate import number

__all__ = ["GRAVITY", "LAYER", "NARROW", "SIDES", "UNIT", "UNLIMITED", "WIDE", "StudRules"]

UNIT = 7.8
"""Width of a cell in StableLego [mm]."""
LAYER = 9.6
"""Height of a brick [mm]."""
GRAVITY = 9.8
"""Acceleration of gravity in StableLego [m/s^2]."""
PULL = 0.98
"""Largest pull at a point of a stud in StableLego [N]: the weight of 100 g."""
NARROW: Array = np.array([[0, -0.25], [-0.25, 0], [0, 0.25], [0.25, 0]])
"""Points of a stud under a brick of width 1, relative to the middle of the stud [cells]."""
WIDE: Array = np.array([[0.125, -0.125], [-0.25, 0], [0.125, 0.125]])
"""Points of a stud under a wider brick, at two walls and a tube [cells]."""
SIDES = ("lower-edge", "face", "none")
"""Values of `sides`: the contact points between neighbouring bricks."""
UNLIMITED, FRICTION = "unlimited", "mu"


@dataclass(frozen=True, slots=True)
class StudRules:
    """Rules for toy bricks: strength of the studs, and contacts of neighbouring bricks.

    Arguments: `pull`: largest pull at each point of a stud [N]; `shear`: largest sideways force at
    each point of a stud: no limit, mu (f_n + pull), or a number [N]. Raises `InputError` if a force
    is negative, or a value is unknown.

    Examples
    --------
    >>> StudRules().pull
    0.98
    >>> StudRules(sides="edge")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the sides of bricks are 'edge'; use lower-edge or face or none
    """

    pull: float = PULL
    shear: float | str = UNLIMITED
    sides: str = "lower-edge"

    def __post_init__(self) -> None:
        object.__setattr__(self, "pull", number(self.pull, "pull of a stud", lowest=0))
        if self.shear not in (UNLIMITED, FRICTION):
            try:
                object.__setattr__(self, "shear", number(_float(self.shear), "shear", lowest=0))
            except InputError:
                hint = "use unlimited, mu, or a force in N"
                raise InputError(f"the shear of studs is {self.shear!r:.40}", hint=hint) from None
        if self.sides not in SIDES:
            raise InputError(
                f"the sides of bricks are {self.sides!r:.40}", hint=f"use {' or '.join(SIDES)}"
            )

    @property
    def bond_shear(self) -> float | str | None:
        """Shear strength of studs, as `Bond` expects it; None for no limit."""
        return None if self.shear == UNLIMITED else self.shear


def _float(value: float | str) -> object:
    """A value converted to a float; other values unchanged, for the error message."""
    try:
        return float(value)
    except ValueError:
        return value
