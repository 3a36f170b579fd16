"""Which points of a surface the triangles of a face cover.

A point x of a surface with normal n belongs to the face where the line x + t n meets one of
its triangles. Neighbouring triangles meet without gaps that way.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask, cross, unit_rows
from kilter.shape.shape_tolerances import GRAZING

__all__ = ["covered"]


BATCH = 500_000
"""Points times triangles compared in one go."""


def covered(triangles: Array, points: Array, normals: Array, reach: float, grow: float) -> Mask:
    """Points of a surface, shape (n, 3), that its triangles, shape (m, 3, 3), cover.

    Parameters
    ----------
    normals : ndarray, shape (n, 3)
        Of the surface at the points.
    reach : float
        Greatest distance of a triangle from the surface [length unit].
    grow : float
        Triangles are grown by this [length unit].
    """
    inside = np.zeros(len(points), dtype=bool)
    if not len(triangles) or not len(points):
        return inside
    near = _near(triangles, points, reach + grow)
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


def _near(triangles: Array, points: Array, margin: float) -> Mask:
    """Triangles whose box comes within a margin of the box of the points."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    meets: Mask = (triangles.min(axis=1) <= high).all(axis=1)
    meets &= (triangles.max(axis=1) >= low).all(axis=1)
    return meets
