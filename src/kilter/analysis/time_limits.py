"""Time limit of an analysis over all directions of gravity, with a partial answer on expiry."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from kilter.analysis.check import check
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import TimeLimitReached
from kilter.work import stop_after

__all__ = ["given_direction_known"]

AFTERWARDS = 0.4
"""Time after the limit for the verdict of the given direction of gravity [s]."""


@contextmanager
def given_direction_known(
    assembly: Assembly, contacts: ContactSet, time_limit: float | None
) -> Iterator[None]:
    """Limit the time of an analysis; its error then states the verdict of the given direction.

    Arguments: `time_limit`: time from now [s]; None for no limit. Raises `TimeLimitReached` at the
    limit. `TimeLimitReached.known` has the verdict of the given direction of gravity, if it is
    known or found within the following 0.4 s.
    """
    try:
        with stop_after(time_limit):
            yield
    except TimeLimitReached:
        if time_limit is None:
            raise  # the limit of an outer computation
        verdict = check(
            assembly, contacts=contacts, require="equilibrium", effort=0, time_limit=AFTERWARDS
        )
        level = "" if verdict.level is None else f", level {verdict.level}"
        word = verdict.verdict.replace("-", " ")
        raise TimeLimitReached(f"With gravity as given it is {word}{level}.") from None
