"""Search for the enclosure of a round cone of held directions by proved rays and facets.

Each extreme ray of the outer cone is the target of an arc from inside
(`kilter.analysis.regions.cone_cutting`), or, until the inner cone has width and the outer cone a
tip, of a projection. Both bring a ray and a facet. `kilter.analysis.regions.cone_cutting` has the
formulas.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kilter.analysis.analysis_tolerances import (
    BEYOND_FACET,
    BEYOND_FAR,
    CONIC_SHARP,
    GAP_DEG,
    NO_DIRECTION,
    NO_PROJECTION,
    ON_PLANE,
    POINTED,
    PULLED_IN,
    RAY_BLUR,
    SAME_RAY,
    SHARE_AGREES,
    WIDEST_ARC,
)
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit, SharedCones, find_limit, gravity_wrench
from kilter.analysis.regions.cone_hull import (
    InnerHull,
    cone_around,
    edges_of,
    extreme_rays,
    inner_hull,
)
from kilter.analysis.regions.polyhedral_cone import widest_axis
from kilter.analysis.regions.stable_cone import DirectionProof, StableCone, stable_cone
from kilter.arrays import Array, Mask, angle_between, unit_rows
from kilter.errors import InputError, TimeLimitReached
from kilter.mechanics.balance_in_cones import ConeBalance, balance_in_cones
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import (
    ConeProblem,
    cone_problem,
    nearest_load,
    pyramid,
    pyramid_forces,
)
from kilter.mechanics.locked_parts import LockedParts, find_locked_parts
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.many_shares import SharePoint, first_point, many_shares
from kilter.validate import frozen

# Boundary points of the cone of held directions along arcs from a direction inside, with facets.


ENTRIES = 60_000
"""Entries of the columns of all programs that are solved side by side; more are solved in turn."""
LEAST = 4
"""Least number of programs that are solved side by side."""


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryRay:
    """A direction near the boundary of the cone of held directions, with candidates for proofs."""

    down: Array
    """Unit, shape (3,)."""
    forces: tuple[Array, Array]
    """Forces along and across the rows that hold it [N]."""
    motion: Array
    """Motion that starts beyond it, shape (N, 6)."""


class BoundaryRays:
    """Search for boundary directions of the cone of held directions of a program."""

    def __init__(self, locked: LockedParts, opening: Opening) -> None:
        self._locked, self._opening = locked, opening
        self._middles: list[tuple[Array, SharePoint]] = []
        program = locked.program
        none = np.zeros((len(program.names), 6))
        self._balance: ConeBalance = balance_in_cones(program, none, none, 1.0)
        wrenches = [gravity_wrench(program, axis) for axis in np.eye(3)]
        self._loads = np.array(
            [self._balance.with_more(wrench, 1.0).cones.along for wrench in wrenches]
        )

    @property
    def together(self) -> int:
        """Number of programs that are solved side by side."""
        return max(ENTRIES // int(self._balance.cones.columns[0].size), LEAST)

    def towards(self, start: Array, targets: Array) -> list[BoundaryRay | None]:
        """Boundary direction on the arc from a start inside the cone to each target outside.

        Arguments: `start` (3,); `targets` (D, 3): unit, not opposite to the start. Returns None if
        the search fails on an arc.
        """
        ways = _ways(start, targets)
        right = np.tensordot(start, self._loads, axes=1)
        along = np.tensordot(ways, self._loads, axes=1)
        starts = [self._start(target) for target in targets]
        shares = many_shares(self._balance.cones, right, along, starts, agree=SHARE_AGREES)
        found: list[BoundaryRay | None] = []
        for way, share in zip(ways, shares, strict=True):
            if share is None:
                found.append(None)
                continue
            reached = start + share.share * way
            size = float(np.linalg.norm(reached))
            down = reached / size
            self._middles.append((down, share.middle))
            forces = self._locked.forces(down, *self._balance.decoded(share.x / size))
            motion = self._locked.motion(self._balance.motion(-share.y))
            found.append(BoundaryRay(down, forces, motion))
        return found

    def _start(self, target: Array) -> SharePoint:
        """First point of the search towards a target, from the nearest known boundary direction."""
        if self._middles:
            return max(self._middles, key=lambda known: float(known[0] @ target))[1]
        m0 = self._opening.m0
        opening = None if m0 is None else -self._balance.multipliers(m0)
        return first_point(self._balance.cones, opening)


def _ways(start: Array, targets: Array) -> Array:
    """Vectors from a start towards targets, shortened to arcs of at most `WIDEST_ARC`."""
    aside = unit_rows(targets - np.outer(targets @ start, start))
    wide = np.cos(WIDEST_ARC) * start + np.sin(WIDEST_ARC) * aside
    far = targets @ start < np.cos(WIDEST_ARC)
    result: Array = np.where(far[:, None], wide, targets) - start
    return result


NEARER = 0.5
"""Fraction of the allowed angle within which a boundary ray is at the extreme ray: no facet is
added."""
GIVEN = 0.99
"""Largest absolute cosine between given gravity and the target of an arc that starts there [-]."""
PIECE = 0.05
"""Half of the angle of the pieces of an edge between whose ends distances are computed [rad]."""
PROGRAMS = 600
"""Conic programs after which the search ends with the gap that is left."""


class ConeCutting:
    """Refinement of the enclosure: rays proved inside the stable cone, and facets outside it.

    Arguments: `widest`: whether the widest circular cone inside is all that is sought.
    """

    def __init__(
        self, program: Program, progress: Callable[[str], None] | None, *, widest: bool = False
    ) -> None:
        self.program, self.progress, self.inscribed = program, progress, widest
        self.locked = find_locked_parts(program)
        self.small = self.locked.program
        self.wide: ConeProblem = cone_problem(self.small)
        self.opening = Opening(self.wide)
        axes = np.array([gravity_wrench(self.small, axis) for axis in np.eye(3)])
        # only the cost depends on the direction, so the matrices are built once
        self.nearest = nearest_load(self.wide, axes, np.zeros(3))
        self.arcs = BoundaryRays(self.locked, self.opening) if self.small.free.any() else None
        self.rays: list[DirectionProof] = []
        self.facets: list[DirectionProof] = []
        self.slack = 0.0
        self.seen = np.empty((0, 3))
        self.angle = np.empty(0)
        self.between: list[DirectionProof | None] = []
        self.programs = 0
        self.widest: float | None = None

    @property
    def normals(self) -> Array:
        """Outward unit normals of the facets around the stable cone, shape (f, 3)."""
        return -np.array([facet.vector for facet in self.facets]).reshape(-1, 3)

    def hull(self) -> InnerHull | None:
        """The inner cone, if it has width and the outer cone is pointed; else None."""
        normals = self.normals
        if len(normals) < 3 or len(self.rays) < 3:
            return None
        axis = -normals.sum(axis=0)
        length = float(np.linalg.norm(axis))
        outer = extreme_rays(normals)
        if length < POINTED or not len(outer) or float((outer @ axis).min()) < POINTED * length:
            return None
        return inner_hull(np.array([ray.vector for ray in self.rays]), axis / length)

    def cut(self, most: float) -> bool:
        """Cut off extreme rays of the outer cone that are farther than `most` from the inner cone.

        `most` is the largest allowed angle [rad]. Return whether the search goes on.
        """
        outer = extreme_rays(self.normals)
        hull = self.hull()
        if hull is None or self.arcs is None:
            return self._cut_from_given(outer) or self._cut_by_projection(outer, most)
        if self.programs >= PROGRAMS:
            return False
        distance = self._distances(outer, hull)
        self.widest = float(distance.max(initial=0.0))
        far = np.flatnonzero(distance > most)
        if self.inscribed:
            far = far[self._beyond_widest(outer[far], hull, most)]
        # the farthest first, so that an early end leaves the least gap
        far = far[np.argsort(-distance[far], kind="stable")][: self.arcs.together]
        failed = [k for k in far if not self._known_failure(outer[k])]
        if not failed:
            return False
        targets = outer[failed]
        self._tell(len(targets))
        start = widest_axis(hull.normals)
        missed = [
            target
            for target, ray in zip(targets, self.arcs.towards(start, targets), strict=True)
            if ray is None or not self._add(ray, target, most)
        ]
        if missed:
            self._cut_by_projection(np.array(missed), most)
        return True

    def _cut_from_given(self, outer: Array) -> bool:
        """Cut off extreme rays of the outer cone by arcs from the given gravity, if it is held.

        Until the inner cone has width, this takes the place of projections, which cost more. Return
        whether a facet was added.
        """
        start = self.program.down
        if self.arcs is None or not self.given_holds:
            return False
        targets = outer[(outer @ start < GIVEN) & (outer @ start > -GIVEN)]
        self._tell(len(targets))
        before = len(self.facets)
        for target, ray in zip(targets, self.arcs.towards(start, targets), strict=True):
            if ray is not None:
                self._add(ray, target, 0.0)
        return len(self.facets) > before

    @cached_property
    def given_holds(self) -> bool:
        """Whether forces hold the given direction of gravity, so that arcs may start there."""
        return judge(self.program).stable is True

    def _beyond_widest(self, far: Array, hull: InnerHull, most: float) -> Mask:
        """Mask of extreme rays beyond the facets of the inner cone that bound its widest cone.

        No ray counts if a circular cone within the outer cone is wider by at most `most` [rad].
        """
        axis = widest_axis(hull.normals)
        sines = hull.normals @ axis
        angle = np.arcsin(sines.min())
        outer = -self.normals
        if np.arcsin((outer @ widest_axis(outer)).min()) <= angle + most:
            return np.zeros(len(far), dtype=bool)
        bounding = hull.normals[np.arcsin(np.clip(sines, -1.0, 1.0)) <= angle + most]
        beyond: Mask = (far @ bounding.T < -ON_PLANE).any(axis=1)
        return beyond if beyond.any() else np.ones(len(far), dtype=bool)

    def _known_failure(self, direction: Array) -> bool:
        """Whether the arc to this direction was already tried without success."""
        return self._known_ray(direction) is not None

    def _tell(self, count: int) -> None:
        """Count programs, each of which decides a direction, and report the progress.

        The largest angle between an extreme ray and the inner cone bounds the gap of the region,
        as soon as the inner cone has a width.
        """
        self.programs += count
        if self.progress is not None:
            gap = "" if self.widest is None else f", gap {np.degrees(self.widest):.2g} deg"
            self.progress(f"region: directions decided {self.programs}{gap}")

    def _add(self, ray: BoundaryRay, target: Array, most: float) -> bool:
        """Add a boundary direction on the arc to a target and its facet; whether both are proved.

        The facet is left out if the direction is so near to the target that nothing is cut off.
        """
        proof = check_forces(self.program.turned(ray.down), *ray.forces)
        if not proof.holds:
            return False
        self.rays.append(DirectionProof("ray", ray.down, ray.down, proof))
        if angle_between(target, ray.down) <= NEARER * most:
            return True
        facet = self._facet(target, ray.down, ray.motion)
        if facet is not None:
            self.facets.append(facet)
        return facet is not None

    def _cut_by_projection(self, directions: Array, most: float) -> bool:
        """Project directions onto the stable cone, and cut off those that are farther than `most`.

        Return whether a direction was cut off.
        """
        is_cut = False
        for direction in directions:
            k = self._known_ray(direction)
            if k is None:
                if self.programs >= PROGRAMS:
                    return False
                angle, facet = self._project(direction)
                k = len(self.angle)
                self.seen = np.vstack([self.seen, direction])
                self.angle = np.append(self.angle, angle)
                self.between.append(facet)
            facet = self.between[k]
            if facet is not None and self.angle[k] > most:
                self.facets.append(facet)
                self.between[k] = None
                is_cut = True
        return is_cut

    def _known_ray(self, direction: Array) -> int | None:
        """Index of the known extreme ray that equals a direction; None if it is new."""
        near = np.linalg.norm(self.seen - direction, axis=1)
        return int(near.argmin()) if len(near) and near.min() < SAME_RAY else None

    def _project(self, direction: Array) -> tuple[float, DirectionProof | None]:
        """Angle from a direction to the stable cone [rad], and a proved facet between them, if any.

        None for the facet if it has no proof.
        """
        from kilter.solvers.clarabel import solve_conic

        if self.arcs is None:  # a squeeze holds every part, whatever the direction
            none = np.zeros((len(self.small.part_a), 3))
            self._ray(direction, self.locked.forces(direction, none[:, 0], none))
            return 0.0, None
        self._tell(1)
        cost = np.concatenate([self.nearest.cost[:-3], -direction])
        answer = solve_conic(replace(self.nearest, cost=cost), tolerance=CONIC_SHARP)
        if not answer.found:
            return self._from_within(direction, np.pi)
        nearest = answer.x[-3:]
        size = float(np.linalg.norm(nearest))
        angle = np.pi / 2
        if size > NO_PROJECTION:
            down = nearest / size
            forces = self.locked.forces(down, *self.wide.decoded(answer.x[:-3] / size))
            ray = self._ray(down, forces)
            angle = np.pi if ray is None else float(angle_between(direction, ray))
        if angle < SAME_RAY:
            return angle, None
        rows = len(self.wide.problem.right)
        motion = self.wide.problem.motion(self.wide.problem.over_weight(answer.multipliers[:rows]))
        motion = self.locked.motion(self.opening.mended(motion))
        facet = self._facet(direction, nearest, motion)
        return self._from_within(direction, angle) if facet is None else (angle, facet)

    def _ray(self, down: Array, forces: tuple[Array, Array]) -> Array | None:
        """Add a ray to the inner cone, moved inwards until forces prove it; None if none do."""
        proof = check_forces(self.program.turned(down), *forces)
        if proof.holds:
            self.rays.append(DirectionProof("ray", down, down, proof))
            return down
        middle: Array = np.sum([ray.vector for ray in self.rays] or [down], axis=0)
        for pull in PULLED_IN[1 if self.rays else 0 :]:
            moved: Array = down + pull * middle
            moved = moved / float(np.linalg.norm(moved))
            judged = judge(self.program.turned(moved))
            if judged.stable and judged.forces is not None:
                self.rays.append(DirectionProof("ray", moved, moved, judged.forces))
                return moved
        return None

    def _facet(
        self, direction: Array, base: Array, motion: Array, steps: Sequence[float] = BEYOND_FACET
    ) -> DirectionProof | None:
        """Facet, from a motion, that excludes a direction, with its proof; None without a proof."""
        normal = self._normal(motion)
        if normal @ direction <= ON_PLANE:
            return None
        length = float(np.linalg.norm(base))
        on = base / length if length > NO_PROJECTION else np.zeros(3)
        on = on - (on @ normal) * normal

        def judged(angle: float) -> DirectionProof:
            down = np.cos(angle) * on + np.sin(angle) * normal if on.any() else normal
            proof = check_motion(self.program.turned(down), motion)
            return DirectionProof("facet", -normal + 0.0, down, proof)

        # along the normal the power is greatest: a nearer angle proves nothing
        steepest = check_motion(self.program.turned(normal), motion)
        if not steepest.holds:
            return None
        for angle in steps:
            if angle * steepest.ratio < 1.0 or not judged(angle).certificate.holds:
                continue
            # twice as far as where it just holds: a reader's rounding is another
            facet = judged(2 * angle)
            if facet.certificate.holds:
                self.slack = max(self.slack, 2 * angle if on.any() else 0.0)
                return facet
        return None

    def _from_within(self, direction: Array, angle: float) -> tuple[float, DirectionProof | None]:
        """Angle to the stable cone and separating facet, by a search that starts at the known rays.

        In place of `_project`, if the conic program fails.
        """
        middle: Array = np.sum([ray.vector for ray in self.rays], axis=0)
        length = float(np.linalg.norm(middle)) if self.rays else 0.0
        if length < NO_DIRECTION:
            judged = judge(self.program.turned(direction))
            if judged.stable and judged.forces is not None:
                self.rays.append(DirectionProof("ray", direction, direction, judged.forces))
                return 0.0, None
            if judged.motion is None:
                return angle, None
            return angle, self._facet(direction, np.zeros(3), judged.motion.motion)
        start = middle / length
        way, at_start = gravity_wrench(self.small, direction - start), SharedCones(self.small)
        at_start.opening = self.opening
        at_start = at_start.turned(start)
        limit = find_limit(at_start.program, way, shared=at_start, most=1.0)
        if isinstance(limit, NoLimit):
            return angle, None
        share = min(limit.value, 1.0)
        toward = start + share * (direction - start)
        down = toward / float(np.linalg.norm(toward))
        ray = self._ray(down, self.locked.forces(down, *_scale_forces(limit.forces, toward)))
        angle = angle if ray is None else min(angle, float(angle_between(direction, ray)))
        if limit.motion is None:
            return angle, None
        motion = self.locked.motion(limit.motion.motion)
        return angle, self._facet(direction, toward, motion, BEYOND_FAR)

    def _normal(self, motion: Array) -> Array:
        """Outward unit normal of the facet that a motion proves: its mass-weighted sum."""
        normal: Array = (self.program.mass * self.program.free) @ motion[:, :3]
        size = float(np.linalg.norm(normal))
        return normal / size if size > 0.0 else normal

    def _distances(self, directions: Array, hull: InnerHull | None) -> Array:
        """Upper bounds of the angles between directions and the inner cone [rad], shape (D,)."""
        rays = np.array([ray.vector for ray in self.rays]).reshape(-1, 3)
        chords = np.linalg.norm(directions[:, None] - rays, axis=2).min(axis=1, initial=2.0)
        angle = 2 * np.arcsin(np.minimum(chords / 2, 1.0))
        for j, direction in enumerate(directions):
            k = self._known_ray(direction)
            if k is not None and self.angle[k] <= np.pi / 2:
                angle[j] = min(angle[j], self.angle[k] + SAME_RAY)
        nearest: Array = angle if hull is None else np.minimum(angle, hull.distances(directions))
        return nearest

    def answer(self) -> StableCone:
        """The enclosure by the rays and facets that were found."""
        hull = self.hull()
        kept = self.rays if hull is None else [self.rays[k] for k in hull.number]
        inner = cone_around(np.array([ray.vector for ray in kept]).reshape(-1, 3), RAY_BLUR)
        normals = self.normals
        outer = extreme_rays(normals)
        distance = self._distances(outer, hull)
        widest = float(distance.max(initial=0.0))
        for first, second, half in edges_of(normals, outer):
            widest = max(widest, self._along(outer[[first, second]], half, hull))
        gap = 0.0 if not len(outer) else min(widest + self.slack + inner.blur, np.pi)
        return StableCone(
            cone=inner,
            facets=frozen(-normals + 0.0),
            proofs=(*kept, *self.facets),
            programs=self.programs,
            exact=False,
            gap=gap,
            slack=self.slack,
        )

    def _along(self, ends: Array, half: float, hull: InnerHull | None) -> float:
        """Upper bound of the angles between an edge, of angle 2 `half`, and the inner cone [rad].

        Without a hull, only the distances of the two ends are known.
        """
        pieces = 1 if hull is None else int(np.ceil(half / PIECE))
        share = np.linspace(0.0, 1.0, pieces + 1)[:, None]
        points = unit_rows((1 - share) * ends[0] + share * ends[1])
        sines = np.sin(np.minimum(self._distances(points, hull), np.pi / 2))
        turns = np.einsum("ij,ij->i", points[1:], points[:-1])
        cosines = np.sqrt((1 + np.minimum(turns, 1.0)) / 2)
        worst = np.maximum(sines[1:], sines[:-1]) / np.maximum(cosines, np.cos(half))
        return float(np.arcsin(np.minimum(worst.max(initial=0.0), 1.0)))


def _scale_forces(proof: ForceProof, down: Array) -> tuple[Array, Array]:
    """Forces and friction for a unit direction, from a proof for a direction of any length."""
    length = float(np.linalg.norm(down))
    return proof.forces / length, proof.friction / length


# Directions of gravity that contacts with friction can hold, enclosed between two polyhedra.


SHARES = (0.9, 0.45, 0.2)
"""Distances up to which extreme rays of the outer cone are kept, as shares of the gap, in turn."""


def friction_cone(
    program: Program,
    *,
    gap_deg: float = GAP_DEG,
    widest: bool = False,
    progress: Callable[[str], None] | None = None,
) -> StableCone:
    """Enclose the directions of gravity that contacts with friction can hold.

    Arguments: `gap_deg`: [deg]; ends earlier, with the gap that is left, after `PROGRAMS` programs
    or at the limit of `kilter.work.stop_after`; `widest`: whether only the half angle of the widest
    circular cone inside must be known to within the gap. Raises `TimeLimitReached` if no direction
    is yet known to be held, or none yet known not to be. Raises `InputError` if loads are given:
    the set is then no cone.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> found = friction_cone(build_program(block, contacts(block)))
    >>> found.cone.kind, bool(found.gap < np.radians(0.1))
    ('cone', True)
    """
    if program.applied[program.free].any():
        raise InputError(
            "loads are given: their effect depends on the size of gravity, so the held directions"
            " are not a cone",
            hint="leave the loads out, or check a single direction",
        )
    if program.planar or not program.mu.any() or not program.free.any():
        return _exact(program, progress)
    search = ConeCutting(program, progress, widest=widest)
    try:
        for share in SHARES:
            while search.cut(share * np.radians(gap_deg)):
                pass
            cone = search.answer()
            if widest or cone.gap <= np.radians(gap_deg):
                break
    except TimeLimitReached:
        if not search.rays or not search.facets:
            raise
        return replace(search.answer(), is_cut=True)
    return cone


def _exact(program: Program, progress: Callable[[str], None] | None) -> StableCone:
    """The stable directions in the plane, exactly; a friction cone there has two rays."""
    rays = pyramid(program, 2)
    cone = stable_cone(rays, progress=progress)
    opening = Opening(cone_problem(program))

    def judged(proof: DirectionProof) -> ForceProof | MotionProof:
        turned, certificate = program.turned(proof.down), proof.certificate
        if isinstance(certificate, ForceProof):
            return check_forces(turned, *pyramid_forces(program, rays, certificate.forces))
        motion = check_motion(turned, certificate.motion)
        # what a simplex leaves of a violation is mended
        return motion if motion.holds else check_motion(turned, opening.mended(motion.motion))

    proofs = tuple(replace(proof, certificate=judged(proof)) for proof in cone.proofs)
    return replace(cone, proofs=proofs)
