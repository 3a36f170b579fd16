"""Joints: the rows by which they constrain two parts, and the wrench that they transmit.

A joint forbids some relative motions of its parts at a point and leaves the others free:

    linear    (v_b(x) - v_a(x)) . n = 0       its multiplier is a force along n
    angular   (w_b - w_a) . n = 0             its multiplier is a torque along n

    =============  =====================  =====================
    kind           forces along           torques along
    =============  =====================  =====================
    fixed          x, y, z                x, y, z
    revolute       x, y, z                both across the axis
    prismatic      both across the axis   x, y, z
    cylindrical    both across the axis   both across the axis
    spherical      x, y, z                none
    general        across all slides      across all turns
    =============  =====================  =====================

The rows are taken at that point of the joint that is nearest to the centre of the smaller free
part: a fixed or prismatic joint is equivalent about any point, a joint with an axis about any point
of the axis. So a distant `point` costs no digits. In a planar program the rows that act out of the
plane are omitted.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask, across, cross
from kilter.assembly import GROUND, Assembly, Joint
from kilter.assembly.geometry import Geometry
from kilter.rigid import unit


def joint_constraints(
    assembly: Assembly, number: int
) -> tuple[tuple[int, int], Array, Array, Array]:
    """Data of the rows of a joint: its parts (-1: ground), point, force and torque directions."""
    joint = assembly.joints[number]
    linear, angular = constraints(joint, planar=assembly.planar)
    anchor = _anchor(assembly, assembly.geometry, joint)
    return _joint_parts(assembly, joint), anchor, linear, angular


def constraints(joint: Joint, *, planar: bool = False) -> tuple[Array, Array]:
    """Directions in which a joint transmits force and torque, shapes (m, 3) and (n, 3).

    Each set is orthonormal, in the world frame; a planar joint has only those of the plane of
    motion.

    Examples
    --------
    >>> hinge = Joint(("a", "b"), "revolute", point=[0, 0, 0], axis=[0, 1, 0])
    >>> [len(directions) for directions in constraints(hinge)]
    [3, 2]
    >>> [len(directions) for directions in constraints(hinge, planar=True)]
    [2, 0]
    """
    if joint.kind == "general":
        return _across_all(joint.slides), _across_all(joint.turns)
    all_axes, no_axes = np.eye(3), np.empty((0, 3))
    transverse = no_axes if joint.axis is None else _transverse(joint.axis, planar)
    linear = transverse if joint.kind in ("prismatic", "cylindrical") else all_axes
    angular = {"revolute": transverse, "cylindrical": transverse, "spherical": no_axes}.get(
        joint.kind, all_axes
    )
    if planar:  # directions are along y or across it: see `Joint.require_planar`
        return linear[np.abs(linear[:, 1]) < 0.5], angular[np.abs(angular[:, 1]) > 0.5]
    return linear, angular


def _across_all(directions: Array) -> Array:
    """Orthonormal vectors perpendicular to up to three independent directions, (3 - k, 3)."""
    if len(directions) == 1:
        return np.stack(across(directions[0]))
    if len(directions) == 2:
        return unit(cross(*directions), "normal of two directions")[None]
    return np.eye(3) if not len(directions) else np.empty((0, 3))


def _transverse(axis: Array, planar: bool) -> Array:
    """Two unit vectors perpendicular to an axis, shape (2, 3)."""
    if planar:
        axis_along_y = abs(axis[1]) > 0.5
        return (
            np.eye(3)[[0, 2]] if axis_along_y else np.array([[0, 1.0, 0], [-axis[2], 0, axis[0]]])
        )
    return np.stack(across(np.asarray(axis, dtype=np.float64)))


def _joint_parts(assembly: Assembly, joint: Joint) -> tuple[int, int]:
    """Indices of the two parts of a joint; -1 stands for the ground."""
    a, b = (-1 if name == GROUND else assembly.index_of(name) for name in joint.parts)
    return a, b


def _anchor(assembly: Assembly, geometry: Geometry, joint: Joint) -> Array:
    """Point at which the rows of a joint act, near the smaller free part, shape (3,)."""
    parts = [k for k in _joint_parts(assembly, joint) if k >= 0]
    free = [k for k in parts if not geometry.grounded[k]] or parts
    center: Array = geometry.center[min(reversed(free), key=lambda k: geometry.radius[k])]
    # these joints transmit every torque, so their rows may act at any point
    if joint.kind in ("fixed", "prismatic") or joint.point is None:
        return center
    point = np.asarray(joint.point)
    if joint.kind in ("spherical", "general"):  # they may have an axis, which is unused
        return point
    # the point of the axis nearest to the centre keeps the lever arms short
    along: Array = point + joint.axis * float(joint.axis @ (center - point))
    return along


def spring_wrenches(assembly: Assembly) -> Array:
    """Wrenches of the springs of all joints on the parts, about their centres, shape (N, 6)."""
    total = np.zeros((len(assembly.parts), 6))
    for joint in assembly.joints:
        if not joint.stiffness * joint.rest:
            continue
        along = joint.stiffness * joint.rest * np.asarray(joint.axis)
        at = _anchor(assembly, assembly.geometry, joint)
        for part, sign in zip(_joint_parts(assembly, joint), (1.0, -1.0), strict=True):
            if part < 0:
                continue
            if joint.kind == "revolute":
                total[part, 3:] += sign * along
            else:
                total[part, :3] += sign * along
                total[part, 3:] += sign * cross(at - assembly.geometry.center[part], along)
    return total


def reference_point(assembly: Assembly, number: int) -> Array:
    """Point about which the wrench of a joint is reported: its own or that of its rows."""
    joint = assembly.joints[number]
    if joint.point is not None:
        return np.asarray(joint.point)
    return _anchor(assembly, assembly.geometry, joint)


def joint_wrench(normal: Array, angular: Mask, at: Array, forces: Array, about: Array) -> Array:
    """Wrench of a joint on its second part from the forces of its rows, shape (6,).

    Arguments: `normal` (k, 3): directions of the rows; `angular` (k,): True for rows that carry a
    torque; `at` (3,): point of the rows; `forces` (k,): forces [N] and torques [N x length unit] of
    the rows; `about` (3,): reference point of the wrench.
    """
    force, torque = (forces[mask] @ normal[mask] for mask in (~angular, angular))
    return np.concatenate([force, torque + cross(at - about, force)])


def joint_forces(normal: Array, angular: Mask, at: Array, wrench: Array, about: Array) -> Array:
    """Forces of the rows of a joint, shape (k,), that transmit a given wrench to its second part.

    Components that the joint cannot carry are dropped: `joint_wrench` of the result then differs
    from `wrench`.

    Arguments: `normal` (k, 3): directions of the rows; `angular` (k,): True for rows that carry a
    torque; `at` (3,): point of the rows; `wrench` (6,): force [N] and torque [N x length unit] on
    the second part; `about` (3,): reference point of the wrench.
    """
    torque = wrench[3:] + cross(about - at, wrench[:3])
    return np.where(angular, normal @ torque, normal @ wrench[:3])
