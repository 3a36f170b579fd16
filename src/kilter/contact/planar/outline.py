"""Outlines in the plane: convex hulls, and overlays of faces of many triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array, Mask

if TYPE_CHECKING:
    import shapely

__all__ = ["convex_hull", "overlay", "width_of"]


AGREE = 1e-6
"""Two ways to overlay must agree on the area to this part of the smaller outline."""


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull, turning left, shape (m, 2), by Andrew's monotone chain.

    Examples
    --------
    >>> convex_hull(np.array([[0., 0], [1, 0], [.5, .5], [1, 1], [0, 1]])).tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    ordered = np.unique(points, axis=0)
    if len(ordered) <= 2:
        return ordered
    if len(ordered) > 64:
        ordered = ordered[_outer(ordered)]
    rows = ordered.tolist()

    def chain(sequence: list[list[float]]) -> list[list[float]]:
        hull: list[list[float]] = []
        for p in sequence:
            while len(hull) > 1:
                (ax, ay), (bx, by) = hull[-2], hull[-1]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                hull.pop()
            hull.append(p)
        return hull[:-1]

    return np.array(chain(rows) + chain(rows[::-1]))


def _outer(points: Array) -> Mask:
    """Points not inside the octagon of the extremes; keeps the order."""
    directions = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1.0]])
    octagon = points[np.argmax(points @ directions.T, axis=0)]
    step = np.roll(octagon, -1, axis=0) - octagon
    inside = np.ones(len(points), dtype=bool)
    for corner, (dx, dy) in zip(octagon, step, strict=True):
        if dx == 0 and dy == 0:
            continue
        side = dx * (points[:, 1] - corner[1]) - dy * (points[:, 0] - corner[0])
        inside &= side > 1e-12 * (abs(dx) + abs(dy)) ** 2
    return ~inside


def width_of(hull: Array) -> float:
    """Least width of a convex polygon.

    Examples
    --------
    >>> width_of(np.array([[0., 0], [4, 0], [4, 1], [0, 1]]))
    1.0
    """
    edge = np.roll(hull, -1, axis=0) - hull
    length = np.linalg.norm(edge, axis=1)
    keep = length > 0
    if not keep.any():
        return 0.0
    edge, start = edge[keep] / length[keep][:, None], hull[keep]
    apart = hull[None] - start[:, None]
    across = np.abs(edge[:, None, 0] * apart[..., 1] - edge[:, None, 1] * apart[..., 0])
    return float(across.max(axis=1).min())


def overlay(one: tuple[Array, bool], other: tuple[Array, bool]) -> tuple[Array, float]:
    """Convex hull, shape (m, 2), and area of the overlap of two outlines.

    Each outline is (corners, convex): a loop where convex, triangles three by three
    otherwise. GEOS may give an overlap to triangles that have none, so the area is
    asked for twice, as it is and on a fine grid, and the grid is believed where they
    disagree.
    """
    import shapely

    first, second = _region(*one), _region(*other)
    size = float(np.ptp(shapely.get_coordinates([first, second]), axis=0).max())
    gridded = shapely.intersection(first, second, grid_size=1e-11 * size)
    common = shapely.intersection(first, second)
    least = min(first.area, second.area)
    if not common.is_valid or abs(common.area - gridded.area) > AGREE * least:
        common = gridded
    polygons = [p for p in shapely.get_parts(common) if p.geom_type == "Polygon"]
    if not polygons:
        return np.empty((0, 2)), 0.0
    return convex_hull(shapely.get_coordinates(polygons)), float(sum(p.area for p in polygons))


def _region(corners: Array, convex: bool) -> shapely.Geometry:
    """The polygon, with holes, that a loop or a list of triangles covers."""
    import shapely

    if convex:
        return shapely.Polygon(corners)
    triangles = corners.reshape(-1, 3, 2)
    names, index = np.unique(corners, axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    start = index.reshape(-1)
    end = np.roll(index, -1, axis=1).reshape(-1)
    inner = np.isin(start * len(names) + end, end * len(names) + start)
    edges = np.stack([names[start[~inner]], names[end[~inner]]], axis=1)
    region = shapely.build_area(shapely.multilinestrings(shapely.linestrings(edges)))
    covered = 0.5 * np.abs(
        (triangles[:, 1, 0] - triangles[:, 0, 0]) * (triangles[:, 2, 1] - triangles[:, 0, 1])
        - (triangles[:, 1, 1] - triangles[:, 0, 1]) * (triangles[:, 2, 0] - triangles[:, 0, 0])
    )
    if region is None or abs(region.area - covered.sum()) > AGREE * covered.sum():
        region = shapely.union_all(shapely.polygons(triangles), grid_size=1e-11 * np.ptp(corners))
    return region
