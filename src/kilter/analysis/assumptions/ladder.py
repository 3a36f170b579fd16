"""The ladder of assumptions in the answer of `kilter.check`: a verdict for each rung.

The rows are decided by the method of `check`. A row whose search for a pose at rest would take too
long is not decided: its rung must be asked for.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from kilter.analysis.assumptions.assume import Assumed, assume, has_play
from kilter.analysis.assumptions.rung_verdict import judged
from kilter.analysis.check import check_level
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN, JOINED, PLAY, RUNGS, LadderRow
from kilter.assembly.question import Question
from kilter.contact import ContactSet, detect
from kilter.errors import KilterError

DRAWINGS = (
    *(".step", ".stp", ".igs", ".iges", ".fcstd", ".3dm", ".3mf", ".stl", ".obj", ".ply", ".off"),
    *(".dae", ".gltf", ".glb"),
)
"""Endings of the files whose answers have a ladder; folders of such files have one, too."""
MOST_PARTS, MOST_VERTICES, MOST_JOINED = 60, 5_000, 16_000
"""Sizes up to which the rows search for a pose at rest: numbers of parts and of vertices, and of
vertices on the rung joined, whose bodies are few."""
WORK = 0.2
"""Work limit of the search for the pose of a row, over the limit with `--assume` [-]."""
MU = 0.3
"""Friction coefficient of the last row [-]."""
NAMED = 5
"""Number of the falling parts that a row names."""


def is_drawing(assembly: Assembly) -> bool:
    """Whether an assembly comes from CAD, from a mesh file, or from a folder of them."""
    source = Path(assembly.source)
    return bool(assembly.source) and (source.suffix.lower() in DRAWINGS or source.is_dir())


def ladder(verdict: Verdict) -> tuple[LadderRow, ...]:
    """The rows of the ladder beside a verdict; empty if the drawn pose holds, or has no ladder."""
    drawn, contacts = verdict.drawn, verdict.drawn_contacts
    if drawn is None or contacts is None or not is_drawing(drawn) or verdict.time_limit is not None:
        return ()
    asked = Question(
        assembly=drawn, contacts=contacts, require=verdict.require, effort=verdict.effort,
        time_limit=verdict.seconds_left,
    )  # fmt: skip
    rows: list[LadderRow] = []
    known: dict[int, Assumed] = {}
    for rung in RUNGS:
        if rung == verdict.assume:
            rows.append(_row(verdict, rung))
        else:
            rows.append(_decided(asked, rung, known))
        if rung == DRAWN and rows[0].level is not None:
            return ()
    if not any(row.level is not None for row in rows[:-1]) and not rubs(drawn, contacts):
        searched = all(found.ended for found in known.values())
        if len(drawn.geometry.vertices) > MOST_VERTICES:
            rows.append(LadderRow(assume=DRAWN, friction=MU, decided=False))
        else:
            rows.append(_with_friction(asked, PLAY if searched else DRAWN))
    return tuple(rows)


def rubs(assembly: Assembly, contacts: ContactSet) -> bool:
    """Whether the file or an option states any friction."""
    stated = assembly.friction > 0 or any(pair.mu > 0 for pair in assembly.friction_pairs)
    return bool(stated or (contacts.patch_mu > 0).any())


def _row(verdict: Verdict, rung: str) -> LadderRow:
    """The row of a verdict."""
    mass = verdict.program.mass
    falls = [] if verdict.level is not None else verdict.moving
    index = verdict.assembly.index
    largest = sorted(falls, key=lambda name: -mass[index[name]])
    return LadderRow(
        assume=rung,
        verdict=verdict.verdict,
        level=verdict.level,
        falls=len(falls),
        names=tuple(largest[:NAMED]),
    )


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
            moves = rung == JOINED or not late
            found = known.get(found.joints) or _settled(asked, rung, moves=moves)
            known.setdefault(found.joints, found)
        verdict = judged(asked, found, check_level)
    except KilterError:
        return undecided
    if verdict.level is None and not found.ended:
        return undecided
    return _row(verdict, rung)


def _settled(asked: Question, rung: str, *, moves: bool) -> Assumed:
    """The assembly on a rung; of a large one only if it holds without a movement."""
    assembly = asked.assembly
    most = MOST_JOINED if rung == JOINED else MOST_VERTICES
    large = len(assembly.parts) > MOST_PARTS or len(assembly.geometry.vertices) > most
    if large or not moves:
        found = assume(asked, rung, settles=False)
        return replace(found, ended=not has_play(found.assembly, found.contacts))
    return assume(asked, rung, work=WORK)


def _with_friction(asked: Question, rung: str) -> LadderRow:
    """The row with friction on a rung; as drawn if the rung cannot be decided.

    Friction holds parts elsewhere than without it, so that their pose is searched for anew.
    """
    assembly = asked.assembly.with_friction(MU)
    contacts = detect.detected_with_friction(detect.touching(asked), MU).of(assembly)
    rough = asked.but(assembly=assembly, contacts=contacts)
    row = _decided(rough, rung, {})
    return replace(row if row.decided else _decided(rough, DRAWN, {}), friction=MU)
