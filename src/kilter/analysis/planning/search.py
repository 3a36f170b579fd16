"""An order of assembly, found backwards: which part can leave last, and what is held then.

From the whole assembly parts are taken away one by one. A part p may leave S for T = S - p where

    nothing that is to be put in after it is present           the precedence that was asked for
    every part of T hangs together with a grounded one         each part touches what stands
    it has a way out of S                                      `kilter.analysis.planning.removal`
    T holds, at most K of its parts held                       `kilter.analysis.planning.states`

What holds T is asked with p absent: along its way in contacts with p can only add forces, and once
it is in place, T + p with p held too holds as well. The highest layer leaves first: of it, parts
near the last one that leave a T which needs no hold, then those that need holds. (To dig a hold's
part out from below instead keeps it held for many steps.) Ways of two legs come last.

Sets from which no order leads on are kept, so that none is searched twice. The search is that of
one K; K is raised where it fails, so that the first order found has the fewest parts held at once
among those that such ways allow.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np

from kilter.analysis.planning.holds import Holds
from kilter.analysis.planning.part_sets import bits_of, mask_of, members
from kilter.analysis.planning.removal import Leg, Removal
from kilter.analysis.planning.state import State
from kilter.analysis.planning.states import States
from kilter.arrays import TINY, Mask
from kilter.work import Work

__all__ = ["OrderSearch", "Removed", "neighbours_of"]

PROGRAM, FEW = 500.0, 4
"""Units of work of a program of a state, for each part that is present and so many more."""
LAYER = 0.01
"""Parts whose heights are nearer than this lie in one layer, over the width of the whole."""
SWEEP = 400.0
"""Units of work of a pair of parts held against each other on a path."""


@dataclass(frozen=True, slots=True, eq=False)
class Removed:
    """A part that leaves, and what must be held then.

    Attributes
    ----------
    part : int
    legs : tuple of Leg
        Its way out.
    state : State
        Of the parts that stay, the held ones held: it holds.
    """

    part: int
    legs: tuple[Leg, ...]
    state: State


@dataclass(slots=True)
class OrderSearch:
    """The search of an order, backwards from the whole assembly.

    Attributes
    ----------
    states : States
    removal : Removal
    after : list of int
        Of each part the set of those that come later.
    holdable : ndarray of bool, shape (N,)
        Parts that may be held.
    work : Work
    best : list of Removed
        The longest order so far, in the order of removal.
    visited : int
        Sets of parts from which it went on.
    exhausted : bool
        Whether the last search came to its end.
    """

    states: States
    removal: Removal
    after: list[int]
    holdable: Mask
    work: Work
    best: list[Removed] = field(default_factory=list)
    visited: int = 0
    exhausted: bool = False
    _near: list[int] = field(init=False)
    _base: int = field(init=False)
    _height: list[float] = field(init=False)
    _holds: dict[int, Holds[State]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        geometry = self.states.assembly.geometry
        self._near = neighbours_of(self.states)
        self._base = bits_of(geometry.grounded)
        up = geometry.center @ -self.states.assembly.down
        wide = float(np.ptp(geometry.center, axis=0).max())
        self._height = (up / max(wide, TINY) / LAYER).round().tolist()

    def find(self, hold: int) -> list[Removed] | None:
        """The parts in the order in which they leave, at most `hold` held; None: none found."""
        whole = bits_of(np.ones(len(self._near), dtype=bool))
        dead: set[int] = set()
        order: list[Removed] = []
        self.exhausted = False
        waiting = [(whole, self._removals(whole, None, hold))]
        while waiting:
            present, removals = waiting[-1]
            if present == self._base:
                return order
            if self.work.over:
                return None
            taken = next((one for one in removals if present & ~(1 << one.part) not in dead), None)
            if taken is None:
                dead.add(present)
                waiting.pop()
                if order:
                    order.pop()
                continue
            order.append(taken)
            if len(order) > len(self.best):
                self.best = order.copy()
                left = (present & ~self._base).bit_count() - 1
                self.work.tell(f"order: {left} parts to go, {hold} held")
            rest = present & ~(1 << taken.part)
            waiting.append((rest, self._removals(rest, taken.part, hold)))
        self.exhausted = True
        return None

    def _removals(self, present: int, last: int | None, hold: int) -> Iterator[Removed]:
        """What may leave a set of parts, the best first."""
        self.visited += 1
        stuck: list[int] = []
        candidates = self._candidates(present, last)
        for _, layer in groupby(candidates, key=lambda part: self._height[part]):
            yield from self._of_layer(layer, present, hold, stuck)
        for part in stuck:
            legs = self._way_out(part, present, 2)
            if legs is not None:
                yield from self._held(part, legs, present, hold)

    def _of_layer(
        self, layer: Iterable[int], present: int, hold: int, stuck: list[int]
    ) -> Iterator[Removed]:
        """What may leave of one layer; those without a straight way are put to the stuck ones."""
        falling = []
        for part in layer:
            legs = self._way_out(part, present, 1)
            if legs is None:
                stuck.append(part)
                continue
            state = self._state(present & ~(1 << part))
            if state.stable:
                yield Removed(part, legs, state)
            else:
                falling.append((int(state.moves.sum()), part, legs))
        for _, part, legs in sorted(falling, key=lambda one: one[0]):
            yield from self._held(part, legs, present, hold)

    def _candidates(self, present: int, last: int | None) -> list[int]:
        """Parts that may leave by precedence and touch, the highest and nearest first."""
        center = self.states.assembly.geometry.center
        found = [
            part
            for part in members(present & ~self._base, len(self._near)).tolist()
            if not self.after[part] & present and self._hangs_together(present & ~(1 << part))
        ]

        def rank(part: int) -> tuple[float, float]:
            away = 0.0 if last is None else float(np.linalg.norm(center[part] - center[last]))
            return -self._height[part], round(away, 9)

        return sorted(found, key=rank)

    def _hangs_together(self, present: int) -> bool:
        """Whether every part of a set is connected to a grounded one within it."""
        seen = new = present & self._base
        while new:
            part = (new & -new).bit_length() - 1
            new &= new - 1
            more = self._near[part] & present & ~seen
            seen |= more
            new |= more
        return seen == present

    def _way_out(self, part: int, present: int, legs: int) -> tuple[Leg, ...] | None:
        before = self.removal.sweeps.tests
        found = self.removal.way_out(part, present, legs=legs)
        self.work.charge(SWEEP * (self.removal.sweeps.tests - before))
        return found

    def _state(self, present: int) -> State:
        count = len(self._near)
        solved = self._solved()
        state = self.states.judge(mask_of(present, count), np.zeros(count, dtype=bool))
        self._charge(solved, present)
        return state

    def _solved(self) -> int:
        return self.states.counts["programs"] + self.states.counts["cones"]

    def _charge(self, solved: int, present: int) -> None:
        """Count the programs that were solved since."""
        self.work.charge(PROGRAM * (self._solved() - solved) * (FEW + present.bit_count()))

    def _held(self, part: int, legs: tuple[Leg, ...], present: int, hold: int) -> Iterator[Removed]:
        """The removal of a part with the fewest holds, where these are no more than `hold`."""
        rest = present & ~(1 << part)
        known = self._holds.get(rest)
        if known is None or (known.held is None and known.least <= hold):
            solved = self._solved()
            known = self.states.holds_of(mask_of(rest, len(self._near)), self.holdable, most=hold)
            self._charge(solved, rest)
            self._holds[rest] = known
        if known.state is not None and known.held is not None and known.held.sum() <= hold:
            yield Removed(part, legs, known.state)


def neighbours_of(states: States) -> list[int]:
    """Of each part the set of those that it touches or is joined to."""
    assembly = states.assembly
    near = [0] * len(assembly)
    pairs = [tuple(pair) for pair in states.contacts.patch_parts.tolist()]
    for joint in assembly.joints:
        ends = [assembly.index.get(name) for name in joint.parts]
        if None not in ends:
            pairs.append(tuple(ends))
    for a, b in pairs:
        near[a] |= 1 << b
        near[b] |= 1 << a
    return near
