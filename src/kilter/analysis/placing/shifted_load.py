"""The places of a load that the contacts of an assembly carry: a convex set in a rectangle.

    {d in [low, high] : J^T f + w + d_1 W_1 + d_2 W_2 = 0 for forces f in their cones}

with two load wrenches W per unit of shift. Its farthest point along a direction is a linear
program, or a conic program with friction. Forces prove each point, and the multipliers are a
motion that proves a line beyond which the load is not carried.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.turning_tolerances import BEYOND_LIMIT
from kilter.arrays import Array
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import ConicProgram, LinearProgram

__all__ = ["CarriedPlaces", "ShiftedLoad"]

FIRST = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
"""Directions that are searched first."""
MOST_PROGRAMS = 200
"""Largest number of programs for the places of one load; the rest stays open."""
SAME = 1e-9
"""Distance below which two places count as equal [sides of the rectangle]."""


@dataclass(frozen=True, slots=True, eq=False)
class CarriedPlaces:
    """Places that forces prove, and places that motions do not exclude.

    Attributes
    ----------
    inner, outer : shapely geometry
        Convex; forces prove `inner`, and motions prove that places beyond `outer` are not carried.
    programs : int
        Number of solved programs.
    """

    inner: shapely.Geometry
    outer: shapely.Geometry
    programs: int


@dataclass(eq=False)
class ShiftedLoad:
    """A load on an assembly that is shifted within a rectangle.

    Parameters
    ----------
    program : Program
        With the load at the shift 0.
    wrenches : ndarray, shape (2, N, 6)
        Change of the wrenches on all parts per unit of shift along each axis.
    low, high : ndarray, shape (2,)
        The rectangle of shifts [length unit].
    """

    program: Program
    wrenches: Array
    low: Array
    high: Array
    _evidence: Array | None = None

    def places(self, accuracy: float) -> CarriedPlaces:
        """The carried shifts, as a polygon inside and a polygon outside.

        Parameters
        ----------
        accuracy : float
            The search ends if each edge of the inner polygon is this near to the outer polygon
            [length unit].
        """
        whole = shapely.box(*self.low, *self.high)
        outer, points, programs = whole, [], 0
        empty = shapely.Polygon()
        for direction in FIRST:
            found = self._farthest(np.array(direction))
            programs += 1
            if found is None:
                return CarriedPlaces(empty, empty if self._is_refuted() else whole, programs)
            points.append(found[0])
            outer = _cut(outer, found, whole)
        span = float((self.high - self.low).max())
        settled: set[tuple[float, ...]] = set()
        while programs < MOST_PROGRAMS:
            hull = shapely.convex_hull(shapely.multipoints(np.array(points)))
            edge = _next_edge(hull, outer, settled, max(accuracy, SAME * span), span)
            if edge is None:
                break
            start, end, outward = edge
            found = self._farthest(outward)
            programs += 1
            settled.add(_key(start, end, span))
            if found is None:
                continue
            outer = _cut(outer, found, whole)
            if (found[0] - start) @ outward > SAME * span:
                points.append(found[0])
        hull = shapely.convex_hull(shapely.multipoints(np.array(points)))
        return CarriedPlaces(hull, outer, programs)

    def at(self, shift: Array) -> Program:
        """The program with the load at a shift."""
        more = shift[0] * self.wrenches[0] + shift[1] * self.wrenches[1]
        return self.program.with_rows(applied=self.program.applied + more)

    @cached_property
    def _problem(self) -> ScaledProblem:
        return scaled_problem(self.program)

    @cached_property
    def _cones(self) -> ConeProblem:
        return cone_problem(self.program)

    @cached_property
    def _kept(self) -> KeptProgram:
        """The linear program for forces f and shift d, without friction. x = (f, d)."""
        problem = self._problem
        along = [-problem.scaled_load(wrench)[:, None] for wrench in self.wrenches]
        matrix = hstack([problem.matrix, *map(csc_array, along)], format="csc")
        count = problem.matrix.shape[1]
        lower = np.append(np.where(self.program.two_sided, -np.inf, 0.0), self.low)
        upper = np.append(np.full(count, np.inf), self.high)
        right = problem.right
        program = LinearProgram(np.zeros(count + 2), matrix, right, right, lower, upper)
        return KeptProgram(program, goal="point")

    def _conic(self, direction: Array) -> ConicProgram:
        """The conic program for forces f and shift d, with friction. x = (f, d)."""
        cones = self._cones
        problem = cones.problem
        total = problem.matrix.shape[1]
        cone_matrix, positive, sizes = cones.cone_rows()
        balance, equal = cones.balance(*[-problem.scaled_load(each) for each in self.wrenches])
        side = csc_array((np.array([1.0, 1.0]), ([0, 1], [total, total + 1])), shape=(2, total + 2))
        conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], 2))])
        matrix = vstack([balance, side, -side, conic], format="csc")
        bound = np.concatenate([problem.right, np.zeros(equal), self.high, -self.low, cones.heads])
        cost = np.append(np.zeros(total), -direction)
        quadratic = csc_array((total + 2, total + 2))
        return ConicProgram(quadratic, cost, matrix, bound, balance.shape[0], positive + 4, sizes)

    def _farthest(self, direction: Array) -> tuple[Array, Array | None] | None:
        """The farthest carried shift along a direction, and the motion there.

        None if no shift is known to be carried. The motion is None if it proves no line.
        """
        if self.program.mu.any():
            from kilter.solvers.clarabel import solve_conic

            answer = solve_conic(self._conic(direction))
            problem = self._cones.problem
            if not answer.found:
                self._keep_evidence(problem, answer.multipliers[: len(problem.right)])
                return None
            shift = answer.x[-2:]
            forces, friction = self._cones.decoded(answer.x[:-2])
            columns = answer.multipliers[: len(problem.right)]
        else:
            problem, kept = self._problem, self._kept
            count = problem.matrix.shape[1]
            kept.change_cost([count, count + 1], -direction)
            answer = kept.solve()
            if not answer.optimal:
                self._keep_evidence(problem, -answer.multipliers)
                return None
            shift = answer.x[-2:]
            forces, friction = problem.forces(answer.x[:-2]), None
            columns = -answer.multipliers
        shift = np.clip(shift, self.low, self.high)
        if not check_forces(self.at(shift), forces, friction).holds:
            return None
        motion = problem.motion(problem.over_weight(columns))
        return shift, self._line(shift, motion)

    def _keep_evidence(self, problem: ScaledProblem, columns: Array) -> None:
        """Keep the motion of the multipliers of an infeasible program; its sign is tested."""
        if len(columns) != len(problem.right) or not np.isfinite(columns).all():
            return
        middle = self.at((self.low + self.high) / 2)
        for sign in (1.0, -1.0):
            motion = problem.motion(problem.over_weight(sign * columns))
            if check_motion(middle, motion).holds:
                self._evidence = motion
                return

    def _line(self, shift: Array, motion: Array) -> Array | None:
        """The line (a, b, c) with a u + b v <= c for each carried shift; None without a proof."""
        free = self.program.free[:, None]
        rate = np.array([float((np.where(free, w, 0.0) * motion).sum()) for w in self.wrenches])
        size = float(np.linalg.norm(rate))
        if not size > 0:
            return None
        normal = rate / size
        span = float((self.high - self.low).max())
        for step in BEYOND_LIMIT:
            proof = check_motion(self.at(shift + step * span * normal), motion)
            if proof.holds:
                reach = float(normal @ shift) + step * span
                return np.append(normal, reach)
        return None

    def _is_refuted(self) -> bool:
        """Whether a motion proves that no shift of the rectangle is carried.

        The motion gains power at each corner of the rectangle, so it does at each shift.
        """
        if self._evidence is None:
            return False
        corners = [
            np.array([u, v])
            for u in (self.low[0], self.high[0])
            for v in (self.low[1], self.high[1])
        ]
        return all(check_motion(self.at(corner), self._evidence).holds for corner in corners)


def _cut(
    outer: shapely.Geometry, found: tuple[Array, Array | None], whole: shapely.Geometry
) -> shapely.Geometry:
    """An outer polygon without the side of a line that a motion excludes."""
    line = found[1]
    if line is None:
        return outer
    cut = shapely.intersection(outer, _half_plane(line, whole))
    # a line or a point remains: the outer polygon stays, so that it excludes nothing too much
    return cut if cut.geom_type == "Polygon" else outer


def _half_plane(line: Array, whole: shapely.Geometry) -> shapely.Geometry:
    """The part of a half plane a u + b v <= c that covers its side of a rectangle."""
    low, high = np.array(whole.bounds[:2]), np.array(whole.bounds[2:])
    normal, reach = line[:2], float(line[2])
    middle = (low + high) / 2
    far = 4 * float(np.linalg.norm(high - low)) + 4 * abs(reach - float(normal @ middle))
    along = np.array([-normal[1], normal[0]])
    foot = middle + (reach - float(normal @ middle)) * normal
    corners = [foot + far * along, foot - far * along]
    return shapely.polygons([*corners, corners[1] - far * normal, corners[0] - far * normal])


def _next_edge(
    hull: shapely.Geometry,
    outer: shapely.Geometry,
    settled: set[tuple[float, ...]],
    accuracy: float,
    span: float,
) -> tuple[Array, Array, Array] | None:
    """The edge of the hull farthest from the outer polygon, with its outward unit normal.

    None if each edge is settled or near enough.
    """
    if outer.is_empty:
        return None
    if hull.geom_type == "Polygon":
        ring = np.array(shapely.normalize(hull).exterior.coords)
        if shapely.is_ccw(shapely.linearrings(ring)):
            ring = ring[::-1]
    elif hull.geom_type == "LineString":
        ring = np.array([*hull.coords, hull.coords[0]])
    else:
        return None
    corners = shapely.get_coordinates(outer)
    best, chosen = accuracy, None
    for start, end in itertools.pairwise(ring):
        along = end - start
        length = float(np.linalg.norm(along))
        if not length > 0 or _key(start, end, span) in settled:
            continue
        outward = np.array([-along[1], along[0]]) / length
        beyond = float(((corners - start) @ outward).max())
        if beyond > best:
            best, chosen = beyond, (start, end, outward)
    return chosen


def _key(start: Array, end: Array, span: float) -> tuple[float, ...]:
    """Key of an edge, in which places within rounding are equal."""
    return (*np.round(start / span, 9).tolist(), *np.round(end / span, 9).tolist())
