"""Points of one smooth face on the surface that another stands for.

A corner x of one face, with its normal n, meets the triangle of the other that the line
x + t n runs through nearest to x. What touches there is the surface, not the triangle: see
`kilter.contact.smooth.smooth_faces`. Where the rims of both cross, the area of contact has a
corner; there the normals are those between the ends of the two edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Rows, columns, cross, ratio, unit_rows
from kilter.contact.broad import joins
from kilter.contact.contact_tolerances import SMOOTH_ASIDE, SMOOTH_FACING
from kilter.contact.sharp.edges import segment_distance
from kilter.contact.smooth.smooth_faces import SmoothFace

__all__ = ["Matches", "matches"]


@dataclass(frozen=True, slots=True, eq=False)
class Matches(Rows):
    """Points where two smooth faces lie on each other.

    Attributes
    ----------
    point, normal : ndarray, shape (n, 3)
        Half-way between the surfaces; unit normal from the first face to the second.
    gap : ndarray, shape (n,)
        Between the surfaces [length unit].
    apart : ndarray, shape (n,)
        Half the angle between the normals of the two [rad].
    doubt : ndarray, shape (n,)
        How well the better known of the two normals is known [rad].
    """

    point: Array = columns(3)
    normal: Array = columns(3)
    gap: Array = columns()
    apart: Array = columns()
    doubt: Array = columns()


def matches(one: SmoothFace, other: SmoothFace, reach: float, slack: float) -> Matches:
    """Where two faces come within `reach` along their normals, and `slack` aside."""
    aside = slack + SMOOTH_ASIDE * reach
    there = _on_face(one, other, reach, aside)
    back = _turned(_on_face(other, one, reach, aside))
    return Matches.join([there, back, _rims_cross(one, other, reach)])


def _turned(found: Matches) -> Matches:
    return Matches(found.point, -found.normal, found.gap, found.apart, found.doubt)


def _on_face(one: SmoothFace, other: SmoothFace, reach: float, aside: float) -> Matches:
    """Corners of the first face on the surface of the second."""
    corners = other.points[other.triangles]
    here, there = (np.zeros(len(rows), dtype=np.int64) for rows in (one.points, corners))
    around = one.points - reach, one.points + reach
    boxes = corners.min(axis=1), corners.max(axis=1)
    found: list[tuple[Array, Index, Index, Array]] = []
    for _, k, m in joins(here, around, there, boxes, np.zeros(1)):
        share, height, off = _through(one.points[k], one.normals[k], corners[m])
        keep = (np.abs(height) <= reach) & (off <= aside)
        found.append((share[keep], k[keep], m[keep], (np.abs(height) + off)[keep]))
    if not found:
        return Matches.none()
    share, k, m, far = (np.concatenate([block[n] for block in found]) for n in range(4))
    order = np.lexsort((far, k))
    order = order[np.unique(k[order], return_index=True)[1]]
    share, k, m = share[order], k[order], m[order]
    mine = _Side(one.points, one.normals, one.doubt).take(k)
    return _matched(mine, _surface(other, m, share))


def _through(points: Array, normal: Array, corners: Array) -> tuple[Array, Array, Array]:
    """Where lines run through triangles: barycentric coordinates, height, how far outside."""
    a, b, c = corners.transpose(1, 0, 2)
    plane = cross(b - a, c - a)
    fall = np.einsum("ij,ij->i", plane, normal)
    size = np.linalg.norm(plane, axis=1)
    steep = np.abs(fall) < 0.5 * size  # they do not face each other
    height = np.einsum("ij,ij->i", plane, a - points) / np.where(steep, np.inf, fall)
    at = points + height[:, None] * normal
    parts = [
        np.einsum("ij,ij->i", plane, cross(q - p, at - p)) for p, q in ((b, c), (c, a), (a, b))
    ]
    share = np.column_stack(parts) / np.maximum(size, np.finfo(float).tiny)[:, None] ** 2
    inside = np.clip(share, 0, None)
    inside = inside / inside.sum(axis=1)[:, None]
    off = np.linalg.norm(at - np.einsum("nk,nki->ni", inside, corners), axis=1)
    return inside, np.where(steep, np.inf, height), off


def _surface(face: SmoothFace, rows: Index, share: Array) -> _Side:
    """The surface over points of triangles."""
    used = face.triangles[rows]
    corners, normals = face.points[used], face.normals[used]
    flat = np.einsum("nk,nki->ni", share, corners)
    over = np.einsum("nki,nki->nk", corners - flat[:, None], normals)
    lift = np.einsum("nk,nki->ni", share * over, normals) / 2
    normal = unit_rows(np.einsum("nk,nki->ni", share, normals))
    return _Side(flat + lift, normal, np.einsum("nk,nk->n", share, face.doubt[used]))


@dataclass(frozen=True, slots=True, eq=False)
class _Side(Rows):
    """Points of one surface, its unit normals there and how well they are known."""

    place: Array = columns(3)
    normal: Array = columns(3)
    doubt: Array = columns()


def _matched(one: _Side, other: _Side) -> Matches:
    """Points of both surfaces as one point of contact each, where they face each other."""
    normal = unit_rows(one.normal - other.normal)
    apart = np.linalg.norm(one.normal + other.normal, axis=1) / 2
    gap = np.einsum("ij,ij->i", other.place - one.place, normal)
    doubt = np.minimum(one.doubt, other.doubt)
    found = Matches((one.place + other.place) / 2, normal, gap, apart, doubt)
    return found.take(np.flatnonzero(apart <= SMOOTH_FACING))


def _rims_cross(one: SmoothFace, other: SmoothFace, reach: float) -> Matches:
    """Where edges of the rims cross inside of both."""
    ends = [face.points[face.rim] for face in (one, other)]
    boxes = [(end.min(axis=1), end.max(axis=1)) for end in ends]
    owners = [np.zeros(len(end), dtype=np.int64) for end in ends]
    found = [Matches.none()]
    for _, k, m in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([reach])):
        (p, q), (r, s) = ends[0][k].transpose(1, 0, 2), ends[1][m].transpose(1, 0, 2)
        size = np.linalg.norm(q - p, axis=1) * np.linalg.norm(s - r, axis=1)
        across = np.linalg.norm(cross(q - p, s - r), axis=1) > SMOOTH_ASIDE * size
        k, m = k[across], m[across]
        p, q, r, s = p[across], q[across], r[across], s[across]
        distance, x, y = segment_distance(p, q, r, s)
        sides = []
        inside = distance <= reach
        for face, rim, at, start, end in ((one, k, x, p, q), (other, m, y, r, s)):
            t = ratio(np.linalg.norm(at - start, axis=1), np.linalg.norm(end - start, axis=1))
            inside &= (t > SMOOTH_ASIDE) & (t < 1 - SMOOTH_ASIDE)
            low, high = face.rim[rim].T
            normal = (1 - t)[:, None] * face.normals[low] + t[:, None] * face.normals[high]
            doubt = (1 - t) * face.doubt[low] + t * face.doubt[high]
            sides.append(_Side(at, unit_rows(normal), doubt))
        found.append(_matched(sides[0].take(inside), sides[1].take(inside)))
    return Matches.join(found)
