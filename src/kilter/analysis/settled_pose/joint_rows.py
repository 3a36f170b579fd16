"""Joints of bodies that move: constraints, and limits, friction and springs along free motions.

A row is the rate at which the second body of a joint passes the first, along a direction or about
it. The position q of a joint is how far its first body has passed the second, so its rate is the
negative of such a row along the axis of the joint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack

from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, Mask
from kilter.assembly import GROUND, Joint
from kilter.mechanics.joints import constraints


@dataclass(slots=True)
class _Rows:
    """Rows of joints, in lists: bodies, point, direction, and whether it is an axis of turning."""

    ends: list[tuple[int, int]]
    point: list[Array]
    direction: list[Array]
    angular: list[bool]

    @staticmethod
    def empty() -> _Rows:
        return _Rows([], [], [], [])

    def add(self, ends: tuple[int, int], point: Array, direction: Array, angular: bool) -> None:
        """Append a row."""
        self.ends.append(ends)
        self.point.append(point)
        self.direction.append(direction)
        self.angular.append(angular)

    def rates(self, bodies: RigidBodies, length: float) -> csr_array:
        """Rates for unit motions of the F free bodies, shape (n, 6 F)."""
        ends = np.array(self.ends, dtype=np.int64).reshape(-1, 2)
        point, along = (np.array(v).reshape(-1, 3) for v in (self.point, self.direction))
        angular: Mask = np.array(self.angular, dtype=bool)
        number = np.cumsum(bodies.free) - 1
        data, row, column = [], [], []
        for side, sign in ((0, -1.0), (1, 1.0)):
            rows = np.flatnonzero(bodies.free[ends[:, side]])
            body = ends[rows, side]
            turns, n = angular[rows, None], along[rows]
            torque = np.cross((point[rows] - bodies.center[body]) / length, n)
            entries = np.concatenate([np.where(turns, 0.0, n), np.where(turns, n, torque)], axis=1)
            data.append(sign * entries.ravel())
            row.append(np.repeat(rows, 6))
            column.append((6 * number[body][:, None] + np.arange(6)).ravel())
        at = np.concatenate(row), np.concatenate(column)
        shape = (len(ends), 6 * int(bodies.free.sum()))
        return csr_array(coo_array((np.concatenate(data), at), shape=shape))


def joint_rates(bodies: RigidBodies, length: float) -> tuple[csr_array, Array]:
    """Rates and errors of the constraints of all joints that are not fixed."""
    from scipy.spatial.transform import Rotation

    assembly = bodies.drawn
    rows, drift = _Rows.empty(), []
    for joint in assembly.joints:
        a, b = ends = bodies.ends(joint)
        if a == b or joint.kind == "fixed":
            continue
        linear, angular = (
            np.asarray(each) @ bodies.rotation[a].T
            for each in constraints(joint, planar=assembly.planar)
        )
        at = bodies.anchors(joint)
        turned = Rotation.from_matrix(bodies.rotation[b] @ bodies.rotation[a].T).as_rotvec()
        for d in linear:
            rows.add(ends, at[1], d, False)
            drift.append(float(d @ (at[1] - at[0])) / length)
        for d in angular:
            rows.add(ends, at[1], d, True)
            drift.append(float(d @ turned))
    return rows.rates(bodies, length), np.array(drift, dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class JointGuides:
    """The G joints with limits, friction or a spring, in the current pose.

    Positions are in units of length or [rad], forces in units of force or of force times length.
    """

    rate: csr_array
    """Rates of the positions for unit motions of the F free bodies, shape (G, 6 F)."""
    stop: csr_array
    room: Array
    """Rates of the S distances to limits, shape (S, 6 F), and these distances, shape (S,)."""
    stop_parts: Index
    """The two parts of the joint of each limit, shape (S, 2); -1 is the ground."""
    friction: Array
    """Largest friction, shape (G,)."""
    stiffness: Array
    """Force of the spring for a unit of the position, shape (G,)."""
    spring: Array
    """Force of the spring in the current pose, along the position, shape (G,)."""

    @staticmethod
    def of(bodies: RigidBodies, length: float, weight: float) -> JointGuides:
        """Read the joints; `length` and `weight` are the units of length and force."""
        joints = [j for j in bodies.drawn.joints if j.guide and len(set(bodies.ends(j))) == 2]
        rows = _Rows.empty()
        for joint in joints:
            axis = bodies.rotation[bodies.ends(joint)[0]] @ joint.axis
            rows.add(bodies.ends(joint), bodies.anchors(joint)[1], -axis, joint.kind == "revolute")
        rate = rows.rates(bodies, length)
        unit = np.where(rows.angular, 1.0, length)
        q = np.array([bodies.joint_position(joint) for joint in joints], dtype=np.float64)
        limited = np.array([k for k, j in enumerate(joints) if j.limits is not None], np.int64)
        low, high = np.array([joints[k].limits for k in limited], np.float64).reshape(-1, 2).T
        room = np.concatenate([q[limited] - low, high - q[limited]]) / np.tile(unit[limited], 2)
        parts = np.array([_parts(bodies, j) for j in joints], np.int64).reshape(-1, 2)[limited]
        values = np.array([(j.friction, j.stiffness, j.rest) for j in joints]).reshape(-1, 3)
        friction, stiffness, rest = values.T
        force = weight * np.where(rows.angular, length, 1.0)
        return JointGuides(
            rate, csr_array(vstack([rate[limited], -rate[limited]], format="csr")), room,
            np.tile(parts, (2, 1)), friction / force, stiffness * unit / force,
            stiffness * (rest - q) / force,
        )  # fmt: skip

    @property
    def load(self) -> Array:
        """Forces and torques of the springs on the free bodies, shape (6 F,)."""
        load: Array = self.rate.T @ self.spring
        return load


def _parts(bodies: RigidBodies, joint: Joint) -> tuple[int, int]:
    """The two parts of a joint; -1 for the ground."""
    index = bodies.drawn.index
    a, b = (-1 if name == GROUND else index[name] for name in joint.parts)
    return a, b


def spring_energy(bodies: RigidBodies) -> Array:
    """Energy of the springs of joints in the current pose, at a body of each, shape (B,)."""
    energy = np.zeros(len(bodies.mass))
    for joint in bodies.drawn.joints:
        if joint.stiffness:
            stretched = bodies.joint_position(joint) - joint.rest
            energy[max(bodies.ends(joint))] += joint.stiffness * stretched**2 / 2
    return energy
