"""Linear, conic and projection problems: pure mathematics, whatever they are about.

    LinearProgram    min c.x:  L <= A x <= U,  l <= x <= u
    ConicProgram     min 1/2 x.P x + c.x:  A x + s = b,  s in {0} x (s >= 0) x cones |s_1..| <= s_0
    ConeProjection   min 1/2 |b|^2 - v.b:  R b = 0, then R b >= 0      the point of a cone nearest v

A quadratic program is a conic one without cones. Who builds a problem knows what its numbers
mean; who solves it (`kilter.solvers.highs`, `.clarabel`, `.projection`) does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array

from kilter.arrays import Array, Index

__all__ = ["ConeProjection", "ConicProgram", "LinearProgram", "quadratic_program"]


@dataclass(frozen=True, slots=True, eq=False)
class LinearProgram:
    """min cost.x: row_lower <= matrix x <= row_upper, lower <= x <= upper.

    Attributes
    ----------
    cost, lower, upper : ndarray, shape (n,)
    matrix : csc_array, shape (m, n)
    row_lower, row_upper : ndarray, shape (m,)
    """

    cost: Array
    matrix: csc_array
    row_lower: Array
    row_upper: Array
    lower: Array
    upper: Array


@dataclass(frozen=True, slots=True, eq=False)
class ConicProgram:
    """min 1/2 x.(quadratic x) + cost.x: matrix x + s = bound, s in a product of cones.

    The first `equal` rows have s = 0, the next `positive` s >= 0, then one second-order cone
    |s_1..| <= s_0 of each dimension in `cones`.

    Attributes
    ----------
    quadratic : csc_array, shape (n, n)
    cost : ndarray, shape (n,)
    matrix : csc_array, shape (m, n)
    bound : ndarray, shape (m,)
    equal, positive : int
    cones : ndarray of int
    """

    quadratic: csc_array
    cost: Array
    matrix: csc_array
    bound: Array
    equal: int
    positive: int
    cones: Index


def quadratic_program(
    quadratic: csc_array, cost: Array, matrix: csc_array, bound: Array, equal: int
) -> ConicProgram:
    """A conic program without cones: `matrix` x = bound in the first `equal` rows, then >=.

    Parameters
    ----------
    quadratic : csc_array, shape (n, n)
    cost : ndarray, shape (n,)
    matrix : csc_array, shape (m, n)
    bound : ndarray, shape (m,)
    equal : int
        How many rows are equations.
    """
    none = np.empty(0, dtype=np.int64)
    return ConicProgram(quadratic, cost, -matrix, -bound, equal, len(bound) - equal, none)


@dataclass(frozen=True, slots=True, eq=False)
class ConeProjection:
    """min 1/2 |b|^2 - load.b: rows b = 0 in the first `equal` rows, then >= 0.

    Attributes
    ----------
    rows : csr_array, shape (m, n)
        Of unit length.
    load : ndarray, shape (n,)
        What is projected.
    equal : int
    block : int
        Unknowns that belong together: they are eliminated together.
    unit : ndarray, shape (m,)
        Size of a slack of 1 of each row: what rows are weighed against each other by.
    """

    rows: csr_array
    load: Array
    equal: int
    block: int
    unit: Array

    @property
    def conic(self) -> ConicProgram:
        """The same as a conic program."""
        count, bound = len(self.load), np.zeros(len(self.unit))
        eye = csc_array(eye_array(count, format="csc"))
        return quadratic_program(eye, -self.load, csc_array(self.rows), bound, self.equal)
