"""Areas between the round edges of flat facets and their chords.

The corners of a facet are on its round edges, so its polygon lacks a segment at each chord (or has
one too many, at the edge of a hole). A chord of length c, whose edge has the height h over it,
lacks the segment of a circle

    r^2 / 2 (t - sin t),   r = (c^2 / 4 + h^2) / (2 h),   t = 2 asin(c / (2 r))

A patch that covers a facet as a whole has the exact area of the facet. A part of a facet has the
area of its polygon.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross, unit_rows
from kilter.assembly.edge_curves import Chords
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.contact_tolerances import STRAIGHT
from kilter.contact.planar.facets import Facets, facet_triangles
from kilter.shape.closed import shared_edges

__all__ = ["missing_areas"]


def missing_areas(geometry: Geometry, facets: Facets, chosen: Index) -> Array:
    """Exact area of each chosen flat facet minus the area of its polygon, shape (n,).

    Parameters
    ----------
    geometry : Geometry
    facets : Facets
    chosen : ndarray of int, shape (n,)
        Indices of the facets; a facet may occur several times.
    """
    missing = np.zeros(len(facets.part))
    s = geometry.surfaces
    flat = np.unique(chosen[~facets.curved[chosen]])
    flat = flat[np.isin(facets.part[flat], s.part)] if len(s) else flat[:0]
    for part in np.unique(facets.part[flat]):
        chords, key, outward = _round_edges(geometry, int(part))
        own = flat[facets.part[flat] == part]
        owner, triangles = facet_triangles(facets.corner_start, facets.convex, own)
        ids = facets.corners[triangles]
        sides = (ids * len(geometry.vertices) + np.roll(ids, -1, axis=1)).ravel()
        order = np.argsort(sides, kind="stable")
        at = np.minimum(np.searchsorted(sides[order], key), len(sides) - 1)
        found = sides[order][at] == key
        lost = _segments(chords, outward, geometry)
        np.add.at(missing, own[owner[order[at[found]] // 3]], lost[found])
    return missing[chosen]


def _round_edges(geometry: Geometry, part: int) -> tuple[Chords, Index, Array]:
    """Edges between triangles in planes and exact curved surfaces of a part.

    Returns
    -------
    chords : Chords
    key : ndarray of int, shape (n,)
        First vertex times the number of vertices, plus the second, in the sense of the flat face.
    outward : ndarray, shape (n, 3)
        Unit vectors in the flat face, away from it.
    """
    g, s = geometry, geometry.surfaces
    span = slice(g.triangle_start[part], g.triangle_start[part + 1])
    triangles, label = g.triangles[span], g.triangle_surface[span]
    first, second = shared_edges(triangles)
    both = np.column_stack([first, second])
    both = np.concatenate([both, both[:, ::-1]])  # the flat side first
    on = label[both // 3]
    known = (s.kind[on[:, 1]] != FREE) & (s.doubt[on[:, 1]] == 0)
    both = both[(on[:, 0] < 0) & (on[:, 1] >= 0) & known]
    side = both // 3
    start = triangles[side[:, 0], both[:, 0] % 3]
    end = triangles[side[:, 0], (both[:, 0] + 1) % 3]
    corner = g.vertices[triangles[side]]
    normal = unit_rows(cross(corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0]))
    p, q = g.vertices[start], g.vertices[end]
    chords = Chords(p, q, label[side], corner[:, :, 0], normal)
    return chords, start * len(g.vertices) + end, unit_rows(cross(q - p, normal[:, 0]))


def _segments(chords: Chords, outward: Array, geometry: Geometry) -> Array:
    """Signed areas between chords and their edges, positive outside the flat face, shape (n,)."""
    top, converged = chords.on_edge(np.full(len(chords.p), 0.5), geometry.surfaces)
    chord = np.linalg.norm(chords.q - chords.p, axis=1)
    height = np.einsum("ij,ij->i", top - (chords.p + chords.q) / 2, outward)
    bent = np.flatnonzero(converged & (np.abs(height) > STRAIGHT * chord))
    c, h = chord[bent], np.abs(height[bent])
    radius = (c**2 / 4 + h**2) / (2 * h)
    angle = 2 * np.arcsin(np.minimum(c / (2 * radius), 1.0))
    area = np.zeros(len(chord))
    area[bent] = np.sign(height[bent]) * radius**2 / 2 * (angle - np.sin(angle))
    return area
