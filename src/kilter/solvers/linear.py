"""Linear programs, by HiGHS.

Simplex for small programs, for answers exact to rounding; the interior point HiPO for large
ones. HiGHS runs another solver without a word where HiPO's extra package is missing, so that
is asked for first, and named in the answer. What a solver says of its answer is mapped to
words and never decides a verdict.

References
----------
Q. Huangfu, J. Hall, Parallelizing the dual revised simplex method, Math. Prog. Comp. 10,
2018. F. Zanetti, J. Gondzio, A factorisation-based regularised interior point method using
the augmented system, 2025 (HiPO).
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from typing import Literal

import highspy
import numpy as np

from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.solvers.problem import LinearProgram

__all__ = ["LinearSolution", "Method", "highs_model", "hipo_available", "optimum", "solve_linear"]

WIDE = 0.1
"""Gap and dual tolerance where only a feasible point is asked for."""

Method = Literal["simplex", "interior"]
Outcome = Literal["solved", "infeasible", "unbounded", "stopped"]

_OUTCOMES: dict[highspy.HighsModelStatus, Outcome] = {
    highspy.HighsModelStatus.kOptimal: "solved",
    highspy.HighsModelStatus.kModelEmpty: "solved",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnbounded: "unbounded",
    highspy.HighsModelStatus.kUnboundedOrInfeasible: "infeasible",
}


@dataclass(frozen=True, slots=True, eq=False)
class LinearSolution:
    """What a solver gave back, unjudged.

    `x`, `multipliers` of the rows, `outcome` in words, `solver` that ran, `iterations`.
    """

    x: Array
    multipliers: Array
    objective: float
    outcome: Outcome
    solver: str
    iterations: int


def hipo_available() -> bool:
    """Whether HiGHS can run HiPO: its extra package is there."""
    return importlib.util.find_spec("highspy_extras") is not None


def solve_linear(
    program: LinearProgram,
    *,
    method: Method = "simplex",
    tolerance: float = 1e-10,
    presolve: bool = True,
    forces_only: bool = False,
    seconds: float | None = None,
) -> LinearSolution:
    """Solve a linear program.

    Parameters
    ----------
    method : {"simplex", "interior"}
    tolerance : float
        Feasibility tolerance, absolute in the program's own numbers.
    presolve : bool
    forces_only : bool
        Only a feasible x is asked for: an interior point then stops at a wide gap, which
        saves a third of its steps.
    seconds : float, optional
        Time limit.

    Raises
    ------
    SolverError
        If HiGHS rejects the program or breaks down.
    """
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    solver = "simplex"
    if method == "interior":
        solver = "hipo" if hipo_available() else "ipx"
        highs.setOptionValue("run_crossover", "off")
        if solver == "hipo":
            highs.setOptionValue("hipo_system", "normaleq")
        if forces_only:
            for option in ("ipm_optimality_tolerance", "optimality_tolerance"):
                highs.setOptionValue(option, WIDE)
    highs.setOptionValue("solver", solver)
    highs.setOptionValue("presolve", "choose" if presolve else "off")
    highs.setOptionValue("primal_feasibility_tolerance", tolerance)
    highs.setOptionValue("dual_feasibility_tolerance", WIDE if forces_only else tolerance)
    highs.setOptionValue("small_matrix_value", 1e-12)
    if seconds is not None:
        highs.setOptionValue("time_limit", seconds)
    if highs.passModel(highs_model(program)) == highspy.HighsStatus.kError:
        raise SolverError("the solver rejected the program", status="passModel")
    _run(highs)
    status = highs.getModelStatus()
    solution, info = highs.getSolution(), highs.getInfo()
    return LinearSolution(
        x=np.array(solution.col_value),
        multipliers=np.array(solution.row_dual),
        objective=float(info.objective_function_value),
        outcome=_OUTCOMES.get(status, "stopped"),
        solver=solver,
        iterations=int(max(info.simplex_iteration_count, 0) + max(info.ipm_iteration_count, 0)),
    )


def optimum(program: LinearProgram, *, method: Method = "simplex") -> LinearSolution:
    """A solution that the solver calls optimal, by other ways where the first fails.

    For figures beside a verdict; verdicts are judged, whatever the solver calls them.

    Raises
    ------
    SolverError
        If no way ends in one.
    """
    other: Method = "interior" if method == "simplex" else "simplex"
    ways: list[tuple[Method, bool]] = [(method, True), (method, False), (other, True)]
    status = ""
    for way, presolve in ways:
        answer = solve_linear(program, method=way, presolve=presolve)
        if answer.outcome == "solved" and len(answer.x):
            return answer
        status = answer.outcome
    raise SolverError("no solver finished the linear program", status=status)


def highs_model(program: LinearProgram) -> highspy.HighsLp:
    """The program as HiGHS takes it."""
    lp = highspy.HighsLp()
    lp.num_row_, lp.num_col_ = program.matrix.shape
    lp.col_cost_ = program.cost
    lp.col_lower_, lp.col_upper_ = program.lower, program.upper
    lp.row_lower_, lp.row_upper_ = program.row_lower, program.row_upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = program.matrix.indptr
    lp.a_matrix_.index_ = program.matrix.indices
    lp.a_matrix_.value_ = program.matrix.data
    return lp


def _run(highs: highspy.Highs) -> None:
    if highs.run() == highspy.HighsStatus.kError and highs.getModelStatus() in (
        highspy.HighsModelStatus.kNotset,
        highspy.HighsModelStatus.kLoadError,
        highspy.HighsModelStatus.kModelError,
    ):
        raise SolverError("the solver broke down", status=str(highs.getModelStatus()))
