"""Parts moved step by step along a way, their shared volume by manifold3d."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from kilter.contact.common.distances import PartSolids


def shared(solids: PartSolids, p: int, q: int, offset: np.ndarray) -> float:
    """Volume that part p, moved by an offset, shares with part q."""
    g = solids.geometry
    away = g.center[p] + offset - g.center[q]
    return float((solids.of(p).translate(tuple(away.tolist())) ^ solids.of(q)).volume())


def deepest(
    solids: PartSolids, p: int, q: int, offsets: Iterable[np.ndarray], *, enough: float = np.inf
) -> float:
    """The greatest volume shared at some offsets; ends once it is above `enough`."""
    most, size = 0.0, solids.geometry.part_boxes
    low, high = size
    for offset in offsets:
        if (low[p] + offset < high[q]).all() and (high[p] + offset > low[q]).all():
            most = max(most, shared(solids, p, q, offset))
            if most > enough:
                break
    return most


def places_along(path: np.ndarray, count: int) -> np.ndarray:
    """Places on a path of straight pieces, shape (m, 3), as many on each in all, (count, 3)."""
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    at = np.linspace(0.0, lengths[-1], count)
    return np.column_stack([np.interp(at, lengths, column) for column in path.T])


def skin(size: float, tolerance: float) -> float:
    """Volume of a skin of a box of that size which is twice the tolerance thick."""
    return 6 * 2 * tolerance * size**2
