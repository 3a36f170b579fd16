"""Impending motion with friction: initial accelerations that obey Coulomb's law.

Unlike those without friction they need not be unique. Where no exact solution is reached, the
one that comes nearest is given, with its residual in the law.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.analysis_tolerances import MOVES
from kilter.analysis.motion import ImpendingMotion
from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.units import metres_per_unit

__all__ = ["find_motion_with_friction", "motion_of"]


def motion_of(program: Program, acceleration: Array, residual: float) -> ImpendingMotion:
    """Given accelerations as an impending motion.

    Parameters
    ----------
    acceleration : ndarray, shape (N, 6)
        Linear [m/s^2] and angular [rad/s^2].
    residual : float
        In the contact law [-].
    """
    size = program.g
    motion = acceleration / max(size, np.finfo(float).tiny)
    motion[:, 3:] *= metres_per_unit(program.units)
    relative = np.column_stack(
        [
            np.linalg.norm(motion[:, :3], axis=1),
            np.linalg.norm(motion[:, 3:], axis=1) * program.radius,
        ]
    )
    moves = np.asarray((relative > MOVES).any(axis=1))
    energy = program.mass @ (motion[:, :3] ** 2).sum(axis=1) + np.einsum(
        "ni,nij,nj->", motion[:, 3:], program.inertia, motion[:, 3:]
    )
    free_mass = float(program.mass[program.free].sum())
    kappa = min(float(np.sqrt(max(energy, 0.0) / max(free_mass, np.finfo(float).tiny))), 1.0)
    return ImpendingMotion(acceleration, relative, moves, kappa, residual)


def find_motion_with_friction(program: Program, budget: float) -> ImpendingMotion | None:
    """How the parts start to move where no forces of equilibrium exist; None: not reached.

    Parameters
    ----------
    budget : float
        For the search [s].
    """
    from kilter.friction.motion_search import find_coulomb_motion

    found = find_coulomb_motion(program, budget=budget, nearest=True)
    if found is None:
        return None
    return motion_of(program, found.acceleration, found.law.residual)
