"""Linear program for contact forces that depend affinely on the uncertain terms of a load.

The load depends on unknowns d in a box and on a share t,

    b(t, d) = right + t along + sum_k d_k (sides_k + t turns_k),      |d_k| <= 1

Forces that are affine in d, f = f_0 + sum_k d_k f_k, balance the load for every d if

    A f_0 = right + t along,   A f_k = sides_k + t turns_k,   f_0 >= sum_k |f_k|

where the last condition applies to the rows that only push. Forces could also follow d nonlinearly,
so the largest t found here is a safe inner bound, not always the largest possible t.

References
----------
A. Ben-Tal, A. Goryashko, E. Guslitzer, A. Nemirovski, Adjustable robust solutions of uncertain
linear programs, Mathematical Programming 99, 2004 (affinely adjustable counterparts).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csc_array, eye_array, hstack, kron, vstack

from kilter.arrays import Array
from kilter.mechanics.forms import ScaledProblem
from kilter.solvers.problem import LinearProgram

__all__ = ["UncertainLoad", "affine_forces", "affine_imbalance"]


@dataclass(frozen=True, slots=True, eq=False)
class UncertainLoad:
    """A load that depends on uncertain terms within a box, scaled for the equilibrium equations."""

    right: Array
    along: Array
    """Load at t = 0, and its change per unit of t, shape (rows,)."""
    sides: Array
    turns: Array
    """Change of `right`, and of `along`, per unit of each unknown d_k, shape (K, rows)."""


def affine_forces(problem: ScaledProblem, load: UncertainLoad, most: float) -> LinearProgram:
    """Linear program for the largest multiple t of a load, with forces affine in the unknowns d.

    Its unknowns are x = (t, f_0, f_k+, f_k-), where f_k = f_k+ - f_k- and both are nonnegative.

    Arguments: `most`: upper bound of t [-].
    """
    matrix, one_sided = problem.matrix, np.flatnonzero(~problem.program.two_sided)
    rows, count = matrix.shape
    unknowns = len(load.sides)
    follow_blocks = block_diag([matrix, *[matrix] * unknowns], format="csc")
    negative = vstack(
        [csc_array((rows, count * unknowns)), -follow_blocks[rows:, count:]]
        if unknowns
        else [csc_array((rows, 0))]
    )
    share = csc_array(-np.concatenate([load.along, load.turns.ravel()])[:, None])
    balance = hstack([share, follow_blocks, negative])
    pushing = csc_array(eye_array(count))[one_sided]
    all_unknowns = (
        kron(np.ones((1, unknowns)), pushing)
        if unknowns
        else csc_array((len(pushing.indptr) - 1, 0))
    )
    # f_0 - sum_k (f_k+ + f_k-) >= 0 on the rows that only push
    pushes = hstack([csc_array((len(one_sided), 1)), pushing, -all_unknowns, -all_unknowns])
    bound = np.concatenate([load.right, load.sides.ravel()])
    free = np.where(problem.program.two_sided, -np.inf, 0.0)
    total = 1 + count * (1 + 2 * unknowns)
    lower = np.concatenate([[0.0], free, np.zeros(2 * count * unknowns)])
    upper = np.full(total, np.inf)
    upper[0] = most
    cost = np.zeros(total)
    cost[0] = -1.0
    return LinearProgram(
        cost,
        csc_array(vstack([balance, pushes], format="csc")),
        np.concatenate([bound, np.zeros(len(one_sided))]),
        np.concatenate([bound, np.full(len(one_sided), np.inf)]),
        lower,
        upper,
    )


def affine_imbalance(problem: ScaledProblem, load: UncertainLoad, x: Array) -> float:
    """Largest imbalance of a part for any d, over its weight [-], for a solution x of the program.

    The forces are first cut to their cones: f_0 of a row that only pushes is raised to sum_k |f_k|.
    """
    count, unknowns = problem.matrix.shape[1], len(load.sides)
    share, forces = float(x[0]), x[1 : 1 + count]
    both = x[1 + count :].reshape(2, unknowns, count)
    follow = both[0] - both[1]
    pushes = ~problem.program.two_sided
    middle = np.where(pushes, np.maximum(forces, np.abs(follow).sum(axis=0)), forces)
    rest = np.abs(problem.matrix @ middle - load.right - share * load.along)
    for k in range(unknowns):
        rest += np.abs(problem.matrix @ follow[k] - load.sides[k] - share * load.turns[k])
    return float(rest.max(initial=0.0))
