"""The least friction coefficient, the same at every contact, with which forces hold it.

Equilibrium with mu implies equilibrium with more, so the least one is enclosed from both sides:
forces in the cones of `upper`, a motion in the dual cones of `lower`; forces found also say
how much friction they use. Where the least is approached but not attained (a block squeezed
between two walls), it tends to zero as forces grow without bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.judge import judge
from kilter.analysis.margins.load_limit import NoLimit, starting
from kilter.analysis.turning_tolerances import (
    MU_AGREES,
    MU_CLOSE,
    MU_NOTHING,
)
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.coulomb_cones import spread
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

__all__ = ["LeastFriction", "find_least_friction"]


TRIED = (1.0, 30.0, 1e3)
"""Coefficients tried for a first one that holds."""
LARGEST = TRIED[-1]
"""Coefficients above this count as none that holds."""
STEPS = 80
UNDECIDED = 3
"""Coefficients that may be left undecided, at many times the cost of others."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastFriction:
    """The least mu that holds, enclosed.

    Attributes
    ----------
    value : float
        The least coefficient that is proved to hold [-]; 0 where none is needed.
    lower : float
        A coefficient that is proved not to hold [-].
    attained : bool
        False where every mu above zero holds, but zero does not.
    forces : ForceProof
        Forces at `value`.
    mechanism : MotionProof or None
        The motion at `lower`; None where no friction is needed.
    programs : int
    """

    value: float
    lower: float
    attained: bool
    forces: ForceProof
    mechanism: MotionProof | None
    programs: int

    def to_dict(self, program: Program) -> dict[str, Any]:
        """What lies around the least coefficient, as JSON data."""
        return {
            "lower": float(self.lower),
            "attained": self.attained,
            "residual": self.forces.residual,
            "moves": starting(program, self.mechanism),
        }


def find_least_friction(program: Program) -> LeastFriction | NoLimit:
    """The least friction coefficient that holds the assembly; no limit: none does, or failed.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(20.0)
    >>> found = find_least_friction(build_program(block, contacts(block)))
    >>> round(float(found.value), 6), round(float(np.tan(np.radians(20))), 6)
    (0.36397, 0.36397)
    """
    smooth = judge(program.frictionless)
    if smooth.stable:
        assert smooth.forces is not None
        return LeastFriction(0.0, 0.0, True, smooth.forces, None, 1)
    if not (program.kind == CONTACT).any():
        return NoLimit("none" if smooth.stable is False else "failed")
    sticks = _sticks(program)
    if not sticks:
        return NoLimit("failed" if sticks is None else "none")
    start: ForceProof | None = None
    lower, upper, mechanism, undecided = 0.0, LARGEST, smooth.motion, False
    for upper in TRIED:
        judged = judge(program.with_friction(upper))
        if judged.stable:
            start = judged.forces
            break
        undecided = undecided or judged.stable is None
        lower = lower if undecided else upper
    if start is None:
        return NoLimit("failed" if undecided else "none")
    best = start
    upper = min(upper, _used(program.with_friction(upper), best))
    solved = 2
    open_from = open_to = upper  # between them it could not be decided
    undecided_left = UNDECIDED
    for _ in range(STEPS):
        if upper <= MU_NOTHING:
            return LeastFriction(0.0, 0.0, False, best, mechanism, solved)
        open_from, open_to = min(open_from, upper), min(open_to, upper)
        above, below = upper - open_to, open_from - lower
        if max(above, below) <= MU_AGREES * upper:
            break
        middle = _between(open_to, upper) if above > below else _between(lower, open_from)
        judged = judge(program.with_friction(middle))
        solved += 1
        if judged.stable and judged.forces is not None:
            best = judged.forces
            upper = min(middle, _used(program.with_friction(middle), best))
        elif judged.stable is False and judged.motion is not None:
            mechanism, lower = judged.motion, middle
            open_from, open_to = max(open_from, lower), max(open_to, lower)
        elif upper - lower <= MU_CLOSE * upper:
            break
        elif open_from == upper:  # the first
            open_from = open_to = middle
            undecided_left -= 1
        elif undecided_left == 0:
            break
        else:
            undecided_left -= 1
            open_from, open_to = min(open_from, middle), max(open_to, middle)
    return LeastFriction(upper, lower, True, best, mechanism, solved)


def _between(low: float, high: float) -> float:
    """The middle, or where they are far apart that of their logarithms."""
    if high < 2 * low:
        return 0.5 * (low + high)
    return float(np.sqrt(max(low, MU_NOTHING / 10) * high))


def _sticks(program: Program) -> bool | None:
    """Whether forces balance where friction has no limit, not even without a push."""
    wide = spread(program.with_friction(LARGEST)).problem.program
    across = np.arange(len(wide.part_a)) >= len(program.part_a)
    return judge(wide.with_rows(two_sided=wide.two_sided | across)).stable


def _used(program: Program, proof: ForceProof) -> float:
    """The friction that forces use: the greatest |f_t| / f_n, and what their normals may be off."""
    rows = np.flatnonzero(program.kind == CONTACT)
    along, across = proof.forces[rows], np.linalg.norm(proof.friction[rows], axis=1)
    doubt = program.doubt[rows]
    rubs = (across > 0) | ((doubt > 0) & (along > 0))
    return float((across[rubs] / along[rubs] + doubt[rubs]).max(initial=0.0))
