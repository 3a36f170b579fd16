"""Overlaps of opposing facets, as convex polygons with the gap at their corners.

For facets i of part a and j of part b with outward normals n_i and n_j, the normal of the contact
is n = (n_i - n_j) / |n_i - n_j|, from a to b. In a frame at the centroid of the smaller facet the
height of each facet over the plane of n is affine, and so is the gap

    gap(u, v) = h_j(u, v) - h_i(u, v).

The gap is evaluated at the corners of the overlap itself: the offsets of the planes from a far
origin would lose the digits that decide. Faces touch if the range of gaps meets [-tolerance,
tolerance]; the whole overlap is then kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Rows, across, angle_between, counted
from kilter.assembly.geometry import Geometry
from kilter.contact.planar.facets import Facets
from kilter.contact.planar.polygons import clip_convex, overlay, padded, polygon_area

__all__ = ["FacetFrame", "Pieces", "facet_frames", "overlaps_of"]


MANY_TRIANGLES = 32
"""Number of triangles above which overlaps of non-convex facets are computed from outlines."""
BATCH = 2_000_000
"""Number of values in a padded batch; a larger value needs more memory."""


@dataclass(frozen=True, slots=True, eq=False)
class FacetFrame(Rows):
    """Common plane of two facing facets, with axes, and the height of both facets over it.

    `pair` is the row of the pair of parts, `i` and `j` are the facets, `u`, `v` and `normal` the
    unit axes at `origin`, `angle` the angle between the facets [rad]. The height of facet k (0: i,
    1: j) over the plane of the frame is ``height[:, k] + slope[:, k] . (u, v)``.
    """

    pair: Index
    i: Index
    j: Index
    origin: Array
    u: Array
    v: Array
    normal: Array
    angle: Array
    height: Array
    slope: Array

    def flat(self, points: Array, rows: Index) -> Array:
        """Coordinates (u, v) of points, shape (n, m, 3), in the planes `rows`, shape (n, m, 2)."""
        local = points - self.origin[rows][:, None, :]
        return np.stack(
            [
                np.einsum("nki,ni->nk", local, self.u[rows]),
                np.einsum("nki,ni->nk", local, self.v[rows]),
            ],
            axis=2,
        )

    def gaps(self, flat: Array, rows: Index) -> Array:
        """Gap between both facets over points (u, v) of the planes [length unit], shape (n, m)."""
        offset = (self.height[:, 1] - self.height[:, 0])[rows]
        slope = (self.slope[:, 1] - self.slope[:, 0])[rows]
        result: Array = offset[:, None] + np.einsum("nki,ni->nk", flat, slope)
        return result

    def middle(self, flat: Array, rows: Index) -> Array:
        """Points half-way between both facets over points (u, v) of the planes, shape (n, m, 3)."""
        height = self.height.mean(axis=1)[rows][:, None]
        height = height + np.einsum("nki,ni->nk", flat, self.slope.mean(axis=1)[rows])
        middle: Array = (
            self.origin[rows][:, None, :]
            + flat[..., :1] * self.u[rows][:, None, :]
            + flat[..., 1:] * self.v[rows][:, None, :]
            + height[..., None] * self.normal[rows][:, None, :]
        )
        return middle


@dataclass(frozen=True, slots=True, eq=False)
class Pieces(Rows):
    """Convex polygons into which the overlaps of facets are divided, a row for each polygon.

    `frame` is the row of the `FacetFrame`; `points`, shape (n, m, 2), are corners in its plane,
    padded to `count`; `area` is the area, and `gap`, shape (n, 2), the least and greatest gap.
    """

    frame: Index
    points: Array
    count: Index
    area: Array
    gap: Array


@dataclass(frozen=True, slots=True, eq=False)
class _ConvexPieces:
    """Division of all facets into convex polygons, in the order of the facets.

    `vertices`, shape (V, 3), are the points, `corners` rows of them; piece k has the `count[k]`
    corners from ``corners[first[k]]`` on.
    """

    vertices: Array
    corners: Index
    first: Index
    count: Index

    def points(self, which: Index) -> Array:
        """Corners of the polygons `which`, shape (n, m, 3), padded to equal length."""
        rows = padded(self.corners, self.first[which], self.count[which])
        points: Array = self.vertices[rows]
        return points


def facet_frames(facets: Facets, pair: Index, i: Index, j: Index, margin: Array) -> FacetFrame:
    """Common planes of facing facets that come within `margin` of each other."""
    n_i, n_j = facets.normal[i], facets.normal[j]
    total = n_i - n_j
    normal = total / np.linalg.norm(total, axis=1)[:, None]
    smaller = np.where(facets.reach[i] <= facets.reach[j], i, j)
    origin = facets.origin[smaller]
    # the gap at the origin first: it excludes most candidates
    heights = []
    for facet, n in ((i, n_i), (j, n_j)):
        height_over = np.einsum("ij,ij->i", n, origin - facets.origin[facet])
        heights.append(-height_over / np.einsum("ij,ij->i", n, normal))
    height = np.column_stack(heights)
    angle = angle_between(n_i, -n_j)
    near = (
        np.abs(height[:, 1] - height[:, 0]) <= margin + 1.01 * np.tan(angle) * facets.reach[smaller]
    )
    # 1.01: margin for the rounding of the reach
    distance = np.linalg.norm(facets.origin[i] - facets.origin[j], axis=1)
    near &= distance <= (facets.reach[i] + facets.reach[j]) * 1.01 + margin
    keep = np.flatnonzero(near)
    normal, n_i, n_j = normal[keep], n_i[keep], n_j[keep]
    u, v = across(normal)
    slopes = []
    for n in (n_i, n_j):
        along = np.einsum("ij,ij->i", n, normal)
        tangent = np.column_stack([np.einsum("ij,ij->i", n, u), np.einsum("ij,ij->i", n, v)])
        slopes.append(-tangent / along[:, None])
    return FacetFrame(
        pair=pair[keep],
        i=i[keep],
        j=j[keep],
        origin=origin[keep],
        u=u,
        v=v,
        normal=normal,
        angle=angle[keep],
        height=height[keep],
        slope=np.stack(slopes, axis=1),
    )


def overlaps_of(geometry: Geometry, facets: Facets, frames: FacetFrame) -> list[Pieces]:
    """Overlap of the two facets at each common plane, as blocks of convex polygons."""
    triangles = np.where(facets.convex, 0, np.diff(facets.corner_start) // 3)
    intricate = np.maximum(triangles[frames.i], triangles[frames.j]) > MANY_TRIANGLES
    simple = np.flatnonzero(~intricate)
    row, a, b = _piece_products(facets, frames, simple)
    pieces = _pieces_of(geometry, facets)
    blocks = []
    largest = np.maximum(pieces.count[a], pieces.count[b])
    # similar corner counts in each batch: little padding
    for low, high in ((0, 4), (4, 8), (8, 32), (32, 1 << 62)):
        rows_of_size = np.flatnonzero((largest > low) & (largest <= high))
        if not len(rows_of_size):
            continue
        width = int(largest[rows_of_size].max())
        step = max(1, BATCH // (4 * width))
        for begin in range(0, len(rows_of_size), step):
            rows = rows_of_size[begin : begin + step]
            blocks.append(_intersect_pieces(frames, pieces, row[rows], a[rows], b[rows]))
    blocks.extend(_intersect_outlines(geometry, facets, frames, np.flatnonzero(intricate)))
    return [block for block in blocks if len(block.frame)]


def _pieces_of(geometry: Geometry, facets: Facets) -> _ConvexPieces:
    """Divide all facets into convex polygons: convex facets stay whole, others give triangles."""
    length = np.diff(facets.corner_start)
    number = np.where(facets.convex, 1, length // 3)
    owner, k = counted(number)
    first = facets.corner_start[owner] + 3 * k
    count = np.where(facets.convex[owner], length[owner], 3)
    return _ConvexPieces(geometry.vertices, facets.corners, first, count)


def _piece_products(facets: Facets, frames: FacetFrame, rows: Index) -> tuple[Index, Index, Index]:
    """Pairs of convex polygons of both facets, for each plane: (plane, polygon, polygon)."""
    number = np.where(facets.convex, 1, np.diff(facets.corner_start) // 3)
    first = np.cumsum(number) - number
    i, j = frames.i[rows], frames.j[rows]
    total = number[i] * number[j]
    row, k = counted(total)
    width = number[j][row]
    return rows[row], first[i][row] + k // width, first[j][row] + k % width


def _intersect_pieces(
    frames: FacetFrame, pieces: _ConvexPieces, row: Index, a: Index, b: Index
) -> Pieces:
    """Intersect convex polygons `a` with `b` in the common plane of their facets."""
    flat_a = frames.flat(pieces.points(a), row)
    # facet j faces the other way: its corners run clockwise in the frame
    flat_b = _reverse_corners(frames.flat(pieces.points(b), row), pieces.count[b])
    meets = (flat_a.min(axis=1) <= flat_b.max(axis=1)).all(axis=1)
    meets &= (flat_b.min(axis=1) <= flat_a.max(axis=1)).all(axis=1)
    keep = np.flatnonzero(meets)
    row = row[keep]
    count_a, count_b = pieces.count[a][keep], pieces.count[b][keep]
    points, count = clip_convex(flat_a[keep], count_a, flat_b[keep], count_b)
    area = polygon_area(points, count)
    rows = np.flatnonzero((count >= 3) & (area > 0))
    return _with_gaps(frames, row[rows], points[rows], count[rows], area[rows])


def _reverse_corners(points: Array, count: Index) -> Array:
    """Padded polygons with their corners in reverse order."""
    k = np.arange(points.shape[1])
    back = np.where(k < count[:, None], count[:, None] - 1 - k, 0)
    result: Array = points[np.arange(len(points))[:, None], back]
    return result


def _with_gaps(frames: FacetFrame, row: Index, points: Array, count: Index, area: Array) -> Pieces:
    """Convex polygons with the least and greatest gap between both facets over their corners."""
    gaps = frames.gaps(points, row)
    is_corner = np.arange(points.shape[1]) < count[:, None]
    low = np.where(is_corner, gaps, np.inf).min(axis=1, initial=np.inf)
    high = np.where(is_corner, gaps, -np.inf).max(axis=1, initial=-np.inf)
    return Pieces(row, points, count, area, np.column_stack([low, high]))


def _intersect_outlines(
    geometry: Geometry, facets: Facets, frames: FacetFrame, rows: Index
) -> list[Pieces]:
    """Convex hulls of the overlaps of facets with many triangles, from the facets' outlines."""
    blocks = []
    for row in rows:
        single_row = np.array([row])
        outlines = []
        for facet in (frames.i[row], frames.j[row]):
            span = slice(facets.corner_start[facet], facets.corner_start[facet + 1])
            flat = frames.flat(geometry.vertices[facets.corners[span]][None], single_row)[0]
            outlines.append((flat, bool(facets.convex[facet])))
        hull, area = overlay(outlines[0], outlines[1])
        if len(hull) >= 3 and area > 0:
            blocks.append(
                _with_gaps(frames, single_row, hull[None], np.array([len(hull)]), np.array([area]))
            )
    return blocks
