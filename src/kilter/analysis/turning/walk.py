"""Search for the most stable direction by the paper's walk through partitions of the diamond.

This is Problem 2 of the paper as published.

The diamond |g|_1 = 1 is cut into facets (eight; four if planar), and each facet into
partitions in which the same basis of LP (9) stays optimal, equation (11). In a partition z is
linear, so its maximum there is a small LP in g. From the start g_a the walk goes to that
maximum g_b; if g_b lies on the boundary it takes an epsilon step along the directed arc
g_a -> g_b into the next partition, and so on. It ends if the maximum lies in the
interior of its partition, or if a boundary point is met again.

The second rule is not always right: bases are degenerate if z = 0, and a partition by
bases is then only a piece of the set with the same optimal dp. So after the published rule the
direction is tested (`is_best`), and if it fails the walk starts again on the ascent that the
test found. Both are counted apart.

The test: is 0 in the superdifferential of z? At g the supergradients of z are -q for the
q = sum_i m_i dr_i of all optimal dp. The value

    t = min over optimal dp of max over corners v of the facet of -q . v

is z(g) exactly if some optimal dp lets z rise toward no corner. Else the multipliers of
the corners make the direction g' = sum_j l_j v_j toward which z rises at first. Any dp in A
bounds z from above, so t bounds z on the whole facet, however roughly "optimal dp" is taken.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), sections 2.3, 3 and 3.1, equations (10), (11).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.analysis_tolerances import (
    OPTIMAL,
    OPTIMAL_FACE,
    SAME_ON_DIAMOND,
    WALK_STEP,
)
from kilter.analysis.turning.virtual_work import (
    Optimum,
    UnitProgram,
    VirtualWork,
    facets_of_diamond,
)
from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.solvers.highs import solve_linear
from kilter.solvers.problem import LinearProgram

START = np.array([0.37, 0.34, 0.29])
"""Start of a walk, up to signs and length: near the middle of a facet, on no line of symmetry."""
PARTITIONS = 1000
"""Largest number of partitions of a walk; then the walk ends and its last point is tested."""
RESTARTS = 100
"""Largest number of restarts of a walk in a facet."""


@dataclass(frozen=True, slots=True, eq=False)
class WalkFacet:
    """The walk in a facet of the diamond: visited directions, their optimum z, and its end."""

    signs: Array
    """The facet, shape (3,): signs * g >= 0."""
    path: Array
    """Directions visited, shape (k, 3): the start, then the maxima of the partitions."""
    heights: Array
    """z along the path [kg x length unit], shape (k,)."""
    published: float
    """z at the first end of the published rule [kg x length unit]."""
    stops: tuple[str, ...]
    """"interior", "revisited" or "broken off": how each walk ended, restarts included."""
    failed: int
    """Stops that were not optimal."""
    optimal: bool
    """Whether the last stop passed the test."""
    gravity: Array
    """The best direction found, shape (3,)."""
    z: float
    """[kg x length unit]"""


@dataclass(frozen=True, slots=True, eq=False)
class Walk:
    """The most nearly stable direction on the diamond |g|_1 = 1, found by the paper's walk."""

    gravity: Array
    """On the diamond |g|_1 = 1, shape (3,)."""
    z: float
    """[kg x length unit]; 0 if `gravity` is stable."""
    facets: tuple[WalkFacet, ...]
    """The walked facets: all, or up to the first with z = 0."""
    programs: int
    """LPs solved, all kinds."""
    partitions: int
    """Visited, those of restarts included."""
    stops: dict[str, int]
    """How walks ended."""
    failed: int
    """Stops that failed the test of optimality."""
    restarts: int
    published: float
    """z that the published rule alone gives."""


@dataclass(slots=True, eq=False)
class _Trail:
    """Record of a running walk in a facet: path, z divided by the mass, ends, and counts."""

    signs: Array
    path: list[Array] = field(default_factory=list)
    heights: list[float] = field(default_factory=list)
    stops: list[str] = field(default_factory=list)
    programs: int = 0
    partitions: int = 0

    def reach(self, gravity: Array, z: float) -> None:
        self.path.append(gravity)
        self.heights.append(z)

    @property
    def best(self) -> int:
        return int(np.argmax(self.heights))


def walk(program: Program, *, every: bool = False) -> Walk:
    """Find the most nearly stable direction on the diamond |g|_1 = 1 by the paper's walk.

    Parameters
    ----------
    program : Program
    every : bool
        Whether to continue with the other facets after z = 0, its greatest value, was found.

    Raises
    ------
    InputError
        If loads are given.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("paper-figure-12")
    >>> best = walk(build_program(assembly, contacts(assembly)))
    >>> round(float(np.degrees(np.arctan2(best.gravity[0], best.gravity[2]))) + 180, 6)
    60.0
    """
    work = VirtualWork(program)
    mass = work.unit.mass
    facets: list[WalkFacet] = []
    programs = partitions = 0
    for signs in facets_of_diamond(program):
        trail, published, failed, optimal = _facet(work, signs)
        programs, partitions = programs + trail.programs, partitions + trail.partitions
        path, heights = np.array(trail.path), mass * np.array(trail.heights)
        gravity, z = trail.path[trail.best], float(heights[trail.best])
        facets.append(
            WalkFacet(
                signs, path, heights, published * mass, tuple(trail.stops), failed, optimal,
                gravity, z,
            )
        )  # fmt: skip
        if z >= -OPTIMAL * mass and not every:
            break
    best = max(facets, key=lambda facet: facet.z)
    stops = [stop for facet in facets for stop in facet.stops]
    return Walk(
        gravity=best.gravity,
        z=best.z,
        facets=tuple(facets),
        programs=programs + work.programs,
        partitions=partitions,
        stops={word: stops.count(word) for word in ("interior", "revisited", "broken off")},
        failed=sum(facet.failed for facet in facets),
        restarts=len(stops) - len(facets),
        published=max(facet.published for facet in facets),
    )


def _facet(work: VirtualWork, signs: Array) -> tuple[_Trail, float, int, bool]:
    """Walk in a facet until no restart improves it; return the record and how the walk ended."""
    trail = _Trail(signs)
    start = np.zeros(3)
    start[work.unit.axes] = START[work.unit.axes]
    _one_walk(work, trail, _on_facet(start * signs, signs))
    published = trail.heights[trail.best]
    failed = 0
    while True:
        at = trail.best
        if trail.heights[at] >= -OPTIMAL * 1e-3:
            return trail, published, failed, True  # z is never above 0
        test = is_best(work.unit, signs, trail.path[at], trail.heights[at])
        trail.programs += 1
        if test.best:
            return trail, published, failed, True
        failed += 1
        higher = _ascent(work, trail, test)
        if higher is None or failed > RESTARTS:
            return trail, published, failed, False
        _one_walk(work, trail, higher)


def _one_walk(work: VirtualWork, trail: _Trail, start: Array) -> None:
    """Walk from a start by the published rule; store the path and why it ended in the trail."""
    here, seen = start, len(trail.path)
    for _ in range(PARTITIONS):
        optimum = work.solve(here)
        partition = work.partition()
        trail.partitions += 1
        if len(trail.path) == seen:
            trail.reach(here, optimum.z)
        summit = _summit(work, trail, optimum, partition, here)
        trail.reach(summit, -float(optimum.q @ summit))
        if (partition @ summit > SAME_ON_DIAMOND).all():
            trail.stops.append("interior")
            return
        arc = summit - here
        boundary = trail.path[seen + 1 : -1]
        if (
            any(np.abs(summit - point).max() < SAME_ON_DIAMOND for point in boundary)
            or not arc.any()
        ):
            trail.stops.append("revisited")
            return
        here = _on_facet(summit + WALK_STEP * arc / np.abs(arc).sum(), trail.signs)
    trail.stops.append("broken off")


def _summit(
    work: VirtualWork, trail: _Trail, optimum: Optimum, partition: Array, here: Array
) -> Array:
    """Most stable direction in a partition of a facet; `here` if no direction is better.

    It has the greatest z = -q.g, which is linear in a partition.
    """
    axes, signs = work.unit.axes, trail.signs[work.unit.axes]
    rows = np.vstack([partition[:, axes] * signs, np.ones((1, len(axes)))])
    lower = np.append(np.minimum(partition @ here, 0.0), 1.0)
    upper = np.append(np.full(len(partition), np.inf), 1.0)
    answer = solve_linear(
        LinearProgram(
            optimum.q[axes] * signs, csc_array(rows), lower, upper,
            np.zeros(len(axes)), np.ones(len(axes)),
        ),
        presolve=False,
    )  # fmt: skip
    trail.programs += 1
    if not answer.optimal or answer.objective >= -optimum.z - 1e-3 * OPTIMAL:
        return here
    summit = np.zeros(3)
    summit[axes] = signs * answer.x
    return _on_facet(summit, trail.signs)


def _on_facet(point: Array, signs: Array) -> Array:
    """Give a point the signs of a facet, and scale it to |g|_1 = 1."""
    shares = np.maximum(point * signs, 0.0)
    result: Array = signs * shares / float(shares.sum())
    return result


def _ascent(work: VirtualWork, trail: _Trail, test: Optimality) -> Array | None:
    """Direction with greater z than the best so far, on the way to `test.toward`; else None."""
    at = trail.best
    for k in range(40):
        point = trail.path[at] + (test.toward - trail.path[at]) * 0.5**k
        z = work.solve(point).z
        if z > trail.heights[at] + 1e-2 * OPTIMAL:
            return point
    return None


@dataclass(frozen=True, slots=True, eq=False)
class Optimality:
    """Whether a direction is the most stable of its facet; if not, where z is greater.

    `bound`: no direction of the facet has a greater z over the mass. `toward`, shape (3,):
    the point of the facet toward which z rises, if it does.
    """

    best: bool
    bound: float
    toward: Array


def is_best(unit: UnitProgram, signs: Array, gravity: Array, z: float) -> Optimality:
    """Test whether a direction is the most stable of its facet; `z`: its optimum over the mass."""
    lp, axes = unit.lp, unit.axes
    count, rows = len(lp.cost), lp.matrix.shape[0]
    corners = signs[axes, None] * unit.pull[axes]
    face = gravity @ unit.pull
    matrix = vstack(
        [
            hstack([lp.matrix, csc_array((rows, 1))]),
            hstack([csc_array(face[None, :]), csc_array((1, 1))]),
            hstack([csc_array(corners), csc_array(np.ones((len(axes), 1)))]),
        ],
        format="csc",
    )
    zero = np.zeros(len(axes))
    answer = solve_linear(
        LinearProgram(
            np.append(np.zeros(count), 1.0),
            matrix,
            np.concatenate([lp.row_lower, [-z - OPTIMAL_FACE], zero]),
            np.concatenate([lp.row_upper, [np.inf], zero + np.inf]),
            np.append(lp.lower, -1.0 - 1e-6),
            np.append(lp.upper, 1.0 + 1e-6),
        )
    )
    if not answer.optimal:
        return Optimality(False, np.inf, gravity)
    shares = np.maximum(answer.multipliers[rows + 1 :], 0.0)
    toward = np.zeros(3)
    toward[axes] = signs[axes] * shares / max(float(shares.sum()), 1e-300)
    return Optimality(answer.objective <= z + OPTIMAL, answer.objective, toward)
