"""Displacement program of the paper: its optimum z, and displacements that reach the optimum.

    minimise z = -w.dp,   J dp >= 0,   |dr_i|, |dtheta_i| <= 1                  LP (9)

in the units of the file, with gravity of length 1. The optimum is unique, but its displacements
are not. Of all optimal displacements, the answer gives the displacement of least 2-norm, which is
unique.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, eye_array, vstack

from kilter.analysis.analysis_tolerances import LEAST_IS_OPTIMAL, NO_DESCENT
from kilter.arrays import TINY, Array
from kilter.mechanics.clusters import cluster_groups
from kilter.mechanics.forms import displacement
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram, quadratic_program

LIMIT = 300
"""Largest number of free parts for which displacements are computed; z has no limit of size."""


@dataclass(frozen=True, slots=True, eq=False)
class Displacement:
    """Optimum z of the displacement program, with the displacements of the parts.

    `z` is at most 0 [kg x length unit]. `displacement` has shape (N, 6), translations [length
    unit] and rotations [rad], and is None for more than `LIMIT` free parts. Both are None if no
    solver finished.
    """

    z: float | None
    displacement: Array | None


def find_displacement(program: Program) -> Displacement:
    """Solve the displacement program: the greatest energy that bounded displacements release.

    The program always has an optimum. If no solver finishes, z is None, which says nothing about
    the assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("paper-figure-8")
    >>> found = find_displacement(build_program(assembly, contacts(assembly)))
    >>> [round(float(x), 3) + 0.0 for x in found.displacement[1:, [0, 2]].ravel()]
    [0.0, -1.0, 0.577, 0.0]
    """
    large = int(program.free.sum()) > LIMIT
    z, shift = 0.0, np.zeros((len(program.names), 6))
    if program.free.any():
        for cluster in cluster_groups(program):
            found = _of_group(cluster.program, z_only=large)
            if found.z is None:
                return found
            z += found.z
            if found.displacement is not None:
                shift += found.displacement
    return Displacement(z, None if large else shift)


def _of_group(program: Program, *, z_only: bool) -> Displacement:
    """Solve the displacement program of a group of clusters."""
    from kilter.solvers.highs import find_optimum

    count = int(program.free.sum())
    lp = displacement(program)
    size = max(float(np.abs(lp.cost).max(initial=0.0)), TINY)
    scaled = dataclasses.replace(lp, cost=lp.cost / size)
    answer = find_optimum(scaled, method="simplex" if count <= LIMIT else "interior")
    if not answer.optimal:
        return Displacement(None, None)
    z = min(float(lp.cost @ answer.x), 0.0)
    if z_only:
        return Displacement(z, None)
    return Displacement(z, program.full(_shortest(lp, answer.x, z)))


def _shortest(lp: LinearProgram, optimum: Array, z: float) -> Array:
    """Optimal unknowns of least norm: the point nearest to 0 on the optimal face of a program.

    Returns `optimum` if the projection is not accurate enough.
    """
    from kilter.solvers.clarabel import solve_quadratic

    count = len(lp.cost)
    size = float(np.abs(lp.cost).max(initial=0.0))
    if z >= -NO_DESCENT * size:  # the optimum is 0, which x = 0 reaches
        return np.zeros(count)
    two_sided = lp.row_upper == 0.0
    rows = csc_array(lp.matrix)
    box = eye_array(count, format="csc")
    objective = csc_array(lp.cost[None, :] / np.linalg.norm(lp.cost))
    matrix = vstack([objective, rows[two_sided], rows[~two_sided], box, -box], format="csc")
    bound = np.zeros(matrix.shape[0])
    bound[0] = z / float(np.linalg.norm(lp.cost))
    bound[-2 * count :] = -1.0
    quadratic = quadratic_program(
        csc_array(eye_array(count)), np.zeros(count), matrix, bound, 1 + int(two_sided.sum())
    )
    answer = solve_quadratic(quadratic)
    # an inaccurate projection is not optimal: then the optimum of the simplex method is returned
    better = answer.residual < LEAST_IS_OPTIMAL * max(1.0, float(np.abs(answer.x).max(initial=0.0)))
    return answer.x if better else optimum
