"""No order at all, whatever the paths: parts that lock one another.

Let all others be still. A part p can begin to move by y = (dr, dtheta), about its centre of mass,
only where no contact is entered: J y >= 0. It is locked where y = 0 alone does that. By Stiemke's
lemma that is so if and only if

    J^T l = 0  for some l > 0,  and J has full rank

and then no path leads away, since a way out begins with a y that is not 0. With numbers, y of size
1 and J y >= 0 give 0 <= l_k (J y)_k <= y . J^T l <= |J^T l|, so |J y| <= |J^T l| sqrt(K) / min l;
and |J y| is at least the smallest singular value s of J. So it is locked where

    s min l  >  |J^T l| sqrt(K)

which is checked without any solver; a margin is asked for, so that no rounding of normals locks.

A part that is not locked among some parts is not locked among fewer. So what is not locked among
the parts C and the base is taken out of C, again and again. Where some are left, each of them is
locked by the others and the base: none of them leaves before another one does, and so none ever.
Joints do not count, nor a nut on its bolt, nor normals in doubt. A part that can turn on the spot
is not locked, though it may never leave: that is not proved here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.analysis_tolerances import LOCKS
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.states.part_sets import mask_of
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array, Mask
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import LinearProgram

__all__ = ["Locked", "find_locked", "holding_rows", "multipliers_of", "opening", "shuts"]


@dataclass(frozen=True, slots=True, eq=False)
class Locked:
    """A part that nothing lets move.

    Attributes
    ----------
    part : int
    state : State
        The part alone free among those that lock it: it holds.
    multipliers : ndarray, shape (K,)
        Of the rows of its program, above 0 where they lock [-].
    """

    part: int
    state: State
    multipliers: Array


def find_locked(states: States, removal: Removal) -> list[Locked]:
    """Parts each of which is locked by the others and the base; empty where nothing is proved.

    Parameters
    ----------
    states : States
    removal : Removal
        It knows the screws, and directions along which no contact presses.

    Examples
    --------
    >>> from kilter.analysis.planning.states.states import states
    >>> from kilter.scenes import scene
    >>> for name in ("closed-frame", "tower"):
    ...     made = states(scene(name))
    ...     len(find_locked(made, Removal(made.contacts)))
    1
    0
    """
    down = states.assembly.geometry.center @ states.assembly.down
    free = ~states.assembly.geometry.grounded
    core = [k for k in np.argsort(down, kind="stable").tolist() if free[k]]
    base = (1 << len(free)) - 1 - sum(1 << k for k in core)
    while core:
        present = base | sum(1 << k for k in core)
        loose = [k for k in core if removal.lets_go(1 << k, present)]
        if not loose:
            found = [(k, _locked(states, removal, k, present)) for k in core]
            loose = [k for k, locked in found if locked is None]
            if not loose:
                return sorted((one for _, one in found if one), key=lambda one: one.part)
        core = [k for k in core if k not in loose]
    return []


def _locked(states: States, removal: Removal, part: int, present: int) -> Locked | None:
    there = mask_of(present, len(states.assembly))
    held = there.copy()
    held[part] = False
    state = states.judge(there, held)
    rows = holding_rows(state.program, part, removal.threads)
    multipliers = multipliers_of(opening(state.program, part, rows))
    if multipliers is None or not state.stable:
        return None
    all_rows = np.zeros(len(state.program.part_a))
    all_rows[rows] = multipliers
    return Locked(part, state, all_rows)


def holding_rows(program: Program, part: int, threads: frozenset[tuple[int, int]]) -> Mask:
    """Contacts with a part that may lock it, shape (K,): certain ones, over no thread.

    `threads`: bolts and nuts by position, a pair each.
    """
    a, b = program.part_a, program.part_b
    rows = ((a == part) | (b == part)) & (program.kind == CONTACT) & (program.doubt == 0)
    for bolt, nut in threads:
        if part in (bolt, nut):
            other = nut if part == bolt else bolt
            rows &= (a != other) & (b != other)
    locking: Mask = rows
    return locking


def opening(program: Program, part: int, rows: Mask) -> Array:
    """J of some rows on one part, shape (k, 6): how fast they open; turns times its radius."""
    taken = np.flatnonzero(rows)
    lever = program.lever(taken, np.full(len(taken), part))
    sign = np.where(program.part_b[taken] == part, 1.0, -1.0)
    scale = np.repeat([1.0, 1.0 / float(program.radius[part])], 3)
    result: Array = sign[:, None] * lever * scale
    return result


def shuts(rows: Array, multipliers: Array) -> bool:
    """Whether multipliers prove that rows J, shape (K, 6), open by no motion but that of 0."""
    positive = multipliers > 0
    if positive.sum() <= rows.shape[1] or not np.isfinite(multipliers).all():
        return False
    taken, weights = rows[positive], multipliers[positive] / multipliers.max()
    least = float(np.linalg.svd(taken, compute_uv=False)[-1]) * float(weights.min())
    left = float(np.linalg.norm(weights @ taken)) * np.sqrt(len(taken))
    return bool(least > LOCKS and least * LOCKS > left)


def multipliers_of(rows: Array) -> Array | None:
    """Multipliers of rows that prove that nothing opens them; None where there are none."""
    from kilter.solvers.highs import solve_linear

    count = len(rows)
    if count <= rows.shape[1] or np.linalg.matrix_rank(rows, tol=LOCKS) < rows.shape[1]:
        return None
    zero, one = np.zeros(rows.shape[1]), np.ones(count)
    program = LinearProgram(one, csc_array(rows.T), zero, zero, one, one / LOCKS)
    answer = solve_linear(program)
    if not answer.found:
        return None
    balanced = answer.x - np.linalg.lstsq(rows.T, rows.T @ answer.x, rcond=None)[0]
    return balanced if (balanced > 0).all() and shuts(rows, balanced) else None
