"""Forces that follow uncertain loads: a linear program that holds a whole box of them.

The load depends on unknowns d in a box and on a share t,

    b(t, d) = right + t along + sum_k d_k (sides_k + t turns_k),      |d_k| <= 1

and forces that follow it in proportion, f = f_0 + sum_k d_k f_k, hold it for every d where

    A f_0 = right + t along,   A f_k = sides_k + t turns_k,   f_0 >= sum_k |f_k|

on rows that only push. Such forces are some of those that may follow: the largest t found is
an inner answer, safe, and not always the largest there is.

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
    """Loads in the scaled rows of a problem.

    Attributes
    ----------
    right, along : ndarray, shape (rows,)
    sides, turns : ndarray, shape (K, rows)
        What one unit of each unknown adds, and what it adds to `along`.
    """

    right: Array
    along: Array
    sides: Array
    turns: Array


def affine_forces(problem: ScaledProblem, load: UncertainLoad, most: float) -> LinearProgram:
    """The largest share t, from 0 to `most`, held for every d. x = (t, f_0, f_k+, f_k-).

    Parameters
    ----------
    problem : ScaledProblem
    load : UncertainLoad
    most : float
        Shares looked at [-].
    """
    matrix, one_sided = problem.matrix, np.flatnonzero(~problem.program.two_sided)
    rows, count = matrix.shape
    unknowns = len(load.sides)
    follow = block_diag([matrix, *[matrix] * unknowns], format="csc")
    back = vstack(
        [csc_array((rows, count * unknowns)), -follow[rows:, count:]]
        if unknowns
        else [csc_array((rows, 0))]
    )
    share = csc_array(-np.concatenate([load.along, load.turns.ravel()])[:, None])
    balance = hstack([share, follow, back])
    pick = csc_array(eye_array(count))[one_sided]
    every = kron(np.ones((1, unknowns)), pick) if unknowns else csc_array((len(pick.indptr) - 1, 0))
    inside = hstack([csc_array((len(one_sided), 1)), pick, -every, -every])
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
        csc_array(vstack([balance, inside], format="csc")),
        np.concatenate([bound, np.zeros(len(one_sided))]),
        np.concatenate([bound, np.full(len(one_sided), np.inf)]),
        lower,
        upper,
    )


def affine_imbalance(problem: ScaledProblem, load: UncertainLoad, x: Array) -> float:
    """The worst imbalance over all d, in weights of the parts, of forces cut to their cones.

    Parameters
    ----------
    problem : ScaledProblem
    load : UncertainLoad
    x : ndarray
        A solution of `affine_forces`.
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
