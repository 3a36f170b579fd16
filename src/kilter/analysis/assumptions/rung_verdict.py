"""The verdict of `kilter.check` on a rung of the ladder of assumptions."""

from __future__ import annotations

from dataclasses import replace

from kilter.analysis.assumptions.assume import Assumed, assume, rung_of
from kilter.analysis.check import check
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly.assumption import DRAWN
from kilter.assembly.question import Question
from kilter.tell.levels import holds, level_rank
from kilter.work import stop_after


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
    verdict = _judged(asked, found, measures)
    return replace(
        verdict,
        assume=rung,
        moved=found.moved,
        joined_pairs=found.joints,
        drawn=asked.assembly,
        drawn_contacts=found.drawn_contacts,
    )


def _judged(asked: Question, found: Assumed, measures: bool) -> Verdict:
    """The verdict on the contacts of the pose, or on its closed points if they prove more."""
    pose = asked.but(assembly=found.assembly, contacts=found.contacts)
    verdict = check(pose, measures=measures)
    if found.closed is None or holds(verdict.level, asked.require):
        return verdict
    closed = found.closed.closed
    listed = replace(found.assembly, contacts=closed.assembly.contacts, detect=False)
    other = check(asked.but(assembly=listed, contacts=closed.contacts.of(listed)),
                  measures=measures)  # fmt: skip
    if level_rank(other.level) <= level_rank(verdict.level):
        return verdict
    return replace(other, rest_gap=found.closed.gap)
