"""Distance and depth of many pairs of convex cores at once.

Distance: the algorithm of Gilbert, Johnson and Keerthi on all pairs together; the nearest point of
a simplex is the nearest of the projections on its faces that lie inside them, which is exact.
Depth: the least overlap over the face normals of both cores and over the directions across pairs of
edges whose arcs on the Gaussian sphere cross.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, counted, cross
from kilter.contact.convex_pieces import Cores
from kilter.contact.convex_tolerances import CONVERGED, PARALLEL, TOUCHING

ROUNDS = 64
"""Largest number of support points of a pair."""
PRODUCTS = 500_000
"""Largest number of pairs of edges that are compared together."""


@dataclass(frozen=True, slots=True, eq=False)
class NearestPoints:
    """NearestPoints points of pairs of cores."""

    apart: Mask
    """Whether the cores are apart by more than rounding, shape (K,)."""
    on_a: Array
    on_b: Array
    """NearestPoints points, shape (K, 3)."""
    at_corner: Mask
    """Whether the nearest points are a corner and a corner, or a corner and a point of an edge."""


def nearest_points(a: Cores, b: Cores, size: Array, limit: Array) -> NearestPoints:
    """NearestPoints points of pairs of cores.

    Arguments: `size` (K,): size of each pair [length unit]; `limit` (K,): the search for a pair
    ends if its distance is larger [length unit].
    """
    count = len(size)
    corner = np.zeros((count, 4), dtype=np.int64), np.zeros((count, 4), dtype=np.int64)
    weight = np.zeros((count, 4))
    weight[:, 0] = 1.0
    simplex = np.zeros((count, 4, 3))
    simplex[:, 0] = a.vertex[:, 0] - b.vertex[:, 0]
    near = simplex[:, 0].copy()
    apart = np.ones(count, dtype=bool)
    best = np.full(count, np.inf)
    final = weight.copy(), corner[0].copy(), corner[1].copy()
    open_ = np.arange(count)
    for _ in range(ROUNDS):
        v = near[open_]
        square = np.einsum("ki,ki->k", v, v)
        close = square <= (TOUCHING * size[open_]) ** 2
        apart[open_[close]] = False
        better = square < best[open_]
        rows = open_[better]
        best[rows] = square[better]
        for kept, new in zip(final, (weight, *corner), strict=True):
            kept[rows] = new[rows]
        i = (a.vertex[open_] @ -v[..., None])[..., 0].argmax(axis=1)
        j = (b.vertex[open_] @ v[..., None])[..., 0].argmax(axis=1)
        w = a.vertex[open_, i] - b.vertex[open_, j]
        level = np.einsum("ki,ki->k", v, w)
        far = level > np.sqrt(square) * limit[open_]
        used = weight[open_] > 0
        same = (corner[0][open_] == i[:, None]) & (corner[1][open_] == j[:, None])
        again = (same & used).any(axis=1)
        full = used.all(axis=1)
        apart[open_[full & ~again]] = False
        going = (square - level > CONVERGED * square) & ~again & better & ~close & ~full & ~far
        if not going.any():
            break
        open_, i, j, w = open_[going], i[going], j[going], w[going]
        slot = (weight[open_] > 0).argmin(axis=1)
        corner[0][open_, slot], corner[1][open_, slot] = i, j
        simplex[open_, slot] = w
        present = weight[open_] > 0
        present[np.arange(len(open_)), slot] = True
        weight[open_], near[open_] = _nearest_in_simplex(simplex[open_], present)
    rows = np.arange(count)[:, None]
    on_a = np.einsum("kc,kci->ki", final[0], a.vertex[rows, final[1]])
    on_b = np.einsum("kc,kci->ki", final[0], b.vertex[rows, final[2]])
    number = sum(_corner_count(final[0], corners) for corners in final[1:])
    return NearestPoints(apart, on_a, on_b, np.less_equal(number, 3))


def _corner_count(weight: Array, corner: Index) -> Index:
    """Number of different corners with a weight, up to 3, of each row, shape (K,)."""
    first = np.take_along_axis(corner, weight.argmax(axis=1)[:, None], axis=1)
    rest = np.where(corner == first, 0.0, weight)
    second = np.take_along_axis(corner, rest.argmax(axis=1)[:, None], axis=1)
    others = np.where(corner == second, 0.0, rest)
    count: Index = 1 + (rest.max(axis=1) > 0).astype(np.int64) + (others.max(axis=1) > 0)
    return count


EDGES = np.array(list(combinations(range(4), 2)))
TRIANGLES = np.array(list(combinations(range(4), 3)))


def _nearest_in_simplex(p: Array, present: Mask) -> tuple[Array, Array]:
    """Barycentric weights, shape (K, 4), and the point nearest to the origin, shape (K, 3).

    Arguments: `p` (K, 4, 3): corners; `present` (K, 4).
    """
    count = len(p)
    rows = np.arange(count)
    gram = p @ p.transpose(0, 2, 1)
    square = np.where(present, gram[:, range(4), range(4)], np.inf)
    corner = square.argmin(axis=1)
    weight = np.zeros((count, 4))
    weight[rows, corner] = 1.0
    best = square[rows, corner]
    s, t = EDGES.T
    step = p[:, t] - p[:, s]
    along = -np.einsum("kei,kei->ke", p[:, s], step)
    length = np.einsum("kei,kei->ke", step, step)
    share = along / np.where(length > 0, length, 1.0)
    inside = present[:, s] & present[:, t] & (share > 0) & (share < 1)
    point = p[:, s] + share[..., None] * step
    square = np.where(inside, np.einsum("kei,kei->ke", point, point), np.inf)
    k = square.argmin(axis=1)
    better = square[rows, k] < best
    r, e = rows[better], k[better]
    best[r] = square[r, e]
    weight[r] = 0.0
    weight[r, s[e]], weight[r, t[e]] = 1 - share[r, e], share[r, e]
    three = present.sum(axis=1) >= 3
    if three.any():
        _improve_in_triangles(p, present, weight, best, np.flatnonzero(three))
    four = np.flatnonzero(present.all(axis=1))
    if len(four):
        _improve_in_tetrahedra(p, weight, four)
    return weight, np.einsum("kc,kci->ki", weight, p)


def _improve_in_triangles(p: Array, present: Mask, weight: Array, best: Array, rows: Index) -> None:
    """Replace weights if the nearest point lies inside a triangle."""
    q = p[rows]
    i, j, m = TRIANGLES.T
    a, b, c = q[:, i], q[:, j], q[:, m]
    n = cross(b - a, c - a)
    square = np.einsum("kti,kti->kt", n, n)
    safe = np.where(square > 0, square, 1.0)
    height = np.einsum("kti,kti->kt", a, n) / safe
    foot = height[..., None] * n

    def area(x: Array, y: Array) -> Array:
        result: Array = np.einsum("kti,kti->kt", cross(x - foot, y - foot), n) / safe
        return result

    shares = np.stack([area(b, c), area(c, a), area(a, b)], axis=-1)
    inside = present[rows][:, TRIANGLES].all(axis=-1) & (square > 0) & (shares > 0).all(axis=-1)
    apart = np.where(inside, np.einsum("kti,kti->kt", foot, foot), np.inf)
    k = apart.argmin(axis=1)
    each = np.arange(len(rows))
    better = apart[each, k] < best[rows]
    r, t = rows[better], k[better]
    best[r] = apart[each, k][better]
    share = shares[each, k][better]
    weight[r] = 0.0
    weight[r[:, None], TRIANGLES[t]] = share / share.sum(axis=1, keepdims=True)


def _improve_in_tetrahedra(p: Array, weight: Array, rows: Index) -> None:
    """Replace weights if the origin lies inside a tetrahedron."""
    q = p[rows]
    volume = []
    for k in range(4):
        x, y, z = (q[:, other] for other in range(4) if other != k)
        volume.append((-1) ** k * np.einsum("ki,ki->k", x, cross(y, z)))
    parts = np.stack(volume, axis=1)
    total = parts.sum(axis=1)
    share = parts / np.where(total != 0, total, 1.0)[:, None]
    inside = (total != 0) & (share > 0).all(axis=1)
    weight[rows[inside]] = share[inside]


# separation along face normals and across edges ------------------------------------------


def face_separations(a: Cores, b: Cores) -> tuple[Array, Array]:
    """Separation of the cores along the face normals of each, shapes (K, Fa), (K, Fb)."""
    first = (a.normal @ b.vertex.transpose(0, 2, 1)).min(axis=2) - a.offset
    second = (b.normal @ a.vertex.transpose(0, 2, 1)).min(axis=2) - b.offset
    return first, second


@dataclass(frozen=True, slots=True, eq=False)
class EdgeDirections(Rows):
    """Directions across pairs of edges."""

    row: Index
    """Pair of cores of each direction, shape (n,)."""
    normal: Array = columns(3)
    """Unit vectors from a to b, shape (n, 3)."""
    separation: Array = columns()
    """Distance of the edges along them [length unit], shape (n,)."""


def edge_separations(a: Cores, b: Cores, bound: Array) -> EdgeDirections:
    """Separations along the directions across edges that form faces of the Minkowski difference.

    Arguments: `bound` (K,): absolute value of a known separation; edges farther than that from the
    other core are left out.
    """
    first, second = _near_edges(a, b, bound, 1.0), _near_edges(b, a, bound, -1.0)
    blocks = product_blocks(len(bound), first.row, second.row)
    return EdgeDirections.join(_across_arcs(first, second, i, j) for i, j in blocks)


@dataclass(frozen=True, slots=True, eq=False)
class _Edges(Rows):
    """Edges of cores."""

    row: Index
    """Pair of each edge, shape (n,)."""
    start: Array = columns(3)
    step: Array = columns(3)
    low: Array = columns(3)
    high: Array = columns(3)
    """Normals of the faces beside each edge, of the second core with the opposite sign, (n, 3)."""
    bare: Mask = columns()
    """Whether there are no faces beside it, shape (n,)."""


def _near_edges(core: Cores, other: Cores, bound: Array, sign: float) -> _Edges:
    """Edges of a core within a distance of the box around the other core."""
    low = other.vertex.min(axis=1) - bound[:, None]
    high = other.vertex.max(axis=1) + bound[:, None]
    rows = np.arange(len(bound))[:, None]
    ends = core.vertex[rows, core.edge[..., 0]], core.vertex[rows, core.edge[..., 1]]
    near = (np.maximum(*ends) >= low[:, None]) & (np.minimum(*ends) <= high[:, None])
    row, k = np.nonzero(near.all(axis=2) & core.edges)
    faces = core.edge_face[row, k]
    left, right = (sign * core.normal[row, faces[:, side]] for side in range(2))
    start = ends[0][row, k]
    return _Edges(row, start, ends[1][row, k] - start, left, right, faces[:, 0] < 0)


def _across_arcs(first: _Edges, second: _Edges, i: Index, j: Index) -> EdgeDirections:
    """Directions across edges whose arcs of normals cross each other on the Gaussian sphere."""

    def dot(x: Array, y: Array) -> Array:
        result: Array = np.einsum("ki,ki->k", x, y)
        return result

    # each arc crosses the great circle of the other ...
    d = first.step[i]
    kept = second.bare[j] | (dot(second.low[j], d) * dot(second.high[j], d) < 0)
    i, j = i[kept], j[kept]
    e = second.step[j]
    kept = first.bare[i] | (dot(first.low[i], e) * dot(first.high[i], e) < 0)
    i, j, d, e = i[kept], j[kept], first.step[i[kept]], e[kept]
    n = cross(d, e)
    length = np.sqrt(dot(n, n))
    sine = length / np.sqrt(dot(d, d) * dot(e, e))
    n = n / np.where(length > 0, length, 1.0)[:, None]
    # ... on the same side of the sphere
    side = dot(first.low[i] + first.high[i], n)
    other = dot(second.low[j] + second.high[j], n)
    bare_a, bare_b = first.bare[i], second.bare[j]
    kept = (sine > PARALLEL) & (bare_a | bare_b | (side * other > 0))
    between = dot(second.start[j] - first.start[i], n)
    sign = np.where(bare_a, np.where(bare_b, between, other), side)
    turn = np.where(sign < 0, -1.0, 1.0)
    rows = np.flatnonzero(kept)
    turned = turn[rows, None] * n[rows]
    return EdgeDirections(first.row[i[rows]], turned, (between * turn)[rows])


def product_blocks(count: int, first: Index, second: Index) -> Iterator[tuple[Index, Index]]:
    """Pairs of entries of two lists with the same row, as places in both lists, in blocks.

    Arguments: `count`: number of rows; `first`, `second`: row of each entry, ascending.
    """
    start = np.searchsorted(second, np.arange(count + 1))
    number = np.diff(start)[first]
    total = np.cumsum(number)
    limits = np.arange(PRODUCTS, int(total[-1]) if len(total) else 0, PRODUCTS)
    ends = np.searchsorted(total, limits, side="right")
    for block in np.split(np.arange(len(first)), np.unique(ends)):
        owner, place = counted(number[block])
        yield block[owner], start[first[block[owner]]] + place


def products(count: int, first: Index, second: Index) -> tuple[Index, Index]:
    """All pairs of entries of two lists with the same row, as places in both lists."""
    blocks = list(product_blocks(count, first, second))
    return np.concatenate([i for i, _ in blocks]), np.concatenate([j for _, j in blocks])
