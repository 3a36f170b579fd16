"""Polygons in the plane, and the overlaps of opposing facets with the gap at their corners.

`clip_convex` is Sutherland-Hodgman clipping on padded arrays: polygon k of a batch has `count[k]`
corners, anticlockwise, in ``points[k, :count[k]]``. Entries after the count have no meaning.

For facets i of part a and j of part b with outward normals n_i and n_j, the normal of the contact
is n = (n_i - n_j) / |n_i - n_j|, from a to b. In a frame at the centroid of the smaller facet the
height of each facet over the plane of n is affine, and so is the gap

    gap(u, v) = h_j(u, v) - h_i(u, v).

The gap is evaluated at the corners of the overlap itself: the offsets of the planes from a far
origin would lose the digits that decide. Faces touch if the range of gaps meets [-tolerance,
tolerance]; the whole overlap is then kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index, Mask, Rows, across, angle_between, counted, extents
from kilter.assembly.geometry import Geometry
from kilter.contact.common.facets import Facets
from kilter.contact.contact_tolerances import FACET_FLATNESS, OUTLINE_AREA, OUTLINE_GRID

if TYPE_CHECKING:
    import shapely


Scalar = TypeVar("Scalar", bound=np.generic)


def padded(points: NDArray[Scalar], first: Index, count: Index) -> NDArray[Scalar]:
    """Rows of `points` in groups, padded to equal length, shape (n, m, d).

    Run k has the rows ``first[k]`` to ``first[k] + count[k]``.

    Shorter runs are padded with their last row.
    """
    k = np.minimum(np.arange(int(count.max(initial=1))), np.maximum(count, 1)[:, None] - 1)
    taken: NDArray[Scalar] = points[first[:, None] + k]
    return taken


def clip_convex(
    subject: Array, subject_count: Index, clip: Array, clip_count: Index
) -> tuple[Array, Index]:
    """The intersection of each subject polygon with its convex clip polygon.

    Returns `count`, shape (n,): number of corners; 0: no intersection.

    Examples
    --------
    >>> square = np.array([[[0., 0], [2, 0], [2, 2], [0, 2]]])
    >>> points, count = clip_convex(square, np.array([4]), square + 1, np.array([4]))
    >>> float(polygon_area(points, count)[0])
    1.0
    """
    points, count = subject, subject_count
    for k in range(int(clip_count.max(initial=0))):
        rows = np.flatnonzero((k < clip_count) & (count > 0))
        if not len(rows):
            break
        start = clip[rows, k]
        end = clip[rows, np.where(k + 1 < clip_count[rows], k + 1, 0)]
        cut, left = _half_plane(points[rows], count[rows], start, end - start)
        if len(rows) == len(points):
            points, count = cut, left
        else:
            width = max(points.shape[1], cut.shape[1])
            points = np.pad(points, ((0, 0), (0, width - points.shape[1]), (0, 0)))
            points[rows, : cut.shape[1]] = cut
            count = count.copy()
            count[rows] = left
    return points, count


def cut_convex(corners: Array, above: Array) -> Array:
    """The part of a convex polygon in which a linear function is not negative.

    `corners`, shape (n, d): in order around the polygon; columns after the first two are values of
    further linear functions, which are interpolated.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> cut_convex(square, square[:, 0] - 1).tolist()
    [[1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0]]
    """
    following = np.roll(above, -1)
    crosses = (above >= 0) != (following >= 0)
    share = np.where(crosses, above / np.where(crosses, above - following, 1.0), 0.0)
    cut = corners + share[:, None] * (np.roll(corners, -1, axis=0) - corners)
    keep = np.column_stack([above >= 0, crosses]).ravel()
    result: Array = np.stack([corners, cut], axis=1).reshape(-1, corners.shape[1])[keep]
    return result


def _half_plane(points: Array, count: Index, start: Array, along: Array) -> tuple[Array, Index]:
    """Cut convex polygons at the lines ``start + t along``, and keep the side to the left."""
    rows, width = len(points), points.shape[1]
    k = np.arange(width)
    is_corner = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    side = along[:, None, 0] * (points[..., 1] - start[:, None, 1]) - along[:, None, 1] * (
        points[..., 0] - start[:, None, 0]
    )
    lines = np.arange(rows)[:, None]
    next_side = side[lines, after]
    inside = is_corner & (side >= 0)
    crosses = is_corner & ((side >= 0) != (next_side >= 0))
    if not crosses.any() and bool((inside == is_corner).all()):  # nothing to cut
        return points, count
    with np.errstate(divide="ignore", invalid="ignore"):
        t = side / (side - next_side)
    t = np.where(crosses, t, 0.0)
    crossing = points + t[..., None] * (points[lines, after] - points)
    keep = np.stack([inside, crosses], axis=2).reshape(rows, 2 * width)
    corners_and_crossings = np.stack([points, crossing], axis=2).reshape(rows, 2 * width, 2)
    position = np.cumsum(keep, axis=1) - 1
    new_count: Index = position[:, -1] + 1
    result = np.zeros((rows, max(int(new_count.max()), 1), 2))
    kept_positions = np.nonzero(keep)
    result[kept_positions[0], position[kept_positions]] = corners_and_crossings[kept_positions]
    return result, new_count


def polygon_area(points: Array, count: Index) -> Array:
    """Signed area of each polygon, positive if anticlockwise, shape (n,)."""
    k = np.arange(points.shape[1])
    real = k < count[:, None]
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    local = points - points[:, :1]  # avoids cancellation far from the origin
    following = local[np.arange(len(points))[:, None], after]
    cross = local[..., 0] * following[..., 1] - local[..., 1] * following[..., 0]
    area: Array = 0.5 * np.where(real, cross, 0.0).sum(axis=1)
    return area


def tidy(points: Array, count: Index, tolerance: Array) -> tuple[Array, Index]:
    """Remove repeated corners of polygons, and corners on straight sides.

    The order of the two passes matters: in a single pass two near-duplicates at a corner would each
    look like a point on a line, and the corner would be lost.
    """
    points, count = _select_corners(points, count, ~_near_next(points, count, tolerance))
    for _ in range(4):
        straight = _on_chord(points, count, tolerance)
        straight[:, 1:] &= ~straight[:, :-1]  # two neighbours at once could remove a corner
        if not straight.any():
            break
        points, count = _select_corners(points, count, ~straight)
    return points, count


def _select_corners(points: Array, count: Index, keep: Mask) -> tuple[Array, Index]:
    """Padded polygons, reduced to the corners that the mask `keep` selects."""
    keep = keep & (np.arange(points.shape[1]) < count[:, None])
    position = np.cumsum(keep, axis=1) - 1
    new_count: Index = position[:, -1] + 1
    result = np.zeros((len(points), max(int(new_count.max(initial=1)), 1), points.shape[2]))
    kept_positions = np.nonzero(keep)
    result[kept_positions[0], position[kept_positions]] = points[kept_positions]
    return result, new_count


def _near_next(points: Array, count: Index, tolerance: Array) -> Mask:
    """Mask of corners that lie within `tolerance` of the next corner."""
    k = np.arange(points.shape[1])
    after = np.where(k + 1 < count[:, None], k + 1, 0)
    step = points[np.arange(len(points))[:, None], after] - points
    near: Mask = np.linalg.norm(step, axis=2) <= tolerance[:, None]
    near &= count[:, None] > 1
    return near


def _on_chord(points: Array, count: Index, tolerance: Array) -> Mask:
    """Mask of corners that lie within `tolerance` of the line between both neighbours."""
    k = np.arange(points.shape[1])
    rows = np.arange(len(points))[:, None]
    after = points[rows, np.where(k + 1 < count[:, None], k + 1, 0)]
    before = points[rows, np.where(k > 0, k - 1, count[:, None] - 1)]
    chord, arm = after - before, points - before
    cross = chord[..., 0] * arm[..., 1] - chord[..., 1] * arm[..., 0]
    length = np.linalg.norm(chord, axis=2)
    near: Mask = np.abs(cross) <= tolerance[:, None] * np.maximum(length, tolerance[:, None])
    near &= (k < count[:, None]) & (count[:, None] > 2)
    return near


# hulls and outlines -----------------------------------------------------------------------


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull of points in the plane, anticlockwise, shape (m, 2).

    Points on a line have a hull of two corners.

    Examples
    --------
    >>> convex_hull(np.array([[0., 0], [1, 0], [.5, .5], [1, 1], [0, 1]])).tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    import shapely

    hull: Array = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(points)))
    if len(hull) <= 2:  # a point or a segment, not a closed ring
        return np.unique(hull, axis=0)
    hull = hull[-2::-1]  # GEOS runs clockwise and repeats the first corner
    return np.roll(hull, -int(np.lexsort((hull[:, 1], hull[:, 0]))[0]), axis=0)


def width_of(hull: Array) -> float:
    """Least width of a convex polygon in any direction [length unit].

    Examples
    --------
    >>> width_of(np.array([[0., 0], [4, 0], [4, 1], [0, 1]]))
    1.0
    """
    edge = np.roll(hull, -1, axis=0) - hull
    length = np.linalg.norm(edge, axis=1)
    keep = length > 0
    if not keep.any():
        return 0.0
    edge, start = edge[keep] / length[keep][:, None], hull[keep]
    apart = hull[None] - start[:, None]
    across = np.abs(edge[:, None, 0] * apart[..., 1] - edge[:, None, 1] * apart[..., 0])
    return float(across.max(axis=1).min())


def overlay(first: shapely.Geometry, second: shapely.Geometry) -> tuple[Array, float]:
    """Convex hull, shape (m, 2), and area of the overlap of two regions.

    GEOS may return an overlap for triangles with disjoint interiors. So the overlap is computed
    twice, directly and on a fine grid; if the areas differ, the result on the grid is used.
    """
    import shapely

    size = float(np.ptp(shapely.get_coordinates([first, second]), axis=0).max())
    gridded = shapely.intersection(first, second, grid_size=OUTLINE_GRID * size)
    common = shapely.intersection(first, second)
    least = min(first.area, second.area)
    if not common.is_valid or abs(common.area - gridded.area) > OUTLINE_AREA * least:
        common = gridded
    polygons = [p for p in shapely.get_parts(common) if p.geom_type == "Polygon"]
    if not polygons:
        return np.empty((0, 2)), 0.0
    return convex_hull(shapely.get_coordinates(polygons)), float(sum(p.area for p in polygons))


def _region(points: Array, index: Index, convex: bool) -> shapely.Geometry:
    """The shapely region of a convex polygon, or of the union of triangles (not `convex`).

    `index`: rows of `points`, shape (1, m) for a polygon, (n, 3) for triangles.
    """
    import shapely

    if convex:
        return shapely.Polygon(points[index[0]])
    triangles = points[index]
    start = index.reshape(-1)
    end = np.roll(index, -1, axis=1).reshape(-1)
    is_shared = np.isin(start * len(points) + end, end * len(points) + start)
    edges = np.stack([points[start[~is_shared]], points[end[~is_shared]]], axis=1)
    region = shapely.build_area(shapely.multilinestrings(shapely.linestrings(edges)))
    triangle_area = 0.5 * np.abs(
        (triangles[:, 1, 0] - triangles[:, 0, 0]) * (triangles[:, 2, 1] - triangles[:, 0, 1])
        - (triangles[:, 1, 1] - triangles[:, 0, 1]) * (triangles[:, 2, 0] - triangles[:, 0, 0])
    )
    # boundaries that touch themselves confuse build_area: unite the triangles instead
    if (
        region is None
        or abs(region.area - triangle_area.sum()) > OUTLINE_AREA * triangle_area.sum()
    ):
        grid = OUTLINE_GRID * np.ptp(points)
        region = shapely.union_all(shapely.polygons(triangles), grid_size=grid)
    return region


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
    row, a, b = _piece_products(facets, frames, np.flatnonzero(~intricate))
    blocks = []
    pieces = _pieces_of(geometry, facets)
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
    index = NearTriangles(geometry, facets)
    for intricate_row in np.flatnonzero(intricate).tolist():
        blocks.extend(_intersect_outlines(index, frames, intricate_row))
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


@dataclass(slots=True, eq=False)
class NearTriangles:
    """Triangles of facets that may lie over or under another facet, by their boxes.

    A plate with hundreds of holes has thousands of triangles, of which few lie beside a small part.
    """

    geometry: Geometry
    facets: Facets
    boxes: dict[int, tuple[Array, Array]] = field(default_factory=dict)
    """Lower and upper corners of the boxes of the convex polygons of facets, shape (n, 3) each."""

    def corners(self, facet: int) -> Index:
        """Vertices of the convex polygons of a facet, shape (n, m)."""
        span = slice(self.facets.corner_start[facet], self.facets.corner_start[facet + 1])
        corners: Index = self.facets.corners[span]
        return corners[None] if self.facets.convex[facet] else corners.reshape(-1, 3)

    def between(self, frames: FacetFrame, row: int) -> tuple[Index, Index]:
        """Polygons of both facets of a common plane that may overlap, by their numbers.

        Points of both facets at the same place of the plane differ by the gap along the normal, and
        by the distances of their corners from their planes.
        """
        both = [int(frames.i[row]), int(frames.j[row])]
        slope = np.linalg.norm(frames.slope[row, 1] - frames.slope[row, 0])
        gap = abs(frames.height[row, 1] - frames.height[row, 0])
        gap += slope * self.facets.reach[both].min()
        uneven = 2 * FACET_FLATNESS * self.geometry.size[self.facets.part[both]].sum()
        grow = gap * np.abs(frames.normal[row]) + uneven
        (low_i, high_i), (low_j, high_j) = map(self._boxes_of, both)
        bound = low_j.min(axis=0) - grow, high_j.max(axis=0) + grow
        near_i = np.flatnonzero(((low_i <= bound[1]) & (high_i >= bound[0])).all(axis=1))
        if not len(near_i):
            return near_i, near_i
        bound = low_i[near_i].min(axis=0) - grow, high_i[near_i].max(axis=0) + grow
        return near_i, np.flatnonzero(((low_j <= bound[1]) & (high_j >= bound[0])).all(axis=1))

    def _boxes_of(self, facet: int) -> tuple[Array, Array]:
        if facet not in self.boxes:
            self.boxes[facet] = extents(self.geometry.vertices[self.corners(facet)])
        return self.boxes[facet]


def _intersect_outlines(index: NearTriangles, frames: FacetFrame, row: int) -> list[Pieces]:
    """Convex hull of the overlap of facets with many triangles, from the outlines of near ones."""
    single_row, near = np.array([row]), index.between(frames, row)
    if not min(len(kept) for kept in near):
        return []
    regions = []
    for facet, kept in zip((int(frames.i[row]), int(frames.j[row])), near, strict=True):
        names, corners = np.unique(index.corners(facet)[kept], return_inverse=True)
        flat = frames.flat(index.geometry.vertices[names][None], single_row)[0]
        regions.append(_region(flat, corners.reshape(len(kept), -1), index.facets.convex[facet]))
    hull, area = overlay(*regions)
    if len(hull) < 3 or area <= 0:
        return []
    count = np.array([len(hull)])
    return [_with_gaps(frames, single_row, hull[None], count, np.array([area]))]
