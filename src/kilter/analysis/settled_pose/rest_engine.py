"""From any state to a pose at rest: overlaps out, straight falls, then tipping, sliding, rolling.

1. Overlaps open by the least motion, in rounds (`RestPrograms.push_apart`).
2. Groups of bodies that nothing supports fall straight down until they meet a supported part, all
   at the same time (`straight_falls`). A group with nothing below it leaves the scene.
3. Bodies that no forces hold move by a quasi-static step (`descent`) until they stop; a step obeys
   contact and Coulomb's law at all points within its length. If a body loses its support, it falls
   again.

Potential energy falls in each step, apart from the opening of overlaps. So the pose at rest is one
that the bodies reach without gaining energy, and no claim about dynamics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.settled_pose.descent import Descent
from kilter.analysis.settled_pose.near_points import NearPoints, find_near_points
from kilter.analysis.settled_pose.rest import Rest, RestState, Step, WayKind
from kilter.analysis.settled_pose.rest_programs import RestPrograms
from kilter.analysis.settled_pose.rest_proof import closed_gap
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.straight_falls import straight_falls
from kilter.arrays import Array, Index, Mask, connected
from kilter.contact import ContactSet
from kilter.tell.numbers import number
from kilter.work import stop_if_late

Tell = Callable[[str], None]

PUSHES = 30
"""Largest number of rounds that open overlaps."""
ROUNDS = 400
"""Largest number of steps."""
FIRST, LONGEST = 0.02, 0.15
"""Movement in the first step, and the longest in a step, over the size of a body [-]."""
SLOWEST = 1e4
"""Largest time of a step, in times in which a body would fall by its size [-]."""
SHORTEST = 1e-7
"""Length of a step at which a body counts as not moving on [-]."""
STILL = 1e-10
"""Movement in a step that counts as none [sizes]."""
DEEP = 0.05
"""Overlap after a step at which the step is taken back, over its length [-]."""
CORRECTS = 1e-2
"""Length of a movement that corrects the step before it [sizes]."""
FLOATS = 1e-6
"""Gap to the support from which a body floats [sizes]."""


@dataclass(slots=True)
class _State:
    """The bodies while they move."""

    bodies: RigidBodies
    contacts: ContactSet
    """Contacts of the drawn pose."""
    length: float
    weight: float
    closed: float
    """Gap that counts as closed [length unit]."""
    tell: Tell
    stride: Array
    """Length of the next step of each body [length unit], shape (B,)."""
    asleep: Mask
    gone: Mask
    """Bodies at rest, and bodies that left the scene, shape (B,)."""
    ways: list[list[Step]] = field(default_factory=list)
    round_body: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))
    rounds: int = 0

    def move(self, step: Array, how: WayKind | None) -> None:
        """Move the bodies by a step (B, 6), and note the way of each; None: by its kind.

        A correction of a step, which is short, belongs to the movement before it.
        """
        self.bodies = self.bodies.screwed(step)
        far = np.linalg.norm(step[:, :3], axis=1)
        turn = np.linalg.norm(step[:, 3:], axis=1)
        for k in np.flatnonzero(far + turn * self.bodies.size / 2 > STILL * self.length).tolist():
            kind = how or self._kind(k, float(far[k]), float(turn[k]))
            short = far[k] + turn[k] * self.bodies.size[k] / 2 < CORRECTS * self.bodies.size[k]
            if short and self.ways[k] and self.rounds:
                kind = self.ways[k][-1].how
            self._note(k, kind, far[k], turn[k])

    def _kind(self, body: int, far: float, turn: float) -> WayKind:
        """Kind of a movement in contact."""
        if turn * self.bodies.size[body] < far:
            return "slid"
        return "rolled" if self.round_body[body] else "tipped"

    def _note(self, body: int, how: WayKind, far: float, turn: float) -> None:
        """Add a movement to the way of a body."""
        way = self.ways[body]
        degrees = float(np.degrees(turn))
        if way and way[-1].how == how:
            last = way.pop()
            far, degrees = far + last.distance, degrees + last.angle_deg
        way.append(Step(how, float(far), degrees))


def come_to_rest(
    bodies: RigidBodies, contacts: ContactSet, *, reach: float | None, tell: Tell
) -> Rest:
    """Bring bodies to rest from their current pose.

    Arguments: `contacts`: those of the drawn pose; `reach`: largest way of a part [length unit];
    None: no limit.
    """
    state = _begin(bodies, contacts, tell)
    stuck = _open_overlaps(state)
    if stuck is not None:
        return stuck
    while True:
        _fall(state)
        again = _settle_down(state)
        if not again:
            break
    return _result(state, reach)


def _begin(bodies: RigidBodies, contacts: ContactSet, tell: Tell) -> _State:
    """The state before the first movement."""
    geometry = bodies.drawn.geometry
    free = ~geometry.grounded
    count = len(bodies.mass)
    sizes = geometry.size[free] if free.any() else geometry.size
    weights = geometry.mass[free] * float(np.linalg.norm(bodies.drawn.gravity))
    curved = np.zeros(count, dtype=bool)
    curved[bodies.of_part[np.diff(geometry.surfaces.start) > 0]] = True
    return _State(
        bodies, contacts, float(np.median(sizes)), float(weights.mean()) if free.any() else 1.0,
        0.1 * closed_gap(bodies.drawn), tell, FIRST * np.maximum(bodies.size, 1e-300),
        ~bodies.moves, np.zeros(count, dtype=bool), [[] for _ in range(count)], curved,
    )  # fmt: skip


def _points(state: _State, reach: float) -> NearPoints:
    """Points near contact between different bodies, within a reach [length unit]."""
    points = find_near_points(state.bodies.assembly(), reach, reach)
    a, b = state.bodies.of_part[points.part_a], state.bodies.of_part[points.part_b]
    keep = (a != b) & ~state.gone[a] & ~state.gone[b]
    if state.bodies.drawn.planar:
        keep &= np.abs(points.normal[:, 1]) < 0.5
    return points.take(keep)


def _open_overlaps(state: _State, first: bool = True) -> Rest | None:
    """Open all overlaps by the least motion; the result if nothing opens them, else None."""
    deepest = max((o.depth for o in state.contacts.overlaps), default=0.0) if first else 0.0
    reach = max(1.5 * deepest, 1e-3 * state.length)
    for _ in range(PUSHES):
        stop_if_late()
        points = _points(state, reach)
        deep = -float(points.gap.min(initial=0.0))
        if deep <= state.closed:
            return None
        if first:
            state.tell(f"overlaps: {number(deep)}")
        programs = RestPrograms.of(state.bodies, points, state.length, state.weight)
        apart = programs.push_apart()
        if apart is None:
            depth, forces = programs.least_overlap()
            if depth * state.length <= 10 * state.closed:
                return None
            return _does_not_fit(state, points, depth * state.length, forces)
        step = programs.steps(apart, state.bodies)
        state.move(step, "pushed-out")
        moved = np.linalg.norm(step[:, :3], axis=1) + np.linalg.norm(step[:, 3:], axis=1) * (
            state.bodies.size / 2
        )
        state.asleep &= ~(moved > STILL * state.length)
        reach = max(min(reach, 4 * float(moved.max(initial=0.0))), 1e-4 * state.length)
    return None


def _does_not_fit(state: _State, points: NearPoints, depth: float, forces: Array) -> Rest:
    """The result for overlaps that no motion opens: the parts of the certificate."""
    pressed = forces > 1e-3 * max(float(forces.max(initial=0.0)), 1e-300)
    parts = np.unique(np.concatenate([points.part_a[pressed], points.part_b[pressed]]))
    names = tuple(state.bodies.drawn.names[k] for k in parts.tolist())
    return Rest(
        "does-not-fit", state.bodies, _ways(state), parts=names, depth=depth,
        why="no small motion opens all overlaps", rounds=state.rounds,
    )  # fmt: skip


# falls -----------------------------------------------------------------------------------


def _fall(state: _State) -> None:
    """Let all groups of bodies that nothing supports fall; those with nothing below leave."""
    for _ in range(len(state.bodies.mass)):
        stop_if_late()
        group = _floating_groups(state)
        if not group.any():
            return
        assembly = state.bodies.assembly()
        sweeps = Sweeps(replace(state.contacts, assembly=assembly))
        down = assembly.down
        number_of = group
        state.tell("falls")

        fall = straight_falls(sweeps, assembly, number_of[state.bodies.of_part])
        step = np.zeros((len(state.bodies.mass), 6))
        lost = np.isinf(fall)[number_of] & (number_of > 0) & ~state.gone
        lost &= ~_kept_by_joints(state, lost)
        state.gone |= lost
        fall = np.where(np.isfinite(fall), fall, 0.0)
        step[:, :3] = fall[number_of][:, None] * down
        step[~state.bodies.moves | state.gone] = 0.0
        moved = float(np.abs(step).max(initial=0.0))
        state.move(step, "fell")
        state.asleep[np.abs(step).max(axis=1) > 0] = False
        if moved <= FLOATS * state.length:
            return


def _kept_by_joints(state: _State, lost: Mask) -> Mask:
    """Bodies that joints connect with bodies that do not leave."""
    del state
    return np.zeros_like(lost)


def _floating_groups(state: _State) -> Index:
    """Group of each body: 0 if it touches the ground, directly or through others; (B,)."""
    points = _points(state, FLOATS * state.length)
    a, b = state.bodies.of_part[points.part_a], state.bodies.of_part[points.part_b]
    joined = [[state.bodies.body_of(n) for n in j.parts] for j in state.bodies.drawn.joints]
    ends = np.concatenate([np.column_stack([a, b]), np.array(joined, np.int64).reshape(-1, 2)])
    label = connected(len(state.bodies.mass), ends[:, 0], ends[:, 1])
    group = label + 1
    held = ~state.bodies.moves
    group[np.isin(label, np.unique(label[held]))] = 0
    group[state.gone] = 0
    loaded = [state.bodies.body_of(load.part) for load in state.bodies.drawn.loads]
    group[loaded] = 0
    return (
        np.where(group > 0, np.unique(group, return_inverse=True)[1], 0) if group.any() else group
    )


# steps -----------------------------------------------------------------------------------


def _settle_down(state: _State) -> bool:
    """Move the bodies step by step until all are at rest; whether one lost its support."""
    while state.rounds < ROUNDS:
        stop_if_late()
        active = ~state.asleep & ~state.gone & state.bodies.moves
        if not active.any():
            return False
        state.rounds += 1
        most = np.minimum(state.stride, LONGEST * state.bodies.size)
        reach = 2 * float(most[active].max())
        points = _points(state, reach)
        island = _islands(state, points, active)
        stride = _stride_of_islands(state, island)
        program = Descent.of(state.bodies, points, island >= 0, state.length, state.weight)
        step = program.step(stride / state.length, points.gap <= 0.5 * reach)
        if step is None:
            state.stride[active] /= 4
            if state.stride[active].max() < SHORTEST * state.length:
                return False
            continue
        if _advance(state, points, island, stride, step):
            return True
    return False


def _islands(state: _State, points: NearPoints, active: Mask) -> Index:
    """Number of the island of bodies that may affect each other; -1 if nothing moves there."""
    moves = state.bodies.moves & ~state.gone
    a, b = state.bodies.of_part[points.part_a], state.bodies.of_part[points.part_b]
    both = moves[a] & moves[b]
    joined = [[state.bodies.body_of(n) for n in j.parts] for j in state.bodies.drawn.joints]
    ends = np.concatenate(
        [np.column_stack([a, b])[both], np.array(joined, np.int64).reshape(-1, 2)]
    )
    ends = ends[moves[ends].all(axis=1)]
    label = connected(len(moves), ends[:, 0], ends[:, 1])
    awake = np.isin(label, np.unique(label[active]))
    return np.where(awake & moves, label, -1)


def _stride_of_islands(state: _State, island: Index) -> Array:
    """The shortest stride of each island, for its bodies; 0 for bodies that stand still."""
    least = np.full(len(island) + 1, np.inf)
    np.minimum.at(least, island, state.stride)
    return np.where(island >= 0, least[island], 0.0)


def _advance(state: _State, points: NearPoints, island: Index, stride: Array, step: Array) -> bool:
    """Take a step where it is sound; whether a body lost its support."""
    bodies = state.bodies
    far = (
        np.linalg.norm(step[:, :3], axis=1) + np.linalg.norm(step[:, 3:], axis=1) * bodies.size / 2
    )
    moving = far > STILL * state.length
    quiet = np.ones(len(island) + 1, dtype=bool)
    np.logical_and.at(quiet, island, ~moving)
    state.asleep |= (island >= 0) & quiet[island]
    state.tell(f"step {state.rounds}: {number(float(far.max(initial=0.0)))}")
    if not moving.any():
        return False
    step = np.where(moving[:, None], step, 0.0)
    before = state.bodies
    energy = before.center @ bodies.drawn.down
    trial = before.screwed(step)
    after = trial.center @ bodies.drawn.down
    state.bodies = trial
    most = np.minimum(stride, LONGEST * bodies.size)
    near = _points(state, 0.1 * float(most.max()))
    state.bodies = before
    deep = np.zeros(len(island) + 1)
    for side in (near.part_a, near.part_b):
        np.maximum.at(deep, island[bodies.of_part[side]], -near.gap)
    gain = np.zeros(len(island) + 1)
    np.add.at(gain, island, bodies.mass * (after - energy))
    new = -points.gap.min(initial=0.0)
    bad = (deep[island] > DEEP * most + 2 * new + state.closed) | (
        gain[island] < -1e-9 * state.length * bodies.mass[island >= 0].sum()
    )
    bad &= island >= 0
    state.stride = np.where(
        island < 0,
        state.stride,
        np.where(bad, stride / 4, np.minimum(2 * stride, LONGEST * bodies.size)),
    )
    state.move(np.where(bad[:, None], 0.0, step), None)
    state.asleep |= (state.stride < SHORTEST * state.length) & (island >= 0)
    _open_overlaps(state, first=False)
    return bool(_floating_groups(state).any())


def _shortened(state: _State, island: Index, step: Array) -> tuple[Array, Array]:
    """The step, shorter for islands in which a body would move too far; way of each body."""
    size = state.bodies.size
    far = np.linalg.norm(step[:, :3], axis=1) + np.linalg.norm(step[:, 3:], axis=1) * size / 2
    share = np.ones(len(island) + 1)
    np.minimum.at(share, island, 1.5 * LONGEST * size / np.maximum(far, 1e-300))
    share = np.minimum(share, 1.0)[island]
    return step * share[:, None], far * share


def _next_stride(state: _State, stride: Array, far: Array) -> Array:
    """Stride of the next step: twice as long, unless a body would move too far in it."""
    longest = LONGEST * state.bodies.size
    grown = np.minimum(2 * stride, stride * longest / np.maximum(far, 1e-300))
    return np.minimum(grown, SLOWEST * state.bodies.size)


def _ways(state: _State) -> tuple[tuple[Step, ...], ...]:
    return tuple(tuple(way) for way in state.ways)


def _result(state: _State, reach: float | None) -> Rest:
    """The result in the last pose."""
    points = find_near_points(state.bodies.assembly(), 1e-3 * state.length, 1e-3 * state.length)
    closed = points.bears & (np.abs(points.gap) <= 10 * state.closed)
    names = state.bodies.drawn.names
    leaves = tuple(names[k] for k in np.flatnonzero(state.gone[state.bodies.of_part]).tolist())
    moving = ~state.asleep & ~state.gone & state.bodies.moves
    parts = tuple(names[k] for k in np.flatnonzero(moving[state.bodies.of_part]).tolist())
    free = state.bodies.free
    verdict: RestState = "at-rest"
    why = ""
    if parts:
        verdict, why = "not-found", f"the parts still move after {state.rounds} steps"
    elif leaves:
        verdict = "falls" if state.gone[free].all() else "partly"
        why = "nothing is below the parts"
    far = np.linalg.norm(state.bodies.movements()[:, :3], axis=1)
    far[np.isin(names, leaves)] = 0.0
    if reach is not None and far.max(initial=0.0) > reach * (1 + 1e-9):
        k = int(far.argmax())
        verdict, parts = "not-found", (names[k],)
        why = f"{names[k]!r} would move {number(float(far[k]), 3)} {state.bodies.drawn.units}"
    return Rest(
        verdict, state.bodies, _ways(state), leaves, parts, 0.0, why, state.rounds,
        points.take(closed),
    )  # fmt: skip
