"""Feature (face, edge, vertex) of a part at points of its surface, with its curvature.

The normals of the triangles at a point have the rank 3 minus the dimension of the feature: rank 1
is a face, rank 2 an edge, rank 3 a vertex, if the part lies below the planes of all of them. On an
exact surface with outward normal m, at distance rho from its axis, the curvature is

    sphere    P / r                      cylinder  h h^T / r        h the direction around the axis
    cone      h h^T cos(half_angle) / rho
    torus     t t^T / tube + h h^T cos(psi) / rho,   cos(psi) = (rho - radius) / tube, t = h x m
    rim       an edge along h, (m . away) / rho, away the direction from the axis

P is the tangential projection; hollow surfaces have the opposite sign. A surface that was
recognised in a mesh is in doubt by the height d of its arcs over their triangles. Radius and centre
may each be off by d, and the axis may lean by 2 d over a radius: with the greatest curvature k, any
curvature may be off by 4 d k^2 / (1 - 4 d k). Such a surface is open, or known within this doubt.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    columns,
    cross,
    extents,
    ragged,
    ratio,
    starts,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER, FREE, SPHERE, TORUS
from kilter.contact.common.broad import joins
from kilter.contact.curved.contact_points import bands_of
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX
from kilter.second_order.second_order_tolerances import AGREE, CROSSING

OFF = 4.0
"""Factor from the doubt of a surface recognised in a mesh to the error of its radius of curvature
[-]."""
ROUGH = 0.5
"""Relative error of a curvature above which it counts as unknown [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PartFeatures(Rows):
    """Features of single parts at n points of their surfaces, in the columns of `Features`."""

    kind: Index
    edge: Array = columns(3)
    curvature: Array = columns(3, 3)
    doubt: Array = columns()


def part_features(
    geometry: Geometry,
    part: Index,
    point: Array,
    outward: Array,
    reach: Array,
    region: Mask,
    recognised: Mask,
) -> PartFeatures:
    """Features (face, edge, vertex) of parts at points of their surfaces.

    Arguments: `part` (n,); `point`, `outward` (n, 3); `reach` (number of parts,) [length unit];
    `region` (n,); `recognised` (n,).
    """
    order = np.argsort(part, kind="stable")
    back = np.argsort(order, kind="stable")
    part, point, outward = part[order], point[order], outward[order]
    near, triangle = _triangles_at(geometry, part, point, reach)
    flat = _of_triangles(geometry, near, triangle, point, outward, reach[part])
    known = recognised[order]
    round_, many = _of_surfaces(geometry, part, point, outward, reach[part], known)
    foreign = _other_faces(geometry, near, triangle, round_[1])
    curved = round_[0]
    kind = np.where(curved.kind == OPEN, flat.kind, curved.kind)
    kind[_within_rim(geometry, near, triangle, point, outward, reach[part])] = FACE
    kind[many | (foreign & (curved.kind == FACE) & ~region[order])] = OPEN
    on_curved = (curved.kind != OPEN)[:, None]
    edge = np.where(on_curved, curved.edge, flat.edge)
    edge[kind != EDGE] = 0.0
    curvature = np.where((kind == OPEN)[:, None, None], 0.0, curved.curvature)
    doubt = np.where(kind == OPEN, 0.0, curved.doubt)
    return PartFeatures(kind, edge, curvature, doubt).take(back)


# triangles ---------------------------------------------------------------------------------


def _triangles_at(
    geometry: Geometry, part: Index, point: Array, reach: Array
) -> tuple[Index, Index]:
    """Pairs of a point and a triangle within `reach` of it, as indices sorted by point."""
    corners = geometry.vertices[geometry.triangles]
    box = extents(corners)
    pairs = [(k, t) for _, k, t in joins(part, (point, point), geometry.triangle_part, box, reach)]
    near = np.concatenate([np.empty(0, np.int64), *(k for k, _ in pairs)])
    triangle = np.concatenate([np.empty(0, np.int64), *(t for _, t in pairs)])
    p, x, far = corners[triangle], point[near], reach[part[near]]
    normal = unit_rows(cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    within = np.abs(_dot(x - p[:, 0], normal)) <= far
    for k in range(3):
        side = unit_rows(cross(normal, p[:, (k + 1) % 3] - p[:, k]))
        within &= _dot(x - p[:, k], side) >= -far
    order = np.lexsort((triangle[within], near[within]))
    return near[within][order], triangle[within][order]


def _of_triangles(
    geometry: Geometry, near: Index, triangle: Index, point: Array, outward: Array, reach: Array
) -> PartFeatures:
    """Features at points where all near triangles lie in flat faces; unknown at other points."""
    count = len(point)
    p = geometry.vertices[geometry.triangles[triangle]]
    normal = unit_rows(cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    spread = np.zeros((count, 3, 3))
    np.add.at(spread, near, normal[:, :, None] * normal[:, None, :])
    sizes, axes = np.linalg.eigh(spread)
    rank = (sizes > AGREE * np.maximum(sizes[:, 2:], 1.0)).sum(axis=1)
    plain = np.bincount(near, geometry.triangle_surface[triangle] >= 0, minlength=count) == 0
    plain &= rank > 0
    first = starts(np.bincount(near, minlength=count))
    mine, other = ragged(first, near)  # all pairs of triangles at the same point
    over = np.einsum("mki,mi->mk", p[other] - point[near[mine]][:, None], normal[mine]).max(axis=1)
    plain[near[mine][over > reach[near[mine]]]] = False
    edge, face = axes[:, :, 0], axes[:, :, 2]
    plain &= (rank != 1) | (np.abs(_dot(face, outward)) > np.cos(CROSSING))
    plain &= (rank != 2) | (np.abs(_dot(edge, outward)) < CROSSING)
    kind = np.where(plain, np.select([rank == 1, rank == 2], [FACE, EDGE], VERTEX), OPEN)
    across = edge - _dot(edge, outward)[:, None] * outward
    edge = np.where((kind == EDGE)[:, None], unit_rows(across), 0.0)
    return PartFeatures(kind, edge, np.zeros((count, 3, 3)), np.zeros(count))


def _within_rim(
    geometry: Geometry, near: Index, triangle: Index, point: Array, outward: Array, reach: Array
) -> Mask:
    """Mask of points on a chord of a round flat face; the true rim there lies farther outside."""
    s, surface = geometry.surfaces, geometry.triangle_surface[triangle]
    p = geometry.vertices[geometry.triangles[triangle]]
    normal = unit_rows(cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    face = (surface < 0) & (_dot(normal, outward[near]) > np.cos(CROSSING))
    side = np.zeros(len(near), dtype=bool)
    k = np.flatnonzero(surface >= 0)
    on = surface[k]
    convex = np.isin(s.kind[on], (CYLINDER, CONE)) & ~s.hollow[on] & (s.doubt[on] == 0)
    side[k] = convex & (s.distance(on, point[near[k]]) < -reach[near[k]])
    counts = [np.bincount(near, mask, minlength=len(point)) for mask in (face, side, face | side)]
    every = np.bincount(near, minlength=len(point))
    return np.asarray((counts[0] > 0) & (counts[1] > 0) & (counts[2] == every))


def _other_faces(geometry: Geometry, near: Index, triangle: Index, surface: Index) -> Mask:
    """Mask of points on a curved surface that are near another face as well."""
    other = geometry.triangle_surface[triangle] != surface[near]
    return np.bincount(near, other, minlength=len(surface)) > 0


# exact surfaces ----------------------------------------------------------------------------


def _of_surfaces(
    geometry: Geometry, part: Index, point: Array, outward: Array, reach: Array, recognised: Mask
) -> tuple[tuple[PartFeatures, Index], Mask]:
    """Features on exact surfaces, the surface of each point, and a mask of points on several."""
    s, count = geometry.surfaces, len(part)
    row, surface = ragged(s.start, part)
    x, m, far = point[row], outward[row], reach[row]
    _, rho, away = s.polar(surface, x)
    on = (s.kind[surface] != FREE) & (np.abs(s.distance(surface, x)) <= far)
    along = on & (_dot(s.outward(surface, x), m) > np.cos(CROSSING))
    end = _at_ends(geometry, surface, x, far) & on & (rho > far)
    rim = end & (np.abs(_dot(cross(s.axis[surface], away), m)) < CROSSING)
    touching = np.bincount(row, along, minlength=count)
    rims = np.bincount(row, rim, minlength=count)
    kind, at = np.full(count, OPEN), np.full(count, -1)
    edge, curvature = np.zeros((count, 3)), np.zeros((count, 3, 3))
    for chosen, alone in ((along, touching == 1), (rim, (rims == 1) & (touching <= 1))):
        k = np.flatnonzero(chosen & alone[row])
        kind[row[k]], at[row[k]] = (EDGE if chosen is rim else FACE), surface[k]
    k = np.flatnonzero(along & (kind[row] == FACE))
    curvature[row[k]] = _curvatures(geometry, surface[k], x[k], m[k])
    k = np.flatnonzero(rim & (kind[row] == EDGE))
    around = unit_rows(cross(s.axis[surface[k]], away[k]))
    bent = ratio(_dot(m[k], away[k]), rho[k])
    edge[row[k]] = around
    curvature[row[k]] = bent[:, None, None] * around[:, :, None] * around[:, None, :]
    used = np.where(at >= 0, at, 0)
    doubt = np.zeros(count)
    if len(s):
        most = np.linalg.norm(curvature, 2, axis=(1, 2))
        off = OFF * np.where(at >= 0, s.doubt[used], 0.0) * most
        kind[(off > 0) & ~(recognised & (off < ROUGH))] = OPEN
        doubt = np.where(off < ROUGH, most * off / (1 - np.minimum(off, ROUGH)), 0.0)
    return (PartFeatures(kind, edge, curvature, doubt), at), (touching > 1) | (rims > 1)


def _at_ends(geometry: Geometry, surface: Index, x: Array, reach: Array) -> Mask:
    """Mask of points on the flat end of a complete cylinder or cone."""
    s = geometry.surfaces
    at_end = np.zeros(len(surface), dtype=bool)
    k = np.flatnonzero(np.isin(s.kind[surface], (CYLINDER, CONE)))
    if not len(k):
        return at_end
    used, place = np.unique(surface[k], return_inverse=True)
    bands = bands_of(geometry, used)
    height, _, _ = s.polar(surface[k], x[k])
    off = np.minimum(np.abs(height - bands.low[place]), np.abs(height - bands.high[place]))
    at_end[k] = bands.whole[place] & (off <= reach[k])
    return at_end


def _curvatures(geometry: Geometry, surface: Index, x: Array, m: Array) -> Array:
    """Curvature tensors of surfaces at points x with outward normals m, shape (n, 3, 3)."""
    s = geometry.surfaces
    _, rho, away = s.polar(surface, x)
    kind, radius, tube = s.kind[surface], s.radius[surface], s.tube[surface]
    hoop = unit_rows(cross(s.axis[surface], away))
    meridian = cross(hoop, m)
    around = np.where(kind == CONE, ratio(np.cos(s.half_angle[surface]), rho), ratio(1.0, radius))
    around = np.where(kind == TORUS, ratio(ratio(rho - radius, tube), rho), around)
    along = np.where(kind == TORUS, ratio(1.0, tube), 0.0)
    tensor = around[:, None, None] * hoop[:, :, None] * hoop[:, None, :]
    tensor += along[:, None, None] * meridian[:, :, None] * meridian[:, None, :]
    ball = (np.eye(3) - m[:, :, None] * m[:, None, :]) * ratio(1.0, radius)[:, None, None]
    tensor = np.where((kind == SPHERE)[:, None, None], ball, tensor)
    result: Array = np.where(s.hollow[surface][:, None, None], -tensor, tensor)
    return result


def _dot(a: Array, b: Array) -> Array:
    result: Array = np.einsum("ij,ij->i", a, b)
    return result
