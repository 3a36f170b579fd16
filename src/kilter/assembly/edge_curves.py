"""Curves in which two faces meet, known by their chords.

An edge between the faces f = 0 and g = 0 runs over its chord p q: its point over a share of the
chord lies across it, where both vanish, and is found by Newton's method from the chord.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, unit_rows
from kilter.assembly.assembly_tolerances import BESIDE_SEAM, CREASE
from kilter.assembly.surfaces import Surfaces

__all__ = ["Chords"]

STEPS = 4
"""Newton steps from a chord to the edge that it stands for."""


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """Chords of edges between two faces each.

    Attributes
    ----------
    p, q : ndarray, shape (n, 3)
        Their ends, on both faces.
    surface : ndarray of int, shape (n, 2)
        Rows of exact surfaces; -1: the plane of a triangle.
    origin, normal : ndarray, shape (n, 2, 3)
        A point and the unit normal of such planes.
    """

    p: Array
    q: Array
    surface: Index
    origin: Array
    normal: Array

    def rising(self, side: int, points: Array, s: Surfaces) -> tuple[Array, Array]:
        """Signed distance of points from the faces of a side, and its gradient."""
        row = self.surface[:, side]
        normal = self.normal[:, side].copy()
        value = np.einsum("ij,ij->i", points - self.origin[:, side], normal)
        curved = np.flatnonzero(row >= 0)
        value[curved] = s.distance(row[curved], points[curved])
        normal[curved] = s.outward(row[curved], points[curved])
        return value, normal

    def on_edge(self, share: Array, s: Surfaces) -> tuple[Array, Mask]:
        """Points of the edges over shares of their chords, and where they were found."""
        along = unit_rows(self.q - self.p)
        points = self.p + share[:, None] * (self.q - self.p)
        for _ in range(STEPS):
            (f, m), (g, n) = (self.rising(side, points, s) for side in (0, 1))
            sine = np.einsum("ij,ij->i", cross(m, n), along)
            crease = np.abs(sine) > CREASE
            step = f[:, None] * cross(along, n) - g[:, None] * cross(along, m)
            points = points + step / np.where(crease, sine, np.inf)[:, None]
        length = np.linalg.norm(self.q - self.p, axis=1)
        off = np.maximum(*(np.abs(self.rising(side, points, s)[0]) for side in (0, 1)))
        return points, crease & (off <= BESIDE_SEAM * length)
