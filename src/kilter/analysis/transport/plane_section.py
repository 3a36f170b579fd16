"""Boundary of a plane section of a convex set, between a polygon inside and lines around it.

An oracle returns, for a unit direction of the plane, the boundary point along it and a line beyond
which no point of the set lies. Two neighbouring lines meet at a corner. The search asks in the
direction of the corner that is farthest from the polygon, until all corners are near:

    inside      hull of the boundary points
    outside     intersection of the half-planes of the lines
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import PARALLEL_PLANES
from kilter.analysis.load_limit import NoLimit
from kilter.arrays import TINY, Array

PROGRAMS = 160
"""Largest number of limits for a section; the gap that remains is reported."""
FIRST = 8
"""Directions that are computed first, at even angles."""


@dataclass(frozen=True, slots=True, eq=False)
class SupportLine:
    """Boundary point of a plane section of a convex set around 0, with a bounding line."""

    direction: Array
    """Unit direction of the point, shape (2,)."""
    point: Array
    normal: Array
    """Shape (2,)."""
    reach: float
    """Distance of the line from 0."""
    limited: bool
    """False if the point is at the largest acceleration of the search."""
    proved: bool
    """True if a motion proves that nothing beyond the line is carried."""

    @property
    def angle(self) -> float:
        """Polar angle of the boundary point in the section plane, from its first axis [rad]."""
        return float(np.arctan2(self.direction[1], self.direction[0]))


def enclose_section(
    support: Callable[[Array], SupportLine | NoLimit], *, accuracy: float
) -> tuple[list[SupportLine], float] | NoLimit:
    """Find boundary points and lines of a plane section until polygon and lines agree.

    Arguments: `support`: from a unit direction, shape (2,), to the boundary point along it, with a
    bounding line. Returns `supports`: sorted by angle; `gap`: largest distance from an edge of the
    polygon to the lines beyond it.
    """
    supports: list[SupportLine] = []

    def add(direction: Array) -> NoLimit | None:
        answer = support(direction)
        if isinstance(answer, NoLimit):
            return answer
        supports.append(answer)
        return None

    angle = 2 * np.pi * (np.arange(FIRST) + 0.5) / FIRST
    for direction in np.column_stack([np.cos(angle), np.sin(angle)]):
        missing = add(direction)
        if missing is not None:
            return missing
    settled: set[float] = set()
    for _ in range(PROGRAMS):
        supports.sort(key=lambda support: support.angle)
        gaps, corners = corner_gaps(supports)
        open_gaps = np.where([s.angle in settled for s in supports], 0.0, gaps)
        widest = int(open_gaps.argmax())
        if open_gaps[widest] <= accuracy:
            break
        corner = corners[widest]
        before = len(supports)
        known = {support.angle for support in supports}
        missing = add(corner / float(np.linalg.norm(corner)))
        if missing is not None or supports[-1].angle in known:
            settled.add(supports[widest].angle)
            del supports[before:]
    supports.sort(key=lambda support: support.angle)
    gaps, _ = corner_gaps(supports)
    return supports, float(gaps.max())


def corner_gaps(supports: list[SupportLine]) -> tuple[Array, Array]:
    """For two neighbouring bounding lines, the distance of their corner from the polygon edge.

    Also the direction of each corner.

    Arguments: `supports`: points and lines of a plane section, sorted by the angle of the points.
    Returns `gaps` (n,): for each support and the next; 0 where both points are at the largest
    acceleration of the search; `corners` (n, 2): the corners; if the lines meet far outside, a
    point between both directions.
    """
    point = np.array([support.point for support in supports])
    normal = np.array([support.normal for support in supports])
    reach = np.array([support.reach for support in supports])
    limited = np.array([support.limited for support in supports])
    following = np.roll(np.arange(len(supports)), -1)
    sine = normal[:, 0] * normal[following, 1] - normal[:, 1] * normal[following, 0]
    steep = np.abs(sine) > PARALLEL_PLANES
    safe = np.where(steep, sine, 1.0)
    corner = np.column_stack(
        [
            (reach * normal[following, 1] - reach[following] * normal[:, 1]) / safe,
            (reach[following] * normal[:, 0] - reach * normal[following, 0]) / safe,
        ]
    )
    edge = point[following] - point
    length = np.linalg.norm(edge, axis=1)
    middle = 0.5 * (point + point[following])
    outward = np.column_stack([edge[:, 1], -edge[:, 0]])
    outward /= np.maximum(length, TINY)[:, None]
    gap = np.einsum("ij,ij->i", corner - point, outward)
    aligned = ~steep & (np.einsum("ij,ij->i", normal, normal[following]) > 0)
    gap = np.where(aligned, 0.0, np.where(steep, gap, np.inf))
    far = ~steep | (np.linalg.norm(corner, axis=1) > 2 * np.linalg.norm(point, axis=1).max())
    corner = np.where(far[:, None], middle, corner)
    neither = ~limited & ~limited[following]
    return np.where(neither | (length == 0), 0.0, np.maximum(gap, 0.0)), corner
