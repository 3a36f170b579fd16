"""Merge touching polygons to contact patches, one for each pair of parts and plane.

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

from kilter.arrays import Array, Index, Mask, connected, starts
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import PATCH_ANGLE, PATCH_CORNER, SLIVER, WHOLE
from kilter.contact.patches import Patches
from kilter.contact.planar.facet_overlays import FacetFrame, Pieces
from kilter.contact.planar.facets import Facets
from kilter.contact.planar.polygons import convex_hull, tidy, width_of
from kilter.contact.planar.round_areas import missing_areas

__all__ = ["merge"]


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
