"""Projection on a polyhedral cone: an interior point, then exact multipliers.

    min 1/2 |b|^2 - v.b,   R b = 0 in the first rows, then R b >= 0

The interior point (Mehrotra's predictor and corrector, Gondzio's centrality correctors) works
on the normal matrix I + R^T D R, which has one block a part and one a pair of parts that touch:
one factorisation a step, and every corrector re-uses it. Where contacts neither press nor open,
as between bricks that fall side by side, its answer is only as good as the square root of its gap.

Where its steps are whole it looks ahead. Slacks s and forces f that both vanish go like the
root of their products w; along

    s f = (1 - t)^2 w

all is smooth up to t = 1, which a few terms of its series about t = 0 reach. Every term is one
solution with the factors of the step; what comes out is judged as any other point.

Else it is followed by steps of the method of multipliers from its forces f,

    b = argmin 1/2 |b|^2 - v.b + 1/(2 rho) |max(0, f - rho R b)|^2,    f <- max(0, f - rho R b)

each minimised exactly by Newton's method (the function is piecewise quadratic). No row has to
be guessed active: the step never moves f by more than its distance to the nearest optimum, so
violation and complementarity end below that distance over rho, however degenerate the rows.
Whoever asks for fewer digits has the interior point's answer as soon as it has them.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, 1992. J. Gondzio,
Multiple centrality corrections in a primal-dual method for linear programming, 1996. R. T.
Rockafellar, Augmented Lagrangians and applications of the proximal point algorithm, 1976.
J. Stoer, M. Wechs, Infeasible-interior-point paths for sufficient linear complementarity
problems and their analyticity, 1998.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.linked_rows import LinkedRows
from kilter.solvers.problem import ConeProjection

__all__ = ["ProjectionSolution", "solve_projection"]


STEPS = 120
"""Steps of the interior point at most."""
CORRECTORS = 4
"""Centrality correctors of one factorisation at most."""
TERMS = 3
"""Of the series that looks ahead."""
START = 1.0
"""First slacks and forces over the largest load."""
SHORT_OF = 0.995
"""Part of the way to the boundary that a step goes."""
GAP = 1e-16
"""Mean product of slack and force, over the square of gravity, that ends the interior point."""
ROUNDED = 0.1
"""Rests over the root of that product, from which on it does not pay that they grow."""
PROXIMAL = 1e-7
"""Regularisation of two-sided rows."""
RHO = 1e3
"""Weight of the rows in the method of multipliers."""
LEAST = 1e-12
"""Slacks, forces and their falls below this, of the load or of themselves, are taken as this."""
ROUNDS, NEWTON = 6, 60
"""Steps of the method of multipliers, and of Newton's method in each, at most."""
LIGHTEST = 1e-200
"""Least weight of a product: of parts lighter still there are no numbers left."""
EXACT = 3e-12
"""Least change of forces over the load that ends all."""


@dataclass(frozen=True, slots=True, eq=False)
class ProjectionSolution:
    """Unknowns b and multipliers, unjudged; factorisations of both stages."""

    unknowns: Array
    multipliers: Array
    factorisations: int


@dataclass(frozen=True, slots=True, eq=False)
class _Data:
    """The problem, lengths over the load."""

    linked: LinkedRows
    load: Array
    two_sided: Mask
    weight: Array

    def opening(self, b: Array) -> Array:
        """R b."""
        result: Array = self.linked.rows @ b
        return result

    def push(self, f: Array) -> Array:
        """R^T f."""
        result: Array = self.linked.turned @ f
        return result


def solve_projection(problem: ConeProjection, *, enough: float = 0.0) -> ProjectionSolution:
    """Solve by interior point and, where that does not reach what is asked for, multipliers.

    Parameters
    ----------
    enough : float
        Violation of the conditions, over the load, below which an answer is good enough; 0 is as
        far as float64 goes.

    Raises
    ------
    NotPositive
        If a matrix cannot be factorised at the first step, or while forces are made exact.
    """
    size = float(np.abs(problem.load).max(initial=0.0))
    if size == 0.0 or not len(problem.unit):
        return ProjectionSolution(problem.load.copy(), np.zeros(len(problem.unit)), 0)
    # light parts have small numbers: products of theirs are to vanish sooner
    weight = np.maximum((problem.unit.min() / problem.unit) ** 2, LIGHTEST)
    data = _Data(
        LinkedRows(problem.rows, problem.block, problem.place),
        problem.load / size,
        np.arange(len(problem.unit)) < problem.equal,
        weight,
    )
    b, f, violation, count = _interior(data, enough)
    if violation > enough:
        b, f, more = _multipliers(data, b, f, max(EXACT, enough))
        count += more
    return ProjectionSolution(b * size, f * size, count)


def _interior(data: _Data, enough: float) -> tuple[Array, Array, float, int]:
    """The best point on the way: b, f, its violation, and how many factorisations."""
    two = data.two_sided
    root = np.sqrt(data.weight)
    length = 0.0
    b = data.linked.factorised(np.ones(len(two)))(data.load)
    opening = data.opening(b)
    s = np.where(two, 1.0, np.maximum(opening, 0) + START * root)
    f = np.where(two, -opening, np.maximum(-opening, 0) + START * root)
    gap = min(GAP, enough**2) if enough else GAP
    best, before, kept = np.inf, np.inf, (b, np.where(two, f, np.maximum(f, 0)), np.inf)
    count = 1
    for _ in range(STEPS):
        rd = b - data.load - data.push(f)
        rp = data.opening(b) - np.where(two, 0.0, s)
        mu = float((s * f / data.weight)[~two].mean()) if not two.all() else 0.0
        worst = max(float(np.abs(rd).max()), float(np.abs(rp).max(initial=0.0)))
        merit = max(worst, np.sqrt(max(mu, 0.0)))
        both = float((np.minimum(s, np.abs(f)) / root)[~two].max(initial=0.0))
        reached = max(worst, both) <= enough
        if reached or merit < best:
            best, kept = merit, (b, f, max(worst, both))
        if reached:
            break
        if worst > max(before, ROUNDED * np.sqrt(mu)):
            break  # rounding has taken over
        before = worst
        if mu < gap and worst < 1e-8:
            break
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                whole = enough > 0 and length == 1.0
                db, ds, df, length, end = _direction(data, s, f, rd, rp, mu, whole)
        except (NotPositive, FloatingPointError):  # singular to working precision
            break
        count += 1
        if end is not None:
            ahead = _answer(data, end)
            if ahead[2] <= enough:
                return *ahead, count
        b, s, f = b + length * db, s + np.where(two, 0, length * ds), f + length * df
        least = LEAST * LEAST * data.weight
        s, f = np.where(two, s, np.maximum(s, least)), np.where(two, f, np.maximum(f, least))
        if length < 1e-8:
            break
    return *kept, count


def _reach(v: Array, dv: Array) -> float:
    down = dv < -LEAST * v
    return min(1.0, float((-v[down] / dv[down]).min(initial=np.inf)))


def _answer(data: _Data, f: Array) -> tuple[Array, Array, float]:
    """Forces as they may be, the b that they give, and its violation."""
    two = data.two_sided
    f = np.where(two, f, np.maximum(f, 0.0))
    b = data.load + data.push(f)
    opening = data.opening(b)
    rest = np.where(two, opening, np.minimum(opening, f) / np.sqrt(data.weight))
    return b, f, float(np.abs(rest).max())


def _direction(
    data: _Data, s: Array, f: Array, rd: Array, rp: Array, mu: float, look: bool
) -> tuple[Array, Array, Array, float, Array | None]:
    """Predictor, corrector and centrality correctors; the length of the step; forces ahead."""
    two, one = data.two_sided, ~data.two_sided
    weights = np.where(two, 1.0 / PROXIMAL, f / s)
    solve = data.linked.factorised(weights)

    def newton(rd: Array, rp: Array, rc: Array) -> tuple[Array, Array, Array]:
        u = np.where(two, -rp / PROXIMAL, (rc - f * rp) / s)
        db = solve(data.push(u) - rd)
        opening = data.opening(db)
        return db, np.where(two, 0.0, opening + rp), u - weights * opening

    def reach(ds: Array, df: Array) -> float:
        return min(_reach(s[one], ds[one]), _reach(f[one], df[one]))

    db, ds, df = newton(rd, rp, -s * f)
    if two.all():  # equations only: a whole step
        return db, ds, df, 1.0, None
    end = None
    if look:
        slack, force = [s, 2.0 * ds], [f, 2.0 * df]
        for k in range(2, TERMS + 1):
            before = sum(slack[j] * force[k - j] for j in range(1, k))
            product = np.where(two, 0.0, (s * f if k == 2 else 0.0) - before)
            _, *term = newton(np.zeros_like(rd), np.zeros_like(rp), product)
            slack, force = [*slack, term[0]], [*force, term[1]]
        end = np.sum(force, axis=0)
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
    return db, ds, df, length if length == 1.0 else SHORT_OF * length, end


def _multipliers(data: _Data, b: Array, f: Array, enough: float) -> tuple[Array, Array, int]:
    """Steps of the method of multipliers, until violations are below `enough`."""
    count = 0
    for _ in range(ROUNDS):
        b, steps = _minimised(data, b, f, 0.1 * enough)
        count += steps
        pushed = f - RHO * data.opening(b)
        after = np.where(data.two_sided, pushed, np.maximum(pushed, 0.0))
        moved = float(np.abs((after - f) / np.sqrt(data.weight)).max()) / RHO
        f = after
        if moved < enough:
            break
    return b, f, count


def _minimised(data: _Data, b: Array, f: Array, enough: float) -> tuple[Array, int]:
    """Newton's method on the piecewise quadratic, with an exact search along each step."""
    before: Mask | None = None
    solve: Callable[[Array], Array] | None = None
    count, least = 0, np.inf
    for _ in range(NEWTON):
        pushed = f - RHO * data.opening(b)
        active = (pushed > 0) | data.two_sided
        gradient = b - data.load - data.push(np.where(active, pushed, 0.0))
        size = float(np.abs(gradient).max())
        if size < enough:
            break
        same = before is not None and np.array_equal(active, before)
        if same and size > 0.5 * least:
            break  # as far as float64 goes
        least = min(size, least)
        if solve is None or not same:
            solve, before = data.linked.factorised(np.where(active, RHO, 0.0)), active
            count += 1
        d = solve(-gradient)
        b = b + _line(data, b, d, pushed) * d
    return b, count


def _line(data: _Data, b: Array, d: Array, pushed: Array) -> float:
    """The minimum along d: a root of an increasing, piecewise linear function."""
    fall = RHO * data.opening(d)
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
