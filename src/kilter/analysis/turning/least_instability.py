"""The direction of gravity in which parts start to move least (least kappa), with a bound.

kappa is the size of the impending motion, from 0 (stable) to 1 (free fall).

    kappa(g) = |a(g)|_M / (|g| sqrt(sum m_i)),   a(g) = projection of M^-1 W g on {J a >= 0}

is not convex on the sphere, but two things about it are. With m = sum m_i,

    phi(g) = |a(g)|_M     is the support function of {sum_i m_i a_i : J a >= 0, |a|_M <= 1}:
                          convex, phi(t g) = t phi(g), phi(g) >= b.g with b = sum_i m_i a_i / |a|_M
                          at any other direction, and
    psi(g) = |M^-1 W g - a(g)|_M    is convex and homogeneous too; phi^2 + psi^2 = m |g|^2.

The sphere is cut into triangles (arcs if planar) with kappa known at the corners g_j:

    kappa(g) >= max_j b_j.g / sqrt(m)                   good for small kappa
    kappa(g)^2 >= 1 - max (p.g)^2 / m,  p.g_j = psi_j   good for large kappa

Both extremes over a triangle have closed forms: b.g, along an arc on which it is positive,
is least at an end. The triangle with the least bound gets a new corner at the place of the bound,
and the triangulation is the hull of all corners. No direction has a kappa below
the least bound of all triangles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from kilter.analysis.analysis_tolerances import (
    HULL_ROUNDING,
    KAPPA_GAP,
    KAPPA_RESIDUAL,
)
from kilter.analysis.regions.enclose import GrowingHull
from kilter.analysis.turning.virtual_work import unit_program
from kilter.arrays import Array, Index
from kilter.mechanics.forms import ScaledProblem, impending_motion, scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers import clarabel
from kilter.solvers.problem import ConicProgram

LIMIT = 500
"""Largest number of quadratic programs of the search."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastInstability:
    """The direction of gravity with the least instability kappa, and a lower bound of kappa."""

    direction: Array
    """Unit, shape (3,)."""
    value: float
    """kappa there [-]."""
    bound: float
    """No direction has less [-]."""
    programs: int
    """Quadratic programs solved."""


def least_instability(
    program: Program, *, gap: float = KAPPA_GAP, limit: int = LIMIT
) -> LeastInstability:
    """Minimise the instability kappa over all directions of gravity, by branch and bound.

    Arguments: `gap`: the search stops if value and bound differ by at most this [-]. Raises
    `InputError` if loads are given.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("hanging-brick")
    >>> best = least_instability(build_program(assembly, contacts(assembly)))
    >>> np.round(best.direction, 6) + 0.0, round(best.value, 6), best.value - best.bound <= 1e-3
    (array([ 0.,  0., -1.]), 0.179605, True)
    """
    axes = unit_program(program).axes
    if not program.free.any():
        return LeastInstability(program.down, 0.0, 0.0, 0)
    known = _Known(program, axes)
    hull = GrowingHull(known.first(), HULL_ROUNDING)
    bounds = known.bounds(hull)
    while True:
        worst = min(bounds, key=lambda facet: bounds[facet][0])
        bound, where = bounds[worst]
        value = min(known.kappa)
        if value - bound <= gap or len(known.kappa) >= limit or not hull.add(where):
            break
        known.ask(where)
        bounds = known.bounds(hull, bounds)
    best = int(np.argmin(known.kappa))
    direction = np.zeros(3)
    direction[axes] = hull.points[best]
    return LeastInstability(direction, value, max(0.0, min(bound, value)), len(known.kappa))


class _Known:
    """Directions of gravity with computed kappa, and the data that bound kappa between them."""

    def __init__(self, program: Program, axes: Index) -> None:
        self._problem: ScaledProblem = scaled_problem(program)
        self._axes = axes
        self.kappa: list[float] = []
        self.slope: list[Array] = []
        self.rest: list[float] = []

    def first(self) -> Array:
        """Compute kappa at the corners of a regular simplex, (d + 1, d); return the corners."""
        down = self._problem.program.gravity[self._axes]
        size = len(down)
        # a regular simplex, turned so that its first corner is down
        simplex = np.eye(size + 1) - 1.0 / (size + 1)
        _, _, rows = np.linalg.svd(simplex)
        corners = simplex @ rows[:size].T
        corners = corners / np.linalg.norm(corners, axis=1, keepdims=True)
        ends = [np.linalg.qr(np.column_stack([v, np.eye(size)]))[0] for v in (corners[0], down)]
        for end, v in zip(ends, (corners[0], down), strict=True):
            end[:, 0] *= np.sign(end[:, 0] @ v)
        corners = corners @ ends[0] @ ends[1].T
        for corner in corners:
            self.ask(corner)
        result: Array = corners
        return result

    def ask(self, direction: Array) -> None:
        """Compute and store kappa for gravity along a unit direction, shape (d,)."""
        program = self._problem.program
        gravity = np.zeros(3)
        gravity[self._axes] = direction
        free, per = int(program.free.sum()), len(program.freedoms)
        right = np.zeros((free, 6))
        right[:, :3] = -(self._problem.frame @ gravity)
        problem = replace(self._problem, right=right[:, program.freedoms].reshape(-1))
        quadratic = impending_motion(problem)
        x = _minimum(quadratic)
        share = program.mass[program.free] / program.mass[program.free].max()
        moved = np.zeros((free, 6))
        moved[:, program.freedoms] = x.reshape(free, per)
        # |a|_M^2 / m, and sum_i m_i a_i / m, with masses over the largest
        energy = float(x @ (quadratic.quadratic @ x)) / float(share.sum())
        pull = (share @ moved[:, :3]) @ self._problem.frame / float(share.sum())
        kappa = float(np.sqrt(max(energy, 0.0)))
        self.kappa.append(kappa)
        self.slope.append(pull[self._axes] / kappa if kappa > 0 else 0.0 * direction)
        self.rest.append(float(np.sqrt(max(1.0 - energy, 0.0))))

    def bounds(
        self,
        hull: GrowingHull,
        old: dict[tuple[int, ...], tuple[float, Array]] | None = None,
    ) -> dict[tuple[int, ...], tuple[float, Array]]:
        """Lower bound of kappa in each triangle of directions, and where it is attained."""
        old = old or {}
        result = {}
        for facet in map(tuple, hull.facets.tolist()):
            if facet not in old:
                corners = hull.points[list(facet)]
                slopes = np.array([self.slope[k] for k in facet])
                rest = np.array([self.rest[k] for k in facet])
                old[facet] = max(
                    _from_below(corners, slopes), _from_above(corners, rest), key=lambda b: b[0]
                )
            result[facet] = old[facet]
        return result


def _minimum(quadratic: ConicProgram) -> Array:
    """Minimum of a quadratic program, with a looser tolerance if the solver fails on rounding."""
    answer = clarabel.solve_quadratic(quadratic, tolerance=1e-10, polish=False)
    if answer.residual > KAPPA_RESIDUAL:
        again = clarabel.solve_quadratic(quadratic)
        answer = min([answer, again], key=lambda solution: solution.residual)
    return answer.x if answer.found else answer.required("the least instability").x


def _from_below(corners: Array, slopes: Array) -> tuple[float, Array]:
    """Lower bound of kappa in a triangle from its slopes at the corners, with the direction there.

    It is the least of max_j slopes_j . g over unit g in the cone of the corners, at least 0.
    """
    size = len(corners)
    candidates = [*corners]
    for i, j in combinations(range(size), 2):
        across = slopes[i] - slopes[j]
        for edge in combinations(range(size), 2):
            s, t = across @ corners[edge[0]], across @ corners[edge[1]]
            if s * t < 0:
                candidates.append(t * corners[edge[0]] - s * corners[edge[1]])
    if size == 3:
        equal = np.asarray(np.cross(slopes[1] - slopes[0], slopes[2] - slopes[0]), dtype=np.float64)
        shares = _shares(corners, equal)
        if (shares <= 0).all() or (shares >= 0).all():
            candidates.append(equal)
    middle = corners.sum(axis=0)
    candidates = [c if c @ middle > 0 else -c for c in candidates if np.linalg.norm(c) > 1e-12]
    units = np.array(candidates) / np.linalg.norm(candidates, axis=1)[:, None]
    heights = (units @ slopes.T).max(axis=1)
    if (heights <= 0).any():
        return 0.0, middle / np.linalg.norm(middle)
    return float(heights.min()), units[heights.argmin()]


def _from_above(corners: Array, rest: Array) -> tuple[float, Array]:
    """Lower bound of kappa in a triangle from the motions at its corners, with the direction.

    It is the least sqrt(1 - (p.g)^2) over unit g in the cone, with p.g_j = rest_j.
    """
    size = len(corners)
    subsets = [list(s) for k in range(1, size + 1) for s in combinations(range(size), k)]
    best, where = -1.0, corners[0]
    for subset in subsets:
        # p in the span of some corners: its length is the greatest p.g if p lies between them
        p = _shares(corners[subset].T, rest[subset])
        length = float(np.linalg.norm(p))
        inside = len(subset) == 1 or (_shares(corners[subset], p) >= -1e-12).all()
        if inside and length > best:
            best, where = length, p / length if length > 0 else corners[0]
    return float(np.sqrt(max(0.0, 1.0 - best**2))), where


def _shares(corners: Array, point: Array) -> Array:
    """Coefficients of a point as a combination of the corners, by least squares."""
    shares: Array = np.asarray(np.linalg.lstsq(corners.T, point, rcond=None)[0], dtype=np.float64)
    return shares
