"""Triangles of a mesh grouped into flat facets, and which facets meet along a shallow edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross

__all__ = ["STEEPEST", "FacetGraph", "facet_graph", "gathered"]


STEEPEST = np.radians(30.5)
"""Facets that meet at more than this belong to different faces [rad]: a prism of 12 even sides
has 30 degrees, one of 11 has 32.7."""
FLAT = 1e-9
"""Corners closer to a plane than this part of the size are on it, whatever their accuracy."""
ROUNDINGS = 4.0
"""Times the accuracy of a coordinate that a corner may be off the plane of its neighbour."""


@dataclass(frozen=True, slots=True, eq=False)
class FacetGraph:
    """Facets of a mesh: connected triangles in one plane.

    Attributes
    ----------
    facet : ndarray, shape (T,)
        Facet of each triangle.
    triangles_of : ndarray, shape (T,)
        Triangles ordered by facet; those of facet f are rows ``start[f]`` to ``start[f + 1]``.
    start : ndarray, shape (F + 1,)
    normal : ndarray, shape (F, 3)
        Unit, outward.
    area : ndarray, shape (F,)
    neighbours : ndarray, shape (E,)
        Facets across shallow edges; those of facet f are rows ``first[f]`` to ``first[f + 1]``.
    first : ndarray, shape (F + 1,)
    region : ndarray, shape (F,)
        Facets that are connected over shallow edges share a number.
    tolerance : float
        How far a corner may be off a plane or surface that it lies on [length unit].
    """

    facet: Index
    triangles_of: Index
    start: Index
    normal: Array
    area: Array
    neighbours: Index
    first: Index
    region: Index
    tolerance: float


def facet_graph(vertices: Array, triangles: Index, accuracy: float) -> FacetGraph:
    """Facets of a mesh and how they meet."""
    size = float(np.ptp(vertices, axis=0).max(initial=0.0))
    largest = float(np.abs(vertices).max(initial=0.0))
    tolerance = max(ROUNDINGS * max(accuracy, largest * 2.0**-52), FLAT * size)
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    turn = cross(q - p, r - p)
    double = np.linalg.norm(turn, axis=1)
    normal = turn / np.maximum(double, np.finfo(float).tiny)[:, None]
    pairs, edge = _meeting(_welded(vertices, triangles))
    flat = _flat(vertices, triangles, normal, double, pairs, edge, tolerance)
    facet = _components(pairs[flat], len(triangles))
    facet = _without_drift(vertices, triangles, turn, facet, tolerance)
    count = int(facet.max(initial=-1)) + 1
    summed = np.column_stack([np.bincount(facet, turn[:, k], count) for k in range(3)])
    unit = summed / np.maximum(np.linalg.norm(summed, axis=1), np.finfo(float).tiny)[:, None]
    order = np.argsort(facet, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(facet, minlength=count))])
    near = facet[pairs]
    near = near[near[:, 0] != near[:, 1]]
    near = near[(unit[near[:, 0]] * unit[near[:, 1]]).sum(axis=1) > np.cos(STEEPEST)]
    key = np.sort(np.concatenate([near @ [count, 1], near @ [1, count]]))
    key = key[np.diff(key, prepend=-1) > 0]
    both = np.column_stack([key // max(count, 1), key % max(count, 1)])
    first = np.concatenate([[0], np.cumsum(np.bincount(both[:, 0], minlength=count))])
    region = _components(near, count)
    area: Array = np.bincount(facet, double / 2, count).astype(np.float64)
    return FacetGraph(
        facet, order, start, unit, area, both[:, 1], first.astype(np.int64), region, tolerance
    )


def gathered(rows: Index, start: Index, values: Index) -> Index:
    """The values of several rows of a ragged array, one after the other.

    Examples
    --------
    >>> gathered(np.array([2, 0]), np.array([0, 1, 3, 5]), np.array([7, 8, 9, 4, 6]))
    array([4, 6, 7])
    """
    length = start[rows + 1] - start[rows]
    ends = np.cumsum(length)
    offset = np.repeat(start[rows] - ends + length, length)
    found: Index = values[np.arange(ends[-1] if len(ends) else 0) + offset]
    return found


def _welded(vertices: Array, triangles: Index) -> Index:
    """Triangles by distinct corners: those in one place are one."""
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    fresh = np.ones(len(vertices), dtype=bool)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    place = np.empty(len(vertices), dtype=np.int64)
    place[order] = np.cumsum(fresh) - 1
    welded: Index = place[triangles]
    return welded


def _meeting(triangles: Index) -> tuple[Index, Index]:
    """Pairs of triangles with an edge that is theirs alone, and the edge's place in each."""
    ends = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = ends.min(axis=1) * (int(triangles.max(initial=0)) + 1) + ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    same = ordered[1:] == ordered[:-1]
    alone = same.copy()
    alone[1:] &= ~same[:-1]
    alone[:-1] &= ~same[1:]
    at = np.flatnonzero(alone)
    rows = np.column_stack([order[at], order[at + 1]])
    return rows // 3, rows % 3


def _flat(
    vertices: Array,
    triangles: Index,
    normal: Array,
    double: Array,
    pairs: Index,
    edge: Index,
    tolerance: float,
) -> Mask:
    """Pairs in one plane: the far corner of the smaller lies in the plane of the larger.

    And their normals agree, where the smaller is wide enough to have one.
    """
    small = np.argmin(double[pairs], axis=1)
    k = np.arange(len(pairs))
    less, more = pairs[k, small], pairs[k, 1 - small]
    far = triangles[less, (edge[k, small] + 2) % 3]
    near = triangles[less, edge[k, small]]
    off = np.abs(((vertices[far] - vertices[near]) * normal[more]).sum(axis=1))
    length = np.linalg.norm(
        vertices[triangles[less, (edge[k, small] + 1) % 3]] - vertices[near], axis=1
    )
    high = double[less] / np.maximum(length, np.finfo(float).tiny)
    turned = (normal[less] * normal[more]).sum(axis=1) > np.cos(STEEPEST)
    flat: Mask = (off <= tolerance) & (turned | (high <= 10 * tolerance))
    return flat


def _without_drift(
    vertices: Array, triangles: Index, turn: Array, facet: Index, tolerance: float
) -> Index:
    """Facets taken apart into their triangles where corners leave the facet's own plane."""
    count = int(facet.max(initial=-1)) + 1
    summed = np.column_stack([np.bincount(facet, turn[:, k], count) for k in range(3)])
    unit = summed / np.maximum(np.linalg.norm(summed, axis=1), np.finfo(float).tiny)[:, None]
    _, one = np.unique(facet, return_index=True)
    off = np.zeros(count)
    for k in range(3):
        relative = vertices[triangles[:, k]] - vertices[triangles[one, 0]][facet]
        np.maximum.at(off, facet, np.abs((relative * unit[facet]).sum(axis=1)))
    bent = (off > ROUNDINGS * tolerance)[facet]
    label = np.where(bent, count + np.arange(len(facet)), facet)
    return np.unique(label, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _components(pairs: Index, count: int) -> Index:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    label: Index = connected_components(graph, directed=False)[1].astype(np.int64)
    return label
