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
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, distinct_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.refined import refine
from kilter.contact.triangle_distance import at_most, surface_distance
from kilter.shape.closed import weld

__all__ = ["PartSolids", "SharedBody", "depth_of", "shared_body"]


FIRST = 200
"""Points in the first batch of distances; each further batch is twice as large."""


@dataclass(frozen=True, slots=True, eq=False)
class PartSolids:
    """Solids of the library manifold3d for the parts of an assembly, created on first use.

    The centre of mass of a part is at the origin: coordinates keep their digits far from the origin
    of the file. With `finer` (rounds, box), triangles inside a box are refined onto their exact
    surfaces. `cache` keeps the solids.
    """

    geometry: Geometry
    finer: tuple[int, tuple[Array, Array]] | None = None
    cache: dict[int, Any] = field(default_factory=dict)

    def of(self, part: int) -> Any:
        """The solid of a part about its centre of mass; None if its triangles enclose no volume."""
        if part not in self.cache:
            self.cache[part] = self._make(part)
        return self.cache[part]

    def _make(self, part: int) -> Any:
        """Merge the corners of a part's triangles into a solid; None if they enclose no volume."""
        import manifold3d  # slow to import

        g = self.geometry
        rounds, box = self.finer or (0, (g.center[part], g.center[part]))
        corners, rows = refine(g, part, rounds, box)
        vertices, triangles, _ = weld(
            corners - g.center[part], rows, accuracy=float(g.accuracy[part])
        )
        if not _bounds_a_body(triangles):
            return None
        mesh = manifold3d.Mesh64(
            vert_properties=np.ascontiguousarray(vertices),
            tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
            run_index=np.array([0, 3 * len(triangles)], dtype=np.uint64),
            run_original_id=np.array([part + 1], dtype=np.uint32),
        )
        solid = manifold3d.Manifold(mesh)
        return solid if solid.status() == manifold3d.Error.NoError else None


def _bounds_a_body(triangles: Index) -> bool:
    """Whether triangles form a closed surface: each edge occurs once in each direction.

    manifold3d may end the process on triangles without this property.
    """
    following = triangles[:, [1, 2, 0]]
    count = int(triangles.max(initial=0)) + 1
    forward, backward = (
        (triangles * count + following).ravel(),
        (following * count + triangles).ravel(),
    )
    forward.sort()
    backward.sort()
    return bool((forward == backward).all() and (np.diff(forward) > 0).all())


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
