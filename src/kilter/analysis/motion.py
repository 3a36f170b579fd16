"""Impending motion: how the parts start to move, by Gauss's principle of least constraint.

    min 1/2 (a - M^-1 w)^T M (a - M^-1 w),   J a >= 0

Among all accelerations that the contacts allow, the true ones are nearest to those of free
fall, in the metric of the masses and inertia tensors. They are unique, and zero exactly
where the assembly is stable. LP (9) only says that parts move, not how (the paper, 2.2).

    kappa = |a|_M / (|g| sqrt(sum m_i))          0 = stable, 1 = everything in free fall

References
----------
C. F. Gauss, Über ein neues allgemeines Grundgesetz der Mechanik, 1829. D. Baraff,
Analytical methods for dynamic simulation of non-penetrating rigid bodies, 1989.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.mechanics.formulations import impending_motion, scaled
from kilter.mechanics.program import Program
from kilter.units import metres_per_unit

__all__ = ["MOVES", "ImpendingMotion", "find_motion", "still"]

Array = NDArray[np.float64]

MOVES = 1e-6
"""A part moves where its linear, or radius x angular, acceleration is above this [g]."""


@dataclass(frozen=True, slots=True, eq=False)
class ImpendingMotion:
    """Initial accelerations, by Gauss's principle.

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
        Of the optimality conditions, in units of g [-].
    """

    acceleration: Array
    relative: Array
    moves: NDArray[np.bool_]
    instability: float
    residual: float


def find_motion(program: Program) -> ImpendingMotion:
    """The initial accelerations of all parts.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("floating-block")
    >>> motion = find_motion(build_program(assembly, find_contacts(assembly)))
    >>> np.round(motion.acceleration[motion.moves][0, :3], 6) + 0.0
    array([ 0.  ,  0.  , -9.81])
    """
    from kilter.solvers.quadratic import solve_quadratic

    if not program.free.any():
        return still(program)
    problem = scaled(program)
    answer = solve_quadratic(impending_motion(problem))
    # x is (a, radius x alpha) over gravity, in the frame of the problem
    motion = problem.motion(answer.x)
    size = float(np.linalg.norm(program.gravity))
    relative = np.column_stack(
        [
            np.linalg.norm(motion[:, :3], axis=1),
            np.linalg.norm(motion[:, 3:], axis=1) * program.radius,
        ]
    )
    moves = np.asarray((relative > MOVES).any(axis=1))
    motion = np.where(np.abs(motion) < 1e-14, 0.0, motion)
    energy = program.mass @ (motion[:, :3] ** 2).sum(axis=1) + np.einsum(
        "ni,nij,nj->", motion[:, 3:], program.inertia, motion[:, 3:]
    )
    free_mass = float(program.mass[program.free].sum())
    acceleration = motion * size
    acceleration[:, 3:] /= metres_per_unit(program.units)
    kappa = min(float(np.sqrt(max(energy, 0.0) / free_mass)), 1.0)
    return ImpendingMotion(acceleration, relative, moves, kappa, answer.residual)


def still(program: Program) -> ImpendingMotion:
    """The motion of an assembly that is stable: none."""
    count = len(program.names)
    return ImpendingMotion(
        np.zeros((count, 6)), np.zeros((count, 2)), np.zeros(count, dtype=bool), 0.0, 0.0
    )
