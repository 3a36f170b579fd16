"""Patches without area for the contacts of edges and corners.

An edge on a facet is a single patch, with its two ends on that facet as points; every other point
is a patch of its own.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index, Labels, connected, ragged
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import CONE_ANGLE, EDGE_STRAIGHTNESS, NORMAL_ANGLE
from kilter.contact.patches import Patches
from kilter.contact.sharp.edges import Edges
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE, Meetings
from kilter.contact.sharp.normals import Pushes

__all__ = ["edge_contacts"]


def edge_contacts(
    search: ContactSearch, edges: Edges, meetings: Meetings, pushes: Pushes
) -> Patches:
    """Contact patches for the accepted contact points of edges and corners, ordered by pair.

    `accuracy` is that of the coordinates, relative to the size of the features that touch.
    """
    if not len(pushes.meeting):
        return Patches.none()
    pushes = pushes.take(np.argsort(meetings.pair[pushes.meeting], kind="stable"))
    label = _edge_labels(search, edges, meetings, pushes)
    point = meetings.middle[pushes.meeting]
    pushes_kept = _without_middle_points(point, label)
    pushes, label = pushes.take(pushes_kept), label[pushes_kept]
    order = np.argsort(label, kind="stable")
    pushes, label = pushes.take(order), label[order]
    row = pushes.meeting
    start = np.append(np.flatnonzero(np.diff(label, prepend=-1)), len(label))
    gap = np.einsum("ij,ij->i", meetings.at[row, 1] - meetings.at[row, 0], pushes.normal)
    first = start[:-1]
    gaps = [reduce.reduceat(gap, first) for reduce in (np.minimum, np.maximum)]
    point_accuracy = _relative_accuracy(search, edges, meetings, row)
    pair = meetings.pair[row[first]]
    return Patches(
        pair=pair,
        parts=search.pairs[pair],
        kind=_kinds(meetings, pushes, start),
        normal=pushes.normal[first],
        area=np.zeros(len(pair)),
        gap=np.column_stack(gaps),
        accuracy=np.maximum.reduceat(point_accuracy, first),
        doubt=np.zeros(len(pair)),
        mu=np.full(len(pair), np.nan),
        start=start,
        points=meetings.middle[row],
        normals=pushes.normal,
    )


def _kinds(meetings: Meetings, pushes: Pushes, start: Index) -> Labels:
    """Kind of each contact patch: "edge-edge", "vertex-face" or "edge-face"."""
    first = start[:-1]
    kind = meetings.kind[pushes.meeting[first]]
    crossing = (kind == EDGE).all(axis=1) | ~pushes.of_facet[first].any(axis=1)
    crossing &= ~(kind == FACE).any(axis=1)
    kinds: Labels = np.where(crossing, "edge-edge", "vertex-face").astype("<U11")
    kinds[np.diff(start) > 1] = "edge-face"
    return kinds


def _edge_labels(search: ContactSearch, edges: Edges, meetings: Meetings, pushes: Pushes) -> Index:
    """Number of each contact point; points of the same edge on the same facet share a number."""
    first, second = [], []
    for side in (0, 1):
        point, edge = _edges_at(edges, meetings, pushes, side)
        on_facet = pushes.of_facet[point, 1 - side]
        level = np.einsum("ij,ij->i", edges.direction(search.geometry, edge), pushes.normal[point])
        on_facet &= np.abs(level) <= CONE_ANGLE
        point, edge = point[on_facet], edge[on_facet]
        order = np.lexsort((edge, meetings.pair[pushes.meeting[point]]))
        point, edge = point[order], edge[order]
        p, q = point[:-1], point[1:]
        same = np.diff(edge) == 0
        same &= meetings.pair[pushes.meeting[p]] == meetings.pair[pushes.meeting[q]]
        same &= np.linalg.norm(pushes.normal[p] - pushes.normal[q], axis=1) <= NORMAL_ANGLE
        first.append(p[same])
        second.append(q[same])
    return connected(len(pushes), np.concatenate(first), np.concatenate(second))


def _edges_at(edges: Edges, meetings: Meetings, pushes: Pushes, side: int) -> tuple[Index, Index]:
    """Edges of part a (`side` 0) or b (1) through each contact point: pairs (point, edge)."""
    kind, feature = meetings.kind[pushes.meeting, side], meetings.feature[pushes.meeting, side]
    on_edge, corner = np.flatnonzero(kind == EDGE), np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    points = np.concatenate([on_edge, corner[owner]])
    return points, np.concatenate([feature[on_edge], edges.ray_edge[row]])


def _without_middle_points(point: Array, label: Index) -> Index:
    """Rows of contact points that are not between two others on the same edge."""
    keep = np.ones(len(label), dtype=bool)
    count = np.bincount(label)
    for group in np.flatnonzero(count > 2):
        rows = np.flatnonzero(label == group)
        offset = point[rows] - point[rows[0]]
        span = offset[np.linalg.norm(offset, axis=1).argmax()]
        length = float(np.linalg.norm(span))
        share = offset @ span / max(length, TINY)
        off_line = offset - np.outer(share, span) / max(length, TINY)
        if np.abs(off_line).max() <= EDGE_STRAIGHTNESS * length:
            keep[rows] = False
            keep[rows[[share.argmin(), share.argmax()]]] = True
    return np.flatnonzero(keep)


def _relative_accuracy(
    search: ContactSearch, edges: Edges, meetings: Meetings, rows: Index
) -> Array:
    """Error of the coordinates divided by the size of the smallest touching edge or facet [-]."""
    geometry, facets = search.geometry, search.facets
    width = np.full(len(rows), np.inf)
    accuracy = np.zeros(len(rows))
    for side in (0, 1):
        kind, feature = meetings.kind[rows, side], meetings.feature[rows, side]
        face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
        corner = np.flatnonzero(kind == CORNER)
        face_width = facets.area[feature[face]] / facets.reach[feature[face]]
        width[face] = np.minimum(width[face], face_width)
        p, q = edges.ends(geometry, feature[edge])
        width[edge] = np.minimum(width[edge], np.linalg.norm(q - p, axis=1))
        part = np.empty(len(rows), dtype=np.int64)
        part[face] = facets.part[feature[face]]
        part[edge] = geometry.vertex_part[edges.ends_of[feature[edge], 0]]
        part[corner] = geometry.vertex_part[feature[corner]]
        width = np.minimum(width, geometry.size[part])
        accuracy += geometry.accuracy[part]
    result: Array = accuracy / width
    return result
