"""Search for an order of assembly, backwards from the whole assembly by removing parts.

The search removes parts one at a time. A part p may leave the set S for T = S - p if

    no part that must be put in after p is in T                precedence
    contacts connect every part of T with a grounded part      each part touches standing parts
    p has a free path out of S                                 `planning.order.removal`
    T holds with at most K of its parts held                   `planning.states.states`

T is judged without p. On the path of p, contacts with p can only add forces. Once p is in place,
T + p holds too if p is held. The parts of the highest layer leave first, nearest to the last
removed part first: first the parts whose T needs no hold, then the others. (Removing a held part
from below instead would keep it held for many steps.) Paths of two legs are tried last.

Groups of parts that touch only the base are separate problems (`OrderSearch.groups`). Each has an
order by itself, or the whole has none. These orders are put one after the other, and every path and
state is proved again among all parts. Equal groups take the order of the first.

Sets from which no order continues are recorded, so that no set is searched twice. A search has a
fixed K. After a failure K is raised, so the first order found has the fewest parts held at once
among the orders along the tried paths.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import TypeVar

import numpy as np

from kilter.analysis.planning.order.removal import (
    Direction,
    Leg,
    Pressing,
    Removal,
    direction_of,
)
from kilter.analysis.planning.states.holds import (
    Cut,
    Holds,
    bits_of,
    find_fewest_holds,
    mask_of,
    members,
)
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import TINY, Array, Index, Mask
from kilter.assembly import Assembly
from kilter.errors import InputError, some_names
from kilter.work import Work

# Units of parts that block each other along a direction, so that they can only move together.


def units_of_groups(assembly: Assembly, groups: Iterable[str | Iterable[str]]) -> list[int]:
    """Units of a plan (bit sets of parts that move together): given groups, and single free parts.

    Raises `InputError` if a pattern matches no part, a group has a grounded part, or two groups
    share a part.
    """
    units, seen = [], 0
    grounded = assembly.geometry.grounded
    for group in groups:
        names = sorted(assembly.matching(group), key=assembly.index_of)
        if not names:
            raise InputError("a group names no part", hint="name its parts")
        fixed = [name for name in names if assembly[name].grounded]
        if fixed:
            raise InputError(
                f"a group has {some_names(fixed)}, held from the start", hint="leave it out"
            )
        unit = sum(1 << assembly.index_of(name) for name in names)
        if unit & seen:
            twice = [assembly.names[k] for k in members(unit & seen, len(assembly))]
            raise InputError(
                f"{some_names(twice)} is in two groups", hint="name it in a single group"
            )
        units.append(unit)
        seen |= unit
    return units + [1 << k for k in np.flatnonzero(~grounded).tolist() if not seen >> k & 1]


def blocked_together(
    removal: Removal, units: Sequence[int], present: int, base: int
) -> list[tuple[int, Direction]]:
    """Units that can leave together along a direction, but not separately, each with a direction.

    Returns bit set of moved parts and direction, the fewest parts first.
    """
    directions = list(dict.fromkeys(d for unit in units for d in removal.directions(unit)))
    moves: dict[int, Direction] = {}
    for direction in directions:
        for moved in _components(removal, units, present, base, direction):
            moves.setdefault(moved, direction)
    return sorted(moves.items(), key=lambda move: (move[0].bit_count(), move[0]))


def _components(
    removal: Removal, units: Sequence[int], present: int, base: int, direction: Direction
) -> list[int]:
    """Groups of units that block each other along a direction and are blocked by no other unit."""
    size = present.bit_length()
    unit_of = {part: unit for unit in units for part in members(unit, size).tolist()}
    stops: dict[int, int] = {}

    def stopping(unit: int) -> int:
        if unit not in stops:
            stops[unit] = removal.stopping(unit, present, direction)
        return stops[unit]

    reached: dict[int, int] = {}
    for unit in units:
        component, new = unit, unit
        while new and not component & base:
            other = unit_of[(new & -new).bit_length() - 1]
            new &= ~other
            met = stopping(other)
            if met & base:
                component |= met
                break
            more = sum({unit_of[part] for part in members(met & ~component, size).tolist()})
            component |= more
            new |= more
        reached[unit] = component
    return [
        component
        for component in dict.fromkeys(reached.values())
        if not component & base and component not in units
        and all(reached[other] == component for other in units if other & component)
    ]  # fmt: skip


Candidate = TypeVar("Candidate")


PROGRAM, FEW = 150.0, 4
"""Work of one program of a state that is not counted: PROGRAM units for each present part, and for
FEW parts more."""
CHECK = 10
"""Work of a state that needs choices of normals or `kilter.check`, as a number of programs."""
LAYER = 0.01
"""Height of a layer, relative to the width of the assembly [-]; larger: more parts per layer."""
THIN_LAYER = 0.25
"""Largest height of a layer, relative to the median height of the parts [-]: in a wide assembly, a
part and the part on it are in two layers."""
SWEEP = 400.0
"""Units of work of one collision test of a pair of parts on a path."""


@dataclass(frozen=True, slots=True, eq=False)
class Removed:
    """Removal of parts that move together: the reverse of a step, with the parts to hold."""

    parts: tuple[int, ...]
    legs: tuple[Leg, ...]
    """Path of the removal."""
    state: State
    """State of the remaining parts with the holds; it holds."""
    needs: Holds[State] | None = None
    """Proof that fewer holds are not enough; None without held parts."""
    fails: tuple[str, ...] = ()
    """Reasons why the parts of a given order cannot leave; empty otherwise."""
    pressed: State | None = None
    """State with the moved parts in place under the pressing force; None without that force."""
    turned: States | None = None
    """States under another direction of gravity; None under that of the file."""
    between: State | None = None
    """State of the standing parts before the assembly is turned after this step; None if it is
    not turned."""

    def moved(self, where: Index, turn: Array) -> Removed:
        """The removal of copies of the parts, without proofs.

        Arguments: `where` (N,): the copy of each part, or the part itself; `turn` (3, 3).
        """

        def mask(parts: Mask) -> Mask:
            copied = np.zeros_like(parts)
            copied[where[parts]] = True
            return copied

        legs = [Leg(direction_of(turn @ np.array(leg.direction)), leg.length) for leg in self.legs]
        present, free = mask(self.state.present), mask(self.state.free)
        state = State(self.state.names, present, free, None, self.state.programs)
        needs = self.needs
        if needs is not None:
            held = None if needs.held is None else mask(needs.held)
            cuts = tuple(Cut(mask(cut.parts), cut.state) for cut in needs.cuts)
            needs = replace(needs, held=held, state=state, cuts=cuts)
        return Removed(tuple(where[list(self.parts)].tolist()), tuple(legs), state, needs)

    @property
    def set(self) -> int:
        """The removed parts as a bit set (`kilter.analysis.planning.states.holds`)."""
        return sum(1 << part for part in self.parts)

    @property
    def held(self) -> int:
        """Number of held parts during the removal, the grounded parts included."""
        return int((self.state.present & ~self.state.free).sum())


@dataclass(slots=True)
class OrderSearch:
    """Search for an order of assembly that removes parts from the whole assembly."""

    states: States
    removal: Removal
    after: list[int]
    """Bit set of the parts that must come later, for each part."""
    holdable: Mask
    """Parts that may be held, shape (N,)."""
    work: Work
    units: list[int]
    """Bit sets of parts that move together; each part that is not grounded is in exactly one
    set."""
    together: bool = False
    """Whether further parts that block each other may also move together."""
    pressing: Pressing | None = None
    """Force that presses parts in; None without pressing."""
    best: list[Removed] = field(default_factory=list)
    """The longest order so far, in the order of removal."""
    visited: int = 0
    """Number of part sets that the search expanded."""
    exhausted: bool = False
    """Whether the last search tried every possible removal."""
    base: int = field(init=False)
    scope: int = field(init=False)
    """Bit set of the parts that are removed: all, or those of a group."""
    groups: list[int] = field(init=False)
    """Bit sets of groups that can be taken apart one after the other; empty without two groups."""
    _group_of: dict[int, int] = field(init=False)
    _searches: dict[tuple[int, bool], OrderSearch] = field(default_factory=dict)
    _near: list[int] = field(init=False)
    _layer: Array = field(init=False)
    _middle: Array = field(init=False)
    _height: dict[int, float] = field(init=False)
    _holds: dict[int, Holds[State]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        geometry = self.states.assembly.geometry
        self._near = neighbours_of(self.states)
        self.base = bits_of(geometry.grounded)
        self.scope = bits_of(~geometry.grounded)
        self.groups, self._group_of = self._separate_groups()
        up, first = -self.states.assembly.down, geometry.vertex_start[:-1]
        heights = geometry.vertices @ up
        extent = np.maximum.reduceat(heights, first) - np.minimum.reduceat(heights, first)
        wide = float(np.ptp(geometry.center, axis=0).max())
        height = min(LAYER * wide, THIN_LAYER * float(np.median(extent)))
        layer = (geometry.center @ up / max(height, TINY)).round()
        groups = [list(self._members(unit)) for unit in self.units]
        self._layer = np.array([layer[parts].max() for parts in groups])
        self._middle = np.array([geometry.center[parts].mean(axis=0) for parts in groups])
        self._middle = self._middle.reshape(-1, 3)
        self._height = dict(zip(self.units, self._layer.tolist(), strict=True))

    def _separate_groups(self) -> tuple[list[int], dict[int, int]]:
        """Groups without units or precedence across them, and the group of each unit.

        They are left out if each is a single unit.
        """
        groups = [group.bits for group in self.states.groups]
        alone = len(groups) in (0, len(self.units))
        if alone or self.together or self.pressing is not None:
            return [], {}
        group_of = {}
        for unit in self.units:
            part = unit & -unit
            group = next(bits for bits in groups if bits & part)
            if (unit | self.later_of(unit)) & ~group:
                return [], {}
            group_of[unit] = group
        return groups, group_of

    @property
    def whole(self) -> int:
        """All parts that are removed, and the base, as a bit set."""
        return self.base | self.scope

    def find(self, hold: int, *, direct: bool = False) -> list[Removed] | None:
        """Find removals that form an order with at most `hold` held parts; None if not found.

        A `direct` search takes the first possible removal from the highest parts of each set that
        have a path, and ends at the first set without one. Groups that do not touch are taken apart
        one after the other. A group without an order excludes an order of all; if groups are in the
        way of each other, the search continues with all parts together.
        """
        if self.groups:
            found, blocked = self._find_by_groups(hold, direct=direct)
            if not blocked or direct or self.work.over:
                return found
        return self._find_together(hold, direct=direct)

    def _find_by_groups(self, hold: int, *, direct: bool) -> tuple[list[Removed] | None, bool]:
        """Find an order of each group alone, and put these one after the other; None if not found.

        Returns also whether groups are in the way of each other. The search is exhausted if that of
        a group is, and this group has no order.
        """
        order: list[Removed] = []
        present, orders = self.whole, dict[int, list[Removed]]()
        self.exhausted = False
        while present != self.base:
            last = order[-1].set if order else 0
            for group in dict.fromkeys(self._group_of[k] for k in self._candidates(present, last)):
                placed = None if direct else self._like_its_copy(group, present, orders)
                if placed is None:
                    if group not in orders:
                        found = self._order_alone(group, hold, direct=direct)
                        if found is None:
                            return None, False
                        orders[group] = found
                    placed = self._in_place(orders[group], present)
                if placed is not None:
                    break
            else:
                return None, True
            order += placed
            self.note(order, hold)
            present &= ~group
        return order, False

    def _order_alone(self, group: int, hold: int, *, direct: bool) -> list[Removed] | None:
        """Find an order of a group, as if there were no other groups; None if not found."""
        alone = self._alone(group, direct=direct)
        before = alone.visited
        found = alone.find(hold, direct=direct)
        self.visited += alone.visited - before
        self.exhausted = found is None and alone.exhausted
        return found

    def _like_its_copy(
        self, group: int, present: int, orders: dict[int, list[Removed]]
    ) -> list[Removed] | None:
        """Removals of a group in the order of an equal group; None if that is no order of it."""
        copies = self.states.copies
        first, turn = copies.get(group, (group, np.eye(3)))
        source = next((k for k in orders if copies.get(k, (k,))[0] == first), group)
        if source == group:
            return None
        if source != first:
            turn = turn @ copies[source][1].T
        count = len(self._near)
        where = np.arange(count)
        where[members(source, count)] = members(group, count)
        moved = [removed.moved(where, turn) for removed in orders[source]]
        for removed in moved:
            held = bits_of(removed.state.present & ~removed.state.free) & ~self.base
            later = self.later_of(removed.set) & bits_of(removed.state.present)
            if removed.set not in self._group_of or later or held & ~bits_of(self.holdable):
                return None
        return self._in_place(moved, present)

    def _alone(self, group: int, *, direct: bool) -> OrderSearch:
        """The search in a group, as if there were no other groups, with its own work limit."""
        alone = self._searches.get((group, direct))
        if alone is None:
            kept = [k for k, unit in enumerate(self.units) if unit & group]
            alone = self._searches[group, direct] = copy(self)
            alone.states = next(g.states for g in self.states.groups if g.bits & group)
            alone.scope, alone.groups, alone.visited = group, [], 0
            alone._holds, alone.best = {}, []
            alone.units = [self.units[k] for k in kept]
            alone._layer, alone._middle = self._layer[kept], self._middle[kept]
            alone.work = self.work.beside(self.work.allowed)
        return alone

    def _in_place(self, order: list[Removed], present: int) -> list[Removed] | None:
        """The removals of a group among other parts; None if these are in the way."""
        placed = []
        for removed in order:
            legs: tuple[Leg, ...] | None = removed.legs
            if not self.removal.passes(removed.legs, removed.set, present):
                legs = self.way_out(removed.set, present, 1) or self.way_out(
                    removed.set, present, 2
                )
            if legs is None:
                return None
            present &= ~removed.set
            here = mask_of(present, len(self._near))
            state = self.states.judge(here, removed.state.present & ~removed.state.free)
            if not state.stable:
                return None
            needs = removed.needs
            if needs is not None:
                cuts = tuple(
                    Cut(cut.parts, self.states.judge(here, here & ~cut.parts)) for cut in needs.cuts
                )
                if any(cut.state.stable is not False for cut in cuts):
                    return None
                needs = replace(needs, state=state, cuts=cuts)
            placed.append(replace(removed, legs=legs, state=state, needs=needs))
        return placed

    def _find_together(self, hold: int, *, direct: bool = False) -> list[Removed] | None:
        """Find removals of parts in any sequence, as `find`."""
        dead: set[int] = set()
        order: list[Removed] = []
        self.exhausted = False
        waiting = [(self.whole, self.removals(self.whole, 0, hold, direct=direct))]
        while waiting:
            present, removals = waiting[-1]
            if present == self.base:
                return order
            if self.work.over:
                return None
            taken = next(
                (removal for removal in removals if present & ~removal.set not in dead), None
            )
            if taken is None:
                if direct or self.work.over:  # the removals that are left were not tried
                    return None
                dead.add(present)
                waiting.pop()
                if order:
                    order.pop()
                continue
            order.append(taken)
            self.note(order, hold)
            rest = present & ~taken.set
            waiting.append((rest, self.removals(rest, taken.set, hold, direct=direct)))
        self.exhausted = True
        return None

    def note(self, order: list[Removed], hold: int) -> None:
        """Store an order if it is the longest so far, and report progress then."""
        present = order[-1].state.present
        if not self.best or present.sum() < self.best[-1].state.present.sum():
            self.best = order.copy()
            left = (present & ~mask_of(self.base, len(self._near))).sum()
            self.work.tell(f"order: {left} parts to place, {hold} held")

    def removals(
        self, present: int, last: int, hold: int, *, direct: bool = False
    ) -> Iterator[Removed]:
        """Yield possible removals from a set of parts, best first; `last` was removed before.

        The removals end early if the budget is exhausted, or after the highest layer with a path if
        they are `direct`: many removals of a large set may be impossible.
        """
        self.visited += 1
        self.work.tell(f"order: sets of parts {self.visited}, judged states {len(self.states)}")
        stuck: list[int] = []
        candidates = self._candidates(present, last)
        for _, group in groupby(candidates, key=self._height.__getitem__):
            layer, stuck_before = list(group), len(stuck)
            yield from self._of_layer(layer, present, hold, stuck)
            if direct and len(stuck) - stuck_before < len(layer):
                return
        for moved in self._in_budget(stuck):
            legs = self.way_out(moved, present, 2)
            if legs is not None:
                yield from self._held(moved, legs, present, hold)
        if self.together:
            for moved, legs in self._in_budget(self._several(present)):
                yield from self._held(moved, legs, present, hold)

    def _of_layer(
        self, layer: Iterable[int], present: int, hold: int, stuck: list[int]
    ) -> Iterator[Removed]:
        """Yield removals of the units of a layer; units without a path go to the list `stuck`."""
        falling = []
        for moved in self._in_budget(layer):
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
        for moved, legs in self._in_budget(falling):
            yield from self._held(moved, legs, present, hold)

    def _in_budget(self, candidates: Iterable[Candidate]) -> Iterator[Candidate]:
        """Yield the candidates until the budget is exhausted."""
        for candidate in candidates:
            if self.work.over:
                return
            yield candidate

    def _members(self, parts: int) -> tuple[int, ...]:
        """Indices of the parts in a bit set."""
        return tuple(members(parts, len(self._near)).tolist())

    def _candidates(self, present: int, last: int) -> list[int]:
        """Units that may be removed: the highest layer first, then nearest to `last`."""
        here = np.array([k for k, unit in enumerate(self.units) if unit & present], dtype=int)
        layer, middle = self._layer[here], self._middle[here]
        parts = list(self._members(last))
        place = self.states.assembly.geometry.center[parts].mean(axis=0) if last else middle
        away = np.linalg.norm(middle - place, axis=1).round(9)
        return [self.units[k] for k in here[np.lexsort((away, -layer))].tolist()]

    def may_leave(self, moved: int, present: int) -> bool:
        """Whether precedence allows to remove `moved`, and contacts tie the rest to the base."""
        rest = present & ~moved
        return not self.later_of(moved) & rest and self._hangs_together(rest)

    def ways(self, present: int) -> Iterator[tuple[int, tuple[Leg, ...]]]:
        """Yield each unit that can leave a set of parts, with its free path, the highest first."""
        for moved in self._candidates(present, 0):
            if self.may_leave(moved, present):
                legs = self.way_out(moved, present, 1) or self.way_out(moved, present, 2)
                if legs is not None:
                    yield moved, legs

    def later_of(self, moved: int) -> int:
        """Bit set of the parts that must be inserted after the parts `moved`, without `moved`."""
        later = 0
        for part in self._members(moved):
            later |= self.after[part]
        return later & ~moved

    def hangs_on(self, moved: int, standing: int) -> bool:
        """Whether contacts connect every part of `moved` with the standing parts."""
        return self._grow_connected(standing, standing | moved) == standing | moved

    def _hangs_together(self, present: int) -> bool:
        """Whether contacts within a set of parts connect each of them with a grounded part."""
        return self._grow_connected(present & self.base, present) == present

    def _grow_connected(self, seen: int, among: int) -> int:
        """Add to the parts `seen` all parts of `among` that contacts connect with them.

        Contacts count only between parts of both sets.
        """
        new = seen
        while new:
            part = (new & -new).bit_length() - 1
            new &= new - 1
            more = self._near[part] & among & ~seen
            seen |= more
            new |= more
        return seen

    def _several(self, present: int) -> Iterator[tuple[int, tuple[Leg, ...]]]:
        """Yield groups of units that can only leave together, the smallest group first."""
        units = [unit for unit in self.units if unit & present]
        tests = self.removal.sweeps.tests
        moves = blocked_together(self.removal, units, present, self.base)
        self.work.charge(SWEEP * (self.removal.sweeps.tests - tests))
        for moved, direction in moves:
            connected = self._grow_connected(moved & -moved, moved) == moved
            if connected and self.may_leave(moved, present):
                yield moved, (Leg(direction, float("inf")),)

    def way_out(self, moved: int, present: int, legs: int) -> tuple[Leg, ...] | None:
        """Path of at most `legs` legs for parts out of a set of parts; None if none was found."""
        before = self.removal.sweeps.tests
        path = self.removal.way_out(moved, present, legs=legs)
        self.work.charge(SWEEP * (self.removal.sweeps.tests - before))
        return path

    def state(self, present: int) -> State:
        """Judge whether a set of parts stands with only the grounded parts held."""
        count = len(self._near)
        before = self._counted()
        state = self.states.judge(mask_of(present, count), np.zeros(count, dtype=bool))
        self._charge(before, present)
        return state

    def _counted(self) -> tuple[float, int]:
        """Units of the programs solved so far, and number of open and checked states so far."""
        counts = self.states.counts
        return self.states.units, counts["open"] + counts["checks"]

    def _charge(self, before: tuple[float, int], present: int) -> None:
        """Charge the work for the states judged since the count `before` by `_counted`."""
        units, several = self._counted()
        program = PROGRAM * (FEW + present.bit_count())
        self.work.charge(units - before[0] + CHECK * program * (several - before[1]))

    def _held(
        self, moved: int, legs: tuple[Leg, ...], present: int, hold: int
    ) -> Iterator[Removed]:
        """Yield the removal with the fewest held parts, if these are at most `hold`."""
        if self.pressing is not None:
            yield from self.pressed(self.pressing, moved, legs, present, hold)
            return
        known = self.needs(present & ~moved, hold)
        if known.state is not None:
            yield Removed(self._members(moved), legs, known.state, known)

    def pressed(
        self, pressing: Pressing, moved: int, legs: tuple[Leg, ...], present: int, hold: int
    ) -> Iterator[Removed]:
        """Yield the removal with the fewest held parts that also withstand the pressing."""
        x, y, z = legs[0].direction
        before, judge = self._counted(), pressing.judge_of(moved, (-x, -y, -z))
        rest = mask_of(present & ~moved, len(self._near))
        names = self.states.assembly.names
        known = find_fewest_holds(judge, names, rest, self.holdable & rest, most=hold)
        self._charge(before, present)
        self.work.charge(PROGRAM * (FEW + present.bit_count()))
        both = known.state
        if both is not None:
            yield Removed(self._members(moved), legs, both.standing, pressed=both.pressed)

    def needs(self, rest: int, hold: int) -> Holds[State]:
        """Fewest parts to hold so that a set stands; `held` is None if `hold` are not enough."""
        known = self._holds.get(rest)
        if known is None or (known.held is None and known.least <= hold):
            before = self._counted()
            known = self.states.holds_of(mask_of(rest, len(self._near)), self.holdable, most=hold)
            self._charge(before, rest)
            self._holds[rest] = known
        if known.held is not None and known.held.sum() > hold:
            return replace(known, held=None, state=None)
        return known


def neighbours_of(states: States) -> list[int]:
    """For each part, the parts that it touches or is joined to, as a bit set."""
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
