"""The result type of all solvers; it checks itself against its problem.

A solver reports an outcome: "optimal"; "infeasible", no point is feasible; "unbounded"; or
"failed", which states nothing about the problem: an iteration or time limit, rounding, a breakdown.
The outcome is not trusted:

    residual      how far x and the multipliers are from proving each other optimal
    bound         no feasible point costs less, including rounding errors (linear programs)
    proves_none   the multipliers prove, by Farkas' lemma, that no point is feasible

are recomputed from the problem. "Infeasible" and "failed" are different answers, and callers must
handle both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.solvers.problem import ConicProgram, LinearProgram
from kilter.solvers.solver_tolerances import BELIEVED, LARGEST_POINT

__all__ = ["Outcome", "Solution"]

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
