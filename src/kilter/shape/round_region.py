"""A piece of a round surface: facets, the surface fitted to them, and whether it may stand.

The rules are those of `kilter.shape.recognition`; here each is a number and a test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index
from kilter.shape.facet_graph import STEEPEST, FacetGraph, gathered
from kilter.shape.fitting import FITS, perpendicular
from kilter.shape.solid import Surface, height, outward

__all__ = [
    "FEWEST_FACETS",
    "FacetMesh",
    "accepted",
    "depth",
    "deviation",
    "fitted",
    "most_sagitta",
    "sagitta_of",
    "tolerance_of",
]


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


@dataclass(frozen=True, slots=True, eq=False)
class FacetMesh:
    """A mesh and its facets."""

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
        rows = self.triangles[self.corners(facets)[0]].reshape(-1)
        if len(rows) < len(self.vertices) / 8:
            return self.vertices[np.unique(rows)]
        used = np.zeros(len(self.vertices), dtype=bool)  # quicker where there are many
        used[rows] = True
        return self.vertices[used]


def fitted(mesh: FacetMesh, facets: Index, kind: str) -> Surface | None:
    """The surface of a kind through the corners of facets."""
    graph = mesh.graph
    return FITS[kind](mesh.points(facets), graph.normal[facets], graph.area[facets])


def tolerance_of(mesh: FacetMesh, points: Array) -> float:
    """How far corners may be off a surface through such points [length unit]."""
    return max(mesh.graph.tolerance, RELATIVE * float(np.ptp(points, axis=0).max()))


def deviation(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """How far the corners of each facet are off; infinite where it faces another way."""
    rows, owner = mesh.corners(facets)
    corners = mesh.vertices[mesh.triangles[rows]]
    distance = np.abs(height(surface, corners.reshape(-1, 3))).reshape(-1, 3).max(axis=1)
    off = np.zeros(len(facets))
    np.maximum.at(off, owner, distance)
    off[np.abs(agreement(mesh, facets, surface)) < np.cos(ALIKE)] = np.inf
    return off


def agreement(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Cosine between the normal of each facet and the surface's, at the facet's middle."""
    rows, owner = mesh.corners(facets)
    middles = mesh.vertices[mesh.triangles[rows]].mean(axis=1)
    count = np.bincount(owner, minlength=len(facets))[:, None]
    mean = np.column_stack([np.bincount(owner, middles[:, k], len(facets)) for k in range(3)])
    away = outward(surface, mean / count)
    length = np.maximum(np.linalg.norm(away, axis=1), np.finfo(float).tiny)
    return np.asarray((mesh.graph.normal[facets] * away).sum(axis=1) / length)


def sagitta_of(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Distance of each facet from the surface, at middles of edges and triangles."""
    rows, owner = mesh.corners(facets)
    sagitta = np.zeros(len(facets))
    np.maximum.at(sagitta, owner, depth(mesh, rows, surface))
    return sagitta


def depth(mesh: FacetMesh, rows: Index, surface: Surface) -> Array:
    """Distance of each triangle from the surface, at middles of edges and of itself."""
    p, q, r = (mesh.vertices[mesh.triangles[rows, k]] for k in range(3))
    places = ((p + q) / 2, (q + r) / 2, (r + p) / 2, (p + q + r) / 3)
    return np.asarray(np.max([np.abs(height(surface, place)) for place in places], axis=0))


# judging --------------------------------------------------------------------------------


def accepted(mesh: FacetMesh, facets: Index, surface: Surface, *, whole: bool) -> bool:
    """Whether facets are a piece of a surface, by the rules of the module's first lines."""
    points = mesh.points(facets)
    tolerance = tolerance_of(mesh, points)
    if len(facets) < FEWEST_FACETS or float(np.abs(height(surface, points)).max()) > tolerance:
        return False
    agree = agreement(mesh, facets, surface)
    if float(np.abs(agree).min()) < np.cos(ALIKE) or np.ptp(np.sign(agree)) > 0:
        return False
    if not _enough(mesh, facets, surface, whole):
        return False
    centered = points - points.mean(axis=0)
    leaves = np.linalg.svd(centered, full_matrices=False)[2][2]
    if float(np.ptp(centered @ leaves)) < EVIDENCE * tolerance:
        return False
    if not whole and surface.kind != "sphere" and _is_slice(mesh, facets):
        return False
    sagitta = sagitta_of(mesh, facets, surface)
    if surface.kind == "sphere" and sagitta.max() > (1 - np.cos(STEEPEST)) * surface.radius:
        return False
    return bool(sagitta.max() <= most_sagitta(sagitta) + tolerance)


def most_sagitta(sagitta: Array) -> float:
    """The greatest sagitta that a facet among such may have."""
    return WIDEST * float(np.quantile(sagitta, 0.75))


def _enough(mesh: FacetMesh, facets: Index, surface: Surface, whole: bool) -> bool:
    """Facets of enough directions, and enough turn between them."""
    normal = mesh.graph.normal[facets]
    if surface.kind == "sphere":
        mean = normal.mean(axis=0)
        turn = 2 * float(np.arccos(np.clip(normal @ mean / np.linalg.norm(mean), -1, 1)).max())
        return whole or turn >= LEAST_TURN
    u, v = perpendicular(surface.axis)
    angle = np.sort(np.arctan2(normal @ v, normal @ u))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    turn = 2 * np.pi - float(gap.max())
    # facets of one strip differ by rounding only, next to what neighbouring strips do
    steps = int((gap > 1e-3 * gap[gap < gap.max()].max(initial=0.0)).sum())
    return steps >= FEWEST_FACETS and (whole or turn >= LEAST_TURN)


def _is_slice(mesh: FacetMesh, facets: Index) -> bool:
    """Whether facets are one of several bands of like width, side by side."""
    graph = mesh.graph
    usual = float(np.median(graph.area[facets]))

    def beside(these: Index, apart: Index) -> Index:
        near = np.unique(gathered(these, graph.first, graph.neighbours))
        near = near[~np.isin(near, apart)]
        return near[(graph.area[near] > usual / 2) & (graph.area[near] < usual * 2)]

    next_to = beside(facets, facets)
    after = beside(next_to, np.concatenate([facets, next_to]))
    return len(next_to) > 1.5 * len(facets) or min(len(next_to), len(after)) > len(facets) / 2
