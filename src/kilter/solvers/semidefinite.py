"""Semidefinite programs: small, and degenerate by their nature.

    max c.x:   A0 x = 0,  A1 x >= 0,  A2 x in second-order cones,  each matrix S_k(x) >= 0

over x with x[0] = 1. What is asked for are the multipliers, or the point: whoever asks builds a
bound of his own from them. `kilter.solvers.clarabel` solves it. The relaxations that are solved
here have no inside, so that the equations of the interior point are singular in the end: a
regularisation a hundred thousand times larger than usual, no presolving and no decomposition let
it reach eight digits, where it fails otherwise.

References
----------
P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, 2024.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array

__all__ = ["Multipliers", "SemidefiniteProgram"]


@dataclass(frozen=True, slots=True, eq=False)
class SemidefiniteProgram:
    """max gain.x over x with x[0] = 1, as above.

    Attributes
    ----------
    gain : ndarray, shape (n,)
    equal, positive, cones : csr_array, shape (., n)
        Rows that are 0, that are not negative, and in turn of second-order cones.
    dimension : int
        Of every second-order cone.
    squares : tuple of csr_array, shape (k (k + 1) / 2, n)
        Upper triangles of matrices, column by column; off the diagonal times the root of 2.
    """

    gain: Array
    equal: csr_array
    positive: csr_array
    cones: csr_array
    dimension: int
    squares: tuple[csr_array, ...]

    @property
    def entries(self) -> int:
        """How many numbers its rows have."""
        rows = (self.equal, self.positive, self.cones, *self.squares)
        return sum(int(one.nnz) for one in rows)


@dataclass(frozen=True, slots=True, eq=False)
class Multipliers:
    """Multipliers of the rows and the point x, none of them believed; matrices are symmetric."""

    equal: Array
    positive: Array
    cones: Array
    squares: tuple[Array, ...]
    point: Array = field(default_factory=lambda: np.empty(0))
