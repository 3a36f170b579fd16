"""Prepare the surface of a mesh part: weld and orient it, and close it for volume and moments.

    closed                 accepted; several shells are hollows, united, or turned, with a warning
    inconsistent winding   accepted, the faces are reoriented, with a warning
    open, part held        accepted with a warning: a held part needs surfaces, but no volume
    open, small holes      accepted with a warning; its volume is that of the closed mesh
    open, large holes      accepted with a warning if mass and centre are given
    otherwise              replaced by its convex hull, with a warning; its contacts are open

Volume and moments of a mesh with small holes are those of its closure: every connected group of
open edges is joined to its mean point. The true shape of the missing faces is unknown.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    columns,
    connected,
    cross,
    ragged,
    read_only,
    starts,
)
from kilter.assembly.assembly_tolerances import SMALL_HOLES
from kilter.assembly.part import Part, inertia_matrix
from kilter.errors import InputError, some_names
from kilter.shape.closed import is_evenly_paired, open_edges, orient_faces, weld, weld_valid_meshes
from kilter.shape.nested_shells import body_of_shells, count_shells
from kilter.shape.primitives import Box, Cylinder, Mesh, Sphere, hull_surface
from kilter.shape.solid import Solid
from kilter.units import metres_per_unit


@dataclass(frozen=True, slots=True, eq=False)
class MeshSurface:
    """Vertices and triangles of a mesh after repair, and triangles that close its holes."""

    vertices: Array
    """Shape (V, 3)."""
    triangles: Index
    """Shape (T, 3)."""
    caps: Array
    """Corners of the triangles that close the holes, shape (C, 3, 3); empty for a closed mesh."""
    holes: tuple[tuple[Array, Array], ...] = ()
    """Lower and upper corner of the bounding box of each hole."""
    small: bool = True
    """Whether the caps are small against the surface, so that the closed volume is plausible."""
    stand_in: bool = False
    """Whether the surface is the convex hull of the mesh, because its body is unknown."""


MOST_MESHES, MOST_TRIANGLES = 100, 10_000
"""Number of meshes whose surfaces are kept, and largest number of triangles of each."""
_known: dict[int, tuple[Mesh, MeshSurface]] = {}
"""The last meshes and their surfaces, by the identity of the mesh: poses of a part share its mesh.
"""


def mesh_surfaces(parts: Sequence[Part], warnings: list[str]) -> dict[int, MeshSurface]:
    """Repair the mesh of each part that is a mesh; the result maps its index to the surface.

    A valid mesh that several parts share is examined once. Warnings are appended to `warnings`.

    Raises `InputError` if a mesh has no faces, or bounds no body because its corners lie in a
    plane.
    """
    shapes = {k: part.shape for k, part in enumerate(parts) if isinstance(part.shape, Mesh)}
    found = {k: _known[id(mesh)][1] for k, mesh in shapes.items() if id(mesh) in _known}
    unknown = {k: mesh for k, mesh in shapes.items() if k not in found}
    distinct = {id(mesh): mesh for mesh in unknown.values() if len(mesh.triangles)}
    corners = [(mesh.vertices, mesh.triangles) for mesh in distinct.values()]
    valid = dict(zip(distinct, weld_valid_meshes(corners), strict=True))
    no_caps = np.empty((0, 3, 3))
    ready = {key: mesh for key, mesh in valid.items() if mesh is not None}
    several = _with_several_shells(ready)
    if len(_known) + len(unknown) > MOST_MESHES:
        _known.clear()
    for k, mesh in unknown.items():
        before = len(warnings)
        found[k] = (
            MeshSurface(*ready[id(mesh)], no_caps)
            if id(mesh) in ready and id(mesh) not in several
            else mesh_surface(parts[k], mesh, warnings)
        )
        # warnings name the part
        if len(warnings) == before and len(mesh.triangles) <= MOST_TRIANGLES:
            _known[id(mesh)] = mesh, found[k]
    return {k: found[k] for k in shapes}


def _with_several_shells(meshes: Mapping[int, tuple[Array, Index]]) -> set[int]:
    """Keys of the valid meshes that have several shells."""
    if not meshes:
        return set()
    start = starts([len(vertices) for vertices, _ in meshes.values()])
    faces = [mesh[1] + first for mesh, first in zip(meshes.values(), start, strict=False)]
    several = count_shells(np.concatenate(faces), start) > 1
    return {key for key, is_several in zip(meshes, several, strict=True) if is_several}


def mesh_surface(part: Part, mesh: Mesh, warnings: list[str]) -> MeshSurface:
    """Repair a part's mesh: merge vertices, orient faces, and drop faces of zero area.

    Every change is appended to `warnings`.

    Raises `InputError` if the mesh has no faces, or bounds no body because its corners lie in a
    plane.
    """
    name = part.name
    if len(mesh.triangles) == 0 or len(mesh.vertices) == 0:
        raise InputError("mesh has no faces", part=name, hint="give a closed solid")
    vertices, triangles, notes = weld(mesh.vertices, mesh.triangles, accuracy=mesh.accuracy)
    warnings.extend(f"part {name!r}: {note}" for note in notes)
    if len(triangles) == 0:
        raise InputError("all faces have zero area", part=name, hint="give a closed solid")
    edges = open_edges(vertices, triangles)
    if len(edges):
        oriented, count = orient_faces(vertices, triangles)
        left = open_edges(vertices, oriented) if count else edges
        if count and len(left) < len(edges):
            warnings.append(f"part {name!r}: {count} faces had the wrong winding and were reversed")
            triangles, edges = oriented, left
    if len(edges) and is_evenly_paired(triangles):
        what = f"two faces run along {len(edges)} edges in the same sense"
        return _hull_in_place(part, vertices, what, warnings)
    if not len(edges) and count_shells(triangles, np.array([0, len(vertices)]))[0] > 1:
        vertices, triangles, notes = body_of_shells(vertices, triangles)
        warnings.extend(f"part {name!r}: {note}" for note in notes)
    closure = close_holes(vertices, triangles, edges)
    if not len(edges):
        return closure
    place = closure.vertices[edges[0, 0]]
    what = f"the mesh is open: {len(edges)} edges have a face on a single side, the first at "
    what += f"({place[0]:.6g}, {place[1]:.6g}, {place[2]:.6g})"
    if part.grounded:
        effect = "a held part needs no closed mesh"
    elif part.given_mass is not None and part.center_of_mass is not None:
        effect = "the given mass and centre of mass are used"
    elif closure.small:
        effect = "its small holes were closed to compute its mass"
    else:
        return _hull_in_place(part, vertices, what, warnings)
    warnings.append(f"part {name!r}: {what}; {effect}")
    return closure


def _hull_in_place(part: Part, vertices: Array, what: str, warnings: list[str]) -> MeshSurface:
    """The convex hull of a mesh that bounds no known body, with a warning.

    Raises `InputError` if the corners of the mesh lie in a plane.
    """
    name = part.name
    try:
        surface = hull_surface(vertices)
    except InputError:
        raise InputError(
            what, part=name, hint="close it in the program that made it, or leave the part out"
        ) from None
    of_hull = "mass and centre are those" if part.given_mass is None else "the centre is that"
    warnings.append(
        f"part {name!r}: {what}; {of_hull} of its convex hull, and its contacts are unknown: close "
        "it in the program that made it"
    )
    return MeshSurface(*surface, np.empty((0, 3, 3)), stand_in=True)


def close_holes(vertices: Array, triangles: Index, edges: Index) -> MeshSurface:
    """Close the holes of a surface with triangles from each hole's rim to its mean point.

    Arguments: `vertices` (V, 3); `triangles` (T, 3); `edges` (n, 2): open edges; the caps run along
    them in the opposite sense.
    """
    if not len(edges):
        return MeshSurface(vertices, triangles, np.empty((0, 3, 3)))
    used, ends = np.unique(edges, return_inverse=True)
    ends = ends.reshape(-1, 2)
    group = connected(len(used), *ends.T)
    middle = np.array([vertices[used[group == k]].mean(axis=0) for k in range(group.max() + 1)])
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    caps = np.stack([end, start, middle[group[ends[:, 0]]]], axis=1)
    corners = vertices[triangles]
    holes = tuple(
        (vertices[used[group == k]].min(axis=0), vertices[used[group == k]].max(axis=0))
        for k in range(group.max() + 1)
    )
    small = _area(caps) <= SMALL_HOLES * _area(corners)
    return MeshSurface(vertices, triangles, caps, holes, small)


def _area(corners: Array) -> float:
    """Total area of triangles, shape (m, 3, 3)."""
    p, q, r = corners.transpose(1, 0, 2)
    return float(np.linalg.norm(cross(q - p, r - p), axis=1).sum() / 2)


# Compute volume, centre and second moment of polyhedra, of closed meshes or closures.


def polyhedron_moments(
    vertices: Array, triangles: Index, start: Index
) -> tuple[Array, Array, Array, Array]:
    """Volume, centroid, second moment about it, and surface centroid of N polyhedra.

    Arguments: `vertices` (V, 3); `triangles` (T, 3); `start` (N + 1,): first triangle of each
    polyhedron, followed by T. Returns `volume` (N,): volumes, negative if the faces point inwards
    [length unit^3]; `centroid` (N, 3); `second` (N, 3, 3): integral of x x^T about the centroid
    [length unit^5]; `surface_centroid` (N, 3): centroid of the surface, weighted by area.
    """
    origin = vertices[triangles[start[:-1], 0]]
    shift = np.repeat(origin, np.diff(start), axis=0)
    p, q, r = (vertices[triangles[:, k]] - shift for k in range(3))
    total = p + q + r
    normal = cross(q - p, r - p)
    area = np.linalg.norm(normal, axis=1)
    six = np.einsum("ij,ij->i", p, cross(q, r))
    volume = _group_sum(six, start) / 6
    first = _group_sum(six[:, None] * total, start) / 24
    outer = sum(np.einsum("n,ni,nj->nij", six, x, x) for x in (total, p, q, r))
    second = _group_sum(np.asarray(outer), start) / 120
    with np.errstate(divide="ignore", invalid="ignore"):
        centroid = first / volume[:, None]
        surface_centroid = _group_sum(area[:, None] * total, start) / (
            3 * _group_sum(area, start)[:, None]
        )
        # a flat polyhedron has no centroid; callers reject a volume near zero
        second = second - volume[:, None, None] * centroid[:, :, None] * centroid[:, None, :]
    return volume, centroid + origin, second, surface_centroid + origin


def closed_moments(mesh: MeshSurface) -> tuple[float, Array, Array]:
    """Volume, centroid, and second moment about it, of a mesh with its holes closed."""
    vertices = np.vstack([mesh.vertices, mesh.caps.reshape(-1, 3)])
    caps = np.arange(3 * len(mesh.caps)).reshape(-1, 3) + len(mesh.vertices)
    triangles = np.vstack([mesh.triangles, caps])
    volume, center, second, _ = polyhedron_moments(
        vertices, triangles, np.array([0, len(triangles)])
    )
    return float(volume[0]), center[0], second[0]


def _group_sum(values: Array, start: Index) -> Array:
    """Sum of each group of consecutive rows; group k begins at ``start[k]``."""
    result: Array = np.add.reduceat(values, start[:-1], axis=0)
    return result


# Compute masses, centres and second moments of parts, from shapes, densities and overrides.


DEFAULT_DENSITY = 1000.0
"""Density of a part without density and mass [kg/m^3]."""
RECENT_SOLIDS = 256
"""Largest number of solids whose centroid is kept; copies and changed poses share it."""


def part_moments(
    parts: Sequence[Part],
    boxes: Mask,
    local: tuple[Array, Index, Index, Index],
) -> tuple[Array, Array, Array, Array]:
    """Volume, centroid, second moment about it, and surface centroid of parts, in their frames.

    Boxes, cylinders and spheres are computed by closed forms.

    Arguments: `boxes` (N,): whether each part is a box; `local`: vertices, first vertex of each
    part, triangles, first triangle of each part.
    """
    vertices, _, triangles, triangle_start = local
    count = len(parts)
    volume, center = np.zeros(count), np.zeros((count, 3))
    second, area_center = np.zeros((count, 3, 3)), np.zeros((count, 3))
    if boxes.any():
        chosen = np.flatnonzero(boxes)
        sizes = box_sizes(parts, chosen)
        volume[chosen] = sizes.prod(axis=1)
        second[chosen[:, None], range(3), range(3)] = volume[chosen][:, None] * sizes**2 / 12
    solid = np.zeros(count, dtype=bool)
    for k, part in enumerate(parts):
        if isinstance(part.shape, Solid):
            solid[k], area_center[k] = True, _area_center(part.shape)
            volume[k], center[k] = part.shape.volume, part.shape.centroid
            second[k] = part.shape.second_moment
    chosen = np.flatnonzero(~boxes & ~solid)
    if len(chosen):
        _, rows = ragged(triangle_start, chosen)
        start = starts(np.diff(triangle_start)[chosen])
        result = polyhedron_moments(vertices, triangles[rows], start)
        volume[chosen], center[chosen], second[chosen], area_center[chosen] = result
    for k in chosen.tolist():
        shape = parts[k].shape
        if isinstance(shape, Cylinder):
            volume[k] = np.pi * shape.radius**2 * shape.height
            moments = [shape.radius**2 / 4, shape.radius**2 / 4, shape.height**2 / 12]
        elif isinstance(shape, Sphere):
            volume[k] = 4 / 3 * np.pi * shape.radius**3
            moments = [shape.radius**2 / 5] * 3
        else:
            continue
        center[k], area_center[k] = 0.0, 0.0
        second[k] = volume[k] * np.diag(moments)
    return volume, center, second, area_center


@lru_cache(maxsize=RECENT_SOLIDS)
def _area_center(shape: Solid) -> Array:
    """Centroid of the triangles of a solid, weighted by area, in its frame, shape (3,)."""
    start = np.array([0, len(shape.triangles)])
    center: Array = polyhedron_moments(shape.vertices, shape.triangles, start)[3][0]
    return center


def part_masses(
    parts: Sequence[Part],
    units: str,
    moments: tuple[Array, Array, Array],
    warnings: list[str],
) -> tuple[Array, Array, Array]:
    """Masses [kg], centres and mass-weighted second moments of parts; given values override.

    Arguments: `warnings`: a warning is appended if the default density is used beside given masses.
    """
    volume, center, second = moments
    cubic_metres = volume * metres_per_unit(units) ** 3
    density = np.array([part.density or DEFAULT_DENSITY for part in parts])
    given = np.array([part.given_mass is not None for part in parts])
    mass = density * cubic_metres
    mass[given] = [part.given_mass for part in parts if part.given_mass is not None]
    warnings += density_warnings(parts)
    second = second * (mass / volume)[:, None, None]
    center = center.copy()
    for k, part in enumerate(parts):
        if part.center_of_mass is not None:
            center[k] = part.center_of_mass
        if part.inertia is not None:
            inertia = inertia_matrix(part.inertia)
            second[k] = np.trace(inertia) / 2 * np.eye(3) - inertia
    return mass, center, second


def reweighed(part: Part, **changes: Any) -> Part:
    """A copy of a part with another mass or density; given inertia changes in proportion to mass.

    Examples
    --------
    >>> part = Part("bar", Box([1, 1, 1]), mass=2, inertia=[1, 1, 1, 0, 0, 0])
    >>> reweighed(part, mass=6).inertia.tolist()
    [3.0, 3.0, 3.0, 0.0, 0.0, 0.0]
    """
    if part.inertia is None:
        return dataclasses.replace(part, **changes)
    copy = dataclasses.replace(part, **changes, inertia=None)
    return dataclasses.replace(copy, inertia=part.inertia * (copy.mass / part.mass))


def density_warnings(parts: Sequence[Part]) -> list[str]:
    """The warning about the default density beside given masses; empty if it is not needed."""
    free = [part for part in parts if not part.grounded]
    without = [part for part in free if part.given_mass is None and part.density is None]
    assumed = [part.name for part in without]
    if len(assumed) in (0, len(free)):
        return []
    materials = [part.material for part in without if part.material]
    named = f" (material {some_names(list(dict.fromkeys(materials)))})" if materials else ""
    return [
        f"density {DEFAULT_DENSITY:g} kg/m^3 assumed for {some_names(assumed)}{named}, although "
        "other parts have a given mass or density: the verdict may depend on the ratios; "
        "--density sets it"
    ]


def box_sizes(parts: Sequence[Part], which: Index) -> Array:
    """Edge lengths along x, y, z of the boxes among the parts, by index `which`, shape (n, 3)."""
    shapes = (parts[k].shape for k in which.tolist())
    return np.array([shape.size for shape in shapes if isinstance(shape, Box)])


# Regions where the surface of a part is unknown: mesh holes, and replaced unreadable solids.


@dataclass(frozen=True, slots=True, eq=False)
class UnknownSurfaces(Rows):
    """Boxes around regions of parts whose true surface is unknown; world frame."""

    part: Index
    """Shape (n,)."""
    low: Array = columns(3)
    high: Array = columns(3)
    """Lower and upper corner of the box [length unit], shape (n, 3)."""
    whole: Mask = columns()
    """Whether the whole surface of the part is unknown, because its shape is a stand-in, shape
    (n,)."""

    def __post_init__(self) -> None:
        read_only(self)

    def stand_ins(self, count: int) -> Mask:
        """Mask of the parts whose shape is a mere replacement of an unreadable solid, (count,)."""
        stands_in = np.zeros(count, dtype=bool)
        stands_in[self.part[self.whole]] = True
        return stands_in


def unknown_surfaces(
    parts: Sequence[Part], meshes: dict[int, MeshSurface], poses: tuple[Array, Array]
) -> UnknownSurfaces:
    """Regions of parts whose true surface is unknown: holes, and replaced unreadable solids.

    Arguments: `poses`: rotation matrices, shape (N, 3, 3), and positions, shape (N, 3) [length
    unit].
    """
    places: list[tuple[int, Array, bool]] = []
    for k, part in enumerate(parts):
        shape = part.shape
        if k in meshes and meshes[k].stand_in:
            box = np.array([meshes[k].vertices.min(axis=0), meshes[k].vertices.max(axis=0)])
            places.append((k, box, True))
        elif k in meshes:
            places += [(k, np.array(box), False) for box in meshes[k].holes]
        elif isinstance(shape, Solid) and shape.stand_in:
            box = np.array([shape.vertices.min(axis=0), shape.vertices.max(axis=0)])
            places.append((k, box, True))
        elif isinstance(shape, Solid):
            places += [(k, box, False) for box in shape.holes]
    if not places:
        return UnknownSurfaces.none()
    owner = np.array([k for k, _, _ in places])
    rotation, position = (pose[owner] for pose in poses)
    box = np.array([box for _, box, _ in places])
    middle, half = box.mean(axis=1), np.ptp(box, axis=1) / 2
    center = np.einsum("nij,nj->ni", rotation, middle) + position
    reach = np.einsum("nij,nj->ni", np.abs(rotation), half)
    whole = np.array([whole for _, _, whole in places])
    return UnknownSurfaces(owner, center - reach, center + reach, whole)
