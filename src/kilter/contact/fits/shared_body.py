"""The body that two parts share: their triangles cut against each other by manifold3d.

The surface of A and B consists of what of the surface of A lies in B and of what of the
surface of B lies in A. How deep they enter each other is read off there:

    depth = max over points x of either piece of |x - surface of the other part|,

asked at its corners and at the middles of its sides and triangles. The distance from the
nearest corner of the other surface is never less than that, so the farthest points are asked
first, and the rest only until that bound falls below what was found.

Curved faces count as their inscribed polyhedra, cut as fine as is asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import manifold3d
import numpy as np

from kilter.arrays import Array, Index, Mask, distinct_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.refined import refined
from kilter.contact.triangle_distance import at_most, surface_distance
from kilter.shape.closed import welded

__all__ = ["PartSolids", "SharedBody", "depth_of", "shared_body"]


FIRST = 200
"""Points whose distance is asked first; then twice as many, and so on."""


@dataclass(frozen=True, slots=True, eq=False)
class PartSolids:
    """The parts as the kernel holds them, each made when it is first cut; None: refused.

    A part stands in its own place, its centre of mass at the origin: coordinates keep their
    digits, and what is far from the origin of the file is cut as well as what is near. With
    `finer` (rounds, box) triangles within a box are cut finer, on their exact surfaces.
    """

    geometry: Geometry
    finer: tuple[int, tuple[Array, Array]] | None = None
    made: dict[int, Any] = field(default_factory=dict)

    def of(self, part: int) -> Any:
        """The part about its centre, None where its triangles bound no body."""
        if part not in self.made:
            self.made[part] = self._make(part)
        return self.made[part]

    def _make(self, part: int) -> Any:
        g = self.geometry
        rounds, box = self.finer or (0, (g.center[part], g.center[part]))
        corners, rows = refined(g, part, rounds, box)
        vertices, triangles, _ = welded(
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
    """Whether every edge runs once each way: the kernel ends the process on some that do not."""
    following = triangles[:, [1, 2, 0]]
    count = int(triangles.max(initial=0)) + 1
    there, back = (triangles * count + following).ravel(), (following * count + triangles).ravel()
    there.sort()
    back.sort()
    return bool((there == back).all() and (np.diff(there) > 0).all())


@dataclass(frozen=True, slots=True, eq=False)
class SharedBody:
    """What two parts share; world frame.

    Attributes
    ----------
    volume : float
        [length unit^3]
    corners : ndarray, shape (T, 3, 3)
        Its triangles.
    of_first : ndarray of bool, shape (T,)
        They lie on the surface of the first part, else on that of the second.
    """

    volume: float
    corners: Array
    of_first: Mask


def shared_body(solids: PartSolids, a: int, b: int) -> SharedBody | None:
    """The body that parts a and b share, of no triangles where they share none.

    Returns
    -------
    SharedBody or None
        None where the triangles of a part bound no body: an edge with one face, or with
        four.
    """
    one, other = solids.of(a), solids.of(b)
    if one is None or other is None:
        return None
    center = solids.geometry.center
    common = one ^ other.translate(tuple((center[b] - center[a]).tolist()))
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
    """How deep two parts enter each other, at points that are not in `without`.

    Returns
    -------
    float
        `least` where they do not enter each other by more than that.
    """
    deepest = least
    for other, mine in ((parts[1], body.of_first), (parts[0], ~body.of_first)):
        points = _probes(body.corners[mine])
        points = points[~without(points)]
        surface = solids.geometry.corners_of(other)
        deepest = _farthest(points, body.corners[~mine], surface, deepest)
    return deepest


def _probes(corners: Array) -> Array:
    """Corners, middles of sides and of triangles, each once."""
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    points = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3), corners.mean(axis=1)])
    return distinct_rows(points)[0]


def _farthest(points: Array, known: Array, surface: Array, least: float) -> float:
    """The greatest distance of points from a surface, of which `known` is a part, above `least`.

    Points are asked in order of what their distance may be at most.
    """
    if not len(points):
        return least
    most = at_most(points, known if len(known) else surface)
    order = np.argsort(-most, kind="stable")
    begin, count = 0, FIRST
    while begin < len(order) and most[order[begin]] > least:
        some = order[begin : begin + count]
        some = some[most[some] > least]
        least = max(least, float(surface_distance(points[some], surface, most[some]).max()))
        begin, count = begin + count, 2 * count
    return least
