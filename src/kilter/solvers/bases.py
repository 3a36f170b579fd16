"""One feasible set, many costs: a simplex basis kept from solve to solve, and read.

A basis B that is optimal for one cost stays optimal for every cost whose reduced costs keep
their signs, and those are linear in the cost:

    y = B^-T c_B,    d = c - A^T y    >= 0 at a lower bound,  <= 0 at an upper
                     y                >= 0 at a lower side,   <= 0 at an upper

(the paper, equation (11)). Boxed columns keep a basis dual feasible after a change of
cost, so the dual simplex goes on from where it was.

References
----------
Mattikalli, Baraff, Khosla and Repetto (1993), section 3.1. V. Chvátal, Linear Programming,
1983, chapter 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index
from kilter.errors import SolverError
from kilter.solvers.linear import highs_model
from kilter.solvers.problem import LinearProgram

__all__ = ["BasicSolution", "CostModel"]


@dataclass(frozen=True, slots=True, eq=False)
class BasicSolution:
    """A basic optimal solution: `x`, the `multipliers` of the rows, and its `objective`."""

    x: Array
    multipliers: Array
    objective: float


class CostModel:
    """A linear program whose cost and row sides change, and nothing else.

    Parameters
    ----------
    program : LinearProgram
        Its cost is only the first.
    tolerance : float
        Feasibility tolerance, absolute in the program's own numbers.

    Attributes
    ----------
    programs : int
        How many were solved.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> box = np.ones(2)
    >>> lp = LinearProgram(
    ...     box, csc_array([[1.0, 1.0]]), np.zeros(1), np.full(1, np.inf), -box, box
    ... )
    >>> model = CostModel(lp)
    >>> model.solve(np.array([1.0, 2.0])).x
    array([ 1., -1.])
    >>> model.sensitivity(np.eye(2)) @ [1.0, 2.0]  # the basis stays optimal while these are >= 0
    array([1., 1.])
    """

    def __init__(self, program: LinearProgram, *, tolerance: float = 1e-10) -> None:
        self.programs = 0
        self._matrix = csc_array(program.matrix)
        self._columns = np.arange(len(program.cost), dtype=np.int32)
        self._upper = program.upper
        self._row_upper = program.row_upper.copy()
        # its class is not annotated
        self._highs: Any = highspy.Highs()
        for option, value in (
            ("output_flag", False),
            ("solver", "simplex"),
            ("presolve", "off"),
            ("primal_feasibility_tolerance", tolerance),
            ("dual_feasibility_tolerance", tolerance),
            ("small_matrix_value", 1e-12),
        ):
            self._highs.setOptionValue(option, value)
        if self._highs.passModel(highs_model(program)) == highspy.HighsStatus.kError:
            raise SolverError("the solver rejected the program", status="passModel")

    def solve(self, cost: Array | None = None) -> BasicSolution:
        """An optimal vertex for a cost, from the last basis on.

        Raises
        ------
        SolverError
            If no optimum is found from the last basis nor afresh.
        """
        if cost is not None:
            self._highs.changeColsCost(len(cost), self._columns, cost)
        for fresh in (False, True):
            if fresh:
                self._highs.clearSolver()
            self._highs.run()
            self.programs += 1
            status = self._highs.getModelStatus()
            if status in (highspy.HighsModelStatus.kOptimal, highspy.HighsModelStatus.kModelEmpty):
                solution = self._highs.getSolution()
                return BasicSolution(
                    np.array(solution.col_value),
                    np.array(solution.row_dual),
                    float(self._highs.getInfo().objective_function_value),
                )
        raise SolverError("the solver found no optimum", status=str(status))

    def set_rows(self, rows: Index, lower: Array, upper: Array) -> None:
        """Change the two sides of some rows."""
        self._highs.changeRowsBounds(len(rows), rows.astype(np.int32), lower, upper)
        self._row_upper[rows] = upper

    def sensitivity(self, costs: Array) -> Array:
        """How the reduced costs of the last basis depend on a few costs; (11) of the paper.

        Parameters
        ----------
        costs : ndarray, shape (k, n)

        Returns
        -------
        ndarray, shape (m, k)
            One row a nonbasic variable that is not fixed: the last basis is optimal for the
            cost t @ costs where no entry of `result @ t` is negative.
        """
        rows = self._matrix.shape[0]
        _, basic = self._highs.getBasicVariables()
        basic = np.asarray(basic, dtype=np.int64)
        held = np.where(basic >= 0, basic, 0)
        multipliers = np.empty((rows, len(costs)))
        for k, cost in enumerate(costs):
            right = np.where(basic >= 0, cost[held], 0.0)
            multipliers[:, k] = self._highs.getBasisTransposeSolve(right)[1]
        reduced = np.vstack([costs.T - self._matrix.T @ multipliers, multipliers])
        basis = self._highs.getBasis()
        status = np.array([int(s) for s in (*basis.col_status, *basis.row_status)])
        upper = int(highspy.HighsBasisStatus.kUpper)
        lower = int(highspy.HighsBasisStatus.kLower)
        sign = np.where(status == upper, -1.0, 1.0)
        fixed = np.concatenate([self._upper, self._row_upper]) == 0.0
        slopes: Array = (sign[:, None] * reduced)[((status == lower) | (status == upper)) & ~fixed]
        return slopes
