"""Candidate points at corners, edges and rims of parts of any shape, with exact gaps.

Three kinds of features can be the nearest between two parts, besides opposed faces and curved
faces; n is the normal, directed from the face, or from part a, to the other part:

    corner over a face    n is the normal of the face; the point is the corner
    edge across an edge   n lies across both; the point is the middle of the gap
    rim over a face       n is the normal of the face; with the circle's centre c, axis u and radius
                          r, the point is c - r m, where m is the unit vector of n - (n.u) u

Rims are the ends of solid cylinders and cones. A feature counts if its part lies on the far side of
the plane across n there, up to the angle of opposed faces. With a penetration the same features lie
below the face, inside of the other part. Round faces that were recognised in a mesh count as their
facets.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.settled_pose.clear_segments import are_clear
from kilter.analysis.settled_pose.settle_tolerances import COINCIDES, CROSSING, FACING, LEVEL
from kilter.arrays import Array, Index, Mask, cross, lengths, ragged, ratio, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER
from kilter.contact.common.broad import facets_in, joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import segment_distance
from kilter.contact.common.edges import Edges, find_edges
from kilter.contact.common.facets import facet_triangles

Found = tuple[Index, Array, Array, Array]
"""Row of the pair, point on part a, point on part b, and normal from a to b."""
NONE: Found = (np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)))


def feature_points(search: ContactSearch, reach: float) -> tuple[Index, Array, Array, Array, Array]:
    """Points of corners, edges and rims within a reach [length unit], for all pairs of a search.

    Returns the row of the pair, shape (n,), the point, the middle of its gap and the normal from
    part a to part b, shape (n, 3), and the gap, shape (n,).
    """
    if not len(search.pairs):
        return *NONE, np.empty(0)
    edges = find_edges(search.geometry, search.facets, np.unique(search.pairs))
    near = [_near_edges(search, edges, side, reach) for side in (0, 1)]
    blocks = [_edge_points(search, edges, near, reach)]
    for side in (0, 1):
        owner, vertex = _corners(search, edges, near[side])
        point = search.geometry.vertices[vertex]
        row, facet = _over_facets(search, owner, point, side, reach)
        normal = search.facets.normal[facet]
        opens = _opens(search, edges, vertex[row], normal)
        blocks.append(_over_face(search, owner, point, row[opens], facet[opens], side, reach))
        blocks.append(_rim_points(search, side, reach))
    pair, on_a, on_b, normal = (np.concatenate([block[k] for block in blocks]) for k in range(4))
    # the corner or rim of its part is the point; edges have the middle of the gap
    share = np.repeat([0.5, 0.0, 0.0, 1.0, 1.0], [len(block[0]) for block in blocks])
    point = on_a + share[:, None] * (on_b - on_a)
    seen = are_clear(search, pair, on_a, on_b)
    gap = np.einsum("ij,ij->i", on_b - on_a, normal)
    return pair[seen], point[seen], (on_a + on_b)[seen] / 2, normal[seen], gap[seen]


def _box(search: ContactSearch, reach: float) -> tuple[Array, Array]:
    """Box of the common space of each pair, in the frame of the boxes: lower and upper corners."""
    boxes, (a, b) = search.boxes, search.pairs.T
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - reach
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + reach
    return low, high


def _near_edges(
    search: ContactSearch, edges: Edges, side: int, reach: float
) -> tuple[Index, Index]:
    """Straight edges that bend outwards, in the space of each pair: rows of pairs, edges."""
    facets, curved = search.facets, _on_curves(search)
    owner, edge = edges.inside(search.boxes, search.pairs[:, side], _box(search, reach))
    left, right = edges.facet[edge].T
    straight = (left >= 0) & (right >= 0) & ~(curved[left] | curved[right])
    owner, edge, left, right = (x[straight] for x in (owner, edge, left, right))
    into_left = cross(facets.normal[left], edges.direction(search.geometry, edge))
    outwards = np.einsum("ij,ij->i", into_left, facets.normal[right]) < -LEVEL
    return owner[outwards], edge[outwards]


def _on_curves(search: ContactSearch) -> Mask:
    """Mask of the facets that approximate an exact curved face, shape (F,)."""
    facets, doubt = search.facets, search.geometry.surfaces.doubt
    exact = np.append(doubt == 0.0, True)  # the last: a free form
    on: Mask = facets.curved & exact[facets.surface]
    return on


def _corners(search: ContactSearch, edges: Edges, near: tuple[Index, Index]) -> tuple[Index, Index]:
    """Ends of near edges, each once for a pair: rows of pairs, vertices."""
    count = len(search.geometry.vertices)
    key = np.unique((near[0] * count)[:, None] + edges.ends_of[near[1]])
    return key // count, key % count


def _over_facets(
    search: ContactSearch, owner: Index, points: Array, side: int, reach: float
) -> tuple[Index, Index]:
    """Points of part `side` over flat facets of the other part: rows of points, facets."""
    facets, boxes = search.facets, search.boxes
    low, high = _box(search, reach)
    pair, facet = facets_in(facets, boxes, search.pairs[:, 1 - side], low, high)
    flat = ~_on_curves(search)[facet] & (facets.normal[facet] != 0).any(axis=1)
    pair, facet = pair[flat], facet[flat]
    place, corners = facet_triangles(facets.corner_start, facets.convex, facet)
    turned = boxes.turned[facets.corners[corners]]
    at = points @ boxes.frame.T
    margin = np.full(len(search.pairs), reach)
    rows = []
    for _, x, y in joins(
        owner, (at, at), pair[place], (turned.min(axis=1), turned.max(axis=1)), margin
    ):
        of = facet[place[y]]
        normal = facets.normal[of]
        height = np.einsum("ij,ij->i", points[x] - facets.origin[of], normal)
        triangle = search.geometry.vertices[facets.corners[corners[y]]]
        foot = points[x] - height[:, None] * normal
        over = (np.abs(height) <= reach) & _in_triangle(
            foot, triangle, normal, COINCIDES * facets.reach[of]
        )
        rows.append(np.column_stack([x[over], of[over]]))
    if not rows:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    row, of = np.unique(np.concatenate(rows), axis=0).T
    return row, of


def _in_triangle(points: Array, triangle: Array, normal: Array, slack: Array) -> Mask:
    """Mask of points that lie in their triangle, or beside it by a slack."""
    inside = np.ones(len(points), dtype=bool)
    for k in range(3):
        start, along = triangle[:, k], triangle[:, (k + 1) % 3] - triangle[:, k]
        inward = unit_rows(cross(normal, along))
        inside &= np.einsum("ij,ij->i", points - start, inward) >= -slack
    return inside


def _opens(search: ContactSearch, edges: Edges, vertex: Index, normal: Array) -> Mask:
    """Mask of vertices whose edges rise along a normal, or fall by the angle of opposed faces.

    A vertex with an edge that bends inwards has material beside that edge, and does not count. If
    an edge goes on straight beyond the vertex, its faces must rise as well.
    """
    facets, vertices = search.facets, search.geometry.vertices
    owner, ray = ragged(edges.ray_start, vertex)
    used = edges.ray_edge[ray]
    ends = edges.ends_of[used]
    other = np.where(ends[:, 0] == vertex[owner], ends[:, 1], ends[:, 0])
    along = unit_rows(vertices[other] - vertices[vertex[owner]])
    rise = np.full(len(vertex), np.inf)
    np.minimum.at(rise, owner, np.einsum("ij,ij->i", along, normal[owner]))
    rise[owner[edges.reflex(facets, search.geometry, used, np.sin(FACING))]] = -np.inf
    first = np.searchsorted(owner, np.arange(len(vertex) + 1))
    row, mate = ragged(first, owner)
    straight = np.einsum("ij,ij->i", along[row], along[mate]) < LEVEL - 1
    row = np.unique(row[straight])
    for side, sense in ((0, 1.0), (1, -1.0)):
        facet = edges.facet[used[row], side]
        into = sense * cross(facets.normal[facet], edges.direction(search.geometry, used[row]))
        np.minimum.at(rise, owner[row], np.einsum("ij,ij->i", into, normal[owner[row]]))
    opens: Mask = rise >= -np.sin(FACING)
    return opens


def _over_face(
    search: ContactSearch, owner: Index, points: Array, row: Index, facet: Index, side: int,
    reach: float,
) -> Found:  # fmt: skip
    """Points of part `side` and their feet on flat facets of the other part."""
    normal = search.facets.normal[facet]
    height = np.einsum("ij,ij->i", points[row] - search.facets.origin[facet], normal)
    on = points[row], points[row] - height[:, None] * normal
    return (owner[row], on[0], on[1], -normal) if side == 0 else (owner[row], on[1], on[0], normal)


def _edge_points(
    search: ContactSearch, edges: Edges, near: list[tuple[Index, Index]], reach: float
) -> Found:
    """Nearest points of edges of both parts that cross each other."""
    geometry, facets = search.geometry, search.facets
    boxes = [edges.boxes(search.boxes, edge) for _, edge in near]
    margin = np.full(len(search.pairs), reach)
    blocks = [NONE]
    for pair, x, y in joins(near[0][0], boxes[0], near[1][0], boxes[1], margin):
        i, j = near[0][1][x], near[1][1][y]
        across = cross(edges.direction(geometry, i), edges.direction(geometry, j))
        sine = lengths(across)
        skew = sine > CROSSING
        pair, i, j, n = pair[skew], i[skew], j[skew], across[skew] / sine[skew, None]
        ends = *edges.ends(geometry, i), *edges.ends(geometry, j)
        apart, on_a, on_b = segment_distance(*ends)
        # at an end of an edge its other edges count, too: that is a corner
        size = np.minimum(lengths(ends[1] - ends[0]), lengths(ends[3] - ends[2]))
        inner = lengths(np.cross(on_b - on_a, n)) <= COINCIDES * size
        for on, end in zip((on_a, on_a, on_b, on_b), ends, strict=True):
            inner &= lengths(on - end) > COINCIDES * size
        k = np.flatnonzero(inner & (apart <= reach))
        for sign in (1.0, -1.0):
            away = sign * n[k]
            fits = edges.behind(facets, geometry, i[k], away, np.sin(FACING))
            fits &= edges.behind(facets, geometry, j[k], -away, np.sin(FACING))
            rows = k[fits]
            blocks.append((pair[rows], on_a[rows], on_b[rows], sign * n[rows]))
    pair, on_a, on_b, normal = (np.concatenate([block[k] for block in blocks]) for k in range(4))
    return pair, on_a, on_b, normal


def _rim_points(search: ContactSearch, side: int, reach: float) -> Found:
    """Nearest points of the ends of solid cylinders and cones of part `side` over facets."""
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    s = geometry.surfaces
    pair, surface = ragged(s.start, search.pairs[:, side])
    solid = np.isin(s.kind[surface], (CYLINDER, CONE)) & ~s.hollow[surface]
    solid &= s.doubt[surface] == 0.0
    pair, surface = pair[solid], surface[solid]
    if not len(pair):
        return NONE
    used, number = np.unique(surface, return_inverse=True)
    owner, place = ragged(s.triangle_start, used)
    corners = geometry.vertices[geometry.triangles[s.triangle[place]]]
    height = np.einsum("kci,ki->kc", corners - s.point[used][owner][:, None], s.axis[used][owner])
    ends = np.full((2, len(used)), np.inf)
    np.minimum.at(ends[0], owner, height.min(axis=1))
    np.minimum.at(ends[1], owner, -height.max(axis=1))
    ends[1] *= -1
    low, high = _box(search, reach)
    other, facet = facets_in(facets, boxes, search.pairs[:, 1 - side], low, high)
    flat = ~_on_curves(search)[facet]
    other, facet = other[flat], facet[flat]
    first = np.searchsorted(other, np.arange(len(low) + 1))
    row, k = ragged(first, pair)
    n, i = facets.normal[facet[k]], surface[row]
    blocks = [NONE]
    for end, sense in ((0, 1.0), (1, -1.0)):
        axis = s.axis[i]
        rise = np.einsum("ij,ij->i", n, axis)
        m = n - rise[:, None] * axis
        tilted = (sense * rise >= -np.sin(FACING)) & (lengths(m) > LEVEL)
        centre = s.point[i] + ends[end][number[row]][:, None] * axis
        slope = np.where(s.kind[i] == CONE, np.tan(s.half_angle[i]), 0.0)
        radius = s.radius[i] * (s.kind[i] == CYLINDER) + slope * ends[end][number[row]]
        x = centre - radius[:, None] * ratio(m, lengths(m)[:, None])
        height = np.einsum("ij,ij->i", x - facets.origin[facet[k]], n)
        rows = np.flatnonzero(tilted & (np.abs(height) <= reach))
        rows = rows[_on_rim(geometry, i[rows], x[rows], axis[rows], radius[rows])]
        over, of = _over_facets(search, pair[row[rows]], x[rows], side, reach)
        same = of == facet[k[rows[over]]]
        blocks.append(
            _over_face(search, pair[row[rows]], x[rows], over[same], of[same], side, reach)
        )
    pair, on_a, on_b, normal = (np.concatenate([block[k] for block in blocks]) for k in range(4))
    return pair, on_a, on_b, normal


def _on_rim(geometry: Geometry, surface: Index, points: Array, axis: Array, radius: Array) -> Mask:
    """Mask of points at the ends of surfaces, at which a triangle of the surface ends."""
    s = geometry.surfaces
    on = np.zeros(len(points), dtype=bool)
    owner, place = ragged(s.triangle_start, surface)
    corners = geometry.vertices[geometry.triangles[s.triangle[place]]]
    flat = corners - points[owner][:, None]
    along = np.einsum("kci,ki->kc", flat, axis[owner])
    size = radius[owner]
    at_end = np.abs(along) <= COINCIDES * size[:, None]
    # a side of the triangle at the end spans the chord beside the point
    for k in range(3):
        p, q = flat[:, k], flat[:, (k + 1) % 3]
        chord = at_end[:, k] & at_end[:, (k + 1) % 3]
        between = np.einsum("ij,ij->i", p, q) <= COINCIDES * size**2
        on[owner[chord & between]] = True
    return on
