"""Edges of parts: boundaries between facets, and the exact curves that they replace.

An edge of the triangles is a chord of the curve in which its two faces meet. A point of the chord
is moved to the curve by Newton steps of least length: with the distances d of a point from both
faces and their normals N, the step is -N^T (N N^T)^-1 d. The step leaves the position along the
curve, so that the fraction of the chord remains a parameter of the curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    Rows,
    angle_between,
    columns,
    connected,
    counted,
    cross,
    largest_entries,
    lengths,
    ragged,
    ratio,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.common.broad import Boxes, boxes_in
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.facets import Facets
from kilter.contact.contact_tolerances import (
    CONE_ANGLE,
    CURVE_ROUNDING,
    RAY_ANGLE,
    SMOOTH_ANGLE,
    VERTEX_ON_EDGE,
)
from kilter.shape.covering import covered


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """Edges of a set of parts between their facets, ordered by part."""

    start: Index
    """The edges of part i are rows ``start[i]`` to ``start[i + 1]``, shape (N + 1,)."""
    ends_of: Index
    """Vertices at both ends, shape (E, 2)."""
    facet: Index
    """The facet left of the edge and the facet right of it, seen from outside (-1: none), shape
    (E, 2)."""
    ray_start: Index
    ray_edge: Index
    """Edges that end in vertex v: ``ray_edge[ray_start[v]:ray_start[v + 1]]``."""
    doubled: bool
    """True if edges may lie on other edges, because facets of no width lay between them."""

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
        parts, place = np.unique(part, return_inverse=True)
        owner, edges = ragged(self.start, parts)
        start = np.searchsorted(owner, np.arange(len(parts) + 1))
        k, row = boxes_in(start, place, box, self.boxes(boxes, edges))
        return k, edges[row]

    def boxes(self, boxes: Boxes, which: Index) -> tuple[Array, Array]:
        """Bounding boxes of the edges `which`: lower and upper corners, shape (n, 3) each."""
        p, q = (boxes.turned[end] for end in self.ends_of[which].T)
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


NEAREST_STEPS = 12
"""Steps that locate the point of a curve that is nearest to another point."""
NEWTON_STEPS = 5
"""Steps that move a point of a chord to its curve; each doubles the number of correct digits."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvePoints(Rows):
    """Points of edges with the unit tangents of their curves, and the normals of both faces.

    All arrays have the shape (n, 3). Tangents lead from the first to the second end of the edge;
    `left` and `right` are the outward normals of the faces beside it, seen from outside.
    """

    at: Array = columns(3)
    along: Array = columns(3)
    left: Array = columns(3)
    right: Array = columns(3)

    def behind(self, normal: Array) -> Mask:
        """Mask of points at which the material lies behind a plane, shape (n,).

        `normal` is the outward normal of the plane, shape (3,), or of a plane for each point.
        """
        into_left, into_right = cross(self.left, self.along), cross(self.along, self.right)
        inward = into_left + into_right - self.left - self.right
        result = np.ones(len(self.at), dtype=bool)
        for direction in (into_left, into_right, inward):
            result &= (direction * normal).sum(axis=1) <= CONE_ANGLE
        return result


def face_distance(
    geometry: Geometry, facets: Facets, surface: Index, facet: Index, points: Array
) -> tuple[Array, Array]:
    """Signed distance of points from faces, shape (n,), and outward normals there, shape (n, 3).

    `surface`, shape (n,): curved surface of each point; -1: the plane of `facet`.
    """
    s = geometry.surfaces
    normal = facets.normal[facet].copy()
    distance = np.einsum("ij,ij->i", points - facets.origin[facet], normal)
    k = np.flatnonzero(surface >= 0)
    if len(k):
        distance[k], normal[k] = s.distance_and_outward(surface[k], points[k])
    return distance, normal


@dataclass(frozen=True, slots=True, eq=False)
class EdgeCurves:
    """The curves of the edges of a contact search."""

    geometry: Geometry
    facets: Facets
    edges: Edges

    def exact(self, edge: Index) -> Mask:
        """Mask of edges between two faces whose surfaces are known exactly, shape (n,)."""
        s = self.geometry.surfaces
        result = np.ones(len(edge), dtype=bool)
        for facet in self.edges.facet[edge].T:
            surface = self.facets.surface[facet]
            known = (facet >= 0) & (self.facets.normal[facet] != 0).any(axis=1)
            k = np.flatnonzero(surface >= 0)
            known[k] &= (s.kind[surface[k]] != FREE) & (s.doubt[surface[k]] == 0)
            result &= known
        return result

    def sharp(self, edge: Index) -> Mask:
        """Mask of exact edges whose faces meet at an angle, shape (n,)."""
        distinct, place = np.unique(edge, return_inverse=True)
        left, right = (self.facets.surface[facet] for facet in self.edges.facet[distinct].T)
        middle = self.points(distinct, np.full(len(distinct), 0.5))
        bend = angle_between(middle.left, middle.right)
        is_sharp: Mask = ~((left == right) & (left >= 0)) & (bend > SMOOTH_ANGLE)
        return is_sharp[place]

    def points(self, edge: Index, share: Array) -> CurvePoints:
        """Points of exact edges at the given fractions of their chords, shape (n,)."""
        p, q = self.edges.ends(self.geometry, edge)
        at = p + share[:, None] * (q - p)
        rounding = CURVE_ROUNDING * self._coordinates(p, q)
        moving = np.arange(len(edge))
        for _ in range(NEWTON_STEPS):
            step = self._step(edge[moving], at[moving])
            at[moving] -= step
            moving = moving[largest_entries(step) > rounding[moving]]
            if not len(moving):
                break
        (_, left), (_, right) = self._sides(edge, at)
        along = unit_rows(cross(left, right))
        forward = np.einsum("ij,ij->i", along, q - p) < 0
        return CurvePoints(at, np.where(forward[:, None], -along, along), left, right)

    def _step(self, edge: Index, at: Array) -> Array:
        """Newton steps of least length from points to the curves of edges, shape (n, 3)."""
        (d, m), (e, n) = self._sides(edge, at)
        c = np.einsum("ij,ij->i", m, n)
        across = cross(m, n)
        square = np.maximum(np.einsum("ij,ij->i", across, across), TINY)
        step: Array = ((d - c * e) / square)[:, None] * m + ((e - c * d) / square)[:, None] * n
        # tangent faces have no common direction of steps: the chord is kept
        step[square <= SMOOTH_ANGLE**2 / 4] = 0.0
        return step

    def _sides(self, edge: Index, at: Array) -> list[tuple[Array, Array]]:
        """Signed distances of points from both faces of edges, and the normals of these faces."""
        return [
            face_distance(self.geometry, self.facets, self.facets.surface[facet], facet, at)
            for facet in self.edges.facet[edge].T
        ]

    @staticmethod
    def _coordinates(p: Array, q: Array) -> Array:
        """Size of the coordinates of edges from p to q, which are rounded, shape (n,)."""
        return lengths(q - p) + largest_entries(p)

    def nearest_share(self, edge: Index, point: Array) -> Array:
        """Position of the point of each curve that is nearest to a point, in [0, 1], shape (n,).

        The position is the fraction of the chord.
        """
        p, q = self.edges.ends(self.geometry, edge)
        chord = q - p
        square = np.maximum(np.einsum("ij,ij->i", chord, chord), TINY)
        t: Array = np.clip(np.einsum("ij,ij->i", point - p, chord) / square, 0, 1)
        rounding = self.share_rounding(edge)
        moving = np.arange(len(edge))
        for _ in range(NEAREST_STEPS):
            x = self.points(edge[moving], t[moving])
            along = np.einsum("ij,ij->i", point[moving] - x.at, x.along)
            speed = np.maximum(np.einsum("ij,ij->i", x.along, chord[moving]), TINY)
            last = t[moving]
            t[moving] = np.clip(last + along / speed, 0, 1)
            moving = moving[np.abs(t[moving] - last) > rounding[moving]]
            if not len(moving):
                break
        return t

    def share_rounding(self, edge: Index) -> Array:
        """Rounding of the fraction of a chord, from that of the coordinates [-], shape (n,)."""
        p, q = self.edges.ends(self.geometry, edge)
        return CURVE_ROUNDING * ratio(self._coordinates(p, q), lengths(q - p))

    def beside(self, part: int, point: Array, reach: float) -> Index:
        """Edges of a part whose chords come within `reach` of a point, shape (n,)."""
        every = np.arange(self.edges.start[part], self.edges.start[part + 1])
        near: Index = every[self._chord_distance(every, point[None])[0] <= reach]
        return near

    def at_edge(self, part: int, point: Array, most: float) -> bool:
        """Whether a point lies within `most` of an exact sharp edge of a part [length unit]."""
        near = self.beside(part, point, most + float(self.geometry.slack[part]))
        return bool((self.distances(near, point) <= most).any())

    def distances(self, edge: Index, point: Array) -> Array:
        """Distances of a point from the exact sharp edges among `edge` [length unit], (m,)."""
        edge = edge[self.exact(edge)]
        edge = edge[self.sharp(edge)]
        at = self.points(edge, self.nearest_share(edge, np.tile(point, (len(edge), 1)))).at
        result: Array = lengths(point - at)
        return result

    def extends(
        self, part: int, face: tuple[int, int], at: tuple[Array, Array], triangles: Array,
        depth: float, grow: float,
    ) -> Mask:  # fmt: skip
        """Mask of points of a surface to which a face extends, up to `grow` beside it, shape (n,).

        The triangles of a face end at chords of its edges. Beside an edge with a curve the curve
        decides, and elsewhere the triangles.

        `depth`: largest distance of a triangle from a point along the normal [length unit]. `grow`:
        largest distance of a point from the face [length unit].
        """
        points, normals = at
        result = covered(triangles, points, normals, depth, grow)
        slack = float(self.geometry.slack[part])
        edge, is_left = self._bounding(part, face)
        if slack == 0 or not len(edge):
            return result
        row, number = np.nonzero(self._chord_distance(edge, points) <= slack + grow)
        kept = ~np.isin(row, row[~self.exact(edge)[number]])
        row, number = row[kept], number[kept]
        rows = np.unique(row)
        if not len(rows):
            return result
        x = self.points(edge[number], self.nearest_share(edge[number], points[row]))
        offset = points[row] - x.at
        left, right = cross(x.left, x.along), cross(x.along, x.right)
        into = np.where(is_left[number][:, None], left, right)
        distance = lengths(offset)
        least = np.full(len(points), np.inf)
        np.minimum.at(least, row, distance)
        outside = np.einsum("ij,ij->i", offset, into) < -grow
        outside &= distance <= least[row] + grow / 10  # the nearest curve decides
        wide = covered(triangles, points[rows], normals[rows], depth, grow + slack)
        result[rows] = wide & ~np.isin(rows, row[outside])
        return result

    def _bounding(self, part: int, face: tuple[int, int]) -> tuple[Index, Mask]:
        """Edges that bound a face, and a mask of those that have the face on their left side."""
        edge = np.arange(self.edges.start[part], self.edges.start[part + 1])
        sides = self.edges.facet[edge]
        surface, facet = face
        own = (self.facets.surface[sides] == surface) if surface >= 0 else (sides == facet)
        bounds = own[:, 0] != own[:, 1]
        return edge[bounds], own[bounds, 0]

    def _chord_distance(self, edge: Index, points: Array) -> Array:
        """Distance of each of n points from the chords of m edges [length unit], shape (n, m)."""
        p, q = self.edges.ends(self.geometry, edge)
        square = np.maximum(np.einsum("ij,ij->i", q - p, q - p), TINY)
        offset = points[:, None] - p
        t = np.clip(np.einsum("nmi,mi->nm", offset, q - p) / square, 0, 1)
        distance: Array = lengths(offset - t[..., None] * (q - p))
        return distance


def part_curves(search: ContactSearch, part: int) -> EdgeCurves:
    """The curves of the edges of a part of a contact search, which are found on first use."""
    curves = search.part_curves.get(part)
    if curves is None:
        edges = find_edges(search.geometry, search.facets, np.array([part]))
        curves = search.part_curves[part] = EdgeCurves(search.geometry, search.facets, edges)
    return curves
