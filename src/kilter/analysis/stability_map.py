"""The stability map: z for every direction of gravity at once.

    Q = {sum_i m_i dr_i : dp in A},      z(g) = -max over q in Q of q.g

Q is a polytope in R^3 (in R^2 if planar), and 0 lies in it. The partitions of Figure 5 of the
paper are the normal cones of its vertices: there one dp is optimal. A direction is stable
exactly where no point of Q lies on its side of 0; where 0 is inside Q nothing is stable, and
the most nearly stable direction on the Euclidean sphere is the outward normal of the facet
nearest to 0.

Q is found by asking LP (9) in the direction of each facet of a hull that grows: the answer is
a new vertex, or the facet is one of Q. So about V + F programs. Where the answer may be a point
between vertices, a second program next to it gives a vertex.

References
----------
Mattikalli, Baraff, Khosla and Repetto (1993), Figure 5, equations (9), (10), (13). C. Lassez,
J.-L. Lassez, Quantifier elimination for conjunctions of linear constraints via a convex hull
algorithm, 1992 (the hull by an LP oracle).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kilter.analysis.growing_hull import GrowingHull
from kilter.analysis.virtual_work import Support, VirtualWork
from kilter.errors import SolverError
from kilter.mechanics.program import Program
from kilter.rigid import frozen

__all__ = ["StabilityMap", "stability_map"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

OUTSIDE = 2e-9
"""A point of Q counts as outside a facet from here on, over the mass."""
ASIDE = 1e-4
"""How far a second direction leans from the first, so that its optimum is one vertex."""
TIE = 1e-7
"""A direction this near to the boundary of its partition may have more than one optimum."""
PROGRAMS = 20_000
"""A map that needs more programs than this is given up."""


@dataclass(frozen=True, slots=True, eq=False)
class StabilityMap:
    """The polytope Q; world frame, kg x length unit.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
    normals : ndarray, shape (F, 3)
        Outward unit normals of the facets, in the span of Q.
    offsets : ndarray, shape (F,)
        ``normals @ q <= offsets``; none is negative, since 0 is in Q.
    equations : ndarray, shape (3 - dimension, 3)
        Orthonormal; ``equations @ q = 0``. Of a planar program y is always one.
    simplices : ndarray of int, shape (S, dimension)
        Vertices; the boundary of Q.
    simplex_facet : ndarray of int, shape (S,)
        The facet each simplex lies in.
    dimension : int
        Of Q, 0 to 3.
    mass : float
        Of the free parts [kg]: the scale of z.
    planar : bool
    programs : int
        LPs solved.
    """

    vertices: Array
    normals: Array
    offsets: Array
    equations: Array
    simplices: Index
    simplex_facet: Index
    dimension: int
    mass: float
    planar: bool
    programs: int

    def z(self, gravity: ArrayLike) -> Array:
        """Z of LP (9), shape (n,), for gravity vectors, shape (n, 3), of any length.

        z(t g) = t z(g): give vectors with |g|_1 = 1 for the paper's diamond, unit vectors for
        z as `check` reports it.
        """
        gravity = np.asarray(gravity, dtype=np.float64)
        highest = -np.inf * np.ones(gravity.shape[:-1])
        for some in np.array_split(self.vertices, max(1, len(self.vertices) // 64)):
            highest = np.maximum(highest, (gravity @ some.T).max(axis=-1))
        result: Array = np.minimum(-highest, 0.0)
        return result

    def partition_of(self, gravity: ArrayLike) -> Index:
        """The vertex, hence the partition of Figure 5, of each direction, shape (n,)."""
        result: Index = (np.asarray(gravity, dtype=np.float64) @ self.vertices.T).argmax(axis=-1)
        return result

    def partition(self, vertex: int) -> Array:
        """Rays of one partition: unit normals of the facets at a vertex, shape (k, 3).

        The partition is the cone of these rays, plus the span of `equations`.
        """
        at = np.unique(self.simplex_facet[(self.simplices == vertex).any(axis=1)])
        return self.normals[at]

    @property
    def nearest(self) -> tuple[Array, float] | None:
        """Unit direction with the greatest z, and that z; None where a direction is stable."""
        full = 2 if self.planar else 3
        if self.dimension < full or self.offsets.min() <= OUTSIDE * self.mass:
            return None
        best = int(self.offsets.argmin())
        return self.normals[best], -float(self.offsets[best])


def stability_map(program: Program) -> StabilityMap:
    """Find Q, hence z for every direction of gravity.

    Raises
    ------
    InputError
        If loads are given.
    SolverError
        If Q has too many facets.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("paper-figure-4")
    >>> found = stability_map(build_program(assembly, find_contacts(assembly)))
    >>> np.round(found.z([[0, 0, 1], [-1, 0, 0], [-0.5, 0, -0.5]]), 9) + 0.0
    array([-5. , -2.5,  0. ])
    """
    work = VirtualWork(program)
    if not program.free.any():
        return _assembled(work, program.planar, None, np.zeros((0, 3)))
    points, basis = _first_points(work)
    if not len(basis):
        return _assembled(work, program.planar, None, basis)
    hull = GrowingHull(points @ basis.T, OUTSIDE)
    while not hull.done.all():
        if work.programs > PROGRAMS:
            raise SolverError(f"the stability map has more than {PROGRAMS} facets and vertices")
        _grow(work, hull, basis, int(np.flatnonzero(~hull.done)[0]))
    return _assembled(work, program.planar, hull, basis)


def _grow(work: VirtualWork, hull: GrowingHull, basis: Array, facet: int) -> None:
    """Ask in the direction of a facet: confirm it and all in its plane, or add a vertex."""
    normal, offset = hull.normals[facet], float(hull.offsets[facet])
    found = _vertex(work, basis, normal @ basis, offset)
    if found is None or not hull.add(basis @ found):
        same = np.abs(hull.points[hull.facets] @ normal - offset).max(axis=1) <= 2 * OUTSIDE
        hull.done |= same & (hull.normals @ normal > 0)
        hull.done[facet] = True


def _vertex(work: VirtualWork, basis: Array, direction: Array, offset: float) -> Array | None:
    """A vertex of Q over the mass beyond the offset, or None."""
    first = work.solve(direction)
    if -first.z <= offset + OUTSIDE:
        return None
    if len(basis) > 1 and _tied(work, direction):
        aside = np.cos(np.arange(1.0, len(basis) + 1) * 2.3) @ basis
        second = work.solve(direction + ASIDE * aside)
        if float(second.q @ direction) > offset + OUTSIDE:
            return second.q
    return first.q


def _tied(work: VirtualWork, direction: Array) -> bool:
    return bool((work.partition() @ direction < TIE).any())


def _first_points(work: VirtualWork) -> tuple[Array, Array]:
    """Vertices that make a simplex, shape (k + 1, 3), and a basis of the span, (k, 3)."""
    axes = work.unit.axes
    points: list[Array] = []
    while True:
        rest = _rest(points, axes)
        if not len(rest):
            break
        # a direction on no line of symmetry, across all that was found
        direction = np.cos(np.arange(1.0, len(rest) + 1) * 1.7) @ rest
        direction = direction / float(np.linalg.norm(direction))
        level = float(points[0] @ direction) if points else 0.0
        new = _beyond(work, direction, level)
        if not points and len(new) == 1:
            points.append(np.zeros(3))  # 0 is the other end
        points += new if not points else new[:1]
        if not new:
            break
    if not points:
        return np.zeros((1, 3)), np.zeros((0, 3))
    taken = np.vstack(points)
    return taken, _span(taken)


def _beyond(work: VirtualWork, direction: Array, level: float) -> list[Array]:
    """Vertices of Q on the two sides of the plane ``direction . q = level``."""
    found = []
    for sign in (1.0, -1.0):
        answer: Support = work.solve(sign * direction)
        if -answer.z > sign * level + 1e2 * OUTSIDE:
            found.append(answer.q)
    return found


def _span(points: Array) -> Array:
    """Orthonormal basis of the differences of points, shape (k, 3)."""
    edges = points[1:] - points[0]
    basis: list[Array] = []
    for edge in edges:
        rest = edge
        for _ in range(2):
            for axis in basis:
                rest = rest - (rest @ axis) * axis
        basis.append(rest / float(np.linalg.norm(rest)))
    return np.array(basis).reshape(-1, 3)


def _rest(points: list[Array], axes: Index) -> Array:
    """Orthonormal basis of what is at right angles to the differences of points."""
    unit = np.eye(3)[axes]
    if len(points) < 2:
        return unit
    taken = _span(np.vstack(points))
    _, sizes, rows = np.linalg.svd(unit - unit @ taken.T @ taken)
    return rows[: len(axes) - len(taken)] if sizes.size else unit


def _assembled(work: VirtualWork, planar: bool, hull: GrowingHull | None, basis: Array) -> StabilityMap:
    """The map, coplanar simplices made one facet, in the units of the program."""
    mass = work.unit.mass
    _, _, rows = np.linalg.svd(np.vstack([basis, np.zeros((1, 3))]))
    equations = rows[len(basis) :]
    if hull is None:
        none = np.zeros(0, dtype=np.int64)
        return StabilityMap(
            frozen(np.zeros((1, 3))), frozen(np.zeros((0, 3))), frozen(np.zeros(0)),
            frozen(equations), none.reshape(0, 0), none, 0, mass, planar, work.programs,
        )  # fmt: skip
    facet, chosen = _merged(hull)
    return StabilityMap(
        vertices=frozen(hull.points @ basis * mass),
        normals=frozen(hull.normals[chosen] @ basis),
        offsets=frozen(np.maximum(hull.offsets[chosen], 0.0) * mass),
        equations=frozen(equations),
        simplices=hull.facets,
        simplex_facet=facet,
        dimension=len(basis),
        mass=mass,
        planar=planar,
        programs=work.programs,
    )


def _merged(hull: GrowingHull) -> tuple[Index, Index]:
    """The facet of each simplex, and the simplex that stands for each facet: the largest."""
    corners = hull.points[hull.facets]
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=(1, 2))
    facet = np.full(len(corners), -1)
    chosen: list[int] = []
    for k in np.argsort(-size):
        if facet[k] >= 0:
            continue
        off = np.abs(corners @ hull.normals[k] - hull.offsets[k]).max(axis=1)
        same = (off <= 4 * OUTSIDE) & (hull.normals @ hull.normals[k] > 0) & (facet < 0)
        same[k] = True
        facet[same] = len(chosen)
        chosen.append(int(k))
    return facet, np.array(chosen)
