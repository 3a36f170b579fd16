"""Whether two faces that reach into each other have material behind them there.

Where faces i and j of two parts lie on the wrong side of each other by d along a normal n, part i
begins at d/2 and is behind, part j begins at -d/2 and is before. They share the stretch

    from max(-d/2, where i ends behind its face)   to min(d/2, where j ends before its face)

of the line, if there is one: two shells on one axis, the inner of which has the outer's hole
around it, share nothing, though a shaft of the one's radius would fill the other's hole.
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
    """The longest stretch that two parts share on lines through points [length unit]; 0: none.

    Parameters
    ----------
    geometry : Geometry
    parts : pair of int
        The part whose outward normals these are, and the other.
    points, normals : ndarray, shape (n, 3)
        Half-way between the faces.
    depth : ndarray, shape (n,)
        How far they reach into each other; lines of no depth are left out [length unit].
    """
    slack = float(geometry.slack[list(parts)].max())
    best = 0.0
    for x, n, d in zip(points, normals, depth.tolist(), strict=True):
        if d <= 0:
            continue
        behind = _crossings(geometry, parts[0], x, n)
        before = _crossings(geometry, parts[1], x, n)
        low = max(-d / 2, float(behind[behind < d / 2 - slack].max(initial=-np.inf)))
        high = min(d / 2, float(before[before > slack - d / 2].min(initial=np.inf)))
        best = max(best, high - low)
    return best


def _crossings(geometry: Geometry, part: int, x: Array, n: Array) -> Array:
    """Where the line x + t n passes through triangles of a part, values of t."""
    span = slice(int(geometry.triangle_start[part]), int(geometry.triangle_start[part + 1]))
    p, q, r = geometry.vertices[geometry.triangles[span]].transpose(1, 0, 2)
    # Moeller and Trumbore 1997: t, and the shares of q and r, from one determinant
    one, other = q - p, r - p
    normal = cross(one, other)
    bottom = -(normal @ n)
    safe = np.where(bottom == 0, np.inf, bottom)
    to = x - p
    turned = cross(to, np.broadcast_to(n, to.shape))
    share = np.einsum("ij,ij->i", other, turned) / safe, -np.einsum("ij,ij->i", one, turned) / safe
    t = np.einsum("ij,ij->i", to, normal) / safe
    met = (share[0] >= -WALL_RIM) & (share[1] >= -WALL_RIM) & (share[0] + share[1] <= 1 + WALL_RIM)
    result: Array = t[met & (bottom != 0)]
    return result
