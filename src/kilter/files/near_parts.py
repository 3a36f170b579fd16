"""Pairs of parts that are near each other, whose friction and filters a scene states."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kilter.arrays import Index
from kilter.assembly import Part
from kilter.files.limits import Tally
from kilter.shape.primitives import surface

__all__ = ["near_pairs"]

MOST_PAIRS = 10_000_000
"""Largest number of near pairs; parts that all lie at the same place have many."""
AT_ONCE = 128
"""Number of parts whose neighbours are found together; it bounds the memory."""


def near_pairs(parts: Sequence[Part], reach: float) -> tuple[Index, Index]:
    """Pairs of parts whose bounding spheres overlap after enlargement by the factor `reach`.

    Raises `InputError` if there are too many pairs.
    """
    points = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    middle = np.array([(p.min(axis=0) + p.max(axis=0)) / 2 for p in points])
    radius = np.array(
        [np.linalg.norm(p - m, axis=1).max() for p, m in zip(points, middle, strict=True)]
    )
    half = reach * radius
    boxes = shapely.box(*(middle[:, :2] - half[:, None]).T, *(middle[:, :2] + half[:, None]).T)
    tree = shapely.STRtree(boxes)
    tally = Tally("pairs of near parts", MOST_PAIRS)
    rows = []
    for start in range(0, len(parts), AT_ONCE):
        a, b = tree.query(boxes[start : start + AT_ONCE], predicate="intersects")
        a = a + start
        a, b = a[a < b], b[a < b]
        close = np.linalg.norm(middle[a] - middle[b], axis=1) <= reach * (radius[a] + radius[b])
        tally.add(int(close.sum()))
        rows.append(np.column_stack([a[close], b[close]]))
    pairs = np.concatenate(rows).astype(np.int64)
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return pairs[order, 0], pairs[order, 1]
