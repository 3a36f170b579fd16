"""A load limit from both sides, by linear programs in pyramids that are fitted to the cones.

    held       max t:  J^T f + w + t d = 0,  f >= 0 on rays that lie on the cones
    beyond     the same on pyramids whose sides touch the cones; its multipliers are a motion
               that no force in the cones can stop, exactly

A simplex ends at a corner, so both are exact to rounding even if the set of equilibria has
no interior, where an interior point stops short. Rays and sides lie at even angles and along the
forces and slips of earlier solutions; the error of t is the square of their error of
an angle. In a plane a cone has two rays, and a single round is exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.turning_tolerances import BEYOND_LIMIT, LIMIT_AGREES, NEARLY
from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import angles_across, pyramid, pyramid_forces
from kilter.mechanics.forms import largest_share, scaled_problem
from kilter.mechanics.program import Program

if TYPE_CHECKING:
    from kilter.solvers.solution import Solution

__all__ = ["LimitSides", "beyond_at", "held_at", "limit_sides", "motion_share", "slips_of"]

EVEN = 8
"""Rays and sides of each pyramid at even angles."""
ROUNDS = 5
"""Pairs of programs."""
LARGEST = 20_000
"""Rays above which no program is asked."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitSides:
    """A share that is proved to be held, a share that is proved not to be held, and their proofs.

    `held` is -inf, `start` and `beyond` inf if they are unknown. The motion gains power from
    `start` on, enough to count as a proof at `beyond`. `none`: it is proved that no share is
    held.
    """

    held: float = -np.inf
    forces: ForceProof | None = None
    start: float = np.inf
    beyond: float = np.inf
    motion: MotionProof | None = None
    none: bool = False

    @property
    def closed(self) -> bool:
        """Whether both sides agree."""
        known = np.isfinite(self.held) and np.isfinite(self.beyond)
        return known and self.start - self.held <= LIMIT_AGREES * max(abs(self.held), 1.0)

    @property
    def gap(self) -> float:
        """Relative gap (beyond - held) / max(abs(held), 1) between the proved bounds."""
        apart = self.beyond - self.held
        return max(apart / max(abs(self.held), 1.0), 0.0) if np.isfinite(apart) else np.inf

    def better(self, other: LimitSides) -> LimitSides:
        """The nearer of each side."""
        low = self if self.held >= other.held else other
        high = self if self.beyond <= other.beyond else other
        none = self.none or other.none
        return LimitSides(low.held, low.forces, high.start, high.beyond, high.motion, none)


def limit_sides(
    program: Program, wrench: Array, most: float, across: list[Array] | None = None
) -> LimitSides:
    """The largest share of further wrenches that contacts hold, from both sides.

    Parameters
    ----------
    program : Program
        With its own load.
    wrench : ndarray, shape (N, 6)
        Force [N] and torque about the centre of mass [N x length unit] on each part.
    most : float
        Largest examined share: if it is held, `beyond` is infinite.
    across : list of ndarray, shape (K, 3), optional
        Friction as it is guessed to point, for the first rays and sides.

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
            guesses += [_angles_of(program, one) for one in vectors]
        if best.none or best.closed or best.held >= most * (1 - NEARLY):
            break
        if (best.held, best.beyond) == (before.held, before.beyond):
            break
    return best


def _angles_of(program: Program, across: Array) -> Array:
    """Angles of vectors across the contacts; none in a plane, whose cones have two rays."""
    return np.empty(0) if program.planar else angles_across(program, across)


def _angles(program: Program, guesses: list[Array]) -> Array:
    """Even angles and those that are guessed, shape (R, n) [rad]."""
    even = np.tile(2 * np.pi * np.arange(EVEN) / EVEN, (len(program.rough), 1))
    return even if program.planar else np.column_stack([even, *guesses])


def _round(
    program: Program, wrench: Array, most: float, angles: Array
) -> Iterator[tuple[LimitSides, list[Array]]]:
    """Solve a pair of programs: the result that each proves, and its directions of friction."""
    for outer in (True, False):
        rays = pyramid(program, outer=outer, angles=angles)
        answer = _solved(rays, wrench, most)
        if outer and answer.outcome == "infeasible":
            yield LimitSides(none=answer.proves_none), []
            return
        if not answer.found:
            continue
        share = float(answer.x[-1])
        problem = scaled_problem(rays)
        along, aside = pyramid_forces(program, rays, problem.forces(answer.x[:-1]))
        sides, vectors = LimitSides(), [aside, _of_patches(program, aside)]
        if not outer or program.planar:
            sides = sides.better(held_at(program, wrench, share, along, aside))
        if outer and share < most * (1 - NEARLY):
            motion = problem.motion(problem.over_weight(-answer.multipliers))
            start = motion_share(program, wrench, motion)
            sides = sides.better(beyond_at(program, wrench, start, motion))
            vectors.append(-slips_of(program, motion))
        yield sides, vectors


def _solved(rays: Program, wrench: Array, most: float) -> Solution:
    from kilter.solvers.highs import KeptProgram

    return KeptProgram(largest_share(scaled_problem(rays), wrench, most)).solve()


def held_at(
    program: Program, wrench: Array, share: float, along: Array, aside: Array
) -> LimitSides:
    """A share with forces along the rows and across them, as far as they prove it."""
    loaded = program.with_rows(applied=program.applied + share * wrench)
    proof = check_forces(loaded, along, aside)
    return LimitSides(held=share, forces=proof) if proof.holds else LimitSides()


def beyond_at(program: Program, wrench: Array, share: float, motion: Array) -> LimitSides:
    """The least share above `share` at which a motion is proved to start."""
    start = motion_share(program, wrench, motion)
    for step in BEYOND_LIMIT if np.isfinite(share) else ():
        there = share + step * max(abs(share), 1.0)
        loaded = program.with_rows(applied=program.applied + there * wrench)
        proof = check_motion(loaded, motion)
        if proof.holds:
            return LimitSides(start=start, beyond=there, motion=proof)
    return LimitSides()


def motion_share(program: Program, wrench: Array, motion: Array) -> float:
    """The share of further wrenches from which on a motion gains power; inf if it never does."""
    free = program.free[:, None]
    gain = float((np.where(free, wrench, 0.0) * motion).sum())
    return -program.power(motion) / gain if gain > 0 else np.inf


def _of_patches(program: Program, aside: Array) -> Array:
    """Friction of each patch as a whole, at each of its rows, shape (K, 3)."""
    total = np.zeros((int(program.source.max(initial=-1)) + 1, 3))
    np.add.at(total, program.source, aside)
    whole: Array = total[program.source]
    return whole


def slips_of(program: Program, motion: Array) -> Array:
    """Slip of every row, shape (K, 3); 0 without friction."""
    slips = np.zeros((len(program.part_a), 3))
    slips[program.rough] = program.slips(motion, program.rough)
    return slips
