"""Faces without a formula: where their triangles come near each other."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import joins
from kilter.contact.sharp.edges import segment_distance

__all__ = ["free_touch"]


LEVEL = 1e-6
"""Edges closer to parallel than this are asked by their ends [rad]."""


def free_touch(geometry: Geometry, parts: Index, names: tuple[int, int], tolerance: float) -> Array:
    """Points where triangles of two faces come within tolerance and both sagittas, (n, 3)."""
    s = geometry.surfaces
    sides = []
    for part, name in zip(parts.tolist(), names, strict=True):
        if name >= 0:
            chosen = s.triangles_of(name)
        else:
            span = np.arange(geometry.triangle_start[part], geometry.triangle_start[part + 1])
            chosen = span[geometry.triangle_surface[span] < 0]
        sides.append(geometry.vertices[geometry.triangles[chosen]])
    grow = tolerance + float(sum(s.sagitta[k] for k in names if k >= 0))
    boxes = [(side.min(axis=1), side.max(axis=1)) for side in sides]
    owners = [np.zeros(len(side), dtype=np.int64) for side in sides]
    found = [np.empty((0, 3))]
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([grow])):
        off, point = _triangles_apart(sides[0][i], sides[1][j])
        found.append(point[off <= grow])
    return np.concatenate(found)


def _triangles_apart(one: Array, other: Array) -> tuple[Array, Array]:
    """Distance of triangles, shape (n, 3, 3), and a point between them; 0 where they cross."""
    off, best = np.full(len(one), np.inf), one[:, 0].copy()

    def better(value: Array, point: Array) -> None:
        use = value < off
        off[use], best[use] = value[use], point[use]

    for mine, its in ((one, other), (other, one)):
        normal = cross(its[:, 1] - its[:, 0], its[:, 2] - its[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        for k in range(3):
            p, q = mine[:, k], mine[:, (k + 1) % 3]
            for start, end in ((p, p), (p, q)):
                height = [np.einsum("ij,ij->i", x - its[:, 0], normal) for x in (start, end)]
                apart = height[0] - height[1]
                t = np.where(apart != 0, height[0] / np.where(apart != 0, apart, 1.0), 0.0)
                crossing = (t >= 0) & (t <= 1)
                at = start + np.where(crossing, t, 0.0)[:, None] * (end - start)
                up = np.einsum("ij,ij->i", at - its[:, 0], normal)
                foot = at - up[:, None] * normal
                inside = np.ones(len(at), dtype=bool)
                for m in range(3):
                    edge = its[:, (m + 1) % 3] - its[:, m]
                    inside &= np.einsum("ij,ij->i", cross(edge, foot - its[:, m]), normal) >= 0
                better(np.where(inside, np.abs(up), np.inf), (at + foot) / 2)
            for m in range(3):
                start, end = its[:, m], its[:, (m + 1) % 3]
                better(*_point_edge(p, start, end))
                across = np.linalg.norm(cross(q - p, end - start), axis=1)
                size = np.linalg.norm(q - p, axis=1) * np.linalg.norm(end - start, axis=1)
                some = np.flatnonzero(across > LEVEL * size)
                value, point = np.full(len(p), np.inf), p.copy()
                value[some], here, there = segment_distance(
                    p[some], q[some], start[some], end[some]
                )
                point[some] = (here + there) / 2
                better(value, point)
    return off, best


def _point_edge(x: Array, start: Array, end: Array) -> tuple[Array, Array]:
    """Distance of points from edges, and the point half-way."""
    along = end - start
    t = np.einsum("ij,ij->i", x - start, along) / np.maximum((along**2).sum(axis=1), 1e-300)
    foot = start + np.clip(t, 0, 1)[:, None] * along
    return np.linalg.norm(x - foot, axis=1), (x + foot) / 2
