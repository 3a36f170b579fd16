"""Round surfaces of cylinders and spheres: near or not, and the forces they can bring.

A round part has a core, a point (sphere) or the segment of its axis (cylinder), and its
surface lies at the radius from the core. It touches another part where the distance of the
core from that part's surface is the radius, within tolerance. A frictionless sphere is
pushed through its centre, the side of a cylinder across its axis; the flat ends of a
cylinder are planar faces, given as an inscribed polygon, whose circumscribed polygon bounds
the answer from the other side. Where a rim touches (`rims`, found as edges and corners are,
the polygon's sagitta allowed for) any force and torque between the parts is thought possible.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.contact.contact_set import PossibleContacts, Unsupported
from kilter.geometry import Geometry
from kilter.rigid import cross
from kilter.shapes import CYLINDER_SIDES

__all__ = ["RoundContacts", "rim_contacts", "rim_slack", "round_contacts", "round_extents"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
_Force = tuple[int, int, Array, Array]

FACETED = 2e-3
"""A mesh of a round hole may enter a round part by this part of its radius (its sagitta)."""


@dataclass(frozen=True, slots=True, eq=False)
class RoundContacts:
    """Pairs that touch at a round surface, and the forces that they could bring."""

    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


@dataclass(frozen=True, slots=True, eq=False)
class _Core:
    """A point or segment from `start` to `end`, and a radius."""

    start: Array
    end: Array
    radius: float


def rim_slack(geometry: Geometry, part: Index) -> Array:
    """How far the rim of each cylinder may lie outside its polygon [length unit], (n,)."""
    height = 1.0 - np.cos(np.pi / CYLINDER_SIDES)
    cylinder = geometry.round_axis[part].any(axis=1)
    slack: Array = np.where(cylinder, geometry.radius[part] * height, 0.0)
    return slack


def round_extents(geometry: Geometry, parts: Index, frame: Array) -> tuple[Array, Array]:
    """Boxes of the true surfaces of round parts in a frame, corners, shape (n, 3) each.

    A disc of radius r and axis a reaches r sqrt(1 - a_i^2) along direction i.
    """
    cores = [_core(geometry, int(part)) for part in parts]
    ends = np.array([[core.start, core.end] for core in cores]) @ frame.T
    axis = geometry.round_axis[parts] @ frame.T
    radius = np.array([core.radius for core in cores])
    reach = radius[:, None] * np.sqrt(np.maximum(1.0 - axis**2, 0.0))
    return ends.min(axis=1) - reach, ends.max(axis=1) + reach


def round_contacts(
    geometry: Geometry,
    pairs: Index,
    tolerance: Array,
    rows: Index,
    rims: dict[int, Array],
) -> RoundContacts:
    """Which of the pairs `rows` touch at a round surface; `rims`: points of rims that touch."""
    unsupported = []
    forces: list[_Force] = []
    for row in rows:
        a, b = (int(k) for k in pairs[row])
        point = rims.get(int(row))
        if point is not None:
            held = _any_wrench(point, float(geometry.radius[[a, b]].min()))
        else:
            point, rolling = _touch(geometry, a, b, float(tolerance[row]))
            if point is None:
                continue
            held = _forces(geometry, rolling)
        x, y, z = point.tolist()
        unsupported.append(Unsupported((a, b), "curved", (x, y, z)))
        forces.extend((a, b, point, normal) for point, normal in held)
    return RoundContacts(tuple(unsupported), _possible(forces, two_sided=True))


def _any_wrench(point: Array, arm: float) -> list[tuple[Array, Array]]:
    """Points and directions of forces that add up to any force and torque."""
    x, y, z = np.eye(3)
    at = [(point, x), (point, y), (point, z)]
    return [*at, (point + arm * x, y), (point + arm * x, z), (point + arm * y, z)]


def _possible(forces: list[_Force], *, two_sided: bool) -> PossibleContacts:
    count = len(forces)
    return PossibleContacts(
        part_a=np.array([a for a, _, _, _ in forces], dtype=np.int64),
        part_b=np.array([b for _, b, _, _ in forces], dtype=np.int64),
        points=np.array([point for _, _, point, _ in forces]).reshape(count, 3),
        normals=np.array([normal for _, _, _, normal in forces]).reshape(count, 3),
        two_sided=np.full(count, two_sided),
        mu=np.zeros(count),
    )


def _core(geometry: Geometry, part: int) -> _Core:
    vertices = geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    axis = geometry.round_axis[part]
    if not axis.any():
        radius = float(np.linalg.norm(vertices - middle, axis=1).max())
        return _Core(middle, middle, radius)
    along = (vertices - middle) @ axis
    radius = float(np.linalg.norm(vertices - middle - np.outer(along, axis), axis=1).max())
    return _Core(middle + along.min() * axis, middle + along.max() * axis, radius)


def _forces(geometry: Geometry, part: int) -> list[tuple[Array, Array]]:
    """Points and directions of all forces that a round surface can take, both senses."""
    core = _core(geometry, part)
    axis = geometry.round_axis[part]
    if not axis.any():
        return [(core.start, direction) for direction in np.eye(3)]
    u = cross(np.eye(3)[np.abs(axis).argmin()], axis)
    u /= np.linalg.norm(u)
    return [(end, d) for end in (core.start, core.end) for d in (u, cross(axis, u))]


def _touch(geometry: Geometry, a: int, b: int, tolerance: float) -> tuple[Array | None, int]:
    """Where two parts touch at a round surface (None: nowhere), and the part whose it is."""
    # a sphere first: whatever it touches pushes through its centre
    order = sorted((a, b), key=lambda part: bool(geometry.round_axis[part].any()))
    rolling = [part for part in order if geometry.is_round[part]]
    if len(rolling) == 2:
        one, other = _core(geometry, a), _core(geometry, b)
        apart, middle = _segments(one, other)
        if abs(apart - one.radius - other.radius) <= tolerance:
            return middle, rolling[0]
    for part in rolling:
        point = _on_flat(geometry, part, b if part == a else a, tolerance)
        if point is not None:
            return point, part
    return None, a


def _on_flat(geometry: Geometry, a: int, b: int, tolerance: float) -> Array | None:
    """Where the round surface of part a touches a flat face, edge or corner of part b."""
    core, axis = _core(geometry, a), geometry.round_axis[a]
    span = slice(geometry.triangle_start[b], geometry.triangle_start[b + 1])
    triangles = geometry.vertices[geometry.triangles[span]]
    if geometry.is_round[b]:  # only the flat ends of the other; its side is asked apart
        normal = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        along_axis = np.abs(normal @ geometry.round_axis[b])
        triangles = triangles[along_axis > (1 - 1e-9) * np.linalg.norm(normal, axis=1)]
    if not len(triangles):
        return None
    distance, point, along = _to_triangles(core, triangles)
    # beyond an end of the axis it is the flat end that comes near, not the side
    foot = core.start + along[:, None] * (core.end - core.start)
    side = np.abs((point - foot) @ axis) <= tolerance
    near = side & (distance <= core.radius + tolerance)
    near &= distance >= core.radius * (1 - FACETED) - tolerance
    if not near.any():
        return None
    touched: Array = point[np.argmin(np.where(near, np.abs(distance - core.radius), np.inf))]
    return touched


def _segments(one: _Core, other: _Core) -> tuple[float, Array]:
    """Distance of two cores and the point half-way."""
    points = [(one.start, one.end), (other.start, other.end)]
    best, middle = np.inf, one.start
    s = np.linspace(0, 1, 257)
    for (p, q), (start, end) in (points, points[::-1]):
        x = p + s[:, None] * (q - p)
        d = end - start
        t = np.clip((x - start) @ d / max(float(d @ d), 1e-300), 0, 1)
        y = start + t[:, None] * d
        distance = np.linalg.norm(x - y, axis=1)
        k = int(distance.argmin())
        # the distance is convex along a segment: refine between the neighbours
        low, high = s[max(k - 1, 0)], s[min(k + 1, 256)]
        for _ in range(60):
            m1, m2 = low + (high - low) / 3, high - (high - low) / 3
            d1, d2 = (_point_segment(p + m * (q - p), start, end)[0] for m in (m1, m2))
            low, high = (low, m2) if d1 <= d2 else (m1, high)
        x1 = p + (low + high) / 2 * (q - p)
        least, y1 = _point_segment(x1, start, end)
        if least < best:
            best, middle = least, (x1 + y1) / 2
    return best, middle


def _point_segment(x: Array, start: Array, end: Array) -> tuple[float, Array]:
    d = end - start
    t = min(max(float((x - start) @ d) / max(float(d @ d), 1e-300), 0.0), 1.0)
    y = start + t * d
    return float(np.linalg.norm(x - y)), y


def _to_triangles(core: _Core, triangles: Array) -> tuple[Array, Array, Array]:
    """Distance from a core to each triangle, the nearest point, and where along the core."""
    d = core.end - core.start
    samples = [0.0, 1.0] if d.any() else [0.0]
    candidates = [_plane_feet(core.start + s * d, triangles, s) for s in samples]
    for k in range(3):
        candidates.append(_edge_feet(core, triangles[:, k], triangles[:, (k + 1) % 3]))
    distance = np.stack([c[0] for c in candidates])
    best = distance.argmin(axis=0)
    rows = np.arange(len(triangles))
    least, foot, along = (np.stack([c[k] for c in candidates])[best, rows] for k in range(3))
    if not d.any():
        return least, foot, along
    # a segment beside a plane: both ends are equally near, so the middle of it is
    both = np.isfinite(distance[0]) & np.isfinite(distance[1])
    apart = np.where(both, distance[0], 0.0) - np.where(both, distance[1], 0.0)
    level = both & (np.abs(apart) <= 1e-9 * core.radius)
    middle = _plane_feet(core.start + 0.5 * d, triangles, 0.5)
    use = level & np.isfinite(middle[0]) & (middle[0] <= least * (1 + 1e-9))
    return (
        np.where(use, middle[0], least),
        np.where(use[:, None], middle[1], foot),
        np.where(use, middle[2], along),
    )


def _plane_feet(x: Array, triangles: Array, s: float) -> tuple[Array, Array, Array]:
    """Distance from a point to each triangle it lies over; infinite elsewhere."""
    p, q, r = triangles.transpose(1, 0, 2)
    normal = cross(q - p, r - p)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    height = np.einsum("ij,ij->i", x - p, normal)
    foot = x - height[:, None] * normal
    inside = np.ones(len(p), dtype=bool)
    for start, end in ((p, q), (q, r), (r, p)):
        inside &= np.einsum("ij,ij->i", cross(end - start, foot - start), normal) >= 0
    return np.where(inside, np.abs(height), np.inf), foot, np.full(len(p), s)


def _edge_feet(core: _Core, start: Array, end: Array) -> tuple[Array, Array, Array]:
    """Distance from the core to each edge, the nearest point of the edge, where on the core."""
    d1, d2 = core.end - core.start, end - start
    r = core.start - start
    a, e = float(d1 @ d1), np.maximum(np.einsum("ij,ij->i", d2, d2), 1e-300)
    f = np.einsum("ij,ij->i", d2, r)
    if a == 0.0:
        s = np.zeros(len(start))
    else:
        b, c = d2 @ d1, r @ d1
        bottom = a * e - b * b
        s = np.where(bottom > 1e-12 * a * e, (b * f - c * e) / np.maximum(bottom, 1e-300), 0.5)
        s = np.clip(s, 0, 1)
    t = np.clip((s * (d2 @ d1) + f) / e, 0, 1)
    if a > 0.0:
        s = np.clip((t * (d2 @ d1) - r @ d1) / a, 0, 1)
    foot = start + t[:, None] * d2
    return np.linalg.norm(core.start + s[:, None] * d1 - foot, axis=1), foot, s


def rim_contacts(
    geometry: Geometry, parts: Index, normals: Array, start: Index, points: Array
) -> PossibleContacts:
    """Corners of the circumscribed polygon where a patch ends at the rim of a cylinder.

    Parameters
    ----------
    parts : ndarray of int, shape (P, 2)
        Parts of each patch, with their `normals` (P, 3) and `points` by `start`.
    """
    forces: list[_Force] = []
    stretch = 1.0 / np.cos(np.pi / CYLINDER_SIDES)
    for patch in np.flatnonzero(geometry.is_round[parts].any(axis=1)):
        a, b = (int(k) for k in parts[patch])
        corners = points[start[patch] : start[patch + 1]]
        for part in (a, b):
            axis = geometry.round_axis[part]
            if not axis.any():
                continue
            core = _core(geometry, part)
            out = corners - core.start
            out = out - np.outer(out @ axis, axis)
            # corners of the polygon, and corners cut into its sides
            rim = np.linalg.norm(out, axis=1) > core.radius / stretch * (1 - 1e-6)
            forces.extend(
                (a, b, point + (stretch - 1) * away, normals[patch])
                for point, away in zip(corners[rim], out[rim], strict=True)
            )
    return _possible(forces, two_sided=False)
