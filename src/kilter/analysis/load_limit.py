"""The largest multiple of a further load that contacts hold, with forces and mechanism there.

    max t:  J^T f + w + t d = 0,  f in Coulomb's cones

The multipliers of this conic program are the motion that starts at the limit. If the conic solver
stops short of a proof, linear programs in fitted pyramids follow (`limit_sides`).

This is the associative limit. Above it no equilibrium exists. Up to it equilibrium forces exist,
but with friction other motions may still obey the contact law (`kilter.friction.answer`).

References
----------
M. Gilbert, C. Casapulla, H. M. Ahmed, Limit analysis of masonry block structures with
non-associative frictional joints using linear programming, 2006. M. C. Ferris, F. Tin-Loi,
Limit analysis of frictional block assemblies as a mathematical program with complementarity
constraints, 2001.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from kilter.analysis.analysis_tolerances import (
    BEYOND_LIMIT,
    CONIC_SHARP,
    LIMIT_AGREES,
    MOVES,
    NEARLY,
    NO_SHARE,
    PROVED_APART,
    SIDES_APART,
    SIDES_NEAR,
    UNLIMITED,
)
from kilter.analysis.decision.refined_proofs import balanced_proof
from kilter.arrays import Array
from kilter.errors import TimeLimitReached
from kilter.mechanics.balance_in_cones import ConeBalance, balance_in_cones
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.coulomb_cones import (
    LargestLoads,
    angles_across,
    cone_problem,
    pyramid,
    pyramid_forces,
)
from kilter.mechanics.forms import largest_share, scaled_problem
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.cone_interior_point import Start, common_start, iterates
from kilter.solvers.solver_tolerances import CONIC
from kilter.tell.record import InPython, OrNull, Record, Twist, key
from kilter.work import Work, stop_after

if TYPE_CHECKING:
    from kilter.solvers.problem import Solution


# Lower and upper bounds of a load limit, by linear programs in pyramids fitted to the cones.


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
    size, needed = max(abs(share), 1.0), -np.inf
    for step in BEYOND_LIMIT if np.isfinite(share) else ():
        above = share + step * size
        if above - start < needed:
            continue
        loaded = program.with_rows(applied=program.applied + above * wrench)
        proof = check_motion(loaded, motion)
        if proof.holds:
            return LimitSides(start=start, beyond=above, motion=proof)
        if proof.ratio > 0.0:  # the power grows from `start` on, the needed power hardly changes
            needed = SHORT_OF_PROOF * (above - start) / proof.ratio
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


SHORT_OF_PROOF = 0.9
"""Steps above a limit are left out if they give less than this share of the needed power [-]."""
MENDED = 2000
"""Largest number of rows for which a further program narrows bounds that already agree."""
EXACT = 500
"""Largest number of rows for which linear programs close a small gap of the conic program. With
more rows they take two hundred times as long for little gain."""
BOLD = 0.999
"""Fraction of the way to the boundary that an interior-point step takes [-]. A smaller fraction
needs more steps."""
NEAR, CLOSE = 1e-6, 1e-9
"""Distances between a share and the bound of its motion, relative to max(share, 1) [-]. Below
`NEAR` an iterate is worth a certificate; below `CLOSE` the steps end if both proofs meet."""
MODEST = 10.0
"""Upper end of the interval of shares that is tried first [-]."""

T = TypeVar("T")
Why = Literal["none", "failed", "time", "effort", "interrupted"]
WHYS: tuple[Why, ...] = ("none", "interrupted", "time", "effort", "failed")
"""The reasons in order of precedence if several limits have no value."""


class Limit(Record):
    """The largest multiple of a load that contacts hold, with proofs on both sides of it."""

    value: InPython[float]
    """Share t [-]: infinite without a limit, negative if only shares below 0 are held."""
    gap: OrNull
    """Distance from `value`, which is proved to be held, to a share that is proved not to be held,
    relative to max(abs(value), 1) [-]; infinite if the second proof is missing."""
    forces: InPython[ForceProof]
    """Forces at the limit."""
    motion: InPython[MotionProof | None]
    """The motion that starts at the limit; None without a limit or a proved motion."""
    program: InPython[Program]
    """Program of the forces, perhaps with further points of round edges after its rows."""

    @property
    @key
    def residual(self) -> float:
        """Largest imbalance of a part at the limit, divided by its weight [-]."""
        return self.forces.residual

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move beyond the limit."""
        return starting(self.program, self.motion)

    @property
    @key
    def mechanism(self) -> dict[str, Twist] | None:
        """Motion of each free part at the limit [length unit, rad]."""
        if self.motion is None:
            return None
        rows = zip(self.program.names, self.motion.motion, self.program.free, strict=True)
        return {name: row for name, row, free in rows if free}

    def __repr__(self) -> str:
        return f"Limit({self.value:.6g})"


@dataclass(frozen=True, slots=True)
class NoLimit:
    """The reason why a limit has no value.

    The reason `why` is "none" if it is proved that no share is held, "failed" if the solvers
    failed, "time" if the time limit was reached, "effort" if no work was left, and "interrupted" if
    the user ended the command.
    """

    why: Why


def least_limit(limits: Sequence[T | NoLimit], value: Callable[[T], Any]) -> T | NoLimit:
    """The least of the limits of groups that do not touch, which is that of all parts.

    If a group has no limit, the whole has none; the reason "none" is a proof, and precedes others.
    """
    whys = {limit.why for limit in limits if isinstance(limit, NoLimit)}
    for why in WHYS:
        if why in whys:
            return NoLimit(why)
    return min((limit for limit in limits if not isinstance(limit, NoLimit)), key=value)


@dataclass(slots=True, kw_only=True, eq=False)
class LimitSteps:
    """Base class of the steps of an answer, each of which computes a limit, under a time limit.

    `missing` has the reason for each requested limit that has no value. An answer at the time limit
    still has the limits of the steps that ended before it. So has an answer of a command that the
    user interrupts, if the command prints such answers (`keeps`).
    """

    work: Work
    tell: Callable[[str], None]
    keeps: bool = False
    interrupted: bool = False
    missing: dict[str, Why] = field(default_factory=dict)

    def limit(
        self, name: str, step: Callable[..., T | NoLimit | None], *arguments: Any
    ) -> T | None:
        """Run the step for a limit; if it has no value, return None and note the reason."""
        result = self.in_time(step, *arguments)
        if isinstance(result, NoLimit):
            self.missing[name] = result.why
            return None
        return result

    def in_time(self, step: Callable[..., T], *arguments: Any) -> T | NoLimit:
        """The result of a step, or the reason that the time limit or the user ended it."""
        if self.interrupted:
            return NoLimit("interrupted")
        try:
            with stop_after(self.work.seconds):
                result = step(*arguments)
        except TimeLimitReached:
            return NoLimit("time")
        except KeyboardInterrupt:
            if not self.keeps:
                raise
            self.interrupted = True
            return NoLimit("interrupted")
        # a solver that was cut short has no proof, which is no failure of the solver
        if isinstance(result, NoLimit) and result.why == "failed" and self.work.late:
            return NoLimit("time")
        return result


def gravity_wrench(program: Program, direction: Array) -> Array:
    """Weights of the free parts for gravity along a unit vector, world frame, shape (N, 6) [N]."""
    wrench = np.zeros((len(program.names), 6))
    wrench[:, :3] = (program.mass * program.free)[:, None] * program.g * direction
    return wrench


def finite(number: float) -> float | None:
    """A number for JSON: None if it is not finite, and 0.0 instead of -0.0."""
    return float(number) + 0.0 if np.isfinite(number) else None


def starting(program: Program, mechanism: MotionProof | None) -> list[str]:
    """Names of the parts that move in a mechanism."""
    if mechanism is None:
        return []
    size = part_sizes(program, mechanism.motion, per_radius=False)
    fast = size > MOVES * float(size.max(initial=0.0))
    return [n for n, moves in zip(program.names, fast & program.free, strict=True) if moves]


def with_more(program: Program, wrench: Array, share: float) -> Program:
    """Copy of a program with an additional load: `share` times the wrenches, shape (N, 6).

    Wrenches are in [N] and [N x length unit].
    """
    return program.with_rows(applied=program.applied + share * wrench)


def find_limit(
    program: Program,
    wrench: Array,
    *,
    most: float = UNLIMITED,
    shared: SharedCones | None = None,
    from_none: bool = False,
) -> Limit | NoLimit:
    """Compute the largest multiple of the given wrenches that contacts can hold beside the weight.

    The shares that contacts hold are an interval, and the result is its upper end. It may be
    negative. If it is positive, a share of 0 need not be in the interval.

    The result is a `NoLimit` with the reason "none" if it is proved that no share is held, or
    "failed" if the solvers give no proof.

    Arguments: `wrench` (N, 6) [N]; `most` [-]; `shared`: that of earlier limits of the program.

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
    shared = shared or SharedCones(program)
    large = len(program.part_a) > EXACT
    # with bonds, kilter's interior point starts too far from the forces that pull: it ends after 50
    # steps without a proof, and the conic solver needs 15
    near_start = not (program.planar or program.has_strength or shared.far)
    if most <= MODEST and large and near_start:
        bounds = _by_own_cones(wrench, most, shared)
        if bounds.closed or bounds.held >= most * (1 - NEARLY):
            return _limit(shared, bounds, most)
    if most > MODEST:  # shares near 1 need fewer steps of the solver
        near = find_limit(program, wrench, most=MODEST, shared=shared)
        known = isinstance(near, Limit) and np.isfinite(near.value)
        if known or (from_none and isinstance(near, NoLimit)):
            return near  # else larger shares may be held, although no share up to MODEST is
    return _limit(shared, _best_sides(shared, wrench, most), most)


def _best_sides(shared: SharedCones, wrench: Array, most: float) -> LimitSides:
    """Bounds of a load limit from the conic program, or from finer programs if the gap is large."""
    program = shared.program
    limited = program.has_limits  # only the conic program models limits of single forces
    conic = _in_cones(shared, wrench, most)
    large = len(program.part_a) > EXACT
    sides = conic.sides
    enough = sides.gap <= SIDES_NEAR and large
    whole = sides.held >= most * (1 - NEARLY)
    if sides.closed or sides.none or enough or whole:
        return sides
    if large:  # the linear programs take several times as long
        sides = sides.better(_in_cones(shared, wrench, most, CONIC_SHARP).sides)
        if sides.closed or sides.none:
            return sides
    if not limited:
        sides = sides.better(limit_sides(program, wrench, most, conic.across))
    if not sides.none and sides.gap > SIDES_APART and not large:
        sides = sides.better(_in_cones(shared, wrench, most, CONIC_SHARP).sides)
    return sides


@dataclass(frozen=True, slots=True, eq=False)
class _Conic:
    """Load bounds that a conic program proves, and the friction of its solution, (K, 3)."""

    sides: LimitSides
    across: list[Array]


@dataclass(eq=False)
class SharedCones:
    """Cones, starting point and mechanisms that the load limits of a program have in common."""

    program: Program
    far: bool = False
    """True if kilter's own interior-point method found no proof for an earlier limit."""
    mechanisms: list[Array] = field(default_factory=list)
    """Motions at earlier limits, shape (N, 6) each; each bounds the limits of other loads."""
    at_rest: ForceProof | None = None
    """Forces of an earlier limit of 0: they balance the base load alone."""

    @cached_property
    def opening(self) -> Opening:
        """The motion that opens every contact, and the matrices of the conic program."""
        return Opening(cone_problem(self.program))

    @cached_property
    def loads(self) -> LargestLoads:
        """Conic programs for the largest multiples of further loads."""
        return LargestLoads(self.opening.wide)

    def turned(self, down: Array) -> SharedCones:
        """The same for gravity along `down`, shape (3,), with the opening motion of this one."""
        turned = SharedCones(self.program.turned(down), self.far)
        turned.opening = self.opening.turned(down)
        return turned

    def beyond(self, wrench: Array, lowest: float = -np.inf) -> LimitSides:
        """The least upper bound of a limit, from `lowest`, that an earlier mechanism proves."""
        every = [motion_share(self.program, wrench, motion) for motion in self.mechanisms]
        shares = [share if share >= lowest else np.inf for share in every]
        if not shares or not np.isfinite(min(shares)):
            return LimitSides()
        least = int(np.argmin(shares))
        return beyond_at(self.program, wrench, shares[least], self.mechanisms[least])

    def known_limit(self, wrench: Array) -> Limit | None:
        """The limit 0 if the forces and the mechanisms of earlier limits prove it; else None."""
        if self.at_rest is None:
            return None
        sides = held_at(self.program, wrench, 0.0, self.at_rest.forces, self.at_rest.friction)
        sides = sides.better(self.beyond(wrench, 0.0))
        if sides.start > TOLERANCE or sides.forces is None:
            return None  # a mechanism that is not sharp is found anew
        return Limit(
            value=0.0,
            gap=sides.gap,
            forces=sides.forces,
            motion=sides.motion,
            program=self.program,
        )

    @cached_property
    def balance(self) -> ConeBalance:
        """The conic program for the balance of the parts under the base load alone."""
        none = np.zeros((len(self.program.names), 6))
        return balance_in_cones(self.program, self.program.load, none, MODEST)

    @cached_property
    def start(self) -> Start:
        """Starting point of the interior-point method, near forces that balance the base load."""
        return common_start(self.balance.cones)


def _by_own_cones(wrench: Array, most: float, shared: SharedCones) -> LimitSides:
    """Load bounds by kilter's own interior-point method; open if the base load is not held."""
    balance = shared.balance.with_more(wrench, most)
    for start in (shared.start, None):  # the common start may be too far from this wrench
        sides = _from_iterates(balance, wrench, start)
        if sides.closed or sides.held >= most * (1 - NEARLY):
            return sides
    shared.far = not np.isfinite(sides.held)
    return sides


def _from_iterates(balance: ConeBalance, wrench: Array, start: Start | None) -> LimitSides:
    """Best load bounds that the iterates of the interior-point method prove."""
    program, most = balance.program, balance.cones.most
    best = LimitSides()
    for step in iterates(balance.cones, BOLD, start):
        size = max(step.share, 1.0)
        if step.bound < -NEAR * size and step.y_rest <= NEAR * size:
            break  # a share of 0 is not held
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


def _in_cones(shared: SharedCones, wrench: Array, most: float, tolerance: float = CONIC) -> _Conic:
    """Bounds of a load limit by one conic program, with the friction of its solution."""
    from kilter.solvers.clarabel import solve_conic

    program, opening = shared.program, shared.opening
    wide = opening.wide
    answer = solve_conic(shared.loads.along(wrench, most), tolerance=tolerance)
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
    bounds = sides.better(beyond_at(program, wrench, value, motion))
    if not bounds.closed:
        bounds = bounds.better(shared.beyond(wrench))
    apart = bounds.gap > PROVED_APART and len(program.part_a) <= MENDED
    if not bounds.closed or apart:
        # the motion may violate contacts slightly; an opening motion, added to it, corrects this
        motion = opening.mended(motion)
        start = motion_share(program, wrench, motion)
        bounds = bounds.better(beyond_at(program, wrench, start, motion))
    return _Conic(bounds, across)


def _limit(shared: SharedCones, sides: LimitSides, most: float) -> Limit | NoLimit:
    """The load limit of proved bounds; `NoLimit` if not even the base load is proved to be held."""
    program = shared.program
    if sides.motion is not None and sides.closed:
        shared.mechanisms.append(sides.motion.motion)
    if sides.closed and abs(sides.held) <= NO_SHARE:
        shared.at_rest = sides.forces
    if sides.forces is None:
        return NoLimit("none" if sides.none else "failed")
    value, motion, gap = sides.held, sides.motion, sides.gap
    if value >= most * (1 - NEARLY):
        value, motion, gap = np.inf, None, 0.0
    elif abs(value) <= NO_SHARE:
        value = 0.0
    return Limit(value=value, gap=gap, forces=sides.forces, motion=motion, program=program)
