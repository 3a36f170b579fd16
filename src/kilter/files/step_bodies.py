"""Read the solids of a STEP document as bodies; a shared solid is read once."""

from __future__ import annotations

import dataclasses
import fnmatch
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

from kilter.errors import InputError, some, some_names
from kilter.files.occt import failures, quiet
from kilter.files.placed import FileBodies
from kilter.files.stated_accuracy import stated_accuracy
from kilter.files.step_document import Occurrence, StepDocument, read_document
from kilter.files.step_solids import ReadSolid, read_solid, stand_in

__all__ = ["bodies_of", "step_bodies"]


def step_bodies(
    path: Path,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Read the solids of a STEP file as bodies with names and poses.

    Arguments: `tell`: called before each step with its description and the key of the current
    solid, or -1. Raises `InputError` if the file is damaged, or has no solid with a volume.
    """
    try:
        with quiet():
            tell("reading STEP", -1)
            return bodies_of(read_document(path), without, tell, broken)
    except failures():
        raise InputError(
            "damaged STEP: it gives no shape", hint="export it again as STEP"
        ) from None


def bodies_of(
    document: StepDocument,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Convert the solids of a STEP document, from a file or from memory, to bodies.

    The other parameters are those of `step_bodies`.
    """
    kept = [row for row in document.solids if not _matches(row.name, without)]
    read = _read(kept, tell, broken)
    bodies, passed, empty = [], list(document.passed), []
    for row in kept:
        solid = read[row.key].solid
        if solid is not None and not (row.skin and (len(solid.holes) or solid.stand_in)):
            bodies.append((row, solid))
        elif row.skin:
            passed.append(f"{row.name!r} (1 shell)")
        else:
            empty.append(row.name)
    if not bodies and len(kept) == len(document.solids):
        raise _no_solid(passed, empty)
    accuracy = stated_accuracy(document.files, document.units)
    solids = {row.key: dataclasses.replace(solid, uncertainty=accuracy) for row, solid in bodies}
    notes = [f"ignored, not solids: {some(passed, 8)}"] if passed else []
    notes += [f"left out, without volume: {some_names(empty, 8)}"] if empty else []
    hidden = [row.name for row, _ in bodies if row.stated.hidden]
    if hidden:
        notes.append(
            f"hidden in the file: {some_names(hidden, 8)}; leave out hidden variants with --without"
        )
    notes += _notes([row for row, _ in bodies], read)
    return FileBodies(
        names=tuple(row.name for row, _ in bodies),
        shapes=tuple(solids[row.key] for row, _ in bodies),
        poses=tuple(row.pose for row, _ in bodies),
        densities=tuple(row.stated.density for row, _ in bodies),
        colors=tuple(row.stated.color for row, _ in bodies),
        materials=tuple(row.stated.material for row, _ in bodies),
        layers=tuple(row.stated.layer for row, _ in bodies),
        units=document.units,
        notes=tuple(notes),
        left_out=tuple(row.name for row in document.solids if _matches(row.name, without)),
    )


def _no_solid(passed: list[str], empty: list[str]) -> InputError:
    """Build the error for a document without solids; it lists the other shapes."""
    what = "no solid"
    if passed:
        what += f", only {some(passed)}"
    elif empty:
        what += f" with a volume, only {some_names(empty)}"
    return InputError(what, hint="export solids, not surfaces or curves")


def _matches(name: str, patterns: Sequence[str]) -> bool:
    """Whether a name equals a pattern or matches it as a wildcard."""
    return any(name == pattern or fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def _read(
    solids: list[Occurrence], tell: Callable[[str, int], None], broken: Collection[int]
) -> dict[int, ReadSolid]:
    """Read each distinct solid of a STEP document once; return the solids by their keys."""
    first: dict[int, Occurrence] = {}
    for row in solids:
        first.setdefault(row.key, row)
    read = {}
    for number, row in enumerate(first.values(), start=1):
        tell(f"cutting faces of solid {number} of {len(first)}", row.key)
        read[row.key] = (stand_in if row.key in broken else read_solid)(row.shape)
    return read


def _notes(solids: list[Occurrence], read: dict[int, ReadSolid]) -> list[str]:
    """Notes on solids that were read with changes; parts with the same solid share a note."""
    alike: dict[int, list[str]] = {}
    for row in solids:
        alike.setdefault(row.key, []).append(row.name)
    return [
        f"{some_names(names)}: {read[key].note}" for key, names in alike.items() if read[key].note
    ]
