"""The path of parts from a displacement to balance, in pseudo-time.

The equations r(x) = 0 of `kilter.friction.springs` are solved by pseudo-transient continuation,
implicit Euler steps of dx/dt = r(x),

    (x' - x) / h = r(x')

with a step h that grows as r falls: at first the path of parts in thick oil, at last Newton's
method. Each step is solved by Newton's method, shortened where its full step goes beyond the
least energy along it. Where nothing holds, x runs away: it goes on while r stands still.

References
----------
C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J.
Numer. Anal. 35, 1998.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array
from kilter.friction.friction_tolerances import BALANCED, GOAL
from kilter.friction.springs import Springs, SpringState
from kilter.work import Work

__all__ = ["Rest", "relaxed"]

FIRST = 1.0
"""First step h."""
INNER, IDLE = 80, 25
"""Newton steps within one step h, and those after which it failed if the error did not fall."""
STEP_ERROR, STEP_ERROR_SMALL, SMALL = 0.5, 0.1, 0.05
"""A step h is solved to this fraction of r at its beginning; the second below an r of SMALL."""
LEFT, SEARCHED, EDGE = 0.2, 8, 0.1
"""Along a Newton step the work of the error falls to this fraction; points that are tried; how
near the ends of what is left the next may be."""
FALLING = 0.98
"""A Newton step that leaves more than this fraction of the least error did not let it fall."""
GROWTH, SLOW, LEAP, EASY = 2.0, 1.2, 10.0, 6
"""H grows by GROWTH after a step that took up to EASY Newton steps, else by SLOW; times the
factor by which r fell, up to LEAP."""
CUT = 0.25
"""What h is multiplied by where Newton's method failed."""
NEARLY = 0.1
"""Imbalance, over that which counts as balance, at which a path that comes no further is there."""
SHORTEST, LONGEST, LIMIT, EASING, FAR = 1e-6, 1e7, 1e9, 1.5, 1e4
"""It is given up at an h below SHORTEST, and none is above LIMIT; parts have run away at an h
above LONGEST if r does not even fall by EASING, and if they are FAR times as far off as in
balance."""
MOST = 20_000
"""Newton steps after which it is given up."""


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """Where a path ends.

    Attributes
    ----------
    state : SpringState
    end : {"balance", "runs-away", "not-found"}
        In balance; gone, while r stood still; given up, or out of work.
    steps : int
        Newton steps.
    """

    state: SpringState
    end: Literal["balance", "runs-away", "not-found"]
    steps: int


def relaxed(
    springs: Springs, x: Array, *, work: Work, first: float = FIRST, size: float = 1.0
) -> Rest:
    """The path from a displacement x.

    Parameters
    ----------
    springs : Springs
    x : ndarray, shape (n,)
    work : Work
        The path ends where nothing of it is left.
    first : float
        The first step h.
    size : float
        Of displacements in balance; parts that are much farther off have run away.
    """
    state, step, steps = springs.at(x), first, 0
    far = FAR * max(size, 1.0)
    while step > SHORTEST and not work.over:
        new, count = _advanced(springs, state, step, work)
        steps += count
        if new is None and springs.imbalance(state) <= NEARLY * BALANCED:
            break  # at the rounding of its numbers it does not come to the goal
        if new is None:
            step *= CUT
            continue
        fall = float(np.linalg.norm(state.rest)) / max(float(np.linalg.norm(new.rest)), TINY)
        state = new
        if springs.imbalance(state) <= GOAL:
            return Rest(state, "balance", steps)
        if step > LONGEST and fall < EASING and float(np.abs(state.x).max()) > far:
            return Rest(state, "runs-away", steps)
        if steps > MOST:
            break
        step *= (GROWTH if count <= EASY else SLOW) * float(np.clip(fall, 1.0, LEAP))
        step = min(step, LIMIT)
    near = springs.imbalance(state) <= NEARLY * BALANCED
    return Rest(state, "balance" if near else "not-found", steps)


def _advanced(
    springs: Springs, state: SpringState, step: float, work: Work
) -> tuple[SpringState | None, int]:
    """The state a pseudo-time `step` later, None where Newton fails; Newton steps made."""
    new, right = state, state.rest
    least = float(np.linalg.norm(right))
    enough = (STEP_ERROR if least > SMALL else STEP_ERROR_SMALL) * least
    idle = 0
    for count in range(1, INNER + 1):
        try:
            move = springs.newton(new, right, 1.0 / step, work)
        except np.linalg.LinAlgError:
            return None, count
        new, right = _along(springs, (state, new, right), move, step, enough)
        error = float(np.linalg.norm(right))
        if error <= enough:
            return new, count
        idle = 0 if error < FALLING * least else idle + 1
        if idle == IDLE or not error < np.inf:
            return None, count
        least = min(least, error)
    return None, INNER


def _along(
    springs: Springs,
    at: tuple[SpringState, SpringState, Array],
    move: Array,
    step: float,
    enough: float,
) -> tuple[SpringState, Array]:
    """The state along a Newton step at which it does hardly any work more, and its error.

    `at`: the state at the beginning of the step h, the last, and its error. A point that comes
    to touch adds much to the error, though little to the energy; so the line search looks at
    the work of the error along the step, which falls from above 0 to 0 where the energy is
    least. It is shortened where it is far below.
    """
    begin, last, right = at
    low, high = (0.0, float(move @ right)), (1.0, 0.0)
    limit, part = LEFT * low[1], 1.0
    for _ in range(SEARCHED):
        new = springs.at(last.x + part * move)
        error = new.rest - (new.x - begin.x) / step
        gain = float(move @ error)
        there = gain >= -limit and (part == 1.0 or gain <= limit)
        if there or limit <= 0 or float(np.linalg.norm(error)) <= enough:
            break
        if gain > 0:
            low = (part, gain)
        else:
            high = (part, gain)
        between = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        edge = EDGE * (high[0] - low[0])
        part = min(max(between, low[0] + edge), high[0] - edge)
    return new, error
