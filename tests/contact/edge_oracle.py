"""Brute-force oracle for convex polyhedra, and pairs that touch by construction.

Every corner is compared with every facet, every edge with every edge and facet. Shares nothing with
`kilter.contact`: facets and edges come from the planes of the hull.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
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
