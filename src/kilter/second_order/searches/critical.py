"""The critical motions: those that cost nothing to first order.

    Lambda = {f >= 0, J^T f + w = 0}        C = {J z >= 0, w.z = 0}

A row either carries a force in some equilibrium, or opens in some critical motion (Goldman and
Tucker). One linear program finds forces that carry on every row that can: C lies in the null
space of those rows, and is all of it where no other row can open or close there.
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

__all__ = ["Critical", "carrying_forces", "find_critical"]


@dataclass(frozen=True, slots=True, eq=False)
class Critical:
    """C = {basis y: sides y >= 0}.

    Attributes
    ----------
    forces : ndarray, shape (K,)
        An equilibrium that carries wherever one can.
    carries : ndarray of bool, shape (K,)
    basis : ndarray, shape (n, d)
        Orthonormal.
    sides : ndarray, shape (m, d)
        Unit rows; none where C is a space.
    """

    forces: Array
    carries: Mask
    basis: Array
    sides: Array


def find_critical(problem: Stationary, *, work: Work | None = None) -> Critical | None:
    """The critical motions; None where there is no equilibrium, or no solver finds one."""
    forces = carrying_forces(csr_array(problem.rows), problem.load, work=work)
    if forces is None:
        return None
    found, carries = forces
    basis = null_space(problem.rows[carries], problem.blur)
    sides = problem.rows[~carries] @ basis
    size = np.linalg.norm(sides, axis=1)
    turns = size > 1e-3 * np.sqrt(problem.blur)
    unit = sides[turns] / size[turns][:, None]
    _, first = np.unique(np.round(unit, 9), axis=0, return_index=True)
    return Critical(found, carries, basis, unit[np.sort(first)])


def carrying_forces(
    rows: csr_array, load: Array, *, work: Work | None
) -> tuple[Array, Mask] | None:
    """Forces of equilibrium that carry on every row that can, and which do, shape (K,).

    Max sum t:  J^T f + s w = 0,  0 <= t <= 1,  f >= t,  s >= 1;  f / s, and where t is 1.

    Parameters
    ----------
    rows : csr_array, shape (K, n)
    load : ndarray, shape (n,)
    """
    count, freedoms = rows.shape
    if count == 0:
        return None
    none = csc_array((freedoms, count))
    balance = hstack([rows.T, csc_array(load[:, None]), none])
    above = hstack([eye_array(count), csc_array((count, 1)), -eye_array(count)])
    cost = np.concatenate([np.zeros(count + 1), -np.ones(count)])
    x = optimum(
        LinearProgram(
            cost,
            csc_array(vstack([balance, above], format="csc")),
            np.zeros(freedoms + count),
            np.concatenate([np.zeros(freedoms), np.full(count, np.inf)]),
            np.concatenate([np.zeros(count), [1.0], np.zeros(count)]),
            np.concatenate([np.full(count + 1, np.inf), np.ones(count)]),
        ),
        work,
    )
    if x is None:
        return None
    forces, carries = x[:count] / x[count], x[count + 1 :] > 0.5
    return np.where(carries, forces, 0.0), carries
