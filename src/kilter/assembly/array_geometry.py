"""Compute the geometry of many small closed meshes at once; same result as `build_geometry`.

A mesh is plain if it needs no repair: every edge has two faces in opposite senses; vertices are
distinct and used; no face has zero area; the faces point outwards; and there are too few faces to
represent a curved surface; it has a single shell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, distinct_rows, ragged, squares, starts
from kilter.assembly.assembly import Assembly
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.assembly.assembly_tolerances import FLAT_PART, INSIDE_OUT, LARGEST, RESOLVED
from kilter.assembly.geometry import Geometry, build_geometry
from kilter.assembly.hexahedra import box_moments, box_orders, closed_octets
from kilter.assembly.mesh_surface import DEFAULT_DENSITY, UnknownSurfaces, polyhedron_moments
from kilter.assembly.part import Part
from kilter.assembly.surfaces import FEWEST, join_surfaces
from kilter.shape.closed import flat_faces
from kilter.shape.nested_shells import count_shells
from kilter.shape.primitives import Mesh
from kilter.units import metres_per_unit

# SideBySide: many small assemblies as one, so that they are computed together.


@dataclass(frozen=True, slots=True, eq=False)
class SideBySide:
    """M independent assemblies as a single list of parts, all planar or none, in the same unit."""

    whole: Assembly
    """All parts, without friction. Names may repeat, and its gravity has no meaning."""
    start: Index
    """The first part of each assembly, followed by the number of parts, shape (M + 1,)."""
    gravity: Array
    """Acceleration of gravity of each assembly [m/s^2], shape (M, 3)."""

    def __len__(self) -> int:
        return len(self.gravity)

    @property
    def owner(self) -> Index:
        """Index of the assembly to which each part belongs, shape (N,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))


def side_by_side(assemblies: Sequence[Assembly]) -> SideBySide:
    """Join independent assemblies without given contacts, joints or loads, to search them at once.

    Raises `InputError` if the geometry of a part is invalid.
    """
    parts = [part for assembly in assemblies for part in assembly.parts]
    units = assemblies[0].units
    return join_geometry(
        parts,
        build_geometry(parts, units),
        starts([len(assembly) for assembly in assemblies]),
        np.array([assembly.gravity for assembly in assemblies]),
        units=units,
        planar=assemblies[0].planar,
    )


def join_geometry(
    parts: Sequence[Part],
    geometry: Geometry,
    start: Index,
    gravity: Array,
    *,
    units: str = "m",
    planar: bool = False,
) -> SideBySide:
    """Join independent assemblies whose geometry is already computed.

    Arguments: `start` (M + 1,): first part of each assembly, followed by the number of parts;
    `gravity` (M, 3): acceleration of gravity of each assembly [m/s^2].
    """
    whole = object.__new__(Assembly)  # the constructor would reject repeated names
    fields = {
        "parts": tuple(parts),
        "units": units,
        "gravity": gravity[0],
        "friction": 0.0,
        **dict.fromkeys(("friction_pairs", "loads", "contacts", "joints", "bonds", "straps"), ()),
        "notes": (),
        "planar": planar,
        "detect": True,
        "source": "",
        "geometry": geometry,
    }
    whole.__dict__.update(fields)
    return SideBySide(whole, start, gravity)


HUGE = 1e100
"""Assemblies with a density or gravity above this, or below its inverse, are read one by one, and
rejected there."""
PROJECTION = 2.0**0.5, 3.0**0.5
"""Weights of y and z in a sum of coordinates that is seldom equal for different vertices."""
SOME_MESH = Part("part", Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2]]))
"""Placeholder for every part; only the type of its shape matters."""


def arrays_side_by_side(arrays: AssemblyArrays) -> tuple[SideBySide | None, Index]:
    """Join the assemblies of a batch with only plain meshes; also return their indices.

    A mesh is plain if it needs no repair.

    Returns `joined`: None if no assembly has only plain meshes; `which`: positions of these
    assemblies.
    """
    with np.errstate(all="ignore"):
        chosen, ordered = arrays, _boxes_in_order(arrays)
        which = np.flatnonzero(_usable(arrays, ordered[2]))
        while len(which):
            if len(which) < len(chosen):
                chosen = arrays.among(which)
                ordered = _boxes_in_order(chosen)
            geometry, sound = _geometry(chosen, *ordered)
            sound = np.logical_and.reduceat(sound, chosen.part_start[:-1])
            if sound.all():
                parts = (SOME_MESH,) * len(chosen.held)
                start, units = chosen.part_start, chosen.units
                return join_geometry(parts, geometry, start, chosen.gravity, units=units), which
            which = which[sound]
    return None, which


def _usable(arrays: AssemblyArrays, is_box: Mask) -> Mask:
    """Mask of assemblies with plain meshes only, a held part, and valid gravity, shape (M,).

    `is_box` marks the parts that are known to be boxes, shape (N,).
    """
    size = np.abs(arrays.gravity).max(axis=1)
    usable = (size > 1 / HUGE) & (size < HUGE)
    usable &= np.logical_or.reduceat(arrays.held, arrays.part_start[:-1])
    plain = is_box if is_box.all() else _plain(arrays) | is_box
    usable &= np.logical_and.reduceat(plain, arrays.part_start[:-1])
    result: Mask = usable
    return result


def _plain(arrays: AssemblyArrays) -> Mask:
    """Mask of parts whose mesh is plain: closed, welded and without repeated faces, shape (N,)."""
    vertices, faces = arrays.vertices, arrays.faces
    part = np.repeat(np.arange(len(arrays.held)), np.diff(arrays.face_start))
    low, high = arrays.vertex_start[part][:, None], arrays.vertex_start[part + 1][:, None]
    inside = ((faces >= low) & (faces < high)).all(axis=1)
    faces = np.where(inside[:, None], faces, low)
    flat = flat_faces(vertices.astype(np.float64), faces)
    bad = part[flat | ~(inside & _is_matched(faces, len(vertices)))]
    used = np.zeros(len(vertices), dtype=bool)
    used[faces.ravel()] = True
    fine = used & np.isfinite(vertices).all(axis=1) & _is_distinct(vertices, arrays.vertex_start)
    plain = np.logical_and.reduceat(fine, arrays.vertex_start[:-1])
    plain &= np.diff(arrays.face_start) < FEWEST
    plain[bad] = False
    plain &= count_shells(faces, arrays.vertex_start) == 1
    result: Mask = plain
    return result


def _is_matched(faces: Index, count: int) -> Mask:
    """Mask of faces whose every edge borders exactly one other face, shape (F,).

    `count`: the number of vertices.
    """
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    forward, back = start * count + end, np.sort(end * count + start)
    ordered = np.sort(forward)
    once = not len(ordered) or bool((np.diff(ordered) > 0).all())
    if once and np.array_equal(ordered, back):
        return np.ones(len(faces), dtype=bool)
    runs = np.searchsorted(ordered, forward, side="right") - np.searchsorted(ordered, forward)
    opposite = np.searchsorted(back, forward, side="right") - np.searchsorted(back, forward)
    result: Mask = ((runs == 1) & (opposite == 1)).reshape(-1, 3).all(axis=1)
    return result


def _is_distinct(vertices: Array, start: Index) -> Mask:
    """Mask of vertices at a place that no other vertex of the part has, shape (V,)."""
    count = np.diff(start)
    distinct = np.ones(len(vertices), dtype=bool)
    suspects = np.ones(len(count), dtype=bool)
    eights = np.flatnonzero(count == 8)
    if len(eights):
        # equal vertices have equal sums of coordinates: a quick test for boxes, the usual parts
        x, y, z = vertices.T
        sums = (x + PROJECTION[0] * y + PROJECTION[1] * z)[start[eights][:, None] + np.arange(8)]
        sums.sort(axis=1)
        suspects[eights] = (np.diff(sums, axis=1) == 0).any(axis=1)
    part, rows = ragged(start, np.flatnonzero(suspects))
    _, inverse = distinct_rows(np.column_stack([part, vertices[rows]]))
    distinct[rows] = np.bincount(inverse)[inverse] == 1
    return distinct


def _boxes_in_order(arrays: AssemblyArrays) -> tuple[Array, Index, Mask]:
    """Find the parts that are boxes, and bring the corners of each into standard order.

    A box is a plain mesh: its triangles lie in its sides and form a closed surface.

    Returns `vertices, faces` (V, 3): those of the arrays, with the corners of boxes in the order of
    `BOX_CORNERS`; `is_box` (N,).
    """
    vertices, faces = arrays.vertices.astype(np.float64), arrays.faces
    first = arrays.vertex_start[:-1]
    is_box = (np.diff(arrays.vertex_start) == 8) & (np.diff(arrays.face_start) == 12)
    candidates = np.flatnonzero(is_box)
    face_rows = arrays.face_start[candidates][:, None] + np.arange(12)
    local = faces[face_rows] - first[candidates][:, None, None]
    is_closed = closed_octets(local)
    is_box[candidates] = is_closed
    candidates, local = candidates[is_closed], local[is_closed]
    rows = first[candidates][:, None] + np.arange(8)
    order, confirmed = box_orders(vertices[rows], local, _accuracy(arrays)[candidates])
    is_box[candidates] = confirmed
    source = np.arange(len(vertices))
    source[rows[confirmed]] = first[candidates[confirmed]][:, None] + order[confirmed]
    place = np.empty_like(source)
    place[source] = np.arange(len(source))
    return vertices[source], place[faces], is_box


def _moments(
    arrays: AssemblyArrays, vertices: Array, faces: Index, is_box: Mask
) -> tuple[Array, Array, Array, Array]:
    """Volume, centroid, second moment and surface centroid of each part.

    The result is that of `polyhedron_moments`.
    """
    count = len(is_box)
    volume, center, second = np.empty(count), np.empty((count, 3)), np.empty((count, 3, 3))
    corners = vertices[arrays.vertex_start[:-1][is_box][:, None] + np.arange(8)]
    volume[is_box], center[is_box], second[is_box] = box_moments(corners)
    middle, others = center.copy(), np.flatnonzero(~is_box)
    if len(others):
        _, rows = ragged(arrays.face_start, others)
        start = starts(np.diff(arrays.face_start)[others])
        moments = polyhedron_moments(vertices, faces[rows], start)
        volume[others], center[others], second[others], middle[others] = moments
    # a box whose faces point inwards has a negative volume, as for other meshes
    first = faces[arrays.face_start[:-1][is_box]]
    p, q, r = (vertices[first[:, k]] for k in range(3))
    inwards = np.einsum("ni,ni->n", cross(q - p, r - p), p - center[is_box]) < 0
    volume[np.flatnonzero(is_box)[inwards]] *= -1
    return volume, center, second, middle


def _largest_coordinate(vertices: Array) -> Array:
    """Largest absolute coordinate of each vertex, shape (V,); by columns, which is faster."""
    x, y, z = np.abs(vertices).T
    largest: Array = np.maximum(np.maximum(x, y), z)
    return largest


def _accuracy(arrays: AssemblyArrays) -> Array:
    """Largest error of a coordinate of each part [length unit], shape (N,)."""
    size = _largest_coordinate(arrays.vertices).astype(np.float64)
    single = arrays.vertices.dtype == np.float32
    largest = np.maximum.reduceat(size, arrays.vertex_start[:-1])
    accuracy: Array = largest * (2.0**-24 if single else 2.0**-52)
    return accuracy


def _farthest(arrays: AssemblyArrays, vertices: Array, points: Array) -> Array:
    """Largest distance of a vertex of each part from the part's row of `points`, shape (N,)."""
    owner = np.repeat(np.arange(len(points)), np.diff(arrays.vertex_start))
    distance: Array = np.sqrt(
        np.maximum.reduceat(squares(vertices - points[owner]), arrays.vertex_start[:-1])
    )
    return distance


def _geometry(
    arrays: AssemblyArrays, vertices: Array, faces: Index, is_box: Mask
) -> tuple[Geometry, Mask]:
    """Geometry of plain meshes, and a mask of parts that pass the checks of `build_geometry`."""
    first, count = arrays.vertex_start[:-1], len(arrays.held)
    volume, center, second, middle = _moments(arrays, vertices, faces, is_box)
    reach = _farthest(arrays, vertices, middle)
    sound = (reach > 1 / LARGEST) & (reach < LARGEST) & (volume > FLAT_PART * reach**3)
    sound &= reach >= RESOLVED * np.maximum.reduceat(_largest_coordinate(vertices), first)
    others = np.flatnonzero(~is_box)
    spread = np.linalg.eigvalsh(np.where(np.isfinite(second), second, 0.0)[others])
    sound[others] &= spread[:, 0] >= -INSIDE_OUT * np.abs(spread).max(axis=1, initial=0.0)
    density = np.full(count, DEFAULT_DENSITY) if arrays.density is None else arrays.density
    sound &= (density > 1 / HUGE) & (density < HUGE)
    mass = density * (volume * metres_per_unit(arrays.units) ** 3)
    second = second * (mass / volume)[:, None, None]
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    accuracy = _accuracy(arrays)
    poses = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))
    surfaces, label = join_surfaces({}, *poses, vertices, faces, arrays.face_start)
    geometry = Geometry(
        vertices=vertices,
        vertex_start=arrays.vertex_start,
        triangles=faces,
        triangle_start=arrays.face_start,
        grounded=arrays.held,
        mass=mass,
        center=center,
        inertia=inertia,
        volume=volume,
        radius=reach if is_box.all() else _farthest(arrays, vertices, center),
        size=2 * reach,
        accuracy=accuracy,
        single=np.full(count, arrays.vertices.dtype == np.float32),
        is_box=is_box,
        surfaces=surfaces,
        triangle_surface=label,
        triangle_piece=np.zeros(len(label), dtype=np.int64),
        slack=np.zeros(count),
        warnings=(),
        unknown=UnknownSurfaces.none(),
    )
    return geometry, sound
