"""Balance of blocks by forces in cones between them: a conic program that knows its graph.

    max t:  A x = right + t along,   0 <= t <= most,   x in second-order cones, or free

Blocks have n rows of A each. A link joins two blocks, or one to nothing; all columns of a link
are given in the rows of its first block, and one matrix carries them to those of its second. So
A A^T, with any weights on the columns, is a sum of one small matrix a link.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask
from kilter.solvers.block_cholesky import BlockCholesky
from kilter.solvers.lorentz import Scaling

__all__ = ["LinkedCones"]


@dataclass(frozen=True, eq=False)
class LinkedCones:
    """Columns, links and blocks.

    Attributes
    ----------
    columns : ndarray, shape (n, d, K)
        Of A, in the rows of the first block of their link; K cones in d dimensions, sorted by
        link. A half line among cones has columns of 0 behind its first.
    start : ndarray of int, shape (L,)
        First cone of each link.
    first, second : ndarray of int, shape (L,)
        Its blocks; the second may be -1. No two blocks have two links.
    carried : ndarray, shape (L, n, n)
        From rows of the first block to those of the second.
    free : ndarray of bool, shape (K,)
        Half lines that are whole lines.
    place : ndarray, shape (N, 3)
        Of each block, for the order of elimination.
    right, along : ndarray, shape (N, n)
    most : float
    """

    columns: Array
    start: Index
    first: Index
    second: Index
    carried: Array
    free: Mask
    place: Array
    right: Array
    along: Array
    most: float

    def with_more(self, along: Array, most: float) -> LinkedCones:
        """The same with another load to grow; what hangs on the columns alone is shared."""
        other = replace(self, along=along, most=most)
        other.__dict__.update({k: v for k, v in self.__dict__.items() if k not in other.__dict__})
        return other

    @cached_property
    def _link(self) -> Index:
        """Link of each cone."""
        count = np.diff(np.append(self.start, self.columns.shape[2]))
        link: Index = np.repeat(np.arange(len(self.start)), count)
        return link

    @cached_property
    def _both(self) -> Index:
        """Links of two blocks."""
        return np.flatnonzero(self.second >= 0)

    @cached_property
    def _gather(self) -> tuple[csr_array, csr_array]:
        """Matrices that add up what links bring to their first, and to their second blocks."""
        shape, links = (len(self.place), len(self.start)), np.arange(len(self.start))
        first = csr_array((np.ones(len(links)), (self.first, links)), shape=shape)
        both = self._both
        second = csr_array((np.ones(len(both)), (self.second[both], both)), shape=shape)
        return first, second

    @cached_property
    def factor(self) -> BlockCholesky:
        """For matrices of the pattern of A A^T."""
        both = self._both
        ends = self.first[both], self.second[both]
        return BlockCholesky(self.place, *ends, self.columns.shape[0])

    @cached_property
    def sizes(self) -> Array:
        """Largest length of the columns of a cone, in the rows of either block, shape (K,)."""
        own = np.sqrt((self.columns**2).sum(axis=0).max(axis=0))
        stretch = np.sqrt((self.carried**2).sum(axis=(1, 2)))
        size: Array = own * np.maximum(stretch, 1.0)[self._link]
        return size

    @cached_property
    def _squares(self) -> Array:
        """Columns C of each cone as C J C^T, the upper triangle, shape (n (n + 1) / 2, K)."""
        c = self.columns
        i, j = np.triu_indices(len(c))
        squares = c[i, 0] * c[j, 0]
        for k in range(1, c.shape[1]):
            squares -= c[i, k] * c[j, k]
        result: Array = squares
        return result

    def balance(self, x: Array) -> Array:
        """A x, shape (N, n), of x, shape (d, K)."""
        pushed = np.einsum("idk,dk->ik", self.columns, x)
        links = np.add.reduceat(pushed, self.start, axis=1).T
        first, second = self._gather
        result: Array = first @ links + second @ np.einsum("lij,lj->li", self.carried, links)
        return result

    def openings(self, y: Array) -> Array:
        """A^T y, shape (d, K), of y, shape (N, n)."""
        links = y[self.first]
        both = self._both
        links[both] += np.einsum("lji,lj->li", self.carried[both], y[self.second[both]])
        result: Array = np.einsum("idk,ik->dk", self.columns, links.T[:, self._link])
        return result

    def normal_matrix(self, scaling: Scaling) -> tuple[Array, Array]:
        """A W^2 A^T: its diagonal blocks, shape (N, n, n), and those of the links of two blocks.

        W^2 = eta^2 (2 w w^T - J), and C J C^T is known.
        """
        size = len(self.columns)
        along = np.einsum("idk,dk->ik", self.columns, scaling.w)
        square = scaling.eta**2
        links = np.empty((len(self.start), size, size))
        for k, (i, j) in enumerate(zip(*np.triu_indices(size), strict=True)):
            values = (2 * along[i] * along[j] - self._squares[k]) * square
            links[:, i, j] = links[:, j, i] = np.add.reduceat(values, self.start)
        across = links @ self.carried.transpose(0, 2, 1)
        far = self.carried @ across
        first, second = self._gather
        flat = (-1, size * size)
        diagonal = first @ links.reshape(flat) + second @ far.reshape(flat)
        return diagonal.reshape(-1, size, size), across[self._both]
