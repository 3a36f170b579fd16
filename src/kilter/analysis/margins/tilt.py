"""Tilt margin: how far gravity may turn before nothing holds; about an axis, and nearest.

The directions of gravity with forces of equilibrium are a convex cone. Seen from its plane at
the given direction g0, points g0 + p with p across g0, it is a convex region around p = 0, and
the least turn to its boundary is atan of the distance from 0 to the boundary of the region:

    about an axis     max t:  J^T f + W (g0 + t e) = 0,  f in K          angle = atan t
    nearest           the same along the directions e in which the polygon of the boundary
                      points found so far comes nearest to 0

Every boundary point brings a supporting line (its mechanism m: the region lies where the
power W(g0 + p).m is not positive). The polygon of the points is inside the region, the lines
are outside: the distance is known when both agree. Loads given do not turn with gravity, so
they have no tilt margin of this kind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.margins.load_limit import OUTSIDE, Limit, find_limit
from kilter.arrays import Array, cross
from kilter.mechanics.coulomb_cones import Spread, nearest_load, spread
from kilter.mechanics.program import Program, tangents

__all__ = [
    "TiltMargin",
    "across_gravity",
    "find_nearest_held",
    "find_tilt_margin",
    "first_directions",
    "gravity_wrench",
    "nearest_edge",
    "tilt_about",
]


STEEPEST = 1e6
"""Tangent of a turn that counts as a right angle."""
FIRST = 8
"""Directions looked at first."""
SAME = 1e-9
"""Polygon and lines agree when their distances do to this part."""
NOTHING = 1e-6
"""Length of a projection, of a unit vector, that counts as none."""
PROGRAMS = 64
"""Programs after which the search ends with the gap that is left."""


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
        Direction of gravity at the limit, unit.
    limit : Limit
        Forces and mechanism there.
    programs : int
    """

    angle: float
    lower: float
    down: Array
    limit: Limit
    programs: int


def gravity_wrench(program: Program, direction: Array) -> Array:
    """The weights as if gravity pointed along `direction`, shape (N, 6) [N]."""
    wrench = np.zeros((len(program.names), 6))
    size = program.g
    wrench[:, :3] = (program.mass * program.free)[:, None] * size * direction
    return wrench


def tilt_about(program: Program, axis: Array) -> tuple[float, Limit | None] | None:
    """Largest angle [rad] by which gravity may turn about an axis across it, and the limit.

    By the right-hand rule, from 0 to pi, infinite where a full turn is held; None where the
    given direction is not held. One conic program for each right angle.
    """
    start = program.down
    axis = axis / float(np.linalg.norm(axis))
    aside = cross(axis, start)
    limit: Limit | None = None
    quarter = ((start, aside), (aside, -start), (-start, -aside), (-aside, start))
    for turns, (down, along) in enumerate(quarter):
        turned = program.turned(down)
        limit = find_limit(turned, gravity_wrench(program, along), most=STEEPEST)
        if limit is None:
            return None
        if np.isfinite(limit.value):
            return turns * np.pi / 2 + float(np.arctan(limit.value)), limit
    return np.inf, limit


def find_tilt_margin(program: Program) -> TiltMargin | None:
    """The nearest direction of gravity beyond which nothing holds; None: not held as given.

    Raises
    ------
    ValueError
        If there are given loads: they do not turn.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> found = find_tilt_margin(build_program(block, find_contacts(block)))
    >>> round(float(np.tan(found.angle)), 6)
    0.5
    """
    if program.applied.any():
        raise ValueError("given loads do not turn with gravity")
    start = program.down
    across = across_gravity(program, start)
    region = _Region(program, start, across)
    for direction in first_directions(len(across)):
        if not region.shoot(direction):
            return None
    while region.programs < PROGRAMS:
        inner, direction = region.inner()
        if inner >= region.nearest * (1 - SAME) or region.nearest >= STEEPEST or len(across) == 1:
            break
        region.shoot(direction)
    return region.answer()


def find_nearest_held(program: Program) -> tuple[float, Array] | None:
    """The least turn of gravity [rad] to a direction that is held, and that direction.

    None where none is held within a right angle. A convex projection: one conic program.
    """
    from kilter.solvers.clarabel import solve_conic

    start = program.down
    axes = np.eye(3)[[0, 2]] if program.planar else np.eye(3)
    wrenches = np.array([gravity_wrench(program, axis) for axis in axes])
    answer = solve_conic(nearest_load(spread(program), wrenches, axes @ start))
    if not answer.found:
        return None
    found = answer.x[-len(axes) :] @ axes
    size = float(np.linalg.norm(found))
    if size < NOTHING:
        return None
    turn = float(np.arctan2(np.linalg.norm(cross(start, found)), start @ found))
    return turn, found / size


def across_gravity(program: Program, start: Array) -> Array:
    """Directions across gravity, shape (1, 3) where planar, else (2, 3)."""
    if program.planar:
        return cross(start, np.array([0.0, 1.0, 0.0]))[None]
    both: Array = tangents(start[None])[0]
    return both


def first_directions(dimension: int) -> Array:
    """Unit directions of the plane looked at first, shape (n, dimension)."""
    if dimension == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * np.arange(FIRST) / FIRST
    return np.column_stack([np.cos(angle), np.sin(angle)])


def nearest_edge(points: Array) -> tuple[float, Array]:
    """Least distance from 0 of the edges of a convex polygon around it, and the normal there.

    In one dimension, points (n, 1): the nearest point and its direction.
    """
    if points.shape[1] == 1:
        k = int(np.abs(points[:, 0]).argmin())
        return float(abs(points[k, 0])), np.sign(points[k])
    order = np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")
    corner, following = points[order], np.roll(points[order], -1, axis=0)
    edge = following - corner
    length = np.maximum(np.linalg.norm(edge, axis=1), np.finfo(float).tiny)
    normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / length[:, None]
    distance = np.abs(np.einsum("ij,ij->i", normal, corner))
    away = np.einsum("ij,ij->i", normal, corner) < 0
    normal[away] *= -1
    real = length > SAME * np.linalg.norm(points, axis=1).max()
    distance[~real] = np.inf
    k = int(distance.argmin())
    return float(distance[k]), normal[k]


class _Region:
    """Boundary points and supporting lines of the region of p, in the plane of `across`."""

    def __init__(self, program: Program, start: Array, across: Array) -> None:
        self.program, self.start, self.across = program, start, across
        self.wide: Spread = spread(program)
        self.points: list[Array] = []
        self.nearest = np.inf
        self.line = np.zeros(len(across))
        self.limit: Limit | None = None
        self.programs = 0

    def shoot(self, direction: Array) -> bool:
        """Look along a unit direction of the plane; False where nothing is held at p = 0."""
        wrench = gravity_wrench(self.program, direction @ self.across)
        limit = find_limit(self.program, wrench, wide=self.wide, most=STEEPEST)
        self.programs += 1
        if limit is None or limit.value < OUTSIDE:
            return False
        reach = min(limit.value, STEEPEST)
        self.points.append(max(reach, 0.0) * direction)
        if limit.mechanism is None:
            return True
        normal, distance = self._line(limit)
        # where the line is no support (its motion too coarse), the point itself bounds
        if not 0.0 <= distance <= reach * (1 + SAME):
            normal, distance = direction, reach
        if distance < self.nearest or self.limit is None:
            self.nearest, self.line, self.limit = distance, normal, limit
        return True

    def _line(self, limit: Limit) -> tuple[Array, float]:
        """Unit normal and distance of the line at which the mechanism gains no power."""
        assert limit.mechanism is not None
        motion = limit.mechanism.motion
        moment = (self.program.mass * self.program.free) @ motion[:, :3]
        along = self.across @ moment
        size = float(np.linalg.norm(along))
        if size == 0.0:
            return along, np.inf
        return along / size, -float(self.start @ moment) / size

    def inner(self) -> tuple[float, Array]:
        """Least distance from 0 of the polygon of the points, and its direction."""
        points = np.array(self.points)
        if points.shape[1] == 1:
            return self.nearest, points[0]
        return nearest_edge(points)

    def answer(self) -> TiltMargin | None:
        """The margin found."""
        if self.limit is None:
            angle = np.pi / 2
            limit = find_limit(self.program, np.zeros((len(self.program.names), 6)), most=1.0)
            return None if limit is None else TiltMargin(angle, angle, self.start, limit, 0)
        lower, _ = self.inner()
        down = self.start + self.nearest * (self.line @ self.across)
        return TiltMargin(
            float(np.arctan(self.nearest)),
            float(np.arctan(min(lower, self.nearest))),
            down / float(np.linalg.norm(down)),
            self.limit,
            self.programs,
        )
