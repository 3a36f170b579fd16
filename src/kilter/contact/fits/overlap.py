"""Parts that share volume: named with their depth, the volume, and its share of the smaller.

Two convex parts share no volume where the plane of a facet of one has the other in front
of it (within tolerance). Where no facet's plane separates them, the largest ball in both
decides; it also tells apart parts that only an edge against an edge separates.

Of other parts the triangles are cut against each other (`kilter.contact.fits.shared_body`).
Triangles that bound no body have no volume to share: of these the corners are asked whether
they lie inside of the other part, by its winding number.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import TINY, Array, Mask, nearest
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import INTERFERE, SAME_BODY, Overlap
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.contact.fits.coaxial import coaxial_fits
from kilter.contact.fits.shared_body import PartSolids, SharedBody, depth_of, shared_body
from kilter.contact.fits.winding_depth import depth_by_winding
from kilter.contact.gaps import Tolerance
from kilter.contact.planar.facets import Facets
from kilter.contact.touching import Touching, in_patch
from kilter.solvers.problem import LinearProgram

__all__ = ["find_overlaps"]


@dataclass(frozen=True, slots=True, eq=False)
class _Overlapping:
    """What all steps need: what touches, and the parts as the kernel holds them."""

    touching: Touching
    solids: PartSolids

    @property
    def geometry(self) -> Geometry:
        return self.touching.search.geometry

    @property
    def facets(self) -> Facets:
        return self.touching.search.facets


def find_overlaps(
    assembly: Assembly, touching: Touching, allowed: Tolerance
) -> tuple[Overlap, ...]:
    """Pairs that share volume."""
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
    of = _Overlapping(touching, PartSolids(geometry))
    for row in rows.tolist():
        parts = (int(a[row]), int(b[row]))
        if parts in known:
            continue
        if both_convex[row]:
            overlap = _convex_overlap(of, parts, float(tolerance[row]))
        else:
            overlap = _overlap(of, row, parts, float(tolerance[row]))
        if overlap is not None:
            found.append(overlap)
    return tuple(_measured(of, overlap, allowed) for overlap in _named(assembly, found, allowed))


FINER = 2
"""Rounds in which triangles are cut finer to measure what is shared."""


def _named(assembly: Assembly, found: list[Overlap], tolerance: Tolerance) -> list[Overlap]:
    """Overlaps, those of shafts in tighter holes named as such."""
    fits = coaxial_fits(assembly, [overlap.parts for overlap in found], tolerance)
    tight = {frozenset(fit.parts) for fit in fits if fit.tight}
    return [
        replace(overlap, why=INTERFERE) if frozenset(overlap.parts) in tight else overlap
        for overlap in found
    ]


def _measured(of: _Overlapping, overlap: Overlap, tolerance: Tolerance) -> Overlap:
    """An overlap with its volume and that over the volume of the smaller part.

    Of a part that is thinner than a gap may be no share can be told.
    """
    volume, geometry, both = overlap.volume, of.geometry, list(overlap.parts)
    if volume is None or (geometry.slack[both] > 0).any():
        body = shared_body(of.solids, *overlap.parts)
        volume = _exact_volume(geometry, overlap.parts, body) if body is not None else volume
    smaller = int(both[int(np.argmin(geometry.volume[both]))])
    thinnest = float(tolerance.gap_of(geometry.size[[smaller]])[0])
    share = None
    if volume is not None and _thickness(geometry, smaller) > thinnest:
        share = volume / float(geometry.volume[smaller])
    return replace(overlap, volume=volume, share=share)


def _thickness(geometry: Geometry, part: int) -> float:
    """Twice the volume over the surface: of a thin plate its thickness [length unit]."""
    rows = slice(*geometry.triangle_start[part : part + 2].tolist())
    a, b, c = geometry.vertices[geometry.triangles[rows]].transpose(1, 0, 2)
    surface = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return float(2 * geometry.volume[part] / surface) if surface > 0 else 0.0


def _exact_volume(geometry: Geometry, parts: tuple[int, int], body: SharedBody) -> float:
    """The volume of a shared body, of finer triangles where round faces are known exactly."""
    slack = float(geometry.slack[list(parts)].sum())
    if not slack or not len(body.corners):
        return body.volume
    corners = body.corners.reshape(-1, 3)
    box = corners.min(axis=0) - slack, corners.max(axis=0) + slack
    finer = shared_body(PartSolids(geometry, (FINER, box)), *parts)
    return body.volume if finer is None else finer.volume


def _overlap(
    of: _Overlapping, row: int, parts: tuple[int, int], tolerance: float
) -> Overlap | None:
    """What two parts share of which one is not convex, if deeper than the tolerance.

    Points on curved faces that touch all over are left out: only tessellations enter there.
    """
    geometry, (a, b) = of.geometry, parts
    if _identical(geometry, a, b):
        return _same_body(geometry, parts)

    def settled(points: Array) -> Mask:
        return in_patch(of.touching, row, points, 2 * tolerance)

    body = shared_body(of.solids, a, b)
    if body is None:
        volume, depth = None, depth_by_winding(geometry, parts, tolerance, settled)
    else:
        depth = depth_of(of.solids, parts, body, least=tolerance, without=settled)
        volume = body.volume
    return Overlap(parts, volume, depth, "overlap") if depth > tolerance else None


def _same_body(geometry: Geometry, parts: tuple[int, int]) -> Overlap:
    size = float(geometry.size[list(parts)].min())
    return Overlap(parts, float(geometry.volume[parts[0]]), size, SAME_BODY)


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]


def _identical(geometry: Geometry, a: int, b: int) -> bool:
    one, other = _corners(geometry, a), _corners(geometry, b)
    if one.shape != other.shape:
        return False
    close = SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b]
    if np.abs(one.mean(axis=0) - other.mean(axis=0)).max() > close:
        return False
    return bool(nearest(one, other)[0].max() <= close)


def _planes(geometry: Geometry, facets: Facets, part: int) -> tuple[Array, Array]:
    span = slice(facets.start[part], facets.start[part + 1])
    return facets.normal[span], facets.origin[span]


def _convex_overlap(of: _Overlapping, parts: tuple[int, int], tolerance: float) -> Overlap | None:
    geometry, (a, b) = of.geometry, parts
    if _identical(geometry, a, b):
        return _same_body(geometry, parts)
    middle = geometry.center[a]
    normals, offsets, apart = [], [], -np.inf
    for mine, other in ((a, b), (b, a)):
        n, origin = _planes(geometry, of.facets, mine)
        offset = np.einsum("ij,ij->i", n, origin - middle)
        behind = (n @ (_corners(geometry, other) - middle).T).min(axis=1) - offset
        apart = max(apart, float(behind.max()))
        normals.append(n)
        offsets.append(offset)
    if apart >= -tolerance:
        return None
    return _ball(np.concatenate(normals), np.concatenate(offsets), parts, -apart, tolerance)


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
