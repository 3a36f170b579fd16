"""Clipping of convex polygons against convex polygons, many pairs in one go.

Sutherland-Hodgman on padded arrays: polygon k of a batch has `count[k]` corners, turning
left, in ``points[k, :count[k]]``. What lies behind the count is meaningless.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index, Mask

__all__ = ["clip_convex", "padded", "polygon_area", "tidy"]

Scalar = TypeVar("Scalar", bound=np.generic)


def padded(points: NDArray[Scalar], first: Index, count: Index) -> NDArray[Scalar]:
    """Rows ``first[k]`` to ``first[k] + count[k]`` of `points` as one array, shape (n, m, d).

    The last corner is repeated behind the count.
    """
    k = np.minimum(np.arange(int(count.max(initial=1))), np.maximum(count, 1)[:, None] - 1)
    taken: NDArray[Scalar] = points[first[:, None] + k]
    return taken


def clip_convex(
    subject: Array, subject_count: Index, clip: Array, clip_count: Index
) -> tuple[Array, Index]:
    """The intersection of each subject polygon with its clip polygon.

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
        0 where nothing is left.

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


def _half_plane(points: Array, count: Index, start: Array, along: Array) -> tuple[Array, Index]:
    """What lies left of the lines ``start + t along``."""
    rows, width = len(points), points.shape[1]
    k = np.arange(width)
    real = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    side = along[:, None, 0] * (points[..., 1] - start[:, None, 1]) - along[:, None, 1] * (
        points[..., 0] - start[:, None, 0]
    )
    lines = np.arange(rows)[:, None]
    next_side = side[lines, after]
    inside = real & (side >= 0)
    crosses = real & ((side >= 0) != (next_side >= 0))
    if not crosses.any() and bool((inside == real).all()):
        return points, count
    with np.errstate(divide="ignore", invalid="ignore"):
        t = side / (side - next_side)
    t = np.where(crosses, t, 0.0)
    crossing = points + t[..., None] * (points[lines, after] - points)
    keep = np.stack([inside, crosses], axis=2).reshape(rows, 2 * width)
    both = np.stack([points, crossing], axis=2).reshape(rows, 2 * width, 2)
    position = np.cumsum(keep, axis=1) - 1
    left: Index = position[:, -1] + 1
    result = np.zeros((rows, max(int(left.max()), 1), 2))
    where = np.nonzero(keep)
    result[where[0], position[where]] = both[where]
    return result, left


def polygon_area(points: Array, count: Index) -> Array:
    """Signed area of each polygon, shape (n,)."""
    k = np.arange(points.shape[1])
    real = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    local = points - points[:, :1]
    following = local[np.arange(len(points))[:, None], after]
    cross = local[..., 0] * following[..., 1] - local[..., 1] * following[..., 0]
    area: Array = 0.5 * np.where(real, cross, 0.0).sum(axis=1)
    return area


def tidy(points: Array, count: Index, tolerance: Array) -> tuple[Array, Index]:
    """Polygons without near-duplicate corners, then without corners on a straight line.

    Two passes in this order: in one pass two near-duplicates at a corner would each look
    like a point on a line, and the corner would be lost.
    """
    points, count = _kept(points, count, ~_near_next(points, count, tolerance))
    for _ in range(4):
        straight = _on_chord(points, count, tolerance)
        straight[:, 1:] &= ~straight[:, :-1]  # never two neighbours at once
        if not straight.any():
            break
        points, count = _kept(points, count, ~straight)
    return points, count


def _kept(points: Array, count: Index, keep: Mask) -> tuple[Array, Index]:
    keep = keep & (np.arange(points.shape[1]) < count[:, None])
    position = np.cumsum(keep, axis=1) - 1
    left: Index = position[:, -1] + 1
    result = np.zeros((len(points), max(int(left.max(initial=1)), 1), points.shape[2]))
    where = np.nonzero(keep)
    result[where[0], position[where]] = points[where]
    return result, left


def _near_next(points: Array, count: Index, tolerance: Array) -> Mask:
    k = np.arange(points.shape[1])
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    step = points[np.arange(len(points))[:, None], after] - points
    near: Mask = np.linalg.norm(step, axis=2) <= tolerance[:, None]
    near &= count[:, None] > 1
    return near


def _on_chord(points: Array, count: Index, tolerance: Array) -> Mask:
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
