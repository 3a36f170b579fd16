"""Critical motions: motions that close no contact and cost no energy to first order.

    Lambda = {f >= 0, J^T f + w = 0}        C = {J z >= 0, w.z = 0}

The rows of joints are equations in both. Each other row either carries a force in some equilibrium,
or opens in some critical motion (Goldman and Tucker). A linear program finds forces that are
positive on every row that can carry. C lies in the null space of these rows and of the joints, and
equals it if no other row opens or closes there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array, hstack, vstack

from kilter.arrays import Array, Mask
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.searches.counted_program import optimum
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

WITHIN = 0.999
"""Largest friction of a joint that is sought, over its limit [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Critical:
    """Cone of the critical motions, as a basis with inequalities, and the forces that prove it."""

    forces: Array
    """Forces of equilibrium, over the weight [-], positive on every row that can carry, shape
    (K,)."""
    carries: Mask
    """Rows that carry, shape (K,)."""
    basis: Array
    """Orthonormal basis of the null space of these rows, shape (n, d)."""
    sides: Array
    """Unit rows, shape (m, d); empty if C is a linear space."""


def find_critical(problem: Stationary, *, work: Work | None = None) -> Critical | None:
    """Compute the cone of critical motions; None if no equilibrium forces were found."""
    answer = carrying_forces(
        csr_array(problem.rows),
        problem.load,
        two_sided=problem.joined,
        limits=problem.limits,
        work=work,
    )
    if answer is None:
        return None
    forces, carries = answer
    basis = null_space(problem.rows[carries], problem.blur)
    sides = problem.rows[~carries] @ basis
    size = np.linalg.norm(sides, axis=1)
    turns = size > 1e-3 * np.sqrt(problem.blur)
    unit = sides[turns] / size[turns][:, None]
    _, first = np.unique(np.round(unit, 9), axis=0, return_index=True)
    return Critical(forces, carries, basis, unit[np.sort(first)])


def carrying_forces(
    rows: csr_array,
    load: Array,
    *,
    two_sided: Mask | None = None,
    limits: Array | None = None,
    work: Work | None,
) -> tuple[Array, Mask] | None:
    """Equilibrium forces, positive on every row that can carry force, and a mask of these rows.

    Max sum t:  J^T f + s w = 0,  0 <= t <= 1,  f >= t,  s >= 1.  The forces are f / s, shape (K,),
    and the mask is t = 1. None if there is no equilibrium, or the work is over.

    Arguments: `rows` (K, n); `load` (n,); `two_sided` (K,): rows of joints: they count as rows that
    carry, and their forces have either sign; `limits` (K,): forces of rows are below these limits,
    with a margin (`WITHIN`).
    """
    count, freedoms = rows.shape
    if count == 0:
        return None
    none = csc_array((freedoms, count))
    balance = hstack([rows.T, csc_array(load[:, None]), none])
    above = hstack([eye_array(count), csc_array((count, 1)), -eye_array(count)])
    joined = np.zeros(count, dtype=bool) if two_sided is None else two_sided
    free = np.where(joined, -np.inf, 0.0)
    rubs = np.flatnonzero(np.isfinite(limits)) if limits is not None else np.zeros(0, dtype=int)
    one = csc_array((np.ones(len(rubs)), (np.arange(len(rubs)), rubs)), shape=(len(rubs), count))
    most = csc_array(WITHIN * (np.zeros(0) if limits is None else limits[rubs])[:, None])
    rest = csc_array((len(rubs), count))
    within = vstack([hstack([-one, most, rest]), hstack([one, most, rest])])
    cost = np.concatenate([np.zeros(count + 1), -np.ones(count)])
    x = optimum(
        LinearProgram(
            cost,
            csc_array(vstack([balance, above, within], format="csc")),
            np.concatenate([np.zeros(freedoms), free, np.zeros(2 * len(rubs))]),
            np.concatenate([np.zeros(freedoms), np.full(count + 2 * len(rubs), np.inf)]),
            np.concatenate([free, [1.0], np.zeros(count)]),
            np.concatenate([np.full(count + 1, np.inf), np.where(joined, 0.0, 1.0)]),
        ),
        work,
    )
    if x is None:
        return None
    forces, carries = x[:count] / x[count], joined | (x[count + 1 :] > 0.5)
    return np.where(carries, forces, 0.0), carries
