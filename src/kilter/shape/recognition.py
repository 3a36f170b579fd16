"""Recognise the cylinders, cones and spheres that a mesh approximates.

The corners of a tessellated face lie on the face itself. Facets that meet at shallow edges form a
region. A region is round if one surface contains all of its corners. If several faces meet without
an edge (a fillet and its flats), surfaces are grown facet by facet, from three neighbours.

**When is a prism round?** A bar with n equal flat sides and a coarse cylinder are the same mesh, so
a rule must decide. A region counts as round only if

- neighbouring facets meet at no more than 30.5 degrees: a prism with 12 equal sides or more is
  round, with 11 or fewer (hexagonal and octagonal bars, chamfered boxes) flat;
- it has at least 5 facets of different directions, so that a chamfer of 1 to 4 facets is flat;
- its corners lie on the surface within the accuracy of the coordinates, and are more than the
  parameters of the surface: a cone passes through any six points;
- no facet is more than twice as wide as most facets: the flat of a shaft is flat;
- it turns by at least 15 degrees, or has sharp edges all around: a short piece of another curve
  is close to an arc of a circle;
- its corners deviate from their best plane by far more than from the surface;
- a cylinder or cone does not belong to three or more bands of similar width: such bands are slices
  of a surface that is curved in two directions (a torus, an ellipsoid).

The corners of a single band of facets lie on a cylinder or cone, and on a sphere as well; the
first is chosen. All other facets are planes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index, Mask, ragged, starts
from kilter.shape.first_fits import FirstFits
from kilter.shape.fitting import FITS
from kilter.shape.round_region import (
    FEWEST_FACETS,
    FacetMesh,
    deviation,
    facet_graph,
    facet_sagitta,
    fit_surface,
    gather_rows,
    is_round,
    sagitta_limit,
    tolerance_of,
    triangle_sagitta,
)
from kilter.shape.shape_tolerances import GROWING
from kilter.shape.solid import Surface, facing

PATIENCE = 60
"""Number of failed seeds after which the rest of a region counts as flat; more take longer."""
SAMPLE = 1000
"""Largest number of facets of a region for the first fit."""
AHEAD = PATIENCE + 1
"""Number of seeds of a region whose first fits are computed together."""


def recognise(
    vertices: ArrayLike, triangles: ArrayLike, accuracy: float = 0.0, *, planes: bool = True
) -> tuple[tuple[Surface, ...], Index, Array]:
    """Recognise the exact surfaces (cylinders, spheres and so on) that a mesh approximates.

    Arguments: `vertices` (V, 3); `triangles` (T, 3): triangles, counterclockwise seen from outside;
    `accuracy`: largest error of a coordinate [length unit]; `planes`: whether the result contains
    planes; a mesh without round faces may have one per triangle. Returns `surfaces`: round surfaces
    in the order of their first triangle, then planes; `triangle_surface` (T,): surface of each
    triangle; -1 for triangles without area that lie in no facet, and for triangles in planes if the
    result contains no planes; `sagitta` (S,): largest distance of the triangles from each surface,
    measured at middles of triangles and edges [length unit].

    Examples
    --------
    >>> from kilter.shape.primitives import Cylinder, surface
    >>> surfaces, which, sagitta = recognise(*surface(Cylinder(2, 5)))
    >>> [(s.kind, round(s.radius, 12)) for s in surfaces], np.bincount(which)
    ([('cylinder', 2.0), ('plane', 0.0), ('plane', 0.0)], array([192,  94,  94]))
    """
    vertices = np.asarray(vertices, dtype=np.float64).reshape(-1, 3)
    triangles = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if not len(triangles):
        return (), np.empty(0, dtype=np.int64), np.empty(0)
    mesh = FacetMesh(vertices, triangles, facet_graph(vertices, triangles, accuracy))
    return _with_planes(mesh, _round_surfaces(mesh), planes)


_FacetSurfaces = list[tuple[Surface, Index]]
"""Surfaces with the facets of each."""


def _round_surfaces(mesh: FacetMesh) -> _FacetSurfaces:
    """Recognise the round surfaces of a mesh, and the facets that lie on each."""
    region = mesh.graph.region
    order = np.argsort(region, kind="stable")
    count = np.bincount(region)
    start = starts(count)
    surfaces: _FacetSurfaces = []
    divided = []
    for k in np.flatnonzero(count >= FEWEST_FACETS).tolist():
        facets = order[start[k] : start[k + 1]]
        whole = _common_surface(mesh, facets)
        if whole is not None:
            surfaces.append((whole, facets))
        else:
            divided.append(facets)
    return surfaces + _grow_surfaces(mesh, divided)


def _common_surface(mesh: FacetMesh, facets: Index) -> Surface | None:
    """The round surface on which all facets of a region lie; None if there is none."""
    sample = facets[:: max(1, len(facets) // SAMPLE)]
    tolerance = tolerance_of(mesh, mesh.points(facets))
    for kind in FITS:
        rough = fit_surface(mesh, sample, kind)
        if rough is None or deviation(mesh, sample, rough).max() > GROWING * tolerance:
            continue
        surface = fit_surface(mesh, facets, kind)
        if surface is not None and is_round(mesh, facets, surface, whole=True):
            return surface
    return None


# growing --------------------------------------------------------------------------------


def _grow_surfaces(mesh: FacetMesh, regions: Sequence[Index]) -> _FacetSurfaces:
    """Divide regions into round surfaces, each grown from a seed facet by adding neighbours."""
    free = np.zeros(len(mesh.graph.area), dtype=bool)
    if not regions:
        return []
    free[np.concatenate(regions)] = True
    seeds = [_seeds(mesh, facets) for facets in regions]
    first_fits = FirstFits(mesh)
    first_fits.compute(np.concatenate([some[:AHEAD] for some in seeds]), free)
    return [found for some in seeds for found in _grow_region(mesh, some, free, first_fits)]


def _grow_region(
    mesh: FacetMesh, seeds: Index, free: Mask, first_fits: FirstFits
) -> Iterator[tuple[Surface, Index]]:
    """Yield the round surfaces that grow from seeds of a region; mark their facets as not free."""
    fresh = free.copy()
    misses = 0
    for k, seed in enumerate(seeds.tolist()):
        if misses > PATIENCE:
            break
        if not free[seed] or not fresh[seed]:
            continue
        if not first_fits.is_known[seed]:
            later = seeds[k:]
            open_seeds = later[free[later] & fresh[later] & ~first_fits.is_known[later]]
            first_fits.compute(open_seeds[:AHEAD], free)
        surface, grown = _grow_from_seed(mesh, first_fits.of(seed), free)
        fresh[grown] = False
        if surface is None:
            misses += 1
            continue
        misses = 0
        free[grown] = False
        first_fits.forget(grown)
        yield surface, grown


def _seeds(mesh: FacetMesh, facets: Index) -> Index:
    """Facets of a region in the order in which they are tried as seeds of a surface.

    Facets with two neighbours of similar area come first.
    """
    graph = mesh.graph
    owner, rows = ragged(graph.first, facets)
    near = graph.neighbours[rows]
    ratio = graph.area[near] / graph.area[facets][owner]
    alike = np.bincount(owner, (ratio > 0.5) & (ratio < 2.0), len(facets))
    return facets[np.argsort(-np.minimum(alike, 2), kind="stable")]


def _grow_from_seed(
    mesh: FacetMesh, starts: Sequence[tuple[str, Index]], free: Mask
) -> tuple[Surface | None, Index]:
    """A round surface that grows from a seed facet, and its facets; None without a surface.

    Without a round surface, the result is None with the facets of the largest surface that grew;
    they serve as seeds no more.

    Arguments: `starts`: kinds of surface to try at the seed, each with the facets for its first
    fit; `free` (F,): facets that no surface has taken.
    """
    rejected = np.empty(0, dtype=np.int64)
    for kind, start in starts:
        surface, grown = _grow(mesh, start, kind, free)
        if surface is None:
            continue
        if is_round(mesh, grown, surface, whole=False):
            return surface, grown
        if len(grown) > len(rejected):
            rejected = grown
    return None, rejected


def _grow(mesh: FacetMesh, start: Index, kind: str, free: Mask) -> tuple[Surface | None, Index]:
    """Extend a surface from its first facets to all connected facets that lie on it.

    Returns `surface`: None if the first facets do not fit, or too few facets lie on the surface.
    """
    graph, no_facets = mesh.graph, np.empty(0, dtype=np.int64)
    surface, chosen = fit_surface(mesh, start, kind), start
    if surface is None or deviation(mesh, start, surface).max() > tolerance_of(
        mesh, mesh.points(start)
    ):
        return None, no_facets
    seen = np.zeros(len(free), dtype=bool)
    seen[start] = True
    front, last_fit = start, len(start)
    # the box of the corners grows with the front, so a step reads only the corners of its front
    box = _box(mesh.points(start))
    while len(front):
        near = np.unique(gather_rows(front, graph.first, graph.neighbours))
        near = near[free[near] & ~seen[near]]
        if not len(near) or not len(chosen):
            break
        within = tolerance_of(mesh, box)
        front = near[deviation(mesh, near, surface) <= GROWING * within]
        seen[front] = True
        chosen = np.concatenate([chosen, front])
        box = _box(np.concatenate([box, mesh.points(front)]))
        if len(chosen) > 1.3 * last_fit:
            # facets that a fit drops stay marked as seen, else the loop may not end
            surface, chosen, front = _refit(mesh, chosen, front, kind, surface)
            last_fit = max(len(chosen), 1)
            box = _box(mesh.points(chosen)) if len(chosen) else box
    if len(chosen) >= FEWEST_FACETS:  # a fit only drops facets
        surface, chosen, _ = _refit(mesh, chosen, front, kind, surface)
    if len(chosen) < FEWEST_FACETS:
        return None, no_facets
    sagitta = facet_sagitta(mesh, chosen, surface)
    return surface, chosen[sagitta <= sagitta_limit(sagitta) + mesh.graph.tolerance]


def _box(points: Array) -> Array:
    """Lower and upper corner of the bounding box of points, shape (2, 3)."""
    return np.array([points.min(axis=0), points.max(axis=0)])


def _refit(
    mesh: FacetMesh, chosen: Index, front: Index, kind: str, surface: Surface
) -> tuple[Surface, Index, Index]:
    """Fit a surface to its facets once more, and drop the facets that do not lie on it.

    Returns `chosen, front`: the remaining facets of both arguments.
    """
    for _ in range(3):
        if len(chosen) < 3:
            break
        again = fit_surface(mesh, chosen, kind)
        surface = surface if again is None else again
        off = deviation(mesh, chosen, surface)
        within = tolerance_of(mesh, mesh.points(chosen))
        kept = off <= within
        if kept.all():
            break
        # drop only the worst facets, since they distort the fit of the others
        limit = max(within, 0.3 * float(off[np.isfinite(off)].max(initial=0.0)))
        chosen = chosen[off <= limit]
    return surface, chosen, front[np.isin(front, chosen)]


# the answer -----------------------------------------------------------------------------


def _with_planes(
    mesh: FacetMesh, round_surfaces: _FacetSurfaces, planes: bool
) -> tuple[tuple[Surface, ...], Index, Array]:
    """Result of `recognise`: round surfaces, then, with `planes`, a plane for each other facet."""
    graph = mesh.graph
    round_surfaces = sorted(round_surfaces, key=lambda row: int(graph.start[row[1].min()]))
    of_facet = np.full(len(graph.area), -1)
    surfaces, sagitta = [], []
    for k, (surface, facets) in enumerate(round_surfaces):
        of_facet[facets] = k
        rows, _ = mesh.corners(facets)
        surfaces.append(facing(surface, mesh.vertices, mesh.triangles[rows]))
        sagitta.append(float(triangle_sagitta(mesh, rows, surface).max()))
    flat = np.flatnonzero((of_facet < 0) & graph.normal.any(axis=1) & planes)
    of_facet[flat] = len(surfaces) + np.arange(len(flat))
    points = mesh.vertices[mesh.triangles[graph.triangles_of[graph.start[flat]], 0]]
    surfaces += _planes(points, graph.normal[flat])
    off = _plane_offset(mesh, flat, points)
    return tuple(surfaces), of_facet[graph.facet], np.append(sagitta, off)


def _plane_offset(mesh: FacetMesh, flat: Index, points: Array) -> Array:
    """Largest distance of the corners of each flat facet from its plane, shape (n,).

    `points`: a point of each plane, shape (n, 3).
    """
    rows, owner = mesh.corners(flat)
    off = np.zeros(len(flat))
    for k in range(3):
        relative = mesh.vertices[mesh.triangles[rows, k]] - points[owner]
        distance = np.abs((relative * mesh.graph.normal[flat][owner]).sum(axis=1))
        np.maximum.at(off, owner, distance)
    return off


def _planes(points: Array, normals: Array) -> list[Surface]:
    """Build planes from points and unit normals, shape (n, 3) each.

    The constructor of `Surface` is bypassed. A mesh without round faces may have one plane per
    triangle, and the checks, which always pass here, would take ten times as long as all the rest.
    """
    points.flags.writeable = normals.flags.writeable = False
    plain = {"kind": "plane", "radius": 0.0, "tube": 0.0, "half_angle": 0.0, "hollow": False}
    planes = []
    for point, normal in zip(points, normals, strict=True):
        plane = object.__new__(Surface)
        for name, value in plain.items():
            object.__setattr__(plane, name, value)
        object.__setattr__(plane, "point", point)
        object.__setattr__(plane, "axis", normal)
        planes.append(plane)
    return planes
