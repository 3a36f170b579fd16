"""The surface of the convex hull of points, as a closed mesh."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.errors import InputError

__all__ = ["hull_surface"]


def hull_surface(points: Array) -> tuple[Array, Index]:
    """Vertices, shape (V, 3), and outward triangles, shape (T, 3), of the convex hull of points.

    Raises `InputError` if the points lie in a plane.

    Examples
    --------
    >>> vertices, triangles = hull_surface(np.vstack([np.eye(3), np.zeros(3), np.full(3, 0.1)]))
    >>> len(vertices), len(triangles)
    (4, 4)
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        raise InputError(
            "the solid has no volume", hint="repair it in the program that made it"
        ) from None
    used, compact = np.unique(hull.simplices, return_inverse=True)
    triangles = compact.reshape(-1, 3).astype(np.int64)
    vertices = points[used]
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", cross(q - p, r - p), hull.equations[:, :3]) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return vertices, triangles
