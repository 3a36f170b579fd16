"""One-sided derivatives of a limit whose forces or motion are not unique.

In the direction of rates of the data, a limit max { L : J^T f + w + L d = 0, f in K } has the slope

    max over optimal f of min over optimal q of  q.(dJ^T f + dw + L dd) + sum s mu' f_n

with q.d = -1 and sliding speeds s: the formula for a single motion and single forces
(`kilter.analysis.gradients.limit_power`). The optimal forces are f0 + N a, and the optimal motions
span few directions b, so the program has a row for each of these directions only. Its unknowns are
a, the slope l, forces h of sliding rows beyond their cones, and changes g at rows without force:

    max l:  b.(dJ^T f + dw + L dd) + l b.d + sum s_b h + v_b.g = 0   for each b
    f in K,    h >= -mu' f_n,    g in K

A least friction is a minimum: there the slope is the least l, where the friction mu' is l itself.

References
----------
E. G. Golshtein, Theory of Convex Programming, 1972: marginal values of a convex program.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.analysis_tolerances import SAME_FORCE
from kilter.analysis.gradients.limit_power import LimitPower, Rates, row_rates
from kilter.analysis.gradients.refined_limit import (
    ForceColumns,
    RefinedLimit,
    row_friction,
)
from kilter.arrays import TINY, Array, Index, cross
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import ConicProgram
from kilter.solvers.solver_tolerances import CONIC

SHARP = 1e-12
"""Gap of the program of a slope [-]; the error of the slope is a large multiple of it."""
SLOPE_SOLVED = 1e-9
"""Largest violation of optimality by the solution of such a program [-]; else no slope is known."""
SAME_SPAN = 1e-9
"""Directions of forces or motions with a smaller share count as rounding [-]."""
NO_CHANGE = 1e-12
"""Changes of forces and motion below this, relative to the largest, are rounding [-]."""


def slope_on_face(power: LimitPower, refined: RefinedLimit, rates: Rates) -> float:
    """Derivative of a limit toward larger values of a parameter, by one program; NaN if unknown."""
    from kilter.solvers.clarabel import solve_conic

    face = _Face(power, refined, rates)
    if not face.known:
        return np.nan
    for tolerance in (SHARP, CONIC):
        answer = solve_conic(face.program(), tolerance=tolerance)
        if answer.optimal and answer.residual <= SLOPE_SOLVED:
            return float(answer.x[-1]) * face.size
    return np.nan


class _Face:
    """The program of a slope. Unknowns: a, h, g and the slope."""

    def __init__(self, power: LimitPower, refined: RefinedLimit, rates: Rates) -> None:
        self.power, self.refined, self.solved = power, refined, refined.solved
        program, contacting = self.solved.program, refined.contacting
        self.by_load = bool(self.solved.along.any())
        mu = row_friction(self.solved)
        self.forces = ForceColumns(program, contacting.rows, mu)
        others = np.setdiff1d(np.arange(len(program.part_a)), contacting.rows)
        self.changes = ForceColumns(program, others, mu)
        self.sliding = np.flatnonzero(contacting.slides)
        self._set_load(rates)
        self._set_optima()

    @property
    def known(self) -> bool:
        """Whether the program is linear: friction needs unique forces where parts slide."""
        if self.by_load:
            return True
        scale = max(float(np.abs(self.force).max(initial=0.0)), TINY)
        changes = np.abs(self.force_span[self.sliding]).max(initial=0.0)
        return bool(changes <= SAME_FORCE * scale)

    def _set_load(self, rates: Rates) -> None:
        """Set the changes of the rows and of the load, over their largest value."""
        solved, program = self.solved, self.solved.program
        columns = self.forces
        moved, turned = row_rates(self.power, rates.vertices)
        rows = columns.rows[columns.row]
        turns = cross(turned[rows], columns.direction)
        turns[program.angular[rows]] = 0.0
        change = columns.wrenches(turns, np.zeros_like(turns))
        center = rates.center * ~program.angular.all()
        steady = np.where(program.angular[rows][:, None], 0.0, columns.direction)
        change = change + columns.wrenches(steady, moved[rows], center)
        change -= columns.wrenches(steady, np.zeros_like(moved[rows]), np.zeros_like(center))
        pull = program.gravity
        if solved.along_mass is not None:
            pull = pull + solved.value * solved.along_mass
        load = solved.load_share * rates.applied
        load[:, :3] += rates.mass[:, None] * pull
        load[:, 3:] -= cross(rates.center, solved.fixed)
        row_mu = np.zeros(len(program.part_a))
        contact = np.flatnonzero(program.kind == CONTACT)
        row_mu[contact] = rates.mu[program.source[contact]]
        scaled = columns.scaled(load)
        sizes = [np.abs(each).max(initial=0.0) for each in (change, scaled, row_mu)]
        self.size = max(float(max(sizes)), TINY)
        self.change, self.load = change / self.size, scaled / self.size
        self.row_mu = row_mu[columns.rows] / self.size

    def _set_optima(self) -> None:
        """Set the forces and the motions that are optimal: one of them, and directions."""
        columns, normal = self.forces, self.solved.program.normal

        def values(forces: Array, friction: Array) -> Array:
            return columns.values(forces[:, None] * normal + friction)

        def speeds(motion: Array) -> Array:
            return np.asarray((motion / columns.by_length)[columns.freedoms])

        solved, others = self.solved, scaled_others(self.refined)
        self.force = values(solved.forces, solved.friction)
        changes = [values(forces, friction) for forces, friction, _ in others]
        self.force_span = _basis(changes, self.force)
        motion = speeds(solved.motion)
        aside = _basis([speeds(other) for _, _, other in others], motion)
        self.motions = np.column_stack([motion / np.linalg.norm(motion), aside])

    def program(self) -> ConicProgram:
        """The conic program: an equation for each motion, half lines, cones."""
        first, slides = len(self.force), len(self.sliding)
        count = first + slides + self.changes.levers.shape[1] + 1
        spans = self.motions.T
        rays, beyond = self._rays(count, first)
        equal = np.zeros((len(spans), count))
        equal[:, :first], equal[:, first : first + slides] = spans @ self.change, spans @ rays
        equal[:, first + slides : -1] = spans @ self.changes.levers
        equal[:, -1] = spans @ self.forces.scaled(self.solved.along)
        half, cones, sizes = self._cones(count, first)
        matrix = np.concatenate([equal, -beyond, -half, -cones])
        bound = np.zeros(len(matrix))
        bound[: len(equal)] = -spans @ self.load
        # f = f0 + N a
        bound -= matrix[:, :first] @ self.force
        matrix = np.column_stack([matrix[:, :first] @ self.force_span, matrix[:, first:]])
        cost = np.zeros(matrix.shape[1])
        cost[-1] = -1.0 if self.by_load else 1.0
        none = csc_array((len(cost), len(cost)))
        positive = len(beyond) + len(half)
        return ConicProgram(none, cost, csc_array(matrix), bound, len(equal), positive, sizes)

    def _rays(self, count: int, first: int) -> tuple[Array, Array]:
        """Sliding rows: wrenches that measure their speeds, and forces beyond their cones."""
        columns = self.forces
        rays, beyond = np.zeros((len(columns.levers), len(self.sliding))), []
        for k, row in enumerate(self.sliding.tolist()):
            tangents, mu = columns.tangents(row), columns.mu[row]
            unit = self.force[tangents] / max(float(np.linalg.norm(self.force[tangents])), TINY)
            along = mu * columns.levers[:, row] - columns.levers[:, tangents] @ unit
            rays[:, k] = along / (1 + mu**2)
            plane = np.eye(1, count, first + k)[0]
            if self.by_load:
                plane[row] = self.row_mu[row]
            else:
                plane[-1] = self.force[row]
            beyond.append(plane)
        return rays, np.array(beyond).reshape(-1, count)

    def _cones(self, count: int, first: int) -> tuple[Array, Array, Index]:
        """Forces, and changes at rows without force: half lines, cones, and sizes of the cones."""
        half, cones, sizes = [], [], []
        slides = self.refined.contacting.slides
        groups = [(self.forces, 0, slides)]
        none = np.zeros(len(self.changes.rows), dtype=bool)
        groups.append((self.changes, first + len(self.sliding), none))
        for columns, offset, rays in groups:
            two_sided = columns.program.two_sided[columns.rows]
            for row in np.flatnonzero(~two_sided).tolist():
                head = np.eye(1, count, offset + row)[0]
                if rays[row] or not columns.rough[row]:
                    half.append(head)
                    continue
                tangents = offset + columns.tangents(row)
                cones.append(columns.mu[row] * head)
                cones += [np.eye(1, count, column)[0] for column in tangents.tolist()]
                sizes.append(1 + len(tangents))
        return (
            np.array(half).reshape(-1, count),
            np.array(cones).reshape(-1, count),
            np.array(sizes, dtype=np.int64),
        )


def _basis(vectors: list[Array], given: Array) -> Array:
    """Orthonormal basis of the span of vectors as large as a given one, shape (n, m)."""
    if not vectors:
        return np.zeros((len(given), 0))
    left, sizes, _ = np.linalg.svd(np.column_stack(vectors), full_matrices=False)
    basis: Array = left[:, sizes > SAME_SPAN * float(np.linalg.norm(given))]
    return basis


def scaled_others(refined: RefinedLimit) -> list[tuple[Array, Array, Array]]:
    """Changes along which the optimum is not unique, as large as its forces and motion."""
    solved = refined.solved
    force = max(float(np.abs(solved.forces).max(initial=0.0)), TINY)
    program = solved.program
    speed = max(float(part_sizes(program, solved.motion, per_radius=False).max()), TINY)
    scaled = []
    for forces, friction, motion in refined.others:
        by_force = max(float(np.abs(forces).max(initial=0.0)), float(np.abs(friction).max()))
        by_speed = float(part_sizes(program, motion, per_radius=False).max())
        size = max(by_force / force, by_speed / speed)
        if size <= NO_CHANGE:
            continue
        factor = 1 / size
        scaled.append((factor * forces, factor * friction, factor * motion))
    return scaled
