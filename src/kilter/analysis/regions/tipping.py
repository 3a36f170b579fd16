"""Tipping of a body on an endless horizontal table: the tilt and the energy that it needs.

Its energy is its weight times the height of its centre of mass over its lowest point. With d the
direction from there down, in the frame of the body, that is the support function of its hull,

    H(d) = max of d.(x - c)   over its points x,     c the centre of mass,

a function on the sphere of directions: a state of rest is a minimum of it, and the body tips over
the lowest of the passes around.

**A polyhedron.** H is d.(v - c) about each corner v, and falls off from the direction of v - c.
So whatever lies below a height is connected by the directions between neighbouring faces alone:
along the edge between faces f and g, H is highest over the foot of c on the edge, or at f or g.
The lowest pass is then the bottleneck of a graph, faces its nodes. Over the edges of its base it
tips at atan(b / h), b the distance from the foot of c to the edge, h the height of c.

**A body of revolution about the vertical.** H is the greatest of a cos t + b sin t + q, of circles
of radius b at depth a below c rounded by q (0 for the rim of a face, the radius of a sphere, the
tube of a torus). If two of these meet H bends up, so that its first peak in t is that of either of
them, at t = atan2(b, a).
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.analysis_tolerances import NO_PROJECTION, NO_RISE, SAME_RAY
from kilter.arrays import Array, Index, Mask, across, connected, cross, unit_rows
from kilter.assembly.changed_copies import lowest_heights
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, SPHERE, TORUS

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull


@dataclass(frozen=True, slots=True, eq=False)
class Tipping:
    """The tilt and the energy at which a body on a horizontal table tips over."""

    angle: float
    """Tilted by less, about any level axis, it comes back [rad]."""
    rise: float | None
    """Rise of the centre of mass before it can go over [length unit]; None if it comes back from
    anywhere, since it rests in no other way."""


def find_tipping(geometry: Geometry, part: int, down: Array) -> Tipping | None:
    """Find tilt and energy at which a body on a table tips over; None if not in an energy minimum.

    The body must stand in a strict minimum of its energy.

    Arguments: `down` (3,): unit, world frame. Returns None if it stands in no well (on an edge, or
    if it rolls), and for bodies with curved surfaces that are not of revolution about the vertical
    or not known exactly.

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Box
    >>> geometry = Assembly([Part("box", Box([2, 4, 2]))]).geometry
    >>> tipping = find_tipping(geometry, 0, np.array([0.0, 0.0, -1.0]))
    >>> round(float(np.degrees(tipping.angle)), 9), round(tipping.rise, 9)  # sqrt 2 - 1
    (45.0, 0.414213562)
    """
    surfaces = geometry.surfaces
    if surfaces.start[part] == surfaces.start[part + 1]:
        return _of_polyhedron(_corners(geometry, part), down, float(geometry.size[part]))
    return _of_revolution(geometry, part, down)


def _corners(geometry: Geometry, part: int) -> Array:
    """Vertices of a part relative to its centre of mass, shape (m, 3) [length unit]."""
    vertices = slice(geometry.vertex_start[part], geometry.vertex_start[part + 1])
    corners: Array = geometry.vertices[vertices] - geometry.center[part]
    return corners


# a polyhedron -------------------------------------------------------------------------------


def _of_polyhedron(corners: Array, down: Array, size: float) -> Tipping | None:
    """Tipping of a polyhedron over the edges of its hull; None if it is at no energy minimum."""
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    try:
        hull = ConvexHull(corners)
    except QhullError:
        return None
    normals, heights, links, levels = _passes(hull, corners)
    base = int(np.argmax(normals @ down))
    if np.linalg.norm(normals[base] - down) > NO_PROJECTION:
        return None
    least = np.full(len(heights), np.inf)
    for side in links:
        np.minimum.at(least, side, levels)
    rests = least > heights + NO_RISE * size
    if not rests[base]:
        return None
    over = _lowest_pass(base, rests, links, levels)
    lowest = np.flatnonzero(corners @ down > heights[base] - NO_PROJECTION * size)
    aside = _base_distance(corners[lowest], down)
    if over is None:
        return Tipping(np.pi, None)
    return Tipping(float(np.arctan2(aside, heights[base])), over - float(heights[base]))


def _passes(hull: ConvexHull, corners: Array) -> tuple[Array, Array, tuple[Index, Index], Array]:
    """Faces of a hull (normals, heights of the centre of mass), and edges over which it tips."""
    facets, normals = hull.simplices, hull.equations[:, :3]
    first = np.repeat(np.arange(len(facets)), 3)
    second = hull.neighbors.reshape(-1)
    ends = np.stack([np.roll(facets, -1, axis=1), np.roll(facets, 1, axis=1)], axis=2)
    ends = ends.reshape(-1, 2)  # of the edge across from each corner, as the neighbours are
    once = first < second
    first, second, ends = first[once], second[once], ends[once]
    flat = np.linalg.norm(cross(normals[first], normals[second]), axis=1) <= SAME_RAY
    count = len(facets)
    _, first_index, face = np.unique(
        connected(count, first[flat], second[flat]), return_index=True, return_inverse=True
    )
    normal, height = normals[first_index], -hull.equations[first_index, 3]
    bent = ~flat
    f, g, ends = face[first[bent]], face[second[bent]], corners[ends[bent]]
    along = unit_rows(ends[:, 1] - ends[:, 0])
    foot = ends[:, 0] - np.einsum("ij,ij->i", ends[:, 0], along)[:, None] * along
    over = np.einsum("ij,ij->i", cross(normal[f], foot), along)
    short = np.einsum("ij,ij->i", cross(foot, normal[g]), along)
    level = np.maximum(height[f], height[g])
    between = over * short > 0
    level[between] = np.linalg.norm(foot[between], axis=1)
    return normal, height, (f, g), level


def _lowest_pass(base: int, rests: Mask, links: tuple[Index, Index], levels: Array) -> float | None:
    """Height of the centre of mass at the lowest pass to rest on another face; None without a way.

    `links` are the two faces of each pass, `levels` the heights there [length unit]; `rests` marks
    the faces on which the part can rest. The way begins at the face `base`.
    """
    ways: list[list[tuple[float, int]]] = [[] for _ in rests]
    for f, g, level in zip(*(side.tolist() for side in links), levels.tolist(), strict=True):
        ways[f].append((level, g))
        ways[g].append((level, f))
    reached, waiting = set(), [(0.0, base)]
    while waiting:
        level, face = heapq.heappop(waiting)
        if face in reached:
            continue
        reached.add(face)
        if rests[face] and face != base:
            return level
        for over, other in ways[face]:
            heapq.heappush(waiting, (max(over, level), other))
    return None


def _base_distance(base: Array, down: Array) -> float:
    """Distance from the foot of the centre of mass to the nearest base edge [length unit]."""
    from scipy.spatial import ConvexHull  # slow to import

    flat = ConvexHull(base @ np.stack(across(down), axis=1))
    return float(-flat.equations[:, 2].max())


# a body of revolution -----------------------------------------------------------------------


def _of_revolution(geometry: Geometry, part: int, down: Array) -> Tipping | None:
    """Tipping of a body of revolution about the vertical; None if not in a minimum of energy."""
    size = float(geometry.size[part])
    if not _stands_as_turned(geometry, part, down, SAME_RAY * size):
        return None
    depth, out, rounding, low, high = _circles(geometry, part, down)

    def height(angle: Array) -> Array:
        """Height of the centre of mass above the table [length unit] at tilts [rad], shape (n,)."""
        t = angle[:, None]
        each = depth * np.cos(t) + out * np.sin(t) + rounding
        reached = (t >= low - SAME_RAY) & (t <= high + SAME_RAY)
        most: Array = np.where(reached, each, -np.inf).max(axis=1)
        return most

    blur = NO_RISE * size
    start = float(height(np.zeros(1))[0])
    peak, top = np.arctan2(out, depth), np.hypot(depth, out) + rounding
    free = np.hypot(depth, out) > blur
    reached = (peak >= low - SAME_RAY) & (peak <= high + SAME_RAY)
    is_peak = free & reached & (top >= height(peak) - blur) & (top > start + blur)
    if not is_peak.any() or not _rises(depth, out, rounding, low, start, blur):
        return None
    first = int(np.argmin(np.where(is_peak, peak, np.inf)))
    if peak[first] >= np.pi - SAME_RAY:
        return Tipping(np.pi, None)
    return Tipping(float(peak[first]), float(top[first]) - start)


def _rises(
    depth: Array, out: Array, rounding: Array, low: Array, start: float, blur: float
) -> bool:
    """Whether the centre of mass rises as soon as the body tilts from its upright position."""
    lowest = (low <= SAME_RAY) & (depth + rounding > start - blur)
    return bool((lowest & ((out > blur) | (depth < -blur))).any())


def _stands_as_turned(geometry: Geometry, part: int, down: Array, near: float) -> bool:
    """Whether each face of a part is horizontal or a surface of revolution about a vertical axis.

    The axis passes through the centre of mass.
    """
    s = geometry.surfaces
    rows = np.arange(s.start[part], s.start[part + 1])
    off = s.point[rows] - geometry.center[part]
    aside = np.linalg.norm(cross(off, down[None]), axis=1) <= near
    upright = np.linalg.norm(cross(s.axis[rows], down[None]), axis=1) <= SAME_RAY
    known = (s.kind[rows] != FREE) & (s.doubt[rows] == 0)
    if not (known & aside & (upright | (s.kind[rows] == SPHERE))).all():
        return False
    triangles = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    flat = geometry.vertices[
        geometry.triangles[triangles][geometry.triangle_surface[triangles] < 0]
    ]
    normal = unit_rows(cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]))
    return bool((np.linalg.norm(cross(normal, down[None]), axis=1) <= SAME_RAY).all())


def _circles(geometry: Geometry, part: int, down: Array) -> Array:
    """Circles on which a body of revolution may stand, shape (5, n).

    Rows: depth below the centre of mass, radius, rounding, and the two tilts between which it is
    lowest.

    Corners within a sphere or a torus are left out: that stands for them.
    """
    s, first = geometry.surfaces, int(geometry.vertex_start[part])
    corners = _corners(geometry, part)
    rows = np.arange(s.start[part], s.start[part + 1])
    rows = rows[np.isin(s.kind[rows], (SPHERE, TORUS)) & ~s.hollow[rows]]
    ends = [
        float(lowest_heights(geometry, up)[part] - geometry.center[part] @ up)
        for up in (-down, down)
    ]
    inner, rounded = [], []
    for row in rows.tolist():
        used = np.unique(geometry.triangles[s.triangles_of(row)])
        facing = s.outward(np.full(len(used), row), geometry.vertices[used]) @ down
        tilt = np.arccos(np.clip(facing, -1.0, 1.0))
        ball = s.kind[row] == SPHERE
        below = float((s.point[row] - geometry.center[part]) @ down)
        by = float(s.radius[row] if ball else s.tube[row])
        near = SAME_RAY * float(geometry.size[part])
        low = 0.0 if abs(-below - by - ends[0]) <= near else float(tilt.min())
        high = np.pi if abs(below - by - ends[1]) <= near else float(tilt.max())
        inner.append(used[(tilt > low + SAME_RAY) & (tilt < high - SAME_RAY)] - first)
        rounded.append([below, 0.0 if ball else float(s.radius[row]), by, low, high])
    sharp = np.ones(len(corners), dtype=bool)
    sharp[np.concatenate([*inner, np.zeros(0, dtype=np.int64)])] = False
    depth = corners[sharp] @ down
    out = np.linalg.norm(corners[sharp] - depth[:, None] * down, axis=1)
    none = np.zeros(len(depth))
    rims = np.stack([depth, out, none, none, none + np.pi])
    return np.hstack([rims, np.array(rounded).reshape(-1, 5).T])
