"""Wedges: a keystone, and cubes in a corner of three held walls, whole or cut by planes.

A convex solid is a list of its faces, polygons of shape (n, 3), counterclockwise seen from
outside. A cut keeps the half behind a plane and closes it with a new face.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.rigid import unit
from kilter.scenes.pieces import block, floor, prism
from kilter.scenes.registry import listed
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS, Mesh

WALL = 0.5
"""Thickness of the held walls [m]."""


@listed("keystone", "a keystone between two springers", source="wedge", answer="stable")
def keystone(angle: float = 15.0, *, friction: float = 0.0, planar: bool = False) -> Assembly:
    """A keystone between two free springers that lean on held walls; stable.

    Arguments: `angle`: angle of each joint to the vertical [deg], 5 to 30; `friction`: friction
    coefficient [-].
    """
    lean = float(np.tan(np.radians(angle)))
    right = np.array([[0.5, 0], [4, 0], [4, 2], [0.5 + 2 * lean, 2]])
    middle = [[-0.5 - lean, 1], [0.5 + lean, 1], [0.5 + 3 * lean, 3], [-0.5 - 3 * lean, 3]]
    return Assembly(
        [
            floor([-5, -1], [5, 1]),
            block("wall-left", [-5, -1, 0], [-4, 1, 3], grounded=True),
            block("wall-right", [4, -1, 0], [5, 1, 3], grounded=True),
            prism("springer-left", right * [-1, 1]),
            prism("springer-right", right),
            prism("keystone", middle),
        ],
        friction=friction,
        planar=planar,
    )


def corner_boxes(count: int = 3, *, size: float = 1.0) -> Assembly:
    """Cubes piled as a pyramid in a corner of three held walls, `count` along each edge; stable.

    Cube (i, j, k) exists if i + j + k < count. Gravity points into the corner, along -(1, 1, 1).
    Each cube rests on a wall or a cube in all three directions.

    Examples
    --------
    >>> len(corner_boxes(3).parts)  # three walls and 6 + 3 + 1 cubes
    13
    """
    grid = [(i, j, k) for i in range(count) for j in range(count) for k in range(count)]
    cubes = [
        block(
            f"cube-{i}-{j}-{k}", np.array([i, j, k]) * size, np.array([i + 1, j + 1, k + 1]) * size
        )
        for i, j, k in grid
        if i + j + k < count
    ]
    return Assembly([*_corner(count * size), *cubes], gravity=_into_corner())


@listed("corner-wedges", "a cube in a corner, cut into six wedges", source="wedge", answer="stable")
def corner_wedges(count: int = 6, *, seed: int = 0) -> Assembly:
    """A cube in a corner of three held walls, cut into `count` wedges by random planes.

    Each cut goes through the middle of the largest piece. Gravity points into the corner.

    Examples
    --------
    >>> assembly = corner_wedges(5, seed=1)
    >>> bool(abs(assembly.geometry.volume[3:].sum() - 8.0) < 1e-12)
    True
    """
    if count < 1:
        raise InputError(f"{count} wedges", hint="give 1 or more")
    random = np.random.default_rng(seed)
    corners = BOX_CORNERS * 2.0 + 1.0
    pieces = [[corners[quad] for quad in BOX_QUADS]]
    while len(pieces) < count:
        largest = pieces.pop(int(np.argmax([solid_volume(piece) for piece in pieces])))
        normal = unit(random.normal(size=3))
        point = np.concatenate(largest).mean(axis=0)
        pieces += [behind(largest, point, normal), behind(largest, point, -normal)]
    wedges = [Part(f"wedge-{k}", solid_mesh(piece)) for k, piece in enumerate(pieces)]
    return Assembly([*_corner(2.0), *wedges], gravity=_into_corner())


def _into_corner() -> Array:
    return unit([-1, -1, -1]) * 9.81


def _corner(reach: float) -> list[Part]:
    """Held walls x = 0, y = 0 and a held floor z = 0, which do not overlap, as parts."""
    t, r = WALL, reach + WALL
    return [
        block("floor", [-t, -t, -t], [r, r, 0], grounded=True),
        block("wall-x", [-t, -t, 0], [0, r, r], grounded=True),
        block("wall-y", [0, -t, 0], [r, 0, r], grounded=True),
    ]


def behind(faces: list[Array], point: Array, normal: Array) -> list[Array]:
    """The piece of a convex solid behind a plane, closed by a new face."""
    kept, rim = [], []
    for face in faces:
        distance = (face - point) @ normal
        corners = []
        for k, p in enumerate(face):
            j = (k + 1) % len(face)
            if distance[k] <= 0:
                corners.append(p)
            if distance[k] * distance[j] < 0:
                # interpolate from behind to front, so that both faces of the edge get equal bits
                (a, da), (b, db) = sorted(
                    [(k, distance[k]), (j, distance[j])], key=lambda end: end[1]
                )
                cut = face[a] + (face[b] - face[a]) * (da / (da - db))
                corners.append(cut)
                rim.append(cut)
        if len(corners) > 2:
            kept.append(np.array(corners))
    return [*kept, _sort_corners(np.unique(np.array(rim), axis=0), normal)]


def _sort_corners(points: Array, normal: Array) -> Array:
    """Corners of a convex polygon, sorted counterclockwise about `normal`."""
    u = unit(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))]))
    relative = points - points.mean(axis=0)
    angles = np.arctan2(relative @ np.cross(normal, u), relative @ u)
    ordered: Array = points[np.argsort(angles)]
    return ordered


def solid_volume(faces: list[Array]) -> float:
    """Volume of a solid given by its faces."""
    total = 0.0
    for face in faces:
        for k in range(1, len(face) - 1):
            total += float(face[0] @ np.cross(face[k], face[k + 1])) / 6
    return total


def solid_mesh(faces: list[Array]) -> Mesh:
    """Mesh of a solid given by its faces, with common vertices."""
    vertices, index = np.unique(np.concatenate(faces), axis=0, return_inverse=True)
    stops = np.cumsum([len(face) for face in faces])[:-1]
    return Mesh(vertices, [piece.tolist() for piece in np.split(index.reshape(-1), stops)])
