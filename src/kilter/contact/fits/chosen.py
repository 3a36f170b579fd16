"""Saved choices as options of a reading, overridden by the caller's options."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from kilter.assembly import Assembly
from kilter.contact.common.gaps import Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError
from kilter.files.choices import Choices, digest, find_choices
from kilter.files.choices_off import released_in_part, switched_off
from kilter.files.reading import Reading

__all__ = ["Chosen", "chosen", "read_chosen", "tolerance_of"]


@dataclass(frozen=True, slots=True)
class Chosen:
    """A file to read and the options for it: those saved with it, overridden by the caller's.

    Attributes
    ----------
    path : Path
        The file that the choices name.
    reading : Reading
        Options of reading it, with its digest for proofs.
    choices : Choices
        The choices without the keys that are switched off.
    notes : tuple of str
        Sentences about replaced choices and about a changed file.
    """

    path: Path
    reading: Reading
    choices: Choices
    notes: tuple[str, ...]


def chosen(choices: Choices, reading: Reading | None = None) -> Chosen:
    """Merge the options of a file of choices with the caller's options, which have priority.

    Raises
    ------
    InputError
        If the file does not exist, or the choices do not hold a released part.
    """
    path = choices.path
    if find_choices(path) is not None:
        raise InputError(f"{choices.file} is a file of choices itself", hint="name its file")
    given = reading or Reading()
    partly = released_in_part(choices.held, given.release)
    choices, notes = switched_off(choices, given.off, given.release)
    merged, replaced = replace(given, off=(), release=()).over(choices)
    notes += replaced
    present = digest(path)
    if choices.sha256 not in (None, present):
        notes.append(
            f"{choices.file} has changed since the choices were saved; 'kilter save' renews them"
        )
    merged = replace(merged, entries={**merged.entries, "sha256": present}, release=partly)
    return Chosen(path, merged, choices, tuple(notes))


def tolerance_of(choices: Choices) -> Tolerance:
    """The contact tolerance that a file of choices states; the default if it states none."""
    values = choices.tolerance or {}
    base = Tolerance.loose() if choices.loose else Tolerance()
    angle = values.get("angle_deg")
    return replace(
        base,
        gap=values.get("gap"),
        angle=base.angle if angle is None else math.radians(angle),
        clearance=values.get("clearance"),
    )


def read_chosen(
    choices: Choices, reading: Reading | None = None, *, tolerance: Tolerance | None = None
) -> Assembly:
    """Read the assembly that a file of choices describes, with its saved options and tolerance.

    A `tolerance` other than the default one wins over that of the choices.

    Raises
    ------
    InputError
        If the file cannot be read, or an option is invalid.
    """
    both = chosen(choices, reading)
    if tolerance in (None, Tolerance()):
        tolerance = tolerance_of(both.choices)
    assembly = both.reading.read(both.path)
    assembly, _ = fasten_as_read(assembly, both.reading, tolerance=tolerance)
    own = None if tolerance == Tolerance() else tolerance
    return replace(
        assembly,
        notes=[*assembly.notes, *both.notes],
        tolerance=own,
        reading=both.reading.options(),
    )
