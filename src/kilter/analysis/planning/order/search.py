"""An order of assembly, found backwards: which part can leave last, and what is held then.

From the whole assembly parts are taken away one by one. A part p may leave S for T = S - p where

    nothing that is to be put in after it is present           the precedence that was asked for
    every part of T hangs together with a grounded one         each part touches what stands
    it has a way out of S                                      `planning.order.removal`
    T holds, at most K of its parts held                       `planning.states.states`

What holds T is asked with p absent: along its way in contacts with p can only add forces, and once
it is in place, T + p with p held too holds as well. The highest layer leaves first: of it, parts
near the last one that leave a T which needs no hold, then those that need holds, each in the order
of their distance, whatever motion shows that T falls. (To dig a hold's part out from below instead
keeps it held for many steps.) Ways of two legs come last.

Sets from which no order leads on are kept, so that none is searched twice. The search is that of
one K; K is raised where it fails, so that the first order found has the fewest parts held at once
among those that such ways allow.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby

import numpy as np

from kilter.analysis.planning.order.pressing import Pressing
from kilter.analysis.planning.order.removal import Leg, Removal
from kilter.analysis.planning.order.together import blocked_together
from kilter.analysis.planning.states.holds import Holds, find_fewest_holds
from kilter.analysis.planning.states.part_sets import bits_of, mask_of, members
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import TINY, Array, Mask
from kilter.work import Work

__all__ = ["FEW", "PROGRAM", "OrderSearch", "Removed", "neighbours_of"]

PROGRAM, FEW = 150.0, 4
"""Units of work of a program of a state, for each part that is present and so many more."""
CHECK = 10
"""Programs that stand for a state that is left open, or that `kilter.check` is asked of."""
LAYER = 0.01
"""Parts whose heights are nearer than this lie in one layer, over the width of the whole."""
SWEEP = 400.0
"""Units of work of a pair of parts held against each other on a path."""


@dataclass(frozen=True, slots=True, eq=False)
class Removed:
    """Parts that leave, one or several that move as one, and what must be held then.

    Attributes
    ----------
    parts : tuple of int
    legs : tuple of Leg
        Their way out.
    state : State
        Of the parts that stay, the held ones held: it holds.
    needs : Holds or None
        Where parts are held: why fewer are not enough.
    fails : tuple of str
        Of a given order: why these cannot leave.
    pressed : State or None
        With these in place and pressed, where that is asked.
    turned : States or None
        Under what direction of gravity, where that is not the file's.
    between : State or None
        Where all is turned after this step: what stands then, before it is turned.
    """

    parts: tuple[int, ...]
    legs: tuple[Leg, ...]
    state: State
    needs: Holds[State] | None = None
    fails: tuple[str, ...] = ()
    pressed: State | None = None
    turned: States | None = None
    between: State | None = None

    @property
    def set(self) -> int:
        """The parts as `kilter.analysis.planning.states.part_sets` has them."""
        return sum(1 << part for part in self.parts)

    @property
    def held(self) -> int:
        """How many parts are held, the grounded ones counted too."""
        return int((self.state.present & ~self.state.free).sum())


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
    units : list of int
        Sets of parts that move as one; every part that is not grounded is in one of them.
    together : bool
        Whether others that stop one another may move as one too.
    pressing : Pressing or None
        The force with which parts are pressed in, where that is asked.
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
    units: list[int]
    together: bool = False
    pressing: Pressing | None = None
    best: list[Removed] = field(default_factory=list)
    visited: int = 0
    exhausted: bool = False
    base: int = field(init=False)
    _near: list[int] = field(init=False)
    _seat: dict[int, tuple[float, Array]] = field(init=False)
    _holds: dict[int, Holds[State]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        geometry = self.states.assembly.geometry
        self._near = neighbours_of(self.states)
        self.base = bits_of(geometry.grounded)
        up = geometry.center @ -self.states.assembly.down
        wide = float(np.ptp(geometry.center, axis=0).max())
        layer = (up / max(wide, TINY) / LAYER).round()
        self._seat = {}
        for unit in self.units:
            parts = list(self._members(unit))
            self._seat[unit] = float(layer[parts].max()), geometry.center[parts].mean(axis=0)

    @property
    def whole(self) -> int:
        """The set of all parts."""
        return (1 << len(self._near)) - 1

    def find(self, hold: int) -> list[Removed] | None:
        """The parts in the order in which they leave, at most `hold` held; None: none found."""
        dead: set[int] = set()
        order: list[Removed] = []
        self.exhausted = False
        waiting = [(self.whole, self.removals(self.whole, 0, hold))]
        while waiting:
            present, removals = waiting[-1]
            if present == self.base:
                return order
            if self.work.over:
                return None
            taken = next((one for one in removals if present & ~one.set not in dead), None)
            if taken is None:
                dead.add(present)
                waiting.pop()
                if order:
                    order.pop()
                continue
            order.append(taken)
            self.note(order, hold)
            rest = present & ~taken.set
            waiting.append((rest, self.removals(rest, taken.set, hold)))
        self.exhausted = True
        return None

    def note(self, order: list[Removed], hold: int) -> None:
        """Keep the longest order so far, and tell it."""
        if sum(len(one.parts) for one in order) > sum(len(one.parts) for one in self.best):
            self.best = order.copy()
            left = (order[-1].state.present & ~mask_of(self.base, len(self._near))).sum()
            self.work.tell(f"order: {left} parts to go, {hold} held")

    def removals(self, present: int, last: int, hold: int) -> Iterator[Removed]:
        """What may leave a set of parts, the best first; `last` left before."""
        self.visited += 1
        stuck: list[int] = []
        candidates = self._candidates(present, last)
        for _, layer in groupby(candidates, key=lambda unit: self._seat[unit][0]):
            yield from self._of_layer(layer, present, hold, stuck)
        for moved in stuck:
            legs = self.way_out(moved, present, 2)
            if legs is not None:
                yield from self._held(moved, legs, present, hold)
        if self.together:
            for moved, legs in self._several(present):
                yield from self._held(moved, legs, present, hold)

    def _of_layer(
        self, layer: Iterable[int], present: int, hold: int, stuck: list[int]
    ) -> Iterator[Removed]:
        """What may leave of one layer; what has no straight way is put to the stuck ones."""
        falling = []
        for moved in layer:
            if not self.may_leave(moved, present):
                continue
            legs = self.way_out(moved, present, 1)
            if legs is None:
                stuck.append(moved)
                continue
            state = self.state(present & ~moved)
            if state.stable and self.pressing is not None:
                yield from self._held(moved, legs, present, hold)
            elif state.stable:
                yield Removed(self._members(moved), legs, state)
            else:
                falling.append((moved, legs))
        for moved, legs in falling:
            yield from self._held(moved, legs, present, hold)

    def _members(self, parts: int) -> tuple[int, ...]:
        return tuple(members(parts, len(self._near)).tolist())

    def _candidates(self, present: int, last: int) -> list[int]:
        """Units of a set, those of the highest layers first, of a layer those near the last."""
        found = [one for one in self.units if one & present]
        if not found:
            return []
        layer = np.array([self._seat[one][0] for one in found])
        middle = np.array([self._seat[one][1] for one in found])
        parts = list(self._members(last))
        place = self.states.assembly.geometry.center[parts].mean(axis=0) if last else middle
        away = np.linalg.norm(middle - place, axis=1).round(9)
        return [found[k] for k in np.lexsort((away, -layer)).tolist()]

    def may_leave(self, moved: int, present: int) -> bool:
        """Whether what is left keeps the precedence and hangs together with the base."""
        rest = present & ~moved
        return not self.later_of(moved) & rest and self._hangs_together(rest)

    def ways(self, present: int) -> Iterator[tuple[int, tuple[Leg, ...]]]:
        """What may leave a set of parts by its way, the highest first."""
        for moved in self._candidates(present, 0):
            if self.may_leave(moved, present):
                legs = self.way_out(moved, present, 1) or self.way_out(moved, present, 2)
                if legs is not None:
                    yield moved, legs

    def later_of(self, moved: int) -> int:
        """Parts that are to come after some, others than these."""
        later = 0
        for part in self._members(moved):
            later |= self.after[part]
        return later & ~moved

    def hangs_on(self, moved: int, standing: int) -> bool:
        """Whether all of some parts touch what stands, or one another of those that do."""
        return self._connected(standing, standing | moved) == standing | moved

    def _hangs_together(self, present: int) -> bool:
        """Whether every part of a set is connected to a grounded one within it."""
        return self._connected(present & self.base, present) == present

    def _connected(self, seen: int, among: int) -> int:
        """Parts of a set that are connected, within it, to some of them."""
        new = seen
        while new:
            part = (new & -new).bit_length() - 1
            new &= new - 1
            more = self._near[part] & among & ~seen
            seen |= more
            new |= more
        return seen

    def _several(self, present: int) -> Iterator[tuple[int, tuple[Leg, ...]]]:
        """Units that stop one another and leave as one, the fewest parts first."""
        units = [one for one in self.units if one & present]
        tests = self.removal.sweeps.tests
        found = blocked_together(self.removal, units, present, self.base)
        self.work.charge(SWEEP * (self.removal.sweeps.tests - tests))
        for moved, direction in found:
            one = self._connected(moved & -moved, moved) == moved
            if one and self.may_leave(moved, present):
                yield moved, (Leg(direction, float("inf")),)

    def way_out(self, moved: int, present: int, legs: int) -> tuple[Leg, ...] | None:
        """A way out of parts past those of a set, of so many legs."""
        before = self.removal.sweeps.tests
        found = self.removal.way_out(moved, present, legs=legs)
        self.work.charge(SWEEP * (self.removal.sweeps.tests - before))
        return found

    def state(self, present: int) -> State:
        """The state of a set with nothing held."""
        count = len(self._near)
        solved = self._solved()
        state = self.states.judge(mask_of(present, count), np.zeros(count, dtype=bool))
        self._charge(solved, present)
        return state

    def _solved(self) -> int:
        counts = self.states.counts
        several = counts["open"] + counts["checks"]
        return counts["programs"] + counts["cones"] + CHECK * several

    def _charge(self, solved: int, present: int) -> None:
        """Count the programs that were solved since."""
        self.work.charge(PROGRAM * (self._solved() - solved) * (FEW + present.bit_count()))

    def _held(
        self, moved: int, legs: tuple[Leg, ...], present: int, hold: int
    ) -> Iterator[Removed]:
        """A removal with the fewest holds, where these are no more than `hold`."""
        if self.pressing is not None:
            yield from self.pressed(self.pressing, moved, legs, present, hold)
            return
        known = self.needs(present & ~moved, hold)
        if known.state is not None:
            yield Removed(self._members(moved), legs, known.state, known)

    def pressed(
        self, pressing: Pressing, moved: int, legs: tuple[Leg, ...], present: int, hold: int
    ) -> Iterator[Removed]:
        """A removal with the fewest holds with which parts may be pressed in again."""
        x, y, z = legs[0].direction
        solved, judge = self._solved(), pressing.judge_of(moved, (-x, -y, -z))
        rest = mask_of(present & ~moved, len(self._near))
        names = self.states.assembly.names
        known = find_fewest_holds(judge, names, rest, self.holdable & rest, most=hold)
        self._charge(solved, present)
        self.work.charge(PROGRAM * (FEW + present.bit_count()))
        both = known.state
        if both is not None:
            yield Removed(self._members(moved), legs, both.standing, pressed=both.pressed)

    def needs(self, rest: int, hold: int) -> Holds[State]:
        """The fewest holds of a set, none where these are more than `hold`."""
        known = self._holds.get(rest)
        if known is None or (known.held is None and known.least <= hold):
            solved = self._solved()
            known = self.states.holds_of(mask_of(rest, len(self._near)), self.holdable, most=hold)
            self._charge(solved, rest)
            self._holds[rest] = known
        if known.held is not None and known.held.sum() > hold:
            return replace(known, held=None, state=None)
        return known


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
