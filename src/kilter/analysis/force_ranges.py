"""Ranges of contact forces: the least and the greatest force between two parts in equilibrium.

    min and max of  c.f  over  { f in Coulomb's cones,  J^T f + w = 0 }

A statically indeterminate assembly has many equilibria, so the forces of one of them say little.
Each end has two sides: forces in the cones that attain the value, checked as a proof of
equilibrium, and a bound that no forces pass. The bound is that of the multipliers of a linear
program with outer pyramids (`kilter.solvers.problem`), for forces up to `MOST` weights of the free
parts at each point. The set of equilibria is convex: where both sides agree, larger forces could
pass the bound at most by the same gap over `MOST`, times their size. Pyramids get the directions of
the friction at the last optimum, until both sides agree. An end is unbounded if forces in the cones
exist that balance each other alone and push: a squeeze.

References
----------
J. Heyman, *The Stone Skeleton*, International Journal of Solids and Structures 2, 1966: least and
greatest thrust of an arch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.analysis_tolerances import RANGE_AGREES
from kilter.arrays import TINY, Array, Index, Mask
from kilter.errors import InputError
from kilter.mechanics.certificate import ForceProof, check_forces, part_sizes
from kilter.mechanics.clusters import clusters
from kilter.mechanics.coulomb_cones import angles_across, pyramid, pyramid_forces
from kilter.mechanics.forms import ScaledProblem, equilibrium, scaled_problem
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import LinearProgram, Solution
from kilter.tell.record import InPython, Record, Vector, key
from kilter.units import metres_per_unit

EVEN = 8
"""Number of rays, and of sides, of each pyramid at even angles."""
ROUNDS = 12
"""Maximum number of rounds; each solves an inner and an outer program for each end."""
MOST = 100.0
"""Largest force at a contact point for which the bounds hold [weight of the free parts]."""
BALANCED = 1e-9
"""Largest imbalance of a part by a squeeze, over the sum of its forces [-]."""
CORRECTIONS = 4
"""Largest number of steps that balance the forces of an interior point."""
REGULAR = 1e-15
"""Regularisation of the equations that balance the forces, over their largest entry [-]."""
ROUNDED = 1e-12
"""Smaller values count as 0 [weight of the free parts]."""
LARGE = 40_000
"""Entries of the matrix of a program from which an interior point solves it: simplex steps take
minutes there, since most vertices are degenerate."""
NARROWER = 0.5
"""Largest gap of a round over that of the round before, above which an interior point ends [-]."""
SQUEEZED = 1e-6
"""Least gain of a squeeze, whose largest force is 1 [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class EndEvidence:
    """Evidence of an end in a cluster: forces that attain it, and a motion that bounds it."""

    rows: Index
    """Rows of the cluster in the program of the assembly, shape (k,)."""
    forces: ForceProof
    """Forces of these rows."""
    motion: Array
    """Motion of all parts; parts outside of the cluster rest, shape (N, 6)."""


class ForceEnd(Record):
    """An end of a range: the value that checked forces attain, and a bound that none passes."""

    value: float | None
    """Force of an equilibrium [N]; null if the end is unbounded: the parts can squeeze each other.
    """
    bound: float | None
    """No equilibrium has a force beyond this [N]; null if no bound is known."""
    proved: bool
    """Whether value and bound agree, or a squeeze is proved."""
    evidence: InPython[tuple[EndEvidence, ...] | None] = None
    """Evidence of each cluster that matters; None if there is none."""


class ForceRange(Record):
    """The least and the greatest force between two parts, or on a held part."""

    parts: tuple[str, ...]
    """Names of the two parts, or of the held part."""
    along: Vector | None
    """Axis of the force; null for the sum of the normal forces, and for a moment."""
    moment: Vector | None
    """Axis of the moment on the last part about its centre of mass; null for a force."""
    least: ForceEnd
    """The least force [N]; along an axis, the force on the second part. A moment is in N m."""
    greatest: ForceEnd
    """The greatest force [N] or moment [N m]."""
    weight: InPython[float]
    """Weight of the free parts that touch each other there [N], for a moment times the largest
    lever [N m]: smaller numbers are rounding."""

    @property
    def is_single(self) -> bool:
        """Whether all equilibria have the same value."""
        low, high = self.least.value, self.greatest.value
        return None not in (low, high) and bool(high - low <= RANGE_AGREES * self.weight)  # type: ignore[operator]

    @property
    @key
    def sentence(self) -> str:
        """The range in words."""
        names, unit = " - ".join(self.parts), "N" if self.moment is None else "N m"
        low, high = self.least.value, self.greatest.value
        if (low is None and not self.least.proved) or (high is None and not self.greatest.proved):
            return f"{names}: no range is known"
        if low is None and high is None:
            return f"{names}: any value: a squeeze of any size is in balance"
        if high is None:
            return (
                f"{names}: at least {low:.5g} {unit}, without an upper limit: the parts can squeeze"
            )
        if low is None:
            return (
                f"{names}: at most {high:.5g} {unit}, without a lower limit: the parts can squeeze"
            )
        if self.is_single:
            return f"{names}: {(low + high) / 2:.5g} {unit}"
        return f"{names}: {low:.5g} to {high:.5g} {unit}"


def pressed_pairs(program: Program) -> list[tuple[int, ...]]:
    """Pairs of parts with contact rows, by index, in order."""
    rows = program.kind == CONTACT
    pairs = np.unique(np.column_stack([program.part_a[rows], program.part_b[rows]]), axis=0)
    return [(int(a), int(b)) for a, b in pairs]


def force_ranges(
    program: Program,
    about: Sequence[tuple[int, ...]],
    along: Array | None = None,
    moment: Array | None = None,
) -> list[ForceRange]:
    """Compute ranges of the forces between pairs of parts, or on held parts, or of their moments.

    Arguments: `about`: two parts, or a single held part, by index; `along`: axis of the force,
    shape (3,); `moment`: axis of the moment on the last part about its centre of mass, shape (3,).
    Without an axis the normal forces are added. Each end keeps its evidence.

    Raises `InputError` if an entry has no contact, or contacts are bonded.
    """
    if program.cohesion.any() or program.pull.any():
        raise InputError("ranges of forces are not computed for bonds", hint="leave the bonds out")
    parted = clusters(program)
    searches = [EndSearch(cluster.program) for cluster in parted]
    found = []
    for parts in about:
        of_parts = rows_between(program, parts)
        if not of_parts.any():
            names = " and ".join(repr(program.names[part]) for part in parts)
            raise InputError(f"{names} have no contact", hint="name two parts that touch")
        if not any(of_parts[cluster.rows].any() for cluster in parted):
            names = " and ".join(repr(program.names[part]) for part in parts)
            raise InputError(
                f"the force between held parts is not determined: {names}",
                hint="name a part that is free",
            )
        ends, weight = [ForceEnd(value=0.0, bound=0.0, proved=True)] * 2, 0.0
        pieces: tuple[list[EndEvidence | None], ...] = ([], [])
        for cluster, search in zip(parted, searches, strict=True):
            rows = of_parts[cluster.rows]
            if rows.any():
                gain, lever = gain_of(cluster.program, rows, parts, along, moment), 1.0
                if moment is not None:
                    lever = float(np.abs(gain).max(initial=TINY))
                size = lever * (1.0 if moment is None else metres_per_unit(program.units))
                for side, sense in enumerate((-1, 1)):
                    ends[side] = added(ends[side], search.end(gain / lever, sense), size)
                    pieces[side].append(search.evidence(cluster.rows, lever))
                weight += search.weight * size
        ends = [
            replace(end, evidence=None if None in of_end else tuple(filter(None, of_end)))
            for end, of_end in zip(ends, pieces, strict=True)
        ]
        named = tuple(program.names[part] for part in parts)
        found.append(
            ForceRange(
                parts=named, along=along, moment=moment, least=ends[0], greatest=ends[1],
                weight=weight,
            )
        )  # fmt: skip
    return found


def rows_between(program: Program, parts: tuple[int, ...]) -> Mask:
    """Mask of the contact rows between two parts, or of all contact rows of a single part."""
    a, b = program.part_a, program.part_b
    if len(parts) == 1:
        chosen = (a == parts[0]) | (b == parts[0])
    else:
        chosen = ((a == parts[0]) & (b == parts[1])) | ((a == parts[1]) & (b == parts[0]))
    mask: Mask = chosen & (program.kind == CONTACT)
    return mask


def gain_of(
    program: Program,
    rows: Mask,
    parts: tuple[int, ...],
    along: Array | None,
    moment: Array | None,
) -> Array:
    """Vector of each row whose product with its force is the value of a range, (K, 3)."""
    if along is None and moment is None:
        return np.where(rows[:, None], program.normal, 0.0)
    sign = np.where(program.part_b == parts[-1], 1.0, -1.0)
    arms = program.point - program.center[parts[-1]]
    axis = along if moment is None else np.cross(moment, arms)
    return np.where(rows[:, None], sign[:, None] * axis, 0.0)


def added(first: ForceEnd, second: ForceEnd, unit: float = 1.0) -> ForceEnd:
    """The end of the sum of two independent forces, of which the second is in another unit."""
    values, bounds = (first.value, second.value), (first.bound, second.bound)
    return ForceEnd(
        value=None if None in values else values[0] + unit * values[1],  # type: ignore[operator]
        bound=None if None in bounds else bounds[0] + unit * bounds[1],  # type: ignore[operator]
        proved=first.proved and second.proved,
    )


class EndSearch:
    """The search for ends of ranges in a cluster; programs at even angles are kept.

    - `forces`: the forces that attain the value of the last end, or None;
    - `rays`, `multipliers`: pyramids whose multipliers prove its bound, or None.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.weight = float(program.weight[program.free].sum())
        self.forces: ForceProof | None = None
        self.rays: ScaledProblem | None = None
        self.multipliers = np.empty(0)
        self._kept: dict[bool, _Pyramids] = {}

    def end(self, gain: Array, sense: int) -> ForceEnd:
        """The greatest value of `sense` times gain.f over all equilibria, as an end of a range.

        Arguments: `gain` (K, 3): vector of each row whose product with its force counts.
        """
        value, bound, gap = -np.inf, np.inf, np.inf
        self.forces = self.rays = None
        guesses: list[Array] = []
        for number in range(1 if self.program.planar else ROUNDS):
            for outer in (True, False):
                # programs without guesses are kept, and go on from their last basis
                pyramids = self._pyramids(outer, guesses if number else [])
                found = pyramids.best(sense * gain)
                if found.value > value:
                    value, self.forces = found.value, found.forces
                if outer and found.bound < bound:
                    bound, self.multipliers = found.bound, found.multipliers
                    self.rays = pyramids.problem
                if found.large and self._pyramids(False, guesses).can_squeeze(sense * gain):
                    return ForceEnd(value=None, bound=None, proved=True)
                if bound - value <= RANGE_AGREES * self.weight:
                    break
                if found.across is not None and not self.program.planar:
                    entering = pyramids.entering(sense * gain, found.multipliers)
                    guesses += [angles_across(self.program, x) for x in (found.across, entering)]
            ends = pyramids.is_large and bound - value > NARROWER * gap
            gap = bound - value
            if ends or gap <= RANGE_AGREES * self.weight:
                break
        if not np.isfinite(value):
            return ForceEnd(value=None, bound=None, proved=False)
        value = 0.0 if abs(value) <= ROUNDED * self.weight else value
        return ForceEnd(
            value=sense * value,
            bound=sense * bound if np.isfinite(bound) else None,
            proved=bool(bound - value <= RANGE_AGREES * self.weight),
        )

    def evidence(self, rows: Index, lever: float) -> EndEvidence | None:
        """Evidence of the last end, whose gain was over `lever`; `rows` (k,): rows of the cluster.

        Returns None for an end without a limit, or without a solution.
        """
        if self.forces is None or self.rays is None:
            return None
        motion = np.zeros((len(self.program.names), 6))
        moved = self.rays.motion(self.rays.over_weight(self.multipliers))
        motion[self.program.free] = lever * moved[self.program.free]
        return EndEvidence(rows, self.forces, motion)

    def _pyramids(self, outer: bool, guesses: list[Array]) -> _Pyramids:
        """Programs with pyramids at even angles and at guesses; those without guesses are kept."""
        if outer in self._kept and not guesses:
            return self._kept[outer]
        even = np.tile(2 * np.pi * np.arange(EVEN) / EVEN, (len(self.program.rough), 1))
        angles = None if self.program.planar else np.column_stack([even, *guesses])
        made = _Pyramids(self.program, pyramid(self.program, outer=outer, angles=angles), MOST)
        if not guesses:
            self._kept[outer] = made
        return made


@dataclass(frozen=True, slots=True)
class _Best:
    """The optimum of a program: checked value, upper bound, forces, multipliers of the balance.

    `across` (K, 3): forces across the contacts, None without a point; `large`: whether a force
    reaches half of the largest one of the program.
    """

    value: float
    bound: float
    across: Array | None = None
    large: bool = False
    forces: ForceProof | None = None
    multipliers: Array = field(default_factory=lambda: np.empty(0))


class _Pyramids:
    """A linear program for forces in pyramids, whose gain changes."""

    def __init__(self, program: Program, rays: Program, most: float) -> None:
        from kilter.solvers.highs import KeptProgram

        self.program, self.rays = program, rays
        self.problem = scaled_problem(rays)
        self.unit = self.problem.forces(np.ones(len(rays.part_a)))
        linear = equilibrium(self.problem)
        limit = most * float(program.weight[program.free].sum()) / self.unit
        lower, upper = np.maximum(linear.lower, -limit), np.minimum(linear.upper, limit)
        self.limited = np.isfinite(linear.upper)
        self.kept = KeptProgram(replace(linear, lower=lower, upper=upper))

    def _cost(self, gain: Array) -> Array:
        """Cost of each ray: minus its gain per scaled unit of force."""
        of_rays = gain[_source_rows(self.program, self.rays)]
        cost: Array = -np.einsum("ki,ki->k", of_rays, self.rays.normal) * self.unit
        return cost

    def best(self, gain: Array) -> _Best:
        """The greatest gain; its value is -inf if the forces leave the cones or do not balance."""
        answer, x = self._solved(self._cost(gain))
        if not answer.found:
            return _Best(-np.inf, np.inf)
        along, across = pyramid_forces(self.program, self.rays, self.problem.forces(x))
        proof = check_forces(self.program, along, across)
        total = proof.forces[:, None] * self.program.normal + proof.friction
        value = float(np.einsum("ki,ki->", gain, total)) if proof.holds else -np.inf
        large = (np.abs(x) > self.kept.program.upper / 2)[~self.limited].any()
        return _Best(value, -answer.bound, across, bool(large), proof, answer.multipliers)

    @property
    def is_large(self) -> bool:
        """Whether an interior point solves the program."""
        return bool(self.kept.program.matrix.nnz >= LARGE)

    def _solved(self, cost: Array) -> tuple[Solution, Array]:
        """The answer for a cost (n,), and its point (n,), which of an interior point is balanced.

        A small program goes on from its last basis.
        """
        from kilter.solvers.highs import solve_linear

        if self.is_large:
            linear = replace(self.kept.program, cost=cost)
            answer = solve_linear(linear, method="interior")
            if answer.found:
                return answer, _balanced(linear, answer.x)
        answer = self.kept.solve(cost)
        return answer, answer.x

    def entering(self, gain: Array, multipliers: Array) -> Array:
        """Direction across each contact along which a force would gain most, shape (K, 3)."""
        motion = self.problem.motion(self.problem.over_weight(multipliers))
        along = np.einsum("ki,ki->k", gain, self.program.normal)
        across = gain - along[:, None] * self.program.normal
        rows = np.arange(len(gain))
        entering: Array = across + self.program.slips(motion, rows)
        return entering

    def can_squeeze(self, gain: Array) -> bool:
        """Whether forces that balance each other alone have a gain; none exceeds 1 unit."""
        from kilter.solvers.highs import KeptProgram

        linear, zero = self.kept.program, np.zeros(len(self.problem.right))
        one = np.where(self.limited, 0.0, 1.0)
        squeeze = replace(
            linear, cost=self._cost(gain) / self.problem.unit, row_lower=zero, row_upper=zero,
            lower=np.where(linear.lower < 0, -one, 0.0), upper=one,
        )  # fmt: skip
        answer = KeptProgram(squeeze).solve()
        if not answer.found or -squeeze.objective(answer.x) <= SQUEEZED:
            return False
        forces = self.problem.forces(np.clip(answer.x, squeeze.lower, squeeze.upper))
        along, across = pyramid_forces(self.program, self.rays, forces)
        left = part_sizes(self.program, self.program.wrenches(along, across), per_radius=True)
        pressed = self.program.force_sums(along, across)
        return bool((left <= BALANCED * pressed)[self.program.free].all())


def _balanced(linear: LinearProgram, x: Array) -> Array:
    """Forces near x (n,) that are in balance, since an interior point balances them to 1e-8 only.

    Each step is the correction of least squares. The inverse forces weight it, so that it changes
    each force by about the same share of itself, and nearly all of them still push.
    """
    from scipy.sparse.linalg import splu

    matrix = linear.matrix
    for _ in range(CORRECTIONS):
        x = np.clip(x, linear.lower, linear.upper)
        left = linear.row_lower - matrix @ x
        if np.abs(left).max() <= ROUNDED:
            break
        normal = csc_array((matrix * np.abs(x)) @ matrix.T)
        normal.setdiag(normal.diagonal() + REGULAR * normal.diagonal().max())
        factor = splu(normal, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        x = x + np.abs(x) * (matrix.T @ factor.solve(left))
    return x


def _source_rows(program: Program, rays: Program) -> Index:
    """Row of the program for each row of its pyramids, as `pyramid` orders them."""
    rough = program.rough
    if not len(rough):
        return np.arange(len(program.part_a))
    smooth = np.flatnonzero(program.mu <= 0)
    return np.concatenate(
        [smooth, np.repeat(rough, (len(rays.part_a) - len(smooth)) // len(rough))]
    )
