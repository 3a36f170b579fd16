"""Where answers go: standard output, or a file that is whole or not there; and progress."""

from __future__ import annotations

import json
import re
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kilter.errors import InputError, visible

__all__ = ["Progress", "as_json", "emit", "keep_apart", "tell_warnings", "write_whole"]

EACH = 1.0
"""Between two words of progress [s]."""


OBEYED = re.compile(
    r"(?!\x1b\[[\d;]*m)[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]"
)
"""What moves a cursor or turns a line, in names of files and parts; colours are our own."""


def as_json(data: Any) -> str:
    """JSON text with numbers exact to the last digit; what a terminal would obey is escaped."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return OBEYED.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def emit(text: str, output: Path | None) -> None:
    """Print an answer, or write it to a file."""
    text = OBEYED.sub(lambda found: visible(found[0]), text)
    if output is None:
        sys.stdout.write(text if text.endswith("\n") else text + "\n")
    else:
        write_whole(output, text)


def keep_apart(file: str, *outputs: Path | None) -> None:
    """Refuse to write over the file that is read, or two answers to one file.

    Raises
    ------
    InputError
        Naming the file.
    """
    seen = [Path(file).resolve()] if file != "-" else []
    for output in outputs:
        if output is None:
            continue
        if output.resolve() in seen:
            raise InputError(
                "would be written over", file=str(output), hint="write to another file"
            )
        seen.append(output.resolve())


def write_whole(path: Path, text: str) -> None:
    """Write a file in full or not at all.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    from kilter.files import write_text

    write_text(path, text)


def tell_warnings(warnings: Sequence[str], quiet: bool, limit: int = 20) -> None:
    """Warnings on the error stream."""
    if quiet:
        return
    for warning in warnings[:limit]:
        print(f"kilter: warning: {visible(warning)}", file=sys.stderr)
    if len(warnings) > limit:
        print(f"kilter: {len(warnings) - limit} more warnings (--json lists all)", file=sys.stderr)


class Progress:
    """Names the step at work on the error stream, and how long all took, second by second.

    From the first second on, only on a terminal, and not where `quiet`.
    """

    def __init__(self, quiet: bool) -> None:
        self._on = not quiet and sys.stderr.isatty()
        self._started = time.perf_counter()
        self._step = ""
        self._ended = threading.Event()
        self._clock: threading.Thread | None = None

    def __call__(self, stage: str) -> None:
        """Begin a step."""
        self._step = stage
        if self._on and self._clock is None:
            self._clock = threading.Thread(target=self._tell, daemon=True)
            self._clock.start()

    def _tell(self) -> None:
        shown = False
        while not self._ended.wait(EACH):
            elapsed, shown = time.perf_counter() - self._started, True
            line = f"kilter: {self._step} ... ({elapsed:.0f} s so far)"
            print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)
        if shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.done()

    def done(self) -> None:
        """Nothing is at work."""
        if self._clock is not None:
            self._ended.set()
            self._clock.join()
            self._ended, self._clock = threading.Event(), None
