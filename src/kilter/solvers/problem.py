"""Linear, conic and projection problems: pure mathematics, whatever they are about.

    LinearProgram    min c.x:  L <= A x <= U,  l <= x <= u
    ConicProgram     min 1/2 x.P x + c.x:  A x + s = b,  s in {0} x (s >= 0) x cones |s_1..| <= s_0
    ConeProjection   min 1/2 |b|^2 - v.b:  R b = 0, then R b >= 0      the point of a cone nearest v

A quadratic program is a conic one without cones. Who builds a problem knows what its numbers
mean; who solves it (`kilter.solvers.highs`, `.clarabel`, `.projection`) does not.

Each problem measures what a solver says of it. For any multipliers y of the rows of a linear
program, of the sign of a side that exists (others are set to 0),

    c.x >= sum of min(y_i L_i, y_i U_i) + sum of min over l_j <= x_j <= u_j of (c - A^T y)_j x_j

(Neumaier and Shcherbina 2004), computed less a bound of the errors of these sums. With c = 0 and a
right side above 0 no x is feasible; within the box |x_j| <= r, where columns have no bounds.

References
----------
A. Neumaier, O. Shcherbina, Safe bounds in linear and mixed-integer linear programming, Math.
Prog. 99, 2004, section 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array

from kilter.arrays import TINY, Array, Index
from kilter.solvers.solver_tolerances import EPSILON

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

    def objective(self, x: Array) -> float:
        """Cost of a point."""
        return float(self.cost @ x)

    def residual(self, x: Array, multipliers: Array) -> float:
        """Worst violation, of x or of the multipliers' signs, or gap between both objectives.

        With d = cost - matrix^T y the gap is the sum of |y|, |d| times the distance to the
        side that they pull to. Each is relative to the numbers around it; inf for NaN.
        """
        reduced = self.cost - _columns(self.matrix, multipliers)
        rows = _rows(self.matrix, x)
        size = 1.0 + float(np.abs(x).max(initial=0.0))
        steep = 1.0 + float(np.abs(multipliers).max(initial=0.0))
        violated = max(
            _violation(rows, self.row_lower, self.row_upper),
            _violation(x, self.lower, self.upper),
        )
        row_gap, row_sign = _pull(multipliers, rows, self.row_lower, self.row_upper)
        gap, sign = _pull(reduced, x, self.lower, self.upper)
        worst = max(
            violated / size,
            max(row_sign, sign) / steep,
            (row_gap + gap) / (1.0 + abs(self.objective(x))),
        )
        return worst if np.isfinite(worst) else np.inf

    def safe_bound(self, multipliers: Array) -> float:
        """The bound of the least cost that multipliers of the rows prove, rounding allowed for.

        Examples
        --------
        >>> one = np.ones(1)
        >>> line = LinearProgram(one, csc_array(np.eye(1)), one, np.inf * one, 0 * one, 5 * one)
        >>> round(line.safe_bound(one), 12), abs(round(line.safe_bound(-one), 12))
        (1.0, 0.0)
        """
        return _safe_bound(self, self.cost, multipliers, self.lower, self.upper)

    def excluded(self, multipliers: Array) -> float:
        """A size r for which multipliers prove that no x with all |x_j| <= r is feasible.

        inf where no bound of a column is missing; 0 where they prove nothing.

        Examples
        --------
        >>> one = np.ones(1)
        >>> none = LinearProgram(one, csc_array(np.eye(1)), 6 * one, 7 * one, 0 * one, 5 * one)
        >>> none.excluded(one), none.excluded(-one)
        (inf, 0.0)
        """
        if len(multipliers) != len(self.row_lower) or not np.isfinite(multipliers).all():
            return 0.0
        size = float(np.abs(multipliers).max(initial=0.0))
        if size == 0.0:
            return 0.0
        y, zero = multipliers / size, np.zeros(len(self.cost))
        endless = ~np.isfinite(self.lower) | ~np.isfinite(self.upper)
        for reach in (np.inf, 1e9, 1e6, 1e3):
            lower, upper = np.maximum(self.lower, -reach), np.minimum(self.upper, reach)
            if _safe_bound(self, zero, y, lower, upper) > 0:
                return reach if endless.any() else np.inf
        return 0.0


def _columns(matrix: csc_array, y: Array) -> Array:
    """matrix^T y, without the checks that take longer than a small product."""
    owner = np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
    terms = matrix.data * y[matrix.indices]
    return np.asarray(np.bincount(owner, terms, minlength=matrix.shape[1]), dtype=np.float64)


def _rows(matrix: csc_array, x: Array) -> Array:
    """Matrix x, in the same way."""
    terms = matrix.data * np.repeat(x, np.diff(matrix.indptr))
    total = np.bincount(matrix.indices, terms, minlength=matrix.shape[0])
    return np.asarray(total, dtype=np.float64)


def _violation(values: Array, lower: Array, upper: Array) -> float:
    return float(np.maximum(lower - values, values - upper).max(initial=0.0))


def _pull(slopes: Array, values: Array, lower: Array, upper: Array) -> tuple[float, float]:
    """Sum of slope x distance to the side it pulls to; worst slope without such a side."""
    side = np.where(slopes > 0, lower, upper)
    answered = np.isfinite(side)
    distance = np.where(answered, np.abs(values - np.where(answered, side, 0.0)), 0.0)
    wrong = np.abs(slopes[~answered])
    return float(np.abs(slopes) @ distance), float(wrong.max(initial=0.0))


def _safe_bound(
    program: LinearProgram, cost: Array, multipliers: Array, lower: Array, upper: Array
) -> float:
    """`LinearProgram.safe_bound` for another cost and other bounds of the columns."""
    if len(multipliers) != len(program.row_lower) or not np.isfinite(multipliers).all():
        return -np.inf
    y = np.where(np.isfinite(program.row_lower), multipliers, np.minimum(multipliers, 0.0))
    y = np.where(np.isfinite(program.row_upper), y, np.maximum(y, 0.0))
    side = np.where(y > 0, program.row_lower, program.row_upper)
    rows = y * np.where(y == 0, 0.0, side)
    matrix, width = program.matrix, len(cost)
    counts = np.diff(matrix.indptr)
    owner = np.repeat(np.arange(width), counts)
    terms = matrix.data * y[matrix.indices]
    reduced = cost - np.bincount(owner, terms, minlength=width)
    size = np.abs(cost) + np.bincount(owner, np.abs(terms), minlength=width)
    reach = np.maximum(np.abs(lower), np.abs(upper))
    with np.errstate(invalid="ignore"):  # 0 x inf: a column without bounds proves nothing
        columns = np.minimum(reduced * lower, reduced * upper)
        error = float(((counts + 3) * size) @ reach)
    error += (len(rows) + len(columns)) * float(np.abs(rows).sum() + np.abs(columns).sum())
    bound = float(rows.sum() + columns.sum()) - 2 * EPSILON * error
    return bound if np.isfinite(bound) else -np.inf


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

    def objective(self, x: Array) -> float:
        """Cost of a point."""
        return float(0.5 * (x @ (self.quadratic @ x)) + self.cost @ x)

    def residual(self, x: Array, multipliers: Array) -> float:
        """Worst of stationarity, violation and complementarity of a primal-dual pair.

        The multipliers y lie in the dual cones: 0 = quadratic x + cost + matrix^T y.
        """
        slack = self.bound - self.matrix @ x
        stationarity = self.quadratic @ x + self.cost + self.matrix.T @ multipliers
        flat, end = slice(self.equal, self.equal + self.positive), self.equal + self.positive
        worst = [
            np.abs(stationarity),
            np.abs(slack[: self.equal]),
            np.maximum(-slack[flat], 0),
            np.maximum(-multipliers[flat], 0),
            np.minimum(np.abs(slack[flat]), np.abs(multipliers[flat])),
        ]
        if len(self.cones):
            starts = end + np.concatenate([[0], np.cumsum(self.cones)[:-1]])
            s, y = slack[end:], multipliers[end:]
            product = np.abs(np.add.reduceat(s * y, starts - end))
            sizes = _beyond(s, starts - end), _beyond(y, starts - end)
            length = np.abs(slack[starts]) + np.abs(multipliers[starts])
            worst += [*sizes, product / np.maximum(length, TINY)]
        result = float(max(one.max(initial=0.0) for one in worst))
        return result if np.isfinite(result) else np.inf

    def excluded(self, multipliers: Array) -> float:
        """A size r for which multipliers prove that no x with |x|_1 < r is feasible; 0: for none.

        With y in the dual cones, 0 <= y.s = y.bound - (matrix^T y).x for every feasible x, so
        that |x|_1 max |matrix^T y| >= -y.bound.

        Examples
        --------
        >>> none = ConicProgram(  # x >= 1 and x <= -1
        ...     csc_array((1, 1)), np.zeros(1), csc_array([[-1.0], [1.0]]), -np.ones(2), 0, 2,
        ...     np.empty(0, dtype=np.int64))
        >>> none.excluded(np.ones(2)), none.excluded(-np.ones(2))
        (inf, 0.0)
        >>> none.excluded(np.array([1.0, 0.0])) < 1  # the first row alone
        True
        """
        if not np.isfinite(multipliers).all():
            return 0.0
        y, end = multipliers.copy(), self.equal + self.positive
        y[self.equal : end] = np.maximum(y[self.equal : end], 0.0)
        if len(self.cones):
            starts = end + np.concatenate([[0], np.cumsum(self.cones)[:-1]])
            y[starts] += _beyond(y[end:], starts - end)
        below = -float(self.bound @ y)
        below -= len(y) * EPSILON * float(np.abs(self.bound) @ np.abs(y))
        pull = float(np.abs(self.matrix.T @ y).max(initial=0.0))
        if below <= 0.0:
            return 0.0
        return below / pull if pull > 0.0 else np.inf


def _beyond(values: Array, starts: Index) -> Array:
    """How far |v_1..| of each run of values is beyond its v_0."""
    squares = np.add.reduceat(values * values, starts)
    first = values[starts]
    aside = np.sqrt(np.maximum(squares - first * first, 0.0))
    return np.maximum(aside - first, 0.0)


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
    place : ndarray, shape (n / block, 3)
        Of each block, for the order of elimination; a row touches two of them at most.
    """

    rows: csr_array
    load: Array
    equal: int
    block: int
    unit: Array
    place: Array

    @property
    def conic(self) -> ConicProgram:
        """The same as a conic program."""
        count, bound = len(self.load), np.zeros(len(self.unit))
        eye = csc_array(eye_array(count, format="csc"))
        return quadratic_program(eye, -self.load, csc_array(self.rows), bound, self.equal)
