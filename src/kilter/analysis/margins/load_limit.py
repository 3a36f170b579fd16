"""Limit of a load: its greatest factor, with the forces and the mechanism at the limit.

    max t:  J^T f + w + t d = 0,  f in Coulomb's cones

A conic program gives both; its multipliers are the motion that starts at the limit. If it stops
short of a proof, linear programs in fitted pyramids take over (`limit_sides`). This is the
associative limit: equilibrium forces exist up to it, and none beyond it. Friction decides the
level below it (`kilter.friction.answer`).

References
----------
M. Gilbert, C. Casapulla, H. M. Ahmed, Limit analysis of masonry block structures with
non-associative frictional joints using linear programming, 2006. M. C. Ferris, F. Tin-Loi,
Limit analysis of frictional block assemblies as a mathematical program with complementarity
constraints, 2001.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from kilter.analysis.margins.limit_sides import (
    LimitSides,
    beyond_at,
    held_at,
    limit_sides,
    motion_share,
    slips_of,
)
from kilter.analysis.turning_tolerances import (
    CONIC_SHARP,
    MOVES,
    NEARLY,
    NO_SHARE,
    PROVED_APART,
    SIDES_APART,
    SIDES_NEAR,
    UNLIMITED,
)
from kilter.arrays import Array
from kilter.mechanics.balance_in_cones import ConeBalance, balance_in_cones
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.coulomb_cones import cone_problem, largest_load
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.cone_interior_point import Start, common_start, iterates
from kilter.solvers.solver_tolerances import CONIC

__all__ = [
    "Limit",
    "NoLimit",
    "SharedCones",
    "find_limit",
    "finite",
    "gravity_wrench",
    "starting",
    "with_more",
]


MENDED = 2000
"""Rows up to which a limit whose two sides agree is proved nearer: it costs a program more."""
EXACT = 500
"""Rows up to which linear programs make exact what a conic one nearly closes: where there are
more, they take two hundred times as long and bring little."""
BOLD = 0.999
"""Part of the way to the boundary that a step to an optimum goes: fewer steps than with less."""
NEAR, CLOSE = 1e-6, 1e-9
"""Distance of a share from what a motion bounds it by, over 1 and it, from which on both are worth
being judged, and that ends the steps where their proofs meet."""
MODEST = 10.0
"""Shares up to which it is asked first."""

Why = Literal["none", "failed", "time"]


@dataclass(frozen=True, slots=True, eq=False)
class Limit:
    """The largest share of a load, judged from both sides.

    Attributes
    ----------
    value : float
        t; infinite if unlimited, negative if only shares below 0 are held.
    forces : ForceProof
        Forces at the limit.
    mechanism : MotionProof or None
        The motion that starts there; None if the load is unlimited, or no motion was found.
    gap : float
        Distance from `value`, which is proved to be held, to a share that is proved not to
        be, over 1 and the value; infinite if that proof is missing.
    """

    value: float
    forces: ForceProof
    mechanism: MotionProof | None
    gap: float

    def to_dict(self, program: Program) -> dict[str, Any]:
        """The evidence as JSON data: imbalance of the forces, moving parts, open interval."""
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
    """No limit is known.

    The reason `why` is "none" if it is proved that no share is held, "failed" if the solvers
    failed, and "time" if the time limit was reached.
    """

    why: Why


def gravity_wrench(program: Program, direction: Array) -> Array:
    """The weights as if gravity pointed along `direction`, shape (N, 6) [N]."""
    wrench = np.zeros((len(program.names), 6))
    wrench[:, :3] = (program.mass * program.free)[:, None] * program.g * direction
    return wrench


def finite(number: float) -> float | None:
    """A number for JSON: null instead of infinity, and never -0."""
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
    program: Program,
    wrench: Array,
    *,
    opening: Opening | None = None,
    most: float = UNLIMITED,
    shared: SharedCones | None = None,
    from_none: bool = False,
) -> Limit | NoLimit:
    """The largest share of further wrenches that contacts can hold.

    It may be negative. If it is positive, a share of 0 need not be held: the shares that are
    held are an interval, of which this is the upper end.

    Parameters
    ----------
    program : Program
        With its own load.
    wrench : ndarray, shape (N, 6)
        Force [N] and torque about the centre of mass [N x length unit] on each part.
    opening : Opening, optional
        ``Opening(spread(program))``, if the caller has it.
    most : float
        Shares looked at.
    shared : SharedCones, optional
        ``SharedCones(program)``, if the caller computes several limits of the program.
    from_none : bool
        Whether a share of 0 must be held: if small shares are not held, no larger share is tried.

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
    opening = opening or Opening(cone_problem(program))
    # its starts are far from forces that pull: 50 steps and no proof where the conic solver has 15
    large = len(program.part_a) > EXACT
    limited = bool(program.cohesion.any())  # only the conic program takes shear up to a force
    if most <= MODEST and not program.planar and large and not program.has_strength:
        own = _by_own_cones(program, wrench, most, shared)
        if own.closed or own.held >= most * (1 - NEARLY):
            return _limit(own, most)
    if most > MODEST:  # fewer steps of the solver, and an interval of numbers near 1
        near = find_limit(program, wrench, opening=opening, most=MODEST, shared=shared)
        known = isinstance(near, Limit) and np.isfinite(near.value)
        if known or (from_none and isinstance(near, NoLimit)):
            return near  # else larger shares may be held, though none of these is
    conic = _in_cones(program, opening, wrench, most)
    enough = conic.sides.gap <= SIDES_NEAR and large
    whole = conic.sides.held >= most * (1 - NEARLY)
    if conic.sides.closed or conic.sides.none or enough or whole:
        return _limit(conic.sides, most)
    sides = conic.sides
    if not limited:
        sides = sides.better(limit_sides(program, wrench, most, conic.across))
    if not sides.none and sides.gap > SIDES_APART:
        sharp = _in_cones(program, opening, wrench, most, CONIC_SHARP).sides
        sides = sides.better(sharp)
    return _limit(sides, most)


@dataclass(frozen=True, slots=True, eq=False)
class _Conic:
    """The bounds that the conic program proves, and the directions of friction in its solution."""

    sides: LimitSides
    across: list[Array]


@dataclass(frozen=True, eq=False)
class SharedCones:
    """Data that limits of a program under different wrenches share: its cones and a start.

    Attributes
    ----------
    program : Program
    """

    program: Program

    @cached_property
    def balance(self) -> ConeBalance:
        """Its cones without further wrenches."""
        none = np.zeros((len(self.program.names), 6))
        return balance_in_cones(self.program, self.program.load, none, MODEST)

    @cached_property
    def start(self) -> Start:
        """Near its forces without further wrenches."""
        return common_start(self.balance.cones)


def _by_own_cones(
    program: Program, wrench: Array, most: float, shared: SharedCones | None
) -> LimitSides:
    """Both sides by kilter's own interior point, as far as it goes, if a share of 0 is held."""
    balance = (shared or SharedCones(program)).balance.with_more(wrench, most)
    if shared is not None:
        sides = _stepwise(balance, wrench, shared.start)
        if sides.closed or sides.held >= most * (1 - NEARLY):
            return sides
    return _stepwise(balance, wrench, None)


def _stepwise(balance: ConeBalance, wrench: Array, start: Start | None) -> LimitSides:
    program, most = balance.program, balance.cones.most
    best = LimitSides()
    for step in iterates(balance.cones, BOLD, start):
        size = max(step.share, 1.0)
        if step.bound < -NEAR * size and step.y_rest <= NEAR * size:
            break  # not held as it is
        apart = min(abs(step.bound - step.share), most - step.share)
        if apart > NEAR * size:
            continue
        x, motion = step.balanced(), balance.motion(-step.y)
        if x is not None:
            best = best.better(held_at(program, wrench, step.share, *balance.decoded(x)))
        best = best.better(beyond_at(program, wrench, step.share, motion))
        closed = best.closed or best.held >= most * (1 - NEARLY)
        if closed and apart <= CLOSE * size:
            break
    return best


def _in_cones(
    program: Program,
    opening: Opening,
    wrench: Array,
    most: float,
    tolerance: float = CONIC,
) -> _Conic:
    """Both sides from a single conic program."""
    from kilter.solvers.clarabel import solve_conic

    wide = opening.wide
    answer = solve_conic(largest_load(wide, wrench, most), tolerance=tolerance)
    if not answer.found:
        return _Conic(LimitSides(none=answer.proves_none), [])
    value = float(answer.x[-1])
    along, aside = wide.decoded(answer.x[:-1])
    sides = held_at(program, wrench, value, along, aside)
    if value >= most * (1 - NEARLY):
        return _Conic(sides, [aside])
    problem = wide.problem
    motion = problem.motion(problem.over_weight(answer.multipliers[: len(problem.right)]))
    across = [aside, -slips_of(program, motion)]
    found = sides.better(beyond_at(program, wrench, value, motion))
    apart = found.gap > PROVED_APART and len(program.part_a) <= MENDED
    if not found.closed or apart:
        motion = opening.mended(motion)
        start = motion_share(program, wrench, motion)
        found = found.better(beyond_at(program, wrench, start, motion))
    return _Conic(found, across)


def _limit(sides: LimitSides, most: float) -> Limit | NoLimit:
    """The limit between both sides."""
    if sides.forces is None:
        return NoLimit("none" if sides.none else "failed")
    if sides.held >= most * (1 - NEARLY):
        return Limit(np.inf, sides.forces, None, 0.0)
    value = sides.held if abs(sides.held) > NO_SHARE else 0.0
    return Limit(value, sides.forces, sides.motion, sides.gap)
