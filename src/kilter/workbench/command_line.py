"""The command line that reproduces what the workbench shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import shell_words
from kilter.files.choices import Choices
from kilter.files.option_words import option_words

__all__ = ["command", "needs_file", "saved_name"]

TOLERANCE = {"gap": "--gap", "angle_deg": "--angle", "clearance": "--clearance"}
"""Option of each key of the tolerance."""


def needs_file(keys: Mapping[str, Any]) -> bool:
    """Whether choices contain a key without an option, so that a command needs them as a file.

    Examples
    --------
    >>> needs_file({"kilter": 1, "file": "a.step", "friction": 0.3})
    False
    >>> needs_file({"kilter": 1, "file": "a.step", "loads": [{"part": "a", "force": [0, 0, 1]}]})
    True
    """
    entries = Choices.from_dict(dict(keys)).options()["entries"]
    return bool(entries)


def command(
    name: str, keys: Mapping[str, Any], saved: str | None = None, further: Sequence[str] = ()
) -> str:
    """The command that answers a question about the present choices.

    Parameters
    ----------
    name : str
        Name of the command, such as "check".
    keys : mapping
        JSON data of the choices.
    saved : str, optional
        File that holds these choices. It is named if an option cannot express a choice; without it,
        the command begins with the name under which the choices would be saved.
    further : sequence of str
        Further words.

    Examples
    --------
    >>> command("check", {"kilter": 1, "file": "a.step", "held": ["base"], "friction": 0.3})
    'kilter check a.step --ground base --friction 0.3'
    """
    choices = Choices.from_dict(dict(keys))
    options = choices.options()
    if options["entries"]:
        return shell_words(["kilter", name, saved or saved_name(choices.file), *further])
    words = option_words({key: value for key, value in options.items() if key != "entries"})
    for key, value in (choices.tolerance or {}).items():
        if value is not None:
            words += [TOLERANCE[key], f"{value:.15g}"]
    if choices.loose:
        words.append("--loose")
    return shell_words(["kilter", name, choices.file, *words, *further])


def saved_name(file: str) -> str:
    """Name of the file of choices beside an assembly file.

    Examples
    --------
    >>> saved_name("clamp.step"), saved_name("wall.kilter.json")
    ('clamp.kilter.json', 'wall.choices.kilter.json')
    """
    name = file.rsplit("/", 1)[-1]
    if name.endswith(".kilter.json"):
        return f"{name.removesuffix('.kilter.json')}.choices.kilter.json"
    stem = name.rsplit(".", 1)[0] or name
    return f"{stem}.kilter.json"
