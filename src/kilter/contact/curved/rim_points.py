"""Where the rims and tips of solid cylinders and cones touch planes.

The end of a cylinder or cone at the height h of its axis a is a circle of radius rho about
c + h a. With n the outward normal of the plane, it is nearest to it where it lies farthest
along -n, in c + h a + rho u, u = the unit direction of -n less its part along a. The plane
touches there from outside where -n lies between the normal of the side and that of the end,
which is +a or -a. The tip of a cone touches a plane that leaves its whole side in front:
n . a >= sin(half_angle).

Where -n is along the axis the end lies flat, and where it is a normal of the side the part
lies on a generator; both are other contacts (`planar`, `kilter.contact.curved.on_planes`).
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER
from kilter.contact.contact_tolerances import APEX
from kilter.contact.curved.candidates import POINT, Forms, dot, make_forms, without_along
from kilter.contact.curved.coverage import bands_of
from kilter.contact.curved.on_planes import Planes

__all__ = ["rims_on_planes"]


def rims_on_planes(geometry: Geometry, i: Index, planes: Planes, angle: Array) -> Forms:
    """Points in which ends of solid cylinders and cones `i`, shape (n,), touch planes.

    Parameters
    ----------
    geometry : Geometry
    i : ndarray of int, shape (n,)
        Surfaces; those of other kinds, and hollow ones, give nothing.
    planes : Planes
        One a surface.
    angle : ndarray, shape (n,)
        Up to this angle an end lies flat, or a side lies on the plane [rad].

    Returns
    -------
    Forms
        Of the form POINT; `along` leads away from the axis, in the plane of the end.
    """
    s = geometry.surfaces
    row = np.flatnonzero(np.isin(s.kind[i], (CYLINDER, CONE)) & ~s.hollow[i])
    if not len(row):
        return Forms.join([])
    used, place = np.unique(i[row], return_inverse=True)
    bands = bands_of(geometry, used)
    low, high = bands.low[place], bands.high[place]
    n, o = planes.normal[row], planes.origin[row]
    mine = geometry, row, i[row], n, o, angle[row]
    return Forms.join([_rims(*mine, low, -1.0), _rims(*mine, high, 1.0), _tips(*mine, low, high)])


def _rims(
    geometry: Geometry, row: Index, i: Index, n: Array, o: Array, angle: Array, height: Array,
    end: float,
) -> Forms:  # fmt: skip
    s = geometry.surfaces
    axis, alpha = s.axis[i], np.where(s.kind[i] == CONE, s.half_angle[i], 0.0)
    radius = np.where(s.kind[i] == CONE, height * np.tan(alpha), s.radius[i])
    aside = without_along(-n, axis)
    sine = np.linalg.norm(aside, axis=1)
    out = unit_rows(aside)
    # -n = side (out cos - axis sin) + rest (end axis), neither below zero
    rest = end * (dot(-n, axis) + sine * np.tan(alpha))
    k = np.flatnonzero((sine > np.sin(angle)) & (rest > np.sin(angle)) & (radius > 0))
    at = s.point[i] + height[:, None] * axis + radius[:, None] * out
    bend = radius / np.maximum(sine, np.sin(angle))
    return _points(row, at, (n, o), out, (radius, bend), k)


def _tips(
    geometry: Geometry, row: Index, i: Index, n: Array, o: Array, angle: Array, low: Array,
    high: Array,
) -> Forms:  # fmt: skip
    s = geometry.surfaces
    lean = np.arcsin(np.clip(dot(n, s.axis[i]), -1, 1)) - s.half_angle[i]
    sharp = low <= APEX * high
    k = np.flatnonzero((s.kind[i] == CONE) & sharp & (lean > angle))
    bend = high * np.tan(s.half_angle[i]) / np.sin(np.maximum(lean, angle))
    return _points(row, s.point[i], (n, o), -s.axis[i], (0 * bend, bend), k)


def _points(
    row: Index, at: Array, plane: tuple[Array, Array], out: Array, sizes: tuple[Array, Array],
    k: Index,
) -> Forms:  # fmt: skip
    (n, o), (radius, bend) = plane, sizes
    gap = dot(at - o, n)[k]
    middle = at[k] - (gap / 2)[:, None] * n[k]
    return make_forms(
        row[k], POINT, middle, -n[k], gap, along=out[k], radius=radius[k], bend=bend[k]
    )
