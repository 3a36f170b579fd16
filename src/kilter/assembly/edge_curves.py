"""Find points on the edge curves between two faces, starting from their chords.

The edge between the faces f = 0 and g = 0 has the chord p q. The point of the edge over a point of
the chord lies in the plane across the chord there. Newton's method on f = g = 0 finds it, starting
from the chord.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, unit_rows
from kilter.assembly.assembly_tolerances import BESIDE_SEAM, CREASE
from kilter.assembly.surfaces import Surfaces

__all__ = ["Chords"]

STEPS = 4
"""Number of Newton steps from a chord to its edge; more steps reach strongly curved edges."""


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """Straight edges of a mesh that stand for n curved edges, each between two exact faces."""

    p: Array
    q: Array
    """Ends of the chords, on both faces, shape (n, 3)."""
    surface: Index
    """Exact surface of each face, or -1 for the plane of a triangle, shape (n, 2)."""
    origin: Array
    normal: Array
    """A point and the unit normal of that plane, shape (n, 2, 3)."""

    def rising(self, side: int, points: Array, s: Surfaces) -> tuple[Array, Array]:
        """Signed distance of points from one of the two faces at each edge, and its gradient.

        Arguments: `points` (n, 3). Returns `value` (n,); `gradient` (n, 3).
        """
        row = self.surface[:, side]
        normal = self.normal[:, side].copy()
        value = np.einsum("ij,ij->i", points - self.origin[:, side], normal)
        curved = np.flatnonzero(row >= 0)
        value[curved] = s.distance(row[curved], points[curved])
        normal[curved] = s.outward(row[curved], points[curved])
        return value, normal

    def on_edge(self, share: Array, s: Surfaces) -> tuple[Array, Mask]:
        """Points on the true curved edges above points of the chords, and a mask of success.

        Arguments: `share` (n,): position along each chord, from 0 at p to 1 at q. Returns `points`
        (n, 3); `converged` (n,): False if the faces meet smoothly, or Newton's method has not
        converged.
        """
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
