"""Assembly: which parts, which of them are held, what pulls on them; validated once.

Lengths are in `Assembly.units`; gravity is m/s^2, density kg/m^3, mass kg, force N, torque
N x length unit, all in the world frame. What follows from the shapes (vertices, masses,
centres, inertia) is `Assembly.geometry`, computed once, in arrays.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly.bonds import Bond, require_apart
from kilter.assembly.geometry import Geometry, build_geometry
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint, Load
from kilter.assembly.lowest import lowest_heights
from kilter.assembly.part import GROUND, Part
from kilter.errors import InputError, nearest_name, some_names
from kilter.hooks import hook
from kilter.rigid import Pose, rotation_between, unit
from kilter.shape.primitives import Box
from kilter.tell.html import html_of
from kilter.units import metres_per_unit
from kilter.validate import frozen, in_range, number

__all__ = ["Assembly", "require_assembly"]

Entry = FrictionPair | GivenContact | Joint | Bond
ENTRIES: dict[str, type] = {
    "parts": Part,
    "friction_pairs": FrictionPair,
    "loads": Load,
    "contacts": GivenContact,
    "joints": Joint,
    "bonds": Bond,
    "notes": str,
}
"""What the sequences of an assembly hold."""
SPACIOUS = 4.0
"""Width of the floor over the width of the parts that it lies under."""
THICK = 0.25
"""Thickness of the floor over the same."""


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
    friction_pairs, loads, contacts, joints, bonds : sequences
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
    bonds: Sequence[Bond] = ()

    def __post_init__(self) -> None:
        try:
            for name, kind in ENTRIES.items():
                object.__setattr__(self, name, _entries(name, getattr(self, name), kind))
            self._validate_parts()
            self._validate_gravity()
            object.__setattr__(self, "friction", number(self.friction, "friction", lowest=0))
            self._validate_entries()
            for load in self.loads:
                self._validate_load(load)
        except InputError as error:
            raise error.located(file=self.source or None) from None

    def _validate_parts(self) -> None:
        metres_per_unit(self.units)
        if not self.parts:
            raise InputError("no parts", hint="give at least one part")
        if len(self.index) < len(self.parts):
            count = Counter(self.names)
            twice = next(name for name in self.names if count[name] > 1)
            raise InputError(f"two parts are named {twice!r}", hint="give each its own name")

    def _validate_gravity(self) -> None:
        gravity = frozen(self.gravity, (3,), "gravity")
        if not np.isfinite(gravity).all() or not gravity.any():
            raise InputError(
                f"gravity is {gravity.tolist()}", hint="give a vector that is not zero, in m/s^2"
            )
        if self.planar and gravity[1] != 0.0:
            raise InputError(
                "gravity leaves the x-z plane of a planar assembly", hint="give it y = 0"
            )
        in_range(gravity, "gravity")
        object.__setattr__(self, "gravity", gravity)

    def _validate_entries(self) -> None:
        """Friction pairs, contacts, joints and bonds name two parts each; some no pair twice."""
        entries: list[tuple[str, Entry]] = [
            *(("friction pair", entry) for entry in self.friction_pairs),
            *(("contact", entry) for entry in self.contacts),
            *(("joint", entry) for entry in self.joints),
            *(("bond", entry) for entry in self.bonds),
        ]
        for what, entry in entries:
            if len(entry.parts) != 2 or entry.parts[0] == entry.parts[1]:
                raise InputError(f"a {what} names {list(entry.parts)}", hint="name two parts")
            for name in entry.parts:
                if not (isinstance(entry, Joint) and name == GROUND):
                    self.index_of(name)
        for joint in self.joints if self.planar else ():
            joint.require_planar()
        require_apart(tuple(self.bonds))
        pairs = [frozenset(entry.parts) for entry in self.friction_pairs]
        if len(set(pairs)) < len(pairs):
            times = Counter(pairs)
            both = next(pair for pair in pairs if times[pair] > 1)
            raise InputError(
                f"two friction pairs name {some_names(sorted(both))}", hint="leave one out"
            )

    def _validate_load(self, load: Load) -> None:
        if self[load.part].grounded:
            raise InputError(
                "a load acts on a held part, where it moves nothing",
                part=load.part,
                hint="leave the load out, or do not hold the part",
            )
        if self.planar and (load.force[1] or load.torque[0] or load.torque[2]):
            raise InputError(
                "a load leaves the x-z plane of a planar assembly",
                part=load.part,
                hint="give forces along x and z, torques about y",
            )

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)

    def __getitem__(self, part: str | int) -> Part:
        return self.parts[self.index_of(part)]

    def __contains__(self, part: object) -> bool:
        return part in self.index if isinstance(part, str) else part in self.parts

    def __repr__(self) -> str:
        held = sum(part.grounded for part in self.parts)
        source = f", from {Path(self.source).name!r}" if self.source else ""
        return f"<Assembly: {len(self)} parts, {held} held, in {self.units}{source}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return html_of(
            {
                "kilter": 1,
                "units": self.units,
                "gravity": self.gravity.tolist(),
                "friction": self.friction,
                "parts": [{"name": part.name, "grounded": part.grounded} for part in self.parts],
                "joints": self.joints_data(),
                "loads": self.loads,
                "contacts": self.contacts,
                "warnings": self.notes,
            }
        )

    def joints_data(self) -> list[dict[str, Any]]:
        """The joints, those that were fastened among them, as JSON data of an answer."""
        return [
            {"parts": list(joint.parts), "kind": joint.kind}
            | ({"why": joint.why} if joint.why else {})
            for joint in self.joints
        ]

    def bonds_data(self) -> list[dict[str, Any]]:
        """The bonds as JSON data of an answer: of whom, and how strong."""
        return [bond.to_dict() for bond in self.bonds]

    @cached_property
    def index(self) -> dict[str, int]:
        """Position of each part by name."""
        return {part.name: k for k, part in enumerate(self.parts)}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(part.name for part in self.parts)

    def index_of(self, part: str | int) -> int:
        """Position of the part of that name, or at that position.

        Raises
        ------
        InputError
            If there is none; it names the nearest.
        """
        if isinstance(part, int | np.integer):
            if not -len(self.parts) <= part < len(self.parts):
                raise InputError(f"no part has position {part}", hint=f"there are {len(self)}")
            return int(part) % len(self.parts)
        try:
            return self.index[part]
        except (KeyError, TypeError):
            near = nearest_name(part, self.index)
            hint = f"did you mean {near!r}?" if near else f"there are: {some_names(self.names, 8)}"
            raise InputError(
                f"no part is named {part!r}", file=self.source or None, hint=hint
            ) from None

    @cached_property
    def geometry(self) -> Geometry:
        """What follows from the shapes: vertices, masses, centres, inertia, in arrays."""
        try:
            return build_geometry(self.parts, self.units)
        except InputError as error:
            raise error.located(file=self.source or None) from None

    @property
    def down(self) -> Array:
        """Unit direction of gravity, shape (3,)."""
        return unit(self.gravity, "gravity")

    # other libraries -----------------------------------------------------------------

    @classmethod
    def of(cls, value: Any, **options: Any) -> Assembly:
        """The assembly that an object of another library is; the same as `kilter.load`.

        Raises
        ------
        InputError
            If it is nothing that `kilter.load` takes.

        Examples
        --------
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        >>> Assembly.of({"tip": (corners, faces)}, units="mm", ground="tip")
        <Assembly: 1 parts, 1 held, in mm>
        """
        assembly: Assembly = hook("load")(value, **options)
        return assembly

    def to_trimesh(self) -> Any:
        """A `trimesh.Scene` with a node a part, under its name, in the units of the assembly.

        Raises
        ------
        InputError
            If trimesh is not installed.
        """
        return hook("scene_of")(self)

    def to_mjcf(self) -> str:
        """The text of an MJCF scene, to be watched in MuJoCo; see `kilter.files.mjcf`.

        Raises
        ------
        InputError
            If it has loads, or joints that slide.
        """
        text: str = hook("to_mjcf")(self)
        return text

    # changed copies ------------------------------------------------------------------

    def with_down(self, down: ArrayLike) -> Assembly:
        """Gravity turned to the direction `down`, its size kept."""
        size = float(np.linalg.norm(self.gravity))
        return self._replace(gravity=unit(down, "down") * size)

    def with_friction(self, friction: float) -> Assembly:
        """The friction coefficient of contacts that have none of their own."""
        return self._replace(friction=friction)

    def with_grounded(self, patterns: str | Iterable[str]) -> Assembly:
        """The parts that match (``*`` and ``?`` are globs) held, besides those held before."""
        chosen = self.matching(patterns)
        return self._replace(
            parts=[
                dataclasses.replace(part, grounded=True) if part.name in chosen else part
                for part in self.parts
            ]
        )

    def with_bonds(self, bonds: Iterable[Bond]) -> Assembly:
        """Bonds besides those there are."""
        return self._replace(bonds=[*self.bonds, *bonds])

    def with_joints(self, joints: Iterable[Joint], *, notes: Iterable[str] = ()) -> Assembly:
        """Joints besides those there are; `kilter.contact.fastened` makes those of bolts.

        `notes` are added to those of the reader.
        """
        return self._replace(joints=[*self.joints, *joints], notes=[*self.notes, *notes])

    def without(self, patterns: str | Iterable[str]) -> Assembly:
        """The assembly without the parts that match, and all that names them."""
        gone = self.matching(patterns)
        keep = [part for part in self.parts if part.name not in gone]
        if not keep:
            raise InputError("all parts are left out", hint="leave fewer parts out")

        def kept(entries: Sequence[Any]) -> list[Any]:
            return [entry for entry in entries if not gone.intersection(entry.parts)]

        return self._replace(
            parts=keep,
            friction_pairs=kept(self.friction_pairs),
            contacts=kept(self.contacts),
            joints=kept(self.joints),
            bonds=kept(self.bonds),
            loads=[load for load in self.loads if load.part not in gone],
        )

    def with_floor(self, height: float | None = None) -> Assembly:
        """A held table under the lowest point (against gravity), or at a height there.

        The lowest point is that of the exact surfaces. `height` is measured along the direction
        opposite to gravity [length unit].
        """
        geometry = self.geometry
        up = -self.down
        lowest = number(height, "height of the floor") if height is not None else None
        if lowest is None:
            lowest = float(lowest_heights(geometry, up).min())
        size = float(np.ptp(geometry.vertices, axis=0).max())
        middle = (geometry.vertices.min(axis=0) + geometry.vertices.max(axis=0)) / 2
        thick = THICK * size
        center = middle + up * (lowest - thick / 2 - middle @ up)
        name = "floor"
        while name in self.index:
            name += "_"
        table = Part(
            name,
            Box([SPACIOUS * size, SPACIOUS * size, thick]),
            Pose(center, rotation_between([0, 0, 1], up)),
            grounded=True,
            density=1000.0,
            table=True,
        )
        return self._replace(parts=[*self.parts, table])

    def matching(self, patterns: str | Iterable[str]) -> set[str]:
        """Names that match any of the patterns.

        Raises
        ------
        InputError
            If a pattern matches no part.
        """
        chosen: set[str] = set()
        for pattern in [patterns] if isinstance(patterns, str) else patterns:
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
        lowest = self.names[int(lowest_heights(geometry, -self.down).argmin())]
        raise InputError(
            f"nothing is held; the parts are {some_names(self.names, 8)}, the lowest is {lowest!r}",
            file=self.source or None,
            hint=f"hold one with assembly.with_grounded({lowest!r}), or put a table under them "
            "with assembly.with_floor()",
            option=f"hold one with --ground {lowest!r}, or put a table under them with --floor",
        )

    def _replace(self, **changes: Any) -> Assembly:
        return dataclasses.replace(self, **changes)


def _entries(name: str, given: Any, kind: type) -> tuple[Any, ...]:
    """A sequence of one kind of value, as a tuple."""
    try:
        entries = None if isinstance(given, str | bytes | kind) else tuple(given)
    except TypeError:
        entries = None
    if entries is None:
        raise InputError(
            f"{name} is one {type(given).__name__}",
            hint=f"give a list of {kind.__name__}",
        )
    for k, entry in enumerate(entries):
        if not isinstance(entry, kind):
            raise InputError(
                f"{name}[{k}] is of type {type(entry).__name__}",
                hint=f"give a kilter.{kind.__name__}",
            )
    return entries


def require_assembly(value: object, verb: str) -> None:
    """Refuse what is no assembly, and say how to make one of it.

    Raises
    ------
    InputError

    Examples
    --------
    >>> require_assembly("arch.stl", "check")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: check wants an assembly, got a path; read it: kilter.load('arch.stl')
    """
    if isinstance(value, Assembly):
        return
    if isinstance(value, str | os.PathLike):
        raise InputError(
            f"{verb} wants an assembly, got a path",
            hint=f"read it: kilter.load({os.fspath(value)!r:.60})",
        )
    hint = "make one: kilter.Assembly([kilter.Part(...), ...]), or kilter.load(path or object)"
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        hint = "make one of it: kilter.load(mesh)"
    elif isinstance(value, Part):
        hint = "put it into one: kilter.Assembly([part, ...])"
    raise InputError(f"{verb} wants an assembly, got {type(value).__name__}", hint=hint)
