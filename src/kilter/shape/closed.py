"""Is a mesh a closed surface: welding of vertices, faces of no area, open edges.

Vertices in one place (exactly, -0.0 = +0.0) are made one. Where edges are open after that,
vertices closer than 1e-7 of the size (or the accuracy of the coordinates) are made one. An
edge whose neighbours are split by a vertex on it (a T-junction) is closed all the same.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, cross, distinct_rows
from kilter.shape.shape_tolerances import EDGE_END, NO_AREA, WELD

__all__ = [
    "contains",
    "flat_faces",
    "open_edges",
    "shared_edges",
    "turned_alike",
    "welded",
    "wound_both_ways",
]


def welded(
    vertices: Array, triangles: Index, *, accuracy: float = 0.0
) -> tuple[Array, Index, list[str]]:
    """The mesh with each vertex once, without faces of no area or listed twice; and notes.

    Examples
    --------
    >>> soup = np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -0.0], [0, 1, 0], [1, 0, 0]])
    >>> vertices, triangles, notes = welded(soup, np.array([[0, 1, 2], [3, 4, 5]]))
    >>> len(vertices), triangles.tolist()
    (3, [[0, 2, 1], [0, 1, 2]])
    """
    distinct, inverse = distinct_rows(vertices + 0.0)
    merged = inverse[triangles]
    if len(_unmatched(merged)):
        size = float(np.ptp(distinct, axis=0).max(initial=0.0))
        close = _merged_close(distinct, max(WELD * size, 4 * accuracy))
        if len(_unmatched(close[merged])) < len(_unmatched(merged)):
            merged = close[merged]
    notes = []
    flat = _no_area(distinct, merged)
    if flat.any():
        notes.append(f"{int(flat.sum())} faces of zero area dropped")
        merged = merged[~flat]
    merged, repeats = _without_repeats(merged)
    if repeats:
        notes.append(f"{repeats} faces listed twice dropped")
    used, compact = np.unique(merged, return_inverse=True)
    return distinct[used], compact.reshape(-1, 3), notes


def open_edges(vertices: Array, triangles: Index) -> Index:
    """Directed edges, shape (k, 2), that no face on the other side meets."""
    edges = _unmatched(triangles)
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
    """Pairs of half-edges (3 x triangle + corner) that are one edge of two triangles.

    Examples
    --------
    >>> shared_edges(np.array([[0, 1, 2], [0, 2, 3]]))
    (array([2]), array([3]))
    """
    following = triangles[:, [1, 2, 0]]
    low, high = np.minimum(triangles, following).ravel(), np.maximum(triangles, following).ravel()
    key = low * (int(high.max()) + 1) + high
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    return order[same], order[same + 1]


def wound_both_ways(triangles: Index) -> bool:
    """Whether every edge has a face on either side, but some faces are wound the wrong way."""
    edges = np.sort(_edges(triangles), axis=1)
    _, inverse = distinct_rows(edges)
    return bool((np.bincount(inverse) % 2 == 0).all())


def turned_alike(vertices: Array, triangles: Index) -> tuple[Index, int]:
    """The triangles with those turned that were wound against their neighbours, and how many.

    Two triangles that meet at an edge of no other are wound alike where they run along it in
    opposite senses. What hangs together so is turned to have its outside outside, inside of
    another such surface (a hole) the other way; where one surface cannot be wound alike (a
    Moebius strip), nothing is turned.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> vertices, faces = surface(Box([1, 1, 1]))
    >>> mixed = faces.copy()
    >>> mixed[[2, 5]] = mixed[[2, 5], ::-1]
    >>> turned_alike(vertices, mixed)[1], np.array_equal(turned_alike(vertices, mixed)[0], faces)
    (2, True)
    """
    label = _two_sided(triangles)
    count = len(triangles)
    if label is None:
        return triangles, 0
    mirror = label[count:] < label[:count]  # it and the first triangle of its surface disagree
    surface = np.minimum(label[:count], label[count:])
    turned = np.where(mirror[:, None], triangles[:, ::-1], triangles)
    for k in np.unique(surface[mirror]).tolist():
        mine = surface == k
        point = vertices[turned[mine][0, 0]]
        others = np.unique(surface[~mine]).tolist()
        depth = sum(contains(vertices, turned[surface == other], point) for other in others)
        if (_signed_volume(vertices, turned[mine]) < 0) != bool(depth % 2):
            turned[mine] = turned[mine][:, ::-1]
    return turned, int((turned != triangles).any(axis=1).sum())


def contains(vertices: Array, triangles: Index, point: Array) -> bool:
    """The point is inside the closed shell: its solid angle is not zero."""
    p, q, r = (vertices[triangles[:, k]] - point for k in range(3))
    a, b, c = (np.linalg.norm(x, axis=1) for x in (p, q, r))
    top = np.einsum("ij,ij->i", p, cross(q, r))
    low = a * b * c + (p * q).sum(1) * c + (q * r).sum(1) * a + (r * p).sum(1) * b
    return bool(abs(np.arctan2(top, low).sum()) > np.pi)


def _two_sided(triangles: Index) -> Index | None:
    """Number of the surface of each triangle, and of each triangle turned, shape (2 T,).

    None where some triangle lies on one surface with its own mirror image.
    """
    count = len(triangles)
    following = triangles[:, [1, 2, 0]]
    low, high = np.minimum(triangles, following).ravel(), np.maximum(triangles, following).ravel()
    key = low * (int(high.max()) + 1) + high
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    pairs = first[np.diff(np.append(first, len(order))) == 2]
    one, other = order[pairs], order[pairs + 1]
    forward = (triangles <= following).ravel()
    against = (forward[one] == forward[other]).astype(np.int64)  # one of the two is to be turned
    f, g = one // 3, other // 3
    label = connected(
        2 * count,
        np.concatenate([f, f + count]),
        np.concatenate([g + count * against, g + count * (1 - against)]),
    )
    return None if (label[:count] == label[count:]).any() else label


def _signed_volume(vertices: Array, triangles: Index) -> float:
    p, q, r = (vertices[triangles[:, k]] - vertices[triangles[0, 0]] for k in range(3))
    return float(np.einsum("ij,ij->", p, cross(q, r)) / 6)


def _edges(triangles: Index) -> Index:
    edges: Index = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return edges


def _unmatched(triangles: Index) -> Index:
    return _unmatched_edges(_edges(triangles))


def _unmatched_edges(edges: Index) -> Index:
    """Directed edges (p, q) left over after each is paired with one (q, p)."""
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
    # of a group that does not balance, keep as many as are left over, in their direction
    group = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(key))))[wrong]
    surplus = rows[sign[rows] == np.sign(balance[group])]
    group = group[sign[rows] == np.sign(balance[group])]
    rank = np.arange(len(group)) - np.searchsorted(group, group)
    unmatched: Index = edges[surplus[rank < np.abs(balance[group])]]
    return unmatched


def _merged_close(vertices: Array, distance: float) -> Index:
    """For each vertex the index of the one it becomes when those closer are made one."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(vertices).query_pairs(distance, output_type="ndarray")
    count = len(vertices)
    label = connected(count, *pairs.T)
    first = np.full(label.max() + 1, count)
    np.minimum.at(first, label, np.arange(count))
    return first[label]


def _of_one_place(triangles: Index) -> Mask:
    """Triangles of which two corners are one."""
    a, b, c = triangles.T
    same: Mask = (a == b) | (b == c) | (c == a)
    return same


def flat_faces(vertices: Array, triangles: Index) -> Mask:
    """Triangles whose corners lie on one line, within rounding, or in one place."""
    p, q, r = (vertices[corner] for corner in triangles.T)
    twice = np.linalg.norm(cross(q - p, r - p), axis=1)
    longest = np.maximum.reduce([((u - v) ** 2).sum(axis=1) for u, v in ((p, q), (q, r), (r, p))])
    flat: Mask = _of_one_place(triangles) | (twice <= NO_AREA * longest)
    return flat


def _no_area(vertices: Array, triangles: Index) -> Mask:
    flat = flat_faces(vertices, triangles)
    same = _of_one_place(triangles)
    # a sliver that is all that closes an edge stays: dropping it would open the surface
    if flat.any() and not same[flat].all():
        thin = flat & ~same
        if len(_unmatched(triangles[~flat])) > len(_unmatched(triangles[~same])):
            flat = flat & ~thin
    return flat


def _without_repeats(triangles: Index) -> tuple[Index, int]:
    """Faces listed twice with the same turn, once; an exact duplicate doubles the volume."""
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
    """Open edges cut at the open vertices that lie on them."""
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
