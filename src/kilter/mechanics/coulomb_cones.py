"""Programs with Coulomb's cones: equilibrium with friction, exact or by pyramids.

A contact with friction transmits every force f_n n + f_t with |f_t| <= mu f_n. Its row n becomes
three rows, n, u, v, and a second-order cone (mu f_n, f_u, f_v). In a planar assembly there are two
rows, and the cone has two rays. The scaled unknowns and the load are those of
`kilter.mechanics.forms`.

    load factor        max lambda:  A f = lambda b,  0 <= lambda <= 1,  f in K        0 or 1
    largest load       max t:  A f = b + t d,  t <= T,  f in K
    nearest load       min 1/2 |t - t0|^2:  A f = D t,  f in K
    least forces       min 1/2 |f|^2:  A f = b,  f in K          unique, inside the cones
    least strength     min s:  A f = b - (1 - s) c,  |f_t| <= mu f_n + s S,  s >= 0   s of all bonds
    least cohesion     min c:  A f = b,  |f_t| <= mu f_n + c w,  c >= -1     c <= 0: it balances

A pyramid replaces each cone by rays, so that the program becomes linear. An inner pyramid has its
rays on the cone: its forces are admissible for the cone. The sides of an outer pyramid touch the
cone from outside: a motion that it admits is admissible for the cone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, diags_array, hstack, vstack

from kilter.arrays import TINY, Array, Index, across, cross
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram, Solution


@dataclass(frozen=True, slots=True, eq=False)
class ConeProblem:
    """Scaled equilibrium with friction cones; rows with friction have tangential unknowns."""

    program: Program
    """The original program."""
    problem: ScaledProblem
    """The split rows: those of `program`, then u of each rough row, then v (only in space)."""
    rough: Index
    """Rows of `program` with a force across them, shape (R,)."""
    directions: Array
    """u and v in the world frame, shape (R, d, 3); d = 1 in the plane, 2 in space."""

    def decoded(self, columns: Array) -> tuple[Array, Array]:
        """Normal forces, shape (K,), and friction forces, (K, 3) [N], from the scaled unknowns."""
        return self.gathered(self.problem.forces(columns))

    def gathered(self, values: Array) -> tuple[Array, Array]:
        """Normal values, (K,), and tangential vectors, (K, 3), from values of the split rows."""
        count, rough = len(self.program.part_a), len(self.rough)
        friction = np.zeros((count, 3))
        for k in range(self.directions.shape[1]):
            component = values[count + k * rough : count + (k + 1) * rough]
            friction[self.rough] += component[:, None] * self.directions[:, k]
        return values[:count], friction

    def turned(self, down: Array) -> ConeProblem:
        """The same problem for gravity along `down`, shape (3,), of unchanged magnitude."""
        program, split = self.program.turned(down), self.problem.program.turned(down)
        right = self.problem.scaled_load(program.load)
        problem = replace(self.problem, program=split, right=right)
        return replace(self, program=program, problem=problem)

    def cone_rows(self) -> tuple[csc_array, int, Index]:
        """Cone constraints of the forces: matrix, number of inequalities, and sizes of the cones.

        G f + h lies in the product of the half lines (first rows; then the capacities of straps and
        of joint friction) and second-order cones; h is `heads`.
        """
        program, total = self.program, self.problem.matrix.shape[1]
        count, rough = len(program.part_a), len(self.rough)
        half_lines = np.flatnonzero(~program.two_sided & (program.mu <= 0))
        size = 1 + self.directions.shape[1]
        columns = np.empty((rough, size), dtype=np.int64)
        values = np.ones((rough, size))
        columns[:, 0] = self.rough
        values[:, 0] = program.mu[self.rough]
        for k in range(1, size):
            columns[:, k] = count + (k - 1) * rough + np.arange(rough)
        bounded, sense = self._limits()
        index = np.concatenate([half_lines, bounded, columns.ravel()])
        data = np.concatenate([np.ones(len(half_lines)), sense, values.ravel()])
        rows = np.arange(len(index))
        matrix = csc_array((data, (rows, index)), shape=(len(index), total))
        return matrix, len(half_lines) + len(bounded), np.full(rough, size)

    def _limits(self) -> tuple[Index, Array]:
        """Row and sign of each capacity: -1 for an upper limit, 1 for the lower one of friction."""
        bounded = self.program.bounded
        both = bounded[self.program.two_sided[bounded]]
        return np.append(bounded, both), np.repeat([-1.0, 1.0], [len(bounded), len(both)])

    def balance(self, *columns: Array | csc_array) -> tuple[csc_array, int]:
        """Rows of the equations of a conic program, and the number of equal pulls among them.

        First the balance of the parts, with further columns beside the forces: arrays of shape
        (freedoms,), or matrices. Then a row for each further piece of a strap: its pull equals that
        of the first piece. The right-hand sides of these last rows are 0.
        """
        first, strap = self.program.bounded_straps
        pieces = self.program.strap_pieces
        later = pieces != first[strap]
        count = int(later.sum())
        more = [csc_array(c[:, None] if c.ndim == 1 else c) for c in columns]
        rows = hstack([self.problem.matrix, *more], format="csc")
        if not count:
            return rows, 0
        entries = (
            np.repeat([1.0, -1.0], count),
            (np.tile(np.arange(count), 2), np.append(pieces[later], first[strap][later])),
        )
        equal = csc_array(entries, shape=(count, rows.shape[1]))
        return vstack([rows, equal], format="csc"), count

    @property
    def heads(self) -> Array:
        """Constant term of each cone constraint: limit of a bond, strap or joint friction, or 0."""
        bounded, _ = self._limits()
        half_lines = int((~self.program.two_sided & (self.program.mu <= 0)).sum())
        size = 1 + self.directions.shape[1]
        positive = half_lines + len(bounded)
        heads = np.zeros(positive + size * len(self.rough))
        limits = self.program.capacity[bounded] / self.program.arm[bounded]
        heads[half_lines:positive] = limits / self.problem.unit
        heads[positive::size] = self.program.cohesion[self.rough] / self.problem.unit
        return heads


def cone_problem(program: Program) -> ConeProblem:
    """Build the scaled equilibrium of a program, with tangential unknowns for friction."""
    rough = program.gripping
    directions = _directions(program, rough)
    rows = np.concatenate([np.arange(len(program.part_a)), *[rough] * directions.shape[1]])
    tangents = [directions[:, k] for k in range(directions.shape[1])]
    normal = np.concatenate([program.normal, *tangents])
    no_friction = {"mu": np.zeros(len(rows)), "shear": np.full(len(rows), np.nan)}
    split = program.taking(rows).with_rows(normal=normal, **no_friction)
    return ConeProblem(program, scaled_problem(split), rough, directions)


def _directions(program: Program, rough: Index) -> Array:
    """Unit tangent directions of the rows with friction, shape (R, d, 3)."""
    normal = program.normal[rough]
    if program.planar:
        return cross(np.array([0.0, 1.0, 0.0]), normal)[:, None, :]
    return np.stack(across(normal), axis=1)


def load_factor_in_cones(cones: ConeProblem) -> ConicProgram:
    """Conic program for the largest fraction of the load that contacts balance; it is 0 or 1.

    If lambda is 0, the multipliers y of the first rows give a motion in the dual cone.
    """
    problem = cones.problem
    total = problem.matrix.shape[1]
    cone_matrix, positive, sizes = cones.cone_rows()
    balance, _ = cones.balance(-problem.right)
    bounds = csc_array((np.array([-1.0, 1.0]), ([0, 1], [total, total])), shape=(2, total + 1))
    conic = hstack([-cone_matrix, csc_array(-cones.heads[:, None])])
    matrix = vstack([balance, bounds, conic], format="csc")
    bound = np.concatenate([np.zeros(balance.shape[0]), [0.0, 1.0], np.zeros(cone_matrix.shape[0])])
    cost = np.zeros(total + 1)
    cost[-1] = -1.0
    no_quadratic = csc_array((total + 1, total + 1))
    return ConicProgram(no_quadratic, cost, matrix, bound, balance.shape[0], positive + 2, sizes)


class LargestLoads:
    """Conic programs for the largest multiples of different wrenches that contacts balance.

    The programs differ in the last column, which is that of the multiple t.

    Notes
    -----
    The multipliers y of the first rows give the mechanism that starts at the limit: a motion in the
    dual cone for which the load at the limit has no power.
    """

    def __init__(self, cones: ConeProblem) -> None:
        self._problem = problem = cones.problem
        total = problem.matrix.shape[1]
        cone_matrix, positive, self._sizes = cones.cone_rows()
        balance, equal = cones.balance()
        self._matrix = vstack([balance, csc_array((1, total)), -cone_matrix], format="csc")
        self._bound = np.concatenate([problem.right, np.zeros(equal + 1), cones.heads])
        self._cost = np.append(np.zeros(total), -1.0)
        self._no_quadratic = csc_array((total + 1, total + 1))
        self._equal, self._positive = balance.shape[0], positive + 1

    def along(self, wrench: Array, most: float) -> ConicProgram:
        """Conic program for the largest multiple t <= `most` of extra wrenches.

        Arguments: `wrench` (N, 6): force [N] and torque about the centre of mass [N x length unit]
        on each part; `most`: upper bound of t [-].
        """
        column = -self._problem.scaled_load(wrench)
        rows = np.flatnonzero(column)
        base, last = self._matrix, self._equal
        data = np.concatenate([base.data, column[rows], [1.0]])
        index = np.concatenate([base.indices, rows, [last]])
        ends = np.append(base.indptr, len(data))
        matrix = csc_array((data, index, ends), shape=(base.shape[0], base.shape[1] + 1))
        bound = self._bound.copy()
        bound[last] = most
        return ConicProgram(
            self._no_quadratic, self._cost, matrix, bound, last, self._positive, self._sizes
        )


def nearest_load(cones: ConeProblem, wrenches: Array, start: Array) -> ConicProgram:
    """Conic program for the combination of wrenches nearest to `start` that contacts balance.

    The unknowns are x = (f, t).

    Arguments: `wrenches` (d, N, 6): wrenches that replace the load of the program; `start` (d,):
    desired coefficients [-].
    """
    problem = cones.problem
    total, count = problem.matrix.shape[1], len(start)
    cone_matrix, positive, sizes = cones.cone_rows()
    balance, _ = cones.balance(*[-problem.scaled_load(wrench) for wrench in wrenches])
    conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], count))])
    matrix = vstack([balance, conic], format="csc")
    diagonal = np.concatenate([np.zeros(total), np.ones(count)])
    cost = np.concatenate([np.zeros(total), -start])
    bound = np.concatenate([np.zeros(balance.shape[0]), cones.heads])
    quadratic = csc_array(diags_array(diagonal))
    return ConicProgram(quadratic, cost, matrix, bound, balance.shape[0], positive, sizes)


def least_forces(
    cones: ConeProblem, weights: Array | None = None, wanted: Array | None = None
) -> ConicProgram:
    """Conic program for the balanced contact forces with the least sum of squares.

    The solution is unique and not at a corner of the set of all equilibria: equal contacts carry
    equal shares. For a bonded contact the acting force f - T counts, without its pull T.

    Arguments: `weights`: weight of the square of each split row, 1 by default; `wanted` (K,): force
    of each row from which the squares count, the pull by default.
    """
    problem = cones.problem
    total = problem.matrix.shape[1]
    cone_matrix, positive, sizes = cones.cone_rows()
    balance, equal = cones.balance()
    matrix = vstack([balance, -cone_matrix], format="csc")
    bound = np.concatenate([problem.right, np.zeros(equal), cones.heads])
    weights = np.ones(total) if weights is None else weights
    wanted = cones.program.pull if wanted is None else wanted
    cost = np.zeros(total)
    cost[: len(wanted)] = -weights[: len(wanted)] * wanted / problem.unit
    return ConicProgram(
        csc_array(diags_array(weights)), cost, matrix, bound,
        balance.shape[0], positive, sizes,
    )  # fmt: skip


def least_strength(cones: ConeProblem, unit: float) -> ConicProgram:
    """Conic program for the least fraction of all bond strengths with which contacts balance.

    The unknowns are x = (f, s / unit). The program is well posed on both sides of s = 1, where the
    load factor jumps. For s < 1 the forces are within the strength. For s > 1 the multipliers give
    a motion whose power the bonds cannot absorb.
    """
    problem, program = cones.problem, cones.program
    total = problem.matrix.shape[1]
    cone_matrix, positive, sizes = cones.cone_rows()
    clamp = problem.scaled_load(program.clamp)
    balance, equal = cones.balance(-unit * clamp)
    lower_bound = csc_array((np.array([-1.0]), ([0], [total])), shape=(1, total + 1))
    conic = hstack([-cone_matrix, csc_array(-unit * cones.heads[:, None])])
    matrix = vstack([balance, lower_bound, conic], format="csc")
    bound = np.concatenate([problem.right - clamp, np.zeros(equal + 1 + cone_matrix.shape[0])])
    cost = np.append(np.zeros(total), 1.0)
    no_quadratic = csc_array((total + 1, total + 1))
    return ConicProgram(no_quadratic, cost, matrix, bound, balance.shape[0], positive + 1, sizes)


def least_cohesion(cones: ConeProblem) -> ConicProgram:
    """Conic program for the least cohesion c with which |f_t| <= mu f_n + c w allows balance.

    w is the weight of the lighter part at the contact. If c < 0, forces exist inside the cones with
    a margin that exceeds rounding. If c > 0, the multipliers of the first rows give a motion in the
    dual cones. Near a limit both results stay well posed, while the load factor jumps from 0 to 1.
    """
    problem, rough = cones.problem, cones.rough
    program, total = cones.program, problem.matrix.shape[1]
    cone_matrix, positive, sizes = cones.cone_rows()
    weight = np.append(np.where(program.free, program.weight, np.inf), np.inf)
    lighter = np.minimum(weight[program.part_a[rough]], weight[program.part_b[rough]])
    cohesion_heads = np.zeros(cone_matrix.shape[0])
    cohesion_heads[_cone_heads(positive, sizes)] = -lighter / problem.unit
    balance, equal = cones.balance(np.zeros(len(problem.right)))
    lower_bound = csc_array((np.array([-1.0]), ([0], [total])), shape=(1, total + 1))
    conic = hstack([-cone_matrix, csc_array(cohesion_heads[:, None])])
    matrix = vstack([balance, lower_bound, conic], format="csc")
    bound = np.concatenate([problem.right, np.zeros(equal), [1.0], cones.heads])
    cost = np.append(np.zeros(total), 1.0)
    no_quadratic = csc_array((total + 1, total + 1))
    return ConicProgram(no_quadratic, cost, matrix, bound, balance.shape[0], positive + 1, sizes)


def cohesion_slope(cones: ConeProblem, answer: Solution) -> float:
    """Decrease of the least cohesion per unit increase of all friction coefficients."""
    program = answer.problem
    assert isinstance(program, ConicProgram)
    heads = program.equal + _cone_heads(program.positive, program.cones)
    return float(answer.multipliers[heads] @ answer.x[cones.rough])


def _cone_heads(positive: int, sizes: Index) -> Index:
    """Index of the first entry of each friction cone; `positive` scalar rows precede the cones."""
    return positive + np.cumsum(sizes) - sizes


def pyramid(
    program: Program, sides: int = 8, *, outer: bool = False, angles: Array | None = None
) -> Program:
    """Replace each friction cone of a program by a pyramid: a row for each of its edge rays.

    Arguments: `angles` (R, n) [rad].

    Notes
    -----
    The rows of a ray keep the `source` of their contact; their `mu` is 0. The unit direction of a
    row is (n + mu t) over its length, and its force is along it.
    """
    rough = program.rough
    if not len(rough):
        return program
    directions = _directions(program, rough)
    if program.planar:
        around = np.stack([directions[:, 0], -directions[:, 0]], axis=1)
    else:
        if angles is None:
            angles = np.tile(2 * np.pi * np.arange(sides) / sides, (len(rough), 1))
        angle, stretch = _corner_angles(angles) if outer else (angles, np.ones(angles.shape))
        around = stretch[:, :, None] * (
            np.cos(angle)[:, :, None] * directions[:, :1]
            + np.sin(angle)[:, :, None] * directions[:, 1:]
        )
    rays = program.normal[rough][:, None] + program.mu[rough][:, None, None] * around
    rays = rays / np.linalg.norm(rays, axis=2)[:, :, None]
    smooth = np.flatnonzero(program.mu <= 0)
    rows = np.concatenate([smooth, np.repeat(rough, rays.shape[1])])
    normal = np.concatenate([program.normal[smooth], rays.reshape(-1, 3)])
    return program.taking(rows).with_rows(normal=normal, mu=np.zeros(len(rows)))


def _corner_angles(angles: Array) -> tuple[Array, Array]:
    """Angle [rad] and distance from the centre of each corner of a polygon of circle tangents."""
    tangent = np.sort(angles % (2 * np.pi), axis=1)
    half = (np.roll(tangent, -1, axis=1) - tangent) % (2 * np.pi) / 2
    return tangent + half, 1.0 / np.cos(half)


def angles_across(program: Program, across: Array) -> Array:
    """Angle of each tangential vector in the frame of its rough contact, shape (R,) [rad].

    Arguments: `across` (K, 3).
    """
    rough = program.rough
    directions = _directions(program, rough)
    along = np.einsum("ij,ikj->ik", across[rough], directions)
    angles: Array = np.arctan2(along[:, 1], along[:, 0])
    return angles


def pyramid_forces(program: Program, rays: Program, forces: Array) -> tuple[Array, Array]:
    """Normal and friction forces of the rows of `program`, from ray forces of its pyramids.

    Arguments: `forces` (rows of `rays`,). Returns `along` (K,); `across` (K, 3).
    """
    smooth, rough = np.flatnonzero(program.mu <= 0), program.rough
    along, across = np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
    along[smooth] = forces[: len(smooth)]
    if len(rough):
        ray_forces = forces[len(smooth) :, None] * rays.normal[len(smooth) :]
        total = ray_forces.reshape(len(rough), -1, 3).sum(axis=1)
        normal = program.normal[rough]
        along[rough] = np.einsum("ij,ij->i", total, normal)
        across[rough] = total - along[rough][:, None] * normal
    return along, across


# Newton correction of nearly balanced contact forces, so that only rounding errors remain.


REGULAR = 1e-14
"""Regularisation of the normal equations, relative to their largest diagonal entry; iterative
refinement removes its effect. A larger value is more robust on singular systems but needs more
refinement.
"""
REFINED = 8
"""Maximum number of refinement steps."""
SLOWEST = 0.5
"""Refinement ends if a step leaves more than this fraction of the previous imbalance [-]. A larger
value allows slower progress.
"""


def balanced_forces(cones: ConeProblem, forces: Array, friction: Array) -> tuple[Array, Array]:
    """Correct normal and friction forces to the nearest balanced forces, (K,) and (K, 3) [N].

    The result may leave the friction cones by as much as it changes, and it is not better balanced
    than the input if no forces on the pressed contacts balance. So check it with a certificate.

    Arguments: `forces`, `friction`: forces along and across the rows [N].

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.certificate import check_forces
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> near = np.full(4, program.weight[1] / 4) * (1 + 1e-6 * np.arange(4))
    >>> forces, friction = balanced_forces(cone_problem(program), near, np.zeros((4, 3)))
    >>> check_forces(program, near).residual > 1e-7
    True
    >>> check_forces(program, forces, friction).residual < 1e-14
    True
    """
    from scipy.sparse.linalg import splu  # slow to import

    problem, program, rough = cones.problem, cones.program, cones.rough
    tangential = np.einsum("rdi,ri->dr", cones.directions, friction[rough])
    x = np.concatenate([forces, tangential.ravel()]) / (problem.unit * problem.program.arm)
    # a two-sided row without force may take any: its weight must not vanish
    size = np.where(program.two_sided, np.abs(x[: len(forces)]) + 1.0, np.abs(x[: len(forces)]))
    friction_size = np.tile(program.mu[rough] * size[rough], len(tangential))
    weight = np.concatenate([size, friction_size]) ** 2
    matrix = problem.matrix
    normal = csc_array(matrix @ diags_array(weight) @ matrix.T)
    largest = float(normal.diagonal().max(initial=TINY))
    factor = splu(
        csc_array(normal + diags_array(np.full(normal.shape[0], REGULAR * largest))),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
    )
    residual = problem.right - matrix @ x
    for _ in range(REFINED):
        refined = x + weight * (matrix.T @ factor.solve(residual))
        new_residual = problem.right - matrix @ refined
        old_size, new_size = (
            float(np.abs(residual).max(initial=0.0)),
            float(np.abs(new_residual).max(initial=0.0)),
        )
        # refinement no longer helps: the system is singular, or rounding is reached
        if not new_size < old_size:
            break
        x, residual = refined, new_residual
        if new_size > SLOWEST * old_size:
            break
    return cones.decoded(x)
