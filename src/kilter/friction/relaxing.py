"""Follow the parts from a displacement to balance, in pseudo-time (implicit Euler steps).

The equations r(x) = 0 of `kilter.friction.springs` are solved by pseudo-transient continuation,
implicit Euler steps of dx/dt = r(x),

    (x' - x) / h = r(x')

with a step h that grows as r decreases: first the path of parts in a viscous fluid, finally
Newton's method. Each step is solved by Newton's method, shortened if its full step passes the
minimum of the energy along it. If nothing holds the parts, x runs away: it continues to grow while
r stays constant.

References
----------
C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J. Numer.
Anal. 35, 1998.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array
from kilter.friction.friction_tolerances import BALANCED, GOAL
from kilter.friction.line_search import search_step_length
from kilter.friction.springs import Springs, SpringState
from kilter.work import Work

FIRST = 1e3
"""First step h. The tries of 256 random assemblies end alike for first steps from 1 to 1e3, and a
leaning wall of 300 bricks takes two fifths fewer Newton steps.
"""
INNER, LAST, IDLE = 80, 4, 25
"""Maximum number of Newton steps within a step h; the same if the path has nearly arrived; and
number of them without a reduction of the error after which Newton's method has failed.
"""
ROUGH = 20
"""Number of Newton steps within a step h that use symmetric matrices of large systems."""
STEP_ERROR, STEP_ERROR_SMALL, SMALL = 0.8, 0.3, 0.05
"""A step h is solved to the first fraction of r at its beginning; to the second if r is below the
third number.
"""
FALLING = 0.98
"""A Newton step that leaves more than this fraction of the least error does not count as a
reduction.
"""
GROWTH, SLOW, LEAP, EASY = 4.0, 1.2, 10.0, 6
"""h grows by the first factor after a step of at most the last number of Newton steps, else by the
second; and by the factor by which r fell, up to the third.
"""
CUT = 0.25
"""Factor of h after a failure of Newton's method."""
NEARLY = 0.1
"""Imbalance, over that which counts as balance, at which a path without further progress has
arrived.
"""
SHORTEST, LONGEST, LIMIT, EASING, FAR = 1e-6, 1e7, 1e9, 1.5, 1e4
"""The path fails at an h below the first number, and h never exceeds the third. Parts have run away
if h exceeds the second number, r decreases by less than the fourth factor, and the parts are
farther away than in balance by the last factor.
"""
MOST = 20_000
"""Number of Newton steps after which the path fails."""


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """End of the path of the parts in pseudo-time: in balance, run away, or failed."""

    state: SpringState
    end: Literal["balance", "runs-away", "not-found"]
    """One of "balance", "runs-away", "not-found". In balance; run away, while r stayed constant;
    failed, or out of work."""
    steps: int
    """Number of Newton steps."""


def relaxed(
    springs: Springs, x: Array, *, work: Work, first: float = FIRST, size: float = 1.0
) -> Rest:
    """Follow the path of the parts from a displacement x until they balance or run away.

    Arguments: `x` (n,): first displacement; `size`: size of displacements in balance; parts that
    are much farther away have run away.
    """
    state, step, steps = springs.at(x), first, 0
    far, behind = FAR * max(size, 1.0), np.zeros(len(x))

    def rest(end: Literal["balance", "runs-away", "not-found"]) -> Rest:
        return Rest(replace(state, x=behind + state.x), end, steps)

    while step > SHORTEST and not work.over:
        near = springs.imbalance(state) <= NEARLY * BALANCED
        new, count = _advance(springs, state, step, work, LAST if near else INNER)
        steps += count
        if new is None and near:
            break  # rounding prevents the path from reaching the goal
        if new is None:
            step *= CUT
            continue
        decrease = float(np.linalg.norm(state.rest)) / max(float(np.linalg.norm(new.rest)), TINY)
        behind, springs = behind + new.x, springs.moved(new)
        state = replace(new, x=np.zeros(len(x)))
        if springs.imbalance(state) <= GOAL:
            return rest("balance")
        if step > LONGEST and decrease < EASING and float(np.abs(behind).max()) > far:
            return rest("runs-away")
        if steps > MOST:
            break
        step *= (GROWTH if count <= EASY else SLOW) * float(np.clip(decrease, 1.0, LEAP))
        step = min(step, LIMIT)
    near = springs.imbalance(state) <= NEARLY * BALANCED
    return rest("balance" if near else "not-found")


def _advance(
    springs: Springs, state: SpringState, step: float, work: Work, most: int
) -> tuple[SpringState | None, int]:
    """Take a pseudo-time `step` by at most `most` Newton steps.

    Return the new state (None on failure) and the number of Newton steps.
    """
    new, error_vector = state, state.rest
    least_error = float(np.linalg.norm(error_vector))
    accepted = (STEP_ERROR if least_error > SMALL else STEP_ERROR_SMALL) * least_error
    stalled = 0
    rough = springs.system.matrix.symmetric_pays
    for count in range(1, most + 1):
        exact = not rough or count > ROUGH
        try:
            move = springs.newton(new, error_vector, 1.0 / step, work, exact=exact)
        except np.linalg.LinAlgError:
            return None, count
        new, error_vector = _line_search(springs, (state, new, error_vector), move, step, accepted)
        error = float(np.linalg.norm(error_vector))
        if error <= accepted:
            return new, count
        stalled = 0 if error < FALLING * least_error else stalled + 1
        if stalled == IDLE or not error < np.inf:
            return None, count
        least_error = min(least_error, error)
    return None, most


def _line_search(
    springs: Springs,
    at: tuple[SpringState, SpringState, Array],
    move: Array,
    step: float,
    enough: float,
) -> tuple[SpringState, Array]:
    """Choose the length of a Newton step so that the error does no more work along it.

    `at` holds the state at the beginning of the step h, the last state, and its error vector. A
    point that starts to touch adds much to the error, but little to the energy. So the line search
    uses the work of the error along the step, which falls from a positive value to 0 at the minimum
    of the energy. The step is shortened if that work is far below 0.
    """
    first, last, right = at
    gain_at_start = float(move @ right)

    def trial(part: float) -> tuple[tuple[SpringState, Array], float, bool]:
        """State and error after a part of the step, the work of the error, and if it is enough."""
        new = springs.at(last.x + part * move)
        error = new.rest - (new.x - first.x) / step
        small = gain_at_start <= 0 or float(np.linalg.norm(error)) <= enough
        return (new, error), float(move @ error), small

    return search_step_length(trial, gain_at_start)
