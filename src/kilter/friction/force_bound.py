"""A bound of all contact forces: a motion that opens every contact faster than it slides.

Take any motion y of the parts, u = J y. By the law (`kilter.friction.reduced_law`)
f.u >= sum of fn (un - mu |ut|) for f in Coulomb's cones, so that, if un - mu |ut| >= m > 0 at
every point,

    m (sum of fn) <= f.u = y.J^T f = y.(a - w) <= (|y| - w.y) / 2

as |a - w/2| <= 1/2. Such a y exists unless forces in the cones can balance one another without
any load (parts that jam): then no bound of forces exists either.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.friction.reduced_law import ReducedLaw

__all__ = ["force_bound"]

ROUNDING = 1e-12
"""By how much the bound is raised for the rounding of its sums, of its own size."""


def force_bound(law: ReducedLaw, motion: Array) -> float:
    """The sum of all normal forces is at most this, in the units of the law; else infinity."""
    if not len(law.group):
        return 0.0
    if motion.shape != law.load.shape or not np.isfinite(motion).all():
        return np.inf
    slip = np.linalg.norm((law.tangent @ motion).reshape(-1, law.directions), axis=1)
    along = np.append(law.mu * slip, 0.0)  # the last for points without friction
    opening = law.normal @ motion - along[law.group]
    least = float(opening.min()) - ROUNDING * float(np.linalg.norm(motion))
    if not least > 0:
        return np.inf
    return float(np.linalg.norm(motion) - law.load @ motion) / 2 / least * (1 + ROUNDING)
