"""Conic, semidefinite and quadratic programs, by Clarabel; quadratic ones are then made exact.

An interior point's answer is only as good as the square root of its gap. In a program without
cones the rows whose multiplier outweighs their slack are taken as active, and the equations of
that guess are solved directly; the result is kept where its residual is smaller.

References
----------
P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, 2024. The polishing step follows OSQP (Stellato et al., 2020, section 5.2).
"""

from __future__ import annotations

import threading
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
from kilter.solvers.interrupts import DEAF, LONG, call_apart, run_aside
from kilter.solvers.problem import ConicProgram
from kilter.solvers.semidefinite import Multipliers, SemidefiniteProgram
from kilter.solvers.solution import Outcome, Solution
from kilter.solvers.solver_tolerances import CONIC, CONIC_FIRST, QUADRATIC_GOOD
from kilter.work import Work

__all__ = ["solve_conic", "solve_quadratic", "solve_semidefinite"]

STEPS = 100
"""Steps of the interior point after which it is given up."""
GUESSES = 4
"""Guesses of the active rows."""
REGULAR = 1e-9
"""Added to the diagonal of a guess's equations, over its own, and refined away."""
REFINED = 30
"""Steps of refinement at most."""
ROUNDING = 1e-15
"""Residual of the equations that ends the refinement."""
OPENS, PULLS = 1e-11, 1e-9
"""Slack, over the largest unknown, and multiplier below minus which a guess of a row changes."""

SEMIDEFINITE_STEPS = 60
"""Steps of the interior point after which it is given up."""
SEMIDEFINITE_REGULAR = 1e-7
"""Regularisation of the equations of a step, over the largest entry of their diagonal."""
SEMIDEFINITE_GAP = 1e-9
"""Gap and feasibility asked for."""

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
    """Minimise a convex quadratic over linear rows and second-order cones.

    Parameters
    ----------
    program : ConicProgram
    tolerance : float
        Gap and feasibility, absolute and relative [-].
    work : Work, optional
        It is charged, and its time limit is kept.

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
    seconds = None if work is None else work.seconds
    asked = program, tolerance, seconds
    try:
        # setting it up keeps the interpreter to itself
        found = call_apart(_answer, *asked) if entries >= DEAF else _answer(*asked)
    except SolverError:
        return Solution(program, "failed", np.empty(0), np.empty(0), "clarabel", 0)
    if work is not None:
        work.conic(found.iterations, entries)
    x, outcome = found.x, _OUTCOMES.get(found.status, "failed")
    if outcome in ("infeasible", "unbounded") or not np.isfinite(x).all():
        x, outcome = np.empty(0), "failed" if outcome == "optimal" else outcome
    return Solution(program, outcome, x, found.multipliers, "clarabel", found.iterations)


@dataclass(frozen=True, slots=True, eq=False)
class _Answer:
    """What Clarabel says."""

    status: str
    x: Array
    multipliers: Array
    iterations: int


def _answer(program: ConicProgram, tolerance: float, seconds: float | None) -> _Answer:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    settings.max_iter = STEPS
    # on walls twice as fast as what it would choose, on quadratic programs twenty times
    settings.direct_solve_method = "qdldl"
    settings.max_threads = 1  # no bit of an answer depends on the machine
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
    answer = _solved(solver, program.matrix.nnz)
    return _Answer(str(answer.status), np.array(answer.x), np.array(answer.z), answer.iterations)


def _solved(solver: Any, entries: int) -> Any:
    """What the solver answers; beside the main thread where it may take long."""
    if entries < LONG:
        return solver.solve()
    stopped, answers = threading.Event(), []
    solver.set_termination_callback(lambda _: stopped.is_set())
    run_aside(lambda: answers.append(solver.solve()), stopped.set)
    return answers[0]


def solve_quadratic(
    program: ConicProgram, *, tolerance: float = CONIC_FIRST, polish: bool = True
) -> Solution:
    """Minimise a convex quadratic under linear rows: a program without cones.

    Asked for more digits than it can give, the interior point stops far from the optimum; so
    it is asked for fewer, until what is left after polishing is below `QUADRATIC_GOOD`.

    Parameters
    ----------
    program : ConicProgram
    tolerance : float
        Gap and feasibility first asked for [-].
    polish : bool
        Without it the interior point is asked once.
    """
    best = solve_conic(program, tolerance=tolerance)
    if not polish:
        return best
    for looser in (tolerance, 100 * tolerance, 1e4 * tolerance):
        answer = best if looser == tolerance else solve_conic(program, tolerance=looser)
        if answer.found:
            best = min([best, answer, *_polished(answer)], key=lambda one: one.residual)
        if best.residual <= QUADRATIC_GOOD:
            return replace(best, outcome="optimal")
    return best


def _polished(start: Solution) -> list[Solution]:
    """Solutions of the equations of the guessed active rows, by regularised refinement."""
    program = start.problem
    assert isinstance(program, ConicProgram)
    one_sided = np.arange(len(program.bound)) >= program.equal
    slack = program.bound - program.matrix @ start.x
    active = (start.multipliers > slack) | ~one_sided
    found = []
    for _ in range(GUESSES):
        rows = np.flatnonzero(active)
        x, y = _equations(program, rows, start)
        multipliers = np.zeros(len(active))
        multipliers[rows] = y
        pushing = np.where(one_sided, np.maximum(multipliers, 0), multipliers)
        found.append(replace(start, x=x, multipliers=pushing))
        slack = program.bound - program.matrix @ x
        opens = OPENS * max(1.0, float(np.abs(x).max(initial=0.0)))
        change = (~active & (slack < -opens)) | (active & (multipliers < -PULLS) & one_sided)
        if not change.any():
            break
        active = active ^ change
    return found


def _equations(program: ConicProgram, rows: Index, start: Solution) -> tuple[Array, Array]:
    """X and multipliers of the rows held as equations."""
    from scipy.sparse.linalg import splu

    some = csc_array(program.matrix.tocsr()[rows])
    count, held = some.shape[1], some.shape[0]
    small = REGULAR * max(1.0, float(np.abs(program.quadratic.diagonal()).max(initial=0.0)))
    quadratic = program.quadratic + small * eye_array(count)
    system = block_array([[quadratic, some.T], [-some, small * eye_array(held)]], format="csc")
    exact = block_array(
        [[program.quadratic, some.T], [-some, diags_array(np.zeros(held))]], format="csc"
    )
    right = np.concatenate([-program.cost, -program.bound[rows]])
    factor = splu(system)
    z = np.concatenate([start.x, start.multipliers[rows]])
    for _ in range(REFINED):
        rest = right - exact @ z
        if np.abs(rest).max(initial=0.0) < ROUNDING:
            break
        z = z + factor.solve(rest)
    return z[:count], z[count:]


def solve_semidefinite(program: SemidefiniteProgram, *, work: Work) -> Multipliers | None:
    """Multipliers of the rows of a program; None where the solver broke down."""
    size = program.dimension
    weights = [
        np.ones(1),
        1.0 / _lengths(program.equal),
        1.0 / _lengths(program.positive),
        np.repeat(1.0 / _lengths(program.cones).reshape(-1, size).max(axis=1, initial=TINY), size),
    ]
    first = csr_array(([1.0], ([0], [0])), shape=(1, len(program.gain)))
    signed = [first, program.equal, -program.positive, -program.cones]
    rows = [csr_array(one.multiply(w[:, None])) for one, w in zip(signed, weights, strict=True)]
    stacked = vstack([*rows, *(-one for one in program.squares)], format="csc")
    orders = [_order(one.shape[0]) for one in program.squares]
    cones = [clarabel.ZeroConeT(1 + program.equal.shape[0])]
    if program.positive.shape[0]:
        cones.append(clarabel.NonnegativeConeT(program.positive.shape[0]))
    cones += [clarabel.SecondOrderConeT(size)] * (program.cones.shape[0] // size)
    cones += [clarabel.PSDTriangleConeT(order) for order in orders]
    bound = np.zeros(stacked.shape[0])
    bound[0] = 1.0
    none = csc_matrix((len(program.gain), len(program.gain)))
    solver = clarabel.DefaultSolver(
        none, -program.gain, csc_matrix(stacked), bound, cones, _semidefinite_settings(work)
    )
    try:
        answer = _solved(solver, stacked.nnz)
    except BaseException as fault:  # what Rust raises is no Exception
        if type(fault).__name__ != "PanicException":
            raise
        return None
    work.semidefinite(answer.iterations, stacked.nnz)
    z = np.array(answer.z)
    if not len(z) or not np.isfinite(z).all():
        return None
    heights = [len(w) for w in weights]
    _, equal, positive, conic, rest = np.split(z, np.cumsum(heights))
    triangles = np.split(rest, np.cumsum([one.shape[0] for one in program.squares])[:-1])
    return Multipliers(
        equal * weights[1],
        positive * weights[2],
        conic * weights[3],
        tuple(_matrix(one, order) for one, order in zip(triangles, orders, strict=True)),
        np.array(answer.x),
    )


def _semidefinite_settings(work: Work) -> clarabel.DefaultSettings:
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
    """Euclidean length of each row, at least `TINY`."""
    square = np.asarray(rows.multiply(rows).sum(axis=1)).ravel()
    return np.asarray(np.maximum(np.sqrt(square), TINY))


def _order(height: int) -> int:
    """K of an upper triangle of k (k + 1) / 2 numbers."""
    return round((float(np.sqrt(8.0 * height + 1.0)) - 1.0) / 2.0)


def _matrix(triangle: Array, order: int) -> Array:
    """The symmetric matrix of an upper triangle."""
    column, row = np.tril_indices(order)
    values = triangle * np.where(row == column, 1.0, np.sqrt(0.5))
    matrix = np.zeros((order, order))
    matrix[row, column] = values
    matrix[column, row] = values
    return matrix
