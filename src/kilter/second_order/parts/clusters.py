"""An assembly as clusters: free parts that contacts join, each with what is held for it.

Parts of different clusters do not touch, and their energies add up: near the place, what one
cluster may do does not depend on the others. So it is a minimum iff each cluster is at one, and
a path of one that leads down leads the assembly down.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.arrays import Index, connected, starts
from kilter.mechanics.program import Program

__all__ = ["Cluster", "State", "clusters", "joined_state"]

State = Literal["minimum", "free", "balanced", "open"]
ORDER: tuple[State, ...] = ("balanced", "open", "free", "minimum")
"""Of the states of clusters, the first that one of them has is that of all."""


@dataclass(frozen=True, slots=True, eq=False)
class Cluster:
    """All parts, of which only those of the cluster are free, with their rows.

    `rows`, shape (k,): their places in the whole program.
    """

    program: Program
    rows: Index


def clusters(program: Program) -> list[Cluster]:
    """By their first parts. Rows between held parts are in none."""
    free = np.append(program.free, False)
    inner = free[program.part_a] & free[program.part_b]
    count = len(program.names)
    label = connected(count, program.part_a[inner], program.part_b[inner])
    label = np.append(np.where(program.free, label, -1), -1)
    own = np.maximum(label[program.part_a], label[program.part_b])
    numbers = np.unique(label[:-1][program.free])
    if len(numbers) == 1 and (own >= 0).all():
        return [Cluster(program, np.arange(len(own)))]
    order = np.argsort(own, kind="stable")[int((own < 0).sum()) :]
    start = starts(np.bincount(own[own >= 0], minlength=count))
    found = []
    for one in numbers.tolist():
        rows = order[start[one] : start[one + 1]]
        found.append(Cluster(replace(program, free=label[:-1] == one).taking(rows), rows))
    return found


def joined_state(states: Iterable[State]) -> State:
    """The state of an assembly from those of its clusters.

    Examples
    --------
    >>> joined_state(["minimum", "balanced", "open"])
    'balanced'
    """
    given = set(states)
    return next(one for one in ORDER if one in given)
