"""The least friction coefficient, equal at all contacts, with which contact forces balance.

Equilibrium with mu implies equilibrium with any larger coefficient, so two proofs enclose the least
coefficient: forces in the cones of `upper`, and a motion in the dual cones of `lower`.

The forces are first corrected to balance to rounding (`kilter.mechanics.coulomb_cones`), and
`upper` is the friction that they then use. A certificate tolerates an imbalance of 1e-9 of the
weights, and a tiny coefficient may depend on it.

The least cohesion (`kilter.analysis.decision.cohesion`) gives both proofs. Its slope predicts the
limit, so the search needs only about a dozen conic programs.

A block squeezed between two walls holds with every mu above zero, but not with zero. The least
coefficient is then zero and not attained: as mu decreases, the forces grow without bound
(`kilter.analysis.margins.least_friction`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import hstack

from kilter.analysis.analysis_tolerances import (
    MU_AGREES,
    MU_BALANCED,
    MU_CLOSE,
    MU_NOTHING,
    MU_SQUEEZED,
)
from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit, least_limit, starting
from kilter.arrays import Array, Mask
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import ConeProblem, balanced_forces, cone_problem
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import LinearProgram
from kilter.tell.numbers import rounded_up
from kilter.tell.record import InPython, Record, key

# Decide whether arbitrarily little friction suffices, as between parts squeezed very hard.


def squeeze(program: Program) -> Array:
    """Normal forces that balance each other without a load, positive where possible, (K,) [N].

    Such forces squeeze parts between others, and can grow without limit.

    Each is at least the geometric mean of the weights, or 0: without friction.

    Examples
    --------
    >>> from kilter.scenes import friction, stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> def pressed(assembly):
    ...     return int((squeeze(build_program(assembly, contacts(assembly))) > 0).sum())
    >>> pressed(friction.h_block()), pressed(stacks.tower(2))
    (8, 0)
    """
    from kilter.solvers.highs import find_optimum

    problem = scaled_problem(program)
    count, free = len(program.part_a), program.two_sided
    matrix = hstack([problem.matrix, problem.matrix], format="csc")
    zero, none = np.zeros(len(problem.right)), np.zeros(count)
    pressed = np.where(free, 0.0, 1.0)
    answer = find_optimum(
        LinearProgram(
            np.concatenate([-pressed, none]),
            matrix,
            zero,
            zero,
            np.concatenate([none, np.where(free, -np.inf, 0.0)]),
            np.concatenate([pressed, np.full(count, np.inf)]),
        )
    )
    if not answer.optimal:
        return none
    first, more = answer.x[:count], answer.x[count:]
    return problem.forces(np.where((first > 0.5) | free, first + more, 0.0))


def held_by_squeeze(program: Program) -> ForceProof | None:
    """Forces that hold the parts with arbitrarily little friction; None if this is not proved.

    Arguments: `program`: whatever its friction: contacts whose normals are in doubt hold nothing.
    """
    smooth = program.frictionless
    wide, stuck = _with_sticking_rows(smooth, np.zeros(len(smooth.part_a), dtype=bool))
    levels: list[_Level] = []
    while True:
        press = squeeze(stuck)
        pressed = (press > 0) & ~stuck.two_sided & ~stuck.angular
        if not pressed.any():
            break
        rows = pressed[: len(smooth.part_a)]
        levels.append(_Level(rows, *wide.gathered(press)))
        wide, stuck = _with_sticking_rows(smooth, np.any([step.rows for step in levels], axis=0))
    judged = judge(stuck) if levels else None
    if judged is None or not judged.stable or judged.forces is None:
        return None
    carried = wide.gathered(judged.forces.forces)
    for mu in MU_SQUEEZED:
        along, aside = carried
        for level in reversed(levels):
            harder = level.needed(mu, along, aside)
            along, aside = along + harder * level.along, aside + harder * level.aside
        proof = check_forces(smooth.with_friction(mu), along, aside)
        if proof.holds:
            return proof
    return None


@dataclass(frozen=True, slots=True, eq=False)
class _Level:
    """Self-balancing forces that press on the contacts `rows` and raise their friction limits."""

    rows: Mask
    along: Array
    aside: Array

    def needed(self, mu: float, along: Array, aside: Array) -> float:
        """Least multiple of these forces that, added to others, obeys the friction limits [-]."""
        rubs = np.linalg.norm(aside[self.rows], axis=1)
        missing = (rubs / mu - along[self.rows]) / self.along[self.rows]
        return float(missing.max(initial=0.0))


def _with_sticking_rows(smooth: Program, rows: Mask) -> tuple[ConeProblem, Program]:
    """Problem and program in which the contacts `rows` exert forces in any direction."""
    wide = cone_problem(smooth.with_rows(mu=np.where(rows, 1.0, 0.0)))
    spread_rows = wide.problem.program
    count = len(smooth.part_a)
    free = np.concatenate([rows, np.ones(len(spread_rows.part_a) - count, dtype=bool)])
    return wide, spread_rows.with_rows(two_sided=spread_rows.two_sided | free)


TRIED = (1.0, 30.0, 1e3)
"""Coefficients to try, in this order, until forces balance [-]."""
LARGEST = TRIED[-1]
"""Largest coefficient of the search: if it does not hold, no coefficient counts as enough [-]."""
STEPS = 80
"""Maximum number of coefficients in a pass of the search."""
ASIDE = 0.01
"""The next coefficient lies beside the predicted limit by this fraction of the distance to it [-].
A coefficient exactly at the limit would be hard to decide."""
PATIENT = 3
"""If the interval was not halved in this number of steps, the next step bisects it."""
UNDECIDED = 3
"""Maximum number of coefficients left undecided; they cost many times more than others."""


class Failing(NamedTuple):
    """A friction coefficient `mu` of all contacts that is not enough, and the motion proving it."""

    mu: float
    motion: MotionProof


class LeastFriction(Record):
    """Bounds of the least friction coefficient: it is above `lower`, and at most `value`."""

    value: InPython[float]
    """Least coefficient that is proved to hold [-]; 0 if no friction is needed. The forces balance
    to rounding if the data permit it."""
    lower: float
    """Greatest coefficient that is proved not to hold [-]. A proof needs a motion that gains 1e-9
    of the weights, which may leave a visible distance from a tiny `value`."""
    attained: bool
    """False if every mu above zero holds, but zero does not."""
    forces: InPython[ForceProof]
    """Forces at `value`. If it is not attained, they hold at a small coefficient above zero."""
    motion: InPython[MotionProof | None]
    """The motion at `lower`; None if no friction is needed."""
    programs: InPython[int]
    """Number of programs solved."""
    program: InPython[Program]
    """Program without its own coefficients."""

    @property
    @key
    def residual(self) -> float:
        """Largest imbalance of a part, divided by its weight [-]."""
        return self.forces.residual

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move with less friction."""
        return starting(self.program, self.motion)

    def __repr__(self) -> str:
        if self.value == 0.0:
            return f"LeastFriction({'none is needed' if self.attained else 'any mu above 0'})"
        return f"LeastFriction(mu >= {rounded_up(self.value)}, above {self.lower:.6g})"


def find_group_friction(
    groups: Sequence[Program], *, programs: float = np.inf
) -> LeastFriction | NoLimit:
    """Compute the least friction coefficient, equal at all contacts, that holds separate groups.

    Arguments: `groups`: programs of parts that do not touch those of other groups; `programs`: as
    in `find_least_friction`, for each group.
    """
    bounds = [find_least_friction(program, programs=programs) for program in groups]
    whole = least_limit(bounds, lambda bound: (-bound.value, bound.attained, -bound.lower))
    if isinstance(whole, NoLimit):
        return whole
    found = [bound for bound in bounds if isinstance(bound, LeastFriction)]
    failing = max(found, key=lambda bound: bound.lower)
    if failing.lower > whole.lower:
        whole = replace(whole, lower=failing.lower, motion=failing.motion, program=failing.program)
    return replace(whole, programs=sum(bound.programs for bound in found))


def find_least_friction(
    program: Program, *, failing: Failing | None = None, programs: float = np.inf
) -> LeastFriction | NoLimit:
    """Compute the least friction coefficient, equal at all contacts, that holds the assembly.

    The result is a `NoLimit` with the reason "none" if no coefficient is enough, or "failed" if the
    solvers give no proof.

    Arguments: `program`: program of the assembly; its own friction coefficients have no influence;
    `programs`: number of coefficients after which the search ends with the bounds that are proved.

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
    if not (program.kind == CONTACT).any():
        return _without_contacts(program)
    sides = _Sides(program, failing, programs)
    if failing is None:
        smooth = judge(program.frictionless)
        if smooth.stable:
            assert smooth.forces is not None
            return _none_needed(program, smooth.forces)
        sides.motion = smooth.motion
    else:
        sides.decide_first()
    if sides.forces is None:
        balances = _balances_without_slip(program)
        if not balances:
            return NoLimit("failed" if balances is None else "none")
    if failing is None and not program.has_limits:
        squeezed = held_by_squeeze(program)
        if squeezed is not None:
            return sides.answer(0.0, 0.0, squeezed, attained=False)
    while sides.forces is None and sides.decide_first():
        pass
    if sides.forces is None:
        return NoLimit("none" if sides.lower == LARGEST else "failed")
    sides.narrow(surely=False)
    if not sides.near(MU_CLOSE):
        sides.narrow(surely=True)
    return sides.answer(sides.upper, sides.lower, sides.forces)


def _none_needed(program: Program, forces: ForceProof) -> LeastFriction:
    """The answer for a program that holds without friction."""
    return LeastFriction(
        value=0.0,
        lower=0.0,
        attained=True,
        forces=forces,
        motion=None,
        programs=1,
        program=program,
    )


def _without_contacts(program: Program) -> LeastFriction | NoLimit:
    """The least friction coefficient of a program without contacts: zero, or none is enough."""
    smooth = judge(program)
    if smooth.stable:
        assert smooth.forces is not None
        return _none_needed(program, smooth.forces)
    return NoLimit("none" if smooth.stable is False else "failed")


class _Sides:
    """Bounds of the least friction coefficient with their proofs, and the search that narrows them.

    The sign of the least cohesion decides most coefficients, and its slope predicts the limit. The
    next coefficient lies beside the predicted limit, toward the farther bound.

    Close to the limit both proofs may fail. The interval `_undecided` spans these coefficients.
    """

    def __init__(self, program: Program, failing: Failing | None, most: float) -> None:
        self.program = program
        self.lower, self.upper = 0.0, LARGEST
        self.motion: MotionProof | None = None
        if failing is not None:
            self.lower, self.motion = failing
        self._first = [mu for mu in TRIED if mu > self.lower]
        self._most = most
        self._decided = 0
        self.forces: ForceProof | None = None
        self.programs = 4
        self._undecided: tuple[float, float] | None = None
        self._root, self._off, self._slope = np.nan, np.inf, np.inf
        self._opening: Opening | None = None

    def answer(
        self, value: float, lower: float, forces: ForceProof, *, attained: bool = True
    ) -> LeastFriction:
        """The answer with these bounds."""
        return LeastFriction(
            value=value,
            lower=lower,
            attained=attained,
            forces=forces,
            motion=self.motion,
            programs=self.programs,
            program=self.program,
        )

    def near(self, agree: float) -> bool:
        """True if the relative gap of the bounds is at most `agree`, or as small as provable."""
        return self.upper - self.lower <= self._tolerated_gap(agree)

    def _tolerated_gap(self, agree: float) -> float:
        """Largest gap of the bounds [-] with which the search for the least friction may end.

        So close to the limit, a motion gains less power than its certificate requires.
        """
        unseen = TOLERANCE / self._slope if self._slope > 0.0 else np.inf
        return max(agree * self.upper, unseen if self._off <= unseen < np.inf else 0.0)

    def decide_first(self) -> bool:
        """Decide the next of the coefficients `TRIED`; False if none is left."""
        if not self._first:
            return False
        self.decide(self._first.pop(0), surely=True)
        return True

    def narrow(self, *, surely: bool) -> None:
        """Decide further friction coefficients until the bounds of the least coefficient meet.

        The search also ends if they meet the interval that cannot be decided.

        With `surely`, the full decision follows if the cohesion does not decide; this may fail only
        a few times.
        """
        self._undecided = None
        widths, failures = [np.inf] * PATIENT, 0
        for _ in range(STEPS):
            low, high = self._undecided or (self.upper, self.upper)
            left = max(self.upper - high, low - self.lower)
            if min(self.upper - self.lower, left) <= self._tolerated_gap(MU_AGREES):
                return
            if failures > UNDECIDED or self._decided >= self._most:
                return
            middle = self._next(by_root=left <= 0.5 * widths[-PATIENT])
            widths.append(left)
            decided = self.decide(middle, surely=surely)
            failures += surely and not decided

    def _next(self, *, by_root: bool) -> float:
        """The next friction coefficient to decide: near the predicted limit, or by bisection."""
        least = self._tolerated_gap(MU_AGREES) / 3
        if self._undecided is not None:  # leave the undecided interval, twice as far each time
            low, high = self._undecided
            above, below = self.upper - high, low - self.lower
            wide = max(high - low, ASIDE * max(above, below), least)
            if above > below:
                return min(high + wide, _middle(high, self.upper))
            return max(low - wide, _middle(self.lower, low))
        aside = max(ASIDE * self._off, least)
        above = self.upper - self._root > self._root - self.lower
        aim = self._root + (aside if above else -aside)
        if by_root and self.lower < aim < self.upper:
            return aim
        return _middle(self.lower, self.upper)

    def decide(self, mu: float, *, surely: bool) -> bool:
        """Prove or refute that friction `mu` holds; update the bounds; False without a proof."""
        program = self.program.with_friction(mu)
        wide = cone_problem(program)
        forces, motion = self._by_cohesion(wide, mu)
        if forces is None and motion is None and surely:
            judgement = judge(program)
            forces = judgement.forces if judgement.stable else None
            motion = judgement.motion if judgement.stable is False else None
        self.programs += 1
        self._decided += 1
        decided = motion is not None
        if motion is not None:
            self.lower, self.motion = max(mu, self.lower), motion
        if forces is not None:
            used, forces = _used_friction(wide, forces)
            decided |= used <= mu * (1 + MU_BALANCED)
            if self.forces is None or used < self.upper:
                self.upper, self.forces = used, forces
        self.lower = min(self.lower, self.upper)  # both proofs may exist at forces of 1e6 weights
        if not decided:
            low, high = self._undecided or (mu, mu)
            self._undecided = min(low, mu), max(high, mu)
        if self._undecided is not None:
            low, high = max(self._undecided[0], self.lower), min(self._undecided[1], self.upper)
            self._undecided = (low, high) if low <= high else None
        return decided

    def _by_cohesion(
        self, wide: ConeProblem, mu: float
    ) -> tuple[ForceProof | None, MotionProof | None]:
        """Forces and motion at friction `mu`, from the least cohesion; None for a missing proof.

        Close to the limit, both proofs may hold within their tolerances.
        """
        program, cohesion = wide.program, find_cohesion(wide)
        if cohesion is None:
            return None, None
        if abs(cohesion.rise) < self._off:
            self._root, self._off, self._slope = (
                mu + cohesion.rise,
                abs(cohesion.rise),
                cohesion.slope,
            )
        balanced = check_forces(program, cohesion.forces, cohesion.friction)
        forces = balanced if balanced.holds else None
        if cohesion.value <= 0.0:
            return forces, None
        motion = check_motion(program, cohesion.motion)
        if not motion.holds:
            # an opening motion, added to it, makes the motion admissible
            self._opening = self._opening or Opening(
                cone_problem(self.program.with_friction(self.upper))
            )
            motion = check_motion(program, self._opening.narrowed(wide).mended(cohesion.motion))
        return forces, (motion if motion.holds else None)


def _middle(low: float, high: float) -> float:
    """Mean of two coefficients: arithmetic, or geometric if their ratio is above 2."""
    if high < 2 * low:
        return 0.5 * (low + high)
    return float(np.sqrt(max(low, MU_NOTHING / 10) * high))


def _balances_without_slip(program: Program) -> bool | None:
    """True if unlimited friction balances the parts, even at contacts without normal force.

    None if it is undecided.
    """
    wide = cone_problem(program.with_friction(LARGEST)).problem.program
    across = np.arange(len(wide.part_a)) >= len(program.part_a)
    return judge(wide.with_rows(two_sided=wide.two_sided | across)).stable


def _used_friction(wide: ConeProblem, proof: ForceProof) -> tuple[float, ForceProof]:
    """The friction coefficient that given forces need, and the forces after a balance correction.

    If the data are too coarse for such balance, the function returns the given forces.
    """
    program = wide.program
    sticks = program.with_friction(LARGEST)
    nearer = check_forces(sticks, *balanced_forces(wide, proof.forces, proof.friction))
    used = _greatest_ratio(program, nearer)
    exact = check_forces(program.with_friction(used), nearer.forces, nearer.friction)
    if exact.holds and exact.residual <= MU_BALANCED:
        return used, exact
    return _greatest_ratio(program, proof), proof


def _greatest_ratio(program: Program, proof: ForceProof) -> float:
    """Greatest ratio of tangential to normal force over the contacts, for the worst normals [-].

    The doubt of each normal is added.
    """
    rows = np.flatnonzero(program.kind == CONTACT)
    along, across = proof.forces[rows], np.linalg.norm(proof.friction[rows], axis=1)
    doubt = program.doubt[rows]
    rubs = ((across > 0) | ((doubt > 0) & (along > 0))) & np.isnan(program.shear[rows])
    return float((across[rubs] / along[rubs] + doubt[rubs]).max(initial=0.0))
