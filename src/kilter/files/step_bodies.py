"""The solids of a STEP file as bodies: read one by one, those that are shared once."""

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
    """What a STEP file holds.

    Parameters
    ----------
    path : Path
    without : sequence of str
        Names, or globs, of solids that are left out.
    tell : callable
        Called with a word and a number before each step: of the solid at work, or -1.
    broken : collection of int
        Numbers of solids over which OCCT breaks down: a stand-in takes their place.

    Raises
    ------
    InputError
        If the file is damaged, or holds no solid with a volume.
    """
    try:
        with quiet():
            tell("reading STEP", -1)
            return bodies_of(read_document(path), without, tell, broken)
    except failures():
        raise InputError(
            "damaged STEP: no shape can be made of it", hint="export it again as STEP"
        ) from None


def bodies_of(
    document: StepDocument,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """The bodies of what a STEP file, or OCCT in memory, holds; the rest as of `step_bodies`."""
    kept = [one for one in document.solids if not _matches(one.name, without)]
    read = _read(kept, tell, broken)
    found, passed, empty = [], list(document.passed), []
    for one in kept:
        solid = read[one.key].solid
        if solid is not None and not (one.skin and (len(solid.holes) or solid.stand_in)):
            found.append((one, solid))
        elif one.skin:
            passed.append(f"{one.name!r} (1 shell)")
        else:
            empty.append(one.name)
    if not found and len(kept) == len(document.solids):
        raise _nothing(passed, empty)
    accuracy = stated_accuracy(document.files, document.units)
    solids = {one.key: dataclasses.replace(solid, uncertainty=accuracy) for one, solid in found}
    notes = [f"passed over, no solids: {some(passed, 8)}"] if passed else []
    notes += [f"left out, they have no volume: {some_names(empty, 8)}"] if empty else []
    notes += _notes([one for one, _ in found], read)
    return FileBodies(
        names=tuple(one.name for one, _ in found),
        shapes=tuple(solids[one.key] for one, _ in found),
        poses=tuple(one.pose for one, _ in found),
        units=document.units,
        notes=tuple(notes),
        left_out=tuple(one.name for one in document.solids if _matches(one.name, without)),
    )


def _nothing(passed: list[str], empty: list[str]) -> InputError:
    what = "no solid"
    if passed:
        what += f", only {some(passed)}"
    elif empty:
        what += f" with a volume, only {some_names(empty)}"
    return InputError(what, hint="export solids, not surfaces or curves")


def _matches(name: str, patterns: Sequence[str]) -> bool:
    return any(name == pattern or fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def _read(
    solids: list[Occurrence], tell: Callable[[str, int], None], broken: Collection[int]
) -> dict[int, ReadSolid]:
    """Each different solid, by its key."""
    first: dict[int, Occurrence] = {}
    for one in solids:
        first.setdefault(one.key, one)
    read = {}
    for number, one in enumerate(first.values(), start=1):
        tell(f"cutting faces of solid {number} of {len(first)}", one.key)
        read[one.key] = (stand_in if one.key in broken else read_solid)(one.shape)
    return read


def _notes(solids: list[Occurrence], read: dict[int, ReadSolid]) -> list[str]:
    """What is not as the file has it, the parts that share a solid together."""
    alike: dict[int, list[str]] = {}
    for one in solids:
        alike.setdefault(one.key, []).append(one.name)
    return [
        f"{some_names(names)}: {read[key].note}" for key, names in alike.items() if read[key].note
    ]
