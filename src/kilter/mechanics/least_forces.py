"""The forces of bonds and contacts that are least beside their strength, in balance.

Forces f' >= 0 count from -T, where a bond with nothing to do bears f' = T:

    min |f' - T|^2:   A f' = b,  f' >= 0            f' = max(0, T + A^T y),  A f' = b

Newton's method on the equations in y: one factorisation a step, and a handful of steps, where an
equilibrium by linear programs takes hundreds. At first all that only pushes is left out, which is
enough where bonds are strong. Where no forces balance the rest stops falling, and in the limit it
is a motion that proves it. Both are unjudged: their certificates judge.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import TINY, Array
from kilter.mechanics.forms import ScaledProblem

__all__ = ["least_forces"]

REGULAR = 1e-12
"""Added to the diagonal of the equations, over its largest entry, and refined away."""
REFINED = 2
"""Solutions with one factorisation."""
STEPS = 6
"""Newton's steps at most."""
BALANCED = 1e-11
"""Rest over weight that is rounding."""
STALLED = 0.9
"""A step that leaves more than this of the least rest before is one of `PATIENCE`."""
PATIENCE = 1
"""Such steps that end it."""


def least_forces(problem: ScaledProblem) -> tuple[Array, Array] | None:
    """Forces of the rows, shape (K,), and a motion, shape (N, 6); None where no bond holds.

    Parameters
    ----------
    problem : ScaledProblem
        Of a program without friction.
    """
    program, matrix = problem.program, problem.matrix
    if not program.pull.any():
        return None
    from scipy.sparse.linalg import splu  # takes its time

    strength = program.pull / (problem.unit * program.arm)
    acts = (program.pull > 0) | program.two_sided
    y = np.zeros(len(problem.right))
    one = eye_array(len(y), format="csc")
    least, idle = np.inf, 0
    forces, rest = strength, problem.right
    for _ in range(STEPS):
        used = matrix[:, np.flatnonzero(acts)]
        normal = used @ used.T
        most = float(normal.diagonal().max(initial=TINY))
        factor = splu(
            csc_array(normal + REGULAR * most * one),
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True},
        )
        with np.errstate(all="ignore"):  # nothing is left that acts: beyond all numbers
            for _ in range(REFINED):
                y = y + factor.solve(problem.right - used @ (strength[acts] + used.T @ y))
        if not np.isfinite(y).all():
            break
        pressed = strength + matrix.T @ y
        acts = (pressed > 0) | program.two_sided
        found = np.where(acts, pressed, 0.0)
        left = problem.right - matrix @ found
        size = float(np.abs(left).max(initial=0.0))
        idle = idle + 1 if size > STALLED * least else 0
        if size < least:
            least, forces, rest = size, found, left
        if size < BALANCED or idle == PATIENCE:
            break
    return problem.forces(forces), problem.motion(problem.over_weight(-rest))
