"""Judge an order of assembly that the user gives: path, held parts and failures of each step.

The standing parts before each step are judged as in a search
(`kilter.analysis.planning.order.search`), with the fewest parts held. All steps are judged, even
after a step that fails.
"""

from __future__ import annotations

from collections.abc import Iterable

from kilter.analysis.planning.order.plan_step import NO_WAY, UNDECIDED
from kilter.analysis.planning.order.search import OrderSearch, Removed
from kilter.analysis.planning.states.part_sets import members
from kilter.assembly import Assembly
from kilter.errors import InputError, some_names
from kilter.tell.numbers import count

__all__ = ["judge_order", "sets_of_order"]


def sets_of_order(assembly: Assembly, order: Iterable[str | Iterable[str]]) -> list[int]:
    """For each step of a given order, a bit set of the parts that this step inserts.

    Arguments: `order`: names of the steps; the parts of an entry with several names move together.
    Raises `InputError` if a name is not a part, belongs to a grounded part, comes twice, or if a
    part is left out.
    """
    sets, seen = [], {part.name for part in assembly if part.grounded}
    for entry in order:
        names = [entry] if isinstance(entry, str) else list(entry)
        if not names:
            raise InputError("a step of the sequence names no part", hint="name its parts")
        for name in names:
            place = assembly.index_of(name)
            if name in seen:
                fixed = assembly[place].grounded
                why = (
                    "is grounded, so it stands from the start"
                    if fixed
                    else "comes twice in the sequence"
                )
                raise InputError(f"{name!r} {why}", hint="leave it out")
            seen.add(name)
        sets.append(sum(1 << assembly.index_of(name) for name in names))
    missing = [name for name in assembly.names if name not in seen]
    if missing:
        raise InputError(f"the sequence leaves out {some_names(missing)}", hint="add them")
    return sets


def judge_order(search: OrderSearch, order: list[int], hold: int) -> list[Removed]:
    """Judge each step of a given order, the last step first, as a removal with reasons of failure.

    Parameters
    ----------
    search : OrderSearch
    order : list of int
        Bit sets of parts from `sets_of_order`.
    hold : int
        Largest number of parts held at once.
    """
    present, removals = search.whole, []
    for moved in reversed(order):
        removals.append(_judge_removal(search, moved, present, hold))
        present &= ~moved
        search.visited += 1
    return removals


def _judge_removal(search: OrderSearch, moved: int, present: int, hold: int) -> Removed:
    """Judge the removal of given parts: its path, held parts and reasons of failure."""
    rest, fails = present & ~moved, []
    parts = tuple(members(moved, len(search.after)).tolist())
    names = search.states.assembly.names
    early = search.later_of(moved) & rest
    if early:
        later = [names[k] for k in members(early, len(names)).tolist()]
        fails.append(f"it must come before {some_names(later)}")
    if not search.hangs_on(moved, rest):
        fails.append("it touches no standing part")
    legs = search.way_out(moved, present, 1) or search.way_out(moved, present, 2)
    if legs is None:
        fails.append(NO_WAY)
    state = search.state(rest)
    needs = None if state.stable else search.needs(rest, hold)
    if needs is not None and needs.state is not None:
        state = needs.state
    elif needs is not None:
        held = f" with up to {count(hold, 'part')} held" if hold else ""
        if state.stable is None or needs.undecided:
            fails.append(UNDECIDED)
        else:
            fails.append(f"{some_names(state.moving)} would fall before it is in place{held}")
    if search.pressing is not None and legs and not fails:
        pressed = next(search.pressed(search.pressing, moved, legs, present, hold), None)
        if pressed is not None:
            return pressed
        fails.append("the standing parts do not withstand the pressing force")
    return Removed(parts, legs or (), state, needs, tuple(fails))
