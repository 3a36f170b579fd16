"""Depth to which the material behind two overlapping faces is shared.

Faces i and j of two parts overlap by d along a normal n: part i begins at d/2 and extends
backwards, part j begins at -d/2 and extends forwards. They share the interval

    from max(-d/2, the end of i behind its face)   to min(d/2, the end of j in front of its face)

of the line, if it is not empty. Two shells about the same axis, one inside the bore of the other,
share nothing, although the outer shell as a solid shaft would overlap the inner shell.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import WALL_RIM

__all__ = ["shared_depth"]


def shared_depth(
    geometry: Geometry, parts: tuple[int, int], points: Array, normals: Array, depth: Array
) -> float:
    """The longest interval that two parts share on lines through points [length unit]; 0: none.

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
    longest = 0.0
    for x, n, d in zip(points, normals, depth.tolist(), strict=True):
        if d <= 0:
            continue
        behind = _crossings(geometry, parts[0], x, n)
        before = _crossings(geometry, parts[1], x, n)
        low = max(-d / 2, float(behind[behind < d / 2 - slack].max(initial=-np.inf)))
        high = min(d / 2, float(before[before > slack - d / 2].min(initial=np.inf)))
        longest = max(longest, high - low)
    return longest


def _crossings(geometry: Geometry, part: int, x: Array, n: Array) -> Array:
    """Parameters t at which the line x + t n passes through triangles of a part, shape (k,)."""
    span = slice(int(geometry.triangle_start[part]), int(geometry.triangle_start[part + 1]))
    p, q, r = geometry.vertices[geometry.triangles[span]].transpose(1, 0, 2)
    # Moeller and Trumbore 1997: t and the barycentric weights of q and r by Cramer's rule
    edge_q, edge_r = q - p, r - p
    normal = cross(edge_q, edge_r)
    determinant = -(normal @ n)
    divisor = np.where(determinant == 0, np.inf, determinant)
    offset = x - p
    offset_cross_n = cross(offset, np.broadcast_to(n, offset.shape))
    share = (
        np.einsum("ij,ij->i", edge_r, offset_cross_n) / divisor,
        -np.einsum("ij,ij->i", edge_q, offset_cross_n) / divisor,
    )
    t = np.einsum("ij,ij->i", offset, normal) / divisor
    is_hit = (
        (share[0] >= -WALL_RIM) & (share[1] >= -WALL_RIM) & (share[0] + share[1] <= 1 + WALL_RIM)
    )
    result: Array = t[is_hit & (determinant != 0)]
    return result
