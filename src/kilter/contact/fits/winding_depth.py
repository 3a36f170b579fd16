"""Depth of the corners of a part inside another part, by the winding number of its surface.

For triangles that bound no body: an edge with one face, or with four.

References
----------
A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983, equation 8.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kilter.arrays import Array, Mask, cross, distinct_rows
from kilter.assembly.geometry import Geometry
from kilter.contact.triangle_distance import surface_distance

__all__ = ["depth_by_winding", "inside_part"]


PROBES = 300
"""Largest number of points of a part that are tested."""
BATCH = 100_000
"""Largest number of pairs (point, triangle) computed at once; more leave the processor's cache."""


def depth_by_winding(
    geometry: Geometry,
    parts: tuple[int, int],
    tolerance: float,
    without: Callable[[Array], Mask],
) -> float:
    """Depth to which two parts overlap, at corners and edge middles [length unit]; 0: none."""
    a, b = parts
    return max(_depth_inside(geometry, *pair, tolerance, without) for pair in ((a, b), (b, a)))


def _depth_inside(
    geometry: Geometry,
    a: int,
    b: int,
    tolerance: float,
    without: Callable[[Array], Mask],
) -> float:
    """Largest depth of points of part a inside part b [length unit]; 0: none."""
    corners, triangles = geometry.corners_of(a), geometry.corners_of(b)
    sides = (corners + np.roll(corners, -1, axis=1)).reshape(-1, 3) / 2
    probes = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), sides])
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    probes = probes[((probes > low + tolerance) & (probes < high - tolerance)).all(axis=1)]
    probes = _some_without(distinct_rows(probes)[0], without)
    if not len(probes):
        return 0.0
    inside = inside_part(geometry, b, probes)
    return float(surface_distance(probes[inside], triangles).max(initial=0.0))


def inside_part(geometry: Geometry, part: int, points: Array) -> Mask:
    """Mask of points inside the surface of a part, shape (n,)."""
    triangles = geometry.corners_of(part)
    batches = np.array_split(points, 1 + len(points) * len(triangles) // BATCH)
    return np.concatenate([_winding_number(batch, triangles) > 0.5 for batch in batches])


def _some_without(probes: Array, without: Callable[[Array], Mask]) -> Array:
    """About `PROBES` points, evenly spread over the given ones, for which `without` is False."""
    step = len(probes) // PROBES + 1
    chosen = probes[:0]
    for k in range(step):  # one round is enough unless `without` removes many points
        batch = probes[k::step]
        chosen = np.concatenate([chosen, batch[~without(batch)]])
        if len(chosen) >= PROBES // 2:
            break
    return chosen


def _winding_number(points: Array, triangles: Array) -> Array:
    """Winding number of a closed surface about each point: 1 inside, 0 outside, shape (n,)."""
    middle = triangles.mean(axis=(0, 1))
    x, corners = points - middle, triangles - middle
    # products of two or three of a - x, b - x, c - x are linear in x, except for |x|^2: expanded,
    # they need no array of points times triangles times coordinates
    a, b, c = corners.transpose(1, 0, 2)
    square = (x**2).sum(axis=1)[:, None]
    la, lb, lc = (
        np.sqrt(np.maximum(square + (corner**2).sum(axis=1) - 2 * (x @ corner.T), 0.0))
        for corner in (a, b, c)
    )
    bc = cross(b, c)
    top = np.einsum("ti,ti->t", a, bc) - x @ (bc + cross(c, a) + cross(a, b)).T
    bottom = la * lb * lc
    for p, q, length in ((a, b, lc), (b, c, la), (c, a, lb)):
        product = np.einsum("ti,ti->t", p, q) - x @ (p + q).T + square
        bottom += product * length
    winding: Array = np.arctan2(top, bottom).sum(axis=1) / (2 * np.pi)
    return winding
