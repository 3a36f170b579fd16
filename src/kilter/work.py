"""How much work a question may cost, counted and not timed, and words of progress meanwhile.

One `Work` is handed from the question down to the steps of its answer; a step that may take
only a fraction gets a share of it. Every solver call and every factorisation is *charged* by
what it did: iterations times entries of its matrix, entries of its factors. A unit is about
half a microsecond of one core, but no clock is read: the same question costs the same on
every machine, however busy, and so ends with the same answer.

A time limit may be set beside it. It is the only thing here that looks at a clock, none is
set by default, and what it cuts short says so (`Work.late`).

What runs out decides when a search *ends*, never what it says: what is left is open.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite
from time import perf_counter

from kilter.arrays import TINY

__all__ = ["EFFORT", "PER_EFFORT", "Work", "units_of"]

EFFORT = 1.0
"""Of every search, where none is given."""
PER_EFFORT = 1_000_000
"""Units of one effort: about half a second of one core."""
STEP = 10.0
"""By what the work of a further effort is more than that of the last."""
MOST = 12.0
"""An effort above this is no more work: it would take years."""
BETWEEN_WORDS = 1.0
"""Least time between two words of `Work.tell` [s]."""
LEAST = 1e-3
"""What a solver is given at least, where a time limit is set [s]."""

# Units of what is done, fitted to measured times on scenes of 4 to 800 contact points.
CONIC, CONIC_ENTRY = 350.0, 0.25
"""Of a conic program, and of an entry of its matrix in one iteration."""
SEMIDEFINITE, SEMIDEFINITE_ENTRY = 2000.0, 2.0
"""Of a semidefinite program, and of an entry of its rows in one iteration."""
LOADED, LOADED_ENTRY = 700.0, 0.2
"""Of a linear program made and handed over, and of an entry of it."""
LINEAR, LINEAR_ENTRY = 1000.0, 0.012
"""Of a linear program solved, and of an entry of its matrix in one step of the simplex."""
DENSE, DENSE_ENTRY, DENSE_WIDE = 60.0, 0.02, 250.0
"""Of a full system solved, of an entry of it; one of so many unknowns costs twice that."""
SPARSE, SPARSE_ENTRY, SPARSE_WIDE = 500.0, 0.3, 200.0
"""Of a sparse system factorised, of an entry of the factors; the same."""
BAND, BAND_POINT, BAND_ENTRY = 150.0, 0.5, 0.01
"""Of a band system solved, of a point of it, and of an entry of the band."""
JUDGED, JUDGED_POINT = 1000.0, 6.0
"""Of a candidate held against the contact law, and of a point of it."""
WEIGHED, WEIGHED_POINT = 150.0, 0.6
"""Of a candidate of which it is told cheaply whether that is worth it, and of a point of it."""


def units_of(effort: float) -> float:
    """Units of an effort: none for 0, `PER_EFFORT` for 1, and ten times more for each further.

    Examples
    --------
    >>> [units_of(effort) / units_of(1) for effort in (0, 1, 2, 3)]
    [0.0, 1.0, 11.0, 111.0]
    """
    return PER_EFFORT * float(STEP ** min(effort, MOST) - 1.0) / (STEP - 1.0)


@dataclass(slots=True)
class _Clock:
    """When it has to end [s], whether that cut anything short, and when a word was last said."""

    deadline: float
    said: float
    cut: bool = False


class Work:
    """Work that a question may take.

    Parameters
    ----------
    allowed : float
        Units; infinite where not given.
    progress : callable, optional
        Called with words of progress.
    time_limit : float, optional
        Seconds from now on, after which it is over whatever is left.

    Examples
    --------
    >>> work = Work(1000.0)
    >>> half = work.until(0.5)
    >>> half.charge(600.0)
    >>> work.spent, half.over, work.over
    (600.0, True, False)
    >>> work.fraction_left(0.5).left
    200.0
    """

    __slots__ = ("_clock", "_count", "_from", "_progress", "allowed")

    def __init__(
        self,
        allowed: float = inf,
        progress: Callable[[str], None] | None = None,
        *,
        time_limit: float | None = None,
    ) -> None:
        self.allowed = allowed
        self._progress = progress
        self._count = [0.0]  # shared with the shares
        self._from = 0.0
        now = perf_counter()
        self._clock = _Clock(inf if time_limit is None else now + time_limit, now)

    @classmethod
    def of(cls, given: Work | float) -> Work:
        """Some work as it is, or that of an effort."""
        return given if isinstance(given, Work) else cls(units_of(given))

    @property
    def spent(self) -> float:
        """Units charged since it began, also by its shares."""
        return self._count[0] - self._from

    @property
    def left(self) -> float:
        """Units left."""
        return max(self.allowed - self.spent, 0.0)

    @property
    def late(self) -> bool:
        """Whether the time limit is met, so that who asks ends here: once late, always late."""
        if isfinite(self._clock.deadline) and perf_counter() >= self._clock.deadline:
            self._clock.cut = True
        return self._clock.cut

    @property
    def cut(self) -> bool:
        """Whether anything was ended by the time limit."""
        return self._clock.cut

    @property
    def over(self) -> bool:
        """Whether nothing is left, or the time limit was met."""
        return self.spent >= self.allowed or self.late

    @property
    def seconds(self) -> float | None:
        """What a solver may take [s]; None where no time limit is set."""
        deadline = self._clock.deadline
        return max(deadline - perf_counter(), LEAST) if isfinite(deadline) else None

    def charge(self, units: float) -> None:
        """Count units of work."""
        self._count[0] += units

    def conic(self, iterations: int, entries: int) -> None:
        """Count a conic program."""
        self.charge(CONIC + CONIC_ENTRY * iterations * entries)

    def semidefinite(self, iterations: int, entries: int) -> None:
        """Count a semidefinite program."""
        self.charge(SEMIDEFINITE + SEMIDEFINITE_ENTRY * iterations * entries)

    def loaded(self, entries: int) -> None:
        """Count a linear program that was made and handed over."""
        self.charge(LOADED + LOADED_ENTRY * entries)

    def linear(self, steps: int, entries: int) -> None:
        """Count a linear program that was solved."""
        self.charge(LINEAR + LINEAR_ENTRY * steps * entries)

    def steps(self, most: int, entries: int) -> int:
        """Steps of the simplex that are left, at least one, of `most`."""
        return int(min(most, max(self.left / max(LINEAR_ENTRY * entries, TINY), 1.0)))

    def dense(self, unknowns: int) -> None:
        """Count a full system that was solved."""
        self.charge(DENSE + DENSE_ENTRY * unknowns**2 * (1.0 + unknowns / DENSE_WIDE))

    def sparse(self, unknowns: int, entries: int) -> None:
        """Count a sparse system that was factorised, with entries of its factors."""
        self.charge(SPARSE + SPARSE_ENTRY * entries * (1.0 + entries / unknowns / SPARSE_WIDE))

    def band(self, unknowns: int, width: int, points: int) -> None:
        """Count a band system that was made from its points and solved."""
        self.charge(BAND + BAND_POINT * points + BAND_ENTRY * unknowns * width * (1 + width / 30))

    def judged(self, points: int) -> None:
        """Count a candidate that was held against the contact law."""
        self.charge(JUDGED + JUDGED_POINT * points)

    def weighed(self, points: int) -> None:
        """Count a candidate of which it was told whether it is worth being judged."""
        self.charge(WEIGHED + WEIGHED_POINT * points)

    def until(self, fraction: float) -> Work:
        """The share that is over when this fraction of the whole is spent."""
        return self._share(fraction * self.allowed if fraction else 0.0, self._from)

    def fraction_left(self, fraction: float) -> Work:
        """A share, from now on, of this fraction of what is left."""
        return self._share(fraction * self.left if fraction else 0.0, self._count[0])

    def beside(self, allowed: float = inf) -> Work:
        """Work of its own, that of this one left as it is, under the same time limit."""
        part = Work(allowed, self._progress)
        part._clock = self._clock
        return part

    def _share(self, allowed: float, since: float) -> Work:
        part = self.beside(allowed)
        part._count, part._from = self._count, since
        return part

    def stage(self, word: str) -> None:
        """Say what begins now."""
        if self._progress is not None:
            self._progress(word)

    def tell(self, word: str) -> None:
        """Say how far it is, if the last word is `BETWEEN_WORDS` ago."""
        now = perf_counter()
        if self._progress is not None and now - self._clock.said >= BETWEEN_WORDS:
            self._clock.said = now
            self._progress(word)
