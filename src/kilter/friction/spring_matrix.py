"""Linear systems of contact springs between parts, with a fixed pattern of nonzeros.

A matrix is the sum of a block for each pair of touching parts, and of a multiple d of the identity.
It is solved as a band matrix, with parts in reverse Cuthill-McKee order, or as a sparse matrix if
the band is wide. Symmetric positive definite matrices of a wide band are solved by nested
dissection.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array

from kilter.arrays import Array, Index
from kilter.solvers.block_cholesky import BlockCholesky, NotPositive
from kilter.work import Work

WIDEST_BAND = 400
"""Half width of a band above which systems are solved as sparse systems."""
DISSECTED = 250
"""Half width of a band above which symmetric systems are solved by nested dissection."""
SYMMETRIC = 100
"""Half width of a band above which symmetric matrices save time: Newton's method then takes about
1.4 times as many steps, but each takes a third of the operations.
"""


@dataclass(frozen=True, slots=True, eq=False)
class SpringMatrix:
    """Sparse matrix pattern of springs between P pairs of parts, in n unknowns."""

    order: Index
    """Position of each unknown in the order of elimination, shape (n,)."""
    band: int
    """Half width of the band."""
    place: Index
    """Position of each entry of a pair, shape (P x 2 d x 2 d,): in the band, or among the stored
    entries."""
    row: Index
    start: Index
    """Row indices and column starts of a sparse system, as in a csc_array; empty for a band."""
    lower: Index
    """Position of each entry of a pair in the lower half of the band, shape (P x 2 d x 2 d,)."""
    pairs: Index
    """Free parts of each pair in ascending order, shape (P, 2); -1 for a held part."""
    dissection: BlockCholesky | None
    """Factorisation by nested dissection; None for a narrow band."""

    @property
    def symmetric_pays(self) -> bool:
        """True if symmetric matrices make Newton's method faster; this holds for a wide band."""
        return self.band > SYMMETRIC

    def solve(self, blocks: Array, drag: float, right: Array, work: Work) -> Array:
        """Solve the linear system of the springs for the displacement; blocks may be unsymmetric.

        Arguments: `blocks` (P, 2 d, 2 d): contribution of each pair; `right` (n,). Raises
        `numpy.linalg.LinAlgError` if the system is singular.
        """
        ordered = np.empty(len(right))
        ordered[self.order] = right
        if self.band <= WIDEST_BAND:
            step = self._solve_band(blocks, drag, ordered, work)
        else:
            step = self._solve_sparse(blocks, drag, ordered, work)
        return step[self.order]

    def _solve_band(self, blocks: Array, drag: float, right: Array, work: Work) -> Array:
        """Solve the linear system of the springs as a band matrix, in elimination order."""
        from scipy.linalg.lapack import dgbsv

        band, count = self.band, len(right)
        matrix = _sum_entries(self.place, blocks, (3 * band + 1) * count).reshape(-1, count)
        matrix[2 * band] += drag
        work.band(count, band, 0)
        _, _, step, failed = dgbsv(band, band, matrix, right, overwrite_ab=True)
        if failed:
            raise np.linalg.LinAlgError("the band matrix is singular")
        return np.asarray(step, np.float64)

    def _solve_sparse(self, blocks: Array, drag: float, right: Array, work: Work) -> Array:
        """Solve the linear system of the springs as a sparse matrix, in elimination order."""
        from scipy.sparse.linalg import splu

        count = len(right)
        values = _sum_entries(self.place, blocks, len(self.row))
        matrix = csc_array((values, self.row, self.start), shape=(count, count))
        matrix.setdiag(matrix.diagonal() + drag)
        try:
            factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        except RuntimeError as error:
            raise np.linalg.LinAlgError(str(error)) from None
        work.sparse(count, factor.nnz)
        return np.asarray(factor.solve(right), np.float64)

    def solve_symmetric(self, blocks: Array, drag: float, right: Array, work: Work) -> Array:
        """Solve the linear system of springs with symmetric blocks, as `solve` does."""
        from scipy.linalg.lapack import dpbsv

        if self.dissection is not None:
            return self._solve_dissected(self.dissection, blocks, drag, right, work)
        band, count = self.band, len(right)
        matrix = _sum_entries(self.lower, blocks, (band + 1) * count).reshape(-1, count)
        matrix[0] += drag
        ordered = np.empty(count)
        ordered[self.order] = right
        work.symmetric_band(count, band)
        _, step, failed = dpbsv(matrix, ordered, lower=True, overwrite_ab=True)
        if failed:
            raise np.linalg.LinAlgError("the band matrix is not positive definite")
        return np.asarray(step[self.order], np.float64)

    def _solve_dissected(
        self, factor: BlockCholesky, blocks: Array, drag: float, right: Array, work: Work
    ) -> Array:
        """Solve the symmetric linear system of the springs by nested dissection."""
        width = blocks.shape[1] // 2
        parts = len(right) // width
        diagonal = np.zeros((parts + 1, width, width))
        for side in range(2):
            square = slice(width * side, width * (side + 1))
            np.add.at(diagonal, self.pairs[:, side], blocks[:, square, square])
        both = (self.pairs >= 0).all(axis=1)
        try:
            factor.factorise(diagonal[:-1] + drag * np.eye(width), blocks[both, :width, width:])
        except NotPositive:
            raise np.linalg.LinAlgError("the matrix is not positive definite") from None
        work.dissected(len(right), factor.entries)
        return factor.solve(right.reshape(parts, width)).reshape(-1)


def spring_matrix(pairs: Index, center: Array, per: int) -> SpringMatrix:
    """Build the sparse matrix pattern of springs between pairs of parts.

    Arguments: `pairs` (P, 2): free parts of each pair in ascending order, without repetitions; -1
    for a held part; `center` (F, 3): centres of the free parts.
    """
    rank = _elimination_ranks(pairs, len(center))
    count, size = per * len(center), 2 * per
    order = (per * rank[:, None] + np.arange(per)).reshape(-1)
    held = pairs < 0
    unknown = per * rank[np.where(held, 0, pairs)][:, :, None] + np.arange(per)
    unknown = np.where(held[:, :, None], -1, unknown).reshape(len(pairs), size)
    i = np.broadcast_to(unknown[:, :, None], (len(pairs), size, size)).reshape(-1)
    j = np.broadcast_to(unknown[:, None, :], (len(pairs), size, size)).reshape(-1)
    used = (i >= 0) & (j >= 0)
    band = max(int(np.abs(i - j)[used].max(initial=0)), 1)
    lower = np.where(used & (i >= j), (i - j) * count + j, (band + 1) * count)
    row = start = np.empty(0, dtype=np.int64)
    dissection = None
    if band <= WIDEST_BAND:
        place = np.where(used, (2 * band + i - j) * count + j, (3 * band + 1) * count)
    else:
        place, row, start = _sparse_positions(i, j, used, count)
    if band > DISSECTED:
        both = pairs[(pairs >= 0).all(axis=1)]
        dissection = BlockCholesky(center, both[:, 0], both[:, 1], per)
    return SpringMatrix(order, band, place, row, start, lower, pairs, dissection)


def _elimination_ranks(pairs: Index, count: int) -> Index:
    """Position of each part in an elimination order that gives a matrix of small bandwidth."""
    from scipy.sparse.csgraph import reverse_cuthill_mckee  # slow to import

    both = pairs[(pairs >= 0).all(axis=1)]
    ones = np.ones(2 * len(both))
    graph = csr_array((ones, (both.T.reshape(-1), both[:, ::-1].T.reshape(-1))), (count, count))
    rank = np.empty(count, dtype=np.int64)
    rank[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(count)
    return rank


def _sparse_positions(
    i: Index, j: Index, used: np.ndarray, count: int
) -> tuple[Index, Index, Index]:
    """Positions of block entries in a sparse matrix with a full diagonal, and its pattern."""
    diagonal = np.arange(count) * (count + 1)
    keys, inverse = np.unique(np.concatenate([j[used] * count + i[used], diagonal]),
                              return_inverse=True)  # fmt: skip
    place = np.full(len(i), len(keys))
    place[used] = inverse.reshape(-1)[: int(used.sum())]
    start = np.searchsorted(keys, np.arange(count + 1) * count)
    return place, keys % count, start


def _sum_entries(place: Index, blocks: Array, count: int) -> Array:
    """Sum entries that have the same position; entries without a position (-1) are dropped."""
    sums = np.bincount(place, blocks.reshape(-1), minlength=count + 1)[:count]
    return np.asarray(sums, dtype=np.float64)
