"""Changed copies of an assembly: other parts, poses, names, loads, joints, gravity or friction.

Values are frozen: every method returns a new assembly. Positions in the world frame stay where
they are: those of joints, loads, bonds and given contacts do not follow a part to its new pose.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index, Mask, across, cross, extents, lengths, unit_rows
from kilter.assembly.assembly_tolerances import BESIDE_SEAM, UPRIGHT
from kilter.assembly.bonds import Bond
from kilter.assembly.geometry import Geometry
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint, Load
from kilter.assembly.part import Part
from kilter.assembly.straps import Strap
from kilter.assembly.surfaces import FREE, SPHERE, TORUS, Chords
from kilter.errors import InputError
from kilter.rigid import Pose, rotation_between, unit
from kilter.shape.closed import shared_edges
from kilter.shape.covering import covered
from kilter.shape.primitives import Box
from kilter.validate import number
from kilter.values.value import Value

FLOOR = "floor"
"""Name of an added floor, if no part has it."""
SPACIOUS = 4.0
"""Width of the floor [widths of the parts together]."""
THICK = 0.25
"""Thickness of the floor [widths of the parts together]."""
ALIKE = ("units", "gravity", "friction", "planar", "detect", "tolerance")
"""Fields in which two assemblies must agree before they are merged."""


Copy = TypeVar("Copy", bound="ChangedCopies")


class ChangedCopies(Value):
    """Methods of `Assembly` that return a changed copy."""

    __slots__ = ()

    if TYPE_CHECKING:
        parts: Sequence[Part]
        units: str
        gravity: Any
        friction_pairs: Sequence[FrictionPair]
        loads: Sequence[Load]
        contacts: Sequence[GivenContact]
        joints: Sequence[Joint]
        bonds: Sequence[Bond]
        straps: Sequence[Strap]
        notes: Sequence[str]

        # defined by `Assembly`
        @property
        def geometry(self) -> Geometry: ...  # noqa: D102
        @property
        def down(self) -> Array: ...  # noqa: D102
        @property
        def index(self) -> dict[str, int]: ...  # noqa: D102
        @property
        def names(self) -> tuple[str, ...]: ...  # noqa: D102
        def index_of(self, part: str | int) -> int: ...  # noqa: D102
        def matching(self, patterns: str | Iterable[str]) -> set[str]: ...  # noqa: D102

    def _replace(self, **changes: Any) -> Self:
        """A copy of the assembly with other values of the given fields."""
        return cast("Self", dataclasses.replace(cast("Any", self), **changes))

    # parts ---------------------------------------------------------------------------

    def __add__(self, part: Part) -> Self:
        """A copy of the assembly with one more part; `with_parts` adds several."""
        return self.with_parts([part]) if isinstance(part, Part) else NotImplemented

    def with_parts(self, parts: Iterable[Part]) -> Self:
        """A copy of the assembly with additional parts after the others."""
        return self._replace(parts=[*self.parts, *parts])

    def with_pose(self, part: str | int, pose: Any) -> Self:
        """A copy of the assembly with a part in another pose; `pose` as for `Part`."""
        return self.with_poses({self.parts[self.index_of(part)].name: pose})

    def with_poses(self, poses: Mapping[str, Any]) -> Self:
        """A copy of the assembly with some parts in other poses, by name."""
        parts = list(self.parts)
        for name, pose in poses.items():
            k = self.index_of(name)
            parts[k] = dataclasses.replace(parts[k], pose=pose)
        return self._replace(parts=parts)

    def renamed(self, names: Mapping[str, str]) -> Self:
        """A copy of the assembly with other part names, given from old to new.

        Entries that name the parts (loads, joints, bonds, contacts, friction pairs) follow.
        """
        for name in names:
            self.index_of(name)

        def following(entries: Sequence[Any]) -> list[Any]:
            """Copies of entries in which the old part names are replaced by the new names."""
            return [
                dataclasses.replace(entry, parts=tuple(names.get(n, n) for n in entry.parts))
                for entry in entries
            ]

        return self._replace(
            parts=[
                dataclasses.replace(part, name=names[part.name]) if part.name in names else part
                for part in self.parts
            ],
            friction_pairs=following(self.friction_pairs),
            contacts=following(self.contacts),
            joints=following(self.joints),
            bonds=following(self.bonds),
            loads=[
                dataclasses.replace(load, part=names.get(load.part, load.part))
                for load in self.loads
            ],
            straps=[
                dataclasses.replace(
                    strap, path=[(names.get(name, name), point) for name, point in strap.path]
                )
                for strap in self.straps
            ],
        )

    def merged(self, other: Self, *, prefix: str = "") -> Self:
        """A copy of the assembly with all parts and entries of another assembly added.

        Parameters
        ----------
        other : Assembly
            It has the same units, gravity and default friction.
        prefix : str
            Text before the names of the parts of `other`.

        Raises
        ------
        InputError
            If the assemblies disagree in one of these, or share the name of a part.
        """
        for name in ALIKE:
            ours, theirs = getattr(self, name), getattr(other, name)
            if not np.array_equal(ours, theirs):
                raise InputError(
                    f"the assemblies differ in {name}: {ours} and {theirs}",
                    hint=f"give both the same {name} before they are merged",
                )
        joined = other.renamed({name: prefix + name for name in other.names}) if prefix else other
        shared = next((name for name in joined.names if name in self.index), None)
        if shared is not None:
            raise InputError(
                f"both assemblies have a part named {shared!r}",
                hint='give a prefix: first.merged(second, prefix="second/")',
            )
        entries = (
            *("parts", "friction_pairs", "loads", "contacts", "joints", "bonds", "straps"),
            "notes",
        )
        return self._replace(
            **{name: [*getattr(self, name), *getattr(joined, name)] for name in entries}
        )

    def with_loads(self, loads: Iterable[Load]) -> Self:
        """A copy of the assembly with additional loads."""
        return self._replace(loads=[*self.loads, *loads])

    # gravity, friction, held parts, connections --------------------------------------

    def with_down(self, down: ArrayLike) -> Self:
        """A copy of the assembly with gravity turned to the direction `down`, same magnitude."""
        size = float(np.linalg.norm(self.gravity))
        return self._replace(gravity=unit(down, "down") * size, up_assumed=False)

    def with_friction(self, friction: float) -> Self:
        """A copy of the assembly with another friction coefficient.

        It applies to contacts without a coefficient of their own.
        """
        return self._replace(friction=friction)

    def with_grounded(self, patterns: str | Iterable[str]) -> Self:
        """A copy of the assembly in which the parts that match patterns are held, too."""
        chosen = self.matching(patterns)
        return self._replace(
            parts=[
                dataclasses.replace(part, grounded=True) if part.name in chosen else part
                for part in self.parts
            ]
        )

    def with_grips(self, names: Iterable[str]) -> Self:
        """A copy of the assembly in which a hand or gripper holds the given parts.

        Loads on them are left out: the grip carries them.
        """
        gripped = set(names)
        loads = [load for load in self.loads if load.part not in gripped]
        return self._replace(
            parts=[
                dataclasses.replace(part, grounded=True) if part.name in gripped else part
                for part in self.parts
            ],
            loads=loads,
        )

    def with_bonds(self, bonds: Iterable[Bond]) -> Self:
        """A copy of the assembly with additional bonds."""
        return self._replace(bonds=[*self.bonds, *bonds])

    def with_straps(self, straps: Iterable[Strap]) -> Self:
        """A copy of the assembly with additional straps."""
        return self._replace(straps=[*self.straps, *straps])

    def with_joints(self, joints: Iterable[Joint], *, notes: Iterable[str] = ()) -> Self:
        """A copy of the assembly with additional joints, and with `notes` after its own notes.

        `kilter.contact.fastened` makes the joints of bolts and other fasteners.
        """
        return self._replace(joints=[*self.joints, *joints], notes=[*self.notes, *notes])

    def without(self, patterns: str | Iterable[str]) -> Self:
        """A copy of the assembly without the matching parts and all entries that name them."""
        gone = self.matching(patterns)
        keep = [part for part in self.parts if part.name not in gone]
        if not keep:
            raise InputError("all parts are left out", hint="leave fewer parts out")

        def kept(entries: Sequence[Any]) -> list[Any]:
            """The entries (joints, loads and so on) that name none of the removed parts."""
            return [entry for entry in entries if not gone.intersection(entry.parts)]

        return self._replace(
            parts=keep,
            friction_pairs=kept(self.friction_pairs),
            contacts=kept(self.contacts),
            joints=kept(self.joints),
            bonds=kept(self.bonds),
            straps=kept(self.straps),
            loads=[load for load in self.loads if load.part not in gone],
        )

    def with_floor(self, height: float | None = None) -> Self:
        """A copy of the assembly with a held table at a height, by default under the lowest point.

        The lowest point, with respect to gravity, is that of the exact surfaces.

        Parameters
        ----------
        height : float, optional
            Height of the table's top, measured from the origin against gravity [length unit].
        """
        # imported late: few assemblies need these modules

        geometry = self.geometry
        up = -self.down
        lowest = number(height, "height of the floor") if height is not None else None
        if lowest is None:
            lowest = lowest_height(geometry, up)
        size = float(np.ptp(geometry.vertices, axis=0).max())
        middle = (geometry.vertices.min(axis=0) + geometry.vertices.max(axis=0)) / 2
        thick = THICK * size
        center = middle + up * (lowest - thick / 2 - middle @ up)
        name = FLOOR
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


# Find the lowest points of parts on their exact surfaces, not on the triangles.


AROUND = 144
"""Number of points of a circle of lowest points that are tested for lying on the face."""
SECTIONS = 36
"""Number of golden-section steps along a chord: 3e-8 of its length, so that heights are exact to
rounding."""
GOLDEN = (np.sqrt(5.0) - 1) / 2
"""Ratio of successive intervals of a golden-section search [-]."""
PRUNED = 0, 3, 6, 9
"""Golden-section steps after which edges that cannot reach the lowest known point are left out."""
LEVEL = 1e-15
"""Largest sine of the angle between the normal of a level face and the vertical [-]."""
INTERVAL = 10.0
"""Descent that is possible in an interval of a golden-section search, over the distance of its two
inner points, which is .24 of the interval [-]."""


def lowest_heights(geometry: Geometry, up: Array) -> Array:
    """Height of the lowest point of each part along an upward unit vector, shape (N,).

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Sphere
    >>> geometry = Assembly([Part("ball", Sphere(1.0))]).geometry
    >>> up = np.array([0.6, 0.0, 0.8])
    >>> float((geometry.vertices @ up).min()) > -1, lowest_heights(geometry, up).round(15)
    (True, array([-1.]))
    """
    low: Array = np.minimum.reduceat(geometry.vertices @ up, geometry.vertex_start[:-1])
    return _lowered(geometry, up, low, _longest_sides(geometry))


def lowest_height(geometry: Geometry, up: Array) -> float:
    """Height of the lowest point of all parts along an upward unit vector."""
    return float(_lowest_along(geometry, up[None], np.ones(len(geometry.mass), dtype=bool))[0])


def bounds(geometry: Geometry, chosen: Mask) -> Array:
    """Lower and upper corner of the bounding box of the chosen parts (N,), shape (2, 3)."""
    low, high = np.split(_lowest_along(geometry, np.vstack([np.eye(3), -np.eye(3)]), chosen), 2)
    return np.stack([low, -high])


def _lowest_along(geometry: Geometry, ups: Array, chosen: Mask) -> Array:
    """Height of the lowest point of the chosen parts along each upward unit vector, shape (n,).

    Changed copies of an assembly (with other held parts, joints or loads) have the same points, so
    the heights of recent assemblies with curved surfaces are kept by their content.
    """
    if not len(geometry.surfaces):
        return _found_lowest(geometry, ups, chosen)
    surfaces = geometry.surfaces
    digest = hashlib.blake2b(digest_size=16)
    for array in (
        *(geometry.vertices, geometry.vertex_start, geometry.triangles),
        *(geometry.triangle_surface, chosen, ups),
        *(getattr(surfaces, field.name) for field in dataclasses.fields(surfaces)),
    ):
        digest.update(array.tobytes())
    key = digest.digest()
    if key not in _RECENT:
        if len(_RECENT) >= RECENT_HEIGHTS:
            _RECENT.clear()
        _RECENT[key] = _found_lowest(geometry, ups, chosen)
    return _RECENT[key].copy()


RECENT_HEIGHTS = 64
"""Number of heights that are kept."""
_RECENT: dict[bytes, Array] = {}
"""Heights of recent assemblies, by a digest of their geometry, the directions and the parts."""


def _found_lowest(geometry: Geometry, ups: Array, chosen: Mask) -> Array:
    """The heights of `_lowest_along`."""
    own, side = _longest_sides(geometry)
    owner, heights = geometry.triangle_part[own], []
    reach = np.zeros(len(chosen))
    np.maximum.at(reach, owner, side)
    for up in ups:
        low = np.minimum.reduceat(geometry.vertices @ up, geometry.vertex_start[:-1])
        least = low[chosen].min()
        near = (low - (1 + BESIDE_SEAM) * reach <= least)[owner]
        low = np.where(chosen, least, -np.inf)  # no higher point matters
        heights.append(_lowered(geometry, up, low, (own[near], side[near]))[chosen].min())
    return np.array(heights)


def _longest_sides(geometry: Geometry) -> tuple[Index, Array]:
    """Triangles of the parts with curved surfaces, and the length of their longest sides."""
    own = np.flatnonzero((np.diff(geometry.surfaces.start) > 0)[geometry.triangle_part])
    x, y, z = geometry.vertices[geometry.triangles[own]].transpose(1, 0, 2)
    return own, np.maximum.reduce([lengths(y - x), lengths(z - y), lengths(x - z)])


def _lowered(geometry: Geometry, up: Array, low: Array, sides: tuple[Index, Array]) -> Array:
    """The heights (N,), lowered to the points of each part on its exact surfaces below them.

    `sides`: as `_longest_sides` returns.
    """
    if len(geometry.surfaces):
        for part, height in (_inside_faces(geometry, up, low), _on_edges(geometry, up, low, sides)):
            np.minimum.at(low, part, height)
    return low


# within faces -------------------------------------------------------------------------------


def _inside_faces(geometry: Geometry, up: Array, low: Array) -> tuple[Index, Array]:
    """Part and height of the lowest points of exact spheres and tori, if on their faces.

    `low` (N,): heights of the parts; points above them are skipped.
    """
    s = geometry.surfaces
    parts, heights = [], []
    exact = np.isin(s.kind, (SPHERE, TORUS)) & ~s.hollow & (s.doubt == 0)
    for row in np.flatnonzero(exact).tolist():
        points = _lowest_of_surface(geometry, row, up)
        if points[0] @ up >= low[s.part[row]]:
            continue
        triangles = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        grow = BESIDE_SEAM * float(s.radius[row])
        down = np.tile(-up, (len(points), 1))
        if covered(triangles, points, down, float(s.sagitta[row]), grow).any():
            parts.append(int(s.part[row]))
            heights.append(float(points[0] @ up))
    return np.array(parts, dtype=np.int64), np.array(heights)


def _lowest_of_surface(geometry: Geometry, row: int, up: Array) -> Array:
    """Lowest points of a complete sphere or torus, shape (n, 3)."""
    s = geometry.surfaces
    center, axis, radius = s.point[row], s.axis[row], float(s.radius[row])
    if s.kind[row] == SPHERE:
        return np.asarray((center - radius * up)[None])
    aside = up - (up @ axis) * axis
    sine = float(np.linalg.norm(aside))
    if sine > UPRIGHT:
        out = aside[None] / -sine
    else:
        angle = np.arange(AROUND)[:, None] * (2 * np.pi / AROUND)
        u, v = across(axis)
        out = np.cos(angle) * u + np.sin(angle) * v
    return np.asarray(center + radius * out - float(s.tube[row]) * up)


# on edges -----------------------------------------------------------------------------------


def _on_edges(
    geometry: Geometry, up: Array, low: Array, sides: tuple[Index, Array]
) -> tuple[Index, Array]:
    """Part and height of the lowest points of curved edges at exact faces.

    `low` (N,): heights of the parts; edges above them are skipped. `sides`: as `_longest_sides`.
    """
    chords, part = _chords(geometry, up, low, sides)
    if not len(part):
        return part, np.empty(0)
    s, left, right, best = geometry.surfaces, np.zeros(len(part)), np.ones(len(part)), low.copy()
    for step in range(SECTIONS):
        first, second = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
        found, known = Chords.join([chords, chords]).on_edge(np.append(first, second), s)
        p, q = np.split(found, 2)
        lower = p @ up < q @ up
        left, right = np.where(lower, left, first), np.where(lower, second, right)
        if step in PRUNED:
            heights = np.minimum(p @ up, q @ up)
            known = np.logical_and(*np.split(known, 2))
            np.minimum.at(best, part[known], heights[known])
            deep = heights - INTERVAL * lengths(q - p) <= best[part]
            rows = np.flatnonzero(deep | ~known)
            chords, part, left, right = chords.take(rows), part[rows], left[rows], right[rows]
    points, converged = chords.on_edge((left + right) / 2, s)
    return part[converged], (points @ up)[converged]


def _chords(
    geometry: Geometry, up: Array, low: Array, sides: tuple[Index, Array]
) -> tuple[Chords, Index]:
    """Chords of curved edges that may reach below the heights (N,), and their parts.

    An edge of a face that is exact and level reaches no lower than its ends.
    """
    s, label = geometry.surfaces, geometry.triangle_surface
    owner, (own, side) = geometry.triangle_part, sides
    # both triangles of an edge that may reach the heights reach them by their longest side
    lowest, _ = extents((geometry.vertices @ up)[geometry.triangles[own]])
    on_curved = own[lowest - side <= low[owner[own]] + BESIDE_SEAM * side]
    triangles = geometry.triangles[on_curved]
    first, second = shared_edges(triangles)
    both = np.column_stack([on_curved[first // 3], on_curved[second // 3]])
    rows = label[both]
    ends = triangles[first // 3, first % 3], triangles[first // 3, (first + 1) % 3]
    p, q = (geometry.vertices[end] for end in ends)
    reach = np.minimum(p @ up, q @ up) - np.linalg.norm(q - p, axis=1)
    known = ~((s.kind[rows] == FREE) | (s.doubt[rows] > 0)) | (rows < 0)
    keep = (rows[:, 0] != rows[:, 1]) & known.all(axis=1) & (reach <= low[owner[both[:, 0]]])
    corners = geometry.vertices[geometry.triangles[both[keep]]]
    normal = unit_rows(
        cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    )
    level = (rows[keep] < 0) & (np.linalg.norm(np.cross(normal, up), axis=2) <= LEVEL)
    chords = Chords(p[keep], q[keep], rows[keep], corners[:, :, 0], normal)
    kept = np.flatnonzero(~level.any(axis=1))
    return chords.take(kept), owner[both[keep, 0]][kept]


def with_fields(assembly: Copy, **changes: Any) -> Copy:
    """A copy of an assembly with other values of the given fields; it shares the geometry."""
    return assembly._replace(**changes)
