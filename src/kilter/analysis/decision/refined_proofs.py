"""Refinement of a candidate that is nearly a proof: exact balance of forces, lift of a motion.

Solvers balance forces to their own tolerance, relative to the largest forces, and find motions that
keep contacts closed. A proof needs more of both: each part in balance up to rounding, also a light
part under heavy ones, and contacts that open by more than rounding if the moving parts are light
(`kilter.mechanics.proof_limits`).
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY
from kilter.mechanics.balanced_forces import balanced_forces
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.program import Program

__all__ = ["balanced_proof", "lifted_proof"]

NEARLY_BALANCED = 1e-2
"""Imbalance over the largest force on any part up to which forces are corrected [-]."""
LIFTS = (1e-3, 0.1, 0.5)
"""Fractions of the power of a motion that a lift of its parts uses [-]."""


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


def lifted_proof(program: Program, proof: MotionProof) -> MotionProof:
    """Lift the parts of a motion that is no proof off their supports; the given motion if no lift
    makes it a proof.
    """
    if proof.holds or not proof.power > 0.0:
        return proof
    moves = program.free & (part_sizes(program, proof.motion, per_radius=False) > 0.0)
    weight = max(float(program.weight[moves].sum()), TINY)
    for share in LIFTS:
        motion = proof.motion.copy()
        motion[moves, :3] -= share * proof.power / weight * program.down
        lifted = check_motion(program, motion)
        if lifted.holds:
            return lifted
    return proof
