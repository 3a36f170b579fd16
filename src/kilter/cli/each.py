"""The command `check` for several files: a line for each file, and the worst exit code."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import FAULT, HOLDS, LOWER, USAGE, VERDICT
from kilter.cli.output import as_json, emit, tell_warnings, tell_written
from kilter.errors import NO_MEMORY, InputError, fault_words, message_line

__all__ = ["check_each", "code_of"]

Answer = Mapping[str, Any]
WORST = (FAULT, USAGE, VERDICT["unstable"], VERDICT["undecided"], LOWER, HOLDS)
"""Exit codes, the worst first."""
WIDE = 100
"""Largest number of characters about the motion of a file."""


def code_of(answer: Answer) -> int:
    """Exit code of an answer of `check`: a verdict, or data with a verdict."""
    if answer["level"] is None:
        return VERDICT[answer["verdict"]]
    return HOLDS if answer["stable"] else LOWER


def check_each(asked: Asked, files: Sequence[str], judge: Callable[[Asked], Answer]) -> int:
    """Print the verdict or the error of each file; return the worst exit code.

    Returns the worst exit code.
    """
    from kilter.tell.numbers import plain
    from kilter.tell.text import aligned

    answers, rows, codes = [], [], set()
    # every name is validated before the first file is checked
    for file, request in [(file, asked.of_file(file)) for file in files]:
        answer, code = _answer(request, judge)
        answers.append({"file": file, **answer})
        codes.add(code)
        moves = plain(answer["summary"], WIDE) if answer.get("verdict") == "unstable" else ""
        rows.append((file, answer.get("verdict", "error"), moves))
    text = as_json(answers) if asked.writes_json else "\n".join(aligned(rows))
    emit(text, asked.output)
    tell_written(asked.output, f"answers of check about {len(files)} files", asked.quiet)
    return next(code for code in WORST if code in codes)


def _answer(asked: Asked, judge: Callable[[Asked], Answer]) -> tuple[Answer, int]:
    """Check a file and return its answer and exit code; an error becomes the answer."""
    try:
        answer = judge(asked)
    except InputError as error:
        why, code = error.for_command, USAGE
    except BrokenPipeError:
        raise
    except MemoryError:
        why, code = NO_MEMORY, USAGE
    except Exception as error:
        why, code = fault_words(error, ["check", asked.file]), FAULT
    else:
        warnings = [f"{asked.file}: {warning}" for warning in answer["warnings"]]
        tell_warnings(warnings, asked.quiet or asked.json)
        return answer, code_of(answer)
    print(f"kilter: {message_line(why)}", file=sys.stderr)
    return {"error": why}, code
