"""The motion that gives the least bound of the contact forces (`kilter.friction.force_bound`).

    min (|y| - w.y) / 2:   un - mu |ut| >= 1 at every point,   u = J y

is a conic program; where it has no solution, forces can balance one another without a load.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array, hstack, vstack

from kilter.arrays import Array
from kilter.friction.reduced_law import ReducedLaw
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

__all__ = ["opening_motion"]


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
