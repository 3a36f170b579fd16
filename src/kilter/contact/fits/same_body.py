"""Pairs of parts that are the same body twice: a part and a copy of it in the same place.

All corners, edges and faces of such a pair touch, but none of them carries a force: the pair is an
overlap. So its contacts are not searched.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Index, Mask, nearest
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import Boxes
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.contact.gaps import GapLimits

__all__ = ["coincide", "deep_boxes", "same_bodies"]


def coincide(geometry: Geometry, a: int, b: int) -> bool:
    """Whether two parts have the same corners in the same places."""
    corners_a, corners_b = (
        geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
        for part in (a, b)
    )
    if corners_a.shape != corners_b.shape:
        return False
    close = SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b]
    if np.abs(corners_a.mean(axis=0) - corners_b.mean(axis=0)).max() > close:
        return False
    return bool(nearest(corners_a, corners_b)[0].max() <= close)


def deep_boxes(geometry: Geometry, boxes: Boxes, pairs: Index, limits: GapLimits) -> Mask:
    """Mask of pairs whose boxes overlap by more than the gap limit along each axis, shape (n,).

    The limit includes the distances of both parts from their triangles. Other pairs do not overlap.
    """
    a, b = pairs.T
    grow = (limits.gap + geometry.slack[a] + geometry.slack[b])[:, None]
    deep: Mask = (boxes.part_high[a] - boxes.part_low[b] > grow).all(axis=1)
    deep &= (boxes.part_high[b] - boxes.part_low[a] > grow).all(axis=1)
    return deep


def same_bodies(geometry: Geometry, boxes: Boxes, pairs: Index, limits: GapLimits) -> Mask:
    """Mask of pairs that are the same body twice, shape (n,)."""
    a, b = pairs.T
    close = (SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b])[:, None]
    corners = np.diff(geometry.vertex_start)
    same: Mask = corners[a] == corners[b]
    for bound in (boxes.part_low, boxes.part_high):
        same &= (np.abs(bound[a] - bound[b]) <= close).all(axis=1)
    same &= deep_boxes(geometry, boxes, pairs, limits)
    rows = np.flatnonzero(same)
    same[rows] = [coincide(geometry, i, j) for i, j in pairs[rows].tolist()]
    return same
