"""Is a direction the best of its facet? 0 in the superdifferential of z there.

At g the supergradients of z are -q for the q = sum_i m_i dr_i of all optimal dp. The value

    t = min over optimal dp of max over corners v of the facet of -q . v

is z(g) exactly where one of them lets z rise toward no corner. Else the multipliers of
the corners make the direction g' = sum_j l_j v_j toward which z rises at first. Any dp in A
bounds z from above, so t bounds z on the whole facet, however roughly "optimal dp" is taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.turning.virtual_work import UnitProgram
from kilter.analysis.turning_tolerances import (
    OPTIMAL,
    OPTIMAL_FACE,
)
from kilter.arrays import Array
from kilter.solvers.problem import LinearProgram

__all__ = ["Optimality", "is_best"]


@dataclass(frozen=True, slots=True, eq=False)
class Optimality:
    """Whether a direction is the `best` of its facet.

    `bound`: no direction of the facet has a greater z over the mass. `toward`, shape (3,):
    the point of the facet toward which z rises, where it does.
    """

    best: bool
    bound: float
    toward: Array


def is_best(unit: UnitProgram, signs: Array, gravity: Array, z: float) -> Optimality:
    """Test a direction of a facet for optimality; `z` is z(gravity) over the mass."""
    from kilter.solvers.highs import solve_linear

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
