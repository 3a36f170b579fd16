"""Patches: the overlaps of facets that touch, merged to one hull a pair of parts and plane.

Pieces of one pair lie in one plane where their normals agree within the merging angle and
their offsets within twice the gap tolerance. What is thinner than twice the gap tolerance
is no area of contact; that is asked of each connected region, not of each piece (a ring of
thin triangles is a wide region), by its area over its diameter (two slivers along a bent
line are not wide, though their hull is). Pieces as thin as the rounding of the coordinates
are dropped before: one along a line of contact would widen the hull of the patch it touches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.contact.planar.clip import tidy
from kilter.contact.planar.opposing import FacetFrame, Pieces
from kilter.contact.planar.outline import convex_hull, width_of

__all__ = ["Patches", "merge"]


SAME_PLANE = 1e-4
"""Largest angle between pieces of one patch [rad], besides the angle tolerance's tenth."""
NOISE = 8.0
"""Pieces narrower than this many roundings of the coordinates are no pieces."""
CROWD = 1500
"""Up to this many pieces the connected regions of a plane are told apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Patches, arrays: see `ContactSet`; `pair` is the row of the pair of parts."""

    pair: Index
    normal: Array
    area: Array
    gap: Array
    frame: Index
    start: Index
    points: Array


def merge(
    frames: FacetFrame, blocks: list[Pieces], tolerance: Array, blur: Array
) -> tuple[Patches, list[Pieces]]:
    """Patches of accepted pieces, and the pieces dropped because they are too thin.

    Parameters
    ----------
    tolerance, blur : ndarray, shape (number of pairs,)
        Gap tolerance, and rounding of the coordinates, of each pair [length unit].
    """
    noise = [_thin(block, NOISE * blur[frames.pair[block.frame]]) for block in blocks]
    thin = [block.take(np.flatnonzero(slim)) for block, slim in zip(blocks, noise, strict=True)]
    blocks = [block.take(np.flatnonzero(~slim)) for block, slim in zip(blocks, noise, strict=True)]
    pairs = [frames.pair[block.frame] for block in blocks]
    number = np.bincount(np.concatenate([*pairs, np.empty(0, np.int64)]), minlength=len(tolerance))
    groups: list[Patches] = []
    crowd: list[tuple[int, int, int]] = []
    for k, (block, pair) in enumerate(zip(blocks, pairs, strict=True)):
        alone = number[pair] == 1
        slim = np.zeros(len(pair), dtype=bool)
        slim[alone] = _thin(block.take(np.flatnonzero(alone)), 2 * tolerance[pair[alone]])
        thin.append(block.take(np.flatnonzero(slim)))
        groups.append(_single(frames, block.take(np.flatnonzero(alone & ~slim)), tolerance, blur))
        crowd.extend((int(pair[row]), k, int(row)) for row in np.flatnonzero(~alone))
    crowd.sort()
    begin = 0
    for end in range(1, len(crowd) + 1):
        if end == len(crowd) or crowd[end][0] != crowd[begin][0]:
            members = [(blocks[k], row) for _, k, row in crowd[begin:end]]
            patches, dropped = _several(frames, members, float(tolerance[crowd[begin][0]]), blur)
            groups.append(patches)
            thin.extend(dropped)
            begin = end
    return _ordered(groups), [block for block in thin if len(block.frame)]


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


def _single(frames: FacetFrame, pieces: Pieces, tolerance: Array, blur: Array) -> Patches:
    """Patches of pairs that have one piece only."""
    pair = frames.pair[pieces.frame]
    reach = np.sqrt(np.maximum(pieces.area, 0))
    points, count = tidy(pieces.points, pieces.count, np.maximum(1e-10 * reach, blur[pair]))
    solid = points[np.arange(points.shape[1]) < count[:, None]]
    row = np.repeat(np.arange(len(pair)), count)
    middle = frames.middle(solid[:, None, :], pieces.frame[row])[:, 0]
    return Patches(
        pair=pair,
        normal=frames.normal[pieces.frame],
        area=pieces.area,
        gap=pieces.gap,
        frame=pieces.frame,
        start=np.concatenate([[0], np.cumsum(count)]),
        points=middle,
    )


def _several(
    frames: FacetFrame, members: list[tuple[Pieces, int]], tolerance: float, blur: Array
) -> tuple[Patches, list[Pieces]]:
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

    made: list[Patches] = []
    dropped: list[Pieces] = []
    left = np.ones(len(members), dtype=bool)
    for seed in np.argsort(-area, kind="stable"):
        if not left[seed]:
            continue
        same = left & (np.linalg.norm(normal - normal[seed], axis=1) <= SAME_PLANE)
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
        size = max(1e-10 * float(np.sqrt(area[which].sum())), float(blur[frames.pair[frame[seed]]]))
        tidied, number = tidy(hull[None], np.array([len(hull)]), np.array([size]))
        hull = tidied[0, : number[0]]
        mean = area[which] @ normal[which]
        mean /= np.linalg.norm(mean)
        height = float(area[which] @ ((center[which] - center[seed]) @ mean) / area[which].sum())
        lifted = center[seed] + hull @ axes.T
        lifted += np.outer(height - (lifted - center[seed]) @ mean, mean)
        made.append(
            Patches(
                pair=frames.pair[frame[seed]][None],
                normal=mean[None],
                area=np.array([area[which].sum()]),
                gap=np.array([[gap[which, 0].min(), gap[which, 1].max()]]),
                frame=frame[seed][None],
                start=np.array([0, len(hull)]),
                points=lifted,
            )
        )
    return _ordered(made), dropped


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
    from scipy.sparse.csgraph import connected_components

    label = connected_components(meets, directed=False)[1]
    for region in np.unique(label):
        members = np.flatnonzero(label == region)
        if len(members) == 1:
            wide[members] = width_of(hulls[members[0]]) >= width
            continue
        corners = np.concatenate([hulls[k] for k in members])
        diameter = float(np.linalg.norm(np.ptp(corners, axis=0)))
        wide[members] = area[members].sum() >= width * diameter
    return wide


def _ordered(groups: list[Patches]) -> Patches:
    """Groups of patches as one, ordered by pair."""
    groups = [group for group in groups if len(group.pair)]
    if not groups:
        return Patches(
            pair=np.empty(0, dtype=np.int64),
            normal=np.empty((0, 3)),
            area=np.empty(0),
            gap=np.empty((0, 2)),
            frame=np.empty(0, dtype=np.int64),
            start=np.zeros(1, dtype=np.int64),
            points=np.empty((0, 3)),
        )
    pair = np.concatenate([group.pair for group in groups])
    count = np.concatenate([np.diff(group.start) for group in groups])
    points = np.concatenate([group.points for group in groups])
    order = np.argsort(pair, kind="stable")
    first = (np.cumsum(count) - count)[order]
    count = count[order]
    start = np.concatenate([[0], np.cumsum(count)])
    rows = np.repeat(first - start[:-1], count) + np.arange(len(points))
    return Patches(
        pair=pair[order],
        normal=np.concatenate([group.normal for group in groups])[order],
        area=np.concatenate([group.area for group in groups])[order],
        gap=np.concatenate([group.gap for group in groups])[order],
        frame=np.concatenate([group.frame for group in groups])[order],
        start=start,
        points=points[rows],
    )
