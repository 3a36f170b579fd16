"""The least friction coefficient, the same at every contact, with which forces hold it.

Equilibrium with mu implies equilibrium with more, so the least mu is enclosed from both sides:
forces in the cones of `upper`, a motion in the dual cones of `lower`. Forces say how much
friction they use, once they balance to rounding (`kilter.mechanics.balanced_forces`): the
imbalance that a certificate permits, 1e-9 of the weights, is much of a tiny coefficient. The least
cohesion (`kilter.analysis.decision.cohesion`) gives both, and its slope predicts the root, so
that a dozen conic programs are enough. If the least is not attained (a block squeezed
between two walls), it is zero, with forces that grow without bound
(`kilter.analysis.margins.squeeze`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.judge import judge
from kilter.analysis.margins.load_limit import NoLimit, starting
from kilter.analysis.margins.squeeze import held_by_squeeze
from kilter.analysis.turning_tolerances import (
    MU_AGREES,
    MU_BALANCED,
    MU_CLOSE,
    MU_NOTHING,
)
from kilter.mechanics.balanced_forces import balanced_forces
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

__all__ = ["LeastFriction", "find_least_friction"]


TRIED = (1.0, 30.0, 1e3)
"""Coefficients tried for a first one that holds."""
LARGEST = TRIED[-1]
"""Coefficients above this count as none that holds."""
STEPS = 80
ASIDE = 0.01
"""How far beside the limit, as it is expected, it is asked, over the way to it."""
PATIENT = 3
"""Steps after which what is left has to be halved, or else is."""
UNDECIDED = 3
"""Coefficients that may be left undecided, at many times the cost of others."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastFriction:
    """The least mu that holds, enclosed: it lies above `lower`, and is at most `value`.

    Attributes
    ----------
    value : float
        The least coefficient that is proved to hold [-], by forces that balance to rounding
        if the data are that good; 0 if no friction is needed.
    lower : float
        A coefficient that is proved not to hold [-]: no nearer than a motion can gain 1e-9 of
        the weights, which of a tiny coefficient may be seen.
    attained : bool
        False if every mu above zero holds, but zero does not.
    forces : ForceProof
        Forces at `value`.
    mechanism : MotionProof or None
        The motion at `lower`; None if no friction is needed.
    programs : int
    """

    value: float
    lower: float
    attained: bool
    forces: ForceProof
    mechanism: MotionProof | None
    programs: int

    def to_dict(self, program: Program) -> dict[str, Any]:
        """The bounds of the least coefficient and their evidence, as JSON data."""
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
    squeezed = None if program.cohesion.any() else held_by_squeeze(program)
    if squeezed is not None:
        return LeastFriction(0.0, 0.0, False, squeezed, smooth.motion, 4)
    sides = _Sides(program, smooth.motion)
    for mu in TRIED:
        sides.ask(mu, surely=True)
        if sides.forces is not None:
            break
    if sides.forces is None:
        return NoLimit("none" if sides.lower == LARGEST else "failed")
    sides.narrow(surely=False)
    if not sides.near(MU_CLOSE):
        sides.narrow(surely=True)
    return LeastFriction(sides.upper, sides.lower, True, sides.forces, sides.motion, sides.programs)


class _Sides:
    """A coefficient that is proved to hold and a coefficient that is proved not to hold.

    The sign of the least cohesion decides most coefficients, and its slope predicts the root. The
    next coefficient lies beside that root, on the side that is farther off. Close to the limit
    neither proof may hold: the coefficients between the ends of `open` could not be decided.
    """

    def __init__(self, program: Program, motion: MotionProof | None) -> None:
        self.program = program
        self.lower, self.upper = 0.0, LARGEST
        self.motion = motion
        self.forces: ForceProof | None = None
        self.programs = 4
        self._open: tuple[float, float] | None = None
        self._root, self._off, self._slope = np.nan, np.inf, np.inf
        self._opening: Opening | None = None

    def near(self, agree: float) -> bool:
        """Whether both sides agree: to this fraction, or as far as a motion can tell."""
        return self.upper - self.lower <= self._apart(agree)

    def _apart(self, agree: float) -> float:
        """How far apart both sides may stay [-]: beside the limit motions gain too little."""
        unseen = TOLERANCE / self._slope if self._slope > 0.0 else np.inf
        return max(agree * self.upper, unseen if self._off <= unseen < np.inf else 0.0)

    def narrow(self, *, surely: bool) -> None:
        """Decide further coefficients until both sides agree, or both sides and the open interval.

        `surely`: whether coefficients that the cohesion leaves open get all other methods, a few
        times at most.
        """
        self._open = None
        widths, undecided = [np.inf] * PATIENT, 0
        for _ in range(STEPS):
            low, high = self._open or (self.upper, self.upper)
            left = max(self.upper - high, low - self.lower)
            if min(self.upper - self.lower, left) <= self._apart(MU_AGREES):
                return
            if undecided > UNDECIDED:
                return
            middle = self._next(by_root=left <= 0.5 * widths[-PATIENT])
            widths.append(left)
            decided = self.ask(middle, surely=surely)
            undecided += surely and not decided

    def _next(self, *, by_root: bool) -> float:
        """The next coefficient to decide."""
        least = self._apart(MU_AGREES) / 3
        if self._open is not None:  # out of what is open, twice as far each time
            low, high = self._open
            above, below = self.upper - high, low - self.lower
            wide = max(high - low, ASIDE * max(above, below), least)
            if above > below:
                return min(high + wide, _between(high, self.upper))
            return max(low - wide, _between(self.lower, low))
        aside = max(ASIDE * self._off, least)
        above = self.upper - self._root > self._root - self.lower
        aim = self._root + (aside if above else -aside)
        if by_root and self.lower < aim < self.upper:
            return aim
        return _between(self.lower, self.upper)

    def ask(self, mu: float, *, surely: bool) -> bool:
        """Decide a coefficient and update the sides; return whether it was decided."""
        program = self.program.with_friction(mu)
        wide = cone_problem(program)
        forces, motion = self._by_cohesion(wide, mu)
        if forces is None and motion is None and surely:
            judged = judge(program)
            forces = judged.forces if judged.stable else None
            motion = judged.motion if judged.stable is False else None
        self.programs += 1
        decided = motion is not None
        if motion is not None:
            self.lower, self.motion = max(mu, self.lower), motion
        if forces is not None:
            used, forces = _used(wide, forces)
            decided |= used <= mu * (1 + MU_BALANCED)
            if self.forces is None or used < self.upper:
                self.upper, self.forces = used, forces
        self.lower = min(self.lower, self.upper)  # forces of a million weights are both
        if not decided:
            low, high = self._open or (mu, mu)
            self._open = min(low, mu), max(high, mu)
        if self._open is not None:
            low, high = max(self._open[0], self.lower), min(self._open[1], self.upper)
            self._open = (low, high) if low <= high else None
        return decided

    def _by_cohesion(
        self, wide: ConeProblem, mu: float
    ) -> tuple[ForceProof | None, MotionProof | None]:
        """The two proofs, as far as the least cohesion gives them: beside the limit even both."""
        program, found = wide.program, find_cohesion(wide)
        if found is None:
            return None, None
        if abs(found.rise) < self._off:
            self._root, self._off, self._slope = mu + found.rise, abs(found.rise), found.slope
        balanced = check_forces(program, found.forces, found.friction)
        forces = balanced if balanced.holds else None
        if found.value <= 0.0:
            return forces, None
        motion = check_motion(program, found.motion)
        if not motion.holds:
            self._opening = self._opening or Opening(
                cone_problem(self.program.with_friction(self.upper))
            )
            motion = check_motion(program, self._opening.narrowed(wide).mended(found.motion))
        return forces, (motion if motion.holds else None)


def _between(low: float, high: float) -> float:
    """The middle of an interval, or its geometric mean if the ends are far apart."""
    if high < 2 * low:
        return 0.5 * (low + high)
    return float(np.sqrt(max(low, MU_NOTHING / 10) * high))


def _sticks(program: Program) -> bool | None:
    """Whether forces balance if friction has no limit, not even without a normal force."""
    wide = cone_problem(program.with_friction(LARGEST)).problem.program
    across = np.arange(len(wide.part_a)) >= len(program.part_a)
    return judge(wide.with_rows(two_sided=wide.two_sided | across)).stable


def _used(wide: ConeProblem, proof: ForceProof) -> tuple[float, ForceProof]:
    """The friction that forces use once they balance to rounding, and those forces.

    Of data so coarse that none balance so well, as they are: they hold as far as the data do.
    """
    program = wide.program
    sticks = program.with_friction(LARGEST)
    nearer = check_forces(sticks, *balanced_forces(wide, proof.forces, proof.friction))
    used = _greatest(program, nearer)
    exact = check_forces(program.with_friction(used), nearer.forces, nearer.friction)
    if exact.holds and exact.residual <= MU_BALANCED:
        return used, exact
    return _greatest(program, proof), proof


def _greatest(program: Program, proof: ForceProof) -> float:
    """The greatest ratio |f_t| / f_n that friction uses, and the error of the normal forces."""
    rows = np.flatnonzero(program.kind == CONTACT)
    along, across = proof.forces[rows], np.linalg.norm(proof.friction[rows], axis=1)
    doubt = program.doubt[rows]
    rubs = ((across > 0) | ((doubt > 0) & (along > 0))) & np.isnan(program.shear[rows])
    return float((across[rubs] / along[rubs] + doubt[rubs]).max(initial=0.0))
