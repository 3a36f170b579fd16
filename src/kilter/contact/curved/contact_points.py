"""Parts of a line or circle that a face covers, and contact points of curved contacts.

The triangles of a face represent it. A line of a surface with normal n lies on the face if the
plane through the line and n cuts the triangles; a point lies on it if the line along n meets a
triangle (`kilter.shape.covering`). Neighbouring triangles meet without gaps that way, and the ends
of a face across its generators are as exact as the corners of its triangles.

A frictionless contact transmits the cone of the wrenches of its points. With n(t) the unit
direction at angle t across an axis:

- Cylinder in cylinder: forces n(t) at heights z; a wrench is n(t) (x) (1, z), linear in the
  height, so the two ends of each generator suffice; and the n(t) of an arc are sums of
  any set of them that includes its ends and leaves no step of pi. The points are exact.
- Sphere in cylinder, torus in a bore or on a shaft: forces n(t) in a common plane: also exact.
- Line, point: exact.
- Circles and cones whose forces lean on the axis (sphere in cone, torus on plane, cone in
  cone) have a round cone of wrenches. `AROUND` points lie on it: the cone they span lies
  inside the true cone by this fraction, 1 - cos(pi / AROUND) = 9.5e-4 of its half width. The
  outer rows, half-way between the points and farther from the axis by 1 / cos(pi / AROUND),
  span a cone around the true cone: a verdict is given only if both agree.
- Sphere in sphere: forces through the centre. If the socket reaches around half of the
  sphere or more, the points are exact; else as above.

With friction the points between the extreme points matter too: around an axis they are at most
`STEP` apart, so that the forces between two of them fall short by 1 - cos(STEP / 2) = 3.4 %.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across, counted, cross, extents, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE
from kilter.contact.common.broad import joins
from kilter.contact.common.polygons import clip_convex, convex_hull, polygon_area, tidy
from kilter.contact.contact_tolerances import (
    APEX,
    BAND_FILLED,
    DIRECTION_CORNER,
    EDGE_ON,
    FULL_TURN,
    LEAN,
    LEAST_ARC,
    LEAST_OVERLAP,
    ROUND_CONE,
    SEAM_ANGLE,
    THROUGH_CENTER,
)

TURN = 2 * np.pi


def slices(triangles: Array, line: tuple[Array, Array, Array], reach: float, grow: float) -> Array:
    """Intervals of a straight line that lie on a face, shape (k, 2), sorted [length unit].

    `triangles`, shape (m, 3, 3): triangles of the face. `reach`: largest distance along n of
    triangles from the line; others belong to another side of the part [length unit].
    """
    x, d, n = line
    local = triangles - x
    aside = local @ cross(d, n)
    rows = np.flatnonzero((aside.min(axis=1) <= grow) & (aside.max(axis=1) >= -grow))
    if not len(rows):
        return np.empty((0, 2))
    aside, along, height = aside[rows], local[rows] @ d, local[rows] @ n
    reference = np.clip(0.0, aside.min(axis=1), aside.max(axis=1))[:, None]
    off = aside - reference
    following = np.roll(off, -1, axis=1)
    cuts = (off * following <= 0) & (off != following)
    share = np.where(cuts, off / np.where(cuts, off - following, 1.0), 0.0)
    cut_along = along + share * (np.roll(along, -1, axis=1) - along)
    cut_height = height + share * (np.roll(height, -1, axis=1) - height)
    # a corner in the plane is a position too, even if no side crosses the plane
    positions = np.concatenate(
        [np.where(cuts, cut_along, np.nan), np.where(off == 0, along, np.nan)], axis=1
    )
    heights = np.concatenate(
        [np.where(cuts, cut_height, 0.0), np.where(off == 0, height, 0.0)], axis=1
    )
    low = np.nanmin(positions, axis=1)
    high = np.nanmax(positions, axis=1)
    keep = np.abs(heights).max(axis=1) <= reach + grow
    return _merge_intervals(np.column_stack([low, high])[keep], grow)


def _merge_intervals(spans: Array, join: float) -> Array:
    """Merge sorted intervals, shape (k, 2), whose distance is at most `join`."""
    if not len(spans):
        return spans
    spans = spans[np.argsort(spans[:, 0])]
    end = np.maximum.accumulate(spans[:, 1])
    first = np.concatenate([[True], spans[1:, 0] > end[:-1] + join])
    last = np.concatenate([first[1:], [True]])
    return np.column_stack([spans[first, 0], end[last]])


def common_spans(first: Array, second: Array) -> Array:
    """Intersections of two sets of intervals, shape (k, 2)."""
    low = np.maximum(first[:, None, 0], second[None, :, 0]).ravel()
    high = np.minimum(first[:, None, 1], second[None, :, 1]).ravel()
    keep = high > low
    return np.column_stack([low[keep], high[keep]])


# cylinders and cones, unrolled --------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Bands:
    """Extent of each cylinder or cone face in angle about its axis and height along it."""

    low: Array
    high: Array
    """Least and greatest height along the axis above the point of the surface [length unit],
    shape (n,)."""
    begin: Array
    width: Array
    """Begin and length of the arc, shape (n,); 2 pi: all around [rad]."""
    whole: Mask
    """True if the face fills the band, shape (n,): a single arc, no holes, straight ends."""


def unrolled(geometry: Geometry, rows: Index) -> tuple[Index, Array, Array, Mask]:
    """Triangle corners of cylinders or cones as angle about the axis and height along it.

    Returns `owner`, shape (m,): position in `rows`; `angle`, `height`, shape (m, 3): angles [rad]
    and heights of the corners; the angles of a triangle do not jump by 2 pi.
    """
    surfaces = geometry.surfaces
    owner, triangle = ragged(surfaces.triangle_start, rows)
    names = surfaces.triangle[triangle]
    local = geometry.vertices[geometry.triangles[names]] - surfaces.point[rows][owner][:, None]
    u, v = across(surfaces.axis[rows])
    axis = surfaces.axis[rows]
    height = np.einsum("mki,mi->mk", local, axis[owner])
    x = np.einsum("mki,mi->mk", local, u[owner])
    y = np.einsum("mki,mi->mk", local, v[owner])
    angle = np.arctan2(y, x)
    reach = np.hypot(x, y)
    at_apex = reach < APEX * np.maximum(reach.max(axis=1), TINY)[:, None]
    at_apex &= (surfaces.kind[rows][owner] == CONE)[:, None]
    # angles within pi of a corner that has an angle
    base = np.where(at_apex[:, 0], angle[:, 1], angle[:, 0])[:, None]
    angle = base + np.remainder(angle - base + np.pi, TURN) - np.pi
    mean = np.where(at_apex, 0.0, angle).sum(axis=1) / np.maximum((~at_apex).sum(axis=1), 1)
    angle = np.where(at_apex, mean[:, None], angle)
    return owner, angle, height, at_apex.any(axis=1)


def bands_of(geometry: Geometry, rows: Index) -> Bands:
    """Extents in angle and height of the cylinder and cone faces in the given `rows`."""
    count = len(rows)
    owner, angle, height, tip = unrolled(geometry, rows)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    lowest, highest = extents(height)
    np.minimum.at(low, owner, lowest)
    np.maximum.at(high, owner, highest)
    (x0, x1, x2), (y0, y1, y2) = angle.T, height.T
    area = np.abs((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)) / 2
    area = np.bincount(owner, np.where(tip, 2 * area, area), minlength=count)
    begin, width, arcs = _arc_unions(owner, angle.min(axis=1), np.ptp(angle, axis=1), count)
    full = width * (high - low)
    whole = (arcs == 1) & (np.abs(area - full) <= BAND_FILLED * full)
    return Bands(low, high, begin, width, whole)


def _arc_unions(
    owner: Index, start: Array, length: Array, count: int
) -> tuple[Array, Array, Index]:
    """Union of the arcs of each owner: begin and length [rad], and the number of pieces."""
    start = np.remainder(start, TURN)
    order = np.lexsort((start, owner))
    owner, start = owner[order], start[order]
    lift = 100.0 * owner  # separates the owners in a common running maximum
    end = np.maximum.accumulate(start + length[order] + lift) - lift
    first = np.concatenate([[True], owner[1:] != owner[:-1]])
    last = np.concatenate([first[1:], [True]])
    around = end[last] - TURN  # end of arcs that cross the seam
    before = np.empty(len(owner))
    before[1:] = end[:-1]
    before[first] = around
    hole = start > np.maximum(before, around[owner]) + SEAM_ANGLE
    arcs = np.bincount(owner, hole, minlength=count).astype(np.int64)
    begin, width = np.zeros(count), np.full(count, TURN)
    begin[owner[hole]] = start[hole]
    single = np.flatnonzero(hole & (arcs[owner] == 1))
    gap = start[single] - np.maximum(before[single], around[owner[single]])
    width[owner[single]] = TURN - gap
    return begin, width, np.maximum(arcs, 1)


AROUND = 72
"""Number of points on a full circle of oblique forces; more points reduce the error."""
STEP = np.pi / 6
"""Largest angle between neighbouring points around an axis [rad]."""
PROBES = 144
"""Number of angles at which it is tested whether faces cover a circle."""
HALVINGS = 30
"""Bisection steps that locate the end of an arc."""


@dataclass(frozen=True, slots=True, eq=False)
class PatchPoints:
    """Contact points of a patch with unit normals, an enclosing set of points, and the area.

    The wrenches of the outer rows span a cone around the true cone; there are none if the points
    are exact.
    """

    points: Array
    normals: Array
    outer_points: Array
    outer_normals: Array
    area: float


_NO_ROWS = np.empty((0, 3))


def angles_between(begin: float, width: float, step: float) -> Array:
    """Evenly spaced angles along an arc, both ends included, at most `step` apart [rad].

    A full circle has no repeated end.

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
    """Arcs (begin, width) of the unit circle on which the function `inside` is true [rad].

    The circle is sampled at `PROBES` angles; the ends of each arc are then found by bisection.
    """
    angle = np.arange(PROBES, dtype=np.float64) * (TURN / PROBES)
    is_inside = inside(angle)
    if is_inside.all():
        return [(0.0, TURN)]
    if not is_inside.any():
        return []
    starts = np.flatnonzero(is_inside & ~np.roll(is_inside, 1))
    ends = np.flatnonzero(is_inside & ~np.roll(is_inside, -1))
    low = np.concatenate([angle[starts] - TURN / PROBES, angle[ends] + TURN / PROBES])
    high = np.concatenate([angle[starts], angle[ends]])  # low: outside, high: inside
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        middle_inside = inside(middle)
        low, high = np.where(middle_inside, low, middle), np.where(middle_inside, middle, high)
    begin, end = high[: len(starts)], high[len(starts) :]
    arcs = []
    for start in begin:
        width = np.remainder(end - start, TURN)
        arcs.append((float(start), float(width.min())))
    return arcs


def ring(
    center: Array, axis: Array, radius: float, lean: tuple[float, float],
    arcs: list[tuple[float, float]],
) -> PatchPoints:  # fmt: skip
    """Contact points with normals around a circle, or around arcs of it.

    `lean`: components of the normal away from the axis and along it [-]. `arcs`: arcs of contact
    around the axis [rad].
    """
    leaning = abs(lean[1]) > LEAN
    step = TURN / AROUND if leaning else STEP
    u, v = across(axis)
    points, normals, outer_points, outer_normals = [], [], [], []
    for begin, width in arcs:
        angle = angles_between(begin, width, step)
        points.append(_on_circle(center, u, v, radius, angle))
        normals.append(lean[0] * _directions_around(u, v, angle) + lean[1] * axis)
        if leaning:
            between, stretch = _outer_angles(angle, width)
            outer_points.append(_on_circle(center, u, v, radius * stretch, between))
            outer = lean[0] * stretch * _directions_around(u, v, between) + lean[1] * axis
            outer_normals.append(outer / np.linalg.norm(outer, axis=1)[:, None])
    return PatchPoints(
        np.concatenate(points), np.concatenate(normals),
        np.concatenate([_NO_ROWS, *outer_points]), np.concatenate([_NO_ROWS, *outer_normals]), 0.0,
    )  # fmt: skip


def _outer_angles(angle: Array, width: float) -> tuple[Array, float]:
    """Angles midway between points on a circle [rad], and radius factor of the tangents' corners.

    Tangents at neighbouring points of the unit circle meet at this distance from its centre.
    """
    following = np.append(angle[1:], angle[0] + TURN) if width >= TURN - FULL_TURN else angle[1:]
    current = angle[: len(following)]
    half = float((following - current).max(initial=0.0)) / 2
    return (current + following) / 2, 1 / np.cos(half)


def _directions_around(u: Array, v: Array, angle: Array) -> Array:
    """Unit directions at the given angles in the plane of unit vectors u and v, shape (n, 3)."""
    result: Array = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    return result


def _on_circle(center: Array, u: Array, v: Array, radius: float, angle: Array) -> Array:
    result: Array = center + radius * _directions_around(u, v, angle)
    return result


def shell(
    apex: Array, axis: Array, half_angle: float, radius: float,
    region: tuple[Array, Array], outer: tuple[Array, Array] | None,
) -> PatchPoints:  # fmt: skip
    """Contact points with normals on a cylinder or cone, at given angles and heights.

    `outer` holds angles and heights of a region around the true region, if the points are not
    exact; else None.
    """
    u, v = across(axis)
    cosine, sine = np.cos(half_angle), np.sin(half_angle)

    def points_at(angle: Array, height: Array, stretch: float) -> tuple[Array, Array]:
        away = _directions_around(u, v, angle)
        reach = (radius + height * np.tan(half_angle)) * stretch
        points = apex + height[:, None] * axis + reach[:, None] * away
        normals = cosine * stretch * away - sine * axis
        return points, normals / np.linalg.norm(normals, axis=1)[:, None]

    points, normals = points_at(*region, 1.0)
    if outer is None:
        return PatchPoints(points, normals, _NO_ROWS, _NO_ROWS, 0.0)
    stretch = 1.0 if half_angle == 0 else 1 / float(np.cos(np.pi / AROUND))
    return PatchPoints(points, normals, *points_at(*outer, stretch), 0.0)


# sphere in sphere ---------------------------------------------------------------------


def socket(
    center: Array, radius: float, first: Array, second: Array, sagitta: float
) -> PatchPoints | None:
    """Contact points of a ball in a socket: two faces, as triangles, of the same sphere.

    The triangles have the shape (m, 3, 3). None if the faces do not overlap.

    The normals point outwards from the centre. `sagitta` is the largest height of the sphere over
    its triangles [length unit]. None if the faces do not overlap.
    """
    corners, area_vectors = _common_part(first - center, second - center)
    if not len(corners):
        return None
    area = float(np.linalg.norm(area_vectors, axis=1).sum()) * radius**2
    total = area_vectors.sum(axis=0)
    directions, outer_directions = _spanning_directions(corners, total, 2 * sagitta / radius)
    return PatchPoints(
        center + radius * directions,
        directions,
        center + radius * outer_directions if len(outer_directions) else _NO_ROWS,
        outer_directions,
        area,
    )


def _common_part(first: Array, second: Array) -> tuple[Array, Array]:
    """Overlap of two faces on the unit sphere: corners, shape (n, 3), and area vectors, (k, 3).

    Triangles are clipped in the gnomonic projection, in which great circles are straight lines.
    """
    first = first / np.linalg.norm(first, axis=2)[..., None]
    second = second / np.linalg.norm(second, axis=2)[..., None]
    i, j = _box_pairs(first, second)
    middle = first[i].mean(axis=1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    # the projection needs both triangles on the same side of the centre
    front = np.einsum("nki,ni->nk", second[j], middle).min(axis=1) > 0.05
    i, j, middle = i[front], j[front], middle[front]
    u, v = across(middle)
    flat_i, flat_j = (_gnomonic(p, middle, u, v) for p in (first[i], second[j]))
    three = np.full(len(i), 3)
    points, count = clip_convex(_anticlockwise(flat_i), three, _anticlockwise(flat_j), three)
    area = polygon_area(points, count)
    keep = np.flatnonzero((count >= 3) & (area > LEAST_OVERLAP))
    points, count, area = points[keep], count[keep], area[keep]
    is_corner = np.arange(points.shape[1]) < count[:, None]
    piece_of_corner = np.repeat(keep, count)
    flat_corners = points[is_corner]
    corners = (
        middle[piece_of_corner]
        + flat_corners[:, :1] * u[piece_of_corner]
        + flat_corners[:, 1:] * v[piece_of_corner]
    )
    corners /= np.linalg.norm(corners, axis=1)[:, None]
    return corners, _solid_angles(corners, count)[:, None] * middle[keep]


def _solid_angles(corners: Array, count: Index) -> Array:
    """Solid angle of each polygon on the unit sphere, given by its corners in order [sr], (n,).

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


def _box_pairs(first: Array, second: Array) -> tuple[Index, Index]:
    """Pairs of triangles on the unit sphere, one of each face, whose bounding boxes meet."""
    zeros = np.zeros(1)
    blocks = [(np.empty(0, np.int64), np.empty(0, np.int64))]
    boxes = [extents(p) for p in (first, second)]
    owners = [np.zeros(len(p), dtype=np.int64) for p in (first, second)]
    margin = 0.02  # a triangle lies below the sphere that it represents
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], zeros + margin):
        blocks.append((i, j))
    i, j = (np.concatenate([f[k] for f in blocks]) for k in range(2))
    return i, j


def _gnomonic(points: Array, middle: Array, u: Array, v: Array) -> Array:
    """Projection of points, shape (n, k, 3), from the origin to the tangent planes at `middle`."""
    depth = np.maximum(np.einsum("nki,ni->nk", points, middle), EDGE_ON)
    flat = [np.einsum("nki,ni->nk", points, w) / depth for w in (u, v)]
    return np.stack(flat, axis=2)


def _anticlockwise(triangles: Array) -> Array:
    """Triangles, shape (n, 3, 2), with corners in anticlockwise order."""
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    right = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    result: Array = np.where(right[:, None, None], triangles[:, ::-1], triangles)
    return result


def _spanning_directions(corners: Array, mean: Array, blur: float) -> tuple[Array, Array]:
    """Unit directions that span a cone inside that of `corners`, and others that enclose it.

    The second array is empty if the first is exact. `blur` is the largest error of the rim [rad].
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(np.vstack([corners, np.zeros(3)]))
    size = float(np.linalg.norm(mean))
    through = np.abs(hull.equations[:, 3]) <= THROUGH_CENTER
    if not through.any():  # the centre lies inside the hull: every force is possible
        return _spread_subset(corners), _NO_ROWS
    rim = np.unique(hull.simplices[through])
    rim = rim[rim < len(corners)]
    middle = mean / max(size, TINY)
    rays = corners[rim]
    lowest = float((rays @ middle).min())
    if lowest <= 10 * THROUGH_CENTER:  # the socket reaches around half of the sphere
        return np.vstack([_spread_subset(rays), middle]), _NO_ROWS
    rays = _extreme_rays(rays, middle)
    circle = _as_circle(rays)
    if circle is not None:
        axis, lean = circle
        circle_points = ring(np.zeros(3), axis, lean[0], lean, [(0.0, TURN)])
        return np.vstack([circle_points.normals, axis]), circle_points.outer_normals
    # no circle: widen the rays by the error of the rim
    tilted = rays + blur * (rays - (rays @ middle)[:, None] * middle)
    return np.vstack([rays, middle]), tilted / np.linalg.norm(tilted, axis=1)[:, None]


def _extreme_rays(rays: Array, middle: Array) -> Array:
    """The extreme rays among `rays`: those that span the cone of all of them."""
    u, v = across(middle)
    depth = rays @ middle
    hull = convex_hull(np.column_stack([rays @ u / depth, rays @ v / depth]))
    size = float(np.ptp(hull, axis=0).max())
    tidied, count = tidy(hull[None], np.array([len(hull)]), np.array([DIRECTION_CORNER * size]))
    flat = tidied[0, : count[0]]
    corners = middle + flat[:, :1] * u + flat[:, 1:] * v
    unit: Array = corners / np.linalg.norm(corners, axis=1)[:, None]
    return unit


def _spread_subset(corners: Array) -> Array:
    """Directions of `corners` that are farthest along each of 26 fixed directions."""
    grid = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    targets = grid[np.abs(grid).sum(axis=1) > 0].astype(float)
    chosen: Array = corners[np.unique(np.argmax(corners @ targets.T, axis=0))]
    return chosen


def _as_circle(rays: Array) -> tuple[Array, tuple[float, float]] | None:
    """Axis and (sine, cosine) of the circular cone on which all rays lie; None if they do not."""
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
    # a partial circle is not the whole cone
    if float(np.diff(np.append(angle, angle[0] + TURN)).max()) > np.pi / 4:
        return None
    cosine = float(height.mean())
    return axis, (float(np.sqrt(max(1 - cosine**2, 0.0))), cosine)


# cylinders and cones that are not whole bands ------------------------------------------


def unrolled_overlap(
    first: tuple[Array, Array], second: tuple[Array, Array], scale: float
) -> tuple[Array, Array, float, bool]:
    """Overlap of two faces that are unrolled to angle and height: corners, area, and its form.

    The area has the unit rad x length unit. The last value is True if the overlap consists of
    whole bands: it has the same heights at each of its angles.

    Each face is given by angles [rad] and heights of its triangles, shape (m, 3). `scale` is a
    length that makes heights comparable with angles.
    """
    flat_first = np.stack([first[0], first[1] / scale], axis=2)
    flat_second = np.stack([second[0], second[1] / scale], axis=2)
    # copies of the second face, whole turns apart, reach every angle of the first
    shift = np.round((flat_first[:, :, 0].mean() - flat_second[:, :, 0].mean()) / TURN)
    turns = [np.array([TURN * (shift + k), 0.0]) for k in (-2, -1, 0, 1, 2)]
    flat_second = np.concatenate([flat_second + turn for turn in turns])
    boxes = [extents(p) for p in (flat_first, flat_second)]
    padded_boxes = [tuple(np.column_stack([c, np.zeros(len(c))]) for c in box) for box in boxes]
    owners = [np.zeros(len(p), dtype=np.int64) for p in (flat_first, flat_second)]
    corners, boxes_of_pieces, area = [np.empty((0, 2))], [np.empty((0, 2, 2))], 0.0
    for _, i, j in joins(
        owners[0],
        (padded_boxes[0][0], padded_boxes[0][1]),
        owners[1],
        (padded_boxes[1][0], padded_boxes[1][1]),
        np.zeros(1),
    ):
        three = np.full(len(i), 3)
        points, count = clip_convex(
            _anticlockwise(flat_first[i]), three, _anticlockwise(flat_second[j]), three
        )
        size = polygon_area(points, count)
        keep = (count >= 3) & (size > LEAST_OVERLAP)
        is_corner = (np.arange(points.shape[1]) < count[:, None]) & keep[:, None]
        corners.append(points[is_corner])
        inner = is_corner[keep][:, :, None]
        low = np.where(inner, points[keep], np.inf).min(axis=1)
        high = np.where(inner, points[keep], -np.inf).max(axis=1)
        boxes_of_pieces.append(np.stack([low, high], axis=1))
        area += float(size[keep].sum())
    stacked = np.concatenate(corners)
    filled = _fills_bands(np.concatenate(boxes_of_pieces), area)
    return stacked[:, 0], stacked[:, 1] * scale, area * scale, filled


def _fills_bands(boxes: Array, area: float) -> bool:
    """Whether pieces fill bands: all their angles times all their heights.

    `boxes`, shape (n, 2, 2): least and greatest angle [rad] and scaled height of each piece.
    """
    if not len(boxes):
        return False
    angles, heights = boxes.transpose(2, 1, 0)
    _, width, arcs = _arc_unions(np.zeros(boxes.shape[0], dtype=np.int64), angles[0],
                                 angles[1] - angles[0], 1)  # fmt: skip
    order = np.argsort(heights[0], kind="stable")
    reached = np.maximum.accumulate(heights[1][order])
    gaps = np.maximum(heights[0][order][1:] - reached[:-1], 0.0)
    tall = float(reached[-1] - heights[0][order][0] - gaps.sum())
    full = float(width[0]) * tall
    return int(arcs[0]) == 1 and abs(area - full) <= BAND_FILLED * full
