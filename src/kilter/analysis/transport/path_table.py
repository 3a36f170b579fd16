"""Tables of samples along a path: comma-separated values with a header."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, nearest_name
from kilter.files.limits import MOST_TABLE_BYTES, read_bytes
from kilter.files.packing.packing_lists import decoded_table, table_rows
from kilter.files.reader_guard import reader_guard

T = TypeVar("T")


def read_table(
    file: str | Path, known: Sequence[str], build: Callable[[Mapping[str, Array]], T]
) -> T:
    """Read a table of samples over time, and build a value from its columns.

    Raises `InputError` if a column is unknown, "time" is missing, or a row is not a row of numbers;
    the message names the file and the line. Errors of `build` get the file, too.
    """
    path = Path(file)
    data = read_bytes(path, most=MOST_TABLE_BYTES)
    with reader_guard(path):
        return build(_table(decoded_table(data), known))


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
    rows = table_rows(text)
    _, first = next(rows, (0, []))
    if not first:
        raise InputError("the path is empty", hint="give a header and a row for each sample")
    header = [name.strip() for name in first]
    for k, name in enumerate(header):
        if name in header[:k]:
            raise InputError(f"the path has two columns {name!r:.40}", hint="remove one of them")
        if name not in known:
            near = nearest_name(name, known)
            raise InputError(
                f"the path has an unknown column {name!r:.40}",
                hint=f"did you mean {near}?" if near else f"use {', '.join(known)}",
            )
    if "time" not in header:
        raise InputError("the path has no column 'time'", hint="add the time of each sample [s]")
    numbers = []
    for line, row in rows:
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
    if not numbers:
        raise InputError("the path has no samples", hint="give a row for each sample")
    table = np.array(numbers).reshape(-1, len(header))
    return {name: table[:, k] for k, name in enumerate(header)}
