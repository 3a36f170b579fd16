"""Exact separation of displaced parts, by separating planes and distances of their bodies.

Two convex bodies are apart iff a plane separates them,

    s(n) = min over B of n.x - max over A of n.x > 0       for some unit n.

For polyhedra the greatest s is attained at a face normal of either body, or at the cross product of
two edges. For cylinders any n with s(n) > 0 is a proof; the search starts at the contact normals. A
ball is apart from a polyhedron, convex or not, if its centre is outside and farther from each
triangle than its radius. A solid with faces on balls and cylinders is replaced by these whole balls
and cylinders if they contain its flat faces, because they cover its surface. A polyhedron that is
not convex is replaced by its triangles, because a body that crosses its surface cuts a triangle.
For other shapes the separation is unknown.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross, distinct_rows, unit_rows
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, SPHERE
from kilter.contact.common.distances import surface_distance
from kilter.mechanics.program import Program
from kilter.rigid import turn_of
from kilter.second_order.second_order_tolerances import ACROSS, KEEPS
from kilter.shape.primitives import Cylinder, Sphere

CONVEX = 1e-9
"""A polyhedron is convex if no corner is farther outside a face than this, over its size [-]."""


ON_QUARTIC = 8
"""An edge with more points than this on a circle is the circle.

A torus that does not contain a circle meets it in at most 8 points, and a quadric in at most 4.
"""

FAN, ZOOMS = 33, 8
"""Number of directions in a fan, and number of fans, each narrower about the best direction."""

SIMPLEX = 1e-3
"""Size of the first simplex about the best direction [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class ConvexBody:
    """A convex body: a polyhedron, a ball or a cylinder.

    `corners`, shape (m, 3), span the polyhedron if `radius` is 0. With a radius but no `axis` the
    body is a ball about its corner; with an axis it is a cylinder between its corners. `normals`
    and `edges` are the unit face normals and edge directions of a polyhedron.
    """

    corners: Array
    radius: float = 0.0
    axis: Array | None = None
    normals: Array | None = None
    edges: Array | None = None

    def moved(self, center: Array, shift: Array, turn: Array) -> ConvexBody:
        """The body after the motion x -> center + shift + turn (x - center)."""
        corners = (self.corners - center) @ turn.T + center + shift
        parts = (self.axis, self.normals, self.edges)
        axis, normals, edges = (None if rows is None else rows @ turn.T for rows in parts)
        return ConvexBody(corners, self.radius, axis, normals, edges)

    def reach(self, directions: Array) -> Array:
        """Largest n.x over the points x of the body, for each direction n, shape (k,)."""
        most: Array = (self.corners @ directions.T).max(axis=0)
        if self.radius == 0:
            return most
        if self.axis is None:
            return most + self.radius
        along = directions @ self.axis
        return most + self.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0))


def bodies_of(assembly: Assembly, part: int) -> list[ConvexBody] | None:
    """Convex bodies whose surfaces cover the boundary of a part; None for other shapes."""
    shape, geometry = assembly.parts[part].shape, assembly.geometry
    pose = assembly.parts[part].pose
    if isinstance(shape, Sphere):
        return [ConvexBody(pose.position[None], shape.radius)]
    if isinstance(shape, Cylinder):
        axis = pose.matrix[:, 2]
        ends = pose.position + np.outer([0.5, -0.5], axis) * shape.height
        return [ConvexBody(ends, shape.radius, axis)]
    if geometry.surfaces.start[part] != geometry.surfaces.start[part + 1]:
        return _round_pieces(geometry, part)
    triangles = geometry.corners_of(part)
    normals = unit_rows(_normals(triangles))
    corners, _ = distinct_rows(triangles.reshape(-1, 3))
    outside = (corners @ normals.T - np.einsum("ij,ij->i", triangles[:, 0], normals)).max(initial=0)
    if outside <= CONVEX * geometry.size[part]:
        return [_hull(triangles, corners)]
    return [_hull(triangle[None], triangle) for triangle in triangles]


def _round_pieces(geometry: Geometry, part: int) -> list[ConvexBody] | None:
    """Whole balls and cylinders that enclose a round part; None if its faces exceed them."""
    s, near = geometry.surfaces, CONVEX * float(geometry.size[part])
    pieces = []
    for row in range(s.start[part], s.start[part + 1]):
        if s.kind[row] not in (SPHERE, CYLINDER) or s.hollow[row] or s.doubt[row] > 0:
            return None
        radius = float(s.radius[row])
        if s.kind[row] == SPHERE:
            pieces.append(ConvexBody(s.point[row][None], radius))
            continue
        axis = s.axis[row]
        corners = geometry.vertices[np.unique(geometry.triangles[s.triangles_of(row)])]
        along = (corners - s.point[row]) @ axis
        low, high = float(along.min()), float(along.max())
        ends = along - low <= near, high - along <= near
        straight = min(int(end.sum()) for end in ends) > ON_QUARTIC
        if not straight or not (ends[0] | ends[1]).all():
            return None  # an oblique end reaches farther than its corners
        pieces.append(ConvexBody(s.point[row] + np.outer([low, high], axis), radius, axis))
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    flat = geometry.vertices[geometry.triangles[span][geometry.triangle_surface[span] < 0]]
    points = flat.reshape(-1, 3)
    within = [_is_within(piece, points, near).reshape(-1, 3).all(axis=1) for piece in pieces]
    return pieces if np.any(within, axis=0).all() else None


def _is_within(body: ConvexBody, points: Array, near: float) -> Mask:
    """Mask of points, (n, 3), inside a ball or cylinder enlarged by `near`, shape (n,)."""
    off = points - body.corners[0]
    if body.axis is None:
        return np.asarray(np.linalg.norm(off, axis=1) <= body.radius + near)
    along = off @ body.axis
    length = float((body.corners[-1] - body.corners[0]) @ body.axis)
    out = np.linalg.norm(off - along[:, None] * body.axis, axis=1)
    return np.asarray((out <= body.radius + near) & (along >= -near) & (along <= length + near))


def _normals(triangles: Array) -> Array:
    return cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def _hull(triangles: Array, corners: Array) -> ConvexBody:
    """Convex polyhedron (or triangle) with the normals of its faces and its edge directions."""
    edges = np.concatenate([triangles[:, k] - triangles[:, k - 1] for k in range(3)])
    normals = unit_rows(_normals(triangles))
    if len(triangles) == 1:
        normals = np.vstack([normals, -normals, unit_rows(np.cross(edges, normals))])
    edges = unit_rows(edges)
    edges = edges * np.where(edges @ np.array([1.0, 1e-3, 1e-6]) < 0, -1.0, 1.0)[:, None]
    _, first = np.unique(np.round(edges, 9), axis=0, return_index=True)
    _, other = np.unique(np.round(normals, 9), axis=0, return_index=True)
    return ConvexBody(corners, normals=normals[other], edges=edges[first])


def separation(a: ConvexBody, b: ConvexBody, hints: Array) -> float:
    """Largest gap between two bodies along any tried direction [length unit]."""
    return parting(a, b, hints)[0]


def parting(a: ConvexBody, b: ConvexBody, hints: Array, tries: int = 1000) -> tuple[float, Array]:
    """Largest gap between two bodies along any tried direction, and this direction."""
    if a.radius == 0 and b.radius == 0:
        assert a.normals is not None
        assert b.normals is not None
        assert a.edges is not None
        assert b.edges is not None
        both = cross(np.repeat(a.edges, len(b.edges), axis=0), np.tile(b.edges, (len(a.edges), 1)))
        size = np.linalg.norm(both, axis=1)
        both = both[size > 1e-6] / size[size > 1e-6][:, None]
        directions = np.vstack([a.normals, -b.normals, both, -both])
        values = _gaps_along(a, b, directions)
        best = int(values.argmax())
        return float(values[best]), np.asarray(directions[best])
    if len(a.corners) == len(b.corners) == 1 and a.axis is None and b.axis is None:
        between = b.corners[0] - a.corners[0]
        return float(np.linalg.norm(between)) - a.radius - b.radius, unit_rows(between[None])[0]
    middle = b.corners.mean(axis=0) - a.corners.mean(axis=0)
    near = hints[:1] if len(hints) else middle[None]
    directions = unit_rows(np.vstack([hints, middle, *_across_axes(a, b, near)]))
    start = directions[int(_gaps_along(a, b, directions).argmax())]

    from scipy.optimize import minimize  # takes its time

    def cost(n: Array) -> float:
        return -float(_gaps_along(a, b, unit_rows(n[None]))[0])

    simplex = start + SIMPLEX * np.vstack([np.zeros(3), np.eye(3)])
    options = {"xatol": 1e-12, "fatol": 1e-14, "initial_simplex": simplex, "maxfev": tries}
    answer = minimize(cost, start, method="Nelder-Mead", options=options)
    best = answer.x if answer.fun <= cost(start) else start
    return -cost(best), unit_rows(best[None])[0]


def _across_axes(a: ConvexBody, b: ConvexBody, near: Array) -> list[Array]:
    """Directions, from the axes of cylinders, that may separate two bodies.

    Along an axis, across both axes, and the best direction across each axis.
    """
    axes = [body.axis for body in (a, b) if body.axis is not None]
    directions = [sign * axis for axis in axes for sign in (1.0, -1.0)]
    if len(axes) == 2:
        both = np.cross(axes[0], axes[1])
        directions += [both, -both]
    for axis in axes:
        u, v = across(axis)
        middle, span = float(np.arctan2(near[0] @ v, near[0] @ u)), np.pi
        for _ in range(ZOOMS):  # where s is positive along the circle, it has a single maximum
            angle = middle + span * np.linspace(-1.0, 1.0, FAN)
            fan = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)
            best = int(_gaps_along(a, b, fan).argmax())
            middle, span = float(angle[best]), 2 * span / (FAN - 1)
        directions.append(fan[best])
    return directions


def _gaps_along(a: ConvexBody, b: ConvexBody, directions: Array) -> Array:
    """Gap between bodies a and b along each of several directions, shape (k,)."""
    return np.asarray(-b.reach(-directions) - a.reach(directions))


def least_separation(
    assembly: Assembly,
    program: Program,
    motion: Array,
    *,
    beyond: float,
    planes: Mask | None = None,
    tied: Index | None = None,
    jointed: Collection[frozenset[int]] = (),
) -> float | None:
    """Least separation of displaced parts, at most `beyond` [length unit]; None if unknown.

    Arguments: `motion` (N, 6) [length unit, rad]; `beyond` [length unit]; `planes` (K,); `tied`
    (N,). Returns negative if no separating plane was found; None if the separation of a pair is
    unknown.
    """
    count = len(program.names)
    turns = [turn_of(motion[k, 3:]) for k in range(count)]
    moved: dict[int, list[ConvexBody] | None] = {}
    least = beyond
    for i in range(count):
        for j in range(i + 1, count):
            if not (program.free[i] or program.free[j]) or _far(assembly, motion, (i, j), beyond):
                continue
            if (tied is not None and tied[i] == tied[j]) or frozenset((i, j)) in jointed:
                continue
            for k in (i, j):
                if k not in moved:
                    bodies = bodies_of(assembly, k)
                    moved[k] = bodies and [
                        body.moved(program.center[k], motion[k, :3], turns[k]) for body in bodies
                    ]
            first, second = moved[i], moved[j]
            if first is None or second is None:
                return None
            touching = ((program.part_a == i) & (program.part_b == j)) | (
                (program.part_a == j) & (program.part_b == i)
            )
            sense = np.where(program.part_a[touching] == i, 1.0, -1.0)
            normals = program.normal[touching] * sense[:, None]
            if planes is not None and planes[touching].any():
                before = bodies_of(assembly, i), bodies_of(assembly, j)
                size = float(program.radius[[i, j]].min())
                if _parted_as_before(before, (first, second), normals[planes[touching]], size):
                    continue
            least = min(least, _pair_separation(first, second, normals, least))
    return least


Pieces = list[ConvexBody] | None


def _parted_as_before(
    before: tuple[Pieces, Pieces], now: tuple[Pieces, Pieces], normals: Array, size: float
) -> bool:
    """True if a plane at a contact normal still separates two parts as well as before."""
    was, is_ = (
        np.min([_gaps_along(a, b, normals) for a in first or () for b in second or ()], axis=0)
        for first, second in (before, now)
    )
    return bool(((was > -ACROSS * size) & (is_ >= was - KEEPS * size)).any())


def _far(assembly: Assembly, motion: Array, pair: tuple[int, int], beyond: float) -> bool:
    """True if the boxes of two moved parts are farther apart than `beyond`."""
    geometry = assembly.geometry
    low, high = geometry.part_boxes
    i, j = pair
    most = np.linalg.norm(motion[:, :3], axis=1) + geometry.radius * np.linalg.norm(
        motion[:, 3:], axis=1
    )
    room = beyond + float(most[i] + most[j] + geometry.slack[i] + geometry.slack[j])
    return bool((np.maximum(low[i] - high[j], low[j] - high[i]) > room).any())


def _pair_separation(
    first: list[ConvexBody], second: list[ConvexBody], hints: Array, least: float
) -> float:
    """Least separation of the bodies of two parts, at most `least` [length unit]."""
    for a in first:
        for b in second:
            gap = np.maximum(
                b.corners.min(axis=0) - a.corners.max(axis=0),
                a.corners.min(axis=0) - b.corners.max(axis=0),
            ).max()
            if gap - a.radius - b.radius >= least:
                continue
            ball = a if a.axis is None and a.radius > 0 else b
            other = b if ball is a else a
            if ball.radius > 0 and ball.axis is None and other.radius == 0:
                least = min(least, _ball_separation(ball, other))
            else:
                least = min(least, separation(a, b, hints))
    return least


def _ball_separation(ball: ConvexBody, other: ConvexBody) -> float:
    """Separation of a ball from a polyhedron or a triangle [length unit]."""
    assert other.normals is not None
    if len(other.corners) == 3:
        return float(surface_distance(ball.corners, other.corners[None])[0]) - ball.radius
    return separation_of_point(other, ball.corners[0]) - ball.radius


def separation_of_point(body: ConvexBody, point: Array) -> float:
    """Distance of a point from a convex polyhedron [length unit]; negative inside."""
    return parting_point(body, point)[0]


def parting_point(body: ConvexBody, point: Array) -> tuple[float, Array]:
    """Distance of a point from a convex polyhedron or triangle, and the direction from it."""
    assert body.normals is not None
    assert body.edges is not None
    heights = body.normals @ point - body.reach(body.normals)
    if heights.max() <= 0:
        return float(heights.max()), np.asarray(body.normals[int(heights.argmax())])
    apart = point - body.corners
    aside = apart[:, None] - (apart @ body.edges.T)[..., None] * body.edges
    directions = np.vstack([body.normals, apart, aside.reshape(-1, 3)])
    directions = unit_rows(directions[(directions != 0).any(axis=1)])
    values = directions @ point - body.reach(directions)
    best = int(values.argmax())
    return float(values[best]), np.asarray(directions[best])
