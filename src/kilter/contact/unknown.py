"""Pairs that may touch where the surface of one of them is not known.

A stand-in (a solid that could not be read, with a box or a hull in its place) may touch whatever
its box comes near; an open mesh whatever comes near the box of a hole. Nothing says how: such a
pair is listed among the rejected ones, with a gap of 0, and is open.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly.geometry import Geometry
from kilter.contact.gaps import UNKNOWN, Rejected

__all__ = ["unknown_contacts", "unknown_pairs"]


def unknown_pairs(geometry: Geometry, pairs: Index, reach: Array) -> tuple[Index, Index]:
    """Of pairs that come near: those to look at, and those that may touch where nothing is known.

    Parameters
    ----------
    geometry : Geometry
    pairs : ndarray of int, shape (n, 2)
    reach : ndarray, shape (N,)
        How far from each part others are looked for [length unit].

    Returns
    -------
    looked_at, unknown : ndarray of int, shape (k, 2) and (m, 2)
        A pair of a stand-in is in the second alone, one with a hole may be in both.
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
                _enters(geometry, *one) for one in zip(other.tolist(), low, high, strict=True)
            ]
    return pairs[~blind], pairs[meets]


def _enters(geometry: Geometry, part: int, low: Array, high: Array) -> bool:
    """Whether the box of some triangle of a part meets a box."""
    mine = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[mine]]
    apart = (corners.max(axis=1) < low) | (corners.min(axis=1) > high)
    return bool((~apart.any(axis=1)).any())


def unknown_contacts(pairs: Index) -> list[Rejected]:
    """Such pairs as they are listed."""
    return [Rejected((a, b), 0.0, 0.0, UNKNOWN) for a, b in pairs.tolist()]
