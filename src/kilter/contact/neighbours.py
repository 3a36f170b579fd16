"""The nearest part of one that touches nothing, and the gap between their surfaces.

    gap(A, B) = min |x - y|,    x on a triangle of A, y on one of B,

which manifold3d computes within a bound: here the least distance of corners. Others are asked
in the order of the distances between their boxes, until that is no less than the gap found.

Curved faces count as their triangles, so a gap is right to within the sagittas of both and
the accuracy of their coordinates: `Neighbour.accuracy`. Where the triangles of a part bound no
body, its corners and those of the other are asked alone, and the gap is at most what is told.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, nearest
from kilter.assembly.geometry import Geometry
from kilter.contact.fits.shared_body import PartSolids
from kilter.contact.triangle_distance import surface_distance

__all__ = ["ASKED", "Neighbour", "nearest_parts"]

ASKED = 200
"""Parts whose nearest neighbour is looked for."""


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A part that touches nothing, and what comes nearest to it.

    Attributes
    ----------
    part, other : int
    gap : float
        Between their surfaces [length unit].
    accuracy : float
        How far the gap may be from the truth [length unit].
    """

    part: int
    other: int
    gap: float
    accuracy: float

    def to_dict(self, names: Sequence[str]) -> dict[str, Any]:
        """As JSON data."""
        parts = {"part": names[self.part], "nearest": names[self.other]}
        return {**parts, "gap": self.gap, "accuracy": self.accuracy}


def nearest_parts(geometry: Geometry, parts: Iterable[int]) -> tuple[Neighbour, ...]:
    """The nearest other part of each of some parts, of the first `ASKED` of them.

    Parameters
    ----------
    geometry : Geometry
    parts : iterable of int
        Parts that touch nothing.
    """
    asked = list(parts)[:ASKED]
    if not asked or len(geometry.mass) < 2:
        return ()
    solids = PartSolids(geometry)
    boxes = geometry.part_boxes
    return tuple(_nearest(solids, part, boxes) for part in asked)


def _nearest(solids: PartSolids, part: int, boxes: tuple[Array, Array]) -> Neighbour:
    low, high = boxes
    between = np.maximum(np.maximum(low - high[part], low[part] - high), 0.0)
    boxes_apart = np.linalg.norm(between, axis=1)
    boxes_apart[part] = np.inf
    best, gap = -1, np.inf
    for other in _order(boxes_apart):
        if boxes_apart[other] >= gap:
            break
        found = _gap(solids, part, int(other), gap)
        if found < gap:
            best, gap = int(other), found
    geometry = solids.geometry
    both = [part, best]
    accuracy = float((geometry.slack[both] + geometry.accuracy[both]).sum())
    return Neighbour(part, best, gap, accuracy)


def _order(apart: Array) -> Index:
    order: Index = np.argsort(apart, kind="stable")[:-1]
    return order


def _gap(solids: PartSolids, a: int, b: int, most: float) -> float:
    """The gap between two parts, or `most` where it is no less."""
    geometry = solids.geometry
    corners = [_corners(geometry, part) for part in (a, b)]
    bound = min(most, float(nearest(corners[0], corners[1])[0].min()))
    one, other = solids.of(a), solids.of(b)
    if one is not None and other is not None:
        moved = other.translate(tuple((geometry.center[b] - geometry.center[a]).tolist()))
        return float(one.min_gap(moved, bound))
    for points, part in ((corners[0], b), (corners[1], a)):
        away = surface_distance(points, geometry.corners_of(part))
        bound = min(bound, float(away.min()))
    return bound


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
