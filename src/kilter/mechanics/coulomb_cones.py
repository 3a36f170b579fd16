"""Programs with Coulomb's cones: equilibrium with friction, exactly and by pyramids.

A contact with friction takes every force f_n n + f_t with |f_t| <= mu f_n. Its row n becomes
three, n, u, v, and a second-order cone (mu f_n, f_u, f_v); in a planar assembly two, and the
cone has two rays. Everything else is as in `kilter.mechanics.forms`: the same scaled
unknowns, the same load.

    load factor        max lambda:  A f = lambda b,  0 <= lambda <= 1,  f in K        0 or 1
    largest load       max t:  A f = b + t d,  t <= T,  f in K
    nearest load       min 1/2 |t - t0|^2:  A f = D t,  f in K
    least forces       min 1/2 |f|^2:  A f = b,  f in K          unique, inside the cones
    least strength     min s:  A f = b - (1 - s) c,  |f_t| <= mu f_n + s S,  s >= 0   s of all bonds
    least cohesion     min c:  A f = b,  |f_t| <= mu f_n + c w,  c >= -1     sign tells: held or not

A pyramid replaces each cone by rays, so that the program is linear: with rays on the cone it
is inner (its equilibrium is one), with sides that touch the cone it is outer (what moves in
it, moves).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array, hstack, vstack

from kilter.arrays import Array, Index, across, cross
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.solvers.solution import Solution

__all__ = [
    "ConeProblem",
    "angles_across",
    "cohesion_slope",
    "cone_problem",
    "largest_load",
    "least_cohesion",
    "least_forces",
    "least_strength",
    "load_factor_in_cones",
    "nearest_load",
    "pyramid",
    "pyramid_forces",
]


@dataclass(frozen=True, slots=True, eq=False)
class ConeProblem:
    """A program whose rows with friction are spread over n, u and v.

    Attributes
    ----------
    program : Program
        The one that was spread.
    problem : ScaledProblem
        Of the spread rows: those of `program`, then u of each rough row, then v (not planar).
    rough : ndarray of int, shape (R,)
    directions : ndarray, shape (R, d, 3)
        u and v, world frame; d = 1 where planar, else 2.
    """

    program: Program
    problem: ScaledProblem
    rough: Index
    directions: Array

    def decoded(self, columns: Array) -> tuple[Array, Array]:
        """Forces along the rows, shape (K,), and across them, (K, 3) [N], of scaled unknowns."""
        return self.gathered(self.problem.forces(columns))

    def gathered(self, values: Array) -> tuple[Array, Array]:
        """The same of forces of the spread rows [N]."""
        count, rough = len(self.program.part_a), len(self.rough)
        friction = np.zeros((count, 3))
        for k in range(self.directions.shape[1]):
            part = values[count + k * rough : count + (k + 1) * rough]
            friction[self.rough] += part[:, None] * self.directions[:, k]
        return values[:count], friction

    def turned(self, down: Array) -> ConeProblem:
        """The same with gravity, at its size, along `down`, shape (3,)."""
        program, wide = self.program.turned(down), self.problem.program.turned(down)
        right = self.problem.scaled_load(program.load)
        problem = replace(self.problem, program=wide, right=right)
        return replace(self, program=program, problem=problem)

    def cone_rows(self) -> tuple[csc_array, int, Index]:
        """G with G f + h in nonnegative numbers, then second-order cones; how many, of what size.

        h is `heads`.
        """
        program, total = self.program, self.problem.matrix.shape[1]
        count, rough = len(program.part_a), len(self.rough)
        alone = np.flatnonzero(~program.two_sided & (program.mu <= 0))
        size = 1 + self.directions.shape[1]
        columns = np.empty((rough, size), dtype=np.int64)
        values = np.ones((rough, size))
        columns[:, 0] = self.rough
        values[:, 0] = program.mu[self.rough]
        for k in range(1, size):
            columns[:, k] = count + (k - 1) * rough + np.arange(rough)
        index = np.concatenate([alone, columns.ravel()])
        data = np.concatenate([np.ones(len(alone)), values.ravel()])
        rows = np.arange(len(index))
        matrix = csc_array((data, (rows, index)), shape=(len(index), total))
        return matrix, len(alone), np.full(rough, size)

    @property
    def heads(self) -> Array:
        """What bonds add to the first entry of each cone, scaled, at the rows of G; else 0."""
        alone = int((~self.program.two_sided & (self.program.mu <= 0)).sum())
        size = 1 + self.directions.shape[1]
        heads = np.zeros(alone + size * len(self.rough))
        heads[alone::size] = self.program.cohesion[self.rough] / self.problem.unit
        return heads


def cone_problem(program: Program) -> ConeProblem:
    """The program with a row of its own for each direction of friction."""
    rough = program.gripping
    directions = _directions(program, rough)
    rows = np.concatenate([np.arange(len(program.part_a)), *[rough] * directions.shape[1]])
    aside = [directions[:, k] for k in range(directions.shape[1])]
    normal = np.concatenate([program.normal, *aside])
    nothing = {"mu": np.zeros(len(rows)), "shear": np.full(len(rows), np.nan)}
    wide = program.taking(rows).with_rows(normal=normal, **nothing)
    return ConeProblem(program, scaled_problem(wide), rough, directions)


def _directions(program: Program, rough: Index) -> Array:
    normal = program.normal[rough]
    if program.planar:
        return cross(np.array([0.0, 1.0, 0.0]), normal)[:, None, :]
    return np.stack(across(normal), axis=1)


def load_factor_in_cones(wide: ConeProblem) -> ConicProgram:
    """Largest part of the load that contacts with friction can hold: 0 or 1. x = (f, lambda).

    The multipliers y of its first rows give a motion in the dual cone where lambda is 0.
    """
    problem = wide.problem
    total = problem.matrix.shape[1]
    cone, positive, sizes = wide.cone_rows()
    balance = hstack([problem.matrix, csc_array(-problem.right[:, None])])
    ends = csc_array((np.array([-1.0, 1.0]), ([0, 1], [total, total])), shape=(2, total + 1))
    inside = hstack([-cone, csc_array(-wide.heads[:, None])])
    matrix = vstack([balance, ends, inside], format="csc")
    bound = np.concatenate([np.zeros(len(problem.right)), [0.0, 1.0], np.zeros(cone.shape[0])])
    cost = np.zeros(total + 1)
    cost[-1] = -1.0
    nothing = csc_array((total + 1, total + 1))
    return ConicProgram(nothing, cost, matrix, bound, len(problem.right), positive + 2, sizes)


def largest_load(wide: ConeProblem, wrench: Array, most: float) -> ConicProgram:
    """The largest share t, up to `most`, of further wrenches that contacts hold. x = (f, t).

    Parameters
    ----------
    wrench : ndarray, shape (N, 6)
        Force [N] and torque about the centre of mass [N x length unit] on each part.

    Notes
    -----
    The multipliers y of its first rows give the mechanism that starts at the limit: a motion
    in the dual cone, without power of all loads at the limit.
    """
    problem = wide.problem
    total = problem.matrix.shape[1]
    cone, positive, sizes = wide.cone_rows()
    along = problem.scaled_load(wrench)
    balance = hstack([problem.matrix, csc_array(-along[:, None])])
    end = csc_array((np.array([1.0]), ([0], [total])), shape=(1, total + 1))
    inside = hstack([-cone, csc_array((cone.shape[0], 1))])
    matrix = vstack([balance, end, inside], format="csc")
    bound = np.concatenate([problem.right, [most], wide.heads])
    cost = np.zeros(total + 1)
    cost[-1] = -1.0
    nothing = csc_array((total + 1, total + 1))
    return ConicProgram(nothing, cost, matrix, bound, len(problem.right), positive + 1, sizes)


def nearest_load(wide: ConeProblem, wrenches: Array, start: Array) -> ConicProgram:
    """Shares t nearest to `start` of some wrenches with which contacts are in balance. x = (f, t).

    Parameters
    ----------
    wrenches : ndarray, shape (d, N, 6)
        They replace the load of the program.
    start : ndarray, shape (d,)
    """
    problem = wide.problem
    total, count = problem.matrix.shape[1], len(start)
    cone, positive, sizes = wide.cone_rows()
    columns = np.column_stack([problem.scaled_load(wrench) for wrench in wrenches])
    balance = hstack([problem.matrix, csc_array(-columns)])
    inside = hstack([-cone, csc_array((cone.shape[0], count))])
    matrix = vstack([balance, inside], format="csc")
    diagonal = np.concatenate([np.zeros(total), np.ones(count)])
    cost = np.concatenate([np.zeros(total), -start])
    bound = np.concatenate([np.zeros(len(problem.right)), wide.heads])
    quadratic = csc_array(diags_array(diagonal))
    return ConicProgram(quadratic, cost, matrix, bound, len(problem.right), positive, sizes)


def least_forces(wide: ConeProblem) -> ConicProgram:
    """Forces of the least sum of squares that balance. x = f.

    Unique, and not at a corner of the set of all equilibria: equal contacts take equal shares.
    Of a bonded contact it is the square of what acts, which is less than f by its pull.
    """
    problem = wide.problem
    total = problem.matrix.shape[1]
    cone, positive, sizes = wide.cone_rows()
    matrix = vstack([problem.matrix, -cone], format="csc")
    bound = np.concatenate([problem.right, wide.heads])
    cost = np.zeros(total)
    cost[: len(wide.program.pull)] = -wide.program.pull / problem.unit
    return ConicProgram(
        csc_array(eye_array(total)), cost, matrix, bound,
        len(problem.right), positive, sizes,
    )  # fmt: skip


def least_strength(wide: ConeProblem, unit: float) -> ConicProgram:
    """The least share s of the strength of all bonds with which contacts balance. x = (f, s/unit).

    Well posed on both sides of 1, where the load factor jumps: forces at a share below 1 are
    within the strength, and where s is above 1 the multipliers give a motion whose power the
    bonds do not take up.
    """
    problem, program = wide.problem, wide.program
    total = problem.matrix.shape[1]
    cone, positive, sizes = wide.cone_rows()
    clamp = problem.scaled_load(program.clamp)
    balance = hstack([problem.matrix, csc_array(-unit * clamp[:, None])])
    end = csc_array((np.array([-1.0]), ([0], [total])), shape=(1, total + 1))
    inside = hstack([-cone, csc_array(-unit * wide.heads[:, None])])
    matrix = vstack([balance, end, inside], format="csc")
    bound = np.concatenate([problem.right - clamp, np.zeros(1 + cone.shape[0])])
    cost = np.append(np.zeros(total), 1.0)
    nothing = csc_array((total + 1, total + 1))
    return ConicProgram(nothing, cost, matrix, bound, len(problem.right), positive + 1, sizes)


def least_cohesion(wide: ConeProblem) -> ConicProgram:
    """The least cohesion c with which contacts balance: |f_t| <= mu f_n + c w. x = (f, c).

    w is the weight of the lighter part that a contact touches. Below 0 there are forces within
    the cones, by so much that rounding does not count; above 0 the multipliers of the first rows
    give a motion in the dual cones. Near a limit both stay well posed where the load factor,
    which jumps from 0 to 1 there, does not.
    """
    problem, rough = wide.problem, wide.rough
    program, total = wide.program, problem.matrix.shape[1]
    cone, positive, sizes = wide.cone_rows()
    weight = np.append(np.where(program.free, program.weight, np.inf), np.inf)
    lighter = np.minimum(weight[program.part_a[rough]], weight[program.part_b[rough]])
    coheres = np.zeros(cone.shape[0])
    coheres[_heads(positive, sizes)] = -lighter / problem.unit
    balance = hstack([problem.matrix, csc_array((len(problem.right), 1))])
    end = csc_array((np.array([-1.0]), ([0], [total])), shape=(1, total + 1))
    inside = hstack([-cone, csc_array(coheres[:, None])])
    matrix = vstack([balance, end, inside], format="csc")
    bound = np.concatenate([problem.right, [1.0], wide.heads])
    cost = np.append(np.zeros(total), 1.0)
    nothing = csc_array((total + 1, total + 1))
    return ConicProgram(nothing, cost, matrix, bound, len(problem.right), positive + 1, sizes)


def cohesion_slope(wide: ConeProblem, answer: Solution) -> float:
    """By how much the least cohesion falls where every coefficient rises, to first order."""
    program = answer.problem
    assert isinstance(program, ConicProgram)
    heads = program.equal + _heads(program.positive, program.cones)
    return float(answer.multipliers[heads] @ answer.x[wide.rough])


def _heads(positive: int, sizes: Index) -> Index:
    """Rows of the first entry of each cone, after `positive` rows."""
    return positive + np.cumsum(sizes) - sizes


def pyramid(
    program: Program, sides: int = 8, *, outer: bool = False, angles: Array | None = None
) -> Program:
    """The program with every cone of friction replaced by rays, one row a ray.

    Parameters
    ----------
    sides : int
        Rays of each pyramid; a planar cone has two, whatever is asked for.
    outer : bool
        The sides of the pyramid touch the cone, else its rays lie on it.
    angles : ndarray, shape (R, n), optional
        Where rays lie on each cone, or sides touch it, in place of even `sides`: from the
        first direction across the contact to the second [rad]. No gap may be a half turn.

    Notes
    -----
    Rows of a ray keep the `source` of their contact; `mu` is 0. A row's unit direction is
    (n + mu t) over its length, its force is along it.
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
        angle, stretch = _between_sides(angles) if outer else (angles, np.ones(angles.shape))
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


def _between_sides(angles: Array) -> tuple[Array, Array]:
    """Angles [rad] at which neighbouring sides that touch a circle meet, and how far out."""
    first = np.sort(angles % (2 * np.pi), axis=1)
    half = (np.roll(first, -1, axis=1) - first) % (2 * np.pi) / 2
    return first + half, 1.0 / np.cos(half)


def angles_across(program: Program, across: Array) -> Array:
    """Angles of vectors across the rough contacts as `pyramid` counts them, shape (R,) [rad].

    Parameters
    ----------
    across : ndarray, shape (K, 3)
        Such as forces of friction, or slips; 0 for a vector of length 0.
    """
    rough = program.rough
    directions = _directions(program, rough)
    along = np.einsum("ij,ikj->ik", across[rough], directions)
    angles: Array = np.arctan2(along[:, 1], along[:, 0])
    return angles


def pyramid_forces(program: Program, rays: Program, forces: Array) -> tuple[Array, Array]:
    """Forces of a pyramid's rays as forces along the rows of `program`, and across them.

    Parameters
    ----------
    rays : Program
        ``pyramid(program, sides)``.
    forces : ndarray, shape (rows of `rays`,)

    Returns
    -------
    along : ndarray, shape (K,)
    across : ndarray, shape (K, 3)
    """
    smooth, rough = np.flatnonzero(program.mu <= 0), program.rough
    along, across = np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
    along[smooth] = forces[: len(smooth)]
    if len(rough):
        pushed = forces[len(smooth) :, None] * rays.normal[len(smooth) :]
        total = pushed.reshape(len(rough), -1, 3).sum(axis=1)
        normal = program.normal[rough]
        along[rough] = np.einsum("ij,ij->i", total, normal)
        across[rough] = total - along[rough][:, None] * normal
    return along, across
