"""Overlaps: parts that share volume, with depth, volume, and share of the smaller part.

Two convex parts share no volume if the plane of a facet of one has the other in front of it (within
tolerance). If no facet's plane separates them, the largest ball inside both decides; it also
recognises parts that only an edge against an edge separates.

The triangles of other parts are intersected (`kilter.contact.fits.shared_body`). Triangles that
bound no body have no volume; for these the winding number shows which corners lie inside the other
part.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import TINY, Array, Mask
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import INTERFERE, SAME_BODY, Overlap
from kilter.contact.contact_tolerances import COPY_PLACE
from kilter.contact.face_patches import FacePatches, in_patch
from kilter.contact.fits.coaxial import coaxial_fits
from kilter.contact.fits.part_solids import PartSolids
from kilter.contact.fits.same_body import coincide, deep_boxes
from kilter.contact.fits.shared_body import SharedBody, depth_of, shared_body
from kilter.contact.fits.winding_depth import depth_by_winding
from kilter.contact.gaps import Tolerance
from kilter.contact.planar.facets import Facets
from kilter.solvers.problem import LinearProgram
from kilter.work import stop_if_late

__all__ = ["find_overlaps"]


@dataclass(frozen=True, slots=True, eq=False)
class _OverlapSearch:
    """Data of the overlap search: the assembly, its contact patches and its parts as solids."""

    face_patches: FacePatches

    @property
    def solids(self) -> PartSolids:
        return self.face_patches.search.solids

    @property
    def geometry(self) -> Geometry:
        return self.face_patches.search.geometry

    @property
    def facets(self) -> Facets:
        return self.face_patches.search.facets


def find_overlaps(
    assembly: Assembly, face_patches: FacePatches, tolerances: Tolerance
) -> tuple[Overlap, ...]:
    """Find the pairs of parts that occupy the same space, with the shared volume."""
    search = face_patches.search
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    a, b = search.pairs.T
    both_convex = facets.convex_part[a] & facets.convex_part[b]
    # triangulations of touching curved faces penetrate each other by their sagittas
    tolerance = search.limits.gap + geometry.slack[a] + geometry.slack[b]
    deep = deep_boxes(geometry, boxes, search.pairs, search.limits)
    # convex parts with a patch lie on either side of its plane
    rows = np.flatnonzero(deep & ~(both_convex & face_patches.has_patch))
    overlaps = list({overlap.ends: overlap for overlap in face_patches.curved.overlaps}.values())
    overlaps += [_same_body(geometry, (i, j)) for i, j in search.same_bodies.tolist()]
    recorded = {overlap.ends for overlap in overlaps}
    if not overlaps and not len(rows):
        return ()
    overlap_search = _OverlapSearch(face_patches)
    known: dict[tuple[object, ...], Overlap | None] = {}
    for row in rows.tolist():
        parts = (int(a[row]), int(b[row]))
        if parts in recorded:
            continue
        stop_if_late()
        if both_convex[row]:
            overlap = _convex_overlap(overlap_search, parts, float(tolerance[row]))
        else:
            copy = _copy_key(assembly, parts, float(tolerance[row]))
            if copy not in known:
                known[copy] = _general_overlap(overlap_search, row, parts, float(tolerance[row]))
            found = known[copy]
            overlap = None if found is None else replace(found, ends=parts)
        if overlap is not None:
            overlaps.append(overlap)
    return tuple(
        _with_volume(overlap_search, overlap, tolerances)
        for overlap in _with_interference(assembly, overlaps, tolerances)
    )


def _copy_key(assembly: Assembly, parts: tuple[int, int], tolerance: float) -> tuple[object, ...]:
    """Key that is equal for pairs of copies in the same relative pose, whose overlap is equal.

    The poses are rounded to `COPY_PLACE` of the gap tolerance.
    """
    a, b = (assembly.parts[k] for k in parts)
    turn = a.pose.matrix.T
    step = COPY_PLACE * tolerance
    size = float(assembly.geometry.size[list(parts)].max())
    place = np.round(turn @ (b.pose.position - a.pose.position) / step)
    angles = np.round(turn @ b.pose.matrix * (size / step))
    return (id(a.shape), id(b.shape), tolerance, *place.tolist(), *angles.ravel().tolist())


FINER = range(1, 5)
"""Rounds of refinement of triangles for the volume of an overlap; each halves the sides."""
SETTLED = 0.01
"""Relative change of the volume in a round below which the volume is extrapolated [-]. A smaller
change takes more rounds, each of which takes about three times longer."""


def _with_interference(
    assembly: Assembly, overlaps: list[Overlap], tolerance: Tolerance
) -> list[Overlap]:
    """Mark overlaps of shafts that are thicker than their holes, with the reason INTERFERE."""
    fits = coaxial_fits(assembly, [overlap.ends for overlap in overlaps], tolerance)
    tight = {frozenset(fit.ends) for fit in fits if fit.tight}
    return [
        replace(overlap, why=INTERFERE) if frozenset(overlap.ends) in tight else overlap
        for overlap in overlaps
    ]


def _with_volume(overlap_search: _OverlapSearch, overlap: Overlap, tolerance: Tolerance) -> Overlap:
    """The overlap with its shared volume, also as a fraction of the smaller part's volume.

    The share is None if the smaller part is thinner than the gap tolerance.
    """
    volume, geometry, both = overlap.volume, overlap_search.geometry, list(overlap.ends)
    exact = overlap.why == SAME_BODY or not (geometry.slack[both] > 0).any()
    if volume is None or not exact:
        body = shared_body(overlap_search.solids, *overlap.ends)
        volume = _exact_volume(geometry, overlap.ends, body) if body is not None else volume
    smaller = int(both[int(np.argmin(geometry.volume[both]))])
    thinnest = float(tolerance.gap_of(geometry.size[[smaller]])[0])
    share = None
    if volume is not None and _thickness(geometry, smaller) > thinnest:
        share = volume / float(geometry.volume[smaller])
    return replace(overlap, volume=volume, share=share)


def _thickness(geometry: Geometry, part: int) -> float:
    """Mean thickness of a part, twice its volume over its surface [length unit]."""
    rows = slice(*geometry.triangle_start[part : part + 2].tolist())
    a, b, c = geometry.vertices[geometry.triangles[rows]].transpose(1, 0, 2)
    surface = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return float(2 * geometry.volume[part] / surface) if surface > 0 else 0.0


def _exact_volume(geometry: Geometry, parts: tuple[int, int], body: SharedBody) -> float:
    """Volume that two parts share, extrapolated to exact curved surfaces [length unit^3].

    The polyhedra are inside the surfaces by the square of their sides: a round leaves a quarter of
    the error of the volume.
    """
    slack = float(geometry.slack[list(parts)].sum())
    if not slack or not len(body.corners):
        return body.volume
    corners = body.corners.reshape(-1, 3)
    box = corners.min(axis=0) - slack, corners.max(axis=0) + slack
    volume = body.volume
    for rounds in FINER:
        finer = shared_body(PartSolids(geometry, (rounds, box)), *parts)
        if finer is None:
            break
        step, volume = finer.volume - volume, finer.volume
        if rounds > FINER[0] and abs(step) <= SETTLED * volume:
            return volume + step / 3
    return volume


def _general_overlap(
    overlap_search: _OverlapSearch, row: int, parts: tuple[int, int], tolerance: float
) -> Overlap | None:
    """Overlap of two parts of any shape; None if its depth is within the tolerance.

    Points on curved faces that touch over an area are ignored: only triangulations overlap there.
    """
    geometry, (a, b) = overlap_search.geometry, parts
    if coincide(geometry, a, b):
        return _same_body(geometry, parts)

    def on_patch(points: Array) -> Mask:
        return in_patch(overlap_search.face_patches, row, points, 2 * tolerance)

    body = shared_body(overlap_search.solids, a, b)
    if body is None:
        volume, depth = None, depth_by_winding(geometry, parts, tolerance, on_patch)
    else:
        depth = depth_of(overlap_search.solids, parts, body, least=tolerance, without=on_patch)
        volume = body.volume
    return Overlap(parts, volume, depth, "overlap") if depth > tolerance else None


def _same_body(geometry: Geometry, parts: tuple[int, int]) -> Overlap:
    """The overlap of two identical bodies in the same place."""
    size = float(geometry.size[list(parts)].min())
    return Overlap(parts, float(geometry.volume[parts[0]]), size, SAME_BODY)


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]


def _facet_planes(geometry: Geometry, facets: Facets, part: int) -> tuple[Array, Array]:
    """Outward unit normals of a part's facets, and a point on each facet."""
    span = slice(facets.start[part], facets.start[part + 1])
    return facets.normal[span], facets.origin[span]


def _convex_overlap(
    overlap_search: _OverlapSearch, parts: tuple[int, int], tolerance: float
) -> Overlap | None:
    """Overlap of two convex parts; None if they are apart or only touch."""
    geometry, (a, b) = overlap_search.geometry, parts
    if coincide(geometry, a, b):
        return _same_body(geometry, parts)
    middle = geometry.center[a]
    # separation by the planes of the facets, relative to the centre of a to keep digits
    normals, offsets, separation = [], [], -np.inf
    for part, other in ((a, b), (b, a)):
        n, origin = _facet_planes(geometry, overlap_search.facets, part)
        offset = np.einsum("ij,ij->i", n, origin - middle)
        nearest = (n @ (_corners(geometry, other) - middle).T).min(axis=1) - offset
        separation = max(separation, float(nearest.max()))
        normals.append(n)
        offsets.append(offset)
    if separation >= -tolerance:
        return None
    overlap, away = _ball_overlap(
        np.concatenate(normals), np.concatenate(offsets), parts, -separation, tolerance
    )
    if overlap is None or away is None:
        return overlap
    # between edges or corners no facet separates the parts, but this direction does
    outwards = away[: len(normals[0])] @ normals[0]
    length = float(np.linalg.norm(outwards))
    if length <= TINY:
        return overlap
    heights = [(_corners(geometry, part) - middle) @ (outwards / length) for part in parts]
    return replace(overlap, depth=min(overlap.depth, float(heights[0].max() - heights[1].min())))


def _ball_overlap(
    normals: Array, offsets: Array, parts: tuple[int, int], depth: float, tolerance: float
) -> tuple[Overlap | None, Array | None]:
    """Overlap of two convex parts from the largest ball inside both; None if that is small.

    `depth` is the least depth to any facet's plane [length unit]. The ball is the solution of a
    linear program. Also the pressures of the facets on the ball, which are in balance, shape (m,);
    None if they are unknown.
    """
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    from kilter.solvers.highs import solve_linear

    scale = max(float(np.abs(offsets).max()), TINY)
    no_limit = np.full(4, np.inf)
    ball = solve_linear(
        LinearProgram(
            np.array([0.0, 0.0, 0.0, -1.0]),
            csc_array(np.column_stack([normals, np.ones(len(normals))])),
            np.full(len(normals), -np.inf),
            offsets / scale,
            np.array([-np.inf, -np.inf, -np.inf, 0.0]),
            no_limit,
        )
    )
    if ball.outcome == "infeasible" or (ball.optimal and ball.x[3] * scale <= tolerance / 2):
        return None, None
    if not ball.optimal:  # undecided: report an overlap, so that none is missed
        return Overlap(parts, None, depth, "overlap"), None
    try:
        halfspaces = np.column_stack([normals, -offsets / scale])
        corners = HalfspaceIntersection(halfspaces, ball.x[:3]).intersections
        volume = float(ConvexHull(corners).volume) * scale**3
    except QhullError:  # too flat for a volume
        volume = None
    return Overlap(parts, volume, depth, "overlap"), np.abs(ball.multipliers)
