"""A linear program that is kept: one cost after another, each solved from the last basis.

    min cost.x:  row_lower <= A x <= row_upper,  lower <= x <= upper

A new cost leaves the last basis primal feasible, so the primal simplex goes on from there. A
cold start is left to the dual simplex, which is faster on all that was measured; where the
new optimum is far, it also overtakes the warm one, which is therefore stopped early. What
comes back is not believed: with multipliers y of the rows and d = cost - A^T y,

    cost.x - bound(y, d)  =  sum of |y|, |d| times the distance to the bound that they pull to

is computed anew, as are the violations of rows and bounds and the signs that no bound can
answer. Where they do not vanish, the program is solved again, cold, then with another scaling.
"""

from __future__ import annotations

from dataclasses import dataclass

import highspy
import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.solvers.linear import highs_model
from kilter.solvers.problem import LinearProgram

__all__ = ["KeptProgram", "KeptSolution"]


FEASIBLE = 1e-10
"""Feasibility asked of the solver, absolute in the program's own numbers."""
BELIEVED = 1e-8
"""Violations and gaps up to this part of the numbers around them are rounding."""
DUAL, PRIMAL = 1, 4
"""Simplex strategies of HiGHS."""
FEW, MANY = 100, 20
"""Steps that a warm start may take in any case, and a cold one for each row and column."""


@dataclass(frozen=True, slots=True, eq=False)
class KeptSolution:
    """An optimum, recomputed.

    Attributes
    ----------
    x, multipliers : ndarray
        Of the columns and of the rows.
    reduced : ndarray
        cost - A^T multipliers.
    objective : float
        cost.x
    gap : float
        Worst violation of feasibility of x or of the multipliers, or the distance of the
        objective from their bound; each relative to the numbers around it [-].
    """

    x: Array
    multipliers: Array
    reduced: Array
    objective: float
    gap: float

    @property
    def holds(self) -> bool:
        """Whether x is optimal, by its own dual bound."""
        return self.gap <= BELIEVED


class KeptProgram:
    """A program whose cost, bounds and entries may change between solves.

    Parameters
    ----------
    program : LinearProgram
        Copied. Entries that are to change must be stored, even as zero.

    Attributes
    ----------
    solves : int
        How many programs were solved; repetitions of one are not counted.

    Raises
    ------
    SolverError
        If HiGHS rejects the program.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> one, two = np.ones(1), np.ones(2)
    >>> plane = LinearProgram(-two, csc_array(two[None]), -one, one, 0 * two, 5 * two)
    >>> kept = KeptProgram(plane)
    >>> kept.solve().objective
    -1.0
    >>> kept.change_cost([0, 1], [1.0, -2.0])
    >>> kept.solve().x
    array([0., 1.])
    """

    def __init__(self, program: LinearProgram) -> None:
        self.program = LinearProgram(
            program.cost.copy(),
            program.matrix.copy(),
            program.row_lower.copy(),
            program.row_upper.copy(),
            program.lower.copy(),
            program.upper.copy(),
        )
        self.solves = 0
        self._warm = False
        self._steps = 0
        highs = highspy.Highs()
        for option, value in (
            ("output_flag", False),
            ("solver", "simplex"),
            ("presolve", "off"),
            ("primal_feasibility_tolerance", FEASIBLE),
            ("dual_feasibility_tolerance", FEASIBLE),
            ("small_matrix_value", 1e-12),
        ):
            highs.setOptionValue(option, value)
        if highs.passModel(highs_model(self.program)) == highspy.HighsStatus.kError:
            raise SolverError("the solver rejected the program", status="passModel")
        self._highs = highs

    def change_cost(self, columns: ArrayLike, values: ArrayLike) -> None:
        """New costs of some columns."""
        index, cost = np.asarray(columns, dtype=np.int32), np.asarray(values, dtype=np.float64)
        self.program.cost[index] = cost
        self._highs.changeColsCost(len(index), index, cost)

    def change_bounds(self, columns: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> None:
        """New bounds of some columns."""
        index = np.asarray(columns, dtype=np.int32)
        low, high = (np.asarray(bound, dtype=np.float64) for bound in (lower, upper))
        self.program.lower[index], self.program.upper[index] = low, high
        self._highs.changeColsBounds(len(index), index, low, high)

    def change_row(self, row: int, columns: ArrayLike, values: ArrayLike) -> None:
        """New entries of a row, in columns where it has stored entries."""
        matrix = self.program.matrix
        for column, value in zip(np.asarray(columns), np.asarray(values), strict=True):
            start, stop = matrix.indptr[column : column + 2]
            place = start + int(np.flatnonzero(matrix.indices[start:stop] == row)[0])
            matrix.data[place] = value
            self._highs.changeCoeff(int(row), int(column), float(value))

    def solve(self) -> KeptSolution:
        """The optimum for the present cost and bounds, warm; cold where it does not hold.

        Raises
        ------
        SolverError
            If the solver breaks down.
        """
        self.solves += 1
        best = self._run(PRIMAL, self._steps // 4 + FEW) if self._warm else None
        for scaling in (2, 0, 4):
            if best is not None and best.holds:
                break
            self._highs.clearSolver()
            self._highs.setOptionValue("simplex_scale_strategy", scaling)
            cold = self._run(DUAL, MANY * sum(self.program.matrix.shape))
            self._steps = max(int(self._highs.getInfo().simplex_iteration_count), 0)
            best = cold if best is None or cold.gap < best.gap else best
        self._highs.setOptionValue("simplex_scale_strategy", 2)
        if best is None or not len(best.x):
            raise SolverError("the solver gave no answer", status=self._status())
        self._warm = best.holds
        return best

    def _run(self, strategy: int, steps: int) -> KeptSolution:
        self._highs.setOptionValue("simplex_strategy", strategy)
        self._highs.setOptionValue("simplex_iteration_limit", steps)
        self._highs.run()
        solution = self._highs.getSolution()
        x, multipliers = np.array(solution.col_value), np.array(solution.row_dual)
        if len(x) != len(self.program.cost) or len(multipliers) != len(self.program.row_lower):
            return KeptSolution(np.empty(0), np.empty(0), np.empty(0), np.inf, np.inf)
        return _recomputed(self.program, x, multipliers)

    def _status(self) -> str:
        return str(self._highs.getModelStatus())


def _recomputed(program: LinearProgram, x: Array, multipliers: Array) -> KeptSolution:
    """The answer with its gap: how far it is from proving itself optimal."""
    reduced = program.cost - program.matrix.T @ multipliers
    rows = program.matrix @ x
    size = 1.0 + float(np.abs(x).max(initial=0.0))
    steep = 1.0 + float(np.abs(multipliers).max(initial=0.0))
    violated = max(
        _violation(rows, program.row_lower, program.row_upper),
        _violation(x, program.lower, program.upper),
    )
    loose, wrong = zip(
        _pull(multipliers, rows, program.row_lower, program.row_upper),
        _pull(reduced, x, program.lower, program.upper),
        strict=True,
    )
    objective = float(program.cost @ x)
    gap = max(violated / size, max(wrong) / steep, sum(loose) / (1.0 + abs(objective)))
    if not np.isfinite(gap):
        gap = float("inf")
    return KeptSolution(x, multipliers, reduced, objective, gap)


def _violation(values: Array, lower: Array, upper: Array) -> float:
    return float(np.maximum(lower - values, values - upper).max(initial=0.0))


def _pull(slopes: Array, values: Array, lower: Array, upper: Array) -> tuple[float, float]:
    """Sum of slope x distance to the bound it pulls to; worst slope without such a bound."""
    bound = np.where(slopes > 0, lower, upper)
    answered = np.isfinite(bound)
    distance = np.where(answered, np.abs(values - np.where(answered, bound, 0.0)), 0.0)
    wrong = np.abs(slopes[~answered])
    return float(np.abs(slopes) @ distance), float(wrong.max(initial=0.0))
