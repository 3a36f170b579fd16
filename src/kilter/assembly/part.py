"""Part: a rigid part of an assembly, a frozen value."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.primitives import Shape
from kilter.validate import frozen, in_range, number

__all__ = ["GROUND", "Part"]

GROUND = "ground"
"""Reserved name: a joint with it holds a part to the world."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A rigid part.

    Parameters
    ----------
    name : str
        Unique in the assembly; not "ground".
    shape : Box, Cylinder, Sphere, Prism, Mesh or Solid
        In the part's own frame [length unit].
    pose : Pose
        From the part's frame to the world.
    grounded : bool
        Held: it does not move.
    density : float, optional
        [kg/m^3]; 1000 where neither density nor mass is given.
    mass : float, optional
        [kg]; overrides density and volume.
    center_of_mass : array_like, shape (3,), optional
        In the part's own frame; overrides the geometry.

    Raises
    ------
    InputError
        If the name is empty or reserved, or a number is not finite or not above zero.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> Part("C2", Box([1, 1, 1]), Pose([0, 0, 0.5]), density=7850).mass is None
    True
    """

    name: str
    shape: Shape
    pose: Pose = field(default_factory=Pose)
    grounded: bool = False
    density: float | None = None
    mass: float | None = None
    center_of_mass: Any = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"a part's name is {self.name!r}", hint="give a name of some length")
        try:
            self._validate()
        except InputError as error:
            raise error.located(part=self.name) from None

    def _validate(self) -> None:
        if self.name == GROUND:
            raise InputError(f"the name {GROUND!r} is reserved", hint="give it another name")
        if not isinstance(self.shape, Shape):
            raise InputError(f"shape is {type(self.shape).__name__}", hint="give a kilter shape")
        if self.density is not None:
            object.__setattr__(
                self, "density", number(self.density, "density", lowest=0, above=True)
            )
        if self.mass is not None:
            object.__setattr__(self, "mass", number(self.mass, "mass", lowest=0, above=True))
        if self.center_of_mass is not None:
            center = frozen(self.center_of_mass, (3,))
            if not np.isfinite(center).all():
                raise InputError(f"center_of_mass is {center.tolist()}", hint="give finite numbers")
            in_range(center, "center_of_mass")
            object.__setattr__(self, "center_of_mass", center)
