"""Decide which points of a surface are on a face, from the triangles of the face.

A point x of a surface with normal n is on the face if the line x + t n meets one of its triangles.
With this rule, neighbouring triangles leave no gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, unit_rows
from kilter.shape.shape_tolerances import GRAZING

__all__ = ["FaceCover", "covered"]


BATCH = 500_000
"""Number of pairs of point and triangle that are compared at once; more need more memory."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceCover:
    """Triangles of a face, prepared for repeated decisions about points of a surface.

    Attributes
    ----------
    corners : ndarray, shape (3, m, 3)
        First, second and third corners of the m triangles [length unit].
    upright : ndarray, shape (m, 3)
        Unit normals of the triangles.
    inward : ndarray, shape (3, m, 3)
        Unit directions in each triangle's plane, across each of its sides and into the triangle.
    low, high : ndarray, shape (m, 3)
        Lower and upper corners of the boxes of the triangles [length unit].
    """

    corners: Array
    upright: Array
    inward: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, triangles: Array) -> FaceCover:
        """Prepare triangles, given by their corners, shape (m, 3, 3)."""
        p, q, r = corners = triangles.transpose(1, 0, 2)
        upright = unit_rows(cross(q - p, r - p))
        inward = np.stack([unit_rows(cross(upright, side)) for side in (q - p, r - q, p - r)])
        low, high = np.minimum(np.minimum(p, q), r), np.maximum(np.maximum(p, q), r)
        return cls(corners, upright, inward, low, high)

    def covers(self, points: Array, normals: Array, reach: float, grow: float) -> Mask:
        """Mask of points that lie on the face, shape (n,); the parameters are as in `covered`."""
        inside = np.zeros(len(points), dtype=bool)
        if not len(self.upright) or not len(points):
            return inside
        near = self._boxes_near(points, reach + grow)
        corners, upright, inward = self.corners[:, near], self.upright[near], self.inward[:, near]
        step = max(1, BATCH // max(len(upright), 1))
        for begin in range(0, len(points), step):
            rows = slice(begin, begin + step)
            x, n = points[rows, None], normals[rows, None]
            along = np.einsum("ntk,tk->nt", n, upright)
            flat = np.abs(along) < GRAZING
            t = np.einsum("ntk,tk->nt", corners[0] - x, upright) / np.where(flat, 1.0, along)
            foot = x + t[..., None] * n
            hit = ~flat & (np.abs(t) <= reach + grow)
            for start, side in zip(corners, inward, strict=True):
                hit &= np.einsum("ntk,tk->nt", foot - start, side) >= -grow
            inside[rows] = hit.any(axis=1)
        return inside

    def _boxes_near(self, points: Array, margin: float) -> Index:
        """Triangles whose box comes within `margin` of the box of all points."""
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        meets = (self.low <= high).all(axis=1) & (self.high >= low).all(axis=1)
        return np.flatnonzero(meets)


def covered(triangles: Array, points: Array, normals: Array, reach: float, grow: float) -> Mask:
    """Mask of points on a surface that lie on a face, given by its triangles, shape (n,).

    Parameters
    ----------
    triangles : ndarray, shape (m, 3, 3)
        Corners of the triangles.
    points : ndarray, shape (n, 3)
    normals : ndarray, shape (n, 3)
        Normals of the surface at the points.
    reach : float
        Largest distance of a triangle from the surface [length unit].
    grow : float
        Margin by which the triangles are enlarged [length unit].
    """
    if not len(triangles) or not len(points):
        return np.zeros(len(points), dtype=bool)
    return FaceCover.of(triangles).covers(points, normals, reach, grow)
