"""Questions on a rung of the ladder of assumptions, and the verdict of `kilter.check` on it.

The rungs above "drawn" move or join parts. Their modules are imported when a question is on one of
them, since most questions are about the drawn pose.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from kilter.analysis.assumptions.rungs import is_drawing, rung_of
from kilter.analysis.check import check
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly.assumption import DRAWN, PLAY, LadderRow
from kilter.assembly.changed_copies import with_fields
from kilter.assembly.question import Question
from kilter.contact import detect
from kilter.tell.ladder_words import assumed_words
from kilter.work import stop_after

OPEN = (
    "the search for a pose at rest found none for some parts within its work, which does not prove "
    "that they fall: these parts count as drawn"
)
"""Warning of an answer about a pose that the search left open."""


def verdict_on_rung(asked: Question, *, measures: bool) -> Verdict:
    """The verdict on the rung of a question: of the pose at rest, on its closed points if need be.

    The proof is about the joints and the poses of the rung, which it contains.
    """
    rung = rung_of(asked)
    if rung == DRAWN:
        verdict = check(asked, measures=measures)
        return replace(verdict, drawn=asked.assembly, drawn_contacts=verdict.contact_set)
    from kilter.analysis.assumptions.assume import assume, judged

    with stop_after(asked.seconds_left):
        found = assume(asked, rung)
    marked = found.marked
    found = replace(found, assembly=marked, contacts=found.contacts.of(marked))
    verdict = judged(asked, found, partial(check, measures=measures))
    notes = verdict.notes if found.finished or verdict.level is not None else (*verdict.notes, OPEN)
    return replace(
        verdict,
        notes=notes,
        assume=rung,
        moved=found.moved,
        joined_pairs=found.joints,
        drawn=asked.assembly,
        drawn_contacts=found.drawn_contacts,
    )


def assumed(asked: Question) -> Question:
    """The question about the assembly on its rung, as the functions other than `check` ask it."""
    rung = rung_of(asked)
    if rung == DRAWN:
        return asked
    from kilter.analysis.assumptions.assume import as_drawn, assume, with_joints

    if asked.verb == "settle":
        if rung == PLAY:
            return asked
        contacts = detect.touching(asked)
        base = with_joints(asked.assembly, contacts, rung)
        return asked.but(assembly=as_drawn(base), contacts=contacts.of(base))
    found = assume(asked, rung)
    words = assumed_words(found.joints, found.moved, found.assembly.units)
    marked = found.marked
    if words:
        marked = with_fields(marked, notes=[*marked.notes, words])
    return asked.but(assembly=marked, contacts=found.contacts.of(marked))


def ladder(verdict: Verdict) -> tuple[LadderRow, ...]:
    """The rows of the ladder beside a verdict; empty if the drawn pose holds, or has no ladder."""
    drawn, contacts = verdict.drawn, verdict.drawn_contacts
    if drawn is None or contacts is None or not is_drawing(drawn) or verdict.time_limit is not None:
        return ()
    from kilter.analysis.assumptions.ladder import ladder_rows

    return ladder_rows(verdict, drawn, contacts)
