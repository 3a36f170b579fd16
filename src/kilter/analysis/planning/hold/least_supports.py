"""The fewest supports with which an assembly holds, from motions that supports must stop.

The search is that of `kilter.analysis.smallest_set`. A support takes the share 1 of a motion that
it may stop. A vacuum or magnet that the motion with power p pulls off, opening by u, takes F u / p.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.planning.hold.supported import Supported, SupportedState, grips_that_hold
from kilter.analysis.smallest_set import Shares, least_cover, reduced_by_halves
from kilter.tell.levels import holds
from kilter.work import EFFORT, Work, units_of

JUDGED, FEW, JUDGED_ROW = 2000.0, 4, 200.0
"""Units of work to judge a set of supports: for each part, for `FEW` further parts, and for each
row of the program above `LARGE`.
"""
LARGE, MANY = 500, 12
"""Number of rows of a program above which grips that hold are found from least wrenches, and number
of candidates above which they are if open pairs leave the assembly undecided.
"""
SMALLER = 1 / 40
"""Fraction of the work for sets that are smaller than known grips which hold [-]."""
RAISING = 1 / 80
"""Share of the remaining work that the search for a set of a higher level may take [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Stopping:
    """A proved motion of an assembly, and the candidate supports that may stop it."""

    state: SupportedState
    shares: Shares


@dataclass(frozen=True, slots=True, eq=False)
class LeastSupports:
    """The smallest set of supports that holds an assembly, and the proof that fewer do not.

    `enough` is False if all supports together are proved not to hold it; `complete` is False if the
    search reached its work limit.
    """

    state: SupportedState | None
    least: int
    enough: bool | None
    motions: tuple[Stopping, ...]
    complete: bool = True


def find_least_supports(
    given: Supported,
    work: Work,
    *,
    most: int | None = None,
    require: str = "equilibrium",
    effort: float = EFFORT,
) -> LeastSupports:
    """Find the fewest candidate supports with which an assembly reaches the required level.

    Forces of equilibrium and the proof that fewer supports are not enough come first. The first set
    in equilibrium is decided with the effort of a check. If it does not reach the required level,
    sets with a support on a part that may still move are tried within a share of the work
    (`RAISING`). If none of them reaches the level, the first set in equilibrium is the answer.
    """
    count = len(given.supports)
    limit = count if most is None else min(most, count)
    motions: list[Stopping] = []
    passed: list[Shares] = []  # sets that are undecided, or below the level
    lower: SupportedState | None = None  # the first set in equilibrium, below the level

    def answer(state: SupportedState | None, enough: bool | None) -> LeastSupports:
        sure = least_cover([motion.shares for motion in motions], limit)
        least = limit + 1 if sure is None else len(sure)
        return LeastSupports(state, least, enough, tuple(motions), not share.over)

    share = work  # of the current search: for equilibrium, then for the level
    known = _known_to_hold(given, work, limit)  # the next set to judge if no smaller one is left
    smaller = work.fraction_left(SMALLER)
    while True:
        chosen = least_cover([*(motion.shares for motion in motions), *passed], limit)
        enough = chosen is None or (known is not None and len(chosen) >= len(known))
        if known is not None and (enough or smaller.over):
            chosen, known = known, None
        elif chosen is None or share.over:
            if lower is not None:
                return answer(lower, True)
            none = chosen is None and not passed and limit == count
            return answer(None, False if none else None)
        work.tell(f"{len(chosen)} supports")
        state = _judge_supports(given, chosen, work)
        if state.stable:
            known = None
            left = units_of(effort) if lower is None else min(units_of(effort), share.left)
            part = work.beside(left)
            state = given.decide(state, require=require, work=part)
            work.charge(part.spent)
            if state.decision is not None and holds(state.decision.level, require):
                return answer(state, True)
            if lower is None:
                lower, share = state, work.fraction_left(RAISING)
            passed.append(_stops_witness(given, state))
        elif state.stable is None:
            passed.append({k: 1.0 for k in range(count) if k not in chosen})
        else:
            motions.append(_fewest_that_stop(given, state, work))


def _stops_witness(given: Supported, state: SupportedState) -> Shares:
    """Absent supports that may stop a motion that friction does not exclude, with weight 1.

    They are on parts that the motion moves that friction does not exclude.
    """
    others = [k for k in range(len(given.supports)) if k not in state.chosen]
    friction = None if state.decision is None else state.decision.friction
    if state.decision is None or friction is None or friction.witness is None:
        return dict.fromkeys(others, 1.0)
    moves = np.abs(friction.witness.acceleration).max(axis=1) > 0
    names = {n for n, m in zip(state.decision.program.names, moves, strict=True) if m}
    moved = [k for k in others if given.supports[k].part in names]
    return dict.fromkeys(moved or others, 1.0)


def _judge_supports(given: Supported, chosen: frozenset[int], work: Work) -> SupportedState:
    before = given.asked
    state = given.judge(chosen, work)
    work.charge((given.asked - before) * _judging(given))
    return state


def _judging(given: Supported) -> float:
    """Units of work of a judgement of an assembly with some of its supports."""
    rows = max(len(given.whole.part_a) - LARGE, 0)
    return JUDGED * (FEW + len(given.assembly)) + JUDGED_ROW * rows


def _known_to_hold(given: Supported, work: Work, limit: int) -> frozenset[int] | None:
    """Grips that hold, so that no larger set is searched for; None for a small assembly."""
    large = len(given.whole.part_a) > LARGE
    if not large and len(given.supports) <= MANY:
        return None
    alone = _judge_supports(given, frozenset(), work).stable
    if alone or (alone is False and not large):
        return None
    grips = grips_that_hold(given, work, _judging(given))
    return None if grips is None or len(grips) > limit else grips


def _fewest_that_stop(given: Supported, state: SupportedState, work: Work) -> Stopping:
    """Find a motion that as few supports as possible can stop, by adding others."""
    every = frozenset(range(len(given.supports)))
    stopping = Stopping(state, given.shares(state))

    def stopped(members: set[int], added: list[int]) -> set[int] | None:
        nonlocal stopping
        other = _judge_supports(given, (every - members) | set(added), work)
        if other.stable is not False:
            return None
        stopping = Stopping(other, given.shares(other))
        return set(stopping.shares)

    reduced_by_halves(set(stopping.shares), stopped)
    return stopping
