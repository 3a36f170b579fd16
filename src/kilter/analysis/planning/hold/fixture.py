"""Fixture: the fewest supports or straps that hold an assembly, and the proof that fewer do not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

from kilter.analysis.decision.open_question import AnsweredPair, answered_pairs
from kilter.assembly import Assembly, Strap
from kilter.contact import ContactSet
from kilter.contact.supports import Support
from kilter.errors import InputError, some
from kilter.mechanics.bundle import apply_change, make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.tell.levels import holds
from kilter.tell.plan_words import hold_sentence
from kilter.tell.record import Answer, InPython, LevelWord, Record, UnitWord, Vector, key, keys_of


class HeldSupport(Record):
    """A support of a fixture, and its force on the part."""

    kind: str
    """Grip, finger, prop, vacuum or magnet."""
    part: str
    """Part that it holds."""
    point: Vector | None
    """Point of action [length unit]; null for a grip."""
    direction: Vector | None
    """Unit vector along which it pushes the part; null for a prop that pushes upwards."""
    mu: float
    """Friction coefficient across the direction [-]."""
    capacity: float
    """Largest pull of a vacuum or magnet [N]."""
    on: str | None
    """Part that a prop stands on; null: the ground."""
    name: str
    """Name of the candidate."""
    force: Vector | None
    """Least force that suffices [N]: the supports together carry least, by the sum of squares of
    their forces and of torques over the radius of the part; null if it is not known."""
    torque: Vector | None = None
    """Torque of a grip about the centre of mass of its part [N m]; null for other supports."""

    def __repr__(self) -> str:
        return f"<Support: {self.name}>"


class ChosenStrap(Record):
    """A strap of the answer of hold, with its pull."""

    candidate: int
    """Number in the list of candidates, from 1."""
    parts: tuple[str, ...]
    """Parts that it joins, in the order of its path."""
    tension: float | None
    """Tension of a strap that is tensioned [N]."""
    capacity: float | None
    """Largest pull of a strap that is not tensioned [N]."""
    pull: float | None
    """Tension, or largest computed pull [N]."""
    strap: InPython[Strap]
    """The strap itself."""


class StrapCase(Record):
    """A direction of a code of load securing, and the level with the straps of the answer."""

    name: str
    """Direction of the code."""
    acceleration: Vector
    """Acceleration of the carrier [m/s^2]."""
    level: LevelWord | None
    """Level with the straps; null without straps."""


class StoppedMotion(Record):
    """A motion without supports, and the candidate supports that stop it."""

    stopped_by: tuple[str, ...]
    """Candidates that may stop it."""
    moving: list[str]
    """Parts that move."""


Stated = tuple[Mapping[str, Any], ForceProof | MotionProof]
"""Subject of a proof with its change of the assembly, and the forces or motion that prove it."""


class Fixture(Answer):
    """Answer of `kilter.hold`: the fewest supports or straps, or why there are none."""

    answer: ClassVar[str] = "hold"

    level: LevelWord | None
    """Level that the assembly reaches with the supports; null without supports."""
    require: LevelWord
    """Required level."""
    why: str | None = None
    """Reason why the level is only equilibrium, as for check."""
    supports: tuple[HeldSupport, ...] | None
    """Smallest set of supports with which the assembly holds; null if none was found."""
    straps: tuple[ChosenStrap, ...] | None = None
    """Smallest set of straps, empty if none was found; null: straps were no candidates."""
    code: str | None = None
    """Code of load securing; null: the load as it is given."""
    cases: tuple[StrapCase, ...] = ()
    """Directions of the code."""
    least: int
    """Proved lower bound of the number of supports."""
    motions: tuple[StoppedMotion, ...] = ()
    """Motions without supports, of which the supports stop each."""
    most: int | None = None
    """Largest number of supports that the search considered."""
    judged: int
    """Number of judged sets."""
    exhausted: bool
    """Whether the search was complete."""
    interrupted: bool = False
    """Whether an interrupt stopped the search."""
    time_limit: float | None = None
    """Limit that stopped the search [s]; null if the search did not reach it."""
    seconds: dict[str, float]
    """Duration of each stage [s]."""
    assembly: InPython[Assembly]
    """Assembly without the candidates."""
    contacts: InPython[ContactSet]
    """Contacts of this assembly."""
    offered: InPython[Sequence[Support] | Sequence[Strap]]
    """All candidates."""
    chosen: InPython[tuple[int, ...] | None]
    """Indices of the candidates of the answer."""
    impossible: InPython[bool]
    """Whether all sets of candidates are proved not to hold it."""
    stated: InPython[Sequence[Stated]]
    """Proofs: that the candidates of the answer hold it, and that fewer do not."""
    rules: InPython[Mapping[str, Any] | None] = None
    """Further rules of the proof file: the code."""

    @property
    @key
    def verdict(self) -> Literal["held", "impossible", "undecided"]:
        """Whether the assembly is held, or no set of the candidates holds it."""
        if self.chosen is not None:
            return "held"
        return "impossible" if self.impossible else "undecided"

    @property
    @key
    def holds(self) -> bool:
        """Whether the assembly reaches the required verdict level."""
        return holds(self.level, self.require)

    @property
    @key
    def open_pairs(self) -> tuple[AnsweredPair, ...]:
        """Open pairs of the assembly."""
        return answered_pairs(self.assembly, self.contacts)

    @property
    @key
    def fewest(self) -> bool:
        """Whether it is proved that fewer are not enough."""
        return self.chosen is not None and len(self.chosen) == self.least

    @property
    @key
    def candidates(self) -> int:
        """Number of candidates."""
        return len(self.offered)

    @property
    @key
    def units(self) -> UnitWord:
        """Length unit."""
        return self.assembly.units

    @property
    @key
    def base(self) -> list[str]:
        """Held parts of the file."""
        return [part.name for part in self.assembly if part.grounded]

    @property
    @key
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the contacts."""
        return self.contacts.warnings

    @property
    @key
    def sentence(self) -> str:
        """The answer in words."""
        return hold_sentence({k: getattr(self, k) for k in keys_of(Fixture) if k != "sentence"})

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proof that these candidates hold the assembly and fewer do not, for `kilter.verify`.

        `options` are those with which the file is read.

        Raises
        ------
        InputError
            If no candidates were found and their absence is not proved.
        """
        kind, noun = ("hold", "supports") if self.straps is None else ("lashing", "straps")
        if self.verdict == "undecided":
            raise InputError(
                f"no {noun} were found and nothing is proved, so there is no proof to write"
            )
        proofs = [(subject, self._proof(subject, proof, options)) for subject, proof in self.stated]
        rules = {"candidates": [item.to_dict() for item in self.offered], "least": self.least}
        return make_bundle(kind, proofs, rules={**rules, **(self.rules or {})})

    def _proof(
        self,
        subject: Mapping[str, Any],
        proof: ForceProof | MotionProof,
        options: dict[str, Any] | None,
    ) -> dict[str, Any]:
        """Proof about a set of candidates, as data for a proof file."""
        assembly, contacts = apply_change(self.assembly, self.contacts, subject["change"])
        evidence = None
        program = build_program(assembly, contacts, possible=isinstance(proof, MotionProof))
        if isinstance(proof, MotionProof):
            proof = check_motion(program, proof.motion)
        elif program.mu.any():
            evidence = Evidence("open")
        return make_proof(assembly, contacts, program, proof, options or {}, evidence=evidence)

    def __repr__(self) -> str:
        if self.chosen is None:
            return f"<Fixture: {self.verdict}, {self.least} or more>"
        items = [self.offered[k] for k in self.chosen]
        names = [item.name if isinstance(item, Support) else repr(item) for item in items]
        return f"<Fixture: {some(names) or 'nothing'}>"

    def __bool__(self) -> bool:
        raise TypeError("a fixture is neither true nor false: use .verdict")
