"""Fixture: the fewest supports that hold an assembly, and the proof that fewer are not enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.analysis.planning.hold.least_supports import LeastSupports
from kilter.analysis.planning.hold.supported import Supported, SupportedState
from kilter.arrays import Array
from kilter.contact.supports import Support
from kilter.errors import InputError
from kilter.mechanics.bundle import apply_change, make_bundle
from kilter.mechanics.certificate import check_motion, part_sizes
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.tell.hold_words import hold_sentence
from kilter.tell.html import html_of
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds

if TYPE_CHECKING:
    from kilter.tell.answer_data.plan_data import HoldData

__all__ = ["Fixture"]


@dataclass(frozen=True, slots=True, eq=False)
class Fixture(AnswerInWords):
    """Answer of `kilter.hold`: the fewest supports, or the proof that all candidates together fail.

    Attributes
    ----------
    supported : Supported
        Assembly with its candidates.
    found : LeastSupports
    most : int or None
        Largest number of supports that the search considered.
    require : str
        The required level.
    time_limit : float or None
        Limit that stopped the search [s]; None if the search did not reach it.
    interrupted, exhausted : bool
        Whether an interrupt stopped the search; whether the search was complete.
    seconds : mapping
        Duration of each stage [s].
    """

    answer: ClassVar[str] = "hold"

    supported: Supported
    found: LeastSupports
    most: int | None
    require: str
    time_limit: float | None
    interrupted: bool
    exhausted: bool
    seconds: Mapping[str, float]

    @property
    def candidates(self) -> tuple[Support, ...]:
        """All candidate supports of the fixture."""
        return self.supported.supports

    @property
    def supports(self) -> list[Support] | None:
        """The smallest set of candidates with which the assembly holds; None if none was found."""
        if self.found.state is None:
            return None
        return [self.candidates[k] for k in sorted(self.found.state.chosen)]

    @property
    def least(self) -> int:
        """Proved lower bound of the number of supports that hold the assembly."""
        return self.found.least

    @property
    def fewest(self) -> bool:
        """Whether it is proved that fewer supports than these are not enough."""
        return self.found.state is not None and len(self.found.state.chosen) == self.least

    @property
    def verdict(self) -> str:
        """Verdict: "held", "impossible" (all candidates together are not enough) or "undecided"."""
        if self.found.state is not None:
            return "held"
        return "impossible" if self.found.enough is False else "undecided"

    @property
    def level(self) -> str | None:
        """Verdict level that the assembly reaches with the supports; None without supports."""
        state = self.found.state
        return None if state is None or state.decision is None else state.decision.level

    @property
    def holds(self) -> bool:
        """Whether the assembly reaches the required verdict level with the supports."""
        return holds(self.level, self.require)

    def forces(self) -> list[Array | None]:
        """Force of each support on its part [N], shape (3,); None for a grip.

        A grip also has a torque.
        """
        state = self.found.state
        if state is None or state.forces is None or self.supports is None:
            return []
        proof, program = state.forces, state.program
        of = self.supported.support_rows(program)
        total = proof.forces[:, None] * program.normal + proof.friction
        pushes: list[Array | None] = []
        for k in sorted(state.chosen):
            support = self.candidates[k]
            place = self.supported.place_of(k)
            push = total[of == place].sum(axis=0) if place is not None else None
            if push is not None and support.capacity:
                push = push - support.capacity * support.pushing(self.supported.assembly)
            pushes.append(push)
        return pushes

    def to_dict(self) -> HoldData:
        """The fixture as JSON data, as printed by ``kilter hold --json``."""
        assembly = self.supported.assembly
        forces = self.forces()
        answer: HoldData = {
            "verdict": self.verdict,
            "level": self.level,
            "require": self.require,
            "holds": self.holds,
            "why": self._why(),
            "open_pairs": open_pairs_answer(assembly, self.supported.contacts),
            "supports": None
            if self.supports is None
            else [
                {**entry.to_dict(), "force": None if push is None else push.tolist()}
                for entry, push in zip(self.supports, forces, strict=True)
            ],
            "straps": None,
            "code": None,
            "cases": [],
            "least": self.least,
            "fewest": self.fewest,
            "motions": [
                {
                    "stopped_by": [self.candidates[k].name for k in sorted(entry.shares)],
                    "moving": _moving(entry.state),
                }
                for entry in self.found.motions
            ],
            "candidates": len(self.candidates),
            "most": self.most,
            "units": assembly.units,
            "base": [part.name for part in assembly if part.grounded],
            "judged": self.supported.asked,
            "exhausted": self.exhausted,
            "interrupted": self.interrupted,
            "time_limit": self.time_limit,
            "warnings": list(self.supported.contacts.warnings),
            "seconds": {key: round(value, 6) for key, value in self.seconds.items()},
            "sentence": "",  # made below from the other data
        }
        answer["sentence"] = hold_sentence(answer)
        return answer

    def _why(self) -> str | None:
        """Reason why the verdict level is only equilibrium, as in `Verdict.why`; else None."""
        state = self.found.state
        decision = None if state is None else state.decision
        if decision is None or decision.level != "equilibrium":
            return None
        if decision.verdict == "balanced":
            return "balanced"
        return None if decision.friction is None else decision.friction.why

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proof that the supports hold the assembly and fewer do not, for `kilter.verify`.

        Parameters
        ----------
        options : dict, optional
            Options with which the file is read.

        Raises
        ------
        InputError
            If no supports were found and their absence is not proved.
        """
        if self.verdict == "undecided":
            raise InputError(
                "no supports were found and nothing is proved, so there is no proof to write"
            )
        stated: list[tuple[str, SupportedState]] = []
        if self.found.state is not None:
            stated.append(("held", self.found.state))
        stated += [("not fewer", entry.state) for entry in self.found.motions]
        proofs = []
        for about, state in stated:
            gripped, others = self.supported.given(state.chosen)
            change = {"held": gripped, "supports": [entry.to_dict() for entry in others]}
            statement = {"about": about, "supports": sorted(state.chosen), "change": change}
            proofs.append((statement, self._proof(state, change, options or {})))
        rules = {"candidates": [entry.to_dict() for entry in self.candidates], "least": self.least}
        return make_bundle("hold", proofs, rules=rules)

    def _proof(
        self, state: SupportedState, change: dict[str, Any], options: dict[str, Any]
    ) -> dict[str, Any]:
        """Proof of the verdict on a set of supports, as data for a proof file."""
        assembly, contacts = apply_change(self.supported.assembly, self.supported.contacts, change)
        program = build_program(assembly, contacts, possible=state.stable is False)
        if state.motion is not None:
            motion = check_motion(program, state.motion.motion)
            return make_proof(assembly, contacts, program, motion, options)
        evidence = Evidence("open") if program.mu.any() else None
        return make_proof(assembly, contacts, program, state.forces, options, evidence=evidence)

    def _repr_html_(self) -> str:
        """The fixture as HTML for a notebook."""
        return html_of(self.to_dict())

    def __repr__(self) -> str:
        if self.supports is None:
            return f"<Fixture: {self.verdict}, {self.least} or more>"
        names: Sequence[str] = [support.name for support in self.supports]
        return f"<Fixture: {', '.join(names) or 'nothing'}>"

    def __bool__(self) -> bool:
        raise TypeError("a fixture is neither true nor false: use .verdict")


def _moving(state: SupportedState) -> list[str]:
    """Names of the parts that move in the proved motion of a set of supports."""
    assert state.motion is not None
    sizes = part_sizes(state.program, state.motion.motion, per_radius=False)
    moves = sizes > STILL * np.max(sizes, initial=0.0)
    return [name for name, moving in zip(state.program.names, moves, strict=True) if moving]
