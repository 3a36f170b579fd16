"""Find misplaced parts: copies that overlap others although identical parts do not.

Parts of the same volume, radius and inertia (by its trace) count as copies. Bolts that all overlap
their nuts are modelled so; if only one of two feet overlaps, it is misplaced.
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
    geometry: Geometry, overlaps: Sequence[Overlap], tested: Iterable[Overlap]
) -> list[tuple[int, list[int], int]]:
    """Parts that overlap others although an identical part elsewhere overlaps nothing.

    Parameters
    ----------
    geometry : Geometry
    overlaps : sequence of Overlap
        All overlaps of the assembly.
    tested : iterable of Overlap
        Overlaps whose parts are tested.

    Returns
    -------
    list of (part, overlapped parts, copy)
        By position.
    """
    overlapped: dict[int, list[int]] = {}
    for overlap in tested:
        for part, partner in (overlap.ends, overlap.ends[::-1]):
            overlapped.setdefault(part, []).append(partner)
    if not overlapped:
        return []
    is_clear = np.ones(len(geometry.mass), dtype=bool)
    is_clear[[part for overlap in overlaps for part in overlap.ends]] = False
    gyration_squared = ratio(np.trace(geometry.inertia, axis1=1, axis2=2), geometry.mass)
    shape = np.column_stack([np.abs(geometry.volume), geometry.radius**3, gyration_squared**1.5])
    odd = []
    for part in sorted(overlapped):
        alike = np.abs(shape - shape[part]) <= SAME_SHAPE * shape[part]
        copies = np.flatnonzero(is_clear & alike.all(axis=1))
        if len(copies):
            odd.append((part, sorted(overlapped[part]), int(copies[0])))
    return odd
