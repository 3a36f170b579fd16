"""Loads off the centres of mass to second order.

A load F is constant and acts at a point p of its part. If the part with its centre of mass at c
turns by theta, the energy of the load curves by

    -F . (theta x (theta x (p - c))) = theta . S theta,    S = (F . arm) I - (F arm^T + arm F^T) / 2

A pure torque has no potential. Loads at a centre of mass do not curve the energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask, read_only
from kilter.assembly import Assembly
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import KEEPS

__all__ = ["Swings", "swings_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Swings:
    """Loads on N parts, with rigid groups as their first parts."""

    forms: Array
    """S for the turns of each part [N x length unit], shape (N, 3, 3)."""
    arms: Array
    """Sum of the squares of the cross products with the arms of the loads on each part, shape
    (N, 3, 3)."""
    inclined: Mask
    torques: Mask
    """Parts with a load that is not vertical, and with a torque, shape (N,)."""

    def __post_init__(self) -> None:
        read_only(self)

    def conditions(self, part: int) -> Array:
        """Conditions, (3, 3), on a turn of a part that moves no load along an arc."""
        if self.torques[part]:
            return np.eye(3)
        size = float(np.abs(self.arms[part]).max())
        return np.asarray(self.arms[part] / (size if size > 0 else 1.0))


def swings_of(assembly: Assembly, program: Program) -> Swings:
    """Loads of an assembly."""
    count = len(program.names)
    forms, arms = np.zeros((2, count, 3, 3))
    inclined, torques = np.zeros((2, count), dtype=bool)
    groups, center = RigidGroups.of(assembly), assembly.geometry.center
    for load in assembly.loads:
        part = assembly.index_of(load.part)
        first = int(groups.first[part])
        force = np.asarray(load.force, dtype=float)
        arm = (center[part] if load.point is None else load.point) - program.center[first]
        size = float(np.linalg.norm(force))
        torques[first] |= bool(np.any(load.torque))
        aside = float(np.linalg.norm(np.cross(force, program.down)))
        inclined[first] |= aside > KEEPS * size
        if np.linalg.norm(arm) > KEEPS * program.radius[first] and size > 0:
            product = np.outer(force, arm)
            forms[first] += force @ arm * np.eye(3) - (product + product.T) / 2
            arms[first] += skew(arm).T @ skew(arm)
    return Swings(forms, arms, inclined, torques)
