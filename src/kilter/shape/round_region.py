"""Facets of a mesh, and which of them are a piece of a round surface.

Triangles in one plane make a facet, facets that meet along shallow edges a region. A region,
or a piece of one, is round where the rules of `kilter.shape.recognition` hold; here each is a
number and a test (`accepted`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    across,
    connected,
    cross,
    group_sums,
    ragged,
    ratio,
    starts,
    unit_rows,
)
from kilter.shape.fitting import FITS
from kilter.shape.shape_tolerances import (
    EVIDENCE,
    FACET_NORMAL,
    LEAST_TURN,
    NARROW,
    ONE_STRIP,
    PLANE_FLATNESS,
    PLANE_ROUNDINGS,
    STEEPEST_EDGE,
    SURFACE_FIT,
    WIDEST_FACET,
)
from kilter.shape.solid import Surface, height, outward

__all__ = [
    "FEWEST_FACETS",
    "FacetMesh",
    "accepted",
    "depth",
    "deviation",
    "facet_graph",
    "fitted",
    "gathered",
    "most_sagitta",
    "sagitta_of",
    "tolerance_of",
]


FEWEST_FACETS = 5
"""Facets of a round region."""


@dataclass(frozen=True, slots=True, eq=False)
class FacetGraph:
    """Facets of a mesh: connected triangles in one plane.

    Attributes
    ----------
    facet : ndarray, shape (T,)
        Facet of each triangle.
    triangles_of : ndarray, shape (T,)
        Triangles ordered by facet; those of facet f are rows ``start[f]`` to ``start[f + 1]``.
    start : ndarray, shape (F + 1,)
    normal : ndarray, shape (F, 3)
        Unit, outward.
    area : ndarray, shape (F,)
    neighbours : ndarray, shape (E,)
        Facets across shallow edges; those of facet f are rows ``first[f]`` to ``first[f + 1]``.
    first : ndarray, shape (F + 1,)
    region : ndarray, shape (F,)
        Facets that are connected over shallow edges share a number.
    tolerance : float
        How far a corner may be off a plane or surface that it lies on [length unit].
    """

    facet: Index
    triangles_of: Index
    start: Index
    normal: Array
    area: Array
    neighbours: Index
    first: Index
    region: Index
    tolerance: float


def facet_graph(vertices: Array, triangles: Index, accuracy: float) -> FacetGraph:
    """Facets of a mesh and how they meet."""
    size = float(np.ptp(vertices, axis=0).max(initial=0.0))
    largest = float(np.abs(vertices).max(initial=0.0))
    tolerance = max(PLANE_ROUNDINGS * max(accuracy, largest * 2.0**-52), PLANE_FLATNESS * size)
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    turn = cross(q - p, r - p)
    double = np.linalg.norm(turn, axis=1)
    normal = ratio(turn, double[:, None])
    pairs, edge = _meeting(_welded(vertices, triangles))
    flat = _flat(vertices, triangles, normal, double, pairs, edge, tolerance)
    facet = connected(len(triangles), *pairs[flat].T)
    facet = _without_drift(vertices, triangles, turn, facet, tolerance)
    count = int(facet.max(initial=-1)) + 1
    unit = unit_rows(group_sums(facet, turn, count))
    order = np.argsort(facet, kind="stable")
    start = starts(np.bincount(facet, minlength=count))
    near = facet[pairs]
    near = near[near[:, 0] != near[:, 1]]
    near = near[(unit[near[:, 0]] * unit[near[:, 1]]).sum(axis=1) > np.cos(STEEPEST_EDGE)]
    key = np.sort(np.concatenate([near @ [count, 1], near @ [1, count]]))
    key = key[np.diff(key, prepend=-1) > 0]
    both = np.column_stack([key // max(count, 1), key % max(count, 1)])
    first = starts(np.bincount(both[:, 0], minlength=count))
    region = connected(count, *near.T)
    area: Array = np.bincount(facet, double / 2, count).astype(np.float64)
    return FacetGraph(facet, order, start, unit, area, both[:, 1], first, region, tolerance)


def gathered(rows: Index, start: Index, values: Index) -> Index:
    """The values of several rows of a ragged array, one after the other.

    Examples
    --------
    >>> gathered(np.array([2, 0]), np.array([0, 1, 3, 5]), np.array([7, 8, 9, 4, 6]))
    array([4, 6, 7])
    """
    return values[ragged(start, rows)[1]]


def _welded(vertices: Array, triangles: Index) -> Index:
    """Triangles by distinct corners: those in one place are one."""
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    fresh = np.ones(len(vertices), dtype=bool)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    place = np.empty(len(vertices), dtype=np.int64)
    place[order] = np.cumsum(fresh) - 1
    welded: Index = place[triangles]
    return welded


def _meeting(triangles: Index) -> tuple[Index, Index]:
    """Pairs of triangles with an edge that is theirs alone, and the edge's place in each."""
    ends = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = ends.min(axis=1) * (int(triangles.max(initial=0)) + 1) + ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    same = ordered[1:] == ordered[:-1]
    alone = same.copy()
    alone[1:] &= ~same[:-1]
    alone[:-1] &= ~same[1:]
    at = np.flatnonzero(alone)
    rows = np.column_stack([order[at], order[at + 1]])
    return rows // 3, rows % 3


def _flat(
    vertices: Array,
    triangles: Index,
    normal: Array,
    double: Array,
    pairs: Index,
    edge: Index,
    tolerance: float,
) -> Mask:
    """Pairs in one plane: the far corner of the smaller lies in the plane of the larger.

    And their normals agree, where the smaller is wide enough to have one.
    """
    small = np.argmin(double[pairs], axis=1)
    k = np.arange(len(pairs))
    less, more = pairs[k, small], pairs[k, 1 - small]
    far = triangles[less, (edge[k, small] + 2) % 3]
    near = triangles[less, edge[k, small]]
    off = np.abs(((vertices[far] - vertices[near]) * normal[more]).sum(axis=1))
    length = np.linalg.norm(
        vertices[triangles[less, (edge[k, small] + 1) % 3]] - vertices[near], axis=1
    )
    high = ratio(double[less], length)
    turned = (normal[less] * normal[more]).sum(axis=1) > np.cos(STEEPEST_EDGE)
    flat: Mask = (off <= tolerance) & (turned | (high <= NARROW * tolerance))
    return flat


def _without_drift(
    vertices: Array, triangles: Index, turn: Array, facet: Index, tolerance: float
) -> Index:
    """Facets taken apart into their triangles where corners leave the facet's own plane."""
    count = int(facet.max(initial=-1)) + 1
    unit = unit_rows(group_sums(facet, turn, count))
    _, one = np.unique(facet, return_index=True)
    off = np.zeros(count)
    for k in range(3):
        relative = vertices[triangles[:, k]] - vertices[triangles[one, 0]][facet]
        np.maximum.at(off, facet, np.abs((relative * unit[facet]).sum(axis=1)))
    bent = (off > PLANE_ROUNDINGS * tolerance)[facet]
    label = np.where(bent, count + np.arange(len(facet)), facet)
    return np.unique(label, return_inverse=True)[1].reshape(-1).astype(np.int64)


# pieces of round surfaces ---------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class FacetMesh:
    """A mesh and its facets."""

    vertices: Array
    triangles: Index
    graph: FacetGraph

    def corners(self, facets: Index) -> tuple[Index, Index]:
        """Triangles of facets, and the place of each one's facet in the list."""
        owner, rows = ragged(self.graph.start, facets)
        return self.graph.triangles_of[rows], owner

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
    return max(mesh.graph.tolerance, SURFACE_FIT * float(np.ptp(points, axis=0).max()))


def deviation(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """How far the corners of each facet are off; infinite where it faces another way."""
    rows, owner = mesh.corners(facets)
    corners = mesh.vertices[mesh.triangles[rows]]
    distance = np.abs(height(surface, corners.reshape(-1, 3))).reshape(-1, 3).max(axis=1)
    off = np.zeros(len(facets))
    np.maximum.at(off, owner, distance)
    off[np.abs(agreement(mesh, facets, surface)) < np.cos(FACET_NORMAL)] = np.inf
    return off


def agreement(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Cosine between the normal of each facet and the surface's, at the facet's middle."""
    rows, owner = mesh.corners(facets)
    middles = mesh.vertices[mesh.triangles[rows]].mean(axis=1)
    count = np.bincount(owner, minlength=len(facets))[:, None]
    away = outward(surface, group_sums(owner, middles, len(facets)) / count)
    cosine = (mesh.graph.normal[facets] * away).sum(axis=1)
    return ratio(cosine, np.linalg.norm(away, axis=1))


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
    if float(np.abs(agree).min()) < np.cos(FACET_NORMAL) or np.ptp(np.sign(agree)) > 0:
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
    if surface.kind == "sphere" and sagitta.max() > (1 - np.cos(STEEPEST_EDGE)) * surface.radius:
        return False
    return bool(sagitta.max() <= most_sagitta(sagitta) + tolerance)


def most_sagitta(sagitta: Array) -> float:
    """The greatest sagitta that a facet among such may have."""
    return WIDEST_FACET * float(np.quantile(sagitta, 0.75))


def _enough(mesh: FacetMesh, facets: Index, surface: Surface, whole: bool) -> bool:
    """Facets of enough directions, and enough turn between them."""
    normal = mesh.graph.normal[facets]
    if surface.kind == "sphere":
        mean = normal.mean(axis=0)
        turn = 2 * float(np.arccos(np.clip(normal @ mean / np.linalg.norm(mean), -1, 1)).max())
        return whole or turn >= LEAST_TURN
    u, v = across(surface.axis)
    angle = np.sort(np.arctan2(normal @ v, normal @ u))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    turn = 2 * np.pi - float(gap.max())
    # facets of one strip differ by rounding only, next to what neighbouring strips do
    steps = int((gap > ONE_STRIP * gap[gap < gap.max()].max(initial=0.0)).sum())
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
