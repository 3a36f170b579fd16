"""Single-line error messages about wrong usage."""

from __future__ import annotations

import re
from typing import Any

from kilter.values.guesses import meant_word, remedy_of

__all__ = ["usage_words"]


def usage_words(error: Any) -> str:
    """Message for a usage error of the option parser, with a reference to the help."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "kilter"
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
    return f"{message}; see '{path} --help'"
