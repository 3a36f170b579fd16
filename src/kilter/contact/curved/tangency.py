"""Candidate contacts of two exact surfaces: a point, a line, a circle, or the whole surface.

Each kernel takes many pairs of surfaces (i, j) of two kinds and returns candidates: position, unit
normal n from i to j, and the gap there, independently of the extent of their faces, which
`kilter.contact.curved.contact_points` tests. Solid against solid touches from outside; solid in
hollow touches from inside, if the solid is curved more than the hollow. With cores (the centre of a
sphere, the axis of a cylinder, the circle of a torus) at the distance D and radii r:

    solid on solid   gap = D - r_i - r_j          solid in hollow   gap = r_j - r_i - D

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
    body_in_torus,
    dot,
    lines_on_cone,
    make_candidates,
    torus_on_face,
    without_along,
)  # fmt: skip

__all__ = ["find_candidates"]


def _opening_radius(first: Array, second: Array, sign: float) -> Array:
    """Radius of curvature of the gap between two curves: 1 / (1/first + sign/second)."""
    curvature = 1 / np.maximum(first, TINY) + sign / np.maximum(second, TINY)
    result: Array = 1 / np.maximum(curvature, NO_DIRECTION / np.maximum(first, TINY))
    return result


Kernel = Callable[[Surfaces, Index, Index, Index, FormLimits], Candidates]


def find_candidates(
    s: Surfaces, i: Index, j: Index, limits: FormLimits, held: Mask
) -> tuple[Candidates, Mask]:
    """Candidate contacts of pairs of surfaces, and a mask of pairs without a contact formula.

    Parameters
    ----------
    s : Surfaces
    i, j : ndarray of int, shape (n,)
        Rows of the surfaces of each pair.
    limits : FormLimits
        Limits of each pair; its `share` is set here.
    held : ndarray of bool, shape (N,)
        Parts that do not move when a clearance closes. The fit is closed at the position of the
        other part, so that its weight does not rotate it; if both or neither are held, at the
        shaft.

    Returns
    -------
    candidates : Candidates
        Normals lead from i to j.
    unknown : ndarray of bool, shape (n,)
    """
    swap = (s.kind[i] > s.kind[j]) | ((s.kind[i] == s.kind[j]) & s.hollow[i])
    first, second = np.where(swap, j, i), np.where(swap, i, j)
    unknown = (s.kind[i] == FREE) | (s.kind[j] == FREE)
    # kernels expect the surfaces in order of kind, and of two equal kinds the solid first
    inside = s.hollow[second] & ~s.hollow[first]
    outside = ~s.hollow[second] & ~s.hollow[first]
    socket = s.hollow[first] & ~s.hollow[second]
    stays = held[s.part[first]].astype(int) - held[s.part[second]]
    # 0: close at the first surface, 1: at the second; a hollow first surface is the hole
    share = np.where(stays == 0, s.hollow[first] & ~s.hollow[second], stays > 0)
    limits = replace(limits, share=share.astype(np.float64))
    blocks: list[Candidates] = []
    rows = np.arange(len(i))
    for (first_kind, second_kind, position), kernel in _KERNELS.items():
        selected = (s.kind[first] == first_kind) & (s.kind[second] == second_kind)
        selected &= {"on": outside, "in": inside, "around": socket}[position]
        chosen = np.flatnonzero(selected)
        if len(chosen):
            kernel_limits = limits.take(chosen)
            blocks.append(kernel(s, rows[chosen], first[chosen], second[chosen], kernel_limits))
    unknown |= _pairs_without_kernel(s, first, second, inside)
    candidates = Candidates.join(blocks)
    unknown[candidates.row] = False  # a kernel returned a candidate
    turned = swap[candidates.row][:, None]
    return replace(
        candidates, normal=np.where(turned, -candidates.normal, candidates.normal)
    ), unknown


def _pairs_without_kernel(s: Surfaces, i: Index, j: Index, inside: Mask) -> Mask:
    """Mask of surface pairs that may touch in ways for which there is no contact formula."""
    # a torus fills a hollow torus with the same circle
    unmodelled: Mask = (s.kind[i] == TORUS) & (s.kind[j] == TORUS) & inside
    return unmodelled


def _round_in_round(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow spheres: the whole face or a single point.

    The whole face if the radii agree.
    """
    apart = s.point[i] - s.point[j]
    play = s.radius[j] - s.radius[i]
    distance = np.linalg.norm(apart, axis=1)
    same = np.abs(play) <= limits.gap
    direction = unit_rows(apart)
    equal, looser = np.flatnonzero(same), np.flatnonzero(~same & (play > 0))
    coincident = make_candidates(
        row[equal],
        SAME,
        s.point[i[equal]],
        direction[equal],
        play[equal],
        swing=distance[equal],
        bend=s.radius[i[equal]],
    )
    at = s.point[i] + (s.radius[i] + (play - distance) / 2)[:, None] * direction
    bend = _opening_radius(s.radius[i], s.radius[j], -1.0)
    point = make_candidates(
        row[looser],
        POINT,
        at[looser],
        direction[looser],
        (play - distance)[looser],
        bend=bend[looser],
    )
    fitting = np.flatnonzero(limits.fits(play, s.radius[i]))
    fits = make_candidates(
        row[fitting],
        SAME,
        (s.point[i] - limits.share[:, None] * apart)[fitting],
        direction[fitting],
        play[fitting],
        swing=distance[fitting],
        play=play[fitting],
        bend=s.radius[i[fitting]],
    )
    tight = np.flatnonzero(~same & (play <= 0))
    pressed = make_candidates(
        row[tight], SAME, s.point[i[tight]], direction[tight], play[tight], swing=distance[tight]
    )
    return Candidates.join([coincident, fits, point, pressed])


def _sphere_sphere(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside spheres: the point between the centres."""
    apart = s.point[j] - s.point[i]
    return _sphere_beside(s, row, i, apart, s.radius[j])


def _sphere_beside(
    s: Surfaces, row: Index, i: Index, apart: Array, other_radius: Array
) -> Candidates:
    """Candidate contacts of spheres outside round bodies, at the point nearest to their axis.

    The core is the axis or centre of the body; it lies at `apart` from the sphere's centre.
    """
    normal = unit_rows(apart)
    gap = np.linalg.norm(apart, axis=1) - s.radius[i] - other_radius
    at = s.point[i] + (s.radius[i] + gap / 2)[:, None] * normal
    return make_candidates(row, POINT, at, normal, gap, bend=s.radius[i])


def _sphere_cylinder(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside cylinders: the point nearest to the axis."""
    apart = -without_along(s.point[i] - s.point[j], s.axis[j])
    return _sphere_beside(s, row, i, apart, s.radius[j])


def _sphere_in_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits
) -> Candidates:
    """Candidate contacts of spheres in hollow cylinders: a circle for equal radii, else a point."""
    apart = without_along(s.point[i] - s.point[j], s.axis[j])
    play, distance = s.radius[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    circle = _sphere_in_tube(s, row, i, limits, (apart, s.axis[j]), play)
    looser = np.flatnonzero(play > limits.gap)
    direction = unit_rows(apart)
    at = s.point[i] + (s.radius[i] + (play - distance) / 2)[:, None] * direction
    bend = np.maximum(_opening_radius(s.radius[i], s.radius[j], -1.0), s.radius[i])
    return Candidates.join(
        [
            circle,
            make_candidates(
                row[looser],
                POINT,
                at[looser],
                direction[looser],
                (play - distance)[looser],
                bend=bend[looser],
            ),
        ]
    )


def _sphere_in_tube(
    s: Surfaces, row: Index, i: Index, limits: FormLimits, tube: tuple[Array, Array], play: Array
) -> Candidates:
    """Candidate contacts of spheres that fill a tube: a circle around each sphere.

    `tube` holds the offset of the sphere's centre from the line of the tube, and the tube's
    direction.
    """
    apart, along = tube
    fit = limits.fits(play, s.radius[i])
    filling = np.flatnonzero((np.abs(play) <= limits.gap) | fit)
    fit_play = np.where(fit, play, 0.0)[filling]
    flat = np.tile([1.0, 0.0, 0.0], (len(filling), 1))
    at = s.point[i[filling]] - np.where(fit, limits.share, 0.0)[filling, None] * apart[filling]
    return make_candidates(
        row[filling],
        CIRCLE,
        at,
        flat,
        play[filling],
        along=along[filling],
        radius=s.radius[i[filling]] + fit_play / 2,
        swing=np.linalg.norm(apart, axis=1)[filling],
        play=fit_play,
        bend=s.radius[i[filling]],
    )


def _sphere_cone(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside cones: the nearest point of the cone's side."""
    _, _, direction = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    normal = -(np.cos(alpha)[:, None] * direction - np.sin(alpha)[:, None] * s.axis[j])
    gap = s.distance(j, s.point[i]) - s.radius[i]
    at = s.point[i] + (s.radius[i] + gap / 2)[:, None] * normal
    return make_candidates(row, POINT, at, normal, gap, bend=s.radius[i])


def _sphere_in_cone(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow cones: a circle if on the axis, else a point."""
    height, rho, direction = s.polar(j, s.point[i])
    alpha = s.half_angle[j]
    cosine, sine = np.cos(alpha), np.sin(alpha)
    gap = s.distance(j, s.point[i]) - s.radius[i]
    mean = height * sine - s.radius[i]
    closes = (rho > limits.gap) & (np.maximum(rho, mean) <= limits.closed) & (mean > limits.gap)
    on_axis, off_axis = (
        np.flatnonzero(x) for x in ((rho <= limits.gap) | closes, rho > limits.gap)
    )
    normal = cosine[:, None] * direction - sine[:, None] * s.axis[j]
    at = s.point[i] + (s.radius[i] + gap / 2)[:, None] * normal
    circle_center = s.point[i] - (s.radius[i] * sine)[:, None] * s.axis[j]
    circle_center -= np.where(closes, limits.share * rho, 0.0)[:, None] * direction
    play = np.where(closes, mean, 0.0)
    circle = make_candidates(
        row[on_axis],
        CIRCLE,
        circle_center[on_axis],
        np.column_stack([cosine, -sine, 0 * sine])[on_axis],
        mean[on_axis],
        along=s.axis[j[on_axis]],
        radius=(s.radius[i] * cosine + play / 2)[on_axis],
        swing=(rho * cosine)[on_axis],
        play=play[on_axis],
        bend=s.radius[i[on_axis]],
    )
    # around the axis of the cone the gap opens slowly: a wide zone
    bend = 10 * s.radius[i]
    return Candidates.join(
        [
            circle,
            make_candidates(
                row[off_axis],
                POINT,
                at[off_axis],
                normal[off_axis],
                gap[off_axis],
                bend=bend[off_axis],
            ),
        ]
    )


def _sphere_torus(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres outside tori: a circle if centred on the axis, else a point."""
    height, rho, direction = s.polar(j, s.point[i])
    axis, radius = s.axis[j], s.radius[j]
    centred = rho <= limits.gap
    on_axis, off_axis = np.flatnonzero(centred), np.flatnonzero(~centred)
    apart = (radius - rho)[:, None] * direction - height[:, None] * axis
    point = _sphere_beside(s, row, i, apart, s.tube[j]).take(off_axis)
    core = np.hypot(radius, height)
    out, down = radius / core, -height / core
    circle = make_candidates(
        row[on_axis],
        CIRCLE,
        (s.point[i] + (s.radius[i] * down)[:, None] * axis)[on_axis],
        np.column_stack([out, down, 0 * out])[on_axis],
        (core - s.tube[j] - s.radius[i])[on_axis],
        along=axis[on_axis],
        radius=(s.radius[i] * out)[on_axis],
        swing=rho[on_axis],
        bend=s.radius[i[on_axis]],
    )
    return Candidates.join([circle, point])


def _sphere_in_torus(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of spheres in hollow tori: a circle if the radii agree, else a point.

    The circle lies around the tube.
    """
    height, rho, direction = s.polar(j, s.point[i])
    apart = (rho - s.radius[j])[:, None] * direction + height[:, None] * s.axis[j]
    play, distance = s.tube[j] - s.radius[i], np.linalg.norm(apart, axis=1)
    circle = _sphere_in_tube(s, row, i, limits, (apart, cross(s.axis[j], direction)), play)
    looser = np.flatnonzero(play > limits.gap)
    normal = unit_rows(apart)
    at = s.point[i] + (s.radius[i] + (play - distance) / 2)[:, None] * normal
    bend = np.maximum(_opening_radius(s.radius[i], s.tube[j], -1.0), 10 * s.radius[i])
    point = make_candidates(
        row[looser], POINT, at[looser], normal[looser], (play - distance)[looser], bend=bend[looser]
    )
    return Candidates.join([circle, point])


def _cylinder_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits
) -> Candidates:
    """Candidate contacts of cylinders side by side: a line if axes are parallel, else a point."""
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    parallel = sine <= np.sin(limits.angle)
    along_line, crossing = np.flatnonzero(parallel), np.flatnonzero(~parallel)
    along, at, apart, slope = _nearly_parallel(s, i[along_line], j[along_line])
    normal = unit_rows(apart)
    gap = np.linalg.norm(apart, axis=1) - s.radius[i[along_line]] - s.radius[j[along_line]]
    at = at + (s.radius[i[along_line]] + gap / 2)[:, None] * normal
    bend = _opening_radius(s.radius[i[along_line]], s.radius[j[along_line]], 1.0)
    line = make_candidates(
        row[along_line], LINE, at, normal, gap, along=along, slope=dot(slope, normal), bend=bend
    )
    return Candidates.join(
        [
            line,
            _crossing_generators(s, row[crossing], i[crossing], j[crossing], limits.take(crossing)),
        ]
    )


def _nearly_parallel(s: Surfaces, i: Index, j: Index) -> tuple[Array, Array, Array, Array]:
    """Common direction of two nearly parallel axes, for each pair, and the offset between them.

    Returns
    -------
    along : ndarray, shape (n, 3)
        Mean direction of both axes.
    at : ndarray, shape (n, 3)
        A point of the axis of i.
    apart : ndarray, shape (n, 3)
        Vector from there to the axis of j.
    change : ndarray, shape (n, 3)
        Change of that vector per unit length along the common direction [-].
    """
    sense = np.where(dot(s.axis[i], s.axis[j]) < 0, -1.0, 1.0)[:, None]
    axis_j = sense * s.axis[j]
    along = unit_rows(s.axis[i] + axis_j)
    # nearest points across the common direction, beside the point of i
    at = s.point[i]
    nearest = s.point[j] + (dot(at - s.point[j], along) / dot(axis_j, along))[:, None] * axis_j
    change = axis_j / dot(axis_j, along)[:, None] - s.axis[i] / dot(s.axis[i], along)[:, None]
    return along, at, nearest - at, change


def _cylinder_in_cylinder(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits
) -> Candidates:
    """Candidate contacts of cylinders in bores: the whole face if the radii agree, else a line.

    A shaft with play in its hole is a fit (SAME with `play`) and a line.
    """
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    play = s.radius[j] - s.radius[i]
    parallel = sine <= np.sin(limits.angle)
    along, at, apart, slope = _nearly_parallel(s, i, j)
    distance = np.linalg.norm(apart, axis=1)
    same = parallel & (play <= limits.gap)
    # a shaft may lean by its play over the length of the hole: the caller tests the true length
    fit = limits.fits(play, s.radius[i])
    fit &= sine <= np.sin(limits.angle) + 2 * ratio(np.maximum(play, 0), s.radius[i])
    fitting, looser = np.flatnonzero(same | fit), np.flatnonzero(parallel & ~same)
    normal = -unit_rows(apart)
    # the gap varies around and along the axis: the caller computes it at both ends
    coaxial = make_candidates(
        row[fitting],
        SAME,
        at[fitting],
        normal[fitting],
        play[fitting],
        along=along[fitting],
        radius=s.radius[i[fitting]],
        slope=sine[fitting],
        swing=distance[fitting],
        play=np.where(fit, play, 0.0)[fitting],
        bend=s.radius[i[fitting]],
    )
    # coinciding axes leave the same gap all around: any direction serves
    normal = np.where((distance > NO_DIRECTION * s.radius[i])[:, None], normal, across(along)[0])
    gap = play - distance
    at = at + (s.radius[i] + gap / 2)[:, None] * normal
    bend = _opening_radius(s.radius[i], s.radius[j], -1.0)
    line = make_candidates(
        row[looser],
        LINE,
        at[looser],
        normal[looser],
        gap[looser],
        along=along[looser],
        slope=dot(slope, normal)[looser],
        bend=bend[looser],
    )
    return Candidates.join([coaxial, line])


def _cone_in_cone(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate contacts of solid cones in hollow cones of the same half angle and axis."""
    sine = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
    alike = (sine <= np.sin(limits.angle)) & (dot(s.axis[i], s.axis[j]) > 0)
    alike &= np.abs(s.half_angle[i] - s.half_angle[j]) <= limits.angle
    selected = np.flatnonzero(alike)
    row, i, j, limits = row[selected], i[selected], j[selected], limits.take(selected)
    axis = unit_rows(s.axis[i] + s.axis[j])
    alpha = (s.half_angle[i] + s.half_angle[j]) / 2
    shift = s.point[i] - s.point[j]
    lift = dot(shift, axis) * np.sin(alpha)
    distance = np.linalg.norm(without_along(shift, axis), axis=1) * np.cos(alpha)
    slope = s.half_angle[j] - s.half_angle[i]
    closes = (lift > limits.gap) & (lift <= limits.closed)
    return make_candidates(
        row,
        SAME,
        s.point[i],
        np.zeros((len(row), 3)),
        lift,
        along=axis,
        slope=slope,
        swing=distance,
        play=np.where(closes, lift, 0.0),
        bend=np.maximum(s.radius[i], limits.gap),
    )


def _cone_in_wider_cone(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits
) -> Candidates:
    """Candidate contacts of solid cones in hollow cones: whole faces, else a common generator."""
    same = _cone_in_cone(s, row, i, j, limits)
    lines = lines_on_cone(s, row, i, j, limits)
    coaxial = same.row[same.swing <= limits.gap[np.searchsorted(row, same.row)]]
    return Candidates.join([same, lines.take(np.flatnonzero(~np.isin(lines.row, coaxial)))])


def _both(first: Kernel, second: Kernel) -> Kernel:
    """Contact function with the candidates of two contact functions."""

    def kernel(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
        """Candidate contacts of both functions."""
        return Candidates.join([first(s, row, i, j, limits), second(s, row, i, j, limits)])

    return kernel


def _crossing_generators(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits
) -> Candidates:
    """Candidate point contacts of cylinders or cones whose straight lines (generators) cross.

    Both generators lie in the common tangent plane.

    With axes a, b and the wanted m.a, m.b, the unit normal is m = x a + y b + z (a x b). The two
    signs of z give the tangent planes on either side.
    """
    blocks: list[Candidates] = []
    axis_i, axis_j = s.axis[i], s.axis[j]
    want_i = np.where(s.kind[i] == CONE, -np.sin(s.half_angle[i]), 0.0)
    want_j = np.where(s.kind[j] == CONE, np.sin(s.half_angle[j]), 0.0)
    third = cross(axis_i, axis_j)
    cosine, square = dot(axis_i, axis_j), dot(third, third)
    safe = np.maximum(square, TINY)
    x, y = (want_i - cosine * want_j) / safe, (want_j - cosine * want_i) / safe
    rest = 1 - (x * want_i + y * want_j)
    for turn in (1.0, -1.0):
        # no real root: no common tangent plane exists; parallel axes have no cross product
        k = np.flatnonzero((rest > NO_DIRECTION) & (square > NO_DIRECTION))
        z = turn * np.sqrt(rest[k] / square[k])
        m = x[k, None] * axis_i[k] + y[k, None] * axis_j[k] + z[:, None] * third[k]
        foot_i, line_i = _generator(s, i[k], m)
        foot_j, line_j = _generator(s, j[k], -m)
        gap = dot(foot_j - foot_i, m)
        bottom = dot(cross(line_i, line_j), m)
        crossing = np.abs(bottom) > np.sin(limits.angle[k])
        t = dot(cross(foot_j - foot_i, line_j), m) / np.where(crossing, bottom, 1.0)
        at = foot_i + t[:, None] * line_i + (gap / 2)[:, None] * m
        bend = np.maximum(s.radius[i[k]], s.radius[j[k]]) / np.maximum(
            np.abs(bottom), GENERATOR_SINE
        )
        candidates = make_candidates(row[k], POINT, at, m, gap, bend=bend)
        blocks.append(candidates.take(np.flatnonzero(crossing)))
    return Candidates.join(blocks)


def _generator(s: Surfaces, i: Index, m: Array) -> tuple[Array, Array]:
    """A point and the direction of the straight line on a cylinder or cone with the normal m."""
    axis, alpha = s.axis[i], s.half_angle[i]
    cone = (s.kind[i] == CONE)[:, None]
    out = unit_rows(without_along(m, axis))
    foot = np.where(cone, s.point[i], s.point[i] + s.radius[i][:, None] * m)
    side = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    return foot, np.where(cone, side, axis)


def _swapped(kernel: Kernel) -> Kernel:
    """The kernel for pairs in the opposite order."""

    def swapped(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
        """Candidate contacts of surfaces j with surfaces i, with normals from i to j."""
        candidates = kernel(s, row, j, i, limits)
        # the normal of a circle has its components away from the axis and along it
        return replace(candidates, normal=-candidates.normal)

    return swapped


def _torus_on_cylinder(inner: bool) -> Kernel:
    """Contact function of tori with cylinders: fits about a common axis, else the nearest point."""
    coaxial, nearest = _torus_on_axis(inner), _swapped(torus_on_face)

    def kernel(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
        """Candidate contacts of tori with cylinders about the same axis or any other."""
        fits = coaxial(s, row, i, j, limits)
        rest = nearest(s, row, i, j, limits)
        is_fit = np.isin(rest.row, fits.row)
        return Candidates.join([fits, rest.take(np.flatnonzero(~is_fit))])

    return kernel


def _torus_on_axis(inner: bool) -> Kernel:
    """Create the contact function of a torus about a coaxial shaft (`inner`), or in a coaxial bore.

    `inner`: the torus surrounds a shaft and touches it with its inner side; else it lies in a bore.
    """

    def kernel(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
        """Candidate circle contacts of tori with cylinders about the same axis."""
        turned = np.linalg.norm(cross(s.axis[i], s.axis[j]), axis=1)
        off = np.linalg.norm(without_along(s.point[j] - s.point[i], s.axis[i]), axis=1)
        side = -1.0 if inner else 1.0
        radius = s.radius[j] + side * s.tube[j]
        play = side * (s.radius[i] - radius)
        fit = limits.fits(play, s.radius[i]) & (off <= play + limits.gap)
        k = np.flatnonzero((turned <= np.sin(limits.angle)) & (fit | (off <= limits.gap)))
        row, i, j, wider = row[k], i[k], j[k], np.where(fit, play, 0.0)[k]
        share = np.where(fit, 1 - limits.share, 0.0)[k, None]
        flat = np.tile([-side, 0.0, 0.0], (len(k), 1))  # from the cylinder to the torus
        apart = without_along(s.point[i] - s.point[j], s.axis[j])
        return make_candidates(
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
    (CYLINDER, CONE, "on"): _both(_crossing_generators, lines_on_cone),
    (CYLINDER, CONE, "in"): lines_on_cone,
    (CONE, CONE, "on"): _both(_crossing_generators, lines_on_cone),
    (CONE, CONE, "in"): _cone_in_wider_cone,
    (CYLINDER, TORUS, "on"): _torus_on_cylinder(True),
    (CYLINDER, TORUS, "in"): body_in_torus,
    (CYLINDER, TORUS, "around"): _torus_on_cylinder(False),
    (SPHERE, TORUS, "around"): _swapped(torus_on_face),
    (CONE, TORUS, "on"): _swapped(torus_on_face),
    (CONE, TORUS, "in"): body_in_torus,
    (CONE, TORUS, "around"): _swapped(torus_on_face),
    (TORUS, TORUS, "on"): torus_on_face,
    (TORUS, TORUS, "in"): torus_on_face,
}
