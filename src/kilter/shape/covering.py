"""Decide which points of a surface are on a face, from the triangles of the face.

A point x of a surface with normal n is on the face if the line x + t n meets one of its triangles.
With this rule, neighbouring triangles leave no gaps.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask, cross, unit_rows
from kilter.shape.shape_tolerances import GRAZING

__all__ = ["covered"]


BATCH = 500_000
"""Number of pairs of point and triangle that are compared at once; more need more memory."""


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
    inside = np.zeros(len(points), dtype=bool)
    if not len(triangles) or not len(points):
        return inside
    near = _boxes_near(triangles, points, reach + grow)
    p, q, r = triangles[near].transpose(1, 0, 2)
    upright = unit_rows(cross(q - p, r - p))
    step = max(1, BATCH // max(len(p), 1))
    for begin in range(0, len(points), step):
        rows = slice(begin, begin + step)
        x, n = points[rows, None], normals[rows, None]
        along = np.einsum("ntk,tk->nt", n, upright)
        flat = np.abs(along) < GRAZING
        t = np.einsum("ntk,tk->nt", p - x, upright) / np.where(flat, 1.0, along)
        foot = x + t[..., None] * n
        hit = ~flat & (np.abs(t) <= reach + grow)
        for start, end in ((p, q), (q, r), (r, p)):
            side = unit_rows(cross(upright, end - start))
            hit &= np.einsum("ntk,tk->nt", foot - start, side) >= -grow
        inside[rows] = hit.any(axis=1)
    return inside


def _boxes_near(triangles: Array, points: Array, margin: float) -> Mask:
    """Mask of triangles whose box comes within `margin` of the box of all points, shape (m,)."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    meets: Mask = (triangles.min(axis=1) <= high).all(axis=1)
    meets &= (triangles.max(axis=1) >= low).all(axis=1)
    return meets
