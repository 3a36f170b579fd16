"""Find the lowest points of parts on their exact surfaces, not on the triangles.

Along a direction `up`, the lowest point of a solid is a point of a face with the outward normal
-up, a point of an edge, or a corner. Planes, cylinders and cones are ruled surfaces: their lowest
points are on edges and corners. The lowest point of a sphere with centre c is c - r up, that of a
torus is

    c - R u - t up,   u = unit vector of the component of `up` across the axis.

A torus with an upright axis is lowest all around. Both count only if the face extends to that
point. The edge between two faces f and g is the curve f = g = 0 over its chord, which has a single
lowest point. The corners of triangles are on the surfaces. Free forms, and surfaces recognised in
meshes, are represented by their corners only.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, across, cross, unit_rows
from kilter.assembly.assembly_tolerances import BESIDE_SEAM, UPRIGHT
from kilter.assembly.edge_curves import Chords
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, SPHERE, TORUS
from kilter.shape.closed import shared_edges
from kilter.shape.covering import covered

__all__ = ["lowest_heights"]

AROUND = 144
"""Number of points of a circle of lowest points that are tested for lying on the face."""
SECTIONS = 36
"""Number of golden-section steps along a chord: 3e-8 of its length, so that heights are exact to
rounding."""
GOLDEN = (np.sqrt(5.0) - 1) / 2
"""Ratio of successive intervals of a golden-section search [-]."""


def lowest_heights(geometry: Geometry, up: Array) -> Array:
    """Height of the lowest point of each part along an upward unit vector, shape (N,).

    Examples
    --------
    >>> from kilter.assembly import Assembly, Part
    >>> from kilter.shape.primitives import Sphere
    >>> geometry = Assembly([Part("ball", Sphere(1.0))]).geometry
    >>> up = np.array([0.6, 0.0, 0.8])
    >>> float((geometry.vertices @ up).min()) > -1, lowest_heights(geometry, up).round(15)
    (True, array([-1.]))
    """
    low: Array = np.minimum.reduceat(geometry.vertices @ up, geometry.vertex_start[:-1])
    if len(geometry.surfaces):
        for part, height in (_inside_faces(geometry, up), _on_edges(geometry, up, low)):
            np.minimum.at(low, part, height)
    return low


# within faces -------------------------------------------------------------------------------


def _inside_faces(geometry: Geometry, up: Array) -> tuple[Index, Array]:
    """Part and height of the lowest points of exact spheres and tori, if on their faces."""
    s = geometry.surfaces
    parts, heights = [], []
    exact = np.isin(s.kind, (SPHERE, TORUS)) & ~s.hollow & (s.doubt == 0)
    for row in np.flatnonzero(exact).tolist():
        points = _lowest_of_surface(geometry, row, up)
        triangles = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        grow = BESIDE_SEAM * float(s.radius[row])
        down = np.tile(-up, (len(points), 1))
        if covered(triangles, points, down, float(s.sagitta[row]), grow).any():
            parts.append(int(s.part[row]))
            heights.append(float(points[0] @ up))
    return np.array(parts, dtype=np.int64), np.array(heights)


def _lowest_of_surface(geometry: Geometry, row: int, up: Array) -> Array:
    """Lowest points of a complete sphere or torus, shape (n, 3)."""
    s = geometry.surfaces
    center, axis, radius = s.point[row], s.axis[row], float(s.radius[row])
    if s.kind[row] == SPHERE:
        return np.asarray((center - radius * up)[None])
    aside = up - (up @ axis) * axis
    sine = float(np.linalg.norm(aside))
    if sine > UPRIGHT:
        out = aside[None] / -sine
    else:
        angle = np.arange(AROUND)[:, None] * (2 * np.pi / AROUND)
        u, v = across(axis)
        out = np.cos(angle) * u + np.sin(angle) * v
    return np.asarray(center + radius * out - float(s.tube[row]) * up)


# on edges -----------------------------------------------------------------------------------


def _on_edges(geometry: Geometry, up: Array, low: Array) -> tuple[Index, Array]:
    """Part and height of the lowest points of curved edges at exact faces.

    `low`: the lowest vertex of each part, shape (N,); edges above it are skipped.
    """
    chords, part = _chords(geometry, up, low)
    if not len(part):
        return part, np.empty(0)
    s, left, right = geometry.surfaces, np.zeros(len(part)), np.ones(len(part))
    for _ in range(SECTIONS):
        first, second = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
        lower = (
            chords.on_edge(first, geometry.surfaces)[0] @ up
            < chords.on_edge(second, geometry.surfaces)[0] @ up
        )
        left, right = np.where(lower, left, first), np.where(lower, second, right)
    points, converged = chords.on_edge((left + right) / 2, s)
    return part[converged], (points @ up)[converged]


def _chords(geometry: Geometry, up: Array, low: Array) -> tuple[Chords, Index]:
    """Chords of curved edges that may reach below all vertices of their part, and the parts."""
    s, label = geometry.surfaces, geometry.triangle_surface
    owner = geometry.triangle_part
    on_curved = np.flatnonzero((np.diff(s.start) > 0)[owner])  # triangles of parts with surfaces
    triangles = geometry.triangles[on_curved]
    first, second = shared_edges(triangles)
    sides = np.column_stack([on_curved[first // 3], on_curved[second // 3]])
    rows = label[sides]
    ends = triangles[first // 3, first % 3], triangles[first // 3, (first + 1) % 3]
    p, q = (geometry.vertices[end] for end in ends)
    reach = np.minimum(p @ up, q @ up) - np.linalg.norm(q - p, axis=1)
    known = ~((s.kind[rows] == FREE) | (s.doubt[rows] > 0)) | (rows < 0)
    keep = (rows[:, 0] != rows[:, 1]) & known.all(axis=1) & (reach <= low[owner[sides[:, 0]]])
    corners = geometry.vertices[geometry.triangles[sides[keep]]]
    normal = unit_rows(
        cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    )
    chords = Chords(p[keep], q[keep], rows[keep], corners[:, :, 0], normal)
    return chords, owner[sides[keep, 0]]
