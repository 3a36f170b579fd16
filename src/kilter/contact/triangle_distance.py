"""Distances of points and of triangles from triangles, row by row.

The nearest point of a triangle to x lies inside it, below x, or on its boundary. Two triangles
cross if a side of one pierces the other. Otherwise their nearest points are a corner of one, or lie
on a side of each.

References
----------
C. Ericson, Real-Time Collision Detection, 2005, chapter 5.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, lengths, nearest, ratio, squares, unit_rows
from kilter.contact.contact_tolerances import DISTANCE_ROUNDING, FREE_PARALLEL
from kilter.contact.sharp.edges import segment_distance

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = ["TriangleTrees", "at_most", "near_triangles", "surface_distance"]


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

    Parameters
    ----------
    points, triangles : ndarray
    most : ndarray, shape (n,), optional
        Upper bounds on the distances, by default those of `at_most`. The result is never
        above them.

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

    def distance(self, points: Array, most: Array | None = None) -> Array:
        """Distance of each point from the nearest triangle, as `surface_distance`."""
        least = at_most(points, self.triangles) if most is None else most.copy()
        for some in self._classes:
            some.reduce_to_nearest(least, points)
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

    def reduce_to_nearest(self, least: Array, points: Array) -> None:
        """Reduce distances of points to those of the nearest triangle, in place.

        No point of a triangle is farther than `radius` from its middle. So a triangle whose
        middle is farther than the least distance plus `radius` changes nothing. Each round examines
        the next nearest middles of the points whose rest may still be closer.
        """
        middle, radius = self.middle, self.radius
        low, high = middle.min(axis=0), middle.max(axis=0)
        from_box = lengths(points - np.clip(points, low, high))
        rest = np.flatnonzero(from_box <= (least + radius) * (1 + DISTANCE_ROUNDING))
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
                still.append(
                    batch[distance[:, -1] <= (least[batch] + radius) * (1 + DISTANCE_ROUNDING)]
                )
            rest = np.concatenate(still)
            begin, count = count, min(4 * count, len(middle))


def at_most(points: Array, triangles: Array) -> Array:
    """Upper bound on the distance of each point from the nearest triangle [length unit], (n,)."""
    count = min(NEAR, len(triangles))
    near = nearest(triangles.mean(axis=1), points, count)[1].reshape(-1)
    repeated = np.repeat(points, count, axis=0)
    off = lengths(repeated - _nearest_point(repeated, triangles[near]))
    bound: Array = off.reshape(-1, count).min(axis=1)
    return bound


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


def near_triangles(first: Array, second: Array, reach: float) -> Array:
    """Middle points between the triangles of each row that are within `reach`, shape (m, 3).

    Examples
    --------
    >>> flat = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]])
    >>> near_triangles(flat, flat + [0, 0, 0.5], 1.0).shape
    (1, 3)
    >>> near_triangles(flat, flat + [0, 0, 1.5], 1.0).shape
    (0, 3)
    """
    apart = _beyond_plane(first, second, reach) | _beyond_plane(second, first, reach)
    first, second = first[~apart], second[~apart]
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


def _beyond_plane(first: Array, second: Array, reach: float) -> Mask:
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
