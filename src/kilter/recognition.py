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
- it leaves its best plane by far more than the corners leave the surface.

Corners of one band of facets lie on a cylinder or cone and on a sphere as well; the first is
taken. Whatever is not round is planes, one a facet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kilter.facet_graph import FacetGraph, facet_graph, gathered
from kilter.fitting import FITS
from kilter.solid import Surface, facing, height, outward

__all__ = ["recognise"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FEWEST_FACETS = 5
"""Facets of a round region."""
WIDEST = 4.0
"""Times the sagitta of most facets (three quarters of them) that one may have: twice as wide."""
LEAST_TURN = np.radians(15)
"""Turn of a round region that goes on without an edge into another face [rad]."""
EVIDENCE = 20.0
"""Times the tolerance by which a round region leaves its best plane."""
RELATIVE = 1e-7
"""Corners are this close to a surface, in sizes of the region, whatever their accuracy."""
ALIKE = np.radians(25)
"""Between the normal of a facet and that of the surface at its middle [rad]."""
PATIENCE = 60
"""Seeds without success after which the rest of a region is left flat."""
LOOSE = 30.0
"""Times the tolerance that corners may be off while a surface grows from a few facets."""


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
    sagitta : ndarray, shape (S,)
        The greatest distance of a triangle of each surface from it, at the middles of
        triangles and edges [length unit].

    Examples
    --------
    >>> from kilter.shapes import Cylinder, surface
    >>> surfaces, which, sagitta = recognise(*surface(Cylinder(2, 5)))
    >>> [(s.kind, round(s.radius, 12)) for s in surfaces], np.bincount(which)
    ([('cylinder', 2.0), ('plane', 0.0), ('plane', 0.0)], array([192,  94,  94]))
    """
    vertices = np.asarray(vertices, dtype=np.float64).reshape(-1, 3)
    triangles = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if not len(triangles):
        return (), np.empty(0, dtype=np.int64), np.empty(0)
    mesh = _Mesh(vertices, triangles, facet_graph(vertices, triangles, accuracy))
    found = _round_surfaces(mesh)
    return _result(mesh, found)


@dataclass(frozen=True, slots=True, eq=False)
class _Mesh:
    vertices: Array
    triangles: Index
    graph: FacetGraph

    def corners(self, facets: Index) -> tuple[Index, Index]:
        """Triangles of facets, and the place of each one's facet in the list."""
        graph = self.graph
        rows = gathered(facets, graph.start, graph.triangles_of)
        return rows, np.repeat(np.arange(len(facets)), np.diff(graph.start)[facets])

    def points(self, facets: Index) -> Array:
        """Corners of facets, each once."""
        return self.vertices[np.unique(self.triangles[self.corners(facets)[0]])]


_Found = list[tuple[Surface, Index]]


def _round_surfaces(mesh: _Mesh) -> _Found:
    """Round surfaces and the facets of each."""
    region = mesh.graph.region
    order = np.argsort(region, kind="stable")
    count = np.bincount(region)
    start = np.concatenate([[0], np.cumsum(count)])
    found: _Found = []
    for k in np.flatnonzero(count >= FEWEST_FACETS).tolist():
        facets = order[start[k] : start[k + 1]]
        whole = _whole(mesh, facets)
        found += [(whole, facets)] if whole is not None else _grown(mesh, facets)
    return found


def _whole(mesh: _Mesh, facets: Index) -> Surface | None:
    """The one surface of all facets of a region."""
    for kind in FITS:
        surface = _fitted(mesh, facets, kind)
        if surface is not None and _accepted(mesh, facets, surface, whole=True):
            return surface
    return None


def _fitted(mesh: _Mesh, facets: Index, kind: str) -> Surface | None:
    graph = mesh.graph
    return FITS[kind](mesh.points(facets), graph.normal[facets], graph.area[facets])


def _tolerance(mesh: _Mesh, points: Array) -> float:
    return max(mesh.graph.tolerance, RELATIVE * float(np.ptp(points, axis=0).max()))


def _off(mesh: _Mesh, facets: Index, surface: Surface) -> Array:
    """How far the corners of each facet are off; infinite where it faces another way."""
    rows, owner = mesh.corners(facets)
    corners = mesh.vertices[mesh.triangles[rows]]
    distance = np.abs(height(surface, corners.reshape(-1, 3))).reshape(-1, 3).max(axis=1)
    off = np.zeros(len(facets))
    np.maximum.at(off, owner, distance)
    off[np.abs(_agreement(mesh, facets, surface)) < np.cos(ALIKE)] = np.inf
    return off


def _agreement(mesh: _Mesh, facets: Index, surface: Surface) -> Array:
    """Cosine between the normal of each facet and the surface's, at the facet's middle."""
    rows, owner = mesh.corners(facets)
    middles = mesh.vertices[mesh.triangles[rows]].mean(axis=1)
    count = np.bincount(owner, minlength=len(facets))[:, None]
    mean = np.column_stack([np.bincount(owner, middles[:, k], len(facets)) for k in range(3)])
    away = outward(surface, mean / count)
    length = np.maximum(np.linalg.norm(away, axis=1), np.finfo(float).tiny)
    return np.asarray((mesh.graph.normal[facets] * away).sum(axis=1) / length)


def _sagitta(mesh: _Mesh, facets: Index, surface: Surface) -> Array:
    """Distance of each facet from the surface, at middles of edges and triangles."""
    rows, owner = mesh.corners(facets)
    sagitta = np.zeros(len(facets))
    np.maximum.at(sagitta, owner, _depth(mesh, rows, surface))
    return sagitta


def _depth(mesh: _Mesh, rows: Index, surface: Surface) -> Array:
    p, q, r = (mesh.vertices[mesh.triangles[rows, k]] for k in range(3))
    places = ((p + q) / 2, (q + r) / 2, (r + p) / 2, (p + q + r) / 3)
    return np.asarray(np.max([np.abs(height(surface, place)) for place in places], axis=0))


# judging --------------------------------------------------------------------------------


def _accepted(mesh: _Mesh, facets: Index, surface: Surface, *, whole: bool) -> bool:
    """Whether facets are a piece of a surface, by the rules of the module's first lines."""
    points = mesh.points(facets)
    tolerance = _tolerance(mesh, points)
    if len(facets) < FEWEST_FACETS or float(np.abs(height(surface, points)).max()) > tolerance:
        return False
    agreement = _agreement(mesh, facets, surface)
    if float(np.abs(agreement).min()) < np.cos(ALIKE) or np.ptp(np.sign(agreement)) > 0:
        return False
    if not _enough(mesh, facets, surface, whole):
        return False
    centered = points - points.mean(axis=0)
    leaves = np.linalg.svd(centered, full_matrices=False)[2][2]
    if float(np.ptp(centered @ leaves)) < EVIDENCE * tolerance:
        return False
    sagitta = _sagitta(mesh, facets, surface)
    return bool(sagitta.max() <= WIDEST * np.quantile(sagitta, 0.75) + tolerance)


def _enough(mesh: _Mesh, facets: Index, surface: Surface, whole: bool) -> bool:
    """Facets of enough directions, and enough turn between them."""
    normal = mesh.graph.normal[facets]
    if surface.kind == "sphere":
        mean = normal.mean(axis=0)
        turn = 2 * float(np.arccos(np.clip(normal @ mean / np.linalg.norm(mean), -1, 1)).max())
        return whole or turn >= LEAST_TURN
    u = np.cross(surface.axis, np.eye(3)[np.argmin(np.abs(surface.axis))])
    v = np.cross(surface.axis, u)
    angle = np.sort(np.arctan2(normal @ v, normal @ (u * np.linalg.norm(v) / np.linalg.norm(u))))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    turn = 2 * np.pi - float(gap.max())
    # facets of one strip differ by rounding only, next to what neighbouring strips do
    steps = int((gap > 1e-3 * gap[gap < gap.max()].max(initial=0.0)).sum())
    return steps >= FEWEST_FACETS and (whole or turn >= LEAST_TURN)


# growing --------------------------------------------------------------------------------


def _grown(mesh: _Mesh, facets: Index) -> _Found:
    """Surfaces grown from seeds within a region that is not one surface."""
    free = np.zeros(len(mesh.graph.area), dtype=bool)
    free[facets] = True
    found: _Found = []
    misses = 0
    for seed in _seeds(mesh, facets).tolist():
        if not free[seed] or misses > PATIENCE:
            continue
        surface, grown = _from_seed(mesh, seed, free)
        if surface is None:
            misses += 1
            continue
        misses = 0
        free[grown] = False
        found.append((surface, grown))
    return found


def _seeds(mesh: _Mesh, facets: Index) -> Index:
    """Facets by how many neighbours are about as large as they, most first."""
    graph = mesh.graph
    near = gathered(facets, graph.first, graph.neighbours)
    owner = np.repeat(np.arange(len(facets)), np.diff(graph.first)[facets])
    ratio = graph.area[near] / graph.area[facets][owner]
    alike = np.bincount(owner, (ratio > 0.5) & (ratio < 2.0), len(facets))
    return facets[np.argsort(-np.minimum(alike, 2), kind="stable")]


def _from_seed(mesh: _Mesh, seed: int, free: NDArray[np.bool_]) -> tuple[Surface | None, Index]:
    for kind, start in _starts(mesh, seed, free):
        surface, grown = _grow(mesh, start, kind, free)
        if surface is not None and _accepted(mesh, grown, surface, whole=False):
            return surface, grown
    return None, np.empty(0, dtype=np.int64)


def _starts(mesh: _Mesh, seed: int, free: NDArray[np.bool_]) -> list[tuple[str, Index]]:
    """Kinds and first facets: the seed with two neighbours on either side, or with all."""
    graph = mesh.graph
    near = graph.neighbours[graph.first[seed] : graph.first[seed + 1]]
    near = near[free[near]]
    if len(near) < 2:
        return []
    normal = graph.normal
    pairs = []
    for a in range(len(near)):
        for b in range(a + 1, len(near)):
            g, h = normal[near[a]] - normal[seed], normal[near[b]] - normal[seed]
            if g @ h < 0:
                bend = abs(float(np.cross(g, h) @ normal[seed]))
                pairs.append((bend / float(np.linalg.norm(g) * np.linalg.norm(h)), a, b))
        if len(pairs) > 20:
            break
    starts = []
    for _, a, b in sorted(pairs)[:2]:
        three = np.sort(np.array([seed, near[a], near[b]]))
        starts += [("cylinder", three), ("cone", three)]
    ring = np.unique(np.append(near, seed))
    return [*starts, ("cylinder", ring), ("cone", ring), ("sphere", ring)]


def _grow(
    mesh: _Mesh, start: Index, kind: str, free: NDArray[np.bool_]
) -> tuple[Surface | None, Index]:
    """A surface that starts with a few facets takes in neighbours while all lie on it."""
    graph, none = mesh.graph, np.empty(0, dtype=np.int64)
    surface, chosen = _fitted(mesh, start, kind), start
    if surface is None or _off(mesh, start, surface).max() > _tolerance(mesh, mesh.points(start)):
        return None, none
    inside = np.zeros(len(free), dtype=bool)
    inside[start] = True
    front, fitted_to = start, len(start)
    while len(front):
        near = np.unique(gathered(front, graph.first, graph.neighbours))
        near = near[free[near] & ~inside[near]]
        if not len(near):
            break
        within = _tolerance(mesh, mesh.points(chosen))
        front = near[_off(mesh, near, surface) <= LOOSE * within]
        inside[front] = True
        chosen = np.concatenate([chosen, front])
        if len(chosen) > 1.3 * fitted_to:
            surface, chosen, front = _refitted(mesh, chosen, front, kind, surface)
            inside[:] = False
            inside[chosen] = True
            fitted_to = len(chosen)
    surface, chosen, _ = _refitted(mesh, chosen, front, kind, surface)
    return (surface, chosen) if len(chosen) >= FEWEST_FACETS else (None, none)


def _refitted(
    mesh: _Mesh, chosen: Index, front: Index, kind: str, surface: Surface
) -> tuple[Surface, Index, Index]:
    """The surface of the chosen facets, without those that then are off it."""
    for _ in range(3):
        again = _fitted(mesh, chosen, kind)
        surface = surface if again is None else again
        off = _off(mesh, chosen, surface)
        within = _tolerance(mesh, mesh.points(chosen))
        kept = off <= within
        if kept.all():
            break
        # the worst go first: they pull the surface away from the rest
        limit = max(within, 0.3 * float(off[np.isfinite(off)].max(initial=0.0)))
        chosen = chosen[off <= limit]
        if len(chosen) < 3:
            break
    return surface, chosen, front[np.isin(front, chosen)]


# the answer -----------------------------------------------------------------------------


def _result(mesh: _Mesh, found: _Found) -> tuple[tuple[Surface, ...], Index, Array]:
    graph = mesh.graph
    found = sorted(found, key=lambda one: int(graph.start[one[1].min()]))
    of_facet = np.full(len(graph.area), -1)
    surfaces, sagitta = [], []
    for k, (surface, facets) in enumerate(found):
        of_facet[facets] = k
        rows, _ = mesh.corners(facets)
        surfaces.append(facing(surface, mesh.vertices, mesh.triangles[rows]))
        sagitta.append(float(_depth(mesh, rows, surface).max()))
    flat = np.flatnonzero(of_facet < 0)
    of_facet[flat] = len(surfaces) + np.arange(len(flat))
    points = mesh.vertices[mesh.triangles[graph.triangles_of[graph.start[flat]], 0]]
    surfaces += [_plane(x, n) for x, n in zip(points, graph.normal[flat], strict=True)]
    return tuple(surfaces), of_facet[graph.facet], np.append(sagitta, _flat_off(mesh, flat, points))


def _flat_off(mesh: _Mesh, flat: Index, points: Array) -> Array:
    """How far the corners of flat facets are off their planes."""
    rows, owner = mesh.corners(flat)
    off = np.zeros(len(flat))
    for k in range(3):
        relative = mesh.vertices[mesh.triangles[rows, k]] - points[owner]
        distance = np.abs((relative * mesh.graph.normal[flat][owner]).sum(axis=1))
        np.maximum.at(off, owner, distance)
    return off


def _plane(point: Array, normal: Array) -> Surface:
    return Surface("plane", point, normal)
