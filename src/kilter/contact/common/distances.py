"""Distances of points, segments, triangles and parts; the nearest part of a lone part.

The nearest point of a triangle to x lies inside it, below x, or on its boundary. Two triangles
cross if a side of one pierces the other. Otherwise their nearest points are a corner of one, or lie
on a side of each.

    gap(A, B) = min |x - y|,    x on a triangle of A, y on a triangle of B.

manifold3d computes it within an upper bound, here the least distance of corners. Other parts are
visited in the order of the distances between their boxes, until that distance reaches the gap.

Curved faces count as their triangles, so the error of a gap is at most the sagittas of both parts
plus the accuracy of their coordinates: `Neighbour.accuracy`. If the triangles of a part bound no
body, only the corners of both parts are compared, and the true gap is at most the reported gap.

References
----------
C. Ericson, Real-Time Collision Detection, 2005, chapter 5.1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    cross,
    lengths,
    nearest,
    ratio,
    squares,
    unit_rows,
)
from kilter.assembly.geometry import Geometry, refine
from kilter.contact.contact_tolerances import DISTANCE_ROUNDING, FREE_PARALLEL
from kilter.shape.closed import bounds_a_body, weld
from kilter.tell.record import Record
from kilter.work import is_late

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


NEAR = 2
"""Number of nearby triangles whose distance bounds that of the nearest triangle."""
CLASS_RATIO = 4.0
"""Ratio of the sizes of triangles that are searched together; a larger value prunes less [-]."""
MOST_CLASSES = 8
"""Largest number of classes of size; triangles smaller than the last class join it."""
FIRST_MIDDLES = 8
"""Number of middles of triangles that the first round examines for each point."""
BATCH = 1_000_000
"""Pairs (point, triangle) computed at once; a larger value needs more memory."""


def surface_distance(points: Array, triangles: Array, most: Array | None = None) -> Array:
    """Distance of each point, shape (n, 3), from the nearest of m triangles [length unit], (n,).

    `most`, shape (n,): upper bounds on the distances, by default those of `at_most`; the result is
    never above them.

    Examples
    --------
    >>> corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> surface_distance(np.array([[0.2, 0.2, 3], [-2, 0, 0], [1, 1, 0]]), corners).round(3)
    array([3.   , 2.   , 0.707])
    """
    return TriangleTrees(triangles).distance(points, most)


@dataclass(frozen=True, eq=False)
class TriangleTrees:
    """Triangles, shape (m, 3, 3), with the search trees for several questions about distances."""

    triangles: Array

    @cached_property
    def _middle(self) -> Array:
        """Middles of the triangles, shape (m, 3)."""
        middle: Array = self.triangles.mean(axis=1)
        return middle

    @cached_property
    def _tree(self) -> cKDTree:
        """Search tree of all middles."""
        from scipy.spatial import cKDTree

        return cKDTree(self._middle)

    @cached_property
    def _classes(self) -> list[_SizeClass]:
        """The triangles by size; no triangle of a class is much larger than another."""
        radius = lengths(self.triangles - self._middle[:, None]).max(axis=1, initial=0.0)
        return [
            _SizeClass(self.triangles[rows], self._middle[rows], float(radius[rows].max()))
            for rows in _size_classes(radius)
        ]

    def at_most(self, points: Array) -> Array:
        """Upper bound on the distance of each point from the nearest triangle, as `at_most`."""
        _, near = self._tree.query(points, k=np.arange(1, min(NEAR, len(self.triangles)) + 1))
        return _least_distance(points, self.triangles[near])

    def distance(
        self, points: Array, most: Array | None = None, *, enough: float = -np.inf
    ) -> Array:
        """Distance of each point from the nearest triangle, as `surface_distance`.

        Distances up to `enough` are not reduced further [length unit].
        """
        least = at_most(points, self.triangles) if most is None else most.copy()
        for some in self._classes:
            some.reduce_to_nearest(least, points, enough)
        return least

    def within(self, points: Array, reach: float) -> Mask:
        """Mask of the points, shape (n,), at most `reach` from the nearest triangle.

        The middle of a triangle is a point of it, so a point near a middle needs no exact distance.

        Examples
        --------
        >>> corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
        >>> points = np.array([[0.2, 0.2, 3], [-2, 0, 0], [1, 1, 0]])
        >>> TriangleTrees(corners).within(points, 2.0)
        array([False,  True,  True])
        """
        if not len(points) or not len(self.triangles):
            return np.zeros(len(points), dtype=bool)
        low, high = self.triangles.min(axis=(0, 1)) - reach, self.triangles.max(axis=(0, 1)) + reach
        is_within: Mask = ((low <= points) & (points <= high)).all(axis=1)
        near = np.flatnonzero(is_within)
        if len(near):
            distance, _ = self._tree.query(points[near], distance_upper_bound=reach)
            rest = near[distance > reach]
            bound = np.full(len(rest), 2 * reach)
            is_within[rest] = self.distance(points[rest], bound) <= reach
        return is_within


def _size_classes(radius: Array) -> list[Index]:
    """Divide triangles into classes whose radii differ by a factor of `CLASS_RATIO` at most."""
    largest = float(radius.max(initial=0.0))
    if largest == 0.0:
        return [np.arange(len(radius))] if len(radius) else []
    steps = np.log(largest / np.maximum(radius, largest * CLASS_RATIO**-MOST_CLASSES))
    number = np.floor(steps / np.log(CLASS_RATIO)).astype(np.int64)
    return [np.flatnonzero(number == k) for k in np.unique(number).tolist()]


@dataclass(frozen=True, eq=False)
class _SizeClass:
    """Triangles of similar size, their middles, and the largest distance of a corner from its."""

    triangles: Array
    middle: Array
    radius: float

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self.middle)

    def reduce_to_nearest(self, least: Array, points: Array, enough: float) -> None:
        """Reduce distances of points above `enough` to those of the nearest triangle, in place.

        No point of a triangle is farther than `radius` from its middle. So a triangle whose
        middle is farther than the least distance plus `radius` changes nothing. Each round examines
        the next nearest middles of the points whose rest may still be closer.
        """
        middle, radius = self.middle, self.radius
        low, high = middle.min(axis=0), middle.max(axis=0)
        from_box = lengths(points - np.clip(points, low, high))
        may_reduce = from_box <= (least + radius) * (1 + DISTANCE_ROUNDING)
        rest = np.flatnonzero(may_reduce & (least > enough))
        begin, count = 0, min(FIRST_MIDDLES, len(middle))
        while len(rest) and begin < len(middle):
            still = []
            for batch in np.array_split(rest, 1 + len(rest) * count // BATCH):
                within = (least[batch] + radius) * (1 + DISTANCE_ROUNDING)
                farther = float(within.max()) * (1 + DISTANCE_ROUNDING)  # the bound is excluded
                number = np.arange(begin + 1, count + 1)
                distance, row = self._tree.query(
                    points[batch], k=number, distance_upper_bound=farther
                )
                k, column = np.nonzero(distance <= within[:, None])
                near = points[batch[k]]
                foot = _nearest_point(near, self.triangles[row[k, column]])
                np.minimum.at(least, batch[k], lengths(near - foot))
                may_reduce = distance[:, -1] <= (least[batch] + radius) * (1 + DISTANCE_ROUNDING)
                still.append(batch[may_reduce & (least[batch] > enough)])
            rest = np.concatenate(still)
            begin, count = count, min(4 * count, len(middle))


def at_most(points: Array, triangles: Array) -> Array:
    """Upper bound on the distance of each point from the nearest triangle [length unit], (n,)."""
    near = nearest(triangles.mean(axis=1), points, min(NEAR, len(triangles)))[1]
    return _least_distance(points, triangles[near])


def _least_distance(points: Array, triangles: Array) -> Array:
    """Least distance of point k from the triangles k, shape (n, m, 3, 3)."""
    count = triangles.shape[1]
    repeated = np.repeat(points, count, axis=0)
    off = lengths(repeated - _nearest_point(repeated, triangles.reshape(-1, 3, 3)))
    least: Array = off.reshape(-1, count).min(axis=1)
    return least


def triangle_distance(points: Array, triangles: Array) -> Array:
    """Distance of each point, shape (n, 3), from the triangle of its row, (n, 3, 3); shape (n,)."""
    return lengths(points - _nearest_point(points, triangles))


def _nearest_point(points: Array, triangles: Array) -> Array:
    """The point of triangle k that is nearest to point k, shape (n, 3)."""
    normal = unit_rows(cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    height = np.einsum("ij,ij->i", points - triangles[:, 0], normal)
    projection = points - height[:, None] * normal
    inside = _projects_inside(projection, triangles, normal)
    foot: Array = projection
    nearest = np.where(inside, np.abs(height), np.inf)
    for k in range(3):
        start, along = triangles[:, k], triangles[:, (k + 1) % 3] - triangles[:, k]
        t = ratio(np.einsum("ij,ij->i", points - start, along), squares(along))
        on_side = start + np.clip(t, 0, 1)[:, None] * along
        off = lengths(points - on_side)
        closer = off < nearest
        foot = np.where(closer[:, None], on_side, foot)
        nearest = np.where(closer, off, nearest)
    return foot


def _projects_inside(points: Array, triangles: Array, normal: Array) -> Mask:
    """Mask of points in the plane of their triangle that lie inside it."""
    inside: Mask = (normal != 0).any(axis=1)
    for k in range(3):
        start, along = triangles[:, k], triangles[:, (k + 1) % 3] - triangles[:, k]
        inside &= np.einsum("ij,ij->i", cross(along, points - start), normal) >= 0
    return inside


def near_triangles(first: Array, second: Array, reach: float | Array) -> Array:
    """Middle points between the triangles of each row that are within `reach`, shape (m, 3).

    `reach` [length unit] is one number, or one for each row, shape (n,).

    Examples
    --------
    >>> flat = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]])
    >>> near_triangles(flat, flat + [0, 0, 0.5], 1.0).shape
    (1, 3)
    >>> near_triangles(flat, flat + [0, 0, 1.5], 1.0).shape
    (0, 3)
    """
    apart = _beyond_plane(first, second, reach) | _beyond_plane(second, first, reach)
    first, second, reach = first[~apart], second[~apart], np.broadcast_to(reach, len(apart))[~apart]
    off, point = _piercing_distance(first, second)
    for candidate in (
        _piercing_distance(second, first),
        *_corner_distances(first, second),
        *_corner_distances(second, first),
    ):
        off, point = _nearer((off, point), candidate)
    for k in range(3):
        for m in range(3):
            sides = (first[:, k], first[:, k - 1], second[:, m], second[:, m - 1])
            off, point = _nearer((off, point), _side_distance(*sides))
    return point[off <= reach]


def _beyond_plane(first: Array, second: Array, reach: float | Array) -> Mask:
    """Mask of rows whose first triangle is beyond `reach` of the second triangle's plane."""
    normal = unit_rows(cross(second[:, 1] - second[:, 0], second[:, 2] - second[:, 0]))
    height = np.einsum("nki,ni->nk", first - second[:, :1], normal)
    aside: Mask = (height.min(axis=1) > reach) | (height.max(axis=1) < -reach)
    return aside


def _nearer(first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
    """In each row, the (distance, point) with the smaller distance."""
    closer = second[0] < first[0]
    return np.where(closer, second[0], first[0]), np.where(closer[:, None], second[1], first[1])


def _corner_distances(first: Array, second: Array) -> list[tuple[Array, Array]]:
    """Distances of the corners of the first triangles from the second, and middle points."""
    candidates = []
    for k in range(3):
        foot = _nearest_point(first[:, k], second)
        candidates.append((lengths(first[:, k] - foot), (first[:, k] + foot) / 2))
    return candidates


def _piercing_distance(first: Array, second: Array) -> tuple[Array, Array]:
    """Distance 0 and the crossing point where a side of the first triangle pierces the second.

    Other rows have the distance infinity.
    """
    normal = unit_rows(cross(second[:, 1] - second[:, 0], second[:, 2] - second[:, 0]))
    off, point = np.full(len(first), np.inf), first[:, 0]
    for k in range(3):
        start, end = first[:, k - 1], first[:, k]
        low, high = (np.einsum("ij,ij->i", x - second[:, 0], normal) for x in (start, end))
        cuts = (low * high <= 0) & (low != high)
        t = np.where(cuts, low / np.where(cuts, low - high, 1.0), 0.0)
        crossing = start + t[:, None] * (end - start)
        through = cuts & _projects_inside(crossing, second, normal)
        off, point = np.where(through, 0.0, off), np.where(through[:, None], crossing, point)
    return off, point


def _side_distance(p: Array, q: Array, r: Array, s: Array) -> tuple[Array, Array]:
    """Distance and midpoint of the segments p q and r s; infinity if they are parallel."""
    d, e = q - p, s - r
    size = lengths(d) * lengths(e)
    skew = np.flatnonzero(lengths(cross(d, e)) > FREE_PARALLEL * size)
    off, point = np.full(len(p), np.inf), p.copy()
    off[skew], on_first, on_second = segment_distance(p[skew], q[skew], r[skew], s[skew])
    point[skew] = (on_first + on_second) / 2
    return off, point


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


@dataclass(frozen=True, slots=True, eq=False)
class PartSolids:
    """Solids of the library manifold3d for the parts of an assembly, created on first use.

    The centre of mass of a part is at the origin: coordinates keep their digits far from the origin
    of the file. With `finer` (rounds, box), triangles inside a box are refined onto their exact
    surfaces. `cache` and `surfaces` keep the solids and the search trees of the parts.
    """

    geometry: Geometry
    finer: tuple[int, tuple[Array, Array]] | None = None
    cache: dict[int, Any] = field(default_factory=dict)
    surfaces: dict[int, TriangleTrees] = field(default_factory=dict)

    def of(self, part: int) -> Any:
        """The solid of a part about its centre of mass; None if its triangles enclose no volume."""
        if part not in self.cache:
            self.cache[part] = self._make(part)
        return self.cache[part]

    def surface_of(self, part: int) -> TriangleTrees:
        """The triangles of a part with their search trees."""
        if part not in self.surfaces:
            self.surfaces[part] = TriangleTrees(self.geometry.corners_of(part))
        return self.surfaces[part]

    def _make(self, part: int) -> Any:
        """Merge the corners of a part's triangles into a solid; None if they enclose no volume."""
        import manifold3d  # slow to import

        g = self.geometry
        rounds, box = self.finer or (0, (g.center[part], g.center[part]))
        corners, rows = refine(g, part, rounds, box)
        vertices, triangles, _ = weld(
            corners - g.center[part], rows, accuracy=float(g.accuracy[part])
        )
        if not bounds_a_body(triangles):
            return None
        mesh = manifold3d.Mesh64(
            vert_properties=np.ascontiguousarray(vertices),
            tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
            run_index=np.array([0, 3 * len(triangles)], dtype=np.uint64),
            run_original_id=np.array([part + 1], dtype=np.uint32),
        )
        solid = manifold3d.Manifold(mesh)
        return solid if solid.status() == manifold3d.Error.NoError else None


MOST_PARTS = 200
"""Largest number of parts whose nearest neighbour is searched for."""


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A part that touches nothing, with the part nearest to it and the gap."""

    part: int
    other: int
    """The part, and its nearest neighbour, by position."""
    gap: float
    """Distance of their surfaces [length unit]."""
    accuracy: float
    """Largest error of the gap [length unit]."""


class LonePart(Record):
    """A part that touches nothing, and the part nearest to it."""

    part: str
    """Name of the part."""
    nearest: str | None = None
    """Name of the nearest part; null if it was not searched for."""
    gap: float | None = None
    """Distance of their surfaces [length unit]."""
    accuracy: float | None = None
    """Largest error of the gap [length unit]."""
    grounded: bool
    """Whether the part is held."""


def nearest_parts(geometry: Geometry, parts: Iterable[int]) -> tuple[Neighbour, ...]:
    """For each of the first `MOST_PARTS` given parts, the nearest other part and the gap.

    A time limit ends the search; the later parts are then left out.

    `parts`: parts that touch nothing.
    """
    searched = list(parts)[:MOST_PARTS]
    if not searched or len(geometry.mass) < 2:
        return ()
    solids, boxes = PartSolids(geometry), geometry.part_boxes
    return tuple(
        nearest_to_group(solids, np.array([part]), boxes)
        for part in takewhile(lambda _: not is_late(), searched)
    )


def nearest_to_group(solids: PartSolids, group: Index, boxes: tuple[Array, Array]) -> Neighbour:
    """The part outside a group that is nearest to it, and the part of the group at that distance.

    Arguments: `group` (n,): parts, fewer than all; `boxes`: lower and upper corners of the boxes of
    all parts, shape (N, 3) each [length unit]. Pairs are tried by the distances of their boxes,
    first for the distances of corners: with a close bound the library finds a gap much sooner.
    """
    geometry, of_corners = solids.geometry, dict[tuple[int, int], float]()

    def corner_distance(a: int, b: int, _: float) -> float:
        """Least distance of corners of two parts, which is kept."""
        distance = float(nearest(_corners(geometry, a), _corners(geometry, b))[0].min())
        of_corners[a, b] = distance
        return distance

    def gap_below(a: int, b: int, most: float) -> float:
        """Gap between two parts, or `most` if the gap is larger."""
        return _gap(solids, a, b, min(most, of_corners.get((a, b), np.inf)))

    _, bound = _nearest_pair(group, boxes, corner_distance, np.inf)
    pair, gap = _nearest_pair(group, boxes, gap_below, float(np.nextafter(bound, np.inf)))
    accuracy = float((geometry.slack[pair] + geometry.accuracy[pair]).sum())
    return Neighbour(pair[0], pair[1], gap, accuracy)


def _nearest_pair(
    group: Index,
    boxes: tuple[Array, Array],
    distance_of: Callable[[int, int, float], float],
    most: float,
) -> tuple[list[int], float]:
    """The nearest pair of a part of a group and another part, and its distance below `most`.

    `distance_of`: distance of two parts, which matters only if it is below the third argument.
    """
    low, high = boxes
    around = low[group].min(axis=0), high[group].max(axis=0)
    from_group = _box_distance(around, (low, high))
    from_group[group] = np.inf
    pair, gap = [-1, -1], most
    for other in np.argsort(from_group, kind="stable")[: -len(group)].tolist():
        # the distance of the boxes is a lower bound: no later part is nearer
        if from_group[other] >= gap:
            break
        apart = _box_distance((low[other], high[other]), (low[group], high[group]))
        for k in np.argsort(apart, kind="stable").tolist():
            if apart[k] >= gap:
                break
            distance = distance_of(int(group[k]), other, gap)
            if distance < gap:
                pair, gap = [int(group[k]), other], distance
    return pair, gap


def _box_distance(box: tuple[Array, Array], boxes: tuple[Array, Array]) -> Array:
    """Distance of a box from each of n boxes [length unit], shape (n,)."""
    low, high = boxes
    between = np.maximum(np.maximum(low - box[1], box[0] - high), 0.0)
    distance: Array = np.linalg.norm(between, axis=1)
    return distance


def _gap(solids: PartSolids, a: int, b: int, most: float) -> float:
    """Gap between parts a and b [length unit], or `most` if the gap is larger."""
    geometry = solids.geometry
    solid_a, solid_b = solids.of(a), solids.of(b)
    if solid_a is not None and solid_b is not None:
        shifted_b = solid_b.translate(tuple((geometry.center[b] - geometry.center[a]).tolist()))
        return float(solid_a.min_gap(shifted_b, most))
    # a part bounds no body: distances of the corners from the triangles bound the gap
    for points, part in ((_corners(geometry, a), b), (_corners(geometry, b), a)):
        limit = np.full(len(points), most)
        most = float(surface_distance(points, geometry.corners_of(part), limit).min())
    return most


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
