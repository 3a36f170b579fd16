"""Sets of points in the plane as polygons: intersections, differences and unions with an area.

Lines and points that remain of an operation are dropped, since places on them have no area.
"""

from __future__ import annotations

import shapely

from kilter.arrays import Array

__all__ = [
    "NOTHING",
    "areal",
    "both",
    "is_within",
    "moved",
    "polygons_of",
    "rings_of",
    "union",
    "without",
]

NOTHING = 1e-9
"""Share of an area below which it counts as nothing [-]."""
NEAR = 1e-9
"""Half the width of a strip that counts as nothing [extents]: rounding of intersections."""


def polygons_of(geometry: shapely.Geometry) -> list[shapely.Geometry]:
    """The polygons of a geometry, without points and lines."""
    return [piece for piece in shapely.get_parts(geometry) if piece.area > 0]


def areal(geometry: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a geometry as one geometry."""
    if geometry.geom_type in ("Polygon", "MultiPolygon"):
        return geometry
    return shapely.MultiPolygon(polygons_of(geometry))


def both(first: shapely.Geometry, second: shapely.Geometry) -> shapely.Geometry:
    """The intersection of two areas."""
    return areal(shapely.intersection(areal(first), areal(second)))


def without(
    first: shapely.Geometry, second: shapely.Geometry, grid: float | None = None
) -> shapely.Geometry:
    """The first area without the second; on a grid of this width, slivers vanish."""
    return areal(shapely.difference(areal(first), areal(second), grid_size=grid))


def union(areas: list[shapely.Geometry], grid: float | None = None) -> shapely.Geometry:
    """The union of areas; on a grid of this width, slivers of rounding vanish.

    Examples
    --------
    >>> half = shapely.box(0, 0, 1, 1)
    >>> both_halves = [half, shapely.box(1 + 1e-15, 0, 2, 1)]
    >>> len(polygons_of(union(both_halves))), len(polygons_of(union(both_halves, 1e-12)))
    (2, 1)
    """
    return areal(shapely.union_all([areal(area) for area in areas], grid_size=grid))


def moved(geometry: shapely.Geometry, by: Array) -> shapely.Geometry:
    """A geometry that is shifted by a vector, shape (2,)."""
    return shapely.transform(geometry, lambda points: points + by)


def is_within(first: shapely.Geometry, second: shapely.Geometry, extent: float) -> bool:
    """Whether the first area lies within the second, up to rounding of an extent.

    Examples
    --------
    >>> square = shapely.box(0, 0, 1, 1)
    >>> is_within(square, square, 1.0), is_within(shapely.box(0, 0, 1, 1.001), square, 1.0)
    (True, False)
    """
    beyond = without(first, second)
    return all(piece.buffer(-NEAR * extent).is_empty for piece in polygons_of(beyond))


def rings_of(geometry: shapely.Geometry) -> list[list[list[list[float]]]]:
    """Polygons as lists of rings: the outline, then the holes; each ring a list of points."""
    found = []
    for piece in polygons_of(geometry):
        rings = [piece.exterior, *piece.interiors]
        found.append([[[x, y] for x, y in ring.coords] for ring in rings])
    return found
