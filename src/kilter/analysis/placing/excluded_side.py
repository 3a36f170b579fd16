"""The places of a load that a motion excludes: a half plane.

The power of a motion dp under a load that is shifted by d is linear in d,

    P(d) = P(0) + d_1 W_1.dp + d_2 W_2.dp,

so a motion that is possible proves that each place with a sufficient power is not carried.
"""

from __future__ import annotations

import numpy as np
import shapely

from kilter.arrays import Array
from kilter.mechanics.certificate import check_motion, needed_power
from kilter.mechanics.load_checks import shifted_weights
from kilter.mechanics.program import Program

__all__ = ["excluded_side", "remaining"]


def excluded_side(
    program: Program, wrenches: Array, low: Array, high: Array, motion: Array
) -> tuple[Array, float] | None:
    """The half plane of shifts that a motion excludes, within a rectangle of shifts.

    Arguments: `wrenches` (2, N, 6): change of the load per unit of shift along each axis; `low`,
    `high` (2,): the rectangle [length unit]; `motion` (N, 6). Returns `normal` (2,); `reach`:
    shifts d with normal.d > reach are not carried; -inf if no shift is carried. None if the motion
    proves nothing.
    """
    judged = check_motion(program, motion)
    if not judged.motion.any():
        return None
    # the power that a proof needs grows with the load: convex in d, so the corners bound it
    corners = [(u, v) for u in (low[0], high[0]) for v in (low[1], high[1])]
    loads = np.tensordot(np.array(corners), wrenches, axes=1)
    needed = needed_power(program, judged, shifted_weights(program, loads))
    free = program.free[:, None]
    rate = np.array([float((np.where(free, w, 0.0) * judged.motion).sum()) for w in wrenches])
    size = float(np.linalg.norm(rate))
    if not size > 0:
        return (np.array([1.0, 0.0]), -np.inf) if judged.power > needed else None
    return rate / size, (needed - judged.power) / size


def remaining(
    area: shapely.Geometry, side: tuple[Array, float], whole: shapely.Geometry
) -> shapely.Geometry:
    """A convex area of a rectangle without an excluded half plane.

    Examples
    --------
    >>> square = shapely.box(0, 0, 1, 1)
    >>> remaining(square, (np.array([1.0, 0.0]), 0.25), square).area
    0.25
    """
    normal, reach = side
    low, high = np.array(whole.bounds[:2]), np.array(whole.bounds[2:])
    middle = (low + high) / 2
    far = 4 * float(np.linalg.norm(high - low))
    beyond = reach - float(normal @ middle)  # distance of the line from the middle
    if beyond <= -far:
        return shapely.Polygon()
    if beyond >= far:
        return area
    along = np.array([-normal[1], normal[0]])
    foot = middle + beyond * normal
    corners = [foot + far * along, foot - far * along]
    half = shapely.polygons(
        [*corners, corners[1] - 2 * far * normal, corners[0] - 2 * far * normal]
    )
    cut = shapely.intersection(area, half)
    return cut if cut.geom_type == "Polygon" else shapely.Polygon()
