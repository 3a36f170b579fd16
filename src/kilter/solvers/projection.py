"""Projection on a polyhedral cone: an interior point, then exact multipliers.

    min 1/2 |b|^2 - v.b,   R b = 0 in the first rows, then R b >= 0

The interior point (Mehrotra's predictor and corrector, Gondzio's centrality correctors) works
on the normal matrix I + R^T D R, which keeps the sparsity of the contacts: one factorisation
a step, and every corrector re-uses it. Where contacts neither press nor open, as between
bricks that fall side by side, its answer is only as good as the square root of its gap.

So it is followed by steps of the method of multipliers from its forces f,

    b = argmin 1/2 |b|^2 - v.b + 1/(2 rho) |max(0, f - rho R b)|^2,    f <- max(0, f - rho R b)

each minimised exactly by Newton's method (the function is piecewise quadratic). No row has to
be guessed active: the step never moves f by more than its distance to the nearest optimum, so
violation and complementarity end below that distance over rho, however degenerate the rows.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, 1992. J. Gondzio,
Multiple centrality corrections in a primal-dual method for linear programming, 1996. R. T.
Rockafellar, Augmented Lagrangians and applications of the proximal point algorithm, 1976.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array

from kilter.arrays import Array, Index, Mask
from kilter.solvers.problem import ConeProjection

__all__ = ["ProjectionSolution", "solve_projection"]


STEPS = 120
"""Steps of the interior point at most."""
CORRECTORS = 4
"""Centrality correctors of one factorisation at most."""
START = 1.0
"""First slacks and forces over the largest load."""
SHORT_OF = 0.995
"""Part of the way to the boundary that a step goes."""
GAP = 1e-16
"""Mean product of slack and force, over the square of gravity, that ends the interior point."""
PROXIMAL = 1e-7
"""Regularisation of two-sided rows."""
RHO = 1e3
"""Weight of the rows in the method of multipliers."""
LEAST = 1e-12
"""Slacks, forces and their falls below this, of the load or of themselves, are taken as this."""
ROUNDS, NEWTON = 6, 60
"""Steps of the method of multipliers, and of Newton's method in each, at most."""
EXACT = 3e-12
"""Gradient over the load that ends Newton's method; change of forces that ends all."""


@dataclass(frozen=True, slots=True, eq=False)
class ProjectionSolution:
    """Unknowns b and multipliers, unjudged; factorisations of both stages."""

    unknowns: Array
    multipliers: Array
    factorisations: int


@dataclass(frozen=True, slots=True, eq=False)
class _Sorted:
    """The problem with its columns in the order of elimination, lengths over the load."""

    rows: csr_array
    turned: csr_array
    load: Array
    two_sided: Mask
    weight: Array


def solve_projection(problem: ConeProjection, *, exact: bool = True) -> ProjectionSolution:
    """Solve by interior point and, where `exact`, multipliers.

    Without them accelerations of walls of 2,000 to 10,000 bricks are good to 1e-7 g.

    Raises
    ------
    RuntimeError
        If a matrix cannot be factorised at the first step, or while forces are made exact.
    """
    size = float(np.abs(problem.load).max(initial=0.0))
    if size == 0.0 or not len(problem.unit):
        return ProjectionSolution(problem.load.copy(), np.zeros(len(problem.unit)), 0)
    order = _order(problem)
    rows = csr_array(problem.rows[:, order])
    # light parts have small numbers: products of theirs are to vanish sooner
    weight = (problem.unit.min() / problem.unit) ** 2
    data = _Sorted(
        rows,
        csr_array(rows.T),
        problem.load[order] / size,
        np.arange(len(problem.unit)) < problem.equal,
        weight,
    )
    b, f, first = _interior(data)
    b, f, second = _multipliers(data, b, f) if exact else (b, f, 0)
    unknowns = np.empty(len(b))
    unknowns[order] = b * size
    return ProjectionSolution(unknowns, f * size, first + second)


def _order(problem: ConeProjection) -> Index:
    """Columns in an order of little fill-in: by minimum degree, of the parts where they are full.

    SuperLU's own ordering of a matrix with a strong diagonal is read off.
    """
    block = problem.block if problem.block > 3 else 1
    number = problem.rows.shape[1] // block
    pattern = csr_array(
        (
            np.ones(problem.rows.nnz),
            problem.rows.indices // block,
            problem.rows.indptr.copy(),
        ),
        shape=(problem.rows.shape[0], number),
    )
    pattern.sum_duplicates()
    graph = (pattern.T @ pattern).tocsc()
    strong = float(graph.sum(axis=0).max()) * 2 + 1
    matrix = csc_array(graph + strong * eye_array(number, format="csc"))
    from scipy.sparse.linalg import splu  # takes its time

    factor = splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    order = np.argsort(factor.perm_c)
    return np.asarray((order[:, None] * block + np.arange(block)).ravel(), dtype=np.int64)


def _factorised(data: _Sorted, weights: Array) -> Callable[[Array], Array]:
    """Solves (I + R^T diag(weights) R) x = y, with a step of refinement."""
    rows = data.rows
    scaled = csr_array(
        (rows.data * np.repeat(weights, np.diff(rows.indptr)), rows.indices, rows.indptr),
        shape=rows.shape,
    )
    matrix = (data.turned @ scaled).tocsc() + eye_array(rows.shape[1], format="csc")
    from scipy.sparse.linalg import splu

    factor = splu(
        csc_array(matrix),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True, "Equil": False},
    )

    def solve(right: Array) -> Array:
        x = factor.solve(right)
        # the residual in products, not in the matrix: large weights cancel there
        rest = right - x - data.turned @ (weights * (rows @ x))
        better: Array = x + factor.solve(rest)
        return better

    return solve


def _interior(data: _Sorted) -> tuple[Array, Array, int]:
    """The best point on the way: b, f, and how many factorisations."""
    two = data.two_sided
    root = np.sqrt(data.weight)
    solve = _factorised(data, np.ones(len(two)))
    b = solve(data.load)
    opening = data.rows @ b
    s = np.where(two, 1.0, np.maximum(opening, 0) + START * root)
    f = np.where(two, -opening, np.maximum(-opening, 0) + START * root)
    best, kept = np.inf, (b, np.where(two, f, np.maximum(f, 0)))
    count = 1
    for _ in range(STEPS):
        rd = b - data.load - data.turned @ f
        rp = data.rows @ b - np.where(two, 0.0, s)
        mu = float((s * f / data.weight)[~two].mean()) if not two.all() else 0.0
        worst = max(float(np.abs(rd).max()), float(np.abs(rp).max(initial=0.0)))
        merit = max(worst, np.sqrt(max(mu, 0.0)))
        if merit < best:
            best, kept = merit, (b, f)
        elif merit > 1e3 * best:
            break  # rounding has taken over
        if mu < GAP and worst < 1e-8:
            break
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                db, ds, df, length = _direction(data, s, f, rd, rp, mu)
        except (RuntimeError, FloatingPointError):  # singular to working precision
            break
        count += 1
        b, s, f = b + length * db, s + np.where(two, 0, length * ds), f + length * df
        least = LEAST * LEAST * data.weight
        s, f = np.where(two, s, np.maximum(s, least)), np.where(two, f, np.maximum(f, least))
        if length < 1e-8:
            break
    return *kept, count


def _reach(v: Array, dv: Array) -> float:
    down = dv < -LEAST * v
    return min(1.0, float((-v[down] / dv[down]).min(initial=np.inf)))


def _direction(
    data: _Sorted, s: Array, f: Array, rd: Array, rp: Array, mu: float
) -> tuple[Array, Array, Array, float]:
    """Predictor, corrector and centrality correctors; the length of the step."""
    two, one = data.two_sided, ~data.two_sided
    weights = np.where(two, 1.0 / PROXIMAL, f / s)
    solve = _factorised(data, weights)

    def newton(rd: Array, rp: Array, rc: Array) -> tuple[Array, Array, Array]:
        u = np.where(two, -rp / PROXIMAL, (rc - f * rp) / s)
        db = solve(data.turned @ u - rd)
        opening = data.rows @ db
        return db, np.where(two, 0.0, opening + rp), u - weights * opening

    def reach(ds: Array, df: Array) -> float:
        return min(_reach(s[one], ds[one]), _reach(f[one], df[one]))

    db, ds, df = newton(rd, rp, -s * f)
    if two.all():  # equations only: a whole step
        return db, ds, df, 1.0
    length = reach(ds, df)
    after = float((((s + length * ds) * (f + length * df)) / data.weight)[one].mean())
    goal = (after / mu) ** 3 * mu * data.weight
    db, ds, df = newton(rd, rp, goal - s * f - ds * df)
    length = reach(ds, df)
    for _ in range(CORRECTORS):
        if length > 0.97:
            break
        wanted = min(1.0, 1.5 * length + 0.1)
        product = (s + wanted * ds) * (f + wanted * df)
        change = np.maximum(np.clip(product, 0.1 * goal, 10 * goal) - product, -10 * goal)
        more = newton(np.zeros_like(rd), np.zeros_like(rp), np.where(two, 0.0, change))
        tried = reach(ds + more[1], df + more[2])
        if tried < length + 0.01:
            break
        db, ds, df, length = db + more[0], ds + more[1], df + more[2], tried
    return db, ds, df, length if length == 1.0 else SHORT_OF * length


def _multipliers(data: _Sorted, b: Array, f: Array) -> tuple[Array, Array, int]:
    """Steps of the method of multipliers; the last whose Newton steps converge."""
    count = 0
    for _ in range(ROUNDS):
        b, steps = _minimised(data, b, f)
        count += steps
        pushed = f - RHO * (data.rows @ b)
        after = np.where(data.two_sided, pushed, np.maximum(pushed, 0.0))
        moved = float(np.abs((after - f) / np.sqrt(data.weight)).max()) / RHO
        f = after
        if moved < EXACT:
            break
    return b, f, count


def _minimised(data: _Sorted, b: Array, f: Array) -> tuple[Array, int]:
    """Newton's method on the piecewise quadratic, with an exact search along each step."""
    before: Mask | None = None
    solve: Callable[[Array], Array] | None = None
    count, least = 0, np.inf
    for _ in range(NEWTON):
        pushed = f - RHO * (data.rows @ b)
        active = (pushed > 0) | data.two_sided
        gradient = b - data.load - data.turned @ np.where(active, pushed, 0.0)
        size = float(np.abs(gradient).max())
        if size < EXACT * 0.1:
            break
        same = before is not None and np.array_equal(active, before)
        if same and size > 0.5 * least:
            break  # as far as float64 goes
        least = min(size, least)
        if solve is None or not same:
            solve, before = _factorised(data, np.where(active, RHO, 0.0)), active
            count += 1
        d = solve(-gradient)
        b = b + _line(data, b, d, pushed) * d
    return b, count


def _line(data: _Sorted, b: Array, d: Array, pushed: Array) -> float:
    """The minimum along d: a root of an increasing, piecewise linear function."""
    fall = RHO * (data.rows @ d)
    square, start = float(d @ d), float((b - data.load) @ d)
    t, low, high = 1.0, 0.0, np.inf
    for _ in range(50):
        force = pushed - t * fall
        on = (force > 0) | data.two_sided
        slope = square + float(fall[on] @ fall[on]) / RHO
        value = start + t * square - float(force[on] @ fall[on]) / RHO
        low, high = (low, t) if value > 0 else (t, high)
        after = t - value / slope if slope > 0 else t
        if not low <= after <= high:
            after = 0.5 * (low + high) if np.isfinite(high) else 2.0 * t
        if abs(after - t) <= 1e-12 * t:
            return after
        t = after
    return t
