"""Clusters of an assembly: sets of free parts that touch each other.

Parts of different clusters do not touch, so clusters move independently of each other: forces
balance the assembly iff they balance each cluster, and a motion of a cluster is a motion of the
assembly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Index, connected, starts
from kilter.mechanics.program import Program

__all__ = ["PARTED", "Cluster", "cluster_groups", "cluster_labels", "clusters"]

PARTED = 1500
"""Programs with more freedoms than this are solved cluster by cluster."""
GROUP = 300
"""Clusters are solved together up to this many freedoms: a solver run has a fixed cost."""


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
    return _divided(program, cluster_labels(program))


def cluster_groups(program: Program) -> list[Cluster]:
    """Divide a large program into groups of clusters that are solved one after the other.

    The time of a solver grows faster than the size of a program, so the groups are as small as
    the fixed cost of a solver run permits (`GROUP`). A program of at most `PARTED` freedoms, or
    with straps of a capacity, whose pieces pull equally, is a single group.
    """
    per = len(program.freedoms)
    if per * int(program.free.sum()) <= PARTED or program.has_limits:
        return [Cluster(program, np.arange(len(program.part_a)))]
    label = cluster_labels(program)
    numbers, count = np.unique(label[program.free], return_counts=True)
    group_of = np.full(len(label), -1)
    group, size = -1, GROUP
    for number, freedoms in zip(numbers.tolist(), (per * count).tolist(), strict=True):
        if size + freedoms > GROUP:
            group, size = group + 1, 0
        group_of[number] = group
        size += freedoms
    return _divided(program, np.where(label >= 0, group_of[label], -1))


def cluster_labels(program: Program) -> Index:
    """Number of the cluster of each free part, in order of first part, shape (N,); -1 if held."""
    free = np.append(program.free, False)
    inner = free[program.part_a] & free[program.part_b]
    label = connected(len(program.names), program.part_a[inner], program.part_b[inner])
    return np.where(program.free, label, -1)


def _divided(program: Program, label: Index) -> list[Cluster]:
    """Divide a program by the label of each free part; no row joins parts of different labels."""
    count = len(label)
    label = np.append(label, -1)
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
