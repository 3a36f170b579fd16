"""Proof, by all sets of parts, that no order with at most K held parts exists for any paths.

Single parts are removed from the whole assembly, regardless of their paths. The remaining set must
keep the precedence, stay connected with the base and not be refused. A set is refused if no K of
its parts hit all of its motions (`kilter.analysis.planning.states.holds`), so that more than K
parts must be held. Every order with at most K held parts, read backwards, is such a chain of sets.
If no chain reaches the base, no order exists. The motions of the refused sets are the proof.

The proof covers orders that insert single parts under a fixed direction of gravity.
"""

from __future__ import annotations

from collections.abc import Callable

from kilter.analysis.planning.order.search import OrderSearch
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.part_sets import bits_of
from kilter.analysis.planning.states.state import State
from kilter.analysis.smallest_set import least_hitting_set

__all__ = ["MOST_SETS", "find_refused", "leads_nowhere"]

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
