"""Part: a rigid part of an assembly, immutable."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly.assembly_tolerances import INERTIA_ROUNDING, THIN_INERTIA
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.rigid import Pose, in_brackets
from kilter.shape.primitives import Box, Mesh, Shape
from kilter.units import metres_per_unit
from kilter.validate import finite, in_range, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

# Brick: the studs, height and colour of a part that is a toy brick.


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


# Stated moments of inertia: six numbers of a symmetric tensor, and their validation.


def inertia_matrix(numbers: Array) -> Array:
    """The symmetric matrix of xx, yy, zz, xy, xz, yz, shape (3, 3).

    Examples
    --------
    >>> inertia_matrix(np.array([1, 2, 3, 4, 5, 6])).tolist()
    [[1, 4, 5], [4, 2, 6], [5, 6, 3]]
    """
    matrix: Array = numbers[np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])]
    return matrix


def inertia_numbers(matrix: Array) -> Array:
    """The numbers xx, yy, zz, xy, xz, yz of a symmetric matrix, shape (6,)."""
    return matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def inertia_fault(matrix: Array) -> str:
    """The reason why no body has this inertia; empty if a body can have it.

    Examples
    --------
    >>> inertia_fault(np.diag([1.0, 1.0, 1.0])), inertia_fault(np.diag([1.0, 1.0, 3.0]))
    ('', 'its principal moments are 1, 1, 3: the largest exceeds the sum of the others')
    """
    moments = np.linalg.eigvalsh(matrix)
    words = f"its principal moments are {', '.join(f'{moment:.4g}' for moment in moments)}"
    if not moments[0] > THIN_INERTIA * abs(moments[2]):
        return f"{words}: the least is not positive"
    if moments[2] > (1 + INERTIA_ROUNDING) * (moments[0] + moments[1]):
        return f"{words}: the largest exceeds the sum of the others"
    return ""


def valid_inertia(values: Any) -> Array:
    """Copy six numbers of an inertia that a body can have to a read-only array.

    Raises `InputError` if there are not six finite numbers, or no body has this inertia.
    """
    numbers = finite(values, (6,), "inertia")
    in_range(numbers, "inertia")
    fault = inertia_fault(inertia_matrix(numbers))
    if fault:
        raise InputError(
            f"inertia is {numbers.tolist()}, but {fault}",
            hint="give xx, yy, zz, xy, xz, yz about the centre of mass",
        )
    return numbers


GROUND = "ground"
"""Reserved name of the world; a joint with it holds a part."""


NOT_STATED: Any = type("NotStated", (), {"__repr__": lambda _: "None"})()
"""Default of the mass, so that ``replace(part, mass=None)`` removes a given mass."""


@guarded
@dataclass(frozen=True, slots=True, eq=False, init=False)
class Part(Value):
    """A rigid part with a shape, a pose, and a mass or density.

    Parameters
    ----------
    name : str
        Name, unique in the assembly; not "ground".
    shape : Box, Cylinder, Sphere, Prism, Mesh or Solid
        Shape in the part's own frame [length unit]. An object with `vertices` and `faces`, such
        as a mesh of trimesh, becomes a `Mesh`.
    pose : Pose, or array_like of shape (3,), (3, 3) or (4, 4)
        Transform from the part's frame to the world: a pose, a position, a rotation matrix, or a
        rigid transform.
    grounded : bool
        Whether the part is held: it cannot move.
    density : float, optional
        Density [kg/m^3]; default 1000 if the mass is not given either.
    mass : float, optional
        Mass [kg]; overrides density and volume. The attribute `mass` is always known, see below.
    center_of_mass : array_like, shape (3,), optional
        Centre of mass in the part's own frame [length unit]; overrides the geometry.
    inertia : array_like, shape (6,), optional
        Moments of inertia xx, yy, zz, xy, xz, yz about the centre of mass, along the axes of the
        part's own frame [kg x length unit^2]. By default those of the shape about its centroid,
        in proportion to the mass, are used about the centre of mass.
    table : bool
        Whether the part is the table of `Assembly.with_floor`; no part counts as fastened to it.
    brick : Brick, optional
        Toy brick, drawn with studs and in its colour; the shape must be a box.
    color : str, optional
        Colour in drawings, as "#rrggbb" in lower case.
    material, layer : str, optional
        Names of the material and of the layer, as a CAD file states them; words for people, from
        which nothing is computed.
    given_mass : float, optional
        The same as `mass`, for `dataclasses.replace`.
    units : {"m", "cm", "mm", "in"}
        Unit of the lengths. An assembly sets it to its own unit, without a conversion of numbers.
    geometry : {"", "collider", "visual"}
        Kind of shape that a scene of a simulator has for this part; empty for other files.

    Attributes
    ----------
    mass : float
        Mass [kg]: the given mass, or density times volume of the shape.
    given_mass : float or None
        The mass that was given.

    Notes
    -----
    Parts with equal content are equal and have the same hash, whatever their units and geometry.

    Raises
    ------
    InputError
        If the name is empty or reserved, or a number is not finite or not positive; if no body has
        the given inertia.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> part = Part("C2", Box(1, 1, 1), [0, 0, 0.5], density=7850)
    >>> part.mass, part.given_mass
    (7850.0, None)
    >>> part == Part("C2", Box([1, 1, 1]), Pose([0, 0, 0.5]), density=7850.0)
    True
    >>> round(Part("C3", Box(40, 20, 10), units="mm").mass, 12)
    0.008
    """

    name: str
    shape: Shape
    pose: Pose = field(default_factory=Pose)
    grounded: bool = False
    density: float | None = None
    given_mass: float | None = None
    center_of_mass: Any = None
    inertia: Any = None
    table: bool = False
    brick: Brick | None = None
    color: str | None = None
    material: str | None = None
    layer: str | None = None
    units: str = field(default="m", compare=False)
    geometry: str = field(default="", compare=False)

    # The generated initialiser would lack the keyword `mass`, which is also a property.
    def __init__(
        self,
        name: str,
        shape: Shape,
        pose: Any = None,
        grounded: bool = False,
        density: float | None = None,
        mass: float | None = NOT_STATED,
        center_of_mass: Any = None,
        table: bool = False,
        brick: Brick | None = None,
        *,
        inertia: Any = None,
        color: str | None = None,
        material: str | None = None,
        layer: str | None = None,
        given_mass: float | None = None,
        units: str = "m",
        geometry: str = "",
    ) -> None:
        values = {
            "name": name,
            "shape": shape,
            "pose": Pose() if pose is None else pose,
            "grounded": grounded,
            "density": density,
            "given_mass": given_mass if mass is NOT_STATED else mass,
            "center_of_mass": center_of_mass,
            "inertia": inertia,
            "table": table,
            "brick": brick,
            "color": color,
            "material": material,
            "layer": layer,
            "units": units,
            "geometry": geometry,
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if not isinstance(self.name, str) or not self.name:
            raise InputError(
                f"the name of a part is {self.name!r}", hint="give a name that is not empty"
            )
        try:
            self._validate()
        except InputError as error:
            raise error.located(part=self.name) from None

    def _validate(self) -> None:
        """Check and convert all fields of the part except its name."""
        if self.name == GROUND:
            raise InputError(
                f"the name {GROUND!r} is reserved for the world in joints and straps",
                hint="give another name, such as 'table'",
            )
        if not isinstance(self.shape, Shape):
            object.__setattr__(self, "shape", _shape_of(self.shape))
        if self.brick is not None and not isinstance(self.shape, Box):
            raise InputError("the shape of the brick is not a box", hint="give a box, or no brick")
        if self.color is not None and not re.fullmatch("#[0-9a-f]{6}", str(self.color)):
            raise InputError(f"the colour is {self.color!r}", hint='give "#rrggbb", or no colour')
        for key in ("material", "layer"):
            label = getattr(self, key)
            if label is not None and not (isinstance(label, str) and label):
                raise InputError(f"{key} is {label!r:.40}", hint="give a name, or None")
        object.__setattr__(self, "pose", Pose.of(self.pose))
        object.__setattr__(self, "grounded", _flag(self.grounded, "grounded"))
        object.__setattr__(self, "table", _flag(self.table, "table"))
        if self.density is not None:
            object.__setattr__(
                self, "density", number(self.density, "density", lowest=0, above=True)
            )
        if self.given_mass is not None:
            mass = number(self.given_mass, "mass", lowest=0, above=True)
            object.__setattr__(self, "given_mass", mass)
        metres_per_unit(self.units)
        if self.center_of_mass is not None:
            center = finite(self.center_of_mass, (3,), "center_of_mass")
            in_range(center, "center_of_mass")
            object.__setattr__(self, "center_of_mass", center)
        if self.inertia is not None:
            object.__setattr__(self, "inertia", valid_inertia(self.inertia))

    @property
    def mass(self) -> float:
        """Mass of the part [kg]: the given mass, or density times volume of the shape.

        Raises
        ------
        InputError
            If the mass is not given and the shape does not enclose a volume.
        """
        if self.given_mass is not None:
            return self.given_mass
        mass: float = hook("mass_of")(self)
        return mass

    def __repr__(self) -> str:
        held = ", grounded=True" if self.grounded else ""
        return f"Part({self.name!r}, {self.shape!r}, at {in_brackets(self.pose.position)}{held})"


def _flag(value: Any, name: str) -> bool:
    """The value as a bool; raises `InputError` for other types."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} is {value!r:.60}", hint="give True or False")
    return bool(value)


def _shape_of(value: Any) -> Shape:
    """The mesh of an object with vertices and faces, such as a mesh of trimesh.

    Raises `InputError` if the object is another one.
    """
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        try:
            return Mesh(np.asarray(value.vertices), np.asarray(value.faces))
        except (TypeError, ValueError):  # for example methods of the same names
            pass
    raise InputError(
        f"shape is of type {type(value).__name__}",
        hint="give a kilter.Box, Cylinder, Sphere, Prism or Mesh, or convert a shape of another "
        "library: kilter.load({name: shape})",
    )
