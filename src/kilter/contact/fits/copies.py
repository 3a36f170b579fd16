"""Copies of one part of which some overlap others and some do not: the former may be misplaced.

Parts of the same volume, radius and inertia (by its trace) are taken for copies. Bolts that all
overlap their nuts are modelled so; the one foot of two that does stands wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kilter.arrays import ratio
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import SAME_SHAPE
from kilter.contact.left_out import Overlap

__all__ = ["odd_copies"]


def odd_copies(
    geometry: Geometry, overlaps: Sequence[Overlap], asked: Iterable[Overlap]
) -> list[tuple[int, list[int], int]]:
    """Parts that overlap others, those others, and a copy of the part that overlaps nothing.

    Parameters
    ----------
    geometry : Geometry
    overlaps : sequence of Overlap
        All that there are.
    asked : iterable of Overlap
        Those of which parts are looked at.
    """
    others: dict[int, list[int]] = {}
    for one in asked:
        for part, other in (one.parts, one.parts[::-1]):
            others.setdefault(part, []).append(other)
    if not others:
        return []
    clear = np.ones(len(geometry.mass), dtype=bool)
    clear[[part for one in overlaps for part in one.parts]] = False
    turning = ratio(np.trace(geometry.inertia, axis1=1, axis2=2), geometry.mass)
    shape = np.column_stack([np.abs(geometry.volume), geometry.radius**3, turning**1.5])
    found = []
    for part in sorted(others):
        alike = np.abs(shape - shape[part]) <= SAME_SHAPE * shape[part]
        copies = np.flatnonzero(clear & alike.all(axis=1))
        if len(copies):
            found.append((part, sorted(others[part]), int(copies[0])))
    return found
