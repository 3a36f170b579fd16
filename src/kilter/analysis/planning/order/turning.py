"""Search for an order of assembly that may turn the standing parts, base included, between steps.

With the parts S present, H of them held, the directions of gravity g that forces hold,

    C(S, H) = { g : J^T f + m g = 0, f in the cones }

form a convex cone. Let g1 and g2 be in C and not opposite. During a slow turn from g1 to g2 along
the great arc between them, equilibrium forces exist at every instant. (With friction, only their
existence is claimed.) A run is a sequence of steps in one position; it needs one g in the C of each
of its states. The state at a turn needs both directions in its C. A linear program finds a common g
of several states; its unknowns are g and the forces of each state, with inner friction pyramids.

The search proceeds backwards, like `kilter.analysis.planning.order.search`. The finished assembly
and the last run have the direction of the file. The search tries for each removal, in this order:
the remaining parts hold under the same g; the run, except the last one, has another common g with
them; a new run begins with a turn. The allowed holds and turns increase step by step: turns first
for the fewest holds, holds first for the fewest turns. Without a turn the search is complete for
the tried paths, since every state has the direction of the file. So if it fails, an order with a
single turn has the fewest turns. With turns the search tries only a single direction for each run,
so a minimum of two or more turns is not proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from itertools import product

import numpy as np
from scipy.sparse import block_diag, csc_array, hstack

from kilter.analysis.planning.order.removal import Leg
from kilter.analysis.planning.order.search import FEW, PROGRAM, OrderSearch, Removed
from kilter.analysis.planning.states.holds import bits_of, mask_of, members
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

# Search for the order of assembly with the fewest parts held at once, or the fewest held steps.


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """Result of a search for an order of assembly."""

    order: list[Removed] | None
    """Removals, the last step of the assembly first; None without an order."""
    least: int = 0
    """Value of the minimized quantity."""
    proved: bool = False
    """Whether no order along the tried paths has a smaller value."""
    interrupted: bool = False
    """Whether the user interrupted the search."""


def find_order(search: OrderSearch, lowest: int, most: int, fewest: str) -> Searched:
    """Find an order of assembly that minimises held parts or held steps, by the option `fewest`.

    Arguments: `lowest`, `most`: first and last limit of the parts held at once; fewer than `lowest`
    are proved impossible.
    """
    order, hold = None, lowest
    try:
        for hold in range(lowest, most + 1):
            search.work.stage(f"an order with up to {hold} held parts")
            order = search.find(hold)
            if order is not None or search.work.over:
                break
        if order is None or fewest == "holds":
            return Searched(order, hold, proved=order is not None)
        search.work.stage("an order with fewer held steps")
        order, proved = find_fewest_held_steps(search, most, order)
        return Searched(order, held_steps_of(search, order), proved)
    except KeyboardInterrupt:
        search.exhausted = False
        return Searched(order, hold, interrupted=True)


@dataclass(frozen=True, slots=True, eq=False)
class _Reached:
    """A set of parts that the search reached, with its cost, last removal and previous set."""

    present: int
    cost: int
    removals: Iterator[Removed]
    last: Removed | None = None
    before: _Reached | None = None

    @property
    def order(self) -> list[Removed]:
        """Removals that lead from the whole assembly to this set."""
        removals, node = [], self
        while node.last is not None and node.before is not None:
            removals.append(node.last)
            node = node.before
        return removals[::-1]


def held_steps_of(search: OrderSearch, order: Sequence[Removed]) -> int:
    """Number of steps of an order during which a part beside the grounded parts is held."""
    return sum(_holds(search, removed) for removed in order)


def find_fewest_held_steps(
    search: OrderSearch, hold: int, known: Sequence[Removed]
) -> tuple[list[Removed], bool]:
    """Find the order with the fewest held steps, and whether the minimum is proved."""
    best = list(known)
    limit = held_steps_of(search, best)
    if limit == 0:
        return best, True
    start = _Reached(search.whole, 0, search.removals(search.whole, 0, hold))
    waiting, count = [(0, search.whole.bit_count(), 0, start)], 0
    seen = {search.whole: 0}
    while waiting:
        cost, _, _, node = waiting[0]
        if node.present == search.base:
            return node.order, True
        if search.work.over:
            return best, False
        if seen[node.present] < cost:
            heappop(waiting)
            continue
        taken = next(node.removals, None)
        if taken is None:
            if search.work.over:  # the removals that are left were not tried
                return best, False
            heappop(waiting)
            continue
        rest, after = node.present & ~taken.set, cost + _holds(search, taken)
        if after >= seen.get(rest, after + 1) or after >= limit:
            continue
        seen[rest] = after
        count += 1
        following = search.removals(rest, taken.set, hold)
        reached = _Reached(rest, after, following, taken, node)
        heappush(waiting, (after, rest.bit_count(), count, reached))
    return best, True


def _holds(search: OrderSearch, removed: Removed) -> bool:
    """Whether a part other than the grounded parts is held during a removal."""
    return removed.held > search.base.bit_count()


MOST_TURNS = 3
"""Largest number of turns of an order that the search tries."""
SIDES = 8
"""Rays of each friction pyramid in the program of a common direction."""
SMALL = 1e-6
"""Length below which a common direction counts as zero; components are at most 1 [-]."""
OPPOSITE = 1e-6
"""Unit directions whose sum is shorter than this are opposite; the arc is not unique [-]."""

Direction = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """A run: successive states of an order that share a direction of gravity."""

    down: Direction
    states: tuple[tuple[int, int], ...]
    number: int = 0

    @property
    def first(self) -> bool:
        """Whether this is the run that contains the finished assembly."""
        return self.number == 0


@dataclass(slots=True)
class TurningSearch:
    """Search for an order of assembly that may turn the standing parts between steps."""

    search: OrderSearch
    """Search of removals; its states have the direction of the file."""
    _states: dict[Direction, States] = field(default_factory=dict)
    _common: dict[tuple[tuple[int, int], ...], Direction | None] = field(default_factory=dict)

    def states(self, down: Direction) -> States:
        """States of the assembly under gravity along `down`."""
        if down not in self._states:
            part_states = self.search.states
            turned = States(part_states.assembly.with_down(down), part_states.contacts)
            self._states[down] = part_states if down == self._file_direction() else turned
        return self._states[down]

    def find(self, most: int, fewest: str) -> list[Removed] | None:
        """Removals of an order with turns, the last step first; None if no order was found."""
        allowed = list(product(range(most + 1), range(MOST_TURNS + 1)))
        if fewest == "turns":
            allowed.sort(key=lambda limits: limits[1])
        for hold, turns in allowed:
            self.search.work.stage(f"an order with {hold} held parts and {turns} turns")
            order = self._find(hold, turns)
            if order is not None or self.search.work.over:
                return order
        return None

    def _file_direction(self) -> Direction:
        """Direction of gravity (unit) in the input file."""
        x, y, z = self.search.states.assembly.down.tolist()
        return x, y, z

    def _find(self, hold: int, turns: int) -> list[Removed] | None:
        """Find removals that form an order with so many held parts and turns; None if not found."""
        search, start = self.search, _Run(self._file_direction(), ((self.search.whole, 0),))
        order: list[Removed] = []
        dead: set[tuple[int, int, Direction]] = set()
        waiting = [(search.whole, turns, start, self._removals(search.whole, start, turns, hold))]
        search.exhausted = False
        while waiting:
            present, left, run, removals = waiting[-1]
            if present == search.base:
                return self._with_final_direction(order, [entry[2] for entry in waiting[1:]])
            if search.work.over:
                return None
            choice = next(
                (
                    (entry, then, rest)
                    for entry, then, rest in removals
                    if (present & ~entry.set, rest, then.down) not in dead
                ),
                None,
            )
            if choice is None:
                dead.add((present, left, run.down))
                waiting.pop()
                if order:
                    order.pop()
                continue
            entry, then, rest = choice
            order.append(entry)
            search.note(order, hold)
            after = present & ~entry.set
            waiting.append((after, rest, then, self._removals(after, then, rest, hold)))
        search.exhausted = True
        return None

    def _with_final_direction(self, order: list[Removed], runs: list[_Run]) -> list[Removed]:
        """Copies of the removals whose states are judged under the final gravity of each run."""
        downs = {run.number: run.down for run in runs}
        settled = []
        for step, run in zip(order, runs, strict=True):
            if run.first:
                settled.append(step)
                continue
            states, between = self.states(downs[run.number]), step.between
            if between is not None:
                between = states.judge(between.present, between.present & ~between.free)
            state = states.judge(step.state.present, step.state.present & ~step.state.free)
            settled.append(replace(step, state=state, turned=states, between=between))
        return settled

    def _removals(
        self, present: int, run: _Run, turns: int, hold: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """Yield the possible removals from a set of parts, each with its run and turns left."""
        search = self.search
        search.visited += 1
        free = list(search.ways(present))
        for moved, legs in free:
            state = self._fewest_holds_under(run.down, present & ~moved, hold)
            if state is not None:
                yield self._taken(moved, legs, state, run, turns)
        if not run.first:
            for moved, legs in free:
                yield from self._other(moved, legs, present, run, turns)
        for moved, legs in free if turns else ():
            yield from self._removal_with_turn(moved, legs, present, run, turns)

    def _taken(
        self,
        moved: int,
        legs: tuple[Leg, ...],
        state: State,
        run: _Run,
        turns: int,
        between: State | None = None,
    ) -> tuple[Removed, _Run, int]:
        """A removal with its state; the run with the new state; and the number of turns left."""
        parts = tuple(members(moved, len(self.search.after)).tolist())
        turned = None if run.first else self.states(run.down)
        removed = Removed(parts, legs, state, turned=turned, between=between)
        held = bits_of(state.present & ~state.free) & ~self.search.base
        then = _Run(run.down, (*run.states, (bits_of(state.present), held)), run.number)
        return removed, then, turns

    def _other(
        self, moved: int, legs: tuple[Leg, ...], present: int, run: _Run, turns: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """Yield a removal in the same run, if another gravity suits all states of the run.

        The states of the run and the new state must hold under the same direction.
        """
        rest = present & ~moved
        down = self._down((*run.states, (rest, 0)))
        if down is not None and down != run.down:
            state = self.states(down).judge(self._mask(rest), self._mask(0))
            yield self._taken(moved, legs, state, _Run(down, run.states, run.number), turns)

    def _removal_with_turn(
        self, moved: int, legs: tuple[Leg, ...], present: int, run: _Run, turns: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """Yield at most one removal, after a turn of the standing parts that begins a run."""
        key = next(entry for entry in reversed(run.states) if entry[0] == present)
        rest = present & ~moved
        down = self._down((key, (rest, 0)))
        if down is None or np.linalg.norm(np.add(down, run.down)) < OPPOSITE:
            return
        states = self.states(down)
        between = states.judge(self._mask(present), self._mask(key[1]))
        state = states.judge(self._mask(rest), self._mask(0))
        yield self._taken(
            moved, legs, state, _Run(down, (key,), run.number + 1), turns - 1, between
        )

    def _mask(self, parts: int) -> Mask:
        """Mask of the parts in a bit set, shape (N,)."""
        return mask_of(parts, len(self.search.states.assembly))

    def _fewest_holds_under(self, down: Direction, rest: int, hold: int) -> State | None:
        """State with the fewest held parts under a direction of gravity; None if above `hold`."""
        states = self.states(down)
        self.search.work.charge(PROGRAM * (FEW + rest.bit_count()))
        state = states.judge(self._mask(rest), self._mask(0))
        if state.stable or not hold:
            return state if state.stable else None
        return states.holds_of(self._mask(rest), self.search.holdable, most=hold).state

    def _down(self, keys: tuple[tuple[int, int], ...]) -> Direction | None:
        """Direction of gravity under which all given states are proved to hold; else None."""
        if keys not in self._common:
            part_states = self.search.states
            masks = [(self._mask(present), self._mask(held)) for present, held in keys]
            programs = [part_states.judge(*entry).program for entry in masks]
            down = common_down([entry for entry in programs if entry.free.any()])
            self.search.work.charge(1000.0 * sum(len(entry.part_a) for entry in programs))
            if down is not None and not all(
                self.states(down).judge(*entry).stable for entry in masks
            ):
                down = None
            self._common[keys] = down
        return self._common[keys]


def common_down(programs: Sequence[Program]) -> Direction | None:
    """Direction of gravity (unit) under which all programs may hold; None if none exists.

    The direction is interior to the common cone: the normalized sum of its extreme points along
    each axis.
    """
    from kilter.solvers.highs import solve_linear

    if not programs:
        return None
    problems = [scaled_problem(pyramid(entry, SIDES)) for entry in programs]
    right = []
    for problem in problems:
        wrench = np.zeros((3, len(problem.program.mass), 6))
        for axis in range(3):
            wrench[axis, :, axis] = problem.program.mass * problem.program.g
        right.append(np.column_stack([problem.scaled_load(entry) for entry in wrench]))
    matrix = hstack(
        [block_diag([entry.matrix for entry in problems]), csc_array(-np.vstack(right))],
        format="csc",
    )
    lower = [np.where(entry.program.two_sided, -np.inf, 0.0) for entry in problems]
    bounds = np.concatenate([*lower, -np.ones(3)])
    count, zero = len(bounds), np.zeros(matrix.shape[0])
    upper = np.concatenate([np.full(count - 3, np.inf), np.ones(3)])
    total = np.zeros(3)
    for axis in range(3):
        for sign in (-1.0, 1.0):
            cost = np.zeros(count)
            cost[count - 3 + axis] = sign
            optimum = solve_linear(LinearProgram(cost, matrix, zero, zero, bounds, upper))
            if optimum.found:
                total += optimum.x[-3:]
    size = float(np.linalg.norm(total))
    if size < SMALL:
        return None
    x, y, z = ((total / size).round(12) + 0.0).tolist()
    return x, y, z


def find_with_turns(search: OrderSearch, most: int, fewest: str) -> Searched:
    """Find the order with the fewest held parts and then the fewest turns, or vice versa."""
    try:
        order = TurningSearch(search).find(most, fewest)
    except KeyboardInterrupt:
        search.exhausted = False
        return Searched(None, interrupted=True)
    if order is None:
        return Searched(None)
    if fewest == "turns":
        turns = sum(step.between is not None for step in order)
        return Searched(order, turns, proved=turns <= 1)
    return Searched(order, max(step.held for step in order) - search.base.bit_count())
