"""Answer a question about a file again whenever the file is saved."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from kilter.cli.exit_codes import USAGE
from kilter.errors import InputError, visible
from kilter.files.limits import fingerprint

INTERVAL = 0.3
"""Interval at which the file is looked at [s]."""

Answer = Mapping[str, Any]


def watch_file(file: str, answer: Callable[[str], tuple[int, Answer]]) -> int:
    """Print the answer about a file now, and again after each change, until an interruption.

    Arguments: `answer`: function that prints an answer and returns the exit code and the answer.
    Returns the exit code of the last answer. Raises `InputError` if there is no file to watch.
    """
    if file == "-" or file.startswith("scene:") or not os.path.exists(file):
        raise InputError(f"--watch needs a file that exists, not {file!r:.80}")
    code, before, stamp = USAGE, None, None
    with suppress(KeyboardInterrupt):
        while True:
            stamp = _next_stamp(file, stamp)
            try:
                code, present = answer(file)
            except InputError as error:
                code = USAGE
                words = f"kilter: {visible(str(error))}; waiting for the next change"
                print(words, file=sys.stderr, flush=True)
                continue
            if before is not None:
                print(change_words(before, present), flush=True)
            before = present
            print(f"kilter: watching {visible(file)}; Ctrl-C ends it", file=sys.stderr, flush=True)
    return code


def _next_stamp(file: str, stamp: Any) -> Any:
    """Wait until a file has changed and its writer has finished; return its fingerprint."""
    now = fingerprint(file)
    if stamp is None:
        return now
    while now == stamp:
        now = _after(file)
    while (later := _after(file)) != now:
        now = later
    return now


def _after(file: str) -> Any:
    """The fingerprint of a file after an interval."""
    time.sleep(INTERVAL)
    return fingerprint(file)


def change_words(before: Answer, now: Answer) -> str:
    """The difference of two answers of `check` in a line.

    Examples
    --------
    >>> parts = [{"name": "a", "moves": True}]
    >>> first = {"verdict": "unstable", "parts": parts}
    >>> change_words(first, {"verdict": "stable", "parts": [{"name": "a", "moves": False}]})
    'was: unstable (a moves); now: stable'
    """
    words = [_short(answer) for answer in (before, now)]
    if words[0] == words[1]:
        return f"unchanged: {words[1]}"
    return f"was: {words[0]}; now: {words[1]}"


def _short(answer: Answer) -> str:
    """The verdict of an answer with the names of the first moving parts."""
    moving = [part["name"] for part in answer["parts"] if part["moves"]]
    if not moving:
        return str(answer["verdict"])
    more = f" and {len(moving) - NAMED} more" if len(moving) > NAMED else ""
    verb = "moves" if len(moving) == 1 else "move"
    return f"{answer['verdict']} ({', '.join(moving[:NAMED])}{more} {verb})"


NAMED = 3
"""Largest number of moving parts that a line names."""
