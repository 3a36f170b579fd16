"""The polytope Q of weighted displacements that the contacts allow, found facet by facet.

Q = {sum_i m_i dr_i : dp in A}, in R^3, found by solving LP (9) for successive directions.

An oracle of `kilter.analysis.regions.enclose`: the facet of the hull with outward normal n is
program returns the greatest q.n in Q, that is -z(n); a few of the points may lie between vertices,
if a facet of the hull happens to be parallel to an edge of Q. Q may be flat: its span comes
first. In units of the mass of the free parts.

References
----------
C. Lassez, J.-L. Lassez, Quantifier elimination for conjunctions of linear constraints via a
convex hull algorithm, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import (
    OUTSIDE_HULL,
)
from kilter.analysis.regions.enclose import GrowingHull, KnownSet, SupportPoint
from kilter.analysis.turning.virtual_work import VirtualWork
from kilter.arrays import Array, Index
from kilter.errors import SolverError
from kilter.mechanics.program import Program

PROGRAMS = 20_000
"""Largest number of programs for the stability map or the nearest direction."""


class Reachable:
    """Known part of the polytope Q of weighted displacements that the contacts allow.

    See the module docstring.

    - `work`: the oracle; `work.programs` were solved.
    - `basis` (dimension, 3): basis of the span of Q, orthonormal.
    - `known`: in coordinates of `basis`; a facet of its hull that is `done` is a facet of Q. None
      if Q is {0}.
    """

    def __init__(self, program: Program) -> None:
        self.work = VirtualWork(program)
        self.basis = np.zeros((0, 3))
        self.known: KnownSet | None = None
        points = self._first_points() if program.free.any() else np.zeros((0, 3))
        if len(points):
            self.basis = _span(points)
            self.known = KnownSet(self._support, GrowingHull(points @ self.basis.T, OUTSIDE_HULL))

    def _support(self, direction: Array) -> SupportPoint:
        """The farthest point of the polytope Q in a direction, and its supporting plane."""
        answer = self.work.solve(direction @ self.basis)
        return SupportPoint(self.basis @ answer.q, direction, -answer.z)

    def _first_points(self) -> Array:
        """Points of the polytope Q that form a simplex in its span, shape (dimension + 1, 3).

        Empty if Q is a single point.
        """
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
            rest = _basis_across(np.array(points), self.work.unit.axes)
        return np.array(points).reshape(-1, 3)

    def _on_both_sides(self, direction: Array, level: float) -> list[Array]:
        """Farthest points of Q on each side of the plane ``direction . q = level``, if any.

        None on the plane itself.
        """
        sides = []
        for sign in (1.0, -1.0):
            answer = self.work.solve(sign * direction)
            if -answer.z > sign * level + 1e2 * OUTSIDE_HULL:
                sides.append(answer.q)
        return sides


def _span(points: Array) -> Array:
    """Orthonormal basis of the span of a simplex, from its corners, shape (k, 3)."""
    basis, _ = np.linalg.qr((points[1:] - points[0]).T)
    return np.ascontiguousarray(basis.T)


def _basis_across(points: Array, axes: Index) -> Array:
    """Orthonormal basis of the directions along `axes` perpendicular to a simplex, shape (k, 3)."""
    span = _span(points)[:, axes]
    _, _, rows = np.linalg.svd(span)
    return rows[len(span) :] @ np.eye(3)[axes]


@dataclass(frozen=True, slots=True, eq=False)
class SphereDirection:
    """The most nearly stable unit direction of gravity, with its optimum z [kg x length unit].

    z is the optimum of the displacement program; `programs` is the number of LPs solved.
    """

    direction: Array
    z: float
    programs: int


def nearest_on_sphere(program: Program) -> SphereDirection | None:
    """Find the most nearly stable unit direction of gravity; None if some direction is stable.

    z is the optimum of the displacement program: 0 if stable, negative if unstable.

    max over |g|_2 = 1 of z(g) is the distance of 0 from the boundary of Q, negative, reached
    at the outward normal of the facet nearest to 0: only that facet is refined each time.

    Raises `InputError` if loads are given. Raises `SolverError` if more than `PROGRAMS` programs
    are needed.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("wall-on-short-base")
    >>> best = nearest_on_sphere(build_program(assembly, contacts(assembly)))
    >>> np.round(best.direction, 9) + 0.0, round(best.z, 6)
    (array([ 0.,  0., -1.]), -6.684)
    """
    reachable = Reachable(program)
    work, known = reachable.work, reachable.known
    if known is None or len(reachable.basis) < len(work.unit.axes):
        return None
    if not known.close_nearest(PROGRAMS):
        raise SolverError(f"the nearest direction needs more than {PROGRAMS} programs")
    assert known.hull is not None
    nearest = int(known.hull.offsets.argmin())
    offset = float(known.hull.offsets[nearest])
    if offset <= OUTSIDE_HULL:
        return None
    direction = known.hull.normals[nearest] @ reachable.basis
    return SphereDirection(direction, -offset * work.unit.mass, work.programs)
