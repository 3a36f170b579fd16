"""State: what was found of an assembly with some parts present and some of these held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Mask
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import Program

__all__ = ["State"]


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """What was found of one state.

    Attributes
    ----------
    names : tuple of str
        Of all N parts.
    present, free : ndarray of bool, shape (N,)
        Parts that are there; those of them that are neither held nor grounded.
    stable : bool or None
        Whether forces that hold it exist; None: undecided.
    program : Program
        The rows of the state, of which the certificate speaks.
    forces : ForceProof or None
        Where it holds.
    motion : MotionProof or None
        Where it does not.
    verdict : Verdict or None
        The answer of `kilter.check`, where nothing less decided; then the evidence is there.
    """

    names: tuple[str, ...]
    present: Mask
    free: Mask
    stable: bool | None
    program: Program
    forces: ForceProof | None = None
    motion: MotionProof | None = None
    verdict: Verdict | None = None

    @property
    def moving(self) -> list[str]:
        """Parts that the motion moves; none where it holds."""
        return [name for name, moves in zip(self.names, self.moves, strict=True) if moves]

    @property
    def moves(self) -> Mask:
        """The same as a mask, shape (N,)."""
        if self.motion is None:
            told = None if self.stable is not False else self.verdict
            named = set() if told is None else set(told.moving)
            return np.array([name in named for name in self.names], dtype=bool)
        sizes = part_sizes(self.program, self.motion.motion, per_radius=False)
        moves: Mask = sizes > STILL * sizes.max(initial=0.0)
        return moves

    def __repr__(self) -> str:
        word = {True: "holds", False: "falls", None: "undecided"}[self.stable]
        free = int(self.free.sum())
        return f"<State: {int(self.present.sum())} parts, {free} free, {word}>"

    def __bool__(self) -> bool:
        raise TypeError("a state is neither true nor false: use .stable")
