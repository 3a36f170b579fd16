"""The places of a load that the contacts of an assembly carry: a convex set in a rectangle.

    {d in [low, high] : J^T f + w + d_1 W_1 + d_2 W_2 = 0 for forces f in their cones}

with two load wrenches W per unit of shift. Its farthest point along a direction is a linear
program, or a conic program with friction. Forces prove each point, and the multipliers are a
motion that proves a line beyond which the load is not carried.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
import shapely
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.placing.polygon_sets import moved
from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, check_motion, needed_power
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.load_checks import check_load_forces, shifted_weights
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram, LinearProgram, with_columns

if TYPE_CHECKING:
    from kilter.solvers.highs import KeptProgram


# The places of a load that a motion excludes: a half plane.


def excluded_side(
    program: Program, wrenches: Array, low: Array, high: Array, motion: Array
) -> tuple[Array, float] | None:
    """The half plane of shifts that a motion excludes, within a rectangle of shifts.

    Arguments: `wrenches` (2, N, 6): change of the load per unit of shift along each axis; `low`,
    `high` (2,): the rectangle [length unit]; `motion` (N, 6). Returns `normal` (2,); `reach`:
    shifts d with normal.d > reach are not carried; -inf if no shift is carried. None if the motion
    proves nothing.
    """
    judged = check_motion(program, motion)
    if not judged.motion.any():
        return None
    # the power that a proof needs grows with the load: convex in d, so the corners bound it
    corners = [(u, v) for u in (low[0], high[0]) for v in (low[1], high[1])]
    loads = np.tensordot(np.array(corners), wrenches, axes=1)
    needed = needed_power(program, judged, shifted_weights(program, loads))
    free = program.free[:, None]
    rate = np.array([float((np.where(free, w, 0.0) * judged.motion).sum()) for w in wrenches])
    size = float(np.linalg.norm(rate))
    if not size > 0:
        return (np.array([1.0, 0.0]), -np.inf) if judged.power > needed else None
    return rate / size, (needed - judged.power) / size


def remaining(
    area: shapely.Geometry, side: tuple[Array, float], whole: shapely.Geometry
) -> shapely.Geometry:
    """A convex area of a rectangle without an excluded half plane.

    Examples
    --------
    >>> square = shapely.box(0, 0, 1, 1)
    >>> remaining(square, (np.array([1.0, 0.0]), 0.25), square).area
    0.25
    """
    normal, reach = side
    low, high = np.array(whole.bounds[:2]), np.array(whole.bounds[2:])
    middle = (low + high) / 2
    far = 4 * float(np.linalg.norm(high - low))
    beyond = reach - float(normal @ middle)  # distance of the line from the middle
    if beyond <= -far:
        return shapely.Polygon()
    if beyond >= far:
        return area
    along = np.array([-normal[1], normal[0]])
    foot = middle + beyond * normal
    corners = [foot + far * along, foot - far * along]
    half = shapely.polygons(
        [*corners, corners[1] - 2 * far * normal, corners[0] - 2 * far * normal]
    )
    cut = shapely.intersection(area, half)
    return cut if cut.geom_type == "Polygon" else shapely.Polygon()


FIRST = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
"""Directions that are searched first."""
MOST_PROGRAMS = 200
"""Largest number of programs for the places of one load; the rest stays open."""
SAME = 1e-9
"""Distance below which two places count as equal [sides of the rectangle]."""


@dataclass(frozen=True, slots=True, eq=False)
class CarriedPlaces:
    """Places that forces prove, and places that motions do not exclude."""

    inner: shapely.Geometry
    outer: shapely.Geometry
    """Convex; forces prove `inner`, and motions prove that places beyond `outer` are not
    carried."""
    programs: int = 0
    """Number of solved programs."""
    points: tuple[tuple[Array, ForceProof], ...] = ()
    """Carried places and their forces; `inner` is their hull."""
    motions: tuple[Array, ...] = ()
    """Motions, each of which excludes the places of a half plane, shape (N, 6)."""

    def shifted(self, by: Array) -> CarriedPlaces:
        """The same places in coordinates with another origin."""
        return replace(
            self,
            inner=moved(self.inner, by),
            outer=moved(self.outer, by),
            points=tuple((place + by, proof) for place, proof in self.points),
        )

    def with_outside_of(self, other: CarriedPlaces) -> CarriedPlaces:
        """These carried places, with the motions of another search."""
        return replace(self, outer=other.outer, motions=other.motions)

    def without_motions(self) -> CarriedPlaces:
        """These carried places alone; the outer polygon is not proved any more."""
        return replace(self, motions=())


@dataclass(frozen=True, slots=True, eq=False)
class CarriedPoint:
    """A shift of the load that a solver reports as carried, before the check of its forces."""

    shift: Array
    """Shape (2,)."""
    forces: Array
    """Along the rows [N], shape (K,)."""
    friction: Array | None
    """Across the rows [N], shape (K, 3)."""


@dataclass(eq=False)
class ShiftedLoad:
    """A load on an assembly that is shifted within a rectangle.

    Arguments: `wrenches` (2, N, 6); `low`, `high` (2,) [length unit]; `known_motions` (N, 6) each:
    if one of them excludes all shifts, no program is solved.
    """

    program: Program
    wrenches: Array
    low: Array
    high: Array
    bound: Program | None = None
    known: ScaledProblem | None = None
    proofs: Literal["both", "forces", "motions"] = "both"
    known_motions: Sequence[Array] = ()

    def places(
        self,
        accuracy: float,
        carried: Sequence[tuple[Array, ForceProof]] = (),
        within: shapely.Geometry | None = None,
    ) -> CarriedPlaces:
        """The carried shifts, as a polygon inside and a polygon outside.

        Arguments: `accuracy`: the search ends if each edge of the inner polygon is this near to the
        outer polygon [length unit]; `carried`: shifts that are carried, from a search with fewer
        rows; for a search of motions; `within`: the shifts of interest; by default the rectangle.
        """
        whole = shapely.box(*self.low, *self.high)
        outer, programs = whole if within is None else within, 0
        for motion in self.known_motions:
            if (cut := self._left(outer, motion, whole)).is_empty:
                return CarriedPlaces(shapely.Polygon(), cut, motions=(motion,))
        points = [CarriedPoint(shift, proof.forces, None) for shift, proof in carried]
        motions: list[Array] = []

        def farthest(direction: Array) -> CarriedPoint | None:
            nonlocal outer, programs
            found, multipliers = self._farthest(direction)
            programs += 1
            if self.proofs == "forces":
                if found is not None:
                    outer = remaining(outer, _beyond(found.shift, direction), whole)
                return found
            motion = self._motion(multipliers, infeasible=found is None)
            if motion is not None:
                cut = self._left(outer, motion, whole)
                # a line or a point remains of carried places: then nothing is excluded
                if (found is None or cut.area > 0) and cut.area < outer.area * (1 - SAME):
                    motions.append(motion)
                    outer = cut
            return found

        span = float((self.high - self.low).max())
        for direction in map(np.array, FIRST):
            corner = np.where(direction > 0, self.high, self.low)
            if any(np.abs(point.shift - corner).max() <= SAME * span for point in points):
                continue  # nothing lies beyond it
            found = farthest(direction)
            if found is None:
                return CarriedPlaces(shapely.Polygon(), outer, programs, (), tuple(motions))
            points.append(found)
        settled: set[tuple[float, ...]] = set()
        while programs < MOST_PROGRAMS:
            edge = _next_edge(_hull(points), outer, settled, max(accuracy, SAME * span), span)
            if edge is None:
                break
            start, end, outward = edge
            settled.add(_key(start, end, span))
            found = farthest(outward)
            if found is not None and (found.shift - start) @ outward > SAME * span:
                points.append(found)
        proved = () if self.proofs == "motions" else self._proved(points)
        return CarriedPlaces(_hull_of(proved), outer, programs, proved, tuple(motions))

    def _proved(self, points: list[CarriedPoint]) -> tuple[tuple[Array, ForceProof], ...]:
        """The corners of the hull of points, with their forces as proofs; others are left out."""
        corners = {tuple(corner) for corner in shapely.get_coordinates(_hull(points)).tolist()}
        kept = [point for point in points if tuple(point.shift.tolist()) in corners]
        shifts = np.array([point.shift for point in kept])
        rough = any(point.friction is not None for point in kept)
        proofs = check_load_forces(
            self.program,
            np.tensordot(shifts, self.wrenches, axes=1),
            np.array([point.forces for point in kept]),
            np.array([point.friction for point in kept]) if rough else None,
        )
        pairs = zip(kept, proofs, strict=True)
        return tuple((point.shift, proof) for point, proof in pairs if proof.holds)

    @cached_property
    def _problem(self) -> ScaledProblem:
        return scaled_problem(self.program, self.known)

    @cached_property
    def _cones(self) -> ConeProblem:
        return cone_problem(self.program)

    @cached_property
    def _kept(self) -> KeptProgram:
        """The linear program for forces f and shift d, without friction. x = (f, d)."""
        # late: the verification of a map uses this module without a solver
        from kilter.solvers.highs import KeptProgram

        problem = self._problem
        along = [-problem.scaled_load(wrench) for wrench in self.wrenches]
        matrix = with_columns(problem.matrix, along)
        count = problem.matrix.shape[1]
        lower = np.append(np.where(self.program.two_sided, -np.inf, 0.0), self.low)
        upper = np.append(np.full(count, np.inf), self.high)
        right = problem.right
        program = LinearProgram(np.zeros(count + 2), matrix, right, right, lower, upper)
        return KeptProgram(program, goal="proof")

    @cached_property
    def _conic(self) -> ConicProgram:
        """The conic program for forces f and shift d, with friction. x = (f, d); without a cost."""
        cones = self._cones
        problem = cones.problem
        total = problem.matrix.shape[1]
        cone_matrix, positive, sizes = cones.cone_rows()
        balance, equal = cones.balance(*[-problem.scaled_load(each) for each in self.wrenches])
        side = csc_array((np.array([1.0, 1.0]), ([0, 1], [total, total + 1])), shape=(2, total + 2))
        conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], 2))])
        matrix = vstack([balance, side, -side, conic], format="csc")
        bound = np.concatenate([problem.right, np.zeros(equal), self.high, -self.low, cones.heads])
        quadratic = csc_array((total + 2, total + 2))
        cost = np.zeros(total + 2)
        return ConicProgram(quadratic, cost, matrix, bound, balance.shape[0], positive + 4, sizes)

    def _farthest(self, direction: Array) -> tuple[CarriedPoint | None, Array]:
        """The farthest carried shift along a direction, and the multipliers of the balance.

        None if no shift is carried.
        """
        if self.program.mu.any():
            from kilter.solvers.clarabel import solve_conic

            cost = self._conic.cost.copy()
            cost[-2:] = -direction
            answer = solve_conic(replace(self._conic, cost=cost))
            columns = answer.multipliers[: len(self._cones.problem.right)]
            forces, friction = self._cones.decoded(answer.x[:-2]) if answer.found else (None, None)
        else:
            count = self._problem.matrix.shape[1]
            self._kept.change_cost([count, count + 1], -direction)
            answer = self._kept.solve()
            columns = -answer.multipliers[: len(self._problem.right)]
            forces = self._problem.forces(answer.x[:count]) if answer.optimal else None
            friction = None
        if forces is None:
            return None, columns
        count = len(self.program.part_a) if friction is None else len(answer.x) - 2
        shift = np.clip(answer.x[count : count + 2], self.low, self.high)
        return CarriedPoint(shift, forces, friction), columns

    def _motion(self, columns: Array, *, infeasible: bool) -> Array | None:
        """The motion of multipliers; the sign of those of an infeasible program is tested."""
        problem = self._cones.problem if self.program.mu.any() else self._problem
        if len(columns) != len(problem.right) or not np.isfinite(columns).all():
            return None
        motion = problem.motion(problem.over_weight(columns))
        if infeasible and self.program.power(motion) < 0:
            motion = -motion
        return motion

    def _left(
        self, outer: shapely.Geometry, motion: Array, whole: shapely.Geometry
    ) -> shapely.Geometry:
        """The shifts of an area that a motion does not exclude: it excludes a half plane."""
        bound = self.bound or self.program
        side = excluded_side(bound, self.wrenches, self.low, self.high, motion)
        return outer if side is None else remaining(outer, side, whole)


def _beyond(shift: Array, direction: Array) -> tuple[Array, float]:
    """The half plane beyond the farthest carried shift along a direction."""
    normal = direction / np.linalg.norm(direction)
    return normal, float(normal @ shift)


def _hull(points: list[CarriedPoint]) -> shapely.Geometry:
    """The convex hull of carried places."""
    return shapely.convex_hull(shapely.multipoints(np.array([point.shift for point in points])))


def _hull_of(proved: Sequence[tuple[Array, ForceProof]]) -> shapely.Geometry:
    """The convex hull of proved places."""
    if not proved:
        return shapely.Polygon()
    return shapely.convex_hull(shapely.multipoints(np.array([place for place, _ in proved])))


def meet(inner: shapely.Geometry, outer: shapely.Geometry, accuracy: float, sides: Array) -> bool:
    """Whether each edge of the carried places is near to those that are not excluded.

    Arguments: `accuracy` [length unit]; `sides` (2,): of the rectangle of shifts.
    """
    if outer.is_empty or not outer.area > 0:
        return True
    if inner.geom_type != "Polygon" or inner.is_empty:
        return False
    span = float(sides.max())
    return _next_edge(inner, outer, set(), max(accuracy, SAME * span), span) is None


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
