"""Linear and quadratic programs of an assembly's equilibrium and of its motions.

All except the displacement program use scaled unknowns, with one length and one weight per part, so
that the equations of a small part keep their size: translations and radius x rotations; forces and
torques / radius over the weight of the part. The columns of `A` below are the rows of the program.
Gravity is a right-hand side, so a factorised basis stays valid for a new direction.

    equilibrium        find f:  A f = b,  f >= 0                       A = S J^T,  b = -S w
    load factor        max lambda:  A f - lambda b = 0, 0 <= lambda <= 1       is 0 or 1
    largest share      max t:  A f - t d = b,  t <= T,  f >= 0
    least imbalance    min t:  -t <= A f - b <= t, f >= 0
    total imbalance    min sum |A f - b|,  f >= 0
    displacement       LP (9) of the paper, as published, in the units of the file
    impending motion   min 1/2 (a - M^-1 w)^T M (a - M^-1 w),  J a >= 0        Gauss

The solutions are decoded to forces, shape (K,), and motions, shape (N, 6), of the program.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csc_array, eye_array, hstack, kron, vstack

from kilter.arrays import TINY, Array
from kilter.mechanics.mechanics_tolerances import ZERO_ENTRY
from kilter.mechanics.program import Program
from kilter.rigid import common_frame
from kilter.solvers.problem import ConicProgram, LinearProgram, quadratic_program


@dataclass(frozen=True, slots=True, eq=False)
class ScaledProblem:
    """Scaled equilibrium A f = b of the free parts, in the frame of the assembly."""

    program: Program
    frame: Array
    """Rotation from the world to the frame in which most normals lie along axes, so that a
    rotated assembly has as few nonzero entries as an upright one, shape (3, 3)."""
    unit: float
    """Unit of force, the geometric mean of the weights [N]: the entries of the matrix are near 1
    whether the parts weigh grams or megatons."""
    matrix: csc_array
    """A, shape (freedoms, K)."""
    right: Array
    """b, shape (freedoms,)."""
    weight: Array
    """`Program.weight`, shape (N,)."""

    def forces(self, columns: Array) -> Array:
        """Force of each row [N], shape (K,), from the scaled unknowns f of the equilibrium."""
        return columns * self.unit * self.program.arm

    def motion(self, columns: Array) -> Array:
        """Motion of all parts, shape (N, 6), from the scaled motion of the free parts."""
        program = self.program
        per = len(program.freedoms)
        full = np.zeros((len(program.names), 6))
        full[np.ix_(program.free, program.freedoms)] = columns.reshape(-1, per)
        full[:, 3:] /= program.radius[:, None]
        turned = full.reshape(-1, 2, 3) @ self.frame
        return turned.reshape(-1, 6)

    def rounded(self, least: float) -> ScaledProblem:
        """Copy of the problem in which matrix entries smaller than `least` are 0."""
        matrix = self.matrix.copy()
        matrix.data[np.abs(matrix.data) < least] = 0.0
        matrix.eliminate_zeros()
        return replace(self, matrix=matrix)

    def openings(self) -> csc_array:
        """Matrix from scaled motions of free parts to gap openings of rows [length unit]."""
        weight = np.repeat(self.weight[self.program.free] / self.unit, len(self.program.freedoms))
        return csc_array(csc_array(self.matrix.multiply(weight[:, None])).T)

    def power(self) -> Array:
        """Vector whose product with a scaled motion is the power of the load in that motion."""
        weight = self.weight[self.program.free]
        return -self.right * np.repeat(weight, len(self.program.freedoms))

    def scaled_load(self, wrench: Array) -> Array:
        """Scale wrenches on all parts, shape (N, 6), as the right-hand side of the equilibrium."""
        return _over_weight(self.program, self.frame, self.weight, wrench)

    def over_weight(self, columns: Array) -> Array:
        """Scaled motion of the free parts: multipliers of equilibrium over the parts' weights."""
        program = self.program
        return columns / np.repeat(self.weight[program.free], len(program.freedoms))


def scaled_problem(program: Program, known: ScaledProblem | None = None) -> ScaledProblem:
    """Build the scaled equilibrium A f = b of a program."""
    first = 0
    if known is not None:
        frame, unit, right, weight = known.frame, known.unit, known.right, known.weight
        first = known.matrix.shape[1]
    else:
        frame = np.eye(3)
        if not program.planar:
            frame = common_frame(program.normal, np.ones(len(program.normal)))
        weight = program.weight
        unit = float(np.exp(np.log(weight[program.free]).mean())) if program.free.any() else 1.0
        right = _over_weight(program, frame, weight, program.load)
    data, index, start = _columns(program, frame, unit / weight, first)
    if known is not None:
        before = known.matrix
        data, index = np.append(before.data, data), np.append(before.indices, index)
        start = np.append(before.indptr, before.indptr[-1] + start[1:])
    matrix = csc_array((data, index, start), shape=(len(right), len(program.part_a)))
    return ScaledProblem(program, frame, unit, matrix, right, weight)


def _columns(
    program: Program, frame: Array, per_weight: Array, first: int
) -> tuple[Array, NDArray[np.int32], NDArray[np.int32]]:
    """Entries, row indices and starts of the columns of A from the row `first` of a program.

    `per_weight`, shape (N,), is the unit of force over the weight of each part.
    """
    per = len(program.freedoms)
    column = np.full(len(program.names) + 1, -1)
    column[:-1][program.free] = np.arange(int(program.free.sum()))
    arm = program.arm if program.angular[first:].any() else np.ones(len(program.part_a))
    count = len(program.part_a) - first
    data = np.zeros((count, 2, per))
    index = np.zeros((count, 2, per), dtype=np.int32)
    for side, (part, sign) in enumerate(((program.part_a, -1.0), (program.part_b, 1.0))):
        rows = first + np.flatnonzero(column[part[first:]] >= 0)
        owner = part[rows]
        lever = program.lever(rows, owner).reshape(-1, 2, 3) @ frame.T
        lever[:, 1] /= program.radius[owner][:, None]
        entries = lever.reshape(-1, 6)[:, program.freedoms]
        # rounding of rotated levers would fill the sparse matrix
        entries[np.abs(entries) * arm[rows, None] < ZERO_ENTRY] = 0.0
        scale = per_weight[owner] * arm[rows]
        data[rows - first, side] = sign * entries * scale[:, None]
        index[rows - first, side] = column[owner][:, None] * per + np.arange(per)
    flat_data, flat_index = data.reshape(-1, 2 * per), index.reshape(-1, 2 * per)
    used = flat_data != 0
    start = np.concatenate([[0], np.cumsum(used.sum(axis=1))]).astype(np.int32)
    return flat_data[used], flat_index[used], start


def _over_weight(program: Program, frame: Array, weight: Array, wrench: Array) -> Array:
    """Minus the wrenches of free parts over weights (torques also over radii), in the frame."""
    turned = wrench[program.free].reshape(-1, 2, 3) @ frame.T
    turned[:, 1] /= program.radius[program.free][:, None]
    free = weight[program.free][:, None]
    return -(turned.reshape(-1, 6)[:, program.freedoms] / free).reshape(-1)


def _force_bounds(problem: ScaledProblem) -> tuple[Array, Array]:
    """Bounds of each row's scaled force: its capacity, and 0 for one-sided rows."""
    upper = problem.program.capacity / (problem.unit * problem.program.arm)
    return np.where(problem.program.two_sided, -upper, 0.0), upper


def equilibrium(problem: ScaledProblem) -> LinearProgram:
    """Linear program for contact forces that balance the load: A f = b. x = f."""
    lower, upper = _force_bounds(problem)
    cost = np.zeros(len(lower))
    return LinearProgram(cost, problem.matrix, problem.right, problem.right, lower, upper)


def load_factor(problem: ScaledProblem) -> LinearProgram:
    """Linear program for the largest multiple of the load that contacts balance. x = (f, lambda).

    If it is 0, the multipliers y of the rows give a motion: -y has J dp >= 0 and w.dp >= 1.
    """
    lower, upper = _force_bounds(problem)
    count = len(lower)
    matrix = hstack([problem.matrix, csc_array(-problem.right[:, None])], format="csc")
    cost = np.concatenate([np.zeros(count), [-1.0]])
    zero = np.zeros(len(problem.right))
    return LinearProgram(cost, matrix, zero, zero, np.append(lower, 0.0), np.append(upper, 1.0))


def largest_share(problem: ScaledProblem, wrench: Array, most: float) -> LinearProgram:
    """Linear program for the largest multiple t <= `most` of extra wrenches. x = (f, t).

    Minus the multipliers of the rows are the motion that starts at the limit.
    """
    lower, upper = _force_bounds(problem)
    along = problem.scaled_load(wrench)
    matrix = hstack([problem.matrix, csc_array(-along[:, None])], format="csc")
    cost = np.append(np.zeros(len(lower)), -1.0)
    right = problem.right
    return LinearProgram(
        cost, matrix, right, right, np.append(lower, -np.inf), np.append(upper, most)
    )


def least_imbalance(problem: ScaledProblem) -> LinearProgram:
    """Linear program for forces with the smallest maximum imbalance over weight. x = (f, t).

    The multipliers give the motion of greatest power among those whose weighted absolute components
    sum to 1, so both possible proofs are as strong as possible.
    """
    lower, upper = _force_bounds(problem)
    rows = len(problem.right)
    slack = csc_array(np.ones((rows, 1)))
    matrix = vstack(
        [hstack([problem.matrix, slack]), hstack([problem.matrix, -slack])], format="csc"
    )
    cost = np.concatenate([np.zeros(len(lower)), [1.0]])
    unbounded = np.full(rows, np.inf)
    return LinearProgram(
        cost,
        matrix,
        np.concatenate([problem.right, -unbounded]),
        np.concatenate([unbounded, problem.right]),
        np.append(lower, 0.0),
        np.append(upper, np.inf),
    )


def total_imbalance(problem: ScaledProblem) -> LinearProgram:
    """Linear program for forces with the least sum of imbalances. x = (f, deficit, excess).

    Minus the multipliers are a motion of at most 1 in each freedom; if the sum is above 0, it is
    the power of that motion. The program has nearly as few entries as `equilibrium`, and a solution
    for every load.
    """
    lower, upper = _force_bounds(problem)
    rows = len(problem.right)
    identity = eye_array(rows, format="csc")
    matrix = csc_array(hstack([problem.matrix, identity, -identity], format="csc"))
    cost = np.append(np.zeros(len(lower)), np.ones(2 * rows))
    return LinearProgram(
        cost,
        matrix,
        problem.right,
        problem.right,
        np.append(lower, np.zeros(2 * rows)),
        np.append(upper, np.full(2 * rows, np.inf)),
    )


def displacement(program: Program) -> LinearProgram:
    """Displacement program: the bounded admissible motion in which the load does most work.

    This is LP (9) of the paper, with gravity of length 1. x = dp in the order of `Program.columns`;
    lengths are in the unit of the file. Each row is divided by its length, which changes no
    solution.
    """
    cost = -program.load[np.ix_(program.free, program.freedoms)].reshape(-1)
    cost = cost / program.g
    matrix = program.jacobian()
    length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
    matrix = csc_array(matrix.multiply(1.0 / np.maximum(length, TINY)[:, None]))
    bound = np.ones(len(cost))
    return LinearProgram(
        cost,
        matrix,
        np.zeros(len(length)),
        np.where(program.two_sided, 0.0, np.inf),
        -bound,
        bound,
    )


def impending_motion(problem: ScaledProblem) -> ConicProgram:
    """Quadratic program for the accelerations from rest by Gauss's principle, in scaled unknowns.

    x = (a, radius x alpha) of the free parts over the size of gravity, in the frame of the problem.
    Masses are divided by the largest, so that the numbers are near 1:

        min 1/2 x.M x / m_max - w.x / (m_max |g|),   J x >= 0.
    """
    program = problem.program
    free = np.flatnonzero(program.free)
    per = len(program.freedoms)
    turned = np.einsum("ij,njk,lk->nil", problem.frame, program.inertia[free], problem.frame)
    mass = np.zeros((len(free), 6, 6))
    mass[:, range(3), range(3)] = 1.0
    mass[:, 3:, 3:] = turned / (program.mass[free] * program.radius[free] ** 2)[:, None, None]
    share = program.mass[free] / program.mass[free].max(initial=TINY)
    blocks = mass[:, program.freedoms][:, :, program.freedoms] * share[:, None, None]
    row = np.arange(len(free))[:, None, None] * per + np.arange(per)[:, None]
    col = np.arange(len(free))[:, None, None] * per + np.arange(per)[None, :]
    shape = (per * len(free),) * 2
    places = (
        np.broadcast_to(row, blocks.shape).ravel(),
        np.broadcast_to(col, blocks.shape).ravel(),
    )
    quadratic = csc_array((blocks.ravel(), places), shape=shape)
    largest = program.mass[free].max(initial=TINY) * program.g
    share = program.weight[free] / largest
    cost = (problem.right.reshape(-1, per) * share[:, None]).reshape(-1)
    opening = problem.openings()
    order = np.argsort(~program.two_sided, kind="stable")
    return quadratic_program(
        quadratic, cost, opening[order], np.zeros(len(order)), int(program.two_sided.sum())
    )


# Linear program for contact forces that depend affinely on the uncertain terms of a load.


@dataclass(frozen=True, slots=True, eq=False)
class UncertainLoad:
    """A load that depends on uncertain terms within a box, scaled for the equilibrium equations."""

    right: Array
    along: Array
    """Load at t = 0, and its change per unit of t, shape (rows,)."""
    sides: Array
    turns: Array
    """Change of `right`, and of `along`, per unit of each unknown d_k, shape (K, rows)."""


def affine_forces(problem: ScaledProblem, load: UncertainLoad, most: float) -> LinearProgram:
    """Linear program for the largest multiple t of a load, with forces affine in the unknowns d.

    Its unknowns are x = (t, f_0, f_k+, f_k-), where f_k = f_k+ - f_k- and both are nonnegative.

    Arguments: `most`: upper bound of t [-].
    """
    matrix, one_sided = problem.matrix, np.flatnonzero(~problem.program.two_sided)
    rows, count = matrix.shape
    unknowns = len(load.sides)
    follow_blocks = block_diag([matrix, *[matrix] * unknowns], format="csc")
    negative = vstack(
        [csc_array((rows, count * unknowns)), -follow_blocks[rows:, count:]]
        if unknowns
        else [csc_array((rows, 0))]
    )
    share = csc_array(-np.concatenate([load.along, load.turns.ravel()])[:, None])
    balance = hstack([share, follow_blocks, negative])
    pushing = csc_array(eye_array(count))[one_sided]
    all_unknowns = (
        kron(np.ones((1, unknowns)), pushing)
        if unknowns
        else csc_array((len(pushing.indptr) - 1, 0))
    )
    # f_0 - sum_k (f_k+ + f_k-) >= 0 on the rows that only push
    pushes = hstack([csc_array((len(one_sided), 1)), pushing, -all_unknowns, -all_unknowns])
    bound = np.concatenate([load.right, load.sides.ravel()])
    free = np.where(problem.program.two_sided, -np.inf, 0.0)
    total = 1 + count * (1 + 2 * unknowns)
    lower = np.concatenate([[0.0], free, np.zeros(2 * count * unknowns)])
    upper = np.full(total, np.inf)
    upper[0] = most
    cost = np.zeros(total)
    cost[0] = -1.0
    return LinearProgram(
        cost,
        csc_array(vstack([balance, pushes], format="csc")),
        np.concatenate([bound, np.zeros(len(one_sided))]),
        np.concatenate([bound, np.full(len(one_sided), np.inf)]),
        lower,
        upper,
    )


def affine_imbalance(problem: ScaledProblem, load: UncertainLoad, x: Array) -> float:
    """Largest imbalance of a part for any d, over its weight [-], for a solution x of the program.

    The forces are first cut to their cones: f_0 of a row that only pushes is raised to sum_k |f_k|.
    """
    count, unknowns = problem.matrix.shape[1], len(load.sides)
    share, forces = float(x[0]), x[1 : 1 + count]
    both = x[1 + count :].reshape(2, unknowns, count)
    follow = both[0] - both[1]
    pushes = ~problem.program.two_sided
    middle = np.where(pushes, np.maximum(forces, np.abs(follow).sum(axis=0)), forces)
    rest = np.abs(problem.matrix @ middle - load.right - share * load.along)
    for k in range(unknowns):
        rest += np.abs(problem.matrix @ follow[k] - load.sides[k] - share * load.turns[k])
    return float(rest.max(initial=0.0))


# Balanced contact forces closest to those of unloaded bonds, by Newton's method.


REGULAR = 1e-12
"""Regularisation of the equations, relative to their largest diagonal entry; a second solve removes
its effect.
"""
REFINED = 2
"""Number of solves with each factorisation."""
STEPS = 6
"""Maximum number of Newton steps."""
BALANCED = 1e-11
"""Residual over weight that counts as rounding [-]."""
STALLED = 0.9
"""A step is stalled if it leaves more than this fraction of the smallest residual so far [-]."""
PATIENCE = 1
"""Stop after this many consecutive stalled steps."""


def least_forces(problem: ScaledProblem) -> tuple[Array, Array] | None:
    """Balanced row forces, (K,), and a motion that may be a proof, (N, 6); None without bonds."""
    program, matrix = problem.program, problem.matrix
    if not program.pull.any():
        return None
    from scipy.sparse.linalg import splu  # slow to import

    strength = program.pull / (problem.unit * program.arm)
    active = (program.pull > 0) | program.two_sided
    y = np.zeros(len(problem.right))
    identity = eye_array(len(y), format="csc")
    least_size, stalled = np.inf, 0
    forces, residual = strength, problem.right
    for _ in range(STEPS):
        used = matrix[:, np.flatnonzero(active)]
        normal = used @ used.T
        largest = float(normal.diagonal().max(initial=TINY))
        factor = splu(
            csc_array(normal + REGULAR * largest * identity),
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True},
        )
        with np.errstate(all="ignore"):  # without active rows the system is singular: overflow
            for _ in range(REFINED):
                y = y + factor.solve(problem.right - used @ (strength[active] + used.T @ y))
        # the last step had no active rows; the best step before it counts
        if not np.isfinite(y).all():
            break
        pressed = strength + matrix.T @ y
        active = (pressed > 0) | program.two_sided
        trial_forces = np.where(active, pressed, 0.0)
        trial_residual = problem.right - matrix @ trial_forces
        trial_size = float(np.abs(trial_residual).max(initial=0.0))
        stalled = stalled + 1 if trial_size > STALLED * least_size else 0
        if trial_size < least_size:
            least_size, forces, residual = trial_size, trial_forces, trial_residual
        if trial_size < BALANCED or stalled == PATIENCE:
            break
    return problem.forces(forces), problem.motion(problem.over_weight(-residual))
