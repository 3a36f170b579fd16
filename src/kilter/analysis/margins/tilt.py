"""Tilt margin: how far gravity may turn, about an axis or in any direction, before parts move.

The directions of gravity with forces of equilibrium are a convex cone. Seen from its plane at
the given direction g0, points g0 + p with p across g0, it is a convex region around p = 0, and
the least turn to its boundary is atan of the distance from 0 to the boundary of the region:

    about an axis     max t:  J^T f + W (g0 + t e) = 0,  f in K          angle = atan t
    nearest           the same along the directions e in which the polygon of the boundary
                      points found so far comes nearest to 0

Every boundary point brings a supporting line (its mechanism m: in the region the
power W(g0 + p).m is not positive): an oracle of `kilter.analysis.regions.enclose`. Loads given
do not turn with gravity, so they have no tilt margin of this kind.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.analysis_tolerances import (
    BALANCED,
    CONIC_SHARP,
    FOLLOWING_AGREES,
    NO_PROJECTION,
    NOT_HELD,
    STEEPEST,
    TILT_AGREES,
)
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import (
    Limit,
    NoLimit,
    SharedCones,
    find_limit,
    gravity_wrench,
    least_limit,
)
from kilter.analysis.margins.turned_forces import held_distance
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.arrays import TINY, Array, across, angle_between, cross
from kilter.contact.round_edges import RoundEdge
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.coulomb_cones import cone_problem, nearest_load
from kilter.mechanics.forms import ScaledProblem, UncertainLoad, affine_forces, affine_imbalance
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows
from kilter.tell.record import InPython, OrNull, Record, Vector
from kilter.work import stop_if_late

if TYPE_CHECKING:
    from kilter.solvers.highs import Method


# Load limits of parts that tip over round edges, with contact points of the circle as needed.


BESIDE = 5e-5
"""Angle between a point of a circle and the points beside it [rad]; larger: a coarser circle."""
STEPS = 6
"""Largest number of repetitions of a limit; the distance to the circle falls with each."""
NEAR_EDGE = 0.9
"""A resultant farther out than this share of the radius presses on the edge [-]; the chords of a
circle of 16 corners are at 0.98."""


def limit_on_circles(
    program: Program, edges: Sequence[RoundEdge], find: Callable[[Program], Limit | NoLimit]
) -> Limit | NoLimit:
    """Compute a load limit, with points of round edges where the resultants press on them."""
    limit = find(program)
    for _ in range(STEPS):
        if isinstance(limit, NoLimit) or limit.motion is None:
            break
        finer = with_edge_points(program, edges, limit.forces)
        if finer is None:
            break
        program, limit = finer, find(finer)
    return limit


def with_edge_points(
    program: Program, edges: Sequence[RoundEdge], proof: ForceProof
) -> Program | None:
    """The program with points of the round edges on which forces press; None if it has them."""
    more = []
    for edge in edges:
        rows = np.flatnonzero((program.kind == CONTACT) & (program.source == edge.patch))
        pressed = proof.forces[rows] if len(rows) else np.zeros(0)
        total = float(pressed.sum())
        if not total > 0.0:
            continue
        arm = pressed @ (program.point[rows] - edge.center) / total
        angle = np.arctan2(arm @ edge.v, arm @ edge.u) + BESIDE * np.array([0.0, 1.0, -1.0])
        if np.linalg.norm(arm) < NEAR_EDGE * edge.radius or not edge.contains(angle).all():
            continue
        if _known(edge, program.point[rows], float(angle[0])):
            continue
        row = program.force_rows.take(rows[:1].repeat(3))
        more.append(replace(row, point=edge.points(angle)))
    if not more:
        return None
    return program.with_force_rows(ForceRows.join([program.force_rows, *more]))


def _known(edge: RoundEdge, points: Array, angle: float) -> bool:
    """Whether points of the circle lie close to an angle, on both sides of it or at it."""
    arm = points - edge.center
    on = np.abs(np.linalg.norm(arm, axis=1) - edge.radius) <= BESIDE * BESIDE * edge.radius
    away = (np.arctan2(arm[on] @ edge.v, arm[on] @ edge.u) - angle + np.pi) % (2 * np.pi) - np.pi
    close = away[np.abs(away) <= 1.01 * BESIDE]
    return bool((close >= 0).any() and (close <= 0).any()) and len(close) > 1


FIRST = 4
"""Number of directions of tilt that are tried first, between the two horizontal axes."""
NEARER = 3
"""Number of held directions from which a search moves toward the given gravity."""
PROGRAMS = 64
"""Programs after which the search ends with the gap that is left: at most about half the square
of pi over their number, of the tangent, where the boundary is a circle around gravity. Forces that
turn with the tilt close most such gaps earlier (`kilter.analysis.margins.turned_forces`)."""
CLOSED = 2e-6
"""Largest difference between a tilt and the proved lower angle of an exact tilt [rad]."""


class TiltAbout(Record):
    """Limit of a turn of gravity about an axis."""

    axis: Vector
    """Axis of the turn; the other sense has the opposite axis."""
    tilt_deg: OrNull
    """By the right-hand rule [deg]; infinite if a full turn is held."""
    limit: Limit
    """Forces and mechanism there."""


class NearestHeld(Record):
    """The held direction of gravity nearest to the given direction, and the angle between them."""

    angle: float
    """Turn to a direction that is held, as far as a certificate tells [rad]."""
    lower: float
    """A turn up to which a motion proves that no turn is held [rad]; 0 without such a motion."""
    down: Vector
    """The held direction, unit."""
    motion: MotionProof | None
    """The motion that proves `lower`."""

    def __repr__(self) -> str:
        return f"NearestHeld({np.degrees(self.angle):.6g} deg away)"


class TiltMargin(Record):
    """The least turn of gravity after which no contact forces hold the assembly."""

    angle: float
    """[rad]; pi/2 if a right angle is not enough, 0 if it is less than the imbalance that a
    certificate lets forces leave (1e-9): no proof tells it from none."""
    lower: float
    """An angle up to which every turn is held [rad], reduced by the permitted imbalance."""
    down: Vector
    """Direction of gravity at the limit, unit; as given if a right angle is not enough."""
    toward: Vector
    """Horizontal direction toward which the tilt fails first, unit; zero if a right angle is not
    enough."""
    limit: Limit
    """Forces and mechanism there."""
    shared: InPython[SharedCones]
    """The program of the parts that move, with what its limits have in common."""
    programs: int

    @property
    def closed(self) -> bool:
        """Whether the tilt is known from both sides."""
        return self.angle - self.lower <= CLOSED

    def __repr__(self) -> str:
        over = "" if self.angle < np.pi / 2 else "over "
        return f"TiltMargin({over}{np.degrees(self.angle):.6g} deg)"


def tilt_about(groups: Sequence[Program], axis: Array) -> TiltAbout | NoLimit:
    """Largest turn of gravity about an axis at which the parts hold, and its limit.

    Arguments: `groups`: programs of parts that do not touch those of other groups.

    Raises `ValueError` if there are given loads or bonds: they do not turn.
    """
    turns = [_group_tilt_about(program, axis) for program in groups]
    return least_limit(turns, lambda turn: turn.tilt_deg)


def _group_tilt_about(program: Program, axis: Array) -> TiltAbout | NoLimit:
    """Largest turn of gravity about an axis at which the parts of a group hold.

    By the right-hand rule, from 0 to pi, infinite if a full turn is held. Not held as given:
    no limit. A conic program for each right angle.

    Raises `ValueError` if there are given loads or bonds: they do not turn.
    """
    if program.applied.any() or program.has_strength:
        raise ValueError("given loads and bonds do not turn with gravity")
    start = program.down
    aside = cross(axis / float(np.linalg.norm(axis)), start)
    quarter = ((start, aside), (aside, -start), (-start, -aside), (-aside, start))
    unlimited: Limit | None = None
    drawn = SharedCones(program)
    for turns, (down, along) in enumerate(quarter):
        turned = drawn.turned(down)
        wrench = gravity_wrench(program, along)
        limit = find_limit(turned.program, wrench, shared=turned, most=STEEPEST)
        if isinstance(limit, NoLimit):
            return limit if turns == 0 else NoLimit("failed")
        if np.isfinite(limit.value):
            angle = turns * np.pi / 2 + float(np.arctan(limit.value))
            return TiltAbout(axis=axis, tilt_deg=float(np.degrees(angle)), limit=limit)
        unlimited = limit
    assert unlimited is not None
    return TiltAbout(axis=axis, tilt_deg=np.inf, limit=unlimited)


def find_least_tilt(
    groups: Sequence[Program], edges: Sequence[RoundEdge], tell: Callable[[str], None]
) -> TiltMargin | NoLimit:
    """The least tilt margin of groups that do not touch; none if a group has none."""
    tilts: list[TiltMargin | NoLimit] = []
    least = np.pi / 2
    for count, program in enumerate(groups, 1):
        stop_if_late()
        if len(groups) > 1:
            tell(f"tilt: group {count} of {len(groups)}")
        enough = float(np.tan(least)) if least < np.pi / 2 else np.inf
        tilt = find_tilt_margin(program, edges, enough=enough)
        tilts.append(tilt)
        if isinstance(tilt, NoLimit):
            break
        least = min(least, tilt.angle)
    whole = least_limit(tilts, lambda tilt: tilt.angle)
    found = [tilt for tilt in tilts if isinstance(tilt, TiltMargin)]
    if isinstance(whole, TiltMargin):
        lower, programs = min(t.lower for t in found), sum(t.programs for t in found)
        whole = replace(whole, lower=lower, programs=programs)
    return whole


def find_tilt_margin(
    program: Program, edges: Sequence[RoundEdge] = (), *, enough: float = np.inf
) -> TiltMargin | NoLimit:
    """The least tilt of gravity beyond which nothing holds; no limit if not held without tilt.

    Parts tip over the given round edges, and over the corners of all other contacts. The search
    may end with a smaller `lower` than `angle` if both are above atan(`enough`).

    Raises `ValueError` if there are given loads: they do not turn.

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
    shared = SharedCones(program)
    limits: list[Limit | NoLimit] = []
    known: list[tuple[Array, Limit]] = []

    def shoot(direction: Array) -> SupportPoint | None:
        wrench = gravity_wrench(program, direction @ basis)
        limit = held_limit(wrench, shared=shared, most=STEEPEST, edges=edges)
        limits.append(limit)
        if isinstance(limit, NoLimit):
            return None
        known.append((direction, limit))
        return _boundary(program, basis, direction, limit)

    first = first_directions(len(basis))
    # what forces may leave is no difference
    face = nearest_face(
        shoot,
        first,
        agree=TILT_AGREES,
        limit=PROGRAMS,
        most=STEEPEST,
        within=TOLERANCE,
        inside=None if program.planar else partial(held_distance, program, edges, known),
        enough=enough,
    )
    if face is None or NoLimit("none") in limits:
        return NoLimit("none" if NoLimit("none") in limits else "failed")
    limit = limits[face.answer]
    assert isinstance(limit, Limit)
    least = min(bound.value for bound in limits if isinstance(bound, Limit))
    if least < -TOLERANCE and judge(program).stable is False:
        return NoLimit("none")
    if face.outer >= STEEPEST * (1 - TILT_AGREES):  # unlimited in every direction
        angle = lower = np.pi / 2
        down, toward = program.down, np.zeros(3)
    else:
        toward = face.normal @ basis
        down, angle, lower = program.down, 0.0, 0.0
        if face.outer >= TOLERANCE:
            down = down + face.outer * toward
            down = down / float(np.linalg.norm(down))
            angle = float(np.arctan(face.outer))
            lower = max(float(np.arctan(face.inner)) - TOLERANCE, 0.0)
    return TiltMargin(
        angle=angle,
        lower=lower,
        down=down,
        toward=toward,
        limit=limit,
        shared=shared,
        programs=face.asked,
    )


def held_limit(
    wrench: Array, *, shared: SharedCones, most: float, edges: Sequence[RoundEdge] = ()
) -> Limit | NoLimit:
    """Compute the load limit of a program; no limit if the program without the load is not held."""

    def find(refined: Program) -> Limit | NoLimit:
        known = shared if refined is shared.program else None
        return find_limit(refined, wrench, most=most, shared=known, from_none=True)

    limit = limit_on_circles(shared.program, edges, find)
    below = isinstance(limit, Limit) and limit.value < NOT_HELD
    return NoLimit("none") if below else limit


def _boundary(program: Program, basis: Array, direction: Array, limit: Limit) -> SupportPoint:
    """Last stable point along a direction of tilt, with a line that bounds all stable points.

    On the line, the mechanism at the limit neither gains nor loses energy.
    """
    reach = max(min(limit.value, STEEPEST), 0.0)
    point = reach * direction
    if limit.motion is not None:
        moment = (program.mass * program.free) @ limit.motion.motion[:, :3]
        along = basis @ moment
        size = float(np.linalg.norm(along))
        distance = -float(program.down @ moment) / size if size > 0 else np.inf
        # where the line is no support (its motion too coarse), the point itself bounds
        if 0.0 <= distance <= reach * (1 + TILT_AGREES):
            return SupportPoint(point, along / size, distance)
    return SupportPoint(point, direction, reach)


def find_nearest_held(program: Program) -> NearestHeld | NoLimit:
    """The held direction of gravity nearest to the given direction, which is not held.

    A conic program projects the given direction onto the held directions; its error is the root of
    the solver's gap. Two exact limits refine this direction. The first limit is computed on the
    line from it toward the given direction. The mechanism of this limit gains no power on a plane
    of directions, whose nearest point bounds the angle from below. The second limit is computed
    on the line toward that point. The result is a `NoLimit` if no direction within a right angle
    is held, or if the solvers failed.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> slope = stacks.block_on_slope(10.0, friction=float(np.tan(np.radians(10.0) - 1e-7)))
    >>> found = find_nearest_held(build_program(slope, contacts(slope)))
    >>> bool(found.lower <= 1e-7 <= found.angle + 1e-12), round(found.angle * 1e7, 2)
    (True, 1.0)
    """
    nearest = _project_by_cones(program)
    if isinstance(nearest, NoLimit):
        return nearest
    angle, lower, held = float(angle_between(program.down, nearest)), 0.0, nearest
    motion: MotionProof | None = None
    aim, start = program.down, program.turned(nearest)
    for _ in range(NEARER):
        if not (aim - nearest).any():
            break
        limit = find_limit(start, gravity_wrench(program, aim - nearest), most=1.0)
        if isinstance(limit, NoLimit):
            break
        held_down = nearest + min(limit.value, 1.0) * (aim - nearest)
        held_down = held_down / float(np.linalg.norm(held_down))
        if (nearer := float(angle_between(program.down, held_down))) < angle:
            angle, held = nearer, held_down
        if limit.motion is None:
            break
        moment = (program.mass * program.free) @ limit.motion.motion[:, :3]
        normal = moment / max(float(np.linalg.norm(moment)), TINY)
        rise = float(program.down @ normal)
        if rise <= 0.0:
            break
        turn = min(float(np.arcsin(rise)) - TOLERANCE, angle)
        if turn > lower:
            lower, motion = turn, limit.motion
        if angle - lower <= 2 * TOLERANCE:
            break
        aim = program.down - rise * normal
        aim = aim / float(np.linalg.norm(aim))
    return NearestHeld(angle=angle, lower=lower, down=held, motion=motion)


def _project_by_cones(program: Program) -> Array | NoLimit:
    """Unit vector of the nearest held direction of gravity, by a conic program."""
    from kilter.solvers.clarabel import solve_conic

    axes = np.eye(3)[[0, 2]] if program.planar else np.eye(3)
    wrenches = np.array([gravity_wrench(program, axis) for axis in axes])
    nearest = nearest_load(cone_problem(program), wrenches, axes @ program.down)
    answer = solve_conic(nearest)
    if not answer.optimal:
        answer = solve_conic(nearest, tolerance=CONIC_SHARP)
    if not answer.optimal:
        return NoLimit("failed")
    vector = answer.x[-len(axes) :] @ axes
    size = float(np.linalg.norm(vector))
    return NoLimit("none") if size < NO_PROJECTION else vector / size


def across_gravity(program: Program) -> Array:
    """Directions perpendicular to gravity, shape (1, 3) for planar programs, else (2, 3)."""
    if program.planar:
        return cross(program.down, np.array([0.0, 1.0, 0.0]))[None]
    return np.stack(across(program.down))


def first_directions(dimension: int) -> Array:
    """Unit directions of a tilt that the search tries first, shape (n, dimension)."""
    if dimension == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * (np.arange(FIRST) + 0.5) / FIRST
    return np.column_stack([np.cos(angle), np.sin(angle)])


# Limits of tilt and loads that hold for all masses and centres of mass within intervals.


Unknowns = list[tuple[int, int]]
"""Uncertain quantities (part, axis): axis 3 is the mass, 0 to 2 a coordinate of the centre."""
STEEP = 1e3
"""Largest tangent of a tilt, and largest share of a load, in the linear program [-]."""
SHOTS = 16
"""Maximum number of directions in the search for the least tilt."""
SIMPLEX = 30_000
"""Largest number of matrix entries with which simplex runs before the interior-point method."""


class FollowingForces:
    """Limits of tilt and loads for uncertain masses, by forces affine in masses and centres.

    Arguments: `mass`: least and greatest factor of a mass [-]; the masses vary independently;
    `center`: greatest deviation of each coordinate of each centre of mass [length unit].
    """

    def __init__(
        self,
        program: Program,
        problem: ScaledProblem,
        unknowns: Unknowns,
        *,
        mass: tuple[float, float],
        center: float,
    ) -> None:
        self.program, self.problem, self.unknowns = program, problem, unknowns
        self.middle = 0.5 * (mass[0] + mass[1])
        self.spread = 0.5 * (mass[1] - mass[0])
        self.moment = center * mass[1]

    def _sides(self, direction: Array) -> Array:
        """Change of the scaled load with each uncertain quantity, for gravity along `direction`.

        Shape (K, rows).
        """
        program = self.program
        size = program.mass * program.g
        sides = []
        for part, axis in self.unknowns:
            wrench = np.zeros((len(program.names), 6))
            if axis == 3:
                wrench[part, :3] = self.spread * size[part] * direction
            else:
                wrench[part, 3:] = self.moment * size[part] * cross(np.eye(3)[axis], direction)
            sides.append(self.problem.scaled_load(wrench))
        return np.array(sides).reshape(len(sides), len(self.problem.right))

    def reach(
        self, wrench: Array | None, push: Array | None, most: float, sign: float = 1.0
    ) -> float | NoLimit:
        """Largest proved multiple of a load that holds for every mass and centre in the intervals.

        Arguments: `wrench` (N, 6) [N]; `push` (3,); `most` [-]. Returns share [-]; infinite if
        `most` exceeds `STEEP` and the share reaches it. `NoLimit` with reason "none" if the linear
        program is infeasible, else "failed".
        """
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
        return self._largest_share(load, most)

    def _largest_share(self, load: UncertainLoad, most: float) -> float | NoLimit:
        """Largest multiple of an uncertain load that any of several methods proves to be held."""
        from kilter.solvers.highs import solve_linear

        program = affine_forces(self.problem, load, min(most, STEEP))
        methods: tuple[Method, ...] = ("simplex", "interior")
        if program.matrix.nnz > SIMPLEX:
            methods = ("interior", "simplex")
        for method in methods:
            answer = solve_linear(program, method=method)
            if answer.outcome == "infeasible":
                return NoLimit("none")
            if not answer.optimal:
                continue
            if affine_imbalance(self.problem, load, answer.x) <= BALANCED:
                share = float(answer.x[0])
                return np.inf if most > STEEP and share >= STEEP * (1 - FOLLOWING_AGREES) else share
        return NoLimit("failed")

    def tilt(self) -> float | NoLimit:
        """Angle [rad] by which gravity may tilt, for all masses and centres in their intervals.

        The angle is a proved inner bound; `NoLimit` with reason "failed" if no bound is found.
        """
        basis = across_gravity(self.program)

        def shoot(direction: Array) -> SupportPoint | None:
            share = self.reach(None, direction @ basis, STEEP)
            if isinstance(share, NoLimit):
                return None
            return SupportPoint(share * direction, direction, share)

        first = first_directions(len(basis))
        face = nearest_face(shoot, first, agree=FOLLOWING_AGREES, limit=SHOTS)
        return NoLimit("failed") if face is None or face.failed else float(np.arctan(face.inner))
