"""Equations with I + R^T D R, for rows R that each involve at most two blocks of unknowns.

    I + R^T D R

has a block for each block of unknowns and for each pair of blocks that a row joins, so it is
factorised block by block (`kilter.solvers.block_cholesky`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array
from kilter.solvers.block_cholesky import BlockCholesky, NotPositive

__all__ = ["LinkedRows"]

REFINED = 1e-10
"""Residual of a solution, over the right-hand side, above which the solution is refined."""
REGULAR = 1e-13
"""Relative increase of the diagonal if rounding has made the matrix indefinite."""


class LinkedRows:
    """Sparse rows R, shape (K, N n), over N blocks of n unknowns, at most two blocks per row.

    Arguments: `rows` (K, N n); `place` (N, 3): position of each block in space, for the order of
    elimination.

    Examples
    --------
    >>> rows = csr_array(np.array([[1.0, -1.0], [0.0, 1.0]]))
    >>> linked = LinkedRows(rows, 1, np.eye(2, 3))
    >>> solve = linked.factorised(np.array([1.0, 2.0]))  # [[2, -1], [-1, 4]]
    >>> np.allclose(solve(np.array([1.0, 3.0])), [1.0, 1.0])
    True
    """

    def __init__(self, rows: csr_array, block: int, place: Array) -> None:
        self.rows, self.turned = rows, csr_array(rows.T)
        self._block = block
        count = len(place)
        owner = np.repeat(np.arange(rows.shape[0]), np.diff(rows.indptr))
        entry_block = rows.indices // block
        first, second = np.full(rows.shape[0], count), np.full(rows.shape[0], -1)
        np.minimum.at(first, owner, entry_block)
        np.maximum.at(second, owner, entry_block)
        # a row without entries is assigned to the first block, and adds nothing
        first, second = np.where(second < 0, 0, first), np.maximum(second, 0)
        key = first * (count + 1) + second
        self._sorted = np.argsort(key, kind="stable")
        _, self._start = np.unique(key[self._sorted], return_index=True)
        number = np.empty(len(key), dtype=np.int64)
        number[self._sorted] = np.arange(len(key))
        column_place = rows.indices % block + np.where(entry_block == first[owner], 0, block)
        self._columns = np.zeros((2 * block, len(key)))
        self._columns[column_place, number[owner]] = rows.data
        ends = self._sorted[self._start]
        link_first, link_second = first[ends], second[ends]
        self._both = np.flatnonzero(link_first != link_second)
        self._factor = BlockCholesky(place, link_first[self._both], link_second[self._both], block)
        links, shape = np.arange(len(ends)), (count, len(ends))
        self._to_first = csr_array((np.ones(len(ends)), (link_first, links)), shape=shape)
        self._to_second = csr_array((np.ones(len(ends)), (link_second, links)), shape=shape)

    def factorised(self, weights: Array) -> Callable[[Array], Array]:
        """Make a solver of (I + R^T diag(weights) R) x = y, with refinement if necessary.

        The returned function is valid until the next call, which overwrites its factors.

        Raises `NotPositive` if the matrix is not positive definite to working precision.
        """
        diagonal, links = self._normal_matrix(weights[self._sorted])
        try:
            self._factor.factorise(diagonal, links)
        except NotPositive:
            self._factor.factorise(diagonal + REGULAR * diagonal * np.eye(self._block), links)
        rows, turned, block = self.rows, self.turned, self._block

        def solve_once(right: Array) -> Array:
            return self._factor.solve(right.reshape(-1, block)).ravel()

        def solve(right: Array) -> Array:
            x = solve_once(right)
            # the residual by products with R: in the assembled matrix large weights cancel
            residual = right - x - turned @ (weights * (rows @ x))
            inaccurate = np.abs(residual).max(initial=0.0) > REFINED * np.abs(right).max(
                initial=0.0
            )
            return x + solve_once(residual) if inaccurate else x

        return solve

    def _normal_matrix(self, weights: Array) -> tuple[Array, Array]:
        """Diagonal and link blocks of I + R^T D R, for row weights D sorted by link."""
        block = self._block
        sides = slice(block), slice(block, 2 * block)
        links = np.empty((len(self._start), 2 * block, 2 * block))
        for i, column in enumerate(self._columns):
            weighted = column * weights
            for j in range(i, 2 * block):
                sums = np.add.reduceat(weighted * self._columns[j], self._start)
                links[:, i, j] = links[:, j, i] = sums
        first_blocks, second_blocks = (
            links[:, side, side].reshape(-1, block * block) for side in sides
        )
        diagonal = self._to_first @ first_blocks + self._to_second @ second_blocks
        diagonal += np.eye(block).ravel()
        return diagonal.reshape(-1, block, block), links[self._both][:, sides[0], sides[1]]
