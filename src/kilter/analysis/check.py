"""Problem 1 answered in full: verdict, proof, what moves and how.

A stable verdict holds whatever the friction and whatever contacts are not modelled: more
forces can only help, and without friction any solution of the contact law has
a.M a <= w.a <= 0. An unstable one is asked again with every force that contacts which are
not modelled, and friction of any size, might bring; if that could hold it, the verdict is
undecided and says why.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kilter.analysis.degenerate import decide_degenerate
from kilter.analysis.displacement import LIMIT as DISPLACEMENT_LIMIT
from kilter.analysis.displacement import Displacement, find_displacement
from kilter.analysis.motion import ImpendingMotion, find_motion, still
from kilter.analysis.neutral import Neutral, find_neutral
from kilter.analysis.remarks import loose_parts, remarks
from kilter.analysis.stability import Judgement, judge
from kilter.analysis.words import SENTENCES, motion_words
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.errors import some
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import POSSIBLE, TOLERANCE, Program, build_program
from kilter.mechanics.proof import make_proof

__all__ = ["Verdict", "check"]

Array = NDArray[np.float64]
Word = Literal["stable", "potentially-stable", "unstable", "undecided"]

BARELY = 1e-3
"""Instability below which the accuracy of the data is asked about."""
FAR_APART = 1e9
"""Ratio of masses above which accelerations lose their digits."""

GUARANTEE = {"stable": "proved", "unstable": "refuted", "undecided": "open"}


@dataclass(frozen=True, eq=False)
class Verdict:
    """What `check` found, with its evidence.

    Attributes
    ----------
    verdict : {"stable", "unstable", "undecided"}
    sentence : str
        The verdict in words.
    assembly, contacts, program
        What was judged. `program` is the one the certificate speaks of.
    judgement : Judgement
        Forces and motion, judged.
    warnings : tuple of str
    seconds : dict
        Of each stage.
    """

    verdict: Word
    sentence: str
    assembly: Assembly
    contacts: ContactSet
    program: Program
    judgement: Judgement
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def guarantee(self) -> str:
        """Is there no other motion that obeys the contact law? proved, refuted or open."""
        return GUARANTEE[self.verdict]

    @property
    def certificate(self) -> ForceProof | MotionProof | None:
        """The proof that holds, if any."""
        if self.verdict == "stable":
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
        """LP (9) of the paper: z and displacements."""
        if self.verdict == "stable":
            count = len(self.program.names)
            large = int(self.program.free.sum()) > DISPLACEMENT_LIMIT
            return Displacement(0.0, None if large else np.zeros((count, 6)))
        return find_displacement(self.modelled)

    @cached_property
    def motion(self) -> ImpendingMotion:
        """Initial accelerations by Gauss's principle; none where the verdict is stable."""
        return still(self.program) if self.verdict == "stable" else find_motion(self.modelled)

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
        return motion_words(motion.acceleration[part], relative, self.assembly.down)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof as data; `options`: how the assembly was read, for `verify`."""
        return make_proof(
            self.assembly, self.contacts, self.program, self.certificate, options or {}
        )

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data."""
        from kilter.analysis.answers import check_answer

        return check_answer(self)

    def __str__(self) -> str:
        return self.sentence


def check(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
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
    word, program, judgement, why = _decide(assembly, contacts)
    seconds["solve"] = time.perf_counter() - started
    coarse = bool(program.tolerance.max(initial=0.0) > TOLERANCE)
    sentence = SENTENCES.get((word, coarse)) or f"Undecided: {'; '.join(why)}."
    warnings = _warnings(assembly, contacts, program, word)
    return Verdict(word, sentence, assembly, contacts, program, judgement, tuple(warnings), seconds)


def _decide(assembly: Assembly, contacts: ContactSet) -> tuple[Word, Program, Judgement, list[str]]:
    """Verdict, the program it speaks of, and what keeps it undecided."""
    program = build_program(assembly, contacts)
    judgement = judge(program)
    if judgement.stable is None:
        return "undecided", program, judgement, [_figures(judgement)]
    if judgement.stable:
        return "stable", program, judgement, []
    outer = build_program(assembly, contacts, possible=True, sticking=True)
    if len(outer.part_a) == len(program.part_a):
        return "unstable", program, judgement, []
    bound = judge(outer)
    if bound.stable is False:
        return "unstable", outer, bound, []
    sharp = decide_degenerate(assembly, contacts)
    if sharp.program is not None and sharp.judgement is not None:
        return "unstable", sharp.program, sharp.judgement, []
    why = _open_questions(assembly, contacts) + sharp.words
    return "undecided", program, judgement, why


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
    why = []
    if (contacts.patch_mu > 0).any():
        why.append(
            "without friction it would move, and friction, which is not modelled yet, could hold it"
        )
    if contacts.unsupported:
        pairs = [
            f"{names[u.parts[0]]!r} and {names[u.parts[1]]!r} ({u.kind})"
            for u in contacts.unsupported
        ]
        why.append(f"contacts of a kind that is not modelled yet could hold it: {some(pairs)}")
    return why or ["the polygon that stands for a round face could hold it, a circle might not"]


def _warnings(assembly: Assembly, contacts: ContactSet, program: Program, word: Word) -> list[str]:
    warnings = remarks(assembly, contacts)
    if word == "stable":
        return warnings + loose_parts(assembly, contacts)
    if contacts.unsupported or (contacts.patch_mu > 0).any():
        warnings.append(
            "z, displacements and motions are those of the modelled, frictionless contacts"
        )
    mass = program.mass[program.free]
    if len(mass) and mass.max() > FAR_APART * mass.min():
        warnings.append(
            f"masses differ by a factor of {mass.max() / mass.min():.0e}: accelerations of the "
            "lightest parts are not exact"
        )
    return warnings + loose_parts(assembly, contacts)
