"""The rules of the stud model: how much a stud holds, and how neighbours push.

A stud is held at three or four points of its cell. Each pulls by up to `pull`, pushes without
limit, and is sheared without limit, by up to a force, or by friction mu (f_n + pull). Two bricks
side by side push each other, without friction, at their lower edge.

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
"""[m/s^2], as there."""
PULL = 0.98
"""What a point of a stud holds there [N]: 100 g."""
NARROW: Array = np.array([[0, -0.25], [-0.25, 0], [0, 0.25], [0.25, 0]])
"""Points of a stud under a brick that is one stud wide, from its middle, in cells."""
WIDE: Array = np.array([[0.125, -0.125], [-0.25, 0], [0.125, 0.125]])
"""The same under a wider brick: two walls and a tube."""
SIDES = ("lower-edge", "face", "none")
"""Where neighbours push each other."""
UNLIMITED, FRICTION = "unlimited", "mu"


@dataclass(frozen=True, slots=True)
class StudRules:
    """How bricks hold each other; the defaults are those of StableLego.

    Parameters
    ----------
    pull : float
        What a point of a stud holds [N].
    shear : "unlimited", "mu" or float
        Sideways at a point of a stud: any force, mu (f_n + pull), or up to a force [N].
    sides : {"lower-edge", "face", "none"}
        Where neighbours in a layer push each other.

    Raises
    ------
    InputError
        If a force is negative, or a word is unknown.

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
        """The shear as a bond has it: None without a limit."""
        return None if self.shear == UNLIMITED else self.shear


def _float(value: float | str) -> object:
    """A number that was typed, as one."""
    try:
        return float(value)
    except ValueError:
        return value
