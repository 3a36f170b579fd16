"""State of an assembly from the states of its clusters (`kilter.mechanics.clusters`).

The energies of clusters add up. Hence the assembly is at a minimum iff each cluster is, and a path
that leads a cluster down leads the assembly down.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

import numpy as np

from kilter.mechanics.clusters import Cluster, clusters
from kilter.mechanics.program import Program

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


def falling_alone(program: Program, names: Iterable[str]) -> Cluster | None:
    """Part of a cluster in which only the named parts are free; None if they are no cluster."""
    wanted = set(names)
    chosen = np.array([name in wanted for name in program.names]) & program.free
    if not chosen.any() or int(chosen.sum()) != len(wanted):
        return None
    parted = clusters(replace(program, free=chosen))
    return parted[0] if len(parted) == 1 else None
