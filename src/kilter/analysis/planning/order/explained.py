"""What a plan rests on, step by step: forces that hold what stands, and why parts are held.

Forces are those of the state of a step, summed over the points of a contact patch at the point
where they press. A hand carries what is left over at a held part,

    hand = -(J^T f + m g)        force [N] and torque about the centre of mass

one possible set of forces, as the proof has them. Why it is needed is the motion of the same
state without it. Of two parts, one has to come first where it was asked for, where it is the
bolt of a nut, or where the other would stop it on the way that it takes.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kilter.analysis.planning.order.order import Order
from kilter.analysis.planning.order.plan_step import Step
from kilter.analysis.planning.order.removal import Leg
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.arrays import TINY, Array, Index
from kilter.mechanics.certificate import ForceProof, check_motion
from kilter.mechanics.program import Program
from kilter.threads import on_one_thread

__all__ = ["Explained", "Hand", "Need", "StepForces", "explain"]

PAIRS = 6000
"""Pairs of parts up to which it is asked which of them would stop which."""


@dataclass(frozen=True, slots=True, eq=False)
class Hand:
    """What holds a part during a step.

    Attributes
    ----------
    part : str
    force, torque : ndarray, shape (3,), or None
        On the part [N], about its centre of mass [N x length unit]; None where the state was
        decided without forces of its own.
    falls : tuple of str
        What would move if it let go; empty where what stands would hold even so.
    motion : ndarray, shape (N, 6), or None
        How (length unit, rad), the fastest at 1.
    """

    part: str
    force: Array | None
    torque: Array | None
    falls: tuple[str, ...]
    motion: Array | None


@dataclass(frozen=True, slots=True, eq=False)
class StepForces:
    """What holds during a step: contact forces, a row a patch, and hands.

    Attributes
    ----------
    points : ndarray, shape (K, 3)
        Where they press [length unit].
    parts : ndarray of int, shape (K, 2)
    forces : ndarray, shape (K, 3)
        On the second part [N].
    hands : tuple of Hand
    """

    points: Array
    parts: Index
    forces: Array
    hands: tuple[Hand, ...]


@dataclass(frozen=True, slots=True)
class Need:
    """One part has to come before another: it was `asked`, or the other is in the `way`."""

    before: str
    after: str
    why: str


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """An order, explained.

    Attributes
    ----------
    supports : tuple of StepForces
        Of each step.
    needs : tuple of Need
    swept : bool
        Whether it was asked which parts would stop which.
    """

    supports: tuple[StepForces, ...]
    needs: tuple[Need, ...]
    swept: bool

    def __repr__(self) -> str:
        hands = sum(len(support.hands) for support in self.supports)
        return f"<Explained: {len(self.supports)} steps, {hands} hands, {len(self.needs)} needs>"


@on_one_thread
def explain(order: Order) -> Explained:
    """The forces of each step, what falls without its hands, and which part must come first.

    Examples
    --------
    >>> from kilter.analysis.planning.order.plan import plan
    >>> from kilter.scenes import scene
    >>> explain(plan(scene("paper-figure-9")))
    <Explained: 4 steps, 1 hands, 0 needs>
    """
    count = len(order.steps)
    swept = count * (count - 1) // 2 <= PAIRS
    asked = [Need(before, after, "asked") for before, after in order.precedence]
    return Explained(
        supports=tuple(_support(order, step) for step in order.steps),
        needs=(*asked, *(_in_the_way(order) if swept else ())),
        swept=swept,
    )


def _support(order: Order, step: Step) -> StepForces:
    state = step.state
    hands = tuple(_hand(order, step, name) for name in step.held)
    if state.forces is None:
        nothing = np.zeros((0, 3))
        return StepForces(nothing, np.zeros((0, 2), dtype=np.int64), nothing, hands)
    return StepForces(*_pressed(state.program, state.forces), hands)


def _pressed(program: Program, proof: ForceProof) -> tuple[Array, Index, Array]:
    """Points, parts and forces, a row a patch that presses."""
    straight = np.flatnonzero(~program.angular)
    forces = proof.forces[straight, None] * program.normal[straight] + proof.friction[straight]
    size = np.linalg.norm(forces, axis=1)
    keys = np.column_stack([program.kind, program.source, program.part_a, program.part_b])
    rows, patch = np.unique(keys[straight], axis=0, return_inverse=True)
    patch = patch.reshape(-1)
    total, middle = np.zeros((len(rows), 3)), np.zeros((len(rows), 3))
    np.add.at(total, patch, forces)
    np.add.at(middle, patch, size[:, None] * program.point[straight])
    weight = np.bincount(patch, size, minlength=len(rows))
    loaded = weight > TINY
    middle = middle[loaded] / weight[loaded, None]
    return middle, rows[loaded, 2:].astype(np.int64), total[loaded]


def _hand(order: Order, step: Step, name: str) -> Hand:
    """What a hand carries, and what falls without it."""
    states, state = order.states, step.state
    k = states.assembly.index[name]
    force = torque = None
    if state.forces is not None:
        program = state.program
        wrench = program.wrenches(state.forces.forces, state.forces.friction)[k]
        weight = program.applied[k] + 0.0
        weight[:3] += program.mass[k] * program.gravity
        carried = -(wrench + weight)
        if program.planar:
            carried[[1, 3, 5]] = 0.0  # what holds the plane is not asked
        force, torque = carried[:3], carried[3:]
    held = state.present & ~state.free
    held[k] = False
    without = states.judge(state.present, held)
    falls = tuple(without.moving) if without.stable is False else ()
    motion = None
    if falls and without.motion is not None:
        motion = check_motion(without.program, without.motion.motion).motion
    return Hand(name, force, torque, falls, motion)


def _in_the_way(order: Order) -> list[Need]:
    """Steps of which the second, done first, would stop the first on its way."""
    index = order.states.assembly.index
    sweeps = Sweeps(order.states.contacts)
    found = []
    for one, later in combinations(order.steps, 2):
        others = [index[name] for name in later.parts if name != one.over]
        if any(_stops(sweeps, index[name], q, one.legs) for name in one.parts for q in others):
            found.append(Need(one.part, later.part, "way"))
    return found


def _stops(sweeps: Sweeps, part: int, other: int, legs: tuple[Leg, ...]) -> bool:
    start = np.zeros(3)
    for leg in legs:
        if sweeps.pair_stops(part, other, leg.direction, distance=leg.length, start=start):
            return True
        if np.isfinite(leg.length):
            start = start + leg.length * np.array(leg.direction)
    return False
