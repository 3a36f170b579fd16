"""Many small independent equilibria, each with its load factor, solved one after the other.

    max lambda:  A f - lambda b = 0,  0 <= lambda <= 1,  f >= 0 except for two-sided columns

for the blocks of a block-diagonal A. A single HiGHS object takes them in turn, which for a few
dozen rows costs a third of creating an object for each. A block is solved alone, since its forces
must not depend on the other blocks. The caller verifies forces and motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask
from kilter.solvers.highs import FEW, MANY, new_highs
from kilter.solvers.solver_tolerances import FEASIBLE

__all__ = ["BlockAnswers", "Blocks", "solve_blocks"]


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Independent equilibria A f = b, with the diagonal blocks of a matrix A."""

    matrix: csc_array
    """Block-diagonal A, shape (m, n)."""
    right: Array
    """b, shape (m,)."""
    two_sided: Mask
    """Columns whose force may have either sign, shape (n,)."""
    row_start: Index
    column_start: Index
    """First row and column of each block, shape (M + 1,)."""

    def __len__(self) -> int:
        return len(self.row_start) - 1


@dataclass(frozen=True, slots=True, eq=False)
class BlockAnswers:
    """Load factor, forces and multipliers of each block, as the solver returned them."""

    factor: Array
    """Load factor lambda, shape (M,); NaN if the solver failed or the block was not solved."""
    forces: Array
    """f for the whole load if lambda is 1, else 0, shape (n,)."""
    multipliers: Array
    """y with A^T y <= 0 and b, shape (m,).y > 0 if lambda is 0: no f balances b."""


def solve_blocks(blocks: Blocks, which: Index) -> BlockAnswers:
    """Solve the load-factor program of each block in `which`, independently of the others.

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
    for k in which.tolist():
        rows = slice(*blocks.row_start[k : k + 2].tolist())
        columns = slice(*blocks.column_start[k : k + 2].tolist())
        if rows.start == rows.stop:  # a block without free parts balances trivially
            answers.factor[k] = 1.0
            continue
        _pass_block(highs, blocks, rows, columns)
        highs.run()
        if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            continue
        solution = highs.getSolution()
        x = np.array(solution.col_value)
        answers.factor[k] = x[-1]
        # the optimum is 0 or 1: forces for any lambda > 0 can be scaled up to lambda = 1
        if x[-1] > 0.5:
            answers.forces[columns] = x[:-1] / x[-1]
        else:
            answers.multipliers[rows] = solution.row_dual
    return answers


def _pass_block(highs: Any, blocks: Blocks, rows: slice, columns: slice) -> None:
    """Pass the load-factor program of a block to the solver HiGHS."""
    matrix, right = blocks.matrix, blocks.right[rows]
    m, n = rows.stop - rows.start, columns.stop - columns.start
    start = matrix.indptr[columns.start : columns.stop + 1]
    entries = slice(int(start[0]), int(start[-1]))
    loaded_rows = np.flatnonzero(right)
    index = np.concatenate([matrix.indices[entries] - rows.start, loaded_rows])
    value = np.concatenate([matrix.data[entries], -right[loaded_rows]])
    cost, lower, upper = np.zeros(n + 1), np.zeros(n + 1), np.full(n + 1, np.inf)
    cost[-1], upper[-1] = -1.0, 1.0
    lower[:-1][blocks.two_sided[columns]] = -np.inf
    zero, continuous = np.zeros(m), np.zeros(n + 1, dtype=np.int32)
    colwise, minimise = int(highspy.MatrixFormat.kColwise), int(highspy.ObjSense.kMinimize)
    highs.setOptionValue("simplex_iteration_limit", FEW + MANY * (m + n + 1))
    highs.passModel(
        n + 1, m, len(value), colwise, minimise, 0.0, cost, lower, upper, zero, zero,
        (start - start[0]).astype(np.int32, copy=False), index.astype(np.int32, copy=False),
        value, continuous,
    )  # fmt: skip
