"""A given order, judged step by step: its ways, what must be held, and what fails and why.

What stands before each step is asked as in a search (`kilter.analysis.planning.order.search`), with
the fewest parts held; a step that fails does not stop those after it from being judged.
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
    """The sets of parts that are put in, one after the other.

    Parameters
    ----------
    assembly : Assembly
    order : iterable of str or of iterables of str
        Names; several at once move as one.

    Raises
    ------
    InputError
        If a name is not a part, belongs to a grounded part, comes twice, or if a part is left out.
    """
    found, seen = [], {part.name for part in assembly if part.grounded}
    for one in order:
        names = [one] if isinstance(one, str) else list(one)
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
        found.append(sum(1 << assembly.index_of(name) for name in names))
    missing = [name for name in assembly.names if name not in seen]
    if missing:
        raise InputError(f"the sequence leaves out {some_names(missing)}", hint="add them")
    return found


def judge_order(search: OrderSearch, order: list[int], hold: int) -> list[Removed]:
    """The removals of an order, the last part in first, each with what fails.

    Parameters
    ----------
    search : OrderSearch
    order : list of int
        Sets of parts, as `sets_of_order` has them.
    hold : int
        Most parts held at once.
    """
    present, found = search.whole, []
    for moved in reversed(order):
        found.append(_judged(search, moved, present, hold))
        present &= ~moved
        search.visited += 1
    return found


def _judged(search: OrderSearch, moved: int, present: int, hold: int) -> Removed:
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
            fails.append(f"{some_names(state.moving)} would fall before it{held}")
    if search.pressing is not None and legs and not fails:
        pressed = next(search.pressed(search.pressing, moved, legs, present, hold), None)
        if pressed is not None:
            return pressed
        fails.append("the standing parts do not withstand the pressing force")
    return Removed(parts, legs or (), state, needs, tuple(fails))
