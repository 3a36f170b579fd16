"""Conic, semidefinite and quadratic programs, by Clarabel; quadratic solutions are then polished.

The answer of an interior point is only as accurate as the square root of its gap. In a program
without cones, rows whose multiplier exceeds their slack are assumed to be active, and the equations
of that active set are solved directly. The result is kept if its residual is smaller.

References
----------
P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, 2024. The polishing step follows OSQP (Stellato et al., 2020, section 5.2).
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import (
    block_array,
    csc_array,
    csc_matrix,
    csr_array,
    diags_array,
    eye_array,
    vstack,
)

from kilter.arrays import TINY, Array, Index
from kilter.errors import SolverError
from kilter.pipes import can_start, end_process, end_with_parent, receive, send, start_process
from kilter.solvers.problem import ConicProgram, Outcome, Solution
from kilter.solvers.semidefinite import Multipliers, SemidefiniteProgram
from kilter.solvers.solver_tolerances import CONIC, CONIC_FIRST, QUADRATIC_GOOD
from kilter.work import Work, seconds_left

# Run solver calls outside the main thread, so that Ctrl-C ends them at once.


LONG = 20_000
"""Number of matrix entries above which a solver call may take a second."""
DEAF = 300_000
"""Number of matrix entries above which the set-up of a solver may block Ctrl-C for half a second.
"""
ENDS = 0.2
"""Time that an interrupted solver gets to stop [s]."""


def run_aside(run: Callable[[], None], stop: Callable[[], None]) -> None:
    """Call `run` in a thread and wait; on an interruption, call `stop` and raise it again.

    Outside the main thread, which alone receives signals, `run` is called directly.

    Examples
    --------
    >>> done = []
    >>> run_aside(lambda: done.append("ran"), lambda: done.append("stopped"))
    >>> done
    ['ran']
    """
    if threading.current_thread() is not threading.main_thread():
        run()
        return
    failure: list[BaseException] = []

    def run_and_keep_failure() -> None:
        try:
            run()
        except BaseException as error:
            failure.append(error)

    thread = threading.Thread(target=run_and_keep_failure, daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(1.0)
    except BaseException:
        stop()
        thread.join(ENDS)
        raise
    if failure:
        raise failure[0]


def call_apart(function: Callable[..., Any], *given: Any) -> Any:
    """Call a module-level function in a child process that Ctrl-C can end; return its result.

    Outside the main thread, and if Python cannot be started, the function is called directly.

    Raises `SolverError` if the process broke down.

    Examples
    --------
    >>> import math
    >>> call_apart(math.hypot, 3.0, 4.0)
    5.0
    """
    if threading.current_thread() is not threading.main_thread() or not can_start():
        return function(*given)
    process = start_process(__name__)
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        send(process.stdin, (function, given))
        failure, answer = receive(process.stdout)
    except (EOFError, OSError) as error:
        raise SolverError("a solver's process broke down", status="failed") from error
    finally:
        end_process(process)
    if failure is not None:
        raise failure
    return answer


def serve() -> None:
    """Run a single call in the child process, and send its exception (or None) and result."""
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl-C reaches all processes of a terminal; the caller ends this process
    incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # output printed by a solver must not mix with the answer
    end_with_parent()
    try:
        function, given = receive(incoming)
    except EOFError:
        return
    failure, answer = None, None
    try:
        answer = function(*given)
    except Exception as error:
        failure = error
    send(outgoing, (failure, answer))


# Data of small, degenerate semidefinite programs.


STEPS = 100
"""Maximum number of interior-point steps of a conic program."""
MANY_ROWS, DENSE = 10, 2000
"""Rows for each unknown above which active rows are eliminated, for at most this many unknowns."""
GUESSES = 4
"""Maximum number of active sets that polishing tries."""
REGULAR = 1e-9
"""Regularisation of the equations of an active set, relative to their largest diagonal entry;
refinement removes its effect.
"""
REFINED = 30
"""Maximum number of refinement steps."""
ROUNDING = 1e-15
"""Residual of the equations at which refinement ends."""
OPENS, PULLS = 1e-11, 1e-9
"""Polishing changes an active set at slacks below minus the first, over the largest unknown, and at
multipliers below minus the second.
"""

SEMIDEFINITE_STEPS = 60
"""Maximum number of interior-point steps of a semidefinite program."""
SEMIDEFINITE_REGULAR = 1e-7
"""Regularisation of the equations of a step, over their largest diagonal entry."""
SEMIDEFINITE_GAP = 1e-9
"""Requested gap and feasibility of a semidefinite program."""

_OUTCOMES: dict[str, Outcome] = {
    "Solved": "optimal",
    "AlmostSolved": "optimal",
    "PrimalInfeasible": "infeasible",
    "AlmostPrimalInfeasible": "infeasible",
    "DualInfeasible": "unbounded",
    "AlmostDualInfeasible": "unbounded",
}


def solve_conic(
    program: ConicProgram, *, tolerance: float = CONIC, work: Work | None = None
) -> Solution:
    """Minimise a convex quadratic function over linear rows and second-order cones.

    Arguments: `tolerance`: gap and feasibility, absolute and relative [-].

    Examples
    --------
    >>> nearest = ConicProgram(  # the point of the cone t >= |v| nearest to (0, 2)
    ...     csc_array(eye_array(2)), np.array([0.0, -2.0]), csc_array(-eye_array(2)),
    ...     np.zeros(2), 0, 0, np.array([2]))
    >>> answer = solve_conic(nearest)
    >>> np.round(answer.x, 6), answer.outcome
    (array([1., 1.]), 'optimal')
    >>> both = ConicProgram(  # x >= 1 and x <= -1
    ...     csc_array((1, 1)), np.zeros(1), csc_array([[-1.0], [1.0]]), -np.ones(2), 0, 2,
    ...     np.empty(0, dtype=np.int64))
    >>> solve_conic(both).outcome, solve_conic(both).proves_none
    ('infeasible', True)
    """
    entries = program.matrix.nnz
    seconds = seconds_left(work)
    arguments = program, tolerance, seconds
    try:
        # the set-up of a large program holds the interpreter lock: another process stays responsive
        answer = (
            call_apart(_call_clarabel, *arguments)
            if entries >= DEAF
            else _call_clarabel(*arguments)
        )
    except SolverError:
        return Solution(program, "failed", np.empty(0), np.empty(0), "clarabel", 0)
    if work is not None:
        work.conic(answer.iterations, entries)
    elif answer.status not in _OUTCOMES:
        seconds_left(work)  # a failure for lack of time is no failure of the solver
    x, outcome = answer.x, _OUTCOMES.get(answer.status, "failed")
    # Clarabel also returns a point for infeasible programs; it is meaningless
    if outcome in ("infeasible", "unbounded") or not np.isfinite(x).all():
        x, outcome = np.empty(0), "failed" if outcome == "optimal" else outcome
    return Solution(program, outcome, x, answer.multipliers, "clarabel", answer.iterations)


@dataclass(frozen=True, slots=True, eq=False)
class _Answer:
    """Result of the solver Clarabel, as plain arrays."""

    status: str
    x: Array
    multipliers: Array
    iterations: int


def _call_clarabel(program: ConicProgram, tolerance: float, seconds: float | None) -> _Answer:
    """Solve a conic program by Clarabel to a tolerance, within a time [s]; None: no time limit."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    settings.max_iter = STEPS
    # twice as fast as the default on walls, twenty times on quadratic programs
    settings.direct_solve_method = "qdldl"
    settings.max_threads = 1  # identical answers on every machine
    if seconds is not None:
        settings.time_limit = seconds
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
    answer = _solve_interruptible(solver, program.matrix.nnz)
    return _Answer(str(answer.status), np.array(answer.x), np.array(answer.z), answer.iterations)


def _solve_interruptible(solver: Any, entries: int) -> Any:
    """Run Clarabel; a run that may be long is in a thread, so that Ctrl-C ends it at once."""
    if entries < LONG:
        return solver.solve()
    stopped, results = threading.Event(), []
    solver.set_termination_callback(lambda _: stopped.is_set())
    run_aside(lambda: results.append(solver.solve()), stopped.set)
    return results[0]


def solve_quadratic(
    program: ConicProgram, *, tolerance: float = CONIC_FIRST, polish: bool = True
) -> Solution:
    """Minimise a convex quadratic function under linear equations and inequalities.

    If the requested tolerance is finer than it can reach, the interior point stops far from the
    optimum. So the tolerance is relaxed until the residual after polishing is below
    `QUADRATIC_GOOD`.

    Arguments: `tolerance`: first requested gap and feasibility [-].
    """
    best = solve_conic(program, tolerance=tolerance)
    if not polish:
        return best
    for looser in (tolerance, 100 * tolerance, 1e4 * tolerance):
        answer = best if looser == tolerance else solve_conic(program, tolerance=looser)
        if answer.found:
            best = min([best, answer, *_polish(answer)], key=lambda solution: solution.residual)
        if best.residual <= QUADRATIC_GOOD:
            return replace(best, outcome="optimal")
    return best


def _polish(start: Solution) -> list[Solution]:
    """Solutions for successive guesses of the rows that hold as equations, from a first one."""
    program = start.problem
    assert isinstance(program, ConicProgram)
    one_sided = np.arange(len(program.bound)) >= program.equal
    slack = program.bound - program.matrix @ start.x
    # complementarity: of a slack and its multiplier the smaller one tends to 0
    active = (start.multipliers > slack) | ~one_sided
    solutions = []
    for _ in range(GUESSES):
        rows = np.flatnonzero(active)
        x, y = _solve_active_set(program, rows, start)
        multipliers = np.zeros(len(active))
        multipliers[rows] = y
        pushing = np.where(one_sided, np.maximum(multipliers, 0), multipliers)
        solutions.append(replace(start, x=x, multipliers=pushing))
        slack = program.bound - program.matrix @ x
        opens = OPENS * max(1.0, float(np.abs(x).max(initial=0.0)))
        change = (~active & (slack < -opens)) | (active & (multipliers < -PULLS) & one_sided)
        if not change.any():
            break
        active = active ^ change
    return solutions


def _solve_active_set(program: ConicProgram, rows: Index, start: Solution) -> tuple[Array, Array]:
    """Solve for x and multipliers if `rows` hold as equations and all other rows are ignored."""
    from scipy.sparse.linalg import splu

    active_rows = csc_array(program.matrix.tocsr()[rows])
    count, row_count = active_rows.shape[1], active_rows.shape[0]
    regular = REGULAR * max(1.0, float(np.abs(program.quadratic.diagonal()).max(initial=0.0)))
    quadratic = program.quadratic + regular * eye_array(count)
    solve = None
    if row_count > MANY_ROWS * count and count <= DENSE:
        solve = _condensed(quadratic, active_rows, regular)
    if solve is None:
        blocks = [[quadratic, active_rows.T], [-active_rows, regular * eye_array(row_count)]]
        solve = splu(block_array(blocks, format="csc")).solve
    exact = block_array(
        [[program.quadratic, active_rows.T], [-active_rows, diags_array(np.zeros(row_count))]],
        format="csc",
    )
    right = np.concatenate([-program.cost, -program.bound[rows]])
    z = np.concatenate([start.x, start.multipliers[rows]])
    # the residual is that of the exact system: the steps remove the error of the regularisation
    for _ in range(REFINED):
        residual = right - exact @ z
        if np.abs(residual).max(initial=0.0) < ROUNDING:
            break
        z = z + solve(residual)
    return z[:count], z[count:]


def _condensed(quadratic: Any, rows: Any, regular: float) -> Callable[[Array], Array] | None:
    """Solver of a regularised system [[Q, A^T], [-A, r]] whose rows A far outnumber its unknowns.

    Without its multipliers (g + A x) / r the system is Q + A^T A / r, small and dense; the LU
    factors of the whole system would be large. None if Q is not positive.
    """
    from scipy.linalg import cho_factor, cho_solve

    count = rows.shape[1]
    try:
        small = cho_factor((quadratic + rows.T @ rows / regular).toarray())
    except np.linalg.LinAlgError:
        return None

    def solve(right: Array) -> Array:
        first, second = right[:count], right[count:]
        x = cho_solve(small, first - rows.T @ second / regular)
        return np.concatenate([x, (second + rows @ x) / regular])

    return solve


def solve_semidefinite(program: SemidefiniteProgram, *, work: Work) -> Multipliers | None:
    """Solve a semidefinite program for its multipliers; None if the solver breaks down."""
    size = program.dimension
    # rows of length 1, and cones of longest row 1, so that the regularisation suits all of them
    weights = [
        np.ones(1),
        1.0 / _lengths(program.equal),
        1.0 / _lengths(program.positive),
        np.repeat(1.0 / _lengths(program.cones).reshape(-1, size).max(axis=1, initial=TINY), size),
    ]
    first = csr_array(([1.0], ([0], [0])), shape=(1, len(program.gain)))
    signed = [first, program.equal, -program.positive, -program.cones]
    rows = [csr_array(block.multiply(w[:, None])) for block, w in zip(signed, weights, strict=True)]
    stacked = vstack([*rows, *(-square for square in program.squares)], format="csc")
    orders = [_order(square.shape[0]) for square in program.squares]
    cones = [clarabel.ZeroConeT(1 + program.equal.shape[0])]
    if program.positive.shape[0]:
        cones.append(clarabel.NonnegativeConeT(program.positive.shape[0]))
    cones += [clarabel.SecondOrderConeT(size)] * (program.cones.shape[0] // size)
    cones += [clarabel.PSDTriangleConeT(order) for order in orders]
    bound = np.zeros(stacked.shape[0])
    bound[0] = 1.0
    no_quadratic = csc_matrix((len(program.gain), len(program.gain)))
    solver = clarabel.DefaultSolver(
        no_quadratic, -program.gain, csc_matrix(stacked), bound, cones, _semidefinite_settings(work)
    )
    try:
        answer = _solve_interruptible(solver, stacked.nnz)
    except BaseException as fault:  # a panic of Rust is a BaseException
        if type(fault).__name__ != "PanicException":
            raise
        return None
    work.semidefinite(answer.iterations, stacked.nnz)
    z = np.array(answer.z)
    if not len(z) or not np.isfinite(z).all():
        return None
    heights = [len(w) for w in weights]
    _, equal, positive, conic, rest = np.split(z, np.cumsum(heights))
    triangles = np.split(rest, np.cumsum([square.shape[0] for square in program.squares])[:-1])
    return Multipliers(
        equal * weights[1],
        positive * weights[2],
        conic * weights[3],
        tuple(_matrix(triangle, order) for triangle, order in zip(triangles, orders, strict=True)),
        np.array(answer.x),
    )


def _semidefinite_settings(work: Work) -> clarabel.DefaultSettings:
    """Clarabel settings for degenerate programs: strong regularisation, no presolve."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = SEMIDEFINITE_GAP
    settings.max_iter = SEMIDEFINITE_STEPS
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.static_regularization_constant = SEMIDEFINITE_REGULAR
    settings.direct_solve_method = "faer"
    if work.seconds is not None:
        settings.time_limit = work.seconds
    return settings


def _lengths(rows: csr_array) -> Array:
    """Euclidean length of each row, but at least `TINY`, so that a division is safe."""
    square = np.asarray(rows.multiply(rows).sum(axis=1)).ravel()
    return np.asarray(np.maximum(np.sqrt(square), TINY))


def _order(height: int) -> int:
    """Order k of a symmetric matrix whose upper triangle has k (k + 1) / 2 entries."""
    return round((float(np.sqrt(8.0 * height + 1.0)) - 1.0) / 2.0)


def _matrix(triangle: Array, order: int) -> Array:
    """Symmetric matrix from its upper triangle, with a factor sqrt(2) on off-diagonal entries."""
    column, row = np.tril_indices(order)
    values = triangle * np.where(row == column, 1.0, np.sqrt(0.5))
    matrix = np.zeros((order, order))
    matrix[row, column] = values
    matrix[column, row] = values
    return matrix
