"""Compute volume, centre and second moment of polyhedra, of closed meshes or closures.

The integrals are exact sums over the tetrahedra between a reference point and each triangle
(p, q, r) of the closed surface, 6V = sum p.(q x r):

    V c = sum 6v (p + q + r) / 24,     int x x^T = sum 6v (s s^T + p p^T + q q^T + r r^T) / 120

with s = p + q + r. The reference point is a vertex of the part, so that a large distance from the
world's origin causes no cancellation.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.assembly.mesh_surface import MeshSurface

__all__ = ["closed_moments", "polyhedron_moments"]


def polyhedron_moments(
    vertices: Array, triangles: Index, start: Index
) -> tuple[Array, Array, Array, Array]:
    """Volume, centroid, second moment about it, and surface centroid of N polyhedra.

    Arguments: `vertices` (V, 3); `triangles` (T, 3); `start` (N + 1,): first triangle of each
    polyhedron, followed by T. Returns `volume` (N,): volumes, negative if the faces point inwards
    [length unit^3]; `centroid` (N, 3); `second` (N, 3, 3): integral of x x^T about the centroid
    [length unit^5]; `surface_centroid` (N, 3): centroid of the surface, weighted by area.
    """
    origin = vertices[triangles[start[:-1], 0]]
    shift = np.repeat(origin, np.diff(start), axis=0)
    p, q, r = (vertices[triangles[:, k]] - shift for k in range(3))
    total = p + q + r
    normal = cross(q - p, r - p)
    area = np.linalg.norm(normal, axis=1)
    six = np.einsum("ij,ij->i", p, cross(q, r))
    volume = _group_sum(six, start) / 6
    first = _group_sum(six[:, None] * total, start) / 24
    outer = sum(np.einsum("n,ni,nj->nij", six, x, x) for x in (total, p, q, r))
    second = _group_sum(np.asarray(outer), start) / 120
    with np.errstate(divide="ignore", invalid="ignore"):
        centroid = first / volume[:, None]
        surface_centroid = _group_sum(area[:, None] * total, start) / (
            3 * _group_sum(area, start)[:, None]
        )
        # a flat polyhedron has no centroid; callers reject a volume near zero
        second = second - volume[:, None, None] * centroid[:, :, None] * centroid[:, None, :]
    return volume, centroid + origin, second, surface_centroid + origin


def closed_moments(mesh: MeshSurface) -> tuple[float, Array, Array]:
    """Volume, centroid, and second moment about it, of a mesh with its holes closed."""
    vertices = np.vstack([mesh.vertices, mesh.caps.reshape(-1, 3)])
    caps = np.arange(3 * len(mesh.caps)).reshape(-1, 3) + len(mesh.vertices)
    triangles = np.vstack([mesh.triangles, caps])
    volume, center, second, _ = polyhedron_moments(
        vertices, triangles, np.array([0, len(triangles)])
    )
    return float(volume[0]), center[0], second[0]


def _group_sum(values: Array, start: Index) -> Array:
    """Sum of each group of consecutive rows; group k begins at ``start[k]``."""
    result: Array = np.add.reduceat(values, start[:-1], axis=0)
    return result
