"""Separating planes between neighbouring bodies, and the limits they set on small motions.

A plane n.x = o separates two bodies if n.x <= o for every point of the first, and n.x >= o for
every point of the second. Bodies and plane move together: the part of the second body moves by
(dr, dtheta) about c, and the plane tilts by p along its tangents t and shifts by o. To first order
a point x of the second body stays beyond the plane iff

    n.x + n.(dr + dtheta x (x - c)) + p.t(x) - o >= gap / 2

which is linear in all unknowns, so that a single program chooses motions and planes. Balls count as
points with a radius, cylinders as points of their rims. These rows are no proof: `separation`
judges the bodies after their step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, across, cross
from kilter.assembly import Assembly
from kilter.mechanics.program import Program
from kilter.rigid import matrix_to_quaternion, turn_of
from kilter.second_order.parts.separation import ConvexBody, bodies_of, parting, parting_point

FAN = 2e-4 * 4.0 ** np.arange(7)
RIM = np.concatenate([[0.0], FAN, -FAN, np.pi / 4 * np.arange(1, 8)])
"""Angles of points of a rim from the point nearest to a plane [rad].

They are dense about it, because a chord lies within the rim by an eighth of its angle squared.
"""
POINTS = 48
"""Largest number of points of a body, nearest first, for which a plane gives a condition."""
TRIES = 30
"""Number of normals that are tried near the last normal of a plane at a cylinder."""

Pair = tuple[int, int, int, int]
"""A part and a body of it, then another part and a body of it."""


@dataclass(frozen=True, slots=True, eq=False)
class PartPlaces:
    """Displacements of parts: shifts of the centres of mass, (N, 3), and rotations, (N, 3, 3)."""

    shifts: Array
    turns: Array

    @classmethod
    def of(cls, motion: Array) -> PartPlaces:
        """Make displacements from shifts and rotation vectors, shape (N, 6) [length unit, rad]."""
        return cls(motion[:, :3].copy(), np.array([turn_of(vector) for vector in motion[:, 3:]]))

    @property
    def motion(self) -> Array:
        """Shifts and rotation vectors of the displacements, shape (N, 6) [length unit, rad]."""
        return np.hstack([self.shifts, np.array([_rotation_of(turn) for turn in self.turns])])

    def after(self, step: Array) -> PartPlaces:
        """Displacements after one more step of shifts and turns about the centres, (N, 6)."""
        turns = np.array([turn_of(vector) for vector in step[:, 3:]])
        return PartPlaces(self.shifts + step[:, :3], turns @ self.turns)


def _rotation_of(turn: Array) -> Array:
    """Rotation vector of a rotation matrix, shape (3,) [rad], at most half a turn."""
    q = matrix_to_quaternion(turn)
    size = float(np.linalg.norm(q[1:]))
    if size == 0.0:
        return np.zeros(3)
    vector: Array = q[1:] * (2 * float(np.arctan2(size, q[0])) / size)
    return vector


class PartingPlanes:
    """Separating planes between the bodies of an assembly, updated as the parts move."""

    def __init__(self, assembly: Assembly, program: Program) -> None:
        self._program = program
        self._bodies = [bodies_of(assembly, k) or [] for k in range(len(program.names))]
        self._balls = [_bounding_balls(bodies) for bodies in self._bodies]
        self.kept: set[tuple[int, int]] = set()
        """Pairs of parts that get no plane here, because planes of contact keep them apart."""
        self._from: dict[Pair, Array] = {}
        """Normals from which the search for a plane starts, shape (k, 3)."""

    def rows(self, places: PartPlaces, reach: Array, gap: float) -> tuple[Array, Array]:
        """Linear conditions A x <= b on a step, under which separating planes keep bodies apart.

        Arguments: `reach` (N,): largest displacement of points of each part [length unit]; pairs
        beyond are skipped; `gap`: gap between the bodies [length unit]. Returns `matrix` (m, 6 N +
        3 P): a: columns for (dr, dtheta) of each part [length unit, rad], then for the two tilts
        [rad] and the shift [length unit] of each plane; `bound` (m,): b [length unit].
        """
        near = self._near_pairs(places, reach + gap)
        count = 6 * len(self._bodies)
        blocks, bounds = [np.zeros((0, count + 3 * len(near)))], [np.zeros(0)]
        for k, (pair, a, b) in enumerate(near):
            normal = self._normal(pair, a, b)
            tangents = np.array(across(normal))
            ends = [(pair[0], a, normal, 1.0), (pair[2], b, -normal, -1.0)]
            points = [_farthest(body, toward) for _, body, toward, _ in ends]
            anchor = (points[0][0] + points[1][0]) / 2
            for (part, body, _, sign), held in zip(ends, points, strict=True):
                block = np.zeros((len(held), count + 3 * len(near)))
                if self._program.free[part]:
                    arms = held - self._program.center[part] - places.shifts[part]
                    block[:, 6 * part : 6 * part + 3] = normal
                    block[:, 6 * part + 3 : 6 * part + 6] = cross(arms, normal + 0 * arms)
                at = count + 3 * k
                block[:, at : at + 2] = (held - anchor) @ tangents.T
                block[:, at + 2] = -1.0
                rounded = body.radius if body.axis is None else 0.0
                blocks.append(sign * block)
                bounds.append(-sign * (held - anchor) @ normal - rounded - gap / 2)
        return np.vstack(blocks), np.concatenate(bounds)

    def _near_pairs(
        self, places: PartPlaces, reach: Array
    ) -> list[tuple[Pair, ConvexBody, ConvexBody]]:
        """Pairs of displaced bodies within reach of each other, at least one of them free."""
        program, count = self._program, len(self._bodies)
        middles = [
            (middle - program.center[k]) @ places.turns[k].T + program.center[k] + places.shifts[k]
            for k, (middle, _) in enumerate(self._balls)
        ]
        moved: dict[tuple[int, int], ConvexBody] = {}
        pairs = []
        for i in range(count):
            for j in range(i + 1, count):
                held = not (program.free[i] or program.free[j])
                if held or (i, j) in self.kept or (j, i) in self.kept:
                    continue
                apart = np.linalg.norm(middles[i][:, None] - middles[j], axis=2)
                room = reach[i] + reach[j]
                size = self._balls[i][1][:, None] + self._balls[j][1]
                for m, n in np.argwhere(apart <= size + room).tolist():
                    for key in ((i, m), (j, n)):
                        if key not in moved:
                            moved[key] = self._moved_corners(key, places)
                    a, b = moved[i, m], moved[j, n]
                    if _box_distance(a, b) <= room:
                        pairs.append(((i, m, j, n), a, b))
        return pairs

    def _moved_corners(self, key: tuple[int, int], places: PartPlaces) -> ConvexBody:
        part, body = key
        center, shift, turn = (
            values[part] for values in (self._program.center, places.shifts, places.turns)
        )
        return self._bodies[part][body].moved(center, shift, turn)

    def _normal(self, pair: Pair, a: ConvexBody, b: ConvexBody) -> Array:
        """Unit normal of the best separating plane of two bodies, from first to second."""
        if _is_ball(a) and b.radius == 0:
            return -parting_point(b, a.corners[0])[1]
        if _is_ball(b) and a.radius == 0:
            return parting_point(a, b.corners[0])[1]
        program, (i, _, j, _) = self._program, pair
        if pair not in self._from:
            same = (program.part_a == i) & (program.part_b == j)
            other = (program.part_a == j) & (program.part_b == i)
            self._from[pair] = np.vstack([program.normal[same], -program.normal[other]])
        normal = parting(a, b, self._from[pair], TRIES)[1]
        self._from[pair] = normal[None]
        return normal


def _is_ball(body: ConvexBody) -> bool:
    return body.radius > 0 and body.axis is None


def _bounding_balls(bodies: list[ConvexBody]) -> tuple[Array, Array]:
    """Balls that contain bodies: centres, shape (n, 3), and radii, shape (n,) [length unit]."""
    middles = np.array([body.corners.mean(axis=0) for body in bodies]).reshape(-1, 3)
    radii = [
        np.linalg.norm(body.corners - middle, axis=1).max() + body.radius
        for body, middle in zip(bodies, middles, strict=True)
    ]
    return middles, np.array(radii)


def _box_distance(a: ConvexBody, b: ConvexBody) -> float:
    """Largest distance of two bodies' boxes along an axis [length unit]; negative in overlap."""
    gap = np.maximum(
        b.corners.min(axis=0) - a.corners.max(axis=0), a.corners.min(axis=0) - b.corners.max(axis=0)
    )
    return float(gap.max()) - a.radius - b.radius


def _farthest(body: ConvexBody, toward: Array) -> Array:
    """Points of a body that are farthest along a direction, the farthest first, shape (m, 3).

    For a ball its centre, for a cylinder points of its rims.
    """
    points = body.corners
    if body.axis is not None:
        aside = toward - (toward @ body.axis) * body.axis
        size = float(np.linalg.norm(aside))
        u = across(body.axis)[0] if size == 0 else aside / size
        rim = np.outer(np.cos(RIM), u) + np.outer(np.sin(RIM), np.cross(body.axis, u))
        points = (body.corners[:, None] + body.radius * rim).reshape(-1, 3)
    return np.asarray(points[np.argsort(-(points @ toward), kind="stable")[:POINTS]])
