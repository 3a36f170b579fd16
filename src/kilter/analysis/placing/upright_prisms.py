"""Upright prisms: parts with a horizontal convex top, and the part that is put down on them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely

from kilter.analysis.placing.polygon_sets import NOTHING, both, cleaned, union, without
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.patches import PossibleContacts
from kilter.contact.common.polygons import cut_convex
from kilter.mechanics.certificate import check_motion, needed_power
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.load_checks import shifted_weights
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows, pushing_rows

UPRIGHT = 1e-6
"""Largest relative difference of volume between an upright prism and a part [-]; a larger value
accepts parts whose sides lean."""


@dataclass(frozen=True, eq=False)
class Top:
    """The horizontal top of an upright prism of an assembly."""

    part: int
    polygon: shapely.Geometry
    """Convex, in the plane x, y."""
    low: float
    high: float
    """Heights of bottom and top [length unit]."""
    upright: bool
    """False for a part of another form: its bounding box stands for it, and nothing is known
    about places on it."""

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Normals and offsets of the edges of the polygon (`edges_of`)."""
        return edges_of(shapely.get_coordinates(self.polygon)[:-1])


@dataclass(frozen=True, eq=False)
class PlacedPrism:
    """The part that is put down: an upright convex prism."""

    footprint: Array
    """Corners of its underside, counterclockwise, relative to the centre of mass, shape (n, 2)."""
    below: float
    above: float
    """Distance of the centre of mass from the underside and from the top [length unit]."""
    mass: float
    """[kg]"""
    inertia: Array
    """About the centre of mass [kg x length unit^2], shape (3, 3)."""
    radius: float
    """Bounding radius [length unit]."""

    @property
    def height(self) -> float:
        """Height of the prism [length unit]."""
        return self.below + self.above

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Normals and offsets of the edges of the footprint, about the centre (`edges_of`)."""
        return edges_of(self.footprint)

    @property
    def size(self) -> float:
        """Larger extent of the footprint along x or y [length unit]."""
        return float(np.ptp(self.footprint, axis=0).max())


def find_tops(assembly: Assembly) -> list[Top]:
    """The top of each part; the vertical is the z axis."""
    return [_top(assembly.geometry, k) for k in range(len(assembly.parts))]


def _top(geometry: Geometry, k: int) -> Top:
    vertices = geometry.vertices[geometry.vertex_start[k] : geometry.vertex_start[k + 1]]
    low, high = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    hull = shapely.convex_hull(shapely.multipoints(vertices[:, :2]))
    upright = _is_upright(vertices, hull.area, float(geometry.volume[k]))
    curved = geometry.surfaces.start[k + 1] > geometry.surfaces.start[k]
    return Top(k, hull, low, high, upright and not curved)


def _is_upright(vertices: Array, area: float, volume: float) -> bool:
    """Whether vertices and volume are those of an upright convex prism."""
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    size = max(float(np.ptp(vertices, axis=0).max()), 1e-300)
    ends = np.minimum(vertices[:, 2] - low, high - vertices[:, 2])
    if (ends > UPRIGHT * size).any():
        return False
    box = area * float(high - low)
    return bool(abs(volume - box) <= UPRIGHT * max(volume, box))


def placed_prism(assembly: Assembly) -> PlacedPrism | None:
    """The only part of an assembly as a prism to put down; None if it is no upright prism."""
    geometry = assembly.geometry
    top = _top(geometry, 0)
    if not top.upright:
        return None
    center = geometry.center[0]
    ring = shapely.normalize(shapely.Polygon(top.polygon)).exterior
    corners = np.array(ring.coords)[:-1] - center[:2]
    if not shapely.is_ccw(ring):
        corners = corners[::-1]
    return PlacedPrism(
        corners,
        float(center[2] - top.low),
        float(top.high - center[2]),
        float(geometry.mass[0]),
        geometry.inertia[0],
        float(geometry.radius[0]),
    )


def shifted(footprint: Array, place: Sequence[float]) -> shapely.Geometry:
    """The underside of the part with its centre at a place."""
    return shapely.polygons(footprint + np.asarray(place))


def swept(footprint: Array, low: Array, high: Array, *, union: bool) -> shapely.Geometry:
    """The points under the part for some place of a rectangle (`union`), or for each place.

    The part is convex, so the corners of the rectangle decide.
    """
    corners = [(u, v) for u in (low[0], high[0]) for v in (low[1], high[1])]
    if union:
        points = np.concatenate([footprint + corner for corner in corners])
        return shapely.convex_hull(shapely.multipoints(points))
    return shapely.intersection_all([shifted(footprint, corner) for corner in corners])


def edges_of(ring: Array) -> tuple[Array, Array]:
    """Outward unit normals A, shape (n, 2), and offsets b, shape (n,), of a convex polygon.

    Its corners, shape (n, 2), are in either order; the polygon is the set A p <= b.

    Examples
    --------
    >>> normals, offsets = edges_of(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]))
    >>> (normals[1] + 0.0).tolist(), float(offsets[1])
    ([1.0, 0.0], 2.0)
    """
    along = np.roll(ring, -1, axis=0) - ring
    length = np.linalg.norm(along, axis=1)
    ring, along = ring[length > 0], along[length > 0] / length[length > 0, None]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    offsets = np.einsum("ij,ij->i", normals, ring)
    inward = float((normals @ ring.mean(axis=0) - offsets).sum()) > 0
    return (-normals, -offsets) if inward else (normals, offsets)


# Landings: heights at which a part comes to rest when it is lowered, and what it touches there.


BORDER = 1e-9
"""Distance from the border of a rectangle of places within which areas of contact may vanish [sizes
of the part]: rounding of the border."""
EDGE = 1e-6
"""Perimeter above which an area of contact of almost no width counts [sizes of the part]."""


@dataclass(frozen=True, eq=False)
class Landing:
    """Places at which the part rests at one height."""

    height: float
    """Height of its underside [length unit]."""
    tops: list[Top]
    """Tops of this height."""
    here: shapely.Geometry
    """Centres of mass at which it rests on some of these tops."""

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree([top.polygon for top in self.tops])

    def near(self, low: Array, high: Array, margin: float) -> list[Top]:
        """The tops whose bounds are within a margin of a rectangle [length unit]."""
        around = shapely.box(*(low - margin), *(high + margin))
        return [self.tops[k] for k in np.sort(self._tree.query(around)).tolist()]


@dataclass(eq=False)
class Landings:
    """Landings of a part on the tops of an assembly.

    Arguments: `same_height`: tops within this height count as level [length unit]; `clear`:
    distance to keep from parts beside it [length unit].
    """

    tops: list[Top]
    part: PlacedPrism
    same_height: float
    clear: float = 0.0

    def at(self, domain: shapely.Geometry) -> list[Landing]:
        """The landings in a domain of centres of mass, the lowest first."""
        areas = [self.reach[top.part] for top in self.tops]
        tree, high = shapely.STRtree(areas), np.array([top.high for top in self.tops])
        found = []
        for height, tops in self._heights():
            touched = union([self.reach[top.part] for top in tops])
            near = tree.query(touched)
            above = near[high[near] > max(top.high for top in tops)]
            here = both(without(touched, union([areas[k] for k in above.tolist()])), domain)
            here = cleaned(without(here, self._blocked(height)))
            if here.area > 0:
                found.append(Landing(height, tops, here))
        return found

    @cached_property
    def reach(self) -> dict[int, shapely.Geometry]:
        """For each part of the assembly, the centres at which the footprint overlaps its top."""
        return {top.part: self._touched_by(top) for top in self.tops}

    def only(self, landing: Landing, top: Top) -> shapely.Geometry:
        """Places of a landing at which the part touches this top alone."""
        own = self.reach[top.part]
        low, high = np.array(own.bounds).reshape(2, 2)
        near = landing.near(low, high, 2 * self.part.size)
        others = [self.reach[other.part] for other in near if other is not top]
        return without(both(landing.here, own), union(others))

    def areas(
        self, tops: list[Top], low: Array, high: Array, *, any_place: bool
    ) -> dict[int, shapely.Geometry]:
        """Area of contact on each top in a rectangle of places.

        The area that all places have, or that some place has (`any_place`). If the part begins to
        touch a top at the border of the rectangle, all places inside have an edge of the top in
        common, as an area of almost no width.
        """
        under = swept(self.part.footprint, low, high, union=any_place)
        size, areas = self.part.size, {}
        bounds, around = shapely.bounds([top.polygon for top in tops]), under.buffer(size).bounds
        apart = (bounds[:, :2] > around[2:]) | (bounds[:, 2:] < around[:2])
        for top, far in zip(tops, apart.any(axis=1).tolist(), strict=True):
            if far:
                continue
            area = both(top.polygon, under)
            if not any_place and area.area <= NOTHING * top.polygon.area and not under.is_empty:
                area = both(top.polygon, under.buffer(BORDER * size, join_style="mitre"))
                if area.length > EDGE * size:
                    areas[top.part] = area
            elif area.area > NOTHING * top.polygon.area:
                areas[top.part] = area
        return areas

    def _heights(self) -> list[tuple[float, list[Top]]]:
        """Heights of tops, ascending, with the tops of each height."""
        groups: list[tuple[float, list[Top]]] = []
        for top in sorted(self.tops, key=lambda top: top.high):
            if groups and top.high - groups[-1][0] <= self.same_height:
                groups[-1][1].append(top)
            else:
                groups.append((top.high, [top]))
        return groups

    def _touched_by(self, top: Top) -> shapely.Geometry:
        """Centres at which the footprint of the part overlaps a top (Minkowski sum)."""
        ring = shapely.get_coordinates(top.polygon)[:-1]
        points = (ring[:, None] - self.part.footprint[None]).reshape(-1, 2)
        return shapely.convex_hull(shapely.multipoints(points))

    def _blocked(self, height: float) -> shapely.Geometry:
        """Centres at which a part beside it is nearer than `clear`."""
        if not self.clear > 0:
            return shapely.Polygon()
        beside = [
            self._touched_by(top).buffer(self.clear, join_style="mitre")
            for top in self.tops
            if top.high > height + self.same_height and top.low < height + self.part.height
        ]
        return union(beside)


# The programs of an assembly with a part at a place: its weight on a top, or its contacts.


NEW = "new part"
"""Name of the part that is put down."""


@dataclass(eq=False)
class PlacedLoads:
    """Programs of an assembly with a further part.

    Arguments: `friction`: friction coefficient of the part on the tops [-].
    """

    program: Program
    part: PlacedPrism
    friction: float
    _on_parts: dict[tuple[int, ...], Program] = field(default_factory=dict)

    def on_top(self, top: Top, place: Array) -> tuple[Program, Array]:
        """The program with the weight on a top at a place, and its change per shift, (2, N, 6)."""
        point = np.append(place, top.high)
        weight = self.part.mass * self.program.gravity
        base = np.zeros((len(self.program.names), 6))
        base[top.part, :3] = weight
        base[top.part, 3:] = np.cross(point - self.program.center[top.part], weight)
        loaded = self.program.with_rows(applied=self.program.applied + base)
        return loaded, self._torques(top.part, len(self.program.names))

    def on_areas(
        self, areas: dict[int, shapely.Geometry], height: float, place: Array
    ) -> tuple[Program, Array]:
        """The program with the part at a place and contacts at the corners of fixed areas.

        Also the change of the load per shift of the part, (2, N + 1, 6).
        """
        corners = [shapely.get_coordinates(area)[:-1] for area in areas.values()]
        under = tuple(
            support for support, ring in zip(areas, corners, strict=True) for _ in range(len(ring))
        )
        if under not in self._on_parts:
            self._on_parts[under] = self._with_part(under)
        level = np.concatenate(corners)
        point = np.column_stack([level, np.full(len(level), height)])
        return self._on_parts[under].with_rows(
            point=np.vstack([self.program.point, point]),
            center=np.vstack([self.program.center, [*place, height + self.part.below]]),
        ), self.torques_of_part

    @cached_property
    def alone(self) -> ScaledProblem:
        """Equilibrium with the part and without contacts below it: the first columns of all."""
        return scaled_problem(self._with_part(()))

    def _with_part(self, under: tuple[int, ...]) -> Program:
        """The program with the part and a contact row for each entry; places are not set."""
        program, part = self.program, self.part
        count = len(under)
        pushes = PossibleContacts(
            np.array(under, dtype=np.int64),
            np.full(count, len(program.names)),
            np.zeros((count, 3)),
            np.tile([0.0, 0.0, 1.0], (count, 1)),
            np.zeros(count, dtype=bool),
            np.zeros(count),
            np.full(count, -1),
        )
        rows = pushing_rows(pushes)
        rows = replace(rows, kind=np.full(count, CONTACT), mu=np.full(count, self.friction))
        parts = {
            "names": (*program.names, NEW),
            "free": np.append(program.free, True),
            "center": np.vstack([program.center, np.zeros(3)]),
            "mass": np.append(program.mass, part.mass),
            "inertia": np.concatenate([program.inertia, part.inertia[None]]),
            "radius": np.append(program.radius, part.radius),
            "applied": np.vstack([program.applied, np.zeros(6)]),
            "clamp": np.vstack([program.clamp, np.zeros(6)]),
            "tolerance": np.append(program.tolerance, TOLERANCE),
        }
        joined = ForceRows.join([program.force_rows, rows])
        return program.with_rows(**parts).with_force_rows(joined)

    @cached_property
    def torques_of_part(self) -> Array:
        """Change of the load per shift of the part along x and y, (2, N + 1, 6)."""
        count = len(self.program.names)
        return self._torques(count, count + 1)

    def _torques(self, part: int, count: int) -> Array:
        """Change of the wrench on a part per shift of the weight along x and y, (2, count, 6)."""
        more = np.zeros((2, count, 6))
        for axis in (0, 1):
            more[axis, part, 3:] = np.cross(np.eye(3)[axis], self.part.mass * self.program.gravity)
        return more


# The places that a motion leaves to a prism on tops: convex polygons, without cells of places.


PARALLEL = 1e-12
"""Sine of the angle below which two edges are parallel [-]."""


def least_rates(
    top: tuple[Array, Array], part: tuple[Array, Array], constant: float, gradient: Array
) -> Array:
    """Affine functions of the place that bound the least rate in K(x) from below.

    Arguments: `gradient` (2,). Returns (m, 3): rows (c, s_1, s_2): the rate is at least c + s . x.
    The largest is the least rate.

    Examples
    --------
    The least first coordinate on the square [0, 2]^2 under [-1, 1]^2 + x is max(0, x_1 - 1):

    >>> from kilter.analysis.placing.upright_prisms import edges_of
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> rows = least_rates(edges_of(square), edges_of(square - 1), 0.0, np.array([1.0, 0]))
    >>> np.unique(rows + 0.0, axis=0).tolist()
    [[-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]
    """
    if not gradient.any():
        return np.array([[constant, 0.0, 0.0]])
    normals, offsets = np.vstack([top[0], part[0]]), np.append(top[1], part[1])
    moves = np.arange(len(offsets)) >= len(top[1])
    first, second = np.triu_indices(len(offsets), 1)
    one, two = normals[first], normals[second]
    sine = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (gradient[1] * two[:, 0] - gradient[0] * two[:, 1]) / sine
        b = (gradient[0] * one[:, 1] - gradient[1] * one[:, 0]) / sine
        # a multiplier that is negative by rounding alone belongs to a gradient along an edge
        least = -1e-13 * float(np.abs(gradient).max())
        chosen = (np.abs(sine) > PARALLEL) & (a >= least) & (b >= least)
    first, second = first[chosen], second[chosen]
    a, b = np.maximum(a[chosen], 0.0), np.maximum(b[chosen], 0.0)
    slope = (a * moves[first])[:, None] * normals[first]
    slope += (b * moves[second])[:, None] * normals[second]
    return np.column_stack([constant - a * offsets[first] - b * offsets[second], -slope])


def places_left(
    loads: PlacedLoads,
    tops: Iterable[Top],
    height: float,
    low: Array,
    high: Array,
    motion: Array,
) -> shapely.Geometry:
    """The places of a rectangle that a motion does not exclude, of a part without friction.

    Arguments: `height`: height of the underside of the part [length unit]; `low`, `high` (2,): the
    rectangle of centres [length unit]; `motion` (N + 1, 6): motion of all parts and of the added
    part, whose contacts are not yet known to open.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    alone = loads.alone.program
    center = np.vstack([loads.program.center, [*middle, height + loads.part.below]])
    program = alone.with_rows(center=center)
    judged = check_motion(program, motion)
    if not judged.motion.any():
        return shapely.box(*low, *high)
    wrenches = loads.torques_of_part
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    weights = shifted_weights(program, np.tensordot(corners, wrenches, axes=1))
    # the power that a proof needs grows with the load: convex in x, so the corners bound it
    needed = needed_power(program, judged, weights)
    slope = np.einsum("kij,ij->k", wrenches[:, program.free], judged.motion[program.free])
    power = np.array([judged.power - needed - slope @ middle, *slope])
    weight = loads.part.mass * loads.program.g
    constant, gradient = _rise(program, judged.motion, len(program.names) - 1)
    rectangle = middle + corners
    pieces = []
    for top in tops:
        under, along = _rise(program, judged.motion, top.part)
        rates = least_rates(top.edges, loads.part.edges, constant - under, gradient - along)
        ring = _without_positive(rectangle, power + weight * rates)
        # corners that are equal up to rounding are no corners of the hull
        pieces.append(shapely.convex_hull(shapely.multipoints(ring)))
    return union(pieces)


def _rise(program: Program, motion: Array, part: int) -> tuple[float, Array]:
    """Vertical velocity of a part at the point p: constant + gradient . p; 0 for a held part."""
    if not program.free[part]:
        return 0.0, np.zeros(2)
    gradient = np.array([-motion[part, 4], motion[part, 3]])
    return float(motion[part, 2] - gradient @ program.center[part, :2]), gradient


def _without_positive(ring: Array, rows: Array) -> Array:
    """Corners of the part of a convex polygon in which no affine function is positive."""
    values = rows[:, :1] + rows[:, 1:] @ ring.T
    if (values.min(axis=1) > 0).any():
        return np.empty((0, 2))
    for row in rows[values.max(axis=1) > 0]:
        ring = cut_convex(ring, -(row[0] + ring @ row[1:]))
        if len(ring) < 3:
            break
    return ring
