"""How much more of a load it takes: a limit, with the forces and the mechanism at it.

    max t:  J^T f + w + t d = 0,  f in Coulomb's cones

One conic program; its multipliers are the motion that starts at the limit. This is the
associative limit: equilibrium forces exist up to it. Above it nothing holds. Below it what
holds is subject to what friction guarantees (`kilter.friction.answer`).

References
----------
M. Gilbert, C. Casapulla, H. M. Ahmed, Limit analysis of masonry block structures with
non-associative frictional joints using linear programming, 2006. M. C. Ferris, F. Tin-Loi,
Limit analysis of frictional block assemblies as a mathematical program with complementarity
constraints, 2001.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kilter.analysis.turning_tolerances import (
    BEYOND_LIMIT,
    LIMIT_TOLERANCES,
    MOVES,
    UNLIMITED,
)
from kilter.arrays import Array
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.coulomb_cones import Spread, largest_load, spread
from kilter.mechanics.program import Program

__all__ = [
    "Limit",
    "NoLimit",
    "find_limit",
    "finite",
    "gravity_wrench",
    "starting",
    "with_more",
]


Why = Literal["none", "failed"]


@dataclass(frozen=True, slots=True, eq=False)
class Limit:
    """The largest share of a load, judged from both sides.

    Attributes
    ----------
    value : float
        t; infinite where unlimited, negative where only shares below 0 are held.
    forces : ForceProof
        Forces at the limit.
    mechanism : MotionProof or None
        The motion that starts there; None where unlimited.
    gap : float
        Relative distance between a share that is proved to be held and one that is proved
        not to be; infinite where one of the proofs is missing.
    """

    value: float
    forces: ForceProof
    mechanism: MotionProof | None
    gap: float

    def to_dict(self, program: Program) -> dict[str, Any]:
        """The evidence as JSON data: how well forces balance, what moves, what lies between."""
        return {
            "residual": self.forces.residual,
            "gap": finite(self.gap),
            "moves": starting(program, self.mechanism),
            "mechanism": None
            if self.mechanism is None
            else {
                name: (self.mechanism.motion[k] + 0.0).tolist()
                for k, name in enumerate(program.names)
                if program.free[k]
            },
        }


@dataclass(frozen=True, slots=True)
class NoLimit:
    """No limit is known, and why: "none", no share is held, proved; "failed", the numbers did."""

    why: Why


def gravity_wrench(program: Program, direction: Array) -> Array:
    """The weights as if gravity pointed along `direction`, shape (N, 6) [N]."""
    wrench = np.zeros((len(program.names), 6))
    wrench[:, :3] = (program.mass * program.free)[:, None] * program.g * direction
    return wrench


def finite(number: float) -> float | None:
    """A number for JSON: null where it is infinite, never -0."""
    return float(number) + 0.0 if np.isfinite(number) else None


def starting(program: Program, mechanism: MotionProof | None) -> list[str]:
    """Names of the parts that move in a mechanism."""
    if mechanism is None:
        return []
    size = part_sizes(program, mechanism.motion, per_radius=False)
    fast = size > MOVES * float(size.max(initial=0.0))
    return [n for n, moves in zip(program.names, fast & program.free, strict=True) if moves]


def with_more(program: Program, wrench: Array, share: float) -> Program:
    """The program with a share of further wrenches, shape (N, 6), on its parts."""
    return program.with_rows(applied=program.applied + share * wrench)


def find_limit(
    program: Program, wrench: Array, *, wide: Spread | None = None, most: float = UNLIMITED
) -> Limit | NoLimit:
    """The largest share of further wrenches that contacts can hold.

    It may be negative, and where it is not, a share of 0 need not be held: the shares that are
    held are an interval, of which this is the upper end.

    Parameters
    ----------
    program : Program
        With its own load.
    wrench : ndarray, shape (N, 6)
        Force [N] and torque about the centre of mass [N x length unit] on each part.
    wide : Spread, optional
        ``spread(program)``, where it is at hand.
    most : float
        Shares looked at.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> aside = np.zeros((2, 6))
    >>> aside[1, 0] = program.weight[1]
    >>> round(find_limit(program, aside).value, 9)
    0.5
    """
    wide = wide or spread(program)
    best: Limit | NoLimit = NoLimit("failed")
    for tolerance in LIMIT_TOLERANCES:
        found = _limit_at(program, wide, wrench, most, tolerance)
        if isinstance(found, NoLimit):
            if found.why == "none" and isinstance(best, NoLimit):
                return found
            continue
        if isinstance(best, NoLimit) or found.gap < best.gap:
            best = found
        if found.gap < np.inf:
            break
    return best


def _limit_at(
    program: Program, wide: Spread, wrench: Array, most: float, tolerance: float
) -> Limit | NoLimit:
    """The limit that the solver finds at one tolerance, judged."""
    from kilter.solvers.clarabel import solve_conic

    problem = wide.problem
    answer = solve_conic(largest_load(wide, wrench, most), tolerance=tolerance)
    if not answer.found:
        return NoLimit("none" if answer.proves_none else "failed")
    value = float(answer.x[-1])
    at_limit = with_more(program, wrench, value)
    forces = check_forces(at_limit, *wide.decoded(answer.x[:-1]))
    if not forces.holds:
        return NoLimit("failed")
    if value >= most * (1 - BEYOND_LIMIT[-1]):
        return Limit(np.inf, forces, None, 0.0)
    multipliers = answer.multipliers[: len(problem.right)]
    motion = problem.motion(problem.over_weight(multipliers))
    beyond, gap = check_motion(at_limit, motion), np.inf
    for step in BEYOND_LIMIT:
        share = value + step * max(abs(value), 1.0)
        beyond = check_motion(with_more(program, wrench, share), motion)
        if beyond.holds:
            gap = step
            break
    return Limit(value, forces, beyond, gap)
