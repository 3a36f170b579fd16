"""Most stable direction of gravity on the diamond |g|_1 = 1, by a linear program for each facet.

    min over g in the facet, f >= 0 of |J^T f + W g|_1  =  -max over g of z(g)

by the dual of LP (9), in its units (rows of moments in kg x length unit). It is solved by
its own dual, which has a quarter of the rows and columns:

    min t:  t + (sum_i m_i dr_i) . v_j >= 0 at the corners v_j of the facet,  dp in A

whose multipliers are g in the corners v_j, and f. Any dp in A bounds z on the whole facet
from above, so if t < 0 that motion proves that no direction of the facet is stable.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), footnote 1: "a transformation of our maximin
formulation that admits a simpler numerical solution method".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.analysis_tolerances import OPTIMAL
from kilter.analysis.decision.motion import find_motion
from kilter.analysis.turning.least_instability import least_instability
from kilter.analysis.turning.reachable import nearest_on_sphere
from kilter.analysis.turning.virtual_work import UnitProgram, facets_of_diamond, unit_program
from kilter.analysis.turning.walk import walk
from kilter.analysis.verdict.displacement import find_displacement
from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import LinearProgram
from kilter.tell.record import Record, Shape, Vector
from kilter.validate import frozen


@dataclass(frozen=True, slots=True, eq=False)
class FacetOptimum:
    """The most nearly stable direction of gravity on a facet of the diamond |g|_1 = 1.

    Its optimum z of the displacement program is the greatest: 0 if stable, negative if unstable.
    """

    signs: Array
    """The facet, shape (3,): signs * g >= 0."""
    gravity: Array
    """On the diamond, shape (3,)."""
    z: float
    """[kg x length unit]. If the motion of a cluster proves that another facet has a greater z, it
    is an upper bound."""
    motion: Array
    """In A, shape (N, 6); -(sum_i m_i dr_i) . v <= z at every corner v of the facet."""


@dataclass(frozen=True, slots=True, eq=False)
class DiamondOptimum:
    """The most nearly stable direction of gravity on the whole diamond |g|_1 = 1.

    Its optimum z of the displacement program is the greatest: 0 if stable, negative if unstable.
    """

    gravity: Array
    """On the diamond |g|_1 = 1, shape (3,); the zero vector if no part is free."""
    z: float
    """[kg x length unit]; 0 if `gravity` is stable."""
    facets: tuple[FacetOptimum, ...]
    """The solved facets: all, or up to the first with z = 0."""
    programs: int
    """LPs solved."""


def joint(program: Program, *, every: bool = False) -> DiamondOptimum:
    """Find the most nearly stable direction on |g|_1 = 1, by a linear program for each facet.

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
    >>> assembly = scene("paper-figure-11")
    >>> best = joint(build_program(assembly, contacts(assembly)))
    >>> np.round(best.gravity, 9) + 0.0, round(best.z, 9) + 0.0
    (array([-0.5,  0. , -0.5]), 0.0)
    """
    whole = _Facets(program)
    part = _heaviest_cluster(program) if every else None
    equal = OPTIMAL * whole.unit.mass
    optima: list[FacetOptimum] = []
    for facet in facets_of_diamond(program):
        best = max((optimum.z for optimum in optima), default=-np.inf)
        bound = part.solve(facet) if part is not None and optima else None
        worse = bound is not None and bound.z < best - equal
        optima.append(bound if bound is not None and worse else whole.solve(facet))
        if not every and optima[-1].z >= -equal:
            break
    first = max(optima, key=lambda optimum: optimum.z)
    solved = whole.model.solves + (0 if part is None else part.model.solves)
    return DiamondOptimum(first.gravity, first.z, tuple(optima), solved)


class _Facets:
    """The linear program over a facet of the diamond, kept for all facets."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.unit = unit_program(program)
        self.model = KeptProgram(_program(self.unit), warm="dual", goal="point")

    def solve(self, facet: Array) -> FacetOptimum:
        """The most nearly stable direction of a facet, given by its signs, shape (3,)."""
        unit = self.unit
        lower = np.concatenate([np.where(facet[unit.axes] > 0, 0.0, -np.inf)] * 2)
        lower[len(unit.axes) :] = np.where(facet[unit.axes] < 0, 0.0, -np.inf)
        rows = len(unit.lp.row_lower) + np.arange(len(lower))
        self.model.change_sides(rows, lower, np.full(len(lower), np.inf))
        answer = self.model.solve().required("the orientation of a facet")
        return _facet(self.program, unit, facet, answer.x, answer.multipliers[rows])


def _heaviest_cluster(program: Program) -> _Facets | None:
    """Programs over the facets for the heaviest cluster; None if all parts are a single cluster.

    z of the assembly is the sum of z of its clusters, none of which is positive: z of a cluster
    bounds it from above.
    """
    parted = [] if program.has_limits else clusters(program)
    if len(parted) < 2:
        return None
    return _Facets(
        max((c.program for c in parted), key=lambda part: float(part.mass[part.free].sum()))
    )


def _program(unit: UnitProgram) -> LinearProgram:
    """Linear program over a facet: unknowns (x, t), a row per contact, two rows per axis.

    The rows of an axis j are t + q_j >= 0 and t - q_j >= 0.
    """
    lp, pull = unit.lp, unit.pull[unit.axes]
    count = len(lp.cost)
    corners = csc_array(np.vstack([pull, -pull]))
    ones = csc_array(np.ones((len(corners.toarray()), 1)))
    matrix = vstack(
        [hstack([lp.matrix, csc_array((lp.matrix.shape[0], 1))]), hstack([corners, ones])],
        format="csc",
    )
    inner = np.zeros(2 * len(pull))
    return LinearProgram(
        np.append(np.zeros(count), 1.0),
        matrix,
        np.concatenate([lp.row_lower, inner]),
        np.concatenate([lp.row_upper, inner + np.inf]),
        # t is between -1 and 0 by itself; with both bounds the first basis is dual feasible
        np.append(lp.lower, -1.0 - 1e-6),
        np.append(lp.upper, 1e-6),
    )


def _facet(
    program: Program, unit: UnitProgram, signs: Array, x: Array, multipliers: Array
) -> FacetOptimum:
    """Most stable direction of a facet, from the multipliers of its linear program.

    The multipliers of the corners are their coefficients in g.
    """
    size = len(unit.axes)
    shares = np.maximum(np.where(signs[unit.axes] > 0, multipliers[:size], multipliers[size:]), 0)
    total = float(shares.sum())
    gravity = np.zeros(3)
    gravity[unit.axes] = signs[unit.axes] * (shares / total if total > 0 else 1.0 / size)
    motion = program.full(x[:-1] / unit.length)
    return FacetOptimum(signs, gravity + 0.0, min(float(x[-1]), 0.0) * unit.mass, motion)


# The direction of gravity nearest to stable, by three measures, if no direction is stable.


Method = Literal["joint", "walk"]


class NearestDirection(Record):
    """A direction of gravity nearest to stable by a measure, and the measured value."""

    direction: Vector
    """Direction of gravity, unit."""
    value: float
    """z of LP (9) on the diamond or sphere [kg x length unit], or kappa [-]."""
    motion: Annotated[Array, Shape(None, 6)] | None
    """Displacements [length unit, rad], or for kappa accelerations [m/s^2, rad/s^2]. None above the
    size up to which displacements are found."""
    programs: int
    """Number of programs solved for the direction: LPs, or for kappa QPs."""


class BoundedDirection(NearestDirection):
    """A nearest direction, with a proved bound of its value."""

    bound: float
    """No direction is better than this."""


class Nearest(Record):
    """Directions of gravity that are nearest to stable, by three measures."""

    diamond: NearestDirection
    """On the paper's diamond, by the displacement program."""
    sphere: NearestDirection
    """On the unit sphere, by the displacement program."""
    kappa: BoundedDirection | None
    """By the instability kappa; None if it was not computed."""

    @property
    def programs(self) -> int:
        """Number of programs that were solved for all three directions."""
        ways = (self.diamond, self.sphere, self.kappa)
        return sum(way.programs for way in ways if way is not None)


def nearest(
    program: Program, *, method: Method = "joint", solved: DiamondOptimum | None = None
) -> Nearest:
    """Find the directions of gravity nearest to stable, by three measures.

    The values of the measures are 0 if some direction is stable.

    Parameters
    ----------
    program : Program
    method : {"joint", "walk"}
        For the diamond.
    solved : DiamondOptimum, optional
        Result of `joint`, if the caller has it.

    Raises
    ------
    InputError
        If loads are given.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("wedge-on-wedge")
    >>> found = nearest(build_program(assembly, contacts(assembly)))
    >>> np.round(found.sphere.direction, 6) + 0.0, round(found.sphere.value, 6)
    (array([ 0.27735 ,  0.      , -0.960769]), -0.83205)
    >>> round(found.kappa.value, 6)
    0.333333
    """
    optimum = walk(program) if method == "walk" else solved or joint(program)
    length = float(np.linalg.norm(optimum.gravity))
    on_diamond = _with_displacement(program, optimum.gravity / length, optimum.z, optimum.programs)
    sphere = nearest_on_sphere(program)
    if sphere is None:  # a direction is stable: the diamond has found it
        on_sphere = on_diamond
    else:
        on_sphere = _with_displacement(program, sphere.direction, sphere.z, sphere.programs)
    return Nearest(diamond=on_diamond, sphere=on_sphere, kappa=_least_unstable(program))


def _least_unstable(program: Program) -> BoundedDirection | None:
    """The direction of the least instability kappa, and how parts start to move there.

    None if no solver finished.
    """
    try:
        least = least_instability(program)
    except SolverError:
        return None
    motion = find_motion(program.turned(least.direction))
    return BoundedDirection(
        direction=frozen(least.direction),
        value=least.value,
        bound=least.bound,
        motion=frozen(motion.acceleration) if motion.known else None,
        programs=least.programs,
    )


def _with_displacement(
    program: Program, direction: Array, z: float, programs: int
) -> NearestDirection:
    shift = find_displacement(program.turned(direction)).displacement
    motion = None if shift is None else frozen(shift)
    return NearestDirection(direction=frozen(direction), value=z, motion=motion, programs=programs)
