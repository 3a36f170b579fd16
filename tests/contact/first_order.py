"""First-order oracle: move by eps dp, and test whether two parts overlap by order eps.

Shares nothing with `kilter.contact`: parts are given as unions of convex cells, each bounded by
planes; the overlap of two cells is measured by the radius of the largest ball in both, a linear
program. A motion penetrates iff the radius is of order eps and not of eps^2.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

Array = NDArray[np.float64]

EPS = 1e-4
"""Size of a motion."""
ENTERS = 1e-3
"""Radius over EPS from which a motion enters: second order gives about EPS."""
CLEAR = 0.15
"""Smallest opening, for motions of size 1, that counts as non-zero."""


@dataclass(frozen=True)
class Body:
    """A polyhedron: mesh, and convex cells with planes (n, d): n.x <= d inside."""

    vertices: Array
    triangles: NDArray[np.int64]
    cells: list[Array]

    def moved(self, rotation: Array, shift: Array) -> Body:
        cells = [
            np.column_stack([c[:, :3] @ rotation.T, c[:, 3] + c[:, :3] @ rotation.T @ shift])
            for c in self.cells
        ]
        return Body(self.vertices @ rotation.T + shift, self.triangles, cells)


def sheared(body: Body, matrix: Array) -> Body:
    """The image under a linear map of positive determinant."""
    inverse = np.linalg.inv(matrix)
    cells = []
    for cell in body.cells:
        normals = cell[:, :3] @ inverse
        size = np.linalg.norm(normals, axis=1)
        cells.append(np.column_stack([normals / size[:, None], cell[:, 3] / size]))
    return Body(body.vertices @ matrix.T, body.triangles, cells)


def hull(points: Array) -> Body:
    """The convex hull of points."""
    made = ConvexHull(points)
    triangles = made.simplices.copy()
    for k, triangle in enumerate(triangles):
        p, q, r = points[triangle]
        if np.cross(q - p, r - p) @ made.equations[k, :3] < 0:
            triangles[k] = triangle[::-1]
    planes = made.equations
    return Body(points, triangles, [np.column_stack([planes[:, :3], -planes[:, 3]])])


def cubes(cells: set[tuple[int, int, int]]) -> Body:
    """The union of unit cubes of a lattice, by their lowest corners."""
    quads, planes = [], []
    for cell in sorted(cells):
        low = np.array(cell)
        planes.append(np.vstack([
            np.column_stack([np.eye(3), low + 1.0]), np.column_stack([-np.eye(3), -low])
        ]))  # fmt: skip
        for axis, up in product(range(3), (0, 1)):
            beside = list(cell)
            beside[axis] += 2 * up - 1
            if tuple(beside) in cells:
                continue
            u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
            base = low + up * np.eye(3, dtype=int)[axis]
            quad = [base, base + u, base + u + v, base + v]
            quads.append(quad if up else quad[::-1])
    points, index = np.unique(np.array(quads).reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 4)
    triangles = np.vstack([index[:, [0, 1, 2]], index[:, [0, 2, 3]]])
    return Body(points.astype(float), triangles, planes)


def sound(cells: set[tuple[int, int, int]]) -> bool:
    """True if no two cubes meet in an edge or corner only: the surface touches itself nowhere."""
    low = np.min(list(cells), axis=0) - 1
    high = np.max(list(cells), axis=0) + 2
    full = np.zeros(high - low, dtype=int)
    for cell in cells:
        full[tuple(np.array(cell) - low)] = 1
    for corner in product(*(range(n - 1) for n in full.shape)):
        i, j, k = corner
        block = full[i : i + 2, j : j + 2, k : k + 2]
        for value in (0, 1):
            where = {tuple(x) for x in np.argwhere(block == value)}
            if where and len(_reached(where)) < len(where):
                return False
    return True


def _reached(where: set[tuple[int, ...]]) -> set[tuple[int, ...]]:
    found, front = set(), [next(iter(where))]
    while front:
        cell = front.pop()
        if cell in found:
            continue
        found.add(cell)
        front += [c for c in where if sum(abs(x - y) for x, y in zip(c, cell, strict=True)) == 1]
    return found


def polycube(rng: np.random.Generator, count: int) -> set[tuple[int, int, int]]:
    """A random sound union of lattice cubes."""
    while True:
        cells = {(0, 0, 0)}
        while len(cells) < count:
            start = list(cells)[rng.integers(len(cells))]
            axis, step = rng.integers(3), rng.choice([-1, 1])
            cells.add(tuple(int(x) for x in np.array(start) + step * np.eye(3, dtype=int)[axis]))
        if sound(cells):
            return cells


def depth(one: Array, other: Array, about: Array) -> float:
    """Radius of the largest ball in two convex cells, at most 1, near `about`; 0: none."""
    planes = np.vstack([one, other])
    right = planes[:, 3] - planes[:, :3] @ about
    near = right < 1.0
    if not near.any():
        near[:1] = True
    answer = linprog(
        [0, 0, 0, -1.0],
        A_ub=np.column_stack([planes[:, :3], np.ones(len(planes))]),
        b_ub=right,
        bounds=[(None, None)] * 3 + [(-10, 1)],
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert answer.status == 0, answer.message
    return max(0.0, float(answer.x[3]))


def overlap(one: Body, other: Body, about: Array) -> float:
    """Depth of the deepest overlap of the cells of two bodies."""
    return max(depth(p, q, about) for p in one.cells for q in other.cells)


def turned(motion: Array, about: Array) -> tuple[Array, Array]:
    """Rotation and shift of the rigid motion EPS (v, omega) about a point."""
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_rotvec(EPS * motion[3:]).as_matrix()
    return rotation, about + EPS * motion[:3] - rotation @ about


def enters(one: Body, other: Body, motion: Array, about: Array) -> bool:
    """Whether `other`, moved by EPS (v, omega) about a point, enters `one` by order EPS."""
    return overlap(one, other.moved(*turned(motion, about)), about) > ENTERS * EPS


def pairs_of_cubes(seed: int) -> Iterator[tuple[Body, Body]]:
    """Two unions of cubes that touch and do not overlap, sheared by the same map."""
    rng = np.random.default_rng(seed)
    while True:
        first, second = (
            polycube(rng, int(rng.integers(1, 6))),
            polycube(rng, int(rng.integers(1, 5))),
        )
        shift = rng.integers(-3, 4, size=3)
        second = {tuple(int(x) for x in np.array(c) + shift) for c in second}
        if first & second:
            continue
        near = min(np.abs(np.array(p) - np.array(q)).max() for p in first for q in second)
        if near > 1:
            continue
        matrix = np.eye(3) + 0.3 * rng.uniform(-1, 1, size=(3, 3)) * rng.integers(0, 2)
        yield sheared(cubes(first), matrix), sheared(cubes(second), matrix)


def tips_on_cubes(seed: int) -> Iterator[tuple[Body, Body]]:
    """A convex body with a corner or an edge at a lattice point or line of a union of cubes."""
    rng = np.random.default_rng(seed)
    wanted = 4
    while True:
        below = cubes(polycube(rng, int(rng.integers(2, 7))))
        at = below.vertices[rng.integers(len(below.vertices))].copy()
        axis = rng.integers(3)
        at[axis] += rng.choice([0.0, 0.0, 0.5])
        if rng.integers(2):  # an edge along a lattice line, up to 2 long
            ends = np.array([at - rng.choice([0.0, 0.4]) * np.eye(3)[axis],
                             at + rng.choice([0.3, 1.0]) * np.eye(3)[axis]])  # fmt: skip
        else:
            ends = at[None]
        octants = np.array(list(product((-0.1, 0.1), repeat=3)))
        filled = [any((c[:, :3] @ (at + o) < c[:, 3]).all() for c in below.cells) for o in octants]
        if sum(filled) < wanted:  # ridges and corners, then facets and notches
            continue
        away = -10 * octants[filled].mean(axis=0) + 0.4 * rng.normal(size=3)
        away /= np.linalg.norm(away)
        beyond = at + 0.7 * away + 0.25 * rng.normal(size=(5, 3))
        try:
            above = hull(np.vstack([ends, beyond]))
        except Exception:
            continue
        corners = np.unique(above.triangles)
        if len(corners) < len(above.vertices) or overlap(below, above, at) > 1e-9:
            continue
        wanted = 5 - wanted
        yield below, above
