"""The surface of a mesh part: closed, or open where that is enough to know.

    closed                 what a free part has to be
    wound both ways        turned alike, with a warning
    open, part held        read, with a warning: a held part needs surfaces, no volume
    open, part free        read where its holes are small and its mass and centre are given

Volume and moments of an open mesh are those of its closure: every group of open edges that hang
together is joined to one point. What the missing faces look like stays unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, connected, cross
from kilter.assembly.assembly_tolerances import SMALL_HOLES
from kilter.assembly.part import Part
from kilter.errors import InputError
from kilter.shape.closed import open_edges, turned_alike, welded, wound_both_ways
from kilter.shape.primitives import Mesh
from kilter.shape.sound import welded_if_sound

__all__ = ["MeshSurface", "closed_in_thought", "mesh_surface", "mesh_surfaces"]


@dataclass(frozen=True, slots=True, eq=False)
class MeshSurface:
    """Corners and triangles of a mesh, and the triangles that close it in thought.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
    triangles : ndarray, shape (T, 3)
    caps : ndarray, shape (C, 3, 3)
        Corners of the triangles that close it; none of a closed mesh.
    holes : tuple of (ndarray, ndarray)
        Lower and upper corner of the box of each group of open edges.
    small : bool
        The caps are small against the surface: what they close is the part's volume.
    """

    vertices: Array
    triangles: Index
    caps: Array
    holes: tuple[tuple[Array, Array], ...] = ()
    small: bool = True


def mesh_surfaces(parts: Sequence[Part], warnings: list[str]) -> dict[int, MeshSurface]:
    """`MeshSurface` of each part that is a mesh, by the place of the part.

    A mesh that several parts share is looked at once.

    Raises
    ------
    InputError
        If one has no faces, or is open where that is not enough.
    """
    shapes = {k: part.shape for k, part in enumerate(parts) if isinstance(part.shape, Mesh)}
    distinct = {id(mesh): mesh for mesh in shapes.values() if len(mesh.triangles)}
    corners = [(mesh.vertices, mesh.triangles) for mesh in distinct.values()]
    sound = dict(zip(distinct, welded_if_sound(corners), strict=True))
    none = np.empty((0, 3, 3))
    return {
        k: MeshSurface(*ready, none)
        if (ready := sound.get(id(mesh))) is not None
        else mesh_surface(parts[k], mesh, warnings)
        for k, mesh in shapes.items()
    }


def mesh_surface(part: Part, mesh: Mesh, warnings: list[str]) -> MeshSurface:
    """The mesh of a part, welded, without faces of no area; a word of what was done to it.

    Raises
    ------
    InputError
        If it has no faces, or is open where that is not enough.
    """
    name = part.name
    if len(mesh.triangles) == 0 or len(mesh.vertices) == 0:
        raise InputError("mesh has no faces", part=name, hint="give a closed solid")
    vertices, triangles, notes = welded(mesh.vertices, mesh.triangles, accuracy=mesh.accuracy)
    warnings.extend(f"part {name!r}: {note}" for note in notes)
    if len(triangles) == 0:
        raise InputError("all faces have zero area", part=name, hint="give a closed solid")
    edges = open_edges(vertices, triangles)
    if len(edges):
        turned, count = turned_alike(vertices, triangles)
        left = open_edges(vertices, turned) if count else edges
        if count and len(left) < len(edges):
            warnings.append(f"part {name!r}: {count} faces turned, they were wound the other way")
            triangles, edges = turned, left
    if len(edges) and wound_both_ways(triangles):
        raise InputError(
            f"some faces are wound the wrong way: {len(edges)} edges run twice in one sense",
            part=name,
            hint="let all faces turn the same way, seen from outside",
        )
    found = closed_in_thought(vertices, triangles, edges)
    if len(edges):
        warnings.append(_allowed(part, found, edges))
    return found


def closed_in_thought(vertices: Array, triangles: Index, edges: Index) -> MeshSurface:
    """Every group of open edges, shape (n, 2), joined to its middle, run the other way."""
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
    p, q, r = corners.transpose(1, 0, 2)
    return float(np.linalg.norm(cross(q - p, r - p), axis=1).sum() / 2)


def _allowed(part: Part, found: MeshSurface, edges: Index) -> str:
    """The warning that an open mesh is read with; an error where it is not enough."""
    where = found.vertices[edges[0, 0]]
    what = f"mesh is open: {len(edges)} edges have a face on one side only, the first at "
    what += f"({where[0]:.6g}, {where[1]:.6g}, {where[2]:.6g})"
    if part.grounded:
        return f"part {part.name!r}: {what}; it is held, so its surfaces are enough"
    if not found.small:
        hint = "close it where it was made"
    elif part.mass is None or part.center_of_mass is None:
        hint = "close it where it was made, hold it, or give its mass and center_of_mass"
    else:
        return f"part {part.name!r}: {what}; its mass and centre of mass are those given"
    raise InputError(what, part=part.name, hint=hint)
