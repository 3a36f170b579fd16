"""Velocities of contact points past each other, and how they change along a rolling motion.

The formulas are those of `rolling`: the slip G z of both parts at each contact, and its change g.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.second_order_tolerances import BALANCED

__all__ = [
    "contact_shifts",
    "contact_slips",
    "rolling_shifts",
    "slip_axes",
    "slip_changes",
    "slip_rows",
]


def slip_axes(program: Program) -> Array:
    """Unit directions in which contact points must not slip, as rows: three, or two planar."""
    return np.eye(3)[[0, 2]] if program.planar else np.eye(3)


def slip_rows(program: Program) -> Array:
    """Matrix G from motions of the free parts to slips at all contacts."""
    columns = np.eye(len(program.columns))
    slips = [contact_slips(program, program.full(column)) for column in columns]
    return np.array([(slip @ slip_axes(program).T).reshape(-1) for slip in slips]).T


def _velocity(program: Program, motion: Array, part: Index) -> Array:
    """Velocities at the contact points of the material of the given parts, shape (K, 3).

    Points of the ground have the velocity 0.
    """
    padded = np.vstack([motion, np.zeros((1, 6))])[part]
    center = np.vstack([program.center, np.zeros((1, 3))])[part]
    return padded[:, :3] + cross(padded[:, 3:], program.point - center)


def contact_slips(program: Program, motion: Array) -> Array:
    """Velocity of part b relative to part a at each contact point, shape (K, 3)."""
    over = _velocity(program, motion, program.part_b)
    return over - _velocity(program, motion, program.part_a)


def contact_shifts(program: Program, inverse: Array, motion: Array) -> tuple[Array, Array]:
    """Velocity of each contact point past the centres of parts a and b along a rolling, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])
    a, b = padded[program.part_a], padded[program.part_b]
    turn = cross(program.normal, b[:, 3:] - a[:, 3:])
    at = _velocity(program, motion, program.part_a) - np.einsum("kij,kj->ki", inverse, turn)
    return at - a[:, :3], at - b[:, :3]


def slip_changes(program: Program, shifts: tuple[Array, Array], motion: Array) -> Array:
    """Change of the slip of a motion at each contact by shifts of the contact point, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])[:, 3:]
    over_a, over_b = shifts
    return np.asarray(cross(padded[program.part_b], over_b) - cross(padded[program.part_a], over_a))


def rolling_shifts(program: Program, features: Features) -> Array:
    """Inverse of the sum of both curvatures, within their common directions, (K, 3, 3).

    Along a direction in which both surfaces are equally curved, as a rim in a cone along itself,
    they touch on a whole line, and no point of contact shifts.
    """
    total = features.curvature_a + features.curvature_b
    inverse = np.zeros_like(total)
    for k in range(len(total)):
        axes = _common(program, features, k)
        if axes.size:
            within = axes @ total[k] @ axes.T
            values, along = np.linalg.eigh(within)
            # equal curvatures cancel up to rounding of their own size
            size = max(np.abs(features.curvature_a[k]).max(), np.abs(features.curvature_b[k]).max())
            bent = np.abs(values) > BALANCED * size
            along = axes.T @ along[:, bent]
            inverse[k] = along / values[bent] @ along.T
    return inverse


def _common(program: Program, features: Features, k: int) -> Array:
    """Unit tangents along which both features of contact k extend, as rows."""
    away = [program.normal[k]]
    if features.conformal[k]:
        return np.zeros((0, 3))
    for kind, edge in (
        (features.kind_a[k], features.edge_a[k]),
        (features.kind_b[k], features.edge_b[k]),
    ):
        if kind == EDGE:
            away.append(np.cross(program.normal[k], edge))
        elif kind != FACE:
            return np.zeros((0, 3))
    if features.fibre[k].any():
        away.append(features.fibre[k])
    if program.planar:
        away.append(np.array([0.0, 1.0, 0.0]))
    return null_space(np.array(away), BALANCED).T
