"""The set of carrier accelerations at which the contacts hold an assembly in place.

The loads w(g) + B y of a carrier (`kilter.analysis.transport.carrier`) are linear in y = (a, al, O)
and the contact forces are a convex cone. So the set

    A = {y : J^T f + w(g) + B y = 0 for forces f in Coulomb's cones}

is convex. Without friction it is a polyhedron. Given loads and bonds are fixed in the carrier and
belong to w. For an acceleration a alone and without loads and bonds, A = g - S, with the cone S of
directions of gravity that `kilter.region` finds.

    farthest point    max t : J^T f + w(g) + t B y = 0: `kilter.analysis.load_limit`;
                      forces prove the point, a motion proves a plane beyond which A has no point
    least             the point of the boundary nearest to 0 among the horizontal accelerations
    slice             the boundary of a plane section: a polygon inside and planes outside
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from kilter.analysis.analysis_tolerances import TILT_AGREES
from kilter.analysis.load_limit import Limit, NoLimit, SharedCones, Why
from kilter.analysis.margins.tilt import across_gravity, held_limit
from kilter.analysis.margins.turned_forces import held_distance
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.analysis.transport.carrier import CarrierMotion, carrier_wrench
from kilter.analysis.transport.plane_section import SupportLine, enclose_section
from kilter.arrays import Array, Mask
from kilter.contact.round_edges import RoundEdge
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program
from kilter.tell.record import Lines, OrNull, Record, Rows

MOST = 100.0
"""An acceleration of at least this counts as unlimited [g]."""
PROGRAMS = 64
"""Largest number of limits for the least acceleration."""
NEARER = 16
"""Largest number of steps from the nearest plane to the plane of the limit along its normal."""
SAME_DIRECTION = 12
"""Decimals up to which two directions are the same question."""
ACCURACY = 1e-3
"""Largest distance between the polygon and the lines of a slice [g]."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastAcceleration:
    """The least horizontal acceleration of a carrier that no contact forces can balance."""

    value: float
    """[g]; infinite if every horizontal acceleration up to `MOST` is carried."""
    lower: float
    """Every horizontal acceleration below this is carried [g]."""
    direction: Array
    """Direction of the least acceleration, unit, shape (3,); zero if the value is infinite."""
    limit: Limit
    """The limit along this direction, with its forces and its mechanism."""
    programs: int
    """Number of limits that were computed."""


class Slice(Record):
    """Section of the set of carried accelerations with a plane through 0, in units of g."""

    axes: Lines
    """Orthonormal directions of acceleration that span the plane, shape (2, 3)."""
    points: Rows
    """Carried accelerations along the axes, counterclockwise; their hull is carried [g]."""
    limited: Mask
    """False for a point at the largest acceleration of the search."""
    proved: Mask
    """True for a line that a motion proves."""
    normals: Rows
    """Unit normals of lines: ``normals @ a <= reach`` for every carried a."""
    reach: Array
    """Distance of each line from 0, the farthest acceleration along its normal [g]."""
    gap: OrNull
    """Largest distance from an edge of the polygon to the lines beyond it [g]."""


@dataclass(frozen=True, eq=False)
class CarriedSet:
    """The set of accelerations for which contact forces hold the assembly in place.

    Arguments: `program`: contacts with friction, loads and bonds, under gravity without
    acceleration; `most`: largest acceleration of a search [g].

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import stacks
    >>> block = stacks.block_on_slope(0.0, friction=0.4)
    >>> carried = CarriedSet(build_program(block, contacts(block)))
    >>> round(carried.along([1.0, 0, 0]).value, 6)
    0.4
    """

    program: Program
    most: float = MOST
    edges: tuple[RoundEdge, ...] = ()

    @cached_property
    def _known(self) -> dict[tuple[float, ...], Limit | NoLimit]:
        """Limits along the directions of earlier questions."""
        return {}

    @cached_property
    def _shared(self) -> SharedCones:
        return SharedCones(self.program)

    def along(self, direction: Array | list[float]) -> Limit | NoLimit:
        """Largest acceleration [g] of a straight motion along a direction, shape (3,).

        The result is a `NoLimit` with the reason "none" if gravity alone is not held.
        """
        vector = np.asarray(direction, dtype=np.float64)
        vector = vector / float(np.linalg.norm(vector))
        key = tuple((vector.round(SAME_DIRECTION) + 0.0).tolist())
        if key not in self._known:
            self._known[key] = self._farthest(CarrierMotion(self.program.g * vector))
        return self._known[key]

    def share(self, motion: CarrierMotion) -> Limit | NoLimit:
        """Largest factor by which all accelerations of a carrier motion may be multiplied.

        The angular velocity counts by its square: the factor multiplies a, al and O alike.
        """
        return self._farthest(motion)

    def least(self) -> LeastAcceleration | NoLimit:
        """The least horizontal acceleration, in any direction, that contact forces cannot hold.

        The nearest plane outside the set is a bound in the direction of its normal, not in the
        direction whose limit brought it. So the limit of the result is that along the normal.
        """
        basis = across_gravity(self.program)
        whys: list[Why] = []
        known: list[tuple[Array, Limit]] = []

        def reach(direction: Array) -> SupportPoint | None:
            limit = self.along(direction @ basis)
            if isinstance(limit, NoLimit):
                whys.append(limit.why)
                return None
            known.append((direction, limit))
            support = self._support(basis, direction, limit)
            return SupportPoint(support.point, support.normal, support.reach)

        face = nearest_face(
            reach,
            np.vstack([np.eye(len(basis)), -np.eye(len(basis))]),
            agree=TILT_AGREES,
            limit=PROGRAMS,
            most=self.most,
            within=TOLERANCE,
            inside=None
            if len(basis) == 1
            else partial(held_distance, self.program, self.edges, known),
        )
        if face is None or whys:
            return NoLimit("none" if "none" in whys else "failed")
        outer, normal = face.outer, face.normal
        limit = self.along(normal @ basis)
        steps = 1
        while isinstance(limit, Limit) and np.isfinite(limit.value) and steps < NEARER:
            support = self._support(basis, normal, limit)
            if support.reach >= outer * (1 - TILT_AGREES) - TOLERANCE:
                break
            outer, normal, steps = support.reach, support.normal, steps + 1
            limit = self.along(normal @ basis)
        if isinstance(limit, NoLimit):
            return limit
        programs = face.asked + steps
        if outer >= self.most * (1 - TILT_AGREES):
            return LeastAcceleration(np.inf, self.most, np.zeros(3), limit, programs)
        value = min(outer, limit.value)
        lower = max(min(face.inner, value) - TOLERANCE, 0.0)
        return LeastAcceleration(value, lower, normal @ basis, limit, programs)

    def slice(self, axes: Array, *, accuracy: float = ACCURACY) -> Slice | NoLimit:
        """Boundary of the carried accelerations in a plane, as a polygon with lines around it.

        Arguments: `axes` (2, 3): orthonormal directions that span the plane; `accuracy`: the search
        ends if polygon and lines differ by at most this [g].
        """

        def support(direction: Array) -> SupportLine | NoLimit:
            limit = self.along(direction @ axes)
            if isinstance(limit, NoLimit):
                return limit
            return self._support(axes, direction, limit)

        section = enclose_section(support, accuracy=accuracy)
        if isinstance(section, NoLimit):
            return section
        supports, gap = section
        return Slice(
            axes=axes,
            points=np.array([support.point for support in supports]),
            normals=np.array([support.normal for support in supports]),
            reach=np.array([support.reach for support in supports]),
            limited=np.array([support.limited for support in supports]),
            proved=np.array([support.proved for support in supports]),
            gap=gap,
        )

    def _farthest(self, motion: CarrierMotion) -> Limit | NoLimit:
        """Largest factor of a carrier motion, with forces and mechanism at the limit."""
        wrench = carrier_wrench(self.program, motion)
        known = self._shared.known_limit(wrench)
        if known is not None:
            return known
        return held_limit(wrench, shared=self._shared, most=self.most, edges=self.edges)

    def _support(self, axes: Array, direction: Array, limit: Limit) -> SupportLine:
        """Boundary point along a direction in the plane, and its bounding line, in [g].

        No acceleration beyond the line is carried.
        """
        reach = max(min(limit.value, self.most), 0.0)
        point = reach * direction
        limited = bool(np.isfinite(limit.value))
        if limit.motion is None:
            return SupportLine(direction, point, direction, reach, limited, False)
        program, motion = self.program, limit.motion.motion
        moment = (program.mass * program.free) @ motion[:, :3]
        # the power of the load w(g) - m g a on the motion is not positive for any carried a
        outward = -(axes @ moment) * program.g
        size = float(np.linalg.norm(outward))
        distance = -program.power(motion) / size if size > 0.0 else np.inf
        if not 0.0 <= distance <= reach * (1 + TILT_AGREES) + TOLERANCE:
            return SupportLine(direction, point, direction, reach, limited, False)
        return SupportLine(direction, point, outward / size, distance, limited, True)
