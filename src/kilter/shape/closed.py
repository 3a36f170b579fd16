"""Repair and check closed meshes: weld vertices, drop faces without area, find open edges.

Equal vertices (exactly, -0.0 = +0.0) are merged. If edges are open after that, vertices closer than
1e-7 of the size (or the accuracy of the coordinates) are merged too. An edge whose neighbours are
split by a vertex on it (a T-junction) counts as closed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, cross, distinct_rows, squares, starts
from kilter.shape.shape_tolerances import EDGE_END, NO_AREA, WELD


def weld(
    vertices: Array, triangles: Index, *, accuracy: float = 0.0
) -> tuple[Array, Index, list[str]]:
    """Merge equal vertices of a mesh, and drop faces without area and repeated faces.

    Arguments: `vertices` (n, 3); `triangles` (m, 3); `accuracy`: largest error of a coordinate
    [length unit]. Returns `vertices` (V, 3): distinct vertices that are used; `triangles` (T, 3);
    `notes`: description of the dropped faces.

    Examples
    --------
    >>> soup = np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -0.0], [0, 1, 0], [1, 0, 0]])
    >>> vertices, triangles, notes = weld(soup, np.array([[0, 1, 2], [3, 4, 5]]))
    >>> len(vertices), triangles.tolist()
    (3, [[0, 2, 1], [0, 1, 2]])
    """
    distinct, inverse = distinct_rows(vertices + 0.0)
    merged = inverse[triangles]
    is_body = bounds_a_body(merged)
    if not is_body and len(_boundary_edges(merged)):
        size = float(np.ptp(distinct, axis=0).max(initial=0.0))
        close = _representatives(distinct, max(WELD * size, 4 * accuracy))
        if len(_boundary_edges(close[merged])) < len(_boundary_edges(merged)):
            merged = close[merged]
    notes = []
    flat = _removable_faces(distinct, merged)
    if flat.any():
        notes.append(f"{int(flat.sum())} faces of zero area dropped")
        merged = merged[~flat]
    merged, repeats = (merged, 0) if is_body else _without_repeats(merged)
    if repeats:
        notes.append(f"{repeats} repeated faces dropped")
    used, compact = np.unique(merged, return_inverse=True)
    return distinct[used], compact.reshape(-1, 3), notes


def bounds_a_body(triangles: Index) -> bool:
    """Whether triangles form a closed surface: each edge occurs once in each direction.

    manifold3d may end the process on triangles without this property.

    Examples
    --------
    >>> bounds_a_body(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    True
    >>> bounds_a_body(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3]]))
    False
    """
    following = triangles[:, [1, 2, 0]]
    count = int(triangles.max(initial=0)) + 1
    forward, backward = (
        (triangles * count + following).ravel(),
        (following * count + triangles).ravel(),
    )
    forward.sort()
    backward.sort()
    return bool((forward == backward).all() and (np.diff(forward) > 0).all())


def open_edges(vertices: Array, triangles: Index) -> Index:
    """Directed edges that border a single face only, at a hole, shape (k, 2).

    Up to eight rounds split the edges at T-junctions.
    """
    edges = _boundary_edges(triangles)
    for _ in range(8):
        if not len(edges):
            break
        split = _split_at_vertices(vertices, edges)
        remaining = _unmatched_edges(split)
        if len(remaining) == len(edges) and len(split) == len(edges):
            break
        edges = remaining
    return edges


def shared_edges(triangles: Index) -> tuple[Index, Index]:
    """Pairs of half-edges of neighbouring triangles at the same edge, as two index arrays.

    Half-edge ``3 t + k`` runs from corner k of triangle t to the next corner.

    Examples
    --------
    >>> shared_edges(np.array([[0, 1, 2], [0, 2, 3]]))
    (array([2]), array([3]))
    """
    following = triangles[:, [1, 2, 0]]
    low, high = np.minimum(triangles, following).ravel(), np.maximum(triangles, following).ravel()
    key = low * (int(high.max(initial=0)) + 1) + high
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    return order[same], order[same + 1]


def is_evenly_paired(triangles: Index) -> bool:
    """Whether every edge borders an even number of faces, whatever their winding.

    Such a mesh with open edges is closed, but some faces have the wrong winding.
    """
    edges = np.sort(_edges(triangles), axis=1)
    _, inverse = distinct_rows(edges)
    return bool((np.bincount(inverse) % 2 == 0).all())


def orient_faces(vertices: Array, triangles: Index) -> tuple[Index, int]:
    """Reverse faces so that neighbouring faces have the same winding, outwards; also counts them.

    Two triangles that share an edge with no other triangle have the same winding if they run along
    it in opposite senses. Each surface that is connected by such edges is oriented outwards; a
    surface inside another one (a hole) is oriented inwards. If one surface cannot be oriented (a
    Moebius strip), nothing is changed.

    Returns `triangles` (T, 3); `count`: number of reversed triangles.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> vertices, faces = surface(Box([1, 1, 1]))
    >>> mixed = faces.copy()
    >>> mixed[[2, 5]] = mixed[[2, 5], ::-1]
    >>> oriented, count = orient_faces(vertices, mixed)
    >>> count, np.array_equal(oriented, faces)
    (2, True)
    """
    label = _sides(triangles)
    count = len(triangles)
    if label is None:
        return triangles, 0
    mirror = label[count:] < label[:count]  # opposite to the first triangle of the surface
    surface = np.minimum(label[:count], label[count:])
    oriented = np.where(mirror[:, None], triangles[:, ::-1], triangles)
    for k in np.unique(surface[mirror]).tolist():
        rows = surface == k
        point = vertices[oriented[rows][0, 0]]
        others = np.unique(surface[~rows]).tolist()
        depth = sum(contains(vertices, oriented[surface == other], point) for other in others)
        if (signed_volume(vertices, oriented[rows]) < 0) != bool(depth % 2):
            oriented[rows] = oriented[rows][:, ::-1]
    return oriented, int((oriented != triangles).any(axis=1).sum())


def contains(vertices: Array, triangles: Index, point: Array) -> bool:
    """Whether a point is inside a closed shell, by the solid angle of its triangles."""
    p, q, r = (vertices[triangles[:, k]] - point for k in range(3))
    a, b, c = (np.linalg.norm(x, axis=1) for x in (p, q, r))
    top = np.einsum("ij,ij->i", p, cross(q, r))
    low = a * b * c + (p * q).sum(1) * c + (q * r).sum(1) * a + (r * p).sum(1) * b
    return bool(abs(np.arctan2(top, low).sum()) > np.pi)


def _sides(triangles: Index) -> Index | None:
    """Connected surface of each triangle, then of each triangle reversed; None if one-sided.

    None if a triangle and its reverse are on the same surface, which is then not orientable.
    """
    count = len(triangles)
    following = triangles[:, [1, 2, 0]]
    low, high = np.minimum(triangles, following).ravel(), np.maximum(triangles, following).ravel()
    key = low * (int(high.max(initial=0)) + 1) + high
    order = np.argsort(key, kind="stable")
    runs = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    pairs = runs[np.diff(np.append(runs, len(order))) == 2]
    first, second = order[pairs], order[pairs + 1]
    forward = (triangles <= following).ravel()
    against = (forward[first] == forward[second]).astype(np.int64)  # their windings differ
    f, g = first // 3, second // 3
    label = connected(
        2 * count,
        np.concatenate([f, f + count]),
        np.concatenate([g + count * against, g + count * (1 - against)]),
    )
    return None if (label[:count] == label[count:]).any() else label


def signed_volume(vertices: Array, triangles: Index) -> float:
    """Volume inside a closed surface [length unit^3], negative if its faces point inwards."""
    p, q, r = (vertices[triangles[:, k]] - vertices[triangles[0, 0]] for k in range(3))
    return float(np.einsum("ij,ij->", p, cross(q, r)) / 6)


def _edges(triangles: Index) -> Index:
    """Directed edges of triangles, shape (3 T, 2)."""
    edges: Index = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return edges


def _boundary_edges(triangles: Index) -> Index:
    """Directed edges of triangles without an opposite edge of another triangle, shape (k, 2)."""
    return _unmatched_edges(_edges(triangles))


def _unmatched_edges(edges: Index) -> Index:
    """Directed edges (p, q) left over after pairing each with an opposite edge (q, p)."""
    edges = edges[edges[:, 0] != edges[:, 1]]
    if not len(edges):
        return edges
    low, high = edges.min(axis=1), edges.max(axis=1)
    sign = np.where(edges[:, 0] == low, 1, -1)
    key = low * (int(edges.max()) + 1) + high
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    balance = np.add.reduceat(sign[order], first)
    wrong = np.repeat(balance != 0, np.diff(np.append(first, len(key))))
    rows = order[wrong]
    # keep the surplus of each unbalanced group, in its direction
    group = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(key))))[wrong]
    surplus = rows[sign[rows] == np.sign(balance[group])]
    group = group[sign[rows] == np.sign(balance[group])]
    rank = np.arange(len(group)) - np.searchsorted(group, group)
    unmatched: Index = edges[surplus[rank < np.abs(balance[group])]]
    return unmatched


def _representatives(vertices: Array, distance: float) -> Index:
    """For each vertex, the vertex that replaces it when vertices closer than `distance` merge."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(vertices).query_pairs(distance, output_type="ndarray")
    count = len(vertices)
    label = connected(count, *pairs.T)
    first = np.full(label.max() + 1, count)
    np.minimum.at(first, label, np.arange(count))
    return first[label]


def _has_equal_corners(triangles: Index) -> Mask:
    """Mask of triangles with two corners at the same vertex, shape (T,)."""
    a, b, c = triangles.T
    same: Mask = (a == b) | (b == c) | (c == a)
    return same


def flat_faces(vertices: Array, triangles: Index) -> Mask:
    """Mask of triangles whose area is zero within rounding, shape (T,)."""
    p, q, r = (vertices[corner] for corner in triangles.T)
    sides = q - p, r - p, r - q
    twice = np.sqrt(squares(cross(sides[0], sides[1])))
    longest = np.maximum.reduce([squares(side) for side in sides])
    flat: Mask = _has_equal_corners(triangles) | (twice <= NO_AREA * longest)
    return flat


def _removable_faces(vertices: Array, triangles: Index) -> Mask:
    """Mask of triangles without area that can be removed without making a hole, shape (T,)."""
    flat = flat_faces(vertices, triangles)
    same = _has_equal_corners(triangles)
    # slivers of three distinct corners stay if dropping them would open edges
    if flat.any() and not same[flat].all():
        thin = flat & ~same
        if len(_boundary_edges(triangles[~flat])) > len(_boundary_edges(triangles[~same])):
            flat = flat & ~thin
    return flat


def _without_repeats(triangles: Index) -> tuple[Index, int]:
    """Drop repeated faces of the same winding, which would count twice in the volume.

    Returns `triangles` (T, 3); `repeats`: number of dropped faces.
    """
    turn = np.argmin(triangles, axis=1)
    rows = np.arange(len(triangles))[:, None]
    canonical = triangles[rows, (turn[:, None] + np.arange(3)) % 3]
    distinct, inverse = distinct_rows(canonical)
    if len(distinct) == len(triangles):
        return triangles, 0
    first = np.full(len(distinct), len(triangles))
    np.minimum.at(first, inverse, np.arange(len(triangles)))
    return triangles[np.sort(first)], len(triangles) - len(distinct)


def _split_at_vertices(vertices: Array, edges: Index) -> Index:
    """Split open edges at the ends of other open edges that lie on them, shape (n, 2)."""
    if len(edges) > 4000:
        return edges
    points = np.unique(edges)
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along = end - start
    length = np.linalg.norm(along, axis=1)
    size = float(np.ptp(vertices, axis=0).max())
    pieces: list[list[int]] = []
    for k, (p, q) in enumerate(edges.tolist()):
        relative = vertices[points] - start[k]
        t = relative @ along[k] / length[k] ** 2
        off = np.linalg.norm(relative - t[:, None] * along[k], axis=1)
        inside = (t > EDGE_END) & (t < 1 - EDGE_END) & (off <= WELD * size)
        chain = [p, *points[inside][np.argsort(t[inside])].tolist(), q]
        pieces.extend([u, v] for u, v in pairwise(chain) if u != v)
    return np.array(pieces, dtype=np.int64).reshape(-1, 2)


# Weld the valid meshes of a file all at once.


Corners = tuple[Array, Index]
"""A mesh: vertices, shape (n, 3), and triangles, shape (m, 3)."""
BATCH = 500_000
"""Number of triangles that are processed at once; more need more memory."""


def weld_valid_meshes(meshes: Sequence[Corners]) -> list[Corners | None]:
    """Merge equal vertices of all valid meshes at once; None for each mesh that needs repair.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -0.0]])
    >>> faces = np.array([[0, 2, 1], [4, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> closed, opened = weld_valid_meshes([(corners, faces), (corners, faces[:3])])
    >>> len(closed[0]), opened is None
    (4, True)
    """
    welded: list[Corners | None] = []
    for batch in _batches(meshes):
        welded += _weld_batch(batch)
    return welded


def _batches(meshes: Sequence[Corners]) -> Iterator[Sequence[Corners]]:
    """Yield the meshes in order, in groups of about `BATCH` triangles."""
    begin = total = 0
    for end, (_, triangles) in enumerate(meshes, start=1):
        total += len(triangles)
        if total >= BATCH or end == len(meshes):
            yield meshes[begin:end]
            begin, total = end, 0


def _weld_batch(meshes: Sequence[Corners]) -> list[Corners | None]:
    """Merge equal vertices of the meshes of a group; None for each mesh that needs repair."""
    count = [len(vertices) for vertices, _ in meshes]
    first = starts(count)
    first_face = starts([len(triangles) for _, triangles in meshes])
    vertices = np.concatenate([vertices for vertices, _ in meshes]) + 0.0
    owner = np.repeat(np.arange(len(meshes)), count)
    # the mesh as the first column keeps equal vertices of different meshes apart
    rows, inverse = distinct_rows(np.column_stack([owner, vertices]))
    distinct: Array = np.ascontiguousarray(rows[:, 1:])
    faces = np.concatenate([triangles for _, triangles in meshes])
    faces = inverse[faces + np.repeat(first[:-1], np.diff(first_face))[:, None]]
    kept = np.searchsorted(rows[:, 0], np.arange(len(meshes) + 1))
    valid = _is_valid(distinct, faces, kept, first_face)
    return [
        (distinct[a:b], faces[p:q] - a) if fine else None
        for fine, a, b, p, q in zip(valid, kept, kept[1:], first_face, first_face[1:], strict=False)
    ]


def _is_valid(vertices: Array, faces: Index, first: Index, first_face: Index) -> Mask:
    """Mask of merged meshes that are closed and need no repair, shape (number of meshes,).

    `first` and `first_face`: first vertex and first face of each mesh, and the total number.
    """
    valid = np.ones(len(first) - 1, dtype=bool)
    used = np.bincount(faces.reshape(-1), minlength=len(vertices)) > 0
    valid[np.searchsorted(first, np.flatnonzero(~used), side="right") - 1] = False
    flat = np.flatnonzero(flat_faces(vertices, faces))
    begin, end = faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    # the vertices of a mesh are consecutive, so its keys are consecutive after sorting
    forth, back = np.sort(begin * len(vertices) + end), np.sort(end * len(vertices) + begin)
    wrong = forth != back
    wrong[1:] |= forth[1:] == forth[:-1]
    for face in (flat, np.flatnonzero(wrong) // 3):
        valid[np.searchsorted(first_face, face, side="right") - 1] = False
    return valid
