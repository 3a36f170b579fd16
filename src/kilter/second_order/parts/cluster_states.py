"""State of an assembly from the states of its clusters (`kilter.mechanics.clusters`).

The energies of clusters add up. Hence the assembly is at a minimum iff each cluster is, and a path
that leads a cluster down leads the assembly down.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

__all__ = ["State", "joined_state"]

State = Literal["minimum", "free", "balanced", "open"]
ORDER: tuple[State, ...] = ("balanced", "open", "free", "minimum")
"""States in order of precedence: an assembly has the first state that any of its clusters has."""


def joined_state(states: Iterable[State]) -> State:
    """State of an assembly (minimum, free, balanced, open) from the states of its clusters.

    Examples
    --------
    >>> joined_state(["minimum", "balanced", "open"])
    'balanced'
    """
    given = set(states)
    return next(state for state in ORDER if state in given)
