"""Shapes to draw, each stored once about the centre of its box, with the edges to draw.

Positions are float32 relative to the middle of the bounding box, rounded to `GRID` of the size.
Copies of a shape that differ by rounding therefore become equal.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index
from kilter.rigid import quaternion_to_matrix
from kilter.shape.primitives import Box, surface
from kilter.show.brick_look import studded_surface

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["PlacedShapes", "ShapeMesh", "feature_edges", "place_shapes", "shape_mesh"]


GRID = 2.0**-20
"""Grid spacing to which positions are rounded [size of the shape]."""
CREASE = 25.0
"""Angle between the normals of two faces above which their edge is drawn [deg]."""


@dataclass(frozen=True, slots=True, eq=False)
class ShapeMesh:
    """A shape to draw: vertices (n, 3) float32, triangles (m, 3), feature edges (k, 2)."""

    positions: NDArray[np.float32]
    triangles: Index
    edges: Index


@dataclass(frozen=True, slots=True, eq=False)
class PlacedShapes:
    """The distinct shapes of an assembly, and the shape and pose of each part.

    `shape` (N,): index of the shape of each part; `rotation` (N, 4): quaternion w, x, y, z;
    `position` (N, 3): middle of the shape in the world [length unit].
    """

    shapes: tuple[ShapeMesh, ...]
    shape: Index
    rotation: Array
    position: Array


def place_shapes(assembly: Assembly) -> PlacedShapes:
    """Shapes and poses of all parts of an assembly; equal shapes are stored once.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> places = place_shapes(scene("wall"))
    >>> len(places.shapes), len(places.shape)
    (3, 40)
    """
    known: dict[object, int] = {}
    shapes: list[ShapeMesh] = []
    raised: dict[object, Array] = {}
    middles = np.zeros((len(assembly.parts), 3))
    chosen = np.zeros(len(assembly.parts), dtype=np.int64)
    for k, part in enumerate(assembly.parts):
        # boxes are frequent: equal sizes share one shape without building it again
        key: object = tuple(part.shape.size.tolist()) if isinstance(part.shape, Box) else None
        if key is not None and part.brick is not None and isinstance(part.shape, Box):
            key = key, part.brick.cells
            if key not in known:
                shape, raised[key] = shape_mesh(*studded_surface(part.shape, part.brick))
            middles[k] = raised[key]
        elif key is None:
            shape, middles[k] = shape_mesh(*surface(part.shape))
            key = shape.positions.tobytes(), shape.triangles.tobytes()
        elif key not in known:
            shape, _ = shape_mesh(*surface(part.shape))
        if key not in known:
            known[key] = len(shapes)
            shapes.append(shape)
        chosen[k] = known[key]
    rotation = np.array([part.pose.rotation for part in assembly.parts])
    position = np.array([part.pose.position for part in assembly.parts])
    position = position + np.einsum("nij,nj->ni", quaternion_to_matrix(rotation), middles)
    return PlacedShapes(tuple(shapes), chosen, rotation, position)


def shape_mesh(vertices: Array, triangles: Index) -> tuple[ShapeMesh, Array]:
    """Shape of a surface relative to its middle point, and that point, shape (3,)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2
    step = GRID * max(float((high - low).max()), 1e-300)
    positions, inverse = np.unique(
        np.round((vertices - middle) / step), axis=0, return_inverse=True
    )
    corners = np.asarray(inverse).reshape(-1)[triangles]
    edges = feature_edges(positions, corners)
    return ShapeMesh((positions * step).astype(np.float32), corners, edges), middle


def feature_edges(vertices: Array, triangles: Index, crease: float = CREASE) -> Index:
    """Edges to draw: those between faces at an angle, and those of a single face, shape (k, 2).

    Parameters
    ----------
        vertices : ndarray, shape (n, 3)
            Vertices without duplicates.
        triangles : ndarray of int, shape (m, 3)
        crease : float
            Least angle between the normals of the faces [deg].

    Examples
    --------
        >>> from kilter.shape.primitives import Box, surface
        >>> len(feature_edges(*surface(Box([1, 2, 3]))))
        12
    """
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(q - p, r - p)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    flat = length[:, 0] > 0
    normal = (normal / np.where(length > 0, length, 1.0))[flat]
    edges = np.sort(triangles[flat][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    face = np.repeat(np.arange(int(flat.sum())), 3)
    key = edges[:, 0] * len(vertices) + edges[:, 1]
    order = np.argsort(key, kind="stable")
    edge_keys, start, count = np.unique(key[order], return_index=True, return_counts=True)
    pair = count == 2
    first, second = face[order[start[pair]]], face[order[start[pair] + 1]]
    sharp = ~pair
    sharp[pair] = (normal[first] * normal[second]).sum(axis=1) < np.cos(np.radians(crease))
    kept = edge_keys[sharp]
    return np.column_stack([kept // len(vertices), kept % len(vertices)])
