"""Part: a rigid part of an assembly, a frozen value."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.assembly.brick import Brick
from kilter.errors import InputError
from kilter.rigid import Pose, in_brackets
from kilter.shape.primitives import Box, Shape
from kilter.validate import finite, in_range, number

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
    pose : Pose, or array_like of shape (3, 3) or (4, 4)
        From the part's frame to the world; a matrix is a rotation, or a rigid transform.
    grounded : bool
        Held: it does not move.
    density : float, optional
        [kg/m^3]; 1000 where neither density nor mass is given.
    mass : float, optional
        [kg]; overrides density and volume.
    center_of_mass : array_like, shape (3,), optional
        In the part's own frame; overrides the geometry.
    table : bool
        The table of `Assembly.with_floor`: nothing is taken for fastened to it.
    brick : Brick, optional
        What it is as a toy brick: drawn with studs, in its colour. Its shape is a box then.

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
    table: bool = False
    brick: Brick | None = None

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
            raise _no_shape(self.shape)
        if self.brick is not None and not isinstance(self.shape, Box):
            raise InputError("a brick whose shape is no box", hint="give a box, or no brick")
        object.__setattr__(self, "pose", Pose.of(self.pose))
        object.__setattr__(self, "grounded", _flag(self.grounded, "grounded"))
        object.__setattr__(self, "table", _flag(self.table, "table"))
        if self.density is not None:
            object.__setattr__(
                self, "density", number(self.density, "density", lowest=0, above=True)
            )
        if self.mass is not None:
            object.__setattr__(self, "mass", number(self.mass, "mass", lowest=0, above=True))
        if self.center_of_mass is not None:
            center = finite(self.center_of_mass, (3,), "center_of_mass")
            in_range(center, "center_of_mass")
            object.__setattr__(self, "center_of_mass", center)

    def __repr__(self) -> str:
        held = ", grounded=True" if self.grounded else ""
        return f"Part({self.name!r}, {self.shape!r}, at {in_brackets(self.pose.position)}{held})"


def _flag(value: Any, name: str) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} is {value!r:.60}", hint="give True or False")
    return bool(value)


def _no_shape(value: Any) -> InputError:
    """What to do with something that is no shape."""
    hint = "give a kilter.Box, Cylinder, Sphere, Prism or Mesh"
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        hint = "give kilter.Mesh(mesh.vertices, mesh.faces)"
    return InputError(f"shape is of type {type(value).__name__}", hint=hint)
