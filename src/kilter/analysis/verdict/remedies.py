"""Remedies: options that would change a verdict, each tried before it is offered.

A remedy is a set of options of the command line. It is applied to the assembly as reading applies
it (joints, tolerance, friction), and the cascade of `kilter.check` decides the result at the
required level. The answer prints the option with this result.

All tries together have the work of the verdict itself and of a detection of contacts, or
`LEAST_WORK` if that is more. First each option is decided by equilibrium forces, which cost about
as much as an unstable verdict. An option with which the assembly holds without friction is proved
then; only second order remains, with its own fixed work. For an option that needs friction, the
remaining work decides the required level; if it is not sufficient, the answer reports only that
equilibrium forces exist.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import inf

from kilter.analysis.decision.cascade import Decision, decide, with_second_order
from kilter.analysis.decision.open_question import answered_pairs
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.fits.fastening import fastened
from kilter.contact.fits.suggestions import merely_sunk, parts_to_leave_out, suggest_joints
from kilter.contact.kept_contacts import contacts_among
from kilter.errors import InputError, shell_words
from kilter.tell.levels import holds
from kilter.tell.open_words import OpenOption, open_options, remedy_words, rounded_up
from kilter.tell.record import InPython, LevelWord, Record, Word, key
from kilter.work import Work

MOST = 3
"""Largest number of remedies in an answer."""
LEAST_WORK = 100_000.0
"""Work of all tries together if the verdict costs less [units].

It pays for the equilibrium forces of `MOST` options on 300 contact rows. Without it, an option that
needs friction could not be tried: its decision takes two programs, an unstable verdict only one.
"""
PLAY_DECISIONS = 4
"""Work of all tries together, in verdicts such as the present one, if a gap tolerance may close the
play of a part: it is tried after the likely joints, and with them."""
LEAST_PLAY_WORK = 1_000_000.0
"""The same as `LEAST_WORK` in this case: closed plays add contacts, so that each decision with them
costs several times the verdict. It pays for both tries of a file of 10,000 vertices."""
DECISION, ROW = 10_000.0, 40.0
"""Units of a decision by equilibrium forces beside the solvers: in all, and per contact row."""
DETECTION, VERTEX = 10_000.0, 50.0
"""Units of a detection of contacts: in all, and per vertex. Round and oblique parts cost up to ten
times more, for the verdict and for the tries.
"""
SETTLED = "settles"
"""Level from which no larger change is offered."""
FRICTION_WORK = 200_000.0
"""Least work with which the levels of friction are decided [units]; with less, nearly every answer
is cut. The proof for one block on a slope needs as much.
"""
FRICTION = 0.3
"""Friction coefficient that is tried for an assembly without friction [-]."""
LITTLE_FRICTION = 0.01
"""Friction coefficient that stops motions due to rounding errors of a drawing, such as slopes of
1e-4; it is tried before `FRICTION` [-]."""

PLAY = 0.02
"""Largest gap below a part that touches nothing if a tolerance that closes the gap is tried, as a
fraction of the size of the smaller part [-]; a larger value tries wider gaps."""
PLAY_VERTICES = 150_000
"""Largest number of vertices of an assembly for which such a tolerance is tried; with more, the
second search of contacts takes too long."""
MOST_NAMED = 12
"""Largest number of overlapping pairs that a remedy joins by their names."""


class Remedy(Record, kw_only=False):
    """Options of the command line that were tried, and the verdict with them."""

    option: str
    """The options as the user types them."""
    leads_to: Word | None
    """The verdict with these options, at the required level; null if only the existence of
    equilibrium forces was decided, for lack of work."""
    level: LevelWord | None
    """The level with these options; null if the assembly does not hold. It is "equilibrium" if
    nothing higher was decided."""
    moved: float | None = None
    """Largest movement of a part with the option ``--settle`` [length unit]; else null."""
    units: InPython[str] = ""
    """Unit of length of the movement."""

    @property
    @key
    def words(self) -> str:
        """The option and its result, in words."""
        return remedy_words(self.option, self.leads_to, self.moved, self.units)


_Detection = tuple[float | None, Tolerance]
"""Friction coefficient and tolerance of a detection of contacts."""


@dataclass(frozen=True, slots=True)
class _Change:
    """Command-line options that a remedy changes, and their new values."""

    without: tuple[str, ...] = ()
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
        words = [f"--without {shell_words(self.without)}"] if self.without else []
        words += [f"--fasten {shell_words(pair)}" for pair in self.fasten]
        words += ["--fasten-suggested"] if self.suggested else []
        words += ["--fasten-overlaps"] if self.overlaps else []
        words += ["--loose"] if self.loose else []
        words += [] if self.gap is None else [f"--gap {self.gap:.6g}"]
        words += [] if self.clearance is None else [f"--clearance {self.clearance:.6g}"]
        words += [] if self.friction is None else [f"--friction {self.friction:g}"]
        return " ".join(words)

    @property
    def shown_by_the_drawing(self) -> bool:
        """True if these options only leave copies out, join likely pairs and close a play."""
        shown = replace(self, without=(), suggested=False, fasten=(), gap=None)
        joins_or_closes = not self.fasten or self.gap is not None
        return shown == _Change() and self != _Change() and joins_or_closes

    def apply(
        self, assembly: Assembly, contacts: ContactSet, detected: dict[_Detection, ContactSet]
    ) -> tuple[Assembly, ContactSet]:
        """Return the assembly with these options, and its contacts.

        `detected`: contacts by friction coefficient and tolerance, which later changes share.
        """
        tolerance = self._tolerance(contacts.searched)
        if self.friction is not None:
            assembly = assembly.with_friction(self.friction)
        if self.friction is not None or tolerance != contacts.searched:
            key = self.friction, tolerance
            if key not in detected:
                detected[key] = (
                    detect.detected_with_friction(contacts, self.friction)
                    if self.friction is not None and tolerance == contacts.searched
                    else detect.contacts(assembly, tolerance=tolerance)
                )
            contacts = detected[key]
        if self.fasten:  # needs the nearest parts, which parts of a contact set do not have
            assembly = fastened(assembly, self.fasten, contacts=contacts)
            contacts = contacts.of(assembly)
        if self.without:
            assembly = assembly.without(self.without)
            contacts = contacts_among(contacts, assembly)
        if self.suggested or self.overlaps:
            assembly = fastened(
                assembly,
                suggested=self.suggested,
                overlaps=self.overlaps,
                contacts=contacts,
            )
        return assembly, contacts.of(assembly)

    def detects(self, contacts: ContactSet) -> bool:
        """True if these options need another detection of contacts."""
        other = self._tolerance(contacts.searched) != contacts.searched
        rubs = self.friction is not None
        return other or (rubs and detect.friction_needs_detection(contacts))

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

    Returns at most `MOST` remedies that reach a higher level, or that decide an undecided verdict.
    """
    if decision.verdict not in ("unstable", "undecided"):
        return ()
    has_play = _closing_gap(contacts) is not None
    decisions, least = (PLAY_DECISIONS, LEAST_PLAY_WORK) if has_play else (1, LEAST_WORK)
    changes = list(_changes(assembly, contacts, decision))
    # joints together with friction are tried last, after each of them alone
    decisions += any(change.suggested and change.friction is not None for change in changes)
    units = decisions * _decision_units(decision) + _detection_units(assembly)
    tries = _Tries(decision, require, work, work.beside(max(units, least)))
    detected: dict[_Detection, ContactSet] = {}
    for change in changes:
        if len(tries.hopeful) == MOST:
            break
        if tries.needs_less_than(change):
            continue
        try:
            tries.by_forces(change, assembly, contacts, detected)
        except InputError:  # the option does not apply to this assembly, so it is no remedy
            continue
    remedies = tuple(tries.at_the_level())
    if not any(remedy.level for remedy in remedies) and tries.likely is not None:
        remedies = (*remedies[: MOST - 1], tries.likely.remedy(True))
    if not remedies and decision.question is not None:
        # no tolerance closes these pairs, such as threads with play; the user may join them
        question = decision.question
        sunk = _sunk_pairs(assembly, contacts)
        if any(set(p.parts) in sunk for p in question.deciding.pairs):
            return ()
        pairs = tuple(p.parts for p in question.deciding.pairs)
        return (Remedy(_Change(fasten=pairs).option, question.verdict, question.level),)
    return remedies


@dataclass(frozen=True, slots=True)
class _Try:
    """A change of options, the changed assembly with its contacts, and the decision on it."""

    change: _Change
    assembly: Assembly
    contacts: ContactSet
    decision: Decision

    def remedy(self, decided: bool) -> Remedy:
        """The remedy; without the verdict word unless it is `decided` at the required level."""
        result = self.decision
        word = result.verdict if decided or result.level is None else None
        level = result.level if decided or result.level is None else "equilibrium"
        return Remedy(self.change.option, word, level)


@dataclass(slots=True)
class _Tries:
    """Tries of changes within a work budget; `work` is the limit of a check.

    `hopeful`: the tries that change the verdict by equilibrium forces or by a motion. `likely`: the
    last try that states what the drawing shows (copies left out, likely joints), if it leaves the
    verdict undecided: its own answer has the next question. `expected`: work of the next try, that
    of the most costly so far [units].
    """

    decision: Decision
    require: str
    work: Work
    budget: Work
    hopeful: list[_Try] = field(default_factory=list)
    likely: _Try | None = None
    expected: float = 0.0

    def needs_less_than(self, change: _Change) -> bool:
        """Whether a try with fewer joints, or only with less friction, holds the assembly."""
        less = _Change(friction=LITTLE_FRICTION) if change.friction == FRICTION else None
        if change.fasten and change.gap is not None:
            less = replace(change, fasten=())
        return any(hopeful.change == less for hopeful in self.hopeful)

    def by_forces(
        self,
        change: _Change,
        assembly: Assembly,
        contacts: ContactSet,
        detected: dict[_Detection, ContactSet],
    ) -> None:
        """Decide by equilibrium forces whether a change is a remedy; raises InputError."""
        known = len(detected)
        if self.budget.left < max(self.expected, _decision_units(replace(self.decision, units=0))):
            return
        other, touching = change.apply(assembly, contacts, detected)
        decision = decide(
            other,
            touching,
            require="equilibrium",
            work=self.work.whole(self.budget.left),
            second_order=False,
            question=False,
        )
        self.expected = max(self.expected, _decision_units(decision))
        self.budget.charge(_decision_units(decision))
        if len(detected) > known and change.detects(contacts):
            self.budget.charge(_detection_units(assembly))
        falls = decision.level is None
        if not (falls and decision.verdict in (self.decision.verdict, "undecided")):
            self.hopeful.append(_Try(change, other, touching, decision))
        elif decision.verdict == "undecided" and change.shown_by_the_drawing:
            self.likely = _Try(change, other, touching, decision)

    def at_the_level(self) -> Iterator[Remedy]:
        """Yield the remedies with their results at the required level, as far as work is left."""
        for number, hopeful in enumerate(self.hopeful):
            if hopeful.decision.level is None:
                yield hopeful.remedy(True)
                continue
            if hopeful.decision.friction is None:  # proved without friction
                result = self._with_second_order(hopeful)
                yield result
                if holds(result.level, SETTLED):
                    return  # later candidates change more of the assembly
                continue
            share = self.budget.fraction_left(1 / (len(self.hopeful) - number)).left
            if share < FRICTION_WORK:
                yield hopeful.remedy(self.require == "equilibrium")
                continue
            part = self.work.whole(share, self.work.allowed)
            decision = decide(
                hopeful.assembly,
                hopeful.contacts,
                require=self.require,
                work=part,
                question=False,
            )
            self.budget.charge(_decision_units(decision))
            # work that was cut may have left a refutation unknown, but a proof stays a proof
            proved = decision.friction is not None and decision.friction.guarantee != "open"
            if part.cut and not proved:
                yield hopeful.remedy(False)
                continue
            yield replace(hopeful, decision=decision).remedy(True)
            if holds(decision.level, SETTLED):
                return

    def _with_second_order(self, hopeful: _Try) -> Remedy:
        """The remedy of a try that holds without friction, as a check of its own decides it.

        Second order has the fixed work that it has in a check, whatever the other tries took.
        """
        decision = with_second_order(
            hopeful.decision,
            hopeful.assembly,
            hopeful.contacts,
            self.require,
            self.work.whole(inf, self.work.allowed),
        )
        return replace(hopeful, decision=decision).remedy(True)


def _decision_units(decision: Decision) -> float:
    """Work of a decision [units]."""
    return decision.units + DECISION + ROW * len(decision.program.part_a)


def _detection_units(assembly: Assembly) -> float:
    """Work of a detection of the contacts of an assembly [units]."""
    return DETECTION + VERTEX * len(assembly.geometry.vertices)


def _changes(assembly: Assembly, contacts: ContactSet, decision: Decision) -> Iterator[_Change]:
    """Yield the changes of options to try, the smallest change first."""
    joined = [s.parts for s in suggest_joints(assembly, contacts) if s.fixed]
    smooth = not assembly.friction_pairs and not (contacts.patch_mu > 0).any()
    left_out = parts_to_leave_out(contacts)
    likely = _Change(without=left_out, suggested=bool(joined))
    if left_out:
        yield _Change(without=left_out)
    if joined:  # a thread or a press fit is more evidence of a joint than a clearance
        yield likely
    if decision.question is not None:
        sunk = _sunk_pairs(assembly, contacts)
        listed = answered_pairs(assembly, contacts, decision.question)
        pairs = [pair.to_dict() for pair in listed]
        pairs = [pair for pair in pairs if set(pair["parts"]) not in sunk]
        yield _settling_change(open_options(pairs))
        known = {frozenset(pair) for pair in joined}
        rest = [
            pair
            for pair in pairs
            if frozenset(pair["parts"]) not in known and not set(left_out) & set(pair["parts"])
        ]
        options = open_options(rest)
        if options and (left_out or joined):
            settling = _settling_change(options)
            yield replace(settling, without=left_out, suggested=bool(joined))
    gap = _closing_gap(contacts)
    if gap is not None and len(assembly.geometry.vertices) <= PLAY_VERTICES:
        yield replace(likely, gap=gap)
        # faces that overlap by less than this gap count as touching, and no longer as an overlap
        over = {frozenset(overlap.ends) for overlap in contacts.overlaps}
        names = assembly.names
        within = tuple(
            pair
            for pair in joined
            if frozenset(map(names.index, pair)) in over and not set(left_out) & set(pair)
        )
        if 0 < len(within) <= MOST_NAMED:
            yield replace(likely, gap=gap, fasten=within)
    if smooth and len(contacts):
        yield _Change(friction=LITTLE_FRICTION)
        yield _Change(friction=FRICTION)
    if smooth and joined:
        yield replace(likely, friction=FRICTION)


def _sunk_pairs(assembly: Assembly, contacts: ContactSet) -> list[set[str]]:
    """Names of the pairs that are merely sunk into each other, which nobody should join."""
    return [
        {assembly.names[k] for k in overlap.ends}
        for overlap in contacts.overlaps
        if merely_sunk(assembly, overlap)
    ]


def _closing_gap(contacts: ContactSet) -> float | None:
    """Gap tolerance by which parts that touch nothing reach their nearest part, if it is a play.

    Parts farther than `PLAY` from all others are left out; None if no part is nearer.
    """
    size = contacts.assembly.geometry.size
    gaps = [
        near.gap + near.accuracy
        for near in contacts.neighbours
        if near.gap <= PLAY * size[[near.part, near.other]].min()
    ]
    return rounded_up(max(gaps)) if gaps else None


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
