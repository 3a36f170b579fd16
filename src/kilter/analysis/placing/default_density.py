"""Whether a verdict depends on the density of parts that state neither a density nor a mass.

Let w be the load of the parts with a known mass, and d the weights of the other parts at the
default density. The true load is w + t d for an unknown t > 0. Without bonds and straps, the loads
that given contacts hold are a closed convex cone. So forces hold w + t d for every t > 0 exactly if
they hold w and d. A motion proves that the assembly falls for every t if neither w nor d loses
energy in it.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.mechanics.certificate import MotionProof
from kilter.mechanics.program import Program

__all__ = ["density_matters"]


def density_matters(verdict: Verdict) -> bool:
    """True unless it is proved that the verdict is the same for every value of the default density.

    A verdict that rests on friction, and an undecided verdict, count as dependent.
    """
    program = verdict.program
    weights = _default_weights(verdict, program)
    if not weights.any():
        return False
    if verdict.friction_answer is not None or program.has_strength:
        return True
    if isinstance(verdict.evidence, MotionProof):
        motion = verdict.evidence.motion
        shares = [float((load * motion).sum()) for load in (weights, program.load - weights)]
        return min(shares) < 0.0
    if verdict.level is None:
        return True
    known = program.with_rows(applied=program.applied - weights)
    default = program.with_rows(applied=weights - _free_weights(program))
    return not (judge(known).stable and judge(default).stable)


def _free_weights(program: Program) -> Array:
    """Weights of the free parts [N], shape (N, 6)."""
    weights = np.zeros((len(program.names), 6))
    weights[:, :3] = (program.mass * program.free)[:, None] * program.gravity
    return weights


def _default_weights(verdict: Verdict, program: Program) -> Array:
    """Weights of the free parts at the default density [N]; zero for the other parts, (N, 6)."""
    default = [part.density is None and part.given_mass is None for part in verdict.assembly.parts]
    weights: Array = _free_weights(program) * np.array(default)[:, None]
    return weights
