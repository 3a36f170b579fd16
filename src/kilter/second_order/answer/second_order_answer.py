"""What second order says of parts that are stable to first order, with its evidence.

    minimum    a strict minimum of its energy, parts of revolution may spin: small pushes do
               not move it away, whatever the friction
    free       the same across motions that keep every gap and the energy: it rolls or slides freely
    balanced   a path leads down: the slightest push makes it fall, unless friction holds it
    open       neither is known; `why` says what is missing

That of one cluster is found in `one_cluster`, that of all in `whole`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.mechanics.program import Program
from kilter.second_order.answer.oscillation import least_frequency
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.rolling import Rolling
from kilter.second_order.parts.clusters import State
from kilter.second_order.proofs.fall_proof import Configuration, Fall
from kilter.second_order.proofs.paths import Path
from kilter.second_order.proofs.proof_kinds import Proof
from kilter.second_order.searches.decide import Decision

__all__ = ["LATE", "SPENT", "SecondOrder", "answer_of", "open_answer"]

LATE = "the time limit was met"
SPENT = "its work is spent; level strict or a higher effort continues"
NAMED = 3
"""Parts that a phrase names; more are counted."""


@dataclass(frozen=True, slots=True, eq=False)
class SecondOrder:
    """What second order says.

    Attributes
    ----------
    state : {"minimum", "free", "balanced", "open"}
    neutral, free, blocked, undecided : int
        Dimensions of the motions that cost nothing to first order, and of those among them that
        are proved free, that cost energy or may gain some, and of which neither is known.
    rate : float or None
        Of a minimum, the least angular frequency of small oscillations that is proved; of a
        balanced one, the rate of growth along its path [1/s].
    motion : ndarray or None, shape (N, 6)
        How it falls, or moves freely: the part that moves most by 1 length unit.
    moving : ndarray of int
        Parts that move so.
    why : str
        Why it is open.
    decision : Decision or None
        The numbers, with their proof.
    problem : Stationary or None
        What the proof is about.
    configuration : Configuration or None
        Of a balanced one, where all contacts are of bodies that can be held apart exactly.
    program : Program or None
        What `problem` and `decision` are about; its free parts are those of one cluster.
    idle : ndarray of int
        Contacts of its cluster that carry nothing, and were left out of `program`: without them
        less keeps it, and it stays.
    rolling : Rolling or None
        Of what is balanced with friction at its contacts: whether that holds it.
    clusters : tuple of SecondOrder
        The answers that this one joins, where there are several clusters; what moves is that of
        all, the numbers and the configuration are those of the one that decides.
    """

    state: State
    neutral: int
    free: int
    blocked: int
    undecided: int
    rate: float | None
    motion: Array | None
    moving: Index
    why: str
    decision: Decision | None = None
    problem: Stationary | None = None
    configuration: Configuration | None = None
    program: Program | None = None
    idle: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    rolling: Rolling | None = None
    clusters: tuple[SecondOrder, ...] = ()

    @property
    def proof(self) -> Proof | None:
        """The proof of one cluster."""
        proof = None if self.decision is None else self.decision.proof
        if isinstance(proof, Path):
            return Fall(proof, None if self.configuration is None else self.configuration.motion)
        return proof

    @property
    def strict(self) -> bool:
        """Whether no small push makes it fall, as far as that is proved, friction as it is."""
        if self.clusters:
            return all(one.strict for one in self.clusters)
        held = self.rolling is not None and self.rolling.state == "holds"
        return self.state in ("minimum", "free") or (self.state == "balanced" and held)

    @property
    def counted(self) -> bool:
        """Whether its motions were looked at; where not, its counts of 0 say nothing."""
        if self.clusters:
            return all(one.counted for one in self.clusters)
        return self.decision is not None and (self.state != "open" or self.neutral > 0)

    def left_open(self, names: tuple[str, ...]) -> str:
        """The questions that are open, as one short phrase with the reason; empty if none is.

        Parameters
        ----------
        names : tuple of str
            Names of all parts.
        """
        still = [one for one in self.clusters or (self,) if one.state == "open"]
        if still:
            free = np.any([one.program.free for one in still if one.program is not None], axis=0)
            whys = " and ".join(dict.fromkeys(one.why for one in still))
            return f"whether a small push makes {_named(names, np.flatnonzero(free))} fall: {whys}"
        if self.rolling is not None and self.rolling.state == "open":
            return f"whether friction holds {_named(names, self.moving)} against a small push"
        return ""

    def to_dict(self, names: tuple[str, ...]) -> dict[str, Any]:
        """The answer of `kilter check --json`; the motion by part."""
        by_part = None if self.motion is None else {
            names[k]: (self.motion[k] + 0.0).tolist() for k in self.moving.tolist()
        }  # fmt: skip
        return {
            "state": self.state,
            "neutral": self.neutral if self.counted else None,
            "free": self.free if self.counted else None,
            "blocked": self.blocked if self.counted else None,
            "undecided": self.undecided if self.counted else None,
            "rate": self.rate,
            "motion": by_part,
            "rolling": None if self.rolling is None else self.rolling.state,
            "why": self.why or None,
            "left_open": self.left_open(names) or None,
        }


def _named(names: tuple[str, ...], parts: Index) -> str:
    """The first parts by name, and the number of the others."""
    shown = [names[k] for k in parts[:NAMED].tolist()]
    if len(parts) > NAMED:
        return f"{', '.join(shown)} or {len(parts) - NAMED} more"
    return " or ".join(shown)


def open_answer(why: str, program: Program) -> SecondOrder:
    """That nothing is known, and why."""
    none = np.zeros(0, dtype=np.int64)
    return SecondOrder("open", 0, 0, 0, 0, None, None, none, why, program=program)


def answer_of(program: Program, problem: Stationary, decision: Decision) -> SecondOrder:
    """A decision without more."""
    none = np.zeros(0, dtype=np.int64)
    return SecondOrder(
        decision.state,
        decision.neutral,
        decision.free,
        decision.blocked,
        decision.undecided,
        least_frequency(program, problem, decision.proof),
        None,
        none,
        decision.why,
        decision,
        problem,
        program=program,
    )
