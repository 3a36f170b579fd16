"""Candidate contacts of solid curved surfaces with planes.

With n the outward normal of the plane and o a point of it: a sphere touches at c - r n, a cylinder
whose axis lies in the plane along a line, a cone with n.axis = sin(half_angle) along a generator, a
torus around a circle if its axis is upright, else in its lowest point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, unit_rows
from kilter.assembly.surfaces import CONE, CYLINDER, SPHERE, TORUS, Surfaces
from kilter.contact.curved.candidates import (
    CIRCLE,
    LINE,
    POINT,
    Candidates,
    dot,
    make_candidates,
    without_along,
)  # fmt: skip

__all__ = ["Planes", "on_planes"]


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """Planes of n flat faces: unit outward normals and a point of each plane, shape (n, 3)."""

    normal: Array
    origin: Array


def on_planes(s: Surfaces, i: Index, planes: Planes, angle: Array) -> Candidates:
    """Candidate contacts of solid curved surfaces `i` with planes, row by row.

    `angle` is the tolerance of each pair, shape (n,) [rad].
    """
    rows = np.arange(len(i))
    blocks: list[Candidates] = []
    for kind, kernel in (
        (SPHERE, _sphere_plane),
        (CYLINDER, _cylinder_plane),
        (CONE, _cone_plane),
        (TORUS, _torus_plane),
    ):
        k = np.flatnonzero((s.kind[i] == kind) & ~s.hollow[i])
        if len(k):
            n, o = planes.normal[k], planes.origin[k]
            blocks.append(kernel(s, rows[k], i[k], n, o, angle[k]))
    return Candidates.join(blocks)


def _sphere_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Candidates:
    """Candidate point contacts: the point of each sphere nearest to its plane."""
    r = s.radius[i]
    gap = dot(s.point[i] - o, n) - r
    at = s.point[i] - (r + gap / 2)[:, None] * n
    return make_candidates(row, POINT, at, -n, gap, bend=r)


def _cylinder_plane(
    s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array
) -> Candidates:
    """Candidate line contacts: the lowest line of each cylinder, if parallel to its plane.

    Lines up to the tilt `angle` count as parallel [rad].
    """
    slope = dot(s.axis[i], n)
    k = np.flatnonzero(np.abs(slope) <= np.sin(angle))
    row, i, n, o, slope = row[k], i[k], n[k], o[k], slope[k]
    r, axis = s.radius[i], s.axis[i]
    normal = -unit_rows(n + unit_rows(without_along(n, axis)))
    along = unit_rows(without_along(axis, normal))
    gap = dot(s.point[i] - o, n) - r
    at = s.point[i] + (r + gap / 2)[:, None] * normal
    return make_candidates(row, LINE, at, normal, gap, along=along, slope=slope, bend=r)


def _cone_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate line contacts: the straight line of each cone that lies on its plane.

    Lines up to the tilt `angle` count as lying on the plane [rad].
    """
    lift, alpha = dot(s.axis[i], n), s.half_angle[i]
    k = np.flatnonzero(np.abs(np.arcsin(np.clip(lift, -1, 1)) - alpha) <= angle)
    row, i, n, o, alpha = row[k], i[k], n[k], o[k], alpha[k]
    axis = s.axis[i]
    out = -unit_rows(without_along(n, axis))
    side = np.cos(alpha)[:, None] * out - np.sin(alpha)[:, None] * axis
    normal = unit_rows(side - n)
    generator = np.cos(alpha)[:, None] * axis + np.sin(alpha)[:, None] * out
    gap, slope = dot(s.point[i] - o, n), dot(generator, n)
    at = s.point[i] + (gap / 2)[:, None] * normal
    along = unit_rows(without_along(generator, normal))
    return make_candidates(row, LINE, at, normal, gap, along=along, slope=slope, bend=s.radius[i])


def _torus_plane(s: Surfaces, row: Index, i: Index, n: Array, o: Array, angle: Array) -> Candidates:
    """Candidate contacts of tori with planes: a circle if the axis is upright, else a point."""
    center, axis, radius, tube = s.point[i], s.axis[i], s.radius[i], s.tube[i]
    aside = without_along(n, axis)
    sine = np.linalg.norm(aside, axis=1)
    upright = sine <= np.sin(angle)
    k = np.flatnonzero(upright)
    gap = dot(center - o, n) - tube
    at = center - (tube + gap / 2)[:, None] * n
    flat = np.tile([0.0, -1.0, 0.0], (len(k), 1))
    circle = make_candidates(
        row[k], CIRCLE, at[k], flat, gap[k],
        along=n[k], radius=radius[k], swing=(radius * sine)[k], bend=tube[k],
    )  # fmt: skip
    k = np.flatnonzero(~upright)
    lowest = center[k] - radius[k][:, None] * unit_rows(aside[k])
    gap = dot(lowest - o[k], n[k]) - tube[k]
    at = lowest - (tube[k] + gap / 2)[:, None] * n[k]
    bend = tube[k] + radius[k] / sine[k]
    return Candidates.join([circle, make_candidates(row[k], POINT, at, -n[k], gap, bend=bend)])
