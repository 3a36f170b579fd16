"""Cholesky factors of a symmetric matrix of small blocks, front by front, on LAPACK.

    [ F11       ]   [ L11     ] [ L11^T  L21^T ]
    [ F21   F22 ] = [ L21   I ] [        F22 - L21 L21^T ]

for each front of `kilter.solvers.dissection`: what is left of its border is added to its
parent's. Where fronts lie is found once; every matrix of the same pattern re-uses it.

References
----------
I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear
equations, 1983.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kilter.arrays import Array, Index
from kilter.solvers.dissection import Front, fronts

__all__ = ["BlockCholesky", "NotPositive"]


Runs = tuple[tuple[int, int, int], ...]
"""From where to where in one array, and where that begins in another."""


class NotPositive(ArithmeticError):
    """The matrix is not positive definite to working precision."""


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """Where the numbers of one front lie; rows of unknowns in the order of elimination.

    Attributes
    ----------
    start, size : int
        First unknown of the front, and how many it has.
    border : ndarray of int
        Unknowns of its border.
    source, row, column : ndarray of int
        Blocks of the matrix within the front: which (diagonal, then links, then links turned),
        and where, in blocks.
    kids : tuple of (int, tuple of (int, int, int))
        A child, and the runs of unknowns of its border that lie side by side in this front: from
        where to where in the border, and where in the front.
    """

    start: int
    size: int
    border: Index
    source: Index
    row: Index
    column: Index
    kids: tuple[tuple[int, Runs], ...]


class BlockCholesky:
    """A pattern of blocks, to be factorised again and again.

    Parameters
    ----------
    place : ndarray, shape (N, 3)
        Of each block, for the order of elimination.
    one, other : ndarray of int, shape (L,)
        Ends of the links, each pair once.
    width : int
        Unknowns of a block.

    Examples
    --------
    >>> pair = BlockCholesky(np.eye(2, 3), np.array([0]), np.array([1]), 1)
    >>> pair.factorise(np.full((2, 1, 1), 2.0), np.ones((1, 1, 1)))
    >>> pair.solve(np.array([[3.0], [3.0]]))
    array([[1.],
           [1.]])
    """

    def __init__(self, place: Array, one: Index, other: Index, width: int) -> None:
        self._width = width
        found = fronts(place, one, other, width)
        self._order = np.concatenate([front.own for front in found])
        self._plans = _plans(found, one, other, self._order, width)
        self._factors: list[tuple[Array, Array]] = []

    @property
    def entries(self) -> int:
        """Numbers of the factors."""
        return sum(plan.size * (plan.size // 2 + len(plan.border)) for plan in self._plans)

    def factorise(self, diagonal: Array, links: Array) -> None:
        """Factorise a matrix.

        Parameters
        ----------
        diagonal : ndarray, shape (N, width, width)
        links : ndarray, shape (L, width, width)
            The block in the rows of `one` and the columns of `other`.

        Raises
        ------
        NotPositive
            If it is not positive definite.
        """
        # a small check needs none of it
        from scipy.linalg.blas import dsyrk, dtrsm
        from scipy.linalg.lapack import dpotrf

        width = self._width
        blocks = np.concatenate([diagonal, links, links.transpose(0, 2, 1)])
        left: list[Array | None] = [None] * len(self._plans)
        self._factors = []  # the old ones go first: those of a large matrix are most of the memory
        factors: list[tuple[Array, Array]] = []
        for k, plan in enumerate(self._plans):
            size, edge = plan.size, len(plan.border)
            own, below, rest = _filled(plan, blocks, width)
            for child, runs in plan.kids:
                more = left[child]
                assert more is not None
                left[child] = None
                _extend(more, runs, size, own.T, below.T, rest.T)
            if size:
                own, failed = dpotrf(own, lower=1, clean=0, overwrite_a=1)
                if failed:
                    raise NotPositive
            if size and edge:
                below = dtrsm(1.0, own, below, side=1, lower=1, trans_a=1, overwrite_b=1)
                rest = dsyrk(-1.0, below, beta=1.0, c=rest, lower=1, overwrite_c=1)
            left[k] = rest
            factors.append((own, below))
        self._factors = factors

    def solve(self, right: Array) -> Array:
        """Solutions for right-hand sides, shape (N, width, ...)."""
        unknowns = right[self._order].reshape(len(self._order) * self._width, -1)
        for column in range(unknowns.shape[1]):
            one = np.ascontiguousarray(unknowns[:, column])
            self._solve_in_place(one)
            unknowns[:, column] = one
        result = np.empty_like(right)
        result[self._order] = unknowns.reshape(right.shape)
        return result

    def _solve_in_place(self, unknowns: Array) -> None:
        # one after the other: a triangle and one side by dtrsv take less than by dtrsm
        from scipy.linalg.blas import dgemv, dtrsv

        fronts = [
            (unknowns[plan.start : plan.start + plan.size], plan.border, *factor)
            for plan, factor in zip(self._plans, self._factors, strict=True)
            if plan.size
        ]
        for mine, border, own, below in fronts:
            dtrsv(own, mine, lower=1, overwrite_x=1)
            if len(border):
                later = unknowns.take(border)
                unknowns.put(border, dgemv(-1.0, below, mine, 1.0, later, overwrite_y=1))
        for mine, border, own, below in reversed(fronts):
            if len(border):
                dgemv(-1.0, below, unknowns.take(border), 1.0, mine, trans=1, overwrite_y=1)
            dtrsv(own, mine, lower=1, trans=1, overwrite_x=1)


def _plans(found: list[Front], one: Index, other: Index, order: Index, width: int) -> list[_Plan]:
    count, links = len(order), len(one)
    rank, local = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    # a lower block lies in the row of the end that is eliminated later
    turned = rank[one] < rank[other]
    column, row = np.where(turned, one, other), np.where(turned, other, one)
    source = count + np.arange(links) + np.where(turned, links, 0)
    each, plans, start = np.arange(width), [], 0
    for front in found:
        local[front.own] = np.arange(len(front.own))
        local[front.border] = len(front.own) + np.arange(len(front.border))
        own = np.arange(len(front.own))
        kids = []
        for child in front.children:
            kids.append((child, _runs(local[found[child].border], len(front.own), width)))
        plans.append(
            _Plan(
                start,
                len(front.own) * width,
                (rank[front.border][:, None] * width + each).ravel(),
                np.concatenate([front.own, source[front.links]]),
                np.concatenate([own, local[row[front.links]]]),
                np.concatenate([own, local[column[front.links]]]),
                tuple(kids),
            )
        )
        start += len(front.own) * width
    return plans


def _runs(where: Index, own: int, width: int) -> Runs:
    """Runs of neighbours among blocks, those of a front's own apart from those of its border."""
    breaks = (np.diff(where) != 1) | (where[1:] == own)
    ends = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(where)]])
    return tuple(
        (int(a) * width, int(b) * width, int(where[a]) * width) for a, b in pairwise(ends) if b > a
    )


def _extend(more: Array, runs: Runs, size: int, own: Array, below: Array, rest: Array) -> None:
    """Add the lower triangle of what a child has left; all panels turned, so that rows are long."""
    more = more.T
    for k, (a, b, column) in enumerate(runs):
        inside = column < size
        columns = (
            slice(column, column + b - a) if inside else slice(column - size, column - size + b - a)
        )
        for c, d, row in runs[k:]:
            if row < size:
                own[columns, row : row + d - c] += more[a:b, c:d]
            else:
                panel = below if inside else rest
                panel[columns, row - size : row - size + d - c] += more[a:b, c:d]


def _filled(plan: _Plan, blocks: Array, width: int) -> tuple[Array, Array, Array]:
    """The three parts of a front with the blocks of the matrix in them."""
    size, edge = plan.size, len(plan.border)
    own = np.zeros((size, size), order="F")
    below = np.zeros((edge, size), order="F")
    rest = np.zeros((edge, edge), order="F")
    inside = plan.row < size // width
    for panel, some, first in ((own, inside, 0), (below, ~inside, size // width)):
        if some.any():
            tiles = panel.T.reshape(size // width, width, panel.shape[0] // width, width)
            values = blocks[plan.source[some]].transpose(0, 2, 1)
            tiles[plan.column[some], :, plan.row[some] - first] = values
    return own, below, rest
