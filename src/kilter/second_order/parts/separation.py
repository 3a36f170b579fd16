"""Whether parts in other places are apart: exact, pair by pair, by planes and distances.

Two convex bodies are apart iff a plane parts them,

    s(n) = min over B of n.x - max over A of n.x > 0       for some unit n.

Of polyhedra the greatest s is that of a normal of a face of either, or of the cross product of two
edges. Of cylinders any n with s(n) > 0 is proof enough; it is sought from the normals of contact. A
ball is apart from a polyhedron, convex or not, where its centre is outside and farther from each
triangle than its radius. A solid whose curved faces are of balls and cylinders is taken as those,
whole, where its flat faces lie within them: that is no less than its surface. What is no ball,
cylinder or polyhedron otherwise has no answer here.
A polyhedron that is not convex is taken as its triangles: whatever crosses its surface cuts one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross, distinct_rows, unit_rows
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, SPHERE
from kilter.contact.triangle_distance import surface_distance
from kilter.mechanics.program import Program
from kilter.second_order.second_order_tolerances import ACROSS, KEEPS
from kilter.shape.primitives import Cylinder, Sphere

__all__ = [
    "Body",
    "bodies_of",
    "least_separation",
    "parting",
    "parting_point",
    "separation",
    "turn_of",
]

CONVEX = 1e-9
"""No corner of a convex polyhedron is farther outside a face than this, over its size."""


ON_QUARTIC = 8
"""A torus that does not hold a circle meets it in up to 8 points, a quadric in 4: an edge of more
of its points is the circle."""

FAN, ZOOMS = 33, 8
"""Directions across an axis that are tried at once, and how often those around the best are."""

SIMPLEX = 1e-3
"""How far about the best of those a direction is sought."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A convex body: the hull of corners (m, 3), rounded by a disc or a ball.

    `radius` 0: the hull itself. `axis` None: all points within the radius of it, a ball; else
    the hull of discs of that radius across the axis, a cylinder.
    """

    corners: Array
    radius: float = 0.0
    axis: Array | None = None
    normals: Array | None = None
    edges: Array | None = None

    def moved(self, center: Array, shift: Array, turn: Array) -> Body:
        """After x -> center + shift + turn (x - center)."""
        rows = (self.corners - center) @ turn.T + center + shift
        parts = (self.axis, self.normals, self.edges)
        axis, normals, edges = (None if one is None else one @ turn.T for one in parts)
        return Body(rows, self.radius, axis, normals, edges)

    def reach(self, directions: Array) -> Array:
        """Max of n.x, shape (k,), for unit directions, shape (k, 3)."""
        most: Array = (self.corners @ directions.T).max(axis=0)
        if self.radius == 0:
            return most
        if self.axis is None:
            return most + self.radius
        along = directions @ self.axis
        return most + self.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0))


def bodies_of(assembly: Assembly, part: int) -> list[Body] | None:
    """Convex pieces of a part whose surfaces are all of its boundary; None of other kinds."""
    shape, geometry = assembly.parts[part].shape, assembly.geometry
    pose = assembly.parts[part].pose
    if isinstance(shape, Sphere):
        return [Body(pose.position[None], shape.radius)]
    if isinstance(shape, Cylinder):
        axis = pose.matrix[:, 2]
        ends = pose.position + np.outer([0.5, -0.5], axis) * shape.height
        return [Body(ends, shape.radius, axis)]
    if geometry.surfaces.start[part] != geometry.surfaces.start[part + 1]:
        return _round_pieces(geometry, part)
    triangles = geometry.corners_of(part)
    normals = unit_rows(_normals(triangles))
    corners, _ = distinct_rows(triangles.reshape(-1, 3))
    outside = (corners @ normals.T - np.einsum("ij,ij->i", triangles[:, 0], normals)).max(initial=0)
    if outside <= CONVEX * geometry.size[part]:
        return [_hull(triangles, corners)]
    return [_hull(one[None], one) for one in triangles]


def _round_pieces(geometry: Geometry, part: int) -> list[Body] | None:
    """Whole balls and cylinders that hold all faces of a part; None where they do not."""
    s, near = geometry.surfaces, CONVEX * float(geometry.size[part])
    pieces = []
    for row in range(s.start[part], s.start[part + 1]):
        if s.kind[row] not in (SPHERE, CYLINDER) or s.hollow[row] or s.doubt[row] > 0:
            return None
        radius = float(s.radius[row])
        if s.kind[row] == SPHERE:
            pieces.append(Body(s.point[row][None], radius))
            continue
        axis = s.axis[row]
        corners = geometry.vertices[np.unique(geometry.triangles[s.triangles_of(row)])]
        along = (corners - s.point[row]) @ axis
        low, high = float(along.min()), float(along.max())
        ends = along - low <= near, high - along <= near
        straight = min(int(end.sum()) for end in ends) > ON_QUARTIC
        if not straight or not (ends[0] | ends[1]).all():
            return None  # an end that is not straight across reaches farther than its corners
        pieces.append(Body(s.point[row] + np.outer([low, high], axis), radius, axis))
    own = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    flat = geometry.vertices[geometry.triangles[own][geometry.triangle_surface[own] < 0]]
    within = [_within(one, flat.reshape(-1, 3), near).reshape(-1, 3).all(axis=1) for one in pieces]
    return pieces if np.any(within, axis=0).all() else None


def _within(body: Body, points: Array, near: float) -> Mask:
    """Whether points are in a ball or a cylinder, shape (n,)."""
    off = points - body.corners[0]
    if body.axis is None:
        return np.asarray(np.linalg.norm(off, axis=1) <= body.radius + near)
    along = off @ body.axis
    length = float((body.corners[-1] - body.corners[0]) @ body.axis)
    out = np.linalg.norm(off - along[:, None] * body.axis, axis=1)
    return np.asarray((out <= body.radius + near) & (along >= -near) & (along <= length + near))


def _normals(triangles: Array) -> Array:
    return cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def _hull(triangles: Array, corners: Array) -> Body:
    """A convex polyhedron, or one triangle, with the directions that may part it from others."""
    edges = np.concatenate([triangles[:, k] - triangles[:, k - 1] for k in range(3)])
    normals = unit_rows(_normals(triangles))
    if len(triangles) == 1:
        normals = np.vstack([normals, -normals, unit_rows(np.cross(edges, normals))])
    edges = unit_rows(edges)
    edges = edges * np.where(edges @ np.array([1.0, 1e-3, 1e-6]) < 0, -1.0, 1.0)[:, None]
    _, first = np.unique(np.round(edges, 9), axis=0, return_index=True)
    _, other = np.unique(np.round(normals, 9), axis=0, return_index=True)
    return Body(corners, normals=normals[other], edges=edges[first])


def separation(a: Body, b: Body, hints: Array) -> float:
    """The greatest s(n) that is found, from a to b; `hints`, shape (k, 3): where to begin."""
    return parting(a, b, hints)[0]


def parting(a: Body, b: Body, hints: Array, tries: int = 1000) -> tuple[float, Array]:
    """The greatest s(n) that is found, and its n, from a to b; at cylinders in so many tries."""
    if a.radius == 0 and b.radius == 0:
        assert a.normals is not None
        assert b.normals is not None
        assert a.edges is not None
        assert b.edges is not None
        both = cross(np.repeat(a.edges, len(b.edges), axis=0), np.tile(b.edges, (len(a.edges), 1)))
        size = np.linalg.norm(both, axis=1)
        both = both[size > 1e-6] / size[size > 1e-6][:, None]
        tried = np.vstack([a.normals, -b.normals, both, -both])
        values = _parted(a, b, tried)
        best = int(values.argmax())
        return float(values[best]), np.asarray(tried[best])
    if len(a.corners) == len(b.corners) == 1 and a.axis is None and b.axis is None:
        between = b.corners[0] - a.corners[0]
        return float(np.linalg.norm(between)) - a.radius - b.radius, unit_rows(between[None])[0]
    middle = b.corners.mean(axis=0) - a.corners.mean(axis=0)
    tried = np.vstack([hints, middle, *_of_axes(a, b, hints[:1] if len(hints) else middle[None])])
    tried = unit_rows(tried)
    start = tried[int(_parted(a, b, tried).argmax())]

    from scipy.optimize import minimize  # takes its time

    def worth(n: Array) -> float:
        return -float(_parted(a, b, unit_rows(n[None]))[0])

    simplex = start + SIMPLEX * np.vstack([np.zeros(3), np.eye(3)])
    options = {"xatol": 1e-12, "fatol": 1e-14, "initial_simplex": simplex, "maxfev": tries}
    found = minimize(worth, start, method="Nelder-Mead", options=options)
    best = found.x if found.fun <= worth(start) else start
    return -worth(best), unit_rows(best[None])[0]


def _of_axes(a: Body, b: Body, near: Array) -> list[Array]:
    """Directions in which cylinders touch by an end, side by side, or by a side at anything."""
    axes = [one.axis for one in (a, b) if one.axis is not None]
    found = [sign * axis for axis in axes for sign in (1.0, -1.0)]
    if len(axes) == 2:
        both = np.cross(axes[0], axes[1])
        found += [both, -both]
    for axis in axes:
        u, v = across(axis)
        middle, span = float(np.arctan2(near[0] @ v, near[0] @ u)), np.pi
        for _ in range(ZOOMS):  # s is a hill along the circle where it is positive
            angle = middle + span * np.linspace(-1.0, 1.0, FAN)
            fan = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)
            best = int(_parted(a, b, fan).argmax())
            middle, span = float(angle[best]), 2 * span / (FAN - 1)
        found.append(fan[best])
    return found


def _parted(a: Body, b: Body, directions: Array) -> Array:
    """s(n) of each direction."""
    return np.asarray(-b.reach(-directions) - a.reach(directions))


def least_separation(
    assembly: Assembly,
    program: Program,
    motion: Array,
    *,
    beyond: float,
    planes: Mask | None = None,
    tied: Index | None = None,
) -> float | None:
    """The least distance, or separation, of two parts of which one has moved.

    Parameters
    ----------
    assembly : Assembly
    program : Program
        Its contacts say where parts touch.
    motion : ndarray, shape (N, 6)
        Shift of the centre of mass and rotation vector of each part [length unit, rad].
    beyond : float
        Pairs that are farther apart than this in any case are left out [length unit].
    planes : ndarray of bool, shape (K,), optional
        Contacts with a plane: pairs that it parts as it did, which only shifted along it, are
        left out.
    tied : ndarray of int, shape (N,), optional
        A number for each part; pairs of the same number are left out.

    Returns
    -------
    float or None
        Negative where no plane that parts them was found; None where a pair has no answer here.
    """
    count = len(program.names)
    turns = [turn_of(motion[k, 3:]) for k in range(count)]
    kept: dict[int, list[Body] | None] = {}
    least = beyond
    for i in range(count):
        for j in range(i + 1, count):
            if not (program.free[i] or program.free[j]) or _far(assembly, motion, (i, j), beyond):
                continue
            if tied is not None and tied[i] == tied[j]:
                continue
            found = []
            for k in (i, j):
                if k not in kept:
                    bodies = bodies_of(assembly, k)
                    kept[k] = bodies and [
                        one.moved(program.center[k], motion[k, :3], turns[k]) for one in bodies
                    ]
                found.append(kept[k])
            if found[0] is None or found[1] is None:
                return None
            own = ((program.part_a == i) & (program.part_b == j)) | (
                (program.part_a == j) & (program.part_b == i)
            )
            normals = program.normal[own] * np.where(program.part_a[own] == i, 1.0, -1.0)[:, None]
            if planes is not None and planes[own].any():
                before = bodies_of(assembly, i), bodies_of(assembly, j)
                size = float(program.radius[[i, j]].min())
                if _parted_as_before(before, (found[0], found[1]), normals[planes[own]], size):
                    continue
            least = min(least, _pair(found[0], found[1], normals, least))
    return least


Pieces = list[Body] | None


def _parted_as_before(
    before: tuple[Pieces, Pieces], now: tuple[Pieces, Pieces], normals: Array, size: float
) -> bool:
    """Whether a plane across a normal of contact parts two parts as it did where they touched."""
    was, is_ = (
        np.min([_parted(a, b, normals) for a in one or () for b in other or ()], axis=0)
        for one, other in (before, now)
    )
    return bool(((was > -ACROSS * size) & (is_ >= was - KEEPS * size)).any())


def _far(assembly: Assembly, motion: Array, pair: tuple[int, int], beyond: float) -> bool:
    """Whether the boxes of two parts were farther apart than both move, and more."""
    geometry = assembly.geometry
    low, high = geometry.part_boxes
    i, j = pair
    most = np.linalg.norm(motion[:, :3], axis=1) + geometry.radius * np.linalg.norm(
        motion[:, 3:], axis=1
    )
    room = beyond + float(most[i] + most[j] + geometry.slack[i] + geometry.slack[j])
    return bool((np.maximum(low[i] - high[j], low[j] - high[i]) > room).any())


def _pair(first: list[Body], second: list[Body], hints: Array, least: float) -> float:
    """The least separation of pieces of two parts, where it is below `least`."""
    for a in first:
        for b in second:
            gap = np.maximum(
                b.corners.min(axis=0) - a.corners.max(axis=0),
                a.corners.min(axis=0) - b.corners.max(axis=0),
            ).max()
            if gap - a.radius - b.radius >= least:
                continue
            round_one = a if a.axis is None and a.radius > 0 else b
            other = b if round_one is a else a
            if round_one.radius > 0 and round_one.axis is None and other.radius == 0:
                least = min(least, _ball(round_one, other))
            else:
                least = min(least, separation(a, b, hints))
    return least


def _ball(ball: Body, other: Body) -> float:
    """Separation of a ball from a polyhedron or a triangle."""
    assert other.normals is not None
    if len(other.corners) == 3:
        return float(surface_distance(ball.corners, other.corners[None])[0]) - ball.radius
    return separation_of_point(other, ball.corners[0]) - ball.radius


def separation_of_point(body: Body, point: Array) -> float:
    """How far a point is from a convex polyhedron; negative within, then of the nearest face."""
    return parting_point(body, point)[0]


def parting_point(body: Body, point: Array) -> tuple[float, Array]:
    """How far a point is from a convex polyhedron, or a triangle, and in which direction."""
    assert body.normals is not None
    assert body.edges is not None
    heights = body.normals @ point - body.reach(body.normals)
    if heights.max() <= 0:
        return float(heights.max()), np.asarray(body.normals[int(heights.argmax())])
    apart = point - body.corners
    aside = apart[:, None] - (apart @ body.edges.T)[..., None] * body.edges
    tried = np.vstack([body.normals, apart, aside.reshape(-1, 3)])
    tried = unit_rows(tried[(tried != 0).any(axis=1)])
    values = tried @ point - body.reach(tried)
    best = int(values.argmax())
    return float(values[best]), np.asarray(tried[best])


def turn_of(rotation: Array) -> Array:
    """The matrix of a rotation vector, shape (3,) [rad]."""
    angle = float(np.linalg.norm(rotation))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = rotation / angle
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn: Array = np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
    return turn
