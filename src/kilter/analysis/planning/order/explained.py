"""Explanation of a plan: forces of contacts and hands at each step, and why hands are needed.

The contact forces are summed for each contact patch and applied at its centre of pressure. In them
the hands carry the least that suffices (`kilter.analysis.planning.hold.least_loads`). If no least
loads are known, the forces are those of the proof, and a hand carries the remaining load of its
part: one possible equilibrium,

    hand = -(J^T f + m g)        force [N] and torque about the centre of mass

The motion of the same state without the hand shows why it is needed. A part must come before
another part if the precedence requires it, or if the other part would block its path.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kilter.analysis.planning.hold.least_loads import least_loads
from kilter.analysis.planning.order.order import Order
from kilter.analysis.planning.order.plan_step import Step
from kilter.analysis.planning.order.removal import Leg
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.arrays import TINY, Array, Index
from kilter.mechanics.certificate import ForceProof, check_motion
from kilter.mechanics.program import Program
from kilter.threads import on_one_thread

PAIRS = 6000
"""Largest number of pairs of steps whose paths are tested for collision."""


@dataclass(frozen=True, slots=True, eq=False)
class Hand:
    """A hand that holds a part during a step, its force, and the parts that fall without it."""

    part: str
    force: Array | None
    torque: Array | None
    """Force on the part [N] and torque about its centre of mass [N x length unit], shape (3,);
    None if the state has no forces of its own."""
    least: bool
    """Whether these are the least loads of all hands that suffice."""
    falls: tuple[str, ...]
    """Parts that would move without this hand; empty if the state holds without it."""
    motion: Array | None
    """Motion of these parts [length unit, rad], scaled so that the fastest moves at 1, shape (N,
    6)."""


@dataclass(frozen=True, slots=True, eq=False)
class StepForces:
    """Forces during a step of a plan: contact forces for each patch, and the hands."""

    points: Array
    """Centres of pressure [length unit], shape (K, 3)."""
    parts: Index
    """Indices of the two parts of each patch, shape (K, 2)."""
    forces: Array
    """Force on the second part [N], shape (K, 3)."""
    hands: tuple[Hand, ...]


@dataclass(frozen=True, slots=True)
class Need:
    """A part that must come before another part: by the user's rule, or because of its path.

    `asked`: the user required it; `way`: the other part would block its path.
    """

    before: str
    after: str
    why: str


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """Explanation of an order: forces at each step, and pairs of parts whose order is necessary."""

    supports: tuple[StepForces, ...]
    """Contact forces and hands of each step."""
    needs: tuple[Need, ...]
    swept: bool
    """Whether the paths were tested for parts that block them."""

    def __repr__(self) -> str:
        hands = sum(len(support.hands) for support in self.supports)
        return f"<Explained: {len(self.supports)} steps, {hands} hands, {len(self.needs)} needs>"


@on_one_thread
def explain(order: Order) -> Explained:
    """Explain an order: forces at each step, the use of each hand, and necessary precedence.

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
    """Contact forces and hands during a step of a plan."""
    state = step.state
    if state.forces is None:
        hands = tuple(_hand(order, step, name, None, least=False) for name in step.held)
        nothing = np.zeros((0, 3))
        return StepForces(nothing, np.zeros((0, 2), dtype=np.int64), nothing, hands)
    index = order.states.assembly.index
    held = [index[name] for name in step.held]
    program, forces, carried = state.program, state.forces, None
    if held and not state.outer:
        others = state.present & ~state.free
        others[held] = False
        least = least_loads(state.programs.of(state.present, others), held)
        if least is not None:
            program, forces, carried = least.program, least.forces, least.hands
    is_least = carried is not None
    if carried is None:
        wrench = program.wrenches(forces.forces, forces.friction) + program.applied
        wrench[:, :3] += program.mass[:, None] * program.gravity
        carried = -wrench[held]
    if program.planar:
        carried[:, [1, 3, 5]] = 0.0  # the support normal to the plane is not modelled
    hands = tuple(
        _hand(order, step, name, load, least=is_least)
        for name, load in zip(step.held, carried, strict=True)
    )
    return StepForces(*_pressure_centres(program, forces), hands)


def _pressure_centres(program: Program, proof: ForceProof) -> tuple[Array, Index, Array]:
    """Centre of pressure of each patch that carries force, its two parts, and its force."""
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


def _hand(order: Order, step: Step, name: str, load: Array | None, *, least: bool) -> Hand:
    """Describe the hand that holds a part in a step; `load` (6,) is its force and torque."""
    states, state = order.states, step.state
    k = states.assembly.index[name]
    held = state.present & ~state.free
    held[k] = False
    without = states.judge(state.present, held)
    falls = tuple(without.moving) if without.stable is False else ()
    motion = None
    if falls and without.motion is not None:
        motion = check_motion(without.program, without.motion.motion).motion
    force, torque = (None, None) if load is None else (load[:3], load[3:])
    return Hand(name, force, torque, least, falls, motion)


def _in_the_way(order: Order) -> list[Need]:
    """Pairs of parts in which the later part, already in place, would block the earlier part."""
    index = order.states.assembly.index
    sweeps = Sweeps(order.states.contacts)
    needs = []
    for step, later in combinations(order.steps, 2):
        others = [index[name] for name in later.parts if name != step.over]
        if any(_stops(sweeps, index[name], q, step.legs) for name in step.parts for q in others):
            needs.append(Need(step.part, later.part, "way"))
    return needs


def _stops(sweeps: Sweeps, part: int, other: int, legs: tuple[Leg, ...]) -> bool:
    """Whether `other` in its place blocks the path of `part` out of the assembly."""
    start = np.zeros(3)
    for leg in legs:
        if sweeps.pair_stops(part, other, leg.direction, distance=leg.length, start=start):
            return True
        if np.isfinite(leg.length):
            start = start + leg.length * np.array(leg.direction)
    return False
