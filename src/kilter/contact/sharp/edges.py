"""Edges of parts: the boundaries between facets, with the facets beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    Rows,
    connected,
    counted,
    cross,
    lengths,
    ragged,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import Boxes
from kilter.contact.contact_tolerances import RAY_ANGLE, VERTEX_ON_EDGE
from kilter.contact.planar.facets import Facets

__all__ = ["Edges", "Rays", "find_edges", "segment_distance"]


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """Edges of a set of parts between their facets, ordered by part.

    Attributes
    ----------
    start : ndarray of int, shape (N + 1,)
        The edges of part i are rows ``start[i]`` to ``start[i + 1]``.
    ends_of : ndarray of int, shape (E, 2)
        Vertices at both ends.
    facet : ndarray of int, shape (E, 2)
        The facet left of the edge and the facet right of it, seen from outside (-1: none).
    ray_start, ray_edge : ndarray of int
        Edges that end in vertex v: ``ray_edge[ray_start[v]:ray_start[v + 1]]``.
    doubled : bool
        True if edges may lie on other edges, because facets of no width lay between them.
    """

    start: Index
    ends_of: Index
    facet: Index
    ray_start: Index
    ray_edge: Index
    doubled: bool

    def ends(self, geometry: Geometry, which: Index) -> tuple[Array, Array]:
        """Start points and end points of the edges `which`, shape (n, 3) each."""
        p, q = geometry.vertices[self.ends_of[which]].transpose(1, 0, 2)
        return p, q

    def direction(self, geometry: Geometry, which: Index) -> Array:
        """Unit directions of the edges `which`, shape (n, 3)."""
        p, q = self.ends(geometry, which)
        return unit_rows(q - p)

    def inside(self, boxes: Boxes, part: Index, box: tuple[Array, Array]) -> tuple[Index, Index]:
        """Edges of part ``part[k]`` whose box meets box k, as pairs (k, edge), ordered by k."""
        owner, edge = ragged(self.start, part)
        for axis in range(3):
            p, q = boxes.turned[:, axis][self.ends_of[edge]].T
            meets = np.minimum(p, q) <= box[1][owner, axis]
            meets &= np.maximum(p, q) >= box[0][owner, axis]
            owner, edge = owner[meets], edge[meets]
        return owner, edge

    def boxes(self, boxes: Boxes, which: Index) -> tuple[Array, Array]:
        """Bounding boxes of the edges `which`: lower and upper corners, shape (n, 3) each."""
        p, q = boxes.turned[self.ends_of[which]].transpose(1, 0, 2)
        return np.minimum(p, q), np.maximum(p, q)

    def behind(
        self, facets: Facets, geometry: Geometry, which: Index, normal: Array, slack: float
    ) -> Mask:
        """Mask of edges at which the material lies behind a plane with a given normal."""
        fits: Mask = np.ones(len(which), dtype=bool)
        fits[(self.facet[which] < 0).any(axis=1)] = False
        along = self.direction(geometry, which)
        inward = np.zeros((len(which), 3))
        for side, turn in ((0, 1.0), (1, -1.0)):
            outward = facets.normal[self.facet[which, side]]
            into_facet = turn * cross(outward, along)
            fits &= np.einsum("ij,ij->i", into_facet, normal) <= slack
            inward += into_facet - outward
        fits &= np.einsum("ij,ij->i", inward, normal) <= slack
        return fits

    def reflex(self, facets: Facets, geometry: Geometry, which: Index, slack: float) -> Mask:
        """Mask of edges at which the surface bends inwards by more than `slack`, as a sine."""
        left, right = self.facet[which].T
        into_left = cross(facets.normal[left], self.direction(geometry, which))
        rise = np.einsum("ij,ij->i", into_left, facets.normal[right])
        bent: Mask = (left >= 0) & (right >= 0) & (rise > slack)
        return bent

    def rays(self, geometry: Geometry, vertex: Index) -> Rays:
        """All edges at given vertices, as rays: the edge and its direction away from the vertex."""
        owner, row = ragged(self.ray_start, vertex)
        edge = self.ray_edge[row]
        away = self.ends_of[edge, 0] == vertex[owner]
        direction = np.where(away, 1.0, -1.0)[:, None] * self.direction(geometry, edge)
        left, right = self.facet[edge].T
        left, right = np.where(away, left, right), np.where(away, right, left)
        rays = Rays(owner, edge, direction, left, right)
        return rays.once() if self.doubled else rays


@dataclass(frozen=True, slots=True, eq=False)
class Rays(Rows):
    """Edges as rays from their vertices: vertex number, edge, and unit direction away from it.

    `left` and `right` are the facets on either side, seen from outside (-1: none).
    """

    owner: Index
    edge: Index
    direction: Array
    left: Index
    right: Index

    def once(self) -> Rays:
        """These rays without repeats, and without rays inside a facet."""
        rounded = np.round(self.direction / RAY_ANGLE).astype(np.int64)
        key = np.column_stack([self.owner, self.left, self.right, rounded])
        keep = np.unique(key, axis=0, return_index=True)[1]
        keep = np.sort(keep[self.left[keep] != self.right[keep]])
        return self.take(keep)


def find_edges(geometry: Geometry, facets: Facets, parts: Index) -> Edges:
    """The edges between facets of the given parts."""
    is_chosen = np.zeros(len(geometry.mass), dtype=bool)
    is_chosen[parts] = True
    begin, end, facet = _boundary(facets, np.flatnonzero(is_chosen[facets.part]))
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    # both directions of an edge become neighbours, the forward direction first
    order = np.lexsort((begin != low, high, low))
    begin, end, facet, low, high = (x[order] for x in (begin, end, facet, low, high))
    is_new = np.ones(len(low), dtype=bool)
    is_new[1:] = (np.diff(low) != 0) | (np.diff(high) != 0)
    first = np.flatnonzero(is_new)
    sides = np.full((len(first), 2), -1, dtype=np.int64)
    number = np.cumsum(is_new) - 1
    forward = begin == low
    sides[number[forward], 0] = facet[forward]
    sides[number[~forward], 1] = facet[~forward]
    ends = np.column_stack([low[first], high[first]])
    part = geometry.vertex_part[ends[:, 0]]
    order = np.argsort(part, kind="stable")
    ends, sides = ends[order], sides[order]
    sides, split = _match_open_sides(geometry, ends, sides)
    ends, sides, doubled = _bridge_slivers(facets, ends, sides)
    part = geometry.vertex_part[ends[:, 0]]
    end_vertices = ends.T.reshape(-1)
    by_vertex = np.argsort(end_vertices, kind="stable")
    return Edges(
        start=np.searchsorted(part, np.arange(len(geometry.mass) + 1)),
        ends_of=ends,
        facet=sides,
        ray_start=np.searchsorted(end_vertices[by_vertex], np.arange(len(geometry.vertices) + 1)),
        ray_edge=by_vertex % max(1, len(ends)),
        doubled=doubled or split,
    )


MOST_OPEN_EDGES = 4000
"""Number of one-sided edges above which their missing neighbours are not searched for, since the
search takes quadratic time."""


def _match_open_sides(geometry: Geometry, ends: Index, sides: Index) -> tuple[Index, bool]:
    """Complete edges that have a facet on only one side, from shorter edges that lie on them.

    A vertex of the neighbour splits the common edge, so that its pieces have different ends. Also
    returns whether any edge was one-sided.
    """
    one_sided = np.flatnonzero((sides < 0).any(axis=1))
    if not len(one_sided):
        return sides, False
    sides = sides.copy()
    part = geometry.vertex_part[ends[one_sided, 0]]
    facet_of = sides[one_sided].max(axis=1)
    for k in np.unique(part).tolist():
        edges_of_part = one_sided[part == k]
        if len(edges_of_part) > MOST_OPEN_EDGES:
            continue
        start, end = geometry.vertices[ends[edges_of_part]].transpose(1, 0, 2)
        length = lengths(end - start)
        along = unit_rows(end - start)
        for row, edge in enumerate(edges_of_part.tolist()):
            offset = (start[row] + end[row]) / 2 - start
            along_axis = np.einsum("ij,ij->i", offset, along)
            distance = lengths(offset - along_axis[:, None] * along)
            near = (
                (distance <= VERTEX_ON_EDGE * geometry.size[k])
                & (along_axis >= 0)
                & (along_axis <= length)
            )
            # the longer edge contains the middle of the shorter: test both ways
            offset = (start + end) / 2 - start[row]
            along_axis = offset @ along[row]
            distance = lengths(offset - np.outer(along_axis, along[row]))
            near |= (
                (distance <= VERTEX_ON_EDGE * geometry.size[k])
                & (along_axis >= 0)
                & (along_axis <= length[row])
            )
            own_facet = sides[edge].max()
            opposite = np.setdiff1d(facet_of[part == k][near], [own_facet])
            if len(opposite):
                sides[edge, int(np.argmin(sides[edge]))] = opposite[0]
    return sides, True


def _bridge_slivers(facets: Facets, ends: Index, sides: Index) -> tuple[Index, Index, bool]:
    """Make the two facets on both sides of a facet without width neighbours of each other.

    Edges inside a sliver are dropped; also returns whether there is any sliver.
    """
    sliver = lengths(facets.normal) < 0.5
    at_sliver = sliver[sides] & (sides >= 0)
    if not at_sliver.any():
        return ends, sides, False
    inside_sliver = at_sliver.all(axis=1)
    label = connected(len(sliver), *sides[inside_sliver].T)
    beyond: dict[int, set[int]] = {}
    rim = np.flatnonzero(at_sliver.any(axis=1) & ~inside_sliver)
    for row in rim:
        side = int(at_sliver[row, 1])
        beyond.setdefault(int(label[sides[row, side]]), set()).add(int(sides[row, 1 - side]))
    sides = sides.copy()
    for row in rim:
        side = int(at_sliver[row, 1])
        own_facet = int(sides[row, 1 - side])
        opposite = sorted(beyond[int(label[sides[row, side]])] - {own_facet, -1})
        sides[row, side] = opposite[0] if opposite else own_facet
    keep = ~inside_sliver & (sides[:, 0] != sides[:, 1])
    return ends[keep], sides[keep], True


def _boundary(facets: Facets, which: Index) -> tuple[Index, Index, Index]:
    """Directed boundary edges of facets: start, end, and the facet to the left."""
    length = np.diff(facets.corner_start)[which]
    place, k = counted(length)
    owner = which[place]
    row = facets.corner_start[owner] + k
    step = np.where(facets.convex[owner], np.repeat(length, length), 3)
    following = row + np.where((k + 1) % step == 0, 1 - step, 1)
    begin, end = facets.corners[row], facets.corners[following]
    by_triangles = ~facets.convex[owner]
    if by_triangles.any():  # sides between triangles of the same facet are not edges of the part
        is_shared = np.zeros(len(begin), dtype=bool)
        rows = np.flatnonzero(by_triangles)
        is_shared[rows] = _run_both_ways(begin[rows], end[rows], owner[rows])
        begin, end, owner = begin[~is_shared], end[~is_shared], owner[~is_shared]
    return begin, end, owner


def _run_both_ways(begin: Index, end: Index, owner: Index) -> Mask:
    """Mask of directed edges that also occur in reverse for the same owner."""
    low, high, forward = np.minimum(begin, end), np.maximum(begin, end), begin < end
    # a single sort brings both directions of an edge together, and no table of all pairs is needed
    order = np.lexsort((high, low, owner))
    is_new = np.ones(len(order), dtype=bool)
    is_new[1:] = False
    for key in (owner, low, high):
        is_new[1:] |= np.diff(key[order]) != 0
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(is_new) - 1
    runs = np.bincount(group[forward], minlength=len(order)) > 0
    runs_back = np.bincount(group[~forward], minlength=len(order)) > 0
    both: Mask = (runs[group] & runs_back[group]) | (low == high)
    return both


def segment_distance(p1: Array, q1: Array, p2: Array, q2: Array) -> tuple[Array, Array, Array]:
    """Distance between two segments that are not parallel, shape (n,), and their nearest points.

    Examples
    --------
    >>> segment_distance(*(np.array([x], dtype=float) for x in
    ...                    ([-1, 0, 0], [1, 0, 0], [0, -1, 1], [0, 1, 1])))
    (array([1.]), array([[0., 0., 0.]]), array([[0., 0., 1.]]))
    """
    d1, d2, r = q1 - p1, q2 - p2, p1 - p2
    a, e, b = (np.einsum("ij,ij->i", x, y) for x, y in ((d1, d1), (d2, d2), (d1, d2)))
    a, e = np.maximum(a, TINY), np.maximum(e, TINY)
    across = cross(d1, d2)  # its square is a e - b b, without cancellation
    determinant = np.maximum(np.einsum("ij,ij->i", across, across), TINY)
    s = t = np.zeros(len(a))
    for _ in range(3):  # iterative refinement: nearly parallel lines lose digits
        gap = r + s[:, None] * d1 - t[:, None] * d2
        c, f = np.einsum("ij,ij->i", d1, gap), np.einsum("ij,ij->i", d2, gap)
        s, t = s + (b * f - c * e) / determinant, t + (a * f - b * c) / determinant
    # the lines may meet outside the segments: clamp s, then t, then s again (Ericson, 5.1.9)
    s = np.clip(s, 0, 1)
    c, f = np.einsum("ij,ij->i", d1, r), np.einsum("ij,ij->i", d2, r)
    t_far = (b * s + f) / e
    t = np.where((s == 0) | (s == 1), t_far, t)
    clipped = np.clip(t, 0, 1)
    s = np.where(clipped == t, s, np.clip((b * clipped - c) / a, 0, 1))
    t = clipped
    x, y = p1 + s[:, None] * d1, p2 + t[:, None] * d2
    return lengths(x - y), x, y
