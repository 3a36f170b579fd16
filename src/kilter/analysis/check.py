"""Problem 1 answered in full: verdict, proof, what moves and how.

What is stable without friction is stable whatever the friction, and whatever contacts are
not modelled: more forces can only help, and without friction any solution of the contact law
has a.M a <= w.a <= 0. Else, with friction, equilibrium is asked in Coulomb's cones, and
where it exists, what it guarantees (`kilter.friction.answer`). An unstable one is asked
again with every force that contacts which are not modelled might bring; if those could hold
it, the verdict is undecided and says why.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from kilter.analysis.contact_forces import ContactForces, find_contact_forces
from kilter.analysis.degenerate_branches import decide_degenerate
from kilter.analysis.displacement import LIMIT as DISPLACEMENT_LIMIT
from kilter.analysis.displacement import Displacement, find_displacement
from kilter.analysis.frictional_motion import find_motion_with_friction, motion_of
from kilter.analysis.judge import Judgement, judge
from kilter.analysis.motion import ImpendingMotion, find_motion, still
from kilter.analysis.neutral import Neutral, find_neutral
from kilter.analysis.remarks import loose_parts, remarks
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.errors import some
from kilter.friction.answer import BUDGET, FrictionAnswer, ask_friction
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import POSSIBLE, TOLERANCE, Program, build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.tell.sentences import verdict_sentence
from kilter.tell.words import NAMED, motion_summary, motion_words
from kilter.units import metres_per_unit

__all__ = ["Verdict", "check"]

Word = Literal["stable", "potentially-stable", "unstable", "undecided"]

BARELY = 1e-3
"""Instability below which the accuracy of the data is asked about."""
FAR_APART = 1e9
"""Ratio of masses above which accelerations lose their digits."""


@dataclass(frozen=True, eq=False)
class Verdict:
    """What `check` found, with its evidence.

    Attributes
    ----------
    verdict : {"stable", "potentially-stable", "unstable", "undecided"}
    sentence : str
        The verdict in words.
    assembly, contacts, program
        What was judged. `program` is the one the certificate speaks of.
    judgement : Judgement
        Forces and motion, judged.
    friction : FrictionAnswer or None
        What friction guarantees, where the verdict rests on it.
    warnings : tuple of str
    seconds : dict
        Of each stage.
    budget : float
        For the search of motions with friction [s].
    """

    verdict: Word
    sentence: str
    assembly: Assembly
    contacts: ContactSet
    program: Program
    judgement: Judgement
    friction: FrictionAnswer | None
    warnings: tuple[str, ...]
    seconds: dict[str, float]
    budget: float = BUDGET

    @property
    def guarantee(self) -> str:
        """Is there no other motion that obeys the contact law? proved, refuted or open."""
        if self.verdict == "potentially-stable" and self.friction is not None:
            return self.friction.guarantee
        return {"stable": "proved", "unstable": "refuted"}.get(self.verdict, "open")

    @property
    def seated(self) -> bool | None:
        """Does its own weight make the friction that holds it? None where it is not asked."""
        asked = self.verdict == "potentially-stable" and self.friction is not None
        return self.friction.seated if asked and self.friction is not None else None

    @property
    def certificate(self) -> ForceProof | MotionProof | None:
        """The proof that holds, if any."""
        if self.verdict in ("stable", "potentially-stable"):
            return self.judgement.forces
        return self.judgement.motion if self.verdict == "unstable" else None

    @property
    def modelled(self) -> Program:
        """The program with the contacts that are modelled, and no others."""
        if not self.program.kind.size or not (self.program.kind == POSSIBLE).any():
            return self.program
        return build_program(self.assembly, self.contacts)

    @cached_property
    def displacement(self) -> Displacement:
        """LP (9) of the paper, without friction: z and displacements."""
        if self.verdict == "stable" and self.friction is None:
            count = len(self.program.names)
            large = int(self.program.free.sum()) > DISPLACEMENT_LIMIT
            return Displacement(0.0, None if large else np.zeros((count, 6)))
        return find_displacement(self.modelled)

    @cached_property
    def motion(self) -> ImpendingMotion:
        """Initial accelerations; none where the verdict is stable.

        Without friction by Gauss's principle. With friction a motion that obeys Coulomb's
        law: where the verdict is potentially stable, the one that refutes the guarantee.
        """
        if self.verdict == "stable":
            return still(self.program)
        if self.verdict == "undecided" or not self.modelled.mu.any():
            return find_motion(self.modelled)
        if self.friction is not None:
            witness = self.friction.witness
            return still(self.program) if witness is None else motion_of(
                self.program, witness.acceleration, witness.law.residual
            )  # fmt: skip
        found = find_motion_with_friction(self.modelled, self.budget)
        return find_motion(self.modelled) if found is None else found

    @property
    def instability(self) -> float | None:
        """Kappa of the motion [-]; None with loads, or where no motion is known."""
        unknown = self.verdict == "potentially-stable" and self.guarantee == "open"
        return None if self.assembly.loads or unknown else self.motion.instability

    @cached_property
    def forces(self) -> ContactForces | None:
        """Contact forces of the equilibrium; None where there is none."""
        proof = self.certificate
        return find_contact_forces(self.program, proof) if isinstance(proof, ForceProof) else None

    @cached_property
    def neutral(self) -> Neutral | None:
        """Motions that cost no energy to first order, without friction."""
        return find_neutral(self.modelled)

    @property
    def tolerance(self) -> float:
        """The relative tolerance of the verdict: the largest of any part [-]."""
        return float(self.program.tolerance.max(initial=TOLERANCE))

    @property
    def barely(self) -> str:
        """A word of caution where it is unstable by so little that rounding could do it."""
        kappa = self.motion.instability
        if self.verdict != "unstable" or kappa >= BARELY or self.assembly.loads:
            return ""
        return (
            f"barely unstable (kappa {kappa:.1e}): coordinates rounded by about {kappa:.0e} of a "
            "part's size would do as much; where they are, state it as the accuracy of the mesh"
        )

    @property
    def moving(self) -> list[str]:
        """Names of the parts that start to move."""
        return [n for n, m in zip(self.program.names, self.motion.moves, strict=True) if m]

    def words(self, part: int, *, slow: bool = False) -> str:
        """How a part starts to move; `slow`: also below the threshold of `moves`."""
        motion = self.motion
        if self.assembly.parts[part].grounded:
            return "is held"
        relative = motion.relative[part] * (slow or motion.moves[part])
        return motion_words(
            motion.acceleration[part],
            relative,
            self.assembly.down,
            center=self.program.center[part],
            unit=metres_per_unit(self.program.units),
        )

    @property
    def summary(self) -> str:
        """The fastest parts and how they start to move, in one sentence."""
        motion = self.motion
        which = np.flatnonzero(motion.moves)
        order = which[np.argsort(-motion.relative[which].max(axis=1), kind="stable")]
        names = self.program.names
        fastest = [f"{names[k]} {self.words(int(k))}" for k in order[:NAMED]]
        return motion_summary(fastest, len(which))

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof as data; `options`: how the assembly was read, for `verify`."""
        return make_proof(
            self.assembly,
            self.contacts,
            self.program,
            self.certificate,
            options or {},
            evidence=self._evidence(),
        )

    def _evidence(self) -> Evidence | None:
        answer = self.friction
        if answer is None:
            return None
        exclusion = answer.exclusion
        return Evidence(
            answer.guarantee,
            witness=None if answer.witness is None else answer.witness.law,
            seated=answer.seat,
            exclusion=None
            if exclusion is None or not exclusion.proved
            else {
                "kind": exclusion.kind,
                "programs": exclusion.programs,
                "assumes": exclusion.assumes,
            },
        )

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data."""
        from kilter.analysis.answers import check_answer

        return check_answer(self)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from kilter.tell.notebook import verdict_html

        return verdict_html(self)

    def __str__(self) -> str:
        return self.sentence


def check(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    budget: float = BUDGET,
    progress: Callable[[str], None] | None = None,
) -> Verdict:
    """Does the assembly stay together under gravity?

    Parameters
    ----------
    assembly : Assembly
        At least one part must be held.
    contacts : ContactSet, optional
        Found from the geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.
    budget : float
        For what friction guarantees: the search of a motion, and the proof that there is
        none; past it the guarantee is open [s].
    progress : callable, optional
        Called with a word at each stage.

    Raises
    ------
    InputError
        If nothing is held, or the geometry is not usable.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check(scene("tower")).verdict
    'stable'
    >>> verdict = check(scene("paper-figure-8"))
    >>> verdict.verdict, verdict.moving
    ('unstable', ['C2', 'C3'])
    """
    tell = progress or (lambda stage: None)
    assembly.require_grounded()
    seconds: dict[str, float] = {}
    started = time.perf_counter()
    _ = assembly.geometry
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    seconds["contacts"] = time.perf_counter() - started
    tell("verdict")
    started = time.perf_counter()
    decision = _decide(assembly, contacts, budget, tell)
    word, program = decision.verdict, decision.program
    seconds["solve"] = time.perf_counter() - started
    sentence = _sentence(decision)
    warnings = _warnings(assembly, contacts, decision)
    return Verdict(
        word,
        sentence,
        assembly,
        contacts,
        program,
        decision.judgement,
        decision.friction,
        tuple(warnings),
        seconds,
        budget,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Decision:
    """Verdict, the program it speaks of, its evidence, and what keeps it undecided."""

    verdict: Word
    program: Program
    judgement: Judgement
    friction: FrictionAnswer | None = None
    why: tuple[str, ...] = ()


def _sentence(decision: _Decision) -> str:
    if decision.verdict == "undecided":
        return f"Undecided: {'; '.join(decision.why)}."
    friction = decision.friction
    coarse = bool(decision.program.tolerance.max(initial=0.0) > TOLERANCE)
    return verdict_sentence(
        decision.verdict,
        guarantee=None if friction is None else friction.guarantee,
        seated=friction is not None and friction.seated is True,
        coarse=coarse,
    )


def _decide(
    assembly: Assembly, contacts: ContactSet, budget: float, tell: Callable[[str], None]
) -> _Decision:
    program = build_program(assembly, contacts)
    smooth = program.frictionless
    judgement = judge(smooth)
    if judgement.stable:
        return _Decision("stable", smooth, judgement)
    if program is not smooth:
        tell("equilibrium with friction")
        judgement = judge(program)
    if judgement.stable is None:
        return _Decision("undecided", program, judgement, why=(_figures(judgement),))
    if judgement.stable:
        answer = ask_friction(program, budget=budget, tell=tell)
        word: Word = "stable" if answer.guarantee == "proved" else "potentially-stable"
        return _Decision(word, program, judgement, answer)
    outer = build_program(assembly, contacts, possible=True)
    if len(outer.part_a) == len(program.part_a):
        return _Decision("unstable", program, judgement)
    bound = judge(outer)
    if bound.stable is False:
        return _Decision("unstable", outer, bound)
    sharp = decide_degenerate(assembly, contacts)
    if sharp.program is not None and sharp.judgement is not None:
        return _Decision("unstable", sharp.program, sharp.judgement)
    why = (*_open_questions(assembly, contacts), *sharp.words)
    return _Decision("undecided", program, judgement, why=why)


def _figures(judgement: Judgement) -> str:
    residual = judgement.forces.residual if judgement.forces else float("nan")
    motion = judgement.motion
    ratio = f"{motion.power:.2g} W at violation {motion.violation:.2g}" if motion else "none"
    return (
        f"the numbers do not carry a proof (best forces leave {residual:.2g} of a weight, "
        f"best motion: {ratio})"
    )


def _open_questions(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """What could hold it that is not modelled."""
    names = assembly.names
    if contacts.unsupported:
        pairs = [
            f"{names[u.parts[0]]!r} and {names[u.parts[1]]!r} ({u.kind})"
            for u in contacts.unsupported
        ]
        return [f"contacts of a kind that is not modelled yet could hold it: {some(pairs)}"]
    return ["the polygon that stands for a round face could hold it, a circle might not"]


def _warnings(assembly: Assembly, contacts: ContactSet, decision: _Decision) -> list[str]:
    warnings = remarks(assembly, contacts)
    friction, program = decision.friction, decision.program
    if friction is not None and friction.exclusion is not None and friction.exclusion.assumes:
        warnings.append(f"the proof assumes {friction.exclusion.assumes}")
    if friction is not None and contacts.unsupported:
        warnings.append("contacts that are not modelled could add motions, or take them away")
    if decision.verdict == "stable":
        return warnings + loose_parts(assembly, contacts)
    if contacts.unsupported:
        warnings.append("z, displacements and motions are those of the modelled contacts")
    mass = program.mass[program.free]
    if len(mass) and mass.max() > FAR_APART * mass.min():
        warnings.append(
            f"masses differ by a factor of {mass.max() / mass.min():.0e}: accelerations of the "
            "lightest parts are not exact"
        )
    return warnings + loose_parts(assembly, contacts)
