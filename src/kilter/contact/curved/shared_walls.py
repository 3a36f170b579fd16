"""Depth of the material that two overlapping faces share.

Faces i and j of two parts overlap by d along a normal n: part i begins at d/2 and extends
backwards, part j begins at -d/2 and extends forwards. They share the interval

    from max(-d/2, the end of i behind its face)   to min(d/2, the end of j in front of its face)

of the line, if it is not empty. Two shells about the same axis, one inside the bore of the other,
share nothing, although the outer shell as a solid shaft would overlap the inner shell.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import joins
from kilter.contact.contact_tolerances import WALL_RIM

__all__ = ["shared_depth"]


def shared_depth(
    geometry: Geometry, parts: tuple[int, int], points: Array, normals: Array, depth: Array
) -> float:
    """Longest interval on the given lines that lies inside both parts [length unit]; 0: none.

    Parameters
    ----------
    geometry : Geometry
    parts : pair of int
        The part that the outward normals belong to, and the other part.
    points, normals : ndarray, shape (n, 3)
        Points half-way between the faces, and normals there.
    depth : ndarray, shape (n,)
        Overlap of the faces along each normal; lines without overlap are skipped [length unit].
    """
    slack = float(geometry.slack[list(parts)].max())
    overlapping = depth > 0
    points, normals, half = points[overlapping], normals[overlapping], depth[overlapping] / 2
    ends = points - half[:, None] * normals, points + half[:, None] * normals
    boxes = np.minimum(*ends), np.maximum(*ends)
    low, high = -half, half.copy()
    for line, t in _crossings(geometry, parts[0], points, normals, boxes):
        is_end = t < half[line] - slack
        np.maximum.at(low, line[is_end], t[is_end])
    for line, t in _crossings(geometry, parts[1], points, normals, boxes):
        is_end = t > slack - half[line]
        np.minimum.at(high, line[is_end], t[is_end])
    return float((high - low).max(initial=0.0))


def _crossings(
    geometry: Geometry, part: int, points: Array, normals: Array, boxes: tuple[Array, Array]
) -> Iterator[tuple[Index, Array]]:
    """Yield batches of pairs (line, t): a line passes through a triangle of a part at t.

    Line k is ``points[k] + t normals[k]``. All crossings inside its box are among the yielded ones.
    """
    span = slice(int(geometry.triangle_start[part]), int(geometry.triangle_start[part + 1]))
    corners = geometry.vertices[geometry.triangles[span]]
    lowest, highest = corners.min(axis=1), corners.max(axis=1)
    # only triangles near a line: the rim of a triangle, and the rounding of coordinates
    all_boxes = boxes[0].min(axis=0, initial=np.inf), boxes[1].max(axis=0, initial=-np.inf)
    rim = 2 * WALL_RIM * (np.abs(lowest) + np.abs(highest) + highest - lowest).max(initial=0.0)
    is_near = ((highest >= all_boxes[0] - rim) & (lowest <= all_boxes[1] + rim)).all(axis=1)
    corners, lowest, highest = corners[is_near], lowest[is_near], highest[is_near]
    owners = (np.zeros(len(rows), dtype=np.int64) for rows in (points, corners))
    of_lines, of_triangles = owners
    for _, line, k in joins(of_lines, boxes, of_triangles, (lowest, highest), np.array([rim])):
        hit, t = _line_through(corners[k], points[line], normals[line])
        yield line[hit], t[hit]


def _line_through(corners: Array, x: Array, n: Array) -> tuple[Mask, Array]:
    """Mask of triangles through which the line x + t n passes, and the parameter t, shape (m,)."""
    p, q, r = corners.transpose(1, 0, 2)
    # Moeller and Trumbore 1997: t and the barycentric weights of q and r by Cramer's rule
    edge_q, edge_r = q - p, r - p
    normal = cross(edge_q, edge_r)
    determinant = -np.einsum("ij,ij->i", normal, n)
    divisor = np.where(determinant == 0, np.inf, determinant)
    offset = x - p
    offset_cross_n = cross(offset, n)
    share_q = np.einsum("ij,ij->i", edge_r, offset_cross_n) / divisor
    share_r = -np.einsum("ij,ij->i", edge_q, offset_cross_n) / divisor
    t = np.einsum("ij,ij->i", offset, normal) / divisor
    inside = (share_q >= -WALL_RIM) & (share_r >= -WALL_RIM) & (share_q + share_r <= 1 + WALL_RIM)
    return inside & (determinant != 0), t
