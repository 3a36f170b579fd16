"""Branch and bound over contact modes, and in space over sectors of sliding.

Every case is a linear program whose optimum bounds the power of all motions in it (from
above: the relaxation contains them), and the bound is proved apart from the solver. A case
is closed when the power in it is nothing; if all are, no motion can start. The case with the
greatest power is divided first, so that the greatest open power falls, and a relaxed motion
that obeys the law, which ends the search, is met early.

A sector of half width h lets the friction turn by h: near a limit of sliding, cases of
relative width about 1 - cos h stay open however many are tried.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import count

import numpy as np

from kilter.arrays import Array
from kilter.friction.contact_modes import Breach, breach, cases
from kilter.friction.contraction import Search, power_bound
from kilter.friction.enclosure import Enclosure, rescaled

__all__ = ["Branched", "branch"]


OBEYS = 1e-9
"""A relaxed motion that gains less than this part of its power beyond the law obeys it."""
AGAIN = 0.5
"""A power below this part of the scale is bounded again, at its own scale."""
MOST = 200_000
"""Open cases that are kept."""


@dataclass(frozen=True, slots=True, eq=False)
class Branched:
    """How the search ended.

    Attributes
    ----------
    power : float
        Greatest power w.a that is not excluded; at most the tolerance where all is closed.
    nodes : int
        Cases that were bounded.
    motion : ndarray or None
        The relaxed a of the case with the greatest power.
    ended : bool
        Whether more time would change nothing: all is closed, or that motion obeys the law.
    """

    power: float
    nodes: int
    motion: Array | None
    ended: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Case:
    """A case that is open: `bounds` in units of what its power leaves, `motion` a."""

    bounds: Enclosure
    power: float
    where: Breach
    obeys: bool
    motion: Array | None
    basis: object


def branch(search: Search, bounds: Enclosure, until: float = np.inf) -> Branched:
    """Divide the solutions within the bounds until every case is closed.

    Stops at `until` [s of the clock], at the end of the budget, at a relaxed motion that
    obeys the law, and where nothing is left to divide.
    """
    number, nodes = count(), 1
    heap: list[tuple[float, int, _Case]] = []
    _push(heap, next(number), _bounded(search, bounds, None))
    while heap:
        _, _, case = heap[0]
        late = search.clock.over or search.clock.spent > until or len(heap) > MOST
        if case.obeys or late or case.where.largest <= 0.0:
            return Branched(case.power, nodes, case.motion, not late)
        heapq.heappop(heap)
        for child in cases(search.law, case.bounds, case.where):
            nodes += 1
            _push(heap, next(number), _bounded(search, child, case))
        search.clock.tell(f"{nodes} cases, {len(heap)} open, power up to {case.power:.1e}")
    return Branched(search.tolerance, nodes, None, True)


def _push(heap: list[tuple[float, int, _Case]], number: int, case: _Case | None) -> None:
    if case is not None:
        heapq.heappush(heap, (-case.power, number, case))


def _bounded(search: Search, bounds: Enclosure, parent: _Case | None) -> _Case | None:
    """A case with its greatest power; None if it is closed."""
    relaxation = search.relaxation
    basis = parent.basis if parent is not None else None
    while True:
        bounds, power, answer = power_bound(search, bounds, basis)
        if search.closed(bounds, power):
            return None
        old, bounds, basis = bounds, rescaled(relaxation.reach, bounds, power), answer.basis
        if power >= AGAIN * old.scale or search.clock.over:
            break
    worth = old.scale * power
    worth = min(worth, parent.power) if parent is not None else worth
    if not len(answer.x):
        return _Case(bounds, worth, Breach(-1, -1, 0.0, np.inf), False, None, basis)
    where = breach(search.law, relaxation, old, answer.x)
    motion = old.scale * answer.x[relaxation.columns["motion"]]
    return _Case(bounds, worth, where, where.total <= OBEYS * power, motion, basis)
