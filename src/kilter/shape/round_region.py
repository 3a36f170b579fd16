"""Group triangles of a mesh into facets and regions; test whether facets form a round surface.

Connected triangles in a plane form a facet. Facets that meet along shallow edges form a region. A
region or a part of it is round if the rules of `kilter.shape.recognition` hold; `is_round` tests
them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    across,
    angle_between,
    connected,
    cross,
    distinct_rows,
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

FEWEST_FACETS = 5
"""Least number of facets of a round region."""
PARAMETERS = {"sphere": 4, "cylinder": 5, "cone": 6, "torus": 7}
"""Number of parameters of a surface: through so many corners passes a surface of this kind, so that
only further corners are evidence."""


@dataclass(frozen=True, slots=True, eq=False)
class FacetGraph:
    """Facets of a mesh (connected coplanar triangles) with their neighbours and regions."""

    facet: Index
    """Facet of each triangle, shape (T,)."""
    triangles_of: Index
    """Triangles sorted by facet, shape (T,); those of facet f are rows ``start[f]`` to ``start[f
    + 1]``."""
    start: Index
    """Shape (F + 1,)."""
    normal: Array
    """Outward unit normals, shape (F, 3)."""
    area: Array
    """Areas [length unit^2], shape (F,)."""
    neighbours: Index
    """Facets across shallow edges, shape (E,); those of facet f are rows ``first[f]`` to
    ``first[f + 1]``."""
    first: Index
    """Shape (F + 1,)."""
    region: Index
    """Region of each facet, shape (F,): facets that shallow edges connect."""
    tolerance: float
    """Largest distance of a corner from its plane or surface [length unit]."""


def facet_graph(vertices: Array, triangles: Index, accuracy: float) -> FacetGraph:
    """Find the facets of a mesh, their neighbours, and regions of smoothly joined facets.

    Arguments: `vertices` (V, 3); `triangles` (T, 3); `accuracy`: largest error of a coordinate
    [length unit].
    """
    size = float(np.ptp(vertices, axis=0).max(initial=0.0))
    largest = float(np.abs(vertices).max(initial=0.0))
    tolerance = max(PLANE_ROUNDINGS * max(accuracy, largest * 2.0**-52), PLANE_FLATNESS * size)
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    turn = cross(q - p, r - p)
    double = np.linalg.norm(turn, axis=1)
    normal = ratio(turn, double[:, None])
    pairs, edge = _edge_pairs(distinct_rows(vertices)[1][triangles])
    flat = _coplanar(vertices, triangles, normal, double, pairs, edge, tolerance)
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


def gather_rows(rows: Index, start: Index, values: Index) -> Index:
    """Concatenate some groups of a ragged array, given by their numbers.

    Examples
    --------
    >>> gather_rows(np.array([2, 0]), np.array([0, 1, 3, 5]), np.array([7, 8, 9, 4, 6]))
    array([4, 6, 7])
    """
    return values[ragged(start, rows)[1]]


def _edge_pairs(triangles: Index) -> tuple[Index, Index]:
    """Pairs of triangles that share an edge at which no third triangle lies.

    Returns `pairs` (n, 2): the two triangles; `edge` (n, 2): the position of the edge in each
    triangle, from 0 to 2.
    """
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


def _coplanar(
    vertices: Array,
    triangles: Index,
    normal: Array,
    double: Array,
    pairs: Index,
    edge: Index,
    tolerance: float,
) -> Mask:
    """Mask of pairs of triangles that lie in the same plane, shape (n,).

    The far corner of the smaller triangle must lie in the plane of the larger, and their normals
    must agree if the smaller is wide enough to have a normal.

    Arguments: `normal` (T, 3): unit normals of the triangles; `double` (T,): twice the areas of the
    triangles [length unit^2]; `pairs`, `edge` (n, 2): result of `_edge_pairs`; `tolerance`: largest
    distance of a corner from the plane [length unit].
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
    """Divide facets into single triangles if their corners leave the facet's mean plane.

    A chain of nearly coplanar triangles may bend slowly. `turn`: area vectors of the triangles,
    `facet`: facet of each triangle. The result is the new facet of each triangle.
    """
    count = int(facet.max(initial=-1)) + 1
    unit = unit_rows(group_sums(facet, turn, count))
    _, first = np.unique(facet, return_index=True)
    off = np.zeros(count)
    for k in range(3):
        relative = vertices[triangles[:, k]] - vertices[triangles[first, 0]][facet]
        np.maximum.at(off, facet, np.abs((relative * unit[facet]).sum(axis=1)))
    bent = (off > PLANE_ROUNDINGS * tolerance)[facet]
    label = np.where(bent, count + np.arange(len(facet)), facet)
    return np.unique(label, return_inverse=True)[1].reshape(-1).astype(np.int64)


# pieces of round surfaces ---------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class FacetMesh:
    """A mesh and its facet graph."""

    vertices: Array
    triangles: Index
    graph: FacetGraph

    def corners(self, facets: Index) -> tuple[Index, Index]:
        """Triangles of the given facets, and for each the position of its facet in `facets`."""
        owner, rows = ragged(self.graph.start, facets)
        return self.graph.triangles_of[rows], owner

    def points(self, facets: Index) -> Array:
        """Corners of the given facets without repeats, shape (n, 3)."""
        rows = self.triangles[self.corners(facets)[0]].reshape(-1)
        if len(rows) < len(self.vertices) / 8:
            return self.vertices[np.unique(rows)]
        used = np.zeros(len(self.vertices), dtype=bool)  # faster than np.unique for many corners
        used[rows] = True
        return self.vertices[used]


def fit_surface(mesh: FacetMesh, facets: Index, kind: str) -> Surface | None:
    """Fit a surface of the given kind to corners of facets; None if they do not determine it."""
    graph = mesh.graph
    return FITS[kind](mesh.points(facets), graph.normal[facets], graph.area[facets])


def tolerance_of(mesh: FacetMesh, points: Array) -> float:
    """Largest distance at which points count as on a surface, from their accuracy [length unit]."""
    return max(mesh.graph.tolerance, SURFACE_FIT * float(np.ptp(points, axis=0).max()))


def deviation(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Largest distance of the corners of each facet from a surface [length unit], shape (n,).

    It is infinite if the normals of facet and surface differ by more than `FACET_NORMAL`.
    """
    rows, owner = mesh.corners(facets)
    corners = mesh.vertices[mesh.triangles[rows]]
    distance = np.abs(height(surface, corners.reshape(-1, 3))).reshape(-1, 3).max(axis=1)
    off = np.zeros(len(facets))
    np.maximum.at(off, owner, distance)
    off[np.abs(agreement(mesh, facets, surface)) < np.cos(FACET_NORMAL)] = np.inf
    return off


def agreement(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Cosine of the angle between the normals of each facet and of a surface, shape (n,)."""
    rows, owner = mesh.corners(facets)
    middles = mesh.vertices[mesh.triangles[rows]].mean(axis=1)
    count = np.bincount(owner, minlength=len(facets))[:, None]
    away = outward(surface, group_sums(owner, middles, len(facets)) / count)
    cosine = (mesh.graph.normal[facets] * away).sum(axis=1)
    return ratio(cosine, np.linalg.norm(away, axis=1))


def facet_sagitta(mesh: FacetMesh, facets: Index, surface: Surface) -> Array:
    """Largest distance of each facet (inner points too) from a surface [length unit], (n,)."""
    rows, owner = mesh.corners(facets)
    sagitta = np.zeros(len(facets))
    np.maximum.at(sagitta, owner, triangle_sagitta(mesh, rows, surface))
    return sagitta


def triangle_sagitta(mesh: FacetMesh, rows: Index, surface: Surface) -> Array:
    """Largest distance of each of the triangles `rows` from a surface [length unit], (n,).

    It is measured at the middles of edges and at centroids.
    """
    p, q, r = (mesh.vertices[mesh.triangles[rows, k]] for k in range(3))
    places = ((p + q) / 2, (q + r) / 2, (r + p) / 2, (p + q + r) / 3)
    return np.asarray(np.max([np.abs(height(surface, place)) for place in places], axis=0))


# judging --------------------------------------------------------------------------------


def is_round(mesh: FacetMesh, facets: Index, surface: Surface, *, whole: bool) -> bool:
    """Whether facets are enough evidence of a round surface, by the rules of recognition.

    Arguments: `facets` (n,).
    """
    points = mesh.points(facets)
    tolerance = tolerance_of(mesh, points)
    if len(facets) < FEWEST_FACETS or float(np.abs(height(surface, points)).max()) > tolerance:
        return False
    if len(points) <= PARAMETERS[surface.kind]:
        return False
    agree = agreement(mesh, facets, surface)
    if float(np.abs(agree).min()) < np.cos(FACET_NORMAL) or np.ptp(np.sign(agree)) > 0:
        return False
    if not _has_enough_turn(mesh, facets, surface, whole):
        return False
    centered = points - points.mean(axis=0)
    plane_normal = np.linalg.svd(centered, full_matrices=False)[2][2]
    if float(np.ptp(centered @ plane_normal)) < EVIDENCE * tolerance:
        return False
    if not whole and surface.kind != "sphere" and _is_slice(mesh, facets):
        return False
    sagitta = facet_sagitta(mesh, facets, surface)
    if surface.kind == "sphere" and sagitta.max() > (1 - np.cos(STEEPEST_EDGE)) * surface.radius:
        return False
    return bool(sagitta.max() <= sagitta_limit(sagitta) + tolerance)


def sagitta_limit(sagitta: Array) -> float:
    """Largest distance from a round surface at which a facet may belong to it [length unit]."""
    return WIDEST_FACET * float(np.quantile(sagitta, 0.75))


def _has_enough_turn(mesh: FacetMesh, facets: Index, surface: Surface, whole: bool) -> bool:
    """Whether the normals of facets have enough directions, and span a wide enough angle."""
    normal = mesh.graph.normal[facets]
    if surface.kind == "sphere":
        mean = normal.mean(axis=0)
        turn = 2 * float(angle_between(normal, mean).max())
        return whole or turn >= LEAST_TURN
    u, v = across(surface.axis)
    angle = np.sort(np.arctan2(normal @ v, normal @ u))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    turn = 2 * np.pi - float(gap.max())
    # facets of the same strip differ in direction by rounding only
    steps = int((gap > ONE_STRIP * gap[gap < gap.max()].max(initial=0.0)).sum())
    return steps >= FEWEST_FACETS and (whole or turn >= LEAST_TURN)


def _is_slice(mesh: FacetMesh, facets: Index) -> bool:
    """Whether facets form one of several parallel bands of similar width."""
    graph = mesh.graph
    usual = float(np.median(graph.area[facets]))

    def beside(these: Index, apart: Index) -> Index:
        """Neighbours of given facets with a similar area, without the facets `apart`."""
        near = np.unique(gather_rows(these, graph.first, graph.neighbours))
        near = near[~np.isin(near, apart)]
        return near[(graph.area[near] > usual / 2) & (graph.area[near] < usual * 2)]

    next_to = beside(facets, facets)
    after = beside(next_to, np.concatenate([facets, next_to]))
    return len(next_to) > 1.5 * len(facets) or min(len(next_to), len(after)) > len(facets) / 2
