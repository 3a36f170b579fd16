"""An interior point for `LinkedCones`, step by step: who asks says when it is enough.

Mehrotra's predictor and corrector in the scaling of Nesterov and Todd. One factorisation of
A W^2 A^T a step, block by block (`kilter.solvers.block_cholesky`), re-used for both directions
and for projecting the forces of the step onto exact balance: long before they are optimal, such
forces may lie within their cones, which is all that a proof of equilibrium needs. As soon as
dual feasibility is reached, the multipliers are a proof of the opposite where there is one.

Columns that are free have no complement: a proximal term about the step before, of a weight that
is large beside that of the cones, stands for it and vanishes with the steps.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, 1992. E. D. Andersen,
C. Roos, T. Terlaky, On implementing a primal-dual interior-point method for conic quadratic
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

__all__ = ["Iterate", "Start", "common_start", "iterates"]

STEPS = 60
"""Steps at most."""
INSIDE = 1e-10
"""By how much forces over their share may leave their cones and be worth a proof."""
OPENED = 1e-7
"""By how much a motion may leave its cones, over its gain, and be worth a proof."""
SHORT_OF = 0.99
"""Part of the way to the boundary that a step goes: with more, steps near a limit stick."""
REGULAR = 1e-13, 1e-9
"""Added to the diagonal of a block over its mean entry: at first, and where that is not enough."""
WHOLE = 10.0
"""Weight of a free column over the largest of the cones'."""
REFINED = 2
"""Corrections of a projection onto balance."""
COMMON, CENTRED = 4, 0.99
"""Steps of a start that several programs share, and their part of the way to the boundary: a start
near a wall costs each of them more than it saves."""
DONE = 1e-16
"""Mean product of x and s below which steps lead nowhere."""
LEAST_CENTRE = 1e-8
"""Of the mean product that the next step aims at, over this one's."""


@dataclass(slots=True, eq=False)
class Iterate:
    """A step: x, s, shape (d, K); y, shape (N, n); t and most - t with their slacks (2,).

    Attributes
    ----------
    number : int
        Of the step, from 1.
    mean : float
        Mean product of x and s: 0 at the optimum.
    x_rest, y_rest : float
        Largest entries of A x - right - t along, and of A^T y + s.
    """

    problem: LinkedCones
    x: Array
    s: Array
    y: Array
    ends: Array
    slacks: Array
    end: float
    scaling: Scaling
    number: int = 0
    mean: float = np.inf
    x_rest: float = np.inf
    y_rest: float = np.inf

    @property
    def share(self) -> float:
        """The t of this step."""
        return float(self.ends[0])

    @property
    def bound(self) -> float:
        """No share above it is balanced, where -A^T y lies in the cones; inf without one."""
        gain = float((self.problem.along * self.y).sum())
        return -float((self.problem.right * self.y).sum()) / gain if gain > 0.0 else np.inf

    def balanced(self) -> Array | None:
        """The x nearest in the metric of the step that balances at its share, shape (d, K).

        None where it leaves its cones.
        """
        problem, x = self.problem, self.x
        goal = problem.right + self.share * problem.along
        size = float(np.abs(goal).max(initial=0.0))
        if self.x_rest > size:
            return None
        for _ in range(1 + REFINED):
            short = problem.factor.solve(goal - problem.balance(x))
            x = x + self.scaling.twice(problem.openings(short))
        outside = -(depth(x) * problem.sizes)[~problem.free]
        return x if outside.max(initial=0.0) <= INSIDE * size else None

    def against(self) -> Array | None:
        """The y with along.y > 0 and -A^T y in the cones, shape (N, n); None where it is not.

        For programs that are homogeneous: there is no x then.
        """
        gain = float((self.problem.along * self.y).sum())
        opening = -self.problem.openings(self.y)
        out = np.where(self.problem.free, np.abs(opening[0]), -depth(opening))
        return self.y if out.max(initial=0.0) <= OPENED * gain else None


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """x and s within the cones, shape (d, K), y, (N, n), and the mean product of x and s."""

    x: Array
    s: Array
    y: Array
    mean: float


def _middle(problem: LinkedCones) -> Start:
    """The middle of the cones."""
    x = np.zeros(problem.columns.shape[1:])
    x[0, ~problem.free] = 1.0
    return Start(x, x, np.zeros(problem.right.shape), 1.0)


def _begun(problem: LinkedCones, start: Start) -> Iterate:
    half = min(problem.most, 1.0) / 2
    ends = np.array([half, problem.most - half])
    # as far from 0 as the products of x and s; from the middle each is 1
    slacks = np.ones(2) if start.mean == 1.0 else start.mean / ends
    x, s = start.x.copy(), start.s.copy()
    return Iterate(problem, x, s, start.y.copy(), ends, slacks, 0.0, Scaling.of(x, x))


def common_start(problem: LinkedCones) -> Start:
    """Where programs that differ in `along` alone may all begin: a few steps without it.

    The same for each, so that programs that mirror one another have answers that do; each takes
    a third of its steps less.
    """
    now = _begun(problem.with_more(np.zeros(problem.along.shape), problem.most), _middle(problem))
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            for _ in range(COMMON):
                _stepped(now, CENTRED)
    except (NotPositive, FloatingPointError):
        return _middle(problem)
    count = int((~problem.free).sum())
    return Start(now.x, now.s, now.y, float((now.x * now.s).sum()) / count)


def iterates(
    problem: LinkedCones, short_of: float = SHORT_OF, start: Start | None = None
) -> Iterator[Iterate]:
    """The steps from the middle of the cones on, as far as rounding lets them go.

    Parameters
    ----------
    problem : LinkedCones
    short_of : float
        Part of the way to the boundary that a step goes.
    start : Start, optional
        In place of the middle: `common_start` of a program that differs in `along` alone.
    """
    now = _begun(problem, start or _middle(problem))
    for number in range(1, STEPS + 1):
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                _stepped(now, short_of)
        except (NotPositive, FloatingPointError):
            return
        if now.mean < DONE:
            return
        now.number = number
        yield now


@dataclass(slots=True, eq=False)
class _Rests:
    """What is left of the equations of x, of t, of s and of their ends."""

    x: Array
    span: float
    s: Array
    ends: Array


def _rests(now: Iterate) -> _Rests:
    problem, t = now.problem, now.ends[0]
    gain = float((problem.along * now.y).sum())
    rests = _Rests(
        problem.right + t * problem.along - problem.balance(now.x),
        problem.most - float(now.ends.sum()),
        -problem.openings(now.y) - now.s,
        np.array([gain - now.end - 1.0, -now.end]) - now.slacks,
    )
    now.x_rest = float(np.abs(rests.x).max(initial=0.0))
    now.y_rest = float(np.abs(rests.s).max(initial=0.0))
    return rests


def _mean(x: Array, s: Array, ends: Array, slacks: Array, count: int) -> float:
    return float(((x * s).sum() + ends @ slacks) / (count + 2))


def _scaled(now: Iterate) -> Scaling:
    """The scaling of the step; of free columns a weight of their own."""
    free = now.problem.free
    x, s = now.x.copy(), now.s.copy()
    x[:, free] = s[:, free] = 0.0
    x[0, free] = s[0, free] = 1.0
    scaling = Scaling.of(x, s)
    if free.any():
        most = float((scaling.eta * scaling.w[0])[~free].max(initial=1.0))
        scaling.eta[free] = WHOLE * most
    return scaling


def _factorised(problem: LinkedCones, scaling: Scaling) -> None:
    diagonal, links = problem.normal_matrix(scaling)
    size = diagonal.shape[1]
    mean = np.trace(diagonal, axis1=1, axis2=2) / size
    # a block that nothing touches
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


def _stepped(now: Iterate, short_of: float) -> None:
    """One step: predictor, corrector, as far as the cones let it."""
    problem = now.problem
    cones = ~problem.free
    count = int(cones.sum())
    # all of them as a view: a mask copies
    held = slice(None) if count == cones.size else cones
    rests = _rests(now)
    now.mean = mean = _mean(now.x, now.s, now.ends, now.slacks, count)
    now.scaling = scaling = _scaled(now)
    _factorised(problem, scaling)
    middle = scaling.times(now.s)
    middle[0, problem.free] = 1.0
    solve = _direction(now, rests, middle)

    def lengths(step: _Step) -> tuple[float, float]:
        return (
            min(reach(now.x[:, held], step.x[:, held]), _reach(now.ends, step.ends)),
            min(reach(now.s[:, held], step.s[:, held]), _reach(now.slacks, step.slacks)),
        )

    square, flat = product(middle, middle), now.ends * now.slacks
    step = solve(-square, -flat)
    a, b = (min(1.0, far) for far in lengths(step))
    after = _mean(
        now.x + a * step.x, now.s + b * step.s,
        now.ends + a * step.ends, now.slacks + b * step.slacks, count,
    )  # fmt: skip
    goal = min(max((after / mean) ** 3, LEAST_CENTRE), 1.0) * mean
    bent = product(scaling.over(step.x), scaling.times(step.s))
    change = -square - bent
    change[0] += goal
    step = solve(change, goal - flat - step.ends * step.slacks)
    a, b = (min(1.0, short_of * far) for far in lengths(step))
    now.x = now.x + a * step.x
    now.ends = now.ends + a * step.ends
    now.s = now.s + b * step.s
    now.slacks = now.slacks + b * step.slacks
    now.y = now.y + b * step.y
    now.end += b * step.end


@dataclass(slots=True, eq=False)
class _Step:
    """Changes of an iterate's members."""

    x: Array
    s: Array
    y: Array
    ends: Array
    slacks: Array
    end: float


def _direction(now: Iterate, rests: _Rests, middle: Array) -> Callable[[Array, Array], _Step]:
    """The step that brings the products of x and s, and those of the ends, to what is asked."""
    problem, scaling, free = now.problem, now.scaling, now.problem.free
    weight = now.ends / now.slacks
    along = problem.along
    answers: list[Array] = []  # of the blocks to t

    def solved(right: Array) -> Array:
        if answers:
            return problem.factor.solve(right)
        both = problem.factor.solve(np.stack([right, along], axis=-1))
        answers.append(both[..., 1])
        return both[..., 0]

    def solve(change: Array, flat: Array) -> _Step:
        change[:, free] = 0.0
        aimed = scaling.times(divided(middle, change))
        ends = flat / now.slacks - weight * rests.ends
        right = rests.x - problem.balance(aimed - scaling.twice(rests.s))
        y = solved(right)
        answer = answers[0]
        stiff = 1 + weight[0] / weight[1] + weight[0] * float((along * answer).sum())
        rest = (rests.span - ends[1]) / weight[1]
        dt = (ends[0] + weight[0] * (rest - float((along * y).sum()))) / stiff
        y = y + dt * answer
        end = rest - dt / weight[1]
        gain = float((along * y).sum())
        slacks = rests.ends + np.array([gain - end, -end])
        s = rests.s - problem.openings(y)
        x = aimed - scaling.twice(s)
        s[:, free] = 0.0
        dr = ends[1] + weight[1] * end
        return _Step(x, s, y, np.array([dt, dr]), slacks, end)

    return solve


def _reach(values: Array, steps: Array) -> float:
    """The largest t up to which all values + t steps stay positive."""
    falls = steps < 0
    return float((-values[falls] / steps[falls]).min(initial=np.inf))
