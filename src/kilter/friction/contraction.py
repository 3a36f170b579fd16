"""Contraction: bounds of all solutions of the contact law, shrunk by linear programs.

Each bounded quantity (opening, force, slip, rest of the cone, total force of a patch) is
maximised over the relaxation that the present bounds define; the proved bound of the optimum
replaces the old one, the motion is rescaled to what its greatest power leaves, and so on.
Where the greatest power falls below the tolerance, no motion can start. Nothing is branched.
Every bound is that of `kilter.solvers.bounded`, so that each step errs on the safe side.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, kron, vstack

from kilter.arrays import Array
from kilter.friction.contact_law import ContactLaw
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.relaxation import Relaxation
from kilter.solvers.bounded import BoundedSolution, BoundedSolver

__all__ = ["FORCES", "Clock", "Search", "contract", "forces_bounded", "power_bound", "shrunk"]


ALL = ("un", "fn", "most", "least", "ut", "rest")
"""Bounds that are shrunk."""
FORCES = ("fn", "least")
"""Those of forces; in space that of N is that of fn."""
SEEN = 0.95
"""A quantity that reached this part of its bound in some solution is not asked about."""
STALLED = 0.1
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


def contract(search: Search, bounds: Enclosure, until: float = np.inf) -> tuple[Enclosure, float]:
    """Shrink bounds until the power is excluded, they hardly move, or the time is over.

    Returns
    -------
    (Enclosure, float)
        The bounds, and the greatest power w.a that they leave.
    """
    relaxation = search.relaxation
    while True:
        before = bounds
        for _ in range(30):
            bounds, power, answer = power_bound(search, bounds)
            if search.closed(bounds, power) or search.clock.over:
                return bounds, bounds.scale * power
            old = bounds.scale
            bounds = rescaled(relaxation.reach, bounds, power)
            if bounds.scale > 0.95 * old:
                break
        search.clock.tell(f"motions up to {bounds.scale:.1e} of free fall are not excluded")
        bounds = shrunk(search, bounds, answer, until=until)
        late = search.clock.over or search.clock.spent > until
        if late or _progress(before, bounds) < STALLED:
            return bounds, bounds.scale**2


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


@dataclass(frozen=True, slots=True, eq=False)
class _Quantities:
    """What is maximised: name of the bound, place in it, its row of `weights`, present bound."""

    names: list[str]
    places: list[tuple[int, ...]]
    weights: csr_array
    limits: Array


def _quantities(relaxation: Relaxation, b: Enclosure) -> _Quantities:
    """Openings, forces, total forces (also least), slips and, in the plane, rests of cones."""
    at, d = relaxation.columns, relaxation.directions
    groups, wide = len(b.least), d.shape[1]
    kinds = ["un", "fn", "most", "least", "ut", *(["rest"] if wide == 1 else [])]
    eye = eye_array(relaxation.width, format="csr")
    rows = {
        "un": eye[at["un"]],
        "fn": eye[at["fn"]],
        "most": eye[at["total"]],
        "least": -eye[at["total"]],
        "ut": kron(eye_array(groups), d, format="csr") @ eye[at["ut"]],
        "rest": eye[at["rest"]],
    }
    limits = {kind: getattr(b, kind) * (-1.0 if kind == "least" else 1.0) for kind in kinds}
    return _Quantities(
        [kind for kind in kinds for _ in range(limits[kind].size)],
        [place for kind in kinds for place in np.ndindex(limits[kind].shape)],
        csr_array(vstack([rows[kind] for kind in kinds], format="csr")),
        np.concatenate([limits[kind].ravel() for kind in kinds]),
    )


def shrunk(
    search: Search,
    bounds: Enclosure,
    start: BoundedSolution,
    kinds: Sequence[str] = ALL,
    until: float = np.inf,
) -> Enclosure:
    """Every quantity of some kinds once, over the relaxation of the bounds at the start.

    What is not asked until `until` [s of the clock] keeps its bound.
    """
    relaxation = search.relaxation
    new = {name: getattr(bounds, name).copy() for name in ALL}
    program = relaxation.program(bounds)
    program.lower[relaxation.columns["one"]] = 1.0  # else no force has a least value but 0
    search.solver.load(program, start.basis)
    asked = _quantities(relaxation, bounds)
    best = asked.weights @ start.x if len(start.x) else np.full(len(asked.limits), -np.inf)
    enough = np.where(asked.limits > 0, SEEN * asked.limits, asked.limits / SEEN)
    fixed = np.array([name != "least" for name in asked.names]) & (asked.limits <= 0)
    for number, (name, place) in enumerate(zip(asked.names, asked.places, strict=True)):
        if search.clock.over or search.clock.spent > until:
            break
        if name not in kinds:
            continue
        if fixed[number] or (best[number] >= enough[number] and enough[number] != 0):
            continue
        cost = -asked.weights[[number]].toarray()[0]
        answer = search.solver.solve(cost, seconds=search.clock.left)
        if len(answer.x):
            best = np.maximum(best, asked.weights @ answer.x)
        if name == "least":
            new[name][place] = max(answer.bound, new[name][place])
        else:
            new[name][place] = min(max(-answer.bound, 0.0), new[name][place])
        search.clock.tell(f"bounding forces and motions, {number} of {len(asked.limits)}")
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
