"""Part and Assembly: frozen values, validated once.

An `Assembly` says what the parts are, where, which of them are held (grounded), and what
pulls on them. Lengths are in `Assembly.units`; gravity is m/s^2, density kg/m^3, mass kg,
force N, torque N x length unit, all in the world frame. What follows from the shapes
(vertices, masses, centres, inertia) is `Assembly.geometry`, computed once, in arrays.
"""

from __future__ import annotations

import dataclasses
import difflib
import fnmatch
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kilter.errors import InputError
from kilter.rigid import Pose, frozen, unit
from kilter.shapes import Box, Cylinder, Mesh, Prism, Shape, Sphere
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.geometry import Geometry

__all__ = [
    "GROUND",
    "Assembly",
    "FrictionPair",
    "GivenContact",
    "Joint",
    "Load",
    "Part",
    "nearest_name",
]

Array = NDArray[np.float64]

GROUND = "ground"
"""Reserved name: a joint with it holds a part to the world."""

JointKind = Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical"]


def _number(value: Any, what: str, *, lowest: float = -np.inf, above: bool = False) -> float:
    """`value` as a finite float, at least (or above) `lowest`."""
    bound = f"{'above' if above else 'at least'} {lowest:g}" if lowest > -np.inf else "finite"
    hint = f"give a number {bound}" if lowest > -np.inf else "give a finite number"
    if isinstance(value, bool | str) or value is None:
        raise InputError(f"{what} is {value!r}", hint=hint)
    number = float(value)
    if not np.isfinite(number) or number < lowest or (above and number == lowest):
        raise InputError(f"{what} is {number:g}", hint=hint)
    return number


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A rigid part.

    Parameters
    ----------
    name : str
        Unique in the assembly; not "ground".
    shape : Box, Cylinder, Sphere, Prism or Mesh
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
        if not isinstance(self.shape, Box | Cylinder | Sphere | Prism | Mesh):
            raise InputError(f"shape is {type(self.shape).__name__}", hint="give a kilter shape")
        if self.density is not None:
            object.__setattr__(
                self, "density", _number(self.density, "density", lowest=0, above=True)
            )
        if self.mass is not None:
            object.__setattr__(self, "mass", _number(self.mass, "mass", lowest=0, above=True))
        if self.center_of_mass is not None:
            center = frozen(self.center_of_mass, (3,))
            if not np.isfinite(center).all():
                raise InputError(f"center_of_mass is {center.tolist()}")
            object.__setattr__(self, "center_of_mass", center)


@dataclass(frozen=True, slots=True, eq=False)
class FrictionPair:
    """Friction coefficient [-] of every contact between two parts."""

    parts: tuple[str, str]
    mu: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        object.__setattr__(self, "mu", _number(self.mu, "friction coefficient", lowest=0))


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """A force [N] at a point and a torque [N x length unit] on a part, fixed in the world.

    Loads do not turn with the assembly. `point` is in the world frame; None means the
    part's centre of mass.
    """

    part: str
    force: Any = (0.0, 0.0, 0.0)
    torque: Any = (0.0, 0.0, 0.0)
    point: Any = None

    def __post_init__(self) -> None:
        for name in ("force", "torque", "point"):
            value = getattr(self, name)
            if value is None and name == "point":
                continue
            value = frozen(value, (3,))
            if not np.isfinite(value).all():
                raise InputError(f"{name} of a load is {value.tolist()}", part=self.part)
            object.__setattr__(self, name, value)


@dataclass(frozen=True, slots=True, eq=False)
class GivenContact:
    """Contact points between two parts, used instead of detection for that pair.

    `points`, shape (n, 3), and `normal`, shape (3,), from the first part to the second,
    are in the world frame.
    """

    parts: tuple[str, str]
    points: Any
    normal: Any
    mu: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        points = frozen(self.points, (-1, 3)) if len(self.points) else np.empty((0, 3))
        if not len(points) or not np.isfinite(points).all():
            raise InputError(
                f"contact of {self.parts[0]!r} and {self.parts[1]!r} has no usable points",
                hint="give one point or more",
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "normal", unit(self.normal, "normal of a contact"))
        if self.mu is not None:
            object.__setattr__(self, "mu", _number(self.mu, "friction coefficient", lowest=0))


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A two-sided connection of two parts, or of a part and the ground.

    `point` and `axis`, both shape (3,), are in the world frame.
    """

    parts: tuple[str, str]
    kind: JointKind = "fixed"
    point: Any = None
    axis: Any = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        if self.point is not None:
            object.__setattr__(self, "point", frozen(self.point, (3,)))
        if self.axis is not None:
            object.__setattr__(self, "axis", unit(self.axis, "axis of a joint"))


@dataclass(frozen=True, eq=False)
class Assembly:
    """Rigid parts, which of them are held, and what pulls on them.

    Parameters
    ----------
    parts : sequence of Part
    units : {"m", "cm", "mm", "in"}
        The unit of every length.
    gravity : array_like, shape (3,)
        [m/s^2], world frame.
    friction : float
        Coefficient [-] of contacts that have none of their own.
    friction_pairs, loads, contacts, joints : sequences
    planar : bool
        Motions in the x-z plane only; gravity must lie in it.
    detect : bool
        False: only the given contacts count.
    source : str
        The file it was read from; named in messages.
    notes : sequence of str
        What the reader had to say about the file; shown as warnings.

    Raises
    ------
    InputError
        If there is no part, two parts share a name, a name is unknown, gravity is zero.

    Examples
    --------
    >>> table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    >>> assembly = Assembly([table, cube])
    >>> assembly.geometry.mass
    array([16000.,  1000.])
    """

    parts: Sequence[Part]
    units: str = "m"
    gravity: Any = (0.0, 0.0, -9.81)
    friction: float = 0.0
    friction_pairs: Sequence[FrictionPair] = ()
    loads: Sequence[Load] = ()
    contacts: Sequence[GivenContact] = ()
    joints: Sequence[Joint] = ()
    planar: bool = False
    detect: bool = True
    source: str = ""
    notes: Sequence[str] = ()

    def __post_init__(self) -> None:
        for name in ("parts", "friction_pairs", "loads", "contacts", "joints", "notes"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        try:
            self._validate()
        except InputError as error:
            raise error.located(file=self.source or None) from None

    def _validate(self) -> None:
        metres_per_unit(self.units)
        if not self.parts:
            raise InputError("no parts", hint="give at least one part")
        if len(self.index) < len(self.parts):
            names = [part.name for part in self.parts]
            twice = next(name for name in names if names.count(name) > 1)
            raise InputError(f"two parts are named {twice!r}", hint="give each its own name")
        gravity = frozen(self.gravity, (3,))
        if not np.isfinite(gravity).all() or not gravity.any():
            raise InputError(
                f"gravity is {gravity.tolist()}", hint="give a vector that is not zero, in m/s^2"
            )
        if self.planar and gravity[1] != 0.0:
            raise InputError(
                "gravity leaves the x-z plane of a planar assembly", hint="give it y = 0"
            )
        object.__setattr__(self, "gravity", gravity)
        object.__setattr__(self, "friction", _number(self.friction, "friction", lowest=0))
        entries: list[FrictionPair | GivenContact | Joint] = []
        entries += [*self.friction_pairs, *self.contacts, *self.joints]
        for entry in entries:
            self._check_pair(entry)
        for load in self.loads:
            self.index_of(load.part)

    def _check_pair(self, entry: FrictionPair | GivenContact | Joint) -> None:
        what = {"FrictionPair": "friction pair", "GivenContact": "contact", "Joint": "joint"}
        label = what[type(entry).__name__]
        if len(entry.parts) != 2 or entry.parts[0] == entry.parts[1]:
            raise InputError(f"a {label} names {list(entry.parts)}", hint="name two parts")
        for name in entry.parts:
            if not (isinstance(entry, Joint) and name == GROUND):
                self.index_of(name)

    @cached_property
    def index(self) -> dict[str, int]:
        """Position of each part by name."""
        return {part.name: k for k, part in enumerate(self.parts)}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(part.name for part in self.parts)

    def index_of(self, name: str) -> int:
        """Position of the part of that name.

        Raises
        ------
        InputError
            If there is none; it names the nearest.
        """
        try:
            return self.index[name]
        except KeyError:
            near = nearest_name(name, self.index)
            hint = f"did you mean {near!r}?" if near else f"there are: {_some(self.names)}"
            raise InputError(
                f"no part is named {name!r}", file=self.source or None, hint=hint
            ) from None

    @cached_property
    def geometry(self) -> Geometry:
        """What follows from the shapes: vertices, masses, centres, inertia, in arrays."""
        from kilter.geometry import build_geometry

        return build_geometry(self)

    @property
    def down(self) -> Array:
        """Unit direction of gravity, shape (3,)."""
        return unit(self.gravity)

    # changed copies ------------------------------------------------------------------

    def with_down(self, down: ArrayLike) -> Assembly:
        """Gravity turned to the direction `down`, its size kept."""
        size = float(np.linalg.norm(self.gravity))
        return self._replace(gravity=unit(down, "down") * size)

    def with_friction(self, friction: float) -> Assembly:
        """The friction coefficient of contacts that have none of their own."""
        return self._replace(friction=friction)

    def with_grounded(self, patterns: Iterable[str]) -> Assembly:
        """The parts that match (``*`` and ``?`` are globs) held, besides those held before."""
        chosen = self.matching(patterns)
        return self._replace(
            parts=[
                dataclasses.replace(part, grounded=True) if part.name in chosen else part
                for part in self.parts
            ]
        )

    def without(self, patterns: Iterable[str]) -> Assembly:
        """The assembly without the parts that match, and all that names them."""
        gone = self.matching(patterns)
        keep = [part for part in self.parts if part.name not in gone]
        if not keep:
            raise InputError("no part is left", hint="leave fewer parts out")

        def kept(entries: Sequence[Any]) -> list[Any]:
            return [entry for entry in entries if not gone.intersection(entry.parts)]

        return self._replace(
            parts=keep,
            friction_pairs=kept(self.friction_pairs),
            contacts=kept(self.contacts),
            joints=kept(self.joints),
            loads=[load for load in self.loads if load.part not in gone],
        )

    def with_floor(self, height: float | None = None) -> Assembly:
        """A held table under the lowest point (against gravity), or at a height there.

        `height` is measured along the direction opposite to gravity [length unit].
        """
        geometry = self.geometry
        up = -self.down
        heights = geometry.vertices @ up
        lowest = float(heights.min()) if height is None else _number(height, "height of the floor")
        size = float(np.ptp(geometry.vertices, axis=0).max())
        middle = (geometry.vertices.min(axis=0) + geometry.vertices.max(axis=0)) / 2
        thick = size / 4
        center = middle + up * (lowest - thick / 2 - middle @ up)
        from kilter.rigid import rotation_between

        name = "floor"
        while name in self.index:
            name += "_"
        table = Part(
            name,
            Box([4 * size, 4 * size, thick]),
            Pose(center, rotation_between([0, 0, 1], up)),
            grounded=True,
            density=1000.0,
        )
        return self._replace(parts=[*self.parts, table])

    def matching(self, patterns: Iterable[str]) -> set[str]:
        """Names that match any of the patterns.

        Raises
        ------
        InputError
            If a pattern matches no part.
        """
        chosen: set[str] = set()
        for pattern in patterns:
            if pattern in self.index:
                chosen.add(pattern)
                continue
            found = [name for name in self.names if fnmatch.fnmatchcase(name, pattern)]
            if not found:
                self.index_of(pattern)
            chosen.update(found)
        return chosen

    def require_grounded(self) -> None:
        """Refuse an assembly in which nothing is held.

        Raises
        ------
        InputError
            Naming the parts and the lowest one.
        """
        held = any(part.grounded for part in self.parts)
        if held or any(GROUND in joint.parts for joint in self.joints):
            return
        geometry = self.geometry
        heights = -(geometry.vertices @ self.down)
        lowest = self.names[int(geometry.vertex_part[np.argmin(heights)])]
        raise InputError(
            f"nothing is held; the parts are {_some(self.names)}, the lowest is {lowest!r}",
            file=self.source or None,
            hint=f"hold one with --ground {lowest!r}, or put a table under them with --floor",
        )

    def _replace(self, **changes: Any) -> Assembly:
        return dataclasses.replace(self, **changes)


def nearest_name(name: str, names: Iterable[str]) -> str | None:
    """The known name most like `name`, or None.

    Examples
    --------
    >>> nearest_name("densty", ["density", "mass"])
    'density'
    """
    found = difflib.get_close_matches(str(name), list(names), n=1, cutoff=0.5)
    return found[0] if found else None


def _some(names: Sequence[str], limit: int = 8) -> str:
    shown = ", ".join(repr(name) for name in names[:limit])
    return f"{shown} and {len(names) - limit} more" if len(names) > limit else shown
