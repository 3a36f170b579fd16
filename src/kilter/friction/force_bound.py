"""A bound of all contact forces from a motion that opens every contact faster than it slides.

Take any motion y of the parts, u = J y. By the law (`kilter.friction.reduced_law`) f.u >= sum of fn
(un - mu |ut|) for f in Coulomb's cones. So if un - mu |ut| >= m > 0 at every point,

    m (sum of fn) <= f.u = y.J^T f = y.(a - w) <= (|y| - w.y) / 2

since |a - w/2| <= 1/2. Such a motion y exists unless forces in the cones can balance one another
without any load (self-stress: parts that jam). In that case no bound of the forces exists either.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.friction.reduced_law import ReducedLaw

__all__ = ["force_bound"]

ROUNDING = 1e-12
"""Relative increase of the bound that covers the rounding of its sums."""


def force_bound(law: ReducedLaw, motion: Array) -> float:
    """Upper bound of the sum of normal forces [-], from a motion that opens every contact."""
    if not len(law.group):
        return 0.0
    if motion.shape != law.load.shape or not np.isfinite(motion).all():
        return np.inf
    slip = np.linalg.norm((law.tangent @ motion).reshape(-1, law.directions), axis=1)
    friction_loss = np.append(law.mu * slip, 0.0)  # the last entry is for points without friction
    opening = law.normal @ motion - friction_loss[law.group]
    least_opening = float(opening.min()) - ROUNDING * float(np.linalg.norm(motion))
    if not least_opening > 0:
        return np.inf
    return float(np.linalg.norm(motion) - law.load @ motion) / 2 / least_opening * (1 + ROUNDING)
