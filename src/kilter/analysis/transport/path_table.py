"""Tables of samples along a path: comma-separated values with a header."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, nearest_name

__all__ = ["columns_of", "read_table"]

T = TypeVar("T")


def read_table(
    file: str | Path, known: Sequence[str], build: Callable[[Mapping[str, Array]], T]
) -> T:
    """Read a table of samples over time, and build a value from its columns.

    Parameters
    ----------
    file : str or Path
    known : sequence of str
        Permitted names of columns; "time" is required.
    build : callable
        From the columns, arrays of shape (n,) by name, to the value.

    Raises
    ------
    InputError
        If a column is unknown, "time" is missing, or a row is not a row of numbers; the message
        names the file and the line. Errors of `build` get the file, too.
    """
    path = Path(file)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise InputError(f"the path cannot be read: {reason}", file=str(path)) from None
    try:
        return build(_table(text, known))
    except InputError as error:
        raise error.located(file=str(path)) from None


def columns_of(table: Mapping[str, Array], names: Sequence[str]) -> Array | None:
    """Columns of a table with the given names, shape (n, k); None if the table has none of them."""
    there = [name in table for name in names]
    if not any(there):
        return None
    if not all(there):
        missing = ", ".join(
            name for name, is_there in zip(names, there, strict=True) if not is_there
        )
        raise InputError(
            f"the path has no column {missing}", hint=f"give all of {', '.join(names)}"
        )
    return np.column_stack([table[name] for name in names])


def _table(text: str, known: Sequence[str]) -> dict[str, Array]:
    """Columns of a comma-separated table, by name."""
    rows = [row for row in csv.reader(io.StringIO(text)) if row]
    if not rows:
        raise InputError("the path is empty", hint="give a header and a row for each sample")
    header = [name.strip() for name in rows[0]]
    for name in header:
        if name not in known:
            near = nearest_name(name, known)
            raise InputError(
                f"the path has an unknown column {name!r:.40}",
                hint=f"did you mean {near}?" if near else f"use {', '.join(known)}",
            )
    if "time" not in header:
        raise InputError("the path has no column 'time'", hint="add the time of each sample [s]")
    numbers = []
    for line, row in enumerate(rows[1:], start=2):
        try:
            values = [float(cell) for cell in row]
        except ValueError:
            raise InputError(
                f"line {line} of the path is not a row of numbers: {','.join(row):.60}",
                hint="give a number in every column",
            ) from None
        if len(values) != len(header) or not np.isfinite(values).all():
            raise InputError(
                f"line {line} of the path has {len(values)} finite numbers for {len(header)} "
                "columns",
                hint="give a finite number in every column",
            )
        numbers.append(values)
    table = np.array(numbers).reshape(-1, len(header))
    return {name: table[:, k] for k, name in enumerate(header)}
