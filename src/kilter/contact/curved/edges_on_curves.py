"""Sharp edges and corners that touch curved faces."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, Surfaces
from kilter.contact.broad import Boxes, joins
from kilter.contact.contact_tolerances import FACETED_ANGLE, SMOOTH_ANGLE
from kilter.contact.curved.curved_patches import CurvedContacts
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edges import Edges
from kilter.contact.touching import Touching
from kilter.shape.covering import covered

__all__ = ["edges_on_faces"]


def edges_on_faces(
    touching: Touching, edges: Edges, rows: Index, reach: Array, *, turn: bool
) -> tuple[Index, Array, Index]:
    """Where sharp edges of b (of a, if `turn`) touch curved faces of the other part.

    Parameters
    ----------
    touching : Touching
    edges : Edges
        Of all parts of the pairs `rows`.
    rows : ndarray of int, shape (n,)
    reach : ndarray, shape (number of pairs,)
        Up to this distance they touch [length unit].
    turn : bool

    Returns
    -------
    pair : ndarray of int, shape (m,)
    points : ndarray, shape (m, 3)
    surfaces : ndarray of int, shape (m,)
        The curved faces.
    """
    search, curved = touching.search, touching.curved
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    pairs, tolerance = search.pairs, reach
    s = geometry.surfaces
    a, b = pairs[rows].T[::-1] if turn else pairs[rows].T
    slack = geometry.slack[b]
    grow = tolerance[rows] + slack
    owner, face = ragged(s.start, a)
    keep = (s.kind[face] != FREE) & (np.diff(s.triangle_start)[face] > 0)
    owner, face = owner[keep], face[keep]
    low, high = _face_boxes(geometry, boxes, face)
    margin = (grow + geometry.slack[a])[:, None]
    box = (
        np.maximum(boxes.part_low[a], boxes.part_low[b]) - margin,
        np.minimum(boxes.part_high[a], boxes.part_high[b]) + margin,
    )
    owner_e, edge = edges.inside(boxes, b, box)
    sharp = _sharp(geometry, facets, edges, edge)
    owner_e, edge = owner_e[sharp], edge[sharp]
    box_e = edges.boxes(boxes, edge)
    found = [(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0, np.int64))]
    for k, x, y in joins(owner, (low, high), owner_e, box_e, margin[:, 0]):
        surface, line = face[x], edge[y]
        p, q = edges.ends(geometry, line)
        limit = grow[k] + s.doubt[surface]
        there = ~_on_patch(curved, rows[k], surface, s, p, q, limit)
        k, surface, line, p, q = k[there], surface[there], line[there], p[there], q[there]
        exact, middle = _true_middle(geometry, facets, edges, line, p, q)
        limit = np.where(exact, tolerance[rows][k] + s.doubt[surface], limit[there])
        point, off = _nearest(s, surface, (p, middle, q), limit)
        near = np.flatnonzero(np.abs(off) <= limit)
        near = near[_on_face(geometry, surface[near], point[near], limit[near])]
        found.append((rows[k[near]], point[near], surface[near]))
    pair, points, surfaces = (np.concatenate([f[k] for f in found]) for k in range(3))
    return pair, points, surfaces


def _face_boxes(geometry: Geometry, boxes: Boxes, face: Index) -> tuple[Array, Array]:
    s = geometry.surfaces
    used, place = np.unique(face, return_inverse=True)
    low, high = np.empty((len(used), 3)), np.empty((len(used), 3))
    for k, row in enumerate(used.tolist()):
        points = boxes.turned[geometry.triangles[s.triangles_of(row)]]
        low[k] = points.min(axis=(0, 1)) - s.sagitta[row]
        high[k] = points.max(axis=(0, 1)) + s.sagitta[row]
    return low[place], high[place]


def _sharp(geometry: Geometry, facets: Facets, edges: Edges, edge: Index) -> Mask:
    """Edges at which two faces meet at an angle, as the exact surfaces tell it."""
    s = geometry.surfaces
    one, other = edges.facet[edge].T
    middle = geometry.vertices[edges.ends_of[edge, 0]]
    normals, exact = [], np.ones(len(edge), dtype=bool)
    for facet in (one, other):
        surface = facets.surface[facet]
        free = (surface >= 0) & (s.kind[surface] == FREE) if len(s) else surface >= 0
        known = (surface >= 0) & ~free
        normal = facets.normal[facet].copy()
        normal[known] = s.outward(surface[known], middle[known])
        normals.append(normal)
        exact &= ~free
    sine = np.linalg.norm(cross(*normals), axis=1)
    bend = np.arctan2(sine, np.einsum("ij,ij->i", *normals))
    alone = (one < 0) | (other < 0)
    inner = (facets.surface[one] == facets.surface[other]) & (facets.surface[one] >= 0)
    sharp: Mask = alone | (~inner & (bend > np.where(exact, SMOOTH_ANGLE, FACETED_ANGLE)))
    return sharp


def _on_patch(
    curved: CurvedContacts, pair: Index, surface: Index, s: Surfaces, p: Array, q: Array,
    limit: Array,
) -> Mask:  # fmt: skip
    """Edges both of whose ends lie on a surface that has a patch of contact in the pair."""
    patches = curved.patches
    both = [np.column_stack([patches.pair, side])[patches.area > 0] for side in curved.surface.T]
    names = np.unique(np.concatenate(both), axis=0)
    if not len(names):
        return np.zeros(len(pair), dtype=bool)
    big = len(s) + 1
    has = np.isin(pair * big + surface, names[:, 0] * big + names[:, 1])
    held: Mask = has & (np.abs(s.distance(surface, p)) <= limit)
    return held & (np.abs(s.distance(surface, q)) <= limit)


def _true_middle(
    geometry: Geometry, facets: Facets, edges: Edges, line: Index, p: Array, q: Array
) -> tuple[Mask, Array]:
    """Whether the true edge is known, and its middle: on the curved surface beside it."""
    s = geometry.surfaces
    middle, exact = (p + q) / 2, np.ones(len(line), dtype=bool)
    for facet in edges.facet[line].T:
        surface = facets.surface[facet]
        curved = np.flatnonzero((surface >= 0) & (facet >= 0))
        known = curved[s.kind[surface[curved]] != FREE]
        exact[curved] = (s.kind[surface[curved]] != FREE) & (s.doubt[surface[curved]] == 0)
        row = surface[known]
        # out along the plane of the rim, which the flat neighbour and the chord lie in
        out = _across_axis(s, row, middle[known])
        for _ in range(3):
            off = s.distance(row, middle[known])
            steep = np.einsum("ij,ij->i", s.outward(row, middle[known]), out)
            step = off / np.where(np.abs(steep) > SMOOTH_ANGLE, steep, np.inf)
            middle[known] -= step[:, None] * out
    return exact, middle


def _across_axis(s: Surfaces, row: Index, points: Array) -> Array:
    """Unit directions away from the axis of surfaces; from the centre of a sphere."""
    away: Array = s.polar(row, points)[2]
    return away


def _nearest(
    s: Surfaces, face: Index, edge: tuple[Array, Array, Array], limit: Array
) -> tuple[Array, Array]:
    """Point of each edge (start, middle, end) nearest to a face, and its signed distance.

    The distance is taken for the parabola through its three values; where it changes its
    sign the edge passes through the face.
    """
    values = np.stack([s.distance(face, x) for x in edge], axis=1)
    order = np.argmin(values, axis=1)
    rows = np.arange(len(face))
    best, off = np.stack(edge, axis=1)[rows, order].copy(), values[rows, order].copy()
    f0, f1, f2 = values.T
    bend = 2 * (f0 - 2 * f1 + f2)
    t = np.clip((3 * f0 - 4 * f1 + f2) / np.where(bend > 0, 2 * bend, np.inf), 0, 1)
    weight = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)
    there = np.einsum("nk,nki->ni", weight, np.stack(edge, axis=1))
    value = s.distance(face, there)
    better = (value < off) & (bend > 0)
    best[better], off[better] = there[better], value[better]
    through = (values.min(axis=1) < -limit) & (values.max(axis=1) > limit)
    share = (f0 / np.where(f0 != f2, f0 - f2, 1.0)).clip(0, 1)
    best[through] = edge[0][through] + share[through, None] * (edge[2] - edge[0])[through]
    off[through] = 0.0
    return best, off


def _on_face(geometry: Geometry, face: Index, point: Array, limit: Array) -> Mask:
    """Whether faces reach to points on their surfaces."""
    s = geometry.surfaces
    held = np.zeros(len(face), dtype=bool)
    normal = s.outward(face, point) if len(face) else point
    for row in np.unique(face).tolist():
        mine = np.flatnonzero(face == row)
        grow = float(limit[mine].max())
        triangles = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        reach = float(s.sagitta[row]) + grow
        held[mine] = covered(triangles, point[mine], normal[mine], reach, grow)
    return held
