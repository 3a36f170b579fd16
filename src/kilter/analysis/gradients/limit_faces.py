"""One-sided derivatives of a limit whose forces or motion are not unique.

In the direction of rates of the data, a limit max { L : J^T f + w + L d = 0, f in K } has the slope

    max l:  J^T g + l d + dJ^T f + dw + L dd = 0    over all optimal f, and changes g of them:
    g is free where contacts stick, below the tangent plane of the cone where they slide (mu' f_n
    above it), and in the cone where they carry no force

By duality the inner maximum is the least over all optimal motions of the formula for a single
motion (`kilter.analysis.gradients.limit_power`). A least friction is a minimum: there the slope is
the least l, where the friction mu' is l itself.

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

SHARP = 1e-12
"""Gap of the program of a slope [-]; the error of the slope is a large multiple of it."""
NO_CHANGE = 1e-12
"""Changes of forces and motion below this, relative to the largest, are rounding [-]."""


def slope_on_face(power: LimitPower, refined: RefinedLimit, rates: Rates) -> float:
    """Derivative of a limit toward larger values of a parameter, by one program; NaN if unknown."""
    from kilter.solvers.clarabel import solve_conic

    face = _Face(power, refined, rates)
    if not face.known:
        return np.nan
    answer = solve_conic(face.program(), tolerance=SHARP)
    if not answer.found:
        answer = solve_conic(face.program())
    return float(answer.x[-1]) * face.size if answer.found else np.nan


class _Face:
    """The program of a slope. Unknowns: forces, their changes, and the slope."""

    def __init__(self, power: LimitPower, refined: RefinedLimit, rates: Rates) -> None:
        self.power, self.refined, self.solved = power, refined, refined.solved
        self.contacting = refined.contacting
        program = self.solved.program
        self.by_load = bool(self.solved.along.any())
        mu = row_friction(self.solved)
        self.forces = ForceColumns(program, self.contacting.rows, mu)
        others = np.setdiff1d(np.arange(len(program.part_a)), self.contacting.rows)
        rows = np.concatenate([self.contacting.rows, others])
        self.changes = ForceColumns(program, rows, mu)
        self._set_load(rates)

    @property
    def known(self) -> bool:
        """Whether the program is linear: friction needs unique forces where parts slide."""
        if self.by_load:
            return True
        sliding = self.contacting.rows[self.contacting.slides]
        scale = max(float(np.abs(self.solved.forces).max(initial=0.0)), TINY)
        changes = [np.abs(forces[sliding]).max(initial=0.0) for forces, _, _ in self.refined.others]
        return max(changes, default=0.0) <= SAME_FORCE * scale

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

    def program(self) -> ConicProgram:
        """The conic program: equations, half lines, cones."""
        first, second = self.forces.levers.shape[1], self.changes.levers.shape[1]
        count = first + second + 1
        steady = self.forces.scaled(
            self.solved.program.load + self.solved.value * self.solved.along
        )
        along = self.forces.scaled(self.solved.along)
        top = np.zeros((len(steady), count))
        top[:, :first] = self.forces.levers
        low = np.zeros((len(steady), count))
        low[:, :first], low[:, first:-1], low[:, -1] = self.change, self.changes.levers, along
        rays, planes = self._sliding(count, first)
        half, cones, sizes = self._cones(count, first)
        matrix = np.concatenate([top, low, rays, planes, -half, -cones])
        bound = np.zeros(len(matrix))
        bound[: len(steady)] = -steady
        bound[len(steady) : 2 * len(steady)] = -self.load
        cost = np.zeros(count)
        cost[-1] = -1.0 if self.by_load else 1.0
        equal, positive = 2 * len(steady) + len(rays), len(planes) + len(half)
        return ConicProgram(
            csc_array((count, count)), cost, csc_array(matrix), bound, equal, positive, sizes
        )

    def _sliding(self, count: int, first: int) -> tuple[Array, Array]:
        """Sliding rows: equations of forces along rays, and changes below tangent planes."""
        columns, rays, planes = self.forces, [], []
        force = columns.values(
            self.solved.forces[:, None] * self.solved.program.normal + self.solved.friction
        )
        for row in np.flatnonzero(self.contacting.slides).tolist():
            tangents = columns.tangents(row)
            size = max(float(np.linalg.norm(force[tangents])), TINY)
            unit = force[tangents] / size
            for column, part in zip(tangents, unit, strict=True):
                on_ray = np.zeros(count)
                on_ray[column], on_ray[row] = 1.0, -columns.mu[row] * part
                rays.append(on_ray)
            plane = np.zeros(count)
            plane[first + self.changes.tangents(row)] = unit
            plane[first + row] = -columns.mu[row]
            if self.by_load:
                plane[row] = -self.row_mu[row]
            else:
                plane[-1] = -force[row]
            planes.append(plane)
        return np.array(rays).reshape(-1, count), np.array(planes).reshape(-1, count)

    def _cones(self, count: int, first: int) -> tuple[Array, Array, Index]:
        """Forces, and changes at rows without force: half lines, cones, and sizes of the cones."""
        half, cones, sizes = [], [], []
        carrying = len(self.contacting.rows)
        without = range(carrying, len(self.changes.rows))
        groups = [(self.forces, 0, range(carrying)), (self.changes, first, without)]
        for columns, offset, rows in groups:
            two_sided = columns.program.two_sided[columns.rows]
            for row in rows:
                slides = offset == 0 and self.contacting.slides[row]
                if two_sided[row]:
                    continue
                head = np.zeros(count)
                head[offset + row] = 1.0
                if slides or not columns.rough[row]:
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
