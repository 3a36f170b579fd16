"""Data of small, degenerate semidefinite programs.

    max c.x:   A0 x = 0,  A1 x >= 0,  A2 x in second-order cones,  each matrix S_k(x) >= 0

over x with x[0] = 1. The caller builds its own bound from the multipliers, or from the point.
`kilter.solvers.clarabel` solves the programs. The relaxations that kilter solves have no interior,
so the equations of the interior point become singular. A regularisation a hundred thousand times
larger than the default, without presolve and decomposition, lets the method reach eight digits;
with the defaults it fails.

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
    """Semidefinite program: max gain.x with x[0] = 1, linear rows, cones and positive matrices."""

    gain: Array
    """Shape (n,)."""
    equal: csr_array
    positive: csr_array
    cones: csr_array
    """Rows of equations, of nonnegative numbers, and of consecutive second-order cones, shape
    (., n)."""
    dimension: int
    """Dimension of every second-order cone."""
    squares: tuple[csr_array, ...]
    """Upper triangles of matrices, column by column, shape (k (k + 1); off-diagonal entries
    times sqrt(2)."""

    @property
    def entries(self) -> int:
        """Number of nonzero entries in all matrices of the program."""
        rows = (self.equal, self.positive, self.cones, *self.squares)
        return sum(int(matrix.nnz) for matrix in rows)


@dataclass(frozen=True, slots=True, eq=False)
class Multipliers:
    """Multipliers of the rows and matrices of a semidefinite program, and its point x."""

    equal: Array
    positive: Array
    cones: Array
    squares: tuple[Array, ...]
    point: Array = field(default_factory=lambda: np.empty(0))
