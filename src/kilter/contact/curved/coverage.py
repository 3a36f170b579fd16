"""Parts of a line or of a circle that a face covers.

The triangles of a face represent it. A line of a surface with normal n lies on the face if the
plane through the line and n cuts the triangles; a point lies on it if the line along n meets a
triangle (`kilter.shape.covering`). Neighbouring triangles meet without gaps that way, and the ends
of a face across its generators are as exact as the corners of its triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across, cross, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE
from kilter.contact.contact_tolerances import APEX, BAND_FILLED, SEAM_ANGLE

__all__ = ["Bands", "bands_of", "common_spans", "slices", "unrolled"]


TURN = 2 * np.pi


def slices(triangles: Array, line: tuple[Array, Array, Array], reach: float, grow: float) -> Array:
    """Intervals of a straight line that lie on a face, shape (k, 2), sorted [length unit].

    Parameters
    ----------
    triangles : ndarray, shape (m, 3, 3)
        Triangles of the face.
    line : (x, d, n)
        A point of the line, its unit direction, and the unit normal of the face along it.
    reach : float
        Largest distance along n of triangles from the line; others belong to another side of the
        part [length unit].
    grow : float
        Largest distance of triangles beside the line that still count [length unit].
    """
    x, d, n = line
    local = triangles - x
    aside = local @ cross(d, n)
    rows = np.flatnonzero((aside.min(axis=1) <= grow) & (aside.max(axis=1) >= -grow))
    if not len(rows):
        return np.empty((0, 2))
    aside, along, height = aside[rows], local[rows] @ d, local[rows] @ n
    reference = np.clip(0.0, aside.min(axis=1), aside.max(axis=1))[:, None]
    off = aside - reference
    following = np.roll(off, -1, axis=1)
    cuts = (off * following <= 0) & (off != following)
    share = np.where(cuts, off / np.where(cuts, off - following, 1.0), 0.0)
    cut_along = along + share * (np.roll(along, -1, axis=1) - along)
    cut_height = height + share * (np.roll(height, -1, axis=1) - height)
    # a corner in the plane is a position too, even if no side crosses the plane
    positions = np.concatenate(
        [np.where(cuts, cut_along, np.nan), np.where(off == 0, along, np.nan)], axis=1
    )
    heights = np.concatenate(
        [np.where(cuts, cut_height, 0.0), np.where(off == 0, height, 0.0)], axis=1
    )
    low = np.nanmin(positions, axis=1)
    high = np.nanmax(positions, axis=1)
    keep = np.abs(heights).max(axis=1) <= reach + grow
    return _merge_intervals(np.column_stack([low, high])[keep], grow)


def _merge_intervals(spans: Array, join: float) -> Array:
    """Merge sorted intervals, shape (k, 2), whose distance is at most `join`."""
    if not len(spans):
        return spans
    spans = spans[np.argsort(spans[:, 0])]
    end = np.maximum.accumulate(spans[:, 1])
    first = np.concatenate([[True], spans[1:, 0] > end[:-1] + join])
    last = np.concatenate([first[1:], [True]])
    return np.column_stack([spans[first, 0], end[last]])


def common_spans(first: Array, second: Array) -> Array:
    """Intersections of two sets of intervals, shape (k, 2)."""
    low = np.maximum(first[:, None, 0], second[None, :, 0]).ravel()
    high = np.minimum(first[:, None, 1], second[None, :, 1]).ravel()
    keep = high > low
    return np.column_stack([low[keep], high[keep]])


# cylinders and cones, unrolled --------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Bands:
    """Extent of each cylinder or cone face in angle about its axis and height along it.

    Attributes
    ----------
    low, high : ndarray, shape (n,)
        Least and greatest height along the axis above the point of the surface [length unit].
    begin, width : ndarray, shape (n,)
        Begin and length of the arc; 2 pi: all around [rad].
    whole : ndarray of bool, shape (n,)
        True if the face fills the band: a single arc, no holes, straight ends.
    """

    low: Array
    high: Array
    begin: Array
    width: Array
    whole: Mask


def unrolled(geometry: Geometry, rows: Index) -> tuple[Index, Array, Array, Mask]:
    """Triangle corners of cylinders or cones as angle about the axis and height along it.

    Returns
    -------
    owner : ndarray of int, shape (m,)
        Position in `rows`.
    angle, height : ndarray, shape (m, 3)
        Angles [rad] and heights of the corners; the angles of a triangle do not jump by 2 pi.
    tip : ndarray of bool, shape (m,)
        Triangles with a corner in the apex, which cover a whole rectangle of angle and height.
    """
    surfaces = geometry.surfaces
    owner, triangle = ragged(surfaces.triangle_start, rows)
    names = surfaces.triangle[triangle]
    local = geometry.vertices[geometry.triangles[names]] - surfaces.point[rows][owner][:, None]
    u, v = across(surfaces.axis[rows])
    axis = surfaces.axis[rows]
    height = np.einsum("mki,mi->mk", local, axis[owner])
    x = np.einsum("mki,mi->mk", local, u[owner])
    y = np.einsum("mki,mi->mk", local, v[owner])
    angle = np.arctan2(y, x)
    reach = np.hypot(x, y)
    at_apex = reach < APEX * np.maximum(reach.max(axis=1), TINY)[:, None]
    at_apex &= (surfaces.kind[rows][owner] == CONE)[:, None]
    # angles within pi of a corner that has an angle
    base = np.where(at_apex[:, 0], angle[:, 1], angle[:, 0])[:, None]
    angle = base + np.remainder(angle - base + np.pi, TURN) - np.pi
    mean = np.where(at_apex, 0.0, angle).sum(axis=1) / np.maximum((~at_apex).sum(axis=1), 1)
    angle = np.where(at_apex, mean[:, None], angle)
    return owner, angle, height, at_apex.any(axis=1)


def bands_of(geometry: Geometry, rows: Index) -> Bands:
    """Extents in angle and height of the cylinder and cone faces in the given `rows`."""
    count = len(rows)
    owner, angle, height, tip = unrolled(geometry, rows)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, owner, height.min(axis=1))
    np.maximum.at(high, owner, height.max(axis=1))
    (x0, x1, x2), (y0, y1, y2) = angle.T, height.T
    area = np.abs((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)) / 2
    area = np.bincount(owner, np.where(tip, 2 * area, area), minlength=count)
    begin, width, arcs = _arc_unions(owner, angle.min(axis=1), np.ptp(angle, axis=1), count)
    full = width * (high - low)
    whole = (arcs == 1) & (np.abs(area - full) <= BAND_FILLED * full)
    return Bands(low, high, begin, width, whole)


def _arc_unions(
    owner: Index, start: Array, length: Array, count: int
) -> tuple[Array, Array, Index]:
    """Union of the arcs of each owner: begin and length [rad], and the number of pieces."""
    start = np.remainder(start, TURN)
    order = np.lexsort((start, owner))
    owner, start = owner[order], start[order]
    lift = 100.0 * owner  # separates the owners in a common running maximum
    end = np.maximum.accumulate(start + length[order] + lift) - lift
    first = np.concatenate([[True], owner[1:] != owner[:-1]])
    last = np.concatenate([first[1:], [True]])
    around = end[last] - TURN  # end of arcs that cross the seam
    before = np.empty(len(owner))
    before[1:] = end[:-1]
    before[first] = around
    hole = start > np.maximum(before, around[owner]) + SEAM_ANGLE
    arcs = np.bincount(owner, hole, minlength=count).astype(np.int64)
    begin, width = np.zeros(count), np.full(count, TURN)
    begin[owner[hole]] = start[hole]
    single = np.flatnonzero(hole & (arcs[owner] == 1))
    gap = start[single] - np.maximum(before[single], around[owner[single]])
    width[owner[single]] = TURN - gap
    return begin, width, np.maximum(arcs, 1)
