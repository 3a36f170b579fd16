"""Where two exact surfaces touch: in a point, along a line, around a circle, everywhere.

Each kernel takes many pairs of surfaces (i, j) of two kinds and gives candidates: position,
unit normal n from i to j, and the gap there, whatever their faces cover (`kilter.contact.trim`
asks that). Solid against solid touches from outside; solid in hollow from inside, where the
solid bends more than the hollow. With cores (the centre of a sphere, the axis of a cylinder,
the circle of a torus) at the distance D and radii r:

    solid on solid   gap = D - r_i - r_j          solid in hollow   gap = r_j - r_i - D

Cylinders and cones are swept by planes: a plane with normal m touches a cylinder of axis d
where m.d = 0, a cone of axis a and half angle alpha where m.a = -sin(alpha), each along a
generator; two of them touch where their generators of one plane cross.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.contact.trim import frame_of
from kilter.rigid import cross
from kilter.surfaces import CONE, CYLINDER, FREE, SPHERE, TORUS, Surfaces

__all__ = ["CIRCLE", "LINE", "POINT", "SAME", "Forms", "Planes", "meeting", "on_planes"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME: one surface in its own counterpart."""
LEVEL = 1e-12
"""Directions closer than this to one another have no direction across [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Forms:
    """Candidate contacts, one row each.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Row of the pair of surfaces.
    form : ndarray of int, shape (n,)
        POINT, LINE, CIRCLE or SAME.
    at : ndarray, shape (n, 3)
        The point; a point of the line; the centre of the circle, half-way in the gap.
    along : ndarray, shape (n, 3)
        Direction of the line, axis of the circle.
    normal : ndarray, shape (n, 3)
        Unit, from i to j. Of a circle: its components away from the axis and along it.
    radius : ndarray, shape (n,)
        Of the circle [length unit].
    gap, slope, swing : ndarray, shape (n,)
        The gap at `at`; its rise along a line [-]; how much it varies about its mean
        around a circle [length unit].
    bend : ndarray, shape (n,)
        Radius by which the gap opens beside the contact [length unit].
    """

    row: Index
    form: Index
    at: Array
    along: Array
    normal: Array
    radius: Array
    gap: Array
    slope: Array
    swing: Array
    bend: Array

    def take(self, rows: Index | Mask) -> Forms:
        """The rows chosen."""
        return Forms(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """Flat faces: unit outward normals and a point of each, shape (n, 3)."""

    normal: Array
    origin: Array


def _forms(row: Index, form: int, at: Array, normal: Array, gap: Array, **more: Array) -> Forms:
    count = len(row)
    zero, none = np.zeros(count), np.zeros((count, 3))
    return Forms(
        row=row,
        form=np.full(count, form),
        at=at,
        along=more.get("along", none),
        normal=normal,
        radius=more.get("radius", zero),
        gap=gap,
        slope=more.get("slope", zero),
        swing=more.get("swing", zero),
        bend=more.get("bend", zero),
    )


def _together(found: list[Forms]) -> Forms:
    return Forms(*(np.concatenate([getattr(f, name) for f in found]) for name in Forms.__slots__))


def _dot(a: Array, b: Array) -> Array:
    result: Array = np.einsum("ij,ij->i", a, b)
    return result


def _unit(v: Array) -> Array:
    result: Array = v / np.maximum(np.linalg.norm(v, axis=1), 1e-300)[:, None]
    return result


def _across(v: Array, axis: Array) -> Array:
    """The part of vectors across an axis."""
    result: Array = v - _dot(v, axis)[:, None] * axis
    return result


def _inverse(one: Array, other: Array, sign: float) -> Array:
    """1 / (1/one + sign/other), the radius by which two curves part."""
    curvature = 1 / np.maximum(one, 1e-300) + sign / np.maximum(other, 1e-300)
    result: Array = 1 / np.maximum(curvature, 1e-12 / np.maximum(one, 1e-300))
    return result


# on a plane ---------------------------------------------------------------------------


def on_planes(s: Surfaces, i: Index, planes: Planes, angle: Array) -> Forms:
    """Where solid surfaces `i`, shape (n,), touch planes, shape (n,); `angle`: tolerance."""
    rows = np.arange(len(i))
    found = [_none()]
    for kind, kernel in (
        (SPHERE, _sphere_plane),
        (CYLINDER, _cylinder_plane),
        (CONE, _cone_plane),
        (TORUS, _torus_plane),
    ):
        k = np.flatnonzero((s.kind[i] == kind) & ~s.hollow[i])
        if len(k):
            n, o = planes.normal[k], planes.origin[k]
            found.append(kernel(s, rows[k], i[k], n, o, angle[k]))
    return _together(found)


def _none() -> Forms:
    empty = np.empty(0)
    return _forms(np.empty(0, np.int64), POINT, np.empty((0, 3)), np.empty((0, 3)), empty)


def _sphere_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Forms:
    r = s.radius[i]
    gap = _dot(s.point[i] - o, n) - r
    at = s.point[i] - (r + gap / 2)[:, None] * n
    return _forms(row, POINT, at, -n, gap, bend=r)


def _cylinder_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Forms:
    slope = _dot(s.axis[i], n)
    k = np.flatnonzero(np.abs(slope) <= np.sin(angle))
    row, i, n, o, slope = row[k], i[k], n[k], o[k], slope[k]
    r, axis = s.radius[i], s.axis[i]
    normal = -_unit(n + _unit(_across(n, axis)))
    along = _unit(_across(axis, normal))
    gap = _dot(s.point[i] - o, n) - r
    at = s.point[i] + (r + gap / 2)[:, None] * normal
    return _forms(row, LINE, at, normal, gap, along=along, slope=slope, bend=r)


def _cone_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Forms:
    lift, alpha = _dot(s.axis[i], n), s.half_angle[i]
    k = np.flatnonzero(np.abs(np.arcsin(np.clip(lift, -1, 1)) - alpha) <= angle)
    row, i, n, o, alpha = row[k], i[k], n[k], o[k], alpha[k]
    axis = s.axis[i]
    out = -_unit(_across(n, axis))
    side = np.cos(alpha)[:, None] * out - np.sin(alpha)[:, None] * axis
    normal = _unit(side - n)
    generator = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    gap, slope = _dot(s.point[i] - o, n), _dot(generator, n)
    at = s.point[i] + (gap / 2)[:, None] * normal
    along = _unit(_across(generator, normal))
    return _forms(row, LINE, at, normal, gap, along=along, slope=slope, bend=s.radius[i])


def _torus_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Forms:
    center, axis, radius, tube = s.point[i], s.axis[i], s.radius[i], s.tube[i]
    aside = _across(n, axis)
    sine = np.linalg.norm(aside, axis=1)
    upright = sine <= np.sin(angle)
    k = np.flatnonzero(upright)
    gap = _dot(center - o, n) - tube
    at = center - (tube + gap / 2)[:, None] * n
    flat = np.tile([0.0, -1.0, 0.0], (len(k), 1))
    circle = _forms(
        row[k], CIRCLE, at[k], flat, gap[k],
        along=n[k], radius=radius[k], swing=(radius * sine)[k], bend=tube[k],
    )  # fmt: skip
    k = np.flatnonzero(~upright)
    lowest = center[k] - radius[k][:, None] * _unit(aside[k])
    gap = _dot(lowest - o[k], n[k]) - tube[k]
    at = lowest - (tube[k] + gap / 2)[:, None] * n[k]
    bend = tube[k] + radius[k] / sine[k]
    return _together([circle, _forms(row[k], POINT, at, -n[k], gap, bend=bend)])


# on each other ------------------------------------------------------------------------

Kernel = Callable[[Surfaces, Index, Index, Index, Array, Array], Forms]


def meeting(
    s: Surfaces, i: Index, j: Index, gap: Array, angle: Array
) -> tuple[Forms, Mask]:
    """Where surfaces `i` and `j` touch, and which pairs no kernel speaks of.

    Parameters
    ----------
    i, j : ndarray of int, shape (n,)
    gap, angle : ndarray, shape (n,)
        Tolerances [length unit, rad]: when two surfaces count as one, lines as parallel.

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
    found = [_none()]
    rows = np.arange(len(i))
    for (one, other, which), kernel in _KERNELS.items():
        k = (s.kind[first] == one) & (s.kind[second] == other)
        k &= {"on": outside, "in": inside, "around": socket}[which]
        chosen = np.flatnonzero(k)
        if len(chosen):
            found.append(
                kernel(s, rows[chosen], first[chosen], second[chosen], gap[chosen], angle[chosen])
            )
    unknown |= _unmodelled(s, first, second, inside, outside, socket)
    forms = _together(found)
    turned = swap[forms.row][:, None]
    return _with_normal(forms, np.where(turned, -forms.normal, forms.normal)), unknown


def _with_normal(forms: Forms, normal: Array) -> Forms:
    values = {name: getattr(forms, name) for name in Forms.__slots__}
    return Forms(**{**values, "normal": normal})


def _unmodelled(
    s: Surfaces, i: Index, j: Index, inside: Mask, outside: Mask, socket: Mask
) -> Mask:
    """Pairs that may touch in ways without a kernel, besides those with one."""
    one, other = s.kind[i], s.kind[j]
    torus = (other == TORUS) & (one != SPHERE) & ~(s.hollow[i] & s.hollow[j])
    cone = (other == CONE) & inside & (one != SPHERE)  # a cone leans in a wider one
    return torus | cone | ((other == TORUS) & socket)


def _round_in_round(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    """Sphere in hollow sphere."""
    apart = s.point[i] - s.point[j]
    return _nested(s, row, i, j, apart, gap)


def _nested(s: Surfaces, row: Index, i: Index, j: Index, apart: Array, gap: Array) -> Forms:
    """Sphere in sphere: `apart` from the core of j to that of i."""
    play = s.radius[j] - s.radius[i]
    off = np.linalg.norm(apart, axis=1)
    same = np.abs(play) <= gap
    away = _unit(apart)
    k, m = np.flatnonzero(same), np.flatnonzero(~same & (play > 0))
    everywhere = _forms(
        row[k], SAME, s.point[i[k]], away[k], play[k], swing=off[k], bend=s.radius[i[k]]
    )
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * away
    bend = _inverse(s.radius[i], s.radius[j], -1.0)
    point = _forms(row[m], POINT, at[m], away[m], (play - off)[m], bend=bend[m])
    tight = np.flatnonzero(~same & (play <= 0))
    pressed = _forms(
        row[tight], SAME, s.point[i[tight]], away[tight], play[tight], swing=off[tight]
    )
    return _together([everywhere, point, pressed])


def _sphere_sphere(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    apart = s.point[j] - s.point[i]
    return _outer(s, row, i, apart, s.radius[j])


def _outer(s: Surfaces, row: Index, i: Index, apart: Array, other: Array) -> Forms:
    """Sphere i beside a round body whose core is `apart` from its centre."""
    normal = _unit(apart)
    open_ = np.linalg.norm(apart, axis=1) - s.radius[i] - other
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    return _forms(row, POINT, at, normal, open_, bend=s.radius[i])


def _sphere_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    apart = -_across(s.point[i] - s.point[j], s.axis[j])
    return _outer(s, row, i, apart, s.radius[j])


def _sphere_in_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    apart = _across(s.point[i] - s.point[j], s.axis[j])
    play, off = s.radius[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    ring = np.abs(play) <= gap
    k, m = np.flatnonzero(ring), np.flatnonzero(~ring & (play > 0))
    away = _unit(apart)
    flat = np.tile([1.0, 0.0, 0.0], (len(k), 1))
    circle = _forms(
        row[k], CIRCLE, s.point[i[k]], flat, play[k],
        along=s.axis[j[k]], radius=s.radius[i[k]], swing=off[k], bend=s.radius[i[k]],
    )  # fmt: skip
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * away
    bend = np.maximum(_inverse(s.radius[i], s.radius[j], -1.0), s.radius[i])
    return _together([circle, _forms(row[m], POINT, at[m], away[m], (play - off)[m], bend=bend[m])])


def _sphere_cone(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array) -> Forms:
    _, _, away = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    normal = -(np.cos(alpha)[:, None] * away - np.sin(alpha)[:, None] * s.axis[j])
    open_ = s.distance(j, s.point[i]) - s.radius[i]
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    return _forms(row, POINT, at, normal, open_, bend=s.radius[i])


def _sphere_in_cone(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    open_ = s.distance(j, s.point[i]) - s.radius[i]
    centred = rho <= gap
    k, m = np.flatnonzero(centred), np.flatnonzero(~centred)
    cosine, sine = np.cos(alpha), np.sin(alpha)
    normal = cosine[:, None] * away - sine[:, None] * s.axis[j]
    at = s.point[i] + (s.radius[i] + open_ / 2)[:, None] * normal
    around = s.point[i] - (s.radius[i] * sine)[:, None] * s.axis[j]
    circle = _forms(
        row[k], CIRCLE, around[k], np.column_stack([cosine, -sine, 0 * sine])[k],
        (height * sine - s.radius[i])[k], along=s.axis[j[k]],
        radius=(s.radius[i] * cosine)[k], swing=(rho * cosine)[k], bend=s.radius[i[k]],
    )  # fmt: skip
    bend = 10 * s.radius[i]
    return _together([circle, _forms(row[m], POINT, at[m], normal[m], open_[m], bend=bend[m])])


def _sphere_torus(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    axis, radius = s.axis[j], s.radius[j]
    centred = rho <= gap
    k, m = np.flatnonzero(centred), np.flatnonzero(~centred)
    apart = (radius - rho)[:, None] * away - height[:, None] * axis
    point = _outer(s, row, i, apart, s.tube[j]).take(m)
    core = np.hypot(radius, height)
    out, down = radius / core, -height / core
    circle = _forms(
        row[k], CIRCLE, (s.point[i] + (s.radius[i] * down)[:, None] * axis)[k],
        np.column_stack([out, down, 0 * out])[k], (core - s.tube[j] - s.radius[i])[k],
        along=axis[k], radius=(s.radius[i] * out)[k], swing=rho[k], bend=s.radius[i[k]],
    )  # fmt: skip
    return _together([circle, point])


def _sphere_in_torus(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    height, rho, away = s.polar(j, s.point[i])
    apart = (rho - s.radius[j])[:, None] * away + height[:, None] * s.axis[j]
    play, off = s.tube[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    ring = np.abs(play) <= gap
    k, m = np.flatnonzero(ring), np.flatnonzero(~ring & (play > 0))
    normal = _unit(apart)
    flat = np.tile([1.0, 0.0, 0.0], (len(k), 1))
    circle = _forms(
        row[k], CIRCLE, s.point[i[k]], flat, play[k],
        along=cross(s.axis[j], away)[k], radius=s.radius[i[k]], swing=off[k], bend=s.radius[i[k]],
    )  # fmt: skip
    at = s.point[i] + (s.radius[i] + (play - off) / 2)[:, None] * normal
    bend = np.maximum(_inverse(s.radius[i], s.tube[j], -1.0), 10 * s.radius[i])
    point = _forms(row[m], POINT, at[m], normal[m], (play - off)[m], bend=bend[m])
    return _together([circle, point])


def _cylinder_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    level = sine <= np.sin(angle)
    k, m = np.flatnonzero(level), np.flatnonzero(~level)
    along, at, apart, slope = _parallel(s, i[k], j[k])
    normal = _unit(apart)
    open_ = np.linalg.norm(apart, axis=1) - s.radius[i[k]] - s.radius[j[k]]
    at = at + (s.radius[i[k]] + open_ / 2)[:, None] * normal
    bend = _inverse(s.radius[i[k]], s.radius[j[k]], 1.0)
    line = _forms(
        row[k], LINE, at, normal, open_, along=along, slope=_dot(slope, normal), bend=bend
    )
    return _together([line, _swept(s, row[m], i[m], j[m], gap[m], angle[m])])


def _parallel(s: Surfaces, i: Index, j: Index) -> tuple[Array, Array, Array, Array]:
    """Mean direction of nearly parallel axes, a point on i's, from there to j's, its change."""
    turn = np.where(_dot(s.axis[i], s.axis[j]) < 0, -1.0, 1.0)[:, None]
    other = turn * s.axis[j]
    along = _unit(s.axis[i] + other)
    # nearest points across the common direction, beside the point of i
    at = s.point[i]
    to = s.point[j] + (_dot(at - s.point[j], along) / _dot(other, along))[:, None] * other
    change = other / _dot(other, along)[:, None] - s.axis[i] / _dot(s.axis[i], along)[:, None]
    return along, at, to - at, change


def _cylinder_in_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array
) -> Forms:
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    play = s.radius[j] - s.radius[i]
    level = sine <= np.sin(angle)
    along, at, apart, slope = _parallel(s, i, j)
    off = np.linalg.norm(apart, axis=1)
    same = level & (play <= gap)
    k, m = np.flatnonzero(same), np.flatnonzero(level & ~same)
    normal = -_unit(apart)
    # the gap varies around and along: the caller asks both ends
    everywhere = _forms(
        row[k], SAME, at[k], normal[k], play[k],
        along=along[k], radius=s.radius[i[k]], slope=sine[k], swing=off[k], bend=s.radius[i[k]],
    )  # fmt: skip
    # axes that are one leave a gap all around: any direction shows it
    normal = np.where((off > LEVEL * s.radius[i])[:, None], normal, frame_of(along)[0])
    open_ = play - off
    at = at + (s.radius[i] + open_ / 2)[:, None] * normal
    bend = _inverse(s.radius[i], s.radius[j], -1.0)
    line = _forms(
        row[m], LINE, at[m], normal[m], open_[m],
        along=along[m], slope=_dot(slope, normal)[m], bend=bend[m],
    )  # fmt: skip
    return _together([everywhere, line])


def _cone_in_cone(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array) -> Forms:
    """Tapers: the gap across their sides where the axes are one."""
    turned = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    alike = (turned <= np.sin(angle)) & (_dot(s.axis[i], s.axis[j]) > 0)
    alike &= np.abs(s.half_angle[i] - s.half_angle[j]) <= angle
    k = np.flatnonzero(alike)
    row, i, j = row[k], i[k], j[k]
    axis = _unit(s.axis[i] + s.axis[j])
    alpha = (s.half_angle[i] + s.half_angle[j]) / 2
    shift = s.point[i] - s.point[j]
    lift = _dot(shift, axis) * np.sin(alpha)
    off = np.linalg.norm(_across(shift, axis), axis=1) * np.cos(alpha)
    slope = s.half_angle[j] - s.half_angle[i]
    return _forms(
        row, SAME, s.point[i], np.zeros((len(row), 3)), lift,
        along=axis, slope=slope, swing=off, bend=np.maximum(s.radius[i], gap[k]),
    )  # fmt: skip


def _swept(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array) -> Forms:
    """Cylinders and cones side by side: both common planes between them."""
    found = [_none()]
    ai, aj = s.axis[i], s.axis[j]
    want_i = np.where(s.kind[i] == CONE, -np.sin(s.half_angle[i]), 0.0)
    want_j = np.where(s.kind[j] == CONE, np.sin(s.half_angle[j]), 0.0)
    third = cross(ai, aj)
    cosine, square = _dot(ai, aj), _dot(third, third)
    safe = np.maximum(square, 1e-300)
    x, y = (want_i - cosine * want_j) / safe, (want_j - cosine * want_i) / safe
    rest = 1 - (x * want_i + y * want_j)
    for turn in (1.0, -1.0):
        k = np.flatnonzero((rest > LEVEL) & (square > LEVEL))
        z = turn * np.sqrt(rest[k] / square[k])
        m = x[k, None] * ai[k] + y[k, None] * aj[k] + z[:, None] * third[k]
        foot_i, line_i = _generator(s, i[k], m)
        foot_j, line_j = _generator(s, j[k], -m)
        open_ = _dot(foot_j - foot_i, m)
        across = cross(line_i, line_j)
        bottom = _dot(across, m)
        crossing = np.abs(bottom) > np.sin(angle[k])
        t = _dot(cross(foot_j - foot_i, line_j), m) / np.where(crossing, bottom, 1.0)
        at = foot_i + t[:, None] * line_i + (open_ / 2)[:, None] * m
        bend = np.maximum(s.radius[i[k]], s.radius[j[k]]) / np.maximum(np.abs(bottom), 1e-9)
        made = _forms(row[k], POINT, at, m, open_, bend=bend)
        found.append(made.take(np.flatnonzero(crossing)))
    return _together(found)


def _generator(s: Surfaces, i: Index, m: Array) -> tuple[Array, Array]:
    """A point and the direction of the generator of a cylinder or cone with outward normal m."""
    axis, alpha = s.axis[i], s.half_angle[i]
    cone = (s.kind[i] == CONE)[:, None]
    out = _unit(_across(m, axis))
    foot = np.where(cone, s.point[i], s.point[i] + s.radius[i][:, None] * m)
    side = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    return foot, np.where(cone, side, axis)


def _torus_on_axis(inner: bool) -> Kernel:
    """A torus about a shaft, or in a bore, of the same axis."""

    def kernel(s: Surfaces, row: Index, i: Index, j: Index, gap: Array, angle: Array) -> Forms:
        turned = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
        off = np.linalg.norm(_across(s.point[j] - s.point[i], s.axis[i]), axis=1)
        k = np.flatnonzero((turned <= np.sin(angle)) & (off <= gap))
        row, i, j, off = row[k], i[k], j[k], off[k]
        side = -1.0 if inner else 1.0
        radius = s.radius[j] + side * s.tube[j]
        flat = np.tile([-side, 0.0, 0.0], (len(k), 1))  # from the cylinder to the torus
        return _forms(
            row, CIRCLE, s.point[j], flat, side * (s.radius[i] - radius),
            along=s.axis[j], radius=radius, swing=off, bend=s.tube[j],
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
