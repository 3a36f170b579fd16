"""Decide which points of a surface are on a face, from the triangles of the face.

A point x of a surface with normal n is on the face if the line x + t n meets one of its triangles.
With this rule, neighbouring triangles leave no gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, lengths, ratio, unit_rows
from kilter.shape.shape_tolerances import GRAZING

BATCH = 500_000
"""Number of pairs of point and triangle that are compared at once; more need more memory."""
DENSE = 0.05
"""Share of these pairs above which all are compared by products of matrices [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceCover:
    """Triangles of a face, prepared for repeated decisions about points of a surface."""

    corners: Array
    """First, second and third corners of the m triangles [length unit], shape (3, m, 3)."""
    upright: Array
    """Unit normals of the triangles, shape (m, 3)."""
    inward: Array
    """Unit directions in each triangle's plane, across each of its sides and into the triangle,
    shape (3, m, 3)."""
    low: Array
    high: Array
    """Lower and upper corners of the boxes of the triangles [length unit], shape (m, 3)."""
    pointed: Array
    """Distance by which the tips of a triangle move outwards per distance of its sides [-],
    shape (m,)."""

    @classmethod
    def of(cls, triangles: Array) -> FaceCover:
        """Prepare triangles, given by their corners, shape (m, 3, 3)."""
        p, q, r = corners = triangles.transpose(1, 0, 2)
        sides = q - p, r - q, p - r
        double = cross(q - p, r - p)
        upright = unit_rows(double)
        inward = np.stack([unit_rows(cross(upright, side)) for side in sides])
        low, high = np.minimum(np.minimum(p, q), r), np.maximum(np.maximum(p, q), r)
        # sides that move outwards by s scale a triangle about its incentre by 1 + s / inradius
        size = [lengths(side) for side in sides]
        longest, around = np.maximum.reduce(size), sum(size)
        pointed = ratio(longest * around, lengths(double))
        return cls(corners, upright, inward, low, high, pointed)

    def covers(self, points: Array, normals: Array, reach: float, grow: float) -> Mask:
        """Mask of points that lie on the face, shape (n,); the parameters are as in `covered`."""
        inside = np.zeros(len(points), dtype=bool)
        if not len(self.upright) or not len(points):
            return inside
        near = self._boxes_near(points, reach + grow)
        step = max(1, BATCH // max(len(near), 1))
        for begin in range(0, len(points), step):
            x, n = points[begin : begin + step], normals[begin : begin + step]
            meets = self._boxes_meet(x, near, reach, grow)
            if np.count_nonzero(meets) > DENSE * meets.size:
                hits = self._hits_of_all(x, n, near, reach, grow)
                inside[begin : begin + step] = hits.any(axis=1)
                continue
            point, number = np.nonzero(meets)
            hit = self._hits(near[number], x[point], n[point], reach, grow)
            inside[begin + point[hit]] = True
        return inside

    def _hits(self, row: Index, x: Array, n: Array, reach: float, grow: float) -> Mask:
        """Mask of pairs of triangle `row` and line x + t n that meet, shape (k,)."""
        upright = self.upright[row]
        along = np.einsum("ij,ij->i", n, upright)
        flat = np.abs(along) < GRAZING
        rise = np.einsum("ij,ij->i", self.corners[0, row] - x, upright)
        t = rise / np.where(flat, 1.0, along)
        foot = x + t[:, None] * n
        hit: Mask = ~flat & (np.abs(t) <= reach + grow)
        for start, side in zip(self.corners, self.inward, strict=True):
            hit &= np.einsum("ij,ij->i", foot - start[row], side[row]) >= -grow
        return hit

    def _boxes_near(self, points: Array, margin: float) -> Index:
        """Triangles whose box comes within `margin` of the box of all points."""
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        meets = np.ones(len(self.low), dtype=bool)
        for axis in range(3):
            meets &= (self.low[:, axis] <= high[axis]) & (self.high[:, axis] >= low[axis])
        return np.flatnonzero(meets)

    def _boxes_meet(self, points: Array, near: Index, reach: float, grow: float) -> Mask:
        """Mask of pairs of a point and a triangle of `near` that its line may meet, by boxes."""
        margin = reach + grow + grow * self.pointed[near]
        meets = np.ones((len(points), len(near)), dtype=bool)
        for axis in range(3):
            x = points[:, axis, None]
            meets &= self.low[near, axis] - margin <= x
            meets &= self.high[near, axis] + margin >= x
        return meets

    def _hits_of_all(
        self, points: Array, normals: Array, near: Index, reach: float, grow: float
    ) -> Mask:
        """Mask of pairs of a line and a triangle of `near` that meet, by products of matrices."""
        upright, origin = self.upright[near], self.corners[0, near].mean(axis=0)
        x, corners = points - origin, self.corners[:, near] - origin
        along = normals @ upright.T
        hit: Mask = np.abs(along) >= GRAZING
        rise = np.einsum("ij,ij->i", corners[0], upright) - x @ upright.T
        t = rise / np.where(hit, along, 1.0)
        hit &= np.abs(t) <= reach + grow
        for start, side in zip(corners, self.inward[:, near], strict=True):
            from_side = x @ side.T + t * (normals @ side.T) - np.einsum("ij,ij->i", start, side)
            hit &= from_side >= -grow
        return hit


def covered(triangles: Array, points: Array, normals: Array, reach: float, grow: float) -> Mask:
    """Mask of points on a surface that lie on a face, given by its triangles, shape (n,).

    Arguments: `triangles` (m, 3, 3): corners of the triangles; `points` (n, 3); `normals` (n, 3):
    normals of the surface at the points; `reach`: largest distance of a triangle from the surface
    [length unit]; `grow`: margin by which the triangles are enlarged [length unit].
    """
    if not len(triangles) or not len(points):
        return np.zeros(len(points), dtype=bool)
    return FaceCover.of(triangles).covers(points, normals, reach, grow)
