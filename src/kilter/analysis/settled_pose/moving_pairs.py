"""Candidate points of pairs of parts that convex pieces do not cover, while bodies move.

In a step, few parts move. A pair whose parts have kept their poses keeps its points. All other
pairs within reach are examined in a small assembly of their parts.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.analysis.settled_pose.near_points import NearPoints, both_of, find_near_points
from kilter.arrays import Array, Index, Mask, ragged
from kilter.assembly import Assembly, Part
from kilter.contact.convex_points import box_pairs
from kilter.rigid import Pose, matrix_to_quaternion

LARGEST = 0.25
"""Largest growth of a penetration in a movement, over the size of the smaller part [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class _KnownPairs:
    """Points of examined pairs: their keys, ascending, with the poses and the reach."""

    key: Index
    pose: Array
    """Poses of both parts, shape (P, 24)."""
    reach: Array
    start: Index
    """The points of pair k are rows ``start[k]`` to ``start[k + 1]`` of `points`."""
    points: NearPoints

    @staticmethod
    def none() -> _KnownPairs:
        """No pair."""
        empty = np.empty(0, dtype=np.int64)
        start = np.zeros(1, dtype=np.int64)
        return _KnownPairs(empty, np.empty((0, 24)), np.empty(0), start, NearPoints.none())


@dataclass(slots=True, eq=False)
class MovingPairs:
    """The pairs of parts of an assembly that convex pieces do not cover."""

    assembly: Assembly
    covered: Mask
    """Parts that convex pieces cover, shape (N,)."""
    ignored: Index
    """Keys of pairs without contact: a N + b for parts a < b."""
    low: Array
    high: Array
    """Boxes of the parts in their own frames, shape (N, 3)."""
    known: _KnownPairs = field(default_factory=_KnownPairs.none)

    @staticmethod
    def of(assembly: Assembly, covered: Mask, ignored: Index) -> MovingPairs:
        """Prepare the pairs of an assembly.

        Arguments: `covered` (N,); `ignored` (n, 2): pairs of parts without contact.
        """
        geometry = assembly.geometry
        local = [
            (geometry.vertices[geometry.vertex_start[k] : geometry.vertex_start[k + 1]]
             - part.pose.position) @ part.pose.matrix
            for k, part in enumerate(assembly.parts)
        ]  # fmt: skip
        grow = geometry.slack[:, None]
        ends = np.sort(np.asarray(ignored, dtype=np.int64).reshape(-1, 2), axis=1)
        return MovingPairs(
            assembly, covered, ends @ np.array([len(local), 1]),
            np.array([points.min(axis=0) for points in local]) - grow,
            np.array([points.max(axis=0) for points in local]) + grow,
        )  # fmt: skip

    def near(self, rotation: Array, position: Array, body: Index, reach: Array) -> NearPoints:
        """Points of pairs of parts of different bodies, without friction.

        Arguments: `rotation` (N, 3, 3), `position` (N, 3): poses of the parts; `body` (N,): body of
        each part; `reach` (N,): largest gap of a point of each part [length unit], of which the
        larger counts for a pair.
        """
        a, b = self._pairs(rotation, position, body, reach)
        limit = np.maximum(reach[a], reach[b])
        flat = np.concatenate([rotation.reshape(-1, 9), position], axis=1)
        key, pose = a * len(body) + b, np.concatenate([flat[a], flat[b]], axis=1)
        place, same, deep = self._last_search(key, pose, limit)
        new = np.flatnonzero(~same)
        used_reach = float(np.maximum(limit, deep)[new].max(initial=0.0))
        found = self._examined(rotation, position, np.column_stack([a, b])[new], used_reach)
        kept = self.known.points.take(ragged(self.known.start, place[same])[1])
        points = NearPoints.join([kept, found])
        used = np.full(len(key), used_reach)
        if same.any():
            used[same] = self.known.reach[place[same]]
        self.known = _sorted(key, pose, used, points, len(body))
        limit = np.maximum(reach[points.part_a], reach[points.part_b])
        return points.take(points.gap <= limit)

    def _last_search(self, key: Index, pose: Array, limit: Array) -> tuple[Index, Mask, Array]:
        """Row of each pair in the last search, whether its points are still valid, and its depth.

        The depth is the largest that the pair may have now [length unit]: that of the last search
        and the movement of both parts since then. A penetration deeper than the reach of a search
        would not be found.
        """
        known, deep = self.known, np.zeros(len(key))
        if not len(known.key):
            return np.zeros(len(key), np.int64), np.zeros(len(key), dtype=bool), deep
        place = np.minimum(np.searchsorted(known.key, key), len(known.key) - 1)
        there = known.key[place] == key
        change = pose - known.pose[place]
        same = there & (known.reach[place] >= limit) & (change == 0).all(axis=1)
        owner, row = ragged(known.start, place)
        np.maximum.at(deep, owner, -known.points.gap[row])
        ends = np.column_stack(np.divmod(key, len(self.low)))
        middle, size = (self.low + self.high) / 2, np.linalg.norm(self.high - self.low, axis=1)
        turn, shift = change.reshape(-1, 2, 12)[..., :9], change.reshape(-1, 2, 12)[..., 9:]
        turn = turn.reshape(-1, 2, 3, 3)
        moved = np.linalg.norm(shift + np.einsum("kpij,kpj->kpi", turn, middle[ends]), axis=2)
        moved += np.linalg.norm(turn, axis=(2, 3)) * size[ends] / 2
        deep += np.minimum(moved.sum(axis=1), LARGEST * size[ends].min(axis=1))
        return place, same, np.where(there, deep, 0.0)

    def _pairs(
        self, rotation: Array, position: Array, body: Index, reach: Array
    ) -> tuple[Index, Index]:
        """Parts a < b of different bodies whose boxes are within a reach, not both covered."""
        middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
        center = np.einsum("nij,nj->ni", rotation, middle) + position
        grown = np.einsum("nij,nj->ni", np.abs(rotation), half)
        i, j = box_pairs(center - grown, center + grown, reach)
        pairs = np.sort(np.column_stack([i, j]), axis=1)
        held = self.assembly.geometry.grounded
        keep = ~both_of(self.covered, pairs) & ~both_of(held, pairs)
        a, b = pairs.T
        keep &= (body[a] != body[b]) & ~np.isin(a * len(body) + b, self.ignored)
        return a[keep], b[keep]

    def _examined(self, rotation: Array, position: Array, pairs: Index, reach: float) -> NearPoints:
        """Points of pairs of parts in a small assembly of only these parts."""
        if not len(pairs):
            return NearPoints.none()
        used, number = np.unique(pairs, return_inverse=True)
        quaternion = matrix_to_quaternion
        parts = [
            Part(part.name, part.shape, Pose(position[k], quaternion(rotation[k])), mass=1.0)
            for k, part in ((k, self.assembly.parts[k]) for k in used.tolist())
        ]
        small = Assembly(parts, units=self.assembly.units)
        points = find_near_points(small, reach, reach, pairs=number.reshape(-1, 2))
        a, b = used[points.part_a], used[points.part_b]
        return NearPoints(
            a, b, points.point, points.normal, points.gap, np.zeros(len(a)), points.bears
        )


def _sorted(key: Index, pose: Array, reach: Array, points: NearPoints, count: int) -> _KnownPairs:
    """Pairs in the order of their keys, with their points."""
    order = np.argsort(key)
    of_point = points.part_a * count + points.part_b
    points = points.take(np.argsort(of_point, kind="stable"))
    start = np.searchsorted(np.sort(of_point), key[order])
    return _KnownPairs(key[order], pose[order], reach[order], np.append(start, len(points)), points)
