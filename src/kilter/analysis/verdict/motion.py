"""Impending motion: how the parts start to move, by Gauss's principle of least constraint.

    min 1/2 (a - M^-1 w)^T M (a - M^-1 w),   J a >= 0

Among all accelerations that the contacts allow, the true accelerations are nearest to those of free
fall, in the metric of the masses and inertia tensors. They are unique, and zero exactly
if the assembly is stable. LP (9) only proves that parts move, not how (the paper, 2.2).

    kappa = |a|_M / (|g| sqrt(sum m_i))          0 = stable, 1 = everything in free fall

With friction they obey Coulomb's law and need not be unique; if no exact solution is
reached, the nearest one is given, with its residual in the law.

References
----------
C. F. Gauss, Über ein neues allgemeines Grundgesetz der Mechanik, 1829. D. Baraff,
Analytical methods for dynamic simulation of non-penetrating rigid bodies, 1989.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.analysis_tolerances import (
    MOTION_ASKED,
    MOTION_ENOUGH,
    MOTION_GOOD,
    MOVES,
    ZERO_MOTION,
)
from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.gauss import LeastConstraint, least_constraint, mirror_half
from kilter.mechanics.program import Program
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.projection import solve_projection
from kilter.units import metres_per_unit

__all__ = [
    "NO_MOTION",
    "UNKNOWN_MOTION",
    "ImpendingMotion",
    "find_motion",
    "find_motion_with_friction",
    "motion_of",
    "optimality",
    "still",
    "unknown",
]


SMALL = 400
"""Unknowns up to which Clarabel is asked first."""
MANY = 8000
"""Unknowns, about 1,300 parts, above which accelerations are asked for to fewer digits."""


NO_MOTION = (
    "no solver finished the program of the impending motion: accelerations and kappa are left out"
)
UNKNOWN_MOTION = {True: "moves in an unknown way", False: "is not known to move"}
"""Of a part where no solver finished, by whether a proof has it moving."""


@dataclass(frozen=True, slots=True, eq=False)
class ImpendingMotion:
    """Initial accelerations.

    Attributes
    ----------
    acceleration : ndarray, shape (N, 6)
        Linear [m/s^2] and angular [rad/s^2].
    relative : ndarray, shape (N, 2)
        Linear, and radius x angular, acceleration over that of gravity [-].
    moves : ndarray of bool, shape (N,)
    instability : float
        kappa [-].
    residual : float
        Of the optimality conditions, as `optimality` finds it, in units of g, or in Coulomb's
        law [-]; infinite if no solver finished: accelerations are 0 then, and mean nothing.
    """

    acceleration: Array
    relative: Array
    moves: Mask
    instability: float
    residual: float

    @property
    def known(self) -> bool:
        """Whether a solver finished; else `moves` are the parts that move in the proof, if any."""
        return bool(np.isfinite(self.residual))


def find_motion(program: Program) -> ImpendingMotion:
    """The initial accelerations of all parts; not `known` if every solver fails.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("floating-block")
    >>> motion = find_motion(build_program(assembly, contacts(assembly)))
    >>> np.round(motion.acceleration[motion.moves][0, :3], 6) + 0.0
    array([ 0.  ,  0.  , -9.81])
    """
    if not program.free.any():
        return still(program)
    found = _least_constrained(program)
    if found is None:
        return unknown(program)
    motion, residual = found
    motion = np.where(np.abs(motion) < ZERO_MOTION, 0.0, motion)
    acceleration = motion * program.g
    acceleration[:, 3:] /= metres_per_unit(program.units)
    return motion_of(program, acceleration, residual)


def motion_of(program: Program, acceleration: Array, residual: float) -> ImpendingMotion:
    """Given accelerations as an impending motion.

    Parameters
    ----------
    program : Program
    acceleration : ndarray, shape (N, 6)
        Linear [m/s^2] and angular [rad/s^2].
    residual : float
        In the conditions that they are to meet [-].
    """
    motion = acceleration / max(program.g, TINY)
    motion[:, 3:] *= metres_per_unit(program.units)
    sizes = np.linalg.norm(motion.reshape(-1, 2, 3), axis=2)
    sizes[:, 1] *= program.radius
    energy = program.mass @ (motion[:, :3] ** 2).sum(axis=1) + np.einsum(
        "ni,nij,nj->", motion[:, 3:], program.inertia, motion[:, 3:]
    )
    free_mass = float(program.mass[program.free].sum())
    kappa = min(float(np.sqrt(max(energy, 0.0) / max(free_mass, TINY))), 1.0)
    moves = np.asarray((sizes > MOVES).any(axis=1))
    return ImpendingMotion(acceleration, sizes, moves, kappa, residual)


def find_motion_with_friction(program: Program, effort: float) -> ImpendingMotion | None:
    """The initial motion if no forces of equilibrium exist; None if it was not reached.

    Parameters
    ----------
    effort : float
        Of the search.
    """
    from kilter.friction.motion_search import find_coulomb_motion  # takes its time

    found = find_coulomb_motion(program, work=effort, nearest=True)
    if found is None:
        return None
    return motion_of(program, found.acceleration, found.law.residual)


def _least_constrained(program: Program) -> tuple[Array, float] | None:
    """The motion over the size of gravity, shape (N, 6), and its residual; None: all failed.

    A small program by Clarabel first; any whose conditions are then not met to `MOTION_GOOD` by the
    interior point of `kilter.solvers.projection`, within a plane of reflection if
    there is such a plane. The best by the residual, which is recomputed from the rows.
    """
    from kilter.solvers.clarabel import solve_quadratic

    problem = scaled_problem(program)
    whole = least_constraint(problem)
    found: list[tuple[Array, float]] = []

    def tried(one: LeastConstraint, unknowns: Array, multipliers: Array) -> float:
        motion = problem.motion(one.accelerations(unknowns))
        with np.errstate(over="ignore", invalid="ignore"):  # forces beyond all numbers meet nothing
            residual = optimality(program, motion, one.forces(multipliers) * _heaviest(program))
        residual = np.inf if np.isnan(residual) else residual
        found.append((motion, residual))
        return residual

    if len(whole.cone.load) <= SMALL:
        answer = solve_quadratic(whole.cone.conic)
        if answer.found and tried(whole, answer.x, answer.multipliers) <= MOTION_GOOD:
            return found[-1]
    many = len(whole.cone.load) > MANY
    smaller = mirror_half(whole, problem)
    for one in (whole,) if smaller is None else (smaller, whole):
        try:
            solution = solve_projection(one.cone, enough=MOTION_ASKED if many else 0.0)
        except NotPositive:  # a matrix that is singular to rounding
            continue
        good = MOTION_ENOUGH if many else MOTION_GOOD
        if tried(one, solution.unknowns, solution.multipliers) <= good:
            return found[-1]
    if not found:  # singular, whole and halved: the other method, whatever the size
        answer = solve_quadratic(whole.cone.conic)
        if not answer.found:
            return None
        tried(whole, answer.x, answer.multipliers)
    return min(found, key=lambda pair: pair[1])


def optimality(
    program: Program, motion: Array, forces: Array, friction: Array | None = None
) -> float:
    """Worst residual of the conditions of the true motion, in units of g.

        M a = w + J^T f,   J a >= 0,   f >= 0,   f . J a = 0

    each part's over its own weight (and loads), each row's over the lightest part it touches,
    torques over the radius too.

    Parameters
    ----------
    motion : ndarray, shape (N, 6)
        Accelerations over the size of gravity.
    forces : ndarray, shape (K,)
        Of the rows [N].
    friction : ndarray, shape (K, 3), optional
        Across the rows [N].
    """
    gravity = program.g
    rest = -program.wrenches(forces, friction) - program.load
    rest[:, :3] += program.mass[:, None] * motion[:, :3] * gravity
    rest[:, 3:] += np.einsum("nij,nj->ni", program.inertia, motion[:, 3:]) * gravity
    rest[:, 3:] /= program.radius[:, None]
    rest = (rest / program.weight[:, None])[np.ix_(program.free, program.freedoms)]
    heavy = np.append(np.where(program.free, program.mass, np.inf), np.inf)
    light = np.where(heavy[program.part_a] < heavy[program.part_b], program.part_a, program.part_b)
    length = np.where(program.angular, program.radius[light], 1.0)
    size = program.weight[light] / (program.mass[light] * gravity)
    slack = program.velocities(motion) * length / size
    push = forces / (program.weight[light] * length)
    one = ~program.two_sided
    worst = (
        np.abs(rest),
        np.abs(slack[~one]),
        np.maximum(-slack[one], 0.0),
        np.maximum(-push[one], 0.0),
        np.minimum(np.abs(slack[one]), np.abs(push[one])),
    )
    return float(max(part.max(initial=0.0) for part in worst))


def _heaviest(program: Program) -> float:
    return float(program.mass[program.free].max() * program.g)


def still(program: Program) -> ImpendingMotion:
    """The motion of an assembly that is stable: none."""
    count = len(program.names)
    return ImpendingMotion(
        np.zeros((count, 6)), np.zeros((count, 2)), np.zeros(count, dtype=bool), 0.0, 0.0
    )


def unknown(program: Program, proof: ForceProof | MotionProof | None = None) -> ImpendingMotion:
    """The motion if no solver finished: only the parts that move in a proof."""
    motion = still(program)
    moves = motion.moves
    if isinstance(proof, MotionProof) and proof.holds:
        sizes = part_sizes(program, proof.motion, per_radius=False)
        moves = program.free & (sizes > MOVES * float(sizes.max(initial=0.0)))
    return replace(motion, moves=moves, instability=np.nan, residual=np.inf)
