"""Linear programs, by HiGHS: solved once, or kept and changed from solve to solve.

Simplex for small programs, for answers exact to rounding; the interior point HiPO for large
ones. HiGHS runs another solver without a word where HiPO's extra package is missing, so that
is asked for first, and named in the answer.

A kept program goes on from its last basis. A new cost leaves it primal feasible, so the primal
simplex goes on from there, stopped early, since a cold start by the dual simplex overtakes it
where the new optimum is far. Boxed columns keep it dual feasible too: then the dual simplex
goes on. What comes back is not believed (`kilter.solvers.solution`): where it is not good
enough, the program is solved again, cold, then with another scaling, then by the interior point.
Every run ends: steps are limited by the size of the program, and where all tries fail, that is
the answer.

A basis B that is optimal for one cost stays optimal for every cost whose reduced costs keep
their signs, and those are linear in the cost (`KeptProgram.sensitivity`):

    y = B^-T c_B,    d = c - A^T y    >= 0 at a lower bound,  <= 0 at an upper
                     y                >= 0 at a lower side,   <= 0 at an upper

References
----------
Q. Huangfu, J. Hall, Parallelizing the dual revised simplex method, Math. Prog. Comp. 10,
2018. F. Zanetti, J. Gondzio, A factorisation-based regularised interior point method using
the augmented system, 2025 (HiPO). V. Chvátal, Linear Programming, 1983, chapter 10.
Mattikalli, Baraff, Khosla and Repetto (1993), section 3.1, equation (11).
"""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from typing import Any, Literal

import highspy
import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array

from kilter.arrays import Array, Index
from kilter.solvers.interrupts import LONG, run_aside
from kilter.solvers.problem import LinearProgram
from kilter.solvers.solution import Outcome, Solution
from kilter.solvers.solver_tolerances import (
    BOUNDED_FEASIBLE,
    FEASIBLE,
    NEAR_BOUND,
    NEGLIGIBLE_ENTRY,
    WIDE,
)
from kilter.work import Work

__all__ = [
    "KeptProgram",
    "Method",
    "bounding",
    "find_optimum",
    "hipo_available",
    "near_its_bound",
    "new_highs",
    "solve_linear",
]

Method = Literal["simplex", "interior"]
Warm = Literal["primal", "dual"]

STRATEGY = {"dual": 1, "primal": 4}
"""Simplex strategies of HiGHS."""
SCALINGS = (2, 0, 4)
"""Scalings of HiGHS, in the order in which cold starts try them; the first is the usual."""
FEW, MANY = 100, 20
"""Steps that a simplex may take in any case, and further ones for each row and column."""
INTERIOR_STEPS = 300
"""Steps of an interior point; walls of 100,000 bricks take fewer than 200."""

_OUTCOMES: dict[highspy.HighsModelStatus, Outcome] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kModelEmpty: "optimal",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnbounded: "unbounded",
}


def hipo_available() -> bool:
    """Whether HiGHS can run HiPO: its extra package is there."""
    return importlib.util.find_spec("highspy_extras") is not None


def solve_linear(
    program: LinearProgram,
    *,
    method: Method = "simplex",
    tolerance: float = FEASIBLE,
    presolve: bool = True,
    forces_only: bool = False,
    work: Work | None = None,
) -> Solution:
    """Solve a linear program once, cold.

    Parameters
    ----------
    program : LinearProgram
    method : {"simplex", "interior"}
    tolerance : float
        Feasibility tolerance, absolute in the program's own numbers.
    presolve : bool
    forces_only : bool
        Only a feasible x is asked for: an interior point then stops at a wide gap, which
        saves a third of its steps.
    work : Work, optional
        Its time limit is kept.
    """
    highs, solver = new_highs(tolerance), "simplex"
    if method == "interior":
        solver = "hipo" if hipo_available() else "ipx"
        highs.setOptionValue("run_crossover", "off")
        highs.setOptionValue("ipm_iteration_limit", INTERIOR_STEPS)
        if solver == "hipo":
            highs.setOptionValue("hipo_system", "normaleq")
        if forces_only:
            for option in ("ipm_optimality_tolerance", "optimality_tolerance"):
                highs.setOptionValue(option, WIDE)
    highs.setOptionValue("solver", solver)
    highs.setOptionValue("presolve", "choose" if presolve else "off")
    if forces_only:
        highs.setOptionValue("dual_feasibility_tolerance", WIDE)
    highs.setOptionValue("simplex_iteration_limit", _steps(program))
    if work is not None and work.seconds is not None:
        highs.setOptionValue("time_limit", work.seconds)
    _passed(highs, program)
    _run(highs, program)
    if highs.getModelStatus() == highspy.HighsModelStatus.kUnboundedOrInfeasible:
        highs.setOptionValue("presolve", "off")  # which is all that presolve found out
        _run(highs, program)
    return _solution(highs, program, solver)


def find_optimum(
    program: LinearProgram, *, method: Method = "simplex", work: Work | None = None
) -> Solution:
    """A solution that the solver calls optimal, by other ways where the first fails.

    With and without presolve, by the other method, then with other scalings. For figures
    beside a verdict; verdicts are judged, whatever the solver calls them.
    """
    other: Method = "interior" if method == "simplex" else "simplex"
    ways: list[tuple[Method, bool]] = [(method, True), (method, False), (other, True)]
    for way, presolve in ways:
        answer = solve_linear(program, method=way, presolve=presolve, work=work)
        if answer.optimal:
            return answer
    return KeptProgram(program).solve(work=work)


def near_its_bound(solution: Solution) -> bool:
    """Whether the safe bound comes near the objective."""
    near = NEAR_BOUND * (1.0 + abs(solution.objective))
    return solution.found and solution.objective - solution.bound <= near


class KeptProgram:
    """A program that is kept: its cost, bounds, sides and entries may change between solves.

    Parameters
    ----------
    program : LinearProgram
        Entries that are to change must be stored, even as zero.
    warm : {"primal", "dual"}
        Simplex from the last basis: dual where all columns are boxed, or only sides change.
    tolerance : float
        Feasibility asked of the solver, absolute in the program's own numbers.
    goal : {"optimum", "bound", "point"}
        What has to be good enough for a solution not to be looked for again: its residual, its
        safe bound, or what the solver calls it, for points that are judged by who asks.

    Attributes
    ----------
    program : LinearProgram
        As it is now; never changed in place.
    solves : int
        How many programs were solved; repetitions of one are not counted.

    Examples
    --------
    >>> one, two = np.ones(1), np.ones(2)
    >>> plane = LinearProgram(-two, csc_array(two[None]), -one, one, 0 * two, 5 * two)
    >>> kept = KeptProgram(plane)
    >>> kept.solve().objective
    -1.0
    >>> kept.change_cost([0, 1], [1.0, -2.0])
    >>> kept.solve().x
    array([0., 1.])
    """

    def __init__(
        self,
        program: LinearProgram | None = None,
        *,
        warm: Warm = "primal",
        tolerance: float = FEASIBLE,
        goal: Literal["optimum", "bound", "point"] = "optimum",
    ) -> None:
        self.solves = 0
        self._warm: Warm = warm
        self._goal = goal
        self._steps = 0
        self._based = False
        self._options: dict[str, float] = {}
        self._highs = new_highs(tolerance)
        self._highs.setOptionValue("solver", "simplex")
        self._highs.setOptionValue("presolve", "off")
        if program is not None:
            self.load(program)

    def load(self, program: LinearProgram, basis: Any = None) -> None:
        """Take another program; start from a basis of one of the same shape."""
        self.program = program
        _passed(self._highs, program)
        self._based = basis is not None
        if basis is not None:
            self._highs.setBasis(basis)

    def change_cost(self, columns: ArrayLike, values: ArrayLike) -> None:
        """New costs of some columns."""
        index, cost = np.asarray(columns, dtype=np.int64), np.asarray(values, dtype=np.float64)
        self.program = replace(self.program, cost=_with(self.program.cost, index, cost))
        self._highs.changeColsCost(len(index), index.astype(np.int32), cost)

    def change_bounds(self, columns: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> None:
        """New bounds of some columns."""
        index = np.asarray(columns, dtype=np.int64)
        low, high = (np.asarray(bound, dtype=np.float64) for bound in (lower, upper))
        now = self.program
        self.program = replace(
            now, lower=_with(now.lower, index, low), upper=_with(now.upper, index, high)
        )
        self._highs.changeColsBounds(len(index), index.astype(np.int32), low, high)

    def change_sides(self, rows: Index, lower: Array, upper: Array) -> None:
        """New sides of some rows."""
        now = self.program
        self.program = replace(
            now,
            row_lower=_with(now.row_lower, rows, lower),
            row_upper=_with(now.row_upper, rows, upper),
        )
        self._highs.changeRowsBounds(len(rows), rows.astype(np.int32), lower, upper)

    def change_row(self, row: int, columns: ArrayLike, values: ArrayLike) -> None:
        """New entries of a row, in columns where it has stored entries."""
        matrix = csc_array(self.program.matrix.copy())
        for column, value in zip(np.asarray(columns), np.asarray(values), strict=True):
            start, stop = matrix.indptr[column : column + 2]
            place = start + int(np.flatnonzero(matrix.indices[start:stop] == row)[0])
            matrix.data[place] = value
            self._highs.changeCoeff(int(row), int(column), float(value))
        self.program = replace(self.program, matrix=matrix)

    def solve(self, cost: Array | None = None, *, work: Work | None = None) -> Solution:
        """The optimum as the program is now: warm first, cold where that is not good enough.

        Parameters
        ----------
        cost : ndarray, shape (n,), optional
            Another cost of all columns.
        work : Work, optional
            It is charged; steps of the simplex end where nothing of it is left, and its time
            limit is kept.
        """
        if cost is not None:
            self.change_cost(np.arange(len(cost)), cost)
        self.solves += 1
        limit = None if work is None else work.seconds
        self._set("time_limit", np.inf if limit is None else self._highs.getRunTime() + limit)
        tries = []
        if self._based:
            steps = _steps(self.program)
            if self._warm == "primal":
                steps = self._steps // 4 + FEW
            tries.append(self._run(self._warm, steps, work))
        for scaling in SCALINGS:
            if tries and (self._enough(tries[-1]) or (work is not None and work.over)):
                break
            self._highs.clearSolver()
            self._set("simplex_scale_strategy", scaling)
            tries.append(self._run("dual", _steps(self.program), work))
            self._steps = tries[-1].iterations
        self._set("simplex_scale_strategy", SCALINGS[0])
        if self._goal != "bound" and all(one.outcome == "failed" for one in tries):
            tries.append(self._by_interior(work))
        best = tries[0]
        if len(tries) > 1:
            bound = self._goal == "bound"
            best = min(tries, key=lambda one: -one.bound if bound else one.residual)
        self._based = best.basis is not None and self._enough(best)
        if not best.optimal and len({one.outcome for one in tries}) > 1:
            best = replace(best, outcome="failed")  # the tries contradict each other
        return best

    def _by_interior(self, work: Work | None) -> Solution:
        """The other method, where no simplex came to an end."""
        if work is not None and work.over:
            return Solution(self.program, "failed", np.empty(0), np.empty(0), "none", 0)
        answer = solve_linear(self.program, method="interior", work=work)
        if work is not None:
            work.linear(answer.iterations, self.program.matrix.nnz)
        return answer

    def _enough(self, solution: Solution) -> bool:
        if self._goal == "bound":
            return near_its_bound(solution)
        return solution.optimal if self._goal == "point" else solution.holds

    def _run(self, strategy: Warm, steps: int, work: Work | None) -> Solution:
        entries = self.program.matrix.nnz
        self._set("simplex_strategy", STRATEGY[strategy])
        self._set("simplex_iteration_limit", steps if work is None else work.steps(steps, entries))
        _run(self._highs, self.program)
        answer = _solution(self._highs, self.program, "simplex")
        if work is not None:
            work.linear(answer.iterations, entries)
        return answer

    def _set(self, option: str, value: float) -> None:
        """An option of HiGHS, where it is not what it was."""
        if self._options.get(option) != value:
            self._highs.setOptionValue(option, value)
            self._options[option] = value

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

        Examples
        --------
        >>> box = np.ones(2)
        >>> lp = LinearProgram(
        ...     box, csc_array([[1.0, 1.0]]), np.zeros(1), np.full(1, np.inf), -box, box)
        >>> kept = KeptProgram(lp, warm="dual")
        >>> kept.solve(np.array([1.0, 2.0])).x
        array([ 1., -1.])
        >>> kept.sensitivity(np.eye(2)) @ [1.0, 2.0]  # optimal while these are >= 0
        array([1., 1.])
        """
        program, rows = self.program, self.program.matrix.shape[0]
        _, basic = self._highs.getBasicVariables()
        basic = np.asarray(basic, dtype=np.int64)
        column = np.where(basic >= 0, basic, 0)
        multipliers = np.empty((rows, len(costs)))
        for k, cost in enumerate(costs):
            right = np.where(basic >= 0, cost[column], 0.0)
            multipliers[:, k] = self._highs.getBasisTransposeSolve(right)[1]
        reduced = np.vstack([costs.T - program.matrix.T @ multipliers, multipliers])
        basis = self._highs.getBasis()
        status = np.array([int(s) for s in (*basis.col_status, *basis.row_status)])
        upper = int(highspy.HighsBasisStatus.kUpper)
        lower = int(highspy.HighsBasisStatus.kLower)
        sign = np.where(status == upper, -1.0, 1.0)
        fixed = np.concatenate([program.upper, program.row_upper]) == 0.0
        slopes: Array = (sign[:, None] * reduced)[((status == lower) | (status == upper)) & ~fixed]
        return slopes


def bounding() -> KeptProgram:
    """For one program after another of boxed columns, where safe bounds are what counts."""
    return KeptProgram(warm="dual", tolerance=BOUNDED_FEASIBLE, goal="bound")


def _with(values: Array, index: Index, new: Array) -> Array:
    changed = values.copy()
    changed[index] = new
    return changed


def new_highs(tolerance: float) -> Any:
    """HiGHS with the options that every program here has; its class is not annotated."""
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("parallel", "off")  # no bit of an answer depends on the machine
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("primal_feasibility_tolerance", tolerance)
    highs.setOptionValue("dual_feasibility_tolerance", tolerance)
    highs.setOptionValue("small_matrix_value", NEGLIGIBLE_ENTRY)
    return highs


def _passed(highs: Any, program: LinearProgram) -> None:
    """Hand a program over; what HiGHS rejects it then has no answer for."""
    rows, columns = program.matrix.shape
    start, index, value = program.matrix.indptr, program.matrix.indices, program.matrix.data
    colwise, least = int(highspy.MatrixFormat.kColwise), int(highspy.ObjSense.kMinimize)
    none_integer = np.zeros(columns, dtype=np.int32)
    # as arrays: a HighsLp takes them number by number, five times as long
    highs.passModel(
        columns, rows, len(value), colwise, least, 0.0,
        program.cost, program.lower, program.upper, program.row_lower, program.row_upper,
        start.astype(np.int32, copy=False), index.astype(np.int32, copy=False), value, none_integer,
    )  # fmt: skip


def _run(highs: Any, program: LinearProgram) -> None:
    """Solve what was handed over; beside the main thread where it may take long."""
    if program.matrix.nnz < LONG:
        highs.run()
        return
    if not highs.HandleUserInterrupt:  # each time that it is set, one more is asked at every step
        highs.HandleUserInterrupt = True
    run_aside(highs.run, highs.cancelSolve)


def _steps(program: LinearProgram) -> int:
    """Steps after which a simplex is given up."""
    return FEW + MANY * (len(program.row_lower) + len(program.cost))


def _solution(highs: Any, program: LinearProgram, solver: str) -> Solution:
    """What HiGHS has to say after a run."""
    status = highs.getModelStatus()
    outcome = _OUTCOMES.get(status, "failed")
    solution, info = highs.getSolution(), highs.getInfo()
    x, multipliers = np.array(solution.col_value), np.array(solution.row_dual)
    if len(x) != len(program.cost) or not np.isfinite(x).all():
        x, outcome = np.empty(0), "failed" if outcome == "optimal" else outcome
    if outcome == "infeasible":
        # where no run has left a ray, HiGHS would solve the program again for it
        shown = solver == "simplex" and highs.getDualRayExist()[1]
        multipliers = np.array(highs.getDualRay()[2]) if shown else np.empty(0)
    steps = max(info.simplex_iteration_count, 0) + max(info.ipm_iteration_count, 0)
    basis = highs.getBasis() if solver == "simplex" else None
    return Solution(program, outcome, x, multipliers, solver, int(steps), basis)
