"""The command line: the only place that prints.

`main` turns every way a command can end into an exit code and at most one message:
see `kilter.cli.exit_codes`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from kilter.cli.exit_codes import FAULT, INTERRUPTED, USAGE, WRITTEN
from kilter.cli.interruption import end_interrupted, interruptible
from kilter.cli.mistakes import NO_MEMORY, fault_words, usage_words
from kilter.cli.streams import is_full, open_closed_streams
from kilter.threads import make_no_threads

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; the exit code is returned, and used by the console script."""
    import warnings

    words = list(sys.argv[1:] if arguments is None else arguments)
    alone = arguments is None
    try:
        if alone:  # a program of its own
            make_no_threads()
            open_closed_streams()
        with warnings.catch_warnings(), interruptible(alone=alone) as heard:
            warnings.simplefilter("ignore")
            try:
                return _run(words)
            except BrokenPipeError:
                raise
            except Exception as error:
                if heard():  # this is what was made of an interruption on its way
                    raise KeyboardInterrupt from None
                _say(fault_words(error, words))
                return FAULT
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
    except SystemExit as ended:  # what the parser of options makes of a pipe that is closed
        if isinstance(ended.__context__, BrokenPipeError):
            raise BrokenPipeError from None
        raise
    except typer.Exit as ended:
        return int(ended.exit_code)
    except (typer.Abort, EOFError):
        raise KeyboardInterrupt from None
    except InputError as error:
        _say(error.for_command)
        return USAGE
    except MemoryError:
        _say(NO_MEMORY)
        return USAGE
    except OSError as error:
        if not is_full(error):
            raise
        _say(f"the answer cannot be written: {error.strerror}; write to where there is room")
        sys.stdout = None  # what is left in it is not tried again
        return USAGE
    except Exception as error:
        if hasattr(error, "format_message"):  # a usage error of the parser of options
            _say(usage_words(error))
            return USAGE
        raise


def _say(message: str) -> None:
    from kilter.errors import visible

    with suppress(OSError):  # the code says it still
        print(f"kilter: {visible(message)}", file=sys.stderr, flush=True)
