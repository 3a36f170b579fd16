"""Certificates: is a proof a proof? Recomputed from rows and load, apart from any solver.

Forces f prove that an equilibrium exists: every force in its cone (exactly, by clipping;
with friction |f_t| <= mu f_n, and f_n >= 0 also where mu = 0), and the imbalance of each
part, |J^T f + w|, at most the tolerance times the greater of its weight and the sum of the
forces on it; but never above a hundredth of its weight, so that no pinch, however hard,
hides a weight.

A motion dp proves that none exists: normalised so that the part that moves most moves
by 1 (translations, and radius x rotations), its power P = w.dp exceeds the tolerance times
the weight of the moving parts, and P / v is at least 1e6 times that weight, where v is its
worst violation of J dp >= 0: by weak duality, equilibrium would then need contact forces of
at least P / v. With friction the motion lies in the dual cone, u_n >= mu |u_t|, and v is the
worst mu |u_t| - u_n. (Without the ratio a motion proves nothing: any box at rest has one that
violates by 1e-9 and gains 1e-9.)

Where the data are coarser than float64 the tolerance follows them (`BLUR` of the program),
and a motion needs a quarter of it: on 270 scenes turned at random, moved 100 sizes away and
rounded to float32, balanced ones left up to 7 accuracies of imbalance and gained up to 2.

By Farkas' lemma exactly one of the two exists; exactly one must pass. Without friction an
equilibrium is all that stability needs; with friction more is asked (`kilter.analysis`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array
from kilter.mechanics.mechanics_tolerances import (
    COARSE_POWER,
    NO_EXCUSE,
    RULED_OUT,
    STILL,
    TOLERANCE,
)
from kilter.mechanics.program import Program

__all__ = [
    "ForceProof",
    "MotionProof",
    "check_forces",
    "check_motion",
    "part_sizes",
    "violations",
]


@dataclass(frozen=True, slots=True, eq=False)
class ForceProof:
    """Forces of the rows [N], judged: `residual` is the worst relative imbalance [-].

    `forces`, shape (K,), along each row; `friction`, shape (K, 3), across it, on part b.
    """

    forces: Array
    friction: Array
    residual: float
    holds: bool


@dataclass(frozen=True, slots=True, eq=False)
class MotionProof:
    """A motion, shape (N, 6) (length unit and rad), judged.

    `power` [W] where the part that moves most moves at 1 m/s; `violation`: worst negative
    opening of a row at that speed [-]; `ratio`: power over violation and weight [-].
    """

    motion: Array
    power: float
    violation: float
    ratio: float
    holds: bool


def check_forces(program: Program, forces: Array, friction: Array | None = None) -> ForceProof:
    """Judge contact forces as a proof that an equilibrium exists.

    Parameters
    ----------
    program : Program
    forces : ndarray, shape (K,)
        Along the rows [N], torques of angular rows [N x length unit]; cut to what each may be.
    friction : ndarray, shape (K, 3), optional
        Across the contact rows, on part b [N]; cut to Coulomb's cones.
    """
    forces, friction = _in_cones(program, forces, friction)
    wrenches = program.wrenches(forces, friction)
    imbalance = part_sizes(program, wrenches + program.load, per_radius=True)
    scale = np.maximum(program.weight, program.force_sums(forces, friction))
    relative = np.where(program.free, imbalance / np.maximum(scale, TINY), 0.0)
    share = np.where(program.free, imbalance / np.maximum(program.weight, TINY), 0.0)
    most = np.maximum(program.tolerance, NO_EXCUSE)
    holds = bool((relative <= program.tolerance).all() and (share <= most).all())
    return ForceProof(forces, friction, float(relative.max(initial=0.0)), holds)


def _in_cones(program: Program, forces: Array, friction: Array | None) -> tuple[Array, Array]:
    """The nearest forces along the rows that push, and across them within mu times those."""
    forces = np.where(np.isfinite(forces), forces, 0.0)
    forces = np.where(program.two_sided, forces, np.maximum(forces, 0.0))
    aside = np.zeros((len(forces), 3))
    rows = program.gripping
    if friction is not None and len(rows):
        given = np.where(np.isfinite(friction[rows]), friction[rows], 0.0)
        normal = program.normal[rows]
        given = given - np.einsum("ij,ij->i", given, normal)[:, None] * normal
        if program.planar:
            given[:, 1] = 0.0
        size = np.linalg.norm(given, axis=1)
        most = program.mu[rows] * forces[rows] + program.cohesion[rows]
        shrink = most / np.maximum(np.maximum(size, most), np.finfo(float).tiny)  # 1 within it
        aside[rows] = given * shrink[:, None]
    return forces, aside


def check_motion(program: Program, motion: Array) -> MotionProof:
    """Judge a motion as a proof that no equilibrium exists."""
    motion = np.where(program.free[:, None] & np.isfinite(motion), motion, 0.0)
    if program.planar:
        motion = motion * np.array([1.0, 0, 1, 0, 1, 0])
    sizes = part_sizes(program, motion, per_radius=False)
    largest = float(sizes.max(initial=0.0))
    if largest == 0.0:
        return MotionProof(motion, 0.0, 0.0, 0.0, False)
    motion = motion / largest
    power = program.power(motion)
    violation = float(-violations(program, motion).min(initial=0.0))
    moving = program.free & (sizes > STILL * largest)
    weight = float(program.weight[moving].sum())
    ratio = power / max(violation * weight, TINY)
    tolerance = np.maximum(TOLERANCE, COARSE_POWER * program.tolerance)
    needed = float((tolerance * program.weight)[moving].sum())
    return MotionProof(motion, power, violation, ratio, power > needed and ratio >= RULED_OUT)


def violations(program: Program, motion: Array) -> Array:
    """By how much a motion leaves the dual cone of each row: u_n - mu |u_t|, at most 0, (K,).

    In the unit of the motion's translations; of rows that may also pull, -|u_n|.
    """
    opening = program.velocities(motion) * program.arm
    rows = program.rough
    if len(rows):
        slip = np.linalg.norm(program.slips(motion, rows), axis=1)
        opening[rows] -= program.mu[rows] * slip
    bad: Array = np.where(program.two_sided, -np.abs(opening), np.minimum(opening, 0.0))
    return bad


def part_sizes(program: Program, six: Array, *, per_radius: bool) -> Array:
    """One size a part of twists (rotation x radius) or wrenches (torque / radius), (N,).

    Parameters
    ----------
    program : Program
    six : ndarray, shape (N, 6)
    per_radius : bool
        They are wrenches, else twists.
    """
    length = 1 / program.radius if per_radius else program.radius
    with np.errstate(over="ignore"):  # what is beyond all numbers is no proof of anything
        total: Array = np.sqrt(
            (six[:, :3] ** 2).sum(axis=1) + (six[:, 3:] ** 2).sum(axis=1) * length**2
        )
    if program.planar and per_radius:
        total = np.sqrt(six[:, 0] ** 2 + six[:, 2] ** 2 + (six[:, 4] * length) ** 2)
    return total
