"""Work budgets in counted operations, time limits, and progress.

A `Work` object is passed from a public function down to the steps of its computation. A step that
may use only a fraction gets a share. Every solver call and every factorisation is *charged* by
its operations: iterations times entries of its matrix, entries of its factors. A unit is about
half a microsecond of one core, but no clock is read. The same computation costs the same on every
machine, however busy, and therefore ends with the same answer.

A time limit may be set in addition; by default there is none. It is the only part that reads a
clock. An answer that it cuts short reports this (`Work.cut`). `stop_after` limits a whole
computation: every `Work` that is made inside shares its deadline, and a solver call without a
`Work` raises `TimeLimitReached`.

An exhausted budget only decides when a search *ends*. It never decides the answer: whatever was
not searched remains open.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import inf, isfinite
from time import perf_counter

from kilter.errors import TimeLimitReached

EFFORT = 1.0
"""Default effort of every search."""
PER_EFFORT = 1_000_000
"""Units of effort 1: about half a second of one core."""
STEP = 10.0
"""Factor between the additional units of successive efforts [-]."""
MOST = 12.0
"""Largest effort; more would take years of computation."""
BETWEEN_WORDS = 1.0
"""Least time between two messages of `Work.tell` [s]."""
LEAST = 1e-3
"""Least time limit of a solver call under a time limit [s]."""

# Work in units, fitted to measured times on scenes with 4 to 800 contact points.
CONIC, CONIC_ENTRY = 350.0, 0.25
"""Work of a conic program, and in addition for each iteration and matrix entry."""
SEMIDEFINITE, SEMIDEFINITE_ENTRY = 2000.0, 2.0
"""Work of a semidefinite program, and in addition for each iteration and entry."""
LOADED, LOADED_ENTRY = 700.0, 0.2
"""Work of passing a linear program to the solver, and in addition for each matrix entry."""
LINEAR, LINEAR_ENTRY = 1000.0, 0.012
"""Work of solving a linear program, and in addition for each simplex step and entry."""
DENSE, DENSE_ENTRY, DENSE_WIDE = 60.0, 0.02, 250.0
"""Cost of a dense system, per matrix entry; number of unknowns at which an entry costs double."""
SPARSE, SPARSE_ENTRY, SPARSE_WIDE = 500.0, 0.3, 200.0
"""Cost of a sparse factorisation, per factor entry; entries per unknown at which that doubles."""
BAND, BAND_POINT, BAND_ENTRY = 150.0, 0.5, 0.01
"""Work of a band system, for each contact point, and for each entry of the band."""
HALF_BAND_ENTRY, DISSECTED_ENTRY, DISSECTED_WIDE = 0.003, 0.03, 200.0
"""Cost of a symmetric band system, per entry of the band; of a symmetric system by nested
dissection, per entry of its factor, and entries per unknown at which that doubles.
"""
SUBSTITUTED_UNKNOWN, SUBSTITUTED_ENTRY = 0.2, 0.0012
"""Work of a solution with a factor and of a product with its matrix, per unknown and factor entry.
"""
JUDGED, JUDGED_POINT = 1000.0, 6.0
"""Work of a test of a candidate against the contact law, and for each contact point."""
WEIGHED, WEIGHED_POINT = 150.0, 0.6
"""Work of the cheap test before the full test of a candidate, and for each contact point."""


def units_of(effort: float) -> float:
    """Units of work of an effort: 0 for 0, `PER_EFFORT` for 1, about tenfold for each step.

    Examples
    --------
    >>> [units_of(effort) / units_of(1) for effort in (0, 1, 2, 3)]
    [0.0, 1.0, 11.0, 111.0]
    """
    return PER_EFFORT * float(STEP ** min(effort, MOST) - 1.0) / (STEP - 1.0)


@dataclass(slots=True)
class _Clock:
    """Deadlines, and the state of a computation and of all its separate budgets.

    `deadline` and the time of the last progress message `said` are in seconds; `units` of all
    budgets together may reach `most`. `cut` is True once a deadline cut work.
    """

    deadline: float
    said: float
    most: float = inf
    units: float = 0.0
    cut: bool = False


class Work:
    """Work budget of a computation, in counted operations; its steps charge the same budget.

    Parameters
    ----------
    allowed : float
        Units; unlimited by default.
    progress : callable, optional
        Function that is called with each progress message.
    time_limit : float, optional
        Time from now after which the budget is over, whatever is left [s].
    facts : callable, optional
        Function that is called with the subject of each known fact, and the fact.

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

    __slots__ = ("_clock", "_count", "_facts", "_from", "_progress", "allowed")

    def __init__(
        self,
        allowed: float = inf,
        progress: Callable[[str], None] | None = None,
        *,
        time_limit: float | None = None,
        facts: Callable[[str, str], None] | None = None,
    ) -> None:
        self.allowed = allowed
        self._progress, self._facts = progress, facts
        self._count = [0.0]  # a list, so that shares count into the same number
        self._from = 0.0
        now = perf_counter()
        end = inf if time_limit is None else now + time_limit
        self._clock = _Clock(min(end, _DEADLINE.get()), now)

    @classmethod
    def of(cls, given: Work | float) -> Work:
        """Return `given` if it is a `Work`, else make the work budget of that effort."""
        return given if isinstance(given, Work) else cls(units_of(given))

    @property
    def spent(self) -> float:
        """Units of work charged so far, including those of parts of this budget."""
        return self._count[0] - self._from

    @property
    def left(self) -> float:
        """Units of work that are left; 0 if the budget is spent."""
        return max(self.allowed - self.spent, 0.0)

    @property
    def total(self) -> float:
        """Units of work of the whole computation, including separate budgets (`beside`)."""
        return self._clock.units

    @property
    def late(self) -> bool:
        """True if the time limit or the limit of `whole` is reached, from then on for ever."""
        clock = self._clock
        if clock.units >= clock.most or (
            isfinite(clock.deadline) and perf_counter() >= clock.deadline
        ):
            clock.cut = True
        return clock.cut

    @property
    def cut(self) -> bool:
        """True if the time limit, or the limit of `whole`, ended any step of the computation."""
        return self._clock.cut

    @property
    def over(self) -> bool:
        """True if no units of work are left, or the time limit is reached."""
        return self.spent >= self.allowed or self.late

    @property
    def seconds(self) -> float | None:
        """Time left for a solver call [s]; None without a time limit."""
        deadline = self._clock.deadline
        return max(deadline - perf_counter(), LEAST) if isfinite(deadline) else None

    def charge(self, units: float) -> None:
        """Add units of work to those that are spent."""
        self._count[0] += units
        self._clock.units += units

    def conic(self, iterations: int, entries: int) -> None:
        """Charge the work of a solved conic program."""
        self.charge(CONIC + CONIC_ENTRY * iterations * entries)

    def semidefinite(self, iterations: int, entries: int) -> None:
        """Charge the work of a solved semidefinite program."""
        self.charge(SEMIDEFINITE + SEMIDEFINITE_ENTRY * iterations * entries)

    def loaded(self, entries: int) -> None:
        """Charge the work of passing a linear program to the solver."""
        self.charge(LOADED + LOADED_ENTRY * entries)

    def linear(self, steps: int, entries: int) -> None:
        """Charge the work of solving a linear program."""
        self.charge(LINEAR + LINEAR_ENTRY * steps * entries)

    def steps(self, most: int, entries: int) -> int:
        """Number of simplex steps that the remaining units pay for, from 1 to `most`."""
        return int(min(most, max(self.left / max(LINEAR_ENTRY * entries, LINEAR_ENTRY), 1.0)))

    def dense(self, unknowns: int) -> None:
        """Charge the work of a solved dense linear system."""
        self.charge(DENSE + DENSE_ENTRY * unknowns**2 * (1.0 + unknowns / DENSE_WIDE))

    def sparse(self, unknowns: int, entries: int) -> None:
        """Charge a sparse factorisation; `entries` is the number of entries of its factors."""
        self.charge(SPARSE + SPARSE_ENTRY * entries * (1.0 + entries / unknowns / SPARSE_WIDE))

    def band(self, unknowns: int, width: int, points: int) -> None:
        """Charge a band system that was built from contact points and solved."""
        self.charge(BAND + BAND_POINT * points + BAND_ENTRY * unknowns * width * (1 + width / 30))

    def symmetric_band(self, unknowns: int, width: int) -> None:
        """Charge a solved band system with a symmetric positive definite matrix."""
        self.charge(BAND + HALF_BAND_ENTRY * unknowns * width * (1 + width / 30))

    def dissected(self, unknowns: int, entries: int) -> None:
        """Charge a factorisation by nested dissection; `entries` are those of its factor."""
        self.charge(BAND + DISSECTED_ENTRY * entries * (1 + entries / unknowns / DISSECTED_WIDE))

    def substituted(self, unknowns: int, entries: int) -> None:
        """Charge a solution with a factor by nested dissection, and a product with the matrix."""
        self.charge(BAND + SUBSTITUTED_UNKNOWN * unknowns + SUBSTITUTED_ENTRY * entries)

    def judged(self, points: int) -> None:
        """Charge a full check of a candidate motion against the contact law."""
        self.charge(JUDGED + JUDGED_POINT * points)

    def weighed(self, points: int) -> None:
        """Charge a cheap test that decides whether a candidate motion gets the full check."""
        self.charge(WEIGHED + WEIGHED_POINT * points)

    def until(self, fraction: float) -> Work:
        """Share of this budget, until the given fraction of the whole budget is spent."""
        return self._share(fraction * self.allowed if fraction else 0.0, self._from)

    def fraction_left(self, fraction: float) -> Work:
        """Share of this budget: the given fraction of the units that are left now."""
        return self._share(fraction * self.left if fraction else 0.0, self._count[0])

    def beside(self, allowed: float = inf) -> Work:
        """New budget with the same time limit; its charges do not count in this budget."""
        part = Work(allowed, self._progress, facts=self._facts)
        part._clock = self._clock
        return part

    def whole(self, most: float, allowed: float = inf) -> Work:
        """Budget of another computation with the same deadline, which ends as late work ends.

        Parameters
        ----------
        most : float
            Largest `total` of the other computation [units]: all its budgets end there.
        allowed : float
            Units of this budget.
        """
        other = Work(allowed, self._progress)
        other._clock = _Clock(self._clock.deadline, self._clock.said, most)
        return other

    def _share(self, allowed: float, since: float) -> Work:
        part = self.beside(allowed)
        part._count, part._from = self._count, since
        return part

    def stage(self, word: str) -> None:
        """Send a progress message about the stage that begins now."""
        if self._progress is not None:
            self._progress(word)

    def fact(self, subject: str, words: str) -> None:
        """Send a fact about the question of the user that is known before the answer is complete.

        Parameters
        ----------
        subject : str
            Subject of the fact. Of several facts with the same subject, the first counts.
        words : str
            A clause, for instance "forces that hold it exist".
        """
        if self._facts is not None:
            self._facts(subject, words)

    def tell(self, word: str) -> None:
        """Send a progress message, unless the last is more recent than `BETWEEN_WORDS`."""
        now = perf_counter()
        if self._progress is not None and now - self._clock.said >= BETWEEN_WORDS:
            self._clock.said = now
            self._progress(word)


def facts_of(progress: object) -> Callable[[str, str], None] | None:
    """The method `fact` of a progress function, which receives facts; None if it has none."""
    facts: Callable[[str, str], None] | None = getattr(progress, "fact", None)
    return facts


_DEADLINE: ContextVar[float] = ContextVar("deadline", default=inf)


@contextmanager
def stop_after(time_limit: float | None) -> Iterator[None]:
    """Context manager: limit the time of every computation inside [s].

    Arguments: `time_limit` [s]: None changes nothing. Raises `TimeLimitReached` by the first solver
    call without a `Work` after the limit.

    Examples
    --------
    >>> with stop_after(0.0):
    ...     Work().late
    True
    """
    deadline = inf if time_limit is None else perf_counter() + time_limit
    token = _DEADLINE.set(min(deadline, _DEADLINE.get()))
    try:
        yield
    finally:
        _DEADLINE.reset(token)


@contextmanager
def take_at_least(seconds: float) -> Iterator[None]:
    """Context manager: a computation inside may take this time, whatever `stop_after` left [s]."""
    token = _DEADLINE.set(max(perf_counter() + seconds, _DEADLINE.get()))
    try:
        yield
    finally:
        _DEADLINE.reset(token)


def is_late() -> bool:
    """True if the limit of `stop_after` is reached."""
    deadline = _DEADLINE.get()
    return isfinite(deadline) and perf_counter() >= deadline


def stop_if_late() -> None:
    """End a computation that has no `Work`, if the limit of `stop_after` is reached.

    Raises `TimeLimitReached` if the limit is reached.
    """
    if is_late():
        raise TimeLimitReached


def seconds_left(work: Work | None) -> float | None:
    """Time that a solver call may take [s]; None without a limit.

    Raises `TimeLimitReached` if no `Work` is given, which could report the cut, and the limit of
    `stop_after` is reached.
    """
    if work is not None:
        return work.seconds
    deadline = _DEADLINE.get()
    if not isfinite(deadline):
        return None
    stop_if_late()
    return max(deadline - perf_counter(), LEAST)
