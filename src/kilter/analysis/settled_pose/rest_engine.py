"""From any state to a pose at rest: overlaps out, straight falls, then tipping, sliding, rolling.

1. Groups of bodies that are sunk into each other come to rest by the least motion, if it exists
   within about the depth of their overlaps (`_close_sunk_groups`). Other overlaps open by the least
   motion, in rounds (`RestPrograms.push_apart`). Bodies whose overlaps no motion opens stay in
   place, and the others come to rest.
2. Groups of bodies that nothing supports fall straight down until they meet a supported part, all
   at the same time (`straight_falls`). A group with nothing below it leaves the scene.
3. Bodies that no forces hold move by a quasi-static step (`descent`) until they stop; a step obeys
   contact and Coulomb's law at all points within its length. If a body loses its support, it falls
   again.

Bodies on joints that their own loads do not move, such as a drawer, stand still until all others
are at rest. Then they move too, if something pushes them: a light bowl that falls into an open
drawer, and leans against its front for a moment, would else push the drawer to its stop, since a
quasi-static motion has no duration.

Potential energy falls in each step, apart from the opening of overlaps. So the pose at rest is one
that the bodies reach without gaining energy, and no claim about dynamics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.settled_pose.body_copies import BodyCopies, find_copies
from kilter.analysis.settled_pose.candidate_points import CandidatePoints
from kilter.analysis.settled_pose.closing_motion import least_motion, sunk_depths
from kilter.analysis.settled_pose.descent import Descent
from kilter.analysis.settled_pose.joint_rows import spring_energy
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rest import RestResult, RestState, WayKind, WayStep
from kilter.analysis.settled_pose.rest_programs import RestPrograms, loads
from kilter.analysis.settled_pose.rest_proof import closed_gap
from kilter.analysis.settled_pose.rest_search import pressed_parts, units_of
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.straight_falls import FEW_CURVED, falling_distance, straight_falls
from kilter.arrays import Array, Index, Mask, connected
from kilter.contact import ContactSet
from kilter.errors import some_names
from kilter.tell.numbers import number
from kilter.work import stop_if_late

Tell = Callable[[str], None]

PUSHES = 30
"""Largest number of rounds that open overlaps."""
OPENED, STUCK, SHORTEST_PUSH = 0.25, 0.9, 1 / 64
"""Share of the expected opening below which the next steps are shorter, remaining share of an
overlap from which no motion opens it, and part of a step that is taken though it opens nothing [-].
"""
ROUNDS = 400
"""Largest number of steps."""
SLIDES = 16
"""Number of steps after which bodies that slide on without an end are looked for."""
PATIENCE = 5
"""Number of steps after which a fall that moved nothing is tried again."""
FIRST, LONGEST = 0.02, 0.15
"""Movement in the first step, and the longest in a step, over the size of a body [-]."""
SLOWEST = 1e4
"""Largest time of a step, in times in which a body would fall by its size [-]."""
SHORTEST = 1e-7
"""Length of a step at which a body counts as not moving on [-]."""
STILL = 2.0
"""Movement in a step that counts as none, over the gap that counts as closed [-]."""
STALLS = 8
"""Number of steps without a descent after which the steps become shorter, and twice the movement
counts as none, up to half of the gap that the verification accepts."""
STANDS = 24
"""Number of steps without a descent after which bodies without loads stand still."""
EXACT = 2e-5
"""Movement in a step that may come from the solver, whose objective is exact to the square of this
[strides]."""
SHORT, SHORTER = 2e-6, 100.0
"""Length of the last step of a body at rest [sizes], and factor between the steps that confirm it.
"""
ROUNDING = 1e-9
"""Rounding of the length of a step, relative [-]."""
WILD = 1e6
"""Movement in a step from which the solver has failed [strides]."""
DEEP = 0.05
"""Overlap after a step at which the step is taken back, over its length [-]."""
CORRECTS = 1e-2
"""Length of a movement that corrects the step before it [sizes]."""
BALANCES, BALANCED, ROLLED = 40, 1e-13, 1e-6
"""Largest number of steps that balance bodies on joints and round bodies at rest, and movement in
a step that ends them with and without springs [lengths]."""
BALANCE_STRIDE, LIGHT, ROLLS = 1e-3, 1e-6, 1e-3
"""Length of such a step [lengths], factor of the inertia, which springs then outweigh, and first
share of the motion of bodies without springs [-]."""
FREELY = 0.9
"""Fall in a step from which a body falls freely [strides]."""
SIDEWAYS = 1e-6
"""Component of a normal along gravity up to which a contact is at a side [-]."""
GRIP = 0.1
"""Factor of the friction of bodies that slide on beside a joint that they pushed [-]."""
EASY, EASED, EASES = 1e-3, 0.1, 60
"""Factor of the friction with which resting bodies slide on, longest way there [sizes], and largest
number of steps."""
STRAIGHT = 0.999
"""Cosine of the angle to gravity up to which a movement without a turn is a fall [-]."""
SUNK = 2.0
"""Reach of the least motion of bodies that are sunk into each other, over the deepest overlap [-].
"""
SOFT = 0.05
"""Deepest overlap of soft contacts, over the median size of the bodies of a group [-]."""
FLOATS = 1e-6
"""Gap to the support from which a body floats [sizes]."""


@dataclass(slots=True)
class _State:
    """The bodies while they move."""

    bodies: RigidBodies
    candidates: CandidatePoints
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
    ways: list[list[WayStep]]
    round_body: Mask
    """Whether a body has curved faces, shape (B,)."""
    speed: Array
    """Movement in the last step, over its stride, shape (B,)."""
    step: Array
    step_velocity: Array
    """Motion of each body in the last step, and the same over its stride, shape (B, 6)."""
    still: Array
    """Movement in a step that counts as none [length unit], shape (B,)."""
    quiet: Array
    """Longest stride at which a body and its island stood still since it moved, shape (B,)."""
    joined: Index
    """Pairs of different bodies with a joint between them, shape (n, 2)."""
    limit: Array
    """Way from the first pose from which a body leaves the scene [length unit], shape (B,)."""
    first: RigidBodies
    """The bodies in the first pose."""
    loose: Array
    """Gap up to which a body does not float [length unit], shape (B,): straight falls end
    before curved surfaces meet."""
    grip: float = 1.0
    """Factor of the friction [-]."""
    most_rounds: int = ROUNDS
    """Largest number of steps."""
    falls_from: int = 0
    """Number of steps from which bodies without support fall: a fall that moves none is not
    repeated at once."""
    rounds: int = 0
    unfit: tuple[str, ...] = ()
    """Parts that stay in place, since no motion opens their overlaps."""
    depth: float = 0.0
    """Depth of the deepest of these overlaps that remains after the least motion [length unit]."""
    aside: RigidBodies | None = None
    sunk: bool = False
    eased: bool = False
    """`aside`, `sunk` and `eased` of the result."""

    def copied(self) -> _State:
        """A state that moves on its own."""
        values = [(each.name, getattr(self, each.name)) for each in fields(self)]
        arrays: dict[str, Any] = {n: v.copy() for n, v in values if isinstance(v, np.ndarray)}
        return replace(self, ways=[list(way) for way in self.ways], **arrays)

    def move(self, step: Array, how: WayKind | None) -> None:
        """Move the bodies by a step (B, 6), and note the way of each; None: by its kind.

        A correction of a step, which is short, belongs to the movement before it.
        """
        self.bodies = self.bodies.screwed(step)
        far = np.linalg.norm(step[:, :3], axis=1)
        turn = np.linalg.norm(step[:, 3:], axis=1)
        way = self.bodies.travel(step)
        for k in np.flatnonzero(way > STILL * self.closed).tolist():
            kind = how or self._kind(k, step[k], float(far[k]), float(turn[k]))
            short = way[k] < CORRECTS * self.bodies.size[k]
            last = self.ways[k][-1].how if self.ways[k] else "pushed-out"
            kind = last if short and last != "pushed-out" else kind
            self._note(k, kind, far[k], turn[k])
        if np.isfinite(self.limit).any():
            self.gone |= self.way > self.limit

    def put(self, group: Mask, bodies: RigidBodies) -> None:
        """Put a group of bodies (B,), those of `bodies` from 1 on, where they rest."""
        before, self.bodies = self.bodies, self.bodies.with_poses(group, bodies)
        turned = np.einsum("bij,bkj->bik", self.bodies.rotation, before.rotation)
        turn = np.linalg.norm(turned - np.eye(3), axis=(1, 2)) / np.sqrt(2)
        far = np.linalg.norm(self.bodies.center - before.center, axis=1)
        for k in np.flatnonzero(far + turn * self.bodies.size / 2 > STILL * self.closed).tolist():
            self._note(k, "pushed-out", far[k], turn[k])
        self.asleep |= group

    @property
    def way(self) -> Array:
        """Longest way of a point of each body from the first pose, at most [length unit], (B,)."""
        turn = np.linalg.norm(self.bodies.rotation - self.first.rotation, axis=(1, 2))
        shift = np.linalg.norm(self.bodies.center - self.first.center, axis=1)
        return np.asarray(shift + turn * self.bodies.size / 2)

    def _kind(self, body: int, step: Array, far: float, turn: float) -> WayKind:
        """Kind of a movement in a step."""
        straight = step[:3] @ self.bodies.drawn.down >= STRAIGHT * far
        if straight and turn * self.bodies.size[body] < (1 - STRAIGHT) * far:
            return "fell"
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
        way.append(WayStep(how, float(far), degrees))


def come_to_rest(
    bodies: RigidBodies,
    contacts: ContactSet,
    *,
    reach: float | None,
    tell: Tell,
    limit: Array | None = None,
    rounds: int = ROUNDS,
    sunk: bool = True,
    ease: bool = False,
) -> RestResult:
    """Bring bodies to rest from their current pose.

    Arguments: `contacts`: those of the drawn pose; `reach`: largest way of a part [length unit];
    None: no limit; `limit` (B,): way of each body from which it counts as leaving the scene;
    `rounds`: largest number of steps; `sunk`: whether sunk groups first come to rest by the least
    motion; `ease`: whether resting bodies slide on to where they need little friction.
    """
    copies = find_copies(bodies)
    if copies is not None:
        chosen, few = copies.chosen, bodies.only(copies.chosen)
        most = None if limit is None else limit[np.append(0, np.flatnonzero(chosen))]
        found = _search(few, contacts, tell, most, rounds=rounds, sunk=sunk, ease=ease)
        whole = _with_copies(found, copies, contacts, tell)
        if whole is not None:
            return _result(whole, reach)
    found = _search(bodies, contacts, tell, limit, rounds=rounds, sunk=sunk, ease=ease)
    return _result(found, reach)


def _search(
    bodies: RigidBodies, contacts: ContactSet, tell: Tell, limit: Array | None, *, rounds: int,
    sunk: bool, ease: bool,
) -> _State:  # fmt: skip
    """Bring bodies to rest; arguments as of `come_to_rest`."""
    state = _begin(bodies, contacts, tell)
    state.most_rounds = rounds
    if limit is not None:
        state.limit = limit
        state.stride = np.minimum(state.stride, limit / 8)
    before = state.bodies
    if sunk:
        _close_sunk_groups(state)
    closed = state.bodies is not before
    _open_overlaps(state)
    aside = state.bodies
    state = _settle_beside_joints(state)
    if ease:
        _ease(state)
    _balance(state)
    state.aside, state.sunk, state.eased = aside, closed, ease
    return state


def _with_copies(
    found: _State, copies: BodyCopies, contacts: ContactSet, tell: Tell
) -> _State | None:
    """All bodies at rest, from the rest of one group of each class; None if copies may differ."""
    if found.unfit:
        return None
    place = np.append(0, np.cumsum(copies.chosen)[1:])[copies.source]
    ways = [list(found.ways[k]) for k in place.tolist()]
    if not copies.are_apart(ways, found.gone[place]):
        return None
    state = _begin(copies.bodies, contacts, tell)
    state.bodies, state.ways, state.asleep = copies.at_rest(found.bodies), ways, found.asleep[place]
    state.aside = None if found.aside is None else copies.at_rest(found.aside)
    state.gone, state.rounds = found.gone[place], found.rounds
    state.sunk, state.eased = found.sunk, found.eased
    return state


def _begin(bodies: RigidBodies, contacts: ContactSet, tell: Tell) -> _State:
    """The state before the first movement."""
    geometry = bodies.drawn.geometry
    count = len(bodies.mass)
    length, weight = units_of(bodies)
    curved = np.zeros(count, dtype=bool)
    curved[bodies.of_part[np.diff(geometry.surfaces.start) > 0]] = True
    closed = 0.1 * closed_gap(bodies.drawn)
    slack = np.zeros(count)
    np.maximum.at(slack, bodies.of_part, geometry.slack)
    return _State(
        bodies, CandidatePoints.of(bodies), contacts, length, weight,
        closed, tell, FIRST * np.maximum(bodies.size, 1e-300),
        ~bodies.moves, np.zeros(count, dtype=bool), [[] for _ in range(count)], curved,
        np.zeros(count), np.zeros((count, 6)), np.zeros((count, 6)),
        np.full(count, STILL * closed), np.zeros(count),
        np.array([e for e in map(bodies.ends, bodies.drawn.joints) if len(set(e)) == 2],
                 np.int64).reshape(-1, 2),
        np.full(count, np.inf), bodies, FLOATS * length + 2 * slack,
    )  # fmt: skip


def _points(state: _State, reach: float | Array, bodies: RigidBodies | None = None) -> NearPoints:
    """Points near contact between different bodies; `reach` [length unit] of all, or each (B,).

    `bodies`: those in another pose than that of the state.
    """
    points = state.candidates.near(bodies or state.bodies, reach)
    if state.grip < 1.0:
        points = replace(points, mu=state.grip * points.mu)
    gone, moves = (mask[state.bodies.of_part] for mask in (state.gone, state.bodies.moves))
    there = ~gone[points.part_a] & ~gone[points.part_b]
    return points.take(there & (moves[points.part_a] | moves[points.part_b]))


def _close_sunk_groups(state: _State) -> None:
    """Move groups of bodies that are sunk into each other to rest by the least motion.

    A group whose overlaps are deeper than those of soft contacts stays as it is, as does one that
    has no pose at rest within `SUNK` times its deepest overlap.
    """
    bodies = state.bodies
    points = _points(state, state.closed)
    island = _islands(state, points, bodies.moves)
    deep = np.where(island >= 0, _deepest(state, island, points), 0.0)
    deep[(deep <= 5 * state.closed) | np.isfinite(state.limit)] = 0.0
    points = _points(state, np.maximum(SUNK * deep, state.closed))
    island = _islands(state, points, (deep > 0) & bodies.moves)
    depth = sunk_depths(bodies, points)
    for each in np.unique(island[island >= 0]).tolist():
        group = island == each
        deepest = float(deep[group].max())
        if deepest > SOFT * np.median(bodies.size[group]):
            continue
        state.tell(f"sunk group: {number(deepest)}")
        own = np.append(0.0, depth[group])
        found = least_motion(bodies.only(group), SUNK * deepest, state.candidates.near, own)
        if found.state == "at-rest":
            state.put(group, found.bodies)


def _open_overlaps(state: _State, *, upright: bool = False) -> None:
    """Open overlaps by the least motion; bodies whose overlaps nothing opens stay in place.

    `upright`: whether bodies shift rather than turn, as they do within a limited way. A step that
    opens less than a linear motion would is followed by shorter ones: a long turn of a jammed body
    may lead it deeper into its neighbours.
    """
    deepest = max((o.depth for o in state.contacts.overlaps), default=0.0)
    reach = max(1.5 * deepest, 1e-3 * state.length)
    limited = bool(np.isfinite(state.limit).any())
    if limited:  # deeper overlaps would move bodies beyond their limits
        reach = min(reach, float(state.limit[np.isfinite(state.limit)].max()))
    pushes, longest, points = 0, reach, _points(state, reach)
    while pushes < PUSHES:
        stop_if_late()
        bodies = state.bodies
        programs = RestPrograms.of(bodies, points, state.length, state.weight, inertia=bodies.mass)
        deep = -float(programs.gap.min(initial=0.0)) * state.length
        if deep <= 5 * state.closed:  # half of what counts as closed
            return
        state.tell(f"overlaps: {number(deep)}")
        left, apart = 0.0, programs.push_apart(upright=upright or limited)
        if apart is None:
            least, forces, apart = programs.least_overlap()
            left = least * state.length
            if left > STUCK * deep:
                if deep <= 10 * state.closed:
                    return
                _stay(state, programs, left, forces)
                points = _points(state, reach)
                continue
        pushes += 1
        step = programs.steps(apart, bodies)
        far = float(bodies.travel(step).max(initial=0.0))
        share = min(longest / max(far, 1e-300), 1.0)
        step, far = share * step, share * far
        wide = max(min(reach, 4 * far), 1e-4 * state.length)
        after = _points(state, wide, bodies.screwed(step))
        opened = (deep + float(after.gap.min(initial=0.0))) / (share * (deep - left))
        if opened < OPENED:
            longest = far / 4
        elif opened > 1 - OPENED:
            longest *= 2
        if opened > 0 or share < SHORTEST_PUSH:
            state.move(step, "pushed-out")
            points, reach = after, wide


def _stay(state: _State, programs: RestPrograms, depth: float, forces: Array) -> None:
    """Keep the bodies of a certificate in place: no motion opens their overlaps.

    Arguments: `depth`: least depth that remains [length unit]; `forces` (K,): the certificate.
    """
    bodies = state.bodies
    if not forces.any():  # the solver failed
        forces = (programs.gap <= programs.gap.min()).astype(np.float64)
    names = pressed_parts(bodies, programs, forces)
    state.unfit += tuple(name for name in names if name not in state.unfit)
    state.depth = max(state.depth, depth)
    moves = bodies.moves.copy()
    moves[[bodies.body_of(name) for name in names]] = False
    state.bodies, state.asleep = replace(bodies, moves=moves), ~moves


# falls -----------------------------------------------------------------------------------


def _fall(state: _State) -> bool:
    """Let all groups of bodies that nothing supports fall; those with nothing below leave.

    Returns False if some have no support, and none of them moved or left.
    """
    for _ in range(len(state.bodies.mass)):
        stop_if_late()
        gap = FLOATS * state.length
        group = _floating_groups(state, _points(state, gap), gap)
        if not group.any():
            return True
        state.tell("falls")
        before = int(state.gone.sum())
        if _drop(state, group) <= gap and before == state.gone.sum():
            return False
    return True


def _drop(state: _State, group: Index) -> float:
    """Let groups of bodies (B,) fall until they land; returns the longest fall [length unit]."""
    assembly = state.bodies.assembly()
    sweeps = Sweeps(replace(state.contacts, assembly=assembly))
    among = np.where(state.gone, -1, group)[state.bodies.of_part]
    few = np.diff(assembly.geometry.surfaces.start) <= FEW_CURVED
    simple = few & ~state.candidates.pieces.several
    fall = straight_falls(sweeps, assembly, among, on_surfaces=simple)[0][group]
    lost = np.isinf(fall) | (state.way + fall > state.limit)
    state.gone |= lost
    length = np.where(lost, 0.0, fall)
    step = np.zeros((len(state.bodies.mass), 6))
    step[:, :3] = length[:, None] * assembly.down
    state.move(step, "fell")
    state.asleep[length > 0] = False
    return float(length.max(initial=0.0))


def _falling_freely(
    state: _State, points: NearPoints, program: Descent, stride: Array, rough: Mask
) -> Index:
    """Group of each body that falls beside others, which do not press it; else 0; shape (B,).

    A contact at a side has friction only if something presses it.
    """
    none = np.zeros(len(stride), dtype=np.int64)
    down = state.bodies.drawn.down
    closed = np.abs(points.gap) <= FLOATS * state.length
    side = np.abs(points.normal @ down) < SIDEWAYS
    a, b = state.bodies.of_part[points.part_a], state.bodies.of_part[points.part_b]
    # what rests on a body that does not fall does not fall
    rests = closed & ~side
    label = connected(len(stride), a[rests], b[rests])
    held = (stride <= 0) | ~state.bodies.moves
    held[state.joined.ravel()] = True
    free = ~np.isin(label, label[held])
    if not (free[a] | free[b])[side & closed].any():
        return none
    found = program.without_friction(stride / state.length, rough, side)
    if found is None:
        return none
    step, pressed = found
    held = step[:, :3] @ down < FREELY * stride
    held[np.concatenate([a[pressed], b[pressed]])] = True
    free &= ~np.isin(label, label[held])
    ends = np.column_stack([a, b])[rests]
    label = connected(len(free), *ends[free[ends].all(axis=1)].T) + 1
    return np.unique(np.append(np.where(free, label, 0), 0), return_inverse=True)[1][:-1]


def _floating_groups(state: _State, points: NearPoints, gap: float | Array) -> Index:
    """Group of each body: 0 if it touches the ground, directly or through others; (B,).

    Bodies touch if a point has at most this gap [length unit], of all points or each (K,). Joints
    and loads support a body.
    """
    touching = points.take(points.gap <= gap)
    a, b = state.bodies.of_part[touching.part_a], state.bodies.of_part[touching.part_b]
    ends = np.concatenate([np.column_stack([a, b]), state.joined])
    label = connected(len(state.bodies.mass), ends[:, 0], ends[:, 1])
    group = label + 1
    loaded = [state.bodies.body_of(load.part) for load in state.bodies.drawn.loads]
    supported = ~state.bodies.moves
    supported[loaded] = True
    group[np.isin(label, label[supported]) | state.gone] = 0
    return np.unique(np.append(group, 0), return_inverse=True)[1][:-1]


# steps -----------------------------------------------------------------------------------


def _idle(state: _State) -> Mask:
    """Bodies on joints that their own loads do not move, such as drawers and doors, shape (B,)."""
    bodies = state.bodies
    idle = np.zeros(len(bodies.mass), dtype=bool)
    idle[state.joined.ravel()] = True
    idle &= bodies.moves
    if not idle.any():
        return idle
    nowhere = _points(state, 0.0).take(np.zeros(0, dtype=np.int64))
    program = Descent.of(bodies, nowhere, idle, state.length, state.weight)
    step = program.step(state.stride / state.length, np.zeros(0, dtype=bool))
    if step is None:
        return np.zeros_like(idle)
    return idle & (bodies.travel(step) <= EXACT * state.stride)


def _settle_beside_joints(state: _State) -> _State:
    """Bring all bodies to rest; those of `_idle` stand still until the others rest.

    If they then move, the bodies that push them are tried again: they slide on with little
    friction first. Of both results, the one counts in which the idle bodies move less.
    """
    idle = _idle(state)
    if not (state.bodies.moves & ~idle).any():
        idle[:] = False
    state.bodies = replace(state.bodies, moves=state.bodies.moves & ~idle)
    _fall_and_settle(state)
    if not idle.any():
        return state
    before = state.copied()
    pushed = _released(state, idle)
    again = before.copied()
    moves = again.bodies.moves
    again.bodies = replace(again.bodies, moves=moves | idle)
    near = _islands(again, _points(again, _reach(again)), pushed > STILL * state.closed) >= 0
    if not near.any():
        return state
    again.bodies, again.grip = replace(again.bodies, moves=moves), GRIP
    again.asleep &= ~near
    _fall_and_settle(again)
    again.grip, again.asleep = 1.0, again.asleep & ~near
    less = _released(again, idle) + STILL * state.closed

    def fault(of: _State, way: Array) -> tuple[float, ...]:
        moving = ~of.asleep & ~of.gone & of.bodies.moves
        return float(of.gone.sum()), float(moving.sum()), float(way.max())

    return again if fault(again, less) < fault(state, pushed) else state


def _released(state: _State, idle: Mask) -> Array:
    """Let idle bodies move too, until all are at rest; their ways [length unit], shape (B,)."""
    before = state.way
    state.bodies = replace(state.bodies, moves=state.bodies.moves | idle)
    state.most_rounds, state.asleep = state.rounds + state.most_rounds, state.asleep & ~idle
    _fall_and_settle(state)
    way: Array = np.where(idle, state.way - before, 0.0)
    return way


def _fall_and_settle(state: _State) -> None:
    """Let bodies fall, and move them step by step, until all are at rest or have left."""
    again = True
    while again:
        state.falls_from = state.rounds if _fall(state) else state.rounds + PATIENCE
        again = _settle_down(state)


def _ease(state: _State) -> None:
    """Let resting bodies slide on with little friction, since soft friction creeps under load.

    Bodies that would go farther than `EASED`, or find no rest, stay, and so do those beside them.
    """
    size = state.bodies.size
    trial = _begin(state.bodies, state.contacts, state.tell)
    # a limit of the way shortens the steps, which must be long where the motion is slow
    trial.grip, trial.limit, trial.gone = EASY, size.copy(), state.gone.copy()
    trial.bodies = replace(trial.bodies, moves=trial.bodies.moves & ~_idle(trial))
    trial.candidates, trial.ways = state.candidates, [list(way) for way in state.ways]
    trial.most_rounds = EASES
    _fall_and_settle(trial)
    far = trial.gone | (trial.way > EASED * size)
    fails = stays = trial.bodies.moves & ~state.gone & (far | ~trial.asleep)
    if fails.any():
        near = np.where(state.bodies.moves, 2 * EASED * size, 0.0)
        stays = _islands(state, _points(state, near), fails) >= 0
    state.bodies = state.bodies.where(stays, trial.bodies)
    for k in np.flatnonzero(~stays).tolist():
        state.ways[k] = trial.ways[k]


@dataclass(slots=True)
class _Last:
    """The last step, which is taken back where it led into an overlap."""

    bodies: RigidBodies
    """The bodies before it."""
    island: Index
    stride: Array
    """Island and stride of each body, shape (B,)."""
    deep: Array
    """Deepest overlap of the island of each body before it [length unit], shape (B,)."""
    lowest: Array
    """Lowest place of the island of each body until then, as of `_count_stalls`, shape (B,)."""


def _settle_down(state: _State) -> bool:
    """Move the bodies step by step until all are at rest; whether one lost its support."""
    last: _Last | None = None
    lowest = np.full(len(state.bodies.mass), -np.inf)
    stalled = np.zeros(len(lowest), dtype=np.int64)
    while state.rounds < state.most_rounds:
        stop_if_late()
        active = ~state.asleep & ~state.gone & state.bodies.moves
        if not active.any():
            return False
        state.rounds += 1
        points, island = _awake_points(state)
        if state.rounds % SLIDES == 0:
            _slide_away(state, points)
        if last is not None and _taken_back(state, last, points, lowest):
            points, island = _awake_points(state)
        floats = _floating_groups(state, points, _widest(state, points, _reach(state)) / 4)
        if state.rounds >= state.falls_from and floats.any():
            return True
        stride = _stride_of_islands(state, island)
        reach = _widest(state, points, 2 * np.minimum(stride, LONGEST * state.bodies.size))
        near = (points.gap <= reach) & (reach > 0)
        points = _without_still_gaps(state, points.take(near))
        program = Descent.of(state.bodies, points, island >= 0, state.length, state.weight)
        rough = points.gap <= 0.5 * reach[near]
        group = _falling_freely(state, points, program, stride, rough)
        if group.any() and _drop(state, group) > FLOATS * state.length:
            last = None
            continue
        step = program.step(stride / state.length, rough)
        if step is None or (state.bodies.travel(step) > WILD * stride.max()).any():
            state.stride[island >= 0] /= 4
            state.asleep |= (island >= 0) & (state.stride < SHORTEST * state.length)
            continue
        deep = _deepest(state, island, points)
        last = _Last(state.bodies, island, stride, deep, lowest.copy())
        _advance(state, island, stride, step)
        _count_stalls(state, island, lowest, stalled)
        rocks = (stalled > 0) & (stalled % STALLS == 0) & (last.deep > 10 * state.closed)
        if rocks.any():  # corners of compounds that another piece hides while they are open
            state.stride = np.where(rocks, last.deep, state.stride)
            _open_overlaps(state, upright=True)
    return False


def _slide_away(state: _State, points: NearPoints) -> None:
    """Bodies leave that slide along a rail without an end, touch nothing, and have nothing ahead.

    Arguments: `points`: those near contact.
    """
    bodies, assembly = state.bodies, state.bodies.assembly()
    near = points.take(points.gap <= FLOATS * state.length)
    on = np.bincount(state.joined.ravel())
    pull = loads(bodies, state.length, state.weight).reshape(-1, 6)[:, :3] * state.weight
    for joint in bodies.drawn.joints:
        if joint.kind != "prismatic" or joint.limits is not None or joint.stiffness:
            continue
        ends = bodies.ends(joint)
        k = max(ends, key=lambda end: bool(bodies.moves[end]))
        if bodies.moves[list(ends)].sum() != 1 or on[k] != 1 or state.asleep[k]:
            continue
        axis = bodies.rotation[ends[0]] @ joint.axis
        parts = np.flatnonzero(bodies.of_part == k)
        along = float(pull[k - 1] @ axis)
        touches = np.isin(parts, np.append(near.part_a, near.part_b)).any()
        if abs(along) <= joint.friction or touches:
            continue
        sweeps = Sweeps(replace(state.contacts, assembly=assembly))
        state.gone[k] = falling_distance(assembly, sweeps, parts, np.sign(along) * axis) is None


def _balance(state: _State) -> None:
    """Move resting bodies on joints and round bodies until their loads are balanced.

    Contacts may be open by rounding, but a force of a spring and the moment of a weight about a
    hinge, or a point on which a body rolls, have no such tolerance. A joint is closed completely in
    each step, of which only a share may balance the loads.
    """
    bodies, asleep = state.bodies, state.asleep & state.bodies.moves & ~state.gone
    sprung = np.zeros(len(asleep), dtype=bool)
    hangs = sprung.copy()
    hangs[state.joined.ravel()] = True
    hangs &= state.way > STILL * state.closed
    for joint in bodies.drawn.joints:
        sprung[list(bodies.ends(joint))] |= joint.stiffness > 0
    chosen = asleep & (sprung | hangs | state.round_body)
    share, before, least = np.where(sprung, 1.0, ROLLS), None, np.full(len(asleep), np.inf)
    for _ in range(BALANCES if chosen.any() else 0):
        stop_if_late()
        points = _without_still_gaps(state, _points(state, CORRECTS * state.length))
        island = _islands(state, points, chosen)
        program = Descent.of(state.bodies, points, island >= 0, state.length, state.weight)
        light = replace(program, inertia=LIGHT * program.inertia)
        times, rough = np.full(len(sprung), BALANCE_STRIDE), np.ones(len(points), dtype=bool)
        step = light.step(times, rough)
        closing = light.closing(times, rough)
        if step is None or closing is None:
            break
        step = step - closing
        far = _most_of_island(island, state.bodies.travel(step)) / state.length
        bodies, least = bodies.where(far >= least, state.bodies), np.minimum(far, least)
        springs = _most_of_island(island, sprung) > 0
        if before is not None:
            time = _time_to_end(state, island, share[:, None] * before, before, step)
            share = np.where(springs | ~np.isfinite(time), share, time)
        chosen &= (far > np.where(springs, BALANCED, ROLLED)) & (far * share <= CORRECTS)
        goes_on, before = _most_of_island(island, chosen) > 0, step
        if not goes_on.any():
            break
        state.bodies = state.bodies.screwed(closing + np.where(goes_on, share, 0.0)[:, None] * step)
    state.bodies = bodies


def _most_of_island(island: Index, values: Array | Mask) -> Array:
    """The largest value (B,) of the bodies of the island of each body; 0 without an island."""
    most = np.zeros(len(island) + 1)
    np.maximum.at(most, island, values)
    return np.where(island >= 0, most[island], 0.0)


def _taken_back(state: _State, last: _Last, points: NearPoints, lowest: Array) -> bool:
    """Take the last step back for islands that it led into an overlap; whether there are any."""
    size = state.bodies.size
    deep = _deepest(state, last.island, points)
    most = DEEP * np.minimum(last.stride, LONGEST * size) + 2 * last.deep + state.closed
    bad = (deep > most) & (last.island >= 0)
    bad = np.isin(last.island, last.island[bad]) & (last.island >= 0)
    if not bad.any():
        return False
    state.bodies = state.bodies.where(~bad, last.bodies)
    lowest[bad] = last.lowest[bad]
    state.stride = np.where(bad, last.stride / 4, state.stride)
    state.asleep |= bad & (state.stride < SHORTEST * state.length)
    return True


def _deepest(state: _State, island: Index, points: NearPoints) -> Array:
    """Deepest overlap of the island of each body [length unit], shape (B,)."""
    deep = np.zeros(len(island) + 1)
    for side in (points.part_a, points.part_b):
        np.maximum.at(deep, island[state.bodies.of_part[side]], -points.gap)
    return deep[island]


def _count_stalls(state: _State, island: Index, lowest: Array, stalled: Index) -> None:
    """Shorten the stride of islands whose energy has not fallen for some steps.

    Round faces that fit each other closely may rock by rounding, about gaps that count as closed.
    """
    mass = state.bodies.mass
    total, weight = np.zeros(len(mass) + 1), np.zeros(len(mass) + 1)
    gravity = float(np.linalg.norm(state.bodies.drawn.gravity)) or 1.0
    np.add.at(total, island, mass * (state.bodies.center @ state.bodies.drawn.down))
    np.add.at(total, island, -spring_energy(state.bodies) / gravity)
    np.add.at(weight, island, mass)
    depth = (total / np.maximum(weight, 1e-300))[island]
    sinks = depth > lowest + STILL * state.closed
    stalled[:] = np.where(sinks, 0, stalled + (island >= 0))
    lowest[:] = np.maximum(lowest, depth)
    late = (stalled > 0) & (stalled % STALLS == 0)
    state.stride = np.where(late, state.stride / 4, state.stride)
    state.still[late] = np.minimum(2 * state.still[late], 5 * state.closed)
    loaded = np.zeros(len(island) + 1, dtype=bool)
    loaded[island[[state.bodies.body_of(load.part) for load in state.bodies.drawn.loads]]] = True
    state.asleep |= (stalled >= STANDS) & ~loaded[island]
    stalled[stalled >= STANDS] = 0
    state.asleep |= late & (state.stride < SHORTEST * state.length)


def _reach(state: _State) -> Array:
    """Largest gap of the points of each body in the next step [length unit], shape (B,)."""
    awake = ~state.asleep & ~state.gone & state.bodies.moves
    stride = np.minimum(state.stride, state.limit / 4)
    step = 2 * np.minimum(stride, LONGEST * state.bodies.size)
    return np.maximum(np.where(awake, step, 0.0), 4 * state.loose)


def _widest(state: _State, points: NearPoints, reach: Array) -> Array:
    """The larger reach of both bodies of each point, shape (K,)."""
    body = state.bodies.of_part
    widest: Array = np.maximum(reach[body[points.part_a]], reach[body[points.part_b]])
    return widest


def _without_still_gaps(state: _State, points: NearPoints) -> NearPoints:
    """The points, with gap 0 where closing the gap counts as no movement.

    Friction would permit a slip of the gap over mu there in each step.
    """
    body = state.bodies.of_part
    still = np.maximum(state.still[body[points.part_a]], state.still[body[points.part_b]])
    gap = np.where((points.gap > 0) & (points.gap <= still), 0.0, points.gap)
    return replace(points, gap=gap)


def _awake_points(state: _State) -> tuple[NearPoints, Index]:
    """Points near contact, and the island of each body (B,).

    Resting bodies of islands wake up. They and bodies that stand still take the stride of those
    that move, so that a body that comes near does not shorten the steps.
    """
    while True:
        points = _points(state, _reach(state))
        island = _islands(state, points, ~state.asleep & ~state.gone & state.bodies.moves)
        woken = state.asleep & (island >= 0)
        stride = _stride_of_islands(state, island)
        longer = (state.quiet > 0) & (stride > state.stride)
        if not (woken | longer).any():
            return points, island
        state.asleep &= ~woken
        state.stride = np.where(woken | longer, stride, state.stride)


def _islands(state: _State, points: NearPoints, active: Mask) -> Index:
    """Number of the island of bodies that may affect each other; -1 if nothing moves there."""
    moves = state.bodies.moves & ~state.gone
    a, b = state.bodies.of_part[points.part_a], state.bodies.of_part[points.part_b]
    ends = np.concatenate([np.column_stack([a, b]), state.joined])
    ends = ends[moves[ends].all(axis=1)]
    label = connected(len(moves), ends[:, 0], ends[:, 1])
    awake = np.isin(label, label[active])
    return np.where(awake & moves, label, -1)


def _stride_of_islands(state: _State, island: Index) -> Array:
    """The shortest stride of the bodies that move in each island, or of all if none moves.

    It is 0 for bodies that stand still.
    """
    least, moving = np.full((2, len(island) + 1), np.inf)
    own = np.minimum(state.stride, state.limit / 4)
    np.minimum.at(least, island, own)
    np.minimum.at(moving, island, np.where((state.quiet > 0) | state.asleep, np.inf, own))
    stride = np.where(np.isfinite(moving), moving, least)
    return np.where(island >= 0, stride[island], 0.0)


def _advance(state: _State, island: Index, stride: Array, step: Array) -> None:
    """Take a step; islands in which nothing moves, in a long step and then in a short one, rest.

    A long step shows slow motions, a short one small gaps. What comes from the solver is no motion.
    """
    step, far = _shortened(state, island, step)
    moving = far > np.maximum(state.still, EXACT * stride)
    quiet = np.ones(len(island) + 1, dtype=bool)
    np.logical_and.at(quiet, island, ~moving)
    size = np.full(len(island) + 1, np.inf)
    np.minimum.at(size, island, np.minimum(state.bodies.size, state.limit / (2.1 * FIRST)))
    stood = np.maximum(state.quiet, stride)
    state.quiet = np.where(moving, 0.0, np.where(quiet[island] & (island >= 0), stood, state.quiet))
    long = np.ones(len(island) + 1, dtype=bool)
    np.logical_and.at(long, island, state.quiet >= FIRST / 2 * size[island])
    rests = quiet[island] & long[island] & (stride <= (1 + ROUNDING) * SHORT * state.bodies.size)
    state.asleep = np.where(island >= 0, rests, state.asleep)
    state.tell(f"step {state.rounds}: {number(float(far.max(initial=0.0)))}")
    next_stride = _next_stride(state, island, stride, step)
    first = np.where(long[island], stride / SHORTER, np.inf)
    first = np.clip(first, SHORT * state.bodies.size, FIRST * state.bodies.size)
    next_stride = np.where(quiet[island], first, next_stride)
    next_stride = np.where(rests, FIRST * state.bodies.size, next_stride)  # if it moves again
    state.stride = np.where(island >= 0, next_stride, state.stride)
    state.move(np.where(moving[:, None], step, 0.0), None)


def _shortened(state: _State, island: Index, step: Array) -> tuple[Array, Array]:
    """The step, shorter for islands in which a body would move too far; way of each body."""
    size = state.bodies.size
    far = state.bodies.travel(step)
    share = np.ones(len(island) + 1)
    np.minimum.at(share, island, 1.5 * LONGEST * size / np.maximum(far, 1e-300))
    share = share[island]
    return step * share[:, None], far * share


def _next_stride(state: _State, island: Index, stride: Array, step: Array) -> Array:
    """Stride of the next step: longer while the motion grows with it, unless a body moves too far.

    A motion that shrinks although the stride stays the same is about to end. A longer step than
    that which ends a linear motion goes beyond the end and back, as round bodies do.
    """
    size = state.bodies.size
    far = state.bodies.travel(step)
    share, speed = np.full(len(island) + 1, np.inf), np.zeros(len(island) + 1)
    np.minimum.at(share, island, LONGEST * size / np.maximum(far, 1e-300))
    np.maximum.at(speed, island, far / np.maximum(stride, 1e-300))
    goes_on = speed[island] >= 0.5 * state.speed
    state.speed = np.where(island >= 0, speed[island], state.speed)
    grown: Array = np.minimum(np.where(goes_on, 4.0, 1.0), share[island]) * stride
    velocity = step / np.maximum(stride, 1e-300)[:, None]
    time = _time_to_end(state, island, state.step, state.step_velocity, velocity)
    turned = _of_islands(state, island, state.step, velocity) < 0
    time[~turned & ~(_most_of_island(island, state.round_body) > 0)] = np.inf
    state.step = np.where(island[:, None] >= 0, step, state.step)
    state.step_velocity = np.where(island[:, None] >= 0, velocity, state.step_velocity)
    most: Array = np.minimum(np.maximum(time, stride / 4), SLOWEST * size)
    return np.asarray(np.minimum(grown, most))


def _time_to_end(state: _State, island: Index, step: Array, before: Array, after: Array) -> Array:
    """Time in which the motion of each island ends if it is linear, shape (B,); inf without an end.

    Arguments: `step` (B, 6): a step; `before`, `after` (B, 6): velocities at its begin and end.
    """
    square = _of_islands(state, island, step, step)
    change = _of_islands(state, island, step, before - after)
    time = np.full(len(square), np.inf)
    np.divide(square, change, out=time, where=change > 0)
    return time


def _of_islands(state: _State, island: Index, first: Array, second: Array) -> Array:
    """Product of two motions (B, 6) in the island of each body, shape (B,)."""
    product: Array = first * second
    product[:, 3:] *= (state.bodies.size[:, None] / 2) ** 2
    total: Array = np.zeros(len(island) + 1)
    np.add.at(total, island, product.sum(axis=1))
    return np.asarray(total[island])


def _ways(state: _State) -> tuple[tuple[WayStep, ...], ...]:
    return tuple(tuple(way) for way in state.ways)


def _result(state: _State, reach: float | None) -> RestResult:
    """The result in the last pose."""
    points = _points(state, 1e-3 * state.length)
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
        slides = state.gone[state.joined].any()
        why = "nothing stops the parts on their rails" if slides else "nothing is below the parts"
    if state.unfit:
        both, depth = some_names(state.unfit), number(state.depth, 3)
        verdict, parts = "does-not-fit", (*state.unfit, *parts)
        why = f"{both} do not fit, and overlap by at least {depth} {state.bodies.drawn.units}"
    far = np.linalg.norm(state.bodies.movements()[:, :3], axis=1)
    far[np.isin(names, leaves)] = 0.0
    if reach is not None and far.max(initial=0.0) > reach * (1 + 1e-9):
        k = int(far.argmax())
        verdict, parts = "not-found", (*state.unfit, names[k])
        why = f"{names[k]!r} would move {number(float(far[k]), 3)} {state.bodies.drawn.units}"
    return RestResult(
        verdict, state.bodies, _ways(state), leaves, parts, state.depth, why, state.rounds,
        state.aside, points.take(closed), state.sunk, state.eased,
    )  # fmt: skip
