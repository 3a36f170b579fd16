"""Balance of blocks (parts) by forces in cones between them: a conic program on a graph.

    max t:  A x = right + t along,   0 <= t <= most,   x in second-order cones, or free

A block has n rows of A. A link joins two blocks, or a block to the ground. All columns of a link
are given in the rows of its first block, and a matrix per link transfers them to the rows of its
second block. So A A^T, with any weights on the columns, is a sum of small matrices, one for each
link.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask
from kilter.solvers.block_cholesky import BlockCholesky
from kilter.solvers.lorentz import Scaling


@dataclass(frozen=True, eq=False)
class LinkedCones:
    """Data of a balance problem: force columns, links between blocks, and load."""

    columns: Array
    """Columns of A in the rows of the first block of their link, shape (n, d, K); K cones in d
    dimensions, sorted by link. A half line among cones has zero columns after its first."""
    start: Index
    """First cone of each link, shape (L,)."""
    first: Index
    second: Index
    """Blocks of each link, shape (L,); the second may be -1. No two links join the same blocks."""
    carried: Array
    """Transfer matrix from rows of the first block to those of the second, shape (L, n, n)."""
    free: Mask
    """Half lines that are whole lines instead, shape (K,)."""
    place: Array
    """Position of each block in space, for the order of elimination, shape (N, 3)."""
    right: Array
    along: Array
    """Load at t = 0, and its change per unit of t, shape (N, n)."""
    most: float
    """Upper bound of t."""

    def with_more(self, along: Array, most: float) -> LinkedCones:
        """Copy of the problem with another load `along`, whose multiple t may be at most `most`."""
        result = replace(self, along=along, most=most)
        result.__dict__.update({k: v for k, v in self.__dict__.items() if k not in result.__dict__})
        return result

    @cached_property
    def _link(self) -> Index:
        """Index of the link to which each cone belongs, shape (K,)."""
        count = np.diff(np.append(self.start, self.columns.shape[2]))
        link: Index = np.repeat(np.arange(len(self.start)), count)
        return link

    @cached_property
    def _shared_links(self) -> Index:
        """Indices of the links that join two blocks, not a block and the ground."""
        return np.flatnonzero(self.second >= 0)

    @cached_property
    def _gather(self) -> tuple[csr_array, csr_array]:
        """Sparse matrices that add values of links to their first and second blocks."""
        shape, links = (len(self.place), len(self.start)), np.arange(len(self.start))
        first = csr_array((np.ones(len(links)), (self.first, links)), shape=shape)
        both = self._shared_links
        second = csr_array((np.ones(len(both)), (self.second[both], both)), shape=shape)
        return first, second

    @cached_property
    def factor(self) -> BlockCholesky:
        """Cholesky factorisation for matrices with the block pattern of A A^T."""
        both = self._shared_links
        ends = self.first[both], self.second[both]
        return BlockCholesky(self.place, *ends, self.columns.shape[0])

    @cached_property
    def sizes(self) -> Array:
        """Largest column norm of each cone in the equilibrium rows, shape (K,)."""
        length = np.sqrt((self.columns**2).sum(axis=0).max(axis=0))
        stretch = np.sqrt((self.carried**2).sum(axis=(1, 2)))
        size: Array = length * np.maximum(stretch, 1.0)[self._link]
        return size

    @cached_property
    def _squares(self) -> Array:
        """Upper triangle of C J C^T for the columns C of each cone, with J = diag(1, -1, ...)."""
        c = self.columns
        i, j = np.triu_indices(len(c))
        squares = c[i, 0] * c[j, 0]
        for k in range(1, c.shape[1]):
            squares -= c[i, k] * c[j, k]
        result: Array = squares
        return result

    def _at_blocks(self, first: Array, second: Array) -> Array:
        """Sums at each block, shape (..., N, m), of link values at first and second blocks."""

        def gathered(gather: csr_array, values: Array) -> Array:
            ahead = np.moveaxis(values, -2, 0)
            # the width is stated, since it cannot be inferred without links
            summed = gather @ ahead.reshape(len(ahead), math.prod(ahead.shape[1:]))
            return np.moveaxis(summed.reshape(gather.shape[0], *ahead.shape[1:]), 0, -2)

        at_first, at_second = self._gather
        return gathered(at_first, first) + gathered(at_second, second)

    def balance(self, x: Array) -> Array:
        """Forces on the blocks, A x, shape (..., N, n), from cone forces x, shape (d, ..., K)."""
        pushed = np.einsum("idk,d...k->i...k", self.columns, x)
        links = np.moveaxis(np.add.reduceat(pushed, self.start, axis=-1), 0, -1)
        return self._at_blocks(links, (self.carried @ links[..., None])[..., 0])

    def openings(self, y: Array) -> Array:
        """Relative motions A^T y of blocks at the cones, (d, ..., K), for y, shape (..., N, n)."""
        links = y[..., self.first, :]
        both = self._shared_links
        back = self.carried[both].transpose(0, 2, 1)
        links[..., both, :] += (back @ y[..., self.second[both], :, None])[..., 0]
        at_cones = np.moveaxis(links[..., self._link, :], -1, 0)
        result: Array = np.einsum("idk,i...k->d...k", self.columns, at_cones)
        return result

    def normal_matrix(self, scaling: Scaling) -> tuple[Array, Array]:
        """Diagonal, (..., N, n, n), and off-diagonal blocks of the normal matrix A W^2 A^T.

        W^2 = eta^2 (2 w w^T - J), and C J C^T is precomputed. The scaling has arrays of shapes
        (d, ..., K) and (..., K).
        """
        size = len(self.columns)
        along = np.einsum("idk,d...k->i...k", self.columns, scaling.w)
        square = scaling.eta**2
        links = np.empty((*square.shape[:-1], len(self.start), size, size))
        for k, (i, j) in enumerate(zip(*np.triu_indices(size), strict=True)):
            values = (2 * along[i] * along[j] - self._squares[k]) * square
            sums = np.add.reduceat(values, self.start, axis=-1)
            links[..., i, j] = links[..., j, i] = sums
        across = links @ self.carried.transpose(0, 2, 1)
        far = self.carried @ across
        flat = (*links.shape[:-2], size * size)
        diagonal = self._at_blocks(links.reshape(flat), far.reshape(flat))
        return diagonal.reshape(*diagonal.shape[:-1], size, size), across[
            ..., self._shared_links, :, :
        ]
