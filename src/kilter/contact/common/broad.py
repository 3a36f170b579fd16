"""Broad phase: pairs of parts, and of their facets, that come near each other.

The boxes lie in a frame that follows the most common directions of the faces, so that a
rotated assembly costs the same as an upright assembly. The boxes of whole parts are compared
first, then only the facets whose box meets the overlap of the boxes of both parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import TINY, Array, Index, Mask, counted, extents, ragged
from kilter.assembly.geometry import Geometry
from kilter.contact.common.facets import Facets
from kilter.contact.contact_tolerances import BOX_ROUNDING
from kilter.errors import InputError
from kilter.rigid import common_frame, common_frames
from kilter.work import stop_if_late

FEW = 64
"""Largest number of parts whose boxes are compared pair by pair, without a tree."""
MOST_LOOPED = 16
"""Largest number of points of a group that are compared by columns."""
MANY = 10_000
"""Number of facet combinations of two parts above which a search tree is used."""
TREE = 500_000
"""Approximate number of boxes in each search tree; a larger value needs more memory."""
LARGE = 2_000
"""Number of rows of a part above which boxes are compared with them one by one."""
BATCH = 2_000_000
"""Number of row combinations that are compared at once; a larger value needs more memory."""
MOST_PAIRS, MOST_NEAR = 500_000, 20
"""Limits on the number of near pairs of parts: in total, and per part; the search rejects an
assembly above both. Walls have 3 pairs per part, packings 10. If all parts lie in the same place,
every two parts are a pair, which needs some kilobytes each."""
SAMPLE = 100
"""Number of boxes whose neighbours are counted to estimate the number of all pairs."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Bounding boxes of parts, shape (N, 3), and of facets, shape (F, 3), all in the same frame.

    `turned` holds the vertices of the geometry in that frame, shape (V, 3). In a search over
    independent assemblies each assembly has its own frame, and `frame`, shape (3, 3), is unused.
    """

    frame: Array
    turned: Array
    part_low: Array
    part_high: Array
    facet_low: Array
    facet_high: Array


def make_boxes(geometry: Geometry, facets: Facets, start: Index | None = None) -> Boxes:
    """Bounding boxes of all parts and facets; those of parts with curved surfaces have a margin.

    The margin is the part's slack, the largest distance of triangles from the true surface.

    `start` holds the first part of each of several independent assemblies; None: a single assembly.
    """
    if start is None:
        frame = common_frame(facets.normal, facets.area)
        turned = geometry.vertices @ frame.T
    else:
        frame = np.eye(3)
        frames = common_frames(facets.normal, facets.area, facets.start[start])
        turned = geometry.vertices
        if (frames != frame).any():
            assembly_of_vertex = np.repeat(
                np.arange(len(frames)), np.diff(geometry.vertex_start[start])
            )
            turned = np.einsum("vij,vj->vi", frames[assembly_of_vertex], geometry.vertices)
    corners = turned[facets.corners]
    part_low, part_high = _extremes(turned, geometry.vertex_start)
    facet_low, facet_high = _extremes(corners, facets.corner_start)
    if len(geometry.surfaces):  # triangles may lie inside the true curved surface
        part_low -= geometry.slack[:, None]
        part_high += geometry.slack[:, None]
        slack = geometry.slack[facets.part]
        facet_low -= slack[:, None]
        facet_high += slack[:, None]
    return Boxes(frame, turned, part_low, part_high, facet_low, facet_high)


def _extremes(points: Array, start: Index) -> tuple[Array, Array]:
    """Lower and upper corner of the bounding box of each group of points, shape (n, 3) each."""
    count = np.diff(start)
    if len(count) and (count == count[0]).all():  # equal runs: several times faster than reduceat
        groups = points.reshape(len(count), count[0], 3)
        if count[0] > MOST_LOOPED:
            return groups.min(axis=1), groups.max(axis=1)
        return extents(groups)
    return np.minimum.reduceat(points, start[:-1]), np.maximum.reduceat(points, start[:-1])


def part_pairs(boxes: Boxes, grounded: Mask, margin: Array) -> Index:
    """Pairs of parts a < b, (n, 2), whose boxes are at most `margin` apart, not both held.

    Raises `InputError` if there are more pairs than `MOST_PAIRS` and `MOST_NEAR` allow.
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
    """Raise an InputError if too many pairs of parts come near each other."""
    if pairs > max(MOST_PAIRS, MOST_NEAR * parts):
        raise InputError(
            f"the boxes of {pairs:,} pairs of {parts:,} parts or more overlap: too many",
            hint="check the positions of the parts, or remove duplicate parts",
        )


def pairs_apart(boxes: Boxes, grounded: Mask, margin: Array, start: Index) -> Index:
    """Pairs of near parts as from `part_pairs`, if several independent assemblies are joined.

    `start` holds the first part of each assembly. There is no limit on the number of pairs.
    """
    few = int(np.diff(start).max(initial=0)) <= FEW
    if few:
        blocks = [_all_pairs(start)]
    else:
        blocks = []
        for first, last in zip(start[:-1].tolist(), start[1:].tolist(), strict=True):
            parts = slice(first, last)
            grown_boxes = (
                boxes.part_low[parts] - margin[parts, None],
                boxes.part_high[parts] + margin[parts, None],
            )
            blocks.append(np.column_stack(_tree_pairs(*grown_boxes)) + first)
    a, b = np.concatenate(blocks).T
    low, high = boxes.part_low - margin[:, None], boxes.part_high + margin[:, None]
    keep = ~(grounded[a] & grounded[b])
    for axis in range(3):
        keep &= (low[a, axis] <= high[b, axis]) & (low[b, axis] <= high[a, axis])
    return np.column_stack([a[keep], b[keep]]).astype(np.int64)


def _all_pairs(start: Index) -> Index:
    """All pairs a < b of rows of the same group, shape (n, 2), in order."""
    count = np.diff(start)
    run, row = counted(count)
    later_rows = count[run] - 1 - row
    first, step = counted(later_rows)
    a = start[run[first]] + row[first]
    return np.column_stack([a, a + 1 + step])


def _tree_pairs(low: Array, high: Array) -> tuple[Index, Index]:
    """Pairs a < b of boxes that overlap or touch each other, found with a search tree.

    The number of pairs is first estimated from `SAMPLE` boxes, and rejected if it is far above
    the limit, before the memory for all pairs is needed.
    """
    boxes = low, high, np.zeros(len(low), dtype=np.int64)
    sample = np.linspace(0, len(low) - 1, SAMPLE, dtype=np.int64)
    near, _ = _tree_join((low[sample], high[sample], boxes[2][sample]), boxes)
    # a fifth of the boxes have at least this many neighbours: a floor, which meets every
    # part, must not raise the estimate
    typical = np.sort(np.bincount(near, minlength=SAMPLE))[-SAMPLE // 5] - 1
    _require_few(int(typical) * len(low) // 10, len(low))
    a, b = _tree_join(boxes, boxes)
    order = a < b
    return a[order], b[order]


def facet_pairs(
    facets: Facets, boxes: Boxes, pairs: Index, margin: Array, cosine: float
) -> tuple[Index, Index, Index]:
    """Pairs of facets, of part a and of part b, that face each other and whose boxes meet.

    `pairs`, shape (n, 2): parts a and b of each pair. `margin`, shape (n,): largest gap between
    facets of the pair that is of interest [length unit]. Returns `pair`, `i`, `j`, shape (m,): row
    in `pairs`, and the two facets.
    """
    blocks = []
    for begin in range(0, len(pairs), 100_000):
        rows = np.arange(begin, min(begin + 100_000, len(pairs)))
        blocks.extend(_facet_pairs_of(facets, boxes, pairs, rows, margin, cosine))
    if not blocks:
        empty = np.empty(0, dtype=np.int64)
        return empty, empty, empty
    pair, i, j = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    return pair, i, j


def _facet_pairs_of(
    facets: Facets, boxes: Boxes, pairs: Index, rows: Index, margin: Array, cosine: float
) -> list[tuple[Index, Index, Index]]:
    """Pairs of facing facets for some rows of `pairs`, in blocks of (pair, facet, facet)."""
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
    """Facets of part ``part[k]`` whose box meets box k, as pairs (k, facet), ordered by k."""
    return boxes_in(facets.start, part, (low, high), (boxes.facet_low, boxes.facet_high))


def boxes_in(
    start: Index, part: Index, box: tuple[Array, Array], boxes: tuple[Array, Array]
) -> tuple[Index, Index]:
    """Rows of part ``part[k]`` whose box meets box k, as pairs (k, row), ordered by k.

    `start`: first row of each part, and the end of the last; `boxes`: lower and upper corners of
    the boxes of all rows. A part with many rows is compared with each box in turn: a comparison
    along an axis leaves few rows for the next.
    """
    (low, high), (least, most) = box, boxes
    large = np.diff(start)[part] > LARGE
    few = np.flatnonzero(~large)
    owner, row = ragged(start, part[few])
    owner = few[owner]
    for axis in range(3):
        meets = least[row, axis] <= high[owner, axis]
        meets &= most[row, axis] >= low[owner, axis]
        owner, row = owner[meets], row[meets]
    owners, rows = [owner], [row]
    columns: dict[int, list[tuple[Array, Array]]] = {}
    for k in np.flatnonzero(large).tolist():
        of_part = int(part[k])
        span = slice(start[of_part], start[of_part + 1])
        if of_part not in columns:
            columns[of_part] = [(least[span, i].copy(), most[span, i].copy()) for i in range(3)]
        (first, last), *others = columns[of_part]
        row = np.flatnonzero((first <= high[k, 0]) & (last >= low[k, 0]))
        for axis, (lower, upper) in enumerate(others, start=1):
            row = row[lower[row] <= high[k, axis]]
            row = row[upper[row] >= low[k, axis]]
        owners.append(np.full(len(row), k))
        rows.append(span.start + row)
    owner, row = np.concatenate(owners), np.concatenate(rows)
    order = np.argsort(owner, kind="stable") if large.any() else slice(None)
    return owner[order], row[order]


def joins(
    owner_a: Index,
    box_a: tuple[Array, Array],
    owner_b: Index,
    box_b: tuple[Array, Array],
    margin: Array,
) -> Iterator[tuple[Index, Index, Index]]:
    """Pairs (row of a, row of b) with the same owner, whose boxes are at most a margin apart.

    `owner_a`, `owner_b`: owner of each row, such as its pair of parts. `margin`, shape (number of
    owners,): largest distance of the boxes along each axis [length unit].
    """
    counts = [np.bincount(owner, minlength=len(margin)) for owner in (owner_a, owner_b)]
    many = counts[0] * counts[1] > MANY
    few_a, few_b = np.flatnonzero(~many[owner_a]), np.flatnonzero(~many[owner_b])
    grow = margin[owner_a]
    sides = [tuple(np.ascontiguousarray(side[:, k]) for side in (*box_a, *box_b)) for k in range(3)]
    for owner, x, y in _products(owner_a[few_a], owner_b[few_b], len(margin)):
        stop_if_late()
        a, b = few_a[x], few_b[y]
        for low_a, high_a, low_b, high_b in sides:
            meets = (low_a - grow)[a] <= high_b[b]
            meets &= low_b[b] <= (high_a + grow)[a]
            a, b, owner = a[meets], b[meets], owner[meets]
        yield owner, a, b
    for owners in _bundles(many, counts[0] + counts[1]):
        stop_if_late()
        a, b = np.flatnonzero(owners[owner_a]), np.flatnonzero(owners[owner_b])
        wide = grow[a, None]
        grown = box_a[0][a] - wide, box_a[1][a] + wide, owner_a[a]
        plain = box_b[0][b], box_b[1][b], owner_b[b]
        x, y = _tree_join(grown, plain)
        yield owner_a[a[x]], a[x], b[y]


def _bundles(many: Mask, count: Index) -> Iterator[Mask]:
    """Group the owners with many rows so that a group has about `TREE` rows; yield masks."""
    rows = np.flatnonzero(many)
    bundle = np.cumsum(count[rows]) // TREE  # ascending
    for part in np.split(rows, np.flatnonzero(np.diff(bundle)) + 1) if len(rows) else ():
        owners = np.zeros(len(many), dtype=bool)
        owners[part] = True
        yield owners


def _products(owner_a: Index, owner_b: Index, count: int) -> Iterator[tuple[Index, Index, Index]]:
    """Yield (owner, index in a, index in b) for all pairs with equal owner, in batches."""
    first_b = np.searchsorted(owner_b, np.arange(count + 1))
    width_of_row = np.diff(first_b)[owner_a]  # number of rows of b with the owner of each row of a
    combinations_up_to = np.cumsum(width_of_row)
    begin = 0
    while begin < len(owner_a):
        before = combinations_up_to[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(combinations_up_to, before + BATCH, side="right")))
        rows = np.arange(begin, end)
        width = width_of_row[rows]
        row, k = counted(width)
        row_a = rows[row]
        if len(row_a):
            yield owner_a[row_a], row_a, first_b[owner_a[row_a]] + k
        begin = end


_OwnedBoxes = tuple[Array, Array, Index]
"""Lower and upper corners of boxes, shape (n, 3), and the owner of each box, shape (n,)."""


def _tree_join(first: _OwnedBoxes, second: _OwnedBoxes) -> tuple[Index, Index]:
    """Pairs of rows, of equal owner, whose boxes meet, found by a tree in the plane.

    The tree uses the two axes along which the boxes are smallest relative to their total extent.
    Owners are placed next to each other along the first of these axes. The comparison of the boxes
    themselves decides.
    """
    import shapely

    near_a = _near_others(first, second)
    first = _taken(first, near_a)
    near_b = _near_others(second, first)
    (low_a, high_a, owner_a), (low_b, high_b, owner_b) = first, _taken(second, near_b)
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

    def rectangles_of(least: Array, most: Array, place: Index) -> NDArray[np.object_]:
        # fractions of the total extent: their rounding is far below BOX_ROUNDING
        x0, x1 = ((corner[:, u] - low[u]) / spread[u] + 2 * place for corner in (least, most))
        y0, y1 = ((corner[:, v] - low[v]) / spread[v] for corner in (least, most))
        corners = [[x0 - BOX_ROUNDING, y0 - BOX_ROUNDING], [x1 + BOX_ROUNDING, y1 + BOX_ROUNDING]]
        # the tree compares the boxes of the diagonals, which cost less than polygons
        diagonals: NDArray[np.object_] = shapely.linestrings(np.array(corners).transpose(2, 0, 1))
        return diagonals

    place_a, place_b = np.split(place, [len(owner_a)])
    a, b = shapely.STRtree(rectangles_of(low_b, high_b, place_b)).query(
        rectangles_of(low_a, high_a, place_a)
    )
    meets = owner_a[a] == owner_b[b]
    a, b = a[meets], b[meets]
    for k in range(3):  # a test of whole columns is several times faster than one of short rows
        meets = (low_a[:, k][a] <= high_b[:, k][b]) & (low_b[:, k][b] <= high_a[:, k][a])
        a, b = a[meets], b[meets]
    return near_a[a], near_b[b]


def _taken(boxes: _OwnedBoxes, rows: Index) -> _OwnedBoxes:
    """The boxes of the given rows, with their owners."""
    low, high, owner = boxes
    return low[rows], high[rows], owner[rows]


def _near_others(boxes: _OwnedBoxes, others: _OwnedBoxes) -> Index:
    """Rows of boxes that meet the common box of all other boxes of their owner, ascending.

    Two large meshes that meet in a small area have few such rows, and a tree of all rows costs
    far more than this comparison. The owners of `others` are sorted.
    """
    low, high, owner = boxes
    first = np.flatnonzero(np.diff(others[2], prepend=-1))
    if not len(first):
        return first
    owners = others[2][first]
    row = np.minimum(np.searchsorted(owners, owner), len(owners) - 1)
    least, most = np.minimum.reduceat(others[0], first), np.maximum.reduceat(others[1], first)
    meets = (low <= most[row]) & (least[row] <= high)
    return np.flatnonzero(meets.all(axis=1) & (owners[row] == owner))
