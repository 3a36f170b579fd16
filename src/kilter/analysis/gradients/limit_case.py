"""Cases of a limit: solved programs of which the least, or the greatest, is the limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.analysis.gradients.limit_power import SolvedLimit
from kilter.analysis.gradients.refined_limit import RefinedLimit, is_large, refine_limit
from kilter.arrays import TINY, Array

LimitWord = Literal["tilt", "friction", "load factor", "least load factor", "push", "load"]
TURNS = 20
"""Largest number of turns of a direction toward that which its motion gives."""
SAME_TURN = 1e-12
"""Change of a direction that is rounding [-]."""
SETTLED = 1e-8
"""Change of a direction below which its derivatives are those of the least direction [-]."""
LEAP = 0.2
"""Largest step of an extrapolated direction [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitCase:
    """A limit that is solved, and its refined solution if the equations could be solved."""

    solved: SolvedLimit
    refined: RefinedLimit | None
    """None: the equations are too many, or have no solution."""
    solvable: bool
    """Whether the equations are too many, or solved: else the solution has too few digits."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitCases:
    """The cases of a limit: its value is the least of theirs, times `sign`."""

    of: str
    value: float
    """The limit in its unit."""
    unit: str
    """"deg", "-", "N", "g" or "kg"."""
    sign: float
    """-1 for a limit from below, whose cases are limits of the opposite number."""
    cases: tuple[LimitCase, ...]
    copied: bool
    """Whether other parts, equal to these, have the same limit."""
    turned: Callable[[float], LimitCase | None] | None = None
    """The limit of a tilt at an angle across gravity [rad], if all directions may have the limit:
    then the cases are at even angles."""


def refined_case(solved: SolvedLimit) -> LimitCase:
    """A solved limit, with its forces and motion to rounding if the equations have a solution."""
    refined = refine_limit(solved)
    if refined is None:
        return LimitCase(solved, None, is_large(solved))
    return LimitCase(refined.solved, refined, True)


def least_direction(
    solved: SolvedLimit,
    start: Array,
    sought: Callable[[SolvedLimit], Array],
    aimed: Callable[[SolvedLimit, Array], SolvedLimit],
) -> LimitCase:
    """Refine a limit, and turn its load toward the direction in which the limit is least.

    The turns converge slowly if the limit hardly depends on the direction. So each step
    extrapolates from the last two (Anderson's mixing). A direction that does not settle has no
    refined solution, since derivatives at another direction differ.

    Parameters
    ----------
    solved : SolvedLimit
        The limit with its load in the direction `start`, unit vector, shape (3,).
    sought : callable
        Returns the direction that the motion of a limit gives, unit vector, shape (3,).
    aimed : callable
        Returns a limit with its load in another direction.

    References
    ----------
    D. G. Anderson, Iterative procedures for nonlinear integral equations, Journal of the ACM 12,
    1965.
    """
    case, at, before = refined_case(solved), start, None
    for _ in range(TURNS):
        if case.refined is None:
            return case
        goal = sought(case.solved)
        change = goal - at
        if float(np.abs(change).max()) <= SAME_TURN:
            return case
        following = goal if before is None else _mixed(goal, change, *before)
        before = goal, change
        new = refined_case(aimed(case.solved, following))
        if new.refined is None:
            break
        case, at = new, following
    settled = float(np.abs(sought(case.solved) - at).max()) <= SETTLED
    return case if settled else LimitCase(case.solved, None, False)


def _mixed(goal: Array, change: Array, old_goal: Array, old_change: Array) -> Array:
    """Direction at which the change vanishes, extrapolated from two steps; unit vector."""
    differ = change - old_change
    share = float(differ @ change) / max(float(differ @ differ), TINY)
    mixed = goal - share * (goal - old_goal)
    mixed /= max(float(np.linalg.norm(mixed)), TINY)
    return mixed if float(np.linalg.norm(mixed - goal)) <= LEAP else goal
