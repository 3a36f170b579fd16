"""Pairs that nothing connects, but whose corners or edges come nearly to touch.

Faces that come near are recorded where they are overlaid; a corner over a face, or an edge beside
an edge, is not. Asked of pairs alone that have no contact and no near faces, within `LOOSE_GAP` of
the size of the smaller part.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Mask
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import LOOSE_GAP
from kilter.contact.gaps import APART, Rejected
from kilter.contact.sharp.edges import find_edges
from kilter.contact.sharp.feature_pairs import Meetings, PairBlock, meetings

__all__ = ["near_edges"]


def near_edges(search: ContactSearch, silent: Mask) -> list[Rejected]:
    """The nearest corner or edge of each pair that nothing connects.

    Parameters
    ----------
    search : ContactSearch
    silent : ndarray of bool, shape (n,)
        The pairs of the search without any contact, overlap or near faces.
    """
    geometry, boxes = search.geometry, search.boxes
    a, b = search.pairs.T
    limit = LOOSE_GAP * np.minimum(geometry.size[a], geometry.size[b])
    grow = limit[:, None]
    meets = (boxes.part_low[a] <= boxes.part_high[b] + grow).all(axis=1)
    meets &= (boxes.part_low[b] <= boxes.part_high[a] + grow).all(axis=1)
    rows = np.flatnonzero(silent & meets)
    if not len(rows):
        return []
    a, b, grow = a[rows], b[rows], grow[rows]
    low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
    high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
    edges = find_edges(geometry, search.facets, np.unique(search.pairs[rows]))
    block = PairBlock(search, edges, rows, limit[rows], low, high)
    met = Meetings.join(meetings(block))
    apart = np.linalg.norm(met.at[:, 1] - met.at[:, 0], axis=1)
    nearest: dict[int, float] = {}
    for row, gap in zip(met.pair.tolist(), apart.tolist(), strict=True):
        nearest[row] = min(gap, nearest.get(row, gap))
    found = []
    for row, gap in nearest.items():
        one, other = search.pairs[row].tolist()
        found.append(Rejected((one, other), gap, 0.0, APART))
    return found
