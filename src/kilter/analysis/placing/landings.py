"""Landings: heights at which a part comes to rest when it is lowered, and what it touches there.

The part is lowered straight down, so its height at a place is that of the highest top under its
footprint. Tops within the gap of contacts have the same height.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from kilter.analysis.placing.polygon_sets import NOTHING, both, cleaned, union, without
from kilter.analysis.placing.upright_prisms import PlacedPrism, Top, swept
from kilter.arrays import Array

__all__ = ["Landing", "Landings"]


BORDER = 1e-9
"""Distance from the border of a rectangle of places within which areas of contact may vanish [sizes
of the part]: rounding of the border."""
EDGE = 1e-6
"""Perimeter above which an area of contact of almost no width counts [sizes of the part]."""


@dataclass(frozen=True, slots=True, eq=False)
class Landing:
    """Places at which the part rests at one height."""

    height: float
    """Height of its underside [length unit]."""
    tops: list[Top]
    """Tops of this height."""
    here: shapely.Geometry
    """Centres of mass at which it rests on some of these tops."""


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
        above: shapely.Geometry = shapely.Polygon()
        found = []
        for height, tops in reversed(self._heights()):
            touched = union([self.reach[top.part] for top in tops])
            here = both(without(touched, above), domain)
            above = union([above, touched])
            here = cleaned(without(here, self._blocked(height)))
            if here.area > 0:
                found.append(Landing(height, tops, here))
        return found[::-1]

    @cached_property
    def reach(self) -> dict[int, shapely.Geometry]:
        """For each part of the assembly, the centres at which the footprint overlaps its top."""
        return {top.part: self._touched_by(top) for top in self.tops}

    def only(self, landing: Landing, top: Top) -> shapely.Geometry:
        """Places of a landing at which the part touches this top alone."""
        others = [self.reach[other.part] for other in landing.tops if other is not top]
        return without(both(landing.here, self.reach[top.part]), union(others))

    def areas(
        self, tops: list[Top], low: Array, high: Array, *, any_place: bool
    ) -> dict[int, shapely.Geometry]:
        """Area of contact on each top in a rectangle of places.

        The area that all places have, or that some place has (`any_place`). If the part begins to
        touch a top at the border of the rectangle, all places inside have an edge of the top in
        common, as an area of almost no width.
        """
        under = swept(self.part.footprint, low, high, union=any_place)
        size = float(np.ptp(self.part.footprint, axis=0).max())
        areas = {}
        for top in tops:
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
