"""One solution for every problem and every solver; it rechecks itself against its problem.

A solver says one of four things: "optimal"; "infeasible", no point is feasible; "unbounded";
"failed", which says nothing about the problem: an iteration or time limit, rounding, a
breakdown. None of them is believed:

    residual      how far x and the multipliers are from proving each other optimal
    bound         no feasible point costs less, rounding allowed for (linear programs)
    proves_none   the multipliers prove, by Farkas' lemma, that no point is feasible

are computed anew from the problem. "There is none" and "it was not found" are different
answers: whoever asks has to handle both.
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
    """What a solver gave back for a problem.

    Attributes
    ----------
    problem : LinearProgram or ConicProgram
        As it was when it was solved.
    outcome : {"optimal", "infeasible", "unbounded", "failed"}
        What the solver says.
    x : ndarray, shape (n,)
        The solver's point; empty if it has none, or one that is not finite.
    multipliers : ndarray, shape (m,)
        Of the rows, with the signs that the problem's class states; where the outcome is
        "infeasible", the ray that shows it; empty if there are none.
    solver : str
    iterations : int
    basis : object, optional
        Of the simplex, for a program of the same shape to start from.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> one = np.ones(1)
    >>> line = LinearProgram(one, csc_array(np.eye(1)), one, np.inf * one, 0 * one, 5 * one)
    >>> right = Solution(line, "optimal", one, one, "by hand", 0)
    >>> right.holds, round(right.bound, 12)
    (True, 1.0)
    >>> Solution(line, "optimal", 2 * one, one, "by hand", 0).holds  # whatever it says
    False
    """

    problem: LinearProgram | ConicProgram
    outcome: Outcome
    x: Array
    multipliers: Array
    solver: str
    iterations: int
    basis: Any = None

    @property
    def found(self) -> bool:
        """Whether there is a point at all; what it is worth is another matter."""
        return len(self.x) == len(self.problem.cost)

    @property
    def optimal(self) -> bool:
        """Whether there is a point that the solver calls optimal."""
        return self.found and self.outcome == "optimal"

    @cached_property
    def objective(self) -> float:
        """Cost of x; inf without a point."""
        return self.problem.objective(self.x) if self.found else np.inf

    @cached_property
    def residual(self) -> float:
        """How far x and multipliers are from being optimal, as the problem measures it [-]."""
        if not self.found or len(self.multipliers) != self.problem.matrix.shape[0]:
            return np.inf
        return self.problem.residual(self.x, self.multipliers)

    @property
    def holds(self) -> bool:
        """Whether x is optimal by its own multipliers, whatever the solver says."""
        return self.residual <= BELIEVED

    @cached_property
    def bound(self) -> float:
        """No feasible point costs less; -inf where that is all that is known."""
        if isinstance(self.problem, LinearProgram):
            return self.problem.safe_bound(self.multipliers)
        return -np.inf

    @property
    def proves_none(self) -> bool:
        """Whether the multipliers prove that no point up to `LARGEST_POINT` is feasible."""
        if len(self.multipliers) != self.problem.matrix.shape[0]:
            return False
        return self.problem.excluded(self.multipliers) >= LARGEST_POINT

    def required(self, what: str) -> Solution:
        """The solution itself, where it is called optimal.

        Raises
        ------
        SolverError
            Otherwise: for figures that no verdict rests on.
        """
        if not self.optimal:
            raise SolverError(f"no solver finished {what}", status=self.outcome)
        return self
