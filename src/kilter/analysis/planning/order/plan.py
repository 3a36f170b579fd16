"""`kilter.plan`: order of insertion, held parts at each step, and proof that fewer fail.

The order is found backwards (`kilter.analysis.planning.order.search`). Each step has a state that
contact forces hold while the next part comes in (`kilter.analysis.planning.states.states`), and a
free path (`kilter.analysis.planning.order.removal`). Three proofs of impossibility hold for any
paths. Without holds, some parts cannot stand (`kilter.analysis.planning.order.plan`). For any
holds, parts lock each other (`kilter.analysis.planning.order.locking`). For a given number of
holds, the states that need more bar every order (`kilter.analysis.planning.order.plan`). Without
such a proof, the answer "none found" covers only the tried paths.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.decision.open_question import answered_pairs
from kilter.analysis.planning.order.locking import Locked, find_locked
from kilter.analysis.planning.order.order import Assumes, Fewest, Finished, Order, Search
from kilter.analysis.planning.order.plan_rules import PlanRules, turns_alone
from kilter.analysis.planning.order.plan_step import judge_order, sets_of_order, steps_of
from kilter.analysis.planning.order.removal import Pressing, Removal, Screw, find_screws
from kilter.analysis.planning.order.search import FEW, PROGRAM, OrderSearch, units_of_groups
from kilter.analysis.planning.order.turning import Searched, find_order, find_with_turns
from kilter.analysis.planning.states.holds import Holds, bits_of, members
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States, states
from kilter.analysis.smallest_set import least_hitting_set
from kilter.analysis.verdict.remarks import remarks
from kilter.arrays import Array, Mask, across, cross
from kilter.assembly import Assembly
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.errors import InputError, some_names
from kilter.tell.levels import require_level
from kilter.validate import finite
from kilter.work import Work

# Accelerations of a carrier that every state of a plan must carry between two steps.


SIDES = 16
"""Number of corners around the circle of horizontal accelerations. More corners take more time and
are nearer to the circle: the corners exceed its radius by 2 % for 16."""


def extreme_accelerations(assembly: Assembly, carried: float | ArrayLike) -> Array:
    """Accelerations whose convex hull has all accelerations to be carried, shape (n, 3) [m/s^2].

    Arguments: `carried` (3,) [m/s^2]. Raises `InputError` if a vector leaves the plane of a planar
    assembly, or leaves the parts in free fall.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> corners = extreme_accelerations(scene("tower"), 3.0)
    >>> corners.shape, bool(np.linalg.norm(corners[0] + corners[1]) / 2 >= 3.0)
    ((16, 3), True)
    """
    value = np.asarray(carried, dtype=np.float64)
    down = assembly.down
    if value.ndim:
        if assembly.planar and value[1] != 0.0:
            raise InputError(
                f"carried is {value.tolist()}, which leaves the x-z plane of a planar assembly",
                hint="give it y = 0",
            )
        if not (assembly.gravity - value).any():
            raise InputError(
                "with this acceleration of the carrier everything falls freely",
                hint="give another acceleration",
            )
        return value[None] if value.any() else np.empty((0, 3))
    if not value:
        return np.empty((0, 3))
    if assembly.planar:
        along = cross(down, np.array([0.0, 1.0, 0.0]))
        return np.stack([value * along, -value * along])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    corners: Array = np.column_stack([np.cos(angle), np.sin(angle)]) @ np.stack(across(down))
    corners *= float(value) / np.cos(np.pi / SIDES)
    return corners


# Proof that no order of assembly without held parts exists, whatever the paths.


def find_unreachable(states: States, work: Work | None = None) -> tuple[Mask, list[State]]:
    """Find the parts that can stand without hands, and proofs that each of the other parts falls.

    Returns `reached` (N,): mask of the parts that an order may reach; `falling`: states of the
    other parts, each alone free on the reached parts; the part falls. Empty if all parts are
    reached, or if the budget is exhausted; then nothing is proved.

    Examples
    --------
    >>> from kilter.analysis.planning.states.states import states
    >>> from kilter.scenes.arches import arch
    >>> reached, falling = find_unreachable(states(arch(9, ratio=0.3, friction=0.6)))
    >>> int(reached.sum()), len(falling)
    (6, 5)
    """
    work = Work() if work is None else work
    reached = states.assembly.geometry.grounded.copy()
    if not states.groups:
        reached = _reached_parts(states, work)
    for group in states.groups:
        source = states.copies.get(group.bits, (group.bits, None))[0]
        if source == group.bits:
            reached |= _reached_parts(group.states, work)
        else:  # as in an equal group: parts that are not reached have a proof of their own below
            reached[np.flatnonzero(group.free)] = reached[members(source, len(reached))]
    if work.over:
        return reached, []
    falling = np.flatnonzero(~reached).tolist()
    alone = [_state_of_part(states, reached, part, work) for part in falling]
    return reached, alone if all(state.stable is False for state in alone) else []


def _reached_parts(states: States, work: Work) -> Mask:
    """Mask of the parts of a group that an order may reach, and of the grounded parts."""
    reached = states.assembly.geometry.grounded.copy()
    grown = True
    while grown:
        grown = False
        for part in np.flatnonzero(states.free & ~reached).tolist():
            if work.over:
                return reached
            if _state_of_part(states, reached, part, work).stable is not False:
                reached[part] = grown = True
    return reached


def _state_of_part(states: States, standing: Mask, part: int, work: Work) -> State:
    """Judge the state in which only `part` is free and all `standing` parts are held."""
    present = standing.copy()
    present[part] = True
    before = states.units
    state = states.judge(present, standing)
    work.charge(states.units - before + PROGRAM * (FEW + 1))
    return state


# Proof, by all sets of parts, that no order with at most K held parts exists for any paths.


MOST_SETS = 1000
"""Largest number of part sets to enumerate; beyond it nothing is proved."""
MOST_MOTIONS = 200
"""Largest number of motions of a proof; beyond it no proof is returned."""


def leads_nowhere(whole: int, base: int, goes_on: Callable[[int, int], bool]) -> bool:
    """Whether no sequence of removals of single parts leads from the whole assembly to the base.

    Arguments: `goes_on`: function of a part and the set without it that returns whether the removal
    is allowed.
    """
    seen, waiting = {whole}, [whole]
    while waiting:
        present = waiting.pop()
        free = present & ~base
        while free:
            part = free & -free
            free &= ~part
            rest = present & ~part
            if rest in seen or not goes_on(part, rest):
                continue
            if rest == base or len(seen) == MOST_SETS:
                return False
            seen.add(rest)
            waiting.append(rest)
    return True


def find_refused(search: OrderSearch, hold: int) -> list[Holds[State]]:
    """Sets of parts that need more than `hold` held parts; empty unless they exclude all orders."""
    search.work.stage("a proof that no order exists, whatever the paths")
    refused: dict[int, Holds[State]] = {}
    holdable = bits_of(search.holdable)

    def goes_on(part: int, rest: int) -> bool:
        """Whether `part` may be removed and the parts `rest` then stand with at most `hold` held.

        Sets that do not stand are recorded.
        """
        if not search.may_leave(part, rest | part):
            return False
        if rest not in refused:
            if search.work.over:
                return True
            known = search.needs(rest, hold)
            sets = [bits_of(cut.parts) & holdable for cut in known.cuts]
            if least_hitting_set(sets, hold) is not None:
                return True
            refused[rest] = known
        return False

    barred = leads_nowhere(search.whole, search.base, goes_on) and not search.work.over
    motions = sum(len(known.cuts) for known in refused.values())
    return list(refused.values()) if barred and motions <= MOST_MOTIONS else []


# Precedence in a plan: pairs of parts of which the first must be inserted before the second.


def later_parts(assembly: Assembly, before: Iterable[tuple[str, str]]) -> list[int]:
    """For each part, the parts that must be inserted later by the given pairs, as a bit set."""
    later = [0] * len(assembly)
    for pair in before:
        if isinstance(pair, str) or len(pair) != 2:
            raise InputError(f"before has {pair!r:.60}", hint="give pairs of names")
        first, second = (sorted(assembly.matching(pattern)) for pattern in pair)
        for name in first:
            for other in second:
                if assembly[other].grounded and not assembly[name].grounded:
                    raise InputError(
                        f"{name!r} must come before {other!r}, which is held from the start",
                        hint="leave that pair out",
                    )
                later[assembly.index[name]] |= 1 << assembly.index[other]
    _require_no_circle(assembly, later)
    return later


def _require_no_circle(assembly: Assembly, later: list[int]) -> None:
    """Reject a precedence in which a part would have to come before itself."""
    left = bits_of(np.ones(len(later), dtype=bool))
    while True:
        last = [k for k in range(len(later)) if left >> k & 1 and not later[k] & left]
        if not last:
            break
        for k in last:
            left &= ~(1 << k)
    if left:
        names = [name for k, name in enumerate(assembly.names) if left >> k & 1]
        raise InputError(
            f"the precedence has a cycle: {some_names(names)}",
            hint="leave a pair out",
        )


def precedence_pairs(
    assembly: Assembly, later: list[int], screws: Sequence[Screw]
) -> tuple[tuple[str, str], ...]:
    """Required precedence as pairs of names; the bolt of each screw comes before its nut."""
    names = assembly.names
    asked = [
        (names[k], names[other])
        for k in range(len(names))
        for other in range(len(names))
        if later[k] >> other & 1
    ]
    return (*asked, *((names[screw.bolt], names[screw.nut]) for screw in screws))


SEARCH = 12.0
"""Work of the search of an order, relative to the work of an effort [-]; larger: longer searches.

At the default effort a search without result takes about six seconds of one core."""
MANY_PARTS = 500
"""Number of parts from which the work of the search grows with the number of parts."""


@question(require="equilibrium")
def plan(
    asked: Question,
    rules: PlanRules | None = None,
) -> Order:
    """Find an order in which an assembly can be put together, with a proof of each step.

    Parameters
    ----------
    assembly : Assembly, or path
        Finished assembly with at least one grounded part; the grounded parts are the base.
    rules : PlanRules, optional
        Allowed orders, held parts and paths, and the quantity to be minimised; by default up to 2
        parts are held, and their number is minimised.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. `Order.holds` requires it of every step. The default is
        lower than that of `check`, because the search decides half-built states at "equilibrium".
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns the search
        of the order, too.

    Raises
    ------
    InputError
        If no part is grounded, a name matches no part,
        the precedence has a cycle, no thread joins the parts of a screw, a part is in
        two groups, or the sequence does not name each part exactly once.

    See Also
    --------
    kilter.states : verdicts on subsets of the parts, without an order.
    kilter.hold : supports of the finished assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> found = plan(scene("tower"))
    >>> found, [step.part for step in found.steps]
    (<Order: found, 5 steps, 0 with parts held>, ['cube-1', 'cube-2', 'cube-3', 'cube-4', 'cube-5'])
    """
    assembly = asked.assembly
    rules = PlanRules() if rules is None else rules
    _require_plannable(assembly, rules)
    level = require_level(asked.require)
    work = asked.work(SEARCH * max(1.0, len(assembly) / MANY_PARTS))
    after, units = later_parts(assembly, rules.before), units_of_groups(assembly, rules.groups)
    if rules.sequence is not None:
        units = sets_of_order(assembly, rules.sequence)
    carried = extreme_accelerations(assembly, rules.carried)
    part_states = states(asked, accelerations=carried)
    order = _planned(part_states, rules, after, units, asked.but(require=level), work)
    return replace(order, time_limit=asked.time_limit) if work.cut else order


def _planned(
    part_states: States,
    rules: PlanRules,
    after: list[int],
    units: list[int],
    asked: Question,
    work: Work,
) -> Order:
    """The answer for the states of an assembly; `after` and `units` as in `OrderSearch`."""
    searching, level = time.perf_counter(), asked.require
    assembly = part_states.assembly
    carried = extreme_accelerations(assembly, rules.carried)
    whole, finished = part_states.finished(require=level, effort=asked.effort, work=work)
    screws = tuple(find_screws(part_states.contacts, rules.screws))
    search = _order_search(part_states, rules, work, after, units, screws)
    obstacles = _Obstacles(applies=False, locked=[], falling=[])
    searched = _search_directly(search, rules, whole)
    if searched is None:
        obstacles = _find_obstacles(search, rules, whole)
        searched = _search(search, rules, whole, obstacles)
    refused, searched = _find_refused(search, rules, obstacles, searched)
    ordered = time.perf_counter()
    work.stage("levels of the steps")
    steps = steps_of(search, searched.order or [], level, asked.effort)
    longest = () if searched.order else [removed.set for removed in search.best]
    least = _least(searched, len(obstacles.falling))
    return Order(
        require=level,
        units=assembly.units,
        base=tuple(part.name for part in assembly if part.grounded),
        finished=Finished(verdict=finished.verdict, level=finished.level),
        open_pairs=answered_pairs(assembly, part_states.contacts, finished.question),
        steps=tuple(steps),
        precedence=precedence_pairs(assembly, after, screws),
        best=_names(assembly, *longest),
        given=rules.sequence is not None,
        fewest=Fewest(what=rules.fewest, least=least),
        search=_counts(search, rules),
        assumes=_assumes(part_states, rules, carried, screws, units),
        interrupted=searched.interrupted,
        time_limit=None,
        warnings=remarks(assembly, part_states.contacts),
        seconds={
            "contacts": round(searching - asked.begun, 6),
            "search": round(ordered - searching, 6),
            "solve": round(time.perf_counter() - searching, 6),
        },
        states=part_states,
        falling=tuple(obstacles.falling),
        locked=tuple(obstacles.locked),
        refused=tuple(refused),
        whole=whole,
        decision=finished,
        never_held=tuple(np.array(assembly.names)[_never_held(part_states, rules)].tolist()),
        screws=screws,
        accelerations=carried,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Obstacles:
    """Proofs that no order exists or that parts must be held, found from the whole assembly.

    `applies` is false if the rules move several parts at once, or if the whole assembly falls:
    then the proofs say nothing about the orders of the search, and both lists are empty.
    """

    applies: bool
    locked: list[Locked]
    falling: list[State]


def _require_plannable(assembly: Assembly, rules: PlanRules) -> None:
    """Reject an assembly without a base, or with bonds or loads that would turn with it."""
    require_no_bonds(assembly, "plan", NOT_SET)
    assembly.require_grounded()
    if rules.turn and assembly.loads:
        raise turns_alone()


def _order_search(
    part_states: States,
    rules: PlanRules,
    work: Work,
    after: list[int],
    units: list[int],
    screws: Sequence[Screw],
) -> OrderSearch:
    """Create the search for an order under the rules of the user."""
    removal = Removal(part_states.contacts, directions=rules.directions, screws=screws)
    holdable = ~part_states.assembly.geometry.grounded & ~_never_held(part_states, rules)
    pressing = Pressing(part_states, rules.press) if rules.press else None
    return OrderSearch(part_states, removal, after, holdable, work, units, rules.together, pressing)


def _never_held(part_states: States, rules: PlanRules) -> Mask:
    """Mask of the parts that the rules forbid to hold, shape (N,)."""
    if not rules.never_hold:  # no pattern, and a pattern must match a part
        return np.zeros(len(part_states.assembly), dtype=bool)
    return part_states.mask(rules.never_hold)


def _find_obstacles(search: OrderSearch, rules: PlanRules, whole: State) -> _Obstacles:
    """Find parts that block each other; if there are none, find parts that always fall."""
    several = rules.together or any(map(_has_several, search.units)) or not whole.free.any()
    if rules.sequence is not None or several or not whole.stable:
        return _Obstacles(applies=False, locked=[], falling=[])
    search.work.stage("locked parts")
    locked = find_locked(search.states, search.removal)
    search.work.stage("parts that stand by themselves")
    # a turned base changes the direction of gravity, so a part that falls here may stand there
    falling = [] if locked or rules.turn else find_unreachable(search.states, search.work)[1]
    return _Obstacles(applies=True, locked=locked, falling=falling)


def _search_directly(search: OrderSearch, rules: PlanRules, whole: State) -> Searched | None:
    """Take a layered structure apart without held parts or backtracking; None if that fails.

    Such an order shows that no parts lock each other or always fall.
    """
    if not whole.stable or rules.sequence is not None or rules.turn:
        return None
    search.work.stage("an order without held parts")
    try:
        order = search.find(0, direct=True)
    except KeyboardInterrupt:
        return Searched(None, interrupted=True)
    return None if order is None else Searched(order, proved=True)


def _search(search: OrderSearch, rules: PlanRules, whole: State, obstacles: _Obstacles) -> Searched:
    """Search for an order under the rules, unless a proof already excludes every order."""
    if not whole.stable:
        return Searched(None)
    if rules.sequence is not None:
        search.work.stage("the sequence")
        return Searched(judge_order(search, search.units, rules.hold), rules.hold)
    if obstacles.locked:
        return Searched(None)
    if rules.turn:
        return find_with_turns(search, rules.hold, rules.fewest)
    return find_order(search, 1 if obstacles.falling else 0, rules.hold, rules.fewest)


def _find_refused(
    search: OrderSearch, rules: PlanRules, obstacles: _Obstacles, searched: Searched
) -> tuple[list[Holds[State]], Searched]:
    """Find the sets of parts that need too many held parts, if these exclude every order.

    They are sought after a complete search without result.
    """
    complete = search.exhausted and searched.order is None and obstacles.applies
    # parts that always fall already prove that no order without holds exists
    proved = obstacles.falling and rules.hold == 0
    if not complete or rules.turn or rules.press or proved:
        return [], searched
    try:
        return find_refused(search, rules.hold), searched
    except KeyboardInterrupt:
        return [], Searched(None, interrupted=True)


def _counts(search: OrderSearch, rules: PlanRules) -> Search:
    """Counted work of a search for an order, by kind."""
    counts = search.states.counts
    return Search(
        states=search.visited,
        programs=counts["programs"] + counts["cones"],
        sweeps=search.removal.sweeps.tests,
        no_goods=search.states.no_goods,
        exhausted=search.exhausted,
        hold=rules.hold,
    )


def _assumes(
    states: States, rules: PlanRules, carried: Array, screws: Sequence[Screw], units: list[int]
) -> Assumes:
    """The assumptions of a plan under the rules of the user."""
    names, given = states.assembly.names, np.asarray(rules.carried, dtype=np.float64)
    return Assumes(
        directions=tuple(
            entry if isinstance(entry, str) else finite(entry, (3,), "direction")
            for entry in rules.directions
        ),
        tolerance=states.contacts.searched.relative_gap,
        screws=tuple((names[screw.bolt], names[screw.nut]) for screw in screws),
        groups=tuple(_names(states.assembly, unit) for unit in units if _has_several(unit)),
        together=rules.together,
        press=rules.press,
        carried=given.tolist() if len(carried) else None,
        turn=rules.turn,
    )


def _has_several(parts: int) -> bool:
    """Whether a bit set contains at least two parts."""
    return bool(parts & (parts - 1))


def _least(searched: Searched, falling: int) -> Literal["always", "as-tried"] | None:
    """Whether fewer held parts or steps are excluded for all paths, or for the tried ones only."""
    if searched.order is None:
        return None
    if searched.least == 0 or (searched.least == 1 and falling > 1):
        return "always"
    return "as-tried" if searched.proved else None


def _names(assembly: Assembly, *sets: int) -> tuple[str, ...]:
    """Names of all parts in the given bit sets, in the order of the sets."""
    return tuple(
        assembly.names[k] for parts in sets for k in members(parts, len(assembly)).tolist()
    )
