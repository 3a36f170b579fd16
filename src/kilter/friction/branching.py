"""Branch and bound over the contact modes (open, stick, slide), for the search and the proof.

A contact point is in one of three modes. With u the relative acceleration of part b past part a
there, f the force on b, n along the normal (from a to b) and t across it:

    OPEN        f = 0,    u_n >= 0                  the point separates, or touches without force
    STICKING    u = 0,    |f_t| <= mu f_n
    SLIDING     u_n = 0,  f_t = -mu f_n u_t / |u_t|

Every solution of Coulomb's law puts every point into at least one mode. A *case* is a set of
solutions: modes, or sets of modes, of some points, with a sector of directions for the sliding
points. Its relaxation is an upper bound of the power w.a of all motions in it. A case without power
is closed. The open case of the greatest promise is divided next, into cases that cover it.

The callers define the cases, their bounds and their division: `kilter.friction.mode_search` looks
for motions and closes cases freely; `kilter.friction.exclusion_cases` proves that no motion exists,
and closes them by proved bounds.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable, Iterator
from enum import IntEnum
from typing import Generic, TypeVar

Question = TypeVar("Question")
Case = TypeVar("Case")


class Mode(IntEnum):
    """Mode of a contact point: open, sticking or sliding; UNDECIDED if a case allows all three."""

    UNDECIDED = 0
    OPEN = 1
    STICKING = 2
    SLIDING = 3


class CaseTree(Generic[Question, Case]):
    """Unfinished cases of a branch and bound over contact modes, ordered by priority.

    Arguments: `bound`: None at the root) to the bounded case, or None if it is closed.

    - `nodes`: number of questions that were bounded.
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
        """Number of open cases in the tree."""
        return len(self._heap)

    @property
    def best(self) -> Case | None:
        """The open case with the greatest priority; None if all cases are closed."""
        return self._heap[0][2] if self._heap else None

    def explore(
        self,
        root: Question,
        *,
        enough: Callable[[Case], bool] | None = None,
        most: float = math.inf,
    ) -> Iterator[Case]:
        """Bound the first case, then repeatedly divide the open case of highest priority.

        Yields every open case when it is bounded.

        Arguments: `enough`: if it returns true for the most promising case, the search ends before
        that case is divided, and the case stays open.
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
