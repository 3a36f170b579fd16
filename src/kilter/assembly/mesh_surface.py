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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, connected, cross, starts
from kilter.assembly.assembly_tolerances import SMALL_HOLES
from kilter.assembly.part import Part
from kilter.errors import InputError
from kilter.shape.closed import is_evenly_paired, open_edges, orient_faces, weld
from kilter.shape.convex_hull import hull_surface
from kilter.shape.nested_shells import body_of_shells, count_shells
from kilter.shape.primitives import Mesh
from kilter.shape.sound import weld_valid_meshes

__all__ = ["MeshSurface", "close_holes", "mesh_surface", "mesh_surfaces"]


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


def mesh_surfaces(parts: Sequence[Part], warnings: list[str]) -> dict[int, MeshSurface]:
    """Repair the mesh of each part that is a mesh; the result maps its index to the surface.

    A valid mesh that several parts share is examined once. Warnings are appended to `warnings`.

    Raises `InputError` if a mesh has no faces, or bounds no body because its corners lie in a
    plane.
    """
    shapes = {k: part.shape for k, part in enumerate(parts) if isinstance(part.shape, Mesh)}
    distinct = {id(mesh): mesh for mesh in shapes.values() if len(mesh.triangles)}
    corners = [(mesh.vertices, mesh.triangles) for mesh in distinct.values()]
    valid = dict(zip(distinct, weld_valid_meshes(corners), strict=True))
    no_caps = np.empty((0, 3, 3))
    ready = {key: mesh for key, mesh in valid.items() if mesh is not None}
    several = _with_several_shells(ready)
    return {
        k: MeshSurface(*ready[id(mesh)], no_caps)
        if id(mesh) in ready and id(mesh) not in several
        else mesh_surface(parts[k], mesh, warnings)
        for k, mesh in shapes.items()
    }


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
