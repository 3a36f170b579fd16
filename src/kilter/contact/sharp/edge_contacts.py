"""Accepted points of edges and corners as patches without area.

An edge that lies on a facet is one patch, its two ends on that facet; every other point is
a patch of its own.
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


def edge_contacts(search: ContactSearch, edges: Edges, met: Meetings, pushes: Pushes) -> Patches:
    """Accepted points as patches, ordered by pair.

    `accuracy` is that of the coordinates over the size of the features that touch.
    """
    if not len(pushes.meeting):
        return Patches.none()
    pushes = pushes.take(np.argsort(met.pair[pushes.meeting], kind="stable"))
    label = _on_one_edge(search, edges, met, pushes)
    point = met.middle[pushes.meeting]
    pushes_kept = _ends_only(point, label)
    pushes, label = pushes.take(pushes_kept), label[pushes_kept]
    order = np.argsort(label, kind="stable")
    pushes, label = pushes.take(order), label[order]
    row = pushes.meeting
    start = np.append(np.flatnonzero(np.diff(label, prepend=-1)), len(label))
    gap = np.einsum("ij,ij->i", met.at[row, 1] - met.at[row, 0], pushes.normal)
    first = start[:-1]
    gaps = [reduce.reduceat(gap, first) for reduce in (np.minimum, np.maximum)]
    blur = _blur(search, edges, met, row)
    pair = met.pair[row[first]]
    return Patches(
        pair=pair,
        parts=search.pairs[pair],
        kind=_kinds(met, pushes, start),
        normal=pushes.normal[first],
        area=np.zeros(len(pair)),
        gap=np.column_stack(gaps),
        accuracy=np.maximum.reduceat(blur, first),
        start=start,
        points=met.middle[row],
        normals=pushes.normal,
    )


def _kinds(met: Meetings, pushes: Pushes, start: Index) -> Labels:
    first = start[:-1]
    kind = met.kind[pushes.meeting[first]]
    crossing = (kind == EDGE).all(axis=1) | ~pushes.of_facet[first].any(axis=1)
    crossing &= ~(kind == FACE).any(axis=1)
    kinds: Labels = np.where(crossing, "edge-edge", "vertex-face").astype("<U11")
    kinds[np.diff(start) > 1] = "edge-face"
    return kinds


def _on_one_edge(search: ContactSearch, edges: Edges, met: Meetings, pushes: Pushes) -> Index:
    """A number for each point, the same for points of one edge on one facet."""
    first, second = [], []
    for side in (0, 1):
        point, edge = _edges_at(edges, met, pushes, side)
        flat = pushes.of_facet[point, 1 - side]
        level = np.einsum("ij,ij->i", edges.direction(search.geometry, edge), pushes.normal[point])
        flat &= np.abs(level) <= CONE_ANGLE
        point, edge = point[flat], edge[flat]
        order = np.lexsort((edge, met.pair[pushes.meeting[point]]))
        point, edge = point[order], edge[order]
        p, q = point[:-1], point[1:]
        same = np.diff(edge) == 0
        same &= met.pair[pushes.meeting[p]] == met.pair[pushes.meeting[q]]
        same &= np.linalg.norm(pushes.normal[p] - pushes.normal[q], axis=1) <= NORMAL_ANGLE
        first.append(p[same])
        second.append(q[same])
    return connected(len(pushes), np.concatenate(first), np.concatenate(second))


def _edges_at(edges: Edges, met: Meetings, pushes: Pushes, side: int) -> tuple[Index, Index]:
    """Edges of one part through each point: (point, edge)."""
    kind, feature = met.kind[pushes.meeting, side], met.feature[pushes.meeting, side]
    on_edge, corner = np.flatnonzero(kind == EDGE), np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    points = np.concatenate([on_edge, corner[owner]])
    return points, np.concatenate([feature[on_edge], edges.ray_edge[row]])


def _ends_only(point: Array, label: Index) -> Index:
    """Rows without the points between the two ends of an edge."""
    keep = np.ones(len(label), dtype=bool)
    number = np.bincount(label)
    for group in np.flatnonzero(number > 2):
        rows = np.flatnonzero(label == group)
        away = point[rows] - point[rows[0]]
        far = away[np.linalg.norm(away, axis=1).argmax()]
        length = float(np.linalg.norm(far))
        along = away @ far / max(length, TINY)
        aside = away - np.outer(along, far) / max(length, TINY)
        if np.abs(aside).max() <= EDGE_STRAIGHTNESS * length:
            keep[rows] = False
            keep[rows[[along.argmin(), along.argmax()]]] = True
    return np.flatnonzero(keep)


def _blur(search: ContactSearch, edges: Edges, met: Meetings, rows: Index) -> Array:
    """Accuracy of the coordinates over the least of the features that touch."""
    geometry, facets = search.geometry, search.facets
    width = np.full(len(rows), np.inf)
    blur = np.zeros(len(rows))
    for side in (0, 1):
        kind, feature = met.kind[rows, side], met.feature[rows, side]
        face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
        corner = np.flatnonzero(kind == CORNER)
        own = facets.area[feature[face]] / facets.reach[feature[face]]
        width[face] = np.minimum(width[face], own)
        p, q = edges.ends(geometry, feature[edge])
        width[edge] = np.minimum(width[edge], np.linalg.norm(q - p, axis=1))
        part = np.empty(len(rows), dtype=np.int64)
        part[face] = facets.part[feature[face]]
        part[edge] = geometry.vertex_part[edges.ends_of[feature[edge], 0]]
        part[corner] = geometry.vertex_part[feature[corner]]
        width = np.minimum(width, geometry.size[part])
        blur += geometry.accuracy[part]
    result: Array = blur / width
    return result
