"""Impending motion: accelerations of the parts from rest, by Gauss's least constraint.

    min 1/2 (a - M^-1 w)^T M (a - M^-1 w),   J a >= 0

Among all accelerations that the contacts allow, the true accelerations are nearest to free fall,
in the metric of the masses and inertia tensors. They are unique. They are zero if and only if the
assembly is stable. The displacement program only decides whether parts move, not how they move
(section 2.2 of the paper).

    kappa = |a|_M / (|g| sqrt(sum m_i))          0 = stable, 1 = everything in free fall

With friction, the accelerations obey Coulomb's law and need not be unique. If the search finds
none, no accelerations are shown: only the motion of the proof is known, which gains energy.

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
    STATED_MOST,
    ZERO_MOTION,
)
from kilter.arrays import TINY, Array, Mask
from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.clusters import (
    PARTED,
    cluster_groups,
    clusters,
    different_clusters,
    first_groups,
    upright_frames,
)
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.gauss import LeastConstraint, least_constraint, mirror_half
from kilter.mechanics.program import Program
from kilter.shape.primitives import Cylinder, Sphere
from kilter.shape.solid import Solid
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.projection import solve_projection
from kilter.tell.numbers import number
from kilter.tell.words import RoundMantle
from kilter.units import metres_per_unit
from kilter.work import Work, units_of

SMALL = 400
"""Largest number of unknowns for which Clarabel is tried first."""
MORE_WORK = 3.0
"""Work to find the motion of an unstable assembly, over that of an effort: the search for a motion
is all that is left to do. In a wall of 28 bricks it takes 1.5 s."""
MANY = 8000
"""Programs with more unknowns than this, about 1,300 parts, are solved to fewer digits."""


NO_MOTION = (
    "no solver finished the program of the impending motion: accelerations and kappa are left out"
)
NO_MOTION_BY_LAW = (
    "no motion that obeys the law of friction was found: accelerations and kappa are left out"
)
NO_MOTION_OF_LIMITS = (
    "the motion in which straps or the friction of joints give way, or bonds slip, is "
    "not modelled: accelerations and kappa are left out"
)
UNKNOWN_MOTION = {True: "moves in an unknown way", False: "is not known to move"}
"""Words for a part if no solver finished, by whether a proof shows that the part moves."""


@dataclass(frozen=True, slots=True, eq=False)
class ImpendingMotion:
    """Accelerations with which all parts start to move from rest.

    Attributes
    ----------
    acceleration : ndarray, shape (N, 6)
        Linear [m/s^2] and angular [rad/s^2] accelerations, world frame.
    relative : ndarray, shape (N, 2)
        Sizes of the linear, and of radius x angular, acceleration over that of gravity [-].
    moves : ndarray of bool, shape (N,)
        Whether either relative size exceeds `MOVES`.
    instability : float
        kappa [-].
    residual : float
        Residual of the optimality conditions by `optimality` [g], or of Coulomb's law [-].
        Infinite if no solver finished; the accelerations are then 0 and have no meaning.
    gains : ndarray, shape (N, 6), or None
        If the accelerations are not known, the motion of the proof: translations [length unit] and
        rotations [rad] of any common size, which gain energy. None if there is no such proof.
    """

    acceleration: Array
    relative: Array
    moves: Mask
    instability: float
    residual: float
    gains: Array | None = None

    @property
    def known(self) -> bool:
        """Whether a solver computed the motion; if not, `moves` marks parts that a proof moves."""
        return bool(np.isfinite(self.residual))

    def screws(self, metres: float) -> Array:
        """Screw of each moving part, shape (N, 6), all of a common size: for pictures and films.

        Shift of the centre of mass in length units of `metres` [m], and rotation; of the motion of
        the proof if the accelerations are not known. 0 for other parts.
        """
        shown = self.acceleration / np.repeat([metres, 1.0], 3) if self.known else self.gains
        return np.where(self.moves[:, None], 0.0 if shown is None else shown, 0.0)


def falls_freely(motion: ImpendingMotion, gravity: Array) -> Mask:
    """Mask of the parts that start to fall with gravity and without a turn, shape (N,).

    Arguments: `gravity` (3,) [m/s^2]. No part is known to fall freely in a motion that is unknown.
    """
    if not motion.known:
        return np.zeros(len(motion.moves), dtype=bool)
    off = np.linalg.norm(motion.acceleration[:, :3] - gravity, axis=1)
    free: Mask = off <= MOVES * np.linalg.norm(gravity)
    return free & (motion.relative[:, 1] <= MOVES)


def find_motion(program: Program) -> ImpendingMotion:
    """Compute the accelerations of all parts from rest, without friction.

    If every solver fails, the result is not `known`.

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
    solution = _least_constraint_motion(program)
    if solution is None:
        return unknown(program)
    motion, residual = solution
    motion = np.where(np.abs(motion) < ZERO_MOTION, 0.0, motion)
    acceleration = motion * program.g
    acceleration[:, 3:] /= metres_per_unit(program.units)
    return motion_of(program, acceleration, residual)


def motion_of(program: Program, acceleration: Array, residual: float) -> ImpendingMotion:
    """Create an impending motion from accelerations, with moving parts and instability kappa.

    Arguments: `acceleration` (N, 6): linear [m/s^2] and angular [rad/s^2] accelerations;
    `residual`: residual of the conditions that the accelerations must satisfy [-].
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
    """Compute accelerations from rest with Coulomb friction, if no equilibrium exists.

    Returns None if the search finds no motion that obeys the law.
    """
    from kilter.friction.motion_search import find_coulomb_motion  # the import is slow

    work = MORE_WORK * units_of(effort)
    solution = find_coulomb_motion(program, work=Work(work), impending=True)
    if solution is None:
        return None
    return motion_of(program, solution.acceleration, solution.law.residual)


def _least_constraint_motion(program: Program) -> tuple[Array, float] | None:
    """Accelerations of least constraint over g, (N, 6), and their residual; None if solvers fail.

    Parts of a large program that do not touch move independently. Clusters that are equal up to a
    shift and a turn about the vertical move equally.
    """
    freedoms = len(program.freedoms) * int(program.free.sum())
    parted = clusters(program) if freedoms > PARTED and not program.has_limits else []
    if len(parted) < 2:
        return _motion_of_group(program)
    frames = upright_frames(parted)
    first = different_clusters(parted, frames)
    motion, worst = np.zeros((len(program.names), 6)), 0.0
    for group in first_groups(program, parted, first):
        solution = _motion_of_group(group)
        if solution is None:
            return None
        motion[group.free], worst = solution[0][group.free], max(worst, solution[1])
    for k, (cluster, source) in enumerate(zip(parted, first.tolist(), strict=True)):
        if source < k:
            turn = frames[k].T @ frames[source]
            copied = motion[parted[source].program.free].reshape(-1, 2, 3) @ turn.T
            motion[cluster.program.free] = copied.reshape(-1, 6)
    return motion, worst


def _motion_of_group(program: Program) -> tuple[Array, float] | None:
    """The motion of `_least_constraint_motion`, of all parts together.

    Clarabel solves a small program first. If the residual exceeds `MOTION_GOOD`, the interior
    point of `kilter.solvers.projection` follows, first on half of a symmetric assembly. The result
    is the solution with the least residual, which is recomputed from the rows.
    """
    from kilter.solvers.clarabel import solve_quadratic

    problem = scaled_problem(program)
    try:
        whole = least_constraint(problem)
    except np.linalg.LinAlgError:  # the inertia of a damaged body is not positive
        return None
    solutions: list[tuple[Array, float]] = []

    def add(form: LeastConstraint, unknowns: Array, multipliers: Array) -> float:
        """Store a solution of a solver and return its residual."""
        motion = problem.motion(form.accelerations(unknowns))
        with np.errstate(over="ignore", invalid="ignore"):  # overflowing forces: residual infinite
            residual = optimality(program, motion, form.forces(multipliers) * _heaviest(program))
        residual = np.inf if np.isnan(residual) else residual
        solutions.append((motion, residual))
        return residual

    if len(whole.cone.load) <= SMALL:
        answer = solve_quadratic(whole.cone.conic)
        if answer.found and add(whole, answer.x, answer.multipliers) <= MOTION_GOOD:
            return solutions[-1]
    many = len(whole.cone.load) > MANY
    smaller = mirror_half(whole, problem)
    for form in (whole,) if smaller is None else (smaller, whole):
        try:
            solution = solve_projection(form.cone, enough=MOTION_ASKED if many else 0.0)
        except NotPositive:  # the matrix is singular up to rounding
            continue
        good = MOTION_ENOUGH if many else MOTION_GOOD
        if add(form, solution.unknowns, solution.multipliers) <= good:
            return solutions[-1]
    if not solutions:  # both forms are singular: use Clarabel for every size
        answer = solve_quadratic(whole.cone.conic)
        if not answer.found:
            return None
        add(whole, answer.x, answer.multipliers)
    return min(solutions, key=lambda pair: pair[1])


def optimality(
    program: Program, motion: Array, forces: Array, friction: Array | None = None
) -> float:
    """Largest residual of the optimality conditions of an impending motion, in [g].

        M a = w + J^T f,   J a >= 0,   f >= 0,   f . J a = 0

    The residual of a part is relative to its weight, including loads. The residual of a row is
    relative to the lighter part that it touches. Torques are divided by the radius, too.

    Arguments: `motion` (N, 6): accelerations over the size of gravity; `forces` (K,): forces along
    the rows [N]; `friction` (K, 3): forces across the rows [N].
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
    unilateral = ~program.two_sided
    worst = (
        np.abs(rest),
        np.abs(slack[~unilateral]),
        np.maximum(-slack[unilateral], 0.0),
        np.maximum(-push[unilateral], 0.0),
        np.minimum(np.abs(slack[unilateral]), np.abs(push[unilateral])),
    )
    return float(max(part.max(initial=0.0) for part in worst))


def _heaviest(program: Program) -> float:
    """Weight m g of the heaviest free part [N]."""
    return float(program.mass[program.free].max() * program.g)


def still(program: Program) -> ImpendingMotion:
    """The impending motion of an assembly that stays: all accelerations are 0."""
    count = len(program.names)
    return ImpendingMotion(
        np.zeros((count, 6)), np.zeros((count, 2)), np.zeros(count, dtype=bool), 0.0, 0.0
    )


def unknown(program: Program, proof: ForceProof | MotionProof | None = None) -> ImpendingMotion:
    """The motion if none was found: marks the parts that a proof moves, and has its motion."""
    motion = still(program)
    moves, gains = motion.moves, None
    if isinstance(proof, MotionProof) and proof.holds:
        sizes = part_sizes(program, proof.motion, per_radius=False)
        moves = program.free & (sizes > MOVES * float(sizes.max(initial=0.0)))
        gains = np.where(moves[:, None], proof.motion, 0.0)
    return replace(motion, moves=moves, instability=np.nan, residual=np.inf, gains=gains)


def without_opening(program: Program, motion: Array, part: int) -> Array:
    """Motion of a part, shape (6,), without the opening of contacts that slide in a proof.

    In a proof with friction, a contact that slides by u_t opens by mu |u_t|, as no real part does.
    The opening of a part that only shifts, over contacts with one normal, is taken away.

    Arguments: `motion` (N, 6): motion of all parts that proves that they fall.
    """
    touching = (program.part_a[program.rough] == part) | (program.part_b[program.rough] == part)
    rows, moved = program.rough[touching], np.array(motion[part])
    shift, turn = np.linalg.norm(moved.reshape(2, 3), axis=1) * [1, program.radius[part]]
    if turn > MOVES * shift or not len(rows):
        return moved
    slip = np.linalg.norm(program.slips(motion, rows), axis=1)
    opening = program.velocities(motion)[rows]
    dilates = np.abs(opening - program.mu[rows] * slip) <= MOVES * slip.max(initial=0.0)
    outward = np.where(program.part_b[rows] == part, 1.0, -1.0)[:, None] * program.normal[rows]
    if dilates.all() and np.abs(outward - outward[0]).max() <= MOVES:
        moved[:3] -= float(opening.mean()) * outward[0]
    return moved


def round_mantle(part: Part) -> RoundMantle | None:
    """Surface on which a sphere or a cylinder rolls; None for other shapes."""
    if isinstance(part.shape, Sphere):
        return RoundMantle(part.pose.position, None, part.shape.radius)
    if isinstance(part.shape, Cylinder):
        return RoundMantle(part.pose.position, part.pose.matrix[:, 2], part.shape.radius)
    return None


# Decide whether inaccurate coordinates, as the input states them, explain a proved motion.


def explained_by_accuracy(
    assembly: Assembly, contacts: ContactSet, program: Program, proved: Array | None = None
) -> str:
    """Explain how inaccurate coordinates may cause a proved motion; empty if they cannot cause it.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Program of all parts against which a motion is proved.
    proved : ndarray, shape (N, 6), optional
        This motion. If it is too fast to be explained, no accelerations are computed.
    """
    off = stated_accuracy(assembly)
    # the bounds above compare accelerations with weights alone, so loads and bonds are left out
    if not off.any() or assembly.loads or assembly.straps or len(program.gripping):
        return ""
    aside, width = _inaccuracy_and_width(contacts, off)
    if proved is not None and _too_fast(program, proved, aside / width, aside):
        return ""
    speed = np.zeros(len(off))
    for group in cluster_groups(program):
        motion = find_motion(group.program)
        if not motion.known:  # the solver failed: the assembly is unstable as drawn
            return ""
        force, lever = _net_force_and_torque(group.program, motion.acceleration)
        if (force * width > aside).any() or (lever > aside).any():
            return ""
        speed = np.maximum(speed, motion.relative.max(axis=1))
    fastest = assembly.names[int(speed.argmax())]
    stated = f"{number(float(off.max()), 3)} {assembly.units}"
    return (
        f"the coordinates are not accurate enough to decide: as drawn {fastest!r} starts to move, "
        f"but it would hold if points moved by {stated}, which is the accuracy that the file states"
    )


def _too_fast(program: Program, motion: Array, force: Array, lever: Array) -> bool:
    """Whether an admissible motion proves that parts accelerate more than inaccuracy explains.

    In the norm of the kinetic energy, the accelerations a of least constraint satisfy
    |a| >= g . y / |y| for each admissible motion y. Net forces over weight `force` [-], shape (N,),
    and torques over weight `lever` [length unit], (N,), bound |a| from above. As y is admissible
    only to within rounding, twice this bound is required.
    """
    free = program.free
    mass, inertia, moved = program.mass[free], program.inertia[free], motion[free]
    shift, turn = moved[:, :3], moved[:, 3:]
    energy = float(mass @ (shift**2).sum(axis=1) + np.einsum("ni,nij,nj->", turn, inertia, turn))
    power = float(mass @ (shift @ program.down))
    least = np.maximum(np.linalg.eigvalsh(inertia)[:, 0], TINY)
    most = float(mass @ force[free] ** 2 + ((mass * lever[free]) ** 2 / least).sum())
    return power > 0 and power**2 > 4.0 * most * energy


def stated_accuracy(assembly: Assembly) -> Array:
    """Stated inaccuracy of the points of each part, shape (N,) [length unit]; 0 if not stated."""
    shapes = (part.shape for part in assembly.parts)
    return np.array([shape.uncertainty if isinstance(shape, Solid) else 0.0 for shape in shapes])


def _net_force_and_torque(program: Program, acceleration: Array) -> tuple[Array, Array]:
    """Net force over weight [-] and net torque over weight [length unit] of each part, both (N,).

    Both result from the given accelerations.
    """
    force = np.linalg.norm(acceleration[:, :3], axis=1) / program.g
    torque = np.einsum("nij,nj->ni", program.inertia, acceleration[:, 3:])
    lever = np.linalg.norm(torque, axis=1) / (program.mass * program.g)
    return force, lever * metres_per_unit(program.units)


def _inaccuracy_and_width(contacts: ContactSet, off: Array) -> tuple[Array, Array]:
    """Inaccuracy of the contact points, and least width of the contacts, of each part, (N,).

    Both are in length units.

    A part without contacts has inaccuracy 0. Its size replaces an unknown width.
    """
    geometry, parts = contacts.assembly.geometry, contacts.patch_parts
    both = np.minimum(off[parts].sum(axis=1)[:, None], STATED_MOST * geometry.size[parts])
    aside, width = np.zeros(len(off)), np.full(len(off), np.inf)
    np.maximum.at(aside, parts, both)
    known = contacts.patch_accuracy > 0
    wide = geometry.accuracy[parts[known]].sum(axis=1) / contacts.patch_accuracy[known]
    np.minimum.at(width, parts[known], wide[:, None])
    return aside, np.where(np.isfinite(width), width, geometry.size)
