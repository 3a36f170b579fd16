"""Smooth faces: connected triangles with small bends, and the surface that they approximate.

In a mesh these are all triangles on no known surface, in an exact solid its free forms. The corners
of a tessellated face lie on the face itself. At each corner a cubic

    z = a x + b y + (second and third order),   z along the mean of the triangles' normals,

through the corner and fitted to those around it gives the normal (-a, -b, 1). Its difference from
the normal of the fit of second order estimates its error. Within a triangle the surface is the
quadratic patch with the normals at the corners,

    s(p) = p + 1/2 sum_k b_k ((v_k - p).n_k) n_k,   b the barycentric coordinates of p,

and the distance of the triangle from it is at most |(v_k - v_m).(n_k - n_m)| / 6.

A corner x of one face, with its normal n, is matched with the triangle of the other face that the
line x + t n meets nearest to x. The contact lies on the surface, not on the triangle: see
`kilter.contact.smooth.smooth_faces`. At a crossing of the rims of both faces the area of contact
has a corner; the normals there are interpolated between the ends of the two edges.

References
----------
Fits of jets: F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting
of osculating jets, 2005. The quadratic patch: T. Boubekeur, M. Alexa, Phong tessellation, 2008.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    across,
    angle_between,
    columns,
    connected,
    cross,
    extents,
    group_sums,
    ratio,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.common.broad import joins
from kilter.contact.common.distances import segment_distance
from kilter.contact.common.findings import Matches
from kilter.contact.contact_tolerances import (
    DISTANCE_ROUNDING,
    FIT_CUT,
    FIT_REGULAR,
    SMOOTH_ASIDE,
    SMOOTH_BEND,
    SMOOTH_DOUBT,
    SMOOTH_EDGE,
    SMOOTH_FACING,
)
from kilter.shape.closed import shared_edges

FEWEST = 16
"""Least number of triangles of a smooth face."""
AROUND = 24
"""Largest number of corners that a fit uses; more corners remove finer detail."""
SIDES_AWAY = 3
"""Largest distance of corners in a fit, in triangle sides."""
HUB = 3 * AROUND
"""Number of triangle sides at a corner above which a fit does not extend beyond it."""
CUBIC = 13
"""Least number of corners for a fit of third order; a fit of second order needs 6."""


@dataclass(frozen=True, eq=False)
class SmoothFace:
    """A smooth face of a meshed part; world frame. Its normals are fitted when they are needed."""

    part: int
    triangles: Index
    """Corners, as rows of `points`, shape (m, 3)."""
    rows: Index
    """Rows of the geometry's triangles, shape (m,)."""
    points: Array
    """Corners, shape (n, 3)."""
    triangle_normals: Array
    """Unit normals of the triangles, shape (m, 3)."""
    rim: Index
    """Corners of the edges that have a triangle of the face on one side only, shape (k, 2)."""

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lower and upper corner of the bounding box of the corners, shape (3,)."""
        return self.points.min(axis=0), self.points.max(axis=0)

    @cached_property
    def triangle_boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the bounding boxes of the triangles, shape (m, 3)."""
        return extents(self.points[self.triangles])

    @cached_property
    def triangle_balls(self) -> tuple[Array, Array]:
        """Middles of the triangles, shape (m, 3), and distances of their farthest corners, (m,)."""
        corners = self.points[self.triangles]
        middle = corners.mean(axis=1)
        return middle, np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)

    @cached_property
    def rim_boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the bounding boxes of the edges of the rim, shape (k, 3)."""
        ends = self.points[self.rim]
        return ends.min(axis=1), ends.max(axis=1)

    @cached_property
    def _fitted(self) -> tuple[Array, Array]:
        near, is_entry = _neighbourhoods(self.points, self.triangles)
        mean = _mean_normals(self.points, self.triangles, self.triangle_normals)
        return _fit_normals(self.points, near, is_entry, *mean)

    @property
    def normals(self) -> Array:
        """Fitted unit normals at the corners, out of the material, shape (n, 3)."""
        return self._fitted[0]

    @property
    def doubt(self) -> Array:
        """Error of the normals [rad], shape (n,)."""
        return self._fitted[1]

    @cached_property
    def sagitta(self) -> float:
        """Largest distance of a triangle from the surface [length unit]."""
        step = np.roll(self.points[self.triangles], -1, axis=1) - self.points[self.triangles]
        turn = np.roll(self.normals[self.triangles], -1, axis=1) - self.normals[self.triangles]
        return float(np.abs(np.einsum("nki,nki->nk", step, turn)).max() / 6)

    @cached_property
    def most_sagitta(self) -> float:
        """Upper bound on `sagitta` that needs no fit: two unit normals differ by 2 at most."""
        step = np.roll(self.points[self.triangles], -1, axis=1) - self.points[self.triangles]
        return float(np.linalg.norm(step, axis=2).max() / 3)


def smooth_faces(geometry: Geometry, part: int, *, mesh: bool) -> list[SmoothFace]:
    """The smooth faces of a part, except those on exact or recognised surfaces.

    In a mesh (`mesh`) these are all bent faces, in an exact solid only its free forms.
    """
    first, last = geometry.triangle_start[part], geometry.triangle_start[part + 1]
    label = geometry.triangle_surface[first:last]
    is_free = label < 0
    if not mesh:
        is_free = ~is_free
        is_free[is_free] = geometry.surfaces.kind[label[is_free]] == FREE
    rows = np.arange(first, last)[is_free]
    if len(rows) < FEWEST:
        return []
    corners = geometry.vertices[geometry.triangles[rows]]
    normal = unit_rows(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    edge, opposite_edge = shared_edges(geometry.triangles[rows])
    first_side, second_side = edge // 3, opposite_edge // 3
    bend = angle_between(normal[first_side], normal[second_side])
    smooth = bend < SMOOTH_EDGE
    label = connected(len(rows), first_side[smooth], second_side[smooth])
    bent = smooth & (bend > SMOOTH_BEND)
    bent_count = np.bincount(label[first_side[bent]], minlength=int(label.max()) + 1)
    inner = np.zeros(3 * len(rows), dtype=bool)
    inner[edge[smooth]] = inner[opposite_edge[smooth]] = True
    faces = []
    for face_label in np.flatnonzero((bent_count >= FEWEST // 2) & (np.bincount(label) >= FEWEST)):
        of_face = np.flatnonzero(label == face_label)
        faces.append(
            _build_face(
                geometry, part, rows[of_face], normal[of_face], inner.reshape(-1, 3)[of_face]
            )
        )
    return faces


def _build_face(
    geometry: Geometry, part: int, rows: Index, normal: Array, inner: Mask
) -> SmoothFace:
    """Build a smooth face of the given triangles; `inner` marks half-edges inside the face."""
    vertices, local = np.unique(geometry.triangles[rows], return_inverse=True)
    triangles = local.reshape(-1, 3)
    half = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2)
    return SmoothFace(part, triangles, rows, geometry.vertices[vertices], normal, half[~inner])


def _mean_normals(points: Array, triangles: Index, normal: Array) -> tuple[Array, Array]:
    """Angle-weighted mean normal at each corner, and the bend of the surface around it [rad].

    The bend is the largest over the corner and its neighbours: a corner inside a flat facet may
    still lie on a bent face.
    """
    corners = points[triangles]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    weighted = angle_between(after, before)[..., None] * normal[:, None]
    mean = unit_rows(group_sums(triangles.reshape(-1), weighted.reshape(-1, 3), len(points)))
    difference = np.linalg.norm(mean[triangles] - normal[:, None], axis=2)
    bend = np.zeros(len(points))
    np.maximum.at(bend, triangles, difference)
    bend_nearby = np.zeros(len(points))
    np.maximum.at(bend_nearby, triangles, bend[triangles].max(axis=1)[:, None])
    return mean, bend_nearby


def _neighbourhoods(points: Array, triangles: Index) -> tuple[Index, Mask]:
    """Corners near each corner, itself first, shape (n, AROUND), and a mask of real entries.

    Corners up to `SIDES_AWAY` sides away, in order of the number of sides, then of the distance.
    For a tall prism these include its other rim: the nearest corners alone would all lie on the
    same rim.
    """
    from scipy.sparse import coo_array, csr_array  # slow to import, and rarely needed

    n = len(points)
    start = np.concatenate([triangles.ravel(), triangles.ravel(), np.arange(n)])
    end = np.concatenate([np.roll(triangles, 1, 1).ravel(), np.roll(triangles, 2, 1).ravel()])
    beside = csr_array(coo_array((np.ones(len(start)), (start, np.append(end, np.arange(n))))))
    beside.data[:] = 1.0
    # steps onwards from a corner; the hub of a fan has none
    onward = beside.copy()
    onward.data[np.repeat(np.diff(beside.indptr) > HUB, np.diff(beside.indptr))] = 0.0
    reached, fewest = beside, beside.copy()
    for _ in range(1, SIDES_AWAY):
        reached = reached @ onward
        reached.data[:] = reached.data > 0
        fewest = fewest + reached
    entries = fewest.tocoo()
    row, neighbour = entries.row[entries.data > 0], entries.col[entries.data > 0]
    distance = np.linalg.norm(points[neighbour] - points[row], axis=1)
    order = np.lexsort((neighbour, distance, -entries.data[entries.data > 0], row))
    row, neighbour = row[order], neighbour[order]
    place = np.arange(len(row)) - np.searchsorted(row, row)
    is_kept = place < AROUND
    near = np.tile(np.arange(n)[:, None], AROUND)
    near[row[is_kept], place[is_kept]] = neighbour[is_kept]
    is_entry = np.arange(AROUND) < np.bincount(row, minlength=n)[:, None]
    return near, is_entry


def _fit_normals(
    points: Array, near: Index, is_entry: Mask, mean: Array, bend: Array
) -> tuple[Array, Array]:
    """Normals at corners, fitted by cubic surfaces through nearby corners, and the error [rad]."""
    apart = points[near] - points[:, None]
    u, v = across(mean)
    x, y, z = (np.einsum("nki,ni->nk", apart, w) for w in (u, v, mean))
    scale = np.sqrt((x**2 + y**2).max(axis=1))[:, None]
    x, y, z = x / scale, y / scale, z / scale
    alike = is_entry & (np.einsum("nki,ni->nk", mean[near], mean) > 0.5)
    weight = np.where(alike, 1 / (0.05 + x**2 + y**2), 0.0)
    # these factors make the least-norm solution independent of the direction of x and y, if the
    # corners, such as those on the two rims of a prism, leave coefficients undetermined
    two, three = np.sqrt([2.0, 3.0])
    second = np.stack([x, y, x * x, two * x * y, y * y], axis=2)
    third = np.stack([x**3, three * x * x * y, three * x * y * y, y**3], axis=2)
    third[alike.sum(axis=1) < CUBIC] = 0.0
    rough, fine = _slopes(np.concatenate([second, third], axis=2), z, weight, (5, 9))
    normals = unit_rows(mean - fine[:, :1] * u - fine[:, 1:] * v)
    doubt = np.linalg.norm(fine - rough, axis=1)
    is_planar = bend <= SMOOTH_DOUBT  # the normal of a corner in a plane is exact
    normals[is_planar], doubt[is_planar] = mean[is_planar], bend[is_planar]
    return normals, doubt


def _slopes(terms: Array, z: Array, weight: Array, counts: tuple[int, ...]) -> list[Array]:
    """Slopes a and b of weighted least-squares fits of the heights z, shape (n, 2) each.

    There is a fit with the first `count` terms for each count. A single QR factorisation serves
    all fits, since the triangle of the first terms is the corner of the triangle of all terms. A
    fit whose terms are nearly dependent needs the least-norm solution from singular values.
    """
    matrix, right = terms * weight[..., None], z * weight
    rows = np.concatenate([matrix, right[..., None]], axis=2)
    triangle = np.asarray(np.linalg.qr(rows, mode="r"))
    diagonal = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    fits = []
    for count in counts:
        sizes = diagonal[:, :count]
        is_regular = sizes.min(axis=1) > FIT_REGULAR * sizes.max(axis=1)
        slopes = np.empty((len(terms), 2))
        corner = triangle[is_regular, :count]
        slopes[is_regular] = np.linalg.solve(corner[..., :count], corner[..., -1:])[:, :2, 0]
        inverse = np.linalg.pinv(matrix[~is_regular, :, :count], rcond=FIT_CUT)
        slopes[~is_regular] = np.einsum("nik,nk->ni", inverse[:, :2], right[~is_regular])
        fits.append(slopes)
    return fits


def matches(first: SmoothFace, second: SmoothFace, reach: float, slack: float) -> Matches:
    """Contact points of two smooth faces, at most `reach` apart along the normals at the corners.

    `slack` is the distance that is allowed across the normals.
    """
    lateral = slack + SMOOTH_ASIDE * reach
    forward = _project_corners(first, second, reach, lateral)
    backward = _project_corners(second, first, reach, lateral)
    backward = replace(backward, normal=-backward.normal)
    return Matches.join([forward, backward, _rim_crossings(first, second, reach)])


def _project_corners(
    first: SmoothFace, second: SmoothFace, reach: float, lateral: float
) -> Matches:
    """Project the corners of a smooth face on another; return the contact points."""
    # a match lies within `lateral` of the piece of the line that is at most `reach` long
    half = np.abs(first.normals) * reach + lateral
    low, high = first.points - half, first.points + half
    blocks: list[tuple[Array, Index, Index, Array]] = []
    for corner, triangle in _meeting_boxes((low, high), second.triangle_boxes, 0.0):
        k, m = _near_lines(first, second, corner, triangle, lateral)
        corners = second.points[second.triangles[m]]
        share, height, miss = _line_hits(first.points[k], first.normals[k], corners)
        keep = (np.abs(height) <= reach) & (miss <= lateral)
        blocks.append((share[keep], k[keep], m[keep], (np.abs(height) + miss)[keep]))
    if not blocks:
        return Matches.none()
    share, k, m, distance = (np.concatenate([block[n] for block in blocks]) for n in range(4))
    # the nearest triangle of each corner
    order = np.lexsort((distance, k))
    order = order[np.unique(k[order], return_index=True)[1]]
    share, k, m = share[order], k[order], m[order]
    corner_points = _SurfacePoints(first.points, first.normals, first.doubt).take(k)
    return _match_sides(corner_points, _surface_points(second, m, share))


def _near_lines(
    first: SmoothFace, second: SmoothFace, k: Index, m: Index, lateral: float
) -> tuple[Index, Index]:
    """The pairs (corner, triangle) whose line through the corner may come near the triangle."""
    middle, radius = second.triangle_balls
    relative = middle[m] - first.points[k]
    off = cross(relative, first.normals[k])
    most = (radius[m] + lateral) * (1 + DISTANCE_ROUNDING)
    near = np.einsum("ij,ij->i", off, off) <= most**2
    return k[near], m[near]


_Boxes = tuple[Array, Array]
"""Lower and upper corners of boxes, shape (n, 3)."""


def _meeting_boxes(first: _Boxes, second: _Boxes, margin: float) -> Iterator[tuple[Index, Index]]:
    """Yield the pairs (row of first, row of second) of boxes at most `margin` apart, in blocks.

    Only boxes near the common box of the other boxes are compared with each other.
    """
    rows_a = _meeting_common(first, second, margin)
    first = first[0][rows_a], first[1][rows_a]
    rows_b = _meeting_common(second, first, margin)
    second = second[0][rows_b], second[1][rows_b]
    owners = [np.zeros(len(rows), dtype=np.int64) for rows in (rows_a, rows_b)]
    for _, x, y in joins(owners[0], first, owners[1], second, np.array([margin])):
        yield rows_a[x], rows_b[y]


def _meeting_common(boxes: _Boxes, others: _Boxes, margin: float) -> Index:
    """Rows of boxes at most `margin` from the common box of all other boxes."""
    if not len(others[0]):
        return np.empty(0, dtype=np.int64)
    low, high = others[0].min(axis=0) - margin, others[1].max(axis=0) + margin
    rows: Index = np.flatnonzero(((boxes[0] <= high) & (low <= boxes[1])).all(axis=1))
    return rows


def _line_hits(points: Array, normal: Array, corners: Array) -> tuple[Array, Array, Array]:
    """Points in which lines cross the planes of triangles.

    Returns `share`, shape (n, 3): barycentric coordinates of the nearest point inside the triangle;
    `height`, shape (n,): distance along the line; inf if the triangle does not face the line
    [length unit].
    """
    a, b, c = corners.transpose(1, 0, 2)
    plane = cross(b - a, c - a)
    slope = np.einsum("ij,ij->i", plane, normal)
    size = np.linalg.norm(plane, axis=1)
    steep = np.abs(slope) < 0.5 * size  # the triangle does not face the line
    height = np.einsum("ij,ij->i", plane, a - points) / np.where(steep, np.inf, slope)
    hit = points + height[:, None] * normal
    areas = [
        np.einsum("ij,ij->i", plane, cross(q - p, hit - p)) for p, q in ((b, c), (c, a), (a, b))
    ]
    share = np.column_stack(areas) / np.maximum(size, np.finfo(float).tiny)[:, None] ** 2
    inside = np.clip(share, 0, None)
    inside = inside / inside.sum(axis=1)[:, None]
    off = np.linalg.norm(hit - np.einsum("nk,nki->ni", inside, corners), axis=1)
    return inside, np.where(steep, np.inf, height), off


def _surface_points(face: SmoothFace, rows: Index, share: Array) -> _SurfacePoints:
    """Points, unit normals and errors on the true surface, from positions on the triangles."""
    used = face.triangles[rows]
    corners, normals = face.points[used], face.normals[used]
    flat = np.einsum("nk,nki->ni", share, corners)
    over = np.einsum("nki,nki->nk", corners - flat[:, None], normals)
    lift = np.einsum("nk,nki->ni", share * over, normals) / 2
    normal = unit_rows(np.einsum("nk,nki->ni", share, normals))
    return _SurfacePoints(flat + lift, normal, np.einsum("nk,nk->n", share, face.doubt[used]))


@dataclass(frozen=True, slots=True, eq=False)
class _SurfacePoints(Rows):
    """Points of a smooth surface, with unit normals and the error of the normals [rad]."""

    place: Array = columns(3)
    normal: Array = columns(3)
    doubt: Array = columns()


def _match_sides(first: _SurfacePoints, second: _SurfacePoints) -> Matches:
    """Contact points half-way between pairs of surface points with opposing normals."""
    normal = unit_rows(first.normal - second.normal)
    apart = np.linalg.norm(first.normal + second.normal, axis=1) / 2
    gap = np.einsum("ij,ij->i", second.place - first.place, normal)
    doubt = np.minimum(first.doubt, second.doubt)
    matched = Matches((first.place + second.place) / 2, normal, gap, apart, doubt)
    return matched.take(np.flatnonzero(apart <= SMOOTH_FACING))


def _rim_crossings(first: SmoothFace, second: SmoothFace, reach: float) -> Matches:
    """Contact points at which the outlines of two smooth faces cross."""
    blocks = [Matches.none()]
    for k, m in _meeting_boxes(first.rim_boxes, second.rim_boxes, reach):
        (p, q) = first.points[first.rim[k]].transpose(1, 0, 2)
        (r, s) = second.points[second.rim[m]].transpose(1, 0, 2)
        size = np.linalg.norm(q - p, axis=1) * np.linalg.norm(s - r, axis=1)
        is_crossing = np.linalg.norm(cross(q - p, s - r), axis=1) > SMOOTH_ASIDE * size
        k, m = k[is_crossing], m[is_crossing]
        p, q, r, s = p[is_crossing], q[is_crossing], r[is_crossing], s[is_crossing]
        inner = _cross_inside(p, q, r, s)
        k, m, p, q, r, s = k[inner], m[inner], p[inner], q[inner], r[inner], s[inner]
        distance, on_first, on_second = segment_distance(p, q, r, s)
        sides = []
        inside = distance <= reach
        for face, rim, crossing, start, end in (
            (first, k, on_first, p, q),
            (second, m, on_second, r, s),
        ):
            t = ratio(np.linalg.norm(crossing - start, axis=1), np.linalg.norm(end - start, axis=1))
            inside &= (t > SMOOTH_ASIDE) & (t < 1 - SMOOTH_ASIDE)
            low, high = face.rim[rim].T
            normal = (1 - t)[:, None] * face.normals[low] + t[:, None] * face.normals[high]
            doubt = (1 - t) * face.doubt[low] + t * face.doubt[high]
            sides.append(_SurfacePoints(crossing, unit_rows(normal), doubt))
        blocks.append(_match_sides(sides[0].take(inside), sides[1].take(inside)))
    return Matches.join(blocks)


def _cross_inside(p: Array, q: Array, r: Array, s: Array) -> Mask:
    """Mask of edges p q and r s whose lines come nearest to each other inside both edges.

    Otherwise the nearest points of the edges themselves include an end. The lines are far from
    parallel.
    """
    along, other, gap = q - p, s - r, r - p
    a, e, b, c, f = (
        np.einsum("ij,ij->i", x, y)
        for x, y in (
            (along, along),
            (other, other),
            (along, other),
            (along, gap),
            (other, gap),
        )
    )
    determinant = a * e - b * b
    t, u = c * e - b * f, b * c - a * f
    inside: Mask = (t > 0) & (t < determinant) & (u > 0) & (u < determinant)
    return inside
