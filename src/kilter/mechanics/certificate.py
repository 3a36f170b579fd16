"""Certificates: verification of a proof from rows and load alone, independently of the solver.

Forces f prove that an equilibrium exists. Every force must lie in its cone (exactly, by clipping;
with friction |f_t| <= mu f_n, and f_n >= 0 also for mu = 0). The imbalance of each part, |J^T
f + w|, may be at most the tolerance times the greater of its weight and the sum of the forces on
it, and at most a hundredth of its weight, so that no squeeze, however hard, hides a weight. Forces
above 1e10 times the weight of all parts prove nothing: they use the rounding of the directions of
contact normals, such as 1e-13 at the rim of a hemisphere.

A motion dp proves that no equilibrium exists. It is normalised so that the fastest part moves by 1
(translations, and radius x rotations). Its power P = w.dp must exceed the tolerance times the
weight of the moving parts, and P / v must be at least 1e6 times that weight, where v is the worst
violation of J dp >= 0: by weak duality, an equilibrium would then need contact forces of at least P
/ v. With friction the motion lies in the dual cone, u_n >= mu |u_t|, and v is the worst mu |u_t| -
u_n. A strap of capacity LC takes up the power LC times the rate at which it lengthens. (Without the
ratio a motion proves nothing: every box at rest has a motion that violates by 1e-9 and gains 1e-9.)

If the data are coarser than float64 the tolerance follows their accuracy (`BLUR` of the program),
and a motion needs a quarter of it. On 270 scenes, rotated at random, moved 100 sizes away and
rounded to float32, balanced scenes had imbalances of up to 7 accuracies and gains of up to 2.

By Farkas' lemma either forces or a motion exist, never both, so exactly one of the two proofs must
pass. Without friction an equilibrium suffices for stability; with friction further conditions apply
(`kilter.analysis`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.mechanics_tolerances import (
    COARSE_POWER,
    LARGEST_FORCES,
    NO_EXCUSE,
    RULED_OUT,
    STILL,
    TOLERANCE,
)
from kilter.mechanics.program import Program

__all__ = [
    "ForceProof",
    "MotionProof",
    "balanced_parts",
    "check_forces",
    "check_motion",
    "needed_power",
    "needed_powers",
    "part_sizes",
    "violations",
]


@dataclass(frozen=True, slots=True, eq=False)
class ForceProof:
    """Contact and joint forces as a proof of equilibrium, with the result of its check.

    Attributes
    ----------
    forces : ndarray, shape (K,)
        Along the rows [N].
    friction : ndarray, shape (K, 3)
        Across the rows, on part b [N].
    residual : float
        Worst imbalance of a part over the greater of its weight and the forces on it [-].
    holds : bool
        The forces are a proof.
    """

    forces: Array
    friction: Array
    residual: float
    holds: bool


@dataclass(frozen=True, slots=True, eq=False)
class MotionProof:
    """A motion of the parts as a proof that no equilibrium exists, with the result of its check.

    Attributes
    ----------
    motion : ndarray, shape (N, 6)
        Translations [length unit] and rotations [rad]; the fastest part moves by 1.
    power : float
        Power of the load if the fastest part moves at 1 m/s [W].
    violation : float
        Worst negative opening of a row at that speed [-].
    ratio : float
        Power over violation and weight of the moving parts [-].
    holds : bool
        The motion is a proof.
    """

    motion: Array
    power: float
    violation: float
    ratio: float
    holds: bool


def check_forces(program: Program, forces: Array, friction: Array | None = None) -> ForceProof:
    """Check contact forces as a proof that the parts are in equilibrium under their load.

    Parameters
    ----------
    program : Program
    forces : ndarray, shape (K,)
        Along the rows [N], or torques of angular rows [N x length unit]; clipped to the admissible
        signs.
    friction : ndarray, shape (K, 3), optional
        Across the contact rows, on part b [N]; clipped to Coulomb's cones.
    """
    forces, friction = _clip_to_cones(program, forces, friction)
    wrenches = program.wrenches(forces, friction)
    imbalance = part_sizes(program, wrenches + program.load, per_radius=True)
    total = float(program.weight[program.free].sum())
    relative, balanced = balanced_parts(
        program, imbalance, program.weight, program.force_sums(forces, friction), total
    )
    residual = float(relative.max(initial=0.0))
    return ForceProof(forces, friction, residual, bool(balanced.all()))


def balanced_parts(
    program: Program, imbalance: Array, weight: Array, sums: Array, total: Array | float
) -> tuple[Array, Mask]:
    """Apply the criteria of a proof by forces to each part.

    Parameters
    ----------
    program : Program
        Of a single assembly, or of several side by side.
    imbalance, weight, sums : ndarray, shape (N,) or (n, N)
        Imbalance, weight, and sum of the forces on each part [N]; or for each of n loads.
    total : ndarray, shape (N,) or (n, 1), or float
        Weight of all free parts of the assembly of each part [N].

    Returns
    -------
    relative : ndarray, shape (N,) or (n, N)
        Imbalance over the greater of the weight and the forces; 0 for held parts [-].
    balanced : ndarray of bool, shape (N,) or (n, N)
        Parts that are in balance, or held.
    """
    scale = np.maximum(weight, sums)
    relative = np.where(program.free, imbalance / np.maximum(scale, TINY), 0.0)
    share = np.where(program.free, imbalance / np.maximum(weight, TINY), 0.0)
    # large forces that squeeze a part must not excuse an imbalance of much of its weight
    balanced = (relative <= program.tolerance) & (share <= np.maximum(program.tolerance, NO_EXCUSE))
    # forces that large rely on rounding of the normals, whatever they balance
    balanced &= ~program.free | (scale <= LARGEST_FORCES * np.maximum(total, TINY))
    return relative, balanced


def _clip_to_cones(program: Program, forces: Array, friction: Array | None) -> tuple[Array, Array]:
    """Move forces into their cones: one-sided rows push, friction is at most mu f_n + cohesion.

    The pull of a strap is at most its capacity, and equal in all of its pieces.

    Returns both, shapes (K,) and (K, 3); values that are not finite become 0.
    """
    forces = np.where(np.isfinite(forces), forces, 0.0)
    forces = np.where(program.two_sided, forces, np.clip(forces, 0.0, program.capacity))
    forces = program.equal_pulls(forces)
    clipped = np.zeros((len(forces), 3))
    rough = program.gripping
    if friction is not None and len(rough):
        across = np.where(np.isfinite(friction[rough]), friction[rough], 0.0)
        normal = program.normal[rough]
        across = across - np.einsum("ij,ij->i", across, normal)[:, None] * normal
        if program.planar:
            across[:, 1] = 0.0
        length = np.linalg.norm(across, axis=1)
        limit = program.mu[rough] * forces[rough] + program.cohesion[rough]
        # the factor is exactly 1 inside the cone
        shrink = limit / np.maximum(np.maximum(length, limit), np.finfo(float).tiny)
        clipped[rough] = across * shrink[:, None]
    return forces, clipped


def check_motion(program: Program, motion: Array) -> MotionProof:
    """Check a motion as a proof that no equilibrium exists; held parts count as motionless."""
    motion = np.where(program.free[:, None] & np.isfinite(motion), motion, 0.0)
    if program.planar:
        # only x, z and the turn about y are motions in the plane y = 0
        motion = motion * np.array([1.0, 0, 1, 0, 1, 0])
    sizes = part_sizes(program, motion, per_radius=False)
    largest = float(sizes.max(initial=0.0))
    if largest == 0.0:
        return MotionProof(motion, 0.0, 0.0, 0.0, False)
    motion = motion / largest
    power = program.power(motion)
    violation = float(-violations(program, motion).min(initial=0.0))
    weight, needed = _moving_weight(program, motion)
    ratio = power / max(violation * weight, TINY)
    return MotionProof(motion, power, violation, ratio, power > needed and ratio >= RULED_OUT)


def _moving_weight(program: Program, motion: Array) -> tuple[float, float]:
    """Weight of the moving parts [N], and power that a motion must exceed to be a proof [W]."""
    moving, tolerance = _moving_parts(program, motion)
    weight = program.weight
    return float(weight[moving].sum()), float((tolerance * weight)[moving].sum())


def _moving_parts(program: Program, motion: Array) -> tuple[Mask, Array]:
    """Mask of the moving parts, and the tolerance of the power of each part, shape (N,)."""
    sizes = part_sizes(program, motion, per_radius=False)
    moving = program.free & (sizes > STILL * float(sizes.max(initial=0.0)))
    return moving, np.maximum(TOLERANCE, COARSE_POWER * program.tolerance)


def needed_power(program: Program, proof: MotionProof) -> float:
    """Power above which a motion, with its violation of contacts, is a proof [W]."""
    return float(needed_powers(program, proof, program.weight[None])[0])


def needed_powers(program: Program, proof: MotionProof, weight: Array) -> Array:
    """Power above which a motion is a proof under each of n loads [W], shape (n,).

    `weight`, shape (n, N), has the weight of each part under each load (`Program.weight`).
    """
    moving, tolerance = _moving_parts(program, proof.motion)
    total = weight[:, moving].sum(axis=1)
    needed = (tolerance * weight)[:, moving].sum(axis=1)
    least: Array = np.maximum(needed, RULED_OUT * proof.violation * total)
    return least


def violations(program: Program, motion: Array) -> Array:
    """Violation of each row by a motion: min(u_n - mu |u_t|, 0), shape (K,); 0 if admissible.

    The value of a row that may also pull is -|u_n|. A strap may lengthen, since its pull is
    limited (`Program.power`). The unit is that of the motion's translations.
    """
    opening = program.velocities(motion) * program.arm
    rows = program.rough
    if len(rows):
        slip = np.linalg.norm(program.slips(motion, rows), axis=1)
        opening[rows] -= program.mu[rows] * slip
    violation: Array = np.where(program.two_sided, -np.abs(opening), np.minimum(opening, 0.0))
    violation[program.bounded] = 0.0
    return violation


def part_sizes(program: Program, six: Array, *, per_radius: bool) -> Array:
    """Size of each part's twist (angle x radius) or wrench (torque / radius), shape (..., N).

    Parameters
    ----------
    program : Program
    six : ndarray, shape (..., N, 6)
        Twists or wrenches of all parts.
    per_radius : bool
        True for wrenches, False for twists.
    """
    length = 1 / program.radius if per_radius else program.radius
    with np.errstate(over="ignore"):  # an infinite size fails every check
        total: Array = np.sqrt(
            (six[..., :3] ** 2).sum(axis=-1) + (six[..., 3:] ** 2).sum(axis=-1) * length**2
        )
    if program.planar and per_radius:
        # the plane holds a force across it and torques about axes within it
        total = np.sqrt(six[..., 0] ** 2 + six[..., 2] ** 2 + (six[..., 4] * length) ** 2)
    return total
