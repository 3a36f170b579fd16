"""Convex hulls to which points are added one by one, in up to three dimensions.

A facet is a simplex: as many points as there are dimensions. A new point sees the facets
it lies outside of; the ridges between seen and unseen facets are joined to it.
Points in the plane of a facet, up to the tolerance, do not see it: a facet with many
corners is several simplices in a common plane.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask

__all__ = ["GrowingHull"]


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
