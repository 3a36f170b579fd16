"""Single-line error messages about wrong usage."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from kilter.values.guesses import meant_word, remedy_of

__all__ = ["usage_words"]


def usage_words(error: Any, words: Sequence[str]) -> str:
    """Message for a usage error of the option parser, with a reference to the help.

    `words` are those of the command line, of which the first may name the command.
    """
    context = getattr(error, "ctx", None)
    path = "kilter" if words[0].startswith("-") else f"kilter {words[0]}"
    if context is not None:
        path = context.command_path
    message = " ".join(error.format_message().split()).rstrip(".")
    unknown = getattr(error, "option_name", None)
    if unknown is not None and context is not None and not hasattr(error, "param_hint"):
        known = {name for option in context.command.params for name in option.opts}
        meant = meant_word(unknown, known)
        remedy = remedy_of("--", unknown.lstrip("-").split("=")[0].lower())
        if remedy is not None:
            message = f"there is no option {unknown}: {remedy}"
        if meant is not None:
            message = f"there is no option {unknown}: use {meant}"
    message = message.replace("Value error, ", "")
    named = re.match(r"Invalid value for (.+?): Input should be a valid (\w+)", message)
    if named:
        wanted = {"number": "a number", "integer": "a whole number"}.get(named[2], f"a {named[2]}")
        message = f"the value of {named[1]} is not {wanted}"
    missing = re.match(r"Option '(.+)' requires (\S+) argument", message)
    if missing:
        message = (
            f"{missing[1]} needs {'a value' if missing[2] == 'an' else missing[2] + ' values'}"
        )
    extra = re.match(r"Got unexpected extra \S+ \((.+)\)", message)
    if extra:
        message = f"this command has no use for the words {extra[1]!r}"
    return f"{message}; see '{path} --help'"
