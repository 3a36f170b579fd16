"""Segments between the surfaces of two parts that meet no other face of either part.

A candidate point of contact lies between a point of the surface of part a and a point of that of
part b. With a gap, the segment between both points must lie outside of both parts; with a
penetration, inside of both. At its ends it leaves the faces on which they lie in the right
direction, so it does if and only if it crosses no triangle of either part in between. Otherwise
the faces are on different sides of a wall, and do not see each other.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, lengths, ragged
from kilter.contact.common.broad import joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.facets import warps
from kilter.contact.contact_tolerances import SAME_PLACE

PARALLEL = 1e-6
"""Sine of the angle to a triangle below which a segment runs along it [-]."""
AT_END = 1e-3
"""A crossing within this fraction of the length of a segment lies at its end [-]. A larger value
overlooks thicker walls."""
SEAM = 1e-9
"""Margin of the triangles, so that no segment passes between neighbours [-]."""


def are_clear(search: ContactSearch, pair: Index, start: Array, end: Array) -> Mask:
    """Mask of segments that cross no triangle of their parts between their ends, shape (n,).

    Triangles lie off the exact surface of a curved face by up to the sagitta, and off the plane of
    a warped face by up to the warp. So triangles whose planes are within twice the sagittas of an
    end, and the warps, do not count.

    Arguments: `pair` (n,): row of each segment in `search.pairs`; `start`, `end` (n, 3) [length
    unit].
    """
    geometry = search.geometry
    clear = np.ones(len(pair), dtype=bool)
    length = lengths(end - start)
    a, b = search.pairs[pair].T
    slack = geometry.slack[a] + geometry.slack[b]
    warp = np.zeros(len(geometry.mass))
    np.maximum.at(warp, search.facets.part, warps(geometry, search.facets))
    margin = 2 * slack + SAME_PLACE * np.minimum(geometry.size[a], geometry.size[b])
    margin += warp[a] + warp[b]
    rows = np.flatnonzero(length > 2 * margin)
    if not len(rows):
        return clear
    for side in (0, 1):
        rows = rows[clear[rows]]
        owner, triangle = _near_triangles(search, pair[rows], start[rows], end[rows], side)
        corners = geometry.vertices[geometry.triangles[triangle]]
        segment = rows[owner]
        crossed = _crosses(start[segment], end[segment], corners, margin[segment])
        clear[segment[crossed]] = False
    return clear


def _near_triangles(
    search: ContactSearch, pair: Index, start: Array, end: Array, side: int
) -> tuple[Index, Index]:
    """Pairs of a segment and a triangle of part a (side 0) or b (1) whose boxes meet."""
    geometry, boxes = search.geometry, search.boxes
    part = search.pairs[pair, side]
    turned = start @ boxes.frame.T, end @ boxes.frame.T
    low, high = np.minimum(*turned), np.maximum(*turned)
    of_part, number = np.unique(part, return_inverse=True)
    region = np.full((2, len(of_part), 3), np.inf)
    np.minimum.at(region[0], number, low)
    np.minimum.at(region[1], number, -high)
    owner, triangle = ragged(geometry.triangle_start, of_part)
    corners = boxes.turned[geometry.triangles[triangle]]
    least, most = corners.min(axis=1), corners.max(axis=1)
    meets = (least <= -region[1][owner]).all(axis=1) & (most >= region[0][owner]).all(axis=1)
    owner, triangle, least, most = owner[meets], triangle[meets], least[meets], most[meets]
    order = np.argsort(number, kind="stable")
    blocks = [
        (order[x], triangle[y])
        for _, x, y in joins(
            number[order], (low[order], high[order]), owner, (least, most),
            np.full(len(of_part), TINY),
        )
    ]  # fmt: skip
    if not blocks:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate([x for x, _ in blocks]), np.concatenate([y for _, y in blocks])


def _crosses(start: Array, end: Array, corners: Array, margin: Array) -> Mask:
    """Mask of segments that cross their triangle, both ends a margin off its plane, shape (n,)."""
    along, length = end - start, lengths(end - start)
    double = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = lengths(double)
    rise = np.einsum("ij,ij->i", along, double)
    height = np.einsum("ij,ij->i", corners[:, 0] - start, double)
    crosses: Mask = np.abs(rise) > PARALLEL * length * area
    share = height / np.where(crosses, rise, 1.0)
    crosses &= (share > AT_END) & (share < 1 - AT_END)
    crosses &= np.minimum(np.abs(height), np.abs(rise - height)) > margin * area
    foot = start + share[:, None] * along
    for k in range(3):
        p, q = corners[:, k], corners[:, (k + 1) % 3]
        inward = np.einsum("ij,ij->i", cross(double, q - p), foot - p)
        crosses &= inward >= -SEAM * area**1.5 * lengths(q - p)
    return crosses
