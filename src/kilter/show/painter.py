"""Painter's algorithm: convex polygons in space, sorted from back to front for drawing.

A binary space partition orders polygons that do not intersect exactly. It cuts polygons that
are crossed by the plane of another polygon. The largest polygons are used as planes first. After
`WORK` the remaining groups are sorted by the depth of their middles; they consist of small
polygons, for which this order is usually right.

References
----------
H. Fuchs, Z. Kedem, B. Naylor, On visible surface generation by a priori tree structures,
Computer Graphics 14, 1980.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask

WORK = 400_000
"""Number of tests of a polygon against a plane up to which the order is exact."""
MANY = 200
"""Number of polygons in a group above which only the largest, not an even sample, are planes."""
THICK = 1e-6
"""Distance from a plane below which a corner counts as in the plane [size of the scene]."""
TRIED = 5
"""Number of planes that are tried at each partition; the plane with the fewest cuts is used."""


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A parallel projection, as unit vectors to the right, up, and towards the eye.

    Examples
    --------
    >>> Camera.at(0, 0).towards.round(12) + 0.0
    array([ 0., -1.,  0.])
    """

    right: Array
    up: Array
    towards: Array

    @classmethod
    def at(cls, azimuth: float, elevation: float, turn: Array | None = None) -> Camera:
        """Camera at an angle `azimuth` to the right of -y, and `elevation` above the ground [deg].

        `turn`, shape (3, 3), rotates directions of the scene to a frame in which z is up.
        """
        a, e = np.radians([azimuth, elevation])
        right = np.array([np.cos(a), np.sin(a), 0.0])
        towards = np.array([np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)])
        turn = np.eye(3) if turn is None else turn
        up = np.cross(towards, right)
        return cls(right @ turn, up @ turn, towards @ turn)

    def flat(self, points: Array) -> Array:
        """Project points in space, shape (..., 3), to the page, shape (..., 2)."""
        return np.stack([points @ self.right, points @ self.up], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class Polygon:
    """A convex polygon in space, with the part it belongs to and the sides to draw.

    `corners` (n, 3), unit `normal` (3,), index of its `part`; `drawn` (n,): whether the side
    from each corner to the next is drawn as an edge.
    """

    corners: Array
    normal: Array
    drawn: Mask
    part: int


def visible_triangles(vertices: Array, triangles: Index, edges: Index, part: int) -> list[Polygon]:
    """Triangles (m, 3) of a part as polygons, of which only the sides in `edges` (k, 2) are drawn.

    Triangles of zero area are left out.
    """
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    count = len(vertices)
    low, high = edges.min(axis=1), edges.max(axis=1)
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1)
    keys = sides.min(axis=-1) * count + sides.max(axis=-1)
    drawn = np.isin(keys, low * count + high)
    good = np.flatnonzero(length > 0)
    return [Polygon(corners[k], normal[k] / length[k], drawn[k], part) for k in good]


def back_to_front(polygons: list[Polygon], camera: Camera) -> list[Polygon]:
    """Polygons that face the eye, the farthest first; some polygons are cut in two.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> up, sides = np.array([0.0, 0, 1]), np.ones(4, dtype=bool)
    >>> near, far = (Polygon(square + z * up, up, sides, k) for k, z in enumerate((1, 0)))
    >>> [p.part for p in back_to_front([near, far], Camera.at(0, 90))]
    [1, 0]
    """
    facing = [p for p in polygons if p.normal @ camera.towards > THICK]
    if not facing:
        return []
    points = np.concatenate([p.corners for p in facing])
    thick = THICK * max(float(np.ptp(points, axis=0).max()), 1e-300)
    facing.sort(key=lambda p: -_area(p))
    return _partition_order(facing, camera.towards, thick)


def _partition_order(polygons: list[Polygon], towards: Array, thick: float) -> list[Polygon]:
    """Sort polygons from back to front by binary space partition."""
    result: list[Polygon] = []
    waiting: list[tuple[list[Polygon], bool]] = [(polygons, False)]
    work = 0
    while waiting:
        group, done = waiting.pop()
        if done or len(group) == 1:
            result += group
            continue
        work += len(group)
        if work > WORK:
            result += sorted(group, key=lambda p: float(p.corners.mean(axis=0) @ towards))
            continue
        behind, within, front = _partition(group, thick)
        # every polygon faces the eye, so the eye is in front of every plane
        for subset, finished in ((front, False), (within, True), (behind, False)):
            if subset:
                waiting.append((subset, finished))
    return result


def _partition(
    group: list[Polygon], thick: float
) -> tuple[list[Polygon], list[Polygon], list[Polygon]]:
    """Split polygons by the plane of one of them: polygons behind, in, and in front of it.

    The plane is the candidate with the lowest cost, 8 per cut polygon plus the imbalance.
    """
    sizes = [len(p.corners) for p in group]
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    points = np.concatenate([p.corners for p in group])
    best: tuple[float, Array, Array, Array] | None = None
    last = TRIED - 1 if len(group) > MANY else len(group) - 1
    for k in np.unique(np.linspace(0, last, TRIED).astype(int)):
        plane = group[k]
        height = (points - plane.corners[0]) @ plane.normal
        low, high = np.minimum.reduceat(height, starts), np.maximum.reduceat(height, starts)
        cuts = (low < -thick) & (high > thick)
        uneven = abs(int((high <= thick).sum()) - int((low >= -thick).sum()))
        cost = 8.0 * float(cuts.sum()) + uneven
        if best is None or cost < best[0]:
            best = cost, height, low, high
    assert best is not None
    _, height, low, high = best
    behind: list[Polygon] = []
    within: list[Polygon] = []
    front: list[Polygon] = []
    for k, polygon in enumerate(group):
        if high[k] <= thick and low[k] >= -thick:
            within.append(polygon)
        elif high[k] <= thick:
            behind.append(polygon)
        elif low[k] >= -thick:
            front.append(polygon)
        else:
            heights = height[starts[k] : starts[k] + sizes[k]]
            behind.append(_clip(polygon, -heights))
            front.append(_clip(polygon, heights))
    return behind, within, front


def _area(polygon: Polygon) -> float:
    around = polygon.corners - polygon.corners[0]
    crossed = np.cross(around[1:-1], around[2:]).sum(axis=0)
    return float(np.linalg.norm(crossed)) / 2


def _clip(polygon: Polygon, height: Array) -> Polygon:
    """Cut a convex polygon to its part with positive `height` (n,); the cut is not drawn."""
    corners: list[Array] = []
    drawn: list[bool] = []
    count = len(height)
    for k in range(count):
        after = (k + 1) % count
        current, following = height[k], height[after]
        if current >= 0:
            corners.append(polygon.corners[k])
            drawn.append(bool(polygon.drawn[k]) and not (current == 0 and following < 0))
        if current * following < 0:
            share = current / (current - following)
            corners.append(
                polygon.corners[k] + share * (polygon.corners[after] - polygon.corners[k])
            )
            drawn.append(bool(polygon.drawn[k]) and current < 0)
    return Polygon(np.array(corners), polygon.normal, np.array(drawn, dtype=bool), polygon.part)
