"""The map of places: at which centres (x, y) does the next part stand?

The part is lowered straight down, so its height at a place is that of the highest top under its
footprint. All tops of one height on which it rests decide:

    a single top       the forces under the part are equal to its weight at its centre, so it stands
                       exactly where the centre is on the top and a load there is carried
    several tops       the area of contact moves with the part. In a rectangle of places, the area
                       that all places have gives places that surely stand; the area that any place
                       has gives places that surely fall. Rectangles are halved until both agree

Places flush with the side of a neighbour have further contacts, which the map does not contain:
it states nothing about them beyond the places that stand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from kilter.analysis.placing.shifted_load import CarriedPlaces, ShiftedLoad
from kilter.analysis.placing.upright_prisms import PlacedPrism, Top, swept
from kilter.arrays import Array
from kilter.contact.left_out import PossibleContacts
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows, pushing_rows

__all__ = ["LevelMap", "PlaceMap"]

MOST_PROGRAMS = 20_000
"""Largest number of programs of a map; places that are not decided then stay open."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelMap:
    """Places at which the part rests at one height.

    Attributes
    ----------
    height : float
        Height of its underside [length unit].
    stands, falls : shapely geometry
        Places that forces prove, and places that motions exclude.
    open : shapely geometry
        The other places.
    """

    height: float
    stands: shapely.Geometry
    falls: shapely.Geometry
    open: shapely.Geometry


@dataclass(eq=False)
class PlaceMap:
    """Computes the map of places of a part on an assembly of upright prisms.

    Parameters
    ----------
    program : Program
        The assembly without the part.
    tops : list of Top
    part : PlacedPrism
    strip : float
        Largest width of the open strip between places that stand and places that fall
        [length unit].
    same_height : float
        Tops within this height count as level [length unit].
    friction : float
        Friction coefficient of the part on the tops [-].
    clear : float
        Distance to keep from parts beside it [length unit].
    """

    program: Program
    tops: list[Top]
    part: PlacedPrism
    strip: float
    same_height: float
    friction: float
    clear: float = 0.0
    programs: int = 0

    def levels(self, domain: shapely.Geometry) -> list[LevelMap]:
        """The map of a domain of centres, a level for each height, the lowest first."""
        reach = {top.part: self._touched_by(top) for top in self.tops}
        heights = self._heights()
        above: shapely.Geometry = shapely.Polygon()
        found = []
        for height, tops in reversed(heights):
            at = _any_of([reach[top.part] for top in tops])
            here = _both(_without(at, above), domain)
            above = _any_of([above, at])
            here = _without(here, self._blocked(height))
            if here.area > 0:
                found.append(self._level(height, tops, here, reach))
        return found[::-1]

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
        return _any_of(beside)

    def _level(
        self,
        height: float,
        tops: list[Top],
        here: shapely.Geometry,
        reach: dict[int, shapely.Geometry],
    ) -> LevelMap:
        stands, falls = [], []
        shared = here
        for top in tops:
            others = [reach[other.part] for other in tops if other is not top]
            only = _both(here, reach[top.part])
            only = _without(only, _any_of(others))
            if not only.area > 0:
                continue
            shared = _without(shared, only)
            if top.upright:
                carried = self._on_single(top)
                stands.append(_both(only, carried.inner))
                falls.append(_without(only, carried.outer))
        known = [top for top in tops if top.upright]
        for piece in _polygons(shared):
            inside, outside = self._on_several(known, tops, height, piece)
            stands.append(inside)
            falls.append(outside)
        inner, out = _any_of(stands), _any_of(falls)
        left = _without(here, _any_of([inner, out]))
        return LevelMap(height, inner, out, left)

    def _on_single(self, top: Top) -> CarriedPlaces:
        """Places of the part on a single top: those at which the top carries its weight."""
        if not self.program.free[top.part]:  # the part has no effect on the assembly
            nowhere = shapely.Polygon()
            proved, possible = not self._alone.inner.is_empty, not self._alone.outer.is_empty
            return CarriedPlaces(
                top.polygon if proved else nowhere, top.polygon if possible else nowhere, 0
            )
        low, high = np.array(top.polygon.bounds[:2]), np.array(top.polygon.bounds[2:])
        middle = (low + high) / 2
        point = np.append(middle, top.high)
        weight = self.part.mass * self.program.gravity
        base = np.zeros((len(self.program.names), 6))
        base[top.part, :3] = weight
        base[top.part, 3:] = np.cross(point - self.program.center[top.part], weight)
        loaded = self.program.with_rows(applied=self.program.applied + base)
        more = self._torques(top.part, len(self.program.names))
        half = (high - low) / 2
        found = ShiftedLoad(loaded, more, -half, half).places(self.strip)
        self.programs += found.programs
        return CarriedPlaces(
            _both(_moved(found.inner, middle), top.polygon),
            _both(_moved(found.outer, middle), top.polygon),
            found.programs,
        )

    @cached_property
    def _alone(self) -> CarriedPlaces:
        """Whether the assembly stands without the part: all places of a square, or none."""
        none = np.zeros((2, len(self.program.names), 6))
        found = ShiftedLoad(self.program, none, -np.ones(2), np.ones(2)).places(1.0)
        self.programs += found.programs
        return found

    def _torques(self, part: int, count: int) -> Array:
        """Change of the wrench on a part per shift of the weight along x and y, (2, N, 6)."""
        more = np.zeros((2, count, 6))
        for axis in (0, 1):
            more[axis, part, 3:] = np.cross(np.eye(3)[axis], self.part.mass * self.program.gravity)
        return more

    def _on_several(
        self, known: list[Top], tops: list[Top], height: float, piece: shapely.Geometry
    ) -> tuple[shapely.Geometry, shapely.Geometry]:
        """Places of a polygon that stand, and places that fall, on several tops of one height."""
        bounds = np.array(piece.bounds)
        cuts = [self._cuts(tops, axis, bounds[axis], bounds[axis + 2]) for axis in (0, 1)]
        cells = [
            (np.array([u, v]), np.array([s, t]))
            for u, s in zip(cuts[0][:-1], cuts[0][1:], strict=True)
            for v, t in zip(cuts[1][:-1], cuts[1][1:], strict=True)
        ]
        stands, falls = [], []
        unknown = len(known) < len(tops)
        while cells and self.programs < MOST_PROGRAMS:
            low, high = cells.pop()
            cell = _both(shapely.box(*low, *high), piece)
            if not cell.area > 0:
                continue
            possible = self._areas(tops, low, high, union=True)
            # moments of the part alone: its centre lies within the hull of its contact
            hull = shapely.convex_hull(_any_of(list(possible.values())))
            beyond = _without(cell, hull)
            if not unknown:
                falls.append(beyond)
                cell = _both(cell, hull)
            if cell.area <= NOTHING * float(np.prod(high - low)):
                continue
            sure = self._areas(known, low, high, union=False)
            inside = self._carried(sure, height, low, high)
            if _without(cell, inside.inner).area <= NOTHING * cell.area:
                stands.append(cell)
                continue
            same = _equal_areas(sure, possible) and not unknown
            outside = inside if same else self._carried(possible, height, low, high)
            out = _without(cell, outside.outer)
            gap = _gap(cell, inside.inner, outside.outer)
            # halve across the gap: along it the areas of contact may move without any effect
            across = high - low if inside.inner.is_empty else np.abs(gap)
            axis = int(across.argmax())
            width = float(np.linalg.norm(gap))
            small = high[axis] - low[axis] <= self.strip / 2
            if same or small or unknown or width <= self.strip:
                stands.append(_both(cell, inside.inner))
                if not unknown:
                    falls.append(out)
                continue
            middle = (low[axis] + high[axis]) / 2
            first, second = high.copy(), low.copy()
            first[axis] = second[axis] = middle
            cells += [(low, first), (second, high)]
        return _any_of(stands), _any_of(falls)

    def _cuts(self, tops: list[Top], axis: int, low: float, high: float) -> list[float]:
        """Coordinates at which the kind of a corner of the area of contact changes."""
        ends = {low, high}
        along = self.part.footprint[:, axis]
        reach = {float(along.min()), float(along.max())}
        for top in tops:
            for side in shapely.get_coordinates(top.polygon)[:, axis].tolist():
                ends |= {side - shift for shift in (*reach, 0.0) if low < side - shift < high}
        values = sorted(ends)
        width = SAME_CUT * (high - low)
        kept = [value for k, value in enumerate(values) if not k or value - values[k - 1] > width]
        return kept if kept[-1] == high or len(kept) > 1 else [low, high]

    def _areas(
        self, tops: list[Top], low: Array, high: Array, *, union: bool
    ) -> dict[int, shapely.Geometry]:
        """Area of contact on each top that all places of a rectangle have, or that any has."""
        under = swept(self.part.footprint, low, high, union=union)
        areas = {}
        for top in tops:
            area = _both(top.polygon, under)
            if area.area > NOTHING * top.polygon.area:
                areas[top.part] = area
        return areas

    def _carried(
        self, areas: dict[int, shapely.Geometry], height: float, low: Array, high: Array
    ) -> CarriedPlaces:
        """Places of a rectangle at which forces in fixed areas of contact hold the part."""
        if not areas:
            return CarriedPlaces(shapely.Polygon(), shapely.Polygon(), 0)
        middle = (low + high) / 2
        program = self._with_part(areas, height, middle)
        more = self._torques(len(self.program.names), len(program.names))
        half = (high - low) / 2
        found = ShiftedLoad(program, more, -half, half).places(self.strip / 2)
        self.programs += found.programs
        return CarriedPlaces(
            _moved(found.inner, middle), _moved(found.outer, middle), found.programs
        )

    def _with_part(
        self, areas: dict[int, shapely.Geometry], height: float, middle: Array
    ) -> Program:
        """The program with the part above a place, and contacts at the corners of the areas."""
        program, part = self.program, self.part
        index = len(program.names)
        points, under = [], []
        for support, area in areas.items():
            corners = shapely.get_coordinates(area)[:-1]
            points.append(np.column_stack([corners, np.full(len(corners), height)]))
            under += [support] * len(corners)
        point = np.concatenate(points)
        count = len(point)
        pushes = PossibleContacts(
            np.array(under, dtype=np.int64),
            np.full(count, index),
            point,
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
            "center": np.vstack([program.center, [*middle, height + part.below]]),
            "mass": np.append(program.mass, part.mass),
            "inertia": np.concatenate([program.inertia, part.inertia[None]]),
            "radius": np.append(program.radius, part.radius),
            "applied": np.vstack([program.applied, np.zeros(6)]),
            "clamp": np.vstack([program.clamp, np.zeros(6)]),
            "tolerance": np.append(program.tolerance, TOLERANCE),
        }
        joined = ForceRows.join([program.force_rows, rows])
        return program.with_rows(**parts).with_force_rows(joined)


NEW = "new part"
"""Name of the part that is put down."""
NOTHING = 1e-9
"""Share of an area below which it counts as nothing [-]."""
SAME_CUT = 1e-9
"""Share of the width of a polygon below which two cuts are equal [-]."""


def _polygons(geometry: shapely.Geometry) -> list[shapely.Geometry]:
    """The polygons of a geometry, without points and lines."""
    return [piece for piece in shapely.get_parts(geometry) if piece.area > 0]


def _areal(geometry: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a geometry as one geometry; points and lines are dropped."""
    if geometry.geom_type in ("Polygon", "MultiPolygon"):
        return geometry
    return shapely.MultiPolygon(_polygons(geometry))


def _both(first: shapely.Geometry, second: shapely.Geometry) -> shapely.Geometry:
    """The intersection of two areas."""
    return _areal(shapely.intersection(_areal(first), _areal(second)))


def _without(first: shapely.Geometry, second: shapely.Geometry) -> shapely.Geometry:
    """The first area without the second."""
    return _areal(shapely.difference(_areal(first), _areal(second)))


def _any_of(areas: list[shapely.Geometry]) -> shapely.Geometry:
    """The union of areas."""
    return _areal(shapely.union_all([_areal(area) for area in areas]))


def _moved(geometry: shapely.Geometry, by: Array) -> shapely.Geometry:
    return shapely.transform(geometry, lambda points: points + by)


def _equal_areas(first: dict[int, shapely.Geometry], second: dict[int, shapely.Geometry]) -> bool:
    """Whether two sets of areas of contact are equal."""
    if first.keys() != second.keys():
        return False
    return all(
        shapely.symmetric_difference(first[k], second[k]).area <= NOTHING * second[k].area
        for k in first
    )


def _gap(cell: shapely.Geometry, inner: shapely.Geometry, outer: shapely.Geometry) -> Array:
    """Largest shift from the inner polygon to a place within the outer polygon, in a cell, (2,).

    Without an inner polygon it is the narrower side of the outer polygon.
    """
    candidates = _both(cell, outer)
    if candidates.area <= NOTHING * cell.area:
        return np.zeros(2)
    if inner.is_empty:
        around = shapely.get_coordinates(shapely.minimum_rotated_rectangle(candidates))
        sides = np.diff(around[:3], axis=0)
        return np.asarray(sides[np.linalg.norm(sides, axis=1).argmin()])
    corners = shapely.points(shapely.get_coordinates(candidates))
    farthest = corners[int(shapely.distance(corners, inner).argmax())]
    ends = shapely.get_coordinates(shapely.shortest_line(inner, farthest))
    return np.asarray(ends[1] - ends[0])
