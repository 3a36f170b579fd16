"""Directions of gravity that contacts with friction can hold, enclosed between two polyhedra.

    C = {g : exists f in K:  J^T f + W g = 0},   W g = (m_i g, 0)_i

is a convex cone; its boundary is round. A conic program projects a direction v onto it,

    min 1/2 |g - v|^2:  A f + B g = 0,  f in K

and if v is outside, it gives both: the ray g, with forces that prove it, and the facet
n = v - g, n.g' <= 0 for all g' of C, with a motion that proves it (Moreau: v is the sum of its
projections onto C and onto its polar cone; n is a sum of m_i dr_i of a motion in the dual cones).

The facets bound C from outside, the rays from inside. Each extreme ray v of the outer cone is
projected; if it is farther from C than half the required gap, its facet cuts it off.
The greatest angle that remains is the gap. The planes x = 0, y = 0, z = 0 divide the outer cone,
so that its edges span at most a right angle whatever the kind: on an edge between v_1 and v_2,
with an angle e between them, no direction is farther from C than

    asin(max(sin d_1, sin d_2) / cos(e / 2))

and within the outer cone no direction is farther than an edge. In a plane each cone of friction
has two rays, so C is polyhedral and found exactly (`kilter.analysis.regions.stable_cone`).

For each direction of C, forces that hold it exist. Whether it must stay there is another
question (`kilter.friction.answer`).

References
----------
R. Mattikalli, D. Baraff, P. Khosla, Finding all stable orientations of assemblies with
friction, IEEE Transactions on Robotics and Automation 12, 1996.
J. Moreau, Decomposition orthogonale d'un espace hilbertien selon deux cones mutuellement
polaires, 1962.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.margins.load_limit import NoLimit, find_limit, gravity_wrench
from kilter.analysis.regions.cone_hull import cone_around, edges_of, extreme_rays
from kilter.analysis.regions.stable_cone import DirectionProof, StableCone, stable_cone
from kilter.analysis.turning_tolerances import (
    BEYOND_FACET,
    BEYOND_FAR,
    CONIC_SHARP,
    GAP_DEG,
    NO_DIRECTION,
    NO_PROJECTION,
    ON_PLANE,
    PULLED_IN,
    RAY_BLUR,
    SAME_RAY,
)
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import (
    ConeProblem,
    cone_problem,
    nearest_load,
    pyramid,
    pyramid_forces,
)
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.validate import frozen

__all__ = ["friction_cone"]

SHARES = (0.5, 0.25, 0.1)
"""Distances up to which extreme rays of the outer cone are kept, as shares of the gap, in turn."""
PROGRAMS = 600
"""Conic programs after which the search ends with the gap that is left."""


def friction_cone(
    program: Program, *, gap_deg: float = GAP_DEG, progress: Callable[[str], None] | None = None
) -> StableCone:
    """Enclose the directions of gravity that contacts with friction can hold.

    Parameters
    ----------
    program : Program
        Its own gravity gives the size of the forces.
    gap_deg : float
        [deg]; ends earlier, with the gap that is left, after `PROGRAMS` programs.
    progress : callable, optional

    Raises
    ------
    InputError
        If loads are given: the set is then no cone.

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
    search = _Cutting(program, progress)
    for share in SHARES:
        while search.cut(share * np.radians(gap_deg)):
            pass
        cone = search.answer()
        if cone.gap <= np.radians(gap_deg):
            break
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


class _Cutting:
    """Refinement of the enclosure: rays proved inside the stable cone, and facets outside it."""

    def __init__(self, program: Program, progress: Callable[[str], None] | None) -> None:
        self.program, self.progress = program, progress
        self.wide: ConeProblem = cone_problem(program)
        self.opening = Opening(self.wide)
        axes = np.array([gravity_wrench(program, axis) for axis in np.eye(3)])
        # only the cost depends on the direction, so the matrices are built once
        self.nearest = nearest_load(self.wide, axes, np.zeros(3))
        self.rays: list[DirectionProof] = []
        self.facets: list[DirectionProof] = []
        self.slack = 0.0
        self.seen = np.empty((0, 3))
        self.angle = np.empty(0)
        self.between: list[DirectionProof | None] = []
        self.programs = 0

    @property
    def normals(self) -> Array:
        """Outward unit normals of the facets around the stable cone, shape (f, 3)."""
        return -np.array([facet.vector for facet in self.facets]).reshape(-1, 3)

    def cut(self, most: float) -> bool:
        """Cut extreme rays farther than `most` from the inner cone off the outer cone.

        `most` is the largest allowed angle [rad]. Return whether a ray was cut off.
        """
        is_cut = False
        for direction in extreme_rays(self.normals):
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

        self.programs += 1
        if self.progress is not None:
            self.progress(f"directions that are held: conic program {self.programs}")
        cost = np.concatenate([self.nearest.cost[:-3], -direction])
        answer = solve_conic(replace(self.nearest, cost=cost), tolerance=CONIC_SHARP)
        if not answer.found:
            return self._from_within(direction, np.pi)
        nearest = answer.x[-3:]
        size = float(np.linalg.norm(nearest))
        angle = np.pi / 2
        if size > NO_PROJECTION:
            ray = self._ray(nearest / size, self.wide.decoded(answer.x[:-3] / size))
            angle = np.pi if ray is None else _angle_between(direction, ray)
        if angle < SAME_RAY:
            return angle, None
        rows = len(self.wide.problem.right)
        motion = self.wide.problem.motion(self.wide.problem.over_weight(answer.multipliers[:rows]))
        facet = self._facet(direction, nearest, self.opening.mended(motion))
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

        for angle in steps:
            # twice as far as where it just holds: a reader's rounding is another
            farther = judged(2 * angle)
            if farther.certificate.holds and judged(angle).certificate.holds:
                self.slack = max(self.slack, 2 * angle if on.any() else 0.0)
                return farther
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
        opening, way = self.opening.turned(start), gravity_wrench(self.program, direction - start)
        limit = find_limit(opening.program, way, opening=opening, most=1.0)
        if isinstance(limit, NoLimit):
            return angle, None
        share = min(limit.value, 1.0)
        toward = start + share * (direction - start)
        ray = self._ray(toward / float(np.linalg.norm(toward)), _scale_forces(limit.forces, toward))
        angle = angle if ray is None else min(angle, _angle_between(direction, ray))
        if limit.mechanism is None:
            return angle, None
        return angle, self._facet(direction, toward, limit.mechanism.motion, BEYOND_FAR)

    def _normal(self, motion: Array) -> Array:
        """Outward unit normal of the facet that a motion proves: its mass-weighted sum."""
        normal: Array = (self.program.mass * self.program.free) @ motion[:, :3]
        size = float(np.linalg.norm(normal))
        return normal / size if size > 0.0 else normal

    def _distance(self, direction: Array, rays: Array) -> float:
        """Upper bound of the angle between a direction and the inner cone [rad]."""
        k = self._known_ray(direction)
        if k is not None and self.angle[k] <= np.pi / 2:
            return float(self.angle[k]) + SAME_RAY
        near = np.linalg.norm(rays - direction, axis=1).min(initial=2.0)
        return float(2 * np.arcsin(min(float(near) / 2, 1.0)))

    def answer(self) -> StableCone:
        """The enclosure by the rays and facets that were found."""
        rays = np.array([ray.vector for ray in self.rays]).reshape(-1, 3)
        inner = cone_around(rays, RAY_BLUR)
        normals = self.normals
        outer = extreme_rays(normals)
        distance = np.array([self._distance(v, rays) for v in outer])
        widest = float(distance.max(initial=0.0))
        for first, second, half in edges_of(normals, outer):
            sine = max(np.sin(min(distance[k], np.pi / 2)) for k in (first, second))
            widest = max(widest, float(np.arcsin(min(float(sine / np.cos(half)), 1.0))))
        gap = 0.0 if not len(outer) else min(widest + self.slack + inner.blur, np.pi)
        return StableCone(
            cone=inner,
            facets=frozen(-normals + 0.0),
            proofs=(*self.rays, *self.facets),
            programs=self.programs,
            exact=False,
            gap=gap,
            slack=self.slack,
        )


def _scale_forces(proof: ForceProof, down: Array) -> tuple[Array, Array]:
    """Forces and friction for a unit direction, from a proof for a direction of any length."""
    length = float(np.linalg.norm(down))
    return proof.forces / length, proof.friction / length


def _angle_between(first: Array, other: Array) -> float:
    """Angle between two unit vectors [rad]."""
    return float(2 * np.arcsin(min(float(np.linalg.norm(first - other)) / 2, 1.0)))
