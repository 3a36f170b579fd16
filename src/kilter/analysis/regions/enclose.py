"""Enclose a convex set around 0 between a hull and planes, by queries to a support oracle.

The oracle returns a point of the set and a plane around the set for each direction.

The oracle gets a unit direction and returns a point of the set and a plane beyond which no point
of the set lies,  normal . x <= reach. The hull of the points is in the set, the planes are around
it. The next direction is the normal of a facet of the hull. Either the answer
is a point beyond that facet, and the hull grows; or there is none, and then the facet lies on
the boundary of the set and is settled. So every query brings a point or settles a facet.

    nearest boundary      the facet nearest to 0 is refined until hull and planes agree: the least
                          push, the least tilt, the least tilt over intervals, and the direction
                          on the sphere that is nearest to stable
    the whole boundary    all facets are refined: the stability map

Three other modules find a convex set, or walk a sphere, with these parts and another loop:

- `growth.grow` finds a cone, whose facets all pass through 0: it has no nearest facet, its span
  may be thinner than space, and with rounded data its points lie on a facet up to a width, so
  its facets are fitted (`cone_hull.facets_of`).
- `friction_cone` cuts the outer cone at its extreme rays: its oracle projects, which brings a
  point and a plane that a support in a facet's direction would not bring as near, and its gap
  is an angle over the whole sphere.
- `least_instability` bounds a function that is not convex on the triangles of a sphere: only
  the hull is the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import HULL_FINER, HULL_ROUNDING
from kilter.arrays import Array, Index, Mask

# Convex hulls to which points are added one by one, in up to three dimensions.


class GrowingHull:
    """Convex hull of points in R^d, d = 1, 2 or 3, to which further points can be added.

    Arguments: `corners` (d + 1, d): a first simplex, not flat.

    - `points` (n, d): in the order in which they came.
    - `facets` (f, d): points of each simplex.
    - `normals` (f, d): outward, unit.
    - `offsets` (f,): ``normals @ point <= offsets``.
    - `done` (f,): a mark for the user; False on new facets.

    Examples
    --------
    >>> hull = GrowingHull(np.array([[0.0, 0], [1, 0], [0, 1]]), 1e-9)
    >>> hull.add(np.array([1.0, 1.0])), len(hull.facets)
    (True, 4)
    >>> hull.add(np.array([0.5, 0.5]))
    False
    """

    def __init__(self, corners: Array, tolerance: float) -> None:
        size = corners.shape[1]
        self.points = corners.astype(np.float64)
        self.tolerance = tolerance
        self._inside = self.points.mean(axis=0)
        every = np.arange(size + 1)
        self.facets: Index = np.array([np.delete(every, k) for k in every])
        self.normals, self.offsets = self._planes(self.facets)
        self.done: Mask = np.zeros(size + 1, dtype=bool)

    @classmethod
    def of(cls, points: Array, tolerance: float) -> GrowingHull | None:
        """Hull of points, shape (n, d); None if the points are flat up to the tolerance.

        Examples
        --------
        >>> GrowingHull.of(np.array([[0.0, 0], [1, 1], [2, 2]]), 1e-9) is None
        True
        >>> hull = GrowingHull.of(np.array([[0.0, 0], [1, 1], [1, 0], [0, 1]]), 1e-9)
        >>> len(hull.facets)
        4
        """
        if not len(points):
            return None
        chosen = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
        rest = points - points[chosen[0]]
        for _ in range(points.shape[1]):
            # the point farthest from the span of those before
            length = np.linalg.norm(rest, axis=1)
            farthest = int(length.argmax())
            if length[farthest] <= tolerance:
                return None
            chosen.append(farthest)
            along = rest[farthest] / length[farthest]
            rest = rest - np.outer(rest @ along, along)
        hull = cls(points[chosen], tolerance)
        for point in points:
            hull.add(point)
        return hull

    def add(self, point: Array) -> bool:
        """Add a point to the hull; return False, without a change, if it is not outside."""
        seen = self.normals @ point > self.offsets + self.tolerance
        if not seen.any():
            return False
        self.points = np.vstack([self.points, point])
        ridges = self._horizon(self.facets[seen])
        new = np.hstack([ridges, np.full((len(ridges), 1), len(self.points) - 1)])
        normals, offsets = self._planes(new)
        self.facets = np.vstack([self.facets[~seen], new])
        self.normals = np.vstack([self.normals[~seen], normals])
        self.offsets = np.concatenate([self.offsets[~seen], offsets])
        self.done = np.concatenate([self.done[~seen], np.zeros(len(new), dtype=bool)])
        return True

    def _horizon(self, seen: Index) -> Index:
        """Ridges between the facets that a new point sees and the other facets."""
        size = seen.shape[1]
        ridges = np.vstack([np.sort(np.delete(seen, k, axis=1), axis=1) for k in range(size)])
        if size == 1:
            return ridges[:1]
        unique, counts = np.unique(ridges, axis=0, return_counts=True)
        single: Index = unique[counts == 1]
        return single

    def _planes(self, facets: Index) -> tuple[Array, Array]:
        """Outward unit normals and offsets of the planes through facets."""
        corners = self.points[facets]
        size = corners.shape[2]
        first = corners[:, 0]
        if size == 1:
            normals = np.ones((len(corners), 1))
        elif size == 2:
            edge = corners[:, 1] - first
            normals = np.column_stack([edge[:, 1], -edge[:, 0]])
        else:
            normals = np.cross(corners[:, 1] - first, corners[:, 2] - first)
        normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
        out = np.einsum("ij,ij->i", normals, first - self._inside)
        normals[out < 0] *= -1.0
        return normals, np.einsum("ij,ikj->ik", normals, corners).max(axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class SupportPoint:
    """Answer of an oracle: a point of the set, shape (d,), and a plane that bounds the set.

    `normal`, unit, shape (d,), and `reach`: normal . x <= reach for all of the set.
    """

    point: Array
    normal: Array
    reach: float


Oracle = Callable[[Array], SupportPoint | None]
"""Function from a unit direction, shape (d,), to a support point; None if its numbers failed."""


PROVED_AFTER = (12, 16, 24, 32, 48)
"""Numbers of queries after which another proof of the inner distance is tried."""
PROVED_NEAR = 1e-6
"""The search ends if that inner distance is shorter by at most this fraction [-]."""


class KnownSet:
    """Known part of a convex set: its hull of known points, and planes that bound the set.

    - `hull`: hull of the points; a facet that is `done` is a facet of the set. None: flat so far.
    - `outer`, `normal` (d,): distance from 0 of the nearest plane around it, and the unit normal
      of that plane.
    - `answer`: which answer of the oracle brought that plane; -1: none yet.
    - `asked`: questions so far.
    - `failed`: whether the oracle failed in a direction.
    - `proved`: radius of a ball about 0 that is inside the set by another proof.
    """

    def __init__(self, oracle: Oracle, hull: GrowingHull | None = None) -> None:
        self.hull = hull
        self.outer, self.normal, self.answer = np.inf, np.zeros(0), -1
        self.asked = 0
        self.failed = False
        self.proved = 0.0
        self._oracle = oracle
        size = 0 if hull is None else hull.points.shape[1]
        self._planes, self._levels = np.zeros((0, size)), np.zeros(0)

    @property
    def inner(self) -> float:
        """Radius of the largest ball about 0 that is proved to be inside the set."""
        return self.proved if self.hull is None else max(self.hull.offsets.min(), self.proved)

    def ask(self, direction: Array) -> SupportPoint | None:
        """Query the oracle in a direction; add its plane; return its point, or None if it fails."""
        reach = self._oracle(direction)
        self.asked += 1
        if reach is None:
            self.failed = True
        elif reach.reach < self.outer:
            self.outer, self.normal, self.answer = reach.reach, reach.normal, self.asked - 1
        return reach

    def settle(self, facet: int) -> bool:
        """Confirm that a hull facet is on the boundary (True), or add a point beyond it (False)."""
        assert self.hull is not None
        hull = self.hull
        normal, offset = hull.normals[facet], float(hull.offsets[facet])
        if not self._is_known(facet):
            reach = self.ask(normal)
            if reach is not None and hull.add(reach.point):
                return False
            self._planes = np.vstack([self._planes.reshape(-1, len(normal)), normal])
            self._levels = np.append(self._levels, offset)
        hull.done[facet] = True
        return True

    def close_nearest(
        self,
        limit: int,
        agree: float = 0.0,
        most: float = np.inf,
        within: float = 0.0,
        inside: Callable[[float], float] | None = None,
        enough: float = np.inf,
    ) -> bool:
        """Refine the hull facet nearest to 0 until it is confirmed; False at the query limit.

        The search also ends if all points nearer than `enough` are known to be inside.
        """
        while self.asked < limit and self.inner < enough:
            if inside is not None and self.asked in PROVED_AFTER:
                self.proved = max(self.proved, min(inside(self.outer), self.outer))
                if self.proved >= self.outer * (1 - PROVED_NEAR):
                    return True
            if self.hull is None or (self.outer >= most * (1 - agree) and most < np.inf):
                return True
            agreed = agree > 0.0 and self.inner >= self.outer * (1 - agree) - within
            if agreed or self.settle(int(self.hull.offsets.argmin())):
                return True
        return False

    def _is_known(self, facet: int) -> bool:
        """Whether a facet lies in the plane of a facet that is already confirmed."""
        assert self.hull is not None
        hull, planes = self.hull, self._planes
        if not len(planes):
            return False
        corners = hull.points[hull.facets[facet]]
        off = np.abs(corners @ planes.T - self._levels).max(axis=0)
        return bool(((off <= 2 * hull.tolerance) & (planes @ hull.normals[facet] > 0)).any())


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """Bounds of the distance from 0 to the boundary of a convex set, and the nearest point."""

    inner: float
    """Every point nearer than this is in the set."""
    outer: float
    """Distance of the nearest plane outside."""
    normal: Array
    """Normal of the nearest plane outside, unit, shape (d,)."""
    answer: int
    """Which answer of the oracle brought it, from 0."""
    asked: int
    """How many questions there were."""
    failed: bool
    """Whether the oracle failed in a direction: then the distances may be farther apart."""


def nearest_face(
    oracle: Oracle,
    directions: Array,
    *,
    agree: float,
    limit: int,
    most: float = np.inf,
    within: float = 0.0,
    inside: Callable[[float], float] | None = None,
    enough: float = np.inf,
) -> Face | None:
    """Find the boundary point of a set that is nearest to 0; None if the first query fails.

    Arguments: `directions` (n, d): unit, asked first; on all sides of 0; `agree`: the search ends
    if inner and outer distance differ by at most this fraction, or if both exceed `enough`.

    Examples
    --------
    >>> corner = np.array([1.0, 2.0])  # of a box around 0
    >>> def box(direction):
    ...     scale = np.abs(direction) / corner
    ...     side = int(scale.argmax())
    ...     normal = np.eye(2)[side] * np.sign(direction[side])
    ...     return SupportPoint(direction / scale[side], normal, corner[side])
    >>> face = nearest_face(box, np.array([[0.6, 0.8], [-0.8, 0.6], [0, -1.0]]), agree=1e-9,
    ...                     limit=50)
    >>> round(face.inner, 9), float(face.outer)
    (1.0, 1.0)
    """
    known = KnownSet(oracle)
    points = []
    for direction in directions:
        reach = known.ask(direction)
        if reach is not None:
            points.append(reach.point)
        elif not points:
            return None
    size = float(np.abs(np.array(points)).max(initial=0.0))
    tolerance = max(HULL_FINER * agree * min(known.outer, size), HULL_ROUNDING * size)
    known.hull = GrowingHull.of(np.array(points), tolerance)
    known.close_nearest(limit, agree, most, within, inside, enough)
    inner = float(min(known.inner, known.outer))
    return Face(inner, known.outer, known.normal, known.answer, known.asked, known.failed)
