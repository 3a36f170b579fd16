"""Input files of a batch, which a list file names or a folder contains."""

from __future__ import annotations

from pathlib import Path

from kilter.errors import InputError
from kilter.files.formats import FORMATS
from kilter.files.limits import MOST_TABLE_BYTES
from kilter.files.naming import natural_key
from kilter.files.raw import is_file, is_folder, read_bytes

__all__ = ["listed_files"]

READABLE = (*FORMATS, ".json")
"""Endings of files that `kilter.load` reads."""


def listed_files(source: str | Path) -> tuple[Path, list[str]]:
    """The folder to which the paths of a batch are relative, and the path of each input file.

    Raises `InputError` if it cannot be read, or names nothing.
    """
    path = Path(source)
    if path.suffix.lower() in READABLE and is_file(path):
        raise InputError(
            "is an assembly, not a list of assemblies", file=str(path),
            hint="use `kilter check`, or give its folder",
        )  # fmt: skip
    try:
        if is_folder(path):
            chosen = [e for e in path.iterdir() if _is_assembly(e)]
            base, listed = path, sorted((e.name for e in chosen), key=natural_key)
        else:
            lines = read_bytes(path, most=MOST_TABLE_BYTES).decode("utf-8").splitlines()
            words = [line.strip() for line in lines]
            base, listed = path.parent, [w for w in words if w and not w.startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"cannot be read: {getattr(error, 'strerror', None) or 'it is not a text file'}",
            file=str(path),
            hint="give a folder of assemblies, or a text file with a path in each line",
        ) from None
    if not listed:
        hint = "name a file in each line"
        if is_folder(path):
            hint = "subfolders are not searched; name their files in a list, a file in each line"
        raise InputError("it contains no assembly", file=str(path), hint=hint)
    return base.resolve(), listed


def _is_assembly(entry: Path) -> bool:
    readable = entry.suffix.lower() in READABLE
    return readable and not entry.name.startswith(".") and entry.is_file()
