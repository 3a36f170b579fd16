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

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.turning.virtual_work import (
    UnitProgram,
    facets_of_diamond,
    unit_program,
)
from kilter.analysis.turning_tolerances import OPTIMAL
from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import LinearProgram

__all__ = ["DiamondOptimum", "FacetOptimum", "joint"]


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
    """[kg x length unit]"""
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
    """Those that were solved: all, or up to the first with z = 0."""
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
    unit = unit_program(program)
    signs = facets_of_diamond(program)
    model = KeptProgram(_program(unit), warm="dual", goal="point")
    optima: list[FacetOptimum] = []
    for facet in signs:
        first = len(unit.lp.row_lower)
        lower = np.concatenate([np.where(facet[unit.axes] > 0, 0.0, -np.inf)] * 2)
        lower[len(unit.axes) :] = np.where(facet[unit.axes] < 0, 0.0, -np.inf)
        rows = first + np.arange(len(lower))
        model.change_sides(rows, lower, np.full(len(lower), np.inf))
        answer = model.solve().required("the orientation of a facet")
        optima.append(_facet(program, unit, facet, answer.x, answer.multipliers[rows]))
        if not every and optima[-1].z >= -OPTIMAL * unit.mass:
            break
    best = max(optima, key=lambda optimum: optimum.z)
    return DiamondOptimum(best.gravity, best.z, tuple(optima), model.solves)


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
