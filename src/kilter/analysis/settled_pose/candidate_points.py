"""Candidate points of moving bodies: convex pieces by distance, all other parts by their faces.

Parts that consist of convex pieces (boxes, convex meshes, compounds of a simulator) have points by
the distances of their pieces (`kilter.contact.convex_points`), in arrays and without a new
assembly. All other pairs of parts have the points of `near_points`. A pair whose parts have kept
their poses keeps its points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.settled_pose.moving_pairs import MovingPairs
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, distinct_rows
from kilter.assembly import Assembly
from kilter.contact.convex_pieces import ConvexPieces, convex_pieces
from kilter.contact.convex_points import near_points
from kilter.contact.friction_coefficients import friction_coefficients


@dataclass(frozen=True, slots=True, eq=False)
class _KnownPoints:
    """Points of convex pieces in the last search."""

    rotation: Array
    position: Array
    """Poses of the parts, shape (N, 3, 3) and (N, 3)."""
    reach: Array
    """Reach of each part, shape (N,)."""
    points: NearPoints


@dataclass(slots=True, eq=False)
class CandidatePoints:
    """Data of an assembly for the search for candidate points, computed once."""

    assembly: Assembly
    pieces: ConvexPieces
    ignored: Index
    """Pairs of parts that never touch, shape (n, 2)."""
    rotation: Array
    position: Array
    """Drawn poses of the parts, shape (N, 3, 3) and (N, 3)."""
    others: MovingPairs
    """Pairs of parts that convex pieces do not cover."""
    known: _KnownPoints | None = None

    @staticmethod
    def of(bodies: RigidBodies) -> CandidatePoints:
        """Prepare the search for the bodies of an assembly."""
        assembly = bodies.drawn
        apart = [entry.parts for entry in assembly.contacts if not len(entry.points)]
        pairs = [[assembly.index[name] for name in names] for names in apart]
        pieces, ignored = convex_pieces(assembly), np.array(pairs, np.int64).reshape(-1, 2)
        return CandidatePoints(
            assembly, pieces, ignored,
            np.array([part.pose.matrix for part in assembly.parts]),
            np.array([part.pose.position for part in assembly.parts]),
            MovingPairs.of(assembly, pieces.whole, ignored),
        )  # fmt: skip

    def near(self, bodies: RigidBodies, reach: float | Array) -> NearPoints:
        """Points between different bodies within a reach.

        Arguments: `reach`: largest gap of a point [length unit], or that of each body (B,), of
        which the larger counts for a pair.
        """
        body = bodies.of_part
        turn = bodies.rotation[body]
        rotation = turn @ self.rotation
        position = bodies.center[body] + np.einsum(
            "nij,nj->ni", turn, self.position - bodies.drawn_center[body]
        )
        limit = np.broadcast_to(np.asarray(reach, dtype=np.float64), len(bodies.mass))[body]
        points = self._between_pieces(rotation, position, body, limit)
        if not self.pieces.whole.all():
            points = NearPoints.join([points, self.others.near(rotation, position, body, limit)])
        points = replace(points, mu=self._friction(points))
        if self.assembly.planar:
            points = points.take(np.abs(points.normal[:, 1]) < 0.5)
        return points

    def _between_pieces(
        self, rotation: Array, position: Array, body: Index, reach: Array
    ) -> NearPoints:
        """Points of pairs of convex parts, without friction; `reach` (N,)."""
        moved, kept = np.ones(len(body), dtype=bool), NearPoints.none()
        if self.known is not None:
            moved = (rotation != self.known.rotation).any(axis=(1, 2))
            moved |= (position != self.known.position).any(axis=1) | (reach > self.known.reach)
            old = self.known.points
            kept = old.take(~moved[old.part_a] & ~moved[old.part_b])
            kept = kept.take(kept.gap <= np.maximum(reach[kept.part_a], reach[kept.part_b]))
        found = near_points(self.pieces, rotation, position, reach, self.ignored, body, moved)
        new = NearPoints(
            found.part_a, found.part_b, found.point, found.normal, found.gap,
            np.zeros(len(found)), found.bears,
        )  # fmt: skip
        points = NearPoints.join([kept, new])
        self.known = _KnownPoints(rotation, position, reach, points)
        return points

    def _friction(self, points: NearPoints) -> Array:
        """Friction coefficient of each point [-]."""
        pairs, pair = distinct_rows(np.column_stack([points.part_a, points.part_b]))
        return friction_coefficients(self.assembly, pairs)[pair]
