"""Where two exact surfaces touch: in a point, along a line, around a circle, everywhere.

Each kernel takes many pairs of surfaces (i, j) of two kinds and gives candidates: position,
unit normal n from i to j, and the gap there, whatever their faces cover
(`kilter.contact.curved.coverage` asks that). Solid against solid touches from outside;
solid in hollow from inside, where the solid bends more than the hollow.
With cores (the centre of a sphere, the axis of a cylinder, the circle of a torus)
at the distance D and radii r:

    solid on solid   gap = D - r_i - r_j          solid in hollow   gap = r_j - r_i - D

Cylinders and cones are swept by planes: a plane with normal m touches a cylinder of axis d
where m.d = 0, a cone of axis a and half angle alpha where m.a = -sin(alpha), each along a
generator; two of them touch where their generators of one plane cross.
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
    Allowed,
    Forms,
    dot,
    make_forms,
    without_along,
)  # fmt: skip

__all__ = ["meeting"]


def _inverse(one: Array, other: Array, sign: float) -> Array:
    """1 / (1/one + sign/other), the radius by which two curves part."""
    curvature = 1 / np.maximum(one, TINY) + sign / np.maximum(other, TINY)
    result: Array = 1 / np.maximum(curvature, NO_DIRECTION / np.maximum(one, TINY))
    return result


Kernel = Callable[[Surfaces, Index, Index, Index, Allowed], Forms]


def meeting(s: Surfaces, i: Index, j: Index, allowed: Allowed, held: Mask) -> tuple[Forms, Mask]:
    """Where surfaces `i` and `j` touch, and which pairs no kernel speaks of.

    Parameters
    ----------
    i, j : ndarray of int, shape (n,)
    allowed : Allowed
        Of each pair; its `share` is filled in here.
    held : ndarray of bool, shape (N,)
        Parts that stay where they are when a clearance closes: the fit is made where the other
        part is, else where the shaft is, so that its own weight does not turn it.

    Returns
    -------
    forms : Forms
        Normals from i to j.
    unknown : ndarray of bool, shape (n,)
    """
    swap = (s.kind[i] > s.kind[j]) | ((s.kind[i] == s.kind[j]) & s.hollow[i])
    first, second = np.where(swap, j, i), np.where(swap, i, j)
    unknown = (s.kind[i] == FREE) | (s.kind[j] == FREE)
    inside = s.hollow[second] & ~s.hollow[first]
    outside = ~s.hollow[second] & ~s.hollow[first]
    socket = s.hollow[first] & ~s.hollow[second]
    stays = held[s.part[first]].astype(int) - held[s.part[second]]
    share = np.where(stays == 0, s.hollow[first] & ~s.hollow[second], stays > 0)
    allowed = replace(allowed, share=share.astype(np.float64))
    found: list[Forms] = []
    rows = np.arange(len(i))
    for (one, other, which), kernel in _KERNELS.items():
        k = (s.kind[first] == one) & (s.kind[second] == other)
        k &= {"on": outside, "in": inside, "around": socket}[which]
        chosen = np.flatnonzero(k)
        if len(chosen):
            mine = allowed.take(chosen)
            found.append(kernel(s, rows[chosen], first[chosen], second[chosen], mine))
    unknown |= _unmodelled(s, first, second, inside, outside, socket)
    forms = Forms.join(found)
    unknown[forms.row] = False  # a kernel spoke of them
    turned = swap[forms.row][:, None]
    return replace(forms, normal=np.where(turned, -forms.normal, forms.normal)), unknown


def _unmodelled(s: Surfaces, i: Index, j: Index, inside: Mask, outside: Mask, socket: Mask) -> Mask:
    """Pairs that may touch in ways without a kernel, besides those with one."""
    one, other = s.kind[i], s.kind[j]
    torus = (other == TORUS) & (one != SPHERE) & ~(s.hollow[i] & s.hollow[j])
    cone = (other == CONE) & inside & (one != SPHERE)  # a cone leans in a wider one
    unmodelled: Mask = torus | cone | ((other == TORUS) & socket)
    return unmodelled


def _round_in_round(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    """Sphere in hollow sphere."""
    apart = s.point[i] - s.point[j]
    play = s.radius[j] - s.radius[i]
    off = np.linalg.norm(apart, axis=1)
    same = np.abs(play) <= allowed.gap
    away = unit_rows(apart)
    k, m = np.flatnonzero(same), np.flatnonzero(~same & (play > 0))
    everywhere = make_forms(
        row[k], SAME, s.point[i[k]], away[k], play[k], swing=off[k], bend=s.radius[i[k]]
    )
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * away
    bend = _inverse(s.radius[i], s.radius[j], -1.0)
    point = make_forms(row[m], POINT, at[m], away[m], (play - off)[m], bend=bend[m])
    f = np.flatnonzero(allowed.fits(play, s.radius[i]))
    fits = make_forms(
        row[f], SAME, (s.point[i] - allowed.share[:, None] * apart)[f], away[f], play[f],
        swing=off[f], play=play[f], bend=s.radius[i[f]],
    )  # fmt: skip
    tight = np.flatnonzero(~same & (play <= 0))
    pressed = make_forms(
        row[tight], SAME, s.point[i[tight]], away[tight], play[tight], swing=off[tight]
    )
    return Forms.join([everywhere, fits, point, pressed])


def _sphere_sphere(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    apart = s.point[j] - s.point[i]
    return _outer(s, row, i, apart, s.radius[j])


def _outer(s: Surfaces, row: Index, i: Index, apart: Array, other: Array) -> Forms:
    """Sphere i beside a round body whose core is `apart` from its centre."""
    normal = unit_rows(apart)
    open_ = np.linalg.norm(apart, axis=1) - s.radius[i] - other
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    return make_forms(row, POINT, at, normal, open_, bend=s.radius[i])


def _sphere_cylinder(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    apart = -without_along(s.point[i] - s.point[j], s.axis[j])
    return _outer(s, row, i, apart, s.radius[j])


def _sphere_in_cylinder(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    apart = without_along(s.point[i] - s.point[j], s.axis[j])
    play, off = s.radius[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    circle = _ring(s, row, i, allowed, (apart, s.axis[j]), play)
    m = np.flatnonzero(play > allowed.gap)
    away = unit_rows(apart)
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * away
    bend = np.maximum(_inverse(s.radius[i], s.radius[j], -1.0), s.radius[i])
    return Forms.join(
        [circle, make_forms(row[m], POINT, at[m], away[m], (play - off)[m], bend=bend[m])]
    )


def _ring(
    s: Surfaces, row: Index, i: Index, allowed: Allowed, tube: tuple[Array, Array], play: Array
) -> Forms:
    """Spheres that fill a tube: `apart` of its line, and the direction of that (`tube`)."""
    apart, along = tube
    fit = allowed.fits(play, s.radius[i])
    k = np.flatnonzero((np.abs(play) <= allowed.gap) | fit)
    wider = np.where(fit, play, 0.0)[k]
    flat = np.tile([1.0, 0.0, 0.0], (len(k), 1))
    at = s.point[i[k]] - np.where(fit, allowed.share, 0.0)[k, None] * apart[k]
    return make_forms(
        row[k], CIRCLE, at, flat, play[k], along=along[k], radius=s.radius[i[k]] + wider / 2,
        swing=np.linalg.norm(apart, axis=1)[k], play=wider, bend=s.radius[i[k]],
    )  # fmt: skip


def _sphere_cone(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    _, _, away = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    normal = -(np.cos(alpha)[:, None] * away - np.sin(alpha)[:, None] * s.axis[j])
    open_ = s.distance(j, s.point[i]) - s.radius[i]
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    return make_forms(row, POINT, at, normal, open_, bend=s.radius[i])


def _sphere_in_cone(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    cosine, sine = np.cos(alpha), np.sin(alpha)
    open_ = s.distance(j, s.point[i]) - s.radius[i]
    mean = height * sine - s.radius[i]
    closes = (rho > allowed.gap) & (np.maximum(rho, mean) <= allowed.closed) & (mean > allowed.gap)
    k, m = (np.flatnonzero(x) for x in ((rho <= allowed.gap) | closes, rho > allowed.gap))
    normal = cosine[:, None] * away - sine[:, None] * s.axis[j]
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    around = s.point[i] - (s.radius[i] * sine)[:, None] * s.axis[j]
    around -= np.where(closes, allowed.share * rho, 0.0)[:, None] * away
    play = np.where(closes, mean, 0.0)
    circle = make_forms(
        row[k], CIRCLE, around[k], np.column_stack([cosine, -sine, 0 * sine])[k], mean[k],
        along=s.axis[j[k]], radius=(s.radius[i] * cosine + play / 2)[k], swing=(rho * cosine)[k],
        play=play[k], bend=s.radius[i[k]],
    )  # fmt: skip
    bend = 10 * s.radius[i]
    return Forms.join([circle, make_forms(row[m], POINT, at[m], normal[m], open_[m], bend=bend[m])])


def _sphere_torus(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    axis, radius = s.axis[j], s.radius[j]
    centred = rho <= allowed.gap
    k, m = np.flatnonzero(centred), np.flatnonzero(~centred)
    apart = (radius - rho)[:, None] * away - height[:, None] * axis
    point = _outer(s, row, i, apart, s.tube[j]).take(m)
    core = np.hypot(radius, height)
    out, down = radius / core, -height / core
    circle = make_forms(
        row[k], CIRCLE, (s.point[i] + (s.radius[i] * down)[:, None] * axis)[k],
        np.column_stack([out, down, 0 * out])[k], (core - s.tube[j] - s.radius[i])[k],
        along=axis[k], radius=(s.radius[i] * out)[k], swing=rho[k], bend=s.radius[i[k]],
    )  # fmt: skip
    return Forms.join([circle, point])


def _sphere_in_torus(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    apart = (rho - s.radius[j])[:, None] * away + height[:, None] * s.axis[j]
    play, off = s.tube[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    circle = _ring(s, row, i, allowed, (apart, cross(s.axis[j], away)), play)
    m = np.flatnonzero(play > allowed.gap)
    normal = unit_rows(apart)
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * normal
    bend = np.maximum(_inverse(s.radius[i], s.tube[j], -1.0), 10 * s.radius[i])
    point = make_forms(row[m], POINT, at[m], normal[m], (play - off)[m], bend=bend[m])
    return Forms.join([circle, point])


def _cylinder_cylinder(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    level = sine <= np.sin(allowed.angle)
    k, m = np.flatnonzero(level), np.flatnonzero(~level)
    along, at, apart, slope = _parallel(s, i[k], j[k])
    normal = unit_rows(apart)
    open_ = np.linalg.norm(apart, axis=1) - s.radius[i[k]] - s.radius[j[k]]
    at = at + (s.radius[i[k]] + open_ / 2)[:, None] * normal
    bend = _inverse(s.radius[i[k]], s.radius[j[k]], 1.0)
    line = make_forms(
        row[k], LINE, at, normal, open_, along=along, slope=dot(slope, normal), bend=bend
    )
    return Forms.join([line, _swept(s, row[m], i[m], j[m], allowed.take(m))])


def _parallel(s: Surfaces, i: Index, j: Index) -> tuple[Array, Array, Array, Array]:
    """Mean direction of nearly parallel axes, a point on i's, from there to j's, its change."""
    turn = np.where(dot(s.axis[i], s.axis[j]) < 0, -1.0, 1.0)[:, None]
    other = turn * s.axis[j]
    along = unit_rows(s.axis[i] + other)
    # nearest points across the common direction, beside the point of i
    at = s.point[i]
    to = s.point[j] + (dot(at - s.point[j], along) / dot(other, along))[:, None] * other
    change = other / dot(other, along)[:, None] - s.axis[i] / dot(s.axis[i], along)[:, None]
    return along, at, to - at, change


def _cylinder_in_cylinder(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    play = s.radius[j] - s.radius[i]
    level = sine <= np.sin(allowed.angle)
    along, at, apart, slope = _parallel(s, i, j)
    off = np.linalg.norm(apart, axis=1)
    same = level & (play <= allowed.gap)
    # a shaft may lean in its hole by its play over the length of that, which the caller asks
    fit = allowed.fits(play, s.radius[i])
    fit &= sine <= np.sin(allowed.angle) + 2 * ratio(np.maximum(play, 0), s.radius[i])
    k, m = np.flatnonzero(same | fit), np.flatnonzero(level & ~same)
    normal = -unit_rows(apart)
    # the gap varies around and along: the caller asks both ends
    everywhere = make_forms(
        row[k], SAME, at[k], normal[k], play[k],
        along=along[k], radius=s.radius[i[k]], slope=sine[k], swing=off[k],
        play=np.where(fit, play, 0.0)[k], bend=s.radius[i[k]],
    )  # fmt: skip
    # axes that are one leave a gap all around: any direction shows it
    normal = np.where((off > NO_DIRECTION * s.radius[i])[:, None], normal, across(along)[0])
    open_ = play - off
    at = at + (s.radius[i] + open_ / 2)[:, None] * normal
    bend = _inverse(s.radius[i], s.radius[j], -1.0)
    line = make_forms(
        row[m], LINE, at[m], normal[m], open_[m],
        along=along[m], slope=dot(slope, normal)[m], bend=bend[m],
    )  # fmt: skip
    return Forms.join([everywhere, line])


def _cone_in_cone(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    """Tapers: the gap across their sides where the axes are one."""
    turned = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    alike = (turned <= np.sin(allowed.angle)) & (dot(s.axis[i], s.axis[j]) > 0)
    alike &= np.abs(s.half_angle[i] - s.half_angle[j]) <= allowed.angle
    k = np.flatnonzero(alike)
    row, i, j, allowed = row[k], i[k], j[k], allowed.take(k)
    axis = unit_rows(s.axis[i] + s.axis[j])
    alpha = (s.half_angle[i] + s.half_angle[j]) / 2
    shift = s.point[i] - s.point[j]
    lift = dot(shift, axis) * np.sin(alpha)
    off = np.linalg.norm(without_along(shift, axis), axis=1) * np.cos(alpha)
    slope = s.half_angle[j] - s.half_angle[i]
    closes = (lift > allowed.gap) & (lift <= allowed.closed)
    return make_forms(
        row, SAME, s.point[i], np.zeros((len(row), 3)), lift, along=axis, slope=slope, swing=off,
        play=np.where(closes, lift, 0.0), bend=np.maximum(s.radius[i], allowed.gap),
    )  # fmt: skip


def _swept(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
    """Cylinders and cones side by side: both common planes between them."""
    found: list[Forms] = []
    ai, aj = s.axis[i], s.axis[j]
    want_i = np.where(s.kind[i] == CONE, -np.sin(s.half_angle[i]), 0.0)
    want_j = np.where(s.kind[j] == CONE, np.sin(s.half_angle[j]), 0.0)
    third = cross(ai, aj)
    cosine, square = dot(ai, aj), dot(third, third)
    safe = np.maximum(square, TINY)
    x, y = (want_i - cosine * want_j) / safe, (want_j - cosine * want_i) / safe
    rest = 1 - (x * want_i + y * want_j)
    for turn in (1.0, -1.0):
        k = np.flatnonzero((rest > NO_DIRECTION) & (square > NO_DIRECTION))
        z = turn * np.sqrt(rest[k] / square[k])
        m = x[k, None] * ai[k] + y[k, None] * aj[k] + z[:, None] * third[k]
        foot_i, line_i = _generator(s, i[k], m)
        foot_j, line_j = _generator(s, j[k], -m)
        open_ = dot(foot_j - foot_i, m)
        bottom = dot(cross(line_i, line_j), m)
        crossing = np.abs(bottom) > np.sin(allowed.angle[k])
        t = dot(cross(foot_j - foot_i, line_j), m) / np.where(crossing, bottom, 1.0)
        at = foot_i + t[:, None] * line_i + (open_ / 2)[:, None] * m
        bend = np.maximum(s.radius[i[k]], s.radius[j[k]]) / np.maximum(
            np.abs(bottom), GENERATOR_SINE
        )
        made = make_forms(row[k], POINT, at, m, open_, bend=bend)
        found.append(made.take(np.flatnonzero(crossing)))
    return Forms.join(found)


def _generator(s: Surfaces, i: Index, m: Array) -> tuple[Array, Array]:
    """A point and the direction of the generator of a cylinder or cone with outward normal m."""
    axis, alpha = s.axis[i], s.half_angle[i]
    cone = (s.kind[i] == CONE)[:, None]
    out = unit_rows(without_along(m, axis))
    foot = np.where(cone, s.point[i], s.point[i] + s.radius[i][:, None] * m)
    side = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    return foot, np.where(cone, side, axis)


def _torus_on_axis(inner: bool) -> Kernel:
    """A torus about a shaft, or in a bore, of the same axis."""

    def kernel(s: Surfaces, row: Index, i: Index, j: Index, allowed: Allowed) -> Forms:
        turned = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
        off = np.linalg.norm(without_along(s.point[j] - s.point[i], s.axis[i]), axis=1)
        side = -1.0 if inner else 1.0
        radius = s.radius[j] + side * s.tube[j]
        play = side * (s.radius[i] - radius)
        fit = allowed.fits(play, s.radius[i]) & (off <= play + allowed.gap)
        k = np.flatnonzero((turned <= np.sin(allowed.angle)) & (fit | (off <= allowed.gap)))
        row, i, j, wider = row[k], i[k], j[k], np.where(fit, play, 0.0)[k]
        share = np.where(fit, 1 - allowed.share, 0.0)[k, None]
        flat = np.tile([-side, 0.0, 0.0], (len(k), 1))  # from the cylinder to the torus
        apart = without_along(s.point[i] - s.point[j], s.axis[j])
        return make_forms(
            row, CIRCLE, s.point[j] + share * apart, flat, play[k],
            along=s.axis[j], radius=radius[k] + side * wider / 2, swing=off[k], play=wider,
            bend=s.tube[j],
        )  # fmt: skip

    return kernel


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
    (CYLINDER, CONE, "on"): _swept,
    (CONE, CONE, "on"): _swept,
    (CONE, CONE, "in"): _cone_in_cone,
    (CYLINDER, TORUS, "on"): _torus_on_axis(True),
    (CYLINDER, TORUS, "around"): _torus_on_axis(False),
}
