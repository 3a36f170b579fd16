"""`kilter settle --states`: many states of a scene brought to rest."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.exit_codes import SOME_ERRORS, WRITTEN
from kilter.cli.output import as_json, emit, tell_written
from kilter.errors import InputError
from kilter.tell.levels import require_level
from kilter.tell.numbers import count, number

if TYPE_CHECKING:
    from kilter.cli.asked import Asked

SHOWN = 60
"""Largest number of states in the table of a terminal."""
HEAD = ("state", "result", "at rest", "farthest", "time", "notes")


def settle_many(
    asked: Asked,
    states: Path,
    options: Mapping[str, Any],
    *,
    processes: int,
    json: bool,
    output: Path | None,
) -> int:
    """Settle the states of a file, and print a row for each; return the exit code.

    Arguments: `options`: keywords of `kilter.settle` from the command line.
    """
    from kilter.analysis.many.settle_states import run_states
    from kilter.cli.file_commands import RateLine
    from kilter.contact import Tolerance

    _require_suitable(asked, output)
    quiet = asked.quiet or not sys.stderr.isatty()
    answer = run_states(
        asked.source or Path(asked.file),
        states,
        asked.reading,
        {
            **options,
            "require": require_level(options["require"], strict=True),
            "effort": asked.effort or 0.0,
            "time_limit": asked.limit,
        },
        tolerance=None if asked.tolerance == Tolerance() else asked.tolerance,
        output=output,
        processes=processes,
        progress=None if quiet else RateLine("states"),
    )
    data = answer.to_dict()
    emit(as_json(data) if json else states_text(data), None)
    tell_written(output, "states at rest", asked.quiet)
    return SOME_ERRORS if answer.counts.get("error") else WRITTEN


def _require_suitable(asked: Asked, output: Path | None) -> None:
    """Raise an error for options that belong to a single state."""
    if asked.proof is not None:
        raise InputError(
            "--proof is that of one state", hint="give --state FILE:ROW in place of --states"
        )
    if asked.file == "-":
        raise InputError("states belong to an MJCF file", hint="give its path")
    if output is not None and output.suffix.lower() != ".npy":
        raise InputError(
            "many states are written to a NumPy file", file=str(output), hint="give X.npy"
        )


def states_text(data: Mapping[str, Any]) -> str:
    """The answer as text: a sentence, and a table with a row for each state."""
    rows = data["states"]
    lines = [data["sentence"]]
    if data["found_there"]:
        lines.append(f"{count(data['found_there'], 'state')} from an earlier run.")
    cells = [HEAD, *(_cells(row) for row in rows[:SHOWN])]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines.append("")
    for row in cells:
        padded = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join(padded).rstrip())
    if len(rows) > SHOWN:
        lines.append(f"{len(rows) - SHOWN} more states (--json lists all)")
    return "\n".join(lines)


def _cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    """The cells of the row of a state."""
    far = "" if row["farthest"] is None else f"{row['farthest']} {number(row['moved'], 3)} m"
    leaves = f"leaves: {', '.join(row['leaves'])}" if row["leaves"] else ""
    notes = "; ".join(filter(None, [leaves, row["why"]]))
    rests = f"{row['rests']} of {row['free']}"
    return str(row["index"]), row["state"], rests, far, f"{row['seconds']:.2f} s", notes
