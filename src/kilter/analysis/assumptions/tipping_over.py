"""Where a rigid body that does not stand on a level floor comes to rest by tipping over.

The body touches the floor at its lowest points. If its centre of mass c is not above their convex
hull, the body tips over the nearest point q of the hull, towards c. In the frame of the body this
turns the direction of gravity d towards the horizontal unit vector u from q to c:

    d' = cos(t) d + sin(t) u,      tan(t) = -(p - q).d / (p - q).u

with t the least angle at which another point p reaches the floor. The centre of mass sinks in each
step, so the steps end where it is above the hull.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import ConvexHull, QhullError

from kilter.arrays import Array, Index, across

SAME_HEIGHT = 1e-7
"""Points within this distance above the lowest point touch the floor [sizes of the body]."""
MOST_STEPS = 500
"""Largest number of steps of a body that rolls on its curved faces."""


def rest_after_tipping(
    points: Array, center: Array, down: Array, slack: float = 0.0
) -> tuple[float, Index] | None:
    """The angle by which a body tips over until it rests [rad], and its points on the floor then.

    The angle is 0 for a body that stands, and for a ball whose points lie below its surface: its
    centre of mass sinks by no more than their distances from the surface. None if the body does not
    end within `MOST_STEPS` steps.

    Arguments: `points` (n, 3): points of the body; `center` (3,): its centre of mass, in the same
    length unit; `down` (3,): unit direction of gravity; `slack`: largest distance of the surface
    from the triangles of the points [length unit]. The floor is level.
    """
    try:
        outer = ConvexHull(points).vertices.astype(np.int64)
    except QhullError:  # flat
        outer = np.arange(len(points))
    hull = points[outer] - center
    same = SAME_HEIGHT * float(np.ptp(hull, axis=0).max())
    d, first = down, float((hull @ down).max())
    for _ in range(MOST_STEPS):
        depth, plane = hull @ d, np.stack(across(d), axis=1)
        low = depth >= depth.max() - same
        feet = shapely.convex_hull(shapely.multipoints(hull[low] @ plane))
        if shapely.distance(feet, shapely.points(0.0, 0.0)) <= same:
            sinks = first - depth.max() > slack
            angle = np.arccos(np.clip(d @ down, -1.0, 1.0)) if sinks else 0.0
            return float(angle), outer[low]
        line = shapely.shortest_line(feet, shapely.points(0.0, 0.0))
        q = shapely.get_coordinates(line)[0]
        u = plane @ (-q / np.linalg.norm(q))
        ahead = (hull - plane @ q) @ u
        rises = ~low & (ahead > same)
        if not rises.any():
            return None
        height = depth.max() - depth[rises]
        turn = float(np.arctan2(height, ahead[rises]).min())
        d = np.cos(turn) * d + np.sin(turn) * u
        d = d / np.linalg.norm(d)
    return None
