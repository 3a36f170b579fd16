"""Candidate contacts of two exact surfaces: a point, a line, a circle, or the whole surface.

Each kernel takes many pairs of surfaces (a, b) of two kinds and returns candidates: position, unit
normal n from a to b, and the gap there, independently of the extent of their faces, which
`kilter.contact.curved.contact_points` tests. Solid against solid touches from outside; solid in
hollow touches from inside, if the solid is curved more than the hollow. With cores (the centre of a
sphere, the axis of a cylinder, the circle of a torus) at the distance D and radii r:

    solid on solid   gap = D - r_a - r_b          solid in hollow   gap = r_b - r_a - D

Cylinders and cones are envelopes of planes: a plane with normal m touches a cylinder of axis d if
m.d = 0, and a cone of axis a and half angle alpha if m.a = -sin(alpha), each along a generator; two
such surfaces touch at the crossing of their generators in a common plane.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across, cross, ratio, unit_rows
from kilter.assembly.surfaces import CONE, CYLINDER, FREE, SPHERE, TORUS, Surfaces
from kilter.contact.contact_tolerances import GENERATOR_SINE, NO_DIRECTION
from kilter.contact.curved.candidates import (
    CIRCLE,
    LINE,
    POINT,
    SAME,
    Candidates,
    FormLimits,
    Side,
    body_in_torus,
    dot,
    lines_on_cone,
    make_candidates,
    torus_on_face,
    without_along,
)  # fmt: skip


def _opening_radius(first: Array, second: Array, sign: float) -> Array:
    """Radius of curvature of the gap between two curves: 1 / (1/first + sign/second)."""
    curvature = 1 / np.maximum(first, TINY) + sign / np.maximum(second, TINY)
    result: Array = 1 / np.maximum(curvature, NO_DIRECTION / np.maximum(first, TINY))
    return result


Kernel = Callable[[Side, Side, FormLimits], Candidates]


def find_candidates(
    s: Surfaces, i: Index, j: Index, limits: FormLimits, held: Mask
) -> tuple[Candidates, Mask]:
    """Candidate contacts of pairs of surfaces, and a mask of pairs without a contact formula.

    `i`, `j`, shape (n,): rows of the surfaces of each pair. `limits`: limits of each pair; its
    `share` is set here. Returns `candidates`: normals lead from i to j.
    """
    swap = (s.kind[i] > s.kind[j]) | ((s.kind[i] == s.kind[j]) & s.hollow[i])
    # kernels expect the surfaces in order of kind, and of two equal kinds the solid first
    a, b = Side(s, np.where(swap, j, i)), Side(s, np.where(swap, i, j))
    inside, socket = b.hollow & ~a.hollow, a.hollow & ~b.hollow
    stays = held[s.part[a.row]].astype(int) - held[s.part[b.row]]
    # 0: close at the first surface, 1: at the second; a hollow first surface is the hole
    share = np.where(stays == 0, socket, stays > 0)
    limits = replace(limits, share=share.astype(np.float64))
    places = {"on": ~a.hollow & ~b.hollow, "in": inside, "around": socket}
    blocks: list[Candidates] = []
    for (first_kind, second_kind, place), kernel in _KERNELS.items():
        rows = np.flatnonzero((a.kind == first_kind) & (b.kind == second_kind) & places[place])
        if len(rows):
            block = kernel(a.take(rows), b.take(rows), limits.take(rows))
            blocks.append(replace(block, row=rows[block.row]))
    candidates = Candidates.join(blocks)
    # a torus fills a hollow torus with the same circle
    unknown = (a.kind == FREE) | (b.kind == FREE) | (a.kind == TORUS) & (b.kind == TORUS) & inside
    unknown[candidates.row] = False  # a kernel returned a candidate
    turned = np.where(swap[candidates.row], -1.0, 1.0)[:, None]
    return replace(candidates, normal=turned * candidates.normal), unknown


def _round_in_round(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow spheres: the whole face or a single point.

    The whole face if the radii agree.
    """
    apart = a.point - b.point
    play, distance, direction = b.radius - a.radius, _length(apart), unit_rows(apart)
    same = np.abs(play) <= limits.gap
    whole = make_candidates(SAME, a.point, direction, play, swing=distance, bend=a.radius)
    fits = replace(whole, at=a.point - limits.share[:, None] * apart, play=play)
    bend = _opening_radius(a.radius, b.radius, -1.0)
    point = _on_wall(a, direction, play - distance, bend)
    return Candidates.join(
        [
            whole.take(same),
            fits.take(limits.fits(play, a.radius)),
            point.take(~same & (play > 0)),
            replace(whole, bend=0 * play).take(~same & (play <= 0)),
        ]
    )


def _length(v: Array) -> Array:
    """Lengths of vectors, shape (n,)."""
    result: Array = np.linalg.norm(v, axis=1)
    return result


def _on_wall(a: Side, normal: Array, gap: Array, bend: Array) -> Candidates:
    """Candidate point contacts of spheres at their farthest points along the normals."""
    return make_candidates(
        POINT, a.point + (a.radius + gap / 2)[:, None] * normal, normal, gap, bend=bend
    )


def _sphere_beside(a: Side, apart: Array, other_radius: Array) -> Candidates:
    """Candidate contacts of spheres outside round bodies, at the point nearest to their axis.

    The core is the axis or centre of the body; it lies at `apart` from the sphere's centre.
    """
    return _on_wall(a, unit_rows(apart), _length(apart) - a.radius - other_radius, a.radius)


def _sphere_sphere(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside spheres: the point between the centres."""
    return _sphere_beside(a, b.point - a.point, b.radius)


def _sphere_cylinder(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside cylinders: the point nearest to the axis."""
    return _sphere_beside(a, -without_along(a.point - b.point, b.axis), b.radius)


def _sphere_in_cylinder(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow cylinders: a circle for equal radii, else a point."""
    apart = without_along(a.point - b.point, b.axis)
    return _sphere_in_tube(a, limits, apart, b.axis, b.radius, 1.0)


def _sphere_in_tube(
    a: Side, limits: FormLimits, apart: Array, along: Array, tube: Array, widest: float
) -> Candidates:
    """Candidate contacts of spheres in tubes: a circle if the sphere fills the tube, else a point.

    `apart` leads from the line of the tube to the sphere's centre; `along` is the direction of that
    line, `tube` the radius. The gap opens over at least `widest` radii of the sphere.
    """
    play, distance = tube - a.radius, _length(apart)
    fit = limits.fits(play, a.radius)
    wider = np.where(fit, play, 0.0)
    circle = make_candidates(
        CIRCLE,
        a.point - np.where(fit, limits.share, 0.0)[:, None] * apart,
        np.tile([1.0, 0.0, 0.0], (len(play), 1)),
        play,
        along=along,
        radius=a.radius + wider / 2,
        swing=distance,
        play=wider,
        bend=a.radius,
    )
    bend = np.maximum(_opening_radius(a.radius, tube, -1.0), widest * a.radius)
    point = _on_wall(a, unit_rows(apart), play - distance, bend)
    filling = (np.abs(play) <= limits.gap) | fit
    return Candidates.join([circle.take(filling), point.take(play > limits.gap)])


def _sphere_cone(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside cones: the nearest point of the cone's side."""
    _, _, direction = b.polar(a.point)
    cosine, sine = np.cos(b.half_angle)[:, None], np.sin(b.half_angle)[:, None]
    normal = -(cosine * direction - sine * b.axis)
    return _on_wall(a, normal, b.distance(a.point) - a.radius, a.radius)


def _sphere_in_cone(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow cones: a circle if on the axis, else a point."""
    height, rho, direction = b.polar(a.point)
    cosine, sine = np.cos(b.half_angle), np.sin(b.half_angle)
    mean = height * sine - a.radius
    closes = (rho > limits.gap) & (np.maximum(rho, mean) <= limits.closed) & (mean > limits.gap)
    center = a.point - (a.radius * sine)[:, None] * b.axis
    center -= np.where(closes, limits.share * rho, 0.0)[:, None] * direction
    play = np.where(closes, mean, 0.0)
    circle = make_candidates(
        CIRCLE,
        center,
        np.column_stack([cosine, -sine, 0 * sine]),
        mean,
        along=b.axis,
        radius=a.radius * cosine + play / 2,
        swing=rho * cosine,
        play=play,
        bend=a.radius,
    )
    normal = cosine[:, None] * direction - sine[:, None] * b.axis
    # around the axis of the cone the gap opens slowly: a wide zone
    point = _on_wall(a, normal, b.distance(a.point) - a.radius, 10 * a.radius)
    off_axis = rho > limits.gap
    return Candidates.join([circle.take(~off_axis | closes), point.take(off_axis)])


def _sphere_torus(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside tori: a circle if centred on the axis, else a point."""
    height, rho, direction = b.polar(a.point)
    core = np.hypot(b.radius, height)
    out, down = b.radius / core, -height / core
    circle = make_candidates(
        CIRCLE,
        a.point + (a.radius * down)[:, None] * b.axis,
        np.column_stack([out, down, 0 * out]),
        core - b.tube - a.radius,
        along=b.axis,
        radius=a.radius * out,
        swing=rho,
        bend=a.radius,
    )
    apart = (b.radius - rho)[:, None] * direction - height[:, None] * b.axis
    centred = rho <= limits.gap
    point = _sphere_beside(a, apart, b.tube)
    return Candidates.join([circle.take(centred), point.take(~centred)])


def _sphere_in_torus(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow tori: a circle if the radii agree, else a point.

    The circle lies around the tube.
    """
    height, rho, direction = b.polar(a.point)
    apart = (rho - b.radius)[:, None] * direction + height[:, None] * b.axis
    return _sphere_in_tube(a, limits, apart, cross(b.axis, direction), b.tube, 10.0)


def _cylinder_cylinder(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of cylinders side by side: a line if axes are parallel, else a point."""
    parallel = _length(cross(a.axis, b.axis)) <= np.sin(limits.angle)
    along, apart, change = _nearly_parallel(a, b)
    normal = unit_rows(apart)
    gap = _length(apart) - a.radius - b.radius
    line = make_candidates(
        LINE,
        a.point + (a.radius + gap / 2)[:, None] * normal,
        normal,
        gap,
        along=along,
        slope=dot(change, normal),
        bend=_opening_radius(a.radius, b.radius, 1.0),
    )
    point = _crossing_generators(a, b, limits)
    return Candidates.join([line.take(parallel), point.take(~parallel[point.row])])


def _nearly_parallel(a: Side, b: Side) -> tuple[Array, Array, Array]:
    """Common direction of two nearly parallel axes, and the offset between them, shape (n, 3).

    The offset leads from the point of a across the common direction to the axis of b; the third
    value is its change per unit length along that direction [-].
    """
    axis_b = np.where(dot(a.axis, b.axis) < 0, -1.0, 1.0)[:, None] * b.axis
    along = unit_rows(a.axis + axis_b)
    lean_a, lean_b = dot(a.axis, along)[:, None], dot(axis_b, along)[:, None]
    nearest = b.point + dot(a.point - b.point, along)[:, None] / lean_b * axis_b
    return along, nearest - a.point, axis_b / lean_b - a.axis / lean_a


def _cylinder_in_cylinder(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of cylinders in bores: the whole face if the radii agree, else a line.

    A shaft with play in its hole is a fit (SAME with `play`) and a line.
    """
    sine, play = _length(cross(a.axis, b.axis)), b.radius - a.radius
    parallel = sine <= np.sin(limits.angle)
    along, apart, change = _nearly_parallel(a, b)
    distance, normal = _length(apart), -unit_rows(apart)
    same = parallel & (play <= limits.gap)
    # a shaft may lean by its play over the length of the hole: the caller tests the true length
    fit = limits.fits(play, a.radius)
    fit &= sine <= np.sin(limits.angle) + 2 * ratio(np.maximum(play, 0), a.radius)
    # the gap varies around and along the axis: the caller computes it at both ends
    coaxial = make_candidates(
        SAME,
        a.point,
        normal,
        play,
        along=along,
        radius=a.radius,
        slope=sine,
        swing=distance,
        play=np.where(fit, play, 0.0),
        bend=a.radius,
    )
    # coinciding axes leave the same gap all around: any direction serves
    normal = np.where((distance > NO_DIRECTION * a.radius)[:, None], normal, across(along)[0])
    gap = play - distance
    line = make_candidates(
        LINE,
        a.point + (a.radius + gap / 2)[:, None] * normal,
        normal,
        gap,
        along=along,
        slope=dot(change, normal),
        bend=_opening_radius(a.radius, b.radius, -1.0),
    )
    return Candidates.join([coaxial.take(same | fit), line.take(parallel & ~same)])


def _cone_in_cone(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of solid cones in hollow cones of the same half angle and axis."""
    alike = _length(cross(a.axis, b.axis)) <= np.sin(limits.angle)
    alike &= dot(a.axis, b.axis) > 0
    alike &= np.abs(a.half_angle - b.half_angle) <= limits.angle
    a, b, limits = a.take(alike), b.take(alike), limits.take(alike)
    axis, alpha, shift = (
        unit_rows(a.axis + b.axis),
        (a.half_angle + b.half_angle) / 2,
        a.point - b.point,
    )
    lift = dot(shift, axis) * np.sin(alpha)
    closes = (lift > limits.gap) & (lift <= limits.closed)
    same = make_candidates(
        SAME,
        a.point,
        0 * axis,
        lift,
        along=axis,
        slope=b.half_angle - a.half_angle,
        swing=_length(without_along(shift, axis)) * np.cos(alpha),
        play=np.where(closes, lift, 0.0),
        bend=np.maximum(a.radius, limits.gap),
    )
    return replace(same, row=np.flatnonzero(alike))


def _cone_in_wider_cone(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of solid cones in hollow cones: whole faces, else a common generator."""
    same, lines = _cone_in_cone(a, b, limits), lines_on_cone(a, b, limits)
    coaxial = same.row[same.swing <= limits.gap[same.row]]
    return Candidates.join([same, lines.take(~np.isin(lines.row, coaxial))])


def _generators(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of cylinders or cones whose generators cross or are common."""
    return Candidates.join([_crossing_generators(a, b, limits), lines_on_cone(a, b, limits)])


def _crossing_generators(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate point contacts of cylinders or cones whose straight lines (generators) cross.

    Both generators lie in the common tangent plane. With axes a, b and the wanted m.a, m.b, the
    unit normal is m = x a + y b + z (a x b). The two signs of z give the tangent planes on either
    side.
    """
    want_a = np.where(a.kind == CONE, -np.sin(a.half_angle), 0.0)
    want_b = np.where(b.kind == CONE, np.sin(b.half_angle), 0.0)
    third = cross(a.axis, b.axis)
    cosine, square = dot(a.axis, b.axis), dot(third, third)
    safe = np.maximum(square, TINY)
    x, y = (want_a - cosine * want_b) / safe, (want_b - cosine * want_a) / safe
    rest = 1 - (x * want_a + y * want_b)
    # no real root: no common tangent plane exists; parallel axes have no cross product
    k = np.flatnonzero((rest > NO_DIRECTION) & (square > NO_DIRECTION))
    a, b, limits = a.take(k), b.take(k), limits.take(k)
    level = x[k, None] * a.axis + y[k, None] * b.axis
    upright = np.sqrt(rest[k] / square[k])[:, None] * third[k]
    blocks: list[Candidates] = []
    for m in (level + upright, level - upright):
        foot_a, line_a = _generator(a, m)
        foot_b, line_b = _generator(b, -m)
        gap = dot(foot_b - foot_a, m)
        bottom = dot(cross(line_a, line_b), m)
        crossing = np.abs(bottom) > np.sin(limits.angle)
        t = dot(cross(foot_b - foot_a, line_b), m) / np.where(crossing, bottom, 1.0)
        at = foot_a + t[:, None] * line_a + (gap / 2)[:, None] * m
        bend = np.maximum(a.radius, b.radius) / np.maximum(np.abs(bottom), GENERATOR_SINE)
        block = make_candidates(POINT, at, m, gap, bend=bend).take(crossing)
        blocks.append(replace(block, row=k[block.row]))
    return Candidates.join(blocks)


def _generator(a: Side, m: Array) -> tuple[Array, Array]:
    """A point and the direction of the straight line on a cylinder or cone with the normal m."""
    cone, alpha = (a.kind == CONE)[:, None], a.half_angle[:, None]
    out = unit_rows(without_along(m, a.axis))
    side = np.cos(alpha) * a.axis + np.sin(alpha) * out
    return a.point + np.where(cone, 0.0, a.radius[:, None] * m), np.where(cone, side, a.axis)


def _face_on_torus(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of faces a with solid tori b, with normals from a to b."""
    candidates = torus_on_face(b, a, limits)
    # the normal of a circle has its components away from the axis and along it
    return replace(candidates, normal=-candidates.normal)


def _torus_on_cylinder(a: Side, b: Side, limits: FormLimits) -> Candidates:
    """Candidate contacts of tori with cylinders: fits about a common axis, else the nearest point.

    The torus surrounds a shaft and touches it with its inner side, or lies in a bore. Circles lead
    from the cylinder to the torus.
    """
    off = _length(without_along(b.point - a.point, a.axis))
    side = np.where(a.hollow, 1.0, -1.0)
    radius = b.radius + side * b.tube
    play = side * (a.radius - radius)
    fit = limits.fits(play, a.radius) & (off <= play + limits.gap)
    wider = np.where(fit, play, 0.0)
    share = np.where(fit, 1 - limits.share, 0.0)[:, None]
    circles = make_candidates(
        CIRCLE,
        b.point + share * without_along(a.point - b.point, b.axis),
        -side[:, None] * [1.0, 0.0, 0.0],
        play,
        along=b.axis,
        radius=radius + side * wider / 2,
        swing=off,
        play=wider,
        bend=b.tube,
    )
    level = _length(cross(a.axis, b.axis)) <= np.sin(limits.angle)
    coaxial = level & (fit | (off <= limits.gap))
    nearest = _face_on_torus(a, b, limits)
    return Candidates.join([circles.take(coaxial), nearest.take(~coaxial[nearest.row])])


_KERNELS: dict[tuple[int, int, str], Kernel] = {
    (SPHERE, SPHERE, "on"): _sphere_sphere,
    (SPHERE, SPHERE, "in"): _round_in_round,
    (SPHERE, CYLINDER, "on"): _sphere_cylinder,
    (SPHERE, CYLINDER, "in"): _sphere_in_cylinder,
    (SPHERE, CONE, "on"): _sphere_cone,
    (SPHERE, CONE, "in"): _sphere_in_cone,
    (SPHERE, TORUS, "on"): _sphere_torus,
    (SPHERE, TORUS, "in"): _sphere_in_torus,
    (CYLINDER, CYLINDER, "on"): _cylinder_cylinder,
    (CYLINDER, CYLINDER, "in"): _cylinder_in_cylinder,
    (CYLINDER, CONE, "on"): _generators,
    (CYLINDER, CONE, "in"): lines_on_cone,
    (CONE, CONE, "on"): _generators,
    (CONE, CONE, "in"): _cone_in_wider_cone,
    (CYLINDER, TORUS, "on"): _torus_on_cylinder,
    (CYLINDER, TORUS, "in"): body_in_torus,
    (CYLINDER, TORUS, "around"): _torus_on_cylinder,
    (SPHERE, TORUS, "around"): _face_on_torus,
    (CONE, TORUS, "on"): _face_on_torus,
    (CONE, TORUS, "in"): body_in_torus,
    (CONE, TORUS, "around"): _face_on_torus,
    (TORUS, TORUS, "on"): torus_on_face,
    (TORUS, TORUS, "in"): torus_on_face,
}
