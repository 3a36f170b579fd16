"""Accelerations of a carrier that every state of a plan must carry between two steps.

The accelerations that contact forces carry are a convex set (`kilter.analysis.transport`). So a
state that carries the corners of a polygon carries every acceleration within it. A polygon around
the circle of radius A covers A in every horizontal direction:

    a_k = A / cos(pi / SIDES) (cos t_k, sin t_k),      t_k = 2 pi k / SIDES
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, across, cross
from kilter.assembly import Assembly
from kilter.errors import InputError

__all__ = ["SIDES", "extreme_accelerations"]

SIDES = 16
"""Number of corners around the circle of horizontal accelerations. More corners take more time and
are nearer to the circle: the corners exceed its radius by 2 % for 16."""


def extreme_accelerations(assembly: Assembly, carried: float | ArrayLike) -> Array:
    """Accelerations whose convex hull has all accelerations to be carried, shape (n, 3) [m/s^2].

    Arguments: `carried` (3,) [m/s^2]. Raises `InputError` if a vector leaves the plane of a planar
    assembly, or leaves the parts in free fall.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> corners = extreme_accelerations(scene("tower"), 3.0)
    >>> corners.shape, bool(np.linalg.norm(corners[0] + corners[1]) / 2 >= 3.0)
    ((16, 3), True)
    """
    value = np.asarray(carried, dtype=np.float64)
    down = assembly.down
    if value.ndim:
        if assembly.planar and value[1] != 0.0:
            raise InputError(
                f"carried is {value.tolist()}, which leaves the x-z plane of a planar assembly",
                hint="give it y = 0",
            )
        if not (assembly.gravity - value).any():
            raise InputError(
                "with this acceleration of the carrier everything falls freely",
                hint="give another acceleration",
            )
        return value[None] if value.any() else np.empty((0, 3))
    if not value:
        return np.empty((0, 3))
    if assembly.planar:
        along = cross(down, np.array([0.0, 1.0, 0.0]))
        return np.stack([value * along, -value * along])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    corners: Array = np.column_stack([np.cos(angle), np.sin(angle)]) @ np.stack(across(down))
    corners *= float(value) / np.cos(np.pi / SIDES)
    return corners
