"""The verdict of `kilter.check` on a rung of the ladder of assumptions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from kilter.analysis.assumptions.assume import Assumed, assume, rung_of
from kilter.analysis.check import check
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly.assumption import DRAWN
from kilter.assembly.changed_copies import with_fields
from kilter.assembly.question import Question
from kilter.tell.levels import holds, level_rank
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


def judged(asked: Question, found: Assumed, judge: Callable[[Question], Verdict]) -> Verdict:
    """The verdict on the contacts of the pose, or on its closed points if they prove more."""
    verdict = judge(asked.but(assembly=found.assembly, contacts=found.contacts))
    if found.closed is None or holds(verdict.level, asked.require):
        return verdict
    closed = found.closed.closed
    listed = with_fields(found.assembly, contacts=closed.assembly.contacts, detect=False)
    other = judge(asked.but(assembly=listed, contacts=closed.contacts.of(listed)))
    if level_rank(other.level) <= level_rank(verdict.level):
        return verdict
    return replace(other, rest_gap=found.closed.gap)
