"""Free motions as directions in scaled unknowns: their span, and how much of it only spins."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.mechanics.program import Program
from kilter.second_order.free_motions import FreeMotions
from kilter.second_order.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import ACROSS
from kilter.second_order.stationary import Stationary
from kilter.shape.primitives import Cylinder, Sphere

__all__ = ["free_span", "moving_free", "scaled_columns"]


def free_span(program: Program, problem: Stationary, free: FreeMotions) -> Array:
    """An orthonormal basis of the free motions, shape (n, f), as the numbers bear them out."""
    columns = scaled_columns(program, problem, free.motions)
    size = np.linalg.norm(columns, axis=0)
    columns = np.asarray(columns[:, size > 0] / size[size > 0], dtype=np.float64)
    opened = np.abs(problem.rows @ columns).max(axis=0, initial=0.0)
    spent = np.abs(problem.load @ columns)
    columns = columns[:, (opened < ACROSS / 10) & (spent < ACROSS / 10)]
    if not columns.shape[1]:
        return columns
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.ascontiguousarray(left[:, values > ACROSS * values[0]])


def scaled_columns(program: Program, problem: Stationary, motions: Array) -> Array:
    """Motions of all parts, shape (F, N, 6), in scaled unknowns, shape (n, F)."""
    assert problem.scale is not None
    free = np.flatnonzero(program.free)
    own = motions[:, free][:, :, program.freedoms].reshape(len(motions), len(problem.scale))
    return np.asarray((own / problem.scale).T)


def moving_free(assembly: Assembly, free: FreeMotions) -> Index:
    """Parts that a free motion moves visibly: not balls and cylinders that spin.

    Of parts that fixed joints tie the first is told, as in the motions.
    """
    groups, moving = RigidGroups.of(assembly), np.zeros(len(assembly.parts), dtype=bool)
    for motion in groups.spread(free.motions):
        for k in np.flatnonzero(np.abs(motion).max(axis=1) > 0):
            moving[k] |= not _spins_unseen(assembly, int(k), motion[k])
    return np.unique(groups.first[moving])


def _spins_unseen(assembly: Assembly, part: int, motion: Array) -> bool:
    """Whether a motion of a part only turns it about an axis of revolution of its shape."""
    shape, turn = assembly.parts[part].shape, motion[3:]
    center = assembly.geometry.center[part]
    at = assembly.parts[part].pose.position - center
    radius = float(assembly.geometry.radius[part])
    speed = float(np.abs(turn).max()) * radius
    still = ACROSS * max(speed, float(np.abs(motion[:3]).max()))
    if np.abs(motion[:3] + np.cross(turn, at)).max() > still or speed == 0:
        return False
    if isinstance(shape, Sphere):
        return True
    axis = assembly.parts[part].pose.matrix[:, 2]
    return isinstance(shape, Cylinder) and bool(np.abs(np.cross(turn, axis)).max() * radius < still)
