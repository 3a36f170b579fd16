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
from scipy.sparse import csc_array, csr_array, hstack, vstack

from kilter.arrays import Array
from kilter.friction.reduced_law import ReducedLaw
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

__all__ = ["force_bound", "opening_motion"]

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


def opening_motion(law: ReducedLaw, *, work: Work) -> Array | None:
    """The motion that gives the least bound of the forces; None where there is none."""
    count, wide = len(law.load), law.directions
    points = len(law.group)
    smooth, rough = np.flatnonzero(law.group < 0), np.flatnonzero(law.group >= 0)
    lines = -csr_array(law.normal)
    own = law.group[rough]
    across = [
        -csr_array(law.tangent[own * wide + k].multiply(law.mu[own][:, None])) for k in range(wide)
    ]
    order = np.argsort(np.tile(np.arange(len(rough)), 1 + wide), kind="stable")
    cones = csr_array(vstack([lines[rough], *across]))[order]
    rows = csr_array(vstack([lines[smooth], cones]))
    ball = -csr_array(np.eye(count + 1))
    size = csr_array((rows.shape[0], 1))  # the first unknown is a bound of |y|
    bound = np.zeros(rows.shape[0] + count + 1)
    bound[: len(smooth)] = -1.0
    bound[len(smooth) : rows.shape[0] : 1 + wide] = -1.0
    program = ConicProgram(
        csc_array((count + 1, count + 1)),
        np.concatenate([[0.5], -0.5 * law.load]),
        csc_array(vstack([hstack([size, rows]), ball])),
        bound,
        0,
        len(smooth),
        np.array([*[1 + wide] * len(rough), count + 1]),
    )
    answer = solve_conic(program, work=work)
    if not points or not answer.found:
        return None
    return answer.x[1:]
