"""The finished rows of a run over states, kept in a file until the run is complete.

The file lies beside the output. Its first line identifies the run; each further line is a row. A
line that a killed run has not completed is left out.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from kilter.analysis.many.batch_folder import lock_file
from kilter.errors import InputError

ENDING = ".rows"
"""Ending of the file, after the name of the output."""


class StateJournal:
    """Rows by the index of their state; with a file, each new row is written at once."""

    def __init__(self, path: Path | None = None, stream: BinaryIO | None = None) -> None:
        self.rows: dict[int, dict[str, Any]] = {}
        self._path, self._stream = path, stream

    def add(self, row: dict[str, Any]) -> None:
        """Add the row of a state."""
        self.rows[row["index"]] = row
        if self._stream is not None:
            self._stream.write(json.dumps(row).encode() + b"\n")
            self._stream.flush()

    def remove(self) -> None:
        """Remove the file of a complete run."""
        if self._path is not None:
            self._path.unlink(missing_ok=True)


@contextlib.contextmanager
def open_journal(output: str | Path | None, identity: str) -> Iterator[StateJournal]:
    """Open the journal of a run, with the rows of an interrupted run; without an output no file.

    Raises `InputError` if the file cannot be written, has rows of another run, or another run is
    writing to it.
    """
    if output is None:
        yield StateJournal()
        return
    path = Path(output).with_name(Path(output).name + ENDING)
    try:
        stream = path.open("a+b")
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be written: {getattr(error, 'strerror', None) or error}",
            file=str(path),
            hint="check the folder and its permissions",
        ) from None
    with stream:
        try:
            lock_file(stream.fileno())
        except OSError:
            raise InputError(
                "another run is writing to this file", file=str(path), hint="wait for its end"
            ) from None
        journal = StateJournal(path, stream)
        head = json.dumps({"kilter_states": 1, "run": identity}).encode()
        stream.seek(0)
        whole, _, _ = stream.read().rpartition(b"\n")
        if whole:
            journal.rows = _known_rows(whole.split(b"\n"), head, path)
            stream.truncate(len(whole) + 1)
        else:
            stream.truncate(0)
            stream.write(head + b"\n")
        yield journal


def _known_rows(lines: list[bytes], head: bytes, path: Path) -> dict[int, dict[str, Any]]:
    """The rows of an interrupted run by index.

    Raises `InputError` if they belong to another run.
    """
    try:
        rows = [json.loads(line) for line in lines[1:]]
        if lines[0] == head:
            return {row["index"]: row for row in rows}
    except (ValueError, TypeError, KeyError):
        pass
    raise InputError(
        "holds rows of another run", file=str(path), hint="remove it, or give another output"
    )
