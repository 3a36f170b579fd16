"""Shrink the bounds of all motions that obey the contact law, by linear programs.

Each bounded quantity (opening, force, sliding speed, distance to the cone, total force of a group)
is maximised over the relaxation that the present bounds define. The proved bound of the optimum
replaces the old bound, the motion is rescaled to the size that its greatest power leaves, and so
on. If the greatest power falls below the tolerance, no motion can start. No cases are
distinguished. Every bound is that of `kilter.solvers.problem`, which does not trust the solver, so
each step is safe.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from kilter.arrays import TINY
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.exclusion_bounds import (
    ALL,
    ExclusionStep,
    PowerStep,
    Quantity,
    ShrinkStep,
    quantities,
    shrunk_by,
    with_one,
    with_tangent,
)
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import Solution
from kilter.work import Work

SEEN = 0.95
"""A quantity that some solution brings to this fraction of its bound is not maximised again. A
larger value solves more programs."""
STALLED = 0.1
"""Mean relative decrease of the bounds in a round, below which contraction stops [-]."""
CURVED = 1e-2
"""Scale |a| below which the kinetic term |a|^2 is too small for its tangents to matter."""
RESCALINGS = 30
"""Maximum number of rescalings of the motion before the other bounds are shrunk again."""
RESCALED = 0.95
"""Rescaling ends if the new scale is more than this fraction of the old."""


@dataclass(slots=True, eq=False)
class ProofAttempt:
    """Data that all steps share in a proof that no motion can start.

    `tolerance` is the power w.a over |w|^2 that counts as zero. `steps` are the steps so far, by
    which the proof can be repeated without the solver.
    """

    law: ReducedLaw
    relaxation: Relaxation
    solver: KeptProgram
    work: Work
    tolerance: float
    steps: list[ExclusionStep] = field(default_factory=list)

    def closed(self, bounds: Enclosure, power: float) -> bool:
        """True if a bound of the power of all motions within `bounds` is below the tolerance."""
        return bounds.scale * power <= self.tolerance


def power_bound(
    attempt: ProofAttempt, bounds: Enclosure, basis: object = None
) -> tuple[Enclosure, float, Solution, PowerStep]:
    """Upper bound of the load's power over all motions within the given bounds.

    Returns the bounds with a tangent at the solution, the power, the solution, and the step. In the
    plane the solver maximises the power over the scale, which is its largest value: the solver's
    tolerances are absolute, and at the scale of the last cases they exceed the power that counts as
    zero if a heavy part makes the lightest part's weight a small fraction. In space the same loses
    a proof by sectors in 250 random assemblies, and gains none.
    """
    program = attempt.relaxation.program(bounds)
    size = bounds.scale if attempt.law.directions == 1 else 1.0
    attempt.solver.load(replace(program, cost=program.cost / size), basis)
    attempt.work.loaded(program.matrix.nnz)
    answer = attempt.solver.solve(work=attempt.work)
    tangent_matters = bounds.scale > CURVED and len(answer.x)
    point = answer.x[attempt.relaxation.columns["motion"]] if tangent_matters else None
    step = PowerStep.of(answer.multipliers * size, point)
    power = -program.safe_bound(step.over(len(program.row_lower)))
    bounds = with_tangent(bounds, point)
    return bounds, min(max(power, 0.0), bounds.scale), answer, step


def contract(
    attempt: ProofAttempt,
    bounds: Enclosure,
    kinds: Sequence[str] = ALL,
    until: Work | None = None,
) -> tuple[Enclosure, float]:
    """Shrink bounds until no motion gains power, progress stalls, or the work `until` is spent.

    `kinds` are the kinds of bounds that are shrunk, a subset of `ALL`.

    Returns the bounds, and the greatest power w.a that they leave.
    """
    relaxation = attempt.relaxation
    until = until or attempt.work
    while True:
        before = bounds
        for _ in range(RESCALINGS):
            bounds, power, answer, step = power_bound(attempt, bounds)
            attempt.steps.append(step)
            if attempt.closed(bounds, power) or attempt.work.over:
                return bounds, bounds.scale * power
            old = bounds.scale
            bounds = rescaled(relaxation.fastest, bounds, power)
            if bounds.scale > RESCALED * old:
                break
        attempt.work.tell(f"motions up to {bounds.scale:.1e} of free fall are not excluded")
        bounds = shrunk(attempt, bounds, answer, kinds, until)
        if until.over or _progress(before, bounds) < STALLED:
            return bounds, bounds.scale**2


def _progress(before: Enclosure, after: Enclosure) -> float:
    """Progress of a round: the largest mean relative decrease among the arrays of bounds.

    Speeds count in units of the scale.
    """
    drops = [1.0 - (after.scale / before.scale) ** 2]
    for old, new in (
        (before.un, after.un),
        (before.fn, after.fn),
        (before.ut, after.ut),
        (before.rest, after.rest),
        (before.most, after.most),
    ):
        if old.size:
            drop = 1.0 - new / np.maximum(old, TINY)
            drops.append(float(np.maximum(drop[old > 0], 0.0).mean()) if (old > 0).any() else 0.0)
    return max(drops)


def shrunk(
    attempt: ProofAttempt,
    bounds: Enclosure,
    start: Solution,
    kinds: Sequence[str] = ALL,
    until: Work | None = None,
) -> Enclosure:
    """Shrink the bounds of the given kinds of quantities, with a linear program for each."""
    relaxation = attempt.relaxation
    until = until or attempt.work
    attempt.solver.load(with_one(relaxation, bounds), start.basis)
    attempt.work.loaded(attempt.solver.program.matrix.nnz)
    targets = quantities(relaxation, bounds)
    reached = targets.weights @ start.x if len(start.x) else np.full(len(targets.limits), -np.inf)
    good_enough = np.where(targets.limits > 0, SEEN * targets.limits, targets.limits / SEEN)
    # a quantity whose bound is already 0 cannot shrink
    fixed = np.array([name != "least" for name in targets.names]) & (targets.limits <= 0)
    bounded: list[Quantity] = []
    for number, name in enumerate(targets.names):
        if until.over:
            break
        if name not in kinds:
            continue
        if fixed[number] or (reached[number] >= good_enough[number] and good_enough[number] != 0):
            continue
        cost = -targets.weights[[number]].toarray()[0]
        answer = attempt.solver.solve(cost, warm="primal", work=attempt.work)
        if len(answer.x):
            reached = np.maximum(reached, targets.weights @ answer.x)
        bounded.append(Quantity(number, PowerStep.of(answer.multipliers, None)))
        attempt.work.tell(f"bounding forces and motions, {number} of {len(targets.limits)}")
    step = ShrinkStep(tuple(bounded))
    attempt.steps.append(step)
    return shrunk_by(attempt.law, relaxation, bounds, step)
