"""Energy of the springs of joints, to second order and exactly.

A spring of stiffness k has the torque k rest in the drawn pose, which is a load of the program.
With the shift or turn g of the second part past the first along the axis, g = J z + z.H z / 2, its
energy beyond that load is

    k (g^2 / 2 + rest (g - J z))  =  z.(k J^T J + k rest H) z / 2 + O(3)

The rows of the joint itself keep g a single number: so its second derivative H is that of a row
about, or along, the axis (`joint_forms`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Joint
from kilter.mechanics.program import Program
from kilter.mechanics.rows import DRAG, JOINT
from kilter.second_order.gaps.joint_forms import joint_errors, joint_forms

__all__ = ["spring_excess", "spring_form", "sprung_rows"]


def sprung_rows(program: Program, joints: Sequence[Joint]) -> Index:
    """One row of each joint with a spring that the program has, shape (S,)."""
    rows = np.flatnonzero(program.kind == JOINT)
    sprung = np.array([joints[k].stiffness > 0 for k in program.source[rows]], dtype=bool)
    _, first = np.unique(program.source[rows[sprung]], return_index=True)
    chosen: Index = rows[sprung][first]
    return chosen


def spring_form(program: Program, joints: Sequence[Joint]) -> Array | None:
    """Second derivative of the energy of all springs over the freedoms, (n, n); None without any.

    The unknowns are those of `Program.columns` [N / length unit, N, N x length unit].
    """
    along, stiffness, rest = _springs(program, joints)
    if not len(stiffness):
        return None
    rows, per = along.jacobian().toarray(), len(program.freedoms)
    forms = joint_forms(along, joints) / along.arm[:, None, None]
    total = rows.T @ (stiffness[:, None] * rows)
    place = np.full((len(program.names) + 1, 6), -1)
    free = np.flatnonzero(program.free)
    place[np.ix_(free, program.freedoms)] = np.arange(per * len(free)).reshape(-1, per)
    for a, b, form, force in zip(along.part_a, along.part_b, forms, stiffness * rest, strict=True):
        at = np.append(place[a], place[b])
        used = at >= 0
        total[np.ix_(at[used], at[used])] += force * form[np.ix_(used, used)]
    return np.asarray((total + total.T) / 2)


def spring_excess(program: Program, joints: Sequence[Joint], motion: Array) -> float:
    """Exact energy of all springs after a motion, (N, 6), beyond their load [N x length unit]."""
    along, stiffness, rest = _springs(program, joints)
    if not len(stiffness):
        return 0.0
    moved = joint_errors(along, joints, motion) / along.arm
    moved = np.where(along.angular, np.arcsin(np.clip(moved, -1.0, 1.0)), moved)
    linear = along.velocities(np.where(program.free[:, None], motion, 0.0))
    return float(stiffness @ (moved**2 / 2 + rest * (moved - linear)))


def _springs(program: Program, joints: Sequence[Joint]) -> tuple[Program, Array, Array]:
    """Rows along the axes of all joints with springs, their stiffness and rest positions."""
    rows = sprung_rows(program, joints)
    chosen = [joints[k] for k in program.source[rows]]
    along = program.taking(rows).with_rows(
        normal=np.array([joint.axis for joint in chosen]).reshape(-1, 3),
        angular=np.array([joint.kind == "revolute" for joint in chosen], dtype=bool),
        kind=np.full(len(rows), DRAG),
    )
    stiffness = np.array([joint.stiffness for joint in chosen])
    return along, stiffness, np.array([joint.rest for joint in chosen])
