"""A folder of mesh and STEP files, one part a file.

A part has the name of its file; a file of several objects gives ``<file>/<object>``. Files
come in the order in which people count (2 before 10). What is neither is passed over and named
in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.formats import FORMATS, read_bodies
from kilter.files.naming import distinct, filled, natural_key
from kilter.files.placed import FileBodies
from kilter.shape.primitives import Mesh

__all__ = ["load_folder"]


def load_folder(path: Path, *, units: str | None = None) -> Assembly:
    """An assembly of the mesh and STEP files of a folder; folders within it are not entered.

    Raises
    ------
    InputError
        If the folder cannot be read or holds no such file, or a file is damaged.
    """
    try:
        entries = sorted(path.iterdir(), key=lambda entry: natural_key(entry.name))
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror or error}",
            file=str(path),
            hint="check the path and its rights",
        ) from None
    entries = [entry for entry in entries if not entry.name.startswith(".")]
    chosen = [e for e in entries if e.suffix.lower() in FORMATS and not e.is_dir()]
    if not chosen:
        raise InputError(
            "no mesh or STEP file in the folder", file=str(path), hint=_instead(entries)
        )
    solids = [read_bodies(entry) for entry in chosen]
    target = _units(path, chosen, solids, units)
    notes = _ignored([entry for entry in entries if entry not in chosen])
    for entry, found in zip(chosen, solids, strict=True):
        notes += [f"{entry.name}: {note}" for note in found.notes]
        notes += _several_bodies(entry, found)
    return Assembly(
        _parts(path, chosen, solids, target), units=target, source=str(path), notes=notes
    )


def _instead(entries: Sequence[Path]) -> str:
    files = [e.name for e in entries if e.name.lower().endswith(".json")]
    if files:
        return f"give the file itself: {files[0]!r}"
    return f"put files of {', '.join(FORMATS)} into it"


def _parts(path: Path, files: list[Path], solids: list[FileBodies], target: str) -> list[Part]:
    stems = distinct([file.stem for file in files])
    parts = []
    for file, stem, found in zip(files, stems, solids, strict=True):
        several = len(found.names) > 1
        names = [f"{stem}/{name}" for name in filled(found.names, stem)] if several else [stem]
        try:
            for name, (shape, pose) in zip(names, found.in_units(target), strict=True):
                parts.append(Part(name, shape, pose))
        except InputError as error:
            raise error.located(file=str(file)) from None
    return parts


def _units(path: Path, files: list[Path], solids: list[FileBodies], units: str | None) -> str:
    """The units asked for, else those that the files state."""
    stated = sorted({found.units for found in solids if found.units})
    if units:
        return units
    silent = [file.name for file, found in zip(files, solids, strict=True) if not found.units]
    if len(stated) > 1 and silent:
        raise InputError(
            f"files are in {' and '.join(stated)}, {silent[0]!r} states no units",
            file=str(path),
            hint="give the units: load(path, units='mm')",
            option="give --units",
        )
    return stated[0] if len(stated) == 1 else "m"


def _ignored(entries: Sequence[Path], limit: int = 8) -> list[str]:
    if not entries:
        return []
    shown = ", ".join(repr(entry.name) for entry in entries[:limit])
    more = f" and {len(entries) - limit} more" if len(entries) > limit else ""
    return [f"passed over, no mesh or STEP files: {shown}{more}"]


def _several_bodies(file: Path, found: FileBodies) -> list[str]:
    alone = found.shapes[0]
    if found.names != (None,) or not isinstance(alone, Mesh):
        return []
    count = len(split_bodies(alone))
    return [f"{file.name}: {count} separate bodies, taken as one part"] if count > 1 else []
