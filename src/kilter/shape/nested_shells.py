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

from kilter.arrays import Array, Index, Mask, connected, extents, starts
from kilter.errors import InputError
from kilter.shape.closed import contains, signed_volume
from kilter.shape.shape_tolerances import COMMON_VOLUME

MOST_PAIRS = 20_000
"""Most pairs of shells of a mesh whose boxes may overlap; each takes about a millisecond."""


def count_shells(triangles: Index, vertex_start: Index) -> Index:
    """Number of shells of each mesh, shape (N,); shells that share a vertex count as one.

    Arguments: `triangles` (T, 3): faces of all meshes, whose vertices are all used; `vertex_start`
    (N + 1,): first vertex of each mesh, and the total number.

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

    Returns `vertices` (V, 3); `triangles` (T, 3); `notes`: description of the changes.

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
    rows = np.argsort(label, kind="stable")
    first = np.flatnonzero(np.diff(label[rows], prepend=-1))
    shells = np.split(triangles[rows], first[1:])
    volume = np.array([signed_volume(vertices, shell) for shell in shells])
    outward = [s if v > 0 else s[:, ::-1] for s, v in zip(shells, volume, strict=True)]
    depth, crosses = _arrangement(vertices, outward, np.abs(volume))
    wrong = (volume > 0) == (depth % 2 == 1)
    if wrong.all():  # the whole mesh is inside out, which its volume shows
        volume, wrong = -volume, ~wrong
    if crosses.any():
        matter = (depth % 2 == 0) & ((volume > 0) | ~crosses)
        united = _united(vertices, outward, depth, matter)
        if united is not None:
            return *united, [f"overlapping shells: {int(crosses.sum())}, united"]
    flip = wrong & ~crosses
    turned = np.where(flip[label][:, None], triangles[:, ::-1], triangles)
    hollows, apart = int((flip & (depth % 2 == 1)).sum()), int((flip & (depth % 2 == 0)).sum())
    notes = [f"hollows whose faces pointed outwards: {hollows}, reversed"] if hollows else []
    notes += [f"separate shells whose faces pointed inwards: {apart}, reversed"] if apart else []
    return vertices, turned, notes


def _arrangement(vertices: Array, shells: Sequence[Index], volume: Array) -> tuple[Index, Mask]:
    """Depth of each shell, and a mask of the shells that cross others, each of shape (n,).

    `shells` are wound outwards; `volume` is that inside each.

    Raises `InputError` if too many shells overlap.
    """
    depth, crosses = np.zeros(len(shells), dtype=np.int64), np.zeros(len(shells), dtype=bool)
    solids: dict[int, Any] = {}
    for larger, smaller in _near_shells(vertices, shells, volume):
        for k in (larger, *smaller):
            if k not in solids:
                solids[k] = _solid(vertices, shells[k])
        # usually a shell contains all its smaller neighbours, or none of them
        share = _common_share(solids[larger], [solids[k] for k in smaller])
        for k in smaller:
            if share is None or COMMON_VOLUME < share <= 1 - COMMON_VOLUME:
                own = _common_share(solids[larger], [solids[k]])
                if own is None:
                    point = vertices[shells[k][0, 0]]
                    own = float(contains(vertices, shells[larger], point))
            else:
                own = share
            depth[k] += own > 1 - COMMON_VOLUME
            if COMMON_VOLUME < own <= 1 - COMMON_VOLUME:
                crosses[[larger, k]] = True
    return depth, crosses


def _near_shells(
    vertices: Array, shells: Sequence[Index], volume: Array
) -> list[tuple[int, list[int]]]:
    """Each shell with the smaller shells whose bounding boxes overlap its own.

    Raises `InputError` if there are more than `MOST_PAIRS` such pairs.
    """
    import shapely

    corners = vertices[np.vstack(shells)]
    first = starts([len(shell) for shell in shells])[:-1]
    least, greatest = extents(corners)
    low, high = np.minimum.reduceat(least, first), np.maximum.reduceat(greatest, first)
    boxes = shapely.box(*low[:, :2].T, *high[:, :2].T)
    tree, rank, pairs = shapely.STRtree(boxes), np.argsort(np.argsort(-volume, kind="stable")), 0
    near = []
    for i, box in enumerate(boxes):
        others = tree.query(box)
        others = others[rank[others] > rank[i]]
        others = others[((low[i] < high[others]) & (low[others] < high[i])).all(axis=1)]
        pairs += len(others)
        if pairs > MOST_PAIRS:
            raise InputError(
                f"more than {MOST_PAIRS} pairs of its {len(shells)} shells may overlap",
                hint="divide the mesh into parts",
            )
        if len(others):
            near.append((i, others.tolist()))
    return near


def _common_share(solid: Any, others: Sequence[Any]) -> float | None:
    """Share of the union of other solids that a solid contains [-]; None without a manifold."""
    import manifold3d

    if solid is None or any(other is None for other in others):
        return None
    union = manifold3d.Manifold.batch_boolean(others, manifold3d.OpType.Add)
    return float((solid ^ union).volume() / union.volume())


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
