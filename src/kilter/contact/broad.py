"""Broad phase: which parts, and which of their facets, come near each other.

Boxes in a frame that follows the most common directions of the faces, so that a turned
assembly costs what an upright one costs. First the boxes of whole parts, then only the
facets whose box meets the overlap of the two parts' boxes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.contact.facets import Facets
from kilter.geometry import Geometry

__all__ = ["Boxes", "facet_pairs", "facets_in", "make_boxes", "part_pairs", "products"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FEW = 64
"""Up to this many parts all pairs are compared."""
MANY = 2_000_000
"""Pairs of parts whose facets make more candidates than this go through a tree."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes of parts, shape (N, 3), and of facets, shape (F, 3), in a common frame."""

    frame: Array
    part_low: Array
    part_high: Array
    facet_low: Array
    facet_high: Array


def make_boxes(geometry: Geometry, facets: Facets) -> Boxes:
    """Boxes of all parts and facets."""
    frame = common_frame(facets.normal, facets.area)
    turned = geometry.vertices @ frame.T
    corners = turned[facets.corners]
    return Boxes(
        frame=frame,
        part_low=np.minimum.reduceat(turned, geometry.vertex_start[:-1]),
        part_high=np.maximum.reduceat(turned, geometry.vertex_start[:-1]),
        facet_low=np.minimum.reduceat(corners, facets.corner_start[:-1]),
        facet_high=np.maximum.reduceat(corners, facets.corner_start[:-1]),
    )


def common_frame(normals: Array, areas: Array) -> Array:
    """Rotation whose rows are the most common directions of the normals, shape (3, 3).

    Examples
    --------
    >>> common_frame(np.eye(3), np.array([1., 1., 2.]))[0]
    array([0., 0., 1.])
    """
    step = max(1, len(normals) // 20_000)
    normals, areas = normals[::step], areas[::step]
    strongest = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, None], axis=1)
    normals = normals * np.where(strongest < 0, -1.0, 1.0)
    first = _most_common(normals, areas)
    square = np.abs(normals @ first) < 1e-3
    second = (
        _most_common(normals[square], areas[square])
        if square.any()
        else np.eye(3)[np.argmin(np.abs(first))]
    )
    second = second - (second @ first) * first
    second /= np.linalg.norm(second)
    return np.array([first, second, np.cross(first, second)])


def _most_common(normals: Array, areas: Array) -> Array:
    _, label = np.unique(np.round(normals, 5), axis=0, return_inverse=True)
    label = label.reshape(-1)
    best = np.argmax(np.bincount(label, weights=areas))
    chosen: Array = normals[np.argmax(np.where(label == best, areas, -1.0))]
    return chosen


def part_pairs(boxes: Boxes, grounded: NDArray[np.bool_], margin: Array) -> Index:
    """Pairs (a, b), a < b, not both held, whose boxes, grown by `margin`, meet; shape (n, 2)."""
    low, high = boxes.part_low - margin[:, None], boxes.part_high + margin[:, None]
    count = len(low)
    if count <= FEW:
        a, b = np.triu_indices(count, 1)
    else:
        a, b = _tree_pairs(low, high)
    keep = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
    keep &= ~(grounded[a] & grounded[b])
    return np.column_stack([a[keep], b[keep]]).astype(np.int64)


def _tree_pairs(low: Array, high: Array) -> tuple[Index, Index]:
    """Pairs a < b of boxes that meet in the two directions in which they crowd least."""
    import shapely

    crowding = (high - low).mean(axis=0) / np.maximum(np.ptp(low, axis=0), 1e-300)
    u, v = np.argsort(crowding)[:2]
    shapes = shapely.box(low[:, u], low[:, v], high[:, u], high[:, v])
    a, b = shapely.STRtree(shapes).query(shapes)
    order = a < b
    return a[order].astype(np.int64), b[order].astype(np.int64)


def facet_pairs(
    facets: Facets, boxes: Boxes, pairs: Index, margin: Array, cosine: float
) -> tuple[Index, Index, Index]:
    """Facets i of a and j of b that oppose each other and whose boxes meet.

    Parameters
    ----------
    pairs : ndarray of int, shape (n, 2)
    margin : ndarray, shape (n,)
        Distance within which a pair is looked at [length unit].
    cosine : float
        Of the largest angle between opposing facets.

    Returns
    -------
    pair, i, j : ndarrays of int, shape (m,)
    """
    found = []
    for begin in range(0, len(pairs), 100_000):
        rows = np.arange(begin, min(begin + 100_000, len(pairs)))
        found.append(_facet_pairs(facets, boxes, pairs, rows, margin, cosine))
    if not found:
        empty = np.empty(0, dtype=np.int64)
        return empty, empty, empty
    pair, i, j = (np.concatenate([block[k] for block in found]) for k in range(3))
    return pair, i, j


def _facet_pairs(
    facets: Facets, boxes: Boxes, pairs: Index, rows: Index, margin: Array, cosine: float
) -> tuple[Index, Index, Index]:
    a, b = pairs[rows].T
    grow = margin[rows][:, None]
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
    near_a = facets_in(facets, boxes, a, low, high)
    near_b = facets_in(facets, boxes, b, low, high)
    count_a, count_b = (np.bincount(near[0], minlength=len(rows)) for near in (near_a, near_b))
    many = count_a * count_b > MANY
    few_a, few_b = ~many[near_a[0]], ~many[near_b[0]]
    blocks = []
    for pair, x, y in products(near_a[0][few_a], near_b[0][few_b], len(rows), MANY):
        i, j = near_a[1][few_a][x], near_b[1][few_b][y]
        keep = _oppose(facets, boxes, i, j, margin[rows][pair], cosine)
        blocks.append((pair[keep], i[keep], j[keep]))
    for k in np.flatnonzero(many):
        mine, other = near_a[1][near_a[0] == k], near_b[1][near_b[0] == k]
        i, j = _facet_tree(boxes, mine, other, float(margin[rows[k]]))
        keep = _oppose(facets, boxes, i, j, np.full(len(i), margin[rows[k]]), cosine)
        blocks.append((np.full(int(keep.sum()), k), i[keep], j[keep]))
    if not blocks:
        empty = np.empty(0, dtype=np.int64)
        return empty, empty, empty
    pair, i, j = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    return rows[pair], i, j


def facets_in(
    facets: Facets, boxes: Boxes, part: Index, low: Array, high: Array
) -> tuple[Index, Index]:
    """Facets of ``part[k]`` whose box meets box k: pairs (k, facet), ordered by k."""
    count = facets.start[part + 1] - facets.start[part]
    owner = np.repeat(np.arange(len(part)), count)
    facet = np.arange(len(owner)) + np.repeat(
        facets.start[part] - (np.cumsum(count) - count), count
    )
    keep = np.ones(len(owner), dtype=bool)
    for axis in range(3):
        keep &= boxes.facet_low[facet, axis] <= high[owner, axis]
        keep &= boxes.facet_high[facet, axis] >= low[owner, axis]
    return owner[keep], facet[keep]


def products(
    owner_a: Index, owner_b: Index, count: int, batch: int
) -> Iterator[tuple[Index, Index, Index]]:
    """All combinations of the rows of a and b that have the same owner, batch by batch.

    Parameters
    ----------
    owner_a, owner_b : ndarray of int, sorted
        Owner, below `count`, of each row.
    batch : int
        About how many combinations to give at once.

    Yields
    ------
    owner, row_a, row_b : ndarrays of int, shape (m,)
    """
    first_b = np.searchsorted(owner_b, np.arange(count + 1))
    width_of_row = np.diff(first_b)[owner_a]  # how many rows of b each row of a meets
    behind = np.cumsum(width_of_row)
    begin = 0
    while begin < len(owner_a):
        before = behind[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(behind, before + batch, side="right")))
        rows = np.arange(begin, end)
        width = width_of_row[rows]
        row_a = np.repeat(rows, width)
        k = np.arange(len(row_a)) - np.repeat(np.cumsum(width) - width, width)
        if len(row_a):
            yield owner_a[row_a], row_a, first_b[owner_a[row_a]] + k
        begin = end


def _facet_tree(boxes: Boxes, mine: Index, other: Index, margin: float) -> tuple[Index, Index]:
    import shapely

    spread = np.argsort(np.ptp(boxes.facet_low[other], axis=0))[1:]

    def flat(which: Index, grow: float) -> NDArray[np.object_]:
        low, high = (
            boxes.facet_low[which][:, spread] - grow,
            boxes.facet_high[which][:, spread] + grow,
        )
        made: NDArray[np.object_] = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
        return made

    a, b = shapely.STRtree(flat(other, 0.0)).query(flat(mine, margin))
    return mine[a], other[b]


def _oppose(
    facets: Facets, boxes: Boxes, i: Index, j: Index, margin: Array, cosine: float
) -> NDArray[np.bool_]:
    """Pairs of facets that face each other and whose boxes meet."""
    keep = np.einsum("ij,ij->i", facets.normal[i], facets.normal[j]) <= -cosine
    rows = np.flatnonzero(keep)
    for axis in range(3):
        k, grow = rows, margin[rows]
        meets = (boxes.facet_low[i[k], axis] <= boxes.facet_high[j[k], axis] + grow) & (
            boxes.facet_low[j[k], axis] <= boxes.facet_high[i[k], axis] + grow
        )
        rows = rows[meets]
    result = np.zeros(len(i), dtype=bool)
    result[rows] = True
    return result
