"""In which order can it be put together, what must be held, and why not with less?

An order is found backwards (`kilter.analysis.planning.order.search`); each of its steps is a state
with forces that hold it while the next part comes in (`kilter.analysis.planning.states.states`),
and a way in that nothing stops (`kilter.analysis.planning.order.removal`). With nothing held, that
there is no order along any paths may be proved (`kilter.analysis.planning.order.closure`); with any
number held, where parts lock one another (`kilter.analysis.planning.order.locking`); with so many
held, where states that need more bar every order (`kilter.analysis.planning.order.exhaustion`).
Else "none found" says what was tried, and proves nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.planning.order.cheapest import FEWEST, Searched, find_order
from kilter.analysis.planning.order.closure import find_unreachable
from kilter.analysis.planning.order.exhaustion import find_refused
from kilter.analysis.planning.order.given_order import judge_order, sets_of_order
from kilter.analysis.planning.order.locking import Locked, find_locked
from kilter.analysis.planning.order.order import Order
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

MOST_HELD = 2
"""Parts held at once that are tried, one more after the other, where no number is given."""
SEARCH = 40.0
"""Work of the search of an order over that of an effort [-]."""


@on_one_thread
def plan(
    assembly: Assembly,
    *,
    hold: int | None = None,
    directions: Sequence[str | ArrayLike] = ("axes", "normals"),
    before: Iterable[tuple[str, str]] = (),
    never_hold: str | Iterable[str] = (),
    screws: Iterable[tuple[str, str]] = (),
    groups: Iterable[str | Iterable[str]] = (),
    together: bool = False,
    fewest: str = "holds",
    sequence: Iterable[str | Iterable[str]] | None = None,
    press: float = 0.0,
    turn: bool = False,
    require: str = "equilibrium",
    effort: float = EFFORT,
    time_limit: float | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    progress: Callable[[str], None] | None = None,
) -> Order:
    """An order in which an assembly can be put together, part by part, each step proved.

    Parameters
    ----------
    assembly : Assembly
        Whole, at least one part of it held: the base, which is there from the start.
    hold : int, optional
        Most parts held at once, beside the one that moves; the fewest up to 2 where not given.
    directions : sequence of "axes", "normals" or array_like, shape (3,)
        Along which parts are moved, in the order in which they are tried; world frame.
    before : iterable of pairs of str
        The parts that match the first are put in before those that match the second.
    never_hold : str or iterable of str
        Parts that must not be held.
    screws : iterable of pairs of str
        Bolts and nuts: a bolt stays while its nut is on, a nut comes off along its axis.
    groups : iterable of str or of iterables of str
        Parts that match one of them move as one. What holds them to one another on their way is
        not asked; once they are in place, each stands by itself.
    together : bool
        Whether parts that stop one another may move as one where none leaves alone.
    fewest : {"holds", "held-steps", "turns"}
        What there is to be least of: parts held at once, steps during which a part is held, or
        turns between steps; the last implies `turn`.
    sequence : iterable of str or of iterables of str, optional
        An order to judge step by step, in place of a search; several names at once move as one.
    press : float
        Force with which each part is pressed along the last piece of its way, once in place [N].
    turn : bool
        Whether what stands may be turned between two steps, the base and all. Not together with
        `press`, `together`, a `sequence` or the fewest held steps.
    require : {"equilibrium", "settles", "proved"}
        The level that `Order.holds` asks of every step; the search is at "equilibrium".
    effort : float
        Work that the search may take, counted and not timed: 1 usual, each further one ten times
        more.
    time_limit, contacts, tolerance, progress
        As of `kilter.check`.

    Raises
    ------
    InputError
        If nothing or everything is grounded, the whole does not hold, a name matches nothing,
        the precedence goes round in a circle, no thread joins the parts of a screw, a part is in
        two groups, or the sequence does not name each part once.

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
    if fewest not in FEWEST:
        raise InputError(f"fewest is {fewest!r:.40}", hint=f"give {' or '.join(FEWEST)}")
    most = MOST_HELD if hold is None else _whole_number(hold)
    press = number(press, "press", lowest=0)
    turn = turn or fewest == "turns"
    held_steps = fewest == "held-steps"
    if turn and (press or together or sequence is not None or held_steps or assembly.loads):
        raise InputError(
            "turns cannot be combined with press, together, a sequence, held-steps or loads",
            hint="leave the turns or the other option out",
        )
    if time_limit is not None:
        time_limit = number(time_limit, "time_limit", lowest=0)
    budget = SEARCH * units_of(number(effort, "effort", lowest=0))
    work = Work(budget, progress, time_limit=time_limit)
    started = time.perf_counter()
    after, units = later_parts(assembly, before), units_of_groups(assembly, groups)
    if sequence is not None:
        units = sets_of_order(assembly, sequence)
    found = states(assembly, contacts=contacts, tolerance=tolerance, progress=progress)
    seconds = {"contacts": time.perf_counter() - started}
    between = time.perf_counter()
    whole = _whole_state(found)
    finished = found.decide(whole, require=level, effort=effort, work=work, finished=True)
    turned = find_screws(found.contacts, screws)
    removal = Removal(found.contacts, directions=directions, screws=turned)
    barred = found.mask(never_hold) if never_hold else np.zeros(len(assembly), dtype=bool)
    holdable = ~assembly.geometry.grounded & ~barred
    pressing = Pressing(found, press) if press else None
    search = OrderSearch(found, removal, after, holdable, work, units, together, pressing)
    falling: list[State] = []
    locked: list[Locked] = []
    one_by_one = sequence is None and not together
    one_by_one = one_by_one and bool(whole.stable) and not any(unit & (unit - 1) for unit in units)
    if one_by_one:
        work.stage("locked parts")
        locked = find_locked(found, removal)
        work.stage("parts that stand by themselves")
        falling = [] if locked or turn else find_unreachable(found)[1]
    if not whole.stable:
        searched = Searched(None)
    elif sequence is not None:
        work.stage("the sequence")
        searched = Searched(judge_order(search, units, most), most)
    elif turn and not locked:
        searched = find_with_turns(search, most, fewest)
    elif locked:
        searched = Searched(None)
    else:
        searched = find_order(search, 1 if falling else 0, most, fewest)
    refused = []
    if search.exhausted and searched.order is None and one_by_one and not (turn or press):
        try:
            refused = [] if falling and most == 0 else find_refused(search, most)
        except KeyboardInterrupt:
            searched = Searched(None, interrupted=True)
    seconds["search"] = time.perf_counter() - between
    work.stage("levels of the steps")
    steps = steps_of(search, searched.order or [], level, effort)
    seconds["solve"] = time.perf_counter() - between
    return Order(
        states=found,
        steps=tuple(steps),
        best=()
        if searched.order
        else tuple(n for one in search.best for n in _names(assembly, one.set)),
        falling=tuple(falling),
        locked=tuple(locked),
        refused=tuple(refused),
        whole=whole,
        finished=finished,
        hold=most,
        require=level,
        precedence=precedence_pairs(assembly, after, turned),
        never_held=tuple(np.array(assembly.names)[barred].tolist()),
        directions=tuple(one if isinstance(one, str) else tuple(one) for one in directions),  # type: ignore[arg-type]
        screws=tuple(turned),
        moved_as_one=tuple(_names(assembly, unit) for unit in units if unit & (unit - 1)),
        together=together,
        exhausted=search.exhausted,
        press=press,
        turn=turn,
        given=sequence is not None,
        fewest=fewest,
        least=_least(searched, len(falling)),
        interrupted=searched.interrupted,
        time_limit=time_limit if work.cut else None,
        counts={
            "states": search.visited,
            "programs": found.counts["programs"] + found.counts["cones"],
            "sweeps": removal.sweeps.tests,
            "no_goods": found.no_goods,
        },
        seconds=seconds,
    )


def _least(searched: Searched, falling: int) -> str | None:
    """How surely nothing has less than the order that was found."""
    if searched.order is None:
        return None
    if searched.least == 0 or (searched.least == 1 and falling > 1):
        return "always"
    return "as-tried" if searched.proved else None


def _whole_number(hold: int) -> int:
    if isinstance(hold, bool) or not isinstance(hold, int | np.integer) or hold < 0:
        raise InputError(f"hold is {hold!r:.40}", hint="give a whole number, 0 or more")
    return int(hold)


def _whole_state(found: States) -> State:
    """The state of the finished assembly with only its grounded parts held."""
    assembly = found.assembly
    grounded = assembly.geometry.grounded
    if grounded.all():
        raise InputError("everything is held: there is nothing to put together")
    return found.judge(np.ones(len(assembly), dtype=bool), grounded)


def _names(assembly: Assembly, *sets: int) -> tuple[str, ...]:
    """The parts of some sets, set by set."""
    return tuple(assembly.names[k] for one in sets for k in members(one, len(assembly)).tolist())
