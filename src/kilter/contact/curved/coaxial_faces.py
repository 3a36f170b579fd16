"""The region over which two faces about the same axis lie on each other.

Cylinders and cones are unrolled about the axis of the first: an angle and a height give the
position of a point. Faces on the same axis have no common region, whatever their radii, if they lie
beside each other around it or above each other along it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import FULL_TURN, LEAST_ARC
from kilter.contact.curved.contact_points import unrolled_overlap
from kilter.contact.curved.coverage import TURN, Bands, unrolled

__all__ = ["SharedRegion", "shared_region"]


SHARES = (0.19, 0.5, 0.83)
"""Fractions of arcs and heights at which a region is sampled [-]; chosen off the usual borders of
triangles."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedRegion:
    """The region over which two coaxial faces touch, by angle and height about the first axis.

    Attributes
    ----------
    arcs : list of (begin, width)
        Arcs around the axis [rad].
    bottom, top : float
        Heights above the point of the first surface [length unit].
    corners : (angles, heights) or None
        Corners of the common part, if a face is not a whole band; `arcs` then contains the common
        part. Every angle occurs twice, with its least and its greatest height.
    area : float
        Area in angle and height [rad x length unit].
    """

    arcs: list[tuple[float, float]]
    bottom: float
    top: float
    corners: tuple[Array, Array] | None
    area: float

    @property
    def inside(self) -> tuple[Array, Array]:
        """Angles [rad] and heights of sample points inside the region, shape (n,) each."""
        share = np.array(SHARES)
        if self.corners is None:  # whole bands: the arcs are the region
            angle = np.concatenate([begin + width * share for begin, width in self.arcs])
            height = self.bottom + (self.top - self.bottom) * share
            return np.repeat(angle, len(height)), np.tile(height, len(angle))
        angle, low, high = self.corners[0], *np.split(self.corners[1], 2)
        half = len(angle) // 2
        return angle[:half], (low + high) / 2


def shared_region(
    geometry: Geometry, bands: Bands, surfaces: tuple[int, int], band_rows: tuple[int, int]
) -> SharedRegion | None:
    """The region over which two coaxial surfaces lie on each other; None if they do not.

    Parameters
    ----------
    geometry : Geometry
    bands : Bands
    surfaces : pair of int
        Rows of the two surfaces; their axes coincide except for a small rotation.
    band_rows : pair of int
        Rows of the two surfaces in `bands`.
    """
    s, (i, j), (x, y) = geometry.surfaces, surfaces, band_rows
    axis = s.axis[i]
    sense = 1.0 if float(axis @ s.axis[j]) > 0 else -1.0
    height_offset = float((s.point[j] - s.point[i]) @ axis)
    ends = sorted(
        (height_offset + sense * float(bands.low[y]), height_offset + sense * float(bands.high[y]))
    )
    bottom, top = max(float(bands.low[x]), ends[0]), min(float(bands.high[x]), ends[1])
    if top <= bottom:
        return None
    u, v = across(s.axis[[i, j]])
    # angle of the second surface's zero direction in the frame of the first
    angle_offset = float(np.arctan2(u[1] @ v[0], u[1] @ u[0]))
    begin = angle_offset + sense * float(bands.begin[y])
    # an opposite axis reverses the direction of angles, so the arc ends where it began
    begin = begin - float(bands.width[y]) if sense < 0 else begin
    arcs = _common_arcs(
        (float(bands.begin[x]), float(bands.width[x])), (begin, float(bands.width[y]))
    )
    if not arcs:
        return None
    if bands.whole[x] and bands.whole[y]:
        area = sum(width for _, width in arcs) * (top - bottom)
        return SharedRegion(arcs, bottom, top, None, area)
    scale = float(max(s.radius[[i, j]].max(), 0.0)) or abs(bottom) + abs(top)
    overlap = _partial_overlap(geometry, surfaces, angle_offset, sense, height_offset, scale)
    if overlap is None:
        return None
    angles, heights, area = overlap
    return SharedRegion(arcs, bottom, top, (angles, heights), area)


def _common_arcs(
    first: tuple[float, float], second: tuple[float, float]
) -> list[tuple[float, float]]:
    """Arcs (begin, width) that belong to both of two given arcs [rad]."""
    if first[1] >= TURN - FULL_TURN:
        return [second]
    if second[1] >= TURN - FULL_TURN:
        return [first]
    arcs = []
    start = (second[0] - first[0]) % TURN
    # the second arc may meet the first at both of its ends
    for begin in (start - TURN, start):
        low, high = max(begin, 0.0), min(begin + second[1], first[1])
        if high > low + LEAST_ARC:
            arcs.append((first[0] + low, high - low))
    return arcs


def _partial_overlap(
    geometry: Geometry,
    surfaces: tuple[int, int],
    angle_offset: float,
    sense: float,
    height_offset: float,
    scale: float,
) -> tuple[Array, Array, float] | None:
    """Overlap of two coaxial faces with irregular outlines: angles, heights and area; or None.

    Angles are in rad. The faces are not whole bands about the axis.

    Angles and heights of the second surface are transformed to the frame of the first by `sense`,
    `angle_offset` and `height_offset`. None if there is no overlap.
    """
    owner, angle, height, tip = unrolled(geometry, np.array(surfaces))
    angle[owner == 1] = angle_offset + sense * angle[owner == 1]
    height[owner == 1] = height_offset + sense * height[owner == 1]
    if tip.any():
        angle, height, owner = _without_tips(angle, height, owner, tip)
    first, second = ((angle[owner == k], height[owner == k]) for k in (0, 1))
    angles, heights, area = unrolled_overlap(first, second, scale)
    if area <= 0:
        return None
    reduced = np.round(np.remainder(angles, TURN), 9)
    _, representative, group = np.unique(reduced, return_index=True, return_inverse=True)
    low = np.full(len(representative), np.inf)
    high = -low
    np.minimum.at(low, group.reshape(-1), heights)
    np.maximum.at(high, group.reshape(-1), heights)
    return np.tile(angles[representative], 2), np.concatenate([low, high]), area


def _without_tips(
    angle: Array, height: Array, owner: Index, tip: Mask
) -> tuple[Array, Array, Index]:
    """Triangles in angle and height; a triangle at the apex of a cone becomes a rectangle.

    A triangle at the apex covers a rectangle of angle and height, which takes two triangles.

    The angle of the apex is undefined: unrolled, the apex is a whole side of the rectangle.
    """
    angle, height = angle.copy(), height.copy()
    rows = np.flatnonzero(tip)
    more_angle, more_height = [], []
    for row in rows:
        apex = int(np.abs(height[row]).argmin())
        p, q = (k for k in range(3) if k != apex)
        angle[row, apex] = angle[row, p]
        more_angle.append([angle[row, p], angle[row, q], angle[row, q]])
        more_height.append([height[row, apex], height[row, apex], height[row, q]])
    return (
        np.concatenate([angle, np.array(more_angle).reshape(-1, 3)]),
        np.concatenate([height, np.array(more_height).reshape(-1, 3)]),
        np.concatenate([owner, owner[rows]]),
    )
