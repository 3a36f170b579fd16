"""Parts that share volume: named with their depth and, for convex parts, their volume.

Two convex parts share no volume where the plane of a facet of one has the other in front
of it (within tolerance). Where no facet's plane separates them, the largest ball in both
decides; it also tells apart parts that only an edge against an edge separates.

Volumes of other parts are those of their meshes, cut by manifold3d (Apache-2.0) where it is
installed: the extra ``overlap``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import TINY, Array, Index, Mask, cross, ratio, unit_rows
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.part import Part
from kilter.contact.contact_set import INTERFERE, SAME_BODY, Overlap
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.contact.fits.coaxial import coaxial_fits
from kilter.contact.gaps import Tolerance
from kilter.contact.planar.facets import Facets
from kilter.contact.touching import Touching, in_patch
from kilter.shape.closed import welded
from kilter.shape.primitives import surface
from kilter.solvers.problem import LinearProgram

__all__ = ["can_cut", "find_overlaps", "overlap_volume"]


HINT = "volumes of overlaps need the extra: pip install 'kilter[overlap]'"
CUTS = 200
"""The volumes of so many overlaps are computed; each takes some milliseconds."""
Settled = Callable[[Array], Mask]

PROBES = 300
"""Corners of a part that is not convex that are looked for inside another."""


def find_overlaps(
    assembly: Assembly, touching: Touching, allowed: Tolerance
) -> tuple[tuple[Overlap, ...], list[str]]:
    """Pairs that share volume, and warnings that name them."""
    search = touching.search
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    a, b = search.pairs.T
    both_convex = facets.convex_part[a] & facets.convex_part[b]
    # tessellations of curved faces enter each other by their sagittas
    tolerance = search.limits.gap + geometry.slack[a] + geometry.slack[b]
    grow = tolerance[:, None]
    deep = (boxes.part_high[a] - boxes.part_low[b] > grow).all(axis=1)
    deep &= (boxes.part_high[b] - boxes.part_low[a] > grow).all(axis=1)
    rows = np.flatnonzero(deep & ~(both_convex & touching.has_patch))
    found = list({overlap.parts: overlap for overlap in touching.curved.overlaps}.values())
    known = {overlap.parts for overlap in found}
    for row in rows:
        one, other = (int(k) for k in search.pairs[row])
        settled = _settled(touching, int(row), 2 * float(tolerance[row]))
        convex = bool(both_convex[row])
        overlap = _overlap(geometry, facets, (one, other), float(tolerance[row]), convex, settled)
        if overlap is not None and overlap.parts not in known:
            found.append(overlap)
    found = named_overlaps(assembly, found, allowed)
    names = assembly.names
    warnings = []
    for overlap in found[:20]:
        first, second = (repr(names[k]) for k in overlap.parts)
        size = "" if overlap.volume is None else f", volume {overlap.volume:.3g} {assembly.units}^3"
        warnings.append(
            f"{first} and {second} {overlap.why}, {overlap.depth:.3g} {assembly.units} deep{size}; "
            "an overlap is not a contact"
        )
    if found and not can_cut() and any(overlap.volume is None for overlap in found):
        warnings.append(HINT)
    if len(found) > 20:
        warnings.append(f"{len(found) - 20} more pairs overlap")
    return tuple(found), warnings


def _settled(touching: Touching, row: int, slack: float) -> Settled:
    """Whether points lie on curved faces of a pair that touch all over."""

    def settled(points: Array) -> Mask:
        return in_patch(touching, row, points, slack)

    return settled


def named_overlaps(assembly: Assembly, found: list[Overlap], tolerance: Tolerance) -> list[Overlap]:
    """Overlaps with their volumes, as far as a kernel gives them, and fits named as such."""
    parts = assembly.parts
    fits = coaxial_fits(assembly, [overlap.parts for overlap in found], tolerance)
    tight = {frozenset(fit.parts) for fit in fits if fit.tight}
    named = []
    for number, overlap in enumerate(found):
        a, b = overlap.parts
        why = INTERFERE if frozenset((a, b)) in tight else overlap.why
        volume = overlap.volume
        if volume is None and number < CUTS:
            volume = overlap_volume(parts[a], parts[b])
        named.append(dataclasses.replace(overlap, volume=volume, why=why))
    return named


def _overlap(
    geometry: Geometry,
    facets: Facets,
    parts: tuple[int, int],
    tolerance: float,
    convex: bool,
    settled: Settled,
) -> Overlap | None:
    a, b = parts
    if _identical(geometry, a, b):
        volume = float(geometry.volume[a])
        return Overlap((a, b), volume, float(min(geometry.size[[a, b]])), SAME_BODY)
    if convex:
        return _convex_overlap(geometry, facets, a, b, tolerance)
    depth = max(_depth(geometry, facets, *pair, tolerance, settled) for pair in ((a, b), (b, a)))
    if depth <= tolerance:
        return None
    return Overlap((a, b), None, depth, "overlap")


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]


def _identical(geometry: Geometry, a: int, b: int) -> bool:
    one, other = _corners(geometry, a), _corners(geometry, b)
    if one.shape != other.shape:
        return False
    close = SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b]
    if np.abs(one.mean(axis=0) - other.mean(axis=0)).max() > close:
        return False
    from scipy.spatial import cKDTree

    return bool(cKDTree(one).query(other)[0].max() <= close)


def _planes(geometry: Geometry, facets: Facets, part: int) -> tuple[Array, Array]:
    span = slice(facets.start[part], facets.start[part + 1])
    return facets.normal[span], facets.origin[span]


def _convex_overlap(
    geometry: Geometry, facets: Facets, a: int, b: int, tolerance: float
) -> Overlap | None:
    middle = geometry.center[a]
    normals, offsets, apart = [], [], -np.inf
    for mine, other in ((a, b), (b, a)):
        n, origin = _planes(geometry, facets, mine)
        offset = np.einsum("ij,ij->i", n, origin - middle)
        behind = (n @ (_corners(geometry, other) - middle).T).min(axis=1) - offset
        apart = max(apart, float(behind.max()))
        normals.append(n)
        offsets.append(offset)
    if apart >= -tolerance:
        return None
    return _ball(np.concatenate(normals), np.concatenate(offsets), (a, b), -apart, tolerance)


def _ball(
    normals: Array, offsets: Array, parts: tuple[int, int], depth: float, tolerance: float
) -> Overlap | None:
    """The overlap of half-spaces n.x <= offset, by the largest ball inside."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    from kilter.solvers.highs import solve_linear

    scale = max(float(np.abs(offsets).max()), TINY)
    endless = np.full(4, np.inf)
    ball = solve_linear(
        LinearProgram(
            np.array([0.0, 0.0, 0.0, -1.0]),
            csc_array(np.column_stack([normals, np.ones(len(normals))])),
            np.full(len(normals), -np.inf),
            offsets / scale,
            np.array([-np.inf, -np.inf, -np.inf, 0.0]),
            endless,
        )
    )
    if ball.outcome == "infeasible" or (ball.optimal and ball.x[3] * scale <= tolerance / 2):
        return None
    if not ball.optimal:  # it may be that they overlap: rather said than not
        return Overlap(parts, None, depth, "overlap")
    try:
        halfspaces = np.column_stack([normals, -offsets / scale])
        corners = HalfspaceIntersection(halfspaces, ball.x[:3]).intersections
        volume = float(ConvexHull(corners).volume) * scale**3
    except QhullError:
        volume = None
    return Overlap(parts, volume, depth, "overlap")


def _depth(
    geometry: Geometry, facets: Facets, a: int, b: int, tolerance: float, settled: Settled
) -> float:
    """How deep a corner or edge middle of part a lies inside part b, if above the tolerance.

    Points that are `settled` lie on a curved face that touches.
    """
    corners = _corners(geometry, a)
    span = slice(geometry.triangle_start[a], geometry.triangle_start[a + 1])
    own = geometry.vertices[geometry.triangles[span]]
    probes = np.concatenate(
        [corners, own.mean(axis=1), (own + np.roll(own, -1, axis=1)).reshape(-1, 3) / 2]
    )
    other = _corners(geometry, b)
    low, high = other.min(axis=0), other.max(axis=0)
    probes = probes[((probes > low + tolerance) & (probes < high - tolerance)).all(axis=1)]
    probes = probes[~settled(probes)]
    if len(probes) > PROBES:
        probes = probes[:: len(probes) // PROBES + 1]
    if not len(probes):
        return 0.0
    if facets.convex_part[b]:  # inside where behind all planes
        n, origin = _planes(geometry, facets, b)
        middle = origin.mean(axis=0)
        offset = np.einsum("ij,ij->i", n, origin - middle)
        return max(0.0, -float(((probes - middle) @ n.T - offset).max(axis=1).min()))
    span = slice(geometry.triangle_start[b], geometry.triangle_start[b + 1])
    triangles = geometry.vertices[geometry.triangles[span]]
    step = max(1, 4_000_000 // len(triangles))
    deepest = 0.0
    for begin in range(0, len(probes), step):
        some = probes[begin : begin + step]
        inside = _winding(some, triangles) > 0.5
        if inside.any():
            deepest = max(deepest, float(_distance(some[inside], triangles).max()))
    return deepest


def _winding(points: Array, triangles: Array) -> Array:
    """Winding number of a closed surface about points, shape (n,).

    References
    ----------
    A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983, equation 8.
    """
    middle = triangles.mean(axis=(0, 1))
    x, corners = points - middle, triangles - middle
    # every product of two or three of a - x, b - x, c - x is linear in x but for |x|^2
    a, b, c = corners.transpose(1, 0, 2)
    square = (x**2).sum(axis=1)[:, None]
    la, lb, lc = (
        np.sqrt(np.maximum(square + (corner**2).sum(axis=1) - 2 * (x @ corner.T), 0.0))
        for corner in (a, b, c)
    )
    bc = cross(b, c)
    top = np.einsum("ti,ti->t", a, bc) - x @ (bc + cross(c, a) + cross(a, b)).T
    bottom = la * lb * lc
    for one, other, length in ((a, b, lc), (b, c, la), (c, a, lb)):
        product = np.einsum("ti,ti->t", one, other) - x @ (one + other).T + square
        bottom += product * length
    winding: Array = np.arctan2(top, bottom).sum(axis=1) / (2 * np.pi)
    return winding


def _distance(points: Array, triangles: Array) -> Array:
    """Distance of each point from the nearest triangle's plane it lies over, or edge."""
    p, q, r = triangles.transpose(1, 0, 2)
    normal = unit_rows(cross(q - p, r - p))
    height = np.einsum("ntk,tk->nt", points[:, None] - p, normal)
    foot = points[:, None] - height[..., None] * normal
    inside = np.ones(height.shape, dtype=bool)
    nearest = np.full(height.shape, np.inf)
    for start, end in ((p, q), (q, r), (r, p)):
        along = end - start
        local = points[:, None] - start
        inside &= np.einsum("ntk,tk->nt", cross(along, foot - start), normal) >= 0
        t = np.clip(ratio(np.einsum("ntk,tk->nt", local, along), (along**2).sum(1)), 0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(local - t[..., None] * along, axis=2))
    least: Array = np.where(inside, np.abs(height), nearest).min(axis=1)
    return least


# volumes, by whatever kernel there is ---------------------------------------------------


def can_cut() -> bool:
    """Whether there is a kernel that cuts meshes."""
    return find_spec("manifold3d") is not None


def overlap_volume(part_a: Part, part_b: Part) -> float | None:
    """The volume that two parts share [length unit^3], of their triangles.

    Cylinders and spheres count as their inscribed polyhedra.

    Returns
    -------
    float or None
        None where no kernel is installed, or it refuses a mesh: see `can_cut`.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> from kilter.rigid import Pose
    >>> one, other = Part("a", Box([1, 1, 1])), Part("b", Box([1, 1, 1]), Pose([0.5, 0, 0.25]))
    >>> overlap_volume(one, other) in (None, 0.375)
    True
    """
    if not can_cut():
        return None
    meshes = [_world(part) for part in (part_a, part_b)]
    low = np.maximum(*(vertices.min(axis=0) for vertices, _ in meshes))
    high = np.minimum(*(vertices.max(axis=0) for vertices, _ in meshes))
    if (low >= high).any():
        return 0.0
    # in a frame at the overlap, in units of the larger part: digits and tolerances keep their size
    middle = (low + high) / 2
    size = max(float(np.ptp(vertices, axis=0).max()) for vertices, _ in meshes)
    one, other = (_solid((vertices - middle) / size, triangles) for vertices, triangles in meshes)
    if one is None or other is None:
        return None
    return float((one ^ other).volume()) * size**3


def _world(part: Part) -> tuple[Array, Index]:
    vertices, triangles = surface(part.shape)
    accuracy = float(getattr(part.shape, "accuracy", 0.0))
    vertices, triangles, _ = welded(vertices, triangles, accuracy=accuracy)
    return part.pose.apply(vertices), triangles


def _solid(vertices: Array, triangles: Index) -> Any:
    import manifold3d

    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    if float(np.einsum("ij,ij->", p, np.cross(q, r))) < 0:
        triangles = triangles[:, ::-1]
    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(vertices),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
    )
    solid = manifold3d.Manifold(mesh)
    return solid if solid.status() == manifold3d.Error.NoError else None
