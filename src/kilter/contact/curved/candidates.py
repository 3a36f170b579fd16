"""Candidate contacts of curved faces, and those of faces with planes and with tori.

Candidate line contacts of cylinders and cones that touch along a common generator.

A cone j with the axis a and the half angle alpha has the generators g = a cos(alpha) + w
sin(alpha) with the normals N = w cos(alpha) - a sin(alpha), w any direction across a. Surface i
touches it along a whole generator if it has a generator along the line of g, and the outward normal
+N (inside a hollow cone) or -N (beside a solid cone). The axis of i, in the sense in which it opens
along g (s = 1) or against g (s = -1), then lies in the plane of a and w, at the angle

    alpha_j -+ s alpha_i     from a towards w     (-: inside, +: beside; alpha_i = 0 of a cylinder).

Two equal cones with parallel axes have this angle 0; then w leads to the axis of i.

Candidate contacts of solid curved surfaces with planes.

With n the outward normal of the plane and o a point of it: a sphere touches at c - r n, a cylinder
whose axis lies in the plane along a line, a cone with n.axis = sin(half_angle) along a generator, a
torus around a circle if its axis is upright, else in its lowest point.

Candidate contacts of tori, and of cylinders and cones in hollow tori.

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

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, cross, unit_rows
from kilter.assembly.surfaces import CONE, CYLINDER, SPHERE, TORUS, Surfaces
from kilter.contact.contact_tolerances import (
    CURVATURE_STEP,
    FIT_PLAY,
    MIDDLE_OF_TUBE,
    WIDEST_OPENING,
)

__all__ = [
    "CIRCLE",
    "LINE",
    "POINT",
    "SAME",
    "Candidates",
    "FormLimits",
    "Planes",
    "body_in_torus",
    "dot",
    "lines_on_cone",
    "make_candidates",
    "on_planes",
    "torus_on_face",
    "without_along",
]


POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME means that both surfaces lie on each other, as a shaft and its hole."""


@dataclass(frozen=True, slots=True, eq=False)
class FormLimits(Rows):
    """Tolerances that decide whether surfaces coincide, are parallel, or touch with clearance.

    Attributes
    ----------
    gap : ndarray, shape (n,)
        Largest difference of coinciding surfaces [length unit].
    closed : ndarray, shape (n,)
        Widest gap that counts as closed, at least `gap` [length unit].
    angle : ndarray, shape (n,)
        Largest angle between parallel lines [rad].
    share : ndarray, shape (n,)
        Position at which a fit is closed: 0 at the core of the first surface, 1 at the core of the
        second [-].
    """

    gap: Array
    closed: Array
    angle: Array
    share: Array

    def fits(self, play: Array, radius: Array) -> Mask:
        """Mask of radial plays that count as a loose fit: wider than the gap tolerance."""
        result: Mask = (play > self.gap) & (play <= np.maximum(self.closed, FIT_PLAY * radius))
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Candidates(Rows):
    """Possible contacts of pairs of surfaces (point, line, circle or whole face), one per row.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Row of the pair of surfaces.
    form : ndarray of int, shape (n,)
        POINT, LINE, CIRCLE or SAME.
    at : ndarray, shape (n, 3)
        The point, a point of the line, or the centre of the circle, half-way in the gap.
    along : ndarray, shape (n, 3)
        Direction of the line, or axis of the circle. Of a point on the rim of i it is the direction
        in which the point leaves i; 0 for a point inside the face, which leaves along the normal.
    normal : ndarray, shape (n, 3)
        Unit normal from i to j. Of a circle: its components away from the axis and along it.
    radius : ndarray, shape (n,)
        Radius of the circle, or of the rim on which a point lies [length unit].
    gap, slope, swing : ndarray, shape (n,)
        Gap at `at` [length unit]; its rise along a line [-]; its largest deviation from the mean
        around a circle [length unit].
    play : ndarray, shape (n,)
        Gap all around a fit that only a clearance closes; 0: no such fit [length unit].
    bend : ndarray, shape (n,)
        Radius at which the gap opens beside the contact [length unit].
    rim : ndarray, shape (n,)
        Of a circle that is the end of a face: 1 if that face is i, 2 if it is j; else 0. The same
        for the tip of a face.
    """

    row: Index
    form: Index
    at: Array = columns(3)
    along: Array = columns(3)
    normal: Array = columns(3)
    radius: Array = columns()
    gap: Array = columns()
    slope: Array = columns()
    swing: Array = columns()
    play: Array = columns()
    bend: Array = columns()
    rim: Array = columns()


def make_candidates(
    row: Index, form: int, at: Array, normal: Array, gap: Array, **more: Array
) -> Candidates:
    """Build candidate contacts of the same form; fields that are not given are zero."""
    count = len(row)
    zero, zeros = np.zeros(count), np.zeros((count, 3))
    return Candidates(
        row=row,
        form=np.full(count, form),
        at=at,
        along=more.get("along", zeros),
        normal=normal,
        radius=more.get("radius", zero),
        gap=gap,
        slope=more.get("slope", zero),
        swing=more.get("swing", zero),
        play=more.get("play", zero),
        bend=more.get("bend", zero),
        rim=more.get("rim", zero),
    )


def dot(a: Array, b: Array) -> Array:
    """Dot products of rows, shape (n,)."""
    result: Array = np.einsum("ij,ij->i", a, b)
    return result


def without_along(v: Array, axis: Array) -> Array:
    """Components of vectors perpendicular to unit axes, shape (n, 3)."""
    result: Array = v - dot(v, axis)[:, None] * axis
    return result


def lines_on_cone(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate line contacts of solid cylinders or cones `i` with cones `j`, solid or hollow.

    Normals lead from i to j.
    """
    return Candidates.join([_lines(s, row, i, j, limits, sense) for sense in (1.0, -1.0)])


def _lines(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits, sense: float
) -> Candidates:
    """Candidate line contacts of surfaces `i` that open along (1) or against (-1) the generator."""
    inside = np.where(s.hollow[j], 1.0, -1.0)
    own = np.where(s.kind[i] == CONE, s.half_angle[i], 0.0)
    alpha, axis = s.half_angle[j], s.axis[j]
    lean = alpha - sense * inside * own
    opening = sense * s.axis[i]
    aside = without_along(opening, axis)
    angle = np.arctan2(np.linalg.norm(aside, axis=1), dot(opening, axis))
    parallel = np.abs(lean) <= limits.angle
    offset = without_along(s.point[i] - s.point[j], axis)
    out = unit_rows(np.where(parallel[:, None], offset, np.sign(lean)[:, None] * aside))
    cosine, sine = np.cos(alpha)[:, None], np.sin(alpha)[:, None]
    generator = cosine * axis + sine * out
    normal = inside[:, None] * (cosine * out - sine * axis)
    # a point of the generator of i: its apex, or the point of a cylinder farthest along the normal
    point = s.point[i] + np.where(s.kind[i] == CONE, 0.0, s.radius[i])[:, None] * normal
    gap = dot(s.point[j] - point, normal)
    beside = np.abs(dot(point - s.point[j], cross(axis, out)))
    touches = (np.abs(angle - np.abs(lean)) <= limits.angle) & (beside <= limits.gap)
    touches &= np.linalg.norm(out, axis=1) > 0
    # the generator of i with the same normal, by its own axis
    own_axis = s.axis[i]
    own_out = unit_rows(without_along(normal, own_axis))
    line = np.cos(own)[:, None] * own_axis + np.sin(own)[:, None] * own_out
    slope = dot(generator - sense * line, normal)
    k = np.flatnonzero(touches)
    return make_candidates(
        row[k], LINE, (point + (gap / 2)[:, None] * normal)[k], normal[k], gap[k],
        along=generator[k], slope=slope[k],
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """Planes of n flat faces: unit outward normals and a point of each plane, shape (n, 3)."""

    normal: Array
    origin: Array


def on_planes(s: Surfaces, i: Index, planes: Planes, angle: Array) -> Candidates:
    """Candidate contacts of solid curved surfaces `i` with planes, row by row.

    `angle` is the tolerance of each pair, shape (n,) [rad].
    """
    rows = np.arange(len(i))
    blocks: list[Candidates] = []
    for kind, kernel in (
        (SPHERE, _sphere_plane),
        (CYLINDER, _cylinder_plane),
        (CONE, _cone_plane),
        (TORUS, _torus_plane),
    ):
        k = np.flatnonzero((s.kind[i] == kind) & ~s.hollow[i])
        if len(k):
            n, o = planes.normal[k], planes.origin[k]
            blocks.append(kernel(s, rows[k], i[k], n, o, angle[k]))
    return Candidates.join(blocks)


def _sphere_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Candidates:
    """Candidate point contacts: the point of each sphere nearest to its plane."""
    r = s.radius[i]
    gap = dot(s.point[i] - o, n) - r
    at = s.point[i] - (r + gap / 2)[:, None] * n
    return make_candidates(row, POINT, at, -n, gap, bend=r)


def _cylinder_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Candidates:
    """Candidate line contacts: the lowest line of each cylinder, if parallel to its plane.

    Lines up to the tilt `angle` count as parallel [rad].
    """
    slope = dot(s.axis[i], n)
    k = np.flatnonzero(np.abs(slope) <= np.sin(angle))
    row, i, n, o, slope = row[k], i[k], n[k], o[k], slope[k]
    r, axis = s.radius[i], s.axis[i]
    normal = -unit_rows(n + unit_rows(without_along(n, axis)))
    along = unit_rows(without_along(axis, normal))
    gap = dot(s.point[i] - o, n) - r
    at = s.point[i] + (r + gap / 2)[:, None] * normal
    return make_candidates(row, LINE, at, normal, gap, along=along, slope=slope, bend=r)


def _cone_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate line contacts: the straight line of each cone that lies on its plane.

    Lines up to the tilt `angle` count as lying on the plane [rad].
    """
    lift, alpha = dot(s.axis[i], n), s.half_angle[i]
    k = np.flatnonzero(np.abs(np.arcsin(np.clip(lift, -1, 1)) - alpha) <= angle)
    row, i, n, o, alpha = row[k], i[k], n[k], o[k], alpha[k]
    axis = s.axis[i]
    out = -unit_rows(without_along(n, axis))
    side = np.cos(alpha)[:, None] * out - np.sin(alpha)[:, None] * axis
    normal = unit_rows(side - n)
    generator = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    gap, slope = dot(s.point[i] - o, n), dot(generator, n)
    at = s.point[i] + (gap / 2)[:, None] * normal
    along = unit_rows(without_along(generator, normal))
    return make_candidates(row, LINE, at, normal, gap, along=along, slope=slope, bend=s.radius[i])


def _torus_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate contacts of tori with planes: a circle if the axis is upright, else a point."""
    center, axis, radius, tube = s.point[i], s.axis[i], s.radius[i], s.tube[i]
    aside = without_along(n, axis)
    sine = np.linalg.norm(aside, axis=1)
    upright = sine <= np.sin(angle)
    k = np.flatnonzero(upright)
    gap = dot(center - o, n) - tube
    at = center - (tube + gap / 2)[:, None] * n
    flat = np.tile([0.0, -1.0, 0.0], (len(k), 1))
    circle = make_candidates(
        row[k], CIRCLE, at[k], flat, gap[k],
        along=n[k], radius=radius[k], swing=(radius * sine)[k], bend=tube[k],
    )  # fmt: skip
    k = np.flatnonzero(~upright)
    lowest = center[k] - radius[k][:, None] * unit_rows(aside[k])
    gap = dot(lowest - o[k], n[k]) - tube[k]
    at = lowest - (tube[k] + gap / 2)[:, None] * n[k]
    bend = tube[k] + radius[k] / sine[k]
    return Candidates.join([circle, make_candidates(row[k], POINT, at, -n[k], gap, bend=bend)])


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
