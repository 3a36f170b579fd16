"""The ladder of assumptions in the answer of `kilter.check`: a verdict for each rung.

The rows are decided by the method of `check`. A row whose search for a pose at rest would take too
long is not decided: its rung must be asked for.
"""

from __future__ import annotations

from pathlib import Path

from kilter.analysis.assumptions.assume import assume, has_play
from kilter.analysis.check import check_level
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN, PLAY, RUNGS, LadderRow
from kilter.assembly.question import Question
from kilter.contact import ContactSet, detect
from kilter.errors import KilterError

DRAWINGS = (
    *(".step", ".stp", ".igs", ".iges", ".fcstd", ".3dm", ".3mf", ".stl", ".obj", ".ply", ".off"),
    *(".dae", ".gltf", ".glb"),
)
"""Endings of the files whose answers have a ladder; folders of such files have one, too."""
MOST_PARTS, MOST_VERTICES = 60, 60_000
"""Sizes up to which the rows search for a pose at rest."""
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
    own = _row(verdict, verdict.assume)
    first = own if verdict.assume == DRAWN else _decided(asked, DRAWN)
    if first.level is not None:
        return ()
    rows = [first]
    for rung in RUNGS[1:]:
        rows.append(own if rung == verdict.assume else _decided(asked, rung))
    stands = any(row.level is not None for row in rows[:-1])
    if not stands and not rubs(drawn, contacts):
        rows.append(_with_friction(asked, rows))
    return tuple(rows)


def rubs(assembly: Assembly, contacts: ContactSet) -> bool:
    """Whether the file or an option states any friction."""
    stated = assembly.friction > 0 or any(pair.mu > 0 for pair in assembly.friction_pairs)
    return bool(stated or (contacts.patch_mu > 0).any())


def _row(verdict: Verdict, rung: str, friction: float | None = None) -> LadderRow:
    """The row of a verdict."""
    mass = verdict.program.mass
    falls = [] if verdict.level is not None else verdict.moving
    index = verdict.assembly.index
    largest = sorted(falls, key=lambda name: -mass[index[name]])
    return LadderRow(
        assume=rung,
        friction=friction,
        verdict=verdict.verdict,
        level=verdict.level,
        falls=len(falls),
        names=tuple(largest[:NAMED]),
    )


def _decided(asked: Question, rung: str, friction: float | None = None) -> LadderRow:
    """The row of a rung, decided now; undecided if its search for a pose takes too long."""
    assembly = asked.assembly
    large = len(assembly.parts) > MOST_PARTS or len(assembly.geometry.vertices) > MOST_VERTICES
    undecided = LadderRow(assume=rung, friction=friction, decided=False)
    try:
        found = assume(asked, rung, settles=not large)
        verdict = check_level(asked.but(assembly=found.assembly, contacts=found.contacts))
        closed = None if found.closed is None else found.closed.closed
        if closed is not None and verdict.level is None:
            at_rest = asked.but(assembly=closed.assembly, contacts=closed.contacts)
            other = check_level(at_rest)
            verdict = verdict if other.level is None else other
    except KilterError:
        return undecided
    if large and verdict.level is None and has_play(found.assembly, found.contacts):
        return undecided
    return _row(verdict, rung, friction)


def _with_friction(asked: Question, rows: list[LadderRow]) -> LadderRow:
    """The row with friction on the lowest rung on which parts may move, if it was decided."""
    assert asked.contacts is not None
    rung = PLAY if rows[RUNGS.index(PLAY)].decided else DRAWN
    rough = asked.assembly.with_friction(MU)
    contacts = detect.detected_with_friction(asked.contacts, MU)
    return _decided(asked.but(assembly=rough, contacts=contacts.of(rough)), rung, MU)
