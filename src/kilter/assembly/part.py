"""Part: a rigid part of an assembly, immutable."""

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
"""Reserved name of the world; a joint with it holds a part."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A rigid part.

    Parameters
    ----------
    name : str
        Name, unique in the assembly; not "ground".
    shape : Box, Cylinder, Sphere, Prism, Mesh or Solid
        Shape in the part's own frame [length unit].
    pose : Pose, or array_like of shape (3, 3) or (4, 4)
        Transform from the part's frame to the world: a pose, a rotation matrix, or a rigid
        transform.
    grounded : bool
        Whether the part is held: it cannot move.
    density : float, optional
        Density [kg/m^3]; default 1000 if the mass is not given either.
    mass : float, optional
        Mass [kg]; overrides density and volume.
    center_of_mass : array_like, shape (3,), optional
        Centre of mass in the part's own frame [length unit]; overrides the geometry.
    table : bool
        Whether the part is the table of `Assembly.with_floor`; no part counts as fastened to it.
    brick : Brick, optional
        Toy brick, drawn with studs and in its colour; the shape must be a box.

    Raises
    ------
    InputError
        If the name is empty or reserved, or a number is not finite or not positive.

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
            raise InputError(
                f"the name of a part is {self.name!r}", hint="give a name that is not empty"
            )
        try:
            self._validate()
        except InputError as error:
            raise error.located(part=self.name) from None

    def _validate(self) -> None:
        """Verify and convert all fields except the name."""
        if self.name == GROUND:
            raise InputError(f"the name {GROUND!r} is reserved", hint="give it another name")
        if not isinstance(self.shape, Shape):
            raise _shape_error(self.shape)
        if self.brick is not None and not isinstance(self.shape, Box):
            raise InputError("the shape of the brick is not a box", hint="give a box, or no brick")
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
    """A bool; raises `InputError` for other types."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} is {value!r:.60}", hint="give True or False")
    return bool(value)


def _shape_error(value: Any) -> InputError:
    """The error for a value that is not a shape, with a remedy."""
    hint = "give a kilter.Box, Cylinder, Sphere, Prism or Mesh"
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        hint = "give kilter.Mesh(mesh.vertices, mesh.faces)"
    return InputError(f"shape is of type {type(value).__name__}", hint=hint)
