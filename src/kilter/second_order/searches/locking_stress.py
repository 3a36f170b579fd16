"""Search for a self-stress that excludes every turn of parts on flat faces."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.locked import Faces, LockedTurns, judge_locked, shifts
from kilter.second_order.searches.counted_program import optimum
from kilter.second_order.searches.critical import Critical
from kilter.second_order.searches.curved_energy import blocking_stress
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

__all__ = ["find_locked"]

SHARES = (0.5, 0.1, 0.9, 0.01)
"""Shares of the self-stress that presses at all contacts, tried in turn; the rest excludes turns.
"""


def find_locked(
    problem: Stationary, faces: Faces, critical: Critical, *, work: Work
) -> LockedTurns | None:
    """Search for a proof that neutral motions are shifts or locked turns; None without one."""
    if not faces.flat.all() or not critical.carries.all() or problem.rows.shape[1] % 6:
        return None
    free, across = shifts(problem)
    if not free.shape[1] or not across.shape[1]:
        return None
    most, all_round = blocking_stress(problem, across, work=work), _pressing(problem, work)
    if most is None or all_round is None:
        return None
    for share in SHARES:
        proof = LockedTurns(critical.forces, (1 - share) * most + share * all_round)
        if not judge_locked(problem, faces, proof):
            return proof
    return None


def _pressing(problem: Stationary, work: Work) -> Array | None:
    """Self-stress that presses at every contact, shape (K,); None if there is none."""
    count, freedoms = problem.rows.shape
    x = optimum(
        LinearProgram(
            np.append(np.zeros(count), -1.0),
            csc_array(
                np.vstack(
                    [
                        np.hstack([problem.rows.T, np.zeros((freedoms, 1))]),
                        np.hstack([np.eye(count), -np.ones((count, 1))]),
                        np.append(np.ones(count), 0.0),
                    ]
                )
            ),
            np.concatenate([np.zeros(freedoms + count), [1.0]]),
            np.concatenate([np.zeros(freedoms), np.full(count, np.inf), [1.0]]),
            np.zeros(count + 1),
            np.full(count + 1, np.inf),
        ),
        work,
    )
    return None if x is None else x[:count]
