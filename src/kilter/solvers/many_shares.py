"""Largest shares of many loads that the same cones balance, side by side by an interior point.

    max t:  A x = right + t along,   x in second-order cones, or free          for D loads `along`

The dual is  min -right.y:  s = -A^T y in the dual cones,  along.y = 1,  and  -right.y - t = s.x.
So each pair of feasible points bounds t on both sides by its product s.x. The load at t = 0 lies
inside the set that the cones balance, and each `along` leaves it; then t is positive and finite.

Each step is that of `kilter.solvers.cone_interior_point` without limits of t. Arrays have an axis
for the loads, so that the steps of small problems cost little more than their arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.linked_cones import LinkedCones
from kilter.solvers.lorentz import Scaling, depth, divided, product, reaches
from kilter.work import seconds_left

STEPS = 60
"""Maximum number of steps."""
SHORT_OF = 0.99
"""Fraction of the distance to the boundary that a step covers."""
REGULAR = 1e-13, 1e-9
"""Regularisation of a normal matrix over its mean diagonal: the first, and a second after a failed
factorisation."""
WHOLE = 10.0
"""Weight of a free column over the largest weight of the cones."""
LEAST_CENTRE = 1e-8
"""Least ratio of the mean product that a step aims for to the current mean product."""
INSIDE = 1e-13
"""Largest distance of forces outside their cones, over the load [-]: rounding."""
OPENED = 1e-13
"""Largest violation of a motion, over its gain [-]: rounding."""
BALANCED = 1e-10
"""Largest imbalance of forces, over the load [-]."""
REFINED = 2
"""Number of projections of forces onto balance."""
MIDDLE = 1.0
"""Difference of the bounds of a share, over max(share, 1), at which its point is kept [-]: similar
loads begin there. With a smaller value the point is too near to the boundary of a cone."""
TRIED = 1e-3
"""Difference of the bounds of a share, over max(share, 1), below which its forces are tried [-]."""
DONE = 1e-12
"""Difference of the bounds below which further steps have no effect [-]."""
LOST = 1e30
"""Size of an entry at which the steps of a load have diverged."""


@dataclass(frozen=True, slots=True, eq=False)
class SharePoint:
    """Point of the method for a load: x and s in their cones, (d, K), y, shape (N, n), and t."""

    x: Array
    s: Array
    y: Array
    t: float


@dataclass(frozen=True, slots=True, eq=False)
class Share:
    """Largest share of a load: forces that balance a share, and multipliers that bound it."""

    share: float
    bound: float
    """Balanced share t, and its upper bound [-]."""
    x: Array
    """Unknowns in the cones that balance the share, shape (d, K)."""
    y: Array
    """Multipliers with along, shape (N, n).y = 1 and -A^T y in the dual cones."""
    middle: SharePoint
    """Point half-way, from which the search for a similar load may begin."""


@dataclass(slots=True, eq=False)
class _Points:
    """Points of the method for D loads: x, s (d, D, K); y, along (D, N, n); t, number (D,).

    `middles` holds the point of each load half-way, by its number.
    """

    number: Index
    right: Array
    along: Array
    x: Array
    s: Array
    y: Array
    t: Array
    middles: dict[int, SharePoint]

    def take(self, kept: Mask) -> None:
        """Keep only the points of some loads."""
        self.number, self.along = self.number[kept], self.along[kept]
        self.x, self.s = self.x[:, kept], self.s[:, kept]
        self.y, self.t = self.y[kept], self.t[kept]

    def point(self, k: int) -> SharePoint:
        """The present point of a load."""
        x, s = self.x[:, k].copy(), self.s[:, k].copy()
        return SharePoint(x, s, self.y[k].copy(), float(self.t[k]))


def first_point(problem: LinkedCones, opening: Array | None = None) -> SharePoint:
    """Point to begin from: forces x on the axes of their cones, and t = 0.

    Arguments: `opening` (N, n).
    """
    x = np.zeros(problem.columns.shape[1:])
    x[0, ~problem.free] = 1.0
    if opening is None:
        return SharePoint(x, x, np.zeros(problem.right.shape), 0.0)
    s = -problem.openings(opening)
    s[:, problem.free] = 0.0
    size = float(s[0].mean())
    return SharePoint(x, s / size, opening / size, 0.0)


def many_shares(
    problem: LinkedCones,
    right: Array,
    along: Array,
    starts: Sequence[SharePoint],
    *,
    agree: float,
) -> list[Share | None]:
    """Find the largest share of each of D loads that cones balance; None if a search fails.

    Arguments: `right` (N, n): load at t = 0; `along` (D, N, n): loads that grow with t; `starts`:
    where the search for each load begins: `first_point`, or the middle of a similar load; `agree`:
    largest difference of the two bounds of t, over max(t, 1) [-]. Raises `TimeLimitReached` at the
    limit of `kilter.work.stop_after`.

    Examples
    --------
    A block carries a pull aside of its weight times the friction coefficient:

    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.balance_in_cones import balance_in_cones
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import stacks
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> aside = np.zeros((2, 6))
    >>> aside[1, 0] = program.weight[1]
    >>> problem = balance_in_cones(program, program.load, aside, 1.0).cones
    >>> start = first_point(problem)
    >>> found = many_shares(problem, problem.right, problem.along[None], [start], agree=1e-6)[0]
    >>> round(found.share, 5), bool(found.share < 0.5 < found.bound)
    (0.5, True)
    """
    shares: list[Share | None] = [None] * len(along)
    if not shares:
        return shares
    x, s = (np.stack([getattr(start, k) for start in starts], axis=1) for k in ("x", "s"))
    y, t = np.stack([start.y for start in starts]), np.array([start.t for start in starts])
    points = _Points(np.arange(len(along)), right, along, x, s, y, t, {})
    for _ in range(STEPS):
        seconds_left(None)
        with np.errstate(all="ignore"):
            try:
                solve = _advance(problem, points)
            except NotPositive:
                break
            ended = _ended(problem, points, solve, agree, shares)
        if ended.all():
            break
        points.take(~ended)
    return shares


def _ended(
    problem: LinkedCones,
    points: _Points,
    solve: _Solve,
    agree: float,
    shares: list[Share | None],
) -> Mask:
    """Mask of the loads whose search ended; the list holds the best share so far of each load.

    Shares are tried before the bounds agree: forces near the boundary lose their balance.
    """
    gap = (points.x * points.s).sum(axis=(0, 2)) / np.maximum(np.abs(points.t), 1.0)
    ended: Mask = ~np.isfinite(gap) | (np.abs(points.x).max(axis=(0, 2)) > LOST) | (gap < DONE)
    for k in np.flatnonzero(~ended & (gap < MIDDLE)).tolist():
        number = int(points.number[k])
        if number not in points.middles:
            points.middles[number] = points.point(k)
    near = np.flatnonzero(~ended & (gap <= max(agree, TRIED)))
    if not len(near):
        return ended
    opening = -problem.openings(points.y[near])
    violation = np.where(problem.free, np.abs(opening[0]), -depth(opening)).max(axis=-1)
    gain = (points.along[near] * points.y[near]).sum(axis=(1, 2))
    target = points.right + points.t[near, None, None] * points.along[near]
    size = np.abs(target).max(axis=(1, 2))
    x = points.x[:, near]
    for _ in range(REFINED):
        correction = solve(target - problem.balance(x), near)
        x = x + solve.scaling_of(near).twice(problem.openings(correction))
    outside = (-(depth(x) * problem.sizes) * ~problem.free).max(axis=-1)
    rest = np.abs(target - problem.balance(x)).max(axis=(1, 2))
    good = (violation <= OPENED * gain) & (outside <= INSIDE * size) & (rest <= BALANCED * size)
    for j in np.flatnonzero(good):
        k = near[j]
        y = points.y[k] / gain[j]
        bound = -float((points.right * y).sum())
        number = int(points.number[k])
        middle = points.middles[number]
        shares[number] = Share(float(points.t[k]), bound, x[:, j], y, middle)
    known = np.array([shares[number] is not None for number in points.number[near]])
    ended[near[known & (gap[near] <= agree)]] = True
    return ended


class _Solve:
    """Solver of the normal equations A W^2 A^T of each load, factorised for scalings W."""

    def __init__(self, problem: LinkedCones, scaling: Scaling) -> None:
        self.scaling = scaling
        diagonal, links = problem.normal_matrix(scaling)
        size = diagonal.shape[-1]
        mean = np.trace(diagonal, axis1=-2, axis2=-1) / size
        mean = np.where(mean > 0, mean, 1.0)
        each = np.arange(size)
        self._factors = [copy(problem.factor) for _ in range(len(diagonal))]
        for k, factor in enumerate(self._factors):
            for regular in REGULAR:
                diagonal[k][:, each, each] += regular * mean[k][:, None]
                try:
                    factor.factorise(diagonal[k], links[k])
                except NotPositive:
                    if regular == REGULAR[-1]:
                        raise
                else:
                    break

    def __call__(self, right: Array, loads: Index | None = None) -> Array:
        """Solve for a right-hand side of each load, shape (D, N, n), or of some loads."""
        numbers = range(len(self._factors)) if loads is None else loads
        return np.array(
            [self._factors[k].solve(side) for k, side in zip(numbers, right, strict=True)]
        )

    def scaling_of(self, loads: Index) -> Scaling:
        """Scaling W of some loads."""
        return Scaling(self.scaling.w[:, loads], self.scaling.eta[loads])


def _step_scaling(problem: LinkedCones, points: _Points) -> Scaling:
    """Nesterov-Todd scaling of the points; free columns get a large weight instead."""
    free = problem.free
    x, s = points.x.copy(), points.s.copy()
    x[:, :, free] = s[:, :, free] = 0.0
    x[0][:, free] = s[0][:, free] = 1.0
    scaling = Scaling.of(x, s)
    if free.any():
        largest = (scaling.eta * scaling.w[0])[:, ~free].max(axis=1, initial=1.0)
        scaling.eta[:, free] = WHOLE * largest[:, None]
    return scaling


def _advance(problem: LinkedCones, points: _Points) -> _Solve:
    """Take a step for each load: predictor, corrector, then move as far as the cones allow."""
    free = problem.free
    coned = slice(None) if not free.any() else ~free
    count = int((~free).sum())
    x_rest = points.right + points.t[:, None, None] * points.along - problem.balance(points.x)
    s_rest = -problem.openings(points.y) - points.s
    t_rest = 1.0 - (points.along * points.y).sum(axis=(1, 2))
    mean = (points.x * points.s).sum(axis=(0, 2)) / count
    scaling = _step_scaling(problem, points)
    solve = _Solve(problem, scaling)
    answer = solve(points.along)
    stiff = (points.along * answer).sum(axis=(1, 2))
    scaled_point = scaling.times(points.s)
    scaled_point[0][:, free] = 1.0

    def direction(change: Array) -> tuple[Array, Array, Array, Array]:
        """Newton step (dx, ds, dy, dt) for given changes of the complementarity products."""
        change[:, :, free] = 0.0
        aimed = scaling.times(divided(scaled_point, change))
        y = solve(x_rest - problem.balance(aimed - scaling.twice(s_rest)))
        t = (t_rest - (points.along * y).sum(axis=(1, 2))) / stiff
        y = y + t[:, None, None] * answer
        s = s_rest - problem.openings(y)
        x = aimed - scaling.twice(s)
        s[:, :, free] = 0.0
        return x, s, y, t

    def lengths(x: Array, s: Array, most: float) -> tuple[Array, Array]:
        """Primal and dual step lengths of each load, shapes (D,), at most 1."""
        a = reaches(points.x[:, :, coned], x[:, :, coned])
        b = reaches(points.s[:, :, coned], s[:, :, coned])
        return np.minimum(most * a, 1.0), np.minimum(most * b, 1.0)

    square = product(scaled_point, scaled_point)
    x, s, _, _ = direction(-square)
    a, b = lengths(x, s, 1.0)
    predicted = (points.x + a[:, None] * x) * (points.s + b[:, None] * s)
    ratio = predicted.sum(axis=(0, 2)) / count / mean
    target = np.clip(ratio**3, LEAST_CENTRE, 1.0) * mean
    change = -square - product(scaling.over(x), scaling.times(s))
    change[0] += target[:, None]
    x, s, y, t = direction(change)
    a, b = lengths(x, s, SHORT_OF)
    points.x = points.x + a[:, None] * x
    points.t = points.t + a * t
    points.s = points.s + b[:, None] * s
    points.y = points.y + b[:, None, None] * y
    return solve
