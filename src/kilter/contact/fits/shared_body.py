"""Intersection of two overlapping parts as a mesh, by the library manifold3d.

The surface of the intersection of A and B consists of the part of the surface of A inside B and the
part of the surface of B inside A. The depth of the overlap follows from it:

    depth = max over points x of either piece of |x - surface of the other part|,

computed at the corners and at the middles of sides and triangles. The distance from the nearest
corner of the other surface is an upper bound. So the points with the largest bounds are computed
first, and the rest only until the bound falls below the largest distance.

Curved faces count as their inscribed polyhedra, refined as requested.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask, distinct_rows
from kilter.contact.fits.part_solids import PartSolids
from kilter.contact.triangle_distance import at_most, surface_distance

__all__ = ["SharedBody", "depth_of", "shared_body"]


FIRST = 200
"""Points in the first batch of distances; each further batch is twice as large."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedBody:
    """The intersection of two overlapping parts, as a mesh in the world frame.

    Attributes
    ----------
    volume : float
        Volume [length unit^3].
    corners : ndarray, shape (T, 3, 3)
        Triangles of its surface.
    of_first : ndarray of bool, shape (T,)
        True if a triangle lies on the surface of the first part, else on that of the second.
    """

    volume: float
    corners: Array
    of_first: Mask


def shared_body(solids: PartSolids, a: int, b: int) -> SharedBody | None:
    """The intersection of parts a and b, empty if they are apart; None if a part is not closed.

    Returns
    -------
    SharedBody or None
        None if the triangles of a part bound no body: an edge with one face, or with four.
    """
    solid_a, solid_b = solids.of(a), solids.of(b)
    if solid_a is None or solid_b is None:
        return None
    center = solids.geometry.center
    common = solid_a ^ solid_b.translate(tuple((center[b] - center[a]).tolist()))
    mesh = common.to_mesh64()
    length = np.diff(np.asarray(mesh.run_index, dtype=np.int64)) // 3
    first = np.repeat(np.array(mesh.run_original_id) == a + 1, length.astype(np.int64))
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)] + center[a]
    return SharedBody(float(common.volume()), corners, first)


def depth_of(
    solids: PartSolids,
    parts: tuple[int, int],
    body: SharedBody,
    *,
    least: float,
    without: Callable[[Array], Mask],
) -> float:
    """Depth to which two parts overlap, at least `least` [length unit].

    Returns
    -------
    float
        `least` if the overlap is not deeper.
    """
    deepest = least
    for part, on_other in ((parts[1], body.of_first), (parts[0], ~body.of_first)):
        points = _probes(body.corners[on_other])
        points = points[~without(points)]
        surface = solids.geometry.corners_of(part)
        deepest = _farthest(points, body.corners[~on_other], surface, deepest)
    return deepest


def _probes(corners: Array) -> Array:
    """Corners, edge middles and centres of triangles, each point once."""
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    points = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3), corners.mean(axis=1)])
    return distinct_rows(points)[0]


def _farthest(points: Array, patch: Array, surface: Array, least: float) -> float:
    """Largest distance of points from a surface; `least` if all points are nearer than that.

    `patch` is a part of the surface, which bounds the distances from above.
    """
    if not len(points):
        return least
    bound = at_most(points, patch if len(patch) else surface)
    order = np.argsort(-bound, kind="stable")
    begin, count = 0, FIRST
    while begin < len(order) and bound[order[begin]] > least:
        batch = order[begin : begin + count]
        batch = batch[bound[batch] > least]
        least = max(least, float(surface_distance(points[batch], surface, bound[batch]).max()))
        begin, count = begin + count, 2 * count
    return least
