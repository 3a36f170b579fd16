"""Branch and bound over contact modes: the core that the search and the proof share.

A contact point is in one of three modes. With u the relative acceleration of part b past
part a there, f the force on b, n along the normal (from a to b) and t across it:

    OPEN        f = 0,    u_n >= 0                  the point separates, or touches without force
    STICKING    u = 0,    |f_t| <= mu f_n
    SLIDING     u_n = 0,  f_t = -mu f_n u_t / |u_t|

Every solution of Coulomb's law puts every point into at least one. A *case* is a set of
solutions: modes, or sets of modes, of some points, with a sector of directions for those that
slide; its relaxation bounds the power w.a of all motions in it from above. A case whose power
is nothing is closed. The open case of the greatest promise is divided next, into cases that
cover it.

What a case is, how it is bounded and how it is divided is said by who asks:
`kilter.friction.mode_search` looks for motions and closes cases freely, `kilter.friction.
exclusion_cases` proves that there is none, and closes them by bounds that are proved.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable, Iterator
from enum import IntEnum
from typing import Generic, TypeVar

__all__ = ["CaseTree", "Mode"]

Question = TypeVar("Question")
Case = TypeVar("Case")


class Mode(IntEnum):
    """What a contact point does, or UNDECIDED where a case leaves it to be any of the three."""

    UNDECIDED = 0
    OPEN = 1
    STICKING = 2
    SLIDING = 3


class CaseTree(Generic[Question, Case]):
    """The open cases of a branch and bound, the most promising first.

    Parameters
    ----------
    bound : callable
        Of a question (what is decided) and the case it was divided from (None at the root):
        the case with its bound, or None where it is closed.
    divide : callable
        Of a case: questions that cover it; none where it is not worth dividing.
    promise : callable
        Of a case: what is divided first. Equal promise: the older first.

    Attributes
    ----------
    nodes : int
        Questions that were bounded.
    """

    def __init__(
        self,
        bound: Callable[[Question, Case | None], Case | None],
        divide: Callable[[Case], Iterable[Question]],
        promise: Callable[[Case], float],
    ) -> None:
        self.nodes = 0
        self._bound, self._divide, self._promise = bound, divide, promise
        self._heap: list[tuple[float, int, Case]] = []

    def __len__(self) -> int:
        """How many cases are open."""
        return len(self._heap)

    @property
    def best(self) -> Case | None:
        """The most promising open case; None where all are closed."""
        return self._heap[0][2] if self._heap else None

    def explore(
        self,
        root: Question,
        *,
        enough: Callable[[Case], bool] | None = None,
        most: float = math.inf,
    ) -> Iterator[Case]:
        """Bound the root, then divide the most promising case, and so on.

        Yields every case that is open, when it is bounded.

        Parameters
        ----------
        root : Question
        enough : callable, optional
            Asked of the most promising case before it is divided; if true, the search ends
            and the case stays open.
        most : float
            Nodes after which it ends.
        """
        ready: Iterable[Question] = [root]
        parent: Case | None = None
        while True:
            for question in ready:
                if self.nodes >= most:
                    return
                self.nodes += 1
                case = self._bound(question, parent)
                if case is not None:
                    heapq.heappush(self._heap, (-self._promise(case), self.nodes, case))
                    yield case
            if not self._heap or (enough is not None and enough(self._heap[0][2])):
                return
            parent = heapq.heappop(self._heap)[2]
            ready = self._divide(parent)
