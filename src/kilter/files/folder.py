"""A folder of mesh files, one part a file.

A part has the name of its file; a file of several objects gives ``<file>/<object>``. Files
come in the order in which people count (2 before 10). What is no mesh is passed over and
named in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.meshes import SUFFIXES, Solids, read_solids
from kilter.files.naming import distinct, filled, natural_key
from kilter.files.placed import scaled
from kilter.units import metres_per_unit

__all__ = ["load_folder"]


def load_folder(path: Path, *, units: str | None = None) -> Assembly:
    """An assembly of the mesh files of a folder; folders within it are not entered.

    Raises
    ------
    InputError
        If the folder cannot be read or holds no mesh file, or a file is damaged.
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
    chosen = [e for e in entries if e.suffix.lower() in SUFFIXES and not e.is_dir()]
    if not chosen:
        raise InputError("no mesh file in the folder", file=str(path), hint=_instead(entries))
    solids = [read_solids(entry) for entry in chosen]
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
    return f"put files of {', '.join(SUFFIXES)} into it"


def _parts(path: Path, files: list[Path], solids: list[Solids], target: str) -> list[Part]:
    stems = distinct([file.stem for file in files])
    parts = []
    for file, stem, found in zip(files, stems, solids, strict=True):
        factor = metres_per_unit(found.units or target) / metres_per_unit(target)
        several = len(found.meshes) > 1
        names = [f"{stem}/{name}" for name in filled(found.names, stem)] if several else [stem]
        try:
            for name, mesh in zip(names, found.meshes, strict=True):
                parts.append(Part(name, scaled(mesh, factor)))
        except InputError as error:
            raise error.located(file=str(file)) from None
    return parts


def _units(path: Path, files: list[Path], solids: list[Solids], units: str | None) -> str:
    """The units asked for, else those that the files state."""
    stated = sorted({found.units for found in solids if found.units})
    if units:
        return units
    silent = [file.name for file, found in zip(files, solids, strict=True) if not found.units]
    if len(stated) > 1 and silent:
        raise InputError(
            f"files are in {' and '.join(stated)}, {silent[0]!r} states no units",
            file=str(path),
            hint="give --units",
        )
    return stated[0] if len(stated) == 1 else "m"


def _ignored(entries: Sequence[Path], limit: int = 8) -> list[str]:
    if not entries:
        return []
    shown = ", ".join(repr(entry.name) for entry in entries[:limit])
    more = f" and {len(entries) - limit} more" if len(entries) > limit else ""
    return [f"passed over, no mesh files: {shown}{more}"]


def _several_bodies(file: Path, found: Solids) -> list[str]:
    if found.names != (None,):
        return []
    count = len(split_bodies(found.meshes[0]))
    return [f"{file.name}: {count} separate bodies, taken as one part"] if count > 1 else []
