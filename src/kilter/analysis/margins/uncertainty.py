"""The worst margin over intervals of uncertain masses, centres of mass, friction and normals.

Friction. More of it only helps: the lowest coefficients are the worst. Exact.

Normals. A cone of half angle atan mu about any normal within an angle e of the given normal has
a cone of half angle atan mu - e about the given normal inside. If no cone is left, the contact
counts for nothing. Inner: safe, not always the worst case.

Masses and centres of mass. For each gravity the load is linear in the masses m_i and the
moments m_i d_i, and these lie in polytopes. The loads that are held are a convex cone, so
all are held if and only if the corners are: the worst margin is the least of the corners.
Exact, up to `CORNERS` of them. Above that, forces that follow the masses in proportion
(`kilter.mechanics.forms`), in pyramids inside Coulomb's cones. Inner.

An inner answer is a margin that every assembly within the intervals has.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import (
    UNLIMITED,
)
from kilter.analysis.load_limit import (
    NoLimit,
    Why,
    find_limit,
    gravity_wrench,
)
from kilter.analysis.margins.tilt import (
    FollowingForces,
    TiltMargin,
    Unknowns,
    find_tilt_margin,
)
from kilter.arrays import Array, cross
from kilter.contact.friction_coefficients import certain_friction
from kilter.errors import InputError
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.tell.record import Ends, Record, Vector

Kind = Literal["exact", "inner"]

CORNERS = 32
"""Largest number of corners of the box of masses and centres for which every corner is solved."""
SIDES = 8
"""Number of sides of the pyramids inside the friction cones, in space."""
LARGEST = 2_000_000
"""Largest number of matrix entries for which the program of following forces is solved."""


@dataclass(frozen=True, slots=True)
class Ranges:
    """Intervals of uncertain data: masses, centres of mass, friction and contact normals.

    Raises
    ------
    InputError
        If an interval is empty or out of range.
    """

    mass: tuple[float, float] = (1.0, 1.0)
    """Factors, of every free part by itself [-]."""
    center: float = 0.0
    """Every coordinate of every centre of mass, plus or minus [length unit]."""
    mu: tuple[float, float] = (1.0, 1.0)
    """Factors [-]."""
    normal_deg: float = 0.0
    """Every normal, in any direction [deg]."""

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
    """Reject an interval of factors that is infinite, negative or reversed."""
    low, high = ends
    if not (np.isfinite(low) and np.isfinite(high)) or low < 0 or (positive and low == 0):
        raise InputError(
            f"{what} is {low:g} to {high:g}",
            hint=f"give factors {'above 0' if positive else 'of 0 or more'}, 0.9 1.1 for instance",
        )
    if low > high:
        raise InputError(
            f"{what} is {low:g} to {high:g}: the interval is empty", hint="give low, then high"
        )


class WorstData(Record):
    """Mass factor and shift of the centre of mass of a part in the worst case."""

    mass_factor: float
    """Mass over its stated value [-]."""
    shift: Vector
    """Shift of the centre of mass [length unit]."""


class Uncertainty(Record):
    """Limits for the worst case of inexact data."""

    mass: tuple[float, float]
    """Factors of the mass of every free part [-]."""
    com: float
    """Shift of every centre of mass, plus or minus along each axis [length unit]."""
    mu: tuple[float, float]
    """Factors of every friction coefficient [-]."""
    normal_deg: float
    """Turn of every normal, in any direction [deg]."""
    kind: Kind
    """Whether some assembly within the intervals has just this margin, or none has less."""
    held: bool
    """Whether all are held as given; if the bound is inner, False means that it was not proved."""
    tilt_deg: float | None
    """[deg]; None if not all are held, or with loads."""
    load_factor: Ends | None
    """Least and greatest load factor; None if it was not requested, or all hold no factor."""
    missing: dict[str, Why]
    """Requested values of "held", "tilt" and "load_factor" that are missing, and why: "none", some
    are not held, or no following forces hold all (inner)."""
    corners: int
    """Number of corners; 0 if the forces follow the masses."""
    worst: dict[str, WorstData] | None
    """The data at the least tilt, by part."""


def weakened(program: Program, ranges: Ranges) -> Program:
    """Copy of a program with the least friction, and cones that fit inside for all normals."""
    contact = program.kind == CONTACT
    least = certain_friction((program.mu + program.doubt) * ranges.mu[0], program.doubt)
    half = np.arctan(least) - np.radians(ranges.normal_deg)
    mu = np.where(contact, np.tan(np.maximum(half, 0.0)), 0.0)
    weak = program.with_rows(mu=mu)
    return weak.taking(~contact | ((half >= 0) & weak.force_rows.certain))


def corner(program: Program, factor: Array, shift: Array) -> Program:
    """Copy of a program with scaled masses and shifted centres.

    Given loads keep their places in the world.
    """
    applied = program.applied.copy()
    applied[:, 3:] -= cross(shift, applied[:, :3])
    return program.with_rows(
        mass=program.mass * factor, center=program.center + shift, applied=applied
    )


def find_uncertainty(
    program: Program, ranges: Ranges, *, push: Array | None = None
) -> Uncertainty | None:
    """The worst tilt margin and load factor over the intervals; None for too large a program.

    Arguments: `push` (3,): direction of a body force, for the load factor; else that of given
    loads.

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
    """Worst margins over all corners of the intervals; no value if a solver fails at a corner."""
    tilt, factor, worst, count = np.inf, (-np.inf, np.inf), None, 0
    asked, loaded = push is not None or bool(program.applied.any()), bool(program.applied.any())
    missing: dict[str, Why] = {}
    for mass, shift in _corners(program, ranges):
        count += 1
        changed = corner(program, mass, shift)
        limits = _limits(changed, push)
        if isinstance(limits, NoLimit):
            _add(missing, ("load_factor",), limits)
        else:
            factor = max(factor[0], limits[0]), min(factor[1], limits[1])
        still = (
            find_limit(changed, np.zeros_like(changed.applied), most=1.0)
            if loaded
            else find_tilt_margin(changed)
        )
        if isinstance(still, NoLimit):
            _add(missing, ("held",) if loaded else ("held", "tilt"), still)
        elif isinstance(still, TiltMargin) and still.angle < tilt:
            tilt, worst = still.angle, (mass, shift)
    if factor[0] > factor[1]:
        _add(missing, ("load_factor",), NoLimit("none"))
    held = "held" not in missing
    return _uncertainty(
        ranges,
        kind="inner" if "failed" in missing.values() else kind,
        held=held,
        tilt_deg=float(np.degrees(tilt)) if held and not loaded else None,
        load_factor=factor if asked and "load_factor" not in missing else None,
        missing=missing,
        corners=count,
        worst=None if worst is None or not held else _worst(program, *worst),
    )


def _uncertainty(ranges: Ranges, **limits: Any) -> Uncertainty:
    """The answer for given intervals, with its limits."""
    return Uncertainty(
        mass=ranges.mass,
        com=ranges.center,
        mu=ranges.mu,
        normal_deg=ranges.normal_deg,
        **limits,
    )


def _worst(program: Program, mass: Array, shift: Array) -> dict[str, WorstData]:
    """Mass factors, shape (N,), and shifts of the centres, shape (N, 3), of the free parts."""
    return {
        program.names[k]: WorstData(mass_factor=float(mass[k]), shift=shift[k])
        for k in np.flatnonzero(program.free)
    }


def _add(missing: dict[str, Why], names: tuple[str, ...], why: NoLimit) -> None:
    """Record the reason why some values are missing; "none" outweighs "failed"."""
    for name in names:
        if missing.get(name) != "none":
            missing[name] = why.why


def _corners(program: Program, ranges: Ranges) -> Iterator[tuple[Array, Array]]:
    """Yield mass factors and shifts of the centres for each corner of the intervals."""
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


def _limits(program: Program, push: Array | None) -> tuple[float, float] | NoLimit:
    """Least and greatest load factor that hold; no limit if none holds or the solver fails."""
    if push is None and not program.applied.any():
        return -np.inf, np.inf
    base, wrench = program, program.applied
    if push is not None:
        wrench = gravity_wrench(program, push)
    else:
        base = program.with_rows(applied=np.zeros_like(program.applied))
    least, greatest = (find_limit(base, sign * wrench) for sign in (-1.0, 1.0))
    if isinstance(least, NoLimit) or isinstance(greatest, NoLimit):
        return NoLimit("failed" if NoLimit("failed") in (least, greatest) else "none")
    return -least.value, greatest.value


def _by_following(program: Program, ranges: Ranges, push: Array | None) -> Uncertainty | None:
    """Worst margins proved by forces affine in the masses; None for too large a program."""
    rays = pyramid(program, SIDES)
    problem = scaled_problem(rays)
    unknowns = _unknowns(rays, ranges)
    if problem.matrix.nnz * (1 + 2 * len(unknowns)) > LARGEST:
        return None
    following = FollowingForces(rays, problem, unknowns, mass=ranges.mass, center=ranges.center)
    loaded = bool(program.applied.any())
    missing: dict[str, Why] = {}
    still = following.reach(None, np.zeros(3), 1.0)  # a push of 0 keeps the loads in place
    if isinstance(still, NoLimit):
        _add(missing, ("held",) if loaded else ("held", "tilt"), still)
    factor = None
    if push is not None or loaded:
        wrench = None if push is not None else program.applied
        least, greatest = (following.reach(wrench, push, UNLIMITED, sign) for sign in (-1.0, 1.0))
        if isinstance(least, NoLimit) or isinstance(greatest, NoLimit):
            failed = NoLimit("failed") in (least, greatest)
            missing["load_factor"] = "failed" if failed else "none"
        else:
            factor = (-least, greatest)
    degrees = None
    if not loaded and not isinstance(still, NoLimit):
        tilt = following.tilt()
        if isinstance(tilt, NoLimit):
            missing["tilt"] = tilt.why
        else:
            degrees = float(np.degrees(tilt))
    held = not isinstance(still, NoLimit)
    return _uncertainty(
        ranges,
        kind="inner",
        held=held,
        tilt_deg=degrees,
        load_factor=factor,
        missing=missing,
        corners=0,
        worst=None,
    )


def _unknowns(program: Program, ranges: Ranges) -> Unknowns:
    """Uncertain quantities as (part, index): index 3 is the mass, 0 to 2 an axis of the centre."""
    axes = (0, 2) if program.planar else (0, 1, 2)
    what = [3] if ranges.mass[0] < ranges.mass[1] else []
    what += list(axes) if ranges.center > 0 else []
    return [(int(k), w) for k in np.flatnonzero(program.free) for w in what]
