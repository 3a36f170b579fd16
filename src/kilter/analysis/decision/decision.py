"""Decision on an assembly: verdict, verdict level and evidence, as every command reports them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from kilter.analysis.decision.judge import Judgement
from kilter.analysis.decision.open_question import OpenQuestion
from kilter.analysis.decision.ordinary_contacts import OpenTrial
from kilter.mechanics.program import Program
from kilter.tell.levels import level_of

if TYPE_CHECKING:
    from kilter.friction.answer import FrictionAnswer
    from kilter.second_order.answer.second_order_answer import SecondOrder

__all__ = ["Decision", "Word"]

Word = Literal["stable", "settles", "potentially-stable", "balanced", "unstable", "undecided"]


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """The verdict on an assembly with its evidence, as `decide` returns it."""

    verdict: Word
    program: Program
    """The program against which the certificate is proved."""
    judgement: Judgement
    """The proof: forces of equilibrium, or a motion."""
    friction: FrictionAnswer | None = None
    """The guarantee of friction; None if the verdict does not rest on friction."""
    second_order: SecondOrder | None = None
    """The answer of second order; None if no cluster rests without friction."""
    reasons: tuple[str, ...] = ()
    """Reasons why the verdict is undecided, in words."""
    question: OpenQuestion | None = None
    """The open pairs that decide an undecided verdict."""
    trial: OpenTrial | None = None
    """The level with the open pairs as ordinary contacts, if friction guarantees a level."""
    units: float = 0.0
    """Work of the solvers for this decision (`kilter.work`) [units]."""

    @property
    def level(self) -> str | None:
        """Verdict level that the assembly reaches, except "strict"; None if it does not hold."""
        return level_of(self.verdict)
