"""The stability map: optimum z of the displacement program for every direction of gravity.

    Q = {sum_i m_i dr_i : dp in A},      z(g) = -max over q in Q of q.g

Q is a polytope in R^3 (in R^2 if planar), and 0 lies in it. The partitions of Figure 5 of the
paper are the normal cones of its vertices: there a single dp is optimal. A direction is stable
exactly if no point of Q lies on its side of 0; if 0 is inside Q no direction is stable, and
the most nearly stable direction on the Euclidean sphere is the outward normal of the facet
nearest to 0.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), Figure 5, equations (9), (10), (13).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.analysis_tolerances import OUTSIDE_HULL
from kilter.analysis.regions.enclose import GrowingHull
from kilter.analysis.turning.reachable import PROGRAMS, Reachable
from kilter.arrays import Array, Index
from kilter.errors import SolverError
from kilter.mechanics.program import Program
from kilter.validate import frozen


@dataclass(frozen=True, slots=True, eq=False)
class StabilityMap:
    """Polytope from which z follows for every direction of gravity; world frame.

    z is the optimum of the displacement program. Lengths are in kg x length unit.
    """

    vertices: Array
    """Shape (V, 3)."""
    normals: Array
    """Outward unit normals of the facets, in the span of Q, shape (F, 3)."""
    offsets: Array
    """``normals @ q <= offsets``; none is negative, since 0 is in Q, shape (F,)."""
    facets: tuple[Index, ...]
    """The vertices of each facet, in order around it."""
    equations: Array
    """Orthonormal, shape (3 - dimension, 3); ``equations @ q = 0``. Of a planar program y is
    always in their span."""
    dimension: int
    """Dimension of Q, 0 to 3."""
    mass: float
    """Mass of the free parts [kg]: the scale of z."""
    planar: bool
    programs: int
    """LPs solved."""

    def z(self, gravity: ArrayLike) -> Array:
        """Optimum z of the displacement program for gravity vectors (n, 3) of any length, (n,).

        z(t g) = t z(g): give vectors with |g|_1 = 1 for the paper's diamond, unit vectors for
        z as `check` reports it.
        """
        gravity = np.asarray(gravity, dtype=np.float64)
        highest = np.zeros(gravity.shape[:-1])
        for some in np.array_split(self.vertices, 1 + len(self.vertices) // 64):
            highest = np.maximum(highest, (gravity @ some.T).max(axis=-1, initial=0.0))
        result: Array = -highest
        return result

    def partition(self, vertex: int) -> Array:
        """Unit rays of the cone of gravity directions for which a vertex determines z, (k, 3).

        They are the unit normals of the facets at the vertex. The partition is their cone,
        plus the span of `equations`.
        """
        at = [k for k, corners in enumerate(self.facets) if vertex in corners]
        rays: Array = self.normals[at]
        return rays

    @property
    def nearest(self) -> tuple[Array, float] | None:
        """Most nearly stable unit direction of gravity, with z; None if a direction is stable."""
        full = 2 if self.planar else 3
        if self.dimension < full or self.offsets.min() <= OUTSIDE_HULL * self.mass:
            return None
        best = int(self.offsets.argmin())
        return self.normals[best], -float(self.offsets[best])


def stability_map(program: Program, *, limit: int = PROGRAMS) -> StabilityMap:
    """Compute the stability map, which gives optimum z for every direction of gravity.

    Raises `InputError` if loads are given. Raises `SolverError` if the limit is reached: the facets
    of Q can be very many if parts touch on inclined faces.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("paper-figure-4")
    >>> found = stability_map(build_program(assembly, contacts(assembly)))
    >>> np.round(found.z([[0, 0, 1], [-1, 0, 0], [-0.5, 0, -0.5]]), 9) + 0.0
    array([-5. , -2.5,  0. ])
    """
    reachable = Reachable(program)
    known = reachable.known
    hull = None if known is None else known.hull
    last = np.zeros(len(reachable.basis))
    while known is not None and hull is not None and not hull.done.all():
        if reachable.work.programs >= limit:
            raise SolverError(f"the stability map needs more than {limit} programs")
        # the facet most like the last one asked: its basis is near
        open_ = np.flatnonzero(~hull.done)
        chosen = int(open_[(hull.normals[open_] @ last).argmax()])
        last = hull.normals[chosen]
        known.settle(chosen)
    return _assemble_map(reachable, hull, program.planar)


def _assemble_map(reachable: Reachable, hull: GrowingHull | None, planar: bool) -> StabilityMap:
    """The map from a finished search: simplices merged into facets, in the program's units."""
    mass, basis = reachable.work.unit.mass, reachable.basis
    _, _, rows = np.linalg.svd(np.vstack([basis, np.zeros((1, 3))]))
    vertices, normals, offsets = np.zeros((1, 0)), np.zeros((0, 0)), np.zeros(0)
    facets: tuple[Index, ...] = ()
    if hull is not None:
        vertices, normals, offsets, facets = _merge_facets(hull)
    return StabilityMap(
        vertices=frozen(vertices @ basis * mass),
        normals=frozen(normals @ basis),
        offsets=frozen(np.maximum(offsets, 0.0) * mass),
        facets=facets,
        equations=frozen(rows[len(basis) :]),
        dimension=len(basis),
        mass=mass,
        planar=planar,
        programs=reachable.work.programs,
    )


def _merge_facets(hull: GrowingHull) -> tuple[Array, Array, Array, tuple[Index, ...]]:
    """Vertices, normals, offsets and corners of facets, after merging coplanar simplices."""
    facet, chosen = _planes(hull)
    normals, offsets = hull.normals[chosen], hull.offsets[chosen]
    size = hull.points.shape[1]
    on = np.zeros((len(hull.points), len(chosen)), dtype=bool)
    for column in hull.facets.T:
        on[column, facet] = True
    # a vertex lies on as many facets as there are dimensions; other points are between vertices
    true = np.flatnonzero(on.sum(axis=1) >= size)
    points = hull.points[true]
    facets = tuple(
        _sort_corners(points, np.flatnonzero(on[true, k]), n) for k, n in enumerate(normals)
    )
    return points, normals, offsets, facets


def _planes(hull: GrowingHull) -> tuple[Index, list[int]]:
    """Index of the facet that contains each simplex of a hull, and a simplex for each facet."""
    corners = hull.points[hull.facets]
    spread = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=(1, 2))
    beside: dict[tuple[int, ...], list[int]] = {}
    ridges = [np.sort(np.delete(hull.facets, k, axis=1), axis=1) for k in range(corners.shape[2])]
    for side in ridges:
        for simplex, ridge in enumerate(map(tuple, side.tolist())):
            beside.setdefault(ridge, []).append(simplex)
    facet = np.full(len(corners), -1)
    chosen: list[int] = []
    for first in np.argsort(-spread):  # the largest simplex knows its plane best
        if facet[first] >= 0:
            continue
        off = np.abs(corners @ hull.normals[first] - hull.offsets[first]).max(axis=1)
        facet[first] = len(chosen)
        reached = [int(first)]
        while reached and corners.shape[2] > 1:
            simplex = reached.pop()
            for side in ridges:
                for other in beside[tuple(side[simplex].tolist())]:
                    if facet[other] < 0 and off[other] <= 4 * OUTSIDE_HULL:
                        facet[other] = len(chosen)
                        reached.append(other)
        chosen.append(int(first))
    return facet, chosen


def _sort_corners(points: Array, corners: Index, normal: Array) -> Index:
    """Corners of a facet in counterclockwise order, seen from outside."""
    if len(normal) < 3:
        return corners
    rays = points[corners] - points[corners].mean(axis=0)
    first = rays[np.linalg.norm(rays, axis=1).argmax()]
    angle = np.arctan2(rays @ np.cross(normal, first), rays @ first)
    return corners[np.argsort(angle)]
