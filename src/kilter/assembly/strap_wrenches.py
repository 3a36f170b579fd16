"""Forces and torques of straps on the parts of an assembly, and the checks of their paths."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly.assembly import Assembly
from kilter.assembly.assembly_tolerances import STRAP_OFF_PART, STRAP_THROUGH
from kilter.assembly.part import GROUND
from kilter.assembly.straps import Strap, some
from kilter.errors import InputError


def strap_wrenches(assembly: Assembly) -> Array:
    """Wrenches of all straps on the parts, shape (N, 6).

    Force [N], and torque about the centre of mass [N x length unit].

    Raises `InputError` if a strap passes through a part, a point is away from its part, or a strap
    with friction names no tensioned end.
    """
    geometry = assembly.geometry
    total = np.zeros((len(assembly.parts), 6))
    for strap in assembly.straps:
        if strap.open_end:
            raise InputError(
                f"the strap over {some(strap)} has friction, but its tensioned end is not named",
                file=assembly.source or None,
                hint='give "tensioned": "first" or "last"; only check tries both ends',
            )
        _require_clear(assembly, strap)
        for (name, point), force in zip(strap.path, strap.forces, strict=True):
            if name != GROUND:
                k = assembly.index_of(name)
                total[k, :3] += force
                total[k, 3:] += cross(point - geometry.center[k], force)
    return total


def _require_clear(assembly: Assembly, strap: Strap) -> None:
    """Reject a strap that surely passes through a part, or whose points are away from the parts."""
    geometry, points = assembly.geometry, strap.points
    low, high = geometry.part_boxes
    for name, point in strap.path:
        if name == GROUND:
            continue
        k = assembly.index_of(name)
        away = np.maximum(np.maximum(low[k] - point, point - high[k]), 0.0)
        if float(np.linalg.norm(away)) > STRAP_OFF_PART * geometry.size[k]:
            raise InputError(
                f"a strap has the point {point.tolist()} on this part, which is not there",
                part=name,
                file=assembly.source or None,
                hint="give points on the surface of the part",
            )
    for k, part in enumerate(assembly.parts):
        corners = geometry.corners_of(k)
        normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1)
        normal = normal[length > 0] / length[length > 0, None]
        reach = np.einsum("ij,ij->i", normal, corners[length > 0, 0])
        depth = STRAP_THROUGH * geometry.size[k]
        if _pieces_inside(points, normal, reach - depth):
            raise InputError(
                "a strap passes through this part",
                part=part.name,
                file=assembly.source or None,
                hint="add the corners at which the strap bends around the part",
            )


def _pieces_inside(points: Array, normal: Array, reach: Array) -> bool:
    """Whether a piece between successive points meets the intersection of half-spaces.

    For a part that is not convex the half-spaces of its faces meet in a core of the part, so that
    only straps through this core are found.
    """
    first, along = points[:-1], np.diff(points, axis=0)
    room: Array = reach - first @ normal.T
    rate: Array = along @ normal.T
    limit = np.divide(room, rate, out=np.zeros_like(rate), where=rate != 0)
    latest = np.where(rate > 0, limit, 1.0).min(axis=1, initial=1.0)
    earliest = np.where(rate < 0, limit, 0.0).max(axis=1, initial=0.0)
    outside = ((rate == 0) & (room <= 0)).any(axis=1)
    return bool(((earliest < latest) & ~outside).any())
