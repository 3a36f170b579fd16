"""The nearest other part of each part that touches nothing, and the gap between them.

    gap(A, B) = min |x - y|,    x on a triangle of A, y on a triangle of B.

manifold3d computes it within an upper bound, here the least distance of corners. Other parts are
visited in the order of the distances between their boxes, until that distance reaches the gap.

Curved faces count as their triangles, so the error of a gap is at most the sagittas of both parts
plus the accuracy of their coordinates: `Neighbour.accuracy`. If the triangles of a part bound no
body, only the corners of both parts are compared, and the true gap is at most the reported gap.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from kilter.arrays import Array, Index, nearest
from kilter.assembly.geometry import Geometry
from kilter.contact.fits.part_solids import PartSolids
from kilter.tell.record import Record
from kilter.work import is_late

__all__ = ["MOST_PARTS", "LonePart", "Neighbour", "nearest_parts"]

MOST_PARTS = 200
"""Largest number of parts whose nearest neighbour is searched for."""


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A part that touches nothing, with the part nearest to it and the gap.

    Attributes
    ----------
    part, other : int
        The part, and its nearest neighbour, by position.
    gap : float
        Distance of their surfaces [length unit].
    accuracy : float
        Largest error of the gap [length unit].
    """

    part: int
    other: int
    gap: float
    accuracy: float


class LonePart(Record):
    """A part that touches nothing, and the part nearest to it."""

    part: str
    """Name of the part."""
    nearest: str | None = None
    """Name of the nearest part; null if it was not searched for."""
    gap: float | None = None
    """Distance of their surfaces [length unit]."""
    accuracy: float | None = None
    """Largest error of the gap [length unit]."""
    grounded: bool
    """Whether the part is held."""


def nearest_parts(geometry: Geometry, parts: Iterable[int]) -> tuple[Neighbour, ...]:
    """For each of the first `MOST_PARTS` given parts, the nearest other part and the gap.

    A time limit ends the search; the later parts are then left out.

    Parameters
    ----------
    geometry : Geometry
    parts : iterable of int
        Parts that touch nothing.
    """
    searched = list(parts)[:MOST_PARTS]
    if not searched or len(geometry.mass) < 2:
        return ()
    solids = PartSolids(geometry)
    boxes = geometry.part_boxes
    return tuple(
        _nearest(solids, part, boxes) for part in takewhile(lambda _: not is_late(), searched)
    )


def _nearest(solids: PartSolids, part: int, boxes: tuple[Array, Array]) -> Neighbour:
    """The part nearest to a given part; other parts are tried by the distance of their boxes."""
    low, high = boxes
    between = np.maximum(np.maximum(low - high[part], low[part] - high), 0.0)
    boxes_apart = np.linalg.norm(between, axis=1)
    boxes_apart[part] = np.inf
    nearest_part, gap = -1, np.inf
    for other in _order(boxes_apart):
        # the distance of the boxes is a lower bound: no later part is nearer
        if boxes_apart[other] >= gap:
            break
        distance = _gap(solids, part, int(other), gap)
        if distance < gap:
            nearest_part, gap = int(other), distance
    geometry = solids.geometry
    pair = [part, nearest_part]
    accuracy = float((geometry.slack[pair] + geometry.accuracy[pair]).sum())
    return Neighbour(part, nearest_part, gap, accuracy)


def _order(apart: Array) -> Index:
    """Indices of the other parts, sorted by their distance."""
    order: Index = np.argsort(apart, kind="stable")[:-1]
    return order


def _gap(solids: PartSolids, a: int, b: int, most: float) -> float:
    """Gap between parts a and b [length unit], or `most` if the gap is larger."""
    from kilter.contact.triangle_distance import surface_distance

    geometry = solids.geometry
    corners = [_corners(geometry, part) for part in (a, b)]
    bound = min(most, float(nearest(corners[0], corners[1])[0].min()))
    solid_a, solid_b = solids.of(a), solids.of(b)
    if solid_a is not None and solid_b is not None:
        shifted_b = solid_b.translate(tuple((geometry.center[b] - geometry.center[a]).tolist()))
        return float(solid_a.min_gap(shifted_b, bound))
    # a part bounds no body: distances of the corners from the triangles bound the gap
    for points, part in ((corners[0], b), (corners[1], a)):
        limit = np.full(len(points), bound)
        bound = float(surface_distance(points, geometry.corners_of(part), limit).min())
    return bound


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
