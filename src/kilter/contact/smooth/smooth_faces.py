"""Smooth faces: triangles that bend into each other, and the surface they stand for.

Of a mesh they are all that lie on no known surface, of an exact solid its free forms. The corners
of a tessellated face lie on the face itself. At each corner a cubic

    z = a x + b y + (second and third order),   z along the mean of the triangles' normals,

through the corner and fitted to those around it gives the normal (-a, -b, 1). How far it is
from that of the fit of second order is how well it is known. Within a triangle the surface is
the quadratic one that has the normals at the corners,

    s(p) = p + 1/2 sum_k b_k ((v_k - p).n_k) n_k,   b the barycentric coordinates of p,

and the triangle lies off it by up to |(v_k - v_m).(n_k - n_m)| / 6.

References
----------
Fits of jets: F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting
of osculating jets, 2005. The quadratic patch: T. Boubekeur, M. Alexa, Phong tessellation, 2008.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, connected, cross, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.contact_tolerances import (
    FIT_CUT,
    SMOOTH_BEND,
    SMOOTH_DOUBT,
    SMOOTH_EDGE,
)
from kilter.shape.closed import shared_edges

__all__ = ["SmoothFace", "smooth_faces"]


FEWEST = 16
"""Triangles of a smooth face, at least."""
AROUND = 24
"""Corners that a fit looks at, at most."""
SIDES_AWAY = 3
"""A fit looks at corners up to so many sides of triangles away."""
HUB = 3 * AROUND
"""Corners of more sides than this are hubs of fans, across which a fit does not look."""
CUBIC = 13
"""A fit of third order needs this many corners, one of second order 6."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothFace:
    """A smooth face of a part; world frame.

    Attributes
    ----------
    part : int
    triangles : ndarray of int, shape (m, 3)
        Rows of `points`.
    rows : ndarray of int, shape (m,)
        Rows of the geometry's triangles.
    points, normals : ndarray, shape (n, 3)
        Corners and fitted unit normals there, out of the material.
    doubt : ndarray, shape (n,)
        How well the normals are known [rad].
    rim : ndarray of int, shape (k, 2)
        Edges with a triangle of the face on one side only, by corners.
    sagitta : float
        Greatest distance of a triangle from the surface [length unit].
    """

    part: int
    triangles: Index
    rows: Index
    points: Array
    normals: Array
    doubt: Array
    rim: Index
    sagitta: float


def smooth_faces(geometry: Geometry, part: int, *, mesh: bool) -> list[SmoothFace]:
    """The smooth faces of a part without those of a known surface; of a solid, its free forms."""
    first, last = geometry.triangle_start[part], geometry.triangle_start[part + 1]
    label = geometry.triangle_surface[first:last]
    chosen = label < 0
    if not mesh:
        chosen = ~chosen
        chosen[chosen] = geometry.surfaces.kind[label[chosen]] == FREE
    rows = np.arange(first, last)[chosen]
    if len(rows) < FEWEST:
        return []
    corners = geometry.vertices[geometry.triangles[rows]]
    normal = unit_rows(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    edge, its = shared_edges(geometry.triangles[rows])
    one, other = edge // 3, its // 3
    sine = np.linalg.norm(cross(normal[one], normal[other]), axis=1)
    bend = np.arctan2(sine, np.einsum("ij,ij->i", normal[one], normal[other]))
    smooth = bend < SMOOTH_EDGE
    label = connected(len(rows), one[smooth], other[smooth])
    bent = smooth & (bend > SMOOTH_BEND)
    number = np.bincount(label[one[bent]], minlength=int(label.max()) + 1)
    inner = np.zeros(3 * len(rows), dtype=bool)
    inner[edge[smooth]] = inner[its[smooth]] = True
    found = []
    for name in np.flatnonzero((number >= FEWEST // 2) & (np.bincount(label) >= FEWEST)):
        mine = np.flatnonzero(label == name)
        found.append(_face(geometry, part, rows[mine], normal[mine], inner.reshape(-1, 3)[mine]))
    return found


def _face(geometry: Geometry, part: int, rows: Index, normal: Array, inner: Mask) -> SmoothFace:
    """A smooth face of some triangles, with the half-edges that lie inside it."""
    used, local = np.unique(geometry.triangles[rows], return_inverse=True)
    triangles = local.reshape(-1, 3)
    points = geometry.vertices[used]
    near, there = _around(points, triangles)
    normals, doubt = _fitted(points, near, there, *_mean_normals(points, triangles, normal))
    half = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2)
    step = np.roll(points[triangles], -1, axis=1) - points[triangles]
    turn = np.roll(normals[triangles], -1, axis=1) - normals[triangles]
    return SmoothFace(
        part=part,
        triangles=triangles,
        rows=rows,
        points=points,
        normals=normals,
        doubt=doubt,
        rim=half[~inner],
        sagitta=float(np.abs(np.einsum("nki,nki->nk", step, turn)).max() / 6),
    )


def _mean_normals(points: Array, triangles: Index, normal: Array) -> tuple[Array, Array]:
    """Mean normals at corners, by angle; and how far those around bend from theirs [rad].

    Of a corner and those beside it: a corner of one flat facet alone lies on a bent face too.
    """
    corners = points[triangles]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    sine = np.linalg.norm(np.cross(after, before), axis=2)
    angle = np.arctan2(sine, np.einsum("nki,nki->nk", after, before))
    total = np.zeros((len(points), 3))
    np.add.at(total, triangles, angle[..., None] * normal[:, None])
    mean = unit_rows(total)
    off = np.linalg.norm(mean[triangles] - normal[:, None], axis=2)
    bend = np.zeros(len(points))
    np.maximum.at(bend, triangles, off)
    around = np.zeros(len(points))
    np.maximum.at(around, triangles, bend[triangles].max(axis=1)[:, None])
    return mean, around


def _around(points: Array, triangles: Index) -> tuple[Index, Mask]:
    """The corners around each, itself first, (n, AROUND), and which of the entries are any.

    Those up to `SIDES_AWAY` sides away, the fewest first, of as many the nearest. Of a tall
    prism that is its other rim too, where the nearest alone are far along the one.
    """
    from scipy.sparse import coo_array, csr_array  # most assemblies need none, and it takes time

    n = len(points)
    start = np.concatenate([triangles.ravel(), triangles.ravel(), np.arange(n)])
    end = np.concatenate([np.roll(triangles, 1, 1).ravel(), np.roll(triangles, 2, 1).ravel()])
    beside = csr_array(coo_array((np.ones(len(start)), (start, np.append(end, np.arange(n))))))
    beside.data[:] = 1.0
    # what goes on from a corner; from the hub of a fan nothing does
    onward = beside.copy()
    onward.data[np.repeat(np.diff(beside.indptr) > HUB, np.diff(beside.indptr))] = 0.0
    reached, fewest = beside, beside.copy()
    for _ in range(1, SIDES_AWAY):
        reached = reached @ onward
        reached.data[:] = reached.data > 0
        fewest = fewest + reached
    found = fewest.tocoo()
    row, other = found.row[found.data > 0], found.col[found.data > 0]
    far = np.linalg.norm(points[other] - points[row], axis=1)
    order = np.lexsort((other, far, -found.data[found.data > 0], row))
    row, other = row[order], other[order]
    place = np.arange(len(row)) - np.searchsorted(row, row)
    kept = place < AROUND
    near = np.tile(np.arange(n)[:, None], AROUND)
    near[row[kept], place[kept]] = other[kept]
    there = np.arange(AROUND) < np.bincount(row, minlength=n)[:, None]
    return near, there


def _fitted(
    points: Array, near: Index, there: Mask, mean: Array, bend: Array
) -> tuple[Array, Array]:
    """Normals of cubics through the corners around each, and how well they are known."""
    apart = points[near] - points[:, None]
    u, v = across(mean)
    x, y, z = (np.einsum("nki,ni->nk", apart, w) for w in (u, v, mean))
    scale = np.sqrt((x**2 + y**2).max(axis=1))[:, None]
    x, y, z = x / scale, y / scale, z / scale
    alike = there & (np.einsum("nki,ni->nk", mean[near], mean) > 0.5)
    weight = np.where(alike, 1 / (0.05 + x**2 + y**2), 0.0)
    # with these factors the least coefficients are the same whichever way x and y lie: where
    # corners on two straight rims leave some open, as those of a prism do
    two, three = np.sqrt([2.0, 3.0])
    second = np.stack([x, y, x * x, two * x * y, y * y], axis=2)
    third = np.stack([x**3, three * x * x * y, three * x * y * y, y**3], axis=2)
    third[alike.sum(axis=1) < CUBIC] = 0.0
    rough = _slopes(second, z, weight)
    fine = _slopes(np.concatenate([second, third], axis=2), z, weight)
    normals = unit_rows(mean - fine[:, :1] * u - fine[:, 1:] * v)
    doubt = np.linalg.norm(fine - rough, axis=1)
    flat = bend <= SMOOTH_DOUBT  # a corner in a plane is known
    normals[flat], doubt[flat] = mean[flat], bend[flat]
    return normals, doubt


def _slopes(terms: Array, z: Array, weight: Array) -> Array:
    """The slopes a and b of weighted least squares, shape (n, 2)."""
    inverse = np.linalg.pinv(terms * weight[..., None], rcond=FIT_CUT)
    slopes: Array = np.einsum("nik,nk->ni", inverse[:, :2], z * weight)
    return slopes
