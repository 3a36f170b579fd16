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
from kilter.assembly.part import Brick
from kilter.rigid import quaternion_to_matrix
from kilter.shape.primitives import Box, surface

if TYPE_CHECKING:
    from kilter.assembly import Assembly


# Appearance of toy bricks: studs on top of their boxes, and their LDraw colours.


RADIUS = 0.3
"""Radius of a stud [cell]."""
HEIGHT = 0.5
"""Height of a stud [plate]."""
SIDES = 16
"""Corners of the polygon of a stud; with fewer, its side edges would be drawn as creases."""
MOST = 2500
"""Largest number of bricks that are drawn with studs."""
DIRECT = 0x2000000
"""Colour codes from this value on contain red, green and blue directly."""

_LISTED = """
0:1b2a34 1:0055bf 2:257a3e 3:00838f 4:c91a09 5:c870a0 6:583927 7:9ba19d 8:6d6e5c 9:b4d2e3
10:4b9f4a 11:55a5af 12:f2705e 13:fc97ac 14:f2cd37 15:ffffff 17:c2dab8 18:fbe696 19:e4cd9e
20:c9cae2 22:81007b 23:2032b0 25:fe8a18 26:923978 27:bbe90b 28:958a73 29:e4adc8 30:ac78ba
31:e1d5ed 68:f3cf9b 69:cd6298 70:582a12 71:a0a5a9 72:6c6e68 73:5a93db 74:73dca1 77:fecccf
78:f6d7b3 84:cc702a 85:3f3691 86:7c503a 89:4c61db 92:d09168 100:febabd 110:4354a3 112:6874ca
115:c7d23c 118:b3d7d1 120:d9e4a7 125:f9ba61 151:e6e3e0 191:f8bb3d 212:86c1e1 216:b31004
226:fff03a 232:56bed6 272:0d325b 288:184632 308:352100 313:54a9c8 320:720e0f 321:1498d7
322:3ec2dd 323:bddcd8 326:dfeea5 330:9b9a5a 335:d67572 351:f785b1 353:ff6d77 366:fa9c1c
373:845e84 378:a0bcac 379:597184 450:b67b50 462:ffa70b 484:a95500 503:e6e3da
"""
COLORS = {int(k): int(v, 16) for k, v in (entry.split(":") for entry in _LISTED.split())}
"""Solid colours by LDraw code; red, green and blue in one number."""


def brick_rgb(brick: Brick | None) -> tuple[int, int, int] | None:
    """Red, green and blue of a brick, 0 to 255; None without a colour code or a solid colour.

    Examples
    --------
    >>> brick_rgb(Brick((2, 4), color=4)), brick_rgb(Brick((2, 4), color=0x200FF00))
    ((201, 26, 9), (0, 255, 0))
    """
    if brick is None or brick.color is None:
        return None
    code = brick.color
    value = code - DIRECT if DIRECT <= code < 2 * DIRECT else COLORS.get(code)
    return None if value is None else (value >> 16 & 255, value >> 8 & 255, value & 255)


def studded_surface(box: Box, brick: Brick) -> tuple[Array, Index]:
    """Surface of a brick as vertices and triangles: a box with a stud on each cell of its top.

    Returns the vertices, shape (n, 3), and the triangles, shape (m, 3).
    """
    vertices, triangles = surface(box)
    across, along = brick.cells
    if brick.studs > MOST:
        return vertices, triangles
    cell = box.size[:2] / (across, along)
    height = HEIGHT * box.size[2] / brick.plates
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    ring = RADIUS * cell.min() * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    stud = np.concatenate([ring, ring + np.array([0, 0, height]), [[0, 0, height]]])
    k, following = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    faces = np.concatenate(
        [
            np.column_stack([k, following, following + SIDES]),
            np.column_stack([k, following + SIDES, k + SIDES]),
            np.column_stack([k + SIDES, following + SIDES, 0 * k + 2 * SIDES]),
        ]
    )
    x, y = (np.stack(np.meshgrid(range(across), range(along)), axis=-1).reshape(-1, 2) + 0.5).T
    foot = np.column_stack([x * cell[0], y * cell[1], 0 * x]) + box.size * (-0.5, -0.5, 0.5)
    first = len(vertices) + len(stud) * np.arange(len(foot))
    return (
        np.concatenate([vertices, (foot[:, None] + stud).reshape(-1, 3)]),
        np.concatenate([triangles, (first[:, None, None] + faces).reshape(-1, 3)]),
    )


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
