"""Conic programs: linear rows and second-order cones, by Clarabel.

A status is mapped to one of three outcomes and never passed on: what the numbers are worth
is judged by who asked (`kilter.mechanics.certificate`).

References
----------
P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, 2024.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import clarabel
import numpy as np
from scipy.sparse import csc_matrix

from kilter.arrays import Array
from kilter.solvers.problem import ConicProgram

__all__ = ["ConicSolution", "solve_conic"]

Outcome = Literal["optimal", "infeasible", "unfinished"]

TOLERANCE = 1e-10
"""Gap and feasibility asked for."""
ITERATIONS = 100
"""Steps after which the search is given up."""

OUTCOMES: dict[str, Outcome] = {
    "Solved": "optimal",
    "AlmostSolved": "optimal",
    "PrimalInfeasible": "infeasible",
    "AlmostPrimalInfeasible": "infeasible",
}


@dataclass(frozen=True, slots=True, eq=False)
class ConicSolution:
    """Unknowns, multipliers of the rows and slacks of a conic program.

    `multipliers` y lie in the dual cones: 0 = quadratic x + cost + matrix^T y at an optimum;
    where it is infeasible, y is the ray that shows it (matrix^T y = 0, bound.y < 0).
    """

    x: Array
    multipliers: Array
    slack: Array
    outcome: Outcome
    iterations: int


def solve_conic(
    program: ConicProgram, *, tolerance: float = TOLERANCE, seconds: float | None = None
) -> ConicSolution:
    """Minimise a convex quadratic over linear rows and second-order cones.

    Parameters
    ----------
    program : ConicProgram
    tolerance : float
        Gap and feasibility, absolute and relative [-].
    seconds : float, optional
        Time limit.

    Examples
    --------
    >>> from scipy.sparse import csc_array, eye_array
    >>> nearest = ConicProgram(  # the point of the cone t >= |v| nearest to (0, 2)
    ...     csc_array(eye_array(2)), np.array([0.0, -2.0]), csc_array(-eye_array(2)),
    ...     np.zeros(2), 0, 0, np.array([2]))
    >>> np.round(solve_conic(nearest).x, 6)
    array([1., 1.])
    """
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    settings.max_iter = ITERATIONS
    settings.direct_solve_method = "qdldl"  # on walls twice as fast as what it would choose
    if seconds is not None:
        settings.time_limit = max(seconds, 1e-3)
    cones: list[object] = []
    if program.equal:
        cones.append(clarabel.ZeroConeT(program.equal))
    if program.positive:
        cones.append(clarabel.NonnegativeConeT(program.positive))
    cones += [clarabel.SecondOrderConeT(int(size)) for size in program.cones]
    solver = clarabel.DefaultSolver(
        csc_matrix(program.quadratic),
        program.cost,
        csc_matrix(program.matrix),
        program.bound,
        cones,
        settings,
    )
    answer = solver.solve()
    return ConicSolution(
        np.array(answer.x),
        np.array(answer.z),
        np.array(answer.s),
        OUTCOMES.get(str(answer.status), "unfinished"),
        answer.iterations,
    )
