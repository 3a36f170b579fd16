"""No order with so many held, whatever the paths: every half-built state that one could pass.

From the whole assembly parts are taken away one by one, each whatever its way, where what is left
keeps the precedence, hangs together with the base and is not refused: it is refused where no K of
its parts have one of each of its motions (`kilter.analysis.planning.states.holds`), so that more
than K must be held. Every order with at most K held, read backwards, is such a chain of sets. Where
none of these chains comes to the base, there is no order; the motions of what was refused are the
proof.

It speaks of single parts, put in one by one, under one gravity.
"""

from __future__ import annotations

from collections.abc import Callable

from kilter.analysis.planning.order.search import OrderSearch
from kilter.analysis.planning.states.holds import Holds, least_hitting_set
from kilter.analysis.planning.states.part_sets import bits_of
from kilter.analysis.planning.states.state import State

__all__ = ["MOST_SETS", "find_refused", "leads_nowhere"]

MOST_SETS = 1000
"""Sets that are gone through; with more nothing is said."""
MOST_MOTIONS = 200
"""Motions that a proof may have; with more there is none."""


def leads_nowhere(whole: int, base: int, goes_on: Callable[[int, int], bool]) -> bool:
    """Whether no chain of single removals leads from the whole to the base.

    Parameters
    ----------
    whole, base : int
        As `kilter.analysis.planning.states.part_sets` has them.
    goes_on : callable
        From a part, and the set without it, to whether it may be taken away so.
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
    """The sets that need more than `hold` held and bar every order; empty where they do not."""
    search.work.stage("whether any paths would do")
    refused: dict[int, Holds[State]] = {}
    holdable = bits_of(search.holdable)

    def goes_on(part: int, rest: int) -> bool:
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
