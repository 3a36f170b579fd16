"""Contraction: bounds of all solutions of the contact law, shrunk by linear programs.

Each bounded quantity (opening, force, speed of sliding, distance to the cone, total force of a
group) is maximised over the relaxation that the present bounds define; the proved bound of
the optimum replaces the old one, the motion is rescaled to what its greatest power leaves,
and so on. Where the greatest power falls below the tolerance, no motion can start. Nothing
is divided into cases. Every bound is that of `kilter.solvers.solution`, which needs no faith in
the solver, so that each step errs on the safe side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import TINY
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.exclusion_bounds import ALL, quantities, shrunk_by, with_one, with_tangent
from kilter.friction.exclusion_steps import ExclusionStep, PowerStep, Quantity, ShrinkStep
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.solvers.highs import KeptProgram
from kilter.solvers.solution import Solution
from kilter.work import Work

__all__ = [
    "ProofAttempt",
    "contract",
    "power_bound",
    "shrunk",
]

SEEN = 0.95
"""A quantity that reached this fraction of its bound in some solution is not asked about."""
STALLED = 0.1
"""Mean relative progress of the bounds in a round below which contraction stops."""
CURVED = 1e-2
"""Scale |a| below which the kinetic term |a|^2 is too small for its tangents to matter."""
RESCALINGS = 30
"""How often the motion is rescaled before the other bounds are shrunk again."""
RESCALED = 0.95
"""A rescaling to more than this fraction of the old scale is the last."""


@dataclass(slots=True, eq=False)
class ProofAttempt:
    """What the steps of one proof share; `tolerance`: power w.a over |w|^2 that counts as none.

    `steps` are those made so far, for the proof to be repeated without the solver.
    """

    law: ReducedLaw
    relaxation: Relaxation
    solver: KeptProgram
    work: Work
    tolerance: float
    steps: list[ExclusionStep] = field(default_factory=list)

    def closed(self, bounds: Enclosure, power: float) -> bool:
        """Whether a greatest power w.b is nothing: scale * power is w.a."""
        return bounds.scale * power <= self.tolerance


def power_bound(
    attempt: ProofAttempt, bounds: Enclosure, basis: object = None
) -> tuple[Enclosure, float, Solution, PowerStep]:
    """Bounds with the tangent at the solution, the greatest power w.b, the solution, the step."""
    attempt.solver.load(attempt.relaxation.program(bounds), basis)
    attempt.work.loaded(attempt.solver.program.matrix.nnz)
    answer = attempt.solver.solve(work=attempt.work)
    curved = bounds.scale > CURVED and len(answer.x)
    point = answer.x[attempt.relaxation.columns["motion"]] if curved else None
    step = PowerStep.of(answer.multipliers, point)
    bounds, power = with_tangent(bounds, point), -answer.bound
    return bounds, min(max(power, 0.0), bounds.scale), answer, step


def contract(
    attempt: ProofAttempt, bounds: Enclosure, until: Work | None = None
) -> tuple[Enclosure, float]:
    """Shrink bounds until the power is excluded, they hardly move, or `until` is spent.

    Returns
    -------
    (Enclosure, float)
        The bounds, and the greatest power w.a that they leave.
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
        bounds = shrunk(attempt, bounds, answer, until=until)
        if until.over or _progress(before, bounds) < STALLED:
            return bounds, bounds.scale**2


def _progress(before: Enclosure, after: Enclosure) -> float:
    """Mean relative shrinking of the bounds, of motions in units of the scale, and scale."""
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
    """Every quantity of some kinds bounded once, over the relaxation of the given bounds.

    Parameters
    ----------
    attempt : ProofAttempt
    bounds : Enclosure
    start : Solution
        Of the greatest power within these bounds.
    kinds : sequence of str
        Which of `ALL`.
    until : Work, optional
        What is not asked when it is spent keeps its bound.
    """
    relaxation = attempt.relaxation
    until = until or attempt.work
    attempt.solver.load(with_one(relaxation, bounds), start.basis)
    attempt.work.loaded(attempt.solver.program.matrix.nnz)
    asked = quantities(relaxation, bounds)
    best = asked.weights @ start.x if len(start.x) else np.full(len(asked.limits), -np.inf)
    enough = np.where(asked.limits > 0, SEEN * asked.limits, asked.limits / SEEN)
    fixed = np.array([name != "least" for name in asked.names]) & (asked.limits <= 0)
    found: list[Quantity] = []
    for number, name in enumerate(asked.names):
        if until.over:
            break
        if name not in kinds:
            continue
        if fixed[number] or (best[number] >= enough[number] and enough[number] != 0):
            continue
        answer = attempt.solver.solve(-asked.weights[[number]].toarray()[0], work=attempt.work)
        if len(answer.x):
            best = np.maximum(best, asked.weights @ answer.x)
        found.append(Quantity(number, PowerStep.of(answer.multipliers, None)))
        attempt.work.tell(f"bounding forces and motions, {number} of {len(asked.limits)}")
    step = ShrinkStep(tuple(found))
    attempt.steps.append(step)
    return shrunk_by(attempt.law, relaxation, bounds, step)
