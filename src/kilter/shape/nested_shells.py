"""Bodies of closed meshes with several shells: hollows, overlapping shells, shells inside out.

A shell is a connected closed surface. The depth of a shell is the number of shells that contain it.
Of shells that do not cross each other, those of even depth bound matter from outside, and those of
odd depth are the walls of hollows. Crossing shells are united; the body is

    (((U_0 - H_0) - H_1) + U_2) - ...,

U_d and H_d the unions of the shells of depth d around matter and around hollows. Crossing shells of
even depth are around a hollow if their faces point inwards, such as the wall of a drilled hole.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, connected
from kilter.shape.closed import contains, signed_volume
from kilter.shape.shape_tolerances import COMMON_VOLUME

__all__ = ["body_of_shells", "count_shells"]


def count_shells(triangles: Index, vertex_start: Index) -> Index:
    """Number of shells of each mesh, shape (N,); shells that share a vertex count as one.

    Parameters
    ----------
    triangles : ndarray of int, shape (T, 3)
        Faces of all meshes, whose vertices are all used.
    vertex_start : ndarray of int, shape (N + 1,)
        First vertex of each mesh, and the total number.

    Examples
    --------
    >>> tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> count_shells(np.vstack([tetrahedron, tetrahedron + 4]), np.array([0, 8]))
    array([2])
    """
    label = _shell_of_vertices(triangles, int(vertex_start[-1]))
    first = vertex_start[:-1]
    most: Index = np.maximum.reduceat(label, first) - np.minimum.reduceat(label, first) + 1
    return most


def _shell_of_vertices(triangles: Index, count: int) -> Index:
    """Shell to which each of `count` vertices belongs."""
    return connected(count, triangles[:, [0, 1]].ravel(), triangles[:, [1, 2]].ravel())


def body_of_shells(vertices: Array, triangles: Index) -> tuple[Array, Index, list[str]]:
    """The surface of the body that a closed mesh with several shells bounds.

    Returns
    -------
    vertices : ndarray, shape (V, 3)
    triangles : ndarray of int, shape (T, 3)
    notes : list of str
        Description of the changes.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> (outer, faces), (inner, _) = surface(Box([2, 2, 2])), surface(Box([1, 1, 1]))
    >>> corners, turned, notes = body_of_shells(np.vstack([outer, inner]),
    ...                                         np.vstack([faces, faces + 8]))
    >>> signed_volume(corners, turned), notes
    (7.0, ['hollows whose faces pointed outwards: 1, reversed'])
    """
    label = _shell_of_vertices(triangles, len(vertices))[triangles[:, 0]]
    shells = [triangles[label == k] for k in range(int(label.max()) + 1)]
    volume = np.array([signed_volume(vertices, shell) for shell in shells])
    outward = [s if v > 0 else s[:, ::-1] for s, v in zip(shells, volume, strict=True)]
    inside, crossing = _arrangement(vertices, outward, np.abs(volume))
    depth = inside.sum(axis=0)
    wrong = (volume > 0) == (depth % 2 == 1)
    if wrong.all():  # the whole mesh is inside out, which its volume shows
        volume, wrong = -volume, ~wrong
    if crossing.any():
        matter = (depth % 2 == 0) & ((volume > 0) | ~crossing.any(axis=0))
        united = _united(vertices, outward, depth, matter)
        if united is not None:
            return *united, [f"overlapping shells: {int(crossing.any(axis=0).sum())}, united"]
    flip = wrong & ~crossing.any(axis=0)
    turned = np.where(flip[label][:, None], triangles[:, ::-1], triangles)
    hollows, apart = int((flip & (depth % 2 == 1)).sum()), int((flip & (depth % 2 == 0)).sum())
    notes = [f"hollows whose faces pointed outwards: {hollows}, reversed"] if hollows else []
    notes += [f"separate shells whose faces pointed inwards: {apart}, reversed"] if apart else []
    return vertices, turned, notes


def _arrangement(vertices: Array, shells: Sequence[Index], volume: Array) -> tuple[Mask, Mask]:
    """Which shell contains which other, and which pairs cross, two masks of shape (n, n).

    ``inside[i, j]``: shell i contains shell j. Shells that touch neither contain nor cross
    each other. `shells` are wound outwards; `volume` is that inside each.
    """
    count = len(shells)
    inside, crossing = np.zeros((2, count, count), dtype=bool)
    corners = [vertices[np.unique(shell)] for shell in shells]
    low = np.array([points.min(axis=0) for points in corners])
    high = np.array([points.max(axis=0) for points in corners])
    near = ((low[:, None] < high[None]) & (low[None] < high[:, None])).all(axis=2)
    solids: dict[int, Any] = {}
    for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True):
        for k in (i, j):
            if k not in solids:
                solids[k] = _solid(vertices, shells[k])
        larger, smaller = (i, j) if volume[i] >= volume[j] else (j, i)
        if solids[i] is None or solids[j] is None:
            inside[larger, smaller] = contains(vertices, shells[larger], corners[smaller][0])
            continue
        common = (solids[i] ^ solids[j]).volume()
        if common > (1 - COMMON_VOLUME) * volume[smaller]:
            inside[larger, smaller] = True
        elif common > COMMON_VOLUME * volume[smaller]:
            crossing[i, j] = crossing[j, i] = True
    return inside, crossing


def _united(
    vertices: Array, shells: Sequence[Index], depth: Index, matter: Mask
) -> tuple[Array, Index] | None:
    """The body of crossing shells as a mesh; None if a shell is no manifold or nothing is left."""
    import manifold3d

    body = manifold3d.Manifold()
    for level in range(int(depth.max()) + 1):
        for adds in (True, False):
            rows = np.flatnonzero((depth == level) & (matter == adds))
            solids = [_solid(vertices, shells[k]) for k in rows.tolist()]
            if any(solid is None for solid in solids):
                return None
            if solids:
                union = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
                body = body + union if adds else body - union
    mesh = body.to_mesh64()
    corners = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    faces = np.asarray(mesh.tri_verts).astype(np.int64)
    return (corners, faces) if len(faces) else None


def _solid(vertices: Array, triangles: Index) -> Any:
    """A shell as a solid of the library manifold3d; None if it is no manifold."""
    import manifold3d

    used, faces = np.unique(triangles, return_inverse=True)
    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(vertices[used]),
        tri_verts=np.ascontiguousarray(faces.reshape(-1, 3), dtype=np.uint64),
    )
    solid = manifold3d.Manifold(mesh)
    return solid if solid.status() == manifold3d.Error.NoError else None
