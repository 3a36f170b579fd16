"""Normals of the points at which edges and corners meet: unique, or several possible.

A corner on a facet has the normal of the facet; two edges that cross have the normal of both. All
other points follow from the local cones of both parts (`local_cones`) and the spanning rule
(`spanning`). A normal close to that of a facet at the point is replaced by the facet's normal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, cross, ragged, starts, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import CONE_ANGLE, EDGE_NEARLY_PARALLEL, NORMAL_SNAP
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edges import Edges
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE, Meetings
from kilter.contact.sharp.local_cones import Cones, find_cones
from kilter.contact.sharp.spanning import resolve, separating
from kilter.work import stop_if_late

__all__ = ["Clauses", "Pushes", "normals_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Pushes(Rows):
    """Contact points of edges and corners that have a unique normal, from part a to part b.

    `of_facet`, shape (n, 2), is True if a facet of part a, or of part b, has the normal.
    """

    meeting: Index
    normal: Array
    of_facet: Mask


@dataclass(frozen=True, slots=True, eq=False)
class Clauses:
    """Degenerate contact points, at which several normals are possible.

    A motion is allowed if it does not close the gap along at least one normal of each point.

    Attributes
    ----------
    meeting : ndarray of int, shape (n,)
        Row of the meeting.
    start, normal : ndarray, shape (n + 1,) and (m, 3)
        Extreme normals of clause k, from a to b: rows ``start[k]`` to ``start[k + 1]``.
    exact : ndarray of bool, shape (n,)
        True if the literal directions, without tolerance, give the same normals.
    """

    meeting: Index
    start: Index
    normal: Array
    exact: Mask

    def take(self, rows: Index) -> Clauses:
        """Copy with only the degenerate points of the given rows."""
        _, at = ragged(self.start, rows)
        start = starts(np.diff(self.start)[rows])
        return Clauses(self.meeting[rows], start, self.normal[at], self.exact[rows])

    @property
    def owner(self) -> Index:
        """Row of the degenerate point to which each normal belongs, shape (m,)."""
        return np.repeat(np.arange(len(self.meeting)), np.diff(self.start))


def normals_of(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, coincident: Mask
) -> tuple[Pushes, Clauses]:
    """Normals of contact points of edges and corners: unique, or several at degenerate points.

    Parameters
    ----------
    geometry : Geometry
    facets : Facets
    edges : Edges
    meetings : Meetings
    coincident : ndarray of bool, shape (n,)
        True if the two points of a meeting coincide up to rounding.
    """
    on_face = (meetings.kind == FACE).any(axis=1)
    first, second = (
        np.where(meetings.kind[:, k] == EDGE, meetings.feature[:, k], 0) for k in (0, 1)
    )
    crossing = np.flatnonzero((meetings.kind == EDGE).all(axis=1))
    along = [edges.direction(geometry, rows[crossing]) for rows in (first, second)]
    crossing = crossing[np.linalg.norm(cross(*along), axis=1) > EDGE_NEARLY_PARALLEL]
    rest = ~on_face
    rest[crossing] = False
    cone_rows, cone_normals, clauses = _cone_normals(
        geometry, facets, edges, meetings, np.flatnonzero(rest)
    )
    clauses = replace(clauses, exact=clauses.exact & coincident[clauses.meeting])
    blocks = [
        _facet_normals(geometry, facets, edges, meetings, np.flatnonzero(on_face)),
        _crossing_normals(geometry, facets, edges, meetings, crossing),
        (cone_rows, cone_normals),
    ]
    rows, normals = (np.concatenate([f[k] for f in blocks]) for k in (0, 1))
    normals, of_facet = _snap_normals(facets, edges, meetings, rows, normals)
    owner = clauses.meeting[clauses.owner]
    snapped, _ = _snap_normals(facets, edges, meetings, owner, clauses.normal)
    clauses = Clauses(clauses.meeting, clauses.start, snapped, clauses.exact)
    return Pushes(rows, normals, of_facet), clauses


def _facet_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Meetings of a corner or edge with a facet that it bends away from: rows and normals."""
    side = (meetings.kind[rows, 1] == FACE).astype(np.int64)
    normal = facets.normal[meetings.feature[rows, side]]
    feature = meetings.feature[rows, 1 - side]
    is_accepted = np.ones(len(rows), dtype=bool)
    corner = np.flatnonzero(meetings.kind[rows, 1 - side] == CORNER)
    corner_rays = edges.rays(geometry, feature[corner])
    rise = np.einsum("ij,ij->i", corner_rays.direction, normal[corner[corner_rays.owner]])
    is_accepted[corner[corner_rays.owner[rise < -CONE_ANGLE]]] = False
    edge = np.flatnonzero(meetings.kind[rows, 1 - side] == EDGE)
    is_accepted[edge] = edges.behind(facets, geometry, feature[edge], -normal[edge], CONE_ANGLE)
    sign = np.where(side == 0, 1.0, -1.0)[:, None]
    return rows[is_accepted], (sign * normal)[is_accepted]


def _crossing_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Meetings of two convex edges that cross from opposite sides: rows and normals."""
    e, f = meetings.feature[rows].T
    normal = unit_rows(cross(edges.direction(geometry, e), edges.direction(geometry, f)))
    convex = ~edges.reflex(facets, geometry, e, CONE_ANGLE) & ~edges.reflex(
        facets, geometry, f, CONE_ANGLE
    )
    accepted_rows, accepted_normals = [], []
    for sign in (1.0, -1.0):
        is_accepted = convex & edges.behind(facets, geometry, e, sign * normal, CONE_ANGLE)
        is_accepted &= edges.behind(facets, geometry, f, -sign * normal, CONE_ANGLE)
        accepted_rows.append(rows[is_accepted])
        accepted_normals.append(sign * normal[is_accepted])
    return np.concatenate(accepted_rows), np.concatenate(accepted_normals)


def _snap_normals(
    facets: Facets, edges: Edges, meetings: Meetings, rows: Index, normals: Array
) -> tuple[Array, Mask]:
    """Replace normals by those of adjacent facets that nearly agree; also mask where these exist.

    Also returns whether a facet of part a, and of part b, has the normal, shape (n, 2).
    """
    of_facet = np.zeros((len(rows), 2), dtype=bool)
    result = normals.copy()
    nearest = np.full(len(rows), NORMAL_SNAP)
    for side, sign in ((0, 1.0), (1, -1.0)):
        kind, feature = meetings.kind[rows, side], meetings.feature[rows, side]
        owner, facet = _facets_at(edges, kind, feature)
        difference = np.linalg.norm(sign * facets.normal[facet] - normals[owner], axis=1)
        order = np.lexsort((difference, owner))
        first = order[np.unique(owner[order], return_index=True)[1]]
        first = first[difference[first] <= NORMAL_SNAP]
        of_facet[owner[first], side] = True
        first = first[difference[first] < nearest[owner[first]]]
        nearest[owner[first]] = difference[first]
        result[owner[first]] = sign * facets.normal[facet[first]]
    return result, of_facet


def _facets_at(edges: Edges, kind: Index, feature: Index) -> tuple[Index, Index]:
    """Facets beside each face, edge or corner, as pairs (row of the feature, facet)."""
    face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
    corner = np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    sides = edges.facet[edges.ray_edge[row]]
    owners = [face, np.repeat(edge, 2), np.repeat(corner[owner], 2)]
    blocks = [feature[face], edges.facet[feature[edge]].reshape(-1), sides.reshape(-1)]
    all_owners, all_facets = np.concatenate(owners), np.concatenate(blocks)
    real = all_facets >= 0
    return all_owners[real], all_facets[real]


def _cone_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array, Clauses]:
    """Unique normals with their rows, and degenerate points, from the local cones of both parts."""
    both = np.concatenate([meetings.kind[rows], meetings.feature[rows]], axis=1).reshape(-1, 2, 2)
    features = both.transpose(2, 0, 1).reshape(-1, 2)  # those of a, then those of b
    stride = int(features[:, 1].max(initial=0)) + 1
    key, feature_row = np.unique(features[:, 0] * stride + features[:, 1], return_inverse=True)
    cones = find_cones(geometry, facets, edges, key // stride, key % stride)
    cone_a, cone_b = feature_row[: len(rows)], feature_row[len(rows) :]
    # all combinations of the pieces of a and b
    owner_a, piece_a = ragged(cones.start, cone_a)
    again, piece_b = ragged(cones.start, cone_b[owner_a])
    owner, piece_a = owner_a[again], piece_a[again]
    normals, count, exact = _pieces_apart(cones, piece_a, piece_b)
    pieces = np.bincount(owner, minlength=len(rows))
    has_one_piece = pieces[owner] == 1
    single = np.flatnonzero(has_one_piece & (count == 1))
    several = np.flatnonzero(has_one_piece & (count > 1))
    accepted, accepted_normals = [owner[single]], [normals[single, 0]]
    clauses = [
        (owner[several], count[several], _stack_normals(normals, count, several), exact[several])
    ]
    first = np.searchsorted(owner, np.arange(len(rows) + 1))
    for k in np.flatnonzero(pieces > 1).tolist():
        stop_if_late()
        pairs_of_pieces = [j for j in range(int(first[k]), int(first[k + 1])) if count[j]]
        result = resolve(
            [
                (_rays(cones, piece_a[j]), _rays(cones, piece_b[j]), normals[j, : count[j]])
                for j in pairs_of_pieces
            ]
        )
        accepted.append(np.full(len(result.accepted), k))
        accepted_normals.append(result.accepted)
        length = np.array([len(c) for c in result.clauses], dtype=np.int64)
        stacked = np.concatenate([np.empty((0, 3)), *result.clauses])
        is_exact = np.full(len(length), bool(exact[pairs_of_pieces].all()))
        clauses.append((np.full(len(length), k), length, stacked, is_exact))
    row, length, stacked, is_exact = (np.concatenate([c[i] for c in clauses]) for i in range(4))
    return (
        rows[np.concatenate(accepted)],
        np.concatenate(accepted_normals),
        Clauses(rows[row], starts(length), stacked, is_exact),
    )


def _rays(cones: Cones, piece: int) -> Array:
    """Unit directions that span the convex cone number `piece`."""
    return cones.rays[cones.ray_start[piece] : cones.ray_start[piece + 1]]


def _stack_normals(normals: Array, count: Index, rows: Index) -> Array:
    """The first ``count[k]`` normals of each row k, shape (m, 3)."""
    inside = np.arange(normals.shape[1]) < count[rows][:, None]
    stacked: Array = normals[rows][inside]
    return stacked


def _pieces_apart(cones: Cones, piece_a: Index, piece_b: Index) -> tuple[Array, Index, Mask]:
    """Normals that separate pairs of convex cones, in batches of equal shape."""
    length = np.diff(cones.ray_start)
    key = length[piece_a] * (int(length.max(initial=0)) + 1) + length[piece_b]
    count = np.zeros(len(piece_a), dtype=np.int64)
    exact = np.ones(len(piece_a), dtype=bool)
    normals = np.zeros((len(piece_a), 1, 3))
    for lengths in np.unique(key):
        rows = np.flatnonzero(key == lengths)
        rays = [
            cones.rays[cones.ray_start[piece][:, None] + np.arange(length[piece[0]])]
            for piece in (piece_a[rows], piece_b[rows])
        ]
        found_normals, count[rows], exact[rows] = separating(*rays)
        if found_normals.shape[1] > normals.shape[1]:
            padding = np.zeros((len(normals), found_normals.shape[1] - normals.shape[1], 3))
            normals = np.concatenate([normals, padding], axis=1)
        normals[rows, : found_normals.shape[1]] = found_normals
    return normals, count, exact
