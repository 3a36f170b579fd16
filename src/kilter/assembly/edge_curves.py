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
    """Straight edges of a mesh that stand for n curved edges, each between two exact faces.

    Attributes
    ----------
    p, q : ndarray, shape (n, 3)
        Ends of the chords, on both faces.
    surface : ndarray of int, shape (n, 2)
        Exact surface of each face, or -1 for the plane of a triangle.
    origin, normal : ndarray, shape (n, 2, 3)
        A point and the unit normal of that plane.
    """

    p: Array
    q: Array
    surface: Index
    origin: Array
    normal: Array

    def rising(self, side: int, points: Array, s: Surfaces) -> tuple[Array, Array]:
        """Signed distance of points from one of the two faces at each edge, and its gradient.

        Parameters
        ----------
        side : int
            0 or 1: the first or second face of each edge.
        points : ndarray, shape (n, 3)
        s : Surfaces

        Returns
        -------
        value : ndarray, shape (n,)
        gradient : ndarray, shape (n, 3)
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

        Parameters
        ----------
        share : ndarray, shape (n,)
            Position along each chord, from 0 at p to 1 at q.
        s : Surfaces

        Returns
        -------
        points : ndarray, shape (n, 3)
        converged : ndarray of bool, shape (n,)
            False if the faces meet smoothly, or Newton's method has not converged.
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
