"""Collision tests of polyhedral parts on straight paths, by projection along the path.

A part P moves by d (a unit vector) over a distance L, which may be endless. A line along d that
leaves P at the height a = x . d and enters Q at b is stopped at b - a. So Q stops P where exit
faces of P (n . d > 0) and entry faces of Q (n . d < 0) overlap in projection with

    -e <= b - a <= L - e                            e: the tolerance of the pair

over a region that contains a disk of radius e. Faces parallel to d have no area in projection, so
sliding is free. The result depends only on the pair, not on other parts.

    e = max(gap tolerance, 4 (slack of P + slack of Q), 2 accuracies, 2 depths)

because triangles approximate round faces to within their slack, and parts that overlap by a depth
in the file must still block each other.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
import shapely

from kilter.analysis.analysis_tolerances import ALONG
from kilter.analysis.planning.states.holds import bits_of, members
from kilter.arrays import Array, Index, Mask, across, cross, extents, unit_rows
from kilter.contact import ContactSet
from kilter.contact.common.polygons import cut_convex
from kilter.contact.contact_tolerances import COPY_PLACE

SLACKS = 4.0
"""Overlap on a path that counts as no collision [slacks of both parts]; larger: fewer collisions.
"""
DEPTHS = 2.0
"""Overlap on a path that counts as no collision [overlap of the pair in the file]."""
WELD = 1e-3
"""Distance by which polygons of an overlap are widened to join their neighbours [tolerances]."""

MANY = 400
"""Product of the numbers of corners of two parts from which copies of a test are tested once."""
LARGEST = 32
"""Number of pairs of faces that are tested before all others, the largest faces first."""
SLIVER = 1e-3
"""Width up to which an overlap of two faces in projection comes from rounding [tolerances]."""
MEETS = 4.0
"""Curved faces that are less than this above other faces may meet first [distance of a triangle
from its surface]."""
FIRST_FACES = 500
"""Pairs of faces that are compared first; each further batch is twice as large."""

Direction = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class _Shadow:
    """Projection of a part along a direction: triangles on the normal plane, with their heights."""

    plane: Array
    """Corners on the plane [length unit], shape (m, 3, 2)."""
    height: Array
    """Heights of the corners along the direction [length unit], shape (m, 3)."""
    facing: Array
    """Facing cosine n . d of each triangle [-], shape (m,)."""
    slack: Array
    """Distance of each triangle from its curved surface [length unit], shape (m,)."""

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the boxes of the triangles on the plane, shape (m, 2)."""
        return extents(self.plane)

    @cached_property
    def depths(self) -> tuple[Array, Array]:
        """Least and greatest height of each triangle [length unit], shape (m,)."""
        return extents(self.height)

    def moved(self, aside: Array, along: float) -> _Shadow:
        """Copy of the projection, moved by a vector on the plane, shape (2,), and by a height."""
        return replace(self, plane=self.plane + aside, height=self.height + along)


class Sweeps:
    """Collision tests for parts of an assembly that move on straight paths.

    - `tests`: number of tested pairs;
    - `falls`: heights on the exact surfaces that `straight_falls` computed [length unit].
    """

    def __init__(self, contacts: ContactSet) -> None:
        self._geometry = contacts.assembly.geometry
        self._assembly = contacts.assembly
        self._tolerance = contacts.searched
        self._depths: dict[int, dict[int, float]] = {}
        for overlap in contacts.overlaps:
            for part, other in (overlap.ends, overlap.ends[::-1]):
                self._depths.setdefault(part, {})[other] = overlap.depth
        self._shadows: dict[tuple[int, Direction], _Shadow] = {}
        self._endless: dict[tuple[int, Direction], tuple[int, int]] = {}
        self._before: dict[tuple[int, Direction], int] = {}
        self._box: dict[Direction, tuple[Array, Array]] = {}
        self._heights: dict[tuple[int, int, Direction], tuple[float, bool]] = {}
        self._copies: dict[Hashable, bool] = {}
        self.falls: dict[tuple[int, int, Direction], float] = {}
        self.tests = 0

    @classmethod
    def of(cls, contacts: ContactSet) -> Sweeps:
        """The tests for an assembly as drawn; each contact set has one object, with its results."""
        return _SWEEPS.setdefault(contacts, cls(contacts))

    def overlap(self, p: int, q: int) -> bool:
        """Whether two parts share volume as drawn."""
        return q in self._depths.get(p, {})

    def tolerance(self, p: int, q: int) -> float:
        """Depth to which two parts may overlap on a path without a collision [length unit]."""
        return float(self._tolerances(p, np.array([q]))[0])

    def _tolerances(self, p: int, others: Index) -> Array:
        """`tolerance` of a part with each of several others, shape (n,) [length unit]."""
        g = self._geometry
        gap = self._tolerance.gap_of(np.minimum(g.size[p], g.size[others]))
        slack, accuracy = g.slack[p] + g.slack[others], g.accuracy[p] + g.accuracy[others]
        most: Array = np.maximum.reduce([gap, SLACKS * slack, 2 * accuracy])
        depths = self._depths.get(p)
        if depths is not None:
            depth = [depths.get(other, 0.0) for other in others.tolist()]
            most = np.maximum(most, DEPTHS * np.array(depth))
        return most

    def stops(self, part: int, present: int, direction: Direction) -> bool:
        """Whether any present part blocks a part on an endless straight path."""
        others = present & ~(1 << part) & self._ahead(part, direction)
        stopping, free = self._endless.get((part, direction), (0, 0))
        if stopping & others:
            return True
        for other in members(others & ~free, len(self._geometry.mass)).tolist():
            if self.pair_stops(part, other, direction):
                self._endless[part, direction] = (stopping | 1 << other, free)
                return True
            free |= 1 << other
            self._endless[part, direction] = (stopping, free)
        return False

    def leg_stops(
        self,
        part: int,
        others: Index,
        direction: Direction,
        *,
        distance: float = np.inf,
        start: Array | None = None,
    ) -> bool:
        """Whether any of the other parts blocks a part on a leg of a path, as in `pair_stops`.

        Parts whose projected boxes are beside the path are left out.
        """
        low, high = self._boxes(direction)
        by = np.zeros(3) if start is None else _basis(np.array(direction)) @ start
        first, last = low[part] + by, high[part] + by
        most = self._tolerances(part, others)
        near = ((low[others, :2] < last[:2]) & (high[others, :2] > first[:2])).all(axis=1)
        near &= high[others, 2] - first[2] >= -most
        near &= low[others, 2] - last[2] <= distance - most
        return any(
            self.pair_stops(part, other, direction, distance=distance, start=start)
            for other in others[near].tolist()
        )

    def _ahead(self, part: int, direction: Direction) -> int:
        """Bit set of the parts ahead of a part along a direction whose projected boxes overlap."""
        key = part, direction
        if key not in self._before:
            low, high = self._boxes(direction)
            meets = (low[:, :2] < high[part, :2]) & (high[:, :2] > low[part, :2])
            near = meets.all(axis=1)
            most = float(self._tolerances(part, np.flatnonzero(near)).max())
            self._before[key] = bits_of(near & (high[:, 2] >= low[part, 2] - most))
        return self._before[key]

    def _boxes(self, direction: Direction) -> tuple[Array, Array]:
        """Lowest and highest coordinates of each part in the basis of a direction, each (N, 3)."""
        if direction not in self._box:
            g = self._geometry
            seen = g.vertices @ _basis(np.array(direction)).T
            start = g.vertex_start[:-1]
            self._box[direction] = (
                np.minimum.reduceat(seen, start, axis=0),
                np.maximum.reduceat(seen, start, axis=0),
            )
        return self._box[direction]

    def pair_stops(
        self,
        part: int,
        other: int,
        direction: Direction,
        *,
        distance: float = np.inf,
        start: Array | None = None,
    ) -> bool:
        """Whether the part `other` blocks the part `part` on a straight path.

        Arguments: `distance`: length of the path [length unit]; `start` (3,): displacement of the
        part at the start of the path [length unit].
        """
        count = np.diff(self._geometry.vertex_start)
        if count[part] * count[other] < MANY:
            return self._test_pair(part, other, direction, distance, start)
        key = self._key(part, other, direction, distance, start)
        if key not in self._copies:
            self._copies[key] = self._test_pair(part, other, direction, distance, start)
        return self._copies[key]

    def _key(
        self, part: int, other: int, direction: Direction, distance: float, start: Array | None
    ) -> Hashable:
        """Key of a test, which is equal for copies of both parts that meet in the same way.

        Lengths are rounded to `COPY_PLACE` of the tolerance of the pair.
        """
        moving, still = self._assembly.parts[part], self._assembly.parts[other]
        step = COPY_PLACE * self.tolerance(part, other)
        size = self._geometry.size[[part, other]].max()
        turn, by = moving.pose.matrix.T, np.zeros(3) if start is None else start
        lengths = [
            turn @ (still.pose.position - moving.pose.position),
            turn @ by,
            (turn @ still.pose.matrix).ravel() * size,
            turn @ np.array(direction) * size,
            [distance],
        ]
        rounded = np.round(np.concatenate(lengths) / step) + 0.0  # no negative zeros
        level = round(math.log2(step) / COPY_PLACE)
        return id(moving.shape), id(still.shape), level, rounded.tobytes()

    def _test_pair(
        self, part: int, other: int, direction: Direction, distance: float, start: Array | None
    ) -> bool:
        """Test a pair as in `pair_stops`."""
        self.tests += 1
        moving, still = self._shadow(part, direction), self._shadow(other, direction)
        if start is not None:
            basis = _basis(np.array(direction))
            moving = moving.moved(basis[:2] @ start, float(basis[2] @ start))
        return _blocks_within(moving, still, self.tolerance(part, other), distance)

    def clearance(self, part: int, other: int, direction: Direction) -> float:
        """Distance that a part moves straight until its triangles meet those of another part.

        The distance is exact for the triangles: it is the least height between an exit face and an
        entry face over the area in which they overlap in projection. Pairs of faces that are more
        than the tolerance behind each other do not count.

        Returns distance [length unit]; infinite if the parts never meet.
        """
        return self.heights(part, other, direction)[0]

    def heights(self, part: int, other: int, direction: Direction) -> tuple[float, bool]:
        """Distance as `clearance`, and whether it is that of the exact surfaces, too.

        It is not if curved surfaces, which are beside their triangles, may meet first.
        """
        key = part, other, direction
        if key not in self._heights:
            moving, still = self._shadow(part, direction), self._shadow(other, direction)
            self._heights[key] = _least_heights(moving, still, self.tolerance(part, other))
        return self._heights[key]

    def under(self, parts: Index, direction: Direction) -> tuple[Index, Array]:
        """Other parts that the given parts may meet on a straight path, the nearest first.

        Returns `others` (n,): parts ahead whose projected boxes overlap that of a given part;
        `least` (n,): lower bound of the distance to each, from the boxes, ascending [length unit].
        """
        low, high = self._boxes(direction)
        bound = np.full(len(low), np.inf)
        for part in parts.tolist():
            meets = ((low[:, :2] < high[part, :2]) & (high[:, :2] > low[part, :2])).all(axis=1)
            meets &= high[:, 2] >= low[part, 2]
            ahead = np.where(meets, low[:, 2] - high[part, 2], np.inf)
            bound = np.minimum(bound, ahead)
        bound[parts] = np.inf
        others = np.flatnonzero(np.isfinite(bound))
        others = others[np.argsort(bound[others], kind="stable")]
        return others, bound[others]

    def _shadow(self, part: int, direction: Direction) -> _Shadow:
        """Projection of a part along a direction; each is computed once."""
        key = part, direction
        if key not in self._shadows:
            corners = self._geometry.corners_of(part)
            normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            seen = corners @ _basis(np.array(direction)).T
            facing = unit_rows(normal) @ np.array(direction)
            slack = self._geometry.slack_of(part)
            self._shadows[key] = _Shadow(seen[..., :2], seen[..., 2], facing, slack)
        return self._shadows[key]


_SWEEPS: WeakKeyDictionary[ContactSet, Sweeps] = WeakKeyDictionary()
"""The tests of each contact set."""


def _basis(direction: Array) -> Array:
    """Orthonormal basis with the given unit vector as the last row, shape (3, 3)."""
    return np.stack([*across(direction), direction])


def _blocks_within(moving: _Shadow, still: _Shadow, tolerance: float, distance: float) -> bool:
    """Whether a moving part meets a still part within a distance; see the module docstring."""
    exits, entries = np.flatnonzero(moving.facing > ALONG), np.flatnonzero(still.facing < -ALONG)
    first, second = _near_faces(moving, exits, still, entries, tolerance, distance)
    reach = -tolerance, distance - tolerance
    if len(first) > 2 * LARGEST:  # the largest faces decide most pairs of parts
        size = np.minimum(_areas(moving.plane[first]), _areas(still.plane[second]))
        large = np.argpartition(-size, LARGEST)[:LARGEST]
        some = _met_areas(moving, first[large], still, second[large], reach)
        if _fits_a_disk(some[0], tolerance):
            return True
    whole, partly = _met_areas(moving, first, still, second, reach)
    if _fits_a_disk(whole, tolerance):
        return True
    region = np.array([*whole, *partly])
    if not len(region):
        return False
    welded = shapely.buffer(region, tolerance * WELD, quad_segs=1)
    return not shapely.is_empty(shapely.buffer(shapely.union_all(welded), -tolerance))


def _areas(triangles: Array) -> Array:
    """Areas of triangles on the plane, shape (n, 3, 2)."""
    edge, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area: Array = np.abs(edge[:, 0] * two[:, 1] - edge[:, 1] * two[:, 0]) / 2
    return area


def _met_areas(
    moving: _Shadow, first: Index, still: _Shadow, second: Index, reach: tuple[float, float]
) -> tuple[Array, list[object]]:
    """Polygons on which exit faces meet entry faces at a height within the two bounds of `reach`.

    Returns those of the pairs of faces that meet in their whole overlap, and the pieces of others.
    """
    shared = shapely.intersection(
        shapely.polygons(moving.plane[first]), shapely.polygons(still.plane[second])
    )
    flat = shapely.area(shared) > 0
    first, second, shared = first[flat], second[flat], shared[flat]
    corner, owner = shapely.get_coordinates(shared, return_index=True)
    if not len(corner):
        return shared, []
    between = _heights(still, second[owner], corner) - _heights(moving, first[owner], corner)
    low, high = reach
    starts = np.flatnonzero(np.diff(owner, prepend=-1))
    lowest = np.minimum.reduceat(between, starts)
    highest = np.maximum.reduceat(between, starts)
    whole = (lowest >= low) & (highest <= high)
    partly = ~whole & (highest >= low) & (lowest <= high)
    pieces = [
        _polygon_between(corner[owner == k][:-1], between[owner == k][:-1], low, high)
        for k in np.flatnonzero(partly)
    ]
    return shared[whole], [piece for piece in pieces if piece is not None]


def _least_heights(moving: _Shadow, still: _Shadow, tolerance: float) -> tuple[float, bool]:
    """Least height from exit faces of a part to entry faces of another; infinite without any.

    It is exact if no pair with a curved surface may be lower, by `MEETS` times its distance from
    the triangles. Slivers that come from the rounding of touching outlines do not count. The pairs
    of faces are compared in the order of the least heights at which they may meet.
    """
    exits = _beneath(moving, np.flatnonzero(moving.facing > ALONG), still)
    entries = _beneath(still, np.flatnonzero(still.facing < -ALONG), moving)
    (bottom, top), (still_bottom, still_top) = moving.depths, still.depths
    above = bottom[exits].min(initial=np.inf)
    entries = entries[still_top[entries] >= above - tolerance]
    if not len(exits) or not len(entries):
        return np.inf, True
    below = shapely.polygons(moving.plane[exits])
    tree = shapely.STRtree(shapely.polygons(still.plane[entries]))
    first, second = tree.query(below)
    low = still_bottom[entries][second] - top[exits][first]
    high = still_top[entries][second] - bottom[exits][first]
    slack = moving.slack[exits][first] + still.slack[entries][second]
    earliest = np.maximum(low, -tolerance) - MEETS * slack
    order = np.argsort(earliest, kind="stable")
    order = order[high[order] >= -tolerance]
    least, may_meet, begin, count = np.inf, np.inf, 0, FIRST_FACES
    while begin < len(order) and earliest[order[begin]] < least:
        rows = order[begin : begin + count]
        begin, count = begin + count, 2 * count
        planes = moving.plane[exits[first[rows]]], still.plane[entries[second[rows]]]
        rows = rows[~(_are_separated(*planes) | _are_separated(*planes[::-1]))]
        shared = shapely.intersection(below[first[rows]], tree.geometries[second[rows]])
        wide = shapely.area(shared) > SLIVER * tolerance * shapely.length(shared)
        rows, shared = rows[wide], shared[wide]
        corner, owner = shapely.get_coordinates(shared, return_index=True)
        if not len(corner):
            continue
        on_still = _heights(still, entries[second[rows]][owner], corner)
        between = on_still - _heights(moving, exits[first[rows]][owner], corner)
        starts = np.flatnonzero(np.diff(owner, prepend=-1))
        ahead = np.maximum.reduceat(between, starts) >= -tolerance
        lowest = np.maximum(np.minimum.reduceat(between, starts), -tolerance)[ahead]
        least = min(least, float(lowest.min(initial=np.inf)))
        curved = slack[rows][ahead] > 0
        meets = (lowest - MEETS * slack[rows][ahead])[curved]
        may_meet = min(may_meet, float(meets.min(initial=np.inf)))
    return least, not may_meet < least


def _are_separated(first: Array, second: Array) -> Mask:
    """Mask of rows whose triangles, shape (n, 3, 2), lie on either side of a side of the first."""
    separated = np.zeros(len(first), dtype=bool)
    for k in range(3):
        along = first[:, k] - first[:, k - 1]
        across_side = np.column_stack([-along[:, 1], along[:, 0]])
        (low, high), (other_low, other_high) = (
            extents(np.einsum("nki,ni->nk", corners - first[:, k, None], across_side))
            for corners in (first, second)
        )
        separated |= (other_low > high) | (other_high < low)
    return separated


def _beneath(shadow: _Shadow, faces: Index, other: _Shadow) -> Index:
    """The faces of a projection that reach the projected box of another one."""
    (least, most), (low, high) = shadow.boxes, other.boxes
    near = (most[faces] >= low.min(axis=0)) & (least[faces] <= high.max(axis=0))
    kept: Index = faces[near.all(axis=1)]
    return kept


def _near_faces(
    moving: _Shadow, exits: Index, still: _Shadow, entries: Index, tolerance: float, distance: float
) -> tuple[Index, Index]:
    """Pairs of exit and entry faces of two projections whose boxes overlap within the distance."""
    a, b = moving.plane[exits], still.plane[entries]
    za, zb = moving.height[exits], still.height[entries]
    near = (zb.max(axis=1)[None] - za.min(axis=1)[:, None] >= -tolerance) & (
        zb.min(axis=1)[None] - za.max(axis=1)[:, None] <= distance - tolerance
    )
    for axis in range(2):
        near &= a[:, None, :, axis].min(axis=2) < b[None, :, :, axis].max(axis=2)
        near &= b[None, :, :, axis].min(axis=2) < a[:, None, :, axis].max(axis=2)
    first, second = np.nonzero(near)
    return exits[first], entries[second]


def _heights(shadow: _Shadow, rows: Index, points: Array) -> Array:
    """Heights of points of the projection plane, shape (n, 2), each on its own triangle."""
    plane, height = shadow.plane[rows], shadow.height[rows]
    edge, two, off = plane[:, 1] - plane[:, 0], plane[:, 2] - plane[:, 0], points - plane[:, 0]
    area = edge[:, 0] * two[:, 1] - edge[:, 1] * two[:, 0]
    s = (off[:, 0] * two[:, 1] - off[:, 1] * two[:, 0]) / area
    t = (edge[:, 0] * off[:, 1] - edge[:, 1] * off[:, 0]) / area
    rise = height - height[:, :1]
    result: Array = height[:, 0] + s * rise[:, 1] + t * rise[:, 2]
    return result


def _fits_a_disk(pieces: Array, radius: float) -> bool:
    """Whether one of the convex polygons surely contains a disk: area > radius * perimeter.

    A convex piece of area A and length of outline U has an inscribed disk of radius A / U.
    """
    return bool((shapely.area(pieces) > radius * shapely.length(pieces)).any())


def _polygon_between(corners: Array, values: Array, low: float, high: float) -> object | None:
    """Piece of a convex polygon on which a linear function is between two bounds; None if empty."""
    rows = np.column_stack([corners, values])
    for bound, sign in ((low, 1.0), (high, -1.0)):
        if np.isfinite(bound):
            rows = cut_convex(rows, sign * (rows[:, 2] - bound))
    return shapely.polygons(rows[:, :2]) if len(rows) > 2 else None
