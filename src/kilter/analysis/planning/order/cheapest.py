"""The order with the fewest parts held at once, or the fewest steps during which one is held.

For the first, one search after the other, with one part more held in each. For the second a
uniform-cost search, backwards: of the sets of parts that are reached from the whole, the one with
the fewest held steps so far goes on first; of several the one with the fewest parts left. How many
must be held in a set does not depend on how it was reached, so a set is gone on from once, and the
first order that is complete has the fewest held steps among all that the ways tried allow.

A set is not opened all at once: its removals are drawn one by one, and it waits for its next turn
behind the sets that came of it. What cannot have fewer held steps than an order that is known is
left out; where nothing else is left, that order has the fewest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from kilter.analysis.planning.order.search import OrderSearch, Removed

__all__ = ["FEWEST", "Searched", "find_fewest_held_steps", "find_order", "held_steps_of"]

FEWEST = ("holds", "held-steps", "turns")
"""What there may be least of."""


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """What a search came to.

    Attributes
    ----------
    order : list of Removed or None
        The removals, backwards.
    least : int
        How many it has of what there was to be least of.
    proved : bool
        Whether all that were tried have no fewer.
    interrupted : bool
    """

    order: list[Removed] | None
    least: int = 0
    proved: bool = False
    interrupted: bool = False


def find_order(search: OrderSearch, lowest: int, most: int, fewest: str) -> Searched:
    """The order with the fewest of `fewest` that was found.

    Parameters
    ----------
    search : OrderSearch
    lowest, most : int
        Most parts held at once: where it starts, since less is proved not to be enough, and ends.
    fewest : {"holds", "held-steps"}
    """
    order, hold = None, lowest
    try:
        for hold in range(lowest, most + 1):
            search.work.stage(f"an order with up to {hold} held")
            order = search.find(hold)
            if order is not None or search.work.over:
                break
        if order is None or fewest == "holds":
            return Searched(order, hold, proved=order is not None)
        search.work.stage("an order with fewer held steps")
        order, proved = find_fewest_held_steps(search, most, order)
        return Searched(order, held_steps_of(search, order), proved)
    except KeyboardInterrupt:
        search.exhausted = False
        return Searched(order, hold, interrupted=True)


@dataclass(frozen=True, slots=True, eq=False)
class _Reached:
    """A set of parts, the removal that led to it and the set before."""

    present: int
    cost: int
    removals: Iterator[Removed]
    last: Removed | None = None
    before: _Reached | None = None

    @property
    def order(self) -> list[Removed]:
        """The removals that led here."""
        found, one = [], self
        while one.last is not None and one.before is not None:
            found.append(one.last)
            one = one.before
        return found[::-1]


def held_steps_of(search: OrderSearch, order: Sequence[Removed]) -> int:
    """Steps of an order during which a part is held, beside the grounded ones."""
    return sum(_holds(search, one) for one in order)


def find_fewest_held_steps(
    search: OrderSearch, hold: int, known: Sequence[Removed]
) -> tuple[list[Removed], bool]:
    """The order with the fewest held steps, and whether none of those tried has fewer.

    Parameters
    ----------
    search : OrderSearch
    hold : int
        Most parts held at once.
    known : sequence of Removed
        An order to do better than.
    """
    best = list(known)
    limit = held_steps_of(search, best)
    if limit == 0:
        return best, True
    start = _Reached(search.whole, 0, search.removals(search.whole, 0, hold))
    waiting, count = [(0, search.whole.bit_count(), 0, start)], 0
    seen = {search.whole: 0}
    while waiting:
        cost, _, _, node = waiting[0]
        if node.present == search.base:
            return node.order, True
        if search.work.over:
            return best, False
        if seen[node.present] < cost:
            heappop(waiting)
            continue
        taken = next(node.removals, None)
        if taken is None:
            heappop(waiting)
            continue
        rest, after = node.present & ~taken.set, cost + _holds(search, taken)
        if after >= seen.get(rest, after + 1) or after >= limit:
            continue
        seen[rest] = after
        count += 1
        following = search.removals(rest, taken.set, hold)
        reached = _Reached(rest, after, following, taken, node)
        heappush(waiting, (after, rest.bit_count(), count, reached))
    return best, True


def _holds(search: OrderSearch, one: Removed) -> bool:
    """Whether a part is held while others leave."""
    return one.held > search.base.bit_count()
