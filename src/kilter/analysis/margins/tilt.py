"""Tilt margin: how far gravity may turn before nothing holds; about an axis, and nearest.

The directions of gravity with forces of equilibrium are a convex cone. Seen from its plane at
the given direction g0, points g0 + p with p across g0, it is a convex region around p = 0, and
the least turn to its boundary is atan of the distance from 0 to the boundary of the region:

    about an axis     max t:  J^T f + W (g0 + t e) = 0,  f in K          angle = atan t
    nearest           the same along the directions e in which the polygon of the boundary
                      points found so far comes nearest to 0

Every boundary point brings a supporting line (its mechanism m: the region lies where the
power W(g0 + p).m is not positive): an oracle of `kilter.analysis.regions.enclose`. Loads given
do not turn with gravity, so they have no tilt margin of this kind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.margins.load_limit import (
    Limit,
    NoLimit,
    find_limit,
    gravity_wrench,
)
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.analysis.turning_tolerances import (
    CONIC_SHARP,
    NO_PROJECTION,
    NOT_HELD,
    STEEPEST,
    TILT_AGREES,
)
from kilter.arrays import Array, across, cross
from kilter.mechanics.coulomb_cones import nearest_load, spread
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program

__all__ = [
    "TiltMargin",
    "across_gravity",
    "find_nearest_held",
    "find_tilt_margin",
    "first_directions",
    "held_limit",
    "tilt_about",
]

FIRST = 4
"""Directions looked at first, between the axes across gravity."""
PROGRAMS = 64
"""Programs after which the search ends with the gap that is left: at most about half the square
of pi over their number, of the tangent, where the boundary is a circle around gravity."""


@dataclass(frozen=True, slots=True, eq=False)
class TiltMargin:
    """The least turn of gravity after which no forces hold the assembly.

    Attributes
    ----------
    angle : float
        [rad]; pi/2 where a right angle is not enough.
    lower : float
        An angle up to which every turn is held [rad].
    down : ndarray, shape (3,)
        Direction of gravity at the limit, unit; as given where a right angle is not enough.
    limit : Limit
        Forces and mechanism there.
    programs : int
    """

    angle: float
    lower: float
    down: Array
    limit: Limit
    programs: int


def tilt_about(program: Program, axis: Array) -> tuple[float, Limit] | NoLimit:
    """Largest angle [rad] by which gravity may turn about an axis across it, and the limit.

    By the right-hand rule, from 0 to pi, infinite where a full turn is held. Not held as given:
    no limit. One conic program for each right angle.
    """
    start = program.down
    aside = cross(axis / float(np.linalg.norm(axis)), start)
    quarter = ((start, aside), (aside, -start), (-start, -aside), (-aside, start))
    unlimited: Limit | None = None
    opening = Opening(spread(program))
    for turns, (down, along) in enumerate(quarter):
        turned = opening.turned(down)
        wrench = gravity_wrench(program, along)
        limit = find_limit(turned.program, wrench, opening=turned, most=STEEPEST)
        if isinstance(limit, NoLimit):
            return limit if turns == 0 else NoLimit("failed")
        if np.isfinite(limit.value):
            return turns * np.pi / 2 + float(np.arctan(limit.value)), limit
        unlimited = limit
    assert unlimited is not None
    return np.inf, unlimited


def find_tilt_margin(program: Program) -> TiltMargin | NoLimit:
    """The nearest direction of gravity beyond which nothing holds; no limit: not held as given.

    Raises
    ------
    ValueError
        If there are given loads: they do not turn.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> found = find_tilt_margin(build_program(block, contacts(block)))
    >>> round(float(np.tan(found.angle)), 6)
    0.5
    """
    if program.applied.any():
        raise ValueError("given loads do not turn with gravity")
    basis = across_gravity(program)
    opening = Opening(spread(program))
    limits: list[Limit | NoLimit] = []

    def shoot(direction: Array) -> SupportPoint | None:
        wrench = gravity_wrench(program, direction @ basis)
        limit = held_limit(program, wrench, opening=opening, most=STEEPEST)
        limits.append(limit)
        return None if isinstance(limit, NoLimit) else _boundary(program, basis, direction, limit)

    first = first_directions(len(basis))
    face = nearest_face(shoot, first, agree=TILT_AGREES, limit=PROGRAMS, most=STEEPEST)
    if face is None or NoLimit("none") in limits:
        return NoLimit("none" if NoLimit("none") in limits else "failed")
    limit = limits[face.answer]
    assert isinstance(limit, Limit)
    if face.outer >= STEEPEST * (1 - TILT_AGREES):  # unlimited in every direction
        return TiltMargin(np.pi / 2, np.pi / 2, program.down, limit, face.asked)
    down = program.down + face.outer * (face.normal @ basis)
    return TiltMargin(
        float(np.arctan(face.outer)),
        float(np.arctan(face.inner)),
        down / float(np.linalg.norm(down)),
        limit,
        face.asked,
    )


def held_limit(
    program: Program, wrench: Array, *, opening: Opening, most: float
) -> Limit | NoLimit:
    """The limit, where a share of 0 is held too."""
    limit = find_limit(program, wrench, opening=opening, most=most)
    below = isinstance(limit, Limit) and limit.value < NOT_HELD
    return NoLimit("none") if below else limit


def _boundary(program: Program, basis: Array, direction: Array, limit: Limit) -> SupportPoint:
    """The boundary point along a direction, and the line at which its mechanism gains no power."""
    reach = max(min(limit.value, STEEPEST), 0.0)
    point = reach * direction
    if limit.mechanism is not None:
        moment = (program.mass * program.free) @ limit.mechanism.motion[:, :3]
        along = basis @ moment
        size = float(np.linalg.norm(along))
        distance = -float(program.down @ moment) / size if size > 0 else np.inf
        # where the line is no support (its motion too coarse), the point itself bounds
        if 0.0 <= distance <= reach * (1 + TILT_AGREES):
            return SupportPoint(point, along / size, distance)
    return SupportPoint(point, direction, reach)


def find_nearest_held(program: Program) -> tuple[float, Array] | NoLimit:
    """The least turn of gravity [rad] to a direction that is held, and that direction.

    A convex projection: one conic program, asked again where it fails. No limit: none is held
    within a right angle, or both failed.
    """
    from kilter.solvers.clarabel import solve_conic

    axes = np.eye(3)[[0, 2]] if program.planar else np.eye(3)
    wrenches = np.array([gravity_wrench(program, axis) for axis in axes])
    nearest = nearest_load(spread(program), wrenches, axes @ program.down)
    answer = solve_conic(nearest)
    if not answer.optimal:
        answer = solve_conic(nearest, tolerance=CONIC_SHARP)
    if not answer.optimal:
        return NoLimit("failed")
    found = answer.x[-len(axes) :] @ axes
    size = float(np.linalg.norm(found))
    if size < NO_PROJECTION:
        return NoLimit("none")
    turn = float(np.arctan2(np.linalg.norm(cross(program.down, found)), program.down @ found))
    return turn, found / size


def across_gravity(program: Program) -> Array:
    """Directions across gravity, shape (1, 3) where planar, else (2, 3)."""
    if program.planar:
        return cross(program.down, np.array([0.0, 1.0, 0.0]))[None]
    return np.stack(across(program.down))


def first_directions(dimension: int) -> Array:
    """Unit directions of the plane looked at first, shape (n, dimension)."""
    if dimension == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * (np.arange(FIRST) + 0.5) / FIRST
    return np.column_stack([np.cos(angle), np.sin(angle)])
