"""One part at a time: the method of Boneschanscher et al. that the paper compares with (2.2).

What the paper says of it (sections 1.1, 2.2): the assembly sits on a table; "the stability of
an assembly was determined one part at a time", the constraints on each part "separated and
satisfied independently"; larger systems are formed "by transforming the contact graph"; if any
subassembly is found unstable, the whole is; it does not work where the contact graph has loops.

So, here, with all held parts as one table:

1. A part that touches one other thing only is judged alone, its neighbour taken as fixed. The
   wrench it passes on is its load, whatever the forces: the graph is transformed by taking it
   away and adding its load to that neighbour. Repeated, this is exact for a tree.
2. Where no such part is left, there are loops: what the parts pass on to each other is not
   determined by one part. Each is then judged alone, its neighbours fixed, under its own load.

A part is judged by a small LP: least t so that its contact forces balance its load to within t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from independent import dense_rows
from scipy.optimize import linprog

from kilter.mechanics.program import Program

__all__ = ["OnePart", "one_part_at_a_time"]

SMALL = 1e-8
"""Balanced: to this part of the load."""


@dataclass(frozen=True)
class OnePart:
    """Result of the method: whether every part is stable, and the parts left in loops."""

    stable: bool
    loops: frozenset[int]


def one_part_at_a_time(program: Program) -> OnePart:
    """The verdict of the method on the contacts of a program."""
    rows = dense_rows(program).reshape(len(program.part_a), -1, 6)
    table = len(program.names)
    ends = np.column_stack([program.part_a, program.part_b])
    ends = np.where(program.free[ends], ends, table)
    load = program.load.copy()
    left = set(np.flatnonzero(program.free).tolist())
    stable = True
    while left:
        touching = {part: _neighbours(ends, part, left | {table}) for part in left}
        ready = [part for part in sorted(left) if len(touching[part]) <= 1]
        if not ready:
            break
        part = ready[0]
        stable &= _balanced(program, rows, ends, part, left | {table}, load[part])
        for neighbour in touching[part] - {table}:
            load[neighbour] += _about(program, part, neighbour, load[part])
        left.remove(part)
    for part in left:
        stable &= _balanced(program, rows, ends, part, left | {table}, load[part])
    return OnePart(stable, frozenset(left))


def _neighbours(ends: np.ndarray, part: int, alive: set[int]) -> set[int]:
    near = {int(b) for a, b in ends if a == part} | {int(a) for a, b in ends if b == part}
    return (near & alive) - {part}


def _about(program: Program, part: int, other: int, wrench: np.ndarray) -> np.ndarray:
    """A wrench about the centre of one part as one about that of another."""
    arm = program.center[part] - program.center[other]
    return np.concatenate([wrench[:3], wrench[3:] + np.cross(arm, wrench[:3])])


def _balanced(
    program: Program,
    rows: np.ndarray,
    ends: np.ndarray,
    part: int,
    alive: set[int],
    load: np.ndarray,
) -> bool:
    """True if contacts with the remaining parts, all fixed, carry the load of a part."""
    here = (ends == part).any(axis=1) & np.isin(ends, list(alive)).all(axis=1)
    scale = np.ones(6)
    scale[3:] = program.radius[part]
    freedoms = program.freedoms
    matrix = (rows[here, part] / scale)[:, freedoms].T
    right = -(load / scale)[freedoms] / np.linalg.norm(load / scale)
    if not matrix.shape[1]:
        return False
    count, width = len(right), matrix.shape[1]
    answer = linprog(
        np.concatenate([np.zeros(width), np.ones(2 * count)]),
        A_eq=np.hstack([matrix, np.eye(count), -np.eye(count)]),
        b_eq=right,
        bounds=(0, None),
        method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert answer.status == 0
    return float(answer.fun) < SMALL
