"""Equal groups of bodies come to rest once: the others take the same rest at their place.

Groups are equal up to a shift and a turn about the vertical. The rest of a group is that of its
copies if nothing else is near their ways:

- A cylinder about the vertical through the group contains all its bodies on their whole ways. No
  cylinder of a group with copies meets that of another group.
- Of the held parts that meet the cylinders, each is a convex polytope, and the half spaces that cut
  the cylinder of the group and of its copy are equal.

The pose at rest of all bodies is verified as any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.equal_groups import COPY_DIGITS, equal_groups
from kilter.analysis.settled_pose.rest import WayStep
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, Mask, connected
from kilter.assembly import Assembly
from kilter.contact.convex_pieces import ConvexPieces, convex_pieces
from kilter.contact.convex_points import box_pairs

NEAR = 0.02
"""Distance of the boxes of parts of a group, and of its ways from those of others [sizes]."""


@dataclass(frozen=True, slots=True, eq=False)
class BodyCopies:
    """Groups of bodies, of which some are equal to earlier ones."""

    bodies: RigidBodies
    """The bodies in the drawn pose."""
    group: Index
    """Group of each body, shape (B,); -1 for the ground."""
    source: Index
    """Body whose rest each body takes, shape (B,): itself, or that of an equal group."""
    turn: Array
    """Turn from the source to each body, shape (B, 3, 3)."""

    @property
    def chosen(self) -> Mask:
        """Bodies that come to rest by themselves, shape (B,)."""
        mask: Mask = (self.source == np.arange(len(self.source))) & self.bodies.free
        return mask

    def at_rest(self, settled: RigidBodies) -> RigidBodies:
        """All bodies at rest, from those of `bodies.only(chosen)` at rest."""
        whole, source, turn = self.bodies.with_poses(self.chosen, settled), self.source, self.turn
        shift = whole.center[source] - whole.drawn_center[source]
        center = whole.drawn_center + np.einsum("bij,bj->bi", turn, shift)
        rotation = turn @ whole.rotation[source] @ turn.transpose(0, 2, 1)
        placed = replace(whole, center=center, rotation=rotation)
        return whole.where(source == np.arange(len(source)), placed)

    def are_apart(self, ways: Sequence[Sequence[WayStep]], gone: Mask) -> bool:
        """Whether nothing differs near the ways (B,) of equal groups.

        Bodies that are `gone` (B,) fall out of the scene.
        """
        middle, low, high, radius = self._cylinders(ways, gone)
        copied = np.zeros(len(radius), dtype=bool)
        pairs = np.unique(np.column_stack([self.group, self.group[self.source]]), axis=0)
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        copied[pairs] = True
        down = self.bodies.drawn.down
        apart = middle[:, None] - middle[None]
        apart -= (apart @ down)[..., None] * down
        meets = np.linalg.norm(apart, axis=2) <= radius[:, None] + radius[None]
        meets &= (low[:, None] <= high[None]) & (low[None] <= high[:, None])
        np.fill_diagonal(meets, val=False)
        if meets[copied].any():
            return False
        around = _HeldPlanes.of(self.bodies.drawn)
        turns = np.tile(np.eye(3), (len(radius), 1, 1))
        turns[self.group[1:]] = self.turn[1:]
        seen = {
            k: around.cutting((middle[k], low[k], high[k], radius[k]), turns[k])
            for k in np.unique(pairs).tolist()
        }
        return all(seen[a] is not None and seen[a] == seen[b] for a, b in pairs.tolist())

    def _cylinders(
        self, ways: Sequence[Sequence[WayStep]], gone: Mask
    ) -> tuple[Array, Array, Array, Array]:
        """The cylinder of each group: a point of its axis (G, 3), ends along gravity, radius (G,).

        The middle of a group is that of its bodies, so that it moves with the group.
        """
        bodies, geometry = self.bodies, self.bodies.drawn.geometry
        down, count = bodies.drawn.down, int(self.group.max()) + 1
        aside, along = np.zeros((2, len(bodies.mass)))
        for k, way in enumerate(ways):
            turned = sum(np.radians(step.angle_deg) for step in way) * bodies.size[k] / 2
            aside[k] = turned + sum(step.distance for step in way if step.how != "fell")
            along[k] = turned + sum(step.distance for step in way)
        along[gone] += np.ptp(geometry.vertices @ down)
        middle = np.zeros((count, 3))
        np.add.at(middle, self.group[1:], bodies.drawn_center[1:])
        middle /= np.bincount(self.group[1:])[:, None]
        owner = bodies.of_part[geometry.vertex_part]
        slack = (geometry.slack + NEAR * geometry.size)[geometry.vertex_part[owner > 0]]
        points, owner = geometry.vertices[owner > 0], owner[owner > 0]
        group = self.group[owner]
        arm = points - middle[group]
        depth = arm @ down
        across = np.linalg.norm(arm - depth[:, None] * down, axis=1)
        radius, low, high = np.zeros(count), np.full(count, np.inf), np.full(count, -np.inf)
        np.maximum.at(radius, group, across + aside[owner] + slack)
        np.minimum.at(low, group, points @ down - along[owner] - slack)
        np.maximum.at(high, group, points @ down + along[owner] + slack)
        return middle, low, high, radius


@dataclass(frozen=True, slots=True, eq=False)
class _HeldPlanes:
    """The half spaces of held parts, in the world."""

    assembly: Assembly
    pieces: ConvexPieces
    held: Index
    """Held parts."""

    @staticmethod
    def of(assembly: Assembly) -> _HeldPlanes:
        """Collect the half spaces of an assembly."""
        held = np.flatnonzero(assembly.geometry.grounded)
        return _HeldPlanes(assembly, convex_pieces(assembly), held)

    def cutting(
        self, cylinder: tuple[Array, float, float, float], turn: Array
    ) -> list[bytes] | None:
        """The half spaces that cut an upright cylinder, of each part that meets it, as keys.

        They are relative to the middle of the cylinder, and turned back. None: a part that may meet
        it is no polytope.

        Arguments: `cylinder`: point of the axis, ends along gravity, radius.
        """
        (middle, low, high, radius), keys = cylinder, []
        geometry, down = self.assembly.geometry, self.assembly.down
        size = max(radius, high - low)
        for k in self.held.tolist():
            points = geometry.vertices[geometry.vertex_start[k] : geometry.vertex_start[k + 1]]
            far = points.min(axis=0) - middle, middle - points.max(axis=0)
            reach = radius + high - low + geometry.slack[k]
            if max(map(np.max, far)) > reach:
                continue
            pieces = np.flatnonzero(self.pieces.part == k)
            if not self.pieces.whole[k] or len(pieces) != 1:
                return None
            piece = int(pieces[0])
            if self.pieces.radius[piece] or self.pieces.disc[piece]:
                return None
            rows = slice(self.pieces.face_start[piece], self.pieces.face_start[piece + 1])
            pose = self.assembly.parts[k].pose
            normal = self.pieces.normal[rows] @ pose.matrix.T
            offset = self.pieces.offset[rows] + normal @ (pose.position - middle)
            upright = normal @ down
            across = radius * np.sqrt(np.maximum(1 - upright**2, 0.0))
            ends = np.outer(upright, [low - middle @ down, high - middle @ down])
            if (ends.min(axis=1) - across > offset).any():
                continue
            cuts = ends.max(axis=1) + across > offset
            planes = np.column_stack([normal[cuts] @ turn, offset[cuts] / size])
            planes = planes.round(COPY_DIGITS - 1) + 0.0
            keys.append(planes[np.lexsort(planes.T)].tobytes())
        return sorted(keys)


def find_copies(bodies: RigidBodies) -> BodyCopies | None:
    """Find the equal groups of bodies; None if there are none, or something may tell them apart.

    Loads, joints, given contacts and friction of pairs are not compared.
    """
    drawn, geometry = bodies.drawn, bodies.drawn.geometry
    told = drawn.loads or drawn.contacts or drawn.friction_pairs or drawn.straps or drawn.planar
    if told or any(joint.kind != "fixed" for joint in drawn.joints):
        return None
    if bodies.changed.any() or not bodies.moves[1:].all() or len(bodies.mass) < 3:
        return None
    begin = geometry.vertex_start[:-1]
    low = np.minimum.reduceat(geometry.vertices, begin)
    high = np.maximum.reduceat(geometry.vertices, begin)
    ends = np.column_stack(box_pairs(low, high, geometry.slack + NEAR * geometry.size))
    ends = bodies.of_part[ends]
    ends = ends[(ends > 0).all(axis=1)]
    group = connected(len(bodies.mass), *ends.T)
    group = np.unique(group[1:], return_inverse=True)[1]
    of_part = np.append(-1, group)[bodies.of_part]
    order = np.argsort(of_part, kind="stable")
    members = np.split(order, np.searchsorted(of_part[order], np.arange(group.max() + 1)))[1:]
    source, turn = np.arange(len(bodies.mass)), np.tile(np.eye(3), (len(bodies.mass), 1, 1))
    for k, (first, turned) in equal_groups(drawn, members).items():
        own, other = bodies.of_part[members[k]], bodies.of_part[members[first]]
        if _are_equal(bodies, own, other, turned):
            source[own], turn[own] = other, turned
    if (source == np.arange(len(source))).all():
        return None
    return BodyCopies(bodies, np.append(-1, group), source, turn)


def _are_equal(bodies: RigidBodies, own: Index, other: Index, turn: Array) -> bool:
    """Whether bodies of parts are equal to others in the same order: the same parts and masses."""
    pairs = np.unique(np.column_stack([own, other]), axis=0)
    if len(pairs) != len(np.unique(own)) or len(pairs) != len(np.unique(other)):
        return False
    first, second = pairs.T
    arms = bodies.center[first] - bodies.center[first[0]]
    others = (bodies.center[second] - bodies.center[second[0]]) @ turn.T
    near = 10.0**-COPY_DIGITS
    same = np.abs(arms - others).max() <= near * bodies.size[first].max()
    return bool(same and np.allclose(bodies.mass[first], bodies.mass[second], rtol=near, atol=0.0))
