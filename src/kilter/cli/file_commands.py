"""The command `batch`: verdicts of many files."""

from __future__ import annotations

import json as json_form
import re
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import DOCTOR, SOME_ERRORS, WRITTEN
from kilter.cli.options import FORM, TOUCH, Json, Output, Require, asks, takes
from kilter.cli.output import Progress, as_json, emit, tell_warnings, writes_json
from kilter.errors import InputError, shell_words
from kilter.tell.levels import require_level
from kilter.tell.numbers import count
from kilter.values.declaration import REQUIRED, argument, option

if TYPE_CHECKING:
    from kilter.files.own.choices import Choices


SHOWN = 20
"""Largest number of listed errors; errors with the same beginning count as a single error."""


@dataclass(frozen=True, kw_only=True)
class BatchOptions:
    """Options of `batch`."""

    output: Path = option(
        "-o --output DIR",
        "Folder of the tables. Existing rows of the same batch are kept.",
        FORM,
        default=REQUIRED,
    )
    processes: int | None = option(
        "--processes N", "Number of processes on this machine; the number of cores by default."
    )
    chunk: int = option("--chunk N", "Number of rows in each table file.", default=1000)
    cluster: str | None = option(
        "--cluster ADDRESS",
        "Dask scheduler whose workers compute the verdicts, instead of processes on this machine.",
    )
    require: str = Require()
    json: bool = Json()


@asks(searches=True, answers=False)
def batch(asked: Asked, options: BatchOptions) -> int:
    """Check many assemblies and write their verdicts to a folder of tables.

    FILE is a folder of assemblies, or a text file with a path in each line. The tables are Parquet
    files with kilter[batch], otherwise CSV files.

    A second run computes only the missing rows. An assembly that cannot be checked gets a row with
    its error. The column 'stable' states whether it holds at the level of --require.

    Exit code: 0 all rows are written, whatever the verdicts; 1 some rows are errors.
    """
    from kilter.analysis.many.batch import run_batch
    from kilter.analysis.many.batch_rows import BatchQuestion

    level = require_level(options.require)
    question = BatchQuestion(
        asked.reading,
        asked.tolerance,
        level,
        asked.effort or 0.0,
        asked.time_limit,
    )
    quiet = asked.quiet or not sys.stderr.isatty()
    result = run_batch(
        asked.file,
        options.output,
        question,
        processes=options.processes,
        chunk=options.chunk,
        cluster=options.cluster,
        progress=None if quiet else RateLine(),
    )
    errors = result.counts.get("error", 0)
    if options.json:
        emit(as_json(result.to_dict()), None)
    else:
        counts = ", ".join(f"{number:,} {word}" for word, number in result.counts.items())
        before = ""
        if result.found_there:
            before = f" ({result.found_there:,} of them from an earlier run)"
        rows, files = count(result.rows, "row", grouped=True), count(len(result.files), "file")
        first = [(entry.file, entry.error) for entry in result.errors]
        head = f"{options.output}: {rows} in {files}{before}: {counts}"
        emit("\n".join([head, *_error_lines(first, errors)]), None)
    return SOME_ERRORS if errors else WRITTEN


def _error_lines(errors: Sequence[tuple[str, str]], total: int) -> list[str]:
    """Lines that count errors with the same beginning, the most frequent first.

    Parameters
    ----------
    errors : sequence of tuple
        File and error of the first errors.
    total : int
        Number of all errors.

    Examples
    --------
    >>> few = [("a", "not JSON: line 1"), ("b", "no such file"), ("c", "not JSON: line 7")]
    >>> print(*_error_lines(few, 3), sep="\\n")
    error  a and 1 more: not JSON: line 1
    error  b: no such file
    """
    alike: dict[str, list[tuple[str, str]]] = {}
    for file, error in errors:
        alike.setdefault(re.split("[:;]", error)[0], []).append((file, error))
    groups = sorted(alike.values(), key=len, reverse=True)[:SHOWN]
    lines = []
    for (file, error), *others in groups:
        more = f" and {len(others):,} more" if others else ""
        lines.append(f"error  {file}{more}: {error}")
    left = total - sum(map(len, groups))
    return [*lines, f"{left:,} more errors are in the tables"] if left else lines


class RateLine:
    """Progress line of a batch: rows written, rate and time left, at most once a second."""

    def __init__(self, things: str = "rows") -> None:
        self._things = things
        self._started = self._printed = time.perf_counter()
        self._first: int | None = None

    def __call__(self, done: int, total: int) -> None:
        """Print the line for the number of finished things and the number of all."""
        now = time.perf_counter()
        self._first = done if self._first is None else self._first
        if now - self._printed < 1.0 and done < total:
            return
        self._printed = now
        rate = (done - self._first) / max(now - self._started, 1e-9)
        left = f", {_duration((total - done) / rate)} left" if rate > 0 else ""
        line = f"\r\x1b[Kkilter: {done:,} of {total:,} {self._things}, {rate:,.3g}/s{left}"
        print(line, end="\n" if done == total else "", file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    """Describe a duration [s] in words.

    Examples
    --------
    >>> _duration(42.3), _duration(130), _duration(7300)
    ('42 s', '2 min 10 s', '2 h 1 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


# The command `doctor`: test of the installation.


@dataclass(frozen=True, kw_only=True)
class DoctorOptions:
    """Options of `doctor`."""

    json: bool = Json()
    output: Path | None = Output()


@takes
def doctor(options: DoctorOptions) -> int:
    """Test whether this installation works: versions, solvers, extras, STEP, page, terminal.

    Each part computes something with a known result. The test uses no network. Copy its text into
    a bug report.

    Exit code: 0 all installed parts work, 1 a part is broken. A missing extra is not broken.
    """
    from kilter.health import doctor as look
    from kilter.tell.text import health_text

    answer = look().to_dict()
    emit(
        as_json(answer) if writes_json(options.json, options.output) else health_text(answer),
        options.output,
    )
    return DOCTOR[answer["works"]]


# The command `save`: write the options for an input file to a file of choices.


@dataclass(frozen=True, kw_only=True)
class SaveOptions:
    """Options of `save`."""

    output: Path | None = option(
        "-o --output X.kilter.json", "File to write, in the folder of FILE or above it.", FORM
    )
    open_pairs: list[tuple[str, str, str]] | None = option(
        "--open NAME NAME joined|touching|apart",
        "Decide how two parts touch whose contact the geometry leaves uncertain. Repeatable.",
        TOUCH,
    )
    json: bool = Json()


@asks(answers=False)
def save(asked: Asked, options: SaveOptions) -> int:
    """Save the options for an input file, so that later commands do not need them again.

    Every command and kilter.load read X.kilter.json as FILE with the saved options. Options on the
    command line win over saved options, and the answer names what they replace.

    If FILE has choices itself, the new choices are its choices with the given changes.

    These keys have no option and are edited in X.kilter.json: gravity, friction_pairs, joints,
    bonds with more than a pull, loads, poses.
    """
    from kilter.files.own.choices_writing import require_place
    from kilter.loading import save_reading

    if options.output is None:
        raise InputError("the name of the output file is missing", hint="add -o X.kilter.json")
    if asked.file == "-":
        raise InputError(
            "options for standard input cannot be saved", hint="give a file or a folder"
        )
    for name in ("mass", "load", "accelerate"):
        if getattr(asked.typed, name):
            raise InputError(
                f"--{name} is not saved: it is part of a question",
                hint=f"give --{name} to the command that asks; --material and the key 'loads' of "
                "the file of choices are saved",
            )
    replaces = require_place(options.output)
    decisions = [_decision(words) for words in options.open_pairs or ()]
    given = {**asked.typed.entries, **({"open_pairs": decisions} if decisions else {})}
    asked = replace(asked, typed=replace(asked.typed, entries=given)).of_file(asked.file)
    with Progress(asked.quiet) as progress:
        choices = save_reading(
            asked.source or Path(asked.file),
            options.output,
            asked.reading,
            asked.all_touch.saved(),
            progress=progress,
        )
    tell_warnings(asked.notes, asked.quiet)
    if options.json:
        emit(as_json(choices.to_dict()), None)
    else:
        emit(_words(choices, options.output, replaces), None)
    return WRITTEN


def _decision(words: tuple[str, str, str]) -> dict[str, Any]:
    """Convert a value of ``--open`` into the entry of an open pair in a file of choices."""
    first, second, state = words
    if state not in ("joined", "touching", "apart"):
        raise InputError(f"--open has {state!r:.60}", hint="give joined, touching or apart")
    return {"parts": [first, second], "as": state}


def _words(choices: Choices, output: Path, replaces: bool) -> str:
    """Text about the written choices for users: their keys, and the next command."""
    from kilter.tell.text import aligned

    rows = [
        [
            "  " + key,
            value if isinstance(value, str) else json_form.dumps(value, ensure_ascii=False),
        ]
        for key, value in choices.to_dict().items()
        if key not in ("kilter", "file", "sha256")
    ]
    how = "earlier choices replaced by choices" if replaces else "choices"
    lines = [f"{output}: {how} about {choices.file}", *aligned(rows)]
    return "\n".join([*lines, f"next: {shell_words(['kilter', 'check', str(output)])}"])


# The command `mcp`: a server of tools for agents.


@dataclass(frozen=True, kw_only=True)
class McpOptions:
    """Options of `mcp`."""

    folder: Path = argument(
        "[FOLDER]",
        "Start folder: only files below it are opened. By default the present folder.",
        default=Path(),
    )


@takes
def mcp(options: McpOptions) -> int:
    """Serve the questions of kilter as tools for agents, on standard input and output.

    The server speaks the Model Context Protocol (extra 'mcp'). Its tools are check, contacts,
    margin, hold, plan, settle, place, transport, scene, draw and example. Each answer has at most
    4 kB and names the resource that has the whole answer.

    Exit code: 0 when standard input ends.
    """
    from kilter.agents.tool_calls import serve

    serve(options.folder)
    return WRITTEN
