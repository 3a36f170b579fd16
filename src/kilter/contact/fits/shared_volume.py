"""The volume that two parts share: one place to ask, whatever kernel answers.

Meshes are cut by manifold3d (Apache-2.0), where it is installed: the extra ``overlap``.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly.part import Part
from kilter.shape.closed import welded
from kilter.shape.primitives import surface

__all__ = ["HINT", "can_cut", "overlap_volume"]


HINT = "volumes of overlaps need the extra: pip install 'kilter[overlap]'"


def can_cut() -> bool:
    """Whether there is a kernel that cuts meshes."""
    return find_spec("manifold3d") is not None


def overlap_volume(part_a: Part, part_b: Part) -> float | None:
    """The volume that two parts share [length unit^3], of their triangles.

    Cylinders and spheres count as their inscribed polyhedra.

    Returns
    -------
    float or None
        None where no kernel is installed, or it refuses a mesh: see `can_cut`.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> from kilter.rigid import Pose
    >>> one, other = Part("a", Box([1, 1, 1])), Part("b", Box([1, 1, 1]), Pose([0.5, 0, 0.25]))
    >>> overlap_volume(one, other) in (None, 0.375)
    True
    """
    if not can_cut():
        return None
    meshes = [_world(part) for part in (part_a, part_b)]
    low = np.maximum(*(vertices.min(axis=0) for vertices, _ in meshes))
    high = np.minimum(*(vertices.max(axis=0) for vertices, _ in meshes))
    if (low >= high).any():
        return 0.0
    # in a frame at the overlap, in units of the larger part: digits and tolerances keep their size
    middle = (low + high) / 2
    size = max(float(np.ptp(vertices, axis=0).max()) for vertices, _ in meshes)
    one, other = (_solid((vertices - middle) / size, triangles) for vertices, triangles in meshes)
    if one is None or other is None:
        return None
    return float((one ^ other).volume()) * size**3


def _world(part: Part) -> tuple[Array, Index]:
    vertices, triangles = surface(part.shape)
    accuracy = float(getattr(part.shape, "accuracy", 0.0))
    vertices, triangles, _ = welded(vertices, triangles, accuracy=accuracy)
    return part.pose.apply(vertices), triangles


def _solid(vertices: Array, triangles: Index) -> Any:
    import manifold3d

    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    if float(np.einsum("ij,ij->", p, np.cross(q, r))) < 0:
        triangles = triangles[:, ::-1]
    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(vertices),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
    )
    solid = manifold3d.Manifold(mesh)
    return solid if solid.status() == manifold3d.Error.NoError else None
