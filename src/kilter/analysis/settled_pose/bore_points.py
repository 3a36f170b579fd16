"""Candidate points between a round body and the hole around it, at any play.

A solid cylinder (radius r, axis through c along u) passes a cylindrical hole (radius R, axis
through C along U). Over the common heights along U the body comes nearest to the wall at one of
their two ends. At an end, a circle ends there: that of the body or that of the hole. For a unit
direction n across the axis of the other surface, the point of the circle towards n is

    x = c' + r m,     gap = R - |x - C|_across U     (the end of the body)
    x = C' + R m,     gap = |x - c|_across u - r     (the end of the hole)

where c', C' are the middles of the circles, m is n without its component along the own axis, as a
unit vector, and | |_across the distance from the axis. The gap is exact for every pose. The
directions are the direction in which both come nearest, the direction of gravity, and others at
both sides of them, so that the body stops at the wall in whatever direction it moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.settled_pose.settle_tolerances import FACING
from kilter.arrays import Array, Index, Mask, Rows, across, lengths, ragged, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, Surfaces
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.shape.covering import covered

BESIDE_NEAREST = (0.0, 0.2, 2.0)
BESIDE_DOWN = (0.0, 0.2, 2.0, 10.0, 25.0, 45.0, 90.0, 135.0, 180.0)
"""Angles of the directions to the nearest direction and to that of gravity, on both sides [deg]. A
body that slides along the wall stays inside of the polygon of the walls across these directions;
small angles keep it near to the wall itself."""
OBLIQUE = 0.5
"""Largest angle between the axes of a body and a hole [rad]."""
LENGTHS = 4.0
"""Distance over which triangles may lie off the surface that they cover, in sagittas [-]."""
INSIDE = 1e-3
"""Distance from an end at which the extent of both faces is examined, over the common height."""

Points = tuple[Index, Array, Array, Array]
"""Row of the shaft and hole, point, normal from part a to b, and gap."""


@dataclass(frozen=True, slots=True, eq=False)
class Shafts(Rows):
    """Solid cylinders in hollow cylinders: rows of the surfaces, and of the pair of parts."""

    pair: Index
    body: Index
    hole: Index
    swapped: Mask
    """True if the hole belongs to part a."""


def bore_points(geometry: Geometry, shafts: Shafts, down: Array, reach: float) -> Points:
    """Points between solid cylinders and the holes that they pass, with gaps up to a reach.

    Arguments: `down` (3,): direction of gravity; `reach` [length unit].
    """
    body, hole, swapped = shafts.body, shafts.hole, shafts.swapped
    blocks = []
    for at_body in (True, False):
        for end in (0, 1):
            blocks += _end_points(geometry, (body, hole), down, reach, end, at_body=at_body)
    if not blocks:
        return np.empty(0, dtype=np.int64), np.empty((0, 3)), np.empty((0, 3)), np.empty(0)
    row, point, normal, gap = (np.concatenate([block[k] for block in blocks]) for k in range(4))
    return row, point, np.where(swapped[row, None], -normal, normal), gap


def shafts_in_holes(geometry: Geometry, pairs: Index) -> Shafts:
    """Solid cylinders, and wider hollow cylinders of the other part up to `OBLIQUE` apart.

    Arguments: `pairs` (n, 2): parts a and b.
    """
    s = geometry.surfaces
    blocks = []
    for solid, hollow in ((0, 1), (1, 0)):
        owner, i = ragged(s.start, pairs[:, solid])
        keep = (s.kind[i] == CYLINDER) & ~s.hollow[i]
        owner, i = owner[keep], i[keep]
        row, j = ragged(s.start, pairs[owner, hollow])
        keep = (s.kind[j] == CYLINDER) & s.hollow[j] & (s.radius[j] > s.radius[i[row]])
        row, j = row[keep], j[keep]
        keep = lengths(np.cross(s.axis[i[row]], s.axis[j])) <= np.sin(OBLIQUE)
        row, j = row[keep], j[keep]
        blocks.append(Shafts(owner[row], i[row], j, np.full(len(j), solid == 1)))
    return Shafts.join(blocks)


def _extents(geometry: Geometry, rows: Index, axis: Array, origin: Array) -> tuple[Array, Array]:
    """Least and greatest height of surfaces along axes through origins, shape (n,) each."""
    s = geometry.surfaces
    owner, place = ragged(s.triangle_start, rows)
    corners = geometry.vertices[geometry.triangles[s.triangle[place]]]
    height = np.einsum("kci,ki->kc", corners - origin[owner][:, None], axis[owner])
    low, high = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    np.minimum.at(low, owner, height.min(axis=1))
    np.maximum.at(high, owner, height.max(axis=1))
    return low, high


def _end_points(
    geometry: Geometry, pair: tuple[Index, Index], down: Array, reach: float, end: int,
    *, at_body: bool,
) -> list[tuple[Index, Array, Array, Array]]:  # fmt: skip
    """Points at the low (0) or high (1) end of the body (`at_body`) or of the hole."""
    s = geometry.surfaces
    own, other = pair if at_body else pair[::-1]
    if not len(own):
        return []
    axis = s.axis[own]
    limits = _extents(geometry, own, axis, s.point[own])
    far = _extents(geometry, other, axis, s.point[own])
    height = limits[end]
    # equal ends count once
    grow = SAME_PLACE * (limits[1] - limits[0]) * (1 if at_body else -1)
    rows = np.flatnonzero((height >= far[0] - grow) & (height <= far[1] + grow))
    inward = (1 - 2 * end) * INSIDE * (limits[1] - limits[0])
    own, other, axis, height = own[rows], other[rows], axis[rows], height[rows]
    middle = s.point[own] + height[:, None] * axis
    n = _directions(s, other, middle, down, 1.0 if at_body else -1.0)
    row = np.repeat(np.arange(len(rows)), n.shape[1])
    n = n.reshape(-1, 3)
    m = unit_rows(n - np.einsum("ij,ij->i", n, axis[row])[:, None] * axis[row])
    x = middle[row] + s.radius[own[row]][:, None] * m
    gap, face = s.distance(other[row], x), s.outward(other[row], x)
    keep = np.abs(gap) <= reach
    step = (inward[rows, None] * axis)[row]
    keep[keep] = _on_face(geometry, own[row[keep]], (x + step)[keep], m[keep])
    foot = x - gap[:, None] * face
    keep[keep] = _on_face(geometry, other[row[keep]], (foot + step)[keep], face[keep])
    normal = -face if at_body else face
    return [(rows[row[keep]], ((x + foot) / 2)[keep], normal[keep], gap[keep])]


def _directions(s: Surfaces, other: Index, middle: Array, down: Array, sense: float) -> Array:
    """Directions across the axes of surfaces: to the nearest wall, and around.

    The nearest wall lies away from the axis (`sense` 1) or towards it (-1), seen from the middles.
    Shape (n, m, 3).
    """
    axis = s.axis[other]
    u = down - (axis @ down)[:, None] * axis
    flat = lengths(u) < FACING
    u[flat] = across(axis[flat])[0]
    u = unit_rows(u)
    nearest = sense * s.polar(other, middle)[2]
    nearest = np.where(lengths(nearest)[:, None] > 0.5, nearest, u)
    fans = [_fan(nearest, axis, BESIDE_NEAREST), _fan(u, axis, BESIDE_DOWN)]
    return np.concatenate(fans, axis=1)


def _fan(first: Array, axis: Array, degrees: tuple[float, ...]) -> Array:
    """Unit vectors at angles to the first direction on both sides, about an axis, (n, m, 3)."""
    both = sorted({sign * angle for angle in degrees for sign in (-1.0, 1.0)} - {-180.0})
    angle = np.radians(both)[:, None]
    aside = np.cross(axis, first)
    fan: Array = np.cos(angle) * first[:, None] + np.sin(angle) * aside[:, None]
    return fan


def _on_face(geometry: Geometry, rows: Index, points: Array, normals: Array) -> Mask:
    """Mask of points of surfaces that their triangles cover."""
    s = geometry.surfaces
    on = np.zeros(len(rows), dtype=bool)
    for row in np.unique(rows).tolist():
        k = np.flatnonzero(rows == row)
        face = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        sagitta = LENGTHS * float(s.sagitta[row]) + float(geometry.accuracy[s.part[row]])
        on[k] = covered(face, points[k], normals[k], sagitta, sagitta)
    return on
