"""Smooth faces: connected triangles with small bends, and the surface that they approximate.

In a mesh these are all triangles on no known surface, in an exact solid its free forms. The corners
of a tessellated face lie on the face itself. At each corner a cubic

    z = a x + b y + (second and third order),   z along the mean of the triangles' normals,

through the corner and fitted to those around it gives the normal (-a, -b, 1). Its difference from
the normal of the fit of second order estimates its error. Within a triangle the surface is the
quadratic patch with the normals at the corners,

    s(p) = p + 1/2 sum_k b_k ((v_k - p).n_k) n_k,   b the barycentric coordinates of p,

and the distance of the triangle from it is at most |(v_k - v_m).(n_k - n_m)| / 6.

References
----------
Fits of jets: F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting
of osculating jets, 2005. The quadratic patch: T. Boubekeur, M. Alexa, Phong tessellation, 2008.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    across,
    angle_between,
    connected,
    cross,
    group_sums,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.contact_tolerances import (
    FIT_CUT,
    FIT_REGULAR,
    SMOOTH_BEND,
    SMOOTH_DOUBT,
    SMOOTH_EDGE,
)
from kilter.shape.closed import shared_edges

__all__ = ["SmoothFace", "smooth_faces"]


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
    """A smooth face of a meshed part; world frame. Its normals are fitted when they are needed.

    Attributes
    ----------
    part : int
    triangles : ndarray of int, shape (m, 3)
        Corners, as rows of `points`.
    rows : ndarray of int, shape (m,)
        Rows of the geometry's triangles.
    points : ndarray, shape (n, 3)
        Corners.
    triangle_normals : ndarray, shape (m, 3)
        Unit normals of the triangles.
    rim : ndarray of int, shape (k, 2)
        Corners of the edges that have a triangle of the face on one side only.
    """

    part: int
    triangles: Index
    rows: Index
    points: Array
    triangle_normals: Array
    rim: Index

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lower and upper corner of the bounding box of the corners, shape (3,)."""
        return self.points.min(axis=0), self.points.max(axis=0)

    @cached_property
    def triangle_boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the bounding boxes of the triangles, shape (m, 3)."""
        corners = self.points[self.triangles]
        return corners.min(axis=1), corners.max(axis=1)

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
