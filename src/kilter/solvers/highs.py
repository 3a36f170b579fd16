"""Solve linear programs by HiGHS, once or with changes between successive solves.

Small programs use the simplex method, whose answers are exact to rounding. Large programs use the
interior point HiPO. If HiPO's extra package is missing, HiGHS silently runs another solver, so the
package is looked up first, and the answer names the solver.

A kept program continues from its last basis. A new cost leaves that basis primal feasible, so the
primal simplex continues, with a low step limit, because a cold start of the dual simplex is faster
if the new optimum is far away. With boxed columns the basis also stays dual feasible; then the dual
simplex continues. Every answer is checked (`kilter.solvers.problem`). If it is not good enough,
the program is solved again: from a cold start, then with another scaling, then by the interior
point. The number of steps is limited by the size of the program. If every attempt fails, the
outcome is "failed".

A basis B that is optimal for one cost stays optimal for every cost whose reduced costs keep their
signs, and those are linear in the cost (`KeptProgram.sensitivity`):

    y = B^-T c_B,    d = c - A^T y    >= 0 at a lower bound,  <= 0 at an upper
                     y                >= 0 at a lower side,   <= 0 at an upper

References
----------
Q. Huangfu, J. Hall, Parallelizing the dual revised simplex method, Math. Prog. Comp. 10, 2018. F.
Zanetti, J. Gondzio, A factorisation-based regularised interior point method using the augmented
system, 2025 (HiPO). V. Chvátal, Linear Programming, 1983, chapter 10. Mattikalli, Baraff, Khosla
and Repetto (1993), section 3.1, equation (11).
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass, replace
from typing import Any, Literal

import highspy
import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask
from kilter.solvers.clarabel import LONG, run_aside
from kilter.solvers.problem import LinearProgram, Outcome, Solution
from kilter.solvers.solver_tolerances import (
    BOUNDED_FEASIBLE,
    FEASIBLE,
    NEAR_BOUND,
    NEGLIGIBLE_ENTRY,
    WIDE,
)
from kilter.work import Work, seconds_left

Method = Literal["simplex", "interior"]
Warm = Literal["primal", "dual"]

STRATEGY = {"dual": 1, "primal": 4}
"""Simplex strategies of HiGHS."""
SCALINGS = (2, 0, 4)
"""Scalings of HiGHS in the order in which cold starts try them; the first is the default."""
FEW, MANY = 100, 20
"""Limit of simplex steps: the first number, plus the second for each row and column of the program.
"""
INTERIOR_STEPS = 300
"""Maximum number of interior-point steps; walls of 100,000 bricks need fewer than 200."""

_OUTCOMES: dict[highspy.HighsModelStatus, Outcome] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kModelEmpty: "optimal",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnbounded: "unbounded",
}


def hipo_available() -> bool:
    """True if the package is installed that HiGHS needs for its interior-point method HiPO."""
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
    """Solve a linear program once by HiGHS, from a cold start.

    Arguments: `forces_only`: accept any feasible x: an interior point then stops at a wide gap,
    which saves a third of its steps.
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
    limit = seconds_left(work)
    if limit is not None:
        highs.setOptionValue("time_limit", limit)
    _pass_program(highs, program)
    _run(highs, program)
    if highs.getModelStatus() == highspy.HighsModelStatus.kUnboundedOrInfeasible:
        # presolve cannot tell which of the two applies; the simplex can
        highs.setOptionValue("presolve", "off")
        _run(highs, program)
    answer = _read_solution(highs, program, solver)
    if answer.outcome == "failed":
        seconds_left(work)  # a failure for lack of time is no failure of the solver
    return answer


def find_optimum(
    program: LinearProgram, *, method: Method = "simplex", work: Work | None = None
) -> Solution:
    """Solve a linear program by several methods until the solver reports an optimum.

    The attempts are with and without presolve, by the other method, then with other scalings. The
    result serves figures beside a verdict; the certificates of verdicts do not rely on the solver's
    report.
    """
    other_method: Method = "interior" if method == "simplex" else "simplex"
    attempts: list[tuple[Method, bool]] = [(method, True), (method, False), (other_method, True)]
    for solver, presolve in attempts:
        answer = solve_linear(program, method=solver, presolve=presolve, work=work)
        if answer.optimal:
            return answer
    return KeptProgram(program).solve(work=work)


def near_its_bound(solution: Solution) -> bool:
    """True if the objective of a solution is close to its proved lower bound."""
    distance = NEAR_BOUND * (1.0 + abs(solution.objective))
    return solution.found and solution.objective - solution.bound <= distance


class KeptProgram:
    """A linear program kept in HiGHS, whose cost, bounds, sides and entries may change.

    - `program`: the current program; its arrays are never modified in place.
    - `solves`: number of solved programs; repeated attempts are not counted.

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
        goal: Literal["optimum", "bound", "point", "proof"] = "optimum",
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
        """Replace the kept program; start from a basis of a same-shaped program if given."""
        self.program = program
        _pass_program(self._highs, program)
        self._based = basis is not None
        if basis is not None:
            self._highs.setBasis(basis)

    def change_cost(self, columns: ArrayLike, values: ArrayLike) -> None:
        """Set the costs of some columns of the kept program."""
        index, cost = np.asarray(columns, dtype=np.int64), np.asarray(values, dtype=np.float64)
        self.program = replace(self.program, cost=_with_values(self.program.cost, index, cost))
        self._highs.changeColsCost(len(index), index.astype(np.int32), cost)

    def change_bounds(self, columns: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> None:
        """Set the bounds of some columns of the kept program."""
        index = np.asarray(columns, dtype=np.int64)
        low, high = (np.asarray(bound, dtype=np.float64) for bound in (lower, upper))
        old = self.program
        self.program = replace(
            old,
            lower=_with_values(old.lower, index, low),
            upper=_with_values(old.upper, index, high),
        )
        self._highs.changeColsBounds(len(index), index.astype(np.int32), low, high)

    def change_sides(self, rows: Index, lower: Array, upper: Array) -> None:
        """Set the lower and upper sides of some rows of the kept program."""
        old = self.program
        self.program = replace(
            old,
            row_lower=_with_values(old.row_lower, rows, lower),
            row_upper=_with_values(old.row_upper, rows, upper),
        )
        self._highs.changeRowsBounds(len(rows), rows.astype(np.int32), lower, upper)

    def change_row(self, row: int, columns: ArrayLike, values: ArrayLike) -> None:
        """Change stored entries of a row of the kept program, in the given columns."""
        matrix = csc_array(self.program.matrix.copy())
        for column, value in zip(np.asarray(columns), np.asarray(values), strict=True):
            start, stop = matrix.indptr[column : column + 2]
            place = start + int(np.flatnonzero(matrix.indices[start:stop] == row)[0])
            matrix.data[place] = value
            self._highs.changeCoeff(int(row), int(column), float(value))
        self.program = replace(self.program, matrix=matrix)

    def solve(
        self, cost: Array | None = None, *, warm: Warm | None = None, work: Work | None = None
    ) -> Solution:
        """Solve the kept program from its last basis; if that fails, from cold starts.

        Arguments: `cost` (n,): new cost of all columns.
        """
        if cost is not None:
            self.change_cost(np.arange(len(cost)), cost)
        self.solves += 1
        limit = seconds_left(work)
        self._set("time_limit", np.inf if limit is None else self._highs.getRunTime() + limit)
        attempts = []
        if self._based:
            warm, steps = warm or self._warm, _steps(self.program)
            if warm == "primal":
                steps = self._steps // 4 + FEW
            attempts.append(self._run_simplex(warm, steps, work))
        for scaling in SCALINGS:
            if attempts and (self._accepts(attempts[-1]) or (work is not None and work.over)):
                break
            self._highs.clearSolver()
            self._set("simplex_scale_strategy", scaling)
            attempts.append(self._run_simplex("dual", _steps(self.program), work))
            self._steps = attempts[-1].iterations
        self._set("simplex_scale_strategy", SCALINGS[0])
        if self._goal != "bound" and all(attempt.outcome == "failed" for attempt in attempts):
            attempts.append(self._solve_by_interior(work))
        if all(attempt.outcome == "failed" for attempt in attempts):
            seconds_left(work)  # a failure for lack of time is no failure of the solver
        best = attempts[0]
        if len(attempts) > 1:
            bound = self._goal == "bound"
            best = min(attempts, key=lambda attempt: -attempt.bound if bound else attempt.residual)
        self._based = best.basis is not None and self._accepts(best)
        if not best.optimal and len({attempt.outcome for attempt in attempts}) > 1:
            best = replace(best, outcome="failed")  # the attempts contradict each other
        return best

    def _solve_by_interior(self, work: Work | None) -> Solution:
        """Solve the kept program by an interior-point method, after simplex attempts failed."""
        if work is not None and work.over:
            return Solution(self.program, "failed", np.empty(0), np.empty(0), "none", 0)
        answer = solve_linear(self.program, method="interior", work=work)
        if work is not None:
            work.linear(answer.iterations, self.program.matrix.nnz)
        return answer

    def _accepts(self, solution: Solution) -> bool:
        """True if a solution is good enough (optimal, or near its bound) to end the attempts."""
        if self._goal == "bound":
            return near_its_bound(solution)
        if self._goal == "proof" and solution.outcome == "infeasible":
            return len(solution.multipliers) == len(self.program.row_lower)
        return solution.optimal if self._goal in ("point", "proof") else solution.holds

    def _run_simplex(self, strategy: Warm, steps: int, work: Work | None) -> Solution:
        """Run a simplex method on the kept program, from its current basis."""
        entries = self.program.matrix.nnz
        self._set("simplex_strategy", STRATEGY[strategy])
        self._set("simplex_iteration_limit", steps if work is None else work.steps(steps, entries))
        _run(self._highs, self.program)
        answer = _read_solution(self._highs, self.program, "simplex")
        if work is not None:
            work.linear(answer.iterations, entries)
        return answer

    def _set(self, option: str, value: float) -> None:
        """Set an option of HiGHS if its value changes."""
        if self._options.get(option) != value:
            self._highs.setOptionValue(option, value)
            self._options[option] = value

    def sensitivity(self, costs: Array) -> Array:
        """Reduced costs at the last basis for several cost vectors, shape (m, columns).

        This is equation (11) of the paper.

        Arguments: `costs` (k, n). Returns (m, k): a row for each nonbasic variable that is not
        fixed: the last basis is optimal for the cost t @ costs if no entry of `result @ t` is
        negative.

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
    """Create a `KeptProgram` for programs with bounded columns, of which only bounds are needed."""
    return KeptProgram(warm="dual", tolerance=BOUNDED_FEASIBLE, goal="bound")


def _with_values(values: Array, index: Index, new: Array) -> Array:
    """A copy of `values` with the entries at `index` replaced."""
    result = values.copy()
    result[index] = new
    return result


def longer_basis(basis: Any, columns: int, rows: int) -> Any:
    """Basis of a program with further columns at their lower bounds, and further basic rows."""
    longer = highspy.HighsBasis()
    lower, basic = highspy.HighsBasisStatus.kLower, highspy.HighsBasisStatus.kBasic
    longer.col_status = [*basis.col_status, *[lower] * columns]
    longer.row_status = [*basis.row_status, *[basic] * rows]
    longer.valid = True
    return longer


def new_highs(tolerance: float) -> Any:
    """A new HiGHS object with the options common to all programs."""
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("parallel", "off")  # identical answers on every machine
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("primal_feasibility_tolerance", tolerance)
    highs.setOptionValue("dual_feasibility_tolerance", tolerance)
    highs.setOptionValue("small_matrix_value", NEGLIGIBLE_ENTRY)
    return highs


def _pass_program(highs: Any, program: LinearProgram) -> None:
    """Pass a program to HiGHS; HiGHS then reports a rejected program as without an answer."""
    rows, columns = program.matrix.shape
    start, index, value = program.matrix.indptr, program.matrix.indices, program.matrix.data
    colwise, minimise = int(highspy.MatrixFormat.kColwise), int(highspy.ObjSense.kMinimize)
    none_integer = np.zeros(columns, dtype=np.int32)
    # as arrays: filling a HighsLp number by number takes five times as long
    highs.passModel(
        columns, rows, len(value), colwise, minimise, 0.0,
        program.cost, program.lower, program.upper, program.row_lower, program.row_upper,
        start.astype(np.int32, copy=False), index.astype(np.int32, copy=False), value, none_integer,
    )  # fmt: skip


def _run(highs: Any, program: LinearProgram) -> None:
    """Solve the program in HiGHS; a long run is in a thread, so that Ctrl-C ends it."""
    if program.matrix.nnz < LONG:
        highs.run()
        return
    if not highs.HandleUserInterrupt:  # setting it again would add another callback to every step
        highs.HandleUserInterrupt = True
    run_aside(highs.run, highs.cancelSolve)


def _steps(program: LinearProgram) -> int:
    """Largest number of simplex steps that a program may take."""
    return FEW + MANY * (len(program.row_lower) + len(program.cost))


def _read_solution(highs: Any, program: LinearProgram, solver: str) -> Solution:
    """Read the result of a HiGHS run as a `Solution`."""
    status = highs.getModelStatus()
    outcome = _OUTCOMES.get(status, "failed")
    solution, info = highs.getSolution(), highs.getInfo()
    x, multipliers = np.array(solution.col_value), np.array(solution.row_dual)
    if len(x) != len(program.cost) or not np.isfinite(x).all():
        x, outcome = np.empty(0), "failed" if outcome == "optimal" else outcome
    if outcome == "infeasible":
        # without a stored ray, HiGHS would solve the program again to compute it
        has_ray = solver == "simplex" and highs.getDualRayExist()[1]
        multipliers = np.array(highs.getDualRay()[2]) if has_ray else np.empty(0)
    steps = max(info.simplex_iteration_count, 0) + max(info.ipm_iteration_count, 0)
    basis = highs.getBasis() if solver == "simplex" else None
    return Solution(program, outcome, x, multipliers, solver, int(steps), basis)


# Many small independent equilibria, each with its load factor, solved one after the other.


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Independent equilibria A f = b, with the diagonal blocks of a matrix A."""

    matrix: csc_array
    """Block-diagonal A, shape (m, n)."""
    right: Array
    """b, shape (m,)."""
    two_sided: Mask
    """Columns whose force may have either sign, shape (n,)."""
    row_start: Index
    column_start: Index
    """First row and column of each block, shape (M + 1,)."""

    def __len__(self) -> int:
        return len(self.row_start) - 1


@dataclass(frozen=True, slots=True, eq=False)
class BlockAnswers:
    """Load factor, forces and multipliers of each block, as the solver returned them."""

    factor: Array
    """Load factor lambda, shape (M,); NaN if the solver failed or the block was not solved."""
    forces: Array
    """f for the whole load if lambda is 1, else 0, shape (n,)."""
    multipliers: Array
    """y with A^T y <= 0 and b, shape (m,).y > 0 if lambda is 0: no f balances b."""


def solve_blocks(blocks: Blocks, which: Index) -> BlockAnswers:
    """Solve the load-factor program of each block in `which`, independently of the others.

    Examples
    --------
    >>> matrix = csc_array(np.array([[-1.0, 0.0], [0.0, -1.0]]))
    >>> start = np.arange(3)
    >>> two = Blocks(matrix, np.array([-2.0, 2.0]), np.zeros(2, dtype=bool), start, start)
    >>> answers = solve_blocks(two, np.arange(2))
    >>> answers.factor.round().tolist() == [1, 0], answers.forces.tolist()
    (True, [2.0, 0.0])
    """
    count = len(blocks)
    answers = BlockAnswers(
        np.full(count, np.nan), np.zeros(len(blocks.two_sided)), np.zeros(len(blocks.right))
    )
    highs = new_highs(FEASIBLE)
    highs.setOptionValue("solver", "simplex")
    highs.setOptionValue("presolve", "off")
    for k in which.tolist():
        rows = slice(*blocks.row_start[k : k + 2].tolist())
        columns = slice(*blocks.column_start[k : k + 2].tolist())
        if rows.start == rows.stop:  # a block without free parts balances trivially
            answers.factor[k] = 1.0
            continue
        _pass_block(highs, blocks, rows, columns)
        highs.run()
        if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            continue
        solution = highs.getSolution()
        x = np.array(solution.col_value)
        answers.factor[k] = x[-1]
        # the optimum is 0 or 1: forces for any lambda > 0 can be scaled up to lambda = 1
        if x[-1] > 0.5:
            answers.forces[columns] = x[:-1] / x[-1]
        else:
            answers.multipliers[rows] = solution.row_dual
    return answers


def _pass_block(highs: Any, blocks: Blocks, rows: slice, columns: slice) -> None:
    """Pass the load-factor program of a block to the solver HiGHS."""
    matrix, right = blocks.matrix, blocks.right[rows]
    m, n = rows.stop - rows.start, columns.stop - columns.start
    start = matrix.indptr[columns.start : columns.stop + 1]
    entries = slice(int(start[0]), int(start[-1]))
    loaded_rows = np.flatnonzero(right)
    index = np.concatenate([matrix.indices[entries] - rows.start, loaded_rows])
    value = np.concatenate([matrix.data[entries], -right[loaded_rows]])
    cost, lower, upper = np.zeros(n + 1), np.zeros(n + 1), np.full(n + 1, np.inf)
    cost[-1], upper[-1] = -1.0, 1.0
    lower[:-1][blocks.two_sided[columns]] = -np.inf
    zero, continuous = np.zeros(m), np.zeros(n + 1, dtype=np.int32)
    colwise, minimise = int(highspy.MatrixFormat.kColwise), int(highspy.ObjSense.kMinimize)
    highs.setOptionValue("simplex_iteration_limit", FEW + MANY * (m + n + 1))
    highs.passModel(
        n + 1, m, len(value), colwise, minimise, 0.0, cost, lower, upper, zero, zero,
        (start - start[0]).astype(np.int32, copy=False), index.astype(np.int32, copy=False),
        value, continuous,
    )  # fmt: skip
