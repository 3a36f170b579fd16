"""The motion that opens all contacts and gives the smallest bound of the contact forces.

    min (|y| - w.y) / 2:   un - mu |ut| >= 1 at every point,   u = J y

is the conic program of `kilter.mechanics.opening`. If it has no solution, forces can balance one
another without a load.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array
from kilter.friction.reduced_law import ReducedLaw
from kilter.mechanics.opening import opening_program
from kilter.solvers.clarabel import solve_conic
from kilter.work import Work

__all__ = ["opening_motion"]


def opening_motion(law: ReducedLaw, *, work: Work) -> Array | None:
    """Motion that opens all contacts, with the least bound of forces, (n,); None if none does."""
    rough = np.flatnonzero(law.group >= 0)
    rough_group, directions = law.group[rough], law.directions
    program = opening_program(
        csr_array((0, len(law.load))),  # joints are eliminated
        law.normal[np.flatnonzero(law.group < 0)],
        [
            law.normal[rough],
            *[law.tangent[rough_group * directions + k] for k in range(directions)],
        ],
        law.mu[rough_group],
        load=law.load,
    )
    answer = solve_conic(program, work=work)
    if not len(law.group) or not answer.found:
        return None
    return answer.x[1:]
