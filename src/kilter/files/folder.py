"""Read a folder of mesh and STEP files, one part per file.

A part has the name of its file; the objects of a file with several are named
``<file>/<object>``. Files are sorted by the numbers in their names (2 before 10). Files of other
types are ignored and listed in a note.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.formats import FORMATS, read_bodies
from kilter.files.limits import require_regular
from kilter.files.naming import distinct, fill_names, natural_key
from kilter.files.placed import FileBodies
from kilter.shape.primitives import Mesh

__all__ = ["load_folder"]


def load_folder(path: Path, *, units: str | None = None) -> Assembly:
    """Read all mesh and STEP files of a folder as an assembly; subfolders are ignored.

    Raises `InputError` if the folder cannot be read, has no mesh or STEP file, or a file is
    damaged.
    """
    try:
        entries = sorted(path.iterdir(), key=lambda entry: natural_key(entry.name))
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror or error}",
            file=str(path),
            hint="check the path and the permissions",
        ) from None
    entries = [entry for entry in entries if not entry.name.startswith(".")]
    chosen = [e for e in entries if e.suffix.lower() in FORMATS and not e.is_dir()]
    if not chosen:
        raise InputError(
            "no mesh or STEP file in the folder", file=str(path), hint=_remedy(entries)
        )
    try:
        for entry in chosen:
            require_regular(entry)
    except InputError as error:
        raise error.located(file=str(path)) from None
    solids = [read_bodies(entry) for entry in chosen]
    target = _units(path, chosen, solids, units)
    notes = _ignored_note([entry for entry in entries if entry not in chosen])
    for entry, bodies in zip(chosen, solids, strict=True):
        notes += [f"{entry.name}: {note}" for note in bodies.notes]
        notes += _several_bodies(entry, bodies)
    return Assembly(
        _parts(path, chosen, solids, target), units=target, source=str(path), notes=notes
    )


def _remedy(entries: Sequence[Path]) -> str:
    """Advice to the user about a folder without mesh files: give its JSON file, or add meshes."""
    files = [e.name for e in entries if e.name.lower().endswith(".json")]
    if files:
        return f"give the file itself: {files[0]!r}"
    return f"put files of {', '.join(FORMATS)} into it"


def _parts(path: Path, files: list[Path], solids: list[FileBodies], target: str) -> list[Part]:
    """Build the parts of all files, with lengths converted to the unit `target`."""
    stems = distinct([file.stem for file in files])
    parts = []
    for file, stem, bodies in zip(files, stems, solids, strict=True):
        several = len(bodies.names) > 1
        names = [f"{stem}/{name}" for name in fill_names(bodies.names, stem)] if several else [stem]
        try:
            rows = zip(names, bodies.in_units(target), bodies.stated, strict=True)
            parts += [Part(name, shape, pose, **stated) for name, (shape, pose), stated in rows]
        except InputError as error:
            raise error.located(file=str(file)) from None
    return parts


def _units(path: Path, files: list[Path], solids: list[FileBodies], units: str | None) -> str:
    """Length unit of the assembly: the given unit, else that of the files, else "m".

    If the files state several units, metres serve as the common unit.
    """
    stated = sorted({bodies.units for bodies in solids if bodies.units})
    if units:
        return units
    silent = [file.name for file, bodies in zip(files, solids, strict=True) if not bodies.units]
    if len(stated) > 1 and silent:
        raise InputError(
            f"files are in {' and '.join(stated)}, {silent[0]!r} states no units",
            file=str(path),
            hint="give the units: load(path, units='mm')",
            option="give --units",
        )
    return stated[0] if len(stated) == 1 else "m"


def _ignored_note(entries: Sequence[Path], limit: int = 8) -> list[str]:
    """A note that names up to `limit` files of other types; an empty list if there are none."""
    if not entries:
        return []
    shown = ", ".join(repr(entry.name) for entry in entries[:limit])
    more = f" and {len(entries) - limit} more" if len(entries) > limit else ""
    return [f"ignored, not mesh or STEP files: {shown}{more}"]


def _several_bodies(file: Path, bodies: FileBodies) -> list[str]:
    """A note if a file without names holds several separate bodies; else an empty list."""
    only = bodies.shapes[0]
    if bodies.names != (None,) or not isinstance(only, Mesh):
        return []
    count = len(split_bodies(only))
    return [f"{file.name}: {count} separate bodies, read as a single part"] if count > 1 else []
