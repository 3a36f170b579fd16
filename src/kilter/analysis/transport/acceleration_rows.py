"""Linear constraints A a <= b on the acceleration of a carrier, for path planners.

inner    facets of the hull of accelerations that forces prove to be carried
outer    planes of motions: a carried acceleration gives no motion a positive power
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.analysis.load_limit import Limit
from kilter.analysis.transport.carried_set import MOST, Slice
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.mechanics.program import Program

__all__ = ["inner_rows", "outer_rows"]


Known = Sequence[tuple[Array, Limit]]
"""Unit directions, shape (3,), and the largest acceleration along each [g]."""


def inner_rows(program: Program, known: Known, polar: Slice | None) -> tuple[Array, Array]:
    """Constraints A a <= b on an acceleration a [m/s^2]; if a satisfies all, forces can hold."""
    from scipy.spatial import ConvexHull, QhullError

    points = [min(limit.value, MOST) * direction for direction, limit in known]
    if polar is not None:
        points += list(polar.points @ polar.axes)
    carried = np.vstack([np.zeros(3), *points]) * program.g
    used = np.array([0, 2]) if program.planar else np.arange(3)
    try:
        facets = ConvexHull(carried[:, used]).equations
    except QhullError:
        raise InputError(
            "the carried accelerations lie in a plane or on a line", hint="use outer rows"
        ) from None
    facets = np.unique(facets.round(12), axis=0)
    rows = np.zeros((len(facets), 3))
    rows[:, used] = facets[:, :-1]
    return rows, -facets[:, -1]


def outer_rows(program: Program, known: Known, polar: Slice | None) -> tuple[Array, Array]:
    """Constraints A a <= b on an acceleration a [m/s^2]; if a violates one, no forces can hold."""
    rows, bounds = [], []
    for _, limit in known:
        if limit.motion is None:
            continue
        motion = limit.motion.motion
        moment = (program.mass * program.free) @ motion[:, :3]
        size = float(np.linalg.norm(moment))
        if size > 0.0:
            rows.append(-moment / size)
            bounds.append(-program.power(motion) / size)
    if polar is not None:
        proved = polar.proved
        rows += list((polar.normals @ polar.axes)[proved])
        bounds += list(polar.reach[proved] * program.g)
    return np.array(rows).reshape(-1, 3), np.array(bounds)
