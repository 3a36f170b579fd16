"""Candidate contacts of the rims and tips of solid cylinders and cones with planes.

The end of a cylinder or cone at the height h of its axis a is a circle of radius rho about c + h a.
With n the outward normal of the plane, its nearest point to the plane is the farthest along -n, c +
h a + rho u, u = the unit direction of -n less its part along a. The plane touches the rim there
from outside if -n lies between the normal of the side and that of the end, which is +a or -a. The
tip of a cone touches a plane that has the whole side in front of it: n . a >= sin(half_angle).

If -n is along the axis, the end lies flat; if -n is a normal of the side, the part lies on a
generator. Both are other contacts (`planar`, `kilter.contact.curved.on_planes`).
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER, FREE
from kilter.contact.contact_tolerances import APEX
from kilter.contact.curved.candidates import POINT, Candidates, dot, make_candidates, without_along
from kilter.contact.curved.coverage import bands_of
from kilter.contact.curved.on_planes import Planes

__all__ = ["cone_tips", "rims_on_planes", "tips_on_faces"]


def rims_on_planes(geometry: Geometry, i: Index, planes: Planes, angle: Array) -> Candidates:
    """Candidate point contacts of the circular ends of cylinders and cones `i` with planes.

    Parameters
    ----------
    geometry : Geometry
    i : ndarray of int, shape (n,)
        Surfaces; those of other kinds, and hollow surfaces, have no candidates.
    planes : Planes
        A plane for each surface.
    angle : ndarray, shape (n,)
        Largest angle at which an end lies flat, or a side lies on the plane [rad].

    Returns
    -------
    Forms
        Candidates of the form POINT; `along` leads away from the axis, in the plane of the end.
    """
    s = geometry.surfaces
    row = np.flatnonzero(np.isin(s.kind[i], (CYLINDER, CONE)) & ~s.hollow[i])
    if not len(row):
        return Candidates.join([])
    used, band_row = np.unique(i[row], return_inverse=True)
    bands = bands_of(geometry, used)
    low, high = bands.low[band_row], bands.high[band_row]
    n, o = planes.normal[row], planes.origin[row]
    shared_arguments = geometry, row, i[row], n, o, angle[row]
    return Candidates.join(
        [
            _rims(*shared_arguments, low, -1.0),
            _rims(*shared_arguments, high, 1.0),
            _tips(*shared_arguments, low, high),
        ]
    )


def _rims(
    geometry: Geometry, row: Index, i: Index, n: Array, o: Array, angle: Array, height: Array,
    end: float,
) -> Candidates:  # fmt: skip
    """Candidate contacts: the lowest points of the end circles at `height` over their planes.

    `end` is 1 at the upper and -1 at the lower end.
    """
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
) -> Candidates:  # fmt: skip
    """Candidate point contacts of the tips of cones with their planes."""
    s = geometry.surfaces
    # angle by which the side rises from the plane
    lean = np.arcsin(np.clip(dot(n, s.axis[i]), -1, 1)) - s.half_angle[i]
    sharp = low <= APEX * high
    k = np.flatnonzero((s.kind[i] == CONE) & sharp & (lean > angle))
    bend = high * np.tan(s.half_angle[i]) / np.sin(np.maximum(lean, angle))
    return _points(row, s.point[i], (n, o), -s.axis[i], (0 * bend, bend), k)


def cone_tips(geometry: Geometry) -> Index:
    """Exact solid cones that reach their apex, as rows of the surfaces."""
    s = geometry.surfaces
    cones = np.flatnonzero((s.kind == CONE) & ~s.hollow & (s.doubt == 0))
    cones = cones[np.diff(s.triangle_start)[cones] > 0]
    if not len(cones):
        return cones
    bands = bands_of(geometry, cones)
    sharp: Index = cones[bands.low <= APEX * bands.high]
    return sharp


def tips_on_faces(geometry: Geometry, i: Index, j: Index, angle: Array) -> Candidates:
    """Candidate point contacts of the tips of cones with curved faces.

    Parameters
    ----------
    geometry : Geometry
    i, j : ndarray of int, shape (n,)
        Surfaces of each pair.
    angle : ndarray, shape (n,)
        Largest angle at which the side of a cone lies on a face [rad].

    Returns
    -------
    Candidates
        Normals lead from i to j; `along` leads out of the tip.
    """
    s = geometry.surfaces
    tips = cone_tips(geometry)
    blocks = []
    for first, second, sense in ((i, j, -1.0), (j, i, 1.0)):
        row = np.flatnonzero(np.isin(first, tips) & (s.kind[second] != FREE))
        cone, face = first[row], second[row]
        tip, axis = s.point[cone], s.axis[cone]
        gap, n = s.distance(face, tip), s.outward(face, tip)
        lean = np.arcsin(np.clip(dot(n, axis), -1, 1)) - s.half_angle[cone]
        k = np.flatnonzero(lean > angle[row])
        middle = tip[k] - (gap[k] / 2)[:, None] * n[k]
        blocks.append(
            make_candidates(
                row[k], POINT, middle, sense * n[k], gap[k],
                along=-axis[k], rim=np.full(len(k), 1.0 if sense < 0 else 2.0),
            )
        )  # fmt: skip
    return Candidates.join(blocks)


def _points(
    row: Index, at: Array, plane: tuple[Array, Array], out: Array, sizes: tuple[Array, Array],
    k: Index,
) -> Candidates:  # fmt: skip
    """Candidate point contacts of the rows `k`, at points `at` with outward directions `out`."""
    (n, o), (radius, bend) = plane, sizes
    gap = dot(at - o, n)[k]
    middle = at[k] - (gap / 2)[:, None] * n[k]
    return make_candidates(
        row[k], POINT, middle, -n[k], gap, along=out[k], radius=radius[k], bend=bend[k]
    )
