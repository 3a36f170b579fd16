"""Division of motions into contact modes until a linear program excludes power in each case.

A relaxed motion violates the law if a point has f_n u_n > 0, or if the groups of a patch have a sum
of f_t.u_t + mu N |u_t| > 0 (`kilter.friction.reduced_law`). Both are powers and never negative;
their sum is the gain of the motion beyond the law. A case is divided at the point or patch with the
largest gain:

    a point          touches (u_n = 0: sticking or sliding)  |  is open (f_n = 0)
    a patch          sticks (t = 0)  |  its twist t lies in one of the 2^d orthants
    a patch in a cone                   the cone halved

Modes of sliding belong to patches, not to points: all groups of a patch share its twist, so a
single cone determines the sliding direction of each.

The optimum of a case bounds the power of all motions in it, and that bound is proved independently
of the solver. The case of the greatest power is divided first, so the greatest open power falls,
and a relaxed motion that obeys the law, which ends the search, is met early. A sector of half width
h lets friction turn by h: near a limit of sliding, cases of relative width about 1 - cos h stay
open however many are examined.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.friction.branching import CaseTree
from kilter.friction.contraction import ProofAttempt, power_bound
from kilter.friction.enclosure import Enclosure, cases, rescaled, width
from kilter.friction.exclusion_bounds import CaseStep
from kilter.friction.friction_tolerances import NARROWEST_CONE, OBEYED
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.work import Work

AGAIN = 0.5
"""A power below this fraction of the scale is bounded again at its own scale, at which the numbers
are near 1 again.
"""
MOST_OPEN = 200_000
"""Largest number of unfinished cases; then the division ends, to limit memory."""


@dataclass(frozen=True, slots=True)
class Breach:
    """The contact point or patch at which a relaxed motion violates the contact law most."""

    point: int
    patch: int
    """Index of the point or of the patch; the other is -1. Both are -1 if unknown."""
    largest: float
    """Power that it gains there, among points and patches that can still be divided."""
    total: float
    """Power that it gains in all."""


@dataclass(frozen=True, slots=True, eq=False)
class CasesLeft:
    """Result of a division into cases of contact modes: the power that is left, and the tree."""

    power: float
    """Greatest power w.a that is not excluded, over |w|^2; the tolerance if all cases are
    closed."""
    nodes: int
    """Number of bounded cases."""
    ended: bool
    """True if more time would not help: all cases are closed, a relaxed motion obeys the law, or
    nothing can be divided."""
    step: CaseStep | None = None
    """The whole tree, if all cases are closed."""


@dataclass(frozen=True, slots=True, eq=False)
class _OpenCase:
    """A case of contact modes that is not excluded yet, with bounds at its own scale."""

    bounds: Enclosure
    power: float
    where: Breach
    obeys: bool
    basis: object
    step: CaseStep


def breach(law: ReducedLaw, relaxation: Relaxation, bounds: Enclosure, x: Array) -> Breach:
    """Point or patch at which a solution x of the relaxation violates Coulomb's law most."""
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
    normal_gain = float(normal[point]) if point >= 0 else 0.0
    sliding_gain = float(slide[patch]) if patch >= 0 else 0.0
    if normal_gain >= sliding_gain:
        return Breach(point, -1, normal_gain, total)
    return Breach(-1, patch, sliding_gain, total)


def divide_cases(attempt: ProofAttempt, bounds: Enclosure, until: Work | None = None) -> CasesLeft:
    """Divide the motions within bounds into cases until each is excluded or the work is spent.

    Ends early if `until` (else the work of the attempt) is spent, at a relaxed motion that obeys
    the law, or if nothing is left to divide.
    """
    work = attempt.work if until is None else until
    root = CaseStep()
    tree = CaseTree(
        _case_bound(attempt, root),
        lambda case: cases(attempt.law, case.bounds, case.where.point, case.where.patch),
        lambda case: case.power,
    )

    def out_of_budget() -> bool:
        return work.over or len(tree) > MOST_OPEN

    def enough(case: _OpenCase) -> bool:
        return case.obeys or out_of_budget() or case.where.largest <= 0.0

    for case in tree.explore(bounds, enough=enough):
        work.tell(f"{tree.nodes} cases, {len(tree)} open, power up to {case.power:.1e}")
    best = tree.best
    if best is None:
        return CasesLeft(attempt.tolerance, tree.nodes, True, root)
    ended = best.obeys or best.where.largest <= 0.0
    return CasesLeft(best.power, tree.nodes, ended and not out_of_budget())


def _case_bound(
    attempt: ProofAttempt, root: CaseStep
) -> Callable[[Enclosure, _OpenCase | None], _OpenCase | None]:
    """Create the function that bounds the power of a case; it returns None for zero power.

    The function appends the steps of each case below `root`.
    """
    relaxation = attempt.relaxation

    def bound(bounds: Enclosure, parent: _OpenCase | None) -> _OpenCase | None:
        """Bound the power of a case, at smaller scales if useful; None if the power is zero."""
        basis, case_step = None, root
        if parent is not None:
            basis, case_step = parent.basis, CaseStep()
            parent.step.cases.append(case_step)
        while True:
            bounds, power, answer, step = power_bound(attempt, bounds, basis)
            case_step.powers.append(step)
            if attempt.closed(bounds, power):
                return None
            old, bounds, basis = bounds, rescaled(relaxation.fastest, bounds, power), answer.basis
            if power >= AGAIN * old.scale or attempt.work.over:
                break
        case_power = old.scale * power
        case_power = case_power if parent is None else min(case_power, parent.power)
        if not len(answer.x):
            return _OpenCase(
                bounds, case_power, Breach(-1, -1, 0.0, np.inf), False, basis, case_step
            )
        where = breach(attempt.law, relaxation, old, answer.x)
        case_step.point, case_step.patch = where.point, where.patch
        return _OpenCase(bounds, case_power, where, where.total <= OBEYED * power, basis, case_step)

    return bound
