"""Contact points of two smooth faces on their true surfaces, which the triangles approximate.

A corner x of one face, with its normal n, is matched with the triangle of the other face that the
line x + t n meets nearest to x. The contact lies on the surface, not on the triangle: see
`kilter.contact.smooth.smooth_faces`. At a crossing of the rims of both faces the area of contact
has a corner; the normals there are interpolated between the ends of the two edges.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, cross, ratio, unit_rows
from kilter.contact.broad import joins
from kilter.contact.contact_tolerances import DISTANCE_ROUNDING, SMOOTH_ASIDE, SMOOTH_FACING
from kilter.contact.sharp.edges import segment_distance
from kilter.contact.smooth.smooth_faces import SmoothFace

__all__ = ["Matches", "matches"]


@dataclass(frozen=True, slots=True, eq=False)
class Matches(Rows):
    """Contact points of two smooth faces, with their normals, gaps and errors.

    Attributes
    ----------
    point, normal : ndarray, shape (n, 3)
        Points half-way between the surfaces; unit normals from the first face to the second.
    gap : ndarray, shape (n,)
        Gap between the surfaces [length unit].
    apart : ndarray, shape (n,)
        Half the angle between the normals of the two surfaces [rad].
    doubt : ndarray, shape (n,)
        Error of the more accurate of the two normals [rad].
    """

    point: Array = columns(3)
    normal: Array = columns(3)
    gap: Array = columns()
    apart: Array = columns()
    doubt: Array = columns()


def matches(first: SmoothFace, second: SmoothFace, reach: float, slack: float) -> Matches:
    """Contact points of two smooth faces, at most `reach` apart along the normals at the corners.

    `slack` is the distance that is allowed across the normals.
    """
    lateral = slack + SMOOTH_ASIDE * reach
    forward = _project_corners(first, second, reach, lateral)
    backward = _reversed_matches(_project_corners(second, first, reach, lateral))
    return Matches.join([forward, backward, _rim_crossings(first, second, reach)])


def _reversed_matches(matched: Matches) -> Matches:
    """The same contact points with the two faces exchanged."""
    return Matches(matched.point, -matched.normal, matched.gap, matched.apart, matched.doubt)


def _project_corners(
    first: SmoothFace, second: SmoothFace, reach: float, lateral: float
) -> Matches:
    """Project the corners of a smooth face on another; return the contact points."""
    # a match lies within `lateral` of the piece of the line that is at most `reach` long
    half = np.abs(first.normals) * reach + lateral
    low, high = first.points - half, first.points + half
    blocks: list[tuple[Array, Index, Index, Array]] = []
    for corner, triangle in _meeting_boxes((low, high), second.triangle_boxes, 0.0):
        k, m = _near_lines(first, second, corner, triangle, lateral)
        corners = second.points[second.triangles[m]]
        share, height, miss = _line_hits(first.points[k], first.normals[k], corners)
        keep = (np.abs(height) <= reach) & (miss <= lateral)
        blocks.append((share[keep], k[keep], m[keep], (np.abs(height) + miss)[keep]))
    if not blocks:
        return Matches.none()
    share, k, m, distance = (np.concatenate([block[n] for block in blocks]) for n in range(4))
    # the nearest triangle of each corner
    order = np.lexsort((distance, k))
    order = order[np.unique(k[order], return_index=True)[1]]
    share, k, m = share[order], k[order], m[order]
    corner_points = _SurfacePoints(first.points, first.normals, first.doubt).take(k)
    return _match_sides(corner_points, _surface_points(second, m, share))


def _near_lines(
    first: SmoothFace, second: SmoothFace, k: Index, m: Index, lateral: float
) -> tuple[Index, Index]:
    """The pairs (corner, triangle) whose line through the corner may come near the triangle."""
    middle, radius = second.triangle_balls
    relative = middle[m] - first.points[k]
    off = cross(relative, first.normals[k])
    most = (radius[m] + lateral) * (1 + DISTANCE_ROUNDING)
    near = np.einsum("ij,ij->i", off, off) <= most**2
    return k[near], m[near]


_Boxes = tuple[Array, Array]
"""Lower and upper corners of boxes, shape (n, 3)."""


def _meeting_boxes(first: _Boxes, second: _Boxes, margin: float) -> Iterator[tuple[Index, Index]]:
    """Yield the pairs (row of first, row of second) of boxes at most `margin` apart, in blocks.

    Only boxes near the common box of the other boxes are compared with each other.
    """
    rows_a = _meeting_common(first, second, margin)
    first = first[0][rows_a], first[1][rows_a]
    rows_b = _meeting_common(second, first, margin)
    second = second[0][rows_b], second[1][rows_b]
    owners = [np.zeros(len(rows), dtype=np.int64) for rows in (rows_a, rows_b)]
    for _, x, y in joins(owners[0], first, owners[1], second, np.array([margin])):
        yield rows_a[x], rows_b[y]


def _meeting_common(boxes: _Boxes, others: _Boxes, margin: float) -> Index:
    """Rows of boxes at most `margin` from the common box of all other boxes."""
    if not len(others[0]):
        return np.empty(0, dtype=np.int64)
    low, high = others[0].min(axis=0) - margin, others[1].max(axis=0) + margin
    rows: Index = np.flatnonzero(((boxes[0] <= high) & (low <= boxes[1])).all(axis=1))
    return rows


def _line_hits(points: Array, normal: Array, corners: Array) -> tuple[Array, Array, Array]:
    """Points in which lines cross the planes of triangles.

    Returns
    -------
    share : ndarray, shape (n, 3)
        Barycentric coordinates of the nearest point inside the triangle.
    height : ndarray, shape (n,)
        Distance along the line; inf if the triangle does not face the line [length unit].
    off : ndarray, shape (n,)
        Distance of the meeting point from the triangle [length unit].
    """
    a, b, c = corners.transpose(1, 0, 2)
    plane = cross(b - a, c - a)
    slope = np.einsum("ij,ij->i", plane, normal)
    size = np.linalg.norm(plane, axis=1)
    steep = np.abs(slope) < 0.5 * size  # the triangle does not face the line
    height = np.einsum("ij,ij->i", plane, a - points) / np.where(steep, np.inf, slope)
    hit = points + height[:, None] * normal
    areas = [
        np.einsum("ij,ij->i", plane, cross(q - p, hit - p)) for p, q in ((b, c), (c, a), (a, b))
    ]
    share = np.column_stack(areas) / np.maximum(size, np.finfo(float).tiny)[:, None] ** 2
    inside = np.clip(share, 0, None)
    inside = inside / inside.sum(axis=1)[:, None]
    off = np.linalg.norm(hit - np.einsum("nk,nki->ni", inside, corners), axis=1)
    return inside, np.where(steep, np.inf, height), off


def _surface_points(face: SmoothFace, rows: Index, share: Array) -> _SurfacePoints:
    """Points, unit normals and errors on the true surface, from positions on the triangles."""
    used = face.triangles[rows]
    corners, normals = face.points[used], face.normals[used]
    flat = np.einsum("nk,nki->ni", share, corners)
    over = np.einsum("nki,nki->nk", corners - flat[:, None], normals)
    lift = np.einsum("nk,nki->ni", share * over, normals) / 2
    normal = unit_rows(np.einsum("nk,nki->ni", share, normals))
    return _SurfacePoints(flat + lift, normal, np.einsum("nk,nk->n", share, face.doubt[used]))


@dataclass(frozen=True, slots=True, eq=False)
class _SurfacePoints(Rows):
    """Points of a smooth surface, with unit normals and the error of the normals [rad]."""

    place: Array = columns(3)
    normal: Array = columns(3)
    doubt: Array = columns()


def _match_sides(first: _SurfacePoints, second: _SurfacePoints) -> Matches:
    """Contact points half-way between pairs of surface points with opposing normals."""
    normal = unit_rows(first.normal - second.normal)
    apart = np.linalg.norm(first.normal + second.normal, axis=1) / 2
    gap = np.einsum("ij,ij->i", second.place - first.place, normal)
    doubt = np.minimum(first.doubt, second.doubt)
    matched = Matches((first.place + second.place) / 2, normal, gap, apart, doubt)
    return matched.take(np.flatnonzero(apart <= SMOOTH_FACING))


def _rim_crossings(first: SmoothFace, second: SmoothFace, reach: float) -> Matches:
    """Contact points at which the outlines of two smooth faces cross."""
    blocks = [Matches.none()]
    for k, m in _meeting_boxes(first.rim_boxes, second.rim_boxes, reach):
        (p, q) = first.points[first.rim[k]].transpose(1, 0, 2)
        (r, s) = second.points[second.rim[m]].transpose(1, 0, 2)
        size = np.linalg.norm(q - p, axis=1) * np.linalg.norm(s - r, axis=1)
        is_crossing = np.linalg.norm(cross(q - p, s - r), axis=1) > SMOOTH_ASIDE * size
        k, m = k[is_crossing], m[is_crossing]
        p, q, r, s = p[is_crossing], q[is_crossing], r[is_crossing], s[is_crossing]
        inner = _cross_inside(p, q, r, s)
        k, m, p, q, r, s = k[inner], m[inner], p[inner], q[inner], r[inner], s[inner]
        distance, on_first, on_second = segment_distance(p, q, r, s)
        sides = []
        inside = distance <= reach
        for face, rim, crossing, start, end in (
            (first, k, on_first, p, q),
            (second, m, on_second, r, s),
        ):
            t = ratio(np.linalg.norm(crossing - start, axis=1), np.linalg.norm(end - start, axis=1))
            inside &= (t > SMOOTH_ASIDE) & (t < 1 - SMOOTH_ASIDE)
            low, high = face.rim[rim].T
            normal = (1 - t)[:, None] * face.normals[low] + t[:, None] * face.normals[high]
            doubt = (1 - t) * face.doubt[low] + t * face.doubt[high]
            sides.append(_SurfacePoints(crossing, unit_rows(normal), doubt))
        blocks.append(_match_sides(sides[0].take(inside), sides[1].take(inside)))
    return Matches.join(blocks)


def _cross_inside(p: Array, q: Array, r: Array, s: Array) -> Mask:
    """Mask of edges p q and r s whose lines come nearest to each other inside both edges.

    Otherwise the nearest points of the edges themselves include an end. The lines are far from
    parallel.
    """
    along, other, gap = q - p, s - r, r - p
    a, e, b, c, f = (
        np.einsum("ij,ij->i", x, y)
        for x, y in (
            (along, along),
            (other, other),
            (along, other),
            (along, gap),
            (other, gap),
        )
    )
    determinant = a * e - b * b
    t, u = c * e - b * f, b * c - a * f
    inside: Mask = (t > 0) & (t < determinant) & (u > 0) & (u < determinant)
    return inside
