"""Near pairs whose corners or edges almost touch, without any recorded contact.

Near faces are recorded when facets are intersected; a corner over a face, or an edge beside an
edge, is not. Only pairs without a contact and without near faces are searched, within `LOOSE_GAP`
of the size of the smaller part.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Mask
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import LOOSE_GAP
from kilter.contact.gaps import APART, RejectedPair
from kilter.contact.sharp.edges import find_edges
from kilter.contact.sharp.feature_pairs import Meetings, PairBlock, meetings

__all__ = ["near_edges"]


def near_edges(search: ContactSearch, unrecorded: Mask) -> list[RejectedPair]:
    """Near pairs of parts without recorded contact, each with its nearest corner or edge.

    Parameters
    ----------
    search : ContactSearch
    unrecorded : ndarray of bool, shape (n,)
        Pairs of the search without any contact, overlap or near faces.
    """
    geometry, boxes = search.geometry, search.boxes
    a, b = search.pairs.T
    limit = LOOSE_GAP * np.minimum(geometry.size[a], geometry.size[b])
    grow = limit[:, None]
    meets = (boxes.part_low[a] <= boxes.part_high[b] + grow).all(axis=1)
    meets &= (boxes.part_low[b] <= boxes.part_high[a] + grow).all(axis=1)
    rows = np.flatnonzero(unrecorded & meets)
    if not len(rows):
        return []
    a, b, grow = a[rows], b[rows], grow[rows]
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
    edges = find_edges(geometry, search.facets, np.unique(search.pairs[rows]))
    block = PairBlock(search, edges, rows, limit[rows], low, high)
    found_meetings = Meetings.join(meetings(block))
    apart = np.linalg.norm(found_meetings.at[:, 1] - found_meetings.at[:, 0], axis=1)
    nearest: dict[int, float] = {}
    for row, gap in zip(found_meetings.pair.tolist(), apart.tolist(), strict=True):
        nearest[row] = min(gap, nearest.get(row, gap))
    rejected = []
    for row, gap in nearest.items():
        part_a, part_b = search.pairs[row].tolist()
        rejected.append(RejectedPair((part_a, part_b), gap, 0.0, APART))
    return rejected
