"""Contacts of exact edges and corners with edges and corners, at curved faces.

Two curves that cross have the normal of both tangents; the material of each must lie on its side of
the plane with this normal. A corner on an edge or corner, the tip of a cone there, and edges that
run along each other have no single normal: their points are unresolved.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, lengths, unit_rows
from kilter.contact.broad import joins
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import CURVE_END, EDGE_NEARLY_PARALLEL, EDGE_PARALLEL
from kilter.contact.curved.edge_touching import (
    EdgeContact,
    EdgeSearch,
    EdgeTouching,
    corner_rays,
    is_corner,
)
from kilter.contact.curved.exact_edges import EdgeCurves
from kilter.contact.curved.rim_points import cone_tips
from kilter.contact.curved.unmodelled import explained_points
from kilter.contact.face_patches import FacePatches
from kilter.contact.sharp.edges import segment_distance

__all__ = ["edges_on_edges", "near_edge_pairs", "tips_on_edges"]


CROSSING_STEPS = 12
"""Gauss-Newton steps that locate the nearest points of two curves."""


def edges_on_edges(
    search: ContactSearch, curves: EdgeCurves, blocks: tuple[Index, Index, Index], reach: Array,
    found: EdgeTouching,
) -> None:  # fmt: skip
    """Add the contacts of edges with edges to `found`.

    Parameters
    ----------
    search : ContactSearch
    curves : EdgeCurves
    blocks : (pair, edge, edge)
        Exact sharp edges of part a and of part b that may come near each other, shape (n,) each.
    reach : ndarray, shape (number of pairs of parts,)
        Largest gap at which parts touch, or may touch [length unit].
    found : EdgeTouching
    """
    pair, e, f = blocks
    if not len(pair):
        return
    state = EdgeSearch(search, curves, reach, found)
    t, u, crossing = _nearest_shares(curves, e, f)
    x, y = curves.points(e, t), curves.points(f, u)
    apart = y.at - x.at
    distance = lengths(apart)
    inside = (np.minimum(t, u) >= -CURVE_END) & (np.maximum(t, u) <= 1 + CURVE_END)
    k = np.flatnonzero(inside & crossing & (distance <= reach[pair]))
    normal = unit_rows(cross(x.along[k], y.along[k]))
    for row, n in zip(k, normal, strict=True):
        one = np.array([row])
        limit, number = state.limit(int(pair[row])), int(pair[row])
        if _at_corner(curves, e[one], x.at[row], limit) or _at_corner(
            curves, f[one], y.at[row], limit
        ):
            continue  # the corner is compared with the other edge apart
        for sense in (1.0, -1.0):
            direction = sense * n
            if x.take(one).behind(direction) & y.take(one).behind(-direction):
                gap = float(apart[row] @ direction)
                middle = (x.at[row] + y.at[row]) / 2
                if state.is_near(number, gap):
                    contact = EdgeContact(
                        number, "edge-edge", middle[None], direction[None], np.array([gap])
                    )
                    state.found.add(contact, limit)
                break
        else:
            if distance[row] <= limit:
                state.found.unresolved.append((number, x.at[row]))
    beside = np.flatnonzero(~crossing)
    _edges_beside(state, pair[beside], e[beside], f[beside])
    _corners_on_edges(state, pair, e, f)


def _nearest_shares(curves: EdgeCurves, e: Index, f: Index) -> tuple[Array, Array, Mask]:
    """Nearest points of two curves, as fractions of their chords, and a mask of crossing curves.

    Curves with parallel tangents have no single nearest point.
    """
    (p, q), (r, s) = (curves.edges.ends(curves.geometry, edge) for edge in (e, f))
    first, second = (p + q) / 2, (r + s) / 2
    k = _crossing_chords(q - p, s - r)
    _, first[k], second[k] = segment_distance(p[k], q[k], r[k], s[k])
    chord_e, chord_f = q - p, s - r
    t = np.einsum("ij,ij->i", first - p, chord_e) / np.einsum("ij,ij->i", chord_e, chord_e)
    u = np.einsum("ij,ij->i", second - r, chord_f) / np.einsum("ij,ij->i", chord_f, chord_f)
    crossing = np.ones(len(e), dtype=bool)
    rounding_e, rounding_f = curves.share_rounding(e), curves.share_rounding(f)
    moving = np.arange(len(e))
    for _ in range(CROSSING_STEPS):
        x, y = curves.points(e[moving], t[moving]), curves.points(f[moving], u[moving])
        apart = y.at - x.at
        c = np.einsum("ij,ij->i", x.along, y.along)
        square = 1 - c**2
        crossing[moving] = square > EDGE_NEARLY_PARALLEL**2
        a, b = (np.einsum("ij,ij->i", apart, z.along) for z in (x, y))
        safe = np.where(crossing[moving], square, np.inf)
        speed_e = np.einsum("ij,ij->i", x.along, chord_e[moving])
        speed_f = np.einsum("ij,ij->i", y.along, chord_f[moving])
        last_t, last_u = t[moving], u[moving]
        t[moving] = last_t + (a - c * b) / safe / np.maximum(speed_e, TINY)
        u[moving] = last_u + (c * a - b) / safe / np.maximum(speed_f, TINY)
        t[moving], u[moving] = np.clip(t[moving], -0.5, 1.5), np.clip(u[moving], -0.5, 1.5)
        moved = np.abs(t[moving] - last_t) > rounding_e[moving]
        moved |= np.abs(u[moving] - last_u) > rounding_f[moving]
        moving = moving[moved]
        if not len(moving):
            break
    return t, u, crossing


def _at_corner(curves: EdgeCurves, edge: Index, point: Array, limit: float) -> bool:
    """Whether a point of an edge lies within `limit` of a corner at its end."""
    ends = curves.edges.ends_of[edge[0]]
    near = lengths(curves.geometry.vertices[ends] - point) <= limit
    ends = ends[near]
    if not len(ends):
        return False
    owner, away, _, unknown = corner_rays(curves, ends)
    return bool((is_corner(owner, away, len(ends)) | unknown).any())


def _edges_beside(state: EdgeSearch, pair: Index, e: Index, f: Index) -> None:
    """Unresolved points of edges that run along each other within the gap tolerance."""
    if not len(pair):
        return
    curves = state.curves
    for first, second in ((e, f), (f, e)):
        for share in (0.0, 0.5, 1.0):
            point = curves.points(first, np.full(len(first), share)).at
            off = _distance_from_curve(curves, second, point)
            for k in np.flatnonzero(off <= state.reach[pair]):
                _add_degenerate(state, int(pair[k]), point[k], float(off[k]))


def tips_on_edges(
    search: ContactSearch, curves: EdgeCurves, rows: Index, reach: Array, found: EdgeTouching
) -> None:
    """Add the tips of cones on edges and corners of the other part to `found`: unresolved points.

    Parameters
    ----------
    search, curves, reach, found
        As in `edge_contacts_on_faces`.
    rows : ndarray of int, shape (n,)
        Pairs to search.
    """
    geometry = search.geometry
    tips = cone_tips(geometry)
    if not len(tips):
        return
    state = EdgeSearch(search, curves, reach, found)
    s = geometry.surfaces
    for pair in rows.tolist():
        parts = search.pairs[pair].tolist()
        for own, other in (parts, parts[::-1]):
            for tip in s.point[tips[s.part[tips] == own]]:
                near = curves.beside(other, tip, float(reach[pair] + geometry.slack[other]))
                off = curves.distances(near, tip)
                if len(off) and off.min() <= reach[pair]:
                    _add_degenerate(state, pair, tip, float(off.min()))


def _add_degenerate(state: EdgeSearch, pair: int, point: Array, gap: float) -> None:
    """Add a point without a single normal: unresolved if it touches, else near."""
    if gap > state.limit(pair) and state.is_near(pair, gap):
        state.found.near.append((pair, gap))
    else:
        state.found.unresolved.append((pair, point))


def _distance_from_curve(curves: EdgeCurves, edge: Index, point: Array) -> Array:
    """Distance of points from the curves of edges, up to their ends [length unit], shape (n,)."""
    nearest = curves.points(edge, curves.nearest_share(edge, point)).at
    distance: Array = lengths(point - nearest)
    return distance


def _corners_on_edges(state: EdgeSearch, pair: Index, e: Index, f: Index) -> None:
    """Unresolved points of corners on edges or corners, within the gap tolerance."""
    curves = state.curves
    for own, other in ((e, f), (f, e)):
        for end in (0, 1):
            vertex = curves.edges.ends_of[own, end]
            point = curves.geometry.vertices[vertex]
            off = _distance_from_curve(curves, other, point)
            k = np.flatnonzero(off <= state.reach[pair])
            owner, away, _, unknown = corner_rays(curves, vertex[k])
            corner = is_corner(owner, away, len(k)) | unknown
            for row in k[corner]:
                _add_degenerate(state, int(pair[row]), point[row], float(off[row]))


def near_edge_pairs(
    face_patches: FacePatches, curves: EdgeCurves, rows: Index, reach: Array
) -> tuple[Index, Index, Index]:
    """Pairs of exact sharp edges that come near: pair of parts, edge of a, edge of b, shape (n,).

    Edges that come near only on a contact patch of their pair are left out.
    """
    search = face_patches.search
    geometry, boxes, edges = search.geometry, search.boxes, curves.edges
    a, b = search.pairs[rows].T
    grow = reach[rows] + geometry.slack[a] + geometry.slack[b]
    box = (
        np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow[:, None],
        np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow[:, None],
    )
    sides = []
    for part in (a, b):
        owner, edge = edges.inside(boxes, part, box)
        used, place = np.unique(edge, return_inverse=True)
        keep = curves.exact(used)
        keep[keep] = curves.sharp(used[keep])
        sides.append((owner[keep[place]], edge[keep[place]]))
    empty = np.empty(0, dtype=np.int64)
    blocks = [(empty, empty, empty)]
    (owner_a, edge_a), (owner_b, edge_b) = sides
    for k, x, y in joins(
        owner_a, edges.boxes(boxes, edge_a), owner_b, edges.boxes(boxes, edge_b), grow
    ):
        e, f = edge_a[x], edge_b[y]
        distance, middle = _chord_distance(curves, e, f)
        slack = geometry.slack[a[k]] + geometry.slack[b[k]]
        near = np.flatnonzero(distance <= reach[rows[k]] + slack)
        near = near[~explained_points(face_patches, rows[k[near]], middle[near], reach)]
        blocks.append((rows[k[near]], e[near], f[near]))
    pair, e, f = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    return pair, e, f


def _crossing_chords(first: Array, second: Array) -> Index:
    """Rows of vectors that are not parallel."""
    sine = lengths(cross(unit_rows(first), unit_rows(second)))
    return np.flatnonzero(sine > EDGE_PARALLEL)


def _chord_distance(curves: EdgeCurves, e: Index, f: Index) -> tuple[Array, Array]:
    """Distance of the chords of edges, shape (n,), and the point half-way, shape (n, 3)."""
    geometry, edges = curves.geometry, curves.edges
    (p, q), (r, s) = edges.ends(geometry, e), edges.ends(geometry, f)
    distance, middle = np.full(len(p), np.inf), (p + q) / 2
    k = _crossing_chords(q - p, s - r)
    distance[k], first, second = segment_distance(p[k], q[k], r[k], s[k])
    middle[k] = (first + second) / 2
    # parallel chords: the distances of the ends decide
    for point, start, end in ((p, r, s), (q, r, s), (r, p, q), (s, p, q)):
        along = end - start
        square = np.maximum(np.einsum("ij,ij->i", along, along), TINY)
        t = np.clip(np.einsum("ij,ij->i", point - start, along) / square, 0, 1)
        foot = start + t[:, None] * along
        apart = lengths(point - foot)
        nearer = apart < distance
        distance = np.where(nearer, apart, distance)
        middle = np.where(nearer[:, None], (point + foot) / 2, middle)
    return distance, middle
