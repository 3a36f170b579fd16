"""Meshes put in place: turned, scaled, joined; their accuracy goes with them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.arrays import Array
from kilter.shape.primitives import Mesh

__all__ = ["joined", "placed", "scaled"]


def placed(mesh: Mesh, matrix: Array) -> Mesh:
    """The mesh moved by a 4 x 4 matrix (columns); a mirror image keeps its outside outside.

    Examples
    --------
    >>> tip = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> placed(tip, np.diag([-1.0, 1, 1, 1])).triangles
    array([[2, 1, 0]])
    """
    if np.array_equal(matrix, np.eye(4)):
        return mesh
    linear, step = matrix[:3, :3], matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(linear) < 0 else mesh.triangles
    largest = np.abs(mesh.vertices).max(axis=0, initial=0.0)
    # what the coordinates are off by, relative to the largest, holds for the sums they enter
    relative = mesh.accuracy / (float(largest.max()) or 1.0)
    accuracy = relative * float((np.abs(linear) @ largest + np.abs(step)).max())
    return Mesh(mesh.vertices @ linear.T + step, triangles, accuracy=accuracy)


def scaled(mesh: Mesh, factor: float) -> Mesh:
    """The mesh with every length times a factor."""
    if factor == 1.0:
        return mesh
    return Mesh(mesh.vertices * factor, mesh.triangles, accuracy=mesh.accuracy * factor)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one."""
    if len(meshes) == 1:
        return meshes[0]
    start = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + n for m, n in zip(meshes, start[:-1], strict=True)]),
        accuracy=max(mesh.accuracy for mesh in meshes),
    )
