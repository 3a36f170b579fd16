"""Remedies: options that would change a verdict, each tried before it is offered.

A remedy is a set of options of the command line. It is applied to the assembly as reading applies
it (joints, tolerance, friction), and the cascade of `kilter.check` decides the result at the
required level. The answer prints the option with this result.

All tries together have the work limit of a check, or the work of the verdict if it is greater.
Half of it serves tries at the required level. With the other half only the existence of
equilibrium forces is decided, and the answer then reports this fact alone. No try starts after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kilter.analysis.decision.cascade import decide
from kilter.analysis.decision.decision import Decision
from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.fits.fastening import fastened
from kilter.contact.fits.suggestions import suggest_joints
from kilter.errors import InputError, shell_words
from kilter.mechanics.program import Program
from kilter.tell.levels import LEVELS
from kilter.tell.open_words import OpenOption, open_options
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.tell.answer_data.check_data import RemedyData

__all__ = ["Remedy", "find_remedies"]

MOST = 3
"""Largest number of remedies in an answer; each try costs about as much as a verdict."""
RULED = 1_000_000.0
"""Smallest work of all tries together [units], that of effort 1."""
DETECTED = 300.0
"""Units of a detection of contacts, per contact row."""
JUDGED = 90.0
"""Units of a judgement of equilibrium, per contact row."""
FRICTION = 0.3
"""Friction coefficient that is tried for an assembly without friction [-]."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """Options of the command line that were tried, and the verdict with them.

    Attributes
    ----------
    option : str
        The options as the user types them.
    leads_to : str or None
        The verdict with these options, at the required level; None if only the existence of
        equilibrium forces was decided, for lack of work.
    level : str or None
        The level with these options; None if the assembly does not hold. It is "equilibrium" if
        nothing higher was decided.
    """

    option: str
    leads_to: str | None
    level: str | None

    def to_dict(self) -> RemedyData:
        """The remedy as JSON data."""
        return {"option": self.option, "leads_to": self.leads_to, "level": self.level}


_Detection = tuple[float | None, Tolerance]
"""Friction coefficient and tolerance of a detection of contacts."""


@dataclass(frozen=True, slots=True)
class _Change:
    """Command-line options that a remedy changes, and their new values."""

    fasten: tuple[tuple[str, str], ...] = ()
    suggested: bool = False
    overlaps: bool = False
    gap: float | None = None
    clearance: float | None = None
    loose: bool = False
    friction: float | None = None

    @property
    def option(self) -> str:
        """These options as the user types them."""
        words = [f"--fasten {shell_words(pair)}" for pair in self.fasten]
        words += ["--fasten-suggested"] if self.suggested else []
        words += ["--fasten-overlaps"] if self.overlaps else []
        words += ["--loose"] if self.loose else []
        words += [] if self.gap is None else [f"--gap {self.gap:.6g}"]
        words += [] if self.clearance is None else [f"--clearance {self.clearance:.6g}"]
        words += [] if self.friction is None else [f"--friction {self.friction:g}"]
        return " ".join(words)

    def apply(
        self, assembly: Assembly, contacts: ContactSet, detected: dict[_Detection, ContactSet]
    ) -> tuple[Assembly, ContactSet]:
        """Return the assembly with these options, and its contacts.

        `detected`: contacts by friction coefficient and tolerance, which later changes share.
        """
        tolerance = self._tolerance(contacts.tolerance)
        if self.friction is not None:
            assembly = assembly.with_friction(self.friction)
        if self.friction is not None or tolerance != contacts.tolerance:
            key = self.friction, tolerance
            if key not in detected:
                detected[key] = (
                    detect.detected_with_friction(contacts, self.friction)
                    if self.friction is not None and tolerance == contacts.tolerance
                    else detect.contacts(assembly, tolerance=tolerance)
                )
            contacts = detected[key]
        if self.fasten or self.suggested or self.overlaps:
            assembly = fastened(
                assembly,
                self.fasten,
                suggested=self.suggested,
                overlaps=self.overlaps,
                contacts=contacts,
            )
        return assembly, contacts.of(assembly)

    def _tolerance(self, tolerance: Tolerance) -> Tolerance:
        """Copy of a contact tolerance with the values of these options."""
        if self.loose:
            base = Tolerance.loose()
            tolerance = replace(tolerance, relative_gap=base.relative_gap, angle=base.angle)
        if self.gap is not None:
            tolerance = replace(tolerance, gap=self.gap)
        if self.clearance is not None:
            tolerance = replace(tolerance, clearance=self.clearance)
        return tolerance


def find_remedies(
    assembly: Assembly,
    contacts: ContactSet,
    decision: Decision,
    *,
    require: str,
    work: Work,
) -> tuple[Remedy, ...]:
    """Try the options that may change a verdict, and return those that do.

    Options that change least are tried first.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    decision : Decision
        The decision about this assembly and these contacts.
    require : {"equilibrium", "settles", "proved", "strict"}
        The level at which each decision may stop.
    work : Work
        Work limit and time limit of the check.

    Returns
    -------
    tuple of Remedy
        At most `MOST` remedies that reach a higher level, or that decide an undecided verdict.
    """
    if decision.verdict not in ("unstable", "undecided"):
        return ()
    remedies: list[Remedy] = []
    detected: dict[_Detection, ContactSet] = {}
    budget = work.beside(max(work.allowed, RULED, _units(decision.program, 2, detect=True)))
    for change in _changes(assembly, contacts, decision):
        if len(remedies) == MOST or budget.over:
            break
        known = len(detected)
        try:
            other, touching = change.apply(assembly, contacts, detected)
        except InputError:  # the option does not apply to this assembly, so it is no remedy
            continue
        # the effort of a check: with less, a motion that refutes the guarantee may stay unknown
        whole = budget.spent <= 0.5 * budget.allowed
        effort = work.beside(work.allowed)
        level = require if whole else "equilibrium"
        result = decide(other, touching, require=level, work=effort, question=False)
        budget.charge(effort.spent)
        budget.charge(_units(result.program, 2, detect=len(detected) > known))
        if result.level is None and (
            decision.verdict == result.verdict or result.verdict == "undecided"
        ):
            continue
        decided = result.friction is None or level == require
        remedies.append(Remedy(change.option, result.verdict if decided else None, result.level))
        if result.level is not None and LEVELS.index(result.level) >= LEVELS.index("settles"):
            break  # later candidates change more of the assembly
    return tuple(remedies)


def _units(program: Program, judgements: int, *, detect: bool) -> float:
    """Units of work of a number of judgements, and of a contact detection if `detect` is set.

    In units of `Work`.
    """
    return len(program.part_a) * (JUDGED * judgements + DETECTED * detect)


def _changes(assembly: Assembly, contacts: ContactSet, decision: Decision) -> Iterator[_Change]:
    """Yield the changes of options to try, the smallest change first."""
    if decision.question is not None:
        pairs = open_pairs_answer(assembly, contacts, decision.question)
        yield _settling_change(open_options(pairs))
    suggestions = any(suggestion.fixed for suggestion in suggest_joints(assembly, contacts))
    smooth = not assembly.friction_pairs and not (contacts.patch_mu > 0).any()
    if suggestions:
        yield _Change(suggested=True)
    if smooth and len(contacts):
        yield _Change(friction=FRICTION)
    if smooth and suggestions:
        yield _Change(suggested=True, friction=FRICTION)


def _settling_change(options: Sequence[OpenOption]) -> _Change:
    """Combine the options that decide each deciding open pair into a single change."""
    return _Change(
        fasten=tuple(pair for option in options for pair in option.fasten),
        overlaps=any(option.overlaps for option in options),
        loose=any(option.loose for option in options),
        gap=max((option.gap for option in options if option.gap is not None), default=None),
        clearance=max(
            (option.clearance for option in options if option.clearance is not None), default=None
        ),
    )
