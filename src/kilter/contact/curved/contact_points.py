"""Constraint points of curved contacts, and which side their number errs on.

A frictionless contact passes the cone of the wrenches of its points. With n(t) the unit
direction at angle t across an axis:

- Cylinder in cylinder: forces n(t) at heights z; a wrench is n(t) (x) (1, z), linear in the
  height, so the two ends of each generator stand for it; and the n(t) of an arc are sums of
  any of them that include its ends and leave no step of pi. The points are exact.
- Sphere in cylinder, torus in a bore or on a shaft: forces n(t) in one plane: exact too.
- Line, point: exact.
- Circles and cones whose forces lean on the axis (sphere in cone, torus on plane, cone in
  cone) have a round cone of wrenches. `AROUND` points lie on it: the cone they span is
  inside the true one by this fraction, 1 - cos(pi / AROUND) = 9.5e-4 of its half width. The outer
  rows, half-way between the points and farther from the axis by 1 / cos(pi / AROUND), span
  a cone around the true one: a verdict is given only where both agree.
- Sphere in sphere: forces through the centre. Where the socket reaches around half of the
  sphere or more the points are exact; else as above.

With friction the points between the extreme ones matter too: around an axis they are at most
`STEP` apart, so that the forces between two of them fall short by 1 - cos(STEP / 2) = 3.4 %.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across, counted, cross
from kilter.contact.broad import joins
from kilter.contact.contact_tolerances import (
    DIRECTION_CORNER,
    EDGE_ON,
    FULL_TURN,
    LEAN,
    LEAST_ARC,
    LEAST_OVERLAP,
    ROUND_CONE,
    THROUGH_CENTER,
)
from kilter.contact.curved.coverage import TURN
from kilter.contact.planar.polygons import clip_convex, convex_hull, polygon_area, tidy

__all__ = [
    "AROUND",
    "STEP",
    "Spots",
    "angles_between",
    "arcs_of",
    "ring",
    "shell",
    "socket",
    "unrolled_overlap",
]


AROUND = 72
"""Points around a full circle whose forces lean on its axis."""
STEP = np.pi / 6
"""Points around an axis are at most so far apart [rad]."""
PROBES = 144
"""Angles at which a circle is asked whether its faces cover it."""
HALVINGS = 30
"""Halvings that find the end of an arc."""


@dataclass(frozen=True, slots=True, eq=False)
class Spots:
    """Points of one patch with unit normals, outer rows around them, and the area."""

    points: Array
    normals: Array
    outer_points: Array
    outer_normals: Array
    area: float


_NONE = np.empty((0, 3))


def angles_between(begin: float, width: float, step: float) -> Array:
    """Angles of an arc at most `step` apart, with both ends; all around: no end twice.

    Examples
    --------
    >>> angles_between(0.0, 1.0, 0.6).tolist()
    [0.0, 0.5, 1.0]
    """
    if width >= TURN - FULL_TURN:
        count = int(np.ceil(TURN / step - LEAST_ARC))
        around: Array = begin + np.arange(count, dtype=np.float64) * (TURN / count)
        return around
    count = max(1, int(np.ceil(width / step - LEAST_ARC)))
    result: Array = begin + np.arange(count + 1, dtype=np.float64) * (width / count)
    return result


def arcs_of(inside: Callable[[Array], Mask]) -> list[tuple[float, float]]:
    """Arcs (begin, width) of a circle where `inside` holds."""
    angle = np.arange(PROBES, dtype=np.float64) * (TURN / PROBES)
    held = inside(angle)
    if held.all():
        return [(0.0, TURN)]
    if not held.any():
        return []
    starts = np.flatnonzero(held & ~np.roll(held, 1))
    ends = np.flatnonzero(held & ~np.roll(held, -1))
    low = np.concatenate([angle[starts] - TURN / PROBES, angle[ends] + TURN / PROBES])
    high = np.concatenate([angle[starts], angle[ends]])  # outside, inside
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        yes = inside(middle)
        low, high = np.where(yes, low, middle), np.where(yes, middle, high)
    begin, end = high[: len(starts)], high[len(starts) :]
    arcs = []
    for start in begin:
        width = np.remainder(end - start, TURN)
        arcs.append((float(start), float(width.min())))
    return arcs


def ring(
    center: Array, axis: Array, radius: float, lean: tuple[float, float],
    arcs: list[tuple[float, float]],
) -> Spots:  # fmt: skip
    """Points around a circle.

    Parameters
    ----------
    lean : (float, float)
        Components of the normal away from the axis and along it.
    arcs : list of (begin, width)
    """
    leaning = abs(lean[1]) > LEAN
    step = TURN / AROUND if leaning else STEP
    u, v = across(axis)
    points, normals, outer_points, outer_normals = [], [], [], []
    for begin, width in arcs:
        angle = angles_between(begin, width, step)
        points.append(_on_circle(center, u, v, radius, angle))
        normals.append(lean[0] * _around(u, v, angle) + lean[1] * axis)
        if leaning:
            between, stretch = _between(angle, width)
            outer_points.append(_on_circle(center, u, v, radius * stretch, between))
            outer = lean[0] * stretch * _around(u, v, between) + lean[1] * axis
            outer_normals.append(outer / np.linalg.norm(outer, axis=1)[:, None])
    return Spots(
        np.concatenate(points), np.concatenate(normals),
        np.concatenate([_NONE, *outer_points]), np.concatenate([_NONE, *outer_normals]), 0.0,
    )  # fmt: skip


def _between(angle: Array, width: float) -> tuple[Array, float]:
    """Angles half-way between neighbours, and how far out tangents at those meet."""
    following = np.append(angle[1:], angle[0] + TURN) if width >= TURN - FULL_TURN else angle[1:]
    here = angle[: len(following)]
    half = float((following - here).max(initial=0.0)) / 2
    return (here + following) / 2, 1 / np.cos(half)


def _around(u: Array, v: Array, angle: Array) -> Array:
    result: Array = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    return result


def _on_circle(center: Array, u: Array, v: Array, radius: float, angle: Array) -> Array:
    result: Array = center + radius * _around(u, v, angle)
    return result


def shell(
    apex: Array, axis: Array, half_angle: float, radius: float,
    region: tuple[Array, Array], outer: tuple[Array, Array] | None,
) -> Spots:  # fmt: skip
    """Points of a cylinder (`half_angle` 0) or cone at angles and heights, shape (n,) each.

    `outer`: angles and heights of a region around the true one, if the points are not exact.
    """
    u, v = across(axis)
    cosine, sine = np.cos(half_angle), np.sin(half_angle)

    def at(angle: Array, height: Array, stretch: float) -> tuple[Array, Array]:
        away = _around(u, v, angle)
        reach = (radius + height * np.tan(half_angle)) * stretch
        points = apex + height[:, None] * axis + reach[:, None] * away
        normals = cosine * stretch * away - sine * axis
        return points, normals / np.linalg.norm(normals, axis=1)[:, None]

    points, normals = at(*region, 1.0)
    if outer is None:
        return Spots(points, normals, _NONE, _NONE, 0.0)
    stretch = 1.0 if half_angle == 0 else 1 / float(np.cos(np.pi / AROUND))
    return Spots(points, normals, *at(*outer, stretch), 0.0)


# sphere in sphere ---------------------------------------------------------------------


def socket(center: Array, radius: float, one: Array, other: Array, sagitta: float) -> Spots | None:
    """Points where two faces of one sphere, triangles (m, 3, 3), lie on each other.

    Forces from the centre outwards; None where the faces do not overlap.
    """
    corners, weight = _overlap(one - center, other - center)
    if not len(corners):
        return None
    area = float(np.linalg.norm(weight, axis=1).sum()) * radius**2
    mean = weight.sum(axis=0)
    away, outer = _extreme(corners, mean, 2 * sagitta / radius)
    return Spots(
        center + radius * away, away, center + radius * outer if len(outer) else _NONE, outer, area
    )


def _overlap(one: Array, other: Array) -> tuple[Array, Array]:
    """Corners, unit directions (n, 3), of the common part of two faces, and weighted normals."""
    one = one / np.linalg.norm(one, axis=2)[..., None]
    other = other / np.linalg.norm(other, axis=2)[..., None]
    i, j = _box_pairs(one, other)
    middle = one[i].mean(axis=1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    front = np.einsum("nki,ni->nk", other[j], middle).min(axis=1) > 0.05
    i, j, middle = i[front], j[front], middle[front]
    u, v = across(middle)
    flat_i, flat_j = (_gnomonic(p, middle, u, v) for p in (one[i], other[j]))
    three = np.full(len(i), 3)
    points, count = clip_convex(_left(flat_i), three, _left(flat_j), three)
    area = polygon_area(points, count)
    keep = np.flatnonzero((count >= 3) & (area > LEAST_OVERLAP))
    points, count, area = points[keep], count[keep], area[keep]
    real = np.arange(points.shape[1]) < count[:, None]
    row = np.repeat(keep, count)
    solid = points[real]
    corners = middle[row] + solid[:, :1] * u[row] + solid[:, 1:] * v[row]
    corners /= np.linalg.norm(corners, axis=1)[:, None]
    return corners, _solid_angles(corners, count)[:, None] * middle[keep]


def _solid_angles(corners: Array, count: Index) -> Array:
    """Solid angles of polygons on the unit sphere, corners one after the other, shape (n,).

    References
    ----------
    A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983, equation 8.
    """
    first = np.cumsum(count) - count
    fan = count - 2
    owner, k = counted(fan)
    a, b, c = (corners[first[owner] + step] for step in (0 * k, k + 1, k + 2))
    top = np.einsum("ij,ij->i", a, cross(b, c))
    bottom = 1 + sum(np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    angle = 2 * np.arctan2(top, bottom)
    return np.abs(np.bincount(owner, angle, minlength=len(count)))


def _box_pairs(one: Array, other: Array) -> tuple[Index, Index]:
    """Triangles whose boxes meet."""
    zero = np.zeros(1)
    found = [(np.empty(0, np.int64), np.empty(0, np.int64))]
    boxes = [(p.min(axis=1), p.max(axis=1)) for p in (one, other)]
    owners = [np.zeros(len(p), dtype=np.int64) for p in (one, other)]
    grow = 0.02  # a triangle lies below the sphere it stands for
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], zero + grow):
        found.append((i, j))
    i, j = (np.concatenate([f[k] for f in found]) for k in range(2))
    return i, j


def _gnomonic(points: Array, middle: Array, u: Array, v: Array) -> Array:
    depth = np.maximum(np.einsum("nki,ni->nk", points, middle), EDGE_ON)
    flat = [np.einsum("nki,ni->nk", points, w) / depth for w in (u, v)]
    return np.stack(flat, axis=2)


def _left(triangles: Array) -> Array:
    """Triangles, shape (n, 3, 2), turning left."""
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    right = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    result: Array = np.where(right[:, None, None], triangles[:, ::-1], triangles)
    return result


def _extreme(corners: Array, mean: Array, blur: float) -> tuple[Array, Array]:
    """Directions that span the cone of directions, and ones that span a cone around it."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(np.vstack([corners, np.zeros(3)]))
    size = float(np.linalg.norm(mean))
    through = np.abs(hull.equations[:, 3]) <= THROUGH_CENTER
    if not through.any():  # the centre lies inside: any force at all
        return _spread(corners), _NONE
    rim = np.unique(hull.simplices[through])
    rim = rim[rim < len(corners)]
    middle = mean / max(size, TINY)
    rays = corners[rim]
    lowest = float((rays @ middle).min())
    if lowest <= 10 * THROUGH_CENTER:  # half of the sphere
        return np.vstack([_spread(rays), middle]), _NONE
    rays = _corners_of(rays, middle)
    circle = _as_circle(rays)
    if circle is not None:
        axis, lean = circle
        made = ring(np.zeros(3), axis, lean[0], lean, [(0.0, TURN)])
        return np.vstack([made.normals, axis]), made.outer_normals
    tilted = rays + blur * (rays - (rays @ middle)[:, None] * middle)
    return np.vstack([rays, middle]), tilted / np.linalg.norm(tilted, axis=1)[:, None]


def _corners_of(rays: Array, middle: Array) -> Array:
    """Rays without those between two others, about a middle one."""
    u, v = across(middle)
    depth = rays @ middle
    hull = convex_hull(np.column_stack([rays @ u / depth, rays @ v / depth]))
    size = float(np.ptp(hull, axis=0).max())
    tidied, count = tidy(hull[None], np.array([len(hull)]), np.array([DIRECTION_CORNER * size]))
    flat = tidied[0, : count[0]]
    corners = middle + flat[:, :1] * u + flat[:, 1:] * v
    unit: Array = corners / np.linalg.norm(corners, axis=1)[:, None]
    return unit


def _spread(corners: Array) -> Array:
    """Some of the directions, spread over all."""
    axes = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    wanted = axes[np.abs(axes).sum(axis=1) > 0].astype(float)
    chosen: Array = corners[np.unique(np.argmax(corners @ wanted.T, axis=0))]
    return chosen


def _as_circle(rays: Array) -> tuple[Array, tuple[float, float]] | None:
    """Axis and (sine, cosine) of a cone that all rays lie on, where they go around it."""
    if len(rays) < 8:
        return None
    center = rays.mean(axis=0)
    axis = np.linalg.svd(rays - center)[2][2]
    axis = axis if center @ axis > 0 else -axis
    height = rays @ axis
    if float(np.ptp(height)) > ROUND_CONE:
        return None
    u, v = across(axis)
    angle = np.sort(np.arctan2(rays @ v, rays @ u))
    if float(np.diff(np.append(angle, angle[0] + TURN)).max()) > np.pi / 4:
        return None
    cosine = float(height.mean())
    return axis, (float(np.sqrt(max(1 - cosine**2, 0.0))), cosine)


# cylinders and cones that are no whole bands ------------------------------------------


def unrolled_overlap(
    one: tuple[Array, Array], other: tuple[Array, Array], scale: float
) -> tuple[Array, Array, float]:
    """Angles, heights of corners of the common part of faces unrolled; its area [rad x length].

    Each face: angles and heights of its triangles, shape (m, 3).
    """
    flat_one = np.stack([one[0], one[1] / scale], axis=2)
    flat_other = np.stack([other[0], other[1] / scale], axis=2)
    shift = np.round((flat_one[:, :, 0].mean() - flat_other[:, :, 0].mean()) / TURN)
    turns = [np.array([TURN * (shift + k), 0.0]) for k in (-2, -1, 0, 1, 2)]
    flat_other = np.concatenate([flat_other + turn for turn in turns])
    boxes = [(p.min(axis=1), p.max(axis=1)) for p in (flat_one, flat_other)]
    boxes3 = [tuple(np.column_stack([c, np.zeros(len(c))]) for c in box) for box in boxes]
    owners = [np.zeros(len(p), dtype=np.int64) for p in (flat_one, flat_other)]
    corners, area = [np.empty((0, 2))], 0.0
    for _, i, j in joins(
        owners[0],
        (boxes3[0][0], boxes3[0][1]),
        owners[1],
        (boxes3[1][0], boxes3[1][1]),
        np.zeros(1),
    ):
        three = np.full(len(i), 3)
        points, count = clip_convex(_left(flat_one[i]), three, _left(flat_other[j]), three)
        size = polygon_area(points, count)
        keep = (count >= 3) & (size > LEAST_OVERLAP)
        real = (np.arange(points.shape[1]) < count[:, None]) & keep[:, None]
        corners.append(points[real])
        area += float(size[keep].sum())
    found = np.concatenate(corners)
    return found[:, 0], found[:, 1] * scale, area * scale
