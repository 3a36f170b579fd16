"""Write choices beside the file that they are about."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.choices import LOWEST, OPTIONS, STUDS, Choices, digest, find_choices
from kilter.files.writing import json_lines, write_text

__all__ = ["choices_about", "require_place", "write_choices"]

SUFFIX = ".json"
"""Ending of a file of choices; the commands look for choices only in such files."""


def choices_about(path: Path, folder: Path, options: Mapping[str, Any], **keys: Any) -> Choices:
    """Build choices from the options with which a file is read: the inverse of `Choices.options`.

    Raises `InputError` if the file does not lie in the folder or below.
    """
    values = {key: options[option] for key, option in OPTIONS.items() if option in options}
    studs = {key: options[option] for key, option in STUDS.items() if option in options}
    if studs:
        values["studs"] = studs
    if "floor" in options:
        values["floor"] = True if options["floor"] == LOWEST else options["floor"]
    entries = dict(options.get("entries", {}))
    pulls = [{"parts": [a, b], "pull": pull} for a, b, pull in options.get("bond", ())]
    entries["bonds"] = [*pulls, *entries.get("bonds", ())]
    entries["sha256"] = digest(path)
    return Choices(_relative(path, folder), folder=folder, **{**values, **entries, **keys})


def _relative(path: Path, folder: Path) -> str:
    """Path of a file relative to a folder that contains it, with "/" between folders."""
    inside = Path(os.path.realpath(path.parent), path.name)
    base = Path(os.path.realpath(folder))
    try:
        return inside.relative_to(base).as_posix()
    except ValueError:
        raise InputError(
            f"the file {str(path)!r} is outside {str(folder)!r}, the folder of the choices",
            hint=f"write them to the folder {str(path.parent)!r} or to a folder above it",
        ) from None


def require_place(output: Path) -> bool:
    """Verify that choices may be written to a file; return whether it already holds choices.

    Raises `InputError` if the file has another ending than .json, or has another content than
    choices.
    """
    if output.suffix.lower() != SUFFIX:
        raise InputError(
            "choices need a file that ends in .json", file=str(output), hint="give X.kilter.json"
        )
    if not os.path.exists(output):  # also for a name that the system rejects
        return False
    try:
        replaces = find_choices(output) is not None
    except InputError:
        replaces = False
    if not replaces:
        raise InputError(
            "is not overwritten, since it holds something other than saved choices",
            file=str(output),
            hint="write to another file",
        )
    return True


def write_choices(choices: Choices, output: str | Path, *, links: bool = True) -> None:
    """Write choices to a JSON file, a key in each line; a failure leaves the old file intact.

    `links` is that of `kilter.files.writing.write_bytes`.

    Raises `InputError` as `require_place`, or if the file cannot be written.
    """
    require_place(Path(output))
    write_text(output, json_lines(choices.to_dict()), links=links)
