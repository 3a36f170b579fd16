"""The ladder of assumptions in the answer of `kilter.check`: a verdict for each rung.

The rows are decided by the method of `check`. A row whose search for a pose at rest would take too
long is not decided: its rung must be asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kilter.analysis.assumptions.assume import (
    FEW_VERTICES,
    Assumed,
    assume,
    falls_surely,
    judged,
)
from kilter.analysis.check import check_level
from kilter.analysis.verdict.remarks import floating_groups, touching_nothing
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN, JOINED, PLAY, RUNGS, LadderRow
from kilter.assembly.question import Question
from kilter.contact import ContactSet, detect
from kilter.errors import KilterError

MOST_PARTS, MOST_JOINED = 60, 16_000
"""Sizes up to which the rows search for a pose at rest: number of parts, and number of vertices on
the rung joined, whose bodies are few; `FEW_VERTICES` on the others."""
WORK = 0.2
"""Work limit of the search for the pose of a row, over the limit with `--assume` [-]."""
MU = 0.3
"""Friction coefficient of the last row [-]."""
NAMED = 5
"""Number of the falling parts that a row names."""


def ladder_rows(verdict: Verdict, drawn: Assembly, contacts: ContactSet) -> tuple[LadderRow, ...]:
    """The rows beside the verdict on a drawing and its contacts; none if the drawn pose holds."""
    asked = Question(
        assembly=drawn, contacts=contacts, require=verdict.require, effort=verdict.effort,
        time_limit=verdict.seconds_left,
    )  # fmt: skip
    first = _row(asked, verdict, DRAWN) if verdict.assume == DRAWN else _decided(asked, DRAWN, {})
    if first.level is not None:
        return ()
    rows = [first]
    known: dict[int, Assumed] = {}
    tips, surely = falls_surely(asked)
    for rung in RUNGS[1:]:
        if rung == verdict.assume:
            rows.append(_row(asked, verdict, rung))
            continue
        row = LadderRow(assume=rung, decided=False) if tips else _decided(asked, rung, known)
        open_row = not row.decided and not row.falls
        rows.append(_surely(asked, rung, surely, tips=tips) if open_row else row)
    if not any(row.level is not None for row in rows[:-1]) and not rubs(drawn, contacts):
        searched = all(found.ended for found in known.values())
        if tips or len(drawn.geometry.vertices) > FEW_VERTICES:
            row = _surely(asked, DRAWN, surely, tips=tips)
            rows.append(replace(row, friction=MU))
        else:
            rows.append(_with_friction(asked, PLAY if searched else DRAWN))
    return tuple(row if row.decided else _with_reason(asked, row) for row in rows)


def _with_reason(asked: Question, row: LadderRow) -> LadderRow:
    """An undecided row with the reason why it was not decided."""
    return replace(row, why="work" if _searches(asked, row.assume) else "size")


def rubs(assembly: Assembly, contacts: ContactSet) -> bool:
    """Whether the file or an option states any friction."""
    stated = assembly.friction > 0 or any(pair.mu > 0 for pair in assembly.friction_pairs)
    return bool(stated or (contacts.patch_mu > 0).any())


def _row(asked: Question, verdict: Verdict, rung: str) -> LadderRow:
    """The row of a verdict."""
    row = _falling(asked, rung, () if verdict.level is not None else verdict.moving)
    return replace(row, verdict=verdict.verdict, level=verdict.level)


def _falling(
    asked: Question, rung: str, falls: Sequence[str], *, decided: bool = True
) -> LadderRow:
    """The row of an unstable assembly with its falling parts."""
    mass, index = asked.assembly.geometry.mass, asked.assembly.index
    largest = sorted(falls, key=lambda name: -mass[index[name]])
    return LadderRow(
        assume=rung,
        verdict="unstable",
        falls=len(falls),
        names=tuple(largest[:NAMED]),
        decided=decided,
    )


def _surely(asked: Question, rung: str, surely: Sequence[str], *, tips: bool) -> LadderRow:
    """The row of a rung from proofs that need no search: certain falls, or a common tipping over.

    Arguments: `surely`: parts that fall on every rung; `tips`: whether all parts tip over together.
    Then the row of a lower rung names no parts: it is not known which of them fall there.
    """
    if not tips and not surely:
        return LadderRow(assume=rung, decided=False)
    return _falling(asked, rung, surely if rung == JOINED or not tips else (), decided=tips)


def _decided(asked: Question, rung: str, known: dict[int, Assumed]) -> LadderRow:
    """The row of a rung, decided now; undecided if its search for a pose takes too long.

    `known`: findings on lower rungs, by their number of joints: without a further joint a rung is
    as the one before it. After a search without an end, higher rungs are decided without a search.
    """
    undecided = LadderRow(assume=rung, decided=False)
    try:
        found = assume(asked, rung, settles=False)
        if rung != DRAWN:
            late = any(not other.ended for other in known.values())
            below = known.get(found.joints)
            if below is None or (rung == JOINED and not below.ended):
                below = _settled(asked, rung, moves=rung == JOINED or not late)
            found = below
            known.setdefault(found.joints, found)
        if found.surely_fall:
            return _falling(asked, rung, found.surely_fall, decided=False)
        if not found.ended and (not found.joints or _floats(found)):
            return undecided
        verdict = judged(asked, found, check_level)
    except KilterError:
        return undecided
    if verdict.level is None and not found.ended:
        return undecided
    return _row(asked, verdict, rung)


def _floats(found: Assumed) -> bool:
    """Whether a part touches nothing, so that no forces hold it."""
    assembly, contacts = found.assembly, found.contacts
    return bool(touching_nothing(assembly, contacts) or floating_groups(assembly, contacts))


def _settled(asked: Question, rung: str, *, moves: bool) -> Assumed:
    """The assembly on a rung; a large one without a search for a pose at rest."""
    moves = moves and _searches(asked, rung)
    if not moves or (rung == JOINED and len(asked.assembly.geometry.vertices) > FEW_VERTICES):
        found = assume(asked, rung, searches=False)
        if not moves or found.ended:
            return found
    return assume(asked, rung, work=WORK)


def _searches(asked: Question, rung: str) -> bool:
    """Whether the row of a rung searches for a pose at rest."""
    parts, vertices = len(asked.assembly.parts), len(asked.assembly.geometry.vertices)
    return parts <= MOST_PARTS and vertices <= (MOST_JOINED if rung == JOINED else FEW_VERTICES)


def _with_friction(asked: Question, rung: str) -> LadderRow:
    """The row with friction on a rung; as drawn if the rung cannot be decided.

    Friction holds parts elsewhere than without it, so that their pose is searched for anew.
    """
    assembly = asked.assembly.with_friction(MU)
    contacts = detect.detected_with_friction(detect.touching(asked), MU).of(assembly)
    rough = asked.but(assembly=assembly, contacts=contacts)
    row = _decided(rough, rung, {})
    return replace(row if row.decided else _decided(rough, DRAWN, {}), friction=MU)
