"""Contacts between exact curved faces: candidates, the extent of their faces, and patches.

A clearance closes a shaft that is thinner than its hole: both are then treated as a single surface
of their mean radius, about the axis of the shaft, or of the hole if the shaft is held.

The boxes of surfaces decide which surfaces come near. Formulas give the candidates for contact
(`kilter.contact.curved.tangency`), the triangles of the faces decide whether the faces extend
there, and `kilter.contact.curved.contact_points` gives the points. The formulas do not depend on
the triangles, so two tessellations of the same cylinder that cross each other are a single contact.

Two radii that differ by up to the gap tolerance touch. A thinner peg has a gap all around, and lies
in its hole along a line; a thicker peg interferes, which is an overlap and not a contact. Surfaces
recognised in a mesh are known only up to their sagitta: the tolerance of their pairs is raised by
it, and a warning reports this.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across, extents, ragged
from kilter.assembly.surfaces import CYLINDER, KINDS, SPHERE, Surfaces
from kilter.contact.common.broad import facets_in, joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.edges import part_curves
from kilter.contact.common.findings import CurvedFindings, FacePatches
from kilter.contact.common.gaps import THIN, RejectedPair
from kilter.contact.contact_tolerances import FULL_TURN, INTERFERENCE
from kilter.contact.curved.candidates import (
    CIRCLE,
    LINE,
    POINT,
    SAME,
    Candidates,
    FormLimits,
    Planes,
    on_planes,
)
from kilter.contact.curved.coaxial_faces import SharedRegion, shared_region
from kilter.contact.curved.contact_points import (
    AROUND,
    STEP,
    TURN,
    PatchPoints,
    angles_between,
    arcs_of,
    bands_of,
    common_spans,
    ring,
    shell,
    slices,
    socket,
)
from kilter.contact.curved.curved_patches import (
    CandidateLimits,
    CurvedPatch,
    PatchBuilder,
    SurfacePairs,
    classify,
    pack,
    without_repeats,
)
from kilter.contact.curved.rims import balls_on_rims, rims_on_planes, tips_on_faces
from kilter.contact.curved.tangency import find_candidates
from kilter.rigid import quaternion_to_matrix, rotation_between
from kilter.shape.covering import FaceCover, covered
from kilter.work import stop_if_late


def touching_shells(
    search: ContactSearch,
    builder: PatchBuilder,
    pairs: SurfacePairs,
    candidates: Candidates,
    limits: CandidateLimits,
) -> None:
    """Add contacts of coaxial faces that fit into each other, such as shaft and bore.

    Each candidate is unrolled about the axis of its solid surface; regions shorter than twice the
    gap tolerance are rejected as too thin.
    """
    if not len(candidates.row):
        return
    surfaces = search.geometry.surfaces
    first, second = pairs.i[candidates.row], pairs.j[candidates.row]
    used, place = np.unique(np.concatenate([first, second]), return_inverse=True)
    bands = bands_of(search.geometry, used)
    band_i, band_j = place.reshape(2, -1)
    for k in range(len(candidates.row)):
        i, j = int(first[k]), int(second[k])
        turned = bool(pairs.turned[candidates.row[k]]) ^ bool(surfaces.hollow[i])
        solid, hollow = (i, j) if not surfaces.hollow[i] else (j, i)
        band_rows = (band_i[k], band_j[k]) if solid == i else (band_j[k], band_i[k])
        region = shared_region(
            search.geometry, bands, (solid, hollow), (int(band_rows[0]), int(band_rows[1]))
        )
        if region is None:
            continue
        pair, play = int(pairs.pair[candidates.row[k]]), float(candidates.play[k])
        bound, closed = limits.of(int(candidates.row[k]))
        held = search.geometry.grounded[surfaces.part[[solid, hollow]]]
        # a fit closes at the free part, so that its weight does not rotate it; else at the shaft
        moves = play > 0 and bool(held[0] and not held[1])
        spots = _region_points(surfaces, (solid, hollow), region, moves=moves)
        off = _axis_distance(search, solid, hollow, region.bottom, region.top)
        gap = gaps_between(search, solid, hollow, spots.points, bound if play > 0 else off, bound)
        if region.top - region.bottom <= 2 * bound:
            a, b = (int(p) for p in search.pairs[pair])
            builder.rejected.append(RejectedPair((a, b), gap[0], 0.0, THIN))
            continue
        zone = max(bound, play) + float(np.ptp(spots.points, axis=0).max())
        radius, alpha = _radius_and_angle(surfaces, solid, hollow)
        points = shell(
            surfaces.point[solid], surfaces.axis[solid], alpha, radius, region.inside, None
        )
        inside = points.points, points.normals
        patch = CurvedPatch(pair, (solid, hollow), gap, bound, spots, zone, turned)
        classify(search, builder, replace(patch, closed=closed, play=play, inside=inside))


def _axis_distance(search: ContactSearch, i: int, j: int, bottom: float, top: float) -> float:
    """Least distance between the axes of two surfaces, between two heights on the first axis.

    In the length unit.
    """
    s = search.geometry.surfaces
    offsets = []
    for height in (bottom, top):
        center = s.point[i] + height * s.axis[i]
        delta = center - s.point[j]
        offsets.append(delta - (delta @ s.axis[j]) * s.axis[j])
    step = offsets[1] - offsets[0]
    share = float(np.clip(-(offsets[0] @ step) / max(float(step @ step), TINY), 0, 1))
    return float(np.linalg.norm(offsets[0] + share * step))


def _radius_and_angle(s: Surfaces, i: int, j: int) -> tuple[float, float]:
    """Mean radius of two cylinders (0 for cones), and half angle of a cone (0 for cylinders)."""
    if s.kind[i] == CYLINDER:
        return float(s.radius[i] + s.radius[j]) / 2, 0.0
    return 0.0, float(s.half_angle[i])


def _region_points(
    s: Surfaces, names: tuple[int, int], region: SharedRegion, *, moves: bool
) -> PatchPoints:
    """Contact points with normals on the region over which two coaxial surfaces lie together.

    If `moves`, the points are moved to the axis of the second surface.
    """
    i, j = names
    radius, alpha = _radius_and_angle(s, i, j)
    cone = s.kind[i] != CYLINDER
    step = TURN / AROUND if cone else STEP
    filled, outer = _arc_corners(region.arcs, step, region.bottom, region.top)
    whole = region.corners is None
    corners = filled if region.corners is None else region.corners
    # a whole band of a cylinder is exact; other regions need points around the true region
    outer_region = (outer if cone else filled) if (cone or not whole) else None
    spots = shell(s.point[i], s.axis[i], alpha, radius, corners, outer_region)
    # the area of a cone grows with its distance from the apex
    slant = (region.bottom + region.top) / 2 * np.tan(alpha) / np.cos(alpha)
    spots = replace(spots, area=region.area * (radius + slant))
    return _about_second(s, names, region, spots) if moves else spots


def _about_second(
    s: Surfaces, names: tuple[int, int], region: SharedRegion, spots: PatchPoints
) -> PatchPoints:
    """Move the contact points of a fit from the axis of the first surface to that of the second."""
    i, j = names
    axis, second_axis = s.axis[i], s.axis[j]
    second_axis = second_axis if float(axis @ second_axis) > 0 else -second_axis
    middle = s.point[i] + (region.bottom + region.top) / 2 * axis
    shift = s.point[j] - s.point[i]
    if s.kind[i] == CYLINDER:
        offset = middle - s.point[j]
        shift = -(offset - (offset @ second_axis) * second_axis)
    turn = quaternion_to_matrix(rotation_between(axis, second_axis))

    def moved(points: Array) -> Array:
        return np.asarray(middle + shift + (points - middle) @ turn.T)

    return PatchPoints(
        moved(spots.points), spots.normals @ turn.T,
        moved(spots.outer_points), spots.outer_normals @ turn.T, spots.area,
    )  # fmt: skip


def _arc_corners(
    arcs: list[tuple[float, float]], step: float, bottom: float, top: float
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Angles and heights of contact points at the ends of arcs, and of points between them.

    The auxiliary points span a cone of forces that contains the true one.
    """
    angles = [angles_between(begin, width, step) for begin, width in arcs]
    between = []
    for angle, (_, width) in zip(angles, arcs, strict=True):
        closed = np.append(angle, angle[0] + TURN) if width >= TURN - FULL_TURN else angle
        between.append((closed[1:] + closed[:-1]) / 2)
    inner, outer = (
        (np.tile(row, 2), np.repeat([bottom, top], len(row)))
        for row in (np.concatenate(angles), np.concatenate(between))
    )
    return inner, outer


def gaps_between(
    search: ContactSearch, i: int, j: int, points: Array, off: float, limit: float
) -> tuple[float, float]:
    """Least and greatest gap of two surfaces at the points half-way between them [length unit].

    Surfaces in their own counterparts touch all over only if their cores coincide. If the cores are
    farther apart (`off`) than the tolerance, the face penetrates on one side, and that depth is
    returned, or stands apart.
    """
    s = search.geometry.surfaces
    rows = np.ones(len(points), dtype=np.int64)
    gaps = s.distance(i * rows, points) + s.distance(j * rows, points)
    low, high = float(gaps.min()), float(gaps.max())
    if off <= limit:
        return low, high
    return (low, low) if low < -limit else (high, high)


def find_curved(faces: FacePatches) -> CurvedFindings:
    """Find the contacts of curved faces between the near pairs of parts of a search."""
    search = faces.search
    geometry, pairs = search.geometry, search.pairs
    owners = np.diff(geometry.surfaces.start) > 0
    rows = np.flatnonzero(owners[pairs].any(axis=1))
    if not len(rows):
        return CurvedFindings()
    both, flat = _near_surfaces(search, rows)
    builder, unknown = _build_patches(search, both, flat)
    doubt = geometry.surfaces.doubt
    rough = {
        patch.pair
        for patch in builder.touching
        if max(doubt[k] if k >= 0 else 0.0 for k in patch.surface) > search.limits.gap[patch.pair]
    }
    raised = np.array(sorted(rough), dtype=np.int64)
    return without_repeats(pack(search, builder, unknown, raised), faces)


# candidates ---------------------------------------------------------------------------


def _near_surfaces(search: ContactSearch, rows: Index) -> tuple[SurfacePairs, SurfacePairs]:
    """Near pairs of curved surfaces, and near pairs of a curved surface and a flat facet."""
    geometry, boxes = search.geometry, search.boxes
    low, high, has_triangles = _surface_boxes(search)
    a, b = search.pairs[rows].T
    grow = search.limits.margin[rows]
    box_low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow[:, None]
    box_high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow[:, None]

    def surfaces(part: Index) -> tuple[Index, Index]:
        """Curved surfaces of part k that meet box k: pairs (k, surface)."""
        owner, row = ragged(geometry.surfaces.start, part)
        keep = has_triangles[row] & (low[row] <= box_high[owner]).all(axis=1)
        keep &= (high[row] >= box_low[owner]).all(axis=1)
        return owner[keep], row[keep]

    def flats(part: Index) -> tuple[Index, Index]:
        """Flat facets of part k that meet box k: pairs (k, facet)."""
        owner, facet = facets_in(search.facets, boxes, part, box_low, box_high)
        keep = ~search.facets.curved[facet]
        return owner[keep], facet[keep]

    def joined(
        first: tuple[Index, Index], second: tuple[Index, Index], plane: bool
    ) -> Iterator[SurfacePairs]:
        """Yield pairs of a surface in `first` and a surface (a facet if `plane`) in `second`."""
        box_i = low[first[1]], high[first[1]]
        box_j = (
            (boxes.facet_low[second[1]], boxes.facet_high[second[1]])
            if plane
            else (low[second[1]], high[second[1]])
        )
        for pair, x, y in joins(first[0], box_i, second[0], box_j, grow):
            yield SurfacePairs(rows[pair], first[1][x], second[1][y], np.zeros(len(x), dtype=bool))

    round_a, round_b = surfaces(a), surfaces(b)
    both = SurfacePairs.join(joined(round_a, round_b, False))
    forth = SurfacePairs.join(joined(round_a, flats(b), True))
    back = SurfacePairs.join(joined(round_b, flats(a), True))
    back = SurfacePairs(back.pair, back.i, back.j, ~back.turned)
    return both, SurfacePairs.join([forth, back])


def _surface_boxes(search: ContactSearch) -> tuple[Array, Array, Mask]:
    """Boxes of curved surfaces, lower and upper corners, and a mask of surfaces with triangles."""
    geometry, surfaces = search.geometry, search.geometry.surfaces
    low = np.full((len(surfaces), 3), np.inf)
    high = -low
    has_triangles = np.diff(surfaces.triangle_start) > 0
    points = search.boxes.turned[geometry.triangles[surfaces.triangle]]
    first = surfaces.triangle_start[:-1][has_triangles]
    if len(first):
        least, greatest = extents(points)
        low[has_triangles] = np.minimum.reduceat(least, first)
        high[has_triangles] = np.maximum.reduceat(greatest, first)
    sagitta = surfaces.sagitta[:, None]
    return low - sagitta, high + sagitta, has_triangles


# patches ------------------------------------------------------------------------------


def _build_patches(
    search: ContactSearch, both: SurfacePairs, flat: SurfacePairs
) -> tuple[PatchBuilder, Index]:
    """Build patches from all candidates; also return the surface pairs without a formula."""
    surfaces, facets = search.geometry.surfaces, search.facets
    builder = PatchBuilder()
    doubt = surfaces.doubt[both.i] + surfaces.doubt[both.j]
    limits = _candidate_limits(search, both, doubt)
    angle = np.full(len(both.i), search.angle)
    form_limits = FormLimits(limits.gap, limits.closed, angle, 0 * angle)
    candidates, unknown = find_candidates(
        surfaces, both.i, both.j, form_limits, search.geometry.grounded
    )
    rims = balls_on_rims(search.geometry, both.i, both.j, limits.gap)
    tips = tips_on_faces(search.geometry, both.i, both.j, angle)
    candidates = Candidates.join([candidates, rims, tips])
    planes = Planes(facets.normal[flat.j], facets.origin[flat.j])
    flat_limits = _candidate_limits(search, flat, surfaces.doubt[flat.i])
    level = np.full(len(flat.i), search.angle)
    flat_candidates = Candidates.join(
        [
            on_planes(surfaces, flat.i, planes, level),
            rims_on_planes(search.geometry, flat.i, planes, level),
        ]
    )
    near = _may_touch(search, both, candidates, limits.gap)
    shells = near & (candidates.form == SAME) & (surfaces.kind[both.i[candidates.row]] != SPHERE)
    touching_shells(search, builder, both, candidates.take(np.flatnonzero(shells)), limits)
    _add_each(search, builder, both, candidates.take(np.flatnonzero(near & ~shells)), limits, False)
    near = _may_touch(search, flat, flat_candidates, flat_limits.gap)
    _add_each(search, builder, flat, flat_candidates.take(np.flatnonzero(near)), flat_limits, True)
    return builder, _without_formula(search, both, flat, unknown)


def _candidate_limits(search: ContactSearch, pairs: SurfacePairs, doubt: Array) -> CandidateLimits:
    """Gap limits of the candidate contacts, raised by `doubt`, the error of the surfaces."""
    limits = search.limits
    return CandidateLimits(limits.gap[pairs.pair] + doubt, limits.closed[pairs.pair] + doubt)


def _may_touch(
    search: ContactSearch, pairs: SurfacePairs, candidates: Candidates, limit: Array
) -> Mask:
    """Mask of candidates that may touch: small gap, at a place where the boxes overlap."""
    pair = pairs.pair[candidates.row]
    a, b = search.pairs[pair].T
    boxes = search.boxes
    low = np.maximum(boxes.part_low[a], boxes.part_low[b])
    high = np.minimum(boxes.part_high[a], boxes.part_high[b])
    middle = (low + high) / 2 @ boxes.frame
    half = np.linalg.norm(high - low, axis=1) / 2
    margin = np.maximum(search.limits.margin[pair], limit[candidates.row])
    line = candidates.form == LINE
    t = np.where(line, np.einsum("ij,ij->i", middle - candidates.at, candidates.along), 0.0)
    gap = candidates.gap + candidates.slope * t
    spread = np.where(line, np.abs(candidates.slope) * half, candidates.swing)
    surfaces = search.geometry.surfaces
    near: Mask = np.abs(gap) <= margin + spread
    same = candidates.form == SAME
    size = surfaces.radius[pairs.i[candidates.row]]
    thickest = (
        INTERFERENCE * np.where(size > 0, size, half) + np.where(same, candidates.slope, 0.0) * half
    )
    near |= same & (np.abs(candidates.gap) <= thickest)
    too_far = (same | (candidates.form == CIRCLE)) & (
        candidates.swing > np.maximum(thickest, margin)
    )
    # a fit: an axis off by more than the play lies beside the hole; tilt is tested later
    aside = np.linalg.norm(middle - candidates.at, axis=1) + half
    fits = (candidates.play > 0) & (
        candidates.swing <= candidates.play + margin + candidates.slope * aside
    )
    possible: Mask = np.where(candidates.play > 0, fits, near & ~too_far)
    return possible


def _without_formula(
    search: ContactSearch, both: SurfacePairs, flat: SurfacePairs, unknown: Mask
) -> Index:
    """Pairs of surfaces without a contact formula: row of the pair, both surfaces (-1: flat)."""
    surfaces = search.geometry.surfaces
    k = np.flatnonzero(unknown)
    # a free form beside flat faces: a single entry for each pair and surface
    free = np.flatnonzero(surfaces.kind[flat.i] == len(KINDS) - 1)
    free = free[np.unique(np.column_stack([flat.pair, flat.i])[free], axis=0, return_index=True)[1]]
    turned = flat.turned[free]
    i = flat.i[free]
    flats = np.column_stack([flat.pair[free], np.where(turned, -1, i), np.where(turned, i, -1)])
    return np.concatenate([np.column_stack([both.pair[k], both.i[k], both.j[k]]), flats])


def _add_each(
    search: ContactSearch,
    builder: PatchBuilder,
    pairs: SurfacePairs,
    candidates: Candidates,
    limits: CandidateLimits,
    plane: bool,
) -> None:
    """Add the patches of all candidates to `builder`, except those of coaxial faces.

    The candidates are points, lines, circles and spheres in sockets.
    """
    for k in range(len(candidates.row)):
        stop_if_late()
        row = int(candidates.row[k])
        candidate = candidates.take(np.array([k]))
        _add_candidate(search, builder, pairs, row, candidate, limits.of(row), plane)


def _add_candidate(
    search: ContactSearch,
    builder: PatchBuilder,
    pairs: SurfacePairs,
    row: int,
    candidate: Candidates,
    limits: tuple[float, float],
    plane: bool,
) -> None:
    """Add the patch of a candidate to `builder` if both faces reach the place of contact.

    `plane` is True if the partner is a flat facet.
    """
    limit, closed = limits
    play = float(candidate.play[0])
    i, j, pair = int(pairs.i[row]), int(pairs.j[row]), int(pairs.pair[row])
    surfaces = search.geometry.surfaces
    slack = float(search.geometry.slack[search.pairs[pair]].max())
    faces = [
        (search.face(i), float(surfaces.sagitta[i]) + limit),
        (search.flat(j), np.inf) if plane else (search.face(j), float(surfaces.sagitta[j]) + limit),
    ]
    kind = int(candidate.form[0])
    gap = float(candidate.gap[0])
    reach = abs(gap) + float(candidate.swing[0])
    low, high = gap - float(candidate.swing[0]), gap + float(candidate.swing[0])
    if kind == POINT:
        spots = _point_contact(
            search, candidate, _named(search, (i, j), plane), faces, reach, limit
        )
    elif kind == LINE:
        spots, low, high = _line_contact(candidate, faces, reach + search.angle * float(
            search.geometry.size[search.pairs[pair]].min()), limit)  # fmt: skip
    elif kind == CIRCLE:
        spots = _circle_contact(candidate, faces, reach, limit)
    else:
        radius = float(surfaces.radius[[i, j]].mean() if play > 0 else surfaces.radius[i])
        spots = socket(candidate.at[0], radius, faces[0][0], faces[1][0],
                       float(max(surfaces.sagitta[[i, j]])))  # fmt: skip
    if spots is None:
        return
    # the gap of circles and whole surfaces varies: evaluate it at the contact points
    if not plane and kind in (SAME, CIRCLE):
        off = limit if play > 0 else float(candidate.swing[0])
        low, high = gaps_between(search, i, j, spots.points, off, limit)
    bend = float(candidate.bend[0]) or float(search.geometry.size[search.pairs[pair]].min())
    near = max(limit, abs(gap), play)
    # chord of a circle of radius `bend` at which the gap exceeds the tolerance and both slacks
    zone = near + float(np.sqrt(2 * bend * (near + 2 * slack)))
    names = (i, -1) if plane else (i, j)
    turned = bool(pairs.turned[row])
    if kind == SAME and surfaces.hollow[i]:  # the normals of a socket are those of its ball
        names, turned = (j, i), not turned
    # the ends of a line lie on the rims of its faces, so its middle is used to test for material
    inside = (spots.points.mean(axis=0)[None], spots.normals[:1]) if kind == LINE else None
    patch = CurvedPatch(pair, names, (low, high), limit, spots, zone, turned, closed, play, inside)
    classify(search, builder, patch)


_Face = tuple[Array, float]
"""Triangles of a face, shape (m, 3, 3), and its distance from the contact; inf: a flat face."""


def _named(search: ContactSearch, pair: tuple[int, int], plane: bool) -> list[tuple[int, int]]:
    """Curved surface and flat facet of both faces, -1 or 0 in place of the one that is absent."""
    return [(pair[0], 0), (-1, pair[1]) if plane else (pair[1], 0)]


def _point_contact(
    search: ContactSearch, candidate: Candidates, names: list[tuple[int, int]],
    faces: list[_Face], reach: float, grow: float,
) -> PatchPoints | None:  # fmt: skip
    """The contact point of a candidate; None if one of the faces does not reach it.

    On the rim of a face, or at its tip, only the triangles decide about that face. A rim or tip on
    an edge of the other face has no single normal.
    """
    at, normal = candidate.at, candidate.normal
    at_rim = bool(candidate.along.any())
    sharp = int(candidate.rim[0] == 2.0) if at_rim else -1
    rim = float(candidate.radius[0]) / 2  # in the plane of a rim its face is no nearer to the axis
    surfaces, facets = search.geometry.surfaces, search.facets
    for number, (triangles, sagitta) in enumerate(faces):
        depth = 1e300 if not np.isfinite(sagitta) else sagitta + reach
        if number == sharp:
            if not covered(triangles, at, candidate.along, max(depth, rim), grow)[0]:
                return None
            continue
        surface, facet = names[number]
        part = int(surfaces.part[surface] if surface >= 0 else facets.part[facet])
        curves = part_curves(search, part)
        face = surface, facet
        if not curves.extends(part, face, (at, normal), triangles, depth, grow)[0]:
            return None
        if at_rim and curves.at_edge(part, at[0], 2 * grow):
            return None
    empty = np.empty((0, 3))
    return PatchPoints(at, normal, empty, empty, 0.0)


def _line_contact(
    candidate: Candidates, faces: list[_Face], reach: float, grow: float
) -> tuple[PatchPoints | None, float, float]:
    """End points of a line contact, and its least and greatest gap; None for a short line."""
    at, along, normal = candidate.at[0], candidate.along[0], candidate.normal[0]
    spans = np.array([[-np.inf, np.inf]])
    for triangles, sagitta in faces:
        face_spans = slices(triangles, (at, along, normal), sagitta + reach, grow)
        spans = common_spans(spans, face_spans)
    if not len(spans) or spans.max() - spans.min() <= 2 * grow:
        return None, 0.0, 0.0
    ends = np.array([spans.min(), spans.max()])
    gaps = candidate.gap[0] + candidate.slope[0] * ends
    empty = np.empty((0, 3))
    points = at + ends[:, None] * along
    spots = PatchPoints(points, np.tile(normal, (2, 1)), empty, empty, 0.0)
    return spots, float(gaps.min()), float(gaps.max())


def _circle_contact(
    candidate: Candidates, faces: list[_Face], reach: float, grow: float
) -> PatchPoints | None:
    """Contact points on the arcs of a circle that both faces cover; None without arcs."""
    center, axis, radius = candidate.at[0], candidate.along[0], float(candidate.radius[0])
    out, up = (float(x) for x in candidate.normal[0, :2])
    rim = int(candidate.rim[0])
    u, v = across(axis)
    covers = [(FaceCover.of(triangles), sagitta) for triangles, sagitta in faces]

    def inside(angle: Array) -> Mask:
        away = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
        points, normals = center + radius * away, out * away + up * axis
        is_covered = np.ones(len(angle), dtype=bool)
        for number, (cover, sagitta) in enumerate(covers, start=1):
            depth = 1e300 if not np.isfinite(sagitta) else sagitta + reach
            # the normals of a rim leave its face, which lies straight away from the axis
            lines = away if number == rim else normals
            is_covered &= cover.covers(points, lines, depth, grow)
        return is_covered

    arcs = arcs_of(inside)
    return ring(center, axis, radius, (out, up), arcs) if arcs else None
