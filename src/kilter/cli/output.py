"""Print answers to standard output or a file, print warnings, and show progress."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kilter.cli.interruption import begin_facts, remember_fact, remember_step
from kilter.errors import InputError, message_line, short_name, visible
from kilter.tell.palette import VERDICT_ROLE

# Colour of the verdict on a terminal, equal to its colour on pages and figures.


TERMINAL = {"stable": "1;34", "unstable": "1;33"}
"""Terminal codes of the roles of verdicts: blue, and yellow as the nearest colour to orange."""


def coloured() -> bool:
    """Whether standard output is a terminal that shows colours."""
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return True
    return sys.stdout.isatty() and os.environ.get("TERM") != "dumb"


def in_colour(text: str, answer: Mapping[str, Any]) -> str:
    """A text with its first line in the colour of its verdict, if the terminal shows colours."""
    code = TERMINAL.get(VERDICT_ROLE.get(str(answer.get("verdict")), ""))
    if code is None or not coloured():
        return text
    first, *rest = text.split("\n", 1)
    return "\n".join([f"\x1b[{code}m{first}\x1b[0m", *rest])


GROWING = 1.5
"""Factor between the times of two progress lines that are not on a terminal [-]."""
EACH = 1.0
"""Time between two updates of the progress line [s]."""

PAGE, PICTURE, FILM, MODEL = (
    "'kilter report FILE -o x.html' writes a page",
    "'kilter draw FILE -o x.png' writes a picture",
    "'kilter draw FILE -o x.glb' writes a film",
    "'kilter settle FILE' writes parts at rest, and 'kilter scene' objects",
)
OTHER_FILES = {
    **dict.fromkeys((".html", ".htm", ".doc", ".docx", ".odt"), PAGE),
    **dict.fromkeys((".svg", ".png", ".pdf", ".jpg", ".jpeg"), PICTURE),
    **dict.fromkeys((".glb", ".gif", ".mp4"), FILM),
    **dict.fromkeys(
        (".usd", ".usda", ".usdc", ".xml", ".npy", ".urdf", ".step", ".stp", ".stl"), MODEL
    ),
}
"""Endings of files that hold no text of an answer, with the command that writes such a file."""


def as_json(data: Any) -> str:
    """Data as JSON text with exact numbers; characters that do not print are escaped."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    if all(line.isprintable() for line in text.split("\n")):
        return text
    return "".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text)


def emit(text: str, output: Path | None, answer: Mapping[str, Any] | None = None) -> None:
    """Print a text, or write it to a file; characters that do not print are escaped.

    Arguments: `output`: None: standard output.
    """
    text = visible(text, keep="\n")
    if output is not None:
        write_whole(output, text)
        return
    if answer is not None:
        text = in_colour(text, answer)
    sys.stdout.write(text if text.endswith("\n") else text + "\n")


def writes_json(json: bool, output: Path | None) -> bool:
    """Whether an answer is JSON: by option, or because its file ends like JSON."""
    return json or (output is not None and output.suffix.lower() == ".json")


def tell_written(output: Path | None, content: str, quiet: bool) -> None:
    """Report the path and content of a written file on the error stream, unless `quiet`."""
    if output is not None and not quiet:
        print(f"{visible(str(output))}: {content}", file=sys.stderr)


def keep_apart(file: str, *outputs: Path | None) -> None:
    """Raise an error if an output file would overwrite the input file or another output.

    Raises `InputError` if an output is the file that is read or an earlier output.
    """
    seen = [os.path.realpath(file)] if file != "-" else []
    for output in outputs:
        if output is None:
            continue
        place = os.path.realpath(output)
        if place in seen:
            raise InputError("would be overwritten", file=str(output), hint="write to another file")
        seen.append(place)


def require_answer_file(output: Path | None, writes: Sequence[str] = ()) -> None:
    """Raise an error if the file of an answer has the ending of a page, a picture or a film.

    Raises `InputError` if the command would write text into such a file.
    """
    ending = "" if output is None else output.suffix.lower()
    if ending in OTHER_FILES and ending not in writes:
        raise InputError(
            "the answer is text or JSON, which does not belong into such a file",
            file=str(output),
            hint=f"use -o x.txt or -o x.json; {OTHER_FILES[ending]}",
        )


def write_whole(path: Path, text: str) -> None:
    """Write text to a file completely, or leave the file as it was.

    Raises `InputError` if the file cannot be written.
    """
    from kilter.files import write_text

    write_text(path, text)


def tell_warnings(warnings: Sequence[str], quiet: bool, limit: int = 20) -> None:
    """Print the first `limit` warnings on the error stream, unless `quiet`."""
    if quiet:
        return
    for warning in warnings[:limit]:
        print(f"kilter: warning: {message_line(warning)}", file=sys.stderr)
    if len(warnings) > limit:
        print(f"kilter: {len(warnings) - limit} more warnings (--json lists all)", file=sys.stderr)


class Progress:
    """Progress line on the error stream with the current step and the elapsed time.

    The line appears after a second, and not if `quiet`. If the error stream is no terminal, lines
    follow each other in growing intervals, and only for commands that may take minutes (`lines`).
    """

    keeps = True
    """An answer that the user interrupts keeps what is known (`LimitSteps`)."""

    def __init__(self, quiet: bool, *, lines: bool = False) -> None:
        begin_facts()
        self._terminal = sys.stderr.isatty()
        self._on = not quiet and (self._terminal or lines)
        self._started = time.perf_counter()
        self._step = ""
        self._ended = threading.Event()
        self._clock: threading.Thread | None = None

    def __call__(self, stage: str) -> None:
        """Begin a step, whose name the progress line shows from now on."""
        self._step = stage
        remember_step(stage)
        if self._on and self._clock is None:
            self._clock = threading.Thread(target=self._tell, daemon=True)
            self._clock.start()

    def fact(self, subject: str, words: str) -> None:
        """Keep a fact that is known before the answer is complete, in case of an interruption."""
        remember_fact(subject, words)

    def _tell(self) -> None:
        shown, next_line = False, 0.0
        while not self._ended.wait(EACH):
            elapsed, shown = time.perf_counter() - self._started, self._terminal
            line = f"kilter: {short_name(self._step)} ... ({elapsed:.0f} s so far)"
            if self._terminal:
                print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)
            elif elapsed >= next_line:
                print(line, file=sys.stderr, flush=True)
                next_line = GROWING * elapsed
        if shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.done()

    def done(self) -> None:
        """Remove the progress line until the next step."""
        if self._clock is not None:
            self._ended.set()
            self._clock.join()
            self._ended, self._clock = threading.Event(), None
