"""Polygons in the plane: batch clipping, convex hulls, widths, and overlaps of complex outlines.

`clip_convex` is Sutherland-Hodgman clipping on padded arrays: polygon k of a batch has `count[k]`
corners, anticlockwise, in ``points[k, :count[k]]``. Entries after the count have no meaning.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index, Mask
from kilter.contact.contact_tolerances import OUTLINE_AREA, OUTLINE_GRID

if TYPE_CHECKING:
    import shapely

__all__ = [
    "clip_convex",
    "convex_hull",
    "cut_convex",
    "overlay",
    "padded",
    "polygon_area",
    "tidy",
    "width_of",
]

Scalar = TypeVar("Scalar", bound=np.generic)


def padded(points: NDArray[Scalar], first: Index, count: Index) -> NDArray[Scalar]:
    """Rows of `points` in groups, padded to equal length, shape (n, m, d).

    Run k has the rows ``first[k]`` to ``first[k] + count[k]``.

    Shorter runs are padded with their last row.
    """
    k = np.minimum(np.arange(int(count.max(initial=1))), np.maximum(count, 1)[:, None] - 1)
    taken: NDArray[Scalar] = points[first[:, None] + k]
    return taken


def clip_convex(
    subject: Array, subject_count: Index, clip: Array, clip_count: Index
) -> tuple[Array, Index]:
    """The intersection of each subject polygon with its convex clip polygon.

    Parameters
    ----------
    subject : ndarray, shape (n, s, 2)
    subject_count : ndarray of int, shape (n,)
    clip : ndarray, shape (n, c, 2)
    clip_count : ndarray of int, shape (n,)

    Returns
    -------
    points : ndarray, shape (n, m, 2)
    count : ndarray of int, shape (n,)
        Number of corners; 0: no intersection.

    Examples
    --------
    >>> square = np.array([[[0., 0], [2, 0], [2, 2], [0, 2]]])
    >>> points, count = clip_convex(square, np.array([4]), square + 1, np.array([4]))
    >>> float(polygon_area(points, count)[0])
    1.0
    """
    points, count = subject, subject_count
    for k in range(int(clip_count.max(initial=0))):
        rows = np.flatnonzero((k < clip_count) & (count > 0))
        if not len(rows):
            break
        start = clip[rows, k]
        end = clip[rows, np.where(k + 1 < clip_count[rows], k + 1, 0)]
        cut, left = _half_plane(points[rows], count[rows], start, end - start)
        if len(rows) == len(points):
            points, count = cut, left
        else:
            width = max(points.shape[1], cut.shape[1])
            points = np.pad(points, ((0, 0), (0, width - points.shape[1]), (0, 0)))
            points[rows, : cut.shape[1]] = cut
            count = count.copy()
            count[rows] = left
    return points, count


def cut_convex(corners: Array, above: Array) -> Array:
    """The part of a convex polygon in which a linear function is not negative.

    Parameters
    ----------
    corners : ndarray, shape (n, d)
        In order around the polygon. Columns after the first two are values of further linear
        functions, which are interpolated.
    above : ndarray, shape (n,)
        The linear function at the corners.

    Returns
    -------
    ndarray, shape (m, d)

    Examples
    --------
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> cut_convex(square, square[:, 0] - 1).tolist()
    [[1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0]]
    """
    following = np.roll(above, -1)
    crosses = (above >= 0) != (following >= 0)
    share = np.where(crosses, above / np.where(crosses, above - following, 1.0), 0.0)
    cut = corners + share[:, None] * (np.roll(corners, -1, axis=0) - corners)
    keep = np.column_stack([above >= 0, crosses]).ravel()
    result: Array = np.stack([corners, cut], axis=1).reshape(-1, corners.shape[1])[keep]
    return result


def _half_plane(points: Array, count: Index, start: Array, along: Array) -> tuple[Array, Index]:
    """Cut convex polygons at the lines ``start + t along``, and keep the side to the left."""
    rows, width = len(points), points.shape[1]
    k = np.arange(width)
    is_corner = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    side = along[:, None, 0] * (points[..., 1] - start[:, None, 1]) - along[:, None, 1] * (
        points[..., 0] - start[:, None, 0]
    )
    lines = np.arange(rows)[:, None]
    next_side = side[lines, after]
    inside = is_corner & (side >= 0)
    crosses = is_corner & ((side >= 0) != (next_side >= 0))
    if not crosses.any() and bool((inside == is_corner).all()):  # nothing to cut
        return points, count
    with np.errstate(divide="ignore", invalid="ignore"):
        t = side / (side - next_side)
    t = np.where(crosses, t, 0.0)
    crossing = points + t[..., None] * (points[lines, after] - points)
    keep = np.stack([inside, crosses], axis=2).reshape(rows, 2 * width)
    corners_and_crossings = np.stack([points, crossing], axis=2).reshape(rows, 2 * width, 2)
    position = np.cumsum(keep, axis=1) - 1
    new_count: Index = position[:, -1] + 1
    result = np.zeros((rows, max(int(new_count.max()), 1), 2))
    kept_positions = np.nonzero(keep)
    result[kept_positions[0], position[kept_positions]] = corners_and_crossings[kept_positions]
    return result, new_count


def polygon_area(points: Array, count: Index) -> Array:
    """Signed area of each polygon, positive if anticlockwise, shape (n,)."""
    k = np.arange(points.shape[1])
    real = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    local = points - points[:, :1]  # avoids cancellation far from the origin
    following = local[np.arange(len(points))[:, None], after]
    cross = local[..., 0] * following[..., 1] - local[..., 1] * following[..., 0]
    area: Array = 0.5 * np.where(real, cross, 0.0).sum(axis=1)
    return area


def tidy(points: Array, count: Index, tolerance: Array) -> tuple[Array, Index]:
    """Remove repeated corners of polygons, and corners on straight sides.

    The order of the two passes matters: in a single pass two near-duplicates at a corner would each
    look like a point on a line, and the corner would be lost.
    """
    points, count = _select_corners(points, count, ~_near_next(points, count, tolerance))
    for _ in range(4):
        straight = _on_chord(points, count, tolerance)
        straight[:, 1:] &= ~straight[:, :-1]  # two neighbours at once could remove a corner
        if not straight.any():
            break
        points, count = _select_corners(points, count, ~straight)
    return points, count


def _select_corners(points: Array, count: Index, keep: Mask) -> tuple[Array, Index]:
    """Padded polygons, reduced to the corners that the mask `keep` selects."""
    keep = keep & (np.arange(points.shape[1]) < count[:, None])
    position = np.cumsum(keep, axis=1) - 1
    new_count: Index = position[:, -1] + 1
    result = np.zeros((len(points), max(int(new_count.max(initial=1)), 1), points.shape[2]))
    kept_positions = np.nonzero(keep)
    result[kept_positions[0], position[kept_positions]] = points[kept_positions]
    return result, new_count


def _near_next(points: Array, count: Index, tolerance: Array) -> Mask:
    """Mask of corners that lie within `tolerance` of the next corner."""
    k = np.arange(points.shape[1])
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    step = points[np.arange(len(points))[:, None], after] - points
    near: Mask = np.linalg.norm(step, axis=2) <= tolerance[:, None]
    near &= count[:, None] > 1
    return near


def _on_chord(points: Array, count: Index, tolerance: Array) -> Mask:
    """Mask of corners that lie within `tolerance` of the line between both neighbours."""
    k = np.arange(points.shape[1])
    rows = np.arange(len(points))[:, None]
    after = points[rows, np.where(k + 1 < count[:, None], k + 1, 0)]
    before = points[rows, np.where(k > 0, k - 1, count[:, None] - 1)]
    chord, arm = after - before, points - before
    cross = chord[..., 0] * arm[..., 1] - chord[..., 1] * arm[..., 0]
    length = np.linalg.norm(chord, axis=2)
    near: Mask = np.abs(cross) <= tolerance[:, None] * np.maximum(length, tolerance[:, None])
    near &= (k < count[:, None]) & (count[:, None] > 2)
    return near


# hulls and outlines -----------------------------------------------------------------------


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull of points in the plane, anticlockwise, shape (m, 2).

    Points on a line have a hull of two corners.

    Examples
    --------
    >>> convex_hull(np.array([[0., 0], [1, 0], [.5, .5], [1, 1], [0, 1]])).tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    import shapely

    hull: Array = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(points)))
    if len(hull) <= 2:  # a point or a segment, not a closed ring
        return np.unique(hull, axis=0)
    hull = hull[-2::-1]  # GEOS runs clockwise and repeats the first corner
    return np.roll(hull, -int(np.lexsort((hull[:, 1], hull[:, 0]))[0]), axis=0)


def width_of(hull: Array) -> float:
    """Least width of a convex polygon in any direction [length unit].

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


def overlay(
    first_outline: tuple[Array, bool], second_outline: tuple[Array, bool]
) -> tuple[Array, float]:
    """Convex hull, shape (m, 2), and area of the overlap of two outlines.

    Each outline is (corners, convex): a boundary loop if convex, else triangles, three corners
    each. GEOS may return an overlap for triangles with disjoint interiors. So the overlap is
    computed twice, directly and on a fine grid; if the areas differ, the result on the grid is
    used.
    """
    import shapely

    first, second = _region(*first_outline), _region(*second_outline)
    size = float(np.ptp(shapely.get_coordinates([first, second]), axis=0).max())
    gridded = shapely.intersection(first, second, grid_size=OUTLINE_GRID * size)
    common = shapely.intersection(first, second)
    least = min(first.area, second.area)
    if not common.is_valid or abs(common.area - gridded.area) > OUTLINE_AREA * least:
        common = gridded
    polygons = [p for p in shapely.get_parts(common) if p.geom_type == "Polygon"]
    if not polygons:
        return np.empty((0, 2)), 0.0
    return convex_hull(shapely.get_coordinates(polygons)), float(sum(p.area for p in polygons))


def _region(corners: Array, convex: bool) -> shapely.Geometry:
    """The shapely region of a convex polygon, or of the union of triangles (not `convex`)."""
    import shapely

    if convex:
        return shapely.Polygon(corners)
    triangles = corners.reshape(-1, 3, 2)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    start = index.reshape(-1)
    end = np.roll(index, -1, axis=1).reshape(-1)
    is_shared = np.isin(start * len(vertices) + end, end * len(vertices) + start)
    edges = np.stack([vertices[start[~is_shared]], vertices[end[~is_shared]]], axis=1)
    region = shapely.build_area(shapely.multilinestrings(shapely.linestrings(edges)))
    triangle_area = 0.5 * np.abs(
        (triangles[:, 1, 0] - triangles[:, 0, 0]) * (triangles[:, 2, 1] - triangles[:, 0, 1])
        - (triangles[:, 1, 1] - triangles[:, 0, 1]) * (triangles[:, 2, 0] - triangles[:, 0, 0])
    )
    # boundaries that touch themselves confuse build_area: unite the triangles instead
    if (
        region is None
        or abs(region.area - triangle_area.sum()) > OUTLINE_AREA * triangle_area.sum()
    ):
        grid = OUTLINE_GRID * np.ptp(corners)
        region = shapely.union_all(shapely.polygons(triangles), grid_size=grid)
    return region
