"""Candidate contacts of tori, and of cylinders and cones in hollow tori.

A torus is the envelope of spheres of the radius `tube` with centres on its circle; a cylinder or
cone is the envelope of spheres with centres on its axis, of the radius r, or t sin(half_angle) at
the distance t from the apex. Such a body touches another face at the sphere that comes nearest to
it. With d the signed distance from the other face, x(t) the centres and r(t) the radii, the gap is
a least value of

    g(t) = d(x(t)) - r(t),      g'(t) = n . x'(t) - r'(t),      n the outward normal of the face.

The search is along a single parameter. It brackets each change of sign of g' from - to +, and
bisects it. If g is constant around the circle of a torus, the contact is a circle: this needs a
common axis. A torus in a hollow torus with the same circle has no nearest sphere and no candidate.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, across
from kilter.assembly.surfaces import CONE, TORUS, Surfaces
from kilter.contact.contact_tolerances import CURVATURE_STEP, MIDDLE_OF_TUBE, WIDEST_OPENING
from kilter.contact.curved.candidates import (
    CIRCLE,
    POINT,
    Candidates,
    FormLimits,
    dot,
    make_candidates,
)

__all__ = ["body_in_torus", "torus_on_face"]


SAMPLES = 256
"""Number of spheres of each envelope at which the gap is computed; two least gaps between
neighbouring spheres count as a single gap."""
HALVINGS = 52
"""Bisection steps that locate the nearest sphere: as many as a number has binary digits."""


def torus_on_face(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of solid tori `i` with other faces `j`: circles and points.

    Normals lead from i to j.
    """
    t = np.linspace(0, 2 * np.pi, SAMPLES, endpoint=False)
    t = np.tile(t, (len(i), 1))
    gap, _, _ = _gaps(s, i, j, t)
    high, low = gap.max(axis=1), gap.min(axis=1)
    round_ = high - low <= 2 * limits.gap
    k = np.flatnonzero(round_)
    return Candidates.join(
        [
            _circles(s, row[k], i[k], j[k], (low[k] + high[k]) / 2, (high[k] - low[k]) / 2),
            _nearest_spheres(s, row, i, j, t, ~round_),
        ]
    )


def body_in_torus(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate point contacts of solid cylinders or cones `i` in hollow tori `j`.

    Normals lead from i to j.
    """
    # only centres within the tube have a distance from the torus that is positive
    middle = dot(s.point[j] - s.point[i], s.axis[i])
    reach = s.radius[j] + s.tube[j]
    t = middle[:, None] + reach[:, None] * np.linspace(-1, 1, SAMPLES)
    t = np.where((s.kind[i] == CONE)[:, None], np.maximum(t, 0.0), t)
    return _nearest_spheres(s, row, i, j, t, np.ones(len(i), dtype=bool))


def _centres(s: Surfaces, i: Index, t: Array) -> tuple[Array, Array, Array, Array]:
    """Centres and radii of the spheres of bodies `i`, and their derivatives.

    Parameters
    ----------
    s : Surfaces
    i : ndarray of int, shape (n,)
    t : ndarray, shape (n, m)
        Angle around the axis of a torus [rad], or position on the axis of another body [length
        unit].

    Returns
    -------
    centre, step : ndarray, shape (n, m, 3)
    radius, growth : ndarray, shape (n, m)
    """
    torus, axis = s.kind[i] == TORUS, s.axis[i]
    u, v = across(axis)
    size = s.radius[i][:, None, None]
    cosine, sine = np.cos(t)[..., None], np.sin(t)[..., None]
    around = size * (cosine * u[:, None] + sine * v[:, None])
    tangent = size * (cosine * v[:, None] - sine * u[:, None])
    line = t[..., None] * axis[:, None]
    centre = s.point[i][:, None] + np.where(torus[:, None, None], around, line)
    step = np.where(torus[:, None, None], tangent, np.broadcast_to(axis[:, None], line.shape))
    growth = np.where(s.kind[i] == CONE, np.sin(s.half_angle[i]), 0.0)[:, None]
    fixed = np.where(torus, s.tube[i], np.where(s.kind[i] == CONE, 0.0, s.radius[i]))[:, None]
    return centre, step, fixed + growth * t, growth + 0 * t


def _gaps(s: Surfaces, i: Index, j: Index, t: Array) -> tuple[Array, Array, Array]:
    """Gap of each sphere of bodies `i` from faces `j`, its derivative, and the face's normal.

    Shapes (n, m), (n, m) and (n, m, 3); t as in `_centres`.
    """
    centre, step, radius, growth = _centres(s, i, t)
    rows, points = np.repeat(j, t.shape[1]), centre.reshape(-1, 3)
    distance = s.distance(rows, points).reshape(t.shape)
    normal = s.outward(rows, points).reshape(*t.shape, 3)
    return distance - radius, np.einsum("nmi,nmi->nm", normal, step) - growth, normal


def _circles(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, swing: Array) -> Candidates:
    """Candidate circle contacts of tori `i` whose spheres are all equally far from faces `j`."""
    start = np.zeros((len(i), 1))
    centre, _, radius, _ = (x[:, 0] for x in _centres(s, i, start))
    normal = -_gaps(s, i, j, start)[2][:, 0]
    at = centre + (radius + gap / 2)[:, None] * normal
    axis = s.axis[i]
    height, rho, away = s.polar(i, at)
    lean = np.column_stack([dot(normal, away), dot(normal, axis), 0 * rho])
    # spheres about the middle of a hollow tube have no direction to its wall
    height_off, rho_off, _ = s.polar(j, centre)
    off = np.hypot(rho_off - s.radius[j], height_off)
    middle = (s.kind[j] == TORUS) & (off <= MIDDLE_OF_TUBE * s.tube[j])
    k = np.flatnonzero(~middle)
    return make_candidates(
        row[k], CIRCLE, (s.point[i] + height[:, None] * axis)[k], lean[k], gap[k],
        along=axis[k], radius=rho[k], swing=swing[k], bend=s.tube[i[k]],
    )  # fmt: skip


def _nearest_spheres(
    s: Surfaces, row: Index, i: Index, j: Index, t: Array, chosen: Mask
) -> Candidates:
    """Candidate point contacts at the spheres of bodies `i` that come nearest to faces `j`.

    Parameters
    ----------
    s : Surfaces
    row, i, j : ndarray of int, shape (n,)
    t : ndarray, shape (n, m)
        Positions of spheres, as in `_centres`.
    chosen : ndarray of bool, shape (n,)
        Rows to search.
    """
    _, slope, _ = _gaps(s, i, j, t)
    closed = s.kind[i] == TORUS
    following = np.roll(slope, -1, axis=1)
    bracket = (slope < 0) & (following >= 0) & chosen[:, None]
    bracket[~closed, -1] = False  # an axis has ends
    k, place = np.nonzero(bracket)
    row, i, j = row[k], i[k], j[k]
    low = t[k, place]
    high = low + (t[k, 1] - t[k, 0] if len(k) else low)
    high = np.where(closed[k], high, t[k, np.minimum(place + 1, t.shape[1] - 1)])
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        falls = _gaps(s, i, j, middle[:, None])[1][:, 0] < 0
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    nearest = ((low + high) / 2)[:, None]
    gap, _, normal = (x[:, 0] for x in _gaps(s, i, j, nearest))
    centre, step, radius, _ = (x[:, 0] for x in _centres(s, i, nearest))
    at = centre - (radius + gap / 2)[:, None] * normal
    return make_candidates(row, POINT, at, -normal, gap, bend=_opening(s, i, j, nearest, step))


def _opening(s: Surfaces, i: Index, j: Index, t: Array, step: Array) -> Array:
    """Radius at which the gap opens beside the nearest sphere, along the centres, shape (n,).

    At least the radius of that sphere; `WIDEST_OPENING` limits it.
    """
    speed = np.linalg.norm(step, axis=1)
    size = np.where(s.kind[i] == TORUS, s.radius[i] + s.tube[i], s.radius[j] + s.tube[j])
    off = CURVATURE_STEP * size / speed
    ahead, behind = (_gaps(s, i, j, t + sign * off[:, None])[1][:, 0] for sign in (1, -1))
    curvature = (ahead - behind) / (2 * off * speed**2)
    radius = _centres(s, i, t)[2][:, 0]
    opening = 1 / np.maximum(curvature, 1 / (WIDEST_OPENING * size))
    result: Array = np.maximum(radius, opening)
    return result
