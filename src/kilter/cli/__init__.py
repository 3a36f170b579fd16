"""The command line of kilter, the only package that prints.

`main` converts every end of a command into an exit code and at most one message: see
`kilter.cli.exit_codes`.
"""

from __future__ import annotations

import errno
import gc
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from kilter.cli.exit_codes import FAULT, INTERRUPTED, USAGE, WRITTEN
from kilter.cli.interruption import (
    begin_facts,
    end_interrupted,
    interruptible,
    interruption_words,
    is_full,
    open_closed_streams,
)
from kilter.errors import (
    NO_MEMORY,
    InputError,
    fault_words,
    message_line,
    nearest_name,
    shell_words,
)
from kilter.threads import make_no_threads

__all__ = ["main"]

HELP: tuple[list[str], ...] = ([], ["--help"], ["-h"])
"""Command lines that print the overview of the commands."""
READ_APART = {
    **dict.fromkeys(("step", "stp", "igs", "iges", "fcstd"), "step"),
    **dict.fromkeys(("xml", "mjcf"), "mjcf"),
    **dict.fromkeys(("usd", "usda", "usdc", "usdz"), "usd"),
}
"""Endings of the files whose libraries run in a separate process, and the kind of each."""
NEW_OBJECTS = 200_000
"""New objects after which garbage is collected. The imports of a command make about 60,000, and a
collection of so many takes 40 ms; more objects need more memory."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a kilter command, given as words, and return its exit code."""
    import warnings

    words = list(sys.argv[1:] if arguments is None else arguments)
    alone = arguments is None
    begin_facts()
    try:
        if alone:
            # the command owns this process, so it may change threads, collections and streams
            make_no_threads()
            gc.set_threshold(NEW_OBJECTS)
            # plug-ins of pydantic are searched for in the metadata of every installed package
            os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
            open_closed_streams()
        with warnings.catch_warnings(), interruptible(alone=alone) as heard:
            warnings.simplefilter("ignore")
            try:
                return _run(words)
            except BrokenPipeError:
                raise
            except Exception as error:
                if heard():
                    # an extension module converted the interruption into this error
                    raise KeyboardInterrupt from None
                _print_error(fault_words(error, words))
                return FAULT
    except KeyboardInterrupt:
        if alone:
            end_interrupted()
        _print_error(interruption_words())
        return INTERRUPTED
    except BrokenPipeError:
        # the reader closed the pipe, for instance `head`: the rest of the answer is not needed
        sys.stdout = None
        return WRITTEN
    finally:
        if alone:
            # the last collections of the interpreter would traverse all modules, which takes a
            # quarter of the time of a small command; the end of the process frees their memory
            gc.freeze()


def _read_ahead(words: list[str]) -> None:
    """Start reading the first file of a command that needs a process of its own.

    Kilter is still being loaded meanwhile.
    """
    from kilter.files.cad import step_process
    from kilter.files.robots import scene_process

    for word in words:
        path, ending = Path(word), word.lower().rpartition(".")[2]
        if ending not in READ_APART or not path.is_file():
            continue
        if READ_APART[ending] == "step":
            every = not any(word.startswith("--without") for word in words)
            step_process.begin_early(path if every else None)
        elif ending != "xml" or scene_process.is_mjcf(path):
            # the state of `why` depends on its options, so only the process starts early
            scene_process.begin_early(READ_APART[ending], None if words[0] == "why" else path)
        return


def _run(words: list[str]) -> int:
    """Run a command given as words; return its exit code, or that of wrong usage."""
    if words in HELP:
        from kilter.cli.overview import overview

        print(overview())
        return WRITTEN
    with suppress(OSError):
        _read_ahead(words)
    try:
        result = _result(words)
        sys.stdout.flush()
        if result == INTERRUPTED:  # the command has printed what it found until then
            raise KeyboardInterrupt
        return result
    except EOFError:
        raise KeyboardInterrupt from None
    except InputError as error:
        _print_error(error.for_command)
        return USAGE
    except MemoryError:
        _print_error(NO_MEMORY)
        return USAGE
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            _print_error("the name of a file is too long for this system; give a shorter name")
            return USAGE
        if not is_full(error):
            raise
        _print_error(f"the answer cannot be written: {error.strerror}; write to another place")
        sys.stdout = None  # the interpreter would try to write the rest again at its end
        return USAGE


def _result(words: list[str]) -> int:
    """Call the command that the words name, or print a help text; return the exit code."""
    from kilter.cli.commands import COMMANDS, functions_of
    from kilter.cli.option_parser import COMPLETION, completion, help_text, values_of

    name, *rest = words
    if name in COMMANDS:
        typed = rest[: rest.index("--")] if "--" in rest else rest
        if {"-h", "--help"} & set(typed):
            print(help_text(name))
            return WRITTEN
        [function] = functions_of(name)
        return function(**values_of(function, rest))
    if name in ("-V", "--version"):
        import kilter

        print(f"kilter {kilter.__version__}")
        return WRITTEN
    option, equals, shell = name.partition("=")
    if option == COMPLETION:
        print(completion(shell if equals else " ".join(rest)))
        return WRITTEN
    raise _no_command(name, rest)


def _no_command(name: str, rest: list[str]) -> InputError:
    """The error for a first word that is no command."""
    from kilter.cli.commands import COMMANDS
    from kilter.cli.option_parser import is_file

    kind, near = "command", nearest_name(name, COMMANDS)
    hint = f"did you mean {near!r}?" if near else "see 'kilter --help'"
    if name.startswith("-"):
        kind = "option"
        typed = next((word for word in rest if word in COMMANDS), None)
        hint = hint if typed is None else f"options follow the command: kilter {typed} FILE {name}"
    elif near is None and is_file(name):
        hint = f"type 'kilter check {shell_words((name,))}' for its verdict"
    return InputError(f"there is no {kind} {name!r:.60}", hint=hint)


def _print_error(message: str) -> None:
    """Print an error message as a single line on the error stream."""
    with suppress(OSError):  # without an error stream the exit code remains
        print(f"kilter: {message_line(message)}", file=sys.stderr, flush=True)
