"""The lowest points of parts, of their exact surfaces and not of the triangles that stand for them.

Along a direction `up`, a solid is lowest where the outward normal of a face is -up, or on an
edge, or in a corner. Planes, cylinders and cones are ruled: they are lowest at their ends, which
are edges and corners. A sphere of centre c is lowest in c - r up, a torus in

    c - R u - t up,   u = the unit direction of `up` less its part along the axis,

all around where the axis is upright; both only where the face reaches there. An edge between two
faces f and g, known by a chord of it, is the curve f = g = 0 over the chord, lowest in one point
there. Corners of triangles lie on the surfaces, and free forms and surfaces recognised in meshes
are known by those only.
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
"""Points that are asked of a circle that is lowest all around."""
SECTIONS = 36
"""Golden sections of a chord, to 3e-8 of it: heights are then exact to rounding."""
GOLDEN = (np.sqrt(5.0) - 1) / 2


def lowest_heights(geometry: Geometry, up: Array) -> Array:
    """The height of the lowest point of each part along a unit direction, shape (N,).

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
    """Parts and heights of the lowest points of spheres and tori, as far as their faces reach."""
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
    """The lowest points of a whole sphere or torus, shape (n, 3)."""
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
    """Parts and heights of the lowest points of edges beside exact round faces."""
    chords, part = _chords(geometry, up, low)
    if not len(part):
        return part, np.empty(0)
    s, left, right = geometry.surfaces, np.zeros(len(part)), np.ones(len(part))
    for _ in range(SECTIONS):
        one, other = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
        lower = (
            chords.on_edge(one, geometry.surfaces)[0] @ up
            < chords.on_edge(other, geometry.surfaces)[0] @ up
        )
        left, right = np.where(lower, left, one), np.where(lower, other, right)
    points, found = chords.on_edge((left + right) / 2, s)
    return part[found], (points @ up)[found]


def _chords(geometry: Geometry, up: Array, low: Array) -> tuple[Chords, Index]:
    """Edges between different faces, one of them round, near the bottom of their parts."""
    s, label = geometry.surfaces, geometry.triangle_surface
    owner = geometry.triangle_part
    mine = np.flatnonzero((np.diff(s.start) > 0)[owner])
    triangles = geometry.triangles[mine]
    first, second = shared_edges(triangles)
    sides = np.column_stack([mine[first // 3], mine[second // 3]])
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
