"""Proof that no order of assembly exists for any paths, because parts block each other.

Let all other parts be fixed. A part p can start a motion y = (dr, dtheta) about its centre of mass
only if no contact is penetrated: J y >= 0. It is locked if y = 0 is the only solution. By Stiemke's
lemma this is true if and only if

    J^T l = 0  for some l > 0,  and J has full rank

Then no path exists, since each path begins with a y other than 0. In floating point, y of norm
1 and J y >= 0 give 0 <= l_k (J y)_k <= y . J^T l <= |J^T l|, so |J y| <= |J^T l| sqrt(K) / min l;
and |J y| is at least the smallest singular value s of J. So p is locked if

    s min l  >  |J^T l| sqrt(K)

which is verified without a solver. A margin excludes locking by rounded normals only.

A part that is not locked among given parts is not locked among fewer. So parts that are not locked
among the set C and the base are removed from C, repeatedly. Each part of the final C is locked by
the others and the base, so none of them can leave first, and none can ever leave. Joints, a nut on
its bolt, and uncertain normals do not count as contacts. A part that can rotate in place is not
locked; this module does not prove that such a part can never leave.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.analysis_tolerances import LOCKS
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.states.holds import mask_of
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array, Mask
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import LinearProgram


@dataclass(frozen=True, slots=True, eq=False)
class Locked:
    """A part that cannot move, because contacts with the other parts and the base block it."""

    part: int
    state: State
    """State in which only this part is free; it holds."""
    multipliers: Array
    """Multipliers of the rows of its program, positive for the locking rows [-], shape (K,)."""


def find_locked(states: States, removal: Removal) -> list[Locked]:
    """Find parts that the others and the base block in every direction; empty without a proof.

    Arguments: `removal`: search of paths, with the screws and the directions that no contact
    blocks.

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
            proofs = [(k, _prove_locked(states, removal, k, present)) for k in core]
            loose = [k for k, locked in proofs if locked is None]
            if not loose:
                return sorted((proof for _, proof in proofs if proof), key=lambda proof: proof.part)
        core = [k for k in core if k not in loose]
    return []


def _prove_locked(states: States, removal: Removal, part: int, present: int) -> Locked | None:
    """Proof that the other present parts block every motion of a part; None without a proof."""
    is_present = mask_of(present, len(states.assembly))
    held = is_present.copy()
    held[part] = False
    state = states.judge(is_present, held)
    rows = holding_rows(state.program, part, removal.threads)
    multipliers = multipliers_of(opening(state.program, part, rows))
    if multipliers is None or not state.stable:
        return None
    all_rows = np.zeros(len(state.program.part_a))
    all_rows[rows] = multipliers
    return Locked(part, state, all_rows)


def holding_rows(program: Program, part: int, threads: frozenset[tuple[int, int]]) -> Mask:
    """Mask, shape (K,), of the certain contacts that may block a part; threads are left out.

    `threads` has pairs of indices of bolt and nut.
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
    """Matrix from a motion of a part to the change of the gap at given rows, shape (k, 6).

    Rotations are scaled by the radius of the part.
    """
    taken = np.flatnonzero(rows)
    lever = program.lever(taken, np.full(len(taken), part))
    sign = np.where(program.part_b[taken] == part, 1.0, -1.0)
    scale = np.repeat([1.0, 1.0 / float(program.radius[part])], 3)
    result: Array = sign[:, None] * lever * scale
    return result


def shuts(rows: Array, multipliers: Array) -> bool:
    """Whether multipliers prove that every motion y != 0 closes a gap: J y < 0 in some row.

    J has shape (K, 6).
    """
    positive = multipliers > 0
    if positive.sum() <= rows.shape[1] or not np.isfinite(multipliers).all():
        return False
    taken, weights = rows[positive], multipliers[positive] / multipliers.max()
    least = float(np.linalg.svd(taken, compute_uv=False)[-1]) * float(weights.min())
    left = float(np.linalg.norm(weights @ taken)) * np.sqrt(len(taken))
    return bool(least > LOCKS and least * LOCKS > left)


def multipliers_of(rows: Array) -> Array | None:
    """Positive multipliers that prove that every motion closes a gap; None without a proof."""
    from kilter.solvers.highs import solve_linear

    count = len(rows)
    if count <= rows.shape[1] or np.linalg.matrix_rank(rows, tol=LOCKS) < rows.shape[1]:
        return None
    zero, ones = np.zeros(rows.shape[1]), np.ones(count)
    program = LinearProgram(ones, csc_array(rows.T), zero, zero, ones, ones / LOCKS)
    answer = solve_linear(program)
    if not answer.found:
        return None
    balanced = answer.x - np.linalg.lstsq(rows.T, rows.T @ answer.x, rcond=None)[0]
    return balanced if (balanced > 0).all() and shuts(rows, balanced) else None
