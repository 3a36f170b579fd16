"""How much a question may cost, and words of progress while it is asked.

One `Budget` is handed from the question down to the steps of its answer; a step that may
take only a fraction gets a budget of its own. Today a budget is time; whoever wants to count
work in its place changes this file.

A budget decides when a search *ends*, never what it says: what ran out of it is open.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

__all__ = ["Budget"]

LEAST = 1e-2
"""What `Budget.left` gives at least [s], so that a step that has begun can end."""
BETWEEN_WORDS = 1.0
"""Least time between two words of `Budget.tell` [s]."""


class Budget:
    """Time that a question may take, from now on.

    Parameters
    ----------
    seconds : float
        Infinite where not given.
    progress : callable, optional
        Called with words of progress.

    Examples
    --------
    >>> budget = Budget(10.0)
    >>> budget.over, Budget(0.0).over
    (False, True)
    >>> 4.9 < budget.until(0.5).left <= 5.0
    True
    """

    __slots__ = ("_progress", "_said", "_start", "seconds")

    def __init__(
        self, seconds: float = float("inf"), progress: Callable[[str], None] | None = None
    ) -> None:
        self.seconds = seconds
        self._start = perf_counter()
        self._progress = progress
        self._said = [self._start]  # shared with the budgets of the steps

    @classmethod
    def of(cls, given: Budget | float) -> Budget:
        """A budget as it is, or one of some seconds from now on."""
        return given if isinstance(given, Budget) else cls(given)

    @property
    def spent(self) -> float:
        """Seconds since the start."""
        return perf_counter() - self._start

    @property
    def left(self) -> float:
        """Seconds left, at least `LEAST`."""
        return max(self.seconds - self.spent, LEAST)

    @property
    def over(self) -> bool:
        """Whether nothing is left."""
        return self.spent >= self.seconds

    def until(self, fraction: float) -> Budget:
        """The budget that is over when this fraction of the whole is spent."""
        part = Budget(fraction * self.seconds, self._progress)
        part._start, part._said = self._start, self._said
        return part

    def fraction_left(self, fraction: float) -> Budget:
        """A budget, from now on, of this fraction of what is left."""
        part = Budget(fraction * max(self.seconds - self.spent, 0.0), self._progress)
        part._said = self._said
        return part

    def stage(self, word: str) -> None:
        """Say what begins now."""
        if self._progress is not None:
            self._progress(word)

    def tell(self, word: str) -> None:
        """Say how far it is, if the last word is `BETWEEN_WORDS` ago."""
        now = perf_counter()
        if self._progress is not None and now - self._said[0] >= BETWEEN_WORDS:
            self._said[0] = now
            self._progress(word)
