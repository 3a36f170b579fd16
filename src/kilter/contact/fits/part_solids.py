"""Parts as solids of the library manifold3d."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly.geometry import Geometry
from kilter.assembly.refined import refine
from kilter.shape.closed import weld

__all__ = ["PartSolids"]


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
