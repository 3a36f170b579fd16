"""Candidate points of moving bodies: convex pieces by distance, all other parts by their faces.

Parts that consist of convex pieces (boxes, convex meshes, compounds of a simulator) have points by
the distances of their pieces (`kilter.contact.convex_points`), in arrays and without a new
assembly. All other pairs of parts have the points of `near_points`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from kilter.analysis.settled_pose.near_points import NearPoints, find_near_points
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, distinct_rows
from kilter.assembly import Assembly
from kilter.contact.convex_pieces import ConvexPieces, convex_pieces
from kilter.contact.convex_points import near_points
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.shape.primitives import Shape, surface

SPARE = 0.05
"""Enlargement of the box around the corners of a part [sizes of the box]."""


def _box_of(shape: Shape) -> Array:
    """Corners of the box around a shape in its own frame, shape (8, 3)."""
    corners = surface(shape)[0]
    low, high = corners.min(axis=0), corners.max(axis=0)
    # the corners of a curved shape lie inside its surface
    spare = SPARE * (high - low)
    ends = zip((low - spare).tolist(), (high + spare).tolist(), strict=True)
    return np.array(list(product(*ends)))


def _some_parts(assembly: Assembly, chosen: Index) -> Assembly:
    """The assembly of some parts without its joints and loads; `chosen` (n,): their indices."""
    names = {assembly.names[k] for k in chosen.tolist()}
    return replace(
        assembly,
        parts=[assembly.parts[k] for k in chosen.tolist()],
        notes=(), joints=(), bonds=(), straps=(), loads=(),
        friction_pairs=[e for e in assembly.friction_pairs if names.issuperset(e.parts)],
        contacts=[e for e in assembly.contacts if names.issuperset(e.parts)],
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class CandidatePoints:
    """What the search for candidate points needs of an assembly, made once."""

    assembly: Assembly
    pieces: ConvexPieces
    ignored: Index
    """Pairs of parts that never touch, shape (n, 2)."""
    rotation: Array
    position: Array
    """Drawn poses of the parts, shape (N, 3, 3) and (N, 3)."""
    box: Array
    """Corners of the box around each part, in the frame of the part, shape (N, 8, 3)."""

    @staticmethod
    def of(bodies: RigidBodies) -> CandidatePoints:
        """Prepare the search for the bodies of an assembly."""
        assembly = bodies.drawn
        apart = [entry.parts for entry in assembly.contacts if not len(entry.points)]
        pairs = [[assembly.index[name] for name in names] for names in apart]
        return CandidatePoints(
            assembly, convex_pieces(assembly), np.array(pairs, np.int64).reshape(-1, 2),
            np.array([part.pose.matrix for part in assembly.parts]),
            np.array([part.pose.position for part in assembly.parts]),
            np.array([_box_of(part.shape) for part in assembly.parts]),
        )  # fmt: skip

    def near(self, bodies: RigidBodies, reach: float) -> NearPoints:
        """Points between different bodies whose gap is at most `reach` [length unit]."""
        body = bodies.of_part
        turn = bodies.rotation[body]
        rotation = turn @ self.rotation
        position = bodies.center[body] + np.einsum(
            "nij,nj->ni", turn, self.position - bodies.drawn_center[body]
        )
        found = near_points(self.pieces, rotation, position, reach, self.ignored)
        points = NearPoints(
            found.part_a, found.part_b, found.point, found.normal, found.gap,
            np.zeros(len(found)), found.bears,
        )  # fmt: skip
        points = points.take(body[points.part_a] != body[points.part_b])
        points = replace(points, mu=self._friction(points))
        whole = self.pieces.whole
        chosen = self._beside_others(body, rotation, position, reach)
        if len(chosen):
            others = find_near_points(_some_parts(bodies.assembly(), chosen), reach, reach)
            others = replace(others, part_a=chosen[others.part_a], part_b=chosen[others.part_b])
            other = ~(whole[others.part_a] & whole[others.part_b])
            other &= body[others.part_a] != body[others.part_b]
            points = NearPoints.join([points, others.take(other)])
        if self.assembly.planar:
            points = points.take(np.abs(points.normal[:, 1]) < 0.5)
        return points

    def _beside_others(self, body: Index, rotation: Array, position: Array, reach: float) -> Index:
        """Parts of pairs within reach of which one has no convex pieces, ascending; shape (n,)."""
        if self.pieces.whole.all():
            return np.zeros(0, dtype=np.int64)
        corners = position[:, None] + np.einsum("nij,nkj->nki", rotation, self.box)
        low, high = corners.min(axis=1) - reach / 2, corners.max(axis=1) + reach / 2
        other = np.flatnonzero(~self.pieces.whole)
        near = ((low[other, None] <= high) & (low <= high[other, None])).all(axis=2)
        near &= body[other, None] != body
        return np.unique(
            np.concatenate([other[near.any(axis=1)], np.flatnonzero(near.any(axis=0))])
        )

    def _friction(self, points: NearPoints) -> Array:
        """Friction coefficient of each point [-]."""
        pairs, pair = distinct_rows(np.column_stack([points.part_a, points.part_b]))
        return friction_coefficients(self.assembly, pairs)[pair]
