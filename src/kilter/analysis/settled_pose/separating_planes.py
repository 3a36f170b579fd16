"""Points of convex parts without opposed faces: the plane that separates two parts best.

The plane is that of a face of either part, or lies across two edges. The corners of the other part
near the plane are its points. A point carries force if it is a corner over the inside of the face,
or the crossing of two edges; the other points only keep the parts apart.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.settled_pose.settle_tolerances import COINCIDES, SLENDER
from kilter.arrays import Array, Index, Mask, distinct_rows
from kilter.assembly.geometry import Geometry
from kilter.contact.common.distances import segment_distance
from kilter.contact.common.facets import Facets

__all__ = ["separating_points"]

Columns = tuple[Index, Index, Array, Array, Array, Mask]
"""Part a, part b, point, normal, gap, and whether it carries force."""


def separating_points(
    geometry: Geometry, facets: Facets, pairs: Index, reach: float
) -> Columns | None:
    """Points of pairs of convex parts with flat faces, shape (n, 2); None without points."""
    blocks = [_points_of(geometry, facets, (int(a), int(b)), reach) for a, b in pairs]
    found = [block for block in blocks if block is not None]
    if not found:
        return None
    a, b, point, normal, gap, bears = (
        np.concatenate([block[k] for block in found]) for k in range(6)
    )
    return a, b, point, normal, gap, bears


def _points_of(
    geometry: Geometry, facets: Facets, parts: tuple[int, int], reach: float
) -> Columns | None:
    """Points of a pair of parts at the plane that separates it best."""
    own = [_corners(geometry, part) for part in parts]
    spans = [slice(facets.start[part], facets.start[part + 1]) for part in parts]
    normals = np.concatenate([facets.normal[spans[0]], -facets.normal[spans[1]]])
    number = len(normals)
    top, low = (normals @ own[0].T).max(axis=1), (normals @ own[1].T).min(axis=1)
    if (low - top).max() > reach:
        return None
    edges = [_edges(geometry, facets, part) for part in parts]
    across = np.cross(
        (edges[0][1] - edges[0][0])[:, None], (edges[1][1] - edges[1][0])[None]
    ).reshape(-1, 3)
    length = np.linalg.norm(across, axis=1)
    sound = length > SLENDER * float(geometry.size[list(parts)].prod())
    directions = distinct_rows((across[sound] / length[sound, None]).round(9))[0]
    normals = np.concatenate([normals, directions, -directions])
    top, low = (normals @ own[0].T).max(axis=1), (normals @ own[1].T).min(axis=1)
    # a face is preferred to a plane across edges that separates equally well
    k = int(np.argmax(low - top - np.where(np.arange(len(normals)) < number, 0.0, 1e-12 * reach)))
    n, gap = normals[k], float(low[k] - top[k])
    if abs(gap) > reach:
        return None
    if k >= number:
        return _edge_point(edges, parts, n, gap, own)
    face = k < spans[0].stop - spans[0].start
    corners = own[1] if face else own[0]
    height = corners @ n - top[k] if face else low[k] - corners @ n
    rows = height < max(gap, 0.0) + reach
    points = corners[rows]
    other = spans[0] if face else spans[1]
    row = k if face else k - (spans[0].stop - spans[0].start)
    bears = _over_face(facets, other, row, points, COINCIDES * geometry.size[list(parts)].min())
    return _columns(parts, points, np.tile(n, (len(points), 1)), height[rows], bears)


def _columns(
    parts: tuple[int, int], point: Array, normal: Array, gap: Array, bears: Mask
) -> Columns:
    """Columns of points of a single pair."""
    count = len(point)
    return np.full(count, parts[0]), np.full(count, parts[1]), point, normal, gap, bears


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]


def _edges(geometry: Geometry, facets: Facets, part: int) -> tuple[Array, Array]:
    """Ends of the edges of a convex part, each edge once for each direction of travel."""
    begin, end = [], []
    for facet in range(facets.start[part], facets.start[part + 1]):
        loop = facets.corners[facets.corner_start[facet] : facets.corner_start[facet + 1]]
        begin.append(loop)
        end.append(np.roll(loop, -1))
    ends = np.sort(np.column_stack([np.concatenate(begin), np.concatenate(end)]), axis=1)
    ends = distinct_rows(ends)[0]
    return geometry.vertices[ends[:, 0]], geometry.vertices[ends[:, 1]]


def _over_face(facets: Facets, span: slice, row: int, points: Array, slack: float) -> Mask:
    """Mask of points that lie inside the planes of all other faces of a convex part."""
    height = np.einsum(
        "kfi,fi->kf", points[:, None, :] - facets.origin[span][None], facets.normal[span]
    )
    height[:, row] = -np.inf
    inside: Mask = height.max(axis=1) <= -slack
    return inside


def _edge_point(
    edges: list[tuple[Array, Array]],
    parts: tuple[int, int],
    n: Array,
    gap: float,
    own: list[Array],
) -> Columns:
    """The point at which two edges cross, at the plane with the normal n across both."""
    slack = COINCIDES * float(np.ptp(own[0], axis=0).max() + np.ptp(own[1], axis=0).max())
    near = []
    for (p, q), corners, sign in zip(edges, own, (1.0, -1.0), strict=True):
        most = (sign * (corners @ n)).max()
        at = (sign * (p @ n) >= most - slack) & (sign * (q @ n) >= most - slack)
        near.append((p[at], q[at]))
    if not (len(near[0][0]) and len(near[1][0])):
        corner = own[1][np.argmin(own[1] @ n)]
        return _columns(parts, corner[None], n[None], np.array([gap]), np.zeros(1, dtype=bool))
    i, j = (x.ravel() for x in np.indices((len(near[0][0]), len(near[1][0]))))
    p1, q1, p2, q2 = near[0][0][i], near[0][1][i], near[1][0][j], near[1][1][j]
    apart, on_a, on_b = segment_distance(p1, q1, p2, q2)
    k = int(np.argmin(apart))
    ends = (on_a[k] - p1[k], on_a[k] - q1[k], on_b[k] - p2[k], on_b[k] - q2[k])
    inner = min(float(np.linalg.norm(end)) for end in ends) > slack
    middle = (on_a[k] + on_b[k]) / 2
    return _columns(parts, middle[None], n[None], np.array([gap]), np.array([inner]))
