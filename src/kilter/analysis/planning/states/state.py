"""Verdict and proof of an assembly with some parts present and some of these held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.planning.states.state_programs import StatePrograms
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Mask
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import Program

__all__ = ["State"]


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Verdict and proof of a state: some parts of an assembly present, some of these held.

    Attributes
    ----------
    names : tuple of str
        Names of all N parts.
    present, free : ndarray of bool, shape (N,)
        Masks of the present parts, and of the present parts that are neither held nor grounded.
    stable : bool or None
        Whether contact forces can hold the state (level equilibrium); None if undecided.
        `kilter.check` requires the level settles by default: `States.level` gives the level.
    programs : StatePrograms
        Programs of the assembly, from which `program` is taken.
    outer : bool
        Whether the proof refers to the program with the forces of contacts that are not modelled.
    forces : ForceProof or None
        Proof that the state holds.
    motion : MotionProof or None
        Proof that the state falls.
    verdict : Verdict or None
        Answer of `kilter.check` with its own proof; None if a simpler method decided.
    """

    names: tuple[str, ...]
    present: Mask
    free: Mask
    stable: bool | None
    programs: StatePrograms
    outer: bool = False
    forces: ForceProof | None = None
    motion: MotionProof | None = None
    verdict: Verdict | None = None

    @property
    def program(self) -> Program:
        """Program of the state, to whose rows the proof refers.

        It is taken anew at each call, since the programs of thousands of states would fill the
        memory.
        """
        held = self.present & ~self.free
        take = self.programs.outer_of if self.outer else self.programs.of
        return take(self.present, held)

    @property
    def moving(self) -> list[str]:
        """Names of the parts that move in this state; empty if the state holds."""
        return [name for name, moves in zip(self.names, self.moves, strict=True) if moves]

    @property
    def moves(self) -> Mask:
        """Mask of the parts that move in this state, shape (N,)."""
        if self.motion is None:
            proved_verdict = None if self.stable is not False else self.verdict
            named = set() if proved_verdict is None else set(proved_verdict.moving)
            return np.array([name in named for name in self.names], dtype=bool)
        sizes = part_sizes(self.programs.whole, self.motion.motion, per_radius=False)
        moves: Mask = sizes > STILL * sizes.max(initial=0.0)
        return moves

    def __repr__(self) -> str:
        word = {True: "holds", False: "falls", None: "undecided"}[self.stable]
        free = int(self.free.sum())
        return f"<State: {int(self.present.sum())} parts, {free} free, {word}>"

    def __bool__(self) -> bool:
        raise TypeError("a state is neither true nor false: use .stable")
