"""Exact curves of the edges of parts: the curve in which the two faces of an edge meet.

An edge of the triangles is a chord of this curve. A point of the chord is moved to the curve by
Newton steps of least length: with the distances d of a point from both faces and their normals N,
the step is -N^T (N N^T)^-1 d. The step leaves the position along the curve, so that the fraction of
the chord remains a parameter of the curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    Rows,
    angle_between,
    columns,
    cross,
    largest_entries,
    lengths,
    ratio,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import CONE_ANGLE, CURVE_ROUNDING, SMOOTH_ANGLE
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edges import Edges, find_edges
from kilter.shape.covering import covered

__all__ = ["CurvePoints", "EdgeCurves", "face_distance", "part_curves"]


NEAREST_STEPS = 12
"""Steps that locate the point of a curve that is nearest to another point."""
NEWTON_STEPS = 5
"""Steps that move a point of a chord to its curve; each doubles the number of correct digits."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvePoints(Rows):
    """Points of edges with the unit tangents of their curves, and the normals of both faces.

    All arrays have the shape (n, 3). Tangents lead from the first to the second end of the edge;
    `left` and `right` are the outward normals of the faces beside it, seen from outside.
    """

    at: Array = columns(3)
    along: Array = columns(3)
    left: Array = columns(3)
    right: Array = columns(3)

    def behind(self, normal: Array) -> Mask:
        """Mask of points at which the material lies behind a plane, shape (n,).

        `normal` is the outward normal of the plane, shape (3,), or of a plane for each point.
        """
        into_left, into_right = cross(self.left, self.along), cross(self.along, self.right)
        inward = into_left + into_right - self.left - self.right
        result = np.ones(len(self.at), dtype=bool)
        for direction in (into_left, into_right, inward):
            result &= (direction * normal).sum(axis=1) <= CONE_ANGLE
        return result


def face_distance(
    geometry: Geometry, facets: Facets, surface: Index, facet: Index, points: Array
) -> tuple[Array, Array]:
    """Signed distance of points from faces, shape (n,), and outward normals there, shape (n, 3).

    Parameters
    ----------
    geometry : Geometry
    facets : Facets
    surface : ndarray of int, shape (n,)
        Curved surface of each point; -1: the plane of `facet`.
    facet : ndarray of int, shape (n,)
    points : ndarray, shape (n, 3)
    """
    s = geometry.surfaces
    normal = facets.normal[facet].copy()
    distance = np.einsum("ij,ij->i", points - facets.origin[facet], normal)
    k = np.flatnonzero(surface >= 0)
    if len(k):
        distance[k], normal[k] = s.distance_and_outward(surface[k], points[k])
    return distance, normal


@dataclass(frozen=True, slots=True, eq=False)
class EdgeCurves:
    """The curves of the edges of a contact search."""

    geometry: Geometry
    facets: Facets
    edges: Edges

    def exact(self, edge: Index) -> Mask:
        """Mask of edges between two faces whose surfaces are known exactly, shape (n,)."""
        s = self.geometry.surfaces
        result = np.ones(len(edge), dtype=bool)
        for facet in self.edges.facet[edge].T:
            surface = self.facets.surface[facet]
            known = (facet >= 0) & (self.facets.normal[facet] != 0).any(axis=1)
            k = np.flatnonzero(surface >= 0)
            known[k] &= (s.kind[surface[k]] != FREE) & (s.doubt[surface[k]] == 0)
            result &= known
        return result

    def sharp(self, edge: Index) -> Mask:
        """Mask of exact edges whose faces meet at an angle, shape (n,)."""
        distinct, place = np.unique(edge, return_inverse=True)
        left, right = (self.facets.surface[facet] for facet in self.edges.facet[distinct].T)
        middle = self.points(distinct, np.full(len(distinct), 0.5))
        bend = angle_between(middle.left, middle.right)
        is_sharp: Mask = ~((left == right) & (left >= 0)) & (bend > SMOOTH_ANGLE)
        return is_sharp[place]

    def points(self, edge: Index, share: Array) -> CurvePoints:
        """Points of exact edges at the given fractions of their chords, shape (n,)."""
        p, q = self.edges.ends(self.geometry, edge)
        at = p + share[:, None] * (q - p)
        rounding = CURVE_ROUNDING * self._coordinates(p, q)
        moving = np.arange(len(edge))
        for _ in range(NEWTON_STEPS):
            step = self._step(edge[moving], at[moving])
            at[moving] -= step
            moving = moving[largest_entries(step) > rounding[moving]]
            if not len(moving):
                break
        (_, left), (_, right) = self._sides(edge, at)
        along = unit_rows(cross(left, right))
        forward = np.einsum("ij,ij->i", along, q - p) < 0
        return CurvePoints(at, np.where(forward[:, None], -along, along), left, right)

    def _step(self, edge: Index, at: Array) -> Array:
        """Newton steps of least length from points to the curves of edges, shape (n, 3)."""
        (d, m), (e, n) = self._sides(edge, at)
        c = np.einsum("ij,ij->i", m, n)
        across = cross(m, n)
        square = np.maximum(np.einsum("ij,ij->i", across, across), TINY)
        step: Array = ((d - c * e) / square)[:, None] * m + ((e - c * d) / square)[:, None] * n
        # tangent faces have no common direction of steps: the chord is kept
        step[square <= SMOOTH_ANGLE**2 / 4] = 0.0
        return step

    def _sides(self, edge: Index, at: Array) -> list[tuple[Array, Array]]:
        """Signed distances of points from both faces of edges, and the normals of these faces."""
        return [
            face_distance(self.geometry, self.facets, self.facets.surface[facet], facet, at)
            for facet in self.edges.facet[edge].T
        ]

    @staticmethod
    def _coordinates(p: Array, q: Array) -> Array:
        """Size of the coordinates of edges from p to q, which are rounded, shape (n,)."""
        return lengths(q - p) + largest_entries(p)

    def nearest_share(self, edge: Index, point: Array) -> Array:
        """Position of the point of each curve that is nearest to a point, in [0, 1], shape (n,).

        The position is the fraction of the chord.
        """
        p, q = self.edges.ends(self.geometry, edge)
        chord = q - p
        square = np.maximum(np.einsum("ij,ij->i", chord, chord), TINY)
        t: Array = np.clip(np.einsum("ij,ij->i", point - p, chord) / square, 0, 1)
        rounding = self.share_rounding(edge)
        moving = np.arange(len(edge))
        for _ in range(NEAREST_STEPS):
            x = self.points(edge[moving], t[moving])
            along = np.einsum("ij,ij->i", point[moving] - x.at, x.along)
            speed = np.maximum(np.einsum("ij,ij->i", x.along, chord[moving]), TINY)
            last = t[moving]
            t[moving] = np.clip(last + along / speed, 0, 1)
            moving = moving[np.abs(t[moving] - last) > rounding[moving]]
            if not len(moving):
                break
        return t

    def share_rounding(self, edge: Index) -> Array:
        """Rounding of the fraction of a chord, from that of the coordinates [-], shape (n,)."""
        p, q = self.edges.ends(self.geometry, edge)
        return CURVE_ROUNDING * ratio(self._coordinates(p, q), lengths(q - p))

    def beside(self, part: int, point: Array, reach: float) -> Index:
        """Edges of a part whose chords come within `reach` of a point, shape (n,)."""
        every = np.arange(self.edges.start[part], self.edges.start[part + 1])
        near: Index = every[self._chord_distance(every, point[None])[0] <= reach]
        return near

    def at_edge(self, part: int, point: Array, most: float) -> bool:
        """Whether a point lies within `most` of an exact sharp edge of a part [length unit]."""
        near = self.beside(part, point, most + float(self.geometry.slack[part]))
        return bool((self.distances(near, point) <= most).any())

    def distances(self, edge: Index, point: Array) -> Array:
        """Distances of a point from the exact sharp edges among `edge` [length unit], (m,)."""
        edge = edge[self.exact(edge)]
        edge = edge[self.sharp(edge)]
        at = self.points(edge, self.nearest_share(edge, np.tile(point, (len(edge), 1)))).at
        result: Array = lengths(point - at)
        return result

    def extends(
        self, part: int, face: tuple[int, int], at: tuple[Array, Array], triangles: Array,
        depth: float, grow: float,
    ) -> Mask:  # fmt: skip
        """Mask of points of a surface to which a face extends, up to `grow` beside it, shape (n,).

        The triangles of a face end at chords of its edges. Beside an edge with a curve the curve
        decides, and elsewhere the triangles.

        Parameters
        ----------
        part : int
        face : (surface, facet)
            The curved surface, or -1 and the flat facet.
        at : (points, normals)
            Points of the surface and normals there, shape (n, 3).
        triangles : ndarray, shape (m, 3, 3)
            Triangles of the face.
        depth : float
            Largest distance of a triangle from a point along the normal [length unit].
        grow : float
            Largest distance of a point from the face [length unit].
        """
        points, normals = at
        result = covered(triangles, points, normals, depth, grow)
        slack = float(self.geometry.slack[part])
        edge, is_left = self._bounding(part, face)
        if slack == 0 or not len(edge):
            return result
        row, number = np.nonzero(self._chord_distance(edge, points) <= slack + grow)
        row, number = _only_rows_with_all(row, number, self.exact(edge))
        rows = np.unique(row)
        if not len(rows):
            return result
        x = self.points(edge[number], self.nearest_share(edge[number], points[row]))
        offset = points[row] - x.at
        left, right = cross(x.left, x.along), cross(x.along, x.right)
        into = np.where(is_left[number][:, None], left, right)
        distance = lengths(offset)
        least = np.full(len(points), np.inf)
        np.minimum.at(least, row, distance)
        outside = np.einsum("ij,ij->i", offset, into) < -grow
        outside &= distance <= least[row] + grow / 10  # the nearest curve decides
        wide = covered(triangles, points[rows], normals[rows], depth, grow + slack)
        result[rows] = wide & ~np.isin(rows, row[outside])
        return result

    def _bounding(self, part: int, face: tuple[int, int]) -> tuple[Index, Mask]:
        """Edges that bound a face, and a mask of those that have the face on their left side."""
        edge = np.arange(self.edges.start[part], self.edges.start[part + 1])
        sides = self.edges.facet[edge]
        surface, facet = face
        own = (self.facets.surface[sides] == surface) if surface >= 0 else (sides == facet)
        bounds = own[:, 0] != own[:, 1]
        return edge[bounds], own[bounds, 0]

    def _chord_distance(self, edge: Index, points: Array) -> Array:
        """Distance of each of n points from the chords of m edges [length unit], shape (n, m)."""
        p, q = self.edges.ends(self.geometry, edge)
        square = np.maximum(np.einsum("ij,ij->i", q - p, q - p), TINY)
        offset = points[:, None] - p
        t = np.clip(np.einsum("nmi,mi->nm", offset, q - p) / square, 0, 1)
        distance: Array = lengths(offset - t[..., None] * (q - p))
        return distance


def _only_rows_with_all(row: Index, number: Index, keep: Mask) -> tuple[Index, Index]:
    """Pairs (row, number) of the rows for which all numbers are kept."""
    kept = ~np.isin(row, row[~keep[number]])
    return row[kept], number[kept]


def part_curves(search: ContactSearch, part: int) -> EdgeCurves:
    """The curves of the edges of a part of a contact search, which are found on first use."""
    curves = search.part_curves.get(part)
    if curves is None:
        edges = find_edges(search.geometry, search.facets, np.array([part]))
        curves = search.part_curves[part] = EdgeCurves(search.geometry, search.facets, edges)
    return curves
