"""Contacts of convex bodies, and the first order of motions of polycubes, apart from kilter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

FLAT = 1e-9
"""Corners this near a plane lie in it, over the size."""


@dataclass(frozen=True)
class Convex:
    """A convex polyhedron: corners, planes (n, d) with n.x <= d, edges as pairs of corners."""

    corners: Array
    planes: Array
    edges: list[tuple[int, int]]

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Triangles, anticlockwise seen from outside."""
        found = []
        for normal, offset in zip(self.planes[:, :3], self.planes[:, 3], strict=True):
            on = np.flatnonzero(np.abs(self.corners @ normal - offset) <= FLAT)
            middle = self.corners[on].mean(axis=0)
            u = self.corners[on[0]] - middle
            v = np.cross(normal, u)
            away = self.corners[on] - middle
            ring = on[np.argsort(np.arctan2(away @ v, away @ u))]
            found += [[ring[0], ring[k], ring[k + 1]] for k in range(1, len(ring) - 1)]
        return np.array(found)

    def moved(self, rotation: Array, shift: Array) -> Convex:
        normals = self.planes[:, :3] @ rotation.T
        planes = np.column_stack([normals, self.planes[:, 3] + normals @ shift])
        return Convex(self.corners @ rotation.T + shift, planes, self.edges)

    def facet(self, k: int) -> tuple[Array, Array]:
        """A point well inside facet k, and its normal."""
        normal, offset = self.planes[k, :3], self.planes[k, 3]
        on = np.abs(self.corners @ normal - offset) <= FLAT
        return self.corners[on].mean(axis=0), normal


def convex(points: Array) -> Convex:
    """The convex hull of points; coplanar triangles form a single facet."""
    made = ConvexHull(points)
    corners = points[made.vertices]
    planes: list[Array] = []
    for normal in made.equations:
        plane = np.append(normal[:3], -normal[3])
        if not any(np.abs(plane - other).max() < FLAT for other in planes):
            planes.append(plane)
    table = np.abs(corners @ np.array(planes)[:, :3].T - np.array(planes)[:, 3]) <= FLAT
    edges = [
        (i, j) for i, j in combinations(range(len(corners)), 2) if (table[i] & table[j]).sum() >= 2
    ]
    return Convex(corners, np.array(planes), edges)


def dodecahedron() -> Convex:
    golden = (1 + np.sqrt(5)) / 2
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    rest = [[0, x / golden, y * golden] for x in (-1, 1) for y in (-1, 1)]
    points = np.vstack([signs, *(np.roll(rest, k, axis=1) for k in range(3))])
    return convex(points / np.sqrt(3) / 2)


def some_convex(rng: np.random.Generator) -> Convex:
    """A dodecahedron, a random hull, a box or a tetrahedron, of size about 1."""
    kind = rng.integers(4)
    if kind == 0:
        return dodecahedron()
    if kind == 1:
        points = rng.normal(size=(int(rng.integers(6, 14)), 3))
        return convex(points / np.linalg.norm(points, axis=1)[:, None] / 2)
    if kind == 2:
        size = rng.uniform(0.4, 1.0, size=3)
        return convex(np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size)
    return convex(rng.uniform(-0.6, 0.6, size=(4, 3)))


@dataclass(frozen=True)
class Contact:
    """An expected contact: kind, points, normal from a to b."""

    kind: str
    points: Array
    normal: Array


def contacts(a: Convex, b: Convex, tolerance: float, angle: float = 1e-3) -> list[Contact]:
    """Corners on facets and edges on edges, for each pair of features."""
    found: list[Contact] = []
    lone: list[tuple[Array, Array]] = []
    for one, other, sign in ((b, a, 1.0), (a, b, -1.0)):
        for normal, offset in zip(other.planes[:, :3], other.planes[:, 3], strict=True):
            height = one.corners @ normal - offset
            beyond = other.planes[:, 3] - one.corners @ other.planes[:, :3].T
            inside = (beyond >= -2 * tolerance).all(axis=1)
            on = np.flatnonzero((np.abs(height) <= tolerance) & inside)
            lone += [(one.corners[k] - 0.5 * height[k] * normal, sign * normal) for k in on]
    for one, other, sign in ((b, a, 1.0), (a, b, -1.0)):
        for i, j in one.edges:
            for k in range(len(other.planes)):
                ends = _along(one.corners[i], one.corners[j], other, k, tolerance, angle)
                lone += [(x, sign * other.planes[k, :3]) for x in ends]
    for i, j in a.edges:
        for k, m in b.edges:
            p, d = a.corners[i], a.corners[j] - a.corners[i]
            q, e = b.corners[k], b.corners[m] - b.corners[k]
            n = np.cross(d, e)
            if np.linalg.norm(n) <= angle * np.linalg.norm(d) * np.linalg.norm(e):
                continue
            n /= np.linalg.norm(n)
            s, t = np.linalg.lstsq(np.column_stack([d, -e]), q - p, rcond=None)[0]
            if not (0 <= s <= 1 and 0 <= t <= 1) or abs((q - p) @ n) > tolerance:
                continue
            if ((a.corners - p) @ n).max() > -((a.corners - p) @ n).min():
                n = -n
            if ((a.corners - p) @ n).max() <= 2 * tolerance and (
                (b.corners - q) @ n
            ).min() >= -2 * tolerance:
                lone.append(((p + s * d + q + t * e) / 2, n))
    for normal in _distinct([n for _, n in lone], angle):
        points = _distinct(
            [x for x, n in lone if np.linalg.norm(n - normal) <= angle], 4 * tolerance
        )
        found.append(Contact("", np.array(points), normal))
    return found


def _along(p: Array, q: Array, body: Convex, k: int, tolerance: float, angle: float) -> list[Array]:
    """Ends of the part of a tilted edge over facet k, if it comes near at some point."""
    normal, offset = body.planes[k, :3], body.planes[k, 3]
    if abs((q - p) @ normal) > angle * np.linalg.norm(q - p):
        return []
    low, high = 0.0, 1.0
    for row in np.delete(body.planes, k, axis=0):
        n, d = row[:3], row[3]
        # the side of the facet's prism contains the line of both planes
        side = n - (n @ normal) * normal
        room = d - (n @ normal) * offset
        here, there = room - side @ p, room - side @ q
        if here < 0 and there < 0:
            return []
        if here < 0:
            low = max(low, here / (here - there))
        if there < 0:
            high = min(high, here / (here - there))
    ends = [p + t * (q - p) for t in (low, high)]
    gaps = [float(x @ normal - offset) for x in ends]
    if high <= low or min(gaps) > tolerance or max(gaps) < -tolerance:
        return []
    return [x - 0.5 * g * normal for x, g in zip(ends, gaps, strict=True)]


def _distinct(values: list[Array], apart: float) -> list[Array]:
    kept: list[Array] = []
    for value in values:
        if all(np.linalg.norm(value - other) > apart for other in kept):
            kept.append(value)
    return kept


def _frame(normal: Array, along: Array) -> Array:
    """Rotation that takes z to `normal` and x to `along` (across it)."""
    return np.column_stack([along, np.cross(normal, along), normal])


def _across(rng: np.random.Generator, normal: Array) -> Array:
    along = np.cross(normal, rng.normal(size=3))
    return along / np.linalg.norm(along)


def stacked(kind: str, gap: float, tilt: float, rng: np.random.Generator) -> tuple[Convex, Convex]:
    """Two convex bodies that touch in a single way, `gap` apart and b tilted about the point.

    kind: "vertex-face", "edge-face" (an edge of b on a facet of a), "edge-edge"; for the first two
    b may have the facet instead.
    """
    a, b = some_convex(rng), some_convex(rng)
    point, up = a.facet(int(rng.integers(len(a.planes))))
    if kind == "edge-edge":
        i, j = a.edges[rng.integers(len(a.edges))]
        point, along = (a.corners[i] + a.corners[j]) / 2, a.corners[j] - a.corners[i]
        up = _supporting(a, (i, j), rng)
        along = along / np.linalg.norm(along)
    if kind == "vertex-face":
        k = int(rng.integers(len(b.corners)))
        at, down = b.corners[k], _supporting(b, (k,), rng)
        turn = _frame(up, _across(rng, up)) @ _frame(-down, _across(rng, down)).T
    else:
        k, m = b.edges[rng.integers(len(b.edges))]
        at, down = (b.corners[k] + b.corners[m]) / 2, _supporting(b, (k, m), rng)
        own = (b.corners[m] - b.corners[k]) / np.linalg.norm(b.corners[m] - b.corners[k])
        if kind == "edge-edge":
            spin = Rotation.from_rotvec(up * rng.uniform(0.2, np.pi - 0.2)).as_matrix()
            target = spin @ along
        else:
            target = _across(rng, up)
        turn = _frame(up, target) @ _frame(-down, own).T
    b = b.moved(turn, point - turn @ at)
    lean = Rotation.from_rotvec(tilt * _across(rng, up)).as_matrix()
    b = b.moved(lean, point - lean @ point + gap * up)
    whole, shift = Rotation.random(rng=rng).as_matrix(), 3 * rng.normal(size=3)
    return a.moved(whole, shift), b.moved(whole, shift)


def _supporting(body: Convex, corners: tuple[int, ...], rng: np.random.Generator) -> Array:
    """A direction in which the given corners are the farthest of all, by a wide margin."""
    on = np.ones(len(body.planes), dtype=bool)
    for k in corners:
        on &= np.abs(body.planes[:, :3] @ body.corners[k] - body.planes[:, 3]) <= FLAT
    share = rng.uniform(0.3, 1.0, size=int(on.sum()))
    normal = share @ body.planes[on, :3]
    return normal / np.linalg.norm(normal)


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
