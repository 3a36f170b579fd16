"""Assembly: the parts, which of them are held, and the forces on them; validated when created.

Lengths are in `Assembly.units`; gravity is in m/s^2, density in kg/m^3, mass in kg, force in N,
torque in N x length unit. All vectors are in the world frame. `Assembly.geometry` computes
vertices, masses, centres and inertia of all parts once, as arrays.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import itertools
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

from kilter.arrays import Array
from kilter.assembly.bonds import Bond, require_apart
from kilter.assembly.changed_copies import ChangedCopies, bounds
from kilter.assembly.geometry import Geometry, build_geometry
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint, ListedJoint, Load
from kilter.assembly.part import GROUND, Part
from kilter.assembly.straps import Strap, StrapEnd, some
from kilter.errors import InputError, nearest_name, some_names
from kilter.hooks import hook
from kilter.rigid import unit
from kilter.shape.primitives import piece_count
from kilter.tell.html import html_of
from kilter.units import metres_per_unit
from kilter.validate import frozen, in_range, name_list, number
from kilter.values.guesses import guarded

LIBRARIES = ("build123d", "cadquery", "compas", "compas_assembly", "mujoco", "trimesh")
"""Libraries whose objects `kilter.load` converts."""

Entry = FrictionPair | GivenContact | Joint | Bond
ENTRIES: dict[str, type] = {
    "parts": Part,
    "friction_pairs": FrictionPair,
    "loads": Load,
    "contacts": GivenContact,
    "joints": Joint,
    "bonds": Bond,
    "straps": Strap,
    "notes": str,
}
"""Type of the entries of each sequence of an assembly."""


@guarded
@dataclass(frozen=True, eq=False)
class Assembly(ChangedCopies):
    """Rigid parts with held parts, gravity, loads, joints, bonds, straps and given contacts.

    Parameters
    ----------
    parts : sequence of Part
    units : {"m", "cm", "mm", "in"}
        Unit of every length.
    gravity : array_like, shape (3,)
        Acceleration of gravity, world frame [m/s^2].
    friction : float
        Friction coefficient of contacts without a coefficient of their own [-].
    friction_pairs : sequence of FrictionPair
    loads : sequence of Load
    contacts : sequence of GivenContact
    joints : sequence of Joint
    planar : bool
        True: motions in the x-z plane only; gravity must lie in it.
    detect : bool
        False: only the given contacts count.
    source : str
        Name of the file that the assembly was read from, for messages.
    notes : sequence of str
        Remarks of the reader about the file; shown as warnings.
    bonds : sequence of Bond
    tolerance : kilter.Tolerance, optional
        Default tolerance of contact detection; None for that of `kilter.Tolerance()`.
    straps : sequence of Strap
    reading : mapping, optional
        Options with which `kilter.load` read the file, as JSON data: proofs list them.
    file_up : array_like, shape (3,), optional
        Up direction of a file of a format that states no held parts, world frame [-]: an answer
        assumes a floor across it if nothing is held. None: nothing is assumed.
    assumed : mapping
        Options of reading that were assumed, as JSON data: the unit of a file that states none,
        and the support of an assembly without a held part. Proofs list them, too.
    up_assumed : bool
        Whether neither the file nor an option states which axis points up.

    Notes
    -----
    An assembly is a frozen value: methods such as `with_friction` return a changed copy.
    Assemblies with equal content are equal and have the same hash; `source`, `reading`, `file_up`,
    `assumed` and `up_assumed` do not count.

    Raises
    ------
    InputError
        If there is no part, two parts share a name, a name is unknown, or gravity is zero.

    Examples
    --------
    >>> from kilter import Box, Pose
    >>> table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    >>> assembly = Assembly([table, cube])
    >>> assembly.geometry.mass
    array([16000.,  1000.])
    >>> assembly["cube"].mass, assembly.mass, assembly.center_of_mass.tolist()
    (1000.0, 17000.0, [0.0, 0.0, -0.4411764705882353])
    >>> assembly.bounds.tolist()
    [[-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]]
    >>> taller = assembly + Part("lid", Box(1, 1, 1), [0, 0, 1.5])
    >>> taller.without("lid") == assembly
    True
    >>> assembly.merged(assembly, prefix="b/").renamed({"b/table": "far"}).names
    ('table', 'cube', 'far', 'b/cube')
    >>> assembly.with_pose("cube", [1, 0, 0.5])["cube"].pose
    Pose(position=(1, 0, 0.5), rotation=(1, 0, 0, 0))
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
    source: str = field(default="", compare=False)
    notes: Sequence[str] = ()
    bonds: Sequence[Bond] = ()
    tolerance: Any = None
    straps: Sequence[Strap] = ()
    reading: Mapping[str, Any] | None = field(default=None, compare=False)
    file_up: Any = field(default=None, compare=False)
    assumed: Mapping[str, Any] = field(default_factory=dict, compare=False)
    up_assumed: bool = field(default=False, compare=False)

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
            for strap in self.straps:
                self._validate_strap(strap)
        except InputError as error:
            raise error.located(file=self.source or None) from None

    def _validate_parts(self) -> None:
        """Verify that there are parts, with distinct names, and that the units are known."""
        metres_per_unit(self.units)
        parts: Sequence[Part] = self.parts
        if any(part.units != self.units for part in parts):
            parts = [dataclasses.replace(part, units=self.units) for part in parts]
        if not isinstance(parts, _NamedParts):
            object.__setattr__(self, "parts", _NamedParts(parts))
        if not self.parts:
            raise InputError("the assembly has no parts", hint="give at least one part")
        if len(self.index) < len(self.parts):
            count = Counter(self.names)
            twice = next(name for name in self.names if count[name] > 1)
            raise InputError(f"two parts are named {twice!r}", hint="give each its own name")

    def _validate_gravity(self) -> None:
        """Verify that gravity is finite, not zero, and in the plane of a planar assembly."""
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
        """Verify that friction pairs, contacts, joints and bonds name two known parts each.

        Joints must also fit a planar assembly, and neither friction pairs nor bonds may repeat a
        pair.
        """
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
        if self.bonds:
            require_apart(tuple(self.bonds))
        of_pieces: list[FrictionPair | GivenContact] = [*self.friction_pairs, *self.contacts]
        for stated in of_pieces:
            for name, piece in zip(stated.parts, stated.pieces or (0, 0), strict=True):
                if piece >= (count := piece_count(self[name].shape)):
                    raise InputError(
                        f"there is no piece {piece} of it", part=name, hint=f"it has {count}"
                    )
        subjects = [entry.subject for entry in self.friction_pairs]
        if len(set(subjects)) < len(subjects):
            times = Counter(subjects)
            pair = next(entry for entry in self.friction_pairs if times[entry.subject] > 1)
            names = some_names(sorted(pair.parts))
            of = "" if pair.pieces is None else " and the same pieces"
            raise InputError(f"two friction pairs name {names}{of}", hint="remove a pair")

    def _validate_load(self, load: Load) -> None:
        """Verify that a load acts on a free part, and in the plane of a planar assembly."""
        if self[load.part].grounded:
            raise InputError(
                "a load acts on a held part, where it has no effect",
                part=load.part,
                hint="remove the load, or do not hold the part",
            )
        if self.planar and (load.force[1] or load.torque[0] or load.torque[2]):
            raise InputError(
                "a load leaves the x-z plane of a planar assembly",
                part=load.part,
                hint="give forces along x and z, torques about y",
            )

    def _validate_strap(self, strap: Strap) -> None:
        """Verify that a strap runs over known parts, and in the plane of a planar assembly."""
        for name in strap.parts:
            if name != GROUND:
                self.index_of(name)
        if self.planar and np.diff(strap.points[:, 1]).any():
            raise InputError(
                "a strap leaves the x-z plane of a planar assembly",
                hint="give all points of its path the same y",
            )

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__  # without the kept hash, which a frozen value cannot set again

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
        """HTML summary of the assembly, which a notebook displays."""
        return html_of(
            {
                "kilter": 1,
                "units": self.units,
                "gravity": self.gravity.tolist(),
                "friction": self.friction,
                "parts": [{"name": part.name, "grounded": part.grounded} for part in self.parts],
                "joints": [joint.to_dict() for joint in self.joints_data()],
                "loads": self.loads,
                "contacts": self.contacts,
                "warnings": self.notes,
            }
        )

    def joints_data(self) -> tuple[ListedJoint, ...]:
        """The joints as entries of answers; joints that an option added have a reason."""
        return tuple(
            ListedJoint(parts=joint.parts, kind=joint.kind, why=joint.why or None, **joint.guide)
            for joint in self.joints
        )

    @cached_property
    def index(self) -> dict[str, int]:
        """Index of each part, by its name."""
        return {part.name: k for k, part in enumerate(self.parts)}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in order."""
        return tuple(part.name for part in self.parts)

    def index_of(self, part: str | int) -> int:
        """Index of a part, from its name or from an index, which may be negative.

        Raises
        ------
        InputError
            If there is no such part; the error names the most similar name.
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
        """Vertices, masses, centres and inertia of all parts, as arrays."""
        try:
            return cast("_NamedParts", self.parts).geometry
        except InputError as error:
            raise error.located(file=self.source or None) from None

    @cached_property
    def bounds(self) -> Array:
        """Lower and upper corner of the bounding box of all parts, shape (2, 3), read-only.

        World frame [length unit]. The box contains the exact curved surfaces.
        """
        return frozen(bounds(self.geometry, np.ones(len(self.parts), dtype=bool)))

    @property
    def size(self) -> Array:
        """Extents of the free parts along the axes, of all parts if none is free, shape (3,).

        World frame [length unit]. They contain the exact curved surfaces.
        """
        free = ~self.geometry.grounded
        low, high = bounds(self.geometry, free if free.any() else ~free)
        return frozen(high - low)

    @property
    def mass(self) -> float:
        """Total mass of all parts, held parts included [kg]."""
        return float(self.geometry.mass.sum())

    @property
    def center_of_mass(self) -> Array:
        """Common centre of mass of all parts, held parts included [length unit], shape (3,).

        World frame [length unit]. ``geometry.center`` has that of each part.
        """
        mass = self.geometry.mass
        return frozen(mass @ self.geometry.center / mass.sum())

    @property
    def down(self) -> Array:
        """Unit direction of gravity, shape (3,)."""
        return unit(self.gravity, "gravity")

    def show(self, *, height: int = 720, title: str = "") -> Any:
        """The interactive page of `kilter.report` as the output of a notebook cell.

        Parameters
        ----------
        height : int
            Height of the frame [px].
        title : str
            Title above the page; the name of the file by default.

        Returns
        -------
        kilter.Shown

        Raises
        ------
        InputError
            As `kilter.report`; for example if nothing is held.
        """
        return hook("cell")(self, height=height, title=title)

    # other libraries -----------------------------------------------------------------

    @classmethod
    def of(cls, value: Any, **options: Any) -> Assembly:
        """Convert a file or an object of another library to an assembly, as `kilter.load` does.

        Raises
        ------
        InputError
            If `kilter.load` does not support the type of the object.

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
        """Convert the assembly to a `trimesh.Scene` with a node for each part.

        Raises
        ------
        InputError
            If trimesh is not installed.
        """
        return hook("scene_of")(self)

    def to_mjcf(self) -> str:
        """The text of an MJCF file (a scene for MuJoCo) of the assembly.

        Raises
        ------
        InputError
            If the assembly has loads or sliding joints.
        """
        text: str = hook("to_mjcf")(self)
        return text

    def matching(self, patterns: str | Iterable[str]) -> set[str]:
        """Names of the parts that match any of the patterns (names or wildcards).

        A name that an answer shortened ("bracket...assembly_2/nut") counts if a single part has it.

        Raises
        ------
        InputError
            If a pattern matches no part, or is no text.
        """
        chosen: set[str] = set()
        for pattern in name_list(patterns):
            if pattern in self.index:
                chosen.add(pattern)
                continue
            matches = [name for name in self.names if fnmatch.fnmatchcase(name, pattern)]
            if not matches and "..." in pattern:
                head, _, tail = pattern.partition("...")
                ends = [n for n in self.names if n.startswith(head) and n.endswith(tail)]
                matches = ends if len(ends) == 1 else []
            if not matches:
                self._require_alike(pattern)
            chosen.update(matches)
        return chosen

    def _require_alike(self, pattern: str) -> None:
        """Raise an InputError for a pattern without a match; a wildcard may be missing in it."""
        for place, alike in (
            ("end in", f"*{pattern}"),
            ("begin with", f"{pattern}*"),
            ("contain", f"*{pattern}*"),
        ):
            count = len(fnmatch.filter(self.names, alike))
            if count > 1:
                raise InputError(
                    f"no part is named {pattern!r}",
                    file=self.source or None,
                    hint=f"{count} parts {place} {pattern}: {alike!r}",
                )
        self.index_of(pattern)

    @property
    def holds(self) -> bool:
        """Whether a part is held or joined to the ground."""
        held = any(part.grounded for part in self.parts)
        return held or any(GROUND in joint.parts for joint in self.joints)

    @property
    def largest(self) -> str:
        """Name of the part with the largest volume."""
        return self.names[int(self.geometry.volume.argmax())]

    def require_grounded(self) -> None:
        """Raise an InputError if no part is held or joined to the ground.

        Raises
        ------
        InputError
            If nothing is held; the error names the parts and the largest part.
        """
        if self.holds:
            return
        largest = self.largest
        raise InputError(
            f"nothing is held; the parts are {some_names(self.names, 8)}, the largest is "
            f"{largest!r}",
            file=self.source or None,
            hint=f"hold a part with assembly.with_grounded({largest!r}), or put a table under them "
            "with assembly.with_floor()",
            option=f"hold a part with --ground {largest!r}, or put a table under them with --floor",
        )


class _NamedParts(tuple[Part, ...]):
    """The parts of an assembly, which its copies share, and with them the geometry.

    A name as an index is answered with the right call.
    """

    @cached_property
    def geometry(self) -> Geometry:
        """Vertices, masses, centres and inertia of the parts, as arrays."""
        return build_geometry(self, self[0].units)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            raise InputError("parts have positions, not names", hint=f"use assembly[{key!r}]")
        return super().__getitem__(key)


def _entries(name: str, given: Any, kind: type) -> tuple[Any, ...]:
    """Convert a sequence of entries to a tuple; raises `InputError` unless all are of `kind`."""
    if isinstance(given, _NamedParts):
        return given
    try:
        entries = None if isinstance(given, str | bytes | kind) else tuple(given)
    except TypeError:
        entries = None
    if entries is None:
        raise InputError(
            f"{name} is a single {type(given).__name__}",
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
    """Raise an InputError if the argument of a function is no assembly; `verb` names it.

    Raises `InputError` if it is not; the error states how to make an assembly from the value.

    Examples
    --------
    >>> require_assembly("arch.stl", "check")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: check needs an assembly, got a path; read it: kilter.load('arch.stl')
    """
    if isinstance(value, Assembly):
        return
    if isinstance(value, str | os.PathLike):
        raise InputError(
            f"{verb} needs an assembly, got a path",
            hint=f"read it: kilter.load({os.fspath(value)!r:.60})",
        )
    hint = (
        "make an assembly: kilter.Assembly([kilter.Part(...), ...]), or kilter.load(path or object)"
    )
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        hint = "convert it: kilter.load(mesh)"
    elif isinstance(value, Part):
        hint = "put it into an assembly: kilter.Assembly([part, ...])"
    elif type(value).__module__.partition(".")[0] in LIBRARIES:
        hint = "convert it: kilter.load(object, floor=True)"
    raise InputError(f"{verb} needs an assembly, got {type(value).__name__}", hint=hint)


# Straps with friction at their corners that name no tensioned end: both ends are possible.


MOST_OPEN = 6
"""Largest number of straps without a named end; all 2^n combinations are decided."""


def with_named_ends(assembly: Assembly) -> list[Assembly]:
    """Copies of an assembly with every combination of tensioned ends; itself if all are named.

    Raises `InputError` if more than `MOST_OPEN` straps name no tensioned end.
    """
    unnamed = [k for k, strap in enumerate(assembly.straps) if strap.open_end]
    if not unnamed:
        return [assembly]
    if len(unnamed) > MOST_OPEN:
        raise InputError(
            f"{len(unnamed)} straps have friction and name no tensioned end",
            hint=f'give "tensioned" so that at most {MOST_OPEN} straps are left',
        )
    copies = []
    for ends in itertools.product(get_args(StrapEnd), repeat=len(unnamed)):
        straps = list(assembly.straps)
        for k, end in zip(unnamed, ends, strict=True):
            straps[k] = dataclasses.replace(straps[k], tensioned=end)
        copies.append(dataclasses.replace(assembly, straps=straps))
    return copies


def with_ends_of(assembly: Assembly, given: Sequence[Mapping[str, Any]]) -> Assembly:
    """Copy of an assembly whose open ends are those that the straps of a proof name."""
    if len(given) != len(assembly.straps) or not any(s.open_end for s in assembly.straps):
        return assembly
    straps = [
        dataclasses.replace(strap, tensioned=data.get("tensioned"))
        if strap.open_end and data.get("tensioned") in get_args(StrapEnd)
        else strap
        for strap, data in zip(assembly.straps, given, strict=True)
    ]
    return dataclasses.replace(assembly, straps=straps)


def end_words(assembly: Assembly, named: Assembly) -> list[str]:
    """For each strap without a named end, the tensioned end that a copy of the assembly names."""
    return [
        f"the strap over {some(strap)} is tensioned at its {other.tensioned} end"
        for strap, other in zip(assembly.straps, named.straps, strict=True)
        if strap.open_end and not other.open_end
    ]
