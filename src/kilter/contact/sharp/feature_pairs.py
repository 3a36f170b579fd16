"""Points at which corners and edges of a part come near features of another part.

The corners of an area of contact are corners of one part on the other, and crossings of edges; for
rigid parts no other point is needed (the paper, section 2.1). A corner within tolerance of a corner
is not compared with edges, a corner on an edge is not compared with facets, and a crossing lies
inside both of its edges: each point is found once.

An edge within tolerance of a facet that is tilted by less than the angle that counts as flat lies
on the facet with its whole length there, as a face on a face does: both ends of that length are
returned, although their gap is larger.

Near faces are recorded when facets are intersected; a corner over a face, or an edge beside an
edge, is not. Only pairs without a contact and without near faces are searched, within `LOOSE_GAP`
of the size of the smaller part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, cross, ragged, ratio
from kilter.assembly.geometry import Geometry
from kilter.contact.common.broad import Boxes, facets_in, joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import segment_distance
from kilter.contact.common.edges import Edges, find_edges
from kilter.contact.common.facets import Facets, facet_triangles
from kilter.contact.common.gaps import APART, RejectedPair
from kilter.contact.common.polygons import MANY_TRIANGLES
from kilter.contact.contact_tolerances import (
    EDGE_NEARLY_PARALLEL,
    EDGE_PARALLEL,
    FACET_FLATNESS,
    LOOSE_GAP,
)

_Side = tuple[Index, Index]
"""Features near one side of the pairs: rows of the pair block, and indices of the features."""

FACE, EDGE, CORNER = 0, 1, 2
"""Kinds of features of a part."""


@dataclass(frozen=True, slots=True, eq=False)
class Meetings(Rows):
    """Points at which a feature (face, edge, corner) of a part comes near one of another part."""

    pair: Index
    """Row of the pair of parts, shape (n,)."""
    kind: Index = columns(2)
    feature: Index = columns(2)
    """FACE, EDGE or CORNER of part a and of part b, and its row, shape (n, 2)."""
    at: Array = columns(2, 3)
    """Nearest points on a and on b [length unit], shape (n, 2, 3)."""

    @property
    def middle(self) -> Array:
        """Points half-way between the nearest points of both parts, shape (n, 3)."""
        half: Array = (self.at[:, 0] + self.at[:, 1]) / 2
        return half


@dataclass(frozen=True, slots=True, eq=False)
class PairBlock:
    """Block of pairs of parts for the search of edge contacts, each with a box to search in.

    `edges` are the edges of all their parts, `rows` the rows of the pairs, shape (n,), `tolerance`
    the largest gaps, shape (n,), and `low`, `high`, shape (n, 3), the boxes in the frame of the
    part boxes.
    """

    search: ContactSearch
    edges: Edges
    rows: Index
    tolerance: Array
    low: Array
    high: Array

    @property
    def geometry(self) -> Geometry:
        """Geometry of all parts."""
        return self.search.geometry

    @property
    def facets(self) -> Facets:
        """Facets of all parts."""
        return self.search.facets

    @property
    def boxes(self) -> Boxes:
        """Boxes of all parts and facets."""
        return self.search.boxes

    def facets_near(self, part: Index) -> _Side:
        """Flat facets of part ``part[k]`` in the box of pair k: pairs (k, facet)."""
        owner, facet = facets_in(self.facets, self.boxes, part, self.low, self.high)
        flat = ~self.facets.curved[facet]
        flat &= (self.facets.normal[facet] != 0).any(axis=1)  # a sliver has no normal
        return owner[flat], facet[flat]

    def edges_near(self, part: Index) -> _Side:
        """Edges of part ``part[k]`` beside a flat facet, in the box of pair k: pairs (k, edge)."""
        owner, edge = self.edges.inside(self.boxes, part, (self.low, self.high))
        flat = ~self.facets.curved[self.edges.facet[edge]].all(axis=1)
        return owner[flat], edge[flat]

    def corners_near(self, near: _Side) -> _Side:
        """Ends of near edges that lie in the box of their pair: pairs (k, vertex)."""
        owner, edge = near
        owner, corner = np.repeat(owner, 2), self.edges.ends_of[edge].reshape(-1)
        turned = self.turned(corner)
        inside = ((turned >= self.low[owner]) & (turned <= self.high[owner])).all(axis=1)
        key = owner[inside] * len(self.geometry.vertices) + corner[inside]
        key = np.unique(key)
        return key // len(self.geometry.vertices), key % len(self.geometry.vertices)

    def turned(self, vertex: Index) -> Array:
        """Coordinates of vertices in the frame of the bounding boxes."""
        at: Array = self.boxes.turned[vertex]
        return at


def meetings(block: PairBlock) -> list[Meetings]:
    """Points at which a corner or edge of one part meets the other part, for a block of pairs."""
    edges = block.edges
    a, b = block.search.pairs[block.rows].T
    near = block.edges_near(a), block.edges_near(b)
    corners = [block.corners_near(near[0]), block.corners_near(near[1])]
    edge_boxes = [edges.boxes(block.boxes, edge) for _, edge in near]
    blocks, free = _corners_on_corners(block, corners[0], corners[1])
    facets = [block.facets_near(b), block.facets_near(a)]
    for side in (0, 1):
        blocks += _edges_along_facets(block, near[side], edge_boxes[side], facets[side], side)
        own_corners = tuple(rows[free[side]] for rows in corners[side])
        on_edges, still_free = _corners_on_edges(
            block, own_corners, near[1 - side], edge_boxes[1 - side], side
        )
        own_corners = tuple(rows[still_free] for rows in own_corners)
        blocks += on_edges + _corners_on_facets(block, own_corners, facets[side], side)
    return blocks + _crossings(block, near, edge_boxes)


def _make_meetings(
    block: PairBlock, pair: Index, kinds: tuple[int, ...], features: list[Index], at: list[Array]
) -> Meetings:
    """Build `Meetings` of the given kinds; `pair` holds rows of the block."""
    kind = np.tile(np.array(kinds), (len(pair), 1))
    return Meetings(block.rows[pair], kind, np.column_stack(features), np.stack(at, axis=1))


def _corners_on_corners(
    block: PairBlock, corners_a: _Side, corners_b: _Side
) -> tuple[list[Meetings], list[Mask]]:
    """Points at which corners meet corners, and masks of the corners of a and b that do not."""
    at_a, at_b = block.turned(corners_a[1]), block.turned(corners_b[1])
    free = [np.ones(len(at_a), dtype=bool), np.ones(len(at_b), dtype=bool)]
    blocks = []
    vertices = block.geometry.vertices
    for pair, x, y in joins(
        corners_a[0], (at_a, at_a), corners_b[0], (at_b, at_b), block.tolerance
    ):
        near = np.linalg.norm(at_a[x] - at_b[y], axis=1) <= block.tolerance[pair]
        pair, x, y = pair[near], x[near], y[near]
        free[0][x] = free[1][y] = False
        v, w = corners_a[1][x], corners_b[1][y]
        blocks.append(
            _make_meetings(block, pair, (CORNER, CORNER), [v, w], [vertices[v], vertices[w]])
        )
    return blocks, free


def _corners_on_edges(
    block: PairBlock,
    corners: tuple[Index, ...],
    near: _Side,
    edge_boxes: tuple[Array, Array],
    side: int,
) -> tuple[list[Meetings], Mask]:
    """Points at which corners meet edges of the other part, and a mask of the corners that do not.

    `side` 0: corners of part a.
    """
    owner, corner = corners
    order = 1 if side == 0 else -1
    at = block.turned(corner)
    free = np.ones(len(at), dtype=bool)
    blocks = []
    for pair, x, y in joins(owner, (at, at), near[0], edge_boxes, block.tolerance):
        v, edge = corner[x], near[1][y]
        p = block.geometry.vertices[v]
        start, end = block.edges.ends(block.geometry, edge)
        along = end - start
        square = np.einsum("ij,ij->i", along, along)
        t = np.clip(ratio(np.einsum("ij,ij->i", p - start, along), square), 0, 1)
        foot = start + t[:, None] * along
        k = np.flatnonzero(np.linalg.norm(p - foot, axis=1) <= block.tolerance[pair])
        free[x[k]] = False
        features, points = [v[k], edge[k]][::order], [p[k], foot[k]][::order]
        blocks.append(_make_meetings(block, pair[k], (CORNER, EDGE)[::order], features, points))
    return blocks, free


def _corners_on_facets(
    block: PairBlock, corners: tuple[Index, ...], near_facets: _Side, side: int
) -> list[Meetings]:
    """Points at which corners of a part meet facets of the other (`side` 0: corners of a)."""
    geometry, facets = block.geometry, block.facets
    owner, corner = corners
    if not len(corner):
        return []
    order = 1 if side == 0 else -1
    has_corner = np.zeros(len(block.rows), dtype=bool)
    has_corner[owner] = True
    near_facets = (
        near_facets[0][has_corner[near_facets[0]]],
        near_facets[1][has_corner[near_facets[0]]],
    )
    grow, of_facet = block.tolerance[:, None], near_facets[0]
    box = (block.low - grow)[of_facet], (block.high + grow)[of_facet]
    piece_owner, piece, piece_facet = _facet_triangles(facets, block.boxes.turned, near_facets, box)
    at = block.turned(corner)
    pieces = block.boxes.turned[facets.corners[piece]]
    piece_boxes = pieces.min(axis=1, initial=np.inf), pieces.max(axis=1, initial=-np.inf)
    blocks = []
    for pair, x, y in joins(owner, (at, at), piece_owner, piece_boxes, block.tolerance):
        v, facet = corner[x], piece_facet[y]
        p, normal = geometry.vertices[v], facets.normal[facet]
        height = np.einsum("ij,ij->i", p - facets.origin[facet], normal)
        k = np.flatnonzero(np.abs(height) <= block.tolerance[pair])
        foot = p[k] - height[k, None] * normal[k]
        triangle = geometry.vertices[facets.corners[piece[y[k]]]]
        inside = _in_triangle(foot, triangle, normal[k], block.tolerance[pair[k]])
        k, foot = k[inside], foot[inside]
        # a corner over an inner edge of the facet lies in two of its triangles
        names = np.column_stack([pair[k], v[k], facet[k]])
        once = np.unique(names, axis=0, return_index=True)[1]
        k, foot = k[once], foot[once]
        features, points = [v[k], facet[k]][::order], [p[k], foot][::order]
        blocks.append(_make_meetings(block, pair[k], (CORNER, FACE)[::order], features, points))
    return blocks


def _edges_along_facets(
    block: PairBlock, near: _Side, edge_boxes: tuple[Array, Array], near_facets: _Side, side: int
) -> list[Meetings]:
    """Points at both ends of edges that lie along facets of the other part, slightly tilted."""
    geometry, facets, boxes = block.geometry, block.facets, block.boxes
    facet_boxes = boxes.facet_low[near_facets[1]], boxes.facet_high[near_facets[1]]
    order = 1 if side == 0 else -1
    blocks = []
    for pair, x, y in joins(near[0], edge_boxes, near_facets[0], facet_boxes, block.tolerance):
        edge, facet = near[1][x], near_facets[1][y]
        start, end = block.edges.ends(geometry, edge)
        normal, origin = facets.normal[facet], facets.origin[facet]
        heights = [np.einsum("ij,ij->i", p - origin, normal) for p in (start, end)]
        # with both ends within tolerance the edge is found by its corners
        far = np.maximum(np.abs(heights[0]), np.abs(heights[1])) > block.tolerance[pair]
        k = np.flatnonzero(far & _comes_within(heights, block.tolerance[pair]))
        length = np.linalg.norm((end - start)[k], axis=1)
        flat = np.abs(heights[1][k] - heights[0][k]) <= EDGE_NEARLY_PARALLEL * length
        k, length = k[flat], length[flat]
        low, high = _interval_over_facets(facets, geometry, start[k], end[k], facet[k])
        ends = [heights[0][k] + t * (heights[1] - heights[0])[k] for t in (low, high)]
        keep = (high - low) * length > 4 * block.tolerance[pair[k]]
        keep &= _comes_within(ends, block.tolerance[pair[k]])
        keep[keep] = ~_beside_rim(
            block, edge[k[keep]], facet[k[keep]], block.tolerance[pair][k][keep]
        )
        for t, gap in zip((low, high), ends, strict=True):
            j = k[keep]
            p = start[j] + t[keep, None] * (end - start)[j]
            foot = p - gap[keep, None] * normal[j]
            features, points = [edge[j], facet[j]][::order], [p, foot][::order]
            blocks.append(_make_meetings(block, pair[j], (EDGE, FACE)[::order], features, points))
    return blocks


def _beside_rim(block: PairBlock, edge: Index, facet: Index, tolerance: Array) -> Mask:
    """Mask of edges that run along the rim of a facet and may miss it by rounding."""
    geometry, edges = block.geometry, block.edges
    owner, rim = ragged(edges.start, block.facets.part[facet])
    of_facet = (edges.facet[rim] == facet[owner][:, None]).any(axis=1)
    owner, rim = owner[of_facet], rim[of_facet]
    first, second = edges.direction(geometry, edge[owner]), edges.direction(geometry, rim)
    along = np.linalg.norm(cross(first, second), axis=1) < EDGE_NEARLY_PARALLEL
    owner, rim = owner[along], rim[along]
    ends = [*edges.ends(geometry, edge[owner]), *edges.ends(geometry, rim)]
    distance = segment_distance(*ends)[0]
    # parallel segments: the distances of the ends decide
    for p, start, end in ((0, 2, 3), (1, 2, 3), (2, 0, 1), (3, 0, 1)):
        reach = ends[end] - ends[start]
        square = np.einsum("ij,ij->i", reach, reach)
        t = np.clip(ratio(np.einsum("ij,ij->i", ends[p] - ends[start], reach), square), 0, 1)
        off = np.linalg.norm(ends[p] - ends[start] - t[:, None] * reach, axis=1)
        distance = np.minimum(distance, off)
    beside = np.zeros(len(edge), dtype=bool)
    beside[owner[distance <= tolerance[owner]]] = True
    return beside


def _comes_within(gaps: list[Array], tolerance: Array) -> Mask:
    """Mask of gaps that come within the tolerance; a gap is linear between its two ends."""
    near: Mask = np.minimum(*gaps) <= tolerance
    near &= np.maximum(*gaps) >= -tolerance
    return near


def _interval_over_facets(
    facets: Facets, geometry: Geometry, start: Array, end: Array, facet: Index
) -> tuple[Array, Array]:
    """Interval (begin, end) of each segment over its facet, as fractions of its length."""
    ends = np.stack([start, end])
    height = np.einsum("nij,ij->ni", ends - facets.origin[facet], facets.normal[facet])
    grow = np.abs(height).max(axis=0) + FACET_FLATNESS * geometry.size[facets.part[facet]]
    box = ends.min(axis=0) - grow[:, None], ends.max(axis=0) + grow[:, None]
    near = np.arange(len(facet)), facet
    row, piece, _ = _facet_triangles(facets, geometry.vertices, near, box)
    triangle = geometry.vertices[facets.corners[piece]]
    low, high = _interval_over_triangle(start[row], end[row], triangle, facets.normal[facet[row]])
    is_over = low < high
    least, most = np.ones(len(facet)), np.zeros(len(facet))
    np.minimum.at(least, row[is_over], low[is_over])
    np.maximum.at(most, row[is_over], high[is_over])
    return least, most


def _interval_over_triangle(
    start: Array, end: Array, triangle: Array, normal: Array
) -> tuple[Array, Array]:
    """Interval (begin, end) of each segment over a triangle, as fractions; empty if begin > end."""
    low, high = np.zeros(len(start)), np.ones(len(start))
    for k in range(3):
        corner = triangle[:, k]
        inwards = cross(normal, triangle[:, (k + 1) % 3] - corner)
        side_start, side_end = (np.einsum("ij,ij->i", p - corner, inwards) for p in (start, end))
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = side_start / (side_start - side_end)
        low = np.where((side_start < 0) & (side_end >= 0), np.maximum(low, crossing), low)
        high = np.where((side_start >= 0) & (side_end < 0), np.minimum(high, crossing), high)
        high = np.where((side_start < 0) & (side_end < 0), -1.0, high)
    return low, high


def _facet_triangles(
    facets: Facets, points: Array, near: _Side, box: tuple[Array, Array]
) -> tuple[Index, Index, Index]:
    """Triangles of the near facets: row k of the pair, corner positions (n, 3), facet.

    `points`, shape (V, 3): the vertices. `box`: lower and upper corners of the box of each near
    facet, shape (m, 3) each; of facets with many triangles only those that meet it are returned.
    """
    owner, facet = near
    length = np.where(facets.convex, 0, np.diff(facets.corner_start))[facet]
    few = np.flatnonzero(length <= 3 * MANY_TRIANGLES)
    place, corners = facet_triangles(facets.corner_start, facets.convex, facet[few])
    rows, triangles = [few[place]], [corners]
    many = np.flatnonzero(length > 3 * MANY_TRIANGLES)
    for name in np.unique(facet[many]).tolist():
        corners = np.arange(*facets.corner_start[name : name + 2]).reshape(-1, 3)
        at = points[facets.corners[corners]]
        low, high = at.min(axis=1), at.max(axis=1)
        for row in many[facet[many] == name].tolist():
            meets = (low <= box[1][row]).all(axis=1) & (high >= box[0][row]).all(axis=1)
            triangles.append(corners[meets])
            rows.append(np.full(len(triangles[-1]), row))
    row = np.concatenate(rows)
    order = np.argsort(owner[row], kind="stable")
    row = row[order]
    return owner[row], np.concatenate(triangles)[order], facet[row]


def _in_triangle(p: Array, triangle: Array, normal: Array, tolerance: Array) -> Mask:
    """Mask of points that lie in their triangle or within `tolerance` beside it."""
    inside = np.ones(len(p), dtype=bool)
    for k in range(3):
        start = triangle[:, k]
        along = triangle[:, (k + 1) % 3] - start
        side = np.einsum("ij,ij->i", cross(along, p - start), normal)
        side = ratio(side, np.linalg.norm(along, axis=1))
        inside &= side >= -tolerance
    return inside


def _crossings(
    block: PairBlock, near: tuple[_Side, _Side], edge_boxes: list[tuple[Array, Array]]
) -> list[Meetings]:
    """Points at which edges of both parts cross, or run along each other."""
    geometry, edges = block.geometry, block.edges
    blocks = []
    for pair, x, y in joins(near[0][0], edge_boxes[0], near[1][0], edge_boxes[1], block.tolerance):
        e, f = near[0][1][x], near[1][1][y]
        p, q = edges.ends(geometry, e)
        r, s = edges.ends(geometry, f)
        d1, d2 = q - p, s - r
        across = cross(d1, d2)
        length1, length2 = np.linalg.norm(d1, axis=1), np.linalg.norm(d2, axis=1)
        size = np.linalg.norm(across, axis=1)
        sine = ratio(size, length1 * length2)
        k = np.flatnonzero(sine > EDGE_PARALLEL)
        normal = across[k] / size[k, None]
        gap = np.einsum("ij,ij->i", (r - p)[k], normal)
        keep = (np.abs(gap) <= block.tolerance[pair[k]]) | (sine[k] < EDGE_NEARLY_PARALLEL)
        k = k[keep]
        distance, first, second = segment_distance(p[k], q[k], r[k], s[k])
        keep = distance <= block.tolerance[pair[k]]
        for point, ends in ((first, (p, q)), (second, (r, s))):
            for end in ends:
                keep &= np.linalg.norm(point - end[k], axis=1) > block.tolerance[pair[k]]
        k, first, second = k[keep], first[keep], second[keep]
        blocks.append(_make_meetings(block, pair[k], (EDGE, EDGE), [e[k], f[k]], [first, second]))
    return blocks


def near_edges(search: ContactSearch, unrecorded: Mask) -> list[RejectedPair]:
    """Near pairs of parts without recorded contact, each with its nearest corner or edge.

    `unrecorded`, shape (n,): pairs of the search without any contact, overlap or near faces.
    """
    geometry, boxes = search.geometry, search.boxes
    a, b = search.pairs.T
    limit = LOOSE_GAP * np.minimum(geometry.size[a], geometry.size[b])
    grow = limit[:, None]
    meets = (boxes.part_low[a] <= boxes.part_high[b] + grow).all(axis=1)
    meets &= (boxes.part_low[b] <= boxes.part_high[a] + grow).all(axis=1)
    rows = np.flatnonzero(unrecorded & meets)
    if not len(rows):
        return []
    a, b, grow = a[rows], b[rows], grow[rows]
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
    edges = find_edges(geometry, search.facets, np.unique(search.pairs[rows]))
    block = PairBlock(search, edges, rows, limit[rows], low, high)
    found_meetings = Meetings.join(meetings(block))
    apart = np.linalg.norm(found_meetings.at[:, 1] - found_meetings.at[:, 0], axis=1)
    nearest: dict[int, float] = {}
    for row, gap in zip(found_meetings.pair.tolist(), apart.tolist(), strict=True):
        nearest[row] = min(gap, nearest.get(row, gap))
    rejected = []
    for row, gap in nearest.items():
        part_a, part_b = search.pairs[row].tolist()
        rejected.append(RejectedPair((part_a, part_b), gap, 0.0, APART))
    return rejected
