"""The polytope Q = {sum_i m_i dr_i : dp in A}, found by asking LP (9) for one facet after another.

A hull of points of Q grows. Its facet with outward normal n is asked: the greatest q.n in Q,
that is -z(n), is at a new point, or the facet is one of Q. So a new point or a facet comes of
each program; a few of the points may lie between vertices, where a facet of the hull happens
to be parallel to an edge of Q. Q may be flat: its span comes first. In units of the mass of the
free parts.

References
----------
C. Lassez, J.-L. Lassez, Quantifier elimination for conjunctions of linear constraints via a
convex hull algorithm, 1992.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.regions.growing_hull import GrowingHull
from kilter.analysis.turning.virtual_work import VirtualWork
from kilter.arrays import Array, Index
from kilter.mechanics.program import Program

__all__ = ["OUTSIDE", "Reachable"]


OUTSIDE = 2e-9
"""A point of Q counts as outside a facet from here on, over the mass."""


class Reachable:
    """Q as far as it is known.

    Attributes
    ----------
    work : VirtualWork
        The oracle; `work.programs` were solved.
    basis : ndarray, shape (dimension, 3)
        Of the span of Q, orthonormal.
    hull : GrowingHull or None
        In coordinates of `basis`; a facet that is `done` is one of Q. None where Q is {0}.
    """

    def __init__(self, program: Program) -> None:
        self.work = VirtualWork(program)
        self.basis = np.zeros((0, 3))
        self.hull: GrowingHull | None = None
        self._planes = np.zeros((0, 1))
        self._levels = np.zeros(0)
        points = self._first_points() if program.free.any() else np.zeros((0, 3))
        if len(points):
            self.basis = _span(points)
            self.hull = GrowingHull(points @ self.basis.T, OUTSIDE)
            self._planes = np.zeros((0, len(self.basis)))

    def ask(self, facet: int) -> bool:
        """Confirm a facet of the hull, or add a point beyond it; True where confirmed."""
        assert self.hull is not None
        hull, normal, offset = self.hull, self.hull.normals[facet], float(self.hull.offsets[facet])
        corners = hull.points[hull.facets[facet]]
        known = np.abs(corners @ self._planes.T - self._levels).max(axis=0) <= 2 * OUTSIDE
        if not (known & (self._planes @ normal > 0)).any():
            answer = self.work.solve(normal @ self.basis)
            if -answer.z > offset + OUTSIDE and hull.add(self.basis @ answer.q):
                return False
            self._planes = np.vstack([self._planes, normal])
            self._levels = np.append(self._levels, offset)
        hull.done[facet] = True
        return True

    def _first_points(self) -> Array:
        """Points of Q that make a simplex in its span, shape (dimension + 1, 3), or none."""
        points: list[Array] = []
        rest = np.eye(3)[self.work.unit.axes]
        while len(rest):
            # a direction on no line of symmetry, across all that was found
            direction = np.cos(np.arange(1.0, len(rest) + 1) * 1.7) @ rest
            direction = direction / float(np.linalg.norm(direction))
            new = self._on_both_sides(direction, float(points[0] @ direction) if points else 0.0)
            if not new:
                break
            if points:
                points.append(new[0])
            else:
                points = new if len(new) == 2 else [np.zeros(3), *new]  # 0 is the other end
            rest = _across(np.array(points), self.work.unit.axes)
        return np.array(points).reshape(-1, 3)

    def _on_both_sides(self, direction: Array, level: float) -> list[Array]:
        """The farthest points of Q off the plane ``direction . q = level``, none of them on it."""
        found = []
        for sign in (1.0, -1.0):
            answer = self.work.solve(sign * direction)
            if -answer.z > sign * level + 1e2 * OUTSIDE:
                found.append(answer.q)
        return found


def _span(points: Array) -> Array:
    """Orthonormal basis of the differences of points that make a simplex, shape (k, 3)."""
    basis, _ = np.linalg.qr((points[1:] - points[0]).T)
    return np.ascontiguousarray(basis.T)


def _across(points: Array, axes: Index) -> Array:
    """Orthonormal basis of the directions among `axes` across the span of points, (k, 3)."""
    span = _span(points)[:, axes]
    _, _, rows = np.linalg.svd(span)
    return rows[len(span) :] @ np.eye(3)[axes]
