"""Contacts whose equilibrium force is larger than rounding errors.

Forces f > 0 on rows J leave a residual r of the load. Let M = sum of f_k J_k J_k^T, positive
definite across the neutral motions with the least eigenvalue m there, and M y = -r. Then the forces
f_k (1 + J_k.y) balance exactly, and since f_k J_k J_k^T <= M

    |J_k.y|^2 <= (J_k.M^-1 J_k) (r.M^-1 r) <= |r|^2 / (f_k m)

so that all of them push if f_k m > |r|^2. The row of a joint may also pull: in M it has the weight
of the largest force, and no condition. A force at a corner that is needed only for a negligible
torque proves nothing: it may be rounding.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Mask
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.second_order_tolerances import BALANCED, BEARS

__all__ = ["all_carry", "carry_beyond_doubt", "carrying_rows"]

ROUNDING = 1e-13
"""Error of an eigenvalue, over the largest eigenvalue [-]."""


def carrying_rows(problem: Stationary, forces: Array) -> Mask:
    """Mask of the contact rows whose force, of shape (K,), is clearly above the tolerance."""
    limit = max(BALANCED, problem.blur)
    return np.asarray(
        problem.two_sided | (forces > BEARS * limit * np.abs(forces).max(initial=TINY))
    )


def carry_beyond_doubt(
    problem: Stationary, forces: Array, carries: Mask, neutral: Array, load: Array
) -> bool:
    """True if the forces on given rows remain positive after an exact correction of the balance.

    Arguments: `forces` (K,): forces over the weight [-]; those on other rows count as residual;
    `carries` (K,): the given rows; `neutral` (n, d): orthonormal basis of the motions that open
    none of these rows; `load` (n,): the load of the problem, or zero for self-stress.
    """
    rows, limit = problem.rows[carries], max(BALANCED, problem.blur)
    missing = float(np.linalg.norm(rows.T @ forces[carries] + load))
    missing += limit * np.sqrt(len(load)) * float(np.abs(problem.load).max(initial=0.0))
    joined = problem.two_sided[carries]
    return all_carry(csr_array(rows), forces[carries], missing, neutral, joined)


def all_carry(
    rows: csr_array,
    forces: Array,
    missing: float,
    neutral: Array | None = None,
    joined: Mask | None = None,
) -> bool:
    """True if forces (k,) on rows (k, n) remain positive after any correction of their residual.

    Arguments: `neutral` (n, d): orthonormal motions; the rows have to block all motions across
    them; `joined` (k,): rows of joints, which may also pull.
    """
    pushes = np.ones(len(forces), dtype=bool) if joined is None else ~joined
    weights = np.where(pushes, forces, max(float(np.abs(forces).max(initial=0.0)), 1.0))
    held = (rows.T @ diags_array(weights) @ rows).toarray()
    size = max(float(held.diagonal().max(initial=0.0)), TINY)
    least = max(missing**2 / float(forces[pushes].min(initial=np.inf)), ROUNDING * size)
    if neutral is not None:
        held += size * neutral @ neutral.T
    try:
        np.linalg.cholesky(held - least * np.eye(len(held)))
    except np.linalg.LinAlgError:
        return False
    return True
