"""Declarations of options: a field of a record has its names on the command line, and its help.

    gap: float | None = option("--gap LENGTH", "Largest gap between touching faces.", TOUCH)

The type of the field is that of the value; a tuple of any length is an option that repeats.
"""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field
from typing import Any

REQUIRED = MISSING
"""Default of an option, or of an argument, that must be given."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """An option, or an argument (without names), of a command."""

    names: tuple[str, ...]
    """Names of the option on the command line, the long one last."""
    metavar: str
    """Its values in the help text, such as "X Y Z". An option with several names ends with
    "..."."""
    help: str
    """Its sentence in the help text of the command."""
    panel: str = "Options"
    """Heading of its group in the help text."""
    reads: str = ""
    """Name of the function of `kilter.cli.quantities` that converts a word to a value, in place
    of the type; empty for the type."""


def option(
    spec: str, help: str, panel: str = "Options", *, default: Any = None, reads: str = ""
) -> Any:
    """A field that is an option: its names and values such as "-o --output FILE", and its help.

    An option without values is a flag, which is False by default.
    """
    words = spec.split()
    names = tuple(
        word for word in words if word.startswith("--") or (len(word) == 2 and word[0] == "-")
    )
    metavar = " ".join(words[len(names) :])
    declaration = Declaration(names, metavar, help, panel, reads)
    given = default if metavar or default is not None else False
    return field(default=given, metadata={"option": declaration})


def argument(metavar: str, help: str, *, default: Any = REQUIRED) -> Any:
    """A field that is an argument: a word that follows no option."""
    declaration = Declaration((), metavar, help, "Arguments")
    return field(default=default, metadata={"option": declaration})
