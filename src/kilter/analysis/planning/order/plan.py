"""Plan of an assembly: order of insertion, held parts, and proof that fewer holds fail.

The order is found backwards (`kilter.analysis.planning.order.search`). Each step has a state that
contact forces hold while the next part comes in (`kilter.analysis.planning.states.states`), and a
free path (`kilter.analysis.planning.order.removal`). Three proofs of impossibility hold for any
paths. Without holds, some parts cannot stand (`kilter.analysis.planning.order.closure`). For any
holds, parts lock each other (`kilter.analysis.planning.order.locking`). For a given number of
holds, the states that need more bar every order (`kilter.analysis.planning.order.exhaustion`).
Without such a proof, the answer "none found" covers only the tried paths.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from kilter.analysis.planning.order.cheapest import Searched, find_order
from kilter.analysis.planning.order.closure import find_unreachable
from kilter.analysis.planning.order.exhaustion import find_refused
from kilter.analysis.planning.order.given_order import judge_order, sets_of_order
from kilter.analysis.planning.order.locking import Locked, find_locked
from kilter.analysis.planning.order.order import Order
from kilter.analysis.planning.order.plan_rules import PlanRules, turns_alone
from kilter.analysis.planning.order.plan_step import steps_of
from kilter.analysis.planning.order.pressing import Pressing
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.order.screws import find_screws
from kilter.analysis.planning.order.search import OrderSearch
from kilter.analysis.planning.order.succession import later_parts, precedence_pairs
from kilter.analysis.planning.order.together import units_of_groups
from kilter.analysis.planning.order.turning import find_with_turns
from kilter.analysis.planning.states.part_sets import members
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States, states
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.contact import ContactSet, Tolerance
from kilter.errors import InputError
from kilter.tell.levels import require_level
from kilter.threads import on_one_thread
from kilter.validate import number
from kilter.work import EFFORT, Work, units_of

__all__ = ["plan"]

SEARCH = 40.0
"""Work of the search of an order, relative to the work of an effort [-]."""


@on_one_thread
def plan(
    assembly: Assembly,
    rules: PlanRules | None = None,
    *,
    require: str = "equilibrium",
    effort: float = EFFORT,
    time_limit: float | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    progress: Callable[[str], None] | None = None,
) -> Order:
    """Find an order in which an assembly can be put together, with a proof of each step.

    Parameters
    ----------
    assembly : Assembly
        Finished assembly with at least one grounded part; the grounded parts are the base.
    rules : PlanRules, optional
        Allowed orders, held parts and paths, and the quantity to be minimised; by default up to 2
        parts are held, and their number is minimised.
    require : {"equilibrium", "settles", "proved"}
        Level that `Order.holds` requires of every step; the search uses "equilibrium".
    effort : float
        Limit of the counted work of the search: 1 is usual, each further unit means ten times more.
    time_limit, contacts, tolerance, progress
        Same as in `kilter.check`.

    Raises
    ------
    InputError
        If no part or every part is grounded, a name matches no part,
        the precedence has a cycle, no thread joins the parts of a screw, a part is in
        two groups, or the sequence does not name each part exactly once.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> found = plan(scene("tower"))
    >>> found, [step.part for step in found.steps]
    (<Order: found, 5 steps, 0 with parts held>, ['cube-1', 'cube-2', 'cube-3', 'cube-4', 'cube-5'])
    """
    require_assembly(assembly, "plan")
    require_no_bonds(assembly, "plan", NOT_SET)
    assembly.require_grounded()
    level = require_level(require)
    rules = PlanRules() if rules is None else rules
    if rules.turn and assembly.loads:
        raise turns_alone()
    if time_limit is not None:
        time_limit = number(time_limit, "time_limit", lowest=0)
    budget = SEARCH * units_of(number(effort, "effort", lowest=0))
    work = Work(budget, progress, time_limit=time_limit)
    started = time.perf_counter()
    after, units = later_parts(assembly, rules.before), units_of_groups(assembly, rules.groups)
    if rules.sequence is not None:
        units = sets_of_order(assembly, rules.sequence)
    part_states = states(assembly, contacts=contacts, tolerance=tolerance, progress=progress)
    seconds = {"contacts": time.perf_counter() - started}
    between = time.perf_counter()
    whole = _whole_state(part_states)
    finished = part_states.decide(whole, require=level, effort=effort, work=work, finished=True)
    turned = find_screws(part_states.contacts, rules.screws)
    removal = Removal(part_states.contacts, directions=rules.directions, screws=turned)
    barred = (
        part_states.mask(rules.never_hold)
        if rules.never_hold
        else np.zeros(len(assembly), dtype=bool)
    )
    holdable = ~assembly.geometry.grounded & ~barred
    pressing = Pressing(part_states, rules.press) if rules.press else None
    search = OrderSearch(
        part_states, removal, after, holdable, work, units, rules.together, pressing
    )
    falling: list[State] = []
    locked: list[Locked] = []
    one_by_one = rules.sequence is None and not rules.together
    one_by_one = one_by_one and bool(whole.stable) and not any(unit & (unit - 1) for unit in units)
    if one_by_one:
        work.stage("locked parts")
        locked = find_locked(part_states, removal)
        work.stage("parts that stand by themselves")
        falling = [] if locked or rules.turn else find_unreachable(part_states)[1]
    if not whole.stable:
        searched = Searched(None)
    elif rules.sequence is not None:
        work.stage("the sequence")
        searched = Searched(judge_order(search, units, rules.hold), rules.hold)
    elif rules.turn and not locked:
        searched = find_with_turns(search, rules.hold, rules.fewest)
    elif locked:
        searched = Searched(None)
    else:
        searched = find_order(search, 1 if falling else 0, rules.hold, rules.fewest)
    refused = []
    if (
        search.exhausted
        and searched.order is None
        and one_by_one
        and not (rules.turn or rules.press)
    ):
        try:
            refused = [] if falling and rules.hold == 0 else find_refused(search, rules.hold)
        except KeyboardInterrupt:
            searched = Searched(None, interrupted=True)
    seconds["search"] = time.perf_counter() - between
    work.stage("levels of the steps")
    steps = steps_of(search, searched.order or [], level, effort)
    seconds["solve"] = time.perf_counter() - between
    return Order(
        states=part_states,
        steps=tuple(steps),
        best=()
        if searched.order
        else tuple(n for entry in search.best for n in _names(assembly, entry.set)),
        falling=tuple(falling),
        locked=tuple(locked),
        refused=tuple(refused),
        whole=whole,
        finished=finished,
        hold=rules.hold,
        require=level,
        precedence=precedence_pairs(assembly, after, turned),
        never_held=tuple(np.array(assembly.names)[barred].tolist()),
        directions=tuple(
            entry if isinstance(entry, str) else tuple(np.asarray(entry).tolist())
            for entry in rules.directions
        ),
        screws=tuple(turned),
        moved_as_one=tuple(_names(assembly, unit) for unit in units if unit & (unit - 1)),
        together=rules.together,
        exhausted=search.exhausted,
        press=rules.press,
        turn=rules.turn,
        given=rules.sequence is not None,
        fewest=rules.fewest,
        least=_least(searched, len(falling)),
        interrupted=searched.interrupted,
        time_limit=time_limit if work.cut else None,
        counts={
            "states": search.visited,
            "programs": part_states.counts["programs"] + part_states.counts["cones"],
            "sweeps": removal.sweeps.tests,
            "no_goods": part_states.no_goods,
        },
        seconds=seconds,
    )


def _least(searched: Searched, falling: int) -> str | None:
    """Return the scope of the proof that the found order has the minimum, or None."""
    if searched.order is None:
        return None
    if searched.least == 0 or (searched.least == 1 and falling > 1):
        return "always"
    return "as-tried" if searched.proved else None


def _whole_state(part_states: States) -> State:
    """Return the state of the finished assembly with only its grounded parts held."""
    assembly = part_states.assembly
    grounded = assembly.geometry.grounded
    if grounded.all():
        raise InputError("everything is held: there is nothing to put together")
    return part_states.judge(np.ones(len(assembly), dtype=bool), grounded)


def _names(assembly: Assembly, *sets: int) -> tuple[str, ...]:
    """Return the names of the parts of bit sets, set by set."""
    return tuple(
        assembly.names[k] for parts in sets for k in members(parts, len(assembly)).tolist()
    )
