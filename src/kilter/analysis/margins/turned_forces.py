"""Forces that turn with the direction of a load: a proof that a whole arc of directions is held.

Where friction or a round edge decides, the boundary of the held loads is a circle, to which the
hull of n points comes only as near as 1 - cos(pi / n). The forces f_i at five neighbouring
directions theta_i, at one distance r, prove more. With coefficients c_i(theta) that reproduce

    sum c_i (1, cos theta_i, sin theta_i, cos 2 theta_i, sin 2 theta_i)  =  (1, cos theta, ...),

the forces sum c_i f_i balance the load at the distance r in each direction theta between them,
since the load is linear in (cos theta, sin theta). They hold it if they lie in the cones. A share
of the forces at rest, which lie inside the cones, takes up what is missing:

    (1 - share) sum c_i f_i + share f_0   in the cones: the loads are held up to (1 - share) r

A flat patch counts by its resultant. This is held by forces at its centre of pressure, if this
lies in the patch and if the resultant lies in the cone. A torque about the normal at this point is
left to half of the forces at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.analysis.load_limit import Limit
from kilter.arrays import TINY, Array, Index, across
from kilter.contact.common.polygons import convex_hull
from kilter.contact.round_edges import RoundEdge
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

NODES = 5
"""Number of directions whose forces are combined."""
SAMPLES = 33
"""Number of directions of an arc in which the forces are tested."""
SHARES = (1e-9, 1e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4)
"""Shares of the forces at rest that are tested, the least first [-]."""
WIDEST = np.pi / 4
"""Largest angle between neighbouring directions of an arc [rad]."""
SAME = 1e-4
"""Two directions are the same if they are closer than this [rad]: near nodes enlarge errors."""
FLAT = 1e-9
"""Normals of a flat patch differ by at most this [-]."""


def held_distance(
    program: Program,
    edges: Sequence[RoundEdge],
    known: Sequence[tuple[Array, Limit]],
    distance: float,
) -> float:
    """Distance up to which loads in all directions of a plane are proved to be held."""
    angle = np.array([np.arctan2(direction[1], direction[0]) for direction, _ in known])
    order = np.argsort(angle)
    # the last direction comes before the first
    apart = np.diff(angle[order], prepend=angle[order[-1]] - 2 * np.pi)
    order = order[apart > SAME]
    angle, limits = angle[order], [known[k][1] for k in order]
    reach = np.array([limit.value for limit in limits])
    few = len(angle) < NODES + 1 or program.has_strength
    if few or distance <= 0.0 or not (reach >= distance * (1 - FLAT)).all():
        return 0.0
    reach = np.minimum(reach, 1e3 * distance)
    turned = _TurnedForces.of(program, edges, limits, angle, reach, distance)
    if turned is None:
        return 0.0
    least = distance
    for k in range(len(angle)):
        span = (np.roll(angle, -1)[k] - angle[k]) % (2 * np.pi)
        ends = reach[[k, (k + 1) % len(angle)]]
        chord = (
            ends.prod() * np.sin(span) / np.sqrt(ends @ ends - 2 * ends.prod() * np.cos(span))
        )  # distance of the chord from 0
        arc = turned.held_on_arc(k) if span <= WIDEST else 0.0
        least = min(least, max(float(chord), arc * distance))
        if least <= 0.0:
            return 0.0
    return least


@dataclass(frozen=True, slots=True, eq=False)
class _Patch:
    """Cone of the resultants (N, C, T, S) of a flat patch: push, moment, friction, spin.

    `lines` (e, h): the centre of pressure C / N obeys e . C <= h N. `circles`: centre and radius.
    """

    rows: Index
    mu: float
    lines: Array
    circles: list[tuple[Array, float]]
    grip: float


@dataclass(frozen=True, slots=True, eq=False)
class _TurnedForces:
    """Forces at one distance in all known directions, and at rest."""

    program: Program
    angle: Array
    along: Array  # (n, K) on the rows of the program
    aside: Array  # (n, K, 3)
    sums: Array  # (n, P, 6) resultants of flat patches
    rest: tuple[Array, Array, Array]
    patches: list[_Patch]
    others: Index  # rows that are tested by themselves
    whole: Array  # (P,) True if no direction has further points

    @classmethod
    def of(
        cls,
        program: Program,
        edges: Sequence[RoundEdge],
        limits: Sequence[Limit],
        angle: Array,
        reach: Array,
        distance: float,
    ) -> _TurnedForces | None:
        count = len(program.part_a)
        frames = _flat_frames(program)
        along = np.array([limit.forces.forces[:count] for limit in limits])
        aside = np.array([limit.forces.friction[:count] for limit in limits])
        sums = np.array(
            [[_resultant(limit.program, limit, *frame) for frame in frames] for limit in limits]
        ).reshape(len(limits), len(frames), 6)
        extra = np.zeros(len(frames), dtype=bool)
        for limit in limits:
            extra |= np.isin([f[0] for f in frames], limit.program.source[count:])
        weight = _weights_at_rest(angle, reach)
        if weight is None:
            return None
        rest = (
            np.tensordot(weight, along, 1),
            np.tensordot(weight, aside, 1),
            np.tensordot(weight, sums, 1),
        )
        share = distance / reach

        def scaled(values: Array, still: Array) -> Array:
            part = share.reshape(-1, *([1] * still.ndim))
            return part * values + (1 - part) * still

        patches = [_patch(program, edges, frame, limits, weight, rest[:2]) for frame in frames]
        in_patch = np.isin(program.source, [f[0] for f in frames]) & (program.kind == CONTACT)
        return cls(
            program, angle, scaled(along, rest[0]), scaled(aside, rest[1]), scaled(sums, rest[2]),
            rest, patches, np.flatnonzero(~in_patch & ~program.two_sided), ~extra,
        )  # fmt: skip

    def held_on_arc(self, first: int) -> float:
        """Largest proved fraction of the distance on the arc from a direction to the next."""
        count = len(self.angle)
        near = (first + np.arange(-1, NODES - 1)) % count
        start = self.angle[first]
        node = (self.angle[near] - start + np.pi) % (2 * np.pi) - np.pi
        theta = np.linspace(0.0, (self.angle[(first + 1) % count] - start) % (2 * np.pi), SAMPLES)
        # the arc is the second of four, so the nodes lie on both sides of it
        share = np.linalg.solve(_waves(node), _waves(theta)).T
        along, aside, sums = (
            np.tensordot(share, values[near], 1) for values in (self.along, self.aside, self.sums)
        )
        for part in SHARES:
            if self._holds(part, along, aside, sums):
                return 1.0 - part
        return 0.0

    def _holds(self, part: float, along: Array, aside: Array, sums: Array) -> bool:
        """Whether the forces with a share of those at rest lie in the cones on the whole arc."""
        mix_along = (1 - part) * along + part * self.rest[0]
        mix_aside = (1 - part) * aside + part * self.rest[1]
        room = self.program.mu * mix_along - np.linalg.norm(mix_aside, axis=2)
        room = np.where(self.program.mu > 0, room, mix_along)
        if not all(_positive(room[:, row]) for row in self.others):
            return False
        mix = (1 - part) * sums + 0.5 * part * self.rest[2]
        for k, patch in enumerate(self.patches):
            by_rows = self.whole[k] and all(_positive(room[:, row]) for row in patch.rows)
            if not by_rows and not _in_patch(patch, mix[:, k], 0.5 * part):
                return False
        return True


def _waves(angle: Array) -> Array:
    """Values (1, cos, sin, cos 2, sin 2) at some angles, shape (5, n)."""
    return np.stack(
        [np.ones_like(angle), np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)]
    )


def _positive(samples: Array) -> bool:
    """Whether a smooth function is positive between its samples, too.

    Between samples it lies below its chord by at most h^2 |f''| / 8. Second differences estimate
    h^2 |f''|, so twice this bound is required.
    """
    bend = float(np.abs(np.diff(samples, 2)).max(initial=0.0))
    return bool(samples.min() >= bend / 4)


def _weights_at_rest(angle: Array, reach: Array) -> Array | None:
    """Weights, as equal as possible, whose mean of the boundary points is 0; None without such."""
    rows = np.stack([np.ones_like(angle), reach * np.cos(angle), reach * np.sin(angle)])
    rows[1:] /= reach.max()
    equal = np.full(len(angle), 1 / len(angle))
    off = np.array([1.0, 0.0, 0.0]) - rows @ equal
    weight: Array = equal + rows.T @ np.linalg.lstsq(rows @ rows.T, off, rcond=None)[0]
    return weight if weight.min() >= 0.0 else None


def _flat_frames(program: Program) -> list[tuple[int, Array, Array, Array, Array]]:
    """Patch, middle of its points, its normal and two tangents, for each flat patch."""
    frames = []
    for patch in np.unique(program.source[program.kind == CONTACT]):
        rows = np.flatnonzero((program.kind == CONTACT) & (program.source == patch))
        normal = program.normal[rows[0]]
        if np.abs(program.normal[rows] - normal).max() <= FLAT and len(rows) > 2:
            u, v = across(normal)
            frames.append((int(patch), program.point[rows].mean(axis=0), normal, u, v))
    return frames


def _resultant(
    program: Program, limit: Limit, patch: int, middle: Array, normal: Array, u: Array, v: Array
) -> Array:
    """Resultant (N, C, T, S) of the forces of a patch, about the middle of its points."""
    rows = np.flatnonzero((program.kind == CONTACT) & (program.source == patch))
    push, drag = limit.forces.forces[rows], limit.forces.friction[rows]
    arm = program.point[rows] - middle
    arm, drag = np.stack([arm @ u, arm @ v], axis=1), np.stack([drag @ u, drag @ v], axis=1)
    spin = arm[:, 0] * drag[:, 1] - arm[:, 1] * drag[:, 0]
    return np.concatenate([[push.sum()], push @ arm, drag.sum(axis=0), [spin.sum()]])


def _patch(
    program: Program,
    edges: Sequence[RoundEdge],
    frame: tuple[int, Array, Array, Array, Array],
    limits: Sequence[Limit],
    weight: Array,
    rest: tuple[Array, Array],
) -> _Patch:
    """The cone of a flat patch, with the torque that its forces at rest leave to friction."""
    patch, middle, _, u, v = frame
    rows = np.flatnonzero((program.kind == CONTACT) & (program.source == patch))
    arm = program.point[rows] - middle
    place = np.stack([arm @ u, arm @ v], axis=1)
    corner = convex_hull(place)
    side = np.roll(corner, -1, axis=0) - corner
    outward = np.stack([side[:, 1], -side[:, 0]], axis=1)
    outward /= np.maximum(np.linalg.norm(outward, axis=1), TINY)[:, None]
    height = np.einsum("ij,ij->i", outward, corner)
    straight = np.ones(len(corner), dtype=bool)
    circles = []
    for edge in edges:
        if edge.patch != patch:
            continue
        center = np.array([(edge.center - middle) @ u, (edge.center - middle) @ v])
        chord = corner + side / 2
        beyond = center + edge.radius * _unit(chord - center)
        points = middle + beyond[:, :1] * u + beyond[:, 1:] * v
        straight &= ~edge.contains(np.array([edge.angle(point) for point in points]))
        circles.append((center, edge.radius))
    mu = float(program.mu[rows].min())
    lines = np.column_stack([outward, height])[straight]
    return _Patch(rows, mu, lines, circles, _grip(program, limits, weight, rest, frame, mu))


def _grip(
    program: Program,
    limits: Sequence[Limit],
    weight: Array,
    rest: tuple[Array, Array],
    frame: tuple[int, Array, Array, Array, Array],
    mu: float,
) -> float:
    """Torque about the normal that the forces at rest leave to the friction of a patch [N m].

    At each point a force across the arm from the common middle, in proportion to the room there.
    """
    patch, middle, _, u, v = frame
    count, places, rooms = len(program.part_a), [], []

    def add(used: Program, rows: Index, push: Array, drag: Array) -> None:
        rows = rows[(used.kind[rows] == CONTACT) & (used.source[rows] == patch)]
        arm = used.point[rows] - middle
        places.append(np.stack([arm @ u, arm @ v], axis=1))
        room = mu * push[rows] - np.linalg.norm(drag[rows], axis=1)
        rooms.append(np.maximum(room, 0.0))

    add(program, np.arange(count), *rest)
    for limit, part in zip(limits, weight, strict=True):
        # the further points of a limit belong to its direction alone
        forces = part * limit.forces.forces, part * limit.forces.friction
        add(limit.program, np.arange(count, len(limit.program.part_a)), *forces)
    place, room = np.concatenate(places), np.concatenate(rooms)
    if not room.any():
        return 0.0
    away = np.linalg.norm(place - room @ place / room.sum(), axis=1)
    return float(room @ away**2 / max(float(away.max()), TINY))


def _unit(vectors: Array) -> Array:
    units: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1), TINY)[:, None]
    return units


def _in_patch(patch: _Patch, sums: Array, part: float) -> bool:
    """Whether a patch can bear resultants, (n, 6), of an arc beside a share of its rest forces."""
    push, moment, drag, spin = sums[:, 0], sums[:, 1:3], sums[:, 3:5], sums[:, 5]
    if not _positive(push):
        return False
    size = np.linalg.norm(drag, axis=1)
    if patch.mu > 0.0 or size.max() > 0.0:
        if not _positive(patch.mu * push - size):
            return False
        torque = spin - (moment[:, 0] * drag[:, 1] - moment[:, 1] * drag[:, 0]) / push
        most = part * patch.grip
        if not (_positive(most - torque) and _positive(most + torque)):
            return False
    if any(not _positive(h * push - moment @ [x, y]) for x, y, h in patch.lines):
        return False
    return all(
        _positive(radius * push - np.linalg.norm(moment - push[:, None] * center, axis=1))
        for center, radius in patch.circles
    )
