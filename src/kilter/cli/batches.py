"""The command `batch`: verdicts of many files."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import SOME_ERRORS, WRITTEN
from kilter.cli.options import FORM, Json, Require, asks
from kilter.cli.output import as_json, emit
from kilter.tell.levels import require_level
from kilter.tell.numbers import count
from kilter.values.declaration import REQUIRED, option

__all__ = ["batch"]

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
        progress=None if quiet else _RateLine(),
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


class _RateLine:
    """Progress line of a batch: rows written, rate and time left, at most once a second."""

    def __init__(self) -> None:
        self._started = self._printed = time.perf_counter()
        self._first: int | None = None

    def __call__(self, done: int, total: int) -> None:
        now = time.perf_counter()
        self._first = done if self._first is None else self._first
        if now - self._printed < 1.0 and done < total:
            return
        self._printed = now
        rate = (done - self._first) / max(now - self._started, 1e-9)
        left = f", {_duration((total - done) / rate)} left" if rate > 0 else ""
        line = f"\r\x1b[Kkilter: {done:,} of {total:,} rows, {rate:,.0f} rows/s{left}"
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
