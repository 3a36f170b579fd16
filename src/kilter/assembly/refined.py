"""Refine the triangles of a part, with new corners on its exact surfaces.

A round divides each side of a triangle within a box in two. The new corner is moved from the
middle of the side to the surface of both triangles, or to the edge curve if they are on different
faces. It stays on the side if the surface is unknown. The distance from the exact body decreases
by a factor of 16 in two rounds.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross, unit_rows
from kilter.assembly.edge_curves import Chords
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, Surfaces
from kilter.shape.closed import shared_edges

__all__ = ["refine"]


def refine(
    geometry: Geometry, part: int, rounds: int, box: tuple[Array, Array]
) -> tuple[Array, Index]:
    """Divide the triangles of a part within a box into smaller ones on the true surface.

    Arguments: `box` (3,): lower and upper corner, world frame; sides whose bounding box overlaps it
    are divided. Returns `vertices` (n, 3): world frame; `triangles` (m, 3).

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Sphere
    >>> geometry = Assembly([Part("ball", Sphere(2.0))]).geometry
    >>> whole = np.full(3, -2.0), np.full(3, 2.0)
    >>> vertices, triangles = refine(geometry, 0, 1, whole)
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
        vertices, triangles, label = _refine_once(s, vertices, triangles, label, box)
    return vertices, triangles


def _refine_once(
    s: Surfaces, vertices: Array, triangles: Index, label: Index, box: tuple[Array, Array]
) -> tuple[Array, Index, Index]:
    """Divide triangles within a box once; returns vertices, triangles, and surface labels."""
    first, second = shared_edges(triangles)
    ends = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    p, q = vertices[ends[first]].transpose(1, 0, 2)
    near = (np.minimum(p, q) <= box[1]).all(axis=1) & (np.maximum(p, q) >= box[0]).all(axis=1)
    first, second, p, q = first[near], second[near], p[near], q[near]
    middle = _middles(s, vertices[triangles], label, (first // 3, second // 3), (p, q))
    at = np.full(len(ends), -1)
    at[first] = at[second] = len(vertices) + np.arange(len(first))
    pieces, source = _divide(triangles, at.reshape(-1, 3))
    return np.concatenate([vertices, middle]), pieces, label[source]


def _middles(
    s: Surfaces, corner: Array, label: Index, sides: tuple[Index, Index], ends: tuple[Array, Array]
) -> Array:
    """New corners at the middles of triangle sides, moved to the true surfaces, shape (n, 3).

    Arguments: `corner` (m, 3, 3): corners of the triangles; `label` (m,): surface of each triangle,
    or -1; `sides` (n,): the two triangles at each side; `ends` (n, 3): ends of the sides.
    """
    normal = unit_rows(cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
    both, (p, q) = np.column_stack(sides), ends
    on, middle = label[both], (p + q) / 2
    bent = np.flatnonzero(on[:, 0] != on[:, 1])
    both = both[bent]
    chords = Chords(p[bent], q[bent], on[bent], corner[both, 0], normal[both])
    points, converged = chords.on_edge(np.full(len(bent), 0.5), s)
    middle[bent[converged]] = points[converged]
    same = np.flatnonzero((on[:, 0] == on[:, 1]) & (on[:, 0] >= 0))
    rows, at = on[same, 0], middle[same]
    middle[same] = at - s.distance(rows, at)[:, None] * s.outward(rows, at)
    return middle


def _divide(triangles: Index, at: Index) -> tuple[Index, Index]:
    """Divide triangles at the new corners on their sides (`at`, -1: none).

    Arguments: `triangles` (m, 3); `at` (m, 3): new corner on each side, from corner k to corner k +
    1, or -1. Returns `pieces` (n, 3); `source` (n,): the triangle that each piece is from.
    """
    count = (at >= 0).sum(axis=1)
    rows = np.arange(len(triangles))
    # rotate the corners so that the divided sides come first
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
    pieces = [np.column_stack(t)[count == n] for n, cut in cuts.items() for t in cut]
    source = [rows[count == n] for n, cut in cuts.items() for _ in cut]
    return np.concatenate(pieces), np.concatenate(source)
