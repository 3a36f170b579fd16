"""Interior-point method for `LinkedCones`, one step at a time; the caller decides when to stop.

Mehrotra's predictor and corrector in the scaling of Nesterov and Todd. Each step factorises A W^2
A^T once, block by block (`kilter.solvers.block_cholesky`). Both directions reuse the factors, and
so does the projection of the forces onto exact balance: long before they are optimal, projected
forces may lie in their cones, which is all that a proof of equilibrium needs. As soon as the
multipliers are dual feasible, they are a proof of the opposite, if one exists.

Free columns have no complement. A proximal term about the previous step stands in for it, with a
weight that is large compared with those of the cones; the term vanishes as the steps converge.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, 1992. E. D. Andersen, C.
Roos, T. Terlaky, On implementing a primal-dual interior-point method for conic quadratic
optimization, 2003.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.linked_cones import LinkedCones
from kilter.solvers.lorentz import Scaling, depth, divided, product, reach

STEPS = 60
"""Maximum number of steps."""
INSIDE = 1e-10
"""Largest distance of forces outside their cones, over the load, with which they are worth a proof
attempt.
"""
OPENED = 1e-7
"""Largest violation of a motion, over its gain, with which it is worth a proof attempt."""
SHORT_OF = 0.99
"""Fraction of the distance to the boundary that a step covers. With a larger value, steps near a
limit stall.
"""
REGULAR = 1e-13, 1e-9
"""Regularisation of a diagonal block over its mean entry: the first, and a second if factorisation
fails.
"""
WHOLE = 10.0
"""Weight of a free column over the largest weight of the cones."""
REFINED = 2
"""Number of corrections of a projection onto balance."""
COMMON, CENTRED = 4, 0.99
"""Number of steps of a start that several programs share, and their fraction of the distance to the
boundary. A start near the boundary costs each program more steps than it saves."""
DONE = 1e-16
"""Mean product of x and s below which further steps have no effect."""
LEAST_CENTRE = 1e-8
"""Least ratio of the mean product that a step aims for to the current mean product."""


@dataclass(slots=True, eq=False)
class Iterate:
    """State of the interior-point method after a step; each step overwrites it."""

    problem: LinkedCones
    x: Array
    s: Array
    """Unknowns and dual slacks, in the cones, shape (d, K)."""
    y: Array
    """Multipliers of the balance, shape (N, n)."""
    ends: Array
    slacks: Array
    """t and most - t, and their dual slacks, shape (2,)."""
    end: float
    """Multiplier of the equation t + (most - t) = most."""
    scaling: Scaling
    """Scaling of the step."""
    number: int = 0
    """Number of the step, from 1."""
    mean: float = np.inf
    """Mean product of x and s: 0 at the optimum."""
    x_rest: float = np.inf
    y_rest: float = np.inf
    """Largest entries of A x - right - t along, and of A^T y + s."""

    @property
    def share(self) -> float:
        """Load share t at this step of the interior-point method [-]."""
        return float(self.ends[0])

    @property
    def bound(self) -> float:
        """Upper bound of the load share t that the multipliers prove; inf if they prove none."""
        gain = float((self.problem.along * self.y).sum())
        return -float((self.problem.right * self.y).sum()) / gain if gain > 0.0 else np.inf

    def balanced(self) -> Array | None:
        """Forces x, shape (d, K), near the iterate that balance share t; None if outside the cones.

        None if it leaves its cones.
        """
        problem, x = self.problem, self.x
        target = problem.right + self.share * problem.along
        size = float(np.abs(target).max(initial=0.0))
        if self.x_rest > size:
            return None
        for _ in range(1 + REFINED):
            correction = problem.factor.solve(target - problem.balance(x))
            x = x + self.scaling.twice(problem.openings(correction))
        outside = -(depth(x) * problem.sizes)[~problem.free]
        return x if outside.max(initial=0.0) <= INSIDE * size else None

    def against(self) -> Array | None:
        """Multipliers y, (N, n), which prove that no positive share balances; else None.

        For homogeneous programs: y proves that no x balances a positive share.
        """
        gain = float((self.problem.along * self.y).sum())
        opening = -self.problem.openings(self.y)
        violation = np.where(self.problem.free, np.abs(opening[0]), -depth(opening))
        return self.y if violation.max(initial=0.0) <= OPENED * gain else None


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Starting point of the method: x and s inside the cones, shape (d, K), and y, shape (N, n).

    `mean` is the mean product of x and s.
    """

    x: Array
    s: Array
    y: Array
    mean: float


def _middle(problem: LinkedCones) -> Start:
    """Central starting point: x and s are the axes of the cones, y is 0."""
    x = np.zeros(problem.columns.shape[1:])
    x[0, ~problem.free] = 1.0
    return Start(x, x, np.zeros(problem.right.shape), 1.0)


def _first_iterate(problem: LinkedCones, start: Start) -> Iterate:
    """Iterate at a starting point, with the load share t in the middle of its range."""
    half = min(problem.most, 1.0) / 2
    ends = np.array([half, problem.most - half])
    # so that t s_t equals the mean product of x and s, which is 1 at the central start
    slacks = np.ones(2) if start.mean == 1.0 else start.mean / ends
    x, s = start.x.copy(), start.s.copy()
    return Iterate(problem, x, s, start.y.copy(), ends, slacks, 0.0, Scaling.of(x, x))


def common_start(problem: LinkedCones) -> Start:
    """Starting point shared by programs that differ only in `along`: a few steps with along = 0.

    The start is the same for each program, so programs that are mirror images of one another have
    mirror-image answers. Each program then takes a third fewer steps.
    """
    iterate = _first_iterate(
        problem.with_more(np.zeros(problem.along.shape), problem.most), _middle(problem)
    )
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            for _ in range(COMMON):
                _advance(iterate, CENTRED)
    except (NotPositive, FloatingPointError):
        return _middle(problem)
    count = int((~problem.free).sum())
    return Start(iterate.x, iterate.s, iterate.y, float((iterate.x * iterate.s).sum()) / count)


def iterates(
    problem: LinkedCones, short_of: float = SHORT_OF, start: Start | None = None
) -> Iterator[Iterate]:
    """Yield the steps of the interior-point method, until rounding prevents further progress.

    The same object is yielded at each step, updated.

    Arguments: `start`: `common_start` of a program that differs only in `along`; default: the axes
    of the cones.
    """
    iterate = _first_iterate(problem, start or _middle(problem))
    for number in range(1, STEPS + 1):
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                _advance(iterate, short_of)
        except (NotPositive, FloatingPointError):
            return
        if iterate.mean < DONE:
            return
        iterate.number = number
        yield iterate


@dataclass(slots=True, eq=False)
class _Residuals:
    """Residuals of the optimality equations: balance, dual slacks, and the terms of the share t."""

    x: Array
    span: float
    s: Array
    ends: Array


def _residuals(iterate: Iterate) -> _Residuals:
    """Residuals of the optimality equations; also stores their largest entries in the iterate."""
    problem, t = iterate.problem, iterate.ends[0]
    gain = float((problem.along * iterate.y).sum())
    residuals = _Residuals(
        problem.right + t * problem.along - problem.balance(iterate.x),
        problem.most - float(iterate.ends.sum()),
        -problem.openings(iterate.y) - iterate.s,
        np.array([gain - iterate.end - 1.0, -iterate.end]) - iterate.slacks,
    )
    iterate.x_rest = float(np.abs(residuals.x).max(initial=0.0))
    iterate.y_rest = float(np.abs(residuals.s).max(initial=0.0))
    return residuals


def _mean_product(x: Array, s: Array, ends: Array, slacks: Array, count: int) -> float:
    """Mean complementarity product of x and s and of the bounds of t, which goes to 0."""
    return float(((x * s).sum() + ends @ slacks) / (count + 2))


def _step_scaling(iterate: Iterate) -> Scaling:
    """Nesterov-Todd scaling of an iterate, with a large weight for free columns."""
    free = iterate.problem.free
    x, s = iterate.x.copy(), iterate.s.copy()
    x[:, free] = s[:, free] = 0.0
    x[0, free] = s[0, free] = 1.0
    scaling = Scaling.of(x, s)
    if free.any():
        largest = float((scaling.eta * scaling.w[0])[~free].max(initial=1.0))
        scaling.eta[free] = WHOLE * largest
    return scaling


def _factorise(problem: LinkedCones, scaling: Scaling) -> None:
    """Factorise A W^2 A^T of a scaling W, with more regularisation if the first attempt fails."""
    diagonal, links = problem.normal_matrix(scaling)
    size = diagonal.shape[1]
    mean = np.trace(diagonal, axis1=1, axis2=2) / size
    # a block without links has a mean of 0
    mean = np.where(mean > 0, mean, 1.0)
    each = np.arange(size)
    for regular in REGULAR:
        diagonal[:, each, each] += regular * mean[:, None]
        try:
            problem.factor.factorise(diagonal, links)
        except NotPositive:
            if regular == REGULAR[-1]:
                raise
        else:
            return


def _advance(iterate: Iterate, short_of: float) -> None:
    """Take a step: predictor, corrector, then move as far as the cones allow."""
    problem = iterate.problem
    cones = ~problem.free
    count = int(cones.sum())
    # a slice is a view; a mask copies
    coned = slice(None) if count == cones.size else cones
    residuals = _residuals(iterate)
    iterate.mean = mean = _mean_product(iterate.x, iterate.s, iterate.ends, iterate.slacks, count)
    iterate.scaling = scaling = _step_scaling(iterate)
    _factorise(problem, scaling)
    scaled_point = scaling.times(iterate.s)
    scaled_point[0, problem.free] = 1.0
    solve = _direction(iterate, residuals, scaled_point)

    def lengths(step: _Step) -> tuple[float, float]:
        """Largest primal and dual step lengths that keep x and s in their cones."""
        return (
            min(
                reach(iterate.x[:, coned], step.x[:, coned]), _largest_step(iterate.ends, step.ends)
            ),
            min(
                reach(iterate.s[:, coned], step.s[:, coned]),
                _largest_step(iterate.slacks, step.slacks),
            ),
        )

    point_square, end_products = product(scaled_point, scaled_point), iterate.ends * iterate.slacks
    step = solve(-point_square, -end_products)
    a, b = (min(1.0, limit) for limit in lengths(step))
    predicted = _mean_product(
        iterate.x + a * step.x, iterate.s + b * step.s,
        iterate.ends + a * step.ends, iterate.slacks + b * step.slacks, count,
    )  # fmt: skip
    # Mehrotra's rule: the better the predictor, the smaller the mean product to aim for
    target = min(max((predicted / mean) ** 3, LEAST_CENTRE), 1.0) * mean
    second_order = product(scaling.over(step.x), scaling.times(step.s))
    change = -point_square - second_order
    # the aimed product is the mean product times (1, 0, ..), the unit of the Jordan product
    change[0] += target
    step = solve(change, target - end_products - step.ends * step.slacks)
    a, b = (min(1.0, short_of * limit) for limit in lengths(step))
    iterate.x = iterate.x + a * step.x
    iterate.ends = iterate.ends + a * step.ends
    iterate.s = iterate.s + b * step.s
    iterate.slacks = iterate.slacks + b * step.slacks
    iterate.y = iterate.y + b * step.y
    iterate.end += b * step.end


@dataclass(slots=True, eq=False)
class _Step:
    """Changes of x, s, y and t in a step of the interior-point method."""

    x: Array
    s: Array
    y: Array
    ends: Array
    slacks: Array
    end: float


def _direction(
    iterate: Iterate, residuals: _Residuals, scaled_point: Array
) -> Callable[[Array, Array], _Step]:
    """Create a function that solves the Newton equations of an iterate for a change of products.

    The system is solved by eliminating x, s and the slacks; the last unknown is the change of t.
    """
    problem, scaling, free = iterate.problem, iterate.scaling, iterate.problem.free
    weight = iterate.ends / iterate.slacks
    along = problem.along
    responses: list[Array] = []  # response of y to a unit change of t

    def solved(right: Array) -> Array:
        if responses:
            return problem.factor.solve(right)
        both = problem.factor.solve(np.stack([right, along], axis=-1))
        responses.append(both[..., 1])
        return both[..., 0]

    def solve(change: Array, flat: Array) -> _Step:
        """Solve the Newton equations for given changes of the complementarity products."""
        change[:, free] = 0.0
        aimed = scaling.times(divided(scaled_point, change))
        ends = flat / iterate.slacks - weight * residuals.ends
        right = residuals.x - problem.balance(aimed - scaling.twice(residuals.s))
        y = solved(right)
        answer = responses[0]
        stiff = 1 + weight[0] / weight[1] + weight[0] * float((along * answer).sum())
        rest = (residuals.span - ends[1]) / weight[1]
        dt = (ends[0] + weight[0] * (rest - float((along * y).sum()))) / stiff
        y = y + dt * answer
        end = rest - dt / weight[1]
        gain = float((along * y).sum())
        slacks = residuals.ends + np.array([gain - end, -end])
        s = residuals.s - problem.openings(y)
        x = aimed - scaling.twice(s)
        s[:, free] = 0.0
        dr = ends[1] + weight[1] * end
        return _Step(x, s, y, np.array([dt, dr]), slacks, end)

    return solve


def _largest_step(values: Array, steps: Array) -> float:
    """Largest t at which all values + t * steps are positive; inf if no value decreases."""
    falls = steps < 0
    return float((-values[falls] / steps[falls]).min(initial=np.inf))
