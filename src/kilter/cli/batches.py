"""The command about many files: batch."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import SOME_ERRORS, WRITTEN
from kilter.cli.options import FORM, Json, Require, asks
from kilter.cli.output import as_json, emit
from kilter.tell.levels import REQUIRE, require_level

__all__ = ["batch"]

SHOWN = 20
"""Errors that are listed, those that begin alike as one."""


@asks(searches=True, answers=False)
def batch(
    asked: Asked,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="A folder for the rows, one file a chunk; what is there already is kept.",
            rich_help_panel=FORM,
            show_default=False,
        ),
    ],
    processes: Annotated[
        int | None,
        typer.Option(
            "--processes",
            metavar="N",
            help="Processes of this machine; one a core where not given.",
            show_default=False,
        ),
    ] = None,
    chunk: Annotated[int, typer.Option("--chunk", metavar="N", help="Rows of one file.")] = 1000,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster",
            metavar="ADDRESS",
            help="A scheduler of Dask whose workers judge, in place of processes of this machine.",
            show_default=False,
        ),
    ] = None,
    require: Require = REQUIRE,
    json: Json = False,
) -> int:
    """Verdicts of many assemblies, written to a folder as tables, resumable.

    FILE is a folder of assemblies, or a text file with a path a line. The tables are Parquet with
    kilter[batch], else CSV. Run again, it goes on with what is not there yet; an
    assembly that cannot be judged is a row with its error. The column 'stable' says whether it
    holds at the level of --require.

    Exit 0 all rows are written, whatever the verdicts; 1 some are errors.
    """
    from kilter.analysis.many.batch import run_batch
    from kilter.analysis.many.batch_rows import BatchQuestion

    question = BatchQuestion(
        asked.reading, asked.tolerance, require_level(require), asked.effort, asked.time_limit
    )
    quiet = asked.quiet or not sys.stderr.isatty()
    found = run_batch(
        asked.file,
        output,
        question,
        processes=processes,
        chunk=chunk,
        cluster=cluster,
        progress=None if quiet else _Rate(),
    )
    if json:
        emit(as_json(found.to_dict()), None)
    else:
        counts = ", ".join(f"{count:,} {word}" for word, count in found.counts.most_common())
        there = f", {found.found_there:,} of them were there" if found.found_there else ""
        head = f"{found.rows:,} rows in {len(found.files)} files{there}: {counts}"
        emit("\n".join([head, *_errors(found.errors, found.counts["error"])]), None)
    return SOME_ERRORS if found.counts["error"] else WRITTEN


def _errors(errors: Sequence[tuple[str, str]], count: int) -> list[str]:
    """Lines about errors, one for all that begin alike, the most frequent first.

    Examples
    --------
    >>> few = [("a", "not JSON: line 1"), ("b", "no such file"), ("c", "not JSON: line 7")]
    >>> print(*_errors(few, 3), sep="\\n")
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
    left = count - sum(map(len, groups))
    return [*lines, f"{left:,} more errors are in the tables"] if left else lines


class _Rate:
    """How many rows are written, how many a second, and how long the rest takes."""

    def __init__(self) -> None:
        self._started = self._told = time.perf_counter()
        self._first: int | None = None

    def __call__(self, done: int, of: int) -> None:
        now = time.perf_counter()
        self._first = done if self._first is None else self._first
        if now - self._told < 1.0 and done < of:
            return
        self._told = now
        rate = (done - self._first) / max(now - self._started, 1e-9)
        left = f", {_time((of - done) / rate)} left" if rate > 0 else ""
        line = f"\r\x1b[Kkilter: {done:,} of {of:,} rows, {rate:,.0f} a second{left}"
        print(line, end="\n" if done == of else "", file=sys.stderr, flush=True)


def _time(seconds: float) -> str:
    """A time in words.

    Examples
    --------
    >>> _time(42.3), _time(130), _time(7300)
    ('42 s', '2 min 10 s', '2 h 1 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
