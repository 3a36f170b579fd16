"""Rigid bodies: parts that move as one, and their poses during the search.

Parts with a fixed joint or a bond between them form a body, as do all held parts. A pose takes a
point x of the drawn assembly to R (x - c0) + c, where c0 is the drawn centre of mass of the body.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, connected
from kilter.assembly import GROUND, Assembly, Joint, Part
from kilter.rigid import Pose, matrix_to_quaternion


@dataclass(frozen=True, slots=True, eq=False)
class RigidBodies:
    """The bodies of an assembly in their current poses; body 0 is the ground with held parts."""

    drawn: Assembly
    """The assembly in the drawn pose."""
    of_part: Index
    """Body of each part, shape (N,)."""
    moves: Mask
    """Whether each body may move, shape (B,)."""
    mass: Array
    """Masses [kg], shape (B,)."""
    size: Array
    """Diameter of each body about its centre of mass [length unit], shape (B,)."""
    drawn_center: Array
    center: Array
    """Centres of mass in the drawn and in the current pose [length unit], shape (B, 3)."""
    rotation: Array
    """Rotation from the drawn to the current pose, shape (B, 3, 3)."""

    @property
    def free(self) -> Mask:
        """Mask of the bodies that are not held, shape (B,)."""
        return np.arange(len(self.mass)) > 0

    @property
    def changed(self) -> Mask:
        """Mask of the bodies that may move and are not in their drawn pose, shape (B,)."""
        shifted = (self.center != self.drawn_center).any(axis=1)
        turned = (self.rotation != np.eye(3)).any(axis=(1, 2))
        mask: Mask = self.moves & (shifted | turned)
        return mask

    def placed(self, body: int, point: Array) -> Array:
        """A drawn point of a body in the current pose."""
        result: Array = self.rotation[body] @ (point - self.drawn_center[body]) + self.center[body]
        return result

    def moved(self, step: Array) -> RigidBodies:
        """The bodies after a step: shift [length unit] and rotation vector [rad], shape (B, 6)."""
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_rotvec(step[:, 3:]).as_matrix()
        return replace(self, center=self.center + step[:, :3], rotation=turn @ self.rotation)

    def screwed(self, step: Array) -> RigidBodies:
        """The bodies after screw motions with the velocities of a step (B, 6).

        A body turns about its instantaneous axis exactly, so that a point at rest stays at rest.
        """
        from scipy.spatial.transform import Rotation

        spin = step[:, 3:]
        turn = Rotation.from_rotvec(spin).as_matrix()
        angle = np.linalg.norm(spin, axis=1)
        small = angle < 1e-4
        safe = np.where(small, 1.0, angle)
        first = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
        second = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
        across = np.cross(spin, step[:, :3])
        shift = step[:, :3] + first[:, None] * across
        shift += second[:, None] * np.cross(spin, across)
        return replace(self, center=self.center + shift, rotation=turn @ self.rotation)

    def travel(self, step: Array) -> Array:
        """Longest way of a point of each body in a step (B, 6), to first order; shape (B,)."""
        shift, turn = (np.linalg.norm(step[:, k : k + 3], axis=1) for k in (0, 3))
        far: Array = shift + turn * self.size / 2
        return far

    def where(self, chosen: Mask, other: RigidBodies) -> RigidBodies:
        """The poses of the chosen bodies (B,), and those of `other` for the rest."""
        return replace(
            self,
            center=np.where(chosen[:, None], self.center, other.center),
            rotation=np.where(chosen[:, None, None], self.rotation, other.rotation),
        )

    def only(self, group: Mask) -> RigidBodies:
        """The bodies of a group (B,), numbered from 1; all others are held as they are drawn."""
        kept = np.append(0, np.flatnonzero(group))
        number = np.where(group, np.cumsum(group), 0)
        every = (self.moves, self.mass, self.size, self.drawn_center, self.center, self.rotation)
        return RigidBodies(self.drawn, number[self.of_part], *(each[kept] for each in every))

    def with_poses(self, group: Mask, other: RigidBodies) -> RigidBodies:
        """The bodies, with the poses of those of `only(group)` from `other`."""
        center, rotation = self.center.copy(), self.rotation.copy()
        center[group], rotation[group] = other.center[1:], other.rotation[1:]
        return replace(self, center=center, rotation=rotation)

    def assembly(self) -> Assembly:
        """The assembly in the current pose; joints and points of loads and bonds follow.

        A joint follows its first part, or its second part if the first is the ground.
        """
        drawn = self.drawn
        if not self.changed.any():
            return drawn
        parts = self.parts(range(len(drawn.parts)))
        joints, loads, bonds = list(drawn.joints), list(drawn.loads), list(drawn.bonds)
        for k, joint in enumerate(joints):
            body = self.body_of(joint.parts[1 if joint.parts[0] == GROUND else 0])
            point = None if joint.point is None else self.placed(body, joint.point)
            position = self.joint_position(joint) if joint.guide else 0.0
            joints[k] = joint.moved(point, self.rotation[body], position)
        for k, load in enumerate(loads):
            if load.point is not None:
                loads[k] = replace(load, point=self.placed(self.body_of(load.part), load.point))
        for k, bond in enumerate(bonds):
            if bond.points is not None:
                body = self.body_of(bond.parts[0])
                points = np.array([self.placed(body, point) for point in bond.points])
                bonds[k] = replace(bond, points=points, normal=self.rotation[body] @ bond.normal)
        return replace(drawn, parts=parts, joints=joints, loads=loads, bonds=bonds)

    def parts(self, chosen: Iterable[int]) -> list[Part]:
        """Chosen parts in the current pose."""
        parts, changed = [], self.changed
        for k in chosen:
            part, body = self.drawn.parts[k], int(self.of_part[k])
            if changed[body]:
                turned = matrix_to_quaternion(self.rotation[body] @ part.pose.matrix)
                part = replace(part, pose=Pose(self.placed(body, part.pose.position), turned))
            parts.append(part)
        return parts

    def body_of(self, name: str) -> int:
        """Body of a part, by name; 0 for the ground."""
        return 0 if name == GROUND else int(self.of_part[self.drawn.index[name]])

    def ends(self, joint: Joint) -> tuple[int, int]:
        """The two bodies of a joint."""
        first, second = joint.parts
        return self.body_of(first), self.body_of(second)

    def anchors(self, joint: Joint) -> tuple[Array, Array]:
        """The point of a joint in the current pose, as a point of its first and second body."""
        a, b = self.ends(joint)
        anchor = joint.point if joint.point is not None else self.drawn_center[b or a]
        return self.placed(a, anchor), self.placed(b, anchor)

    def joint_position(self, joint: Joint) -> float:
        """Position of a joint along its axis in the current pose [length unit] or [rad].

        Of the equal angles it is the nearest to the middle of the limits, or to the drawn pose.
        """
        from scipy.spatial.transform import Rotation

        a, b = self.ends(joint)
        axis = self.rotation[a] @ joint.axis
        if joint.kind == "prismatic":
            first, second = self.anchors(joint)
            return float(axis @ (first - second))
        turn = Rotation.from_matrix(self.rotation[a] @ self.rotation[b].T)
        angle = float(axis @ turn.as_rotvec())
        middle = 0.0 if joint.limits is None else sum(joint.limits) / 2
        return angle + 2 * np.pi * round((middle - angle) / (2 * np.pi))

    def movements(self) -> Array:
        """Shift of the centre of mass of each part, and its rotation vector [rad], shape (N, 6)."""
        from scipy.spatial.transform import Rotation

        center, body = self.drawn.geometry.center, self.of_part
        shift = np.einsum("nij,nj->ni", self.rotation[body], center - self.drawn_center[body])
        shift += self.center[body] - center
        turn = Rotation.from_matrix(self.rotation).as_rotvec()[body]
        six = np.concatenate([shift, turn], axis=1)
        return np.where(self.changed[body, None], six, 0.0)


def rigid_bodies(assembly: Assembly, keep: Collection[str]) -> RigidBodies:
    """Build the bodies of an assembly; those with a part in `keep` do not move."""
    geometry = assembly.geometry
    count = len(assembly.parts)
    first, second = [], np.flatnonzero(geometry.grounded).tolist()
    first += [count] * len(second)
    tied = [joint.parts for joint in assembly.joints if joint.kind == "fixed"]
    tied += [bond.parts for bond in assembly.bonds]
    for parts in tied:
        ends = [count if name == GROUND else assembly.index[name] for name in parts]
        first.append(ends[0])
        second.append(ends[1])
    label = connected(count + 1, np.array(first, np.int64), np.array(second, np.int64))
    # the ground gets the number 0
    others = np.unique(label[label != label[-1]])
    of_part = np.searchsorted(others, label[:-1]) + 1
    of_part[label[:-1] == label[-1]] = 0
    bodies = len(others) + 1
    mass = np.zeros(bodies)
    np.add.at(mass, of_part, geometry.mass)
    center = np.zeros((bodies, 3))
    np.add.at(center, of_part, geometry.mass[:, None] * geometry.center)
    center /= np.maximum(mass, np.finfo(float).tiny)[:, None]
    reach = np.linalg.norm(geometry.vertices - center[of_part[geometry.vertex_part]], axis=1)
    size = np.zeros(bodies)
    np.maximum.at(size, of_part[geometry.vertex_part], 2 * reach)
    moves = np.arange(bodies) > 0
    moves[[of_part[assembly.index[name]] for name in keep]] = False
    return RigidBodies(
        assembly, of_part, moves, mass, size, center, center, np.tile(np.eye(3), (bodies, 1, 1))
    )
