"""First fits of growing surfaces, for many seed facets at once.

A surface grows from a seed facet and two or three of its neighbours. In a mesh of a free form
nearly all such starts fail: no surface contains their corners, or no further facet lies on it.
This module finds these starts with arrays, and they are left out. `kilter.shape.recognition` fits
the others again, each alone. So the tolerances here are wider by `ROUGHLY`, and no fit here decides
that a surface exists.

The methods are those of `kilter.shape.fitting`, with a leading axis for the starts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    across,
    columns,
    counted,
    cross,
    group_sums,
    ragged,
    ratio,
    starts,
    unit_rows,
)
from kilter.shape.fitting import FITS, STEPS
from kilter.shape.round_region import FacetMesh, gather_rows
from kilter.shape.shape_tolerances import (
    FACET_NORMAL,
    FIT_RANK,
    GROWING,
    LARGEST_RATIO,
    NARROWEST_CONE,
    ROUGHLY,
    STEP_RANK,
    SURFACE_FIT,
    WIDEST_CONE,
)

MOST_NEIGHBOURS = 12
"""Largest number of neighbours of a seed that are tried."""
TRIED = 2
"""Number of pairs of neighbours that are tried at a seed, and of facets that complete a sphere."""
MOST_CORNERS = 64
"""Largest number of corners of a start that is fitted here [-]; larger starts are all kept."""
KINDS = tuple(FITS)
CYLINDER, CONE, SPHERE = (KINDS.index(kind) for kind in ("cylinder", "cone", "sphere"))


@dataclass(frozen=True, slots=True, eq=False)
class _Starts(Rows):
    """Starts of surfaces: seed facet, number of the kind, and first facets (-1: no facet)."""

    seed: Index = columns()
    kind: Index = columns()
    facets: Index = columns(4)


@dataclass(slots=True, eq=False)
class FirstFits:
    """The starts from which a surface may grow, by seed facet; computed on request."""

    mesh: FacetMesh
    is_known: Mask = field(init=False)
    """Whether the starts of each facet are computed, shape (F,)."""
    _middles: Array = field(init=False)
    _starts: dict[int, list[tuple[str, Index]]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        graph = self.mesh.graph
        count = len(graph.area)
        middles = self.mesh.vertices[self.mesh.triangles].mean(axis=1)
        triangles = np.bincount(graph.facet, minlength=count)[:, None]
        self._middles = group_sums(graph.facet, middles, count) / triangles
        self.is_known = np.zeros(count, dtype=bool)

    def compute(self, seeds: Index, free: Mask) -> None:
        """Compute the starts of seed facets; `free` marks facets that no surface has taken."""
        self.is_known[seeds] = True
        for seed in seeds.tolist():
            self._starts.pop(seed, None)
        tried = _possible_starts(self.mesh, seeds, free)
        hopeful = tried.take(_may_grow(self.mesh, self._middles, tried, free))
        for seed, kind, facets in zip(
            hopeful.seed.tolist(), hopeful.kind.tolist(), hopeful.facets, strict=True
        ):
            start = facets[facets >= 0]
            self._starts.setdefault(seed, []).append((KINDS[kind], start))

    def of(self, seed: int) -> list[tuple[str, Index]]:
        """Kinds of surface that may grow from a seed, each with the facets for its first fit."""
        return self._starts.get(seed, [])

    def forget(self, facets: Index) -> None:
        """Forget the starts at neighbours of facets that a surface has taken."""
        self.is_known[gather_rows(facets, self.mesh.graph.first, self.mesh.graph.neighbours)] = (
            False
        )


def _possible_starts(mesh: FacetMesh, seeds: Index, free: Mask) -> _Starts:
    """Starts at seed facets, in the order in which they are tried.

    The first facets are the seed and two neighbours on opposite sides; a sphere needs a third
    neighbour.
    """
    graph = mesh.graph
    owner, rows = ragged(graph.first, seeds)
    is_free = free[graph.neighbours[rows]]
    owner, near = owner[is_free], graph.neighbours[rows][is_free]
    count = np.bincount(owner, minlength=len(seeds))
    place = counted(count)[1]
    kept = place < MOST_NEIGHBOURS
    table = np.full((len(seeds), MOST_NEIGHBOURS), -1)
    table[owner[kept], place[kept]] = near[kept]
    normal = graph.normal[seeds][:, None]
    bend = unit_rows(graph.normal[table] - normal)
    # the normals of the two neighbours along a band differ from the seed's in opposite senses,
    # and the three normals are coplanar
    out_of_plane = np.abs((cross(bend[:, :, None], bend[:, None]) * normal[:, None]).sum(axis=-1))
    is_opposite = (bend @ bend.transpose(0, 2, 1) < 0) & (table >= 0)[:, None]
    is_opposite &= np.triu(np.ones((MOST_NEIGHBOURS, MOST_NEIGHBOURS), dtype=bool), 1)
    out_of_plane = np.where(is_opposite, out_of_plane, np.inf).reshape(len(seeds), -1)
    row = np.arange(len(seeds))
    blocks = []
    columns_of = np.arange(MOST_NEIGHBOURS)
    for number in range(TRIED):
        best = out_of_plane.argmin(axis=1)
        exists = np.isfinite(out_of_plane[row, best])
        out_of_plane[row, best] = np.inf
        g, h = np.divmod(best, MOST_NEIGHBOURS)
        is_other = (table >= 0) & (columns_of != g[:, None]) & (columns_of != h[:, None])
        three = np.column_stack([seeds, table[row, g], table[row, h]])
        for step, kind in enumerate((CYLINDER, CONE, *[SPHERE] * TRIED)):
            fourth, valid = np.full(len(seeds), -1), exists
            if kind == SPHERE:
                other = is_other.argmax(axis=1)
                fourth, valid = table[row, other], exists & is_other.any(axis=1)
                is_other[row, other] = False
            sequence = row * (TRIED * (TRIED + 2)) + number * (TRIED + 2) + step
            kinds = np.full(len(seeds), kind)
            block = _Starts(seeds, kinds, np.column_stack([three, fourth])).take(valid)
            blocks.append((sequence[valid], block))
    order = np.argsort(np.concatenate([sequence for sequence, _ in blocks]))
    return _Starts.join([block for _, block in blocks]).take(order)


# fits -----------------------------------------------------------------------------------

_State = tuple[Array, Array, Array]
"""Points, axes, and radii or half angles of n surfaces: shapes (n, 3), (n, 3), (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Corners(Rows):
    """Distinct corners of the first facets of n starts; entries of zero weight fill the arrays."""

    p: Array
    """Corners relative to their mean [sizes], shape (n, P, 3); zero where there is none."""
    real: Array
    """1 for a corner, 0 for a filling entry, shape (n, P)."""
    middle: Array
    size: Array
    """Mean of the corners, and their largest coordinate relative to it [length unit], shape (n,
    3)."""
    within: Array
    """Largest distance at which a corner counts as on a surface [length unit], shape (n,)."""
    normals: Array
    weights: Array
    """Unit normals of the first facets, and their areas, shape (n, 4, 3); zero where there is
    none."""


def _may_grow(mesh: FacetMesh, middles: Array, tried: _Starts, free: Mask) -> Mask:
    """Mask of the starts that lie on a surface together with a further facet."""
    may_grow = np.ones(len(tried), dtype=bool)
    start, corner = _distinct_corners(mesh, tried.facets)
    count = np.diff(start)
    # arrays of similar length hold few filling entries
    widths = [2**k for k in range(3, MOST_CORNERS.bit_length())]
    for low, high in pairwise([0, *widths]):
        for kind in (CYLINDER, CONE, SPHERE):
            rows = np.flatnonzero((count > low) & (count <= high) & (tried.kind == kind))
            if len(rows):
                corners = _corners(mesh, tried.facets[rows], start, corner, rows)
                state, is_fitted = FIT_MANY[kind](corners)
                surfaces = _Grown(mesh, middles, kind, state, ROUGHLY * corners.within)
                fits = np.flatnonzero(is_fitted)
                fits = fits[surfaces.contain_first(fits, tried.facets[rows[fits]])]
                may_grow[rows] = False
                may_grow[rows[fits[surfaces.reach_next(fits, tried.facets[rows[fits]], free)]]] = (
                    True
                )
    return may_grow


def _distinct_corners(mesh: FacetMesh, facets: Index) -> tuple[Index, Index]:
    """Distinct vertices of each row of facets, shape (m, 4): starts of the rows, and vertices."""
    row, place = np.nonzero(facets >= 0)
    triangles, owner = mesh.corners(facets[row, place])
    count = len(mesh.vertices)
    key = np.unique(row[owner][:, None] * count + mesh.triangles[triangles])
    return starts(np.bincount(key // count, minlength=len(facets))), key % count


def _corners(mesh: FacetMesh, facets: Index, start: Index, corner: Index, rows: Index) -> _Corners:
    """The corners of some starts; `start`, `corner`: the result of `_distinct_corners`."""
    owner, entry = ragged(start, rows)
    count = start[rows + 1] - start[rows]
    place = counted(count)[1]
    points = mesh.vertices[corner[entry]]
    middle = group_sums(owner, points, len(rows)) / count[:, None]
    shape = len(rows), int(count.max())
    real, p = np.zeros(shape), np.zeros((*shape, 3))
    real[owner, place] = 1.0
    p[owner, place] = points - middle[owner]
    size = np.abs(p).max(axis=(1, 2))
    spread = (p.max(axis=1) - p.min(axis=1)).max(axis=1)  # the mean, zero, lies between
    exists = facets >= 0
    return _Corners(
        p=ratio(p, size[:, None, None]),
        real=real,
        middle=middle,
        size=size,
        within=np.maximum(mesh.graph.tolerance, SURFACE_FIT * spread),
        normals=np.where(exists[..., None], mesh.graph.normal[facets], 0.0),
        weights=np.where(exists, mesh.graph.area[facets], 0.0),
    )


def _fit_spheres(corners: _Corners) -> tuple[_State, Mask]:
    """Fit spheres; the state in the world frame, and a mask of valid fits."""
    p, real = corners.p, corners.real
    matrix = np.concatenate([2 * p, real[..., None]], axis=2)
    solution, rank = _least_squares(matrix, (p * p).sum(axis=2))
    square = solution[:, 3] + (solution[:, :3] ** 2).sum(axis=1)
    good = (rank == 4) & (square > 0) & (square < LARGEST_RATIO**2)
    radius = np.sqrt(np.maximum(square, 0.0))
    return _in_world(corners, solution[:, :3], np.zeros_like(corners.middle), radius, SPHERE), good


def _fit_cylinders(corners: _Corners) -> tuple[_State, Mask]:
    """Fit cylinders; the state in the world frame, and a mask of valid fits."""
    p, real = corners.p, corners.real
    weighted = corners.normals * corners.weights[..., None]
    axis = np.linalg.eigh(weighted.transpose(0, 2, 1) @ corners.normals)[1][:, :, 0]
    u, v = across(axis)
    x, y = _dot(p, u), _dot(p, v)
    solution, rank = _least_squares(np.stack([2 * x, 2 * y, real], axis=2), x * x + y * y)
    square = solution[:, 2] + solution[:, 0] ** 2 + solution[:, 1] ** 2
    good = (real.sum(axis=1) >= 5) & (rank == 3) & (square > 0) & (square < LARGEST_RATIO**2)
    center = solution[:, :1] * u + solution[:, 1:2] * v
    radius = np.sqrt(np.maximum(square, 0.0))
    center, axis, radius = _gauss_newton(corners, (center, axis, radius), CYLINDER, good)
    good &= (radius > 0) & (radius < LARGEST_RATIO)
    return _in_world(corners, center, axis, radius, CYLINDER), good


def _fit_cones(corners: _Corners) -> tuple[_State, Mask]:
    """Fit cones; the state in the world frame, and a mask of valid fits."""
    p, real, weights = corners.p, corners.real, corners.weights[..., None]
    mean = (corners.normals * weights).sum(axis=1) / weights.sum(axis=1)
    spread = corners.normals - mean[:, None]
    axis = np.linalg.eigh((spread * weights).transpose(0, 2, 1) @ spread)[1][:, :, 0]
    u, v = across(axis)
    x, y, z = _dot(p, u), _dot(p, v), _dot(p, axis)
    matrix = np.stack([2 * x, 2 * y, z * z, z, real], axis=2)
    solution, _ = _least_squares(matrix, x * x + y * y)
    aside = np.hypot(x - solution[:, :1], y - solution[:, 1:2]) * real
    line, _ = _least_squares(np.stack([z, real], axis=2), aside)
    slope, offset = line.T
    good = (real.sum(axis=1) >= 6) & (np.abs(slope) >= NARROWEST_CONE)
    steep = np.where(good, slope, 1.0)
    apex = solution[:, :1] * u + solution[:, 1:2] * v - (offset / steep)[:, None] * axis
    axis = axis * np.sign(steep)[:, None]
    apex, axis, angle = _gauss_newton(corners, (apex, axis, np.arctan(np.abs(steep))), CONE, good)
    good &= (angle > NARROWEST_CONE) & (angle < WIDEST_CONE)
    good &= np.abs(apex).max(axis=1) <= LARGEST_RATIO
    return _in_world(corners, apex, axis, angle, CONE), good


FIT_MANY = {CYLINDER: _fit_cylinders, CONE: _fit_cones, SPHERE: _fit_spheres}
"""Fit of many surfaces of each kind."""


def _dot(p: Array, axis: Array) -> Array:
    """Products of points, shape (n, P, 3), with the vector of their row, shape (n, 3)."""
    product: Array = (p @ axis[:, :, None])[..., 0]
    return product


def _in_world(corners: _Corners, point: Array, axis: Array, value: Array, kind: int) -> _State:
    """Surfaces in lengths of their corners, moved to the frame of the mesh."""
    scale = 1.0 if kind == CONE else corners.size
    return corners.middle + point * corners.size[:, None], axis, value * scale


def _least_squares(matrix: Array, right: Array) -> tuple[Array, Index]:
    """Least-norm solutions of n least-squares problems, and the ranks of their matrices.

    Shapes: `matrix` (n, P, k), `right` (n, P), solutions (n, k), ranks (n,).
    """
    u, s, vt = np.linalg.svd(matrix, full_matrices=False)
    is_large = s > FIT_RANK * s[:, :1]
    inverse = np.where(is_large, 1.0 / np.where(is_large, s, 1.0), 0.0)
    part = (u.transpose(0, 2, 1) @ right[..., None])[..., 0] * inverse
    return (vt.transpose(0, 2, 1) @ part[..., None])[..., 0], is_large.sum(axis=1)


def _gauss_newton(corners: _Corners, state: _State, kind: int, good: Mask) -> _State:
    """Gauss-Newton steps of n fits, as in `kilter.shape.fitting`; only for the fits `good`."""
    point, axis, value = (array.copy() for array in state)
    rows = np.flatnonzero(good)
    p, real = corners.p[rows], corners.real[rows]
    off, jacobian = _residuals(p, real, (point[rows], axis[rows], value[rows]), kind)
    best = (off * off).sum(axis=1)
    for _ in range(STEPS):
        if not len(rows):
            break
        now_point, now_axis, now_value = point[rows], axis[rows], value[rows]
        step = _normal_step(jacobian, off)
        u, v = across(now_axis)
        last = step.shape[1] - 1
        shift = step[:, :1] * u + step[:, 1:2] * v
        if kind == CONE:
            shift = shift + step[:, 2:3] * now_axis
        turned = unit_rows(
            now_axis + step[:, last - 2 : last - 1] * u + step[:, last - 1 : last] * v
        )
        trial = now_point + shift, turned, now_value + step[:, last]
        off, jacobian = _residuals(p, real, trial, kind)
        square = (off * off).sum(axis=1)
        better = square < best
        for array, new in zip((point, axis, value), trial, strict=True):
            array[rows[better]] = new[better]
        goes_on = better & (square <= 0.5 * best)
        rows, p, real, best = rows[goes_on], p[goes_on], real[goes_on], square[goes_on]
        off, jacobian = off[goes_on], jacobian[goes_on]
    return point, axis, value


def _normal_step(jacobian: Array, off: Array) -> Array:
    """Gauss-Newton steps from the normal equations, shape (n, k)."""
    transposed = jacobian.transpose(0, 2, 1)
    values, vectors = np.linalg.eigh(transposed @ jacobian)
    is_large = values > STEP_RANK * values[:, -1:]
    inverse = np.where(is_large, 1.0 / np.where(is_large, values, 1.0), 0.0)
    right = vectors.transpose(0, 2, 1) @ (transposed @ off[..., None])
    step: Array = -(vectors @ (right * inverse[..., None]))[..., 0]
    return step


def _residuals(p: Array, real: Array, state: _State, kind: int) -> tuple[Array, Array]:
    """Signed distances of points from their surface, (n, P), and derivatives, (n, P, k)."""
    point, axis, value = state
    u, v = across(axis)
    relative = p - point[:, None]
    along = _dot(relative, axis)
    away = relative - along[..., None] * axis[:, None]
    aside = np.sqrt((away * away).sum(axis=2))
    e = ratio(away, aside[..., None])
    eu, ev = _dot(e, u), _dot(e, v)
    if kind == CYLINDER:
        off = aside - value[:, None]
        terms = [-eu, -ev, -eu * along, -ev * along, -np.ones_like(eu)]
    else:
        cos, sin = np.cos(value)[:, None], np.sin(value)[:, None]
        off = aside * cos - along * sin
        side = along * cos + aside * sin
        terms = [-eu * cos, -ev * cos, sin + 0 * eu, -eu * side, -ev * side, -side]
    return off * real, np.stack(terms, axis=2) * real[..., None]


# facets on surfaces ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Grown:
    """Surfaces of a kind that were fitted to the first facets of starts."""

    mesh: FacetMesh
    middles: Array
    """Mean of the middles of the triangles of each facet, shape (F, 3)."""
    kind: int
    state: _State
    within: Array
    """Largest distance of a corner of a first facet [length unit], shape (n,)."""

    def contain_first(self, rows: Index, facets: Index) -> Mask:
        """Mask of the surfaces `rows` that contain their first facets, shape (m, 4)."""
        row, place = np.nonzero(facets >= 0)
        owner = rows[row]
        on = self._contain(owner, facets[row, place], self.within[owner])
        contains: Mask = np.bincount(row[~on], minlength=len(rows)) == 0
        return contains

    def reach_next(self, rows: Index, facets: Index, free: Mask) -> Mask:
        """Mask of the surfaces `rows` on which a free neighbour of their first facets lies."""
        graph = self.mesh.graph
        row, place = np.nonzero(facets >= 0)
        owner, entry = ragged(graph.first, facets[row, place])
        near, owner = graph.neighbours[entry], row[owner]
        is_next = free[near] & (near[:, None] != facets[owner]).all(axis=1)
        near, owner = near[is_next], owner[is_next]
        on = self._contain(rows[owner], near, GROWING * self.within[rows[owner]])
        reaches: Mask = np.bincount(owner[on], minlength=len(rows)) > 0
        return reaches

    def _contain(self, owner: Index, facets: Index, within: Array) -> Mask:
        """Mask of facets that lie on surface `owner`, within a distance, with a similar normal."""
        _, away = self._distance(owner, self.middles[facets])
        cosine = (away * self.mesh.graph.normal[facets]).sum(axis=1)
        length = np.sqrt((away * away).sum(axis=1))
        contained: Mask = np.abs(cosine) >= np.cos(ROUGHLY * FACET_NORMAL) * length
        left = np.flatnonzero(contained)
        triangles, which = self.mesh.corners(facets[left])
        corners = self.mesh.vertices[self.mesh.triangles[triangles]].reshape(-1, 3)
        off, _ = self._distance(np.repeat(owner[left][which], 3), corners)
        far = np.abs(off).reshape(-1, 3).max(axis=1) > within[left][which]
        contained[left[which[far]]] = False
        return contained

    def _distance(self, owner: Index, points: Array) -> tuple[Array, Array]:
        """Signed distance of each point from surface `owner`, and its gradient of any length."""
        point, axis, value = (array[owner] for array in self.state)
        relative = points - point
        if self.kind == SPHERE:
            return np.linalg.norm(relative, axis=1) - value, relative
        along = (relative * axis).sum(axis=1)
        away = relative - along[:, None] * axis
        aside = np.linalg.norm(away, axis=1)
        if self.kind == CYLINDER:
            return aside - value, away
        cos, sin = np.cos(value), np.sin(value)
        gradient = ratio(away, aside[:, None]) * cos[:, None] - axis * sin[:, None]
        return aside * cos - along * sin, gradient
