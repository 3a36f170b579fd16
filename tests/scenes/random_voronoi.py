"""Random masonry: cells of a 3D Voronoi diagram cut from a box, with exactly shared faces."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull, Voronoi

from kilter import Assembly, Mesh, Part
from kilter.arrays import Array

FRICTION = (0.0, 0.2, 0.5, 0.84, 1.0)
"""Coefficients of friction of masonry, and none [-]."""


def random_voronoi(
    seed: int, counts: tuple[int, int] = (4, 9), friction: Sequence[float] = FRICTION
) -> Assembly:
    """Cells of a box [m]; those at its bottom are held, a free cell may be left out.

    Parameters
    ----------
    seed : int
    counts : tuple of int
        Least and largest number of cells.
    friction : sequence of float
        Coefficients of friction, from which a random one applies to all contacts [-].
    """
    random = np.random.default_rng(seed)
    size = random.uniform(0.5, 2.0, 3)
    count = int(random.integers(counts[0], counts[1] + 1))
    points = random.uniform(0.05, 0.95, (count, 3)) * size
    cells = _cells(points, size)
    bottom = [float(vertices[:, 2].min()) < 1e-9 for vertices, _ in cells]
    parts = [
        Part(f"cell-{k}", Mesh(vertices, faces), grounded=held)
        for k, ((vertices, faces), held) in enumerate(zip(cells, bottom, strict=True))
    ]
    free = [k for k, part in enumerate(parts) if not part.grounded]
    if len(free) > 3 and random.random() < 0.5:  # a gap, over which its neighbours lean
        del parts[int(random.choice(free))]
    mu = float(random.choice(friction))
    tilt = np.radians(random.uniform(0, 12))
    turn = random.uniform(0, 2 * np.pi)
    down = np.array([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt)])
    return Assembly(parts, friction=mu, gravity=9.81 * down)


def _cells(points: Array, size: Array) -> list[tuple[Array, Array]]:
    """Vertices and outward triangles of the cell of each point in the box from 0 to `size`."""
    mirrored = [points]
    for axis in range(3):
        for wall in (0.0, size[axis]):
            image = points.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            mirrored.append(image)
    diagram = Voronoi(np.concatenate(mirrored))
    cells = []
    for k in range(len(points)):
        vertices = diagram.vertices[diagram.regions[diagram.point_region[k]]]
        hull = ConvexHull(vertices)
        faces = hull.simplices.copy()
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inward = np.einsum("ij,ij->i", normals, corners[:, 0] - vertices.mean(axis=0)) < 0
        faces[inward] = faces[inward][:, ::-1]
        cells.append((vertices, faces))
    return cells
