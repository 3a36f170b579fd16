"""Repeat the steps of a proof that no motion can start, without a solver.

The law is rebuilt from the program. Each step has multipliers, whose bound is recomputed from the
law; nothing else of the proof is trusted. A step that does not fit proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

from kilter.arrays import Array
from kilter.friction.canonical import canonical
from kilter.friction.enclosure import Enclosure, cases, rescaled, width
from kilter.friction.exclusion_bounds import (
    first_bounds,
    largest_forces,
    no_power,
    power_by,
    shrunk_by,
)
from kilter.friction.exclusion_steps import CaseStep, ExclusionStep, PowerStep, ShrinkStep
from kilter.friction.friction_tolerances import NARROWEST_CONE
from kilter.friction.moment_bound import MomentStep, power_left
from kilter.friction.reduced_law import ReducedLaw, reduced_law, refusal
from kilter.friction.relaxation import Relaxation
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import MalformedProof
from kilter.threads import on_one_thread

__all__ = ["power_not_excluded"]


@on_one_thread
def power_not_excluded(
    program: Program, opening: Array | None, steps: Sequence[ExclusionStep]
) -> tuple[float, float]:
    """Power of the load that a proof does not exclude, and the power that counts as zero [-].

    Raises `MalformedProof` if a step refers to points, rows or quantities that the law does not
    have.
    """
    if not program.free.any() or not program.load[program.free].any():
        return 0.0, 0.0
    program = canonical(program)
    if refusal(program):
        return 1.0, 0.0
    law = reduced_law(program)
    again = _ProofState(law, opening, no_power(program))
    for step in steps:
        again.step(step)
    return again.power, again.tolerance


class _ProofState:
    """State of the repetition of a proof: current bounds of the motions, and the largest power."""

    def __init__(self, law: ReducedLaw, opening: Array | None, tolerance: float) -> None:
        self.law, self.tolerance = law, tolerance
        self.forces = largest_forces(law, opening)
        self.relaxation = Relaxation(law)
        self.bounds = first_bounds(law, self.relaxation, opening)
        self.power = 1.0
        self.patches = range(len(law.twist))

    def step(self, step: ExclusionStep) -> None:
        """Apply one more step of the proof to the bounds and the power."""
        if isinstance(step, MomentStep):
            if step.scale < self.bounds.scale * (1 - 1e-12):
                raise MalformedProof("a step at a size to which motions are not bounded")
            self._leaves(power_left(self.law, step, self.forces))
        elif isinstance(step, PowerStep):
            self.bounds, power = power_by(self.relaxation, self.bounds, step)
            self._leaves(self.bounds.scale * power)
        elif isinstance(step, ShrinkStep):
            self.bounds = shrunk_by(self.law, self.relaxation, self.bounds, step)
        elif self._is_closed(self.bounds, step):
            self.power = min(self.power, self.tolerance)

    def _leaves(self, power: float) -> None:
        self.power = min(self.power, power)
        self.bounds = rescaled(self.relaxation.fastest, self.bounds, power / self.bounds.scale)

    def _is_closed(self, bounds: Enclosure, root: CaseStep) -> bool:
        """True if a proof excludes power in a case, or in all of its subcases."""
        ready = [(bounds, root)]
        while ready:
            closed, case = ready.pop()
            left = self._left(closed, case)
            if left is None:
                continue
            if not self._divisible(left, case):
                return False
            below = cases(self.law, left, case.point, case.patch)
            if len(below) != len(case.cases):
                raise MalformedProof(
                    f"a case is divided into {len(case.cases)} cases, not {len(below)}"
                )
            ready += zip(below, case.cases, strict=True)
        return True

    def _divisible(self, bounds: Enclosure, case: CaseStep) -> bool:
        """True if a case can be divided: its point or patch exists, and its cone is wide enough."""
        if case.point >= 0:
            return case.point < len(self.law.group)
        if case.patch not in self.patches:
            return False
        cone = bounds.cones[case.patch]
        return cone is None or width(cone) >= NARROWEST_CONE

    def _left(self, bounds: Enclosure, case: CaseStep) -> Enclosure | None:
        """Bounds of a case after its linear programs; None if these exclude all power."""
        for step in case.powers:
            bounds, power = power_by(self.relaxation, bounds, step)
            if bounds.scale * power <= self.tolerance:
                return None
            bounds = rescaled(self.relaxation.fastest, bounds, power)
        return bounds
