"""The worst margin over intervals of masses, centres of mass, friction and normals.

Friction. More of it only helps: the lowest coefficients are the worst. Exact.

Normals. A cone of half angle atan mu about any normal within an angle e of the given one has
that of half angle atan mu - e about the given one inside; where nothing is left, the contact
counts for nothing. Inner: safe, not always the worst case.

Masses and centres of mass. For one gravity the load is linear in the masses m_i and the
moments m_i d_i, and these lie in polytopes. The loads that are held are a convex cone, so
all are held if and only if the corners are: the worst margin is the least of the corners.
Exact, up to `CORNERS` of them. Above that, forces that follow the masses in proportion
(`kilter.mechanics.affine`), in pyramids inside Coulomb's cones. Inner.

An inner answer is a margin that every assembly within the intervals has.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from kilter.analysis.margins.load_limit import (
    NoLimit,
    find_limit,
    finite,
    gravity_wrench,
)
from kilter.analysis.margins.tilt import (
    TiltMargin,
    across_gravity,
    find_tilt_margin,
    first_directions,
)
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.analysis.turning_tolerances import (
    BALANCED,
    FOLLOWING_AGREES,
    UNLIMITED,
)
from kilter.arrays import Array, cross
from kilter.errors import InputError
from kilter.mechanics.affine import UncertainLoad, affine_forces, affine_imbalance
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import Scaled, scaled
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

if TYPE_CHECKING:
    from kilter.solvers.highs import Method

__all__ = ["CORNERS", "Ranges", "Uncertainty", "corner", "find_uncertainty", "weakened"]

Kind = Literal["exact", "inner"]

CORNERS = 32
"""Corners of the box of masses and centres up to which each is looked at."""
SIDES = 8
"""Sides of the pyramids inside the cones, in space."""
STEEP = 1e3
"""Tangents of a tilt, and shares of a load, above which forces that follow are not sought."""
SHOTS = 16
"""Directions looked at for the least tilt where forces follow."""
SIMPLEX = 30_000
"""Entries of the linear program up to which simplex is tried first, else interior point."""
LARGEST = 2_000_000
"""Entries of the linear program of forces that follow above which none is sought."""


@dataclass(frozen=True, slots=True)
class Ranges:
    """Intervals of what is not known exactly.

    Attributes
    ----------
    mass : (float, float)
        Factors, of every free part by itself [-].
    center : float
        Every coordinate of every centre of mass, plus or minus [length unit].
    mu : (float, float)
        Factors [-].
    normal_deg : float
        Every normal, in any direction [deg].

    Raises
    ------
    InputError
        If an interval is empty or out of range.
    """

    mass: tuple[float, float] = (1.0, 1.0)
    center: float = 0.0
    mu: tuple[float, float] = (1.0, 1.0)
    normal_deg: float = 0.0

    def __post_init__(self) -> None:
        _require_interval("mass range", self.mass, positive=True)
        _require_interval("mu range", self.mu, positive=False)
        if not 0 <= self.center < np.inf:
            raise InputError(f"com range is {self.center:g}", hint="give a length, 0 or more")
        if not 0 <= self.normal_deg < 90:
            raise InputError(
                f"normal tilt is {self.normal_deg:g} degrees", hint="give 0 or more, below 90"
            )


def _require_interval(what: str, ends: tuple[float, float], *, positive: bool) -> None:
    low, high = ends
    if not (np.isfinite(low) and np.isfinite(high)) or low < 0 or (positive and low == 0):
        raise InputError(
            f"{what} is {low:g} to {high:g}",
            hint=f"give factors {'above 0' if positive else 'of 0 or more'}, 0.9 1.1 for instance",
        )
    if low > high:
        raise InputError(f"{what} is {low:g} to {high:g}: it is empty", hint="give low, then high")


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """Margins that hold for every assembly within the intervals.

    Attributes
    ----------
    ranges : Ranges
    kind : {"exact", "inner"}
        Whether some assembly within them has just this margin, or none has less.
    held : bool
        Whether all are held as given; where inner, False says that it was not shown.
    tilt_deg : float or None
        None where not all are held, or loads are given.
    load_factor : (float, float) or None
        None where not asked for, or no factor is held by all.
    corners : int
        How many were looked at; 0 where forces follow.
    worst : tuple of (ndarray, ndarray), or None
        Mass factors, shape (N,), and shifts of the centres, shape (N, 3), at the least tilt.
    """

    ranges: Ranges
    kind: Kind
    held: bool
    tilt_deg: float | None
    load_factor: tuple[float, float] | None
    corners: int
    worst: tuple[Array, Array] | None

    def to_dict(self, program: Program) -> dict[str, Any]:
        """The worst case and where it is, as JSON data."""
        ranges, at = self.ranges, None
        if self.worst is not None:
            mass, shift = self.worst
            at = {
                name: {"mass_factor": float(mass[k]), "shift": (shift[k] + 0.0).tolist()}
                for k, name in enumerate(program.names)
                if program.free[k]
            }
        ends = self.load_factor
        return {
            "mass": list(ranges.mass),
            "com": ranges.center,
            "mu": list(ranges.mu),
            "normal_deg": ranges.normal_deg,
            "kind": self.kind,
            "held": self.held,
            "tilt_deg": self.tilt_deg,
            "load_factor": None if ends is None else [finite(end) for end in ends],
            "corners": self.corners,
            "worst": at,
        }


def weakened(program: Program, ranges: Ranges) -> Program:
    """The program with the least friction, and cones that all normals have inside."""
    contact = program.kind == CONTACT
    half = np.arctan(program.mu * ranges.mu[0]) - np.radians(ranges.normal_deg)
    mu = np.where(contact, np.tan(np.maximum(half, 0.0)), 0.0)
    return program.with_rows(mu=mu).taking(~contact | (half >= 0))


def corner(program: Program, factor: Array, shift: Array) -> Program:
    """The program with other masses and centres; given loads stay where they are in the world."""
    applied = program.applied.copy()
    applied[:, 3:] -= cross(shift, applied[:, :3])
    return program.with_rows(
        mass=program.mass * factor, center=program.center + shift, applied=applied
    )


def find_uncertainty(
    program: Program, ranges: Ranges, *, push: Array | None = None
) -> Uncertainty | None:
    """The worst tilt margin and load factor over the intervals; None: too large to say.

    Parameters
    ----------
    program : Program
    ranges : Ranges
    push : ndarray, shape (3,), optional
        Direction of a body force, for the load factor; else that of given loads.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> worst = find_uncertainty(program, Ranges(mu=(0.8, 1.2)))
    >>> worst.kind, round(float(np.tan(np.radians(worst.tilt_deg))), 6)
    ('exact', 0.4)
    """
    weak = weakened(program, ranges)
    parts = int(program.free.sum())
    per_part = (2 if ranges.mass[0] < ranges.mass[1] else 1) * (
        1 if ranges.center == 0 else 4 if program.planar else 8
    )
    exact = ranges.normal_deg == 0
    if per_part**parts <= CORNERS:
        return _by_corners(weak, ranges, push, "exact" if exact else "inner")
    return _by_following(weak, ranges, push)


def _by_corners(program: Program, ranges: Ranges, push: Array | None, kind: Kind) -> Uncertainty:
    """The least of the corners; where the numbers fail at one, nothing is shown of all."""
    tilt, factor, worst, held, count = np.inf, (-np.inf, np.inf), None, True, 0
    loaded = bool(program.applied.any())
    failed = False
    for mass, shift in _corners(program, ranges):
        count += 1
        one = corner(program, mass, shift)
        limits = _limits(one, push)
        if limits is None:
            failed, factor = True, (np.inf, -np.inf)
        else:
            factor = max(factor[0], limits[0]), min(factor[1], limits[1])
        still = (
            find_limit(one, np.zeros_like(one.applied), most=1.0)
            if loaded
            else find_tilt_margin(one)
        )
        if isinstance(still, NoLimit):
            held, failed = False, failed or still.why == "failed"
        elif isinstance(still, TiltMargin) and still.angle < tilt:
            tilt, worst = still.angle, (mass, shift)
    asked = push is not None or loaded
    return Uncertainty(
        ranges,
        "inner" if failed else kind,
        held,
        float(np.degrees(tilt)) if held and not loaded else None,
        factor if asked and factor[0] <= factor[1] else None,
        count,
        worst if held else None,
    )


def _corners(program: Program, ranges: Ranges) -> Iterator[tuple[Array, Array]]:
    """Mass factors and shifts of the centres at each corner of the box."""
    factors = sorted(set(ranges.mass))
    signs: list[tuple[float, ...]] = [(0.0,) if ranges.center == 0 else (-1.0, 1.0)] * 3
    if program.planar:
        signs[1] = (0.0,)
    shifts = [ranges.center * np.array(s) for s in itertools.product(*signs)]
    free = np.flatnonzero(program.free)
    for chosen in itertools.product(itertools.product(factors, shifts), repeat=len(free)):
        mass, shift = np.ones(len(program.names)), np.zeros((len(program.names), 3))
        for k, (factor, offset) in zip(free, chosen, strict=True):
            mass[k], shift[k] = factor, offset
        yield mass, shift


def _limits(program: Program, push: Array | None) -> tuple[float, float] | None:
    """Least and greatest load factor, empty where none is held; None where the numbers fail."""
    if push is None and not program.applied.any():
        return -np.inf, np.inf
    base, wrench = program, program.applied
    if push is not None:
        wrench = gravity_wrench(program, push)
    else:
        base = program.with_rows(applied=np.zeros_like(program.applied))
    least, greatest = (find_limit(base, sign * wrench) for sign in (-1.0, 1.0))
    if isinstance(least, NoLimit) or isinstance(greatest, NoLimit):
        return None if NoLimit("failed") in (least, greatest) else (np.inf, -np.inf)
    return -least.value, greatest.value


def _by_following(program: Program, ranges: Ranges, push: Array | None) -> Uncertainty | None:
    rays = pyramid(program, SIDES)
    problem = scaled(rays)
    unknowns = _unknowns(rays, ranges)
    if problem.matrix.nnz * (1 + 2 * len(unknowns)) > LARGEST:
        return None
    following = _Following(rays, problem, unknowns, ranges)
    loaded = bool(program.applied.any())
    still = following.reach(np.zeros_like(program.applied), None, 1.0)
    factor = None
    if push is not None or loaded:
        wrench = None if push is not None else program.applied
        ends = [following.reach(wrench, push, UNLIMITED, sign) for sign in (-1.0, 1.0)]
        if ends[0] is not None and ends[1] is not None:
            factor = (-ends[0], ends[1])
    tilt = None if loaded or still is None else following.tilt()
    degrees = None if tilt is None else float(np.degrees(tilt))
    return Uncertainty(ranges, "inner", still is not None, degrees, factor, 0, None)


def _unknowns(program: Program, ranges: Ranges) -> list[tuple[int, int]]:
    """(part, what): what is 3 for its mass, else the axis of its centre."""
    axes = (0, 2) if program.planar else (0, 1, 2)
    what = [3] if ranges.mass[0] < ranges.mass[1] else []
    what += list(axes) if ranges.center > 0 else []
    return [(int(k), w) for k in np.flatnonzero(program.free) for w in what]


class _Following:
    """Limits with forces that follow masses and centres in proportion."""

    def __init__(
        self, program: Program, problem: Scaled, unknowns: list[tuple[int, int]], ranges: Ranges
    ) -> None:
        self.program, self.problem, self.unknowns = program, problem, unknowns
        self.middle = 0.5 * (ranges.mass[0] + ranges.mass[1])
        self.spread = 0.5 * (ranges.mass[1] - ranges.mass[0])
        self.moment = ranges.center * ranges.mass[1]

    def _sides(self, direction: Array) -> Array:
        """What each unknown adds to the load of a body force along a direction, (K, rows)."""
        program = self.program
        size = program.mass * program.g
        sides = []
        for part, what in self.unknowns:
            wrench = np.zeros((len(program.names), 6))
            if what == 3:
                wrench[part, :3] = self.spread * size[part] * direction
            else:
                wrench[part, 3:] = self.moment * size[part] * cross(np.eye(3)[what], direction)
            sides.append(self.problem.scaled_load(wrench))
        return np.array(sides).reshape(len(sides), len(self.problem.right))

    def reach(
        self, wrench: Array | None, push: Array | None, most: float, sign: float = 1.0
    ) -> float | None:
        """The largest share of given wrenches, or of a body force, held for all; None: none is."""
        program = self.program
        down = program.down
        base = self.middle * gravity_wrench(program, down)
        if wrench is None or not program.applied.any():
            base = base + program.applied
        if push is not None:
            given = self.middle * sign * gravity_wrench(program, push)
            turns = sign * self._sides(push)
        else:
            assert wrench is not None
            given, turns = sign * wrench, np.zeros((len(self.unknowns), len(self.problem.right)))
        load = UncertainLoad(
            self.problem.scaled_load(base),
            self.problem.scaled_load(given),
            self._sides(down),
            turns,
        )
        return self._solved(load, most)

    def _solved(self, load: UncertainLoad, most: float) -> float | None:
        from kilter.solvers.highs import solve_linear

        program = affine_forces(self.problem, load, min(most, STEEP))
        methods: tuple[Method, ...] = ("simplex", "interior")
        if program.matrix.nnz > SIMPLEX:
            methods = ("interior", "simplex")
        for method in methods:
            answer = solve_linear(program, method=method)
            if answer.outcome == "infeasible":
                return None
            if not answer.optimal:
                continue
            if affine_imbalance(self.problem, load, answer.x) <= BALANCED:
                share = float(answer.x[0])
                return np.inf if most > STEEP and share >= STEEP * (1 - FOLLOWING_AGREES) else share
        return None

    def tilt(self) -> float | None:
        """A turn of gravity [rad] up to which every direction is held for all."""
        basis = across_gravity(self.program)

        def shoot(direction: Array) -> SupportPoint | None:
            share = self.reach(None, direction @ basis, STEEP)
            return None if share is None else SupportPoint(share * direction, direction, share)

        first = first_directions(len(basis))
        face = nearest_face(shoot, first, agree=FOLLOWING_AGREES, limit=SHOTS)
        return None if face is None or face.failed else float(np.arctan(face.inner))
