"""Refinement of a candidate that is nearly a proof: exact balance of forces, open contacts.

Solvers balance forces to their own tolerance, relative to the largest forces, and find motions that
keep contacts closed. A proof needs more of both: each part in balance up to rounding, also a light
part under heavy ones, and contacts that open by more than rounding if the moving parts are light
(`kilter.mechanics.clusters`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.coulomb_cones import balanced_forces, cone_problem
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import Program

NEARLY_BALANCED = 1e-2
"""Imbalance over the largest force on any part up to which forces are corrected [-]."""
SHARES = (1e-3, 0.1, 0.5)
"""Fractions of the power of a motion that opening its contacts uses [-]."""


def balanced_proof(program: Program, proof: ForceProof) -> ForceProof:
    """Correct forces that are no proof so that they balance; the given forces if that fails."""
    sums = program.force_sums(proof.forces, proof.friction)
    largest = max(float(sums.max(initial=0.0)), TINY)
    off = proof.residual * float(program.weight[program.free].min(initial=np.inf))
    if proof.holds or not off <= NEARLY_BALANCED * largest:
        return proof
    better = check_forces(
        program, *balanced_forces(cone_problem(program), proof.forces, proof.friction)
    )
    return better if better.residual < proof.residual else proof


def opened_proof(program: Program, proof: MotionProof) -> MotionProof:
    """Add an opening of its contacts to a motion that is no proof; the given motion if that fails.

    The moving parts are lifted, or all parts move away from a point among their supports.
    """
    if proof.holds or not proof.power > 0.0:
        return proof
    for opening in _openings(program, proof.motion):
        cost = -program.power(opening)
        if not cost > 0.0:
            continue
        for share in SHARES:
            opened = check_motion(program, proof.motion + share * proof.power / cost * opening)
            if opened.holds:
                return opened
    return proof


def _openings(program: Program, motion: Array) -> Iterator[Array]:
    """Motions that open many contacts: of the moving parts upwards, and of all parts apart."""
    moves = program.free & (part_sizes(program, motion, per_radius=False) > STILL)
    yield _translations(moves, np.broadcast_to(-program.down, program.center.shape))
    inner = np.append(program.free, False)
    on_held = inner[program.part_a] != inner[program.part_b]
    if on_held.any():
        support = program.point[on_held].mean(axis=0)
        yield _translations(program.free, program.center - support)


def _translations(moves: Mask, velocity: Array) -> Array:
    """Motion of the moving parts by velocities, shape (N, 6)."""
    motion = np.zeros((len(moves), 6))
    motion[:, :3] = np.where(moves[:, None], velocity, 0.0)
    return motion
