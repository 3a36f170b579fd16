"""Lower and upper bounds of a load limit, by linear programs in pyramids fitted to the cones.

    held       max t:  J^T f + w + t d = 0,  f >= 0 on rays that lie on the cones
    beyond     the same program on pyramids whose sides touch the cones from outside; its
               multipliers are a motion that no force in the cones can stop, exactly

The simplex method ends at a vertex, so both bounds are exact to rounding even if the set of
equilibria has no interior. An interior-point method stops short in that case.

The rays and sides lie at even angles, and at the angles of the forces and slips of earlier
solutions. The error of t is the square of the angle between a force and its nearest ray. In a
plane a cone has two rays, and a single round is exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.analysis_tolerances import BEYOND_LIMIT, LIMIT_AGREES, NEARLY
from kilter.analysis.decision.refined_proofs import balanced_proof
from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import angles_across, pyramid, pyramid_forces
from kilter.mechanics.forms import largest_share, scaled_problem
from kilter.mechanics.program import Program

if TYPE_CHECKING:
    from kilter.solvers.problem import Solution


EVEN = 8
"""Number of rays, and of sides, of each pyramid at even angles."""
ROUNDS = 5
"""Maximum number of rounds; each solves an inner and an outer program."""
LARGEST = 20_000
"""Largest total number of rays for which a program is solved."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitSides:
    """Proved lower and upper bounds of the largest multiple of a load, with their proofs."""

    held: float = -np.inf
    """Share at which contact forces balance [-]; -inf if none is known."""
    forces: ForceProof | None = None
    """Forces at `held`."""
    start: float = np.inf
    """Share above which `motion` gains power [-]; inf if no motion is known."""
    beyond: float = np.inf
    """Share at which this power is large enough for a proof [-]; inf if no proof is known."""
    motion: MotionProof | None = None
    """Motion at `beyond`."""
    none: bool = False
    """True if it is proved that no share is held."""

    @property
    def closed(self) -> bool:
        """True if the lower and the upper bound of the load agree."""
        known = np.isfinite(self.held) and np.isfinite(self.beyond)
        return known and self.start - self.held <= LIMIT_AGREES * max(abs(self.held), 1.0)

    @property
    def gap(self) -> float:
        """Relative gap (beyond - held) / max(abs(held), 1) of the load bounds [-], or inf."""
        apart = self.beyond - self.held
        return max(apart / max(abs(self.held), 1.0), 0.0) if np.isfinite(apart) else np.inf

    def better(self, other: LimitSides) -> LimitSides:
        """Combine two pairs of bounds: the greater lower bound and the lesser upper bound."""
        low = self if self.held >= other.held else other
        high = self if self.beyond <= other.beyond else other
        none = self.none or other.none
        return LimitSides(low.held, low.forces, high.start, high.beyond, high.motion, none)


def limit_sides(
    program: Program, wrench: Array, most: float, across: list[Array] | None = None
) -> LimitSides:
    """Compute bounds of the largest multiple of the given wrenches that contacts can hold.

    Arguments: `wrench` (N, 6): force [N] and torque about the centre of mass [N x length unit] on
    each part; `most`: largest share of the programs [-]; if it is held, `beyond` is infinite;
    `across` (K, 3): guesses of the directions of friction at the contact rows, for the first rays
    and sides.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> aside = np.zeros((2, 6))
    >>> aside[1, :2] = program.weight[1] * np.array([0.28, 0.96])
    >>> sides = limit_sides(program, aside, 1e6)
    >>> bool(abs(sides.held - 0.5) < 1e-9), bool(0.5 <= sides.beyond), bool(sides.gap < 3e-7)
    (True, True, True)
    """
    guesses = [_angles_of(program, vectors) for vectors in across or []]
    best = LimitSides()
    for _ in range(1 if program.planar else ROUNDS):
        angles = _angles(program, guesses)
        if angles.size > LARGEST:
            break
        before = best
        for sides, vectors in _round(program, wrench, most, angles):
            best = best.better(sides)
            guesses += [_angles_of(program, across_rows) for across_rows in vectors]
        if best.none or best.closed or best.held >= most * (1 - NEARLY):
            break
        if (best.held, best.beyond) == (before.held, before.beyond):
            break
    return best


def _angles_of(program: Program, across: Array) -> Array:
    """Angles of tangential vectors at the contacts [rad]; empty for a planar assembly.

    A friction cone in a plane has only two rays.
    """
    return np.empty(0) if program.planar else angles_across(program, across)


def _angles(program: Program, guesses: list[Array]) -> Array:
    """Angles of the rays of each row's friction pyramid [rad], even ones and guesses, (R, n)."""
    even = np.tile(2 * np.pi * np.arange(EVEN) / EVEN, (len(program.rough), 1))
    return even if program.planar else np.column_stack([even, *guesses])


def _round(
    program: Program, wrench: Array, most: float, angles: Array
) -> Iterator[tuple[LimitSides, list[Array]]]:
    """Solve the outer and the inner pyramid program; yield load bounds and friction vectors.

    Each program gives one pair of bounds.
    """
    for outer in (True, False):
        rays = pyramid(program, outer=outer, angles=angles)
        answer = _solve_share(rays, wrench, most)
        if outer and answer.outcome == "infeasible":
            yield LimitSides(none=answer.proves_none), []
            return
        if not answer.found:
            continue
        share = float(answer.x[-1])
        problem = scaled_problem(rays)
        along, aside = pyramid_forces(program, rays, problem.forces(answer.x[:-1]))
        sides, vectors = LimitSides(), [aside, _of_patches(program, aside)]
        if not outer or program.planar:  # forces of the outer pyramids may leave the cones
            sides = sides.better(held_at(program, wrench, share, along, aside))
        if outer and share < most * (1 - NEARLY):
            motion = problem.motion(problem.over_weight(-answer.multipliers))
            start = motion_share(program, wrench, motion)
            sides = sides.better(beyond_at(program, wrench, start, motion))
            vectors.append(-slips_of(program, motion))
        yield sides, vectors


def _solve_share(rays: Program, wrench: Array, most: float) -> Solution:
    """Solve the linear program for the largest load multiple, which is its last unknown."""
    from kilter.solvers.highs import KeptProgram

    return KeptProgram(largest_share(scaled_problem(rays), wrench, most)).solve()


def held_at(
    program: Program, wrench: Array, share: float, along: Array, aside: Array
) -> LimitSides:
    """Load bounds with `share` as lower bound, if the given forces prove it; else no bounds.

    Arguments: `wrench` (N, 6): further wrenches per unit of the share [N], [N x length unit];
    `along`, `aside`: forces along and across the contact rows [N].
    """
    loaded = program.with_rows(applied=program.applied + share * wrench)
    proof = balanced_proof(loaded, check_forces(loaded, along, aside))
    return LimitSides(held=share, forces=proof) if proof.holds else LimitSides()


def beyond_at(program: Program, wrench: Array, share: float, motion: Array) -> LimitSides:
    """Load bounds with an upper bound just above `share`, if a motion proves it; else no bounds.

    Arguments: `wrench` (N, 6) [N]; `share` [-]; `motion` (N, 6).
    """
    start = motion_share(program, wrench, motion)
    for step in BEYOND_LIMIT if np.isfinite(share) else ():
        above = share + step * max(abs(share), 1.0)
        loaded = program.with_rows(applied=program.applied + above * wrench)
        proof = check_motion(loaded, motion)
        if proof.holds:
            return LimitSides(start=start, beyond=above, motion=proof)
    return LimitSides()


def motion_share(program: Program, wrench: Array, motion: Array) -> float:
    """Multiple of a load above which a given motion gains energy [-]; inf if there is none."""
    free = program.free[:, None]
    gain = float((np.where(free, wrench, 0.0) * motion).sum())
    return -program.power(motion) / gain if gain > 0 else np.inf


def _of_patches(program: Program, aside: Array) -> Array:
    """Total friction force of the patch to which each row belongs, shape (K, 3) [N]."""
    total = np.zeros((int(program.source.max(initial=-1)) + 1, 3))
    np.add.at(total, program.source, aside)
    whole: Array = total[program.source]
    return whole


def slips_of(program: Program, motion: Array) -> Array:
    """Tangential motion of both parts at every contact row, (K, 3); 0 at rows without friction."""
    slips = np.zeros((len(program.part_a), 3))
    slips[program.rough] = program.slips(motion, program.rough)
    return slips
