"""Options of a reading as the words that a user types on the command line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kilter.files.choices import LOWEST

__all__ = ["option_words"]


def option_words(options: Mapping[str, Any]) -> list[str]:
    """Words of the command line for the options of a reading; of its `entries`, the materials.

    Examples
    --------
    >>> option_words({"ground": ["base"], "floor": "lowest", "friction": 0.3})
    ['--ground', 'base', '--floor', '--friction', '0.3']
    """
    words: list[str] = []
    for key, value in options.items():
        option = f"--{key.replace('_', '-')}"
        if key == "entries":
            for entry in value.get("materials", ()):
                words += ["--material", f"{entry['parts']}={entry.get('name', entry['density'])}"]
        elif key == "saved":
            continue
        elif key == "floor":
            words += ["--floor"] if value == LOWEST else ["--floor", str(value)]
        elif key == "down":
            words += ["--down", *(repr(float(v)).removesuffix(".0") for v in value)]
        elif key == "accelerate":
            words += [option, *value]
        elif key in ("mass", "load"):
            numbers = [(name, ",".join(f"{x:.15g}" for x in each)) for name, *each in value]
            words += [word for name, text in numbers for word in (option, f"{name}={text}")]
        elif key == "fasten":
            words += [word for pair in value for word in ("--fasten", *pair)]
        elif key == "bond":
            words += [word for a, b, pull in value for word in ("--bond", a, b, f"{pull:.15g}")]
        elif value is True:
            words.append(option)
        elif isinstance(value, list | tuple):
            words += [word for entry in value for word in (option, str(entry))]
        else:
            words += [option, f"{value:.15g}" if isinstance(value, float) else str(value)]
    return words
