"""What went wrong, in one line: wrong usage, and faults of kilter itself."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

__all__ = ["NO_MEMORY", "fault_words", "usage_words"]

NO_MEMORY = "there is not enough memory for this; leave parts out, or make it coarser"


def usage_words(error: Any) -> str:
    """What the parser of options has to say, in one line."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "kilter"
    message = " ".join(error.format_message().split()).rstrip(".")
    message = message.replace("Value error, ", "")
    named = re.match(r"Invalid value for (.+?): Input should be a valid (\w+)", message)
    if named:
        wanted = {"number": "a number", "integer": "a whole number"}.get(named[2], f"a {named[2]}")
        message = f"what is given with {named[1]} is not {wanted}"
    return f"{message}; see '{path} --help'"


def fault_words(error: Exception, words: Sequence[str]) -> str:
    """What went wrong inside, where, and how to report it; one line."""
    import traceback

    import kilter

    last = traceback.extract_tb(error.__traceback__)[-1]
    module = last.filename.replace("\\", "/").rsplit("/kilter/", 1)[-1]
    detail = " ".join(str(error).split())[:200]
    return (
        f"a fault of kilter itself: {type(error).__name__}: {detail} "
        f"(kilter {kilter.__version__}, {module}:{last.lineno}); please report it with the "
        f"command 'kilter {' '.join(words)}', the file and what 'kilter doctor' prints"
    )
