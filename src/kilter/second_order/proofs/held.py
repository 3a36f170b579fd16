"""Proof that parts are held to first order: equilibrium forces leave no motion neutral.

With f >= 0 and J^T f + w = 0, the neutral motions are those that keep every contact with f > 0, and
every joint, closed. A joint whose friction is below its limit does not move either. If their rows
have full rank, there are none: the energy rises to first order along every motion, a strict
minimum.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, read_only
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import NUMBER, Form, keys, list_of
from kilter.mechanics.rows import POSSIBLE
from kilter.second_order.gaps.joint_forms import on_joints, slipping
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.carrying import all_carry
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.second_order_tolerances import BALANCED, BEARS

__all__ = ["Held", "judge_held", "scaled_rows", "unbalanced"]


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """Equilibrium forces, (K,) [N], that prove that no neutral motion exists.

    Rows of joints about turns have torques [N x length unit].
    """

    FORM: ClassVar[Form] = keys(held=list_of(NUMBER))
    SURFACES: ClassVar[str] = "none"
    forces: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of held parts, for a proof file."""
        return {"held": self.forces.tolist()}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> Held:
        """Read a proof of held parts from JSON data."""
        return cls(np.array(data["held"], dtype=float))

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of held parts: why it fails, or the state and counts it proves."""
        certain = facts.program.taking(facts.program.kind != POSSIBLE)
        return judge_held(certain, self) or ("minimum", 0, 0)


def judge_held(program: Program, proof: Held) -> str:
    """Reason why a proof of held parts (without friction) fails; empty if it is valid."""
    forces = proof.forces
    if forces.shape != program.part_a.shape or not np.isfinite(forces).all():
        return "it does not have a finite force for each contact"
    joined = on_joints(program)
    if (forces[~joined] < 0).any():
        return "a contact force pulls"
    if slipping(program, forces).any():
        return "the friction of a joint is at its limit"
    limit = max(BALANCED, float(program.tolerance.max(initial=0.0)))
    if not unbalanced(program, forces) <= limit:
        return "its forces do not balance the load"
    over_arm = forces / program.arm  # torques of joints as forces
    carries = joined | (over_arm > BEARS * limit * np.abs(over_arm).max(initial=TINY))
    sizes = np.maximum(program.weight, program.force_sums(forces))[program.free]
    per = len(program.freedoms)
    rows = scaled_rows(program)[carries] @ diags_array(np.repeat(1 / sizes, per))
    missing = 2 * limit * np.sqrt(per * len(sizes))
    if not all_carry(csr_array(rows), over_arm[carries], missing, joined=joined[carries]):
        return "its forces leave a motion neutral"
    return ""


def unbalanced(program: Program, forces: Array) -> float:
    """Largest imbalance |J^T f + w| of a part, relative to its load and forces [-]."""
    return float(imbalances(program, forces).max(initial=0.0))


def imbalances(program: Program, forces: Array) -> Array:
    """Imbalance |J^T f + w| of each part, relative to its load and forces [-], shape (N,)."""
    left = np.abs(program.wrenches(forces) + program.load)
    left[:, 3:] /= program.radius[:, None]
    size = np.maximum(program.weight, program.force_sums(forces))
    left = left[:, program.freedoms]
    relative: Array = np.where(program.free, left.max(axis=1) / np.maximum(size, TINY), 0.0)
    return relative


def scaled_rows(program: Program) -> csr_array:
    """Matrix J of the rows, with turns in units of 1 / part radius, shape (K, n).

    Rows about turns are multiplied by their lever length.
    """
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    scale = diags_array(units[:, program.freedoms].reshape(-1))
    return csr_array(diags_array(program.arm) @ program.jacobian() @ scale)
