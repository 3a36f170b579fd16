"""The command line: the only place that prints.

`main` turns every way a command can end into an exit code and at most one message:
see `kilter.cli.exit_codes`.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from kilter.cli.exit_codes import FAULT, INTERRUPTED, USAGE, WRITTEN
from kilter.cli.interruption import end_interrupted, interruptible
from kilter.threads import make_no_threads

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; the exit code is returned, and used by the console script."""
    import warnings

    if arguments is None:  # a program of its own
        make_no_threads()
    words = list(sys.argv[1:] if arguments is None else arguments)
    alone = arguments is None
    try:
        with warnings.catch_warnings(), interruptible(alone=alone):
            warnings.simplefilter("ignore")
            try:
                return _run(words)
            except KeyboardInterrupt:
                if alone:
                    end_interrupted()
                _say("interrupted")
                return INTERRUPTED
    except BrokenPipeError:
        # the reader of a pipe has seen enough; nothing is left to tell it
        sys.stdout = None
        return WRITTEN


def _read_ahead(words: list[str]) -> None:
    """Have the first STEP file of a command read while the rest of kilter is loaded."""
    from kilter.files.step_process import begin_early

    named = [word for word in words if word.lower().endswith((".step", ".stp"))]
    if named and Path(named[0]).is_file():
        every = not any(word.startswith("--without") for word in words)
        begin_early(Path(named[0]) if every else None)


def _run(words: list[str]) -> int:
    with suppress(OSError):
        _read_ahead(words)
    import typer

    from kilter.cli.app import command
    from kilter.cli.arguments import with_floor_value, with_two_names
    from kilter.errors import InputError

    try:
        given = with_two_names(with_floor_value(words))
        result = command()(given, prog_name="kilter", standalone_mode=False)
        sys.stdout.flush()
        if result == INTERRUPTED:  # the parser of options turns an interruption into its code
            raise KeyboardInterrupt
        return int(result or 0)
    except typer.Exit as ended:
        return int(ended.exit_code)
    except (typer.Abort, EOFError):
        raise KeyboardInterrupt from None
    except InputError as error:
        _say(error.for_command)
        return USAGE
    except (KeyboardInterrupt, BrokenPipeError):
        raise
    except Exception as error:
        if hasattr(error, "format_message"):  # a usage error of the parser of options
            _say(_usage(error))
            return USAGE
        _say(_fault(error, words))
        return FAULT


def _usage(error: Any) -> str:
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


def _say(message: str) -> None:
    print(f"kilter: {message}", file=sys.stderr)


def _fault(error: Exception, words: list[str]) -> str:
    """What went wrong inside, where, and how to report it; one line."""
    import traceback

    import kilter

    last = traceback.extract_tb(error.__traceback__)[-1]
    module = last.filename.replace("\\", "/").rsplit("/kilter/", 1)[-1]
    detail = " ".join(str(error).split())[:200]
    return (
        f"a fault of kilter itself: {type(error).__name__}: {detail} "
        f"(kilter {kilter.__version__}, {module}:{last.lineno}); please report it with the "
        f"command 'kilter {' '.join(words)}' and the file"
    )
