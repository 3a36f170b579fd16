"""Clusters of an assembly: sets of free parts that touch each other.

Parts of different clusters do not touch, and their energies add up, so clusters move independently
of each other. Hence the assembly is at a minimum iff each cluster is, and a path that leads a
cluster down leads the assembly down.
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
"""States in order of precedence: an assembly has the first state that any of its clusters has."""


@dataclass(frozen=True, slots=True, eq=False)
class Cluster:
    """Program in which only the parts of a cluster are free, and the indices of its rows.

    `rows`, shape (k,): indices of its rows in the program of the assembly.
    """

    program: Program
    rows: Index


def clusters(program: Program) -> list[Cluster]:
    """Divide a program into clusters (sets of free parts that touch), ordered by first part.

    Rows between held parts belong to no cluster.
    """
    free = np.append(program.free, False)
    inner = free[program.part_a] & free[program.part_b]
    count = len(program.names)
    label = connected(count, program.part_a[inner], program.part_b[inner])
    label = np.append(np.where(program.free, label, -1), -1)
    of_row = np.maximum(label[program.part_a], label[program.part_b])
    numbers = np.unique(label[:-1][program.free])
    if len(numbers) == 1 and (of_row >= 0).all():
        return [Cluster(program, np.arange(len(of_row)))]
    order = np.argsort(of_row, kind="stable")[int((of_row < 0).sum()) :]
    start = starts(np.bincount(of_row[of_row >= 0], minlength=count))
    parted = []
    for number in numbers.tolist():
        rows = order[start[number] : start[number + 1]]
        parted.append(Cluster(replace(program, free=label[:-1] == number).taking(rows), rows))
    return parted


def joined_state(states: Iterable[State]) -> State:
    """State of an assembly (minimum, free, balanced, open) from the states of its clusters.

    Examples
    --------
    >>> joined_state(["minimum", "balanced", "open"])
    'balanced'
    """
    given = set(states)
    return next(state for state in ORDER if state in given)
