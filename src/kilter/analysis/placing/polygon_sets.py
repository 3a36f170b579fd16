"""Sets of points in the plane as polygons: intersections, differences and unions with an area.

Lines and points that remain of an operation are dropped, since places on them have no area.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely

from kilter.arrays import Array

NOTHING = 1e-9
"""Share of an area below which it counts as nothing [-]."""
GRID = 1e-12
"""Width of the grid on which slivers of rounding vanish [largest coordinate]."""
STRIP = 0.5
"""Ratio of the sides of a rectangle below which it is a strip [-]."""
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
    return _on_grid(shapely.intersection, areal(first), areal(second))


def cleaned(area: shapely.Geometry) -> shapely.Geometry:
    """An area without spikes and slivers of rounding, whose intersections would be wrong.

    Examples
    --------
    >>> spike = shapely.Polygon([(0, 0), (3, 0), (1, 1e-16), (1, 1), (0, 1)])
    >>> np.round(cleaned(spike).bounds, 9).tolist()
    [0.0, 0.0, 1.0, 1.0]
    """
    if area.is_empty:
        return area
    return areal(shapely.set_precision(area, GRID * float(np.abs(area.bounds).max())))


def without(
    first: shapely.Geometry, second: shapely.Geometry, grid: float | None = None
) -> shapely.Geometry:
    """The first area without the second; on a grid of this width, slivers vanish."""
    return _on_grid(shapely.difference, areal(first), areal(second), grid=grid)


def union(areas: list[shapely.Geometry], grid: float | None = None) -> shapely.Geometry:
    """The union of areas; on a grid of this width, slivers of rounding vanish.

    Examples
    --------
    >>> half = shapely.box(0, 0, 1, 1)
    >>> both_halves = [half, shapely.box(1 + 1e-15, 0, 2, 1)]
    >>> len(polygons_of(union(both_halves))), len(polygons_of(union(both_halves, 1e-12)))
    (2, 1)
    """
    return _on_grid(shapely.union_all, [areal(area) for area in areas], grid=grid)


def _on_grid(
    operation: Callable[..., shapely.Geometry], *areas: Any, grid: float | None = None
) -> shapely.Geometry:
    """The area of an operation; if corners nearer than rounding make it fail, on a fine grid."""
    try:
        return areal(operation(*areas, grid_size=grid))
    except shapely.errors.GEOSException:
        largest = float(np.nanmax(np.abs(shapely.bounds(np.hstack(areas))), initial=0.0))
        return areal(operation(*areas, grid_size=GRID * largest))


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


def across(area: shapely.Geometry) -> Array:
    """Extent of an area along x and y; of a strip, across it: along it the areas move freely."""
    around = shapely.get_coordinates(shapely.minimum_rotated_rectangle(area))
    bounds = np.array(area.bounds)
    if len(around) < 4:
        return np.asarray(bounds[2:] - bounds[:2])
    sides = np.diff(around[:3], axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    if lengths.min() > STRIP * lengths.max():
        return np.asarray(bounds[2:] - bounds[:2])
    return np.asarray(np.abs(sides[lengths.argmin()]))
