"""Normals of meetings: points of contact with one normal, and points without.

A corner in a facet and edges that cross have the normal of the facet, that of both edges.
Everything else goes by the cones of both parts (`cones`) and the spanning rule (`spanning`).
Where a facet at the point has the normal found, the facet's own is taken.
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

__all__ = ["Clauses", "Pushes", "normals_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Pushes(Rows):
    """Points with a normal: row of the meeting, normal from a to b, whose facet has it.

    `of_facet`: shape (n, 2), of part a, of part b.
    """

    meeting: Index
    normal: Array
    of_facet: Mask


@dataclass(frozen=True, slots=True, eq=False)
class Clauses:
    """Points without one normal: at least one of several is not to be entered.

    Attributes
    ----------
    meeting : ndarray of int, shape (n,)
    start, normal : ndarray, shape (n + 1,) and (m, 3)
        Extreme normals of clause k, from a to b: rows ``start[k]`` to ``start[k + 1]``.
    exact : ndarray of bool, shape (n,)
        They are the same where the directions are taken at their word.
    """

    meeting: Index
    start: Index
    normal: Array
    exact: Mask

    def take(self, rows: Index) -> Clauses:
        """The rows chosen."""
        _, at = ragged(self.start, rows)
        start = starts(np.diff(self.start)[rows])
        return Clauses(self.meeting[rows], start, self.normal[at], self.exact[rows])

    @property
    def owner(self) -> Index:
        """The clause of each normal, shape (m,)."""
        return np.repeat(np.arange(len(self.meeting)), np.diff(self.start))


def normals_of(
    geometry: Geometry, facets: Facets, edges: Edges, met: Meetings, one_place: Mask
) -> tuple[Pushes, Clauses]:
    """Normals of meetings, and clauses of those that have no one normal.

    Parameters
    ----------
    one_place : ndarray of bool, shape (n,)
        Whether the two points of each meeting are one but for rounding.
    """
    on_face = (met.kind == FACE).any(axis=1)
    first, second = (np.where(met.kind[:, k] == EDGE, met.feature[:, k], 0) for k in (0, 1))
    crossing = np.flatnonzero((met.kind == EDGE).all(axis=1))
    along = [edges.direction(geometry, rows[crossing]) for rows in (first, second)]
    crossing = crossing[np.linalg.norm(cross(*along), axis=1) > EDGE_NEARLY_PARALLEL]
    rest = ~on_face
    rest[crossing] = False
    row, normal, clauses = _by_cones(geometry, facets, edges, met, np.flatnonzero(rest))
    clauses = replace(clauses, exact=clauses.exact & one_place[clauses.meeting])
    found = [
        _in_facets(geometry, facets, edges, met, np.flatnonzero(on_face)),
        _of_crossings(geometry, facets, edges, met, crossing),
        (row, normal),
    ]
    rows, normals = (np.concatenate([f[k] for f in found]) for k in (0, 1))
    normals, of_facet = _snapped(facets, edges, met, rows, normals)
    owner = clauses.meeting[clauses.owner]
    snapped, _ = _snapped(facets, edges, met, owner, clauses.normal)
    clauses = Clauses(clauses.meeting, clauses.start, snapped, clauses.exact)
    return Pushes(rows, normals, of_facet), clauses


def _in_facets(
    geometry: Geometry, facets: Facets, edges: Edges, met: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Corners and edges in facets: accepted if they bend away from the facet there."""
    side = (met.kind[rows, 1] == FACE).astype(np.int64)
    normal = facets.normal[met.feature[rows, side]]
    other = met.feature[rows, 1 - side]
    fits = np.ones(len(rows), dtype=bool)
    corner = np.flatnonzero(met.kind[rows, 1 - side] == CORNER)
    rays = edges.rays(geometry, other[corner])
    rise = np.einsum("ij,ij->i", rays.direction, normal[corner[rays.owner]])
    fits[corner[rays.owner[rise < -CONE_ANGLE]]] = False
    edge = np.flatnonzero(met.kind[rows, 1 - side] == EDGE)
    fits[edge] = edges.behind(facets, geometry, other[edge], -normal[edge], CONE_ANGLE)
    sign = np.where(side == 0, 1.0, -1.0)[:, None]
    return rows[fits], (sign * normal)[fits]


def _of_crossings(
    geometry: Geometry, facets: Facets, edges: Edges, met: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Edges that cross: accepted if both are convex and lie on either side of the plane."""
    e, f = met.feature[rows].T
    normal = unit_rows(cross(edges.direction(geometry, e), edges.direction(geometry, f)))
    convex = ~edges.reflex(facets, geometry, e, CONE_ANGLE) & ~edges.reflex(
        facets, geometry, f, CONE_ANGLE
    )
    found_rows, found = [], []
    for turn in (1.0, -1.0):
        fits = convex & edges.behind(facets, geometry, e, turn * normal, CONE_ANGLE)
        fits &= edges.behind(facets, geometry, f, -turn * normal, CONE_ANGLE)
        found_rows.append(rows[fits])
        found.append(turn * normal[fits])
    return np.concatenate(found_rows), np.concatenate(found)


def _snapped(
    facets: Facets, edges: Edges, met: Meetings, rows: Index, normals: Array
) -> tuple[Array, Mask]:
    """Normals as those of facets at the points where these agree; and whose they are."""
    of_facet = np.zeros((len(rows), 2), dtype=bool)
    result = normals.copy()
    nearest = np.full(len(rows), NORMAL_SNAP)
    for side, sign in ((0, 1.0), (1, -1.0)):
        kind, feature = met.kind[rows, side], met.feature[rows, side]
        owner, facet = _facets_at(edges, kind, feature)
        apart = np.linalg.norm(sign * facets.normal[facet] - normals[owner], axis=1)
        order = np.lexsort((apart, owner))
        first = order[np.unique(owner[order], return_index=True)[1]]
        first = first[apart[first] <= NORMAL_SNAP]
        of_facet[owner[first], side] = True
        first = first[apart[first] < nearest[owner[first]]]
        nearest[owner[first]] = apart[first]
        result[owner[first]] = sign * facets.normal[facet[first]]
    return result, of_facet


def _facets_at(edges: Edges, kind: Index, feature: Index) -> tuple[Index, Index]:
    """Facets that meet at features: (place, facet)."""
    face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
    corner = np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    sides = edges.facet[edges.ray_edge[row]]
    owners = [face, np.repeat(edge, 2), np.repeat(corner[owner], 2)]
    found = [feature[face], edges.facet[feature[edge]].reshape(-1), sides.reshape(-1)]
    all_owners, all_found = np.concatenate(owners), np.concatenate(found)
    real = all_found >= 0
    return all_owners[real], all_found[real]


def _by_cones(
    geometry: Geometry, facets: Facets, edges: Edges, met: Meetings, rows: Index
) -> tuple[Index, Array, Clauses]:
    """The rows by the cones of both parts: accepted rows with normals, and clauses."""
    both = np.concatenate([met.kind[rows], met.feature[rows]], axis=1).reshape(-1, 2, 2)
    names = both.transpose(2, 0, 1).reshape(-1, 2)  # those of a, then those of b
    big = int(names[:, 1].max(initial=0)) + 1
    key, which = np.unique(names[:, 0] * big + names[:, 1], return_inverse=True)
    cones = find_cones(geometry, facets, edges, key // big, key % big)
    cone_a, cone_b = which[: len(rows)], which[len(rows) :]
    # every piece of a with every piece of b
    owner_a, piece_a = ragged(cones.start, cone_a)
    again, piece_b = ragged(cones.start, cone_b[owner_a])
    owner, piece_a = owner_a[again], piece_a[again]
    normals, count, exact = _pieces_apart(cones, piece_a, piece_b)
    pieces = np.bincount(owner, minlength=len(rows))
    plain = pieces[owner] == 1
    one = np.flatnonzero(plain & (count == 1))
    several = np.flatnonzero(plain & (count > 1))
    accepted, found = [owner[one]], [normals[one, 0]]
    clauses = [(owner[several], count[several], _flat(normals, count, several), exact[several])]
    first = np.searchsorted(owner, np.arange(len(rows) + 1))
    for k in np.flatnonzero(pieces > 1).tolist():
        span = [j for j in range(int(first[k]), int(first[k + 1])) if count[j]]
        result = resolve(
            [
                (_rays(cones, piece_a[j]), _rays(cones, piece_b[j]), normals[j, : count[j]])
                for j in span
            ]
        )
        accepted.append(np.full(len(result.accepted), k))
        found.append(result.accepted)
        length = np.array([len(c) for c in result.clauses], dtype=np.int64)
        stacked = np.concatenate([np.empty((0, 3)), *result.clauses])
        sure = np.full(len(length), bool(exact[span].all()))
        clauses.append((np.full(len(length), k), length, stacked, sure))
    at, length, stacked, sure = (np.concatenate([c[i] for c in clauses]) for i in range(4))
    return (
        rows[np.concatenate(accepted)],
        np.concatenate(found),
        Clauses(rows[at], starts(length), stacked, sure),
    )


def _rays(cones: Cones, piece: int) -> Array:
    return cones.rays[cones.ray_start[piece] : cones.ray_start[piece + 1]]


def _flat(normals: Array, count: Index, rows: Index) -> Array:
    inside = np.arange(normals.shape[1]) < count[rows][:, None]
    stacked: Array = normals[rows][inside]
    return stacked


def _pieces_apart(cones: Cones, piece_a: Index, piece_b: Index) -> tuple[Array, Index, Mask]:
    """`separating` of pairs of pieces, those with equally many directions in one go."""
    length = np.diff(cones.ray_start)
    key = length[piece_a] * (int(length.max(initial=0)) + 1) + length[piece_b]
    count = np.zeros(len(piece_a), dtype=np.int64)
    exact = np.ones(len(piece_a), dtype=bool)
    normals = np.zeros((len(piece_a), 1, 3))
    for value in np.unique(key):
        rows = np.flatnonzero(key == value)
        rays = [
            cones.rays[cones.ray_start[piece][:, None] + np.arange(length[piece[0]])]
            for piece in (piece_a[rows], piece_b[rows])
        ]
        some, count[rows], exact[rows] = separating(*rays)
        if some.shape[1] > normals.shape[1]:
            more = np.zeros((len(normals), some.shape[1] - normals.shape[1], 3))
            normals = np.concatenate([normals, more], axis=1)
        normals[rows, : some.shape[1]] = some
    return normals, count, exact
