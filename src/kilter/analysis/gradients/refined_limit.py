"""Forces and motion of a limit to rounding, and the directions in which they are not unique.

The solver's forces and motion at a limit have errors of about the root of its gap. They tell which
contacts stick, slide and open. With this knowledge the conditions of the optimum are equations:

    J^T f + w + L d = 0,    q.d = 1
    sticking     v = 0
    sliding      |f_t| = mu f_n,    v = s (mu n - f_t/|f_t|)

Newton's method solves them. For a least friction, d is 0 and L is the coefficient mu. The null
space of their matrix consists of the changes of forces and motion that keep the limit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.analysis_tolerances import LIMIT_REFINED, LIMIT_SIGNS
from kilter.analysis.gradients.limit_power import SolvedLimit
from kilter.arrays import TINY, Array, Index, Mask, across, cross, lengths
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

STEPS = 8
"""Largest number of steps of Newton's method; they end where only rounding is left."""
LARGEST = 1500
"""Largest number of unknowns for which the equations are solved."""
LEFT_OUT = 8
"""Largest number of rows that are left out because they open."""
NULL = 1e-9
"""Diagonal entries of a triangular factor below this share of the largest count as 0 [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Contacting:
    """The contact rows that carry force at a limit."""

    rows: Index
    """Rows with forces, shape (A,)."""
    slides: Mask
    """Whether the row slides with friction, shape (A,)."""


@dataclass(frozen=True, slots=True, eq=False)
class RefinedLimit:
    """A solved limit, the rows that carry it, and changes of forces and motion that keep it."""

    solved: SolvedLimit
    contacting: Contacting
    others: tuple[tuple[Array, Array, Array], ...]
    """Changes along which the optimum is not unique: of forces along and across the rows, of the
    motion; shapes (K,), (K, 3), (N, 6)."""


def contacting_rows(solved: SolvedLimit) -> Contacting:
    """Decide which rows carry force and which of them slide, from a solution with errors."""
    program, motion = solved.program, solved.motion
    forces, aside = solved.forces, lengths(solved.friction)
    opening = program.velocities(motion) * program.arm
    slip = np.zeros(len(forces))
    contact = np.flatnonzero(program.kind == CONTACT)
    slip[contact] = lengths(program.slips(motion, contact))
    mu = row_friction(solved)
    scale = max(float(np.abs(forces).max(initial=0.0)), TINY)
    speed = max(float(np.abs(opening).max(initial=0.0)), float(slip.max(initial=0.0)), TINY)
    parts_by = (opening - mu * slip) / speed
    carries = program.two_sided | (forces / scale > np.maximum(parts_by, 0.0))
    spare = (mu * forces - aside) / scale
    slides = (mu > 0) & (slip / speed > spare)
    rows = np.flatnonzero(carries)
    return Contacting(rows, slides[rows])


def row_friction(solved: SolvedLimit) -> Array:
    """Friction coefficient of each row at the limit, shape (K,)."""
    program = solved.program
    if solved.along.any():
        return program.mu
    rubs = (program.kind == CONTACT) & ~program.tied & np.isnan(program.shear)
    return np.where(rubs, np.maximum(solved.value - program.doubt, 0.0), 0.0)


def is_large(solved: SolvedLimit) -> bool:
    """Whether a limit has too many unknowns to be refined."""
    return _Equations(solved, contacting_rows(solved)).count > LARGEST


def refine_limit(solved: SolvedLimit) -> RefinedLimit | None:
    """Forces and motion to rounding; None if the equations are too many or have no solution.

    A solver gives small forces also to rows that open by a hair, such as the fourth corner of a
    face that slides and turns. Then the equations contradict each other, and the row that opens
    most, over its force, is left out.
    """
    contacting = contacting_rows(solved)
    for _ in range(LEFT_OUT + 1):
        equations = _Equations(solved, contacting)
        if equations.count > LARGEST:
            return None
        x, residual, matrix = _newton(equations)
        if np.abs(residual).max() <= LIMIT_REFINED:
            break
        opening = equations.opening(x, residual)
        if not opening.max(initial=0.0) > 0.0:
            return None
        kept = np.arange(len(opening)) != opening.argmax()
        contacting = Contacting(contacting.rows[kept], contacting.slides[kept])
    else:
        return None
    refined = equations.solved(x)
    if not _is_optimal(refined, contacting, x[equations.ends[1] : equations.ends[2]]):
        return None
    others = tuple(equations.directions(direction) for direction in _null_space(matrix).T)
    return RefinedLimit(refined, contacting, others)


def _newton(equations: _Equations) -> tuple[Array, Array, Array]:
    """Solve the equations; return unknowns, residual and matrix where only rounding is left."""
    x = equations.start()
    residual, matrix = equations.at(x)
    for _ in range(STEPS):
        accepted = np.abs(residual).max() <= LIMIT_REFINED
        moved = x + _least_step(matrix, -residual)
        following, slopes = equations.at(moved)
        if accepted and not np.abs(following).max() < np.abs(residual).max() / 2:
            break  # only rounding is left
        x, residual, matrix = moved, following, slopes
    return x, residual, matrix


def _is_optimal(solved: SolvedLimit, contacting: Contacting, speeds: Array) -> bool:
    """Whether forces lie in their cones, and no contact closes: the equations are not enough."""
    program = solved.program
    mu = row_friction(solved)
    scale = max(float(np.abs(solved.forces).max(initial=0.0)), TINY)
    spare = mu * solved.forces - lengths(solved.friction)
    spare[contacting.rows[contacting.slides]] = 0.0
    pushes = np.where(program.two_sided, 0.0, solved.forces)
    opening = program.velocities(solved.motion) * program.arm
    contact = np.flatnonzero(program.kind == CONTACT)
    opening[contact] -= mu[contact] * lengths(program.slips(solved.motion, contact))
    opening[contacting.rows] = 0.0
    speed = max(float(np.abs(solved.motion[:, :3]).max()), TINY)
    least = [spare.min(initial=0.0) / scale, pushes.min(initial=0.0) / scale]
    least += [opening.min(initial=0.0) / speed, speeds.min(initial=0.0)]
    return bool(min(least) >= -LIMIT_SIGNS)


def _least_step(matrix: Array, right: Array) -> Array:
    """Solution of least size of linear equations that may be dependent."""
    from scipy.linalg import lstsq

    step: Array = lstsq(matrix, right, cond=NULL, lapack_driver="gelsy", check_finite=False)[0]
    return step


def _null_space(matrix: Array) -> Array:
    """Orthonormal basis of the null space of a matrix, as columns."""
    from scipy.linalg import qr

    q, r, _ = qr(matrix.T, pivoting=True, check_finite=False)
    diagonal = np.abs(np.diag(r))
    rank = int((diagonal > NULL * diagonal.max(initial=TINY)).sum())
    basis: Array = q[:, rank:]
    return basis


class ForceColumns:
    """Unknown forces at rows, a column for each direction, and their scaled wrenches.

    Forces are in weights of the free parts, and lengths in mean radii of them.
    """

    def __init__(self, program: Program, rows: Index, mu: Array) -> None:
        self.program, self.rows, self.mu = program, rows, mu[rows]
        self.weight = max(float(program.weight[program.free].sum()), TINY)
        self.length = float(program.radius[program.free].mean())
        self.rough = (self.mu > 0) & (program.kind[rows] == CONTACT)
        normal = program.normal[rows]
        u, v = across(normal)
        if program.planar:
            u = cross(normal, np.tile([0.0, 1.0, 0.0], (len(normal), 1)))
        tangents = [u] if program.planar else [u, v]
        which = np.flatnonzero(self.rough)
        self.row = np.concatenate([np.arange(len(normal)), *[which] * len(tangents)])
        self.direction = np.concatenate([normal, *(t[which] for t in tangents)])
        self.tangential = np.arange(len(self.row)) >= len(normal)
        self.freedoms = np.tile(np.isin(np.arange(6), program.freedoms), (len(program.free), 1))
        self.freedoms &= program.free[:, None]
        self.by_length = np.tile([1.0] * 3 + [1 / self.length] * 3, (len(program.free), 1))
        self.levers = self.wrenches(self.direction, np.zeros((len(self.row), 3)))

    def wrenches(self, force: Array, shift: Array, center: Array | None = None) -> Array:
        """Scaled wrenches of forces at the rows of the columns, shape (freedoms, columns).

        Arguments: `force` (columns, 3): on part b; `shift` (columns, 3): arm beside that from the
        centre of mass; with `center` (N, 3), less that of the part, the arm is the shift alone.
        """
        program, rows = self.program, self.rows[self.row]
        base = np.zeros((len(program.free), 6, len(rows)))
        columns = np.arange(len(rows))
        angular = program.angular[rows][:, None]
        for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
            mine = part[rows]
            k = np.flatnonzero(mine >= 0)
            arm = program.point[rows[k]] - program.center[mine[k]] + shift[k]
            if center is not None:
                arm = shift[k] - center[mine[k]]
            push = np.where(angular[k], 0.0, force[k])
            moment = np.where(angular[k], force[k], cross(arm, force[k]))
            base[mine[k], :3, columns[k]] += sign * push
            base[mine[k], 3:, columns[k]] += sign * moment / self.length
        scaled: Array = base[self.freedoms]
        return scaled

    def scaled(self, wrench: Array) -> Array:
        """Scaled wrenches of the freedoms of the free parts, from shape (N, 6)."""
        scaled: Array = (wrench * self.by_length)[self.freedoms] / self.weight
        return scaled

    def values(self, force: Array) -> Array:
        """Values of the columns for forces of all rows, shape (K, 3) [N]."""
        along = np.einsum("ij,ij->i", force[self.rows[self.row]], self.direction)
        return np.asarray(along / self.weight)

    def tangents(self, row: int) -> Index:
        """Columns of the friction of a row, by its position in `rows`."""
        return np.flatnonzero((self.row == row) & self.tangential)


class _Equations:
    """The equations of an optimum; unknowns: forces, sliding speeds, motion, limit; scaled."""

    def __init__(self, solved: SolvedLimit, contacting: Contacting) -> None:
        self.given, self.slides = solved, contacting.slides
        program = solved.program
        self.columns = columns = ForceColumns(program, contacting.rows, row_friction(solved))
        self.speed = max(float(np.abs(solved.motion[:, :3]).max()), TINY)
        self.by_load = bool(solved.along.any())
        self.base = columns.levers
        parts = [self.base.shape[1], int(self.slides.sum()), self.base.shape[0], 1]
        self.ends = np.cumsum([0, *parts])
        self.count = int(self.ends[-1])
        self.load = columns.scaled(program.load)
        self.along = columns.scaled(solved.along)
        motion = (solved.motion / columns.by_length)[columns.freedoms] / self.speed
        self.norm = self.along if self.by_load else motion
        self.unit = float(self.norm @ motion)

    def start(self) -> Array:
        """The unknowns of the given solution."""
        solved = self.given
        force = solved.forces[:, None] * solved.program.normal + solved.friction
        columns = self.columns
        motion = (solved.motion / columns.by_length)[columns.freedoms] / self.speed
        speeds = np.zeros(int(self.slides.sum()))
        x = np.concatenate([columns.values(force), speeds, motion, [solved.value]])
        x[self.ends[1] : self.ends[2]] = self._slip(x)
        return x

    def _tangential_sums(self, values: Array) -> Array:
        """Length of the tangential part of column values at each row, shape (A,)."""
        columns = self.columns
        aside = np.where(columns.tangential, values, 0.0)
        squared = np.bincount(columns.row, aside**2, minlength=len(columns.rows))
        return np.sqrt(squared)

    def _slip(self, x: Array) -> Array:
        velocity = self.base.T @ x[self.ends[2] : self.ends[3]]
        slip: Array = self._tangential_sums(velocity)[self.slides]
        return slip

    def at(self, x: Array) -> tuple[Array, Array]:
        """Residual and matrix of the equations."""
        forces, speeds, motion = (x[self.ends[k] : self.ends[k + 1]] for k in range(3))
        limit = float(x[-1])
        mu = self.columns.mu
        if not self.by_load:
            mu = np.where(self.columns.rough, limit, 0.0)
        velocity = self.base.T @ motion
        count, first = self.count, self.base.shape[0]
        matrix = np.zeros((count, count))
        residual = np.zeros(count)
        load = limit * self.along if self.by_load else 0.0
        residual[:first] = self.base @ forces + self.load + load
        matrix[:first, : self.ends[1]] = self.base
        if self.by_load:
            matrix[:first, -1] = self.along
        middle = first + len(forces)
        residual[first:middle] = velocity
        matrix[first:middle, self.ends[2] : self.ends[3]] = self.base.T
        sliding = np.flatnonzero(self.slides)
        for k, row in enumerate(sliding.tolist()):
            self._add_sliding(residual, matrix, (k, row, first), forces, float(speeds[k]), mu[row])
        residual[-1] = self.norm @ motion - self.unit
        matrix[-1, self.ends[2] : self.ends[3]] = self.norm
        return residual, matrix

    def _add_sliding(
        self,
        residual: Array,
        matrix: Array,
        at: tuple[int, int, int],
        forces: Array,
        speed: float,
        mu: float,
    ) -> None:
        """Add the conditions of a sliding row: force on its cone, velocity along the normal of it.

        `at`: number of the sliding row, of the row, and the first equation of the velocities.
        """
        k, row, first = at
        tangents = self.columns.tangents(row)
        aside = forces[tangents]
        size = max(float(np.linalg.norm(aside)), TINY)
        unit = aside / size
        middle = first + len(forces)
        column = self.ends[1] + k
        residual[middle + k] = size - mu * forces[row]
        matrix[middle + k, tangents] = unit
        matrix[middle + k, row] = -mu
        residual[first + row] -= speed * mu
        matrix[first + row, column] = -mu
        residual[first + tangents] += speed * unit
        matrix[first + tangents, column] = unit
        turning = (np.eye(len(unit)) - np.outer(unit, unit)) * (speed / size)
        matrix[np.ix_(first + tangents, tangents)] = turning
        if not self.by_load:
            matrix[middle + k, -1] = -forces[row]
            matrix[first + row, -1] = -speed

    def opening(self, x: Array, residual: Array) -> Array:
        """Velocity at which each row opens beside its condition, over its force, shape (A,)."""
        first, rows = self.base.shape[0], self.columns.rows
        ratio = residual[first : first + len(rows)] / np.maximum(np.abs(x[: len(rows)]), TINY)
        return np.where(self.columns.program.two_sided[rows], 0.0, ratio)

    def solved(self, x: Array) -> SolvedLimit:
        """The limit with the forces and motion of the unknowns."""
        forces, friction, motion = self.directions(x)
        return replace(
            self.given, forces=forces, friction=friction, motion=motion, value=float(x[-1])
        )

    def directions(self, x: Array) -> tuple[Array, Array, Array]:
        """Forces along and across the rows, and the motion, of unknowns."""
        columns, program = self.columns, self.given.program
        values = x[: self.ends[1]] * columns.weight
        forces, friction = np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
        aside = columns.tangential
        forces[columns.rows] = values[~aside]
        rows = columns.rows[columns.row[aside]]
        np.add.at(friction, rows, values[aside, None] * columns.direction[aside])
        motion = np.zeros((len(program.free), 6))
        motion[columns.freedoms] = x[self.ends[2] : self.ends[3]] * self.speed
        return forces, friction, motion * columns.by_length
