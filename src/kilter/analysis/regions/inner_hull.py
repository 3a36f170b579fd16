"""The pointed cone that known rays span in space: its extreme rays, and distances to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.turning_tolerances import NARROW, POINTED
from kilter.arrays import Array, Index, across, cross, unit_rows

__all__ = ["InnerHull", "inner_hull"]


@dataclass(frozen=True, slots=True, eq=False)
class InnerHull:
    """A pointed cone in space by its extreme rays, in order around it."""

    rays: Array
    """Unit, shape (h, 3)."""
    number: Index
    """Index of each among the given rays, shape (h,)."""
    normals: Array
    """Unit inward normals of the planes through each ray and the next, shape (h, 3)."""

    def distances(self, directions: Array) -> Array:
        """Angle from each unit direction, shape (D, 3), to the cone [rad], shape (D,).

        Examples
        --------
        >>> hull = inner_hull(np.eye(3), np.ones(3) / np.sqrt(3))
        >>> np.degrees(hull.distances(np.array([[1, 1, 1], [0, 1, -1], [-1, 0, 1]]) / 2**0.5))
        array([ 0., 45., 45.])
        """
        if not len(directions):
            return np.zeros(0)
        following = np.roll(self.rays, -1, axis=0)
        inside = directions @ self.normals.T
        chords = np.linalg.norm(directions[:, None] - self.rays, axis=2)
        angle = 2 * np.arcsin(np.minimum(chords / 2, 1.0)).min(axis=1)
        beside = (
            (inside < 0)
            & (directions @ cross(self.normals, self.rays).T >= 0)
            & (directions @ cross(self.normals, following).T <= 0)
            & (directions @ (self.rays + following).T > 0)
        )
        arcs = np.where(beside, np.arcsin(np.clip(-inside, 0.0, 1.0)), np.inf).min(axis=1)
        nearest: Array = np.where((inside >= 0).all(axis=1), 0.0, np.minimum(angle, arcs))
        return nearest


def inner_hull(rays: Array, axis: Array) -> InnerHull | None:
    """The cone that rays span; None if it is no pointed cone with width about an axis.

    Arguments: `rays` (r, 3): unit; `axis` (3,): unit; all rays of a pointed cone may lie on its
    side.
    """
    from scipy.spatial import ConvexHull, QhullError

    if len(rays) < 3 or float((rays @ axis).min()) < POINTED:
        return None
    u, v = across(axis)
    flat = np.column_stack([rays @ u, rays @ v]) / (rays @ axis)[:, None]
    try:
        number = ConvexHull(flat).vertices.astype(np.int64)
    except QhullError:
        return None
    chosen = rays[number]
    normals = unit_rows(cross(chosen, np.roll(chosen, -1, axis=0)))
    middle = unit_rows(chosen.sum(axis=0))
    depth = normals @ middle
    normals = normals * np.sign(depth)[:, None]
    if float(np.abs(depth).min()) < NARROW:
        return None
    return InnerHull(chosen, number, normals)
