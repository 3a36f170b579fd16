"""Where two faces about one axis lie over each other: in angle and in height.

Cylinders and cones are unrolled about the axis of the first: an angle and a height say where a
point is. Faces on one axis that lie beside each other around it, or one above the other, have no
region in common, whatever their radii.
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
"""Where arcs and heights are asked, as shares of them: not where triangles tend to meet."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedRegion:
    """The region that two coaxial faces share, about the axis of the first.

    Attributes
    ----------
    arcs : list of (begin, width)
        Around the axis [rad].
    bottom, top : float
        Heights from the point of the first surface [length unit].
    corners : (angles, heights) or None
        Of the common part where the faces are no whole bands: the arcs are around it. Angles
        twice, with their least and their greatest heights.
    area : float
        [rad x length unit]
    """

    arcs: list[tuple[float, float]]
    bottom: float
    top: float
    corners: tuple[Array, Array] | None
    area: float

    @property
    def inside(self) -> tuple[Array, Array]:
        """Angles and heights of some points within the region, shape (n,) each."""
        share = np.array(SHARES)
        if self.corners is None:
            angle = np.concatenate([begin + width * share for begin, width in self.arcs])
            height = self.bottom + (self.top - self.bottom) * share
            return np.repeat(angle, len(height)), np.tile(height, len(angle))
        angle, low, high = self.corners[0], *np.split(self.corners[1], 2)
        half = len(angle) // 2
        return angle[:half], (low + high) / 2


def shared_region(
    geometry: Geometry, bands: Bands, names: tuple[int, int], at: tuple[int, int]
) -> SharedRegion | None:
    """The region that two surfaces share, None where there is none.

    Parameters
    ----------
    geometry : Geometry
    bands : Bands
    names : pair of int
        Rows of the two surfaces; their axes are one but for a small turn.
    at : pair of int
        Rows of the two in `bands`.
    """
    s, (i, j), (x, y) = geometry.surfaces, names, at
    axis = s.axis[i]
    turn = 1.0 if float(axis @ s.axis[j]) > 0 else -1.0
    shift = float((s.point[j] - s.point[i]) @ axis)
    ends = sorted((shift + turn * float(bands.low[y]), shift + turn * float(bands.high[y])))
    bottom, top = max(float(bands.low[x]), ends[0]), min(float(bands.high[x]), ends[1])
    if top <= bottom:
        return None
    u, v = across(s.axis[[i, j]])
    zero = float(np.arctan2(u[1] @ v[0], u[1] @ u[0]))
    begin = zero + turn * float(bands.begin[y])
    begin = begin - float(bands.width[y]) if turn < 0 else begin
    arcs = _common_arcs(
        (float(bands.begin[x]), float(bands.width[x])), (begin, float(bands.width[y]))
    )
    if not arcs:
        return None
    if bands.whole[x] and bands.whole[y]:
        area = sum(width for _, width in arcs) * (top - bottom)
        return SharedRegion(arcs, bottom, top, None, area)
    scale = float(max(s.radius[[i, j]].max(), 0.0)) or abs(bottom) + abs(top)
    filled = _unfilled(geometry, names, zero, turn, shift, scale)
    if filled is None:
        return None
    angles, heights, area = filled
    return SharedRegion(arcs, bottom, top, (angles, heights), area)


def _common_arcs(one: tuple[float, float], other: tuple[float, float]) -> list[tuple[float, float]]:
    """Arcs (begin, width) in both of two arcs."""
    if one[1] >= TURN - FULL_TURN:
        return [other]
    if other[1] >= TURN - FULL_TURN:
        return [one]
    found = []
    start = (other[0] - one[0]) % TURN
    for begin in (start - TURN, start):
        low, high = max(begin, 0.0), min(begin + other[1], one[1])
        if high > low + LEAST_ARC:
            found.append((one[0] + low, high - low))
    return found


def _unfilled(
    geometry: Geometry,
    names: tuple[int, int],
    zero: float,
    turn: float,
    shift: float,
    scale: float,
) -> tuple[Array, Array, float] | None:
    """Corners of the overlap of faces that are no whole bands, and its area."""
    owner, angle, height, tip = unrolled(geometry, np.array(names))
    angle[owner == 1] = zero + turn * angle[owner == 1]
    height[owner == 1] = shift + turn * height[owner == 1]
    if tip.any():
        angle, height, owner = _without_tips(angle, height, owner, tip)
    one, other = ((angle[owner == k], height[owner == k]) for k in (0, 1))
    angles, heights, area = unrolled_overlap(one, other, scale)
    if area <= 0:
        return None
    around = np.round(np.remainder(angles, TURN), 9)
    _, first, group = np.unique(around, return_index=True, return_inverse=True)
    low = np.full(len(first), np.inf)
    high = -low
    np.minimum.at(low, group.reshape(-1), heights)
    np.maximum.at(high, group.reshape(-1), heights)
    return np.tile(angles[first], 2), np.concatenate([low, high]), area


def _without_tips(
    angle: Array, height: Array, owner: Index, tip: Mask
) -> tuple[Array, Array, Index]:
    """Triangles at the apex of a cone as two, so that they fill their rectangle."""
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
