"""Cases of a limit: solved programs of which the least, or the greatest, is the limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.analysis.gradients.limit_power import SolvedLimit
from kilter.analysis.gradients.refined_limit import RefinedLimit, is_large, refine_limit

LimitWord = Literal["tilt", "friction", "load factor", "least load factor", "push", "load"]
TURNS = 20
"""Largest number of turns of a direction toward that which its motion gives."""
SAME_TURN = 1e-12
"""Change of a direction that is rounding [-]."""


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
    """"deg", "-" or "N"."""
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


def least_direction(solved: SolvedLimit, turned: Callable[[SolvedLimit], SolvedLimit]) -> LimitCase:
    """Refine a limit, and turn its load toward the direction in which the limit is least.

    Arguments: `turned`: the limit with the load in the direction that its motion gives.
    """
    case = refined_case(solved)
    for _ in range(TURNS):
        if case.refined is None:
            break
        new = turned(case.solved)
        change = float(np.abs(new.along - case.solved.along).max())
        if change <= SAME_TURN * float(np.abs(new.along).max()):
            break
        following = refined_case(new)
        if following.refined is None:
            break
        case = following
    return case
