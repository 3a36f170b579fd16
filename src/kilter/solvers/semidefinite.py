"""Semidefinite programs, by Clarabel: small, and degenerate by their nature.

    max c.x:   A0 x = 0,  A1 x >= 0,  A2 x in second-order cones,  each matrix S_k(x) >= 0

over x with x[0] = 1. What is asked for are the multipliers: whoever asks builds a bound of his
own from them. The relaxations that are solved here have no inside, so that the equations of
the interior point are singular in the end: a regularisation a hundred thousand times larger than
usual, no presolving and no decomposition let it reach eight digits, where it fails otherwise.

References
----------
P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, 2024.
"""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy.sparse import csc_matrix, csr_array, vstack

from kilter.arrays import TINY, Array
from kilter.work import Work

__all__ = ["Multipliers", "SemidefiniteProgram", "solve_semidefinite"]

STEPS = 60
"""Steps of the interior point after which it is given up."""
REGULAR = 1e-7
"""Regularisation of the equations of a step, over the largest entry of their diagonal."""
GAP = 1e-9
"""Gap and feasibility asked for."""


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
    """Multipliers of the rows, none of them believed; matrices are symmetric."""

    equal: Array
    positive: Array
    cones: Array
    squares: tuple[Array, ...]


def solve_semidefinite(program: SemidefiniteProgram, *, work: Work) -> Multipliers | None:
    """Multipliers of the rows of a program; None where the solver broke down."""
    size = program.dimension
    weights = [
        np.ones(1),
        1.0 / _lengths(program.equal),
        1.0 / _lengths(program.positive),
        np.repeat(1.0 / _lengths(program.cones).reshape(-1, size).max(axis=1, initial=TINY), size),
    ]
    first = csr_array(([1.0], ([0], [0])), shape=(1, len(program.gain)))
    signed = [first, program.equal, -program.positive, -program.cones]
    rows = [csr_array(one.multiply(w[:, None])) for one, w in zip(signed, weights, strict=True)]
    stacked = vstack([*rows, *(-one for one in program.squares)], format="csc")
    orders = [_order(one.shape[0]) for one in program.squares]
    cones = [clarabel.ZeroConeT(1 + program.equal.shape[0])]
    if program.positive.shape[0]:
        cones.append(clarabel.NonnegativeConeT(program.positive.shape[0]))
    cones += [clarabel.SecondOrderConeT(size)] * (program.cones.shape[0] // size)
    cones += [clarabel.PSDTriangleConeT(order) for order in orders]
    bound = np.zeros(stacked.shape[0])
    bound[0] = 1.0
    none = csc_matrix((len(program.gain), len(program.gain)))
    solver = clarabel.DefaultSolver(
        none, -program.gain, csc_matrix(stacked), bound, cones, _settings(work)
    )
    answer = solver.solve()
    work.semidefinite(answer.iterations, stacked.nnz)
    z = np.array(answer.z)
    if not len(z) or not np.isfinite(z).all():
        return None
    heights = [len(w) for w in weights]
    _, equal, positive, conic, rest = np.split(z, np.cumsum(heights))
    triangles = np.split(rest, np.cumsum([one.shape[0] for one in program.squares])[:-1])
    return Multipliers(
        equal * weights[1],
        positive * weights[2],
        conic * weights[3],
        tuple(_matrix(one, order) for one, order in zip(triangles, orders, strict=True)),
    )


def _settings(work: Work) -> clarabel.DefaultSettings:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = GAP
    settings.max_iter = STEPS
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.static_regularization_constant = REGULAR
    settings.direct_solve_method = "faer"
    if work.seconds is not None:
        settings.time_limit = work.seconds
    return settings


def _lengths(rows: csr_array) -> Array:
    """Euclidean length of each row, at least `TINY`."""
    square = np.asarray(rows.multiply(rows).sum(axis=1)).ravel()
    return np.asarray(np.maximum(np.sqrt(square), TINY))


def _order(height: int) -> int:
    """K of an upper triangle of k (k + 1) / 2 numbers."""
    return round((float(np.sqrt(8.0 * height + 1.0)) - 1.0) / 2.0)


def _matrix(triangle: Array, order: int) -> Array:
    """The symmetric matrix of an upper triangle."""
    column, row = np.tril_indices(order)
    values = triangle * np.where(row == column, 1.0, np.sqrt(0.5))
    matrix = np.zeros((order, order))
    matrix[row, column] = values
    matrix[column, row] = values
    return matrix
