"""Candidate contacts of curved faces, and those of faces with planes and with tori.

A cone j with the axis a and the half angle alpha has the generators g = a cos(alpha) + w
sin(alpha) with the normals N = w cos(alpha) - a sin(alpha), w any direction across a. Surface i
touches it along a whole generator if it has a generator along the line of g, and the outward normal
+N (inside a hollow cone) or -N (beside a solid cone). The axis of i, in the sense in which it opens
along g (s = 1) or against g (s = -1), then lies in the plane of a and w, at the angle

    alpha_j -+ s alpha_i     from a towards w     (-: inside, +: beside; alpha_i = 0 of a cylinder).

Two equal cones with parallel axes have this angle 0; then w leads to the axis of i.

With n the outward normal of the plane and o a point of it: a sphere touches at c - r n, a cylinder
whose axis lies in the plane along a line, a cone with n.axis = sin(half_angle) along a generator, a
torus around a circle if its axis is upright, else in its lowest point.

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

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, cross, unit_rows
from kilter.assembly.surfaces import CONE, CYLINDER, SPHERE, TORUS, Surfaces
from kilter.contact.contact_tolerances import (
    CURVATURE_STEP,
    FIT_PLAY,
    MIDDLE_OF_TUBE,
    WIDEST_OPENING,
)

POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME means that both surfaces lie on each other, as a shaft and its hole."""


@dataclass(frozen=True, slots=True, eq=False)
class FormLimits(Rows):
    """Tolerances that decide whether surfaces coincide, are parallel, or touch with clearance."""

    gap: Array
    """Largest difference of coinciding surfaces [length unit], shape (n,)."""
    closed: Array
    """Widest gap that counts as closed, at least `gap` [length unit], shape (n,)."""
    angle: Array
    """Largest angle between parallel lines [rad], shape (n,)."""
    share: Array
    """Position at which a fit is closed, shape (n,): 0 at the core of the first surface, 1 at
    the core of the second [-]."""

    def fits(self, play: Array, radius: Array) -> Mask:
        """Mask of radial plays that count as a loose fit: wider than the gap tolerance."""
        result: Mask = (play > self.gap) & (play <= np.maximum(self.closed, FIT_PLAY * radius))
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Candidates(Rows):
    """Possible contacts of pairs of surfaces (point, line, circle or whole face), one per row."""

    row: Index
    """Row of the pair of surfaces, shape (n,)."""
    form: Index
    """POINT, LINE, CIRCLE or SAME, shape (n,)."""
    at: Array = columns(3)
    """The point, a point of the line, or the centre of the circle, half-way in the gap, shape
    (n, 3)."""
    along: Array = columns(3)
    """Direction of the line, or axis of the circle, shape (n, 3). Of a point on the rim of i it
    is the direction in which the point leaves i; 0 for a point inside the face, which leaves
    along the normal."""
    normal: Array = columns(3)
    """Unit normal from i to j, shape (n, 3). Of a circle: its components away from the axis and
    along it."""
    radius: Array = columns()
    """Radius of the circle, or of the rim on which a point lies [length unit], shape (n,)."""
    gap: Array = columns()
    slope: Array = columns()
    swing: Array = columns()
    """Gap at `at` [length unit]; its rise along a line [-]; its largest deviation from the mean
    around a circle [length unit], shape (n,)."""
    play: Array = columns()
    """Gap all around a fit that only a clearance closes, shape (n,); 0: no such fit [length
    unit]."""
    bend: Array = columns()
    """Radius at which the gap opens beside the contact [length unit], shape (n,)."""
    rim: Array = columns()
    """Whether a circle is the end of a face, shape (n,): 1 if that face is i, 2 if it is j; else
    0. The same for the tip of a face."""


def make_candidates(form: int, at: Array, normal: Array, gap: Array, **more: Array) -> Candidates:
    """Candidate contacts of one form, one for each pair; fields that are not given are zero."""
    zero = np.zeros(len(gap))
    given = {"along": np.zeros(at.shape), **dict.fromkeys(SCALARS, zero), **more}
    return Candidates(
        row=np.arange(len(gap)),
        form=np.full(len(gap), form),
        at=at,
        normal=normal,
        gap=gap,
        **given,
    )


SCALARS = ("radius", "slope", "swing", "play", "bend", "rim")
"""Fields of candidates with one number that is zero by default."""


@dataclass(frozen=True, eq=False)
class Side:
    """One side of pairs of surfaces: the values of a surface for each pair."""

    surfaces: Surfaces
    row: Index

    def take(self, rows: Index | Mask) -> Side:
        """The same side of some of the pairs."""
        return Side(self.surfaces, self.row[rows])

    @cached_property
    def kind(self) -> Index:
        """Kind of each surface, shape (n,)."""
        return self.surfaces.kind[self.row]

    @cached_property
    def hollow(self) -> Mask:
        """Whether the material lies outside of each surface, shape (n,)."""
        return self.surfaces.hollow[self.row]

    @cached_property
    def point(self) -> Array:
        """Point of each surface, shape (n, 3)."""
        return self.surfaces.point[self.row]

    @cached_property
    def axis(self) -> Array:
        """Axis of each surface, shape (n, 3)."""
        return self.surfaces.axis[self.row]

    @cached_property
    def radius(self) -> Array:
        """Radius of each surface [length unit]."""
        return self.surfaces.radius[self.row]

    @cached_property
    def tube(self) -> Array:
        """Radius of the tube of each torus [length unit]."""
        return self.surfaces.tube[self.row]

    @cached_property
    def half_angle(self) -> Array:
        """Half angle of each cone [rad]."""
        return self.surfaces.half_angle[self.row]

    def polar(self, points: Array) -> tuple[Array, Array, Array]:
        """Polar coordinates of a point about the axis of each surface."""
        return self.surfaces.polar(self.row, points)

    def distance(self, points: Array) -> Array:
        """Distance of a point from each surface, positive outside the material [length unit]."""
        return self.surfaces.distance(self.row, points)


def dot(a: Array, b: Array) -> Array:
    """Dot products of rows, shape (n,)."""
    result: Array = np.einsum("ij,ij->i", a, b)
    return result


def without_along(v: Array, axis: Array) -> Array:
    """Components of vectors perpendicular to unit axes, shape (n, 3)."""
    result: Array = v - dot(v, axis)[:, None] * axis
    return result


def lines_on_cone(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate line contacts of solid cylinders or cones `a` with cones `b`, solid or hollow."""
    return Candidates.join([_lines(a, b, limits, sense) for sense in (1.0, -1.0)])


def _lines(a: Side, b: Side, limits: FormLimits, sense: float) -> Candidates:
    """Candidate line contacts of surfaces `a` that open along (1) or against (-1) the generator."""
    inside = np.where(b.hollow, 1.0, -1.0)
    cone = a.kind == CONE
    own = np.where(cone, a.half_angle, 0.0)
    lean = b.half_angle - sense * inside * own
    opening = sense * a.axis
    aside = without_along(opening, b.axis)
    angle = np.arctan2(np.linalg.norm(aside, axis=1), dot(opening, b.axis))
    parallel = np.abs(lean) <= limits.angle
    offset = without_along(a.point - b.point, b.axis)
    out = unit_rows(np.where(parallel[:, None], offset, np.sign(lean)[:, None] * aside))
    cosine, sine = np.cos(b.half_angle)[:, None], np.sin(b.half_angle)[:, None]
    generator = cosine * b.axis + sine * out
    normal = inside[:, None] * (cosine * out - sine * b.axis)
    # a point of the generator of a: its apex, or the point of a cylinder farthest along the normal
    point = a.point + np.where(cone, 0.0, a.radius)[:, None] * normal
    gap = dot(b.point - point, normal)
    beside = np.abs(dot(point - b.point, cross(b.axis, out)))
    touches = (np.abs(angle - np.abs(lean)) <= limits.angle) & (beside <= limits.gap)
    touches &= np.linalg.norm(out, axis=1) > 0
    # the generator of a with the same normal, by its own axis
    own_out = unit_rows(without_along(normal, a.axis))
    line = np.cos(own)[:, None] * a.axis + np.sin(own)[:, None] * own_out
    at, slope = point + (gap / 2)[:, None] * normal, dot(generator - sense * line, normal)
    return make_candidates(LINE, at, normal, gap, along=generator, slope=slope).take(touches)


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """Planes of n flat faces: unit outward normals and a point of each plane, shape (n, 3)."""

    normal: Array
    origin: Array


def on_planes(s: Surfaces, i: Index, planes: Planes, angle: Array) -> Candidates:
    """Candidate contacts of solid curved surfaces `i` with planes, row by row.

    `angle` is the tolerance of each pair, shape (n,) [rad].
    """
    blocks: list[Candidates] = []
    for kind, kernel in (
        (SPHERE, _sphere_plane),
        (CYLINDER, _cylinder_plane),
        (CONE, _cone_plane),
        (TORUS, _torus_plane),
    ):
        k = np.flatnonzero((s.kind[i] == kind) & ~s.hollow[i])
        if len(k):
            block = kernel(Side(s, i[k]), planes.normal[k], planes.origin[k], angle[k])
            blocks.append(replace(block, row=k[block.row]))
    return Candidates.join(blocks)


def _sphere_plane(a: Side, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate point contacts: the point of each sphere nearest to its plane."""
    gap = dot(a.point - o, n) - a.radius
    at = a.point - (a.radius + gap / 2)[:, None] * n
    return make_candidates(POINT, at, -n, gap, bend=a.radius)


def _cylinder_plane(a: Side, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate line contacts: the lowest line of each cylinder, if parallel to its plane.

    Lines up to the tilt `angle` count as parallel [rad].
    """
    slope = dot(a.axis, n)
    normal = -unit_rows(n + unit_rows(without_along(n, a.axis)))
    along = unit_rows(without_along(a.axis, normal))
    gap = dot(a.point - o, n) - a.radius
    at = a.point + (a.radius + gap / 2)[:, None] * normal
    line = make_candidates(LINE, at, normal, gap, along=along, slope=slope, bend=a.radius)
    return line.take(np.abs(slope) <= np.sin(angle))


def _cone_plane(a: Side, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate line contacts: the straight line of each cone that lies on its plane.

    Lines up to the tilt `angle` count as lying on the plane [rad].
    """
    lean = np.arcsin(np.clip(dot(a.axis, n), -1, 1)) - a.half_angle
    cosine, sine = np.cos(a.half_angle)[:, None], np.sin(a.half_angle)[:, None]
    out = -unit_rows(without_along(n, a.axis))
    normal = unit_rows(cosine * out - sine * a.axis - n)
    generator = cosine * a.axis + sine * out
    gap, slope = dot(a.point - o, n), dot(generator, n)
    at = a.point + (gap / 2)[:, None] * normal
    along = unit_rows(without_along(generator, normal))
    line = make_candidates(LINE, at, normal, gap, along=along, slope=slope, bend=a.radius)
    return line.take(np.abs(lean) <= angle)


def _torus_plane(a: Side, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate contacts of tori with planes: a circle if the axis is upright, else a point."""
    aside = without_along(n, a.axis)
    sine = np.linalg.norm(aside, axis=1)
    upright = sine <= np.sin(angle)
    gap = dot(a.point - o, n) - a.tube
    circle = make_candidates(
        CIRCLE,
        a.point - (a.tube + gap / 2)[:, None] * n,
        np.tile([0.0, -1.0, 0.0], (len(gap), 1)),
        gap,
        along=n,
        radius=a.radius,
        swing=a.radius * sine,
        bend=a.tube,
    )
    lowest = a.point - a.radius[:, None] * unit_rows(aside)
    gap = dot(lowest - o, n) - a.tube
    at = lowest - (a.tube + gap / 2)[:, None] * n
    bend = a.tube + a.radius / np.where(upright, 1.0, sine)
    point = make_candidates(POINT, at, -n, gap, bend=bend)
    return Candidates.join([circle.take(upright), point.take(~upright)])


SAMPLES = 256
"""Number of spheres of each envelope at which the gap is computed; two least gaps between
neighbouring spheres count as a single gap."""
HALVINGS = 52
"""Bisection steps that locate the nearest sphere: as many as a number has binary digits."""


def torus_on_face(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of solid tori `a` with other faces `b`: circles and points."""
    t = np.linspace(0, 2 * np.pi, SAMPLES, endpoint=False)
    t = np.tile(t, (len(a.row), 1))
    gap, slope, _ = _gaps(a, b, t)
    high, low = gap.max(axis=1), gap.min(axis=1)
    is_round = high - low <= 2 * limits.gap
    # within a wide gap the torus may lie askew, so that no circle has the normals of the face
    is_round &= np.abs(slope).max(axis=1) <= np.sin(limits.angle) * a.radius
    circles = _circles(a, b, (low + high) / 2, (high - low) / 2)
    return Candidates.join(
        [circles.take(is_round[circles.row]), _nearest_spheres(a, b, t, ~is_round)]
    )


def body_in_torus(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate point contacts of solid cylinders or cones `a` in hollow tori `b`."""
    # only centres within the tube have a distance from the torus that is positive
    middle = dot(b.point - a.point, a.axis)
    reach = b.radius + b.tube
    t = middle[:, None] + reach[:, None] * np.linspace(-1, 1, SAMPLES)
    t = np.where((a.kind == CONE)[:, None], np.maximum(t, 0.0), t)
    return _nearest_spheres(a, b, t, np.ones(len(t), dtype=bool))


def _centres(a: Side, t: Array) -> tuple[Array, Array, Array, Array]:
    """Centres and radii of the spheres of bodies `a`, and their derivatives.

    `t`, shape (n, m), is the angle around the axis of a torus [rad], or the position on the axis of
    another body [length unit]. Shapes (n, m, 3), (n, m, 3), (n, m) and (n, m).
    """
    torus, cone = a.kind == TORUS, a.kind == CONE
    u, v = across(a.axis)
    size = a.radius[:, None, None]
    cosine, sine = np.cos(t)[..., None], np.sin(t)[..., None]
    around = size * (cosine * u[:, None] + sine * v[:, None])
    tangent = size * (cosine * v[:, None] - sine * u[:, None])
    line = t[..., None] * a.axis[:, None]
    centre = a.point[:, None] + np.where(torus[:, None, None], around, line)
    step = np.where(torus[:, None, None], tangent, np.broadcast_to(a.axis[:, None], line.shape))
    growth = np.where(cone, np.sin(a.half_angle), 0.0)[:, None]
    fixed = np.where(torus, a.tube, np.where(cone, 0.0, a.radius))[:, None]
    return centre, step, fixed + growth * t, growth + 0 * t


def _gaps(a: Side, b: Side, t: Array) -> tuple[Array, Array, Array]:
    """Gap of each sphere of bodies `a` from faces `b`, its derivative, and the face's normal.

    Shapes (n, m), (n, m) and (n, m, 3); t as in `_centres`.
    """
    centre, step, radius, growth = _centres(a, t)
    rows, points = np.repeat(b.row, t.shape[1]), centre.reshape(-1, 3)
    distance = b.surfaces.distance(rows, points).reshape(t.shape)
    normal = b.surfaces.outward(rows, points).reshape(*t.shape, 3)
    return distance - radius, np.einsum("nmi,nmi->nm", normal, step) - growth, normal


def _circles(a: Side, b: Side, gap: Array, swing: Array) -> Candidates:
    """Candidate circle contacts of tori `a` whose spheres are all equally far from faces `b`."""
    start = np.zeros((len(gap), 1))
    centre, _, radius, _ = (x[:, 0] for x in _centres(a, start))
    normal = -_gaps(a, b, start)[2][:, 0]
    at = centre + (radius + gap / 2)[:, None] * normal
    height, rho, away = a.polar(at)
    out_and_up = np.column_stack([dot(normal, away), dot(normal, a.axis), 0 * rho])
    circle = make_candidates(
        CIRCLE,
        a.point + height[:, None] * a.axis,
        unit_rows(out_and_up),
        gap,
        along=a.axis,
        radius=rho,
        swing=swing,
        bend=a.tube,
    )
    # spheres about the middle of a hollow tube have no direction to its wall
    height_off, rho_off, _ = b.polar(centre)
    off = np.hypot(rho_off - b.radius, height_off)
    return circle.take((b.kind != TORUS) | (off > MIDDLE_OF_TUBE * b.tube))


def _nearest_spheres(a: Side, b: Side, t: Array, chosen: Mask) -> Candidates:
    """Candidate point contacts at the spheres of bodies `a` that come nearest to faces `b`.

    `t`, shape (n, m), holds positions of spheres, as in `_centres`; `chosen` the rows to search.
    """
    _, slope, _ = _gaps(a, b, t)
    closed = a.kind == TORUS
    following = np.roll(slope, -1, axis=1)
    bracket = (slope < 0) & (following >= 0) & chosen[:, None]
    bracket[~closed, -1] = False  # an axis has ends
    k, place = np.nonzero(bracket)
    a, b = a.take(k), b.take(k)
    low = t[k, place]
    high = low + (t[k, 1] - t[k, 0] if len(k) else low)
    high = np.where(closed[k], high, t[k, np.minimum(place + 1, t.shape[1] - 1)])
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        falls = _gaps(a, b, middle[:, None])[1][:, 0] < 0
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    nearest = ((low + high) / 2)[:, None]
    gap, _, normal = (x[:, 0] for x in _gaps(a, b, nearest))
    centre, step, radius, _ = (x[:, 0] for x in _centres(a, nearest))
    at = centre - (radius + gap / 2)[:, None] * normal
    points = make_candidates(POINT, at, -normal, gap, bend=_opening(a, b, nearest, step))
    return replace(points, row=k)


def _opening(a: Side, b: Side, t: Array, step: Array) -> Array:
    """Radius at which the gap opens beside the nearest sphere, along the centres, shape (n,).

    At least the radius of that sphere; `WIDEST_OPENING` limits it.
    """
    speed = np.linalg.norm(step, axis=1)
    size = np.where(a.kind == TORUS, a.radius + a.tube, b.radius + b.tube)
    off = CURVATURE_STEP * size / speed
    ahead, behind = (_gaps(a, b, t + sign * off[:, None])[1][:, 0] for sign in (1, -1))
    curvature = (ahead - behind) / (2 * off * speed**2)
    radius = _centres(a, t)[2][:, 0]
    opening = 1 / np.maximum(curvature, 1 / (WIDEST_OPENING * size))
    result: Array = np.maximum(radius, opening)
    return result
