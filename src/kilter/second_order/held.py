"""What is held to first order: forces of equilibrium that leave no motion neutral.

With f >= 0 and J^T f + w = 0, neutral motions are those that keep every contact with f > 0 closed.
Where the rows of these are of full rank, there are none: a strict minimum, and its energy rises to
first order along every motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, read_only
from kilter.mechanics.program import Program
from kilter.second_order.carrying import all_carry
from kilter.second_order.second_order_tolerances import BALANCED, BEARS

__all__ = ["Held", "find_held", "judge_held", "unbalanced"]

MOST_SPREAD = 20
"""Forces of up to this many free parts are spread over all contacts."""
ROUNDS = 50
"""Of spreading, ..."""
SHARE = 0.02
"""... until every contact carries this share of the mean force, or half of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """Forces, shape (K,) [N]."""

    forces: Array

    def __post_init__(self) -> None:
        read_only(self)


def find_held(program: Program, forces: Array) -> Held | None:
    """A proof from forces of equilibrium, shape (K,) [N]; None where none was found."""
    if not judge_held(program, Held(forces)):
        return Held(forces)
    if program.free.sum() > MOST_SPREAD or not forces.any():
        return None
    spread = _spread_out(program, forces)
    return None if spread is None or judge_held(program, Held(spread)) else Held(spread)


def _spread_out(program: Program, forces: Array) -> Array | None:
    """Forces of equilibrium on every contact, near to some: projected and cut in turn."""
    rows = _scaled_rows(program).toarray()
    if np.linalg.matrix_rank(rows) < rows.shape[1]:
        return None  # a motion opens nothing
    span, _ = np.linalg.qr(rows)
    least = SHARE * float(forces.mean())
    found = forces
    for _ in range(ROUNDS):
        change = np.maximum(found, least) - forces
        found = forces + change - span @ (span.T @ change)
        if found.min() > least / 2:
            return np.asarray(found)
    return None


def _scaled_rows(program: Program) -> csr_array:
    """J, turns times the radius of the part."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    return csr_array(program.jacobian() @ diags_array(units[:, program.freedoms].reshape(-1)))


def judge_held(program: Program, proof: Held) -> str:
    """Why a proof about contacts without friction does not hold; empty where it does."""
    forces = proof.forces
    if forces.shape != program.part_a.shape or not np.isfinite(forces).all():
        return "its forces are not those of the contacts"
    if (forces < 0).any():
        return "a contact force pulls"
    limit = max(BALANCED, float(program.tolerance.max(initial=0.0)))
    if not unbalanced(program, forces) <= limit:
        return "its forces do not balance the load"
    carries = forces > BEARS * limit * forces.max(initial=TINY)
    sizes = np.maximum(program.weight, program.force_sums(forces))[program.free]
    per = len(program.freedoms)
    rows = _scaled_rows(program)[carries] @ diags_array(np.repeat(1 / sizes, per))
    missing = 2 * limit * np.sqrt(per * len(sizes))
    none = np.zeros((rows.shape[1], 0))
    if not all_carry(csr_array(rows), forces[carries], missing, none):
        return "its forces leave a motion neutral"
    return ""


def unbalanced(program: Program, forces: Array) -> float:
    """|J^T f + w| of the part where it is most, over its load and forces [-]."""
    left = np.abs(program.wrenches(forces) + program.load)
    left[:, 3:] /= program.radius[:, None]
    size = np.maximum(program.weight, program.force_sums(forces))
    left = left[:, program.freedoms]
    return float((left.max(axis=1) / np.maximum(size, TINY))[program.free].max(initial=0.0))
