"""`kilter.check`: the verdict on an assembly, with its proof and the motion of its parts.

Forces of equilibrium without friction prove stability, whatever the friction and whatever further
contacts exist. More forces only help, and without friction every solution of the contact law has
a.M a <= w.a <= 0. Otherwise, with friction, forces of equilibrium are computed in Coulomb's cones.
If they exist, the guarantee of friction follows (`kilter.friction.answer`). If they do not, the
assembly is examined again with every force that contacts not modelled might add. If these forces
could hold it, the verdict is undecided, and the answer gives the reason.

`kilter.analysis.decision.cascade` makes this decision. This module adds sentence and warnings.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from kilter.analysis.decision.cascade import Decision, decide
from kilter.analysis.decision.open_question import answered_pairs
from kilter.analysis.decision.ordinary_contacts import trial_words
from kilter.analysis.verdict.remarks import gaps_under_straps, loose_parts, remarks
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.assembly.assembly import end_words, with_named_ends
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.contact.fits.suggestions import require_apart
from kilter.contact.open_pairs import still_open
from kilter.errors import TimeLimitReached
from kilter.hooks import hook
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.tell.levels import VerdictWord, level_rank, require_level
from kilter.tell.numbers import number as text_of
from kilter.tell.open_words import undecided_sentence
from kilter.tell.second_order_words import balanced_sentence, push_open_sentence
from kilter.tell.words import verdict_sentence
from kilter.threads import on_one_thread
from kilter.work import stop_after

CUT = "stopped at the time limit: the answer is what was proved until then"
"""Warning in an answer that the time limit cut short."""

FAR_APART = 1e9
"""Ratio of the largest to the least mass above which accelerations of light parts are inexact."""


@question(own_rungs=True)
def check(
    asked: Question,
    *,
    measures: bool = False,
) -> Verdict:
    """Decide whether an assembly stays together under gravity, and prove the answer.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part must be held. The assembly contains friction and the direction of
        gravity: ``check(assembly.with_friction(0.6).with_down([0.1, 0, -1]))``.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Verdict.stable` is true from this level.
    measures : bool
        Whether to report z, kappa and the displacements although friction plays a part. They do
        not include friction.

    Returns
    -------
    Verdict

    Raises
    ------
    InputError
        If no part is held, if an argument is invalid, or if the geometry is not usable.

    See Also
    --------
    kilter.margin : how much tilt, push or loss of friction it withstands.
    kilter.scene : a state for each object of a scene.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check(scene("tower")).verdict
    'stable'
    >>> verdict = check(scene("paper-figure-8"))
    >>> verdict.verdict, verdict.moving
    ('unstable', ['C2', 'C3'])
    """
    if asked.verb == "check":
        found: Verdict = hook("verdict_on_rung")(asked.but(verb=""), measures=measures)
        return found
    assembly, require = asked.assembly, require_level(asked.require, strict=True)
    work = asked.work(facts=True)
    assembly.require_grounded()
    seconds: dict[str, float] = {}
    started = time.perf_counter()
    _ = assembly.geometry
    contacts = detect.touching(asked)
    require_apart(assembly, contacts)
    ends = with_named_ends(assembly)
    if len(ends) > 1:
        each = [asked.but(assembly=end, contacts=contacts.of(end)) for end in ends]
        return _worst_end(assembly, [check(end, measures=measures) for end in each])
    seconds["contacts"] = time.perf_counter() - started
    asked.tell("verdict")
    started = time.perf_counter()
    decision = decide(assembly, contacts, require=require, work=work)
    seconds["solve"] = time.perf_counter() - started
    verdict = _verdict(decision, assembly, contacts, require)
    cut = (CUT,) if work.cut else ()
    return replace(
        verdict,
        notes=(*verdict.notes, *cut),
        seconds=seconds,
        effort=asked.effort,
        time_limit=asked.time_limit if work.cut else None,
        measures=measures,
        decision=decision,
        seconds_left=work.seconds,
    )


@on_one_thread
def check_equilibrium(assembly: Assembly, contacts: ContactSet) -> Verdict:
    """Decide only whether forces of equilibrium exist: a first answer while the rest is computed.

    Second order, the deciding open pairs, z and displacements are left out. Forces and
    motion are proved.

    Raises `InputError` if no part is held.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> check_equilibrium(tower, contacts(tower)).verdict
    'stable'
    """
    assembly.require_grounded()
    ends = with_named_ends(assembly)
    if len(ends) > 1:
        return _worst_end(assembly, [check_equilibrium(end, contacts.of(end)) for end in ends])
    decision = decide(assembly, contacts, require="equilibrium", second_order=False, question=False)
    return replace(_verdict(decision, assembly, contacts, "equilibrium"), brief=True)


@on_one_thread
def check_level(asked: Question) -> Verdict:
    """Decide whether a level is reached: the answer of `check`, without what cannot change this.

    The deciding open pairs of an undecided assembly are left out. At "settles" most of the proof
    that no motion exists is left out if every try came to rest, so that a stable assembly may have
    the level "settles" instead of "proved". Lower levels are those of `check`.

    Raises `InputError` if no part is held, or an argument is invalid.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> check_level(Question(assembly=tower, contacts=contacts(tower))).verdict
    'stable'
    """
    assembly, contacts = asked.assembly, detect.touching(asked)
    require = require_level(asked.require, strict=True)
    assembly.require_grounded()
    require_apart(assembly, contacts)
    ends = with_named_ends(assembly)
    if len(ends) > 1:
        each = [asked.but(assembly=end, contacts=contacts.of(end)) for end in ends]
        return _worst_end(assembly, list(map(check_level, each)))
    decision = decide(
        assembly,
        contacts,
        require=require,
        work=asked.but(time_limit=None).work(facts=True),
        question=False,
        level_only=require == "settles",
    )
    verdict = _verdict(decision, assembly, contacts, require)
    return replace(verdict, effort=asked.effort, decision=decision)


def _worst_end(assembly: Assembly, verdicts: list[Verdict]) -> Verdict:
    """The worst of the verdicts with each tensioned end of straps, with a warning that names it."""
    worst = min(verdicts, key=lambda found: (level_rank(found.level), found.verdict != "unstable"))
    same = all(found.verdict == worst.verdict for found in verdicts)
    words = "; ".join(end_words(assembly, worst.assembly))
    why = "all ends lead to this verdict" if same else "another end leads to a better verdict"
    return replace(
        worst,
        notes=(
            *worst.notes,
            f"both ends of each strap without a named tensioned end were tried, and the worst "
            f"result counts: {words}; {why}",
        ),
    )


def _verdict(decision: Decision, assembly: Assembly, contacts: ContactSet, require: str) -> Verdict:
    """The verdict of a decision, with its sentence and warnings."""
    return Verdict(
        verdict=VerdictWord(decision.verdict),
        own_sentence=_sentence(decision, assembly, contacts),
        require=require,
        seconds={},
        assembly=assembly,
        contact_set=contacts,
        program=decision.program,
        judgement=decision.judgement,
        friction_answer=decision.friction,
        notes=tuple(_warnings(assembly, contacts, decision)),
        question=decision.question,
        second_order_answer=decision.second_order,
    )


def _sentence(decision: Decision, assembly: Assembly, contacts: ContactSet) -> str:
    """Write the verdict of a decision as a sentence for users."""
    if decision.verdict == "undecided":
        if decision.question is None:
            return f"Undecided: {'; '.join(decision.reasons)}."
        listed = answered_pairs(assembly, contacts, decision.question)
        pairs = [pair.to_dict() for pair in listed]
        return undecided_sentence(pairs, assembly.units, more=decision.reasons)
    friction = decision.friction
    second = decision.second_order
    settled = friction is None or decision.verdict == "balanced"
    if second is not None and second.state == "balanced" and settled:
        rolling = second.rolling.state if second.rolling is not None else None
        moving = [decision.program.names[k] for k in second.moving]
        return balanced_sentence(moving, rolling=rolling)
    if second is not None and len(second.bending):
        bending = [decision.program.names[k] for k in second.bending]
        return push_open_sentence(bending, second.why)
    gap = contacts.counted_gap
    about: dict[str, Any] = {
        "coarse": decision.program.tolerance.max(initial=0.0) > TOLERANCE,
        "bonded": bool(assembly.bonds),
        "counted": "" if gap is None else f"{text_of(gap, 3)} {assembly.units}",
        "has_open_pairs": bool(still_open(contacts.open_pairs, assembly)),
    }
    if friction is None:
        rubs = assembly.friction > 0 or any(pair.mu > 0 for pair in assembly.friction_pairs)
        about["frictionless"] = not (rubs or decision.program.mu.any())
        about["rubbing_joints"] = any(joint.friction for joint in assembly.joints)
        return verdict_sentence(decision.verdict, **about)
    settling = friction.settling
    return verdict_sentence(
        decision.verdict,
        guarantee=friction.guarantee,
        why=friction.why,
        seated=friction.seating.seated,
        tries=(len(friction.tries), len(settling.ends), settling.of),
        assumed="" if friction.exclusion is None else friction.exclusion.assumes,
        **about,
    )


def _warnings(assembly: Assembly, contacts: ContactSet, decision: Decision) -> list[str]:
    """Warnings about the input, about open pairs and about parts that touch nothing."""
    warnings = remarks(assembly, contacts)
    if decision.verdict in ("unstable", "undecided"):
        warnings += gaps_under_straps(assembly, contacts)
    friction, program = decision.friction, decision.program
    if friction is not None and program.has_limits:
        pieces = len(program.strap_pieces)
        limits = {"bonds with limited shear": program.cohesion.any(),
                  "straps with a capacity": pieces,
                  "joints with friction": len(program.bounded) > pieces}  # fmt: skip
        warnings.append(
            f"for {' and '.join(name for name, there in limits.items() if there)}, kilter proves "
            "only that equilibrium forces exist, not that friction excludes every motion"
        )
    left_open = still_open(contacts.open_pairs, assembly)
    if decision.trial is not None and left_open:
        warnings.append(trial_words(decision.trial, assembly, len(left_open)))
    elif friction is not None and left_open:
        warnings.append("open pairs could add further motions or prevent the motions found")
    if decision.verdict in ("stable", "balanced"):
        return warnings + loose_parts(assembly, contacts)
    if left_open:
        warnings.append("motions, displacements and z are those without forces at the open pairs")
    mass = program.mass[program.free]
    if len(mass) and mass.max() > FAR_APART * mass.min():
        warnings.append(
            f"the masses differ by a factor of {mass.max() / mass.min():.0e}, so the accelerations "
            "of the lightest parts are not exact"
        )
    return warnings + loose_parts(assembly, contacts)


# Time limit of an analysis over all directions of gravity, with a partial answer on expiry.


AFTERWARDS = 0.4
"""Time after the limit for the verdict of the given direction of gravity [s]."""


@contextmanager
def given_direction_known(
    assembly: Assembly, contacts: ContactSet, time_limit: float | None
) -> Iterator[None]:
    """Limit the time of an analysis; its error then states the verdict of the given direction.

    Arguments: `time_limit`: time from now [s]; None for no limit. Raises `TimeLimitReached` at the
    limit. `TimeLimitReached.known` has the verdict of the given direction of gravity, if it is
    known or found within the following 0.4 s.
    """
    try:
        with stop_after(time_limit):
            yield
    except TimeLimitReached:
        if time_limit is None:
            raise  # the limit of an outer computation
        verdict = check(
            assembly, contacts=contacts, require="equilibrium", effort=0, time_limit=AFTERWARDS
        )
        level = "" if verdict.level is None else f", level {verdict.level}"
        word = verdict.verdict.replace("-", " ")
        raise TimeLimitReached(f"With gravity as given it is {word}{level}.") from None
