"""Problem 1 answered in full: verdict, proof, what moves and how.

What is stable without friction is stable whatever the friction, and whatever contacts are
not modelled: more forces can only help, and without friction any solution of the contact law
has a.M a <= w.a <= 0. Else, with friction, equilibrium is asked in Coulomb's cones, and
where it exists, what it guarantees (`kilter.friction.answer`). An unstable one is asked
again with every force that contacts which are not modelled might bring; if those could hold
it, the verdict is undecided and says why.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kilter.analysis.decision.as_stated import explained_by_accuracy
from kilter.analysis.decision.degenerate_branches import decide_degenerate
from kilter.analysis.decision.fitted_normals import rests_on_fits, why_fits_leave_it_open
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.open_pairs.open_question import OpenQuestion, ask_open, open_pairs_answer
from kilter.analysis.open_pairs.ordinary_contacts import (
    EQUILIBRIUM,
    PROVED,
    SETTLES,
    OpenTrial,
    trial_words,
    try_ordinary,
)
from kilter.analysis.verdict.remarks import loose_parts, remarks
from kilter.analysis.verdict.verdict import Verdict, Word
from kilter.assembly import Assembly, require_assembly
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.fits.coincident import require_apart
from kilter.contact.open_pairs import still_open
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.tell.levels import REQUIRE, require_level
from kilter.tell.numbers import number as text_of
from kilter.tell.open_words import undecided_sentence
from kilter.tell.second_order_words import balanced_sentence
from kilter.tell.words import verdict_sentence
from kilter.threads import on_one_thread
from kilter.validate import number
from kilter.work import EFFORT, Work, units_of

if TYPE_CHECKING:
    from kilter.friction.answer import FrictionAnswer
    from kilter.second_order.answer.second_order_answer import SecondOrder

__all__ = ["check"]

FAR_APART = 1e9
"""Ratio of masses above which accelerations lose their digits."""


@on_one_thread
def check(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = REQUIRE,
    measures: bool = False,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Verdict:
    """Does the assembly stay together under gravity?

    Parameters
    ----------
    assembly : Assembly
        At least one part must be held. Friction and the direction of gravity are its own:
        ``check(assembly.with_friction(0.6).with_down([0.1, 0, -1]))``.
    contacts : ContactSet, optional
        Found from the geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.
    require : {"equilibrium", "settles", "proved", "strict"}
        The level at which `Verdict.stable` is true; "strict": no small push makes it fall.
    measures : bool
        Also z, kappa and the displacements of LP (9) where friction plays a part. They leave
        it out.
    effort : float
        For what friction guarantees: the search of a motion, and the proof that there is
        none. Work that is counted, not timed: 0 quick, 1 usual, each further one ten times
        more; past it the guarantee is open.
    time_limit : float, optional
        Seconds after which the answer is what is proved until then; a warning says so. It is
        looked at between steps, and what a limit cuts short may differ from run to run.
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
    if contacts is not None and not isinstance(contacts, ContactSet):
        raise InputError(f"contacts are {contacts!r:.60}", hint="give what kilter.contacts returns")
    require = require_level(require, strict=True)
    work = _work(effort, time_limit, progress)
    require_assembly(assembly, "check")
    assembly.require_grounded()
    seconds: dict[str, float] = {}
    started = time.perf_counter()
    _ = assembly.geometry
    if contacts is None:
        contacts = detect.contacts(assembly, tolerance=tolerance, progress=progress)
    require_apart(assembly, contacts)
    seconds["contacts"] = time.perf_counter() - started
    tell("verdict")
    started = time.perf_counter()
    decision = _as_stated(assembly, contacts, _decide(assembly, contacts, work))
    word, program = decision.verdict, decision.program
    second = _second_order(decision, assembly, contacts, work, strict=require == "strict")
    seconds["solve"] = time.perf_counter() - started
    sentence = _sentence(decision, assembly, contacts)
    if second is not None and second.state == "balanced":
        rolling = None if second.rolling is None else second.rolling.state
        moving = [program.names[k] for k in second.moving]
        sentence = balanced_sentence(moving, rolling=rolling)
    warnings = _warnings(assembly, contacts, decision)
    if work.cut:
        warnings.append(_late(time_limit))
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
        effort,
        time_limit if work.cut else None,
        decision.question,
        require,
        measures,
        second,
    )


def _second_order(
    decision: _Decision, assembly: Assembly, contacts: ContactSet, work: Work, *, strict: bool
) -> SecondOrder | None:
    """What second order says of what is stable without friction."""
    if decision.verdict != "stable" or decision.friction is not None:
        return None
    from kilter.second_order.answer.whole import find_second_order, with_rolling  # takes its time

    proof = decision.judgement.forces
    forces = None if proof is None else proof.forces
    found = find_second_order(
        assembly, contacts, decision.program, forces, work=work, strict=strict
    )
    if found is None or found.state != "balanced":
        return found
    return with_rolling(found, assembly, contacts, build_program(assembly, contacts))


def _work(effort: float, time_limit: float | None, progress: Callable[[str], None] | None) -> Work:
    """What a check may cost."""
    effort = number(effort, "effort", lowest=0)
    if time_limit is not None:
        time_limit = number(time_limit, "time_limit", lowest=0)
    return Work(units_of(effort), progress, time_limit=time_limit)


def _late(time_limit: float | None) -> str:
    return f"cut short by the time limit of {time_limit:g} s: this is what is proved until then"


@dataclass(frozen=True, slots=True, eq=False)
class _Decision:
    """Verdict, the program it speaks of, its evidence, and what keeps it undecided."""

    verdict: Word
    program: Program
    judgement: Judgement
    friction: FrictionAnswer | None = None
    why: tuple[str, ...] = ()
    question: OpenQuestion | None = None
    trial: OpenTrial | None = None


def _sentence(decision: _Decision, assembly: Assembly, contacts: ContactSet) -> str:
    if decision.verdict == "undecided":
        if decision.question is None:
            return f"Undecided: {'; '.join(decision.why)}."
        pairs = open_pairs_answer(assembly, contacts, decision.question)
        return undecided_sentence(pairs, assembly.units, more=decision.why)
    friction = decision.friction
    coarse = bool(decision.program.tolerance.max(initial=0.0) > TOLERANCE)
    bonded = bool(assembly.bonds)
    gap = contacts.counted_gap
    counted = "" if gap is None else f"{text_of(gap, 3)} {assembly.units}"
    if friction is None:
        return verdict_sentence(decision.verdict, coarse=coarse, counted=counted, bonded=bonded)
    settling = friction.settling
    return verdict_sentence(
        decision.verdict,
        guarantee=friction.guarantee,
        why=friction.why,
        squeeze=friction.seating.seated == "runs-away",
        tries=(len(friction.tries), len(settling.ends), settling.of),
        coarse=coarse,
        counted=counted,
        bonded=bonded,
    )


def _decide(assembly: Assembly, contacts: ContactSet, work: Work) -> _Decision:
    program = build_program(assembly, contacts)
    smooth = program.frictionless
    judgement = judge(smooth, work=work)
    if judgement.stable:
        return _Decision("stable", smooth, judgement)
    if program is not smooth:
        work.stage("equilibrium with friction")
        judgement = judge(program, work=work)
    if judgement.stable is None:
        reason = "the time limit was met" if work.cut else _figures(judgement)
        return _Decision("undecided", program, judgement, why=(reason,))
    if judgement.stable:
        if rests_on_fits(program, assembly):
            return _on_fits(program, judgement, work)
        return _with_friction(assembly, contacts, program, judgement, work)
    outer = build_program(assembly, contacts, possible=True)
    if len(outer.part_a) == len(program.part_a):
        return _Decision("unstable", program, judgement)
    bound = judge(outer, work=work)
    if bound.stable is False:
        return _Decision("unstable", outer, bound)
    sharp = decide_degenerate(assembly, contacts)
    if sharp.program is not None and sharp.judgement is not None:
        return _Decision("unstable", sharp.program, sharp.judgement)
    fits = why_fits_leave_it_open(assembly, contacts, program, work)
    work.stage("open pairs")
    question = ask_open(
        assembly, contacts, program, lambda other: _decide(other, contacts, work).verdict, work=work
    )
    unclear = () if question is not None or fits else (_unclear(contacts, bound, work),)
    why = (*unclear, *fits, *sharp.words)
    return _Decision("undecided", program, judgement, why=why, question=question)


def _with_friction(
    assembly: Assembly, contacts: ContactSet, program: Program, judgement: Judgement, work: Work
) -> _Decision:
    """What friction guarantees, with the open pairs as ordinary contacts too."""
    from kilter.friction.answer import ask_friction, not_asked  # takes its time

    if program.cohesion.any():
        return _Decision("potentially-stable", program, judgement, not_asked(program))
    answer, trial = ask_friction(program, work=work), None

    def level(other: Program) -> int:
        if judge(other.frictionless, work=work).stable:
            return PROVED
        return _level(ask_friction(other, work=work.beside(work.allowed)))

    if _level(answer) > EQUILIBRIUM:
        trial = try_ordinary(assembly, contacts, level)
        if trial.level < PROVED and answer.guarantee == "proved":
            answer = dataclasses.replace(answer, guarantee="open")
        if trial.level < SETTLES:
            answer = dataclasses.replace(answer, tries=())
    return _Decision(_word(answer), program, judgement, answer, trial=trial)


def _level(friction: FrictionAnswer) -> int:
    """What friction guarantees, as a level that can be compared."""
    if friction.guarantee == "proved":
        return PROVED
    return SETTLES if friction.settles else EQUILIBRIUM


def _on_fits(program: Program, judgement: Judgement, work: Work) -> _Decision:
    """Equilibrium alone: with normals in doubt nothing is said of other motions."""
    from kilter.friction.answer import ask_friction

    answer = ask_friction(program, work=work.beside(0.0))
    answer = dataclasses.replace(answer, guarantee="open", tries=())
    return _Decision("potentially-stable", program, judgement, answer)


def _as_stated(assembly: Assembly, contacts: ContactSet, decision: _Decision) -> _Decision:
    """The decision; undecided where the accuracy that the file states explains what moves."""
    if decision.verdict != "unstable":
        return decision
    why = explained_by_accuracy(assembly, contacts, decision.program)
    return dataclasses.replace(decision, verdict="undecided", why=(why,)) if why else decision


def _word(friction: FrictionAnswer) -> Word:
    """The verdict on what has forces of equilibrium by friction."""
    if friction.guarantee == "proved":
        return "stable"
    return "settles" if friction.settles else "potentially-stable"


def _figures(judgement: Judgement) -> str:
    residual = judgement.forces.residual if judgement.forces else float("nan")
    motion = judgement.motion
    ratio = f"{motion.power:.2g} W at violation {motion.violation:.2g}" if motion else "none"
    return (
        f"the numbers do not carry a proof (best forces leave {residual:.2g} of a weight, "
        f"best motion: {ratio})"
    )


def _unclear(contacts: ContactSet, bound: Judgement, work: Work) -> str:
    """Why it is undecided where no joined pairs decide; `bound`: of all that could touch."""
    if work.cut:
        return "the time limit was met"
    if bound.stable is None:
        return f"of what could hold it {_figures(bound)}"
    if contacts.open_pairs:
        return "pairs that are left open could hold it together with round rims"
    return "the polygon that stands for a round face could hold it, a circle might not"


def _warnings(assembly: Assembly, contacts: ContactSet, decision: _Decision) -> list[str]:
    warnings = remarks(assembly, contacts)
    friction, program = decision.friction, decision.program
    if friction is not None and program.cohesion.any():
        warnings.append(
            "what friction guarantees is not asked beside bonds that bear shear up to a force: only"
            " that forces balance"
        )
    if friction is not None and friction.exclusion is not None and friction.exclusion.assumes:
        warnings.append(f"the proof assumes {friction.exclusion.assumes}")
    left_open = still_open(contacts.open_pairs, assembly)
    if decision.trial is not None and left_open:
        warnings.append(trial_words(decision.trial, assembly, len(left_open)))
    elif friction is not None and left_open:
        warnings.append("pairs that are left open could add motions, or take them away")
    if decision.verdict == "stable":
        return warnings + loose_parts(assembly, contacts)
    if left_open:
        warnings.append("z, displacements and motions are those of the certain contacts")
    mass = program.mass[program.free]
    if len(mass) and mass.max() > FAR_APART * mass.min():
        warnings.append(
            f"masses differ by a factor of {mass.max() / mass.min():.0e}: accelerations of the "
            "lightest parts are not exact"
        )
    return warnings + loose_parts(assembly, contacts)
