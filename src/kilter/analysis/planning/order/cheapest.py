"""Search for the order of assembly with the fewest parts held at once, or the fewest held steps.

A held step is a step during which a part is held. The fewest parts held at once are found by
repeated searches, each with an additional part held. The fewest held steps are found by a
uniform-cost search, backwards from the whole assembly. It expands the set with the fewest held
steps first, then the set with the fewest remaining parts. The holds of a set do not depend on the
removals before, so each set is expanded once. The first complete order then has the fewest held
steps among all orders along the tried paths.

Removals are generated singly: after each removal the set is queued again behind its successors.
Branches that cannot have fewer held steps than the best known order are skipped. If no other
branch remains, that order has the fewest held steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from kilter.analysis.planning.order.search import OrderSearch, Removed

__all__ = ["Searched", "find_fewest_held_steps", "find_order", "held_steps_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """Result of a search for an order of assembly."""

    order: list[Removed] | None
    """Removals, the last step of the assembly first; None without an order."""
    least: int = 0
    """Value of the minimized quantity."""
    proved: bool = False
    """Whether no order along the tried paths has a smaller value."""
    interrupted: bool = False
    """Whether the user interrupted the search."""


def find_order(search: OrderSearch, lowest: int, most: int, fewest: str) -> Searched:
    """Find an order of assembly that minimises held parts or held steps, by the option `fewest`.

    Arguments: `lowest`, `most`: first and last limit of the parts held at once; fewer than `lowest`
    are proved impossible.
    """
    order, hold = None, lowest
    try:
        for hold in range(lowest, most + 1):
            search.work.stage(f"an order with up to {hold} held parts")
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
    """A set of parts that the search reached, with its cost, last removal and previous set."""

    present: int
    cost: int
    removals: Iterator[Removed]
    last: Removed | None = None
    before: _Reached | None = None

    @property
    def order(self) -> list[Removed]:
        """Removals that lead from the whole assembly to this set."""
        removals, node = [], self
        while node.last is not None and node.before is not None:
            removals.append(node.last)
            node = node.before
        return removals[::-1]


def held_steps_of(search: OrderSearch, order: Sequence[Removed]) -> int:
    """Number of steps of an order during which a part beside the grounded parts is held."""
    return sum(_holds(search, removed) for removed in order)


def find_fewest_held_steps(
    search: OrderSearch, hold: int, known: Sequence[Removed]
) -> tuple[list[Removed], bool]:
    """Find the order with the fewest held steps, and whether the minimum is proved."""
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
            if search.work.over:  # the removals that are left were not tried
                return best, False
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


def _holds(search: OrderSearch, removed: Removed) -> bool:
    """Whether a part other than the grounded parts is held during a removal."""
    return removed.held > search.base.bit_count()
