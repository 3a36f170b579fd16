"""Linear, conic and projection problems as mathematics, without solvers and physics.

    LinearProgram    min c.x:  L <= A x <= U,  l <= x <= u
    ConicProgram     min 1/2 x.P x + c.x:  A x + s = b,  s in {0} x (s >= 0) x cones |s_1..| <= s_0
    ConeProjection   min 1/2 |b|^2 - v.b:  R b = 0, then R b >= 0      the point of a cone nearest v

A quadratic program is a conic program without cones. The code that builds a problem knows the
meaning of its numbers; the solvers (`kilter.solvers.highs`, `.clarabel`, `.projection`) do not.

Each problem can check a solver's answer. For any multipliers y of the rows of a linear program,
with the sign of a side that exists (others are set to 0),

    c.x >= sum of min(y_i L_i, y_i U_i) + sum of min over l_j <= x_j <= u_j of (c - A^T y)_j x_j

(Neumaier and Shcherbina 2004). The right side is computed and reduced by a bound of its rounding
errors. If it is above 0 for c = 0, no x is feasible; columns without bounds are restricted to a box
|x_j| <= r for this.

References
----------
A. Neumaier, O. Shcherbina, Safe bounds in linear and mixed-integer linear programming, Math. Prog.
99, 2004, section 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array

from kilter.arrays import TINY, Array, Index
from kilter.errors import SolverError
from kilter.solvers.solver_tolerances import BELIEVED, EPSILON, LARGEST_POINT


def with_columns(matrix: csc_array, columns: Sequence[Array]) -> csc_array:
    """A sparse matrix with further columns on its right, which store their nonzero entries.

    Examples
    --------
    >>> with_columns(csc_array(np.eye(2)), [np.array([0.0, 3.0])]).toarray()
    array([[1., 0., 0.],
           [0., 1., 3.]])
    """
    used = [np.flatnonzero(column) for column in columns]
    data = [column[rows] for column, rows in zip(columns, used, strict=True)]
    counts = np.cumsum([len(rows) for rows in used])
    return csc_array(
        (
            np.concatenate([matrix.data, *data]),
            np.concatenate([matrix.indices, *used]),
            np.concatenate([matrix.indptr, matrix.indptr[-1] + counts]),
        ),
        shape=(matrix.shape[0], matrix.shape[1] + len(columns)),
    )


@dataclass(frozen=True, slots=True, eq=False)
class LinearProgram:
    """Linear program: min cost.x with row_lower <= matrix x <= row_upper, lower <= x <= upper."""

    cost: Array
    matrix: csc_array
    """Shape (m, n)."""
    row_lower: Array
    row_upper: Array
    """Sides of the rows, shape (m,)."""
    lower: Array
    upper: Array
    """Cost and bounds of the columns, shape (n,)."""

    def objective(self, x: Array) -> float:
        """Cost of a point x of a linear program."""
        return float(self.cost @ x)

    def residual(self, x: Array, multipliers: Array) -> float:
        """Largest relative violation of optimality by a point and multipliers [-]; inf for NaN.

        It is the largest of three numbers: the violation of bounds and sides by x; multipliers of
        the wrong sign; and the gap between both objectives. With d = cost - matrix^T y, the gap is
        the sum of |y| and |d| times the distance to the side or bound of their sign. Each number is
        relative to the magnitudes involved.
        """
        reduced = self.cost - _transposed_product(self.matrix, multipliers)
        rows = _product(self.matrix, x)
        size = 1.0 + float(np.abs(x).max(initial=0.0))
        multiplier_size = 1.0 + float(np.abs(multipliers).max(initial=0.0))
        violated = max(
            _violation(rows, self.row_lower, self.row_upper),
            _violation(x, self.lower, self.upper),
        )
        row_gap, row_sign = _gap(multipliers, rows, self.row_lower, self.row_upper)
        gap, sign = _gap(reduced, x, self.lower, self.upper)
        worst = max(
            violated / size,
            max(row_sign, sign) / multiplier_size,
            (row_gap + gap) / (1.0 + abs(self.objective(x))),
        )
        return worst if np.isfinite(worst) else np.inf

    def safe_bound(self, multipliers: Array) -> float:
        """Lower bound of the optimal cost that multipliers of the rows prove, rounding included.

        Examples
        --------
        >>> ones = np.ones(1)
        >>> line = LinearProgram(
        ...     ones, csc_array(np.eye(1)), ones, np.inf * ones, 0 * ones, 5 * ones)
        >>> round(line.safe_bound(ones), 12), abs(round(line.safe_bound(-ones), 12))
        (1.0, 0.0)
        """
        return _safe_bound(self, self.cost, multipliers, self.lower, self.upper)

    def excluded(self, multipliers: Array) -> float:
        """A radius r such that multipliers prove that no feasible x has all |x_j| <= r.

        inf if every column has bounds; 0 if the multipliers prove nothing.

        Examples
        --------
        >>> ones = np.ones(1)
        >>> empty = LinearProgram(
        ...     ones, csc_array(np.eye(1)), 6 * ones, 7 * ones, 0 * ones, 5 * ones)
        >>> empty.excluded(ones), empty.excluded(-ones)
        (inf, 0.0)
        """
        if len(multipliers) != len(self.row_lower) or not np.isfinite(multipliers).all():
            return 0.0
        size = float(np.abs(multipliers).max(initial=0.0))
        if size == 0.0:
            return 0.0
        # multipliers that prove infeasibility do so at any scale
        y, zero = multipliers / size, np.zeros(len(self.cost))
        unbounded = ~np.isfinite(self.lower) | ~np.isfinite(self.upper)
        for radius in (np.inf, 1e9, 1e6, 1e3):
            lower, upper = np.maximum(self.lower, -radius), np.minimum(self.upper, radius)
            # with cost 0 every feasible x has the objective 0, so a bound above 0 excludes them all
            if _safe_bound(self, zero, y, lower, upper) > 0:
                return radius if unbounded.any() else np.inf
        return 0.0


def _transposed_product(matrix: csc_array, y: Array) -> Array:
    """Product matrix^T y, without scipy's argument checks, which dominate for small matrices."""
    owner = np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
    terms = matrix.data * y[matrix.indices]
    return np.asarray(np.bincount(owner, terms, minlength=matrix.shape[1]), dtype=np.float64)


def _product(matrix: csc_array, x: Array) -> Array:
    """Product matrix x, without scipy's argument checks."""
    terms = matrix.data * np.repeat(x, np.diff(matrix.indptr))
    total = np.bincount(matrix.indices, terms, minlength=matrix.shape[0])
    return np.asarray(total, dtype=np.float64)


def _violation(values: Array, lower: Array, upper: Array) -> float:
    """Largest amount by which values lie outside their bounds; 0 inside."""
    return float(np.maximum(lower - values, values - upper).max(initial=0.0))


def _gap(slopes: Array, values: Array, lower: Array, upper: Array) -> tuple[float, float]:
    """Duality gap (sum of |slope| times the distance to the bound), and largest unbounded slope.

    A positive slope belongs to the lower bound, a negative slope to the upper bound.
    """
    side = np.where(slopes > 0, lower, upper)
    bounded = np.isfinite(side)
    distance = np.where(bounded, np.abs(values - np.where(bounded, side, 0.0)), 0.0)
    unbounded = np.abs(slopes[~bounded])
    return float(np.abs(slopes) @ distance), float(unbounded.max(initial=0.0))


def _safe_bound(
    program: LinearProgram, cost: Array, multipliers: Array, lower: Array, upper: Array
) -> float:
    """Lower bound of the optimal cost that multipliers prove, for other cost and bounds."""
    if len(multipliers) != len(program.row_lower) or not np.isfinite(multipliers).all():
        return -np.inf
    # a multiplier of a side that does not exist is set to 0
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
    with np.errstate(invalid="ignore"):  # 0 x inf is NaN: a column without bounds proves nothing
        columns = np.minimum(reduced * lower, reduced * upper)
        # a sum of n products is off by at most about n EPSILON times the sum of their sizes
        error = float(((counts + 3) * size) @ reach)
    error += (len(rows) + len(columns)) * float(np.abs(rows).sum() + np.abs(columns).sum())
    bound = float(rows.sum() + columns.sum()) - 2 * EPSILON * error
    return bound if np.isfinite(bound) else -np.inf


@dataclass(frozen=True, slots=True, eq=False)
class ConicProgram:
    """Conic program: min 1/2 x.(quadratic x) + cost.x with matrix x + s = bound, s in cones.

    The first `equal` rows have s = 0, the next `positive` rows s >= 0. A second-order cone
    |s_1..| <= s_0 of each dimension in `cones` follows.
    """

    quadratic: csc_array
    """Shape (n, n)."""
    cost: Array
    """Shape (n,)."""
    matrix: csc_array
    """Shape (m, n)."""
    bound: Array
    """Shape (m,)."""
    equal: int
    positive: int
    """Numbers of equations and of inequalities."""
    cones: Index
    """Dimension of each second-order cone."""

    def objective(self, x: Array) -> float:
        """Cost of a point x of a conic program."""
        return float(0.5 * (x @ (self.quadratic @ x)) + self.cost @ x)

    def residual(self, x: Array, multipliers: Array) -> float:
        """Largest violation of stationarity, feasibility and complementarity by x and multipliers.

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
            sizes = _cone_excess(s, starts - end), _cone_excess(y, starts - end)
            length = np.abs(slack[starts]) + np.abs(multipliers[starts])
            worst += [*sizes, product / np.maximum(length, TINY)]
        result = float(max(residuals.max(initial=0.0) for residuals in worst))
        return result if np.isfinite(result) else np.inf

    def excluded(self, multipliers: Array) -> float:
        """A radius r such that multipliers prove that no feasible x has |x|_1 < r; 0 without proof.

        For y in the dual cones, 0 <= y.s = y.bound - (matrix^T y).x for every feasible x, so |x|_1
        max |matrix^T y| >= -y.bound.

        Examples
        --------
        >>> empty = ConicProgram(  # x >= 1 and x <= -1
        ...     csc_array((1, 1)), np.zeros(1), csc_array([[-1.0], [1.0]]), -np.ones(2), 0, 2,
        ...     np.empty(0, dtype=np.int64))
        >>> empty.excluded(np.ones(2)), empty.excluded(-np.ones(2))
        (inf, 0.0)
        >>> empty.excluded(np.array([1.0, 0.0])) < 1  # the first row alone
        True
        """
        if not np.isfinite(multipliers).all():
            return 0.0
        y, end = multipliers.copy(), self.equal + self.positive
        y[self.equal : end] = np.maximum(y[self.equal : end], 0.0)
        if len(self.cones):
            starts = end + np.concatenate([[0], np.cumsum(self.cones)[:-1]])
            y[starts] += _cone_excess(y[end:], starts - end)
        gain = -float(self.bound @ y)
        # a bound of the rounding errors of the product
        gain -= len(y) * EPSILON * float(np.abs(self.bound) @ np.abs(y))
        slope = float(np.abs(self.matrix.T @ y).max(initial=0.0))
        if gain <= 0.0:
            return 0.0
        return gain / slope if slope > 0.0 else np.inf


def _cone_excess(values: Array, starts: Index) -> Array:
    """Amount by which |v_1..| exceeds v_0 in each cone, from stacked values; 0 inside the cone."""
    squares = np.add.reduceat(values * values, starts)
    first = values[starts]
    tail = np.sqrt(np.maximum(squares - first * first, 0.0))
    return np.maximum(tail - first, 0.0)


def quadratic_program(
    quadratic: csc_array, cost: Array, matrix: csc_array, bound: Array, equal: int
) -> ConicProgram:
    """Write a quadratic program in conic form: `equal` equations first, then inequalities >=.

    Arguments: `quadratic` (n, n); `cost` (n,); `matrix` (m, n); `bound` (m,).
    """
    no_cones = np.empty(0, dtype=np.int64)
    return ConicProgram(quadratic, cost, -matrix, -bound, equal, len(bound) - equal, no_cones)


@dataclass(frozen=True, slots=True, eq=False)
class ConeProjection:
    """Projection of a load on the polyhedral cone {b : rows b >= 0}: min 1/2 |b|^2 - load.b."""

    rows: csr_array
    """Rows of unit length, shape (m, n)."""
    load: Array
    """The projected vector, shape (n,)."""
    equal: int
    """Number of equations."""
    block: int
    """Number of unknowns per block; a block is eliminated as a unit."""
    unit: Array
    """Physical size of a unit slack of each row, by which the rows are weighted, shape (m,)."""
    place: Array
    """Position of each block in space, for the order of elimination, shape (n / block, 3); a row
    touches at most two."""

    @property
    def conic(self) -> ConicProgram:
        """The projection problem as a conic program."""
        count, bound = len(self.load), np.zeros(len(self.unit))
        identity = csc_array(eye_array(count, format="csc"))
        return quadratic_program(identity, -self.load, csc_array(self.rows), bound, self.equal)


# The result type of all solvers; it checks itself against its problem.


Outcome = Literal["optimal", "infeasible", "unbounded", "failed"]


@dataclass(frozen=True, eq=False)
class Solution:
    """Result of a solver for a problem: status, point x and multipliers; unverified.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> ones = np.ones(1)
    >>> line = LinearProgram(
    ...     ones, csc_array(np.eye(1)), ones, np.inf * ones, 0 * ones, 5 * ones)
    >>> right = Solution(line, "optimal", ones, ones, "by hand", 0)
    >>> right.holds, round(right.bound, 12)
    (True, 1.0)
    >>> Solution(line, "optimal", 2 * ones, ones, "by hand", 0).holds  # the report is wrong
    False
    """

    problem: LinearProgram | ConicProgram
    """The problem as it was when solved."""
    outcome: Outcome
    """One of "optimal", "infeasible", "unbounded", "failed". Outcome as reported by the solver."""
    x: Array
    """The solver's point, shape (n,); empty without a finite point."""
    multipliers: Array
    """Multipliers of the rows, with the signs that the problem's class states, shape (m,). For
    the outcome "infeasible", a dual ray as evidence. Empty without multipliers."""
    solver: str
    """Name of the solver."""
    iterations: int
    basis: Any = None
    """Simplex basis, as a start for a program of the same shape."""

    @property
    def found(self) -> bool:
        """True if the solver returned a point, of any quality."""
        return len(self.x) == len(self.problem.cost)

    @property
    def optimal(self) -> bool:
        """True if the solver returned a point that it reports as optimal."""
        return self.found and self.outcome == "optimal"

    @cached_property
    def objective(self) -> float:
        """Cost of the solver's point x; inf without a point."""
        return self.problem.objective(self.x) if self.found else np.inf

    @cached_property
    def residual(self) -> float:
        """Largest violation of optimality by x and the multipliers [-]; inf without x."""
        if not self.found or len(self.multipliers) != self.problem.matrix.shape[0]:
            return np.inf
        return self.problem.residual(self.x, self.multipliers)

    @property
    def holds(self) -> bool:
        """True if the multipliers prove x optimal, whatever status the solver reports."""
        return self.residual <= BELIEVED

    @cached_property
    def bound(self) -> float:
        """Proved lower bound of the optimal cost; -inf without a proof."""
        if isinstance(self.problem, LinearProgram):
            return self.problem.safe_bound(self.multipliers)
        return -np.inf

    @property
    def proves_none(self) -> bool:
        """True if the multipliers prove the problem infeasible for points up to `LARGEST_POINT`."""
        if len(self.multipliers) != self.problem.matrix.shape[0]:
            return False
        return self.problem.excluded(self.multipliers) >= LARGEST_POINT

    def required(self, what: str) -> Solution:
        """The solution if the solver reports it as optimal; else raises `SolverError`.

        Raises `SolverError` if the solution is not optimal.
        """
        if not self.optimal:
            raise SolverError(f"no solver finished {what}", status=self.outcome)
        return self
