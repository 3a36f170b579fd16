"""Convex hulls of few points around many places at once.

A place is the origin of its points. `surround` decides for each place whether it lies in the hull
of its points, and returns up to three of them with positive weights whose mean is the place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask

ON_EDGE = 1e-9
"""Largest angle by which a place may lie beside an edge of its hull [rad]; a proof decides."""
AT_POINT = 1e-12
"""A place nearer to a point than this fraction of the reach of its points is at this point [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Surround:
    """Places and the hulls of their points."""

    inside: Mask
    """The place is in the hull, or on its edge within rounding, shape (m,)."""
    which: Index
    """Points whose weighted mean is the place, shape (m, 3)."""
    weight: Array
    """Their weights, which sum to 1, shape (m, 3)."""
    away: Array
    """Unit direction away from all points, for places outside, shape (m, 2)."""


def surround(points: Array, valid: Mask) -> Surround:
    """Decide for each place whether it lies in the hull of its points.

    Arguments: `points` (m, q, 2): points relative to their place; `valid` (m, q): points that
    exist; a place without points is outside.

    Examples
    --------
    >>> square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    >>> found = surround(np.stack([square, square + 3]), np.ones((2, 4), bool))
    >>> found.inside.tolist()
    [True, False]
    >>> (found.weight[0] @ square[found.which[0]]).tolist()
    [0.0, 0.0]
    """
    m, q = valid.shape
    rows = np.arange(m)
    count = valid.sum(axis=1)
    angle = np.where(valid, np.arctan2(points[..., 1], points[..., 0]), np.inf)
    order = np.argsort(angle, axis=1)
    angle = np.take_along_axis(angle, order, axis=1)
    last = np.maximum(count - 1, 0)
    k = np.arange(q)
    after = np.where(k < last[:, None], np.minimum(k + 1, q - 1), 0)
    with np.errstate(invalid="ignore"):
        turn = np.take_along_axis(angle, after, axis=1) - angle
        turn = np.where(k == last[:, None], turn + 2 * np.pi, turn)
    turn = np.where(k < count[:, None], turn, -np.inf)
    widest = turn.argmax(axis=1)
    gap = turn[rows, widest]
    inside = (count > 0) & (gap <= np.pi + ON_EDGE)
    on_edge = inside & (gap >= np.pi - ON_EDGE)

    # inside: the first point, and the two beside the opposite direction
    with np.errstate(invalid="ignore"):
        before = (angle <= angle[:, :1] + np.pi).sum(axis=1) - 1
    before = np.clip(before, 0, last)
    which = np.stack([np.zeros(m, np.int64), before, after[rows, before]], axis=1)
    edge = np.stack([widest, after[rows, widest], widest], axis=1)
    which = np.where(on_edge[:, None], edge, which)
    which = np.take_along_axis(order, which, axis=1)
    a, b, c = (points[rows, which[:, i]] for i in range(3))
    weight = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
    length_a, length_b = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
    along = np.stack([length_b, length_a, 0 * length_a], axis=1)
    weight = np.where(on_edge[:, None], along, np.maximum(weight, 0.0))
    total = weight.sum(axis=1)
    inside &= total > TINY
    weight = weight / np.maximum(total, TINY)[:, None]

    distance = np.where(valid, np.linalg.norm(points, axis=2), np.inf)
    nearest = distance.argmin(axis=1)
    reach = np.where(valid, distance, 0.0).max(axis=1, initial=0.0)
    at_point = (count > 0) & (distance[rows, nearest] <= AT_POINT * reach)
    inside |= at_point
    which = np.where(at_point[:, None], nearest[:, None], which)
    weight = np.where(at_point[:, None], np.array([1.0, 0.0, 0.0]), weight)

    first = np.where(count > 0, angle[rows, widest], 0.0)
    middle = first + np.where(count > 0, gap, 0.0) / 2
    away = np.stack([np.cos(middle), np.sin(middle)], axis=1) * (count > 0)[:, None]
    return Surround(inside, which, weight, away)


def _cross(a: Array, b: Array) -> Array:
    """Cross products of vectors in the plane, shape (...,)."""
    product: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def fan_weights(point: Array, polygon: Array, count: Index) -> tuple[Index, Array]:
    """Three corners of a convex polygon, and weights whose mean is a point in it, both (t, 3).

    Arguments: `point` (t, 2); `polygon` (t, q, 2): corners anticlockwise, padded; `count` (t,):
    number of corners, at least 3.

    Examples
    --------
    >>> square = np.array([[[0.0, 0], [1, 0], [1, 1], [0, 1]]])
    >>> which, weight = fan_weights(np.array([[0.25, 0.75]]), square, np.array([4]))
    >>> which.tolist(), weight.tolist()
    ([[0, 2, 3]], [[0.25, 0.25, 0.5]])
    """
    t, q = polygon.shape[:2]
    arm = polygon - point[:, None]
    first = arm[:, :1]
    b, c = arm[:, 1:-1], arm[:, 2:]
    weight = np.stack([_cross(b, c), _cross(c, first), _cross(first, b)], axis=2)
    total = weight.sum(axis=2)
    real = (np.arange(q - 2) < count[:, None] - 2) & (total > TINY)
    weight = weight / np.where(real, total, 1.0)[..., None]
    least = np.where(real, weight.min(axis=2), -np.inf)
    best = least.argmax(axis=1)
    chosen = np.maximum(weight[np.arange(t), best], 0.0)
    total = chosen.sum(axis=1)
    chosen = chosen / np.where(total > 0, total, 1.0)[:, None]
    which = np.stack([0 * best, best + 1, best + 2], axis=1)
    return which, chosen


def surrounding_triangles(points: Array, valid: Mask) -> tuple[Index, Index, Array]:
    """All triangles of points around each place.

    Returns `place` (t,): ascending; `which` (t, 3): points of each triangle; `weight` (t, 3):
    weights whose mean is the place.
    """
    a, b, c = _triples(valid.shape[1])
    cross = _cross(points[:, :, None], points[:, None, :])
    ab, bc, ca = cross[:, a, b], cross[:, b, c], cross[:, c, a]
    total = ab + bc + ca
    sign = np.where(total < 0, -1.0, 1.0)
    slack = -1e-12 * np.abs(total)
    is_around = (sign * ab >= slack) & (sign * bc >= slack) & (sign * ca >= slack)
    is_around &= np.abs(total) > TINY
    is_around &= valid[:, a] & valid[:, b] & valid[:, c]
    place, triple = np.nonzero(is_around)
    which = np.stack([a[triple], b[triple], c[triple]], axis=1)
    weight = np.stack([bc[place, triple], ca[place, triple], ab[place, triple]], axis=1)
    weight = weight / total[place, triple][:, None]
    return place, which, weight


_TRIPLES: dict[int, tuple[Index, Index, Index]] = {}


def _triples(q: int) -> tuple[Index, Index, Index]:
    """All a < b < c below q."""
    if q not in _TRIPLES:
        a, b, c = np.meshgrid(*(np.arange(q),) * 3, indexing="ij")
        keep = (a < b) & (b < c)
        _TRIPLES[q] = (a[keep], b[keep], c[keep])
    return _TRIPLES[q]


def plane_through(points: Array, heights: Array) -> Array:
    """Fields (a, b, c) through three points each, shape (m, 3)."""
    one, two = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    det = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    det = np.where(np.abs(det) > TINY, det, np.inf)
    up_one, up_two = heights[:, 1] - heights[:, 0], heights[:, 2] - heights[:, 0]
    b = (up_one * two[:, 1] - up_two * one[:, 1]) / det
    c = (up_two * one[:, 0] - up_one * two[:, 0]) / det
    a = heights[:, 0] - b * points[:, 0, 0] - c * points[:, 0, 1]
    return np.stack([a, b, c], axis=1)


def absolute_plane(plane: Array, center: Array) -> Array:
    """A field about a centre as a field about the origin."""
    return np.array([plane[0] - plane[1:] @ center, plane[1], plane[2]])


def lowest_planes(points: Array, heights: Array, center: Array) -> Array:
    """The planes above heights at points that are lowest at a centre, about the origin.

    Arguments: `points` (q, 2): relative to the centre; `heights` (k, q); `center` (2,). Returns (k,
    3): naN if the centre is outside of the hull of the points.
    """
    _, corner, weight = surrounding_triangles(points[None], np.ones((1, len(points)), dtype=bool))
    if not len(corner):
        return np.full((len(heights), 3), np.nan)
    best = (heights[:, corner] * weight).sum(axis=2).argmax(axis=1)
    support = corner[best]
    planes = plane_through(points[support], np.take_along_axis(heights, support, axis=1))
    under = heights - planes[:, :1] - planes[:, 1:] @ points.T
    planes[:, 0] += np.maximum(under.max(axis=1), 0.0)
    return np.stack([absolute_plane(plane, center) for plane in planes])
