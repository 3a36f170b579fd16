"""How far points and triangles are from triangles, row by row.

The nearest point of a triangle to x lies inside it, below x, or on its boundary. Two
triangles cross where a side of one pierces the other; else they are nearest to each other at
a corner of one or between two sides.

References
----------
C. Ericson, Real-Time Collision Detection, 2005, chapter 5.1.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask, cross, nearest, ratio, unit_rows
from kilter.contact.broad import joins
from kilter.contact.contact_tolerances import FREE_PARALLEL
from kilter.contact.sharp.edges import segment_distance

__all__ = ["at_most", "near_triangles", "surface_distance"]


NEAR = 2
"""Triangles by whose distance the distance of the nearest is bounded."""


def surface_distance(points: Array, triangles: Array, most: Array | None = None) -> Array:
    """Distance of points, shape (n, 3), from the nearest of triangles, shape (m, 3, 3).

    Parameters
    ----------
    points, triangles : ndarray
    most : ndarray, shape (n,), optional
        What the distances are at most: see `at_most`.

    Examples
    --------
    >>> corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> surface_distance(np.array([[0.2, 0.2, 3], [-2, 0, 0], [1, 1, 0]]), corners).round(3)
    array([3.   , 2.   , 0.707])
    """
    most = at_most(points, triangles) if most is None else most
    around = points - most[:, None], points + most[:, None]
    boxes = triangles.min(axis=1), triangles.max(axis=1)
    here, there = (np.zeros(len(rows), dtype=np.int64) for rows in (points, triangles))
    least = most.copy()
    for _, k, m in joins(here, around, there, boxes, np.zeros(1)):
        off = np.linalg.norm(points[k] - _foot(points[k], triangles[m]), axis=1)
        np.minimum.at(least, k, off)
    return least


def at_most(points: Array, triangles: Array) -> Array:
    """Bounds on the distance of points from the nearest of triangles: that of some near ones."""
    count = min(NEAR, len(triangles))
    near = nearest(triangles.mean(axis=1), points, count)[1].reshape(-1)
    places = np.repeat(points, count, axis=0)
    off = np.linalg.norm(places - _foot(places, triangles[near]), axis=1)
    bound: Array = off.reshape(-1, count).min(axis=1)
    return bound


def _foot(points: Array, triangles: Array) -> Array:
    """The nearest point of each triangle, shape (n, 3)."""
    normal = unit_rows(cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    height = np.einsum("ij,ij->i", points - triangles[:, 0], normal)
    below = points - height[:, None] * normal
    inside = _inside(below, triangles, normal)
    foot: Array = below
    nearest = np.where(inside, np.abs(height), np.inf)
    for k in range(3):
        start, along = triangles[:, k], triangles[:, (k + 1) % 3] - triangles[:, k]
        t = ratio(np.einsum("ij,ij->i", points - start, along), (along**2).sum(axis=1))
        at = start + np.clip(t, 0, 1)[:, None] * along
        off = np.linalg.norm(points - at, axis=1)
        closer = off < nearest
        foot = np.where(closer[:, None], at, foot)
        nearest = np.where(closer, off, nearest)
    return foot


def _inside(points: Array, triangles: Array, normal: Array) -> Mask:
    """Points of the planes of triangles that lie inside them."""
    inside: Mask = (normal != 0).any(axis=1)
    for k in range(3):
        start, along = triangles[:, k], triangles[:, (k + 1) % 3] - triangles[:, k]
        inside &= np.einsum("ij,ij->i", cross(along, points - start), normal) >= 0
    return inside


def near_triangles(one: Array, other: Array, reach: float) -> Array:
    """A point between each two triangles, shape (n, 3, 3), that come within `reach`, (m, 3).

    Examples
    --------
    >>> flat = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]])
    >>> near_triangles(flat, flat + [0, 0, 0.5], 1.0).shape
    (1, 3)
    >>> near_triangles(flat, flat + [0, 0, 1.5], 1.0).shape
    (0, 3)
    """
    apart = _one_sided(one, other, reach) | _one_sided(other, one, reach)
    one, other = one[~apart], other[~apart]
    off, point = _pierced(one, other)
    for best in (_pierced(other, one), *_corners(one, other), *_corners(other, one)):
        off, point = _nearer((off, point), best)
    for k in range(3):
        for m in range(3):
            sides = (one[:, k], one[:, k - 1], other[:, m], other[:, m - 1])
            off, point = _nearer((off, point), _sides(*sides))
    return point[off <= reach]


def _one_sided(one: Array, other: Array, reach: float) -> Mask:
    """Whether one triangle lies to one side of the plane of the other, farther than `reach`."""
    normal = unit_rows(cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0]))
    height = np.einsum("nki,ni->nk", one - other[:, :1], normal)
    aside: Mask = (height.min(axis=1) > reach) | (height.max(axis=1) < -reach)
    return aside


def _nearer(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array]:
    closer = other[0] < one[0]
    return np.where(closer, other[0], one[0]), np.where(closer[:, None], other[1], one[1])


def _corners(one: Array, other: Array) -> list[tuple[Array, Array]]:
    """Distances of the corners of one from the other, and points half-way."""
    found = []
    for k in range(3):
        foot = _foot(one[:, k], other)
        found.append((np.linalg.norm(one[:, k] - foot, axis=1), (one[:, k] + foot) / 2))
    return found


def _pierced(one: Array, other: Array) -> tuple[Array, Array]:
    """0 where a side of one crosses the other, else infinite; and where."""
    normal = unit_rows(cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0]))
    off, point = np.full(len(one), np.inf), one[:, 0]
    for k in range(3):
        start, end = one[:, k - 1], one[:, k]
        low, high = (np.einsum("ij,ij->i", x - other[:, 0], normal) for x in (start, end))
        cuts = (low * high <= 0) & (low != high)
        t = np.where(cuts, low / np.where(cuts, low - high, 1.0), 0.0)
        at = start + t[:, None] * (end - start)
        through = cuts & _inside(at, other, normal)
        off, point = np.where(through, 0.0, off), np.where(through[:, None], at, point)
    return off, point


def _sides(p: Array, q: Array, r: Array, s: Array) -> tuple[Array, Array]:
    """Distance of sides that are not parallel, else infinite, and the point half-way."""
    d, e = q - p, s - r
    size = np.linalg.norm(d, axis=1) * np.linalg.norm(e, axis=1)
    some = np.flatnonzero(np.linalg.norm(cross(d, e), axis=1) > FREE_PARALLEL * size)
    off, point = np.full(len(p), np.inf), p.copy()
    off[some], here, there = segment_distance(p[some], q[some], r[some], s[some])
    point[some] = (here + there) / 2
    return off, point
