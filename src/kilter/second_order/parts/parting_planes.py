"""Planes that part bodies near one another, and how far small motions may go on their sides.

A plane n.x = o parts two bodies where n.x <= o for every point of the one, n.x >= o of the other.
Bodies and plane move together: with dr, dtheta of its part about c, and the plane tilted by p along
its tangents t and shifted by o, a point x of the other stays beyond it to first order iff

    n.x + n.(dr + dtheta x (x - c)) + p.t(x) - o >= gap / 2

which is linear in all of them, so that one program chooses motions and planes. Balls are points
with a radius, cylinders points of their rims. Rows of first order are no proof: what is judged is
the separation of the bodies where they come to be (`separation`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, across, cross
from kilter.assembly import Assembly
from kilter.mechanics.program import Program
from kilter.rigid import matrix_to_quaternion
from kilter.second_order.parts.separation import Body, bodies_of, parting, parting_point, turn_of

__all__ = ["PartingPlanes", "Places"]

FAN = 2e-4 * 4.0 ** np.arange(7)
RIM = np.concatenate([[0.0], FAN, -FAN, np.pi / 4 * np.arange(1, 8)])
"""Angles of the points of a rim from that nearest to a plane, close about it: a chord lies within
the rim by an eighth of the square of its angle [rad]."""
POINTS = 48
"""Corners of a body, those nearest to the plane, that are held beyond it."""
TRIES = 30
"""Normals that are tried about the best one at cylinders, from place to place."""

Pair = tuple[int, int, int, int]
"""A part and one of its bodies, and another."""


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Where parts are: shifts of the centres of mass, shape (N, 3), and turns, shape (N, 3, 3)."""

    shifts: Array
    turns: Array

    @classmethod
    def of(cls, motion: Array) -> Places:
        """After shifts and rotation vectors, shape (N, 6)."""
        return cls(motion[:, :3].copy(), np.array([turn_of(one) for one in motion[:, 3:]]))

    @property
    def motion(self) -> Array:
        """Shifts and rotation vectors, shape (N, 6)."""
        return np.hstack([self.shifts, np.array([_rotation_of(one) for one in self.turns])])

    def after(self, step: Array) -> Places:
        """After a further step, shape (N, 6): each part shifts, and turns about its centre."""
        turns = np.array([turn_of(one) for one in step[:, 3:]])
        return Places(self.shifts + step[:, :3], turns @ self.turns)


def _rotation_of(turn: Array) -> Array:
    """The rotation vector of a matrix, shape (3,) [rad], up to half a turn."""
    q = matrix_to_quaternion(turn)
    size = float(np.linalg.norm(q[1:]))
    if size == 0.0:
        return np.zeros(3)
    vector: Array = q[1:] * (2 * float(np.arctan2(size, q[0])) / size)
    return vector


class PartingPlanes:
    """Planes between the bodies of an assembly, sought from place to place."""

    def __init__(self, assembly: Assembly, program: Program) -> None:
        self._program = program
        self._bodies = [bodies_of(assembly, k) or [] for k in range(len(program.names))]
        self._balls = [_balls(own) for own in self._bodies]
        self.kept: set[tuple[int, int]] = set()
        """Pairs of parts that other planes keep apart."""
        self._from: dict[Pair, Array] = {}
        """Normals that a plane is sought from, shape (k, 3)."""

    def rows(self, places: Places, reach: Array, gap: float) -> tuple[Array, Array]:
        """Rows A (steps, planes) <= b: bodies apart by a gap, to first order.

        Parameters
        ----------
        places : Places
        reach : ndarray, shape (N,)
            How far points of each part may move [length unit]; what cannot meet is left out.
        gap : float
            [length unit]

        Returns
        -------
        matrix : ndarray, shape (m, 6 N + 3 P)
            Columns of (dr, dtheta) of each part [length unit, rad], then the tilts [rad] and the
            shift [length unit] of each plane.
        bound : ndarray, shape (m,)
            [length unit]
        """
        near = self._near(places, reach + gap)
        count = 6 * len(self._bodies)
        blocks, bounds = [np.zeros((0, count + 3 * len(near)))], [np.zeros(0)]
        for k, (pair, a, b) in enumerate(near):
            normal = self._normal(pair, a, b)
            tangents = np.array(across(normal))
            ends = [(pair[0], a, normal, 1.0), (pair[2], b, -normal, -1.0)]
            points = [_farthest(body, toward) for _, body, toward, _ in ends]
            anchor = (points[0][0] + points[1][0]) / 2
            for (part, body, _, sign), own in zip(ends, points, strict=True):
                block = np.zeros((len(own), count + 3 * len(near)))
                if self._program.free[part]:
                    arms = own - self._program.center[part] - places.shifts[part]
                    block[:, 6 * part : 6 * part + 3] = normal
                    block[:, 6 * part + 3 : 6 * part + 6] = cross(arms, normal + 0 * arms)
                at = count + 3 * k
                block[:, at : at + 2] = (own - anchor) @ tangents.T
                block[:, at + 2] = -1.0
                rounded = body.radius if body.axis is None else 0.0
                blocks.append(sign * block)
                bounds.append(-sign * (own - anchor) @ normal - rounded - gap / 2)
        return np.vstack(blocks), np.concatenate(bounds)

    def _near(self, places: Places, reach: Array) -> list[tuple[Pair, Body, Body]]:
        """Bodies, of parts of which one is free, that are near enough to meet: where they are."""
        program, count = self._program, len(self._bodies)
        middles = [
            (middle - program.center[k]) @ places.turns[k].T + program.center[k] + places.shifts[k]
            for k, (middle, _) in enumerate(self._balls)
        ]
        moved: dict[tuple[int, int], Body] = {}
        found = []
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
                            moved[key] = self._moved(key, places)
                    a, b = moved[i, m], moved[j, n]
                    if _between(a, b) <= room:
                        found.append(((i, m, j, n), a, b))
        return found

    def _moved(self, key: tuple[int, int], places: Places) -> Body:
        part, body = key
        center, shift, turn = (
            one[part] for one in (self._program.center, places.shifts, places.turns)
        )
        return self._bodies[part][body].moved(center, shift, turn)

    def _normal(self, pair: Pair, a: Body, b: Body) -> Array:
        """The normal of the plane that parts two bodies best, from the first to the second."""
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


def _is_ball(body: Body) -> bool:
    return body.radius > 0 and body.axis is None


def _balls(bodies: list[Body]) -> tuple[Array, Array]:
    """Balls about bodies: middles, shape (n, 3), and radii, shape (n,) [length unit]."""
    middles = np.array([one.corners.mean(axis=0) for one in bodies]).reshape(-1, 3)
    radii = [
        np.linalg.norm(one.corners - middle, axis=1).max() + one.radius
        for one, middle in zip(bodies, middles, strict=True)
    ]
    return middles, np.array(radii)


def _between(a: Body, b: Body) -> float:
    """How far apart boxes about two bodies are along an axis; negative where they overlap."""
    gap = np.maximum(
        b.corners.min(axis=0) - a.corners.max(axis=0), a.corners.min(axis=0) - b.corners.max(axis=0)
    )
    return float(gap.max()) - a.radius - b.radius


def _farthest(body: Body, toward: Array) -> Array:
    """Points of a body, or of what it rounds, the farthest along a normal first, shape (m, 3)."""
    points = body.corners
    if body.axis is not None:
        aside = toward - (toward @ body.axis) * body.axis
        size = float(np.linalg.norm(aside))
        u = across(body.axis)[0] if size == 0 else aside / size
        rim = np.outer(np.cos(RIM), u) + np.outer(np.sin(RIM), np.cross(body.axis, u))
        points = (body.corners[:, None] + body.radius * rim).reshape(-1, 3)
    return np.asarray(points[np.argsort(-(points @ toward), kind="stable")[:POINTS]])
