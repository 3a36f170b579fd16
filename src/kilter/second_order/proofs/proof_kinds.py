"""The six kinds of second-order proof, behind a common protocol.

Each kind is named in a proof file by a key that no other kind has.
"""

from __future__ import annotations

from typing import Any, ClassVar, Protocol

from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import Form
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.proofs.fall_proof import Fall
from kilter.second_order.proofs.level_rest import Held, LevelRest
from kilter.second_order.proofs.minimum_proof import LockedTurns, MinimumProof
from kilter.second_order.proofs.stopped import Stopped


class SecondOrderProof(Protocol):
    """Common methods of the second-order proofs: write, read and verify."""

    FORM: ClassVar[Form]
    """Form of its data in a proof file."""
    SURFACES: ClassVar[str]
    """One of "none", "known", "exact", "all". The forms of gaps that the proof uses: none; those
    that are known; those without any doubt; those of all contacts that have a unique normal."""

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof, for a proof file."""

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> SecondOrderProof:
        """Read a proof from JSON data of the form `FORM`.

        Raises `MalformedProof` if numbers do not fit each other, or motions do not fit the parts.
        """

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof: return the reason of failure, or the state and counts it proves."""


KINDS: dict[str, type[SecondOrderProof]] = {
    "held": Held,
    "level": LevelRest,
    "locked": LockedTurns,
    "stopped": Stopped,
    "first": Fall,
    "basis": MinimumProof,
}
"""Class of each kind of proof, by its key in a proof file."""
