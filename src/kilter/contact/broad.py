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

from kilter.arrays import TINY, Array, Index, Mask, counted, ragged
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import BOX_ROUNDING
from kilter.contact.planar.facets import Facets
from kilter.errors import InputError
from kilter.rigid import common_frame, common_frames

__all__ = ["Boxes", "facet_pairs", "facets_in", "joins", "make_boxes", "pairs_apart", "part_pairs"]


FEW = 64
"""Up to this many parts all pairs are compared."""
MANY = 10_000
"""Pairs of parts with more combinations of their facets than this go through a tree."""
TREE = 500_000
"""Boxes of one tree."""
BATCH = 2_000_000
"""Combinations compared in one go."""
MOST_PAIRS, MOST_NEAR = 500_000, 20
"""Pairs of parts that are looked at: so many, or so many for each part. Walls have 3 for each,
packings 10; parts that lie in one another have all with all, at some kilobytes a pair."""
SAMPLE = 100
"""Boxes whose neighbours are counted before those of all are listed."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes of parts, shape (N, 3), and of facets, shape (F, 3), in a common frame.

    `turned`: the vertices of the geometry in that frame, shape (V, 3). Of assemblies side by
    side each has a frame of its own, and `frame`, shape (3, 3), says nothing.
    """

    frame: Array
    turned: Array
    part_low: Array
    part_high: Array
    facet_low: Array
    facet_high: Array


def make_boxes(geometry: Geometry, facets: Facets, start: Index | None = None) -> Boxes:
    """Boxes of all parts and facets; `start`: of assemblies side by side, each one's first part."""
    if start is None:
        frame = common_frame(facets.normal, facets.area)
        turned = geometry.vertices @ frame.T
    else:
        frame = np.eye(3)
        frames = common_frames(facets.normal, facets.area, facets.start[start])
        place = np.repeat(np.arange(len(frames)), np.diff(geometry.vertex_start[start]))
        turned = np.einsum("vij,vj->vi", frames[place], geometry.vertices)
    corners = turned[facets.corners]
    part_low, part_high = _extremes(turned, geometry.vertex_start)
    facet_low, facet_high = _extremes(corners, facets.corner_start)
    if len(geometry.surfaces):  # their polyhedra may lie inside the true surfaces
        part_low -= geometry.slack[:, None]
        part_high += geometry.slack[:, None]
        slack = geometry.slack[facets.part]
        facet_low -= slack[:, None]
        facet_high += slack[:, None]
    return Boxes(frame, turned, part_low, part_high, facet_low, facet_high)


def _extremes(points: Array, start: Index) -> tuple[Array, Array]:
    """Lower and upper corners of the boxes of groups of points, shape (n, 3) each."""
    count = np.diff(start)
    if len(count) and (count == count[0]).all():  # boxes: several times faster than reduceat
        groups = points.reshape(len(count), count[0], 3)
        return groups.min(axis=1), groups.max(axis=1)
    return np.minimum.reduceat(points, start[:-1]), np.maximum.reduceat(points, start[:-1])


def part_pairs(boxes: Boxes, grounded: Mask, margin: Array) -> Index:
    """Pairs (a, b), a < b, not both held, whose boxes, grown by `margin`, meet; shape (n, 2).

    Raises
    ------
    InputError
        If they are more than are looked at.
    """
    low, high = boxes.part_low - margin[:, None], boxes.part_high + margin[:, None]
    count = len(low)
    if count <= FEW:
        a, b = np.triu_indices(count, 1)
    else:
        a, b = _tree_pairs(low, high)
    keep = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
    keep &= ~(grounded[a] & grounded[b])
    _require_few(int(keep.sum()), count)
    return np.column_stack([a[keep], b[keep]]).astype(np.int64)


def _require_few(pairs: int, parts: int) -> None:
    if pairs > max(MOST_PAIRS, MOST_NEAR * parts):
        raise InputError(
            f"{pairs:,} pairs of {parts:,} parts or more lie in each other's boxes: too many",
            hint="check the places of the parts, or leave copies out",
        )


def pairs_apart(boxes: Boxes, grounded: Mask, margin: Array, start: Index) -> Index:
    """Such pairs within each of assemblies side by side, `start`: the first part of each."""
    few = int(np.diff(start).max(initial=0)) <= FEW
    if few:
        blocks = [_all_pairs(start)]
    else:
        blocks = []
        for first, last in zip(start[:-1].tolist(), start[1:].tolist(), strict=True):
            own = slice(first, last)
            mine = boxes.part_low[own] - margin[own, None], boxes.part_high[own] + margin[own, None]
            blocks.append(np.column_stack(_tree_pairs(*mine)) + first)
    a, b = np.concatenate(blocks).T
    low, high = boxes.part_low - margin[:, None], boxes.part_high + margin[:, None]
    keep = ~(grounded[a] & grounded[b])
    for axis in range(3):
        keep &= (low[a, axis] <= high[b, axis]) & (low[b, axis] <= high[a, axis])
    return np.column_stack([a[keep], b[keep]]).astype(np.int64)


def _all_pairs(start: Index) -> Index:
    """Pairs a < b of the rows of each run, shape (n, 2), in order."""
    count = np.diff(start)
    run, row = counted(count)
    after = count[run] - 1 - row
    first, step = counted(after)
    a = start[run[first]] + row[first]
    return np.column_stack([a, a + 1 + step])


def _tree_pairs(low: Array, high: Array) -> tuple[Index, Index]:
    """Pairs a < b of boxes that meet; refused from a sample where there are far too many."""
    boxes = low, high, np.zeros(len(low), dtype=np.int64)
    some = np.linspace(0, len(low) - 1, SAMPLE, dtype=np.int64)
    near, _ = _tree_join((low[some], high[some], boxes[2][some]), boxes)
    # what a fifth of all have at least; a floor may meet all the others
    least = np.sort(np.bincount(near, minlength=SAMPLE))[-SAMPLE // 5] - 1
    _require_few(int(least) * len(low) // 10, len(low))
    a, b = _tree_join(boxes, boxes)
    order = a < b
    return a[order], b[order]


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
        found.extend(_facet_pairs(facets, boxes, pairs, rows, margin, cosine))
    if not found:
        empty = np.empty(0, dtype=np.int64)
        return empty, empty, empty
    pair, i, j = (np.concatenate([block[k] for block in found]) for k in range(3))
    return pair, i, j


def _facet_pairs(
    facets: Facets, boxes: Boxes, pairs: Index, rows: Index, margin: Array, cosine: float
) -> list[tuple[Index, Index, Index]]:
    a, b = pairs[rows].T
    grow = margin[rows][:, None]
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
    near_a = facets_in(facets, boxes, a, low, high)
    near_b = facets_in(facets, boxes, b, low, high)
    blocks = []
    box_a = boxes.facet_low[near_a[1]], boxes.facet_high[near_a[1]]
    box_b = boxes.facet_low[near_b[1]], boxes.facet_high[near_b[1]]
    for pair, x, y in joins(near_a[0], box_a, near_b[0], box_b, margin[rows]):
        i, j = near_a[1][x], near_b[1][y]
        keep = np.einsum("ij,ij->i", facets.normal[i], facets.normal[j]) <= -cosine
        blocks.append((rows[pair[keep]], i[keep], j[keep]))
    return blocks


def facets_in(
    facets: Facets, boxes: Boxes, part: Index, low: Array, high: Array
) -> tuple[Index, Index]:
    """Facets of ``part[k]`` whose box meets box k: pairs (k, facet), ordered by k."""
    owner, facet = ragged(facets.start, part)
    keep = np.ones(len(owner), dtype=bool)
    for axis in range(3):
        keep &= boxes.facet_low[facet, axis] <= high[owner, axis]
        keep &= boxes.facet_high[facet, axis] >= low[owner, axis]
    return owner[keep], facet[keep]


def joins(
    owner_a: Index,
    box_a: tuple[Array, Array],
    owner_b: Index,
    box_b: tuple[Array, Array],
    margin: Array,
) -> Iterator[tuple[Index, Index, Index]]:
    """Rows of a and b that have the same owner and whose boxes come within a margin.

    Parameters
    ----------
    owner_a, owner_b : ndarray of int, sorted
        Owner of each row.
    box_a, box_b : pair of ndarray, shape (n, 3)
        Lower and upper corners.
    margin : ndarray, shape (number of owners,)

    Yields
    ------
    owner, row_a, row_b : ndarrays of int, shape (m,)
        About `BATCH` combinations are compared at once; owners with more than `MANY` of
        their own go through trees of about `TREE` boxes.
    """
    counts = [np.bincount(owner, minlength=len(margin)) for owner in (owner_a, owner_b)]
    many = counts[0] * counts[1] > MANY
    few_a, few_b = np.flatnonzero(~many[owner_a]), np.flatnonzero(~many[owner_b])
    grow = margin[owner_a]
    sides = [tuple(np.ascontiguousarray(side[:, k]) for side in (*box_a, *box_b)) for k in range(3)]
    for owner, x, y in _products(owner_a[few_a], owner_b[few_b], len(margin)):
        a, b = few_a[x], few_b[y]
        for low_a, high_a, low_b, high_b in sides:
            meets = (low_a - grow)[a] <= high_b[b]
            meets &= low_b[b] <= (high_a + grow)[a]
            a, b, owner = a[meets], b[meets], owner[meets]
        yield owner, a, b
    for owners in _bundles(many, counts[0] + counts[1]):
        a, b = np.flatnonzero(owners[owner_a]), np.flatnonzero(owners[owner_b])
        wide = grow[a, None]
        one = box_a[0][a] - wide, box_a[1][a] + wide, owner_a[a]
        other = box_b[0][b], box_b[1][b], owner_b[b]
        x, y = _tree_join(one, other)
        yield owner_a[a[x]], a[x], b[y]


def _bundles(many: Mask, count: Index) -> Iterator[Mask]:
    """The owners that go through a tree, some at a time."""
    rows = np.flatnonzero(many)
    for number in np.unique(bundle := np.cumsum(count[rows]) // TREE):
        chosen = np.zeros(len(many), dtype=bool)
        chosen[rows[bundle == number]] = True
        yield chosen


def _products(owner_a: Index, owner_b: Index, count: int) -> Iterator[tuple[Index, Index, Index]]:
    """All combinations of the rows of a and b that have the same owner, batch by batch."""
    first_b = np.searchsorted(owner_b, np.arange(count + 1))
    width_of_row = np.diff(first_b)[owner_a]  # how many rows of b each row of a meets
    behind = np.cumsum(width_of_row)
    begin = 0
    while begin < len(owner_a):
        before = behind[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(behind, before + BATCH, side="right")))
        rows = np.arange(begin, end)
        width = width_of_row[rows]
        row, k = counted(width)
        row_a = rows[row]
        if len(row_a):
            yield owner_a[row_a], row_a, first_b[owner_a[row_a]] + k
        begin = end


_Boxed = tuple[Array, Array, Index]
"""Lower and upper corners of boxes, shape (n, 3), and their owners, shape (n,)."""


def _tree_join(one: _Boxed, other: _Boxed) -> tuple[Index, Index]:
    """Rows whose boxes meet and whose owner is the same, by one tree.

    The tree lies in the two directions of least crowding, with the owners side by side in one
    of them; the boxes themselves decide.
    """
    import shapely

    (low_a, high_a, owner_a), (low_b, high_b, owner_b) = one, other
    if not (len(low_a) and len(low_b)):
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    low, high = (
        np.minimum(low_a.min(axis=0), low_b.min(axis=0)),
        np.maximum(high_a.max(axis=0), high_b.max(axis=0)),
    )
    spread = np.maximum(high - low, TINY)
    crowding = ((high_a - low_a).mean(axis=0) + (high_b - low_b).mean(axis=0)) / spread
    u, v = np.argsort(crowding)[:2]
    _, place = np.unique(np.concatenate([owner_a, owner_b]), return_inverse=True)

    def flat(least: Array, most: Array, place: Index) -> NDArray[np.object_]:
        # shares of the spread: their rounding is far below what they are grown by
        x0, x1 = ((corner[:, u] - low[u]) / spread[u] + 2 * place for corner in (least, most))
        y0, y1 = ((corner[:, v] - low[v]) / spread[v] for corner in (least, most))
        made: NDArray[np.object_] = shapely.box(
            x0 - BOX_ROUNDING, y0 - BOX_ROUNDING, x1 + BOX_ROUNDING, y1 + BOX_ROUNDING
        )
        return made

    mine, its = np.split(place, [len(owner_a)])
    a, b = shapely.STRtree(flat(low_b, high_b, its)).query(flat(low_a, high_a, mine))
    meets = ((low_a[a] <= high_b[b]) & (low_b[b] <= high_a[a])).all(axis=1)
    meets &= owner_a[a] == owner_b[b]
    return a[meets].astype(np.int64), b[meets].astype(np.int64)
