"""Contraction: bounds of all solutions of the contact law, shrunk by linear programs.

Each bounded quantity (opening, force, slip, rest of the cone, total force of a patch) is
maximised over the relaxation that the present bounds define; the proved bound of the optimum
replaces the old one, the motion is rescaled to what its greatest power leaves, and so on.
Where the greatest power falls below the tolerance, no motion can start. Nothing is branched.
Every bound is that of `kilter.solvers.bounded`, so that each step errs on the safe side.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kilter.mechanics.contact_law import ContactLaw
from kilter.mechanics.enclosure import Enclosure, rescaled
from kilter.mechanics.relaxation import Relaxation
from kilter.solvers.bounded import BoundedSolution, BoundedSolver

__all__ = ["Clock", "Search", "contract", "forces_bounded", "power_bound"]

Array = NDArray[np.float64]

DEBUG = False
SEEN = 0.95
"""A quantity that reached this part of its bound in some solution is not asked about."""
STALLED = 0.03
"""Mean relative progress of the bounds in a round below which contraction stops."""
CURVED = 1e-2
"""Scale below which the kinetic term is too small for its tangents to matter."""
TALK = 1.0
"""Seconds between two words of progress."""


class Clock:
    """What is left of a budget [s], and words of progress about once a second."""

    def __init__(self, budget: float, tell: Callable[[str], None] | None) -> None:
        self.start = self._said = time.perf_counter()
        self.budget = budget
        self._tell = tell

    @property
    def spent(self) -> float:
        """Seconds since the start."""
        return time.perf_counter() - self.start

    @property
    def left(self) -> float:
        """Seconds left, at least a little."""
        return max(self.budget - self.spent, 1e-2)

    @property
    def over(self) -> bool:
        """Whether the budget is spent."""
        return self.spent >= self.budget

    def tell(self, word: str) -> None:
        """Pass on a word if the last one is a second ago."""
        now = time.perf_counter()
        if self._tell is not None and now - self._said >= TALK:
            self._said = now
            self._tell(word)


@dataclass(slots=True, eq=False)
class Search:
    """What the steps of one proof share."""

    law: ContactLaw
    relaxation: Relaxation
    solver: BoundedSolver
    clock: Clock
    tolerance: float

    def closed(self, bounds: Enclosure, power: float) -> bool:
        """Whether a greatest power w.b is nothing: scale * power is w.a."""
        return bounds.scale * power <= self.tolerance


def forces_bounded(search: Search, bounds: Enclosure) -> bool:
    """Whether no solution needs forces as large as the bounds that were assumed.

    The relaxation without the cuts that rest on those bounds is convex and contains 0: if
    its part within them touches none of them, there is no other part.
    """
    search.solver.load(search.relaxation.program(replace(bounds, cuts=False)))
    cost = np.zeros(search.relaxation.width)
    cost[search.relaxation.columns["fn"]] = -1.0
    answer = search.solver.solve(cost, seconds=search.clock.left)
    return -answer.bound < float(bounds.fn.min(initial=np.inf))


def power_bound(
    search: Search, bounds: Enclosure, basis: object = None
) -> tuple[Enclosure, float, BoundedSolution]:
    """Bounds rescaled, the greatest power w.b in units of the old scale, the solution."""
    search.solver.load(search.relaxation.program(bounds), basis)
    answer = search.solver.solve(seconds=search.clock.left)
    power = min(max(-answer.bound, 0.0), bounds.scale)
    if bounds.scale > CURVED and len(answer.x):
        point = answer.x[search.relaxation.columns["motion"]]
        tangents = np.vstack([bounds.tangents[:2], point, bounds.tangents[2:-1]])
        bounds = replace(bounds, tangents=tangents)
    return bounds, power, answer


def contract(search: Search, bounds: Enclosure) -> tuple[Enclosure, float, BoundedSolution]:
    """Shrink bounds until the power is excluded, nothing moves, or the time is over.

    Returns
    -------
    (Enclosure, float, BoundedSolution)
        The bounds, the greatest power w.b in units of their scale, the last solution.
    """
    relaxation, law = search.relaxation, search.law
    while True:
        before = bounds
        for _ in range(30):
            bounds, power, answer = power_bound(search, bounds)
            if search.closed(bounds, power) or search.clock.over:
                return bounds, power, answer
            old = bounds.scale
            bounds = rescaled(law, relaxation.directions, bounds, power)
            if bounds.scale > 0.95 * old:
                break
        search.clock.tell(f"motions up to {bounds.scale:.1e} of free fall are not excluded")
        bounds = _round(search, bounds, answer)
        if DEBUG: print(round(search.clock.spent,1), search.solver.programs, bounds.scale, _progress(before,bounds), (bounds.least>0).sum(), bounds.fn.mean(), bounds.most.mean(), bounds.un.mean(), bounds.ut.mean())
        if search.clock.over or _progress(before, bounds) < STALLED:
            return bounds, min(power, bounds.scale), answer


def _progress(before: Enclosure, after: Enclosure) -> float:
    """Mean relative shrinking of the bounds, of motions in units of the scale, and scale."""
    drops = [1.0 - (after.scale / before.scale) ** 2] * 4
    for old, new in (
        (before.un, after.un),
        (before.fn, after.fn),
        (before.ut, after.ut),
        (before.rest, after.rest),
        (before.most, after.most),
    ):
        if old.size:
            share = 1.0 - new / np.maximum(old, 1e-300)
            drops.append(float(np.maximum(share[old > 0], 0.0).mean()) if (old > 0).any() else 0.0)
    return max(drops) if drops else 0.0


def _quantities(relaxation: Relaxation, b: Enclosure) -> Iterator[tuple[str, tuple[int, ...], Array, Array, float]]:
    """Name, place, columns, coefficients and present bound of what is maximised."""
    at, d = relaxation.columns, relaxation.directions
    groups, wide = len(b.least), d.shape[1]
    ut = np.arange(at["ut"].start, at["ut"].stop).reshape(groups, wide)
    one = np.ones(1)
    for k in range(len(b.un)):
        yield "un", (k,), np.array([at["un"].start + k]), one, float(b.un[k])
        yield "fn", (k,), np.array([at["fn"].start + k]), one, float(b.fn[k])
    for g in range(groups):
        total = np.array([at["total"].start + g])
        yield "most", (g,), total, one, float(b.most[g])
        yield "least", (g,), total, -one, -float(b.least[g])
        for k in range(len(d)):
            yield "ut", (g, k), ut[g], d[k], float(b.ut[g, k])
            if wide == 1:
                rest = np.array([at["rest"].start + g * len(d) + k])
                yield "rest", (g, k), rest, one, float(b.rest[g, k])


def _round(search: Search, bounds: Enclosure, start: BoundedSolution) -> Enclosure:
    """Every quantity once, over the relaxation of the bounds at the start of the round."""
    relaxation = search.relaxation
    new = {name: getattr(bounds, name).copy() for name in ("un", "fn", "ut", "rest", "least", "most")}
    program = relaxation.program(bounds)
    program.lower[relaxation.columns["one"]] = 1.0  # else no force has a least value but 0
    search.solver.load(program, start.basis)
    points = [start.x] if len(start.x) else []
    quantities = list(_quantities(relaxation, bounds))
    best = np.array([
        max((float(c @ x[j]) for x in points), default=-np.inf) for _, _, j, c, _ in quantities
    ])  # fmt: skip
    for number, (name, place, columns, weights, limit) in enumerate(quantities):
        if search.clock.over:
            break
        reach = SEEN * limit if limit > 0 else limit / SEEN
        if limit == 0.0 and name != "least" or best[number] >= reach != 0.0:
            continue
        cost = np.zeros(relaxation.width)
        cost[columns] = -weights
        answer = search.solver.solve(cost, seconds=search.clock.left)
        value = -answer.bound
        if len(answer.x):
            found = np.array([float(c @ answer.x[j]) for _, _, j, c, _ in quantities[number:]])
            best[number:] = np.maximum(best[number:], found)
        if name == "least":
            new[name][place] = max(-value, new[name][place])
        else:
            new[name][place] = min(max(value, 0.0), new[name][place])
        search.clock.tell(f"bounding forces and motions, {number} of {len(quantities)}")
    return _consistent(search.law, relaxation, replace(bounds, **new))


def _consistent(law: ContactLaw, relaxation: Relaxation, b: Enclosure) -> Enclosure:
    """Bounds that follow from others: |ut| from its directions, N from forces, g from N."""
    wide = law.directions
    members = np.flatnonzero(law.group >= 0)
    total = np.bincount(law.group[members], b.fn[members], minlength=len(law.mu))
    most = np.minimum(b.most, total)
    fn = b.fn.copy()
    fn[members] = np.minimum(fn[members], most[law.group[members]])
    if wide == 1:
        slip = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0))
        rest = np.minimum(b.rest, 2 * (law.mu * most)[:, None])
        return replace(b, most=most, fn=fn, slip=slip, rest=rest)
    # |ut| is at most that of the corner of the polygon whose sides are the bounds
    sides = len(relaxation.directions)
    corner = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0) / np.cos(np.pi / sides))
    rest = np.repeat(2 * (law.mu * most)[:, None], sides, axis=1)
    ut = np.repeat(corner[:, None], sides, axis=1)
    return replace(b, most=most, fn=fn, slip=corner, ut=ut, rest=np.minimum(b.rest, rest))
