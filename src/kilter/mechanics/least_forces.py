"""Balanced contact forces closest to those of unloaded bonds, by Newton's method.

Forces f' >= 0 are counted from -T, so a bond without load has f' = T:

    min |f' - T|^2:   A f' = b,  f' >= 0            f' = max(0, T + A^T y),  A f' = b

Newton's method solves the equations in y with a factorisation per step and a handful of steps,
whereas an equilibrium by linear programs takes hundreds. The first step omits the rows that only
push, which suffices if the bonds are strong. If no balanced forces exist, the residual stops
decreasing and tends to a motion that proves it. Both results are unverified; certificates check
them.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import TINY, Array
from kilter.mechanics.forms import ScaledProblem

__all__ = ["least_forces"]

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
