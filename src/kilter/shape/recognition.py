"""The cylinders, cones and spheres that a mesh stands for.

Corners of a tessellated face lie on the face itself. Facets that meet at shallow edges make a
region; it is round where one surface passes all of its corners. Where several faces run into
each other without an edge (a fillet into its flats) a surface is grown facet by facet from
three neighbours.

**When is a prism round?** A bar of n even flat sides and a coarse cylinder are the same mesh, so
a rule must choose. A region is taken for round only if

- neighbouring facets meet at no more than 30.5 degrees: a prism of 12 even sides or more counts
  as round, one of 11 or less (hexagonal, octagonal bars, chamfered boxes) stays flat;
- it has 5 facets or more of different directions, so that a chamfer in 1 to 4 pieces stays flat;
- its corners lie on the surface within the accuracy of the coordinates;
- no facet is more than twice as wide as most are: the flat of a shaft stays a flat;
- it turns by 15 degrees or more, or is bounded by sharp edges all around: a short piece of some
  other curve passes for an arc of a circle;
- it leaves its best plane by far more than the corners leave the surface;
- as a cylinder or cone, it is not one of three or more bands of like width that bend into each
  other: such bands are slices of something that is curved both ways (a torus, an ellipsoid).

Corners of one band of facets lie on a cylinder or cone and on a sphere as well; the first is
taken. Whatever is not round is planes, one a facet.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index, Mask, cross, ragged, starts, unit_rows
from kilter.shape.fitting import FITS
from kilter.shape.round_region import (
    FEWEST_FACETS,
    FacetMesh,
    accepted,
    depth,
    deviation,
    facet_graph,
    fitted,
    gathered,
    most_sagitta,
    sagitta_of,
    tolerance_of,
)
from kilter.shape.shape_tolerances import GROWING
from kilter.shape.solid import Surface, facing

__all__ = ["recognise"]


PATIENCE = 60
"""Seeds without success after which the rest of a region is left flat."""
SAMPLE = 1000
"""Facets of a region that are looked at first."""
MOST_NEIGHBOURS = 12
"""Neighbours of a seed that are looked at."""


def recognise(
    vertices: ArrayLike, triangles: ArrayLike, accuracy: float = 0.0
) -> tuple[tuple[Surface, ...], Index, Array]:
    """The exact surfaces that the triangles of a mesh stand for.

    Parameters
    ----------
    vertices : array_like, shape (V, 3)
    triangles : array_like, shape (T, 3)
        Turning left seen from outside.
    accuracy : float
        How far a coordinate may be from the truth [length unit].

    Returns
    -------
    surfaces : tuple of Surface
        Round ones first, by the order of their first triangle; then planes.
    triangle_surface : ndarray, shape (T,)
        -1 for triangles of no area that lie in no facet.
    sagitta : ndarray, shape (S,)
        The greatest distance of a triangle of each surface from it, at the middles of
        triangles and edges [length unit].

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
    found = _round_surfaces(mesh)
    return _result(mesh, found)


_Found = list[tuple[Surface, Index]]


def _round_surfaces(mesh: FacetMesh) -> _Found:
    """Round surfaces and the facets of each."""
    region = mesh.graph.region
    order = np.argsort(region, kind="stable")
    count = np.bincount(region)
    start = starts(count)
    found: _Found = []
    for k in np.flatnonzero(count >= FEWEST_FACETS).tolist():
        facets = order[start[k] : start[k + 1]]
        whole = _whole(mesh, facets)
        found += [(whole, facets)] if whole is not None else _grown(mesh, facets)
    return found


def _whole(mesh: FacetMesh, facets: Index) -> Surface | None:
    """The one surface of all facets of a region."""
    some = facets[:: max(1, len(facets) // SAMPLE)]
    tolerance = tolerance_of(mesh, mesh.points(facets))
    for kind in FITS:
        rough = fitted(mesh, some, kind)
        if rough is None or deviation(mesh, some, rough).max() > GROWING * tolerance:
            continue
        surface = fitted(mesh, facets, kind)
        if surface is not None and accepted(mesh, facets, surface, whole=True):
            return surface
    return None


# growing --------------------------------------------------------------------------------


def _grown(mesh: FacetMesh, facets: Index) -> _Found:
    """Surfaces grown from seeds within a region that is not one surface."""
    free = np.zeros(len(mesh.graph.area), dtype=bool)
    free[facets] = True
    fresh = free.copy()
    found: _Found = []
    misses = 0
    for seed in _seeds(mesh, facets).tolist():
        if misses > PATIENCE:
            break
        if not free[seed] or not fresh[seed]:
            continue
        surface, grown = _from_seed(mesh, seed, free)
        fresh[grown] = False
        if surface is None:
            misses += 1
            continue
        misses = 0
        free[grown] = False
        found.append((surface, grown))
    return found


def _seeds(mesh: FacetMesh, facets: Index) -> Index:
    """Facets by how many neighbours are about as large as they, most first."""
    graph = mesh.graph
    owner, rows = ragged(graph.first, facets)
    near = graph.neighbours[rows]
    ratio = graph.area[near] / graph.area[facets][owner]
    alike = np.bincount(owner, (ratio > 0.5) & (ratio < 2.0), len(facets))
    return facets[np.argsort(-np.minimum(alike, 2), kind="stable")]


def _from_seed(mesh: FacetMesh, seed: int, free: Mask) -> tuple[Surface | None, Index]:
    """The first surface that grows from a seed and is accepted, plain kinds first.

    Where none is, the facets are those of the largest that grew: not to be tried again.
    """
    refused = np.empty(0, dtype=np.int64)
    for kind, start in _starts(mesh, seed, free):
        surface, grown = _grow(mesh, start, kind, free)
        if surface is None:
            continue
        if accepted(mesh, grown, surface, whole=False):
            return surface, grown
        if len(grown) > len(refused):
            refused = grown
    return None, refused


def _starts(mesh: FacetMesh, seed: int, free: Mask) -> list[tuple[str, Index]]:
    """Kinds and first facets: the seed between two neighbours, with a third for a sphere."""
    graph = mesh.graph
    near = graph.neighbours[graph.first[seed] : graph.first[seed + 1]]
    near = near[free[near]][:MOST_NEIGHBOURS]
    bend = unit_rows(graph.normal[near] - graph.normal[seed])
    # neighbours on either side along a band bend opposite ways in one plane with the seed
    out_of_plane = np.abs(cross(bend[:, None], bend[None]) @ graph.normal[seed])
    a, b = np.nonzero(np.triu(bend @ bend.T < 0, 1))
    order = np.argsort(out_of_plane[a, b], kind="stable")[:2]
    found = []
    for g, h in zip(a[order].tolist(), b[order].tolist(), strict=True):
        three = np.array([seed, near[g], near[h]])
        found += [("cylinder", three), ("cone", three)]
        others = [k for k in range(len(near)) if k not in (g, h)][:2]
        found += [("sphere", np.append(three, near[k])) for k in others]
    return found


def _grow(mesh: FacetMesh, start: Index, kind: str, free: Mask) -> tuple[Surface | None, Index]:
    """A surface that starts with a few facets takes in neighbours while all lie on it."""
    graph, none = mesh.graph, np.empty(0, dtype=np.int64)
    surface, chosen = fitted(mesh, start, kind), start
    if surface is None or deviation(mesh, start, surface).max() > tolerance_of(
        mesh, mesh.points(start)
    ):
        return None, none
    seen = np.zeros(len(free), dtype=bool)
    seen[start] = True
    front, fitted_to = start, len(start)
    while len(front):
        near = np.unique(gathered(front, graph.first, graph.neighbours))
        near = near[free[near] & ~seen[near]]
        if not len(near) or not len(chosen):
            break
        within = tolerance_of(mesh, mesh.points(chosen))
        front = near[deviation(mesh, near, surface) <= GROWING * within]
        seen[front] = True
        chosen = np.concatenate([chosen, front])
        if len(chosen) > 1.3 * fitted_to:
            # what a fit drops stays seen: taken in again, it could be dropped without end
            surface, chosen, front = _refitted(mesh, chosen, front, kind, surface)
            fitted_to = max(len(chosen), 1)
    surface, chosen, _ = _refitted(mesh, chosen, front, kind, surface)
    if len(chosen) < FEWEST_FACETS:
        return None, none
    sagitta = sagitta_of(mesh, chosen, surface)
    return surface, chosen[sagitta <= most_sagitta(sagitta) + mesh.graph.tolerance]


def _refitted(
    mesh: FacetMesh, chosen: Index, front: Index, kind: str, surface: Surface
) -> tuple[Surface, Index, Index]:
    """The surface of the chosen facets, without those that then are off it."""
    for _ in range(3):
        if len(chosen) < 3:
            break
        again = fitted(mesh, chosen, kind)
        surface = surface if again is None else again
        off = deviation(mesh, chosen, surface)
        within = tolerance_of(mesh, mesh.points(chosen))
        kept = off <= within
        if kept.all():
            break
        # the worst go first: they pull the surface away from the rest
        limit = max(within, 0.3 * float(off[np.isfinite(off)].max(initial=0.0)))
        chosen = chosen[off <= limit]
    return surface, chosen, front[np.isin(front, chosen)]


# the answer -----------------------------------------------------------------------------


def _result(mesh: FacetMesh, found: _Found) -> tuple[tuple[Surface, ...], Index, Array]:
    graph = mesh.graph
    found = sorted(found, key=lambda one: int(graph.start[one[1].min()]))
    of_facet = np.full(len(graph.area), -1)
    surfaces, sagitta = [], []
    for k, (surface, facets) in enumerate(found):
        of_facet[facets] = k
        rows, _ = mesh.corners(facets)
        surfaces.append(facing(surface, mesh.vertices, mesh.triangles[rows]))
        sagitta.append(float(depth(mesh, rows, surface).max()))
    flat = np.flatnonzero((of_facet < 0) & graph.normal.any(axis=1))
    of_facet[flat] = len(surfaces) + np.arange(len(flat))
    points = mesh.vertices[mesh.triangles[graph.triangles_of[graph.start[flat]], 0]]
    surfaces += _planes(points, graph.normal[flat])
    return tuple(surfaces), of_facet[graph.facet], np.append(sagitta, _flat_off(mesh, flat, points))


def _flat_off(mesh: FacetMesh, flat: Index, points: Array) -> Array:
    """How far the corners of flat facets are off their planes."""
    rows, owner = mesh.corners(flat)
    off = np.zeros(len(flat))
    for k in range(3):
        relative = mesh.vertices[mesh.triangles[rows, k]] - points[owner]
        distance = np.abs((relative * mesh.graph.normal[flat][owner]).sum(axis=1))
        np.maximum.at(off, owner, distance)
    return off


def _planes(points: Array, normals: Array) -> list[Surface]:
    """Planes by a point and a unit normal each.

    Made without the checks of `Surface`, which hold by themselves: a mesh of no round face has
    one plane a triangle, and the checks would take ten times as long as all the rest.
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
