"""Contacts of flat faces: overlaps of opposed facets, merged to patches with exact areas.

The corners of a facet are on its round edges, so its polygon lacks a segment at each chord (or has
one too many, at the edge of a hole). A chord of length c, whose edge has the height h over it,
lacks the segment of a circle

    r^2 / 2 (t - sin t),   r = (c^2 / 4 + h^2) / (2 h),   t = 2 asin(c / (2 r))

A patch that covers a facet as a whole has the exact area of the facet. A part of a facet has the
area of its polygon.

Pieces of a pair lie in the same plane if their normals agree within the merging angle and their
offsets within twice the gap tolerance. An area thinner than twice the gap tolerance is not an area
of contact. This is tested for each connected region, not for each piece: a ring of thin triangles
is a wide region. The width of a region is its area over its diameter: two slivers along a bent line
are not wide, though their hull is. Pieces as thin as the rounding of the coordinates are dropped
first: such a piece along a line of contact would widen the hull of its neighbour.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, cross, starts, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, Chords
from kilter.contact.common.broad import facet_pairs
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.facets import Facets, facet_triangles
from kilter.contact.common.findings import FacePatches, Findings
from kilter.contact.common.gaps import (
    APART,
    PENETRATES,
    THIN,
    TILTED,
    RejectedPair,
    nearest_gap,
    touches,
)
from kilter.contact.common.patches import Patches
from kilter.contact.common.polygons import (
    FacetFrame,
    Pieces,
    convex_hull,
    facet_frames,
    overlaps_of,
    tidy,
    width_of,
)
from kilter.contact.contact_tolerances import (
    LOOKED_AT_ANGLE,
    PATCH_ANGLE,
    PATCH_CORNER,
    ROUNDINGS,
    SLIVER,
    STRAIGHT,
    WHOLE,
)
from kilter.shape.closed import shared_edges


def missing_areas(geometry: Geometry, facets: Facets, chosen: Index) -> Array:
    """Exact area of each chosen flat facet minus the area of its polygon, shape (n,).

    `chosen`, shape (n,): indices of the facets; a facet may occur several times.
    """
    missing = np.zeros(len(facets.part))
    s = geometry.surfaces
    flat = np.unique(chosen[~facets.curved[chosen]])
    flat = flat[np.isin(facets.part[flat], s.part)] if len(s) else flat[:0]
    for part in np.unique(facets.part[flat]):
        chords, key, outward = _round_edges(geometry, int(part))
        own = flat[facets.part[flat] == part]
        owner, triangles = facet_triangles(facets.corner_start, facets.convex, own)
        ids = facets.corners[triangles]
        sides = (ids * len(geometry.vertices) + np.roll(ids, -1, axis=1)).ravel()
        order = np.argsort(sides, kind="stable")
        at = np.minimum(np.searchsorted(sides[order], key), len(sides) - 1)
        found = sides[order][at] == key
        lost = _segments(chords, outward, geometry)
        np.add.at(missing, own[owner[order[at[found]] // 3]], lost[found])
    return missing[chosen]


def _round_edges(geometry: Geometry, part: int) -> tuple[Chords, Index, Array]:
    """Edges between triangles in planes and exact curved surfaces of a part.

    Returns `key`, shape (n,): first vertex times the number of vertices, plus the second, in the
    sense of the flat face; `outward`, shape (n, 3): unit vectors in the flat face, away from it.
    """
    g, s = geometry, geometry.surfaces
    span = slice(g.triangle_start[part], g.triangle_start[part + 1])
    triangles, label = g.triangles[span], g.triangle_surface[span]
    first, second = shared_edges(triangles)
    both = np.column_stack([first, second])
    both = np.concatenate([both, both[:, ::-1]])  # the flat side first
    on = label[both // 3]
    known = (s.kind[on[:, 1]] != FREE) & (s.doubt[on[:, 1]] == 0)
    both = both[(on[:, 0] < 0) & (on[:, 1] >= 0) & known]
    side = both // 3
    start = triangles[side[:, 0], both[:, 0] % 3]
    end = triangles[side[:, 0], (both[:, 0] + 1) % 3]
    corner = g.vertices[triangles[side]]
    normal = unit_rows(cross(corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0]))
    p, q = g.vertices[start], g.vertices[end]
    chords = Chords(p, q, label[side], corner[:, :, 0], normal)
    return chords, start * len(g.vertices) + end, unit_rows(cross(q - p, normal[:, 0]))


def _segments(chords: Chords, outward: Array, geometry: Geometry) -> Array:
    """Signed areas between chords and their edges, positive outside the flat face, shape (n,)."""
    top, converged = chords.on_edge(np.full(len(chords.p), 0.5), geometry.surfaces)
    chord = np.linalg.norm(chords.q - chords.p, axis=1)
    height = np.einsum("ij,ij->i", top - (chords.p + chords.q) / 2, outward)
    bent = np.flatnonzero(converged & (np.abs(height) > STRAIGHT * chord))
    c, h = chord[bent], np.abs(height[bent])
    radius = (c**2 / 4 + h**2) / (2 * h)
    angle = 2 * np.arcsin(np.minimum(c / (2 * radius), 1.0))
    area = np.zeros(len(chord))
    area[bent] = np.sign(height[bent]) * radius**2 / 2 * (angle - np.sin(angle))
    return area


CROWD = 1500
"""Largest number of polygons in a plane whose connected regions are separated."""


class _PlanePatch(NamedTuple):
    """A contact patch in the common plane `frame`, merged from several polygons."""

    frame: int
    normal: Array
    area: float
    gap: tuple[float, float]
    points: Array


def merge(
    search: ContactSearch, frames: FacetFrame, blocks: list[Pieces]
) -> tuple[Patches, list[Pieces]]:
    """Merge touching polygons to contact patches; also returns the polygons that are too thin."""
    tolerance, blur = search.limits.gap, search.limits.rounding
    is_sliver = [_is_thin(block, SLIVER * blur[frames.pair[block.frame]]) for block in blocks]
    thin = [block.take(np.flatnonzero(slim)) for block, slim in zip(blocks, is_sliver, strict=True)]
    blocks = [_select(block, ~slim) for block, slim in zip(blocks, is_sliver, strict=True)]
    pairs = [frames.pair[block.frame] for block in blocks]
    piece_count = np.bincount(
        np.concatenate([*pairs, np.empty(0, np.int64)]), minlength=len(tolerance)
    )
    blocks_of_patches: list[Patches] = []
    shared_rows: list[tuple[int, int, int]] = []
    # pairs with a single piece in arrays, all others pair by pair
    for k, (block, pair) in enumerate(zip(blocks, pairs, strict=True)):
        alone = piece_count[pair] == 1
        slim = np.zeros(len(pair), dtype=bool)
        slim[alone] = _is_thin(_select(block, alone), 2 * tolerance[pair[alone]])
        thin.append(block.take(np.flatnonzero(slim)))
        blocks_of_patches.append(_single_patches(search, frames, _select(block, alone & ~slim)))
        shared_rows.extend((int(pair[row]), k, int(row)) for row in np.flatnonzero(~alone))
    shared_rows.sort()
    begin = 0
    merged: list[_PlanePatch] = []
    for end in range(1, len(shared_rows) + 1):
        if end == len(shared_rows) or shared_rows[end][0] != shared_rows[begin][0]:
            pair_row = shared_rows[begin][0]
            members = [(blocks[k], row) for _, k, row in shared_rows[begin:end]]
            limits = float(tolerance[pair_row]), float(blur[pair_row])
            plane_patches, dropped = _merge_planes(search.facets, frames, members, *limits)
            merged += plane_patches
            thin.extend(dropped)
            begin = end
    if merged:
        blocks_of_patches.append(_pack_patches(search, frames, merged))
    return Patches.join(blocks_of_patches).ordered(), [block for block in thin if len(block.frame)]


def _select(pieces: Pieces, chosen: Mask) -> Pieces:
    """The polygons that a mask selects; the same object if it selects all."""
    return pieces if chosen.all() else pieces.take(np.flatnonzero(chosen))


def _pack_patches(search: ContactSearch, frames: FacetFrame, merged: list[_PlanePatch]) -> Patches:
    """Convert merged patches to arrays."""
    return _make_patches(
        search,
        frames,
        np.array([patch.frame for patch in merged]),
        np.array([patch.normal for patch in merged]),
        np.array([patch.area for patch in merged]),
        np.array([patch.gap for patch in merged]),
        np.array([len(patch.points) for patch in merged]),
        np.concatenate([patch.points for patch in merged]),
    )


def _make_patches(
    search: ContactSearch,
    frames: FacetFrame,
    frame: Index,
    normal: Array,
    area: Array,
    gap: Array,
    count: Index,
    points: Array,
) -> Patches:
    """Build patches; patch k lies in the plane `frame[k]` and has `count[k]` points."""
    facets, pair = search.facets, frames.pair[frame]
    facet = np.column_stack([frames.i, frames.j])[frame]
    parts = search.pairs[pair]
    width = (facets.area[facet] / facets.reach[facet]).min(axis=1)
    whole = area[:, None] >= (1 - WHOLE) * facets.area[facet]
    if whole.any() and len(search.geometry.surfaces):
        lacks = np.full(whole.shape, np.inf)
        lacks[whole] = missing_areas(search.geometry, facets, facet[whole])
        area = area + np.where(whole.any(axis=1), lacks.min(axis=1), 0.0)
    return Patches(
        pair=pair,
        parts=parts,
        kind=np.full(len(pair), "plane", dtype="<U11"),
        normal=normal,
        area=area,
        gap=gap,
        accuracy=search.geometry.accuracy[parts].sum(axis=1) / width,
        doubt=np.zeros(len(pair)),
        mu=np.full(len(pair), np.nan),
        start=starts(count),
        points=points,
        normals=np.repeat(normal, count, axis=0),
        pieces=facets.piece[facet],
    )


def _is_thin(pieces: Pieces, width: Array) -> Mask:
    """Mask of the polygons whose least width is below `width` [length unit]."""
    if not len(pieces.frame):
        return np.zeros(0, dtype=bool)
    real = (np.arange(pieces.points.shape[1]) < pieces.count[:, None])[..., None]
    low = np.where(real, pieces.points, np.inf).min(axis=1)
    high = np.where(real, pieces.points, -np.inf).max(axis=1)
    diameter = np.linalg.norm(high - low, axis=1)
    doubtful: Mask = (
        pieces.area <= width * diameter
    )  # the area of a convex polygon is at most width x diameter
    for row in np.flatnonzero(doubtful):  # the bound does not decide
        doubtful[row] = width_of(pieces.points[row, : pieces.count[row]]) < width[row]
    return doubtful


def _single_patches(search: ContactSearch, frames: FacetFrame, pieces: Pieces) -> Patches:
    """Contact patches of pairs of parts whose contact is a single polygon."""
    rounding = search.limits.rounding[frames.pair[pieces.frame]]
    reach = np.sqrt(np.maximum(pieces.area, 0))
    points, count = tidy(pieces.points, pieces.count, np.maximum(PATCH_CORNER * reach, rounding))
    corners = points[np.arange(points.shape[1]) < count[:, None]]
    middle = frames.middle(corners[:, None, :], np.repeat(pieces.frame, count))[:, 0]
    normal = frames.normal[pieces.frame]
    return _make_patches(
        search, frames, pieces.frame, normal, pieces.area, pieces.gap, count, middle
    )


def _merge_planes(
    facets: Facets,
    frames: FacetFrame,
    members: list[tuple[Pieces, int]],
    tolerance: float,
    rounding: float,
) -> tuple[list[_PlanePatch], list[Pieces]]:
    """Merge the polygons of a pair to patches, plane by plane; also return too thin polygons.

    The largest remaining polygon defines the next plane. Polygons of different pieces of a part
    stay apart. `tolerance` and `rounding` are those of the pair [length unit].
    """
    frame = np.array([block.frame[row] for block, row in members])
    piece_i, piece_j = facets.piece[frames.i[frame]], facets.piece[frames.j[frame]]
    area = np.array([block.area[row] for block, row in members])
    gap = np.array([block.gap[row] for block, row in members])
    count = np.array([block.count[row] for block, row in members])
    flat_corners = np.concatenate([block.points[row, : block.count[row]] for block, row in members])
    owner = np.repeat(np.arange(len(members)), count)
    points = frames.middle(flat_corners[:, None, :], frame[owner])[:, 0]
    normal = frames.normal[frame]
    center = np.add.reduceat(points, np.cumsum(count) - count) / count[:, None]

    patches: list[_PlanePatch] = []
    dropped: list[Pieces] = []
    remaining = np.ones(len(members), dtype=bool)
    # the largest piece has the most accurate normal
    for seed in np.argsort(-area, kind="stable"):
        if not remaining[seed]:
            continue
        same = remaining & (np.linalg.norm(normal - normal[seed], axis=1) <= PATCH_ANGLE)
        same &= np.abs((center - center[seed]) @ normal[seed]) <= 2 * tolerance
        same &= (piece_i == piece_i[seed]) & (piece_j == piece_j[seed])
        same[seed] = True
        remaining &= ~same
        piece_rows = np.flatnonzero(same)
        axes = np.stack([frames.u[frame[seed]], frames.v[frame[seed]]], axis=1)
        plane = (points - center[seed]) @ axes
        wide = _wide_regions(plane, owner, piece_rows, area[piece_rows], 2 * tolerance)
        dropped.extend(members[k][0].take(np.array([members[k][1]])) for k in piece_rows[~wide])
        piece_rows = piece_rows[wide]
        if not len(piece_rows):
            continue
        in_patch = np.isin(owner, piece_rows)
        hull = convex_hull(plane[in_patch])
        size = max(PATCH_CORNER * float(np.sqrt(area[piece_rows].sum())), rounding)
        tidied, number = tidy(hull[None], np.array([len(hull)]), np.array([size]))
        hull = tidied[0, : number[0]]
        mean = area[piece_rows] @ normal[piece_rows]
        mean /= np.linalg.norm(mean)
        height = float(
            area[piece_rows] @ ((center[piece_rows] - center[seed]) @ mean) / area[piece_rows].sum()
        )
        corners = center[seed] + hull @ axes.T
        corners += np.outer(height - (corners - center[seed]) @ mean, mean)
        low, high = float(gap[piece_rows, 0].min()), float(gap[piece_rows, 1].max())
        total = float(area[piece_rows].sum())
        patches.append(_PlanePatch(int(frame[seed]), mean, total, (low, high), corners))
    return patches, dropped


def _wide_regions(plane: Array, owner: Index, which: Index, area: Array, width: float) -> Mask:
    """Mask of the polygons in connected regions that are at least `width` wide."""
    wide = np.ones(len(which), dtype=bool)
    if len(which) > CROWD:  # every two boxes are compared: too much memory
        return wide
    hulls = [plane[owner == k] for k in which]
    if all(width_of(hull) >= width for hull in hulls):
        return wide
    low = np.array([hull.min(axis=0) for hull in hulls]) - width / 2
    high = np.array([hull.max(axis=0) for hull in hulls]) + width / 2
    meets = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    label = connected(len(which), *np.nonzero(meets))
    for region in np.unique(label):
        members = np.flatnonzero(label == region)
        if len(members) == 1:
            wide[members] = width_of(hulls[members[0]]) >= width
            continue
        corners = np.concatenate([hulls[k] for k in members])
        diameter = float(np.linalg.norm(np.ptp(corners, axis=0)))
        wide[members] = area[members].sum() >= width * diameter
    return wide


DECADES: Array = np.power(10.0, np.arange(-12, -1))
GAP_EDGES: Array = np.concatenate([[-np.inf], -DECADES[::-1], [0.0], DECADES, [np.inf]])
"""Bin edges of the histogram of gaps, relative to the size of the smaller part [-]."""


def find_flat(faces: FacePatches) -> Findings:
    """Find the contacts of flat faces of near pairs, except facets of smooth contacts."""
    search = faces.search
    geometry, facets, limits = search.geometry, search.facets, search.limits
    widest = max(LOOKED_AT_ANGLE, 2 * search.angle)
    cosine = float(np.cos(widest))
    pair, i, j = facet_pairs(facets, search.boxes, search.pairs, limits.margin, cosine)
    flat = ~(facets.curved[i] | facets.curved[j])
    pair, i, j = pair[flat], i[flat], j[flat]
    if faces.smooth.joints:
        plain = ~faces.smooth.between(pair, i, j)
        pair, i, j = pair[plain], i[plain], j[plain]
    frames = facet_frames(facets, pair, i, j, limits.margin[pair])
    angle = search.angle + _angle_rounding(search, frames)
    size = np.minimum(geometry.size[facets.part[frames.i]], geometry.size[facets.part[frames.j]])
    accepted, refused, gaps = [], [], [np.empty((0, 2), dtype=np.int64)]
    for block in overlaps_of(geometry, facets, frames):
        pair_of = frames.pair[block.frame]
        limit = limits.gap[pair_of]
        opposed = frames.angle[block.frame] <= angle[block.frame]
        touch = opposed & touches(block.gap, limit, limits.closed[pair_of])
        accepted.append(block.take(np.flatnonzero(touch)))
        refused.append(block.take(np.flatnonzero(~touch)))
        wide = block.area > limit * np.sqrt(
            block.area
        )  # an overlap without width has no gap to count
        relative = (nearest_gap(block.gap) / size[block.frame])[wide & opposed]
        interval = np.searchsorted(GAP_EDGES, relative, side="right") - 1
        gaps.append(np.column_stack([pair_of[wide & opposed], interval]))
    patches, thin = merge(search, frames, accepted)
    rejected = _rejected_pairs(search, frames, refused, angle)
    rejected += _rejected_pairs(search, frames, thin, angle, THIN)
    return Findings(patches, tuple(rejected), gaps=np.concatenate(gaps))


def _angle_rounding(search: ContactSearch, frames: FacetFrame) -> Array:
    """Largest angle between two facets that rounding of coordinates may cause [rad]."""
    geometry, facets = search.geometry, search.facets
    error = np.zeros(len(frames))
    for facet in (frames.i, frames.j):
        part = facets.part[facet]
        width = facets.area[facet] / facets.reach[facet]
        error += np.where(geometry.single[part], ROUNDINGS * geometry.accuracy[part] / width, 0.0)
    return np.minimum(error, LOOKED_AT_ANGLE)


def _rejected_pairs(
    search: ContactSearch, frames: FacetFrame, blocks: list[Pieces], angle: Array, why: str = ""
) -> list[RejectedPair]:
    """For each pair of parts and reason, the nearest facets that do not count as touching.

    `angle` is the angle tolerance of each frame [rad]; `why` is a reason for all blocks, else the
    reason follows from the tilt and the sign of the gap.
    """
    limits = search.limits
    nearest: dict[tuple[int, str], RejectedPair] = {}
    for block in blocks:
        row = block.frame
        pair = frames.pair[row]
        gap = nearest_gap(block.gap)
        wide = (block.area > (2 * limits.gap[pair]) ** 2) & (np.abs(gap) <= limits.margin[pair])
        for k in np.flatnonzero(wide | bool(why)):
            tilt = float(frames.angle[row[k]])
            reason = TILTED if tilt > angle[row[k]] else APART if gap[k] > 0 else PENETRATES
            key = (int(pair[k]), why or reason)
            if key not in nearest or abs(gap[k]) < abs(nearest[key].gap):
                a, b = (int(part) for part in search.pairs[pair[k]])
                nearest[key] = RejectedPair((a, b), float(gap[k]), tilt, key[1])
    return list(nearest.values())
