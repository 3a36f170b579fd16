"""The fewest supports with which an assembly holds, by covers of motions.

    Z = least cover of the motions found;  does the assembly hold with Z?
        yes: Z is the answer          no: another motion, which no support of Z stops

Before it is kept, a motion is sought that fewer supports can stop: others are added while one is
left. The loop ends, since each motion rules out the set that it was found with. That Z holds is
proved by forces, that fewer are not enough by the motions
(`kilter.analysis.planning.states.covers`).
"""

from __future__ import annotations

from dataclasses import dataclass

from kilter.analysis.planning.hold.supported import Supported, SupportedState
from kilter.analysis.planning.states.covers import Shares, least_cover
from kilter.work import Work

__all__ = ["LeastSupports", "Stopping", "find_least_supports"]

JUDGED, FEW = 2000.0, 4
"""Units of work of a set of supports, for each part and so many more."""


@dataclass(frozen=True, slots=True, eq=False)
class Stopping:
    """A motion that one or more supports must stop.

    Attributes
    ----------
    state : SupportedState
        With supports of which none stops it: it falls.
    shares : mapping
        The supports that may stop it, each with its share.
    """

    state: SupportedState
    shares: Shares


@dataclass(frozen=True, slots=True, eq=False)
class LeastSupports:
    """The fewest supports, and why fewer are not enough.

    Attributes
    ----------
    state : SupportedState or None
        With the fewest supports: it holds. None where there are none, or none were found.
    least : int
        Fewer are not enough, that is proved.
    enough : bool or None
        Whether supports were found that hold it; False: all together do not, that is proved.
    motions : tuple of Stopping
    """

    state: SupportedState | None
    least: int
    enough: bool | None
    motions: tuple[Stopping, ...]


def find_least_supports(given: Supported, work: Work, *, most: int | None = None) -> LeastSupports:
    """The fewest of the supports of an assembly with which it holds.

    Parameters
    ----------
    given : Supported
    work : Work
        Where it is over, the best bound so far is told.
    most : int, optional
        More than these are not asked for.
    """
    count = len(given.supports)
    limit = count if most is None else min(most, count)
    motions: list[Stopping] = []
    passed: list[Shares] = []  # sets that are undecided: others are tried first

    def answer(state: SupportedState | None, enough: bool | None) -> LeastSupports:
        sure = least_cover([one.shares for one in motions], limit)
        least = limit + 1 if sure is None else len(sure)
        return LeastSupports(state, least, enough, tuple(motions))

    while True:
        chosen = least_cover([*(one.shares for one in motions), *passed], limit)
        if chosen is None or work.over:
            none = chosen is None and not passed and limit == count
            return answer(None, False if none else None)
        work.tell(f"{len(chosen)} supports")
        state = _judged(given, chosen, work)
        if state.stable:
            return answer(state, True)
        if state.stable is None:
            passed.append({k: 1.0 for k in range(count) if k not in chosen})
        else:
            motions.append(_fewest_that_stop(given, state, work))


def _judged(given: Supported, chosen: frozenset[int], work: Work) -> SupportedState:
    before = given.asked
    state = given.judge(chosen, work)
    work.charge(JUDGED * (given.asked - before) * (FEW + len(given.assembly)))
    return state


def _fewest_that_stop(given: Supported, state: SupportedState, work: Work) -> Stopping:
    """A motion that few supports can stop: half of them added, a quarter, ... while one is left."""
    every = frozenset(range(len(given.supports)))
    found = Stopping(state, given.shares(state))
    needed: set[int] = set()
    size = max(len(found.shares) // 2, 1)
    while (left := sorted(set(found.shares) - needed)) and len(found.shares) > 1:
        size = min(size, max(len(left) // 2, 1))
        other = _judged(given, (every - set(found.shares)) | set(left[:size]), work)
        if other.stable is False:
            found = Stopping(other, given.shares(other))
        elif size == 1:
            needed.add(left[0])
        else:
            size //= 2
    return found
