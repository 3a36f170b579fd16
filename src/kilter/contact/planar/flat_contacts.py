"""Contacts of flat faces: overlaps of opposed facets, split into touching and rejected pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index
from kilter.contact.broad import facet_pairs
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import LOOKED_AT_ANGLE, ROUNDINGS
from kilter.contact.gaps import (
    APART,
    PENETRATES,
    THIN,
    TILTED,
    RejectedPair,
    nearest_gap,
    touches,
)
from kilter.contact.kept_pairs import KeptPairs
from kilter.contact.patches import Patches
from kilter.contact.planar.facet_overlays import FacetFrame, Pieces, facet_frames, overlaps_of
from kilter.contact.planar.merging import merge
from kilter.contact.smooth.smooth_joints import SmoothJoints

__all__ = ["GAP_EDGES", "FlatContacts", "find_flat"]


DECADES: Array = np.power(10.0, np.arange(-12, -1))
GAP_EDGES: Array = np.concatenate([[-np.inf], -DECADES[::-1], [0.0], DECADES, [np.inf]])
"""Bin edges of the histogram of gaps, relative to the size of the smaller part [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatContacts:
    """Result of the search for flat contacts: patches, near faces, and the gaps of opposed faces.

    Attributes
    ----------
    patches : Patches
    rejected : list of RejectedPair
    gaps : ndarray of int, shape (n, 2)
        Row of the pair, and interval of `GAP_EDGES`, of each gap between opposed faces.
    """

    patches: Patches
    rejected: list[RejectedPair]
    gaps: Index

    @property
    def counts(self) -> Index:
        """Number of gaps in each interval of `GAP_EDGES`."""
        return np.bincount(self.gaps[:, 1], minlength=len(GAP_EDGES) - 1)

    @staticmethod
    def join(blocks: Sequence[tuple[int, FlatContacts]]) -> FlatContacts:
        """Contacts of successive pairs; a block gives its first pair, and its contacts."""
        return FlatContacts(
            Patches.join(block.patches.after(begin) for begin, block in blocks),
            [pair for _, block in blocks for pair in block.rejected],
            np.concatenate([np.add(block.gaps, (begin, 0)) for begin, block in blocks]),
        )

    def among(self, kept: KeptPairs) -> FlatContacts:
        """The contacts of some of the pairs, with new numbers."""
        return FlatContacts(
            kept.patches(self.patches), list(kept.records(self.rejected)), kept.rows(self.gaps)
        )


def find_flat(search: ContactSearch, smooth: SmoothJoints) -> FlatContacts:
    """Find the contacts of flat faces of near pairs, except facets of smooth contacts."""
    geometry, facets, limits = search.geometry, search.facets, search.limits
    widest = max(LOOKED_AT_ANGLE, 2 * search.angle)
    cosine = float(np.cos(widest))
    pair, i, j = facet_pairs(facets, search.boxes, search.pairs, limits.margin, cosine)
    flat = ~(facets.curved[i] | facets.curved[j])
    pair, i, j = pair[flat], i[flat], j[flat]
    plain = ~smooth.between(pair, i, j)
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
    return FlatContacts(patches, rejected, np.concatenate(gaps))


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
