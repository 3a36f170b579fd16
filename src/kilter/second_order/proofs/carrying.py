"""Which contacts carry, whatever rounding leaves of the load.

Forces f > 0 on rows J miss r of what they are to balance. With M = sum of f_k J_k J_k^T, positive
definite across what is neutral, its least eigenvalue m there, and M y = -r, the forces
f_k (1 + J_k.y) balance to the last digit, and since f_k J_k J_k^T <= M

    |J_k.y|^2 <= (J_k.M^-1 J_k) (r.M^-1 r) <= |r|^2 / (f_k m)

so that all of them push where f_k m > |r|^2. A force that next to no torque comes of proves nothing
of a corner that carries: it may be all rounding.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Mask
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.second_order_tolerances import BALANCED, BEARS

__all__ = ["all_carry", "carry_beyond_doubt", "carrying_rows"]

ROUNDING = 1e-13
"""An eigenvalue may be off by this share of the largest."""


def carrying_rows(problem: Stationary, forces: Array) -> Mask:
    """Rows whose forces (K,) over the weight are more than what may be out of balance."""
    limit = max(BALANCED, problem.blur)
    return np.asarray(forces > BEARS * limit * forces.max(initial=TINY))


def carry_beyond_doubt(
    problem: Stationary, forces: Array, carries: Mask, neutral: Array, load: Array
) -> bool:
    """Whether some rows carry by forces that balance a load exactly.

    Parameters
    ----------
    forces : ndarray, shape (K,)
        Over the weight; those of other rows count as missing.
    carries : ndarray of bool, shape (K,)
    neutral : ndarray, shape (n, d)
        Orthonormal motions, all that open none of these rows.
    load : ndarray, shape (n,)
        What they balance: that of the problem, or none.
    """
    rows, limit = problem.rows[carries], max(BALANCED, problem.blur)
    missing = float(np.linalg.norm(rows.T @ forces[carries] + load))
    missing += limit * np.sqrt(len(load)) * float(np.abs(problem.load).max(initial=0.0))
    return all_carry(csr_array(rows), forces[carries], missing, neutral)


def all_carry(rows: csr_array, forces: Array, missing: float, neutral: Array | None = None) -> bool:
    """Whether forces (k,) on rows (k, n) stay pushes when they make good what is missing.

    True only where the rows hold all that is not in `neutral`, shape (n, d), orthonormal.
    """
    held = (rows.T @ diags_array(forces) @ rows).toarray()
    size = max(float(held.diagonal().max(initial=0.0)), TINY)
    least = max(missing**2 / float(forces.min(initial=np.inf)), ROUNDING * size)
    if neutral is not None:
        held += size * neutral @ neutral.T
    try:
        np.linalg.cholesky(held - least * np.eye(len(held)))
    except np.linalg.LinAlgError:
        return False
    return True
