"""The answer of `kilter.hold` with candidate straps, and the loads that the straps must hold.

Without a code the load is the assembly. With a code of load securing it is the assembly under the
gravity g - a of each acceleration a of the code, and the same straps must hold it each time.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.codes import code_accelerations
from kilter.assembly import Assembly, Strap
from kilter.contact import ContactSet
from kilter.errors import InputError, some_names
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.mechanics.rows import STRAP
from kilter.tell.hold_words import hold_sentence
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds, level_rank

if TYPE_CHECKING:
    from kilter.tell.answer_data.plan_data import HoldData

__all__ = ["Lashing", "LoadCase", "lashed", "load_cases"]


@dataclass(frozen=True, slots=True, eq=False)
class LoadCase:
    """An assembly that straps must hold: as given, or as it feels an acceleration of a code.

    Attributes
    ----------
    name : str
        Direction of the code; empty without a code.
    assembly : Assembly
        With the gravity that it feels.
    """

    name: str
    assembly: Assembly

    def change(self, straps: Sequence[Strap]) -> dict[str, Any]:
        """The change from the file to this load with straps, as a proof states it."""
        change: dict[str, Any] = {"straps": [strap.to_dict() for strap in straps]}
        return change | ({"gravity": self.assembly.gravity.tolist()} if self.name else {})


def load_cases(
    assembly: Assembly, code: str | None = None, forward: ArrayLike = (1.0, 0.0, 0.0)
) -> tuple[LoadCase, ...]:
    """The loads that straps must hold: the assembly, or one for each direction of a code.

    Raises
    ------
    InputError
        If the code does not exist, or a direction is invalid.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> cases = load_cases(stacks.tower(1), "eumos:0.5")
    >>> [case.name for case in cases], cases[0].assembly.gravity.tolist()
    (['forward', 'backward', 'left', 'right'], [4.905, 0.0, -9.81])
    """
    if code is None:
        return (LoadCase("", assembly),)
    cases = []
    for name, acceleration in code_accelerations(assembly, code, forward):
        motion = CarrierMotion(acceleration)
        motion.require_in_plane(assembly.planar)
        cases.append(LoadCase(name, carried_assembly(assembly, motion)))
    return tuple(cases)


def lashed(
    assembly: Assembly, contacts: ContactSet, straps: Sequence[Strap]
) -> tuple[Assembly, ContactSet]:
    """The assembly with further straps, and its contacts."""
    more = dataclasses.replace(assembly, straps=[*assembly.straps, *straps])
    return more, contacts.of(more)


@dataclass(frozen=True, slots=True, eq=False)
class Lashing(AnswerInWords):
    """Answer of `kilter.hold` with candidate straps: the fewest of them, or why there are none.

    Attributes
    ----------
    assembly : Assembly
        Without the candidates.
    contacts : ContactSet
    candidates : tuple of Strap
    code : dict or None
        `name` of the code of load securing, and its `forward` direction.
    cases : tuple of LoadCase
        The loads that the same straps must hold.
    chosen : tuple of int or None
        Indices of the straps of the answer; None without an answer.
    forces : tuple of ForceProof
        Forces that hold each load with these straps; empty without an answer.
    levels : tuple of (str or None)
        Level that `kilter.check` finds for each load with these straps.
    require : str
    least : int
        No set of fewer straps holds, by proof.
    motions : tuple of (int, tuple of int, MotionProof)
        Load and set of straps that does not hold it, each with its motion.
    impossible : bool
        True if the motions exclude every set.
    exhausted : bool
        False if a limit or an undecided set ended the search.
    seconds : float
    """

    answer: ClassVar[str] = "hold"

    assembly: Assembly
    contacts: ContactSet
    candidates: tuple[Strap, ...]
    code: Mapping[str, Any] | None
    cases: tuple[LoadCase, ...]
    chosen: tuple[int, ...] | None
    forces: tuple[ForceProof, ...]
    levels: tuple[str | None, ...]
    require: str
    least: int
    motions: tuple[tuple[int, tuple[int, ...], MotionProof], ...]
    impossible: bool
    exhausted: bool
    seconds: float

    @property
    def straps(self) -> tuple[Strap, ...] | None:
        """The straps of the answer; None without an answer."""
        return None if self.chosen is None else tuple(self.candidates[k] for k in self.chosen)

    @property
    def verdict(self) -> str:
        """Verdict: "held", "impossible" (no set of the candidates holds), or "undecided"."""
        if self.chosen is not None:
            return "held"
        return "impossible" if self.impossible else "undecided"

    @property
    def level(self) -> str | None:
        """The lowest level of the loads with these straps; None without an answer."""
        return min(self.levels, key=level_rank, default=None)

    @property
    def holds(self) -> bool:
        """Whether every load reaches the required level with these straps."""
        return holds(self.level, self.require)

    @property
    def pulls(self) -> dict[int, float]:
        """Tension, or largest computed pull, of each chosen strap [N], by its index."""
        before = len(self.assembly.straps)
        pulls = {k: self.candidates[k].tension or 0.0 for k in self.chosen or ()}
        for case, proof in zip(self.cases, self.forces, strict=False):
            program = build_program(*lashed(case.assembly, self.contacts, self.straps or ()))
            rows = np.flatnonzero(program.kind == STRAP)
            for strap, pull in zip(program.source[rows], proof.forces[rows], strict=True):
                if strap >= before and self.chosen is not None:
                    index = self.chosen[strap - before]
                    pulls[index] = max(pulls[index], float(pull))
        return pulls

    def to_dict(self) -> HoldData:
        """The lashing as JSON data, as printed by ``kilter hold --straps FILE --json``."""
        pulls = self.pulls
        levels = self.levels or (None,) * len(self.cases)
        answer: HoldData = {
            "verdict": self.verdict,
            "level": self.level,
            "require": self.require,
            "holds": self.holds,
            "why": None,
            "open_pairs": open_pairs_answer(self.assembly, self.contacts),
            "supports": None if self.chosen is None else [],
            "straps": [
                {
                    "candidate": k + 1,
                    "parts": list(self.candidates[k].parts),
                    "tension": self.candidates[k].tension,
                    "capacity": self.candidates[k].capacity,
                    "pull": pulls.get(k),
                }
                for k in self.chosen or ()
            ],
            "code": None if self.code is None else self.code["name"],
            "cases": [
                {
                    "name": case.name,
                    "acceleration": (self.assembly.gravity - case.assembly.gravity).tolist(),
                    "level": level,
                }
                for case, level in zip(self.cases, levels, strict=True)
                if self.code is not None
            ],
            "least": self.least,
            "fewest": self.chosen is not None,
            "motions": [],
            "candidates": len(self.candidates),
            "most": None,
            "units": self.assembly.units,
            "base": [part.name for part in self.assembly if part.grounded],
            "judged": len(self.motions) + len(self.forces),
            "exhausted": self.exhausted,
            "interrupted": False,
            "time_limit": None,
            "warnings": list(self.contacts.warnings),
            "seconds": {"solve": round(self.seconds, 6)},
            "sentence": "",  # made below from the other data
        }
        answer["sentence"] = hold_sentence(answer)
        return answer

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proof that these straps hold the assembly and fewer do not, for `kilter.verify`.

        Raises
        ------
        InputError
            If no straps were found and their absence is not proved.
        """
        if self.verdict == "undecided":
            raise InputError("nothing is proved about the straps, so there is no proof to write")
        stated: list[tuple[str, int, tuple[int, ...], ForceProof | MotionProof]] = []
        if self.chosen is not None:
            stated += [("held", k, self.chosen, forces) for k, forces in enumerate(self.forces)]
        stated += [("not enough", *motion) for motion in self.motions]
        proofs = []
        for about, k, chosen, certificate in stated:
            case, straps = self.cases[k], [self.candidates[index] for index in chosen]
            assembly, contacts = lashed(case.assembly, self.contacts, straps)
            by_motion = isinstance(certificate, MotionProof)
            program = build_program(assembly, contacts, possible=by_motion)
            if isinstance(certificate, MotionProof):
                certificate, evidence = check_motion(program, certificate.motion), None
            else:
                evidence = Evidence("open") if program.mu.any() else None
            data = make_proof(
                assembly, contacts, program, certificate, options or {}, evidence=evidence
            )
            subject = {"about": about, "chosen": list(chosen), "change": case.change(straps)}
            proofs.append((subject | ({"case": case.name} if case.name else {}), data))
        rules: dict[str, Any] = {
            "candidates": [strap.to_dict() for strap in self.candidates],
            "least": self.least,
        }
        if self.code is not None:
            rules["code"] = dict(self.code)
        return make_bundle("lashing", proofs, rules=rules)

    def __repr__(self) -> str:
        if self.straps is None:
            return f"<Lashing: {self.verdict}, {self.least} or more>"
        return f"<Lashing: {some_names([repr(strap) for strap in self.straps]) or 'nothing'}>"
