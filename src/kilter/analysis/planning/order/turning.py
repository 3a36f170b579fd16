"""An order in which what stands may be turned between two steps, the base and all.

With the parts S present, H of them held, the directions of gravity g that forces hold,

    C(S, H) = { g : J^T f + m g = 0, f in the cones }

are a convex cone. So while it turns slowly from g1 to g2, both in C and not opposite, along the
great arc between them, forces of equilibrium exist at every instant. (With friction no more is
claimed than that they exist.) The steps made in one position, a run, need one g in the C of every
state of it; a turn needs the state between in the C of both. One linear program asks whether some
states have a g in common, friction by inner pyramids: its unknowns are g and the forces of each.

The search goes backwards, as that of `kilter.analysis.planning.order.search`. The finished
assembly, and the run before it, have the file's direction. A part leaves, in this order: what stays
holds as it is; the run, but for the first, has another g in common with it; or a new run begins
with a turn. Holds and turns allowed are raised one by one: turns first for the fewest holds, holds
first for the fewest turns. Without a turn every state has the file's direction, so that search
leaves out no order along the ways tried: where it ends with none, one turn is the fewest. With
turns only one direction is tried of the many that a run may have: whether two or more are the
fewest is open.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from scipy.sparse import block_diag, csc_array, hstack

from kilter.analysis.planning.order.cheapest import Searched
from kilter.analysis.planning.order.removal import Leg
from kilter.analysis.planning.order.search import FEW, PROGRAM, OrderSearch, Removed
from kilter.analysis.planning.states.part_sets import bits_of, mask_of, members
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

__all__ = ["OPPOSITE", "TurningSearch", "common_down", "find_with_turns"]

MOST_TURNS = 3
"""Turns up to which an order is sought."""
SIDES = 8
"""Rays of each pyramid of friction, where a common direction is sought."""
SMALL = 1e-6
"""Of a common direction that is none, in a box of 1 to each side."""
OPPOSITE = 1e-6
"""Two directions with a sum below this are opposite: between them lies no one arc."""

Direction = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """States that have a direction in common: sets that are present and held; turns before it."""

    down: Direction
    states: tuple[tuple[int, int], ...]
    number: int = 0

    @property
    def first(self) -> bool:
        """Whether it is the run of the finished assembly."""
        return self.number == 0


@dataclass(slots=True)
class TurningSearch:
    """The search of an order with turns.

    Attributes
    ----------
    search : OrderSearch
        What may leave, and how; its states are those of the file's direction.
    """

    search: OrderSearch
    _states: dict[Direction, States] = field(default_factory=dict)
    _common: dict[tuple[tuple[int, int], ...], Direction | None] = field(default_factory=dict)

    def states(self, down: Direction) -> States:
        """The states of the assembly under a direction of gravity."""
        if down not in self._states:
            own = self.search.states
            turned = States(own.assembly.with_down(down), own.contacts)
            self._states[down] = own if down == self._own() else turned
        return self._states[down]

    def find(self, most: int, fewest: str) -> list[Removed] | None:
        """The removals of an order, the last step first; None where none was found."""
        allowed = list(product(range(most + 1), range(MOST_TURNS + 1)))
        if fewest == "turns":
            allowed.sort(key=lambda one: one[1])
        for hold, turns in allowed:
            self.search.work.stage(f"an order with {hold} held, {turns} turns")
            found = self._find(hold, turns)
            if found is not None or self.search.work.over:
                return found
        return None

    def _own(self) -> Direction:
        x, y, z = self.search.states.assembly.down.tolist()
        return x, y, z

    def _find(self, hold: int, turns: int) -> list[Removed] | None:
        search, start = self.search, _Run(self._own(), ((self.search.whole, 0),))
        order: list[Removed] = []
        dead: set[tuple[int, int, Direction]] = set()
        waiting = [(search.whole, turns, start, self._removals(search.whole, start, turns, hold))]
        search.exhausted = False
        while waiting:
            present, left, run, removals = waiting[-1]
            if present == search.base:
                return self._settled(order, [one[2] for one in waiting[1:]])
            if search.work.over:
                return None
            found = next(
                (
                    (one, then, rest)
                    for one, then, rest in removals
                    if (present & ~one.set, rest, then.down) not in dead
                ),
                None,
            )
            if found is None:
                dead.add((present, left, run.down))
                waiting.pop()
                if order:
                    order.pop()
                continue
            one, then, rest = found
            order.append(one)
            search.note(order, hold)
            after = present & ~one.set
            waiting.append((after, rest, then, self._removals(after, then, rest, hold)))
        search.exhausted = True
        return None

    def _settled(self, order: list[Removed], runs: list[_Run]) -> list[Removed]:
        """The removals, each under the direction that its run has in the end."""
        downs = {run.number: run.down for run in runs}
        settled = []
        for one, run in zip(order, runs, strict=True):
            if run.first:
                settled.append(one)
                continue
            states, between = self.states(downs[run.number]), one.between
            if between is not None:
                between = states.judge(between.present, between.present & ~between.free)
            state = states.judge(one.state.present, one.state.present & ~one.state.free)
            settled.append(replace(one, state=state, turned=states, between=between))
        return settled

    def _removals(
        self, present: int, run: _Run, turns: int, hold: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """What may leave, the run that it belongs to, and turns that are left."""
        search = self.search
        search.visited += 1
        free = list(search.ways(present))
        for moved, legs in free:
            state = self._held(run.down, present & ~moved, hold)
            if state is not None:
                yield self._taken(moved, legs, state, run, turns)
        if not run.first:
            for moved, legs in free:
                yield from self._other(moved, legs, present, run, turns)
        for moved, legs in free if turns else ():
            yield from self._turned(moved, legs, present, run, turns)

    def _taken(
        self,
        moved: int,
        legs: tuple[Leg, ...],
        state: State,
        run: _Run,
        turns: int,
        between: State | None = None,
    ) -> tuple[Removed, _Run, int]:
        parts = tuple(members(moved, len(self.search.after)).tolist())
        turned = None if run.first else self.states(run.down)
        removed = Removed(parts, legs, state, turned=turned, between=between)
        held = bits_of(state.present & ~state.free) & ~self.search.base
        then = _Run(run.down, (*run.states, (bits_of(state.present), held)), run.number)
        return removed, then, turns

    def _other(
        self, moved: int, legs: tuple[Leg, ...], present: int, run: _Run, turns: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """A removal in the run with another direction, where all of it has one in common."""
        rest = present & ~moved
        down = self._down((*run.states, (rest, 0)))
        if down is not None and down != run.down:
            state = self.states(down).judge(self._mask(rest), self._mask(0))
            yield self._taken(moved, legs, state, _Run(down, run.states, run.number), turns)

    def _turned(
        self, moved: int, legs: tuple[Leg, ...], present: int, run: _Run, turns: int
    ) -> Iterator[tuple[Removed, _Run, int]]:
        """A removal before which all is turned."""
        key = next(one for one in reversed(run.states) if one[0] == present)
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
        return mask_of(parts, len(self.search.states.assembly))

    def _held(self, down: Direction, rest: int, hold: int) -> State | None:
        """A state with the fewest parts held under a direction, none above `hold`."""
        states = self.states(down)
        self.search.work.charge(PROGRAM * (FEW + rest.bit_count()))
        state = states.judge(self._mask(rest), self._mask(0))
        if state.stable or not hold:
            return state if state.stable else None
        return states.holds_of(self._mask(rest), self.search.holdable, most=hold).state

    def _down(self, keys: tuple[tuple[int, int], ...]) -> Direction | None:
        """A direction under which all of some states hold, that is certified; None: none found."""
        if keys not in self._common:
            own = self.search.states
            masks = [(self._mask(there), self._mask(held)) for there, held in keys]
            programs = [own.judge(*one).program for one in masks]
            down = common_down([one for one in programs if one.free.any()])
            self.search.work.charge(1000.0 * sum(len(one.part_a) for one in programs))
            if down is not None and not all(self.states(down).judge(*one).stable for one in masks):
                down = None
            self._common[keys] = down
        return self._common[keys]


def common_down(programs: Sequence[Program]) -> Direction | None:
    """A direction of gravity under which some states may hold; None where none was found.

    It lies well inside those that they have in common: the sum of the farthest along each axis.
    """
    from kilter.solvers.highs import solve_linear

    if not programs:
        return None
    problems = [scaled_problem(pyramid(one, SIDES)) for one in programs]
    right = []
    for problem in problems:
        wrench = np.zeros((3, len(problem.program.mass), 6))
        for axis in range(3):
            wrench[axis, :, axis] = problem.program.mass * problem.program.g
        right.append(np.column_stack([problem.scaled_load(one) for one in wrench]))
    matrix = hstack(
        [block_diag([one.matrix for one in problems]), csc_array(-np.vstack(right))], format="csc"
    )
    lower = [np.where(one.program.two_sided, -np.inf, 0.0) for one in problems]
    bounds = np.concatenate([*lower, -np.ones(3)])
    count, zero = len(bounds), np.zeros(matrix.shape[0])
    upper = np.concatenate([np.full(count - 3, np.inf), np.ones(3)])
    total = np.zeros(3)
    for axis in range(3):
        for sign in (-1.0, 1.0):
            cost = np.zeros(count)
            cost[count - 3 + axis] = sign
            found = solve_linear(LinearProgram(cost, matrix, zero, zero, bounds, upper))
            if found.found:
                total += found.x[-3:]
    size = float(np.linalg.norm(total))
    if size < SMALL:
        return None
    x, y, z = ((total / size).round(12) + 0.0).tolist()
    return x, y, z


def find_with_turns(search: OrderSearch, most: int, fewest: str) -> Searched:
    """The order with the fewest holds and for these the fewest turns, or the other way round.

    Parameters
    ----------
    search : OrderSearch
    most : int
        Most parts held at once.
    fewest : {"holds", "turns"}
        What there is to be least of first.
    """
    try:
        order = TurningSearch(search).find(most, fewest)
    except KeyboardInterrupt:
        search.exhausted = False
        return Searched(None, interrupted=True)
    if order is None:
        return Searched(None)
    if fewest == "turns":
        turns = sum(one.between is not None for one in order)
        return Searched(order, turns, proved=turns <= 1)
    return Searched(order, max(one.held for one in order) - search.base.bit_count())
