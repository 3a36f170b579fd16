"""Cases of contact modes whose power is bounded by linear programs, until none is left.

A relaxed motion breaks the law where a point has f_n u_n > 0, and where the groups of a patch
have a sum of f_t.u_t + mu N |u_t| > 0 (`kilter.friction.reduced_law`). Both are powers, never
negative; their sum is what the motion gains beyond what the law allows. A case is divided
where that is largest:

    a point          touches (u_n = 0: sticking or sliding)  |  is open (f_n = 0)
    a patch          sticks (t = 0)  |  its twist t lies in one of the 2^d orthants
    a patch in a cone                   the cone halved

Modes of sliding belong to patches, not to points: all groups of a patch share its twist, so
that one cone tells the direction of sliding of each.

The optimum of a case bounds the power of all motions in it, and that bound is proved apart
from the solver. If all cases are closed, no motion can start. The case of the greatest power
is divided first, so that the greatest open power falls, and a relaxed motion that obeys the
law, which ends the search, is met early. A sector of half width h lets friction turn by h:
near a limit of sliding, cases of relative width about 1 - cos h stay open however many are
tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.friction.branching import CaseTree
from kilter.friction.contraction import ProofAttempt, power_bound
from kilter.friction.enclosure import Enclosure, cases, rescaled, width
from kilter.friction.exclusion_steps import CaseStep
from kilter.friction.friction_tolerances import NARROWEST_CONE, OBEYED
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.work import Work

__all__ = ["Breach", "CasesLeft", "breach", "divided"]

AGAIN = 0.5
"""A power below this fraction of the scale is bounded again, at its own scale, where numbers
are again near 1."""
MOST_OPEN = 200_000
"""Open cases above which the division ends, so that memory does."""


@dataclass(frozen=True, slots=True)
class Breach:
    """Where a relaxed motion breaks the law most; powers in units of the enclosure [-].

    Attributes
    ----------
    point, patch : int
        One of the two; the other is -1. Both are -1 where no place is known.
    largest : float
        The power that it gains there, among places that can still be divided.
    total : float
        What it gains in all.
    """

    point: int
    patch: int
    largest: float
    total: float


@dataclass(frozen=True, slots=True, eq=False)
class CasesLeft:
    """How the division into cases ended.

    Attributes
    ----------
    power : float
        Greatest power w.a that is not excluded, over |w|^2; the tolerance where all is closed.
    nodes : int
        Cases that were bounded.
    ended : bool
        Whether more time would change nothing: all is closed, or a relaxed motion obeys the
        law, or nothing is left to divide.
    step : CaseStep or None
        The whole tree, where all is closed.
    """

    power: float
    nodes: int
    ended: bool
    step: CaseStep | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _OpenCase:
    """A case that is open; `bounds` in units of the size that its power leaves."""

    bounds: Enclosure
    power: float
    where: Breach
    obeys: bool
    basis: object
    step: CaseStep


def breach(law: ReducedLaw, relaxation: Relaxation, bounds: Enclosure, x: Array) -> Breach:
    """Where a solution x of the relaxation breaks the law most."""
    columns = relaxation.named(x)
    normal = np.maximum(columns["fn"], 0.0) * np.maximum(columns["un"], 0.0)
    ft, ut = (columns[name].reshape(-1, law.directions) for name in ("ft", "ut"))
    speed = np.linalg.norm(ut, axis=1)
    loss = np.maximum((ft * ut).sum(axis=1) + law.mu * columns["total"] * speed, 0.0)
    slide = np.bincount(law.patch, loss, minlength=len(law.twist))
    total = float(normal.sum() + slide.sum())
    for patch, cone in enumerate(bounds.cones):
        narrow = cone is not None and (not cone.size or width(cone) < NARROWEST_CONE)
        slide[patch] = 0.0 if narrow else slide[patch]
    point = int(normal.argmax()) if len(normal) else -1
    patch = int(slide.argmax()) if len(slide) else -1
    most = float(normal[point]) if point >= 0 else 0.0
    slid = float(slide[patch]) if patch >= 0 else 0.0
    if most >= slid:
        return Breach(point, -1, most, total)
    return Breach(-1, patch, slid, total)


def divided(attempt: ProofAttempt, bounds: Enclosure, until: Work | None = None) -> CasesLeft:
    """Divide the solutions within the bounds until every case is closed.

    Ends early when `until` (else the work of the attempt) is spent, at a relaxed motion
    that obeys the law, and where nothing is left to divide.
    """
    work = attempt.work if until is None else until
    root = CaseStep()
    tree = CaseTree(
        _bounding(attempt, root),
        lambda case: cases(attempt.law, case.bounds, case.where.point, case.where.patch),
        lambda case: case.power,
    )

    def late() -> bool:
        return work.over or len(tree) > MOST_OPEN

    def enough(case: _OpenCase) -> bool:
        return case.obeys or late() or case.where.largest <= 0.0

    for case in tree.explore(bounds, enough=enough):
        work.tell(f"{tree.nodes} cases, {len(tree)} open, power up to {case.power:.1e}")
    best = tree.best
    if best is None:
        return CasesLeft(attempt.tolerance, tree.nodes, True, root)
    ended = best.obeys or best.where.largest <= 0.0
    return CasesLeft(best.power, tree.nodes, ended and not late())


def _bounding(
    attempt: ProofAttempt, root: CaseStep
) -> Callable[[Enclosure, _OpenCase | None], _OpenCase | None]:
    """The bound of a case: its greatest power; None if that is nothing. Steps below `root`."""
    relaxation = attempt.relaxation

    def bound(bounds: Enclosure, parent: _OpenCase | None) -> _OpenCase | None:
        basis, made = None, root
        if parent is not None:
            basis, made = parent.basis, CaseStep()
            parent.step.cases.append(made)
        while True:
            bounds, power, answer, step = power_bound(attempt, bounds, basis)
            made.powers.append(step)
            if attempt.closed(bounds, power):
                return None
            old, bounds, basis = bounds, rescaled(relaxation.fastest, bounds, power), answer.basis
            if power >= AGAIN * old.scale or attempt.work.over:
                break
        worth = old.scale * power
        worth = worth if parent is None else min(worth, parent.power)
        if not len(answer.x):
            return _OpenCase(bounds, worth, Breach(-1, -1, 0.0, np.inf), False, basis, made)
        where = breach(attempt.law, relaxation, old, answer.x)
        made.point, made.patch = where.point, where.patch
        return _OpenCase(bounds, worth, where, where.total <= OBEYED * power, basis, made)

    return bound
