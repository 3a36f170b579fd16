"""Many small independent equilibria, each with its load factor.

    max lambda:  A f - lambda b = 0,  0 <= lambda <= 1,  f >= 0 except for two-sided columns

for the blocks of a block-diagonal A. A single HiGHS object takes them in groups, each group as one
program: for a few dozen rows, passing and starting a program costs more than solving it. The
caller verifies forces and motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask, ragged, starts
from kilter.solvers.highs import FEW, MANY, new_highs
from kilter.solvers.solver_tolerances import FEASIBLE

__all__ = ["BlockAnswers", "Blocks", "solve_blocks"]

ROWS_AT_ONCE = 600
"""Number of rows of the blocks that are solved as one program; longer programs gain nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Independent equilibria A f = b, with the diagonal blocks of a matrix A.

    Attributes
    ----------
    matrix : csc_array, shape (m, n)
        Block-diagonal A.
    right : ndarray, shape (m,)
        b.
    two_sided : ndarray of bool, shape (n,)
        Columns whose force may have either sign.
    row_start, column_start : ndarray of int, shape (M + 1,)
        First row and column of each block.
    """

    matrix: csc_array
    right: Array
    two_sided: Mask
    row_start: Index
    column_start: Index

    def __len__(self) -> int:
        return len(self.row_start) - 1


@dataclass(frozen=True, slots=True, eq=False)
class BlockAnswers:
    """Load factor, forces and multipliers of each block, as the solver returned them.

    Attributes
    ----------
    factor : ndarray, shape (M,)
        Load factor lambda; NaN if the solver failed or the block was not solved.
    forces : ndarray, shape (n,)
        f for the whole load if lambda is 1, else 0.
    multipliers : ndarray, shape (m,)
        y with A^T y <= 0 and b.y > 0 if lambda is 0: no f balances b.
    """

    factor: Array
    forces: Array
    multipliers: Array


def solve_blocks(blocks: Blocks, which: Index) -> BlockAnswers:
    """Solve the load-factor program of each block in `which`, independently of the others.

    Parameters
    ----------
    blocks : Blocks
    which : ndarray of int
        Indices of the blocks to solve, ascending.

    Examples
    --------
    >>> matrix = csc_array(np.array([[-1.0, 0.0], [0.0, -1.0]]))
    >>> start = np.arange(3)
    >>> two = Blocks(matrix, np.array([-2.0, 2.0]), np.zeros(2, dtype=bool), start, start)
    >>> answers = solve_blocks(two, np.arange(2))
    >>> answers.factor.round().tolist() == [1, 0], answers.forces.tolist()
    (True, [2.0, 0.0])
    """
    count = len(blocks)
    answers = BlockAnswers(
        np.full(count, np.nan), np.zeros(len(blocks.two_sided)), np.zeros(len(blocks.right))
    )
    highs = new_highs(FEASIBLE)
    highs.setOptionValue("solver", "simplex")
    highs.setOptionValue("presolve", "off")
    rows = np.diff(blocks.row_start)
    answers.factor[which[rows[which] == 0]] = 1.0  # a block without free parts balances trivially
    which = which[rows[which] > 0]
    group = np.cumsum(rows[which]) // ROWS_AT_ONCE
    for together in np.split(which, np.flatnonzero(np.diff(group)) + 1):
        if len(together) and not _solve(highs, blocks, together, answers):
            for k in together[:, None] if len(together) > 1 else ():
                _solve(highs, blocks, k, answers)
    return answers


def _solve(highs: Any, blocks: Blocks, which: Index, answers: BlockAnswers) -> bool:
    """Solve some blocks side by side in one program; return whether the solver succeeded.

    The sum of their load factors is greatest if each factor is greatest, since no row and no
    column is shared.
    """
    (row_owner, rows), (_, columns) = (
        ragged(blocks.row_start, which),
        ragged(blocks.column_start, which),
    )
    _pass_blocks(highs, blocks, rows, columns, row_owner)
    highs.run()
    if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return False
    solution = highs.getSolution()
    x, dual = np.array(solution.col_value), np.array(solution.row_dual)
    forces, factor = x[: len(columns)], x[len(columns) :]
    answers.factor[which] = factor
    # the optimum is 0 or 1: forces for any lambda > 0 can be scaled up to lambda = 1
    holds = factor > 0.5
    scale = np.where(holds, 1.0 / np.where(holds, factor, 1.0), 0.0)
    answers.forces[columns] = forces * np.repeat(scale, np.diff(blocks.column_start)[which])
    answers.multipliers[rows] = np.where(holds[row_owner], 0.0, dual)
    return True


def _pass_blocks(highs: Any, blocks: Blocks, rows: Index, columns: Index, row_owner: Index) -> None:
    """Pass the load-factor programs of some blocks to the solver HiGHS as one program.

    `row_owner` is the number of the block of each row, from 0.
    """
    matrix, right = blocks.matrix, blocks.right[rows]
    m, n, count = len(rows), len(columns), int(row_owner[-1]) + 1
    entries = ragged(matrix.indptr, columns)[1]
    loaded = np.flatnonzero(right)
    index = np.concatenate([np.searchsorted(rows, matrix.indices[entries]), loaded])
    value = np.concatenate([matrix.data[entries], -right[loaded]])
    sizes = np.append(
        np.diff(matrix.indptr)[columns], np.bincount(row_owner[loaded], minlength=count)
    )
    cost, lower, upper = np.zeros((3, n + count))
    cost[n:], upper[:n], upper[n:] = -1.0, np.inf, 1.0
    lower[:n][blocks.two_sided[columns]] = -np.inf
    zero, continuous = np.zeros(m), np.zeros(n + count, dtype=np.int32)
    colwise, minimise = int(highspy.MatrixFormat.kColwise), int(highspy.ObjSense.kMinimize)
    highs.setOptionValue("simplex_iteration_limit", FEW + MANY * (m + n + count))
    highs.passModel(
        n + count, m, len(value), colwise, minimise, 0.0, cost, lower, upper, zero, zero,
        starts(sizes).astype(np.int32), index.astype(np.int32), value, continuous,
    )  # fmt: skip
