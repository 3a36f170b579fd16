"""Pairs of parts that may touch where the surface of a part is unknown.

A stand-in (a box or hull in place of a solid that could not be read) may touch every part that
comes near its box; an open mesh every part that comes near the box of a hole. The kind of contact
is unknown: such a pair is listed among the rejected pairs, with a gap of 0, and is open.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly.geometry import Geometry
from kilter.contact.gaps import UNKNOWN, RejectedPair

__all__ = ["unknown_contacts", "unknown_pairs"]


def unknown_pairs(geometry: Geometry, pairs: Index, reach: Array) -> tuple[Index, Index]:
    """Split near pairs into pairs to search, and pairs that may touch at an unknown surface.

    Parameters
    ----------
    geometry : Geometry
    pairs : ndarray of int, shape (n, 2)
    reach : ndarray, shape (N,)
        Distance from each part within which others are searched for [length unit].

    Returns
    -------
    looked_at, unknown : ndarray of int, shape (k, 2) and (m, 2)
        A pair with a stand-in is only in the second array; a pair with a hole may be in both.
    """
    places = geometry.unknown
    if not len(places) or not len(pairs):
        return pairs, pairs[:0]
    stand_in = places.stand_ins(len(geometry.mass))
    blind: Mask = stand_in[pairs[:, 0]] | stand_in[pairs[:, 1]]
    meets: Mask = blind.copy()
    for k in range(len(places)):
        for side in (0, 1):
            rows = np.flatnonzero(~meets & (pairs[:, side] == places.part[k]))
            other = pairs[rows, 1 - side]
            grown = reach[places.part[k]] + reach[other]
            low, high = places.low[k] - grown[:, None], places.high[k] + grown[:, None]
            meets[rows] = [
                _meets_box(geometry, *box) for box in zip(other.tolist(), low, high, strict=True)
            ]
    return pairs[~blind], pairs[meets]


def _meets_box(geometry: Geometry, part: int, low: Array, high: Array) -> bool:
    """Whether the bounding box of any triangle of a part meets the box from `low` to `high`."""
    rows = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[rows]]
    apart = (corners.max(axis=1) < low) | (corners.min(axis=1) > high)
    return bool((~apart.any(axis=1)).any())


def unknown_contacts(pairs: Index) -> list[RejectedPair]:
    """Records of pairs that may touch at an unknown surface, as `RejectedPair` values."""
    return [RejectedPair((a, b), 0.0, 0.0, UNKNOWN) for a, b in pairs.tolist()]
