"""Multifrontal Cholesky factorisation of a symmetric matrix of small blocks, on LAPACK.

    [ F11       ]   [ L11     ] [ L11^T  L21^T ]
    [ F21   F22 ] = [ L21   I ] [        F22 - L21 L21^T ]

for each front of `kilter.solvers.block_cholesky`. The Schur complement of its border is added to
the parent front. The layout of the fronts is computed once; every matrix of the same pattern reuses
it.

References
----------
I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear equations,
1983.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask, ragged

# Nested dissection: an order of elimination for the blocks of a sparse matrix.


LEAF = 72
"""Default of `leaf`, for factorisations that solve a few right-hand sides each."""


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """Blocks of a matrix that are eliminated together, and the later blocks that they affect."""

    own: Index
    """Indices of the blocks, in the order of elimination."""
    border: Index
    """Later blocks that are linked to them, in the order of elimination."""
    links: Index
    """Links whose earlier end is among `own`."""
    children: tuple[int, ...]
    """Earlier fronts whose borders begin in this front."""


def fronts(place: Array, first: Index, second: Index, width: int, leaf: int = LEAF) -> list[Front]:
    """Divide a block matrix into fronts, in the order of elimination: children before parents.

    Arguments: `place` (N, 3); `first`, `second` (L,).

    Examples
    --------
    >>> row = np.arange(40)  # a chain
    >>> chain = fronts(np.column_stack([row, 0 * row, 0 * row]), row[:-1], row[1:], 6)
    >>> sum(len(front.own) for front in chain), len(chain[-1].border)
    (40, 0)
    """
    count = len(place)
    ends = (np.concatenate([first, second]), np.concatenate([second, first]))
    graph = csr_array((np.ones(len(ends[0])), ends), shape=(count, count))
    sets = _dissect(place, graph, leaf // width)
    owner, rank = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    order = np.concatenate([members for members, _ in sets])
    rank[order] = np.arange(count)
    owner[order] = np.repeat(np.arange(len(sets)), [len(members) for members, _ in sets])
    earliest = np.minimum(owner[first], owner[second])
    sorted_links = np.argsort(earliest, kind="stable")
    bounds = np.searchsorted(earliest[sorted_links], np.arange(len(sets) + 1))
    result: list[Front] = []
    for k, (members, children) in enumerate(sets):
        links = sorted_links[bounds[k] : bounds[k + 1]]
        # the border: later blocks that are linked to a member, or to a block eliminated before
        adjacent = [first[links], second[links], *(result[child].border for child in children)]
        touched = np.unique(rank[np.concatenate(adjacent)])
        border = order[touched]
        result.append(Front(members, border[owner[border] != k], links, children))
    return result


def _dissect(place: Array, graph: csr_array, leaf: int) -> list[tuple[Index, tuple[int, ...]]]:
    """Halve the blocks recursively; return the separators, each with the two sets it separates.

    Children come before their parents. A set of at most `leaf` blocks is not divided.
    """
    sets: list[tuple[Index, tuple[int, ...]]] = []
    right_side = np.zeros(len(place), dtype=bool)

    def divide(which: Index) -> int:
        """Halve a set of blocks recursively; return the index of its separator or leaf."""
        if len(which) <= leaf:
            sets.append((_sorted_along(place, which), ()))
            return len(sets) - 1
        points = place[which]
        axis = int(np.argmax(np.ptp(points, axis=0)))
        order = np.argsort(points[:, axis], kind="stable")
        left, right = which[order[: len(which) // 2]], which[order[len(which) // 2 :]]
        right_side[right] = True
        # these blocks separate the rest of the left half from the right half
        touching = _linked_blocks(graph, left, right_side)
        right_side[right] = False
        parts = [part for part in (left[~touching], right) if len(part)]
        children = tuple(divide(part) for part in parts)
        sets.append((_sorted_along(place, left[touching]), children))
        return len(sets) - 1

    if len(place):
        divide(np.arange(len(place)))
    return sets


def _sorted_along(place: Array, which: Index) -> Index:
    """Sort blocks by position along the axis of greatest extent; neighbours stay close."""
    points = place[which]
    axes = np.argsort(np.ptp(points, axis=0), kind="stable") if len(which) else np.arange(3)
    ordered: Index = which[np.lexsort(points[:, axes].T)]
    return ordered


def _linked_blocks(graph: csr_array, which: Index, marked: Mask) -> Mask:
    """Mask of the blocks in `which` that are linked to a marked block."""
    owner, entry = ragged(graph.indptr.astype(np.int64), which)
    hits = np.bincount(owner[marked[graph.indices[entry]]], minlength=len(which))
    linked: Mask = hits > 0
    return linked


LEAF_SINGLE = 216
"""Largest number of unknowns of an undivided set in single precision: these factorisations solve
dozens of right-hand sides each, so that fewer fronts pay."""

Runs = tuple[tuple[int, int, int], ...]
"""Groups of consecutive indices: start and end in one array, and start in another array."""


class NotPositive(ArithmeticError):
    """Error: a matrix is not positive definite to working precision."""


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """Layout of a front (blocks eliminated together) in the arrays of the factorisation."""

    start: int
    size: int
    """First unknown of the front, and their number."""
    border: Index
    """Unknowns of its border."""
    source: Index
    row: Index
    column: Index
    """Blocks of the matrix in the front: index among the diagonal blocks, links, and transposed
    links, and position in the front, in blocks."""
    kids: tuple[tuple[int, Runs], ...]
    """Each child, and the runs of its border that are consecutive in this front: start and end
    in the border, and start in the front."""


class BlockCholesky:
    """Cholesky factorisation of sparse symmetric matrices that share a pattern of small blocks.

    Arguments: `place` (N, 3): position of each block in space, for the order of elimination;
    `first`, `second` (L,): blocks at the ends of the links; each pair occurs once; `single`:
    factorise and solve in single precision: half the time and memory, for a preconditioner.

    Examples
    --------
    >>> pair = BlockCholesky(np.eye(2, 3), np.array([0]), np.array([1]), 1)
    >>> pair.factorise(np.full((2, 1, 1), 2.0), np.ones((1, 1, 1)))
    >>> pair.solve(np.array([[3.0], [3.0]]))
    array([[1.],
           [1.]])
    """

    def __init__(
        self, place: Array, first: Index, second: Index, width: int, *, single: bool = False
    ) -> None:
        self._width, self._real = width, np.float32 if single else np.float64
        front_list = fronts(place, first, second, width, LEAF_SINGLE if single else LEAF)
        self._order = np.concatenate([front.own for front in front_list])
        self._plans = _plans(front_list, first, second, self._order, width)
        self._factors: list[tuple[Array, Array]] = []

    def another(self) -> BlockCholesky:
        """A factorisation with the same layout and a matrix of its own."""
        other = copy(self)
        other._factors = []
        return other

    @property
    def entries(self) -> int:
        """Number of entries that the Cholesky factors store."""
        return sum(plan.size * (plan.size // 2 + len(plan.border)) for plan in self._plans)

    def factorise(self, diagonal: Array, links: Array) -> None:
        """Factorise a positive definite matrix, given by its diagonal blocks and its link blocks.

        Arguments: `diagonal` (N, width, width): diagonal blocks; `links` (L, width, width): block
        of each link, in the rows of `first` and the columns of `second`. Raises `NotPositive` if
        the matrix is not positive definite to working precision.
        """
        # imported late: small programs do not need LAPACK
        from scipy.linalg import get_blas_funcs, get_lapack_funcs

        width, kind = self._width, np.empty(0, self._real)
        (factorise,) = get_lapack_funcs(("potrf",), (kind,))
        solve_below, multiply = get_blas_funcs(("trsm", "syrk"), (kind,))
        blocks: Array = np.concatenate(
            [diagonal, links, links.transpose(0, 2, 1)], dtype=self._real, casting="same_kind"
        )
        updates: list[Array | None] = [None] * len(self._plans)
        self._factors = []  # release the old factors first: they are most of the memory
        factors: list[tuple[Array, Array]] = []
        for k, plan in enumerate(self._plans):
            size, border_size = plan.size, len(plan.border)
            pivot, below, border_block = _front_panels(plan, blocks, width)
            for child, runs in plan.kids:
                update = updates[child]
                assert update is not None
                updates[child] = None
                _add_update(update, runs, size, pivot.T, below.T, border_block.T)
            if size:
                pivot, failed = factorise(pivot, lower=1, clean=0, overwrite_a=1)
                if failed:
                    raise NotPositive
            if size and border_size:
                below = solve_below(1.0, pivot, below, side=1, lower=1, trans_a=1, overwrite_b=1)
                border_block = multiply(
                    -1.0, below, beta=1.0, c=border_block, lower=1, overwrite_c=1
                )
            updates[k] = border_block
            factors.append((pivot, below))
        self._factors = factors

    def solve(self, right: Array) -> Array:
        """Solve for right-hand sides of shape (N, width, ...), with the last factorised matrix."""
        unknowns = right[self._order].reshape(len(self._order) * self._width, -1)
        unknowns = unknowns.astype(self._real, copy=False)
        for column in range(unknowns.shape[1]):
            single = np.ascontiguousarray(unknowns[:, column])
            self._solve_in_place(single)
            unknowns[:, column] = single
        result = np.empty_like(right)
        result[self._order] = unknowns.reshape(right.shape)
        return result

    def _solve_in_place(self, unknowns: Array) -> None:
        """Forward and backward substitution, front by front, in the right-hand side itself."""
        # for one right-hand side, trsv is faster than trsm
        from scipy.linalg import get_blas_funcs

        multiply, solve = get_blas_funcs(("gemv", "trsv"), (unknowns,))
        fronts = [
            (unknowns[plan.start : plan.start + plan.size], plan.border, *factor)
            for plan, factor in zip(self._plans, self._factors, strict=True)
            if plan.size
        ]
        for values, border, pivot, below in fronts:
            solve(pivot, values, lower=1, overwrite_x=1)
            if len(border):
                change = multiply(-1.0, below, values, 1.0, unknowns.take(border), overwrite_y=1)
                unknowns.put(border, change)
        for values, border, pivot, below in reversed(fronts):
            if len(border):
                multiply(-1.0, below, unknowns.take(border), 1.0, values, trans=1, overwrite_y=1)
            solve(pivot, values, lower=1, trans=1, overwrite_x=1)


def _plans(
    front_list: list[Front], first: Index, second: Index, order: Index, width: int
) -> list[_Plan]:
    """Layout of every front, in the order of elimination."""
    count, links = len(order), len(first)
    rank, local = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    # blocks of the lower triangle lie in the row of the block that is eliminated later
    transposed = rank[first] < rank[second]
    column, row = np.where(transposed, first, second), np.where(transposed, second, first)
    source = count + np.arange(links) + np.where(transposed, links, 0)
    each, plans, start = np.arange(width), [], 0
    for front in front_list:
        local[front.own] = np.arange(len(front.own))
        local[front.border] = len(front.own) + np.arange(len(front.border))
        positions = np.arange(len(front.own))
        kids = []
        for child in front.children:
            kids.append((child, _runs(local[front_list[child].border], len(front.own), width)))
        plans.append(
            _Plan(
                start,
                len(front.own) * width,
                (rank[front.border][:, None] * width + each).ravel(),
                np.concatenate([front.own, source[front.links]]),
                np.concatenate([positions, local[row[front.links]]]),
                np.concatenate([positions, local[column[front.links]]]),
                tuple(kids),
            )
        )
        start += len(front.own) * width
    return plans


def _runs(positions: Index, pivots: int, width: int) -> Runs:
    """Groups of consecutive block positions; no group contains both pivots and border blocks.

    `positions` holds positions in the front, and `pivots` is the number of its pivot blocks.
    """
    breaks = (np.diff(positions) != 1) | (positions[1:] == pivots)
    ends = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(positions)]])
    return tuple(
        (int(a) * width, int(b) * width, int(positions[a]) * width)
        for a, b in pairwise(ends)
        if b > a
    )


def _add_update(
    update: Array, runs: Runs, size: int, pivot: Array, below: Array, border_block: Array
) -> None:
    """Add the Schur complement of a child front, a lower triangle, to the panels of its parent.

    The panels are transposed, so that consecutive entries are contiguous in memory.
    """
    update = update.T
    for k, (a, b, column) in enumerate(runs):
        inside = column < size
        columns = (
            slice(column, column + b - a) if inside else slice(column - size, column - size + b - a)
        )
        for c, d, row in runs[k:]:
            if row < size:
                pivot[columns, row : row + d - c] += update[a:b, c:d]
            else:
                panel = below if inside else border_block
                panel[columns, row - size : row - size + d - c] += update[a:b, c:d]


def _front_panels(plan: _Plan, blocks: Array, width: int) -> tuple[Array, Array, Array]:
    """Pivot, sub-diagonal and border panels of a front, filled with blocks of the matrix."""
    size, border_size = plan.size, len(plan.border)
    pivot = np.zeros((size, size), blocks.dtype, order="F")
    below = np.zeros((border_size, size), blocks.dtype, order="F")
    border_block = np.zeros((border_size, border_size), blocks.dtype, order="F")
    inside = plan.row < size // width
    for panel, chosen, first in ((pivot, inside, 0), (below, ~inside, size // width)):
        if chosen.any():
            tiles = panel.T.reshape(size // width, width, panel.shape[0] // width, width)
            values = blocks[plan.source[chosen]].transpose(0, 2, 1)
            tiles[plan.column[chosen], :, plan.row[chosen] - first] = values
    return pivot, below, border_block


# Equations with I + R^T D R, for rows R that each involve at most two blocks of unknowns.


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
