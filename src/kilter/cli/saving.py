"""The command `save`: write the options for an input file to a file of choices."""

from __future__ import annotations

import json as json_form
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import FORM, TOUCH, Json, asks
from kilter.cli.output import Progress, as_json, emit, tell_warnings
from kilter.errors import InputError, shell_words
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.files.choices import Choices

__all__ = ["save"]


@dataclass(frozen=True, kw_only=True)
class SaveOptions:
    """Options of `save`."""

    output: Path | None = option(
        "-o --output X.kilter.json", "File to write, in the folder of FILE or above it.", FORM
    )
    open_pairs: list[tuple[str, str, str]] | None = option(
        "--open NAME NAME joined|touching|apart",
        "Decide how two parts touch whose contact the geometry leaves uncertain. Repeatable.",
        TOUCH,
    )
    json: bool = Json()


@asks(answers=False)
def save(asked: Asked, options: SaveOptions) -> int:
    """Save the options for an input file, so that later commands do not need them again.

    Every command and kilter.load read X.kilter.json as FILE with the saved options. Options on the
    command line win over saved options, and the answer names what they replace.

    If FILE has choices itself, the new choices are its choices with the given changes.

    These keys have no option and are edited in X.kilter.json: gravity, friction_pairs, joints,
    bonds with more than a pull, loads, poses.
    """
    from kilter.files.choices_writing import require_place
    from kilter.loading import save_reading

    if options.output is None:
        raise InputError("the name of the output file is missing", hint="add -o X.kilter.json")
    if asked.file == "-":
        raise InputError(
            "options for standard input cannot be saved", hint="give a file or a folder"
        )
    for name in ("mass", "load", "accelerate"):
        if getattr(asked.typed, name):
            raise InputError(
                f"--{name} is not saved: it is part of a question",
                hint=f"give --{name} to the command that asks; --material and the key 'loads' of "
                "the file of choices are saved",
            )
    replaces = require_place(options.output)
    decisions = [_decision(words) for words in options.open_pairs or ()]
    given = {**asked.typed.entries, **({"open_pairs": decisions} if decisions else {})}
    asked = replace(asked, typed=replace(asked.typed, entries=given)).of_file(asked.file)
    with Progress(asked.quiet) as progress:
        choices = save_reading(
            asked.source or Path(asked.file),
            options.output,
            asked.reading,
            asked.all_touch.saved(),
            progress=progress,
        )
    tell_warnings(asked.notes, asked.quiet)
    if options.json:
        emit(as_json(choices.to_dict()), None)
    else:
        emit(_words(choices, options.output, replaces), None)
    return WRITTEN


def _decision(words: tuple[str, str, str]) -> dict[str, Any]:
    """Convert a value of ``--open`` into the entry of an open pair in a file of choices."""
    first, second, state = words
    if state not in ("joined", "touching", "apart"):
        raise InputError(f"--open has {state!r:.60}", hint="give joined, touching or apart")
    return {"parts": [first, second], "as": state}


def _words(choices: Choices, output: Path, replaces: bool) -> str:
    """Text about the written choices for users: their keys, and the next command."""
    from kilter.tell.text import aligned

    rows = [
        [
            "  " + key,
            value if isinstance(value, str) else json_form.dumps(value, ensure_ascii=False),
        ]
        for key, value in choices.to_dict().items()
        if key not in ("kilter", "file", "sha256")
    ]
    how = "earlier choices replaced by choices" if replaces else "choices"
    lines = [f"{output}: {how} about {choices.file}", *aligned(rows)]
    return "\n".join([*lines, f"next: {shell_words(['kilter', 'check', str(output)])}"])
