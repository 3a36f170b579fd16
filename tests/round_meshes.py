"""Meshes of round parts: solids of revolution, bars with rounded edges."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kilter.shape.primitives import Prism, surface

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[np.int64]]


def revolved(profile: Sequence[tuple[float, float]], sides: int, phase: float = 0.0) -> Mesh:
    """A solid of revolution about z with a closed, counterclockwise outline of (radius, z)."""
    angle = phase + np.arange(sides) * (2 * np.pi / sides)
    vertices: list[list[float]] = []
    rows = []
    for radius, z in profile:
        count = sides if radius else 1
        rows.append([len(vertices) + k % count for k in range(sides)])
        vertices += [[radius * np.cos(t), radius * np.sin(t), z] for t in angle[:count]]
    faces = []
    for k, low in enumerate(rows):
        high = rows[(k + 1) % len(rows)]
        for i in range(sides):
            j = (i + 1) % sides
            faces += [[low[i], low[j], high[j]], [low[i], high[j], high[i]]]
    return np.array(vertices), np.array([f for f in faces if len(set(f)) == 3])


def bar(corners: Array, length: float = 3.0) -> Mesh:
    """An extruded polygon."""
    return surface(Prism(corners, length))


def circle(sides: int, radius: float = 1.0) -> Array:
    angle = np.arange(sides) * (2 * np.pi / sides)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def rounded_bar(pieces: int, radius: float = 1.0) -> Mesh:
    """A bar with 4 flats, and rounded edges of `pieces` facets each."""
    corners = []
    for x, z, start in ((3, 2, 0), (-3, 2, 90), (-3, -2, 180), (3, -2, 270)):
        for t in np.radians(start + np.linspace(0, 90, pieces + 1)):
            corners.append([x + radius * np.cos(t), z + radius * np.sin(t)])
    return bar(np.array(corners))


def moved(mesh: Mesh, seed: int, scale: float = 1.0, single: bool = False) -> Mesh:
    """A mesh after a random rigid motion, as float32 if `single`."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    vertices = (mesh[0] @ turn.T + rng.normal(size=3) * 5) * scale
    return (vertices.astype(np.float32).astype(float) if single else vertices), mesh[1]
