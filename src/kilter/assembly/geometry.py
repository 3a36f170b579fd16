"""Geometry and mass properties of the parts of an assembly, as arrays with one row per part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, extents, read_only, starts, unit_rows
from kilter.assembly.assembly_tolerances import FLAT_PART, INSIDE_OUT, LARGEST, RESOLVED
from kilter.assembly.mesh_surface import (
    MeshSurface,
    UnknownSurfaces,
    box_sizes,
    closed_moments,
    mesh_surfaces,
    part_masses,
    part_moments,
    unknown_surfaces,
)
from kilter.assembly.part import Part, inertia_numbers
from kilter.assembly.surfaces import FREE, Chords, Surfaces, join_surfaces, surfaces_of
from kilter.errors import InputError, some_names
from kilter.rigid import Pose, quaternion_to_matrix
from kilter.shape.closed import shared_edges
from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES, Box, Mesh, Prism, surface
from kilter.shape.solid import Solid


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """Geometry and mass properties of N parts as arrays, world frame."""

    vertices: Array
    """Vertices of all parts [length unit], shape (V, 3); those of part i are rows
    ``vertex_start[i]`` to ``vertex_start[i + 1]``."""
    vertex_start: Index
    """Shape (N + 1,)."""
    triangles: Index
    """Rows of `vertices`, counterclockwise seen from outside; the triangles of part i are rows
    ``triangle_start[i]`` to ``triangle_start[i + 1]``, shape (T, 3)."""
    triangle_start: Index
    """Shape (N + 1,)."""
    grounded: Mask
    """Whether each part is held, shape (N,)."""
    mass: Array
    """Masses [kg], shape (N,)."""
    center: Array
    """Centres of mass [length unit], shape (N, 3)."""
    inertia: Array
    """Inertia about the centre of mass, world axes [kg x length unit^2], shape (N, 3, 3)."""
    volume: Array
    """Volumes [length unit^3], shape (N,)."""
    radius: Array
    """Largest distance of a vertex from the centre of mass [length unit], shape (N,)."""
    size: Array
    """Twice the largest distance of a vertex from the centroid of the surface [length unit],
    shape (N,). The tolerances of a part are relative to this length; it does not depend on the
    pose."""
    accuracy: Array
    """Largest error of a coordinate [length unit], shape (N,)."""
    single: Mask
    """Whether the coordinates are coarser than float64, shape (N,)."""
    is_box: Mask
    """Whether the vertices of a part are the eight corners of a box, in order, shape (N,)."""
    surfaces: Surfaces
    """The exact curved surfaces of all parts, ordered by part."""
    triangle_surface: Index
    """Row of `surfaces` that each triangle approximates; -1 if the triangle itself is exact,
    shape (T,)."""
    triangle_piece: Index
    """Piece of its part to which each triangle belongs (`Mesh.pieces`), shape (T,)."""
    slack: Array
    """Largest distance of the true surface of a part from its triangles [length unit], shape
    (N,)."""
    warnings: tuple[str, ...]
    unknown: UnknownSurfaces
    """Regions of unknown surface: at holes of open meshes, and all over stand-ins."""
    shapes: tuple[Any, ...] = ()
    """The shape of each part; empty if unknown. Parts with the same object are copies."""

    def __post_init__(self) -> None:
        read_only(self)

    def __repr__(self) -> str:
        return f"<Geometry: {len(self.mass)} parts, {len(self.triangles)} triangles>"

    @property
    def vertex_part(self) -> Index:
        """Index of the part to which each vertex belongs, shape (V,)."""
        return np.repeat(np.arange(len(self.mass)), np.diff(self.vertex_start))

    @property
    def triangle_part(self) -> Index:
        """Index of the part to which each triangle belongs, shape (T,)."""
        return np.repeat(np.arange(len(self.mass)), np.diff(self.triangle_start))

    @property
    def part_boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the bounding boxes of the parts, each of shape (N, 3)."""
        first = self.vertex_start[:-1]
        low: Array = np.minimum.reduceat(self.vertices, first)
        high: Array = np.maximum.reduceat(self.vertices, first)
        return low, high

    def corners_of(self, part: int) -> Array:
        """Corner positions of the triangles of a part, shape (m, 3, 3)."""
        span = slice(self.triangle_start[part], self.triangle_start[part + 1])
        return self.vertices[self.triangles[span]]

    def slack_of(self, part: int) -> Array:
        """Distance of each triangle of a part from its true surface [length unit], shape (m,)."""
        span = slice(self.triangle_start[part], self.triangle_start[part + 1])
        return np.append(self.surfaces.sagitta, 0.0)[self.triangle_surface[span]]


def build_geometry(parts: Sequence[Part], units: str = "m") -> Geometry:
    """Compute the geometry of parts, with lengths in `units`.

    Raises `InputError` if a mesh is flat, empty, self-intersecting or out of range; the error names
    the part.
    """
    boxes = np.array([isinstance(part.shape, Box) for part in parts])
    warnings: list[str] = []
    meshes: dict[int, MeshSurface] = {}
    if any(isinstance(part.shape, Mesh) for part in parts):
        meshes = mesh_surfaces(parts, warnings)
    local = _local_surfaces(parts, boxes, meshes)
    vertices, vertex_start, triangles, triangle_start = local

    rotation = quaternion_to_matrix(np.array([part.pose.rotation for part in parts]))
    position = np.array([part.pose.position for part in parts])
    owner = np.repeat(np.arange(len(parts)), np.diff(vertex_start))

    volume, center, second, area_center = part_moments(parts, boxes, local)
    _set_closed_moments(meshes, (volume, center, second))
    if (volume < 0).any():
        warnings.append(_turn_outwards(parts, volume, second, triangles, triangle_start))
    reach = _group_max(np.linalg.norm(vertices - area_center[owner], axis=1), vertex_start)
    sheets = np.array([k for k, mesh in meshes.items() if not mesh.small], dtype=np.int64)
    volume[sheets], center[sheets] = reach[sheets] ** 3, area_center[sheets]
    second[sheets] = (reach[sheets] ** 5 / 5)[:, None, None] * np.eye(3)
    _require_solid(parts, reach, volume)
    _require_positive_moments(parts, boxes, second)
    mass, center, second = part_masses(parts, units, (volume, center, second), warnings)

    world = np.einsum("nij,nj->ni", rotation[owner], vertices) + position[owner]
    world_center = np.einsum("nij,nj->ni", rotation, center) + position
    moment = np.einsum("nij,njk,nlk->nil", rotation, second, rotation)
    inertia = np.trace(moment, axis1=1, axis2=2)[:, None, None] * np.eye(3) - moment
    largest = _group_max(np.abs(world).max(axis=1), vertex_start)
    _require_resolved(parts, reach, largest)
    shapes = tuple(part.shape for part in parts)
    stated = [shape.accuracy if isinstance(shape, Mesh | Solid) else 0.0 for shape in shapes]
    accuracy = np.maximum(np.array(stated), largest * 2.0**-52)
    surfaces, triangle_surface = _curved_surfaces(
        parts, boxes, (vertices, triangles, world), local, (rotation, position)
    )
    return Geometry(
        vertices=world,
        vertex_start=vertex_start,
        triangles=triangles,
        triangle_start=triangle_start,
        grounded=np.array([part.grounded for part in parts]),
        mass=mass,
        center=world_center,
        inertia=inertia,
        volume=volume,
        radius=_group_max(np.linalg.norm(world - world_center[owner], axis=1), vertex_start),
        size=2 * reach,
        accuracy=accuracy,
        single=accuracy > largest * 2.0**-40,
        is_box=boxes,
        surfaces=surfaces,
        triangle_surface=triangle_surface,
        triangle_piece=_triangle_pieces(parts, meshes, triangle_start),
        slack=_group_slack(len(parts), surfaces),
        warnings=tuple(warnings),
        unknown=_unknown_of(parts, meshes, (rotation, position)),
        shapes=shapes,
    )


def _unknown_of(
    parts: Sequence[Part], meshes: dict[int, MeshSurface], poses: tuple[Array, Array]
) -> UnknownSurfaces:
    """The surfaces of unknown form, which only meshes and solids have."""
    if meshes or any(isinstance(part.shape, Solid) for part in parts):
        return unknown_surfaces(parts, meshes, poses)
    return UnknownSurfaces.none()


def _group_slack(count: int, surfaces: Surfaces) -> Array:
    """Largest distance between triangles and curved surface of each part, shape (N,)."""
    slack = np.zeros(count)
    np.maximum.at(slack, surfaces.part, surfaces.sagitta)
    return slack


def _turn_outwards(
    parts: Sequence[Part], volume: Array, second: Array, triangles: Index, start: Index
) -> str:
    """Reverse, in place, the surfaces whose volume is negative; return the warning about them."""
    flipped = np.flatnonzero(volume < 0)
    for k in flipped:
        span = slice(start[k], start[k + 1])
        triangles[span] = triangles[span, ::-1]
    volume[flipped] *= -1
    second[flipped] *= -1
    turned = some_names([parts[k].name for k in flipped.tolist()])
    return f"the faces pointed inwards and were reversed: {turned}"


def _require_solid(parts: Sequence[Part], reach: Array, volume: Array) -> None:
    """Raise an InputError if the size of a part is out of range, or the part is flat."""
    extreme = np.flatnonzero(~((reach > 1 / LARGEST) & (reach < LARGEST)))
    if len(extreme):
        raise InputError(
            f"its size is {2 * reach[extreme[0]]:.3g}, which is out of range",
            part=parts[int(extreme[0])].name,
            hint="check its units: the range is 1e-30 to 1e30",
        )
    flat = np.flatnonzero(~(volume > FLAT_PART * reach**3))
    if len(flat):
        raise InputError(
            f"the part is flat, its volume is {volume[flat[0]]:.3g}",
            part=parts[flat[0]].name,
            hint="give a closed solid",
        )


def _require_resolved(parts: Sequence[Part], reach: Array, largest: Array) -> None:
    """Raise an InputError if a part is too far from the origin to resolve its corners."""
    lost = np.flatnonzero(reach < RESOLVED * largest)
    if len(lost):
        size, off = 2 * reach[lost[0]], largest[lost[0]]
        raise InputError(
            f"its size is {size:.3g}, too small to resolve its corners at the distance {off:.3g} "
            "from the origin",
            part=parts[int(lost[0])].name,
            hint="check its units, or move the assembly to the origin",
        )


def _require_positive_moments(parts: Sequence[Part], boxes: Mask, second: Array) -> None:
    """Raise an InputError if the second moment of a part has a negative eigenvalue.

    The second moment of a body is an integral of squares. A negative eigenvalue means that the
    surface intersects itself and encloses regions of negative volume.
    """
    solid = np.flatnonzero(~boxes)
    spread = np.linalg.eigvalsh(second[solid])
    wrong = solid[spread[:, 0] < -INSIDE_OUT * np.abs(spread).max(axis=1)]
    if len(wrong):
        raise InputError(
            "its faces intersect each other and enclose a negative volume",
            part=parts[int(wrong[0])].name,
            hint="repair it in the program that made it",
        )


def _local_surfaces(
    parts: Sequence[Part], boxes: Mask, meshes: dict[int, MeshSurface]
) -> tuple[Array, Index, Index, Index]:
    """Meshes of all parts in their own frames: vertices, triangles, and starts of each part.

    Returns `vertices` (V, 3); `vertex_start` (N + 1,); `triangles` (T, 3); `triangle_start` (N +
    1,).
    """
    others = {
        k: (meshes[k].vertices, meshes[k].triangles) if k in meshes else surface(parts[k].shape)
        for k in np.flatnonzero(~boxes).tolist()
    }
    corner_count = np.full(len(parts), 8)
    triangle_count = np.full(len(parts), 12)
    for k, (vertices, triangles) in others.items():
        corner_count[k], triangle_count[k] = len(vertices), len(triangles)
    vertex_start, triangle_start = starts(corner_count), starts(triangle_count)

    all_vertices = np.empty((vertex_start[-1], 3))
    all_triangles = np.empty((triangle_start[-1], 3), dtype=np.int64)
    if boxes.any():
        box_parts = np.flatnonzero(boxes)
        sizes = box_sizes(parts, box_parts)
        rows = vertex_start[box_parts][:, None] + np.arange(8)
        all_vertices[rows] = BOX_CORNERS * sizes[:, None, :]
        rows = triangle_start[box_parts][:, None] + np.arange(12)
        all_triangles[rows] = BOX_TRIANGLES + vertex_start[box_parts][:, None, None]
    for k, (vertices, triangles) in others.items():
        all_vertices[vertex_start[k] : vertex_start[k + 1]] = vertices
        all_triangles[triangle_start[k] : triangle_start[k + 1]] = triangles + vertex_start[k]
    return all_vertices, vertex_start, all_triangles, triangle_start


def _triangle_pieces(
    parts: Sequence[Part], meshes: dict[int, MeshSurface], triangle_start: Index
) -> Index:
    """Piece of each triangle of all parts; a repaired mesh has that of the nearest given triangle.

    Repair drops triangles and moves corners by rounding only.
    """
    piece = np.zeros(triangle_start[-1], dtype=np.int64)
    for k, repaired in meshes.items():
        mesh = parts[k].shape
        if not isinstance(mesh, Mesh) or mesh.pieces is None:
            continue
        rows: Index | slice = slice(None)
        if len(repaired.triangles) != len(mesh.triangles):
            # imported late: few meshes with pieces need repair
            from scipy.spatial import cKDTree

            middle = mesh.vertices[mesh.triangles].mean(axis=1)
            rows = cKDTree(middle).query(repaired.vertices[repaired.triangles].mean(axis=1))[1]
        piece[triangle_start[k] : triangle_start[k + 1]] = mesh.pieces[rows]
    return piece


def _set_closed_moments(
    meshes: dict[int, MeshSurface], moments: tuple[Array, Array, Array]
) -> None:
    """Replace the moments of open meshes, in place, by those after closing their holes.

    A mesh with large holes encloses no plausible volume: its volume becomes 1, so that its faces
    are not reversed.
    """
    volume, center, second = moments
    for k, mesh in meshes.items():
        if not mesh.small:
            volume[k] = 1.0
        elif len(mesh.caps):
            volume[k], center[k], second[k] = closed_moments(mesh)


def _curved_surfaces(
    parts: Sequence[Part],
    boxes: Mask,
    corners: tuple[Array, Index, Array],
    local: tuple[Array, Index, Index, Index],
    poses: tuple[Array, Array],
) -> tuple[Surfaces, Index]:
    """Curved surfaces of all parts, and the surface on which each triangle lies.

    Arguments: `boxes` (N,); `corners`: vertices in the frames of the parts, triangles, vertices in
    the world frame.
    """
    (vertices, triangles, world), (_, first, _, start) = corners, local
    by_part = {}
    for k in np.flatnonzero(~boxes).tolist():
        shape = parts[k].shape
        if isinstance(shape, Prism):
            continue
        corner_rows = vertices[first[k] : first[k + 1]]
        faces = triangles[start[k] : start[k + 1]] - first[k]
        accuracy = shape.accuracy if isinstance(shape, Mesh | Solid) else 0.0
        curved = surfaces_of(shape, corner_rows, faces, accuracy)
        if curved is not None:
            by_part[k] = curved
    return join_surfaces(by_part, *poses, world, triangles, start)


def _group_max(values: Array, start: Index) -> Array:
    """Largest value of each group of consecutive rows; group k begins at ``start[k]``."""
    result: Array = np.maximum.reduceat(values, start[:-1])
    return result


def mass_of(part: Part) -> float:
    """Mass of a part from its density and the volume of its shape [kg].

    Raises
    ------
    InputError
        If the shape does not enclose a volume, as `build_geometry`.
    """
    return float(build_geometry([part], part.units).mass[0])


# Mass, centre of mass and inertia of bodies that a file states in several pieces.


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    """Mass [kg], centre [length unit], and inertia about it [kg x length unit^2], in one frame."""

    mass: float
    center: Array
    """Shape (3,)."""
    inertia: Array
    """Shape (3, 3)."""

    @classmethod
    def of_part(cls, part: Part) -> Self:
        """The mass properties of a part, world frame; those of its shape if none are given."""
        geometry = build_geometry([part], part.units)
        return cls(float(geometry.mass[0]), geometry.center[0], geometry.inertia[0])

    @classmethod
    def sum(cls, pieces: Sequence[MassProperties]) -> Self:
        """The mass properties of rigidly joined pieces, in their common frame.

        Examples
        --------
        >>> ends = [MassProperties(1.0, np.array([x, 0, 0]), np.zeros((3, 3))) for x in (-1, 1)]
        >>> MassProperties.sum(ends).inertia.diagonal().tolist()
        [0.0, 2.0, 2.0]
        """
        mass = np.array([piece.mass for piece in pieces])
        centers = np.array([piece.center for piece in pieces])
        center = mass @ centers / mass.sum()
        inertia = sum((piece.inertia for piece in pieces), _steiner(mass, centers - center))
        return cls(float(mass.sum()), center, inertia)

    def about(self, center: Array) -> MassProperties:
        """The same mass with its moments about another point, which becomes the centre of mass."""
        return MassProperties(
            self.mass, center, self.inertia + _steiner(np.array([self.mass]), center - self.center)
        )

    def outside(self, pose: Pose) -> MassProperties:
        """The same body in the frame outside of `pose`, whose inner frame it is given in."""
        turn = pose.matrix
        return MassProperties(self.mass, pose.apply([self.center])[0], turn @ self.inertia @ turn.T)

    def fields(self, pose: Pose) -> dict[str, Any]:
        """Mass, centre of mass and inertia as fields of a part with this pose."""
        own = self.outside(pose.inverse())
        return {
            "mass": own.mass,
            "center_of_mass": own.center,
            "inertia": inertia_numbers((own.inertia + own.inertia.T) / 2),
        }


def _steiner(mass: Array, arms: Array) -> Array:
    """Inertia of point masses at `arms` about the origin, shape (3, 3)."""
    second = np.einsum("n,ni,nj->ij", mass, np.atleast_2d(arms), np.atleast_2d(arms))
    inertia: Array = np.trace(second) * np.eye(3) - second
    return inertia


# Refine the triangles of a part, with new corners on its exact surfaces.


def refine(
    geometry: Geometry, part: int, rounds: int, box: tuple[Array, Array]
) -> tuple[Array, Index]:
    """Divide the triangles of a part within a box into smaller ones on the true surface.

    Arguments: `box` (3,): lower and upper corner, world frame; sides whose bounding box overlaps it
    are divided. Returns `vertices` (n, 3): world frame; `triangles` (m, 3).

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Sphere
    >>> geometry = Assembly([Part("ball", Sphere(2.0))]).geometry
    >>> whole = np.full(3, -2.0), np.full(3, 2.0)
    >>> vertices, triangles = refine(geometry, 0, 1, whole)
    >>> len(triangles) == 4 * len(geometry.triangles)
    True
    >>> np.allclose(np.linalg.norm(vertices, axis=1), 2.0)
    True
    """
    s = geometry.surfaces
    first, last = geometry.vertex_start[part], geometry.vertex_start[part + 1]
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    vertices, triangles = geometry.vertices[first:last], geometry.triangles[span] - first
    label = geometry.triangle_surface[span]
    if len(s):
        known = (s.kind[label] != FREE) & (s.doubt[label] == 0)
        label = np.where(known, label, -1)
    for _ in range(rounds):
        vertices, triangles, label = _refine_once(s, vertices, triangles, label, box)
    return vertices, triangles


def _refine_once(
    s: Surfaces, vertices: Array, triangles: Index, label: Index, box: tuple[Array, Array]
) -> tuple[Array, Index, Index]:
    """Divide triangles within a box once; returns vertices, triangles, and surface labels."""
    low, high = extents(vertices[triangles])
    rows = np.flatnonzero((low <= box[1]).all(axis=1) & (high >= box[0]).all(axis=1))
    within = triangles[rows]
    first, second = shared_edges(within)
    ends = np.stack([within, within[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    p, q = vertices[ends[first]].transpose(1, 0, 2)
    near = (np.minimum(p, q) <= box[1]).all(axis=1) & (np.maximum(p, q) >= box[0]).all(axis=1)
    first, second, p, q = first[near], second[near], p[near], q[near]
    middle = _middles(s, vertices[within], label[rows], (first // 3, second // 3), (p, q))
    new = np.full(len(ends), -1)
    new[first] = new[second] = len(vertices) + np.arange(len(first))
    at = np.full(triangles.shape, -1)
    at[rows] = new.reshape(-1, 3)
    pieces, source = _divide(triangles, at)
    return np.concatenate([vertices, middle]), pieces, label[source]


def _middles(
    s: Surfaces, corner: Array, label: Index, sides: tuple[Index, Index], ends: tuple[Array, Array]
) -> Array:
    """New corners at the middles of triangle sides, moved to the true surfaces, shape (n, 3).

    Arguments: `corner` (m, 3, 3): corners of the triangles; `label` (m,): surface of each triangle,
    or -1; `sides` (n,): the two triangles at each side; `ends` (n, 3): ends of the sides.
    """
    normal = unit_rows(cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
    both, (p, q) = np.column_stack(sides), ends
    on, middle = label[both], (p + q) / 2
    bent = np.flatnonzero(on[:, 0] != on[:, 1])
    both = both[bent]
    chords = Chords(p[bent], q[bent], on[bent], corner[both, 0], normal[both])
    points, converged = chords.on_edge(np.full(len(bent), 0.5), s)
    middle[bent[converged]] = points[converged]
    same = np.flatnonzero((on[:, 0] == on[:, 1]) & (on[:, 0] >= 0))
    rows, at = on[same, 0], middle[same]
    middle[same] = at - s.distance(rows, at)[:, None] * s.outward(rows, at)
    return middle


def _divide(triangles: Index, at: Index) -> tuple[Index, Index]:
    """Divide triangles at the new corners on their sides (`at`, -1: none).

    Arguments: `triangles` (m, 3); `at` (m, 3): new corner on each side, from corner k to corner k +
    1, or -1. Returns `pieces` (n, 3); `source` (n,): the triangle that each piece is from.
    """
    count = (at >= 0).sum(axis=1)
    rows = np.arange(len(triangles))
    # rotate the corners so that the divided sides come first
    first = np.where(count == 1, (at >= 0).argmax(axis=1), 0)
    first = np.where(count == 2, ((at < 0).argmax(axis=1) + 1) % 3, first)
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turn, axis=1).T
    p, q, r = np.take_along_axis(at, turn, axis=1).T
    cuts = {
        0: [(a, b, c)],
        1: [(a, p, c), (p, b, c)],
        2: [(a, p, c), (p, q, c), (p, b, q)],
        3: [(a, p, r), (p, b, q), (r, q, c), (p, q, r)],
    }
    pieces = [np.column_stack(t)[count == n] for n, cut in cuts.items() for t in cut]
    source = [rows[count == n] for n, cut in cuts.items() for _ in cut]
    return np.concatenate(pieces), np.concatenate(source)
