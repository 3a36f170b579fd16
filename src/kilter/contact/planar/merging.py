"""Patches: the overlaps of facets that touch, merged to one hull a pair of parts and plane.

Pieces of one pair lie in one plane where their normals agree within the merging angle and
their offsets within twice the gap tolerance. What is thinner than twice the gap tolerance
is no area of contact; that is asked of each connected region, not of each piece (a ring of
thin triangles is a wide region), by its area over its diameter (two slivers along a bent
line are not wide, though their hull is). Pieces as thin as the rounding of the coordinates
are dropped before: one along a line of contact would widen the hull of the patch it touches.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, starts
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import PATCH_ANGLE, PATCH_CORNER, SLIVER
from kilter.contact.patches import Patches
from kilter.contact.planar.facet_overlays import FacetFrame, Pieces
from kilter.contact.planar.polygons import convex_hull, tidy, width_of

__all__ = ["merge"]


CROWD = 1500
"""Up to this many pieces the connected regions of a plane are told apart."""


class _Merged(NamedTuple):
    """One patch of several pieces: row of the frame it goes by, and what it is."""

    frame: int
    normal: Array
    area: float
    gap: tuple[float, float]
    points: Array


def merge(
    search: ContactSearch, frames: FacetFrame, blocks: list[Pieces]
) -> tuple[Patches, list[Pieces]]:
    """Patches of accepted pieces, and the pieces dropped because they are too thin."""
    tolerance, blur = search.limits.gap, search.limits.rounding
    noise = [_thin(block, SLIVER * blur[frames.pair[block.frame]]) for block in blocks]
    thin = [block.take(np.flatnonzero(slim)) for block, slim in zip(blocks, noise, strict=True)]
    blocks = [_only(block, ~slim) for block, slim in zip(blocks, noise, strict=True)]
    pairs = [frames.pair[block.frame] for block in blocks]
    number = np.bincount(np.concatenate([*pairs, np.empty(0, np.int64)]), minlength=len(tolerance))
    groups: list[Patches] = []
    crowd: list[tuple[int, int, int]] = []
    for k, (block, pair) in enumerate(zip(blocks, pairs, strict=True)):
        alone = number[pair] == 1
        slim = np.zeros(len(pair), dtype=bool)
        slim[alone] = _thin(_only(block, alone), 2 * tolerance[pair[alone]])
        thin.append(block.take(np.flatnonzero(slim)))
        groups.append(_single(search, frames, _only(block, alone & ~slim)))
        crowd.extend((int(pair[row]), k, int(row)) for row in np.flatnonzero(~alone))
    crowd.sort()
    begin = 0
    merged: list[_Merged] = []
    for end in range(1, len(crowd) + 1):
        if end == len(crowd) or crowd[end][0] != crowd[begin][0]:
            pair_row = crowd[begin][0]
            members = [(blocks[k], row) for _, k, row in crowd[begin:end]]
            limits = float(tolerance[pair_row]), float(blur[pair_row])
            made, dropped = _several(frames, members, *limits)
            merged += made
            thin.extend(dropped)
            begin = end
    if merged:
        groups.append(_packed(search, frames, merged))
    return Patches.join(groups).ordered(), [block for block in thin if len(block.frame)]


def _only(pieces: Pieces, chosen: Mask) -> Pieces:
    return pieces if chosen.all() else pieces.take(np.flatnonzero(chosen))


def _packed(search: ContactSearch, frames: FacetFrame, merged: list[_Merged]) -> Patches:
    return _patches(
        search,
        frames,
        np.array([one.frame for one in merged]),
        np.array([one.normal for one in merged]),
        np.array([one.area for one in merged]),
        np.array([one.gap for one in merged]),
        np.array([len(one.points) for one in merged]),
        np.concatenate([one.points for one in merged]),
    )


def _patches(
    search: ContactSearch,
    frames: FacetFrame,
    frame: Index,
    normal: Array,
    area: Array,
    gap: Array,
    count: Index,
    points: Array,
) -> Patches:
    """Patches, each with the row of a frame that it goes by and `count` points."""
    facets, pair = search.facets, frames.pair[frame]
    facet = np.column_stack([frames.i, frames.j])[frame]
    parts = search.pairs[pair]
    width = (facets.area[facet] / facets.reach[facet]).min(axis=1)
    return Patches(
        pair=pair,
        parts=parts,
        kind=np.full(len(pair), "plane", dtype="<U11"),
        normal=normal,
        area=area,
        gap=gap,
        accuracy=search.geometry.accuracy[parts].sum(axis=1) / width,
        start=starts(count),
        points=points,
        normals=np.repeat(normal, count, axis=0),
    )


def _thin(pieces: Pieces, width: Array) -> Mask:
    """Pieces whose least width is below `width`."""
    if not len(pieces.frame):
        return np.zeros(0, dtype=bool)
    real = (np.arange(pieces.points.shape[1]) < pieces.count[:, None])[..., None]
    low = np.where(real, pieces.points, np.inf).min(axis=1)
    high = np.where(real, pieces.points, -np.inf).max(axis=1)
    diameter = np.linalg.norm(high - low, axis=1)
    doubtful: Mask = pieces.area <= width * diameter  # area <= width x diameter, always
    for row in np.flatnonzero(doubtful):
        doubtful[row] = width_of(pieces.points[row, : pieces.count[row]]) < width[row]
    return doubtful


def _single(search: ContactSearch, frames: FacetFrame, pieces: Pieces) -> Patches:
    """Patches of pairs that have one piece only."""
    rounding = search.limits.rounding[frames.pair[pieces.frame]]
    reach = np.sqrt(np.maximum(pieces.area, 0))
    points, count = tidy(pieces.points, pieces.count, np.maximum(PATCH_CORNER * reach, rounding))
    solid = points[np.arange(points.shape[1]) < count[:, None]]
    middle = frames.middle(solid[:, None, :], np.repeat(pieces.frame, count))[:, 0]
    normal = frames.normal[pieces.frame]
    return _patches(search, frames, pieces.frame, normal, pieces.area, pieces.gap, count, middle)


def _several(
    frames: FacetFrame, members: list[tuple[Pieces, int]], tolerance: float, rounding: float
) -> tuple[list[_Merged], list[Pieces]]:
    """Patches of one pair that has several pieces, plane by plane."""
    frame = np.array([block.frame[row] for block, row in members])
    area = np.array([block.area[row] for block, row in members])
    gap = np.array([block.gap[row] for block, row in members])
    count = np.array([block.count[row] for block, row in members])
    flat = np.concatenate([block.points[row, : block.count[row]] for block, row in members])
    owner = np.repeat(np.arange(len(members)), count)
    points = frames.middle(flat[:, None, :], frame[owner])[:, 0]
    normal = frames.normal[frame]
    center = np.add.reduceat(points, np.cumsum(count) - count) / count[:, None]

    made: list[_Merged] = []
    dropped: list[Pieces] = []
    left = np.ones(len(members), dtype=bool)
    for seed in np.argsort(-area, kind="stable"):
        if not left[seed]:
            continue
        same = left & (np.linalg.norm(normal - normal[seed], axis=1) <= PATCH_ANGLE)
        same &= np.abs((center - center[seed]) @ normal[seed]) <= 2 * tolerance
        same[seed] = True
        left &= ~same
        which = np.flatnonzero(same)
        axes = np.stack([frames.u[frame[seed]], frames.v[frame[seed]]], axis=1)
        plane = (points - center[seed]) @ axes
        wide = _wide_regions(plane, owner, which, area[which], 2 * tolerance)
        dropped.extend(members[k][0].take(np.array([members[k][1]])) for k in which[~wide])
        which = which[wide]
        if not len(which):
            continue
        mine = np.isin(owner, which)
        hull = convex_hull(plane[mine])
        size = max(PATCH_CORNER * float(np.sqrt(area[which].sum())), rounding)
        tidied, number = tidy(hull[None], np.array([len(hull)]), np.array([size]))
        hull = tidied[0, : number[0]]
        mean = area[which] @ normal[which]
        mean /= np.linalg.norm(mean)
        height = float(area[which] @ ((center[which] - center[seed]) @ mean) / area[which].sum())
        lifted = center[seed] + hull @ axes.T
        lifted += np.outer(height - (lifted - center[seed]) @ mean, mean)
        low, high = float(gap[which, 0].min()), float(gap[which, 1].max())
        total = float(area[which].sum())
        made.append(_Merged(int(frame[seed]), mean, total, (low, high), lifted))
    return made, dropped


def _wide_regions(plane: Array, owner: Index, which: Index, area: Array, width: float) -> Mask:
    """Which pieces, with their areas, belong to a connected region at least `width` wide."""
    wide = np.ones(len(which), dtype=bool)
    if len(which) > CROWD:
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
