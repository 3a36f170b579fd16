"""Certificates: verification of a proof from rows and load alone, independently of the solver.

Forces f prove that an equilibrium exists. Every force must lie in its cone (exactly, by clipping;
with friction |f_t| <= mu f_n, and f_n >= 0 also for mu = 0). The imbalance |J^T f + w| of each part
may be at most the tolerance times its weight, and what rounding of its forces explains.

A motion dp proves that no equilibrium exists. It is normalised so that the fastest part moves by 1
(translations, and radius x rotations). Its power P = w.dp must exceed what the imbalance of any
accepted forces, and its own violation v of J dp >= 0, can explain. With friction the motion lies in
the dual cone, u_n >= mu |u_t|, and v is the worst mu |u_t| - u_n. A strap of capacity LC takes up
the power LC times the rate at which it lengthens, and the friction F of a joint F times its speed.

`kilter.mechanics.clusters` has both limits, and the theorem that at most one of both proofs
passes. If the data are coarser than float64 the tolerance follows their accuracy (`BLUR` of the
program): on 270 scenes, rotated at random, moved 100 sizes away and rounded to float32, balanced
scenes had imbalances of up to 7 accuracies of the forces.

Without friction an equilibrium suffices for stability; with friction further conditions apply
(`kilter.analysis`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array
from kilter.mechanics.clusters import balanced_parts, power_limit, pressing_forces
from kilter.mechanics.program import Program


@dataclass(frozen=True, slots=True, eq=False)
class ForceProof:
    """Contact and joint forces as a proof of equilibrium, with the result of its check."""

    forces: Array
    """Along the rows [N], shape (K,)."""
    friction: Array
    """Across the rows, on part b [N], shape (K, 3)."""
    residual: float
    """Worst imbalance of a part over its weight [-]."""
    holds: bool
    """The forces are a proof."""


@dataclass(frozen=True, slots=True, eq=False)
class MotionProof:
    """A motion of the parts as a proof that no equilibrium exists, with the result of its check."""

    motion: Array
    """Translations [length unit] and rotations [rad], shape (N, 6); the fastest part moves by 1."""
    power: float
    """Power of the load if the fastest part moves at 1 m/s [W]."""
    violation: float
    """Worst negative opening of a row at that speed [-]."""
    ratio: float
    """Power over the power that a proof must exceed [-]."""
    holds: bool
    """The motion is a proof."""


def check_forces(program: Program, forces: Array, friction: Array | None = None) -> ForceProof:
    """Check contact forces as a proof that the parts are in equilibrium under their load.

    Arguments: `forces` (K,): along the rows [N], or torques of angular rows [N x length unit];
    clipped to the admissible signs; `friction` (K, 3): across the contact rows, on part b [N];
    clipped to Coulomb's cones.
    """
    forces, friction = _clip_to_cones(program, forces, friction)
    wrenches = program.wrenches(forces, friction)
    imbalance = part_sizes(program, wrenches + program.load, per_radius=True)
    sums = pressed = program.force_sums(forces, friction)
    if program.pull.any():
        pressed = program.force_sums(pressing_forces(program, forces), friction)
    relative, balanced = balanced_parts(program, imbalance, program.weight, sums, pressed)
    residual = float(relative.max(initial=0.0))
    return ForceProof(forces, friction, residual, bool(balanced.all()))


def _clip_to_cones(program: Program, forces: Array, friction: Array | None) -> tuple[Array, Array]:
    """Move forces into their cones: one-sided rows push, friction is at most mu f_n + cohesion.

    The pull of a strap is at most its capacity, and equal in all of its pieces. Friction of a
    joint is at most its limit.

    Returns both, shapes (K,) and (K, 3); values that are not finite become 0.
    """
    forces = np.where(np.isfinite(forces), forces, 0.0)
    least = np.where(program.two_sided, -program.capacity, 0.0)
    forces = np.clip(forces, least, program.capacity)
    forces = program.by_stops(program.equal_pulls(forces))
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
    if largest == 0.0 or not np.isfinite(largest):
        return MotionProof(np.zeros_like(motion), 0.0, 0.0, 0.0, False)
    motion = motion / largest
    power = program.power(motion)
    opening = row_openings(program, motion)
    violation = _violations(program, opening)
    needed = power_limit(program, opening, sizes / largest).largest(program.weight[None])
    ratio = power / max(needed, TINY)
    return MotionProof(motion, power, float(-violation.min(initial=0.0)), ratio, power > needed)


def needed_power(program: Program, proof: MotionProof, weight: Array | None = None) -> float:
    """Power above which a motion, with its violation of contacts, is a proof [W].

    With weights, shape (n, N), of the parts under n loads (`Program.weight`), it is a proof for
    every load in the hull of these loads.
    """
    weight = program.weight[None] if weight is None else weight
    sizes = part_sizes(program, proof.motion, per_radius=False)
    return power_limit(program, row_openings(program, proof.motion), sizes).largest(weight)


def row_openings(program: Program, motion: Array) -> Array:
    """Opening u_n - mu |u_t| of each row by a motion, times its arm, shape (K,).

    A strap may lengthen, and a joint with friction may move, since their forces are limited
    (`Program.power`): their value is 0.
    """
    opening = program.velocities(motion) * program.arm
    rows = program.rough
    if len(rows):
        opening[rows] -= program.mu[rows] * np.linalg.norm(program.slips(motion, rows), axis=1)
    opening[program.bounded] = 0.0
    return opening


def violations(program: Program, motion: Array) -> Array:
    """Violation of each row by a motion: min(u_n - mu |u_t|, 0), shape (K,); 0 if admissible.

    The value of a row that may also pull is -|u_n|. A strap may lengthen, since its pull is
    limited (`Program.power`). The unit is that of the motion's translations.
    """
    return _violations(program, row_openings(program, motion))


def _violations(program: Program, opening: Array) -> Array:
    """Violation of each row from its opening, shape (K,); 0 if admissible."""
    violation: Array = np.where(program.two_sided, -np.abs(opening), np.minimum(opening, 0.0))
    return violation


def part_sizes(program: Program, six: Array, *, per_radius: bool) -> Array:
    """Size of each part's twist (angle x radius) or wrench (torque / radius), shape (..., N).

    Arguments: `six` (..., N, 6): twists or wrenches of all parts.
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
