"""Rows of joints to second order, and exactly.

A joint is a set of equations in the motions of its two parts. Part i moves by
x -> c_i + r_i + exp(theta_i) (x - c_i). With p_i = x - c_i for the point x of a row along n, and
the axis d of the joint, the equations and their second derivatives are

    point of b on point of a     n . (x_b - x_a)
        n . (tb x (tb x pb)) - n . (ta x (ta x pa))
    point of b on axis of a      (exp(ta) n) . (x_b - x_a)
        the same, and 2 (ta x n) . v
    axis of b along axis of a    (exp(ta) e) . (exp(tb) d),    e = n x d
        d . (ta x (ta x e)) + e . (tb x (tb x d)) + 2 (ta x e) . (tb x d)
    no turn of b over a          n . log(exp(-ta) exp(tb))
        -n . (ta x tb)

A joint of two turns about d1, fixed in a, and d2, fixed in b, has the third equation with d = d2
and e along d1, of which the constant e . d is subtracted: n is across both.

with ta, tb the turns and v = v_b - v_a the velocity of b past a at x. Rows about turns are
multiplied by a length (`Program.arm`), so that all gaps are lengths.

The rows of a stop and of friction are those of the free motion: the fourth equation about the axis
of a hinge, and the second along a rail. A stop keeps its gap at least 0. A joint whose friction is
below its limit does not move, so its row is an equation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, read_only
from kilter.assembly import Assembly, Joint
from kilter.mechanics.program import Program
from kilter.mechanics.rows import DRAG, JOINT, OF_JOINTS, STOP
from kilter.rigid import skew, turn_of
from kilter.second_order.gaps.gap_form import arms_of, relative_motion, swing
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import KEEPS

ROUNDS = 60
"""Largest number of corrections that close the joints of a configuration."""
CLOSED = 1e-12
"""Largest error of closed joints, over the length of the assembly [-]."""
YIELDS = 1e-6
"""Friction of a joint within this share of its limit may yield to a small push [-]."""


def on_joints(program: Program) -> Mask:
    """Mask of the rows that are equations: those of joints and of their friction, shape (K,)."""
    rows: Mask = np.isin(program.kind, (JOINT, DRAG))
    return rows


def of_joints(program: Program) -> Mask:
    """Mask of the rows of joints, with their stops and friction, shape (K,)."""
    rows: Mask = np.isin(program.kind, OF_JOINTS)
    return rows


def slipping(program: Program, forces: Array) -> Mask:
    """Mask of the rows of joint friction whose force, of forces (K,), is at its limit, (K,)."""
    limit = (1 - YIELDS) * program.capacity
    rows: Mask = (program.kind == DRAG) & ~(np.abs(forces) < limit)
    return rows


def joint_forms(program: Program, joints: Sequence[Joint]) -> Array:
    """Second derivatives of the gaps of joints and stops, (K, 12, 12); 0 for other rows.

    Returns (K, 12, 12): in (r_a, theta_a, r_b, theta_b) about the centres of mass, world frame
    [length unit].
    """
    result = np.zeros((len(program.kind), 12, 12))
    rows = np.flatnonzero(of_joints(program))
    if not len(rows):
        return result
    slides, axes, across = _kinds(program, joints, rows)
    has_axis: Mask = np.asarray(np.any(axes != 0, axis=1))
    normal = program.normal[rows]
    arm_a, arm_b = arms_of(program, rows)
    slip, _ = relative_motion(arm_a, arm_b)
    form = np.zeros((len(rows), 12, 12))
    form[:, 3:6] += np.where(slides[:, None, None], skew(normal) @ slip, 0.0)
    form += form.swapaxes(1, 2).copy()
    form[:, 3:6, 3:6] -= swing(normal, arm_a)
    form[:, 9:, 9:] += swing(normal, arm_b)
    turn = np.zeros((len(rows), 12, 12))
    mixed = np.where(has_axis[:, None, None], -skew(across) @ skew(axes), skew(normal) / 2)
    turn[:, 3:6, 9:] = mixed
    turn[:, 9:, 3:6] = mixed.swapaxes(1, 2)
    turn[:, 3:6, 3:6] = swing(axes, across)
    turn[:, 9:, 9:] = swing(across, axes)
    turn *= program.arm[rows, None, None]
    result[rows] = np.where(program.angular[rows, None, None], turn, form)
    return result


def joint_errors(program: Program, joints: Sequence[Joint], motion: Array) -> Array:
    """Gaps of joints and stops after a motion, shape (N, 6), exactly; (k,) [length unit]."""
    rows = np.flatnonzero(of_joints(program))
    slides, axes, across = _kinds(program, joints, rows)
    normal, padded = program.normal[rows], np.vstack([motion, np.zeros((1, 6))])
    turns = np.array([turn_of(six[3:]) for six in padded])
    a, b = program.part_a[rows], program.part_b[rows]
    arm_a, arm_b = arms_of(program, rows)
    # the centres cancel: both arms end in the same point before the motion
    moved = padded[b, :3] - padded[a, :3]
    moved += np.einsum("kij,kj->ki", turns[b], arm_b) - arm_b
    moved -= np.einsum("kij,kj->ki", turns[a], arm_a) - arm_a
    along = np.where(slides[:, None], np.einsum("kij,kj->ki", turns[a], normal), normal)
    shifted = np.einsum("ki,ki->k", along, moved)
    over = turns[a].swapaxes(1, 2) @ turns[b]
    vee = np.stack(
        [
            over[:, 2, 1] - over[:, 1, 2],
            over[:, 0, 2] - over[:, 2, 0],
            over[:, 1, 0] - over[:, 0, 1],
        ],
        axis=1,
    )
    leaning = np.einsum("ki,kij,kj->k", across, over, axes) - np.einsum("ki,ki->k", across, axes)
    turned = np.where(np.any(axes != 0, axis=1), leaning, np.einsum("ki,ki->k", normal, vee) / 2)
    errors: Array = np.where(program.angular[rows], turned * program.arm[rows], shifted)
    return errors


def joints_closed(program: Program, joints: Sequence[Joint], motion: Array, length: float) -> bool:
    """True if all joints are closed, and all within limits, after a motion, (N, 6).

    Rounding is allowed for.
    """
    errors = joint_errors(program, joints, motion)
    stops = program.kind[of_joints(program)] == STOP
    off = np.where(stops, np.maximum(-errors, 0.0), np.abs(errors))
    return bool(off.max(initial=0.0) <= CLOSED * length)


def close_joints(
    program: Program, joints: Sequence[Joint], motion: Array, length: float
) -> Array | None:
    """Configuration near a motion, (N, 6), in which all joints are closed; None if not found.

    Newton's method with the derivatives at the start.
    """
    chosen = on_joints(program)
    if not chosen.any():
        return motion
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    scale = units[:, program.freedoms].reshape(-1)
    arm = program.arm[chosen]
    rows = program.taking(chosen).jacobian().toarray() * scale * arm[:, None]
    inverse = np.linalg.pinv(rows, rcond=1e-9)
    for _ in range(ROUNDS):
        if joints_closed(program, joints, motion, length):
            return motion
        errors = joint_errors(program, joints, motion)[chosen[of_joints(program)]]
        motion = motion - program.full(scale * (inverse @ errors))
    return None


SLIDING = ("prismatic", "cylindrical", "general")
"""Kinds of joints whose linear rows have directions of the first part."""


def _kinds(program: Program, joints: Sequence[Joint], rows: Index) -> tuple[Mask, Array, Array]:
    """For joint rows: whether b slides past a; the axis of b that turns, and e in a across it.

    Both vectors are 0 for joints without an axis of rotation; shapes (k,), (k, 3), (k, 3).
    """
    chosen = [joints[k] for k in program.source[rows]]
    slides = np.array([joint.kind in SLIDING for joint in chosen], dtype=bool)
    axes = np.array([_last_axis(joint) for joint in chosen]).reshape(-1, 3)
    axes[program.kind[rows] != JOINT] = 0.0
    normal = program.normal[rows]
    across = cross(normal, axes)
    for k, joint in enumerate(chosen):
        if len(joint.turns) == 2:
            both = cross(joint.turns[1], joint.turns[0])
            across[k] = joint.turns[0] * float(normal[k] @ both) / float(both @ both)
    return slides, axes, across


def _last_axis(joint: Joint) -> Array:
    """The axis of rotation of a joint that moves with its second part, (3,); 0 without one."""
    if joint.kind in ("revolute", "cylindrical"):
        return np.asarray(joint.axis)
    return joint.turns[-1] if len(joint.turns) in (1, 2) else np.zeros(3)


# Energy of the springs of joints, to second order and exactly.


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


# Loads off the centres of mass to second order.


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
    if not assembly.loads:
        return Swings(forms, arms, inclined, torques)
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
