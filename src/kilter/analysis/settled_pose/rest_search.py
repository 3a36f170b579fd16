"""The search for a pose at rest near the drawn pose.

Each round finds the points near contact, opens all overlaps by the least motion, selects the points
whose forces carry the load at the least sum of force times gap, closes these by the least motion,
and moves the bodies. It ends in one of four states:

    at-rest        forces at closed points alone balance the load, and no gap is below -tolerance
    does-not-fit   no small motion opens all overlaps
    falls          twice in a row no forces at the points within reach balance the load, or the gaps
                   of the carrying points grow in three rounds in a row: each step that closes them
                   opens others, and the closed points balance no load
    not-found      the rounds are used up, nothing lies within reach, or the solver failed

The state at-rest is a claim of the search; `kilter.analysis.settled_pose.rest_proof` verifies it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from kilter.analysis.settled_pose.near_points import NearPoints, find_near_points
from kilter.analysis.settled_pose.rest_programs import RestPrograms
from kilter.analysis.settled_pose.rest_proof import closed_gap
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.settle_tolerances import (
    BALANCED,
    LEAST_REACH,
    SEARCH_CLOSED,
    SEARCH_SHARE,
)
from kilter.arrays import Array
from kilter.assembly import GROUND
from kilter.tell.numbers import number
from kilter.work import stop_if_late

RestState = Literal["at-rest", "does-not-fit", "falls", "not-found"]

ROUNDS = 20
"""Largest number of rounds; disturbed walls and arches need 2 to 4."""
AGAIN = 4
"""Largest number of times that a round solves for the forces again after a step."""
STEP_LENGTH = 2.0
"""Largest movement of a part in a round [reaches]."""
CARRIES, CARRIES_LEAST = 1e-4, 1e-8
"""Force from which a point is closed [mean weights], at first and at least."""
KAPPA = 1e-3
"""Weight of the motion in the closing of gaps, at first [-]; a larger value leaves gaps."""
HARDER = 100.0
"""Factor by which both fall in a round that does not halve the widest gap."""
CLOSES = 1e-5
"""Sum of force times gap, over the widest gap, at which a step has closed its points [-]."""
SLACK = 1e-9
"""Largest movement beyond the permitted movement, as a fraction of it [-]."""
SAME = 0.01
"""Fraction of the carrying points that may change while the step counts as unchanged [-]; the next
round corrects the rest."""
GROWS = 3
"""Number of rounds in a row in which the widest gap of the carrying points grows until the
assembly counts as falling. Assemblies that come to rest show at most two such rounds."""
FINER = 10.0
"""Reach of the next round for parts that are not convex, in steps of this round."""


@dataclass(frozen=True, slots=True, eq=False)
class SearchResult:
    """Result of the search."""

    state: RestState
    bodies: RigidBodies
    """The bodies in their last poses."""
    rounds: int
    parts: tuple[str, ...] = ()
    """Parts out of balance, or parts that do not fit."""
    depth: float = 0.0
    """Depth of the overlap that cannot be opened [length unit]."""
    why: str = ""
    """Cause of a failure as a clause."""
    points: NearPoints | None = None
    """Points of the last pose that the search regards as closed, those within bodies included."""


@dataclass(slots=True)
class _Progress:
    """Numbers that pass from round to round; gaps are over the median size of the parts.

    `closed` is the gap that counts as closed; it grows to `accepted` if overlaps by the rounding of
    the data cannot be opened. `widest` has the parts of the widest gap of a carrying point, or of
    the deepest overlap.
    """

    stuck: int = 0
    grows: int = 0
    wide: float = np.inf
    fine_reach: float = np.inf
    closed: float = SEARCH_CLOSED
    accepted: float = SEARCH_CLOSED
    widest: tuple[int, int] = (0, 0)
    tell: Callable[[str], None] = field(default=lambda stage: None)


def search_rest(
    bodies: RigidBodies,
    *,
    reach: float,
    most: float | None,
    progress: Callable[[str], None],
    near: Callable[[RigidBodies, float], NearPoints] | None = None,
    inertia: Array | None = None,
) -> SearchResult:
    """Search for a pose at rest near the current pose.

    Arguments: `reach`: largest gap of the points that are considered [length unit]; `most`: largest
    permitted movement of a part [length unit]; None: no limit; `near`: function that finds the
    points within a reach; by default `find_near_points`; `inertia`: as of
    `RestPrograms.of`.
    """
    length, weight = units_of(bodies)
    closed_at = max(SEARCH_CLOSED, SEARCH_SHARE * closed_gap(bodies.drawn) / length)
    state = _Progress(fine_reach=reach, accepted=closed_at, tell=progress)
    for rounds in range(ROUNDS + 1):
        stop_if_late()
        assembly = bodies.assembly()
        every = (
            find_near_points(assembly, reach, state.fine_reach)
            if near is None
            else near(bodies, reach)
        )
        points = _between_bodies(bodies, every)
        programs = RestPrograms.of(bodies, points, length, weight, inertia=inertia)
        if not len(programs.gap):
            why = "no two parts come within reach"
            return SearchResult("not-found", bodies, rounds, why=why)
        outcome = _round(bodies, programs, state, rounds, reach)
        if isinstance(outcome, SearchResult):
            closed = every.bears & (np.abs(every.gap) <= state.closed * length)
            return replace(outcome, points=every.take(closed))
        bodies = bodies.moved(outcome)
        distance = np.linalg.norm(bodies.movements()[:, :3], axis=1)
        if most is not None and distance.max() > most * (1 + SLACK):
            name = bodies.drawn.names[int(distance.argmax())]
            far = f"{number(float(distance.max()), 3)} {bodies.drawn.units}"
            why = f"{name!r} would have to move {far} or more, which is out of reach"
            return SearchResult("not-found", bodies, rounds, (name,), why=why)
    return _not_closed(bodies, state, length)


def _not_closed(bodies: RigidBodies, state: _Progress, length: float) -> SearchResult:
    """The result after the last round: it names the pair with the widest gap."""
    both = tuple(GROUND if k < 0 else bodies.drawn.names[k] for k in state.widest)
    wide = f"{number(state.wide * length, 3)} {bodies.drawn.units}"
    why = f"{both[0]!r} and {both[1]!r} do not close: {wide} are left after {ROUNDS} rounds"
    return SearchResult("not-found", bodies, ROUNDS, both, why=why)


def units_of(bodies: RigidBodies) -> tuple[float, float]:
    """Units of length [length unit] and force [N] of the programs."""
    geometry = bodies.drawn.geometry
    free = bodies.of_part > 0
    sizes = geometry.size[free] if free.any() else geometry.size
    weights = geometry.mass[free] * float(np.linalg.norm(bodies.drawn.gravity))
    acting = [load for load in bodies.drawn.loads if bodies.body_of(load.part)]
    loads = [float(np.linalg.norm(load.force)) for load in acting]
    mean = float(weights.mean()) if free.any() else 1.0
    return float(np.median(sizes)), max([mean, *loads])


def _between_bodies(bodies: RigidBodies, points: NearPoints) -> NearPoints:
    """Points between different bodies, without those that act out of the plane of motion."""
    a, b = bodies.of_part[points.part_a], bodies.of_part[points.part_b]
    keep = a != b
    if bodies.drawn.planar:
        keep &= np.abs(points.normal[:, 1]) < 0.5
    return points.take(keep)


def _round(
    bodies: RigidBodies, programs: RestPrograms, state: _Progress, rounds: int, reach: float
) -> SearchResult | Array:  # fmt: skip
    """A round: the result if the search ends, else the step of all bodies, shape (B, 6)."""
    gap = programs.gap
    deep = float(max(-gap.min(), 0.0))
    off = float(np.abs(programs.drift).max(initial=0.0))
    opened = gap
    if max(deep, off) <= state.closed:
        closed = programs.bears & (np.abs(gap) <= state.closed)
        _, imbalance = programs.carry(np.zeros(len(gap)), closed)
        if np.abs(imbalance).max(initial=0.0) <= BALANCED:
            return SearchResult("at-rest", bodies, rounds)
    else:
        apart = programs.push_apart()
        if apart is None:
            depth, forces, _ = programs.least_overlap()
            if depth > state.accepted:
                return _does_not_fit(bodies, programs, depth, forces, rounds)
            if depth > state.closed:
                state.closed = state.accepted
            programs = replace(programs, gap=gap + 2 * depth + state.closed / 2)
            apart = programs.push_apart()
        if apart is not None:
            opened = gap + programs.rates @ apart
    forces, imbalance = programs.carry(
        np.maximum(opened, 0.0) / max(float(np.abs(gap).max()), 1e-300), programs.bears
    )
    short = float(np.abs(imbalance).max(initial=0.0))
    least = max(CARRIES / HARDER**state.stuck, CARRIES_LEAST)
    before = state.wide
    carrying = np.where(forces > least, np.abs(gap), np.maximum(-gap, 0.0))
    state.wide = max(float(carrying.max(initial=0.0)), off)
    worst = int(carrying.argmax())
    state.widest = (int(programs.parts[worst, 0]), int(programs.parts[worst, 1]))
    state.tell(f"round {rounds + 1}: widest gap {number(state.wide * programs.length)}")
    state.stuck += state.wide > before / 2 or state.wide <= state.closed
    state.grows = state.grows + 1 if state.wide > before else 0
    if state.stuck > 1 and short > BALANCED:
        return _falls(bodies, imbalance, rounds, "within reach")
    if state.grows >= GROWS:
        _, imbalance = programs.carry(np.zeros(len(gap)), programs.bears & (gap <= state.closed))
        if np.abs(imbalance).max(initial=0.0) > BALANCED:
            return _falls(bodies, imbalance, rounds, "that the search could close")
    scale = max(state.wide, state.closed)
    motion = _closing_step(programs, forces, scale, least, state.stuck)
    if motion is None:  # the overlaps open by too little for the solver: admit the accepted depth
        programs = replace(programs, gap=programs.gap + state.closed)
        motion = _closing_step(programs, forces, scale, least, state.stuck)
    if motion is None:
        return SearchResult("not-found", bodies, rounds, why="a step of the search has no solution")
    return _limited(programs.steps(motion * scale, bodies), bodies, programs.length, state, reach)


def _limited(
    steps: Array, bodies: RigidBodies, length: float, state: _Progress, reach: float
) -> Array:
    """The steps, shortened to the largest movement in a round; the next fine reach follows."""
    far = np.linalg.norm(steps[:, :3], axis=1) + np.linalg.norm(steps[:, 3:], axis=1) * (
        bodies.size / 2
    )
    longest = float(far.max())
    state.fine_reach = float(
        np.clip(FINER * longest, LEAST_REACH * length, min(reach, state.fine_reach))
    )
    return steps * min(1.0, STEP_LENGTH * reach / max(longest, 1e-300))


def _closing_step(
    programs: RestPrograms, forces: Array, scale: float, least: float, stuck: int
) -> Array | None:
    """The motion, over `scale`, that closes the points with a force; forces are solved again."""
    kappa = KAPPA / HARDER ** min(stuck, 2)
    motion = None
    for solved in range(1, AGAIN + 1):
        push = np.where(forces > least, np.maximum(forces, 0.1), 0.0)
        motion = programs.close(push, scale, kappa)
        if motion is None:
            return None
        left = np.maximum(np.minimum(programs.gap / scale, 1e4) + programs.rates @ motion, 0.0)
        if float(left @ push) < CLOSES or solved == AGAIN:
            break
        forces, _ = programs.carry(left / float(left.max()), programs.bears)
        changed = np.count_nonzero((forces > least) != (push > 0.0))
        if changed <= SAME * np.count_nonzero(push):
            break
    return motion


def pressed_parts(bodies: RigidBodies, programs: RestPrograms, forces: Array) -> tuple[str, ...]:
    """Names of the parts that the forces of a certificate press against each other."""
    pressed = forces > 1e-3 * max(float(forces.max(initial=0.0)), 1e-300)
    parts = np.unique(programs.parts[pressed])
    return tuple(bodies.drawn.names[k] for k in parts[parts >= 0].tolist())


def _does_not_fit(
    bodies: RigidBodies, programs: RestPrograms, depth: float, forces: Array, rounds: int
) -> SearchResult:  # fmt: skip
    """The result for parts whose overlaps no small motion opens: the parts of the certificate."""
    names = pressed_parts(bodies, programs, forces)
    return SearchResult(
        "does-not-fit", bodies, rounds, names, depth * programs.length,
        "no small motion opens all overlaps",
    )  # fmt: skip


def _falls(bodies: RigidBodies, imbalance: Array, rounds: int, points: str) -> SearchResult:
    """The result for parts whose loads no forces balance; `points` is a clause about the points."""
    size = np.abs(imbalance).reshape(-1, 6).max(axis=1)
    if not np.isfinite(size).all():
        return SearchResult("not-found", bodies, rounds, why="the solver found no forces")
    unbalanced = np.flatnonzero(bodies.free)[size > max(BALANCED, 1e-3 * float(size.max()))]
    names = bodies.drawn.names
    parts = tuple(names[k] for k in np.flatnonzero(np.isin(bodies.of_part, unbalanced)).tolist())
    why = f"no forces balance the parts at the points {points}"
    return SearchResult("falls", bodies, rounds, parts, why=why)
