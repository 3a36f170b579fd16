"""Linear programs of bounded columns, with a bound that needs no faith in the solver.

    min c.x:  L <= A x <= U,  l <= x <= u,  all l, u finite

For any multipliers y of the rows, of the sign of a bound that exists (others are set to 0),

    c.x >= sum of min(y_i L_i, y_i U_i) + sum of min over l_j <= x_j <= u_j of (c - A^T y)_j x_j

which is computed here from the y of HiGHS, less a bound of the errors of these sums: it holds
whatever the solver did. How good it is, is another matter: where it does not come near the
solver's own objective, the program is solved again, cold, then with another scaling.

References
----------
A. Neumaier, O. Shcherbina, Safe bounds in linear and mixed-integer linear programming, Math.
Prog. 99, 2004, section 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np

from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.solvers.linear import highs_model
from kilter.solvers.problem import LinearProgram

__all__ = ["BoundedSolution", "BoundedSolver", "safe_bound"]


FEASIBLE = 1e-9
"""Feasibility asked of the solver, absolute in the program's own numbers."""
NEAR = 1e-7
"""A bound this near the objective needs no second try."""
EPSILON = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class BoundedSolution:
    """A point, and a bound of the least cost that is proved.

    Attributes
    ----------
    x : ndarray
        The solver's point, unjudged; empty if there is none.
    bound : float
        No feasible point costs less; -inf if that is all that is known.
    objective : float
        Cost of x.
    basis : object
        To start from in a program of the same shape.
    """

    x: Array
    bound: float
    objective: float
    basis: Any


def safe_bound(program: LinearProgram, multipliers: Array) -> float:
    """The bound of the least cost that multipliers of the rows prove, rounding allowed for.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> one = np.ones(1)
    >>> line = LinearProgram(one, csc_array(np.eye(1)), one, np.inf * one, 0 * one, 5 * one)
    >>> round(safe_bound(line, one), 12), abs(round(safe_bound(line, -one), 12))
    (1.0, 0.0)
    """
    if len(multipliers) != len(program.row_lower) or not np.isfinite(multipliers).all():
        return -np.inf
    y = np.where(np.isfinite(program.row_lower), multipliers, np.minimum(multipliers, 0.0))
    y = np.where(np.isfinite(program.row_upper), y, np.maximum(y, 0.0))
    side = np.where(y > 0, program.row_lower, program.row_upper)
    rows = y * np.where(y == 0, 0.0, side)
    matrix, width = program.matrix, len(program.cost)
    counts = np.diff(matrix.indptr)
    owner = np.repeat(np.arange(width), counts)
    terms = matrix.data * y[matrix.indices]
    reduced = program.cost - np.bincount(owner, terms, minlength=width)
    columns = np.minimum(reduced * program.lower, reduced * program.upper)
    size = np.abs(program.cost) + np.bincount(owner, np.abs(terms), minlength=width)
    reach = np.maximum(np.abs(program.lower), np.abs(program.upper))
    error = float(((counts + 3) * size) @ reach)
    error += (len(rows) + len(columns)) * float(np.abs(rows).sum() + np.abs(columns).sum())
    bound = float(rows.sum() + columns.sum()) - 2 * EPSILON * error
    return bound if np.isfinite(bound) else -np.inf


class BoundedSolver:
    """Solves one program after another.

    Attributes
    ----------
    programs : int
        How many were solved; repetitions of one are not counted.
    """

    def __init__(self) -> None:
        self.programs = 0
        self._program: LinearProgram | None = None
        self._highs = highspy.Highs()
        for option, value in (
            ("output_flag", False),
            ("solver", "simplex"),
            ("presolve", "off"),
            ("threads", 1),
            ("primal_feasibility_tolerance", FEASIBLE),
            ("dual_feasibility_tolerance", FEASIBLE),
            ("small_matrix_value", 1e-12),
        ):
            self._highs.setOptionValue(option, value)

    def load(self, program: LinearProgram, basis: Any = None) -> None:
        """Take a program; start from a basis of another of the same shape.

        Raises
        ------
        SolverError
            If HiGHS rejects the program.
        """
        self._program = program
        if self._highs.passModel(highs_model(program)) == highspy.HighsStatus.kError:
            raise SolverError("the solver rejected the program", status="passModel")
        if basis is not None:
            self._highs.setBasis(basis)

    def solve(self, cost: Array | None = None, *, seconds: float = np.inf) -> BoundedSolution:
        """Solve the program that was loaded, for another cost if one is given."""
        assert self._program is not None
        self.programs += 1
        program = self._program
        if cost is not None:
            index = np.arange(len(cost), dtype=np.int32)
            self._highs.changeColsCost(len(cost), index, cost)
            program = LinearProgram(
                cost, program.matrix, program.row_lower, program.row_upper,
                program.lower, program.upper,
            )  # fmt: skip
            self._program = program
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + float(seconds))
        best = self._run(program)
        for scaling in (0, 4):
            if best.objective - best.bound <= NEAR * (1.0 + abs(best.objective)):
                break
            if self._highs.getModelStatus() == highspy.HighsModelStatus.kTimeLimit:
                break
            self._highs.clearSolver()
            self._highs.setOptionValue("simplex_scale_strategy", scaling)
            again = self._run(program)
            best = again if again.bound > best.bound else best
            self._highs.setOptionValue("simplex_scale_strategy", 2)
        return best

    def _run(self, program: LinearProgram) -> BoundedSolution:
        self._highs.run()
        solution = self._highs.getSolution()
        x, multipliers = np.array(solution.col_value), np.array(solution.row_dual)
        bound = safe_bound(program, multipliers) if solution.dual_valid else -np.inf
        objective = float(program.cost @ x) if len(x) == len(program.cost) else np.inf
        return BoundedSolution(x, bound, objective, self._highs.getBasis())
