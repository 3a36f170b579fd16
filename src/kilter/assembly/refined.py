"""The triangles of a part cut finer, their new corners on its exact surfaces.

Within a box each side of a triangle is cut in two, a round. A new corner lies over the middle of
a side: on the surface of both triangles there, on the edge where those are different faces, and
on the side itself where nothing is known but the triangles. So the body there converges to the
exact one, by a factor of 16 in two rounds.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross, unit_rows
from kilter.assembly.edge_curves import Chords
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, Surfaces
from kilter.shape.closed import shared_edges

__all__ = ["refined"]


def refined(
    geometry: Geometry, part: int, rounds: int, box: tuple[Array, Array]
) -> tuple[Array, Index]:
    """Corners, shape (n, 3), and triangles of a part, cut finer so many times; world frame.

    Parameters
    ----------
    geometry : Geometry
    part : int
    rounds : int
    box : (low, high)
        Sides that come within it are cut.

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Sphere
    >>> geometry = Assembly([Part("ball", Sphere(2.0))]).geometry
    >>> whole = np.full(3, -2.0), np.full(3, 2.0)
    >>> vertices, triangles = refined(geometry, 0, 1, whole)
    >>> len(triangles) == 4 * len(geometry.triangles)
    True
    >>> np.allclose(np.linalg.norm(vertices, axis=1), 2.0)
    True
    """
    s = geometry.surfaces
    first, last = geometry.vertex_start[part], geometry.vertex_start[part + 1]
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    vertices, triangles = geometry.vertices[first:last], geometry.triangles[span] - first
    label = geometry.triangle_surface[span]
    if len(s):
        known = (s.kind[label] != FREE) & (s.doubt[label] == 0)
        label = np.where(known, label, -1)
    for _ in range(rounds):
        vertices, triangles, label = _cut(s, vertices, triangles, label, box)
    return vertices, triangles


def _cut(
    s: Surfaces, vertices: Array, triangles: Index, label: Index, box: tuple[Array, Array]
) -> tuple[Array, Index, Index]:
    """The sides of triangles within a box cut in two; the surface of each triangle."""
    one, other = shared_edges(triangles)
    ends = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    p, q = vertices[ends[one]].transpose(1, 0, 2)
    near = (np.minimum(p, q) <= box[1]).all(axis=1) & (np.maximum(p, q) >= box[0]).all(axis=1)
    one, other, p, q = one[near], other[near], p[near], q[near]
    middle = _middles(s, vertices[triangles], label, (one // 3, other // 3), (p, q))
    at = np.full(len(ends), -1)
    at[one] = at[other] = len(vertices) + np.arange(len(one))
    made, kept = _halved(triangles, at.reshape(-1, 3))
    return np.concatenate([vertices, middle]), made, label[kept]


def _middles(
    s: Surfaces, corner: Array, label: Index, sides: tuple[Index, Index], ends: tuple[Array, Array]
) -> Array:
    """Where sides between pairs of triangles are cut, shape (n, 3)."""
    normal = unit_rows(cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
    both, (p, q) = np.column_stack(sides), ends
    on, middle = label[both], (p + q) / 2
    bent = np.flatnonzero(on[:, 0] != on[:, 1])
    both = both[bent]
    chords = Chords(p[bent], q[bent], on[bent], corner[both, 0], normal[both])
    points, found = chords.on_edge(np.full(len(bent), 0.5), s)
    middle[bent[found]] = points[found]
    same = np.flatnonzero((on[:, 0] == on[:, 1]) & (on[:, 0] >= 0))
    rows, at = on[same, 0], middle[same]
    middle[same] = at - s.distance(rows, at)[:, None] * s.outward(rows, at)
    return middle


def _halved(triangles: Index, at: Index) -> tuple[Index, Index]:
    """Triangles cut where `at` names a corner on a side (-1: none), and which each came from."""
    count = (at >= 0).sum(axis=1)
    rows = np.arange(len(triangles))
    # turned so that sides from the first one on are cut, in order: then the rest are not
    first = np.where(count == 1, (at >= 0).argmax(axis=1), 0)
    first = np.where(count == 2, ((at < 0).argmax(axis=1) + 1) % 3, first)
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turn, axis=1).T
    p, q, r = np.take_along_axis(at, turn, axis=1).T
    cuts = {
        0: [(a, b, c)],
        1: [(a, p, c), (p, b, c)],
        2: [(a, p, c), (p, q, c), (p, b, q)],
        3: [(a, p, r), (p, b, q), (r, q, c), (p, q, r)],
    }
    made = [np.column_stack(t)[count == n] for n, pieces in cuts.items() for t in pieces]
    kept = [rows[count == n] for n, pieces in cuts.items() for _ in pieces]
    return np.concatenate(made), np.concatenate(kept)
