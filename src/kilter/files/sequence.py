"""Read an assembly sequence from text, CSV or JSON.

    text    one part name per line; empty lines and lines that begin with # are ignored
    CSV     a table with a column `part`; a cell with several parts, separated by ;, is one step
    JSON    a list of part names, or of lists of names that are one step; or the answer of
            ``kilter plan --json``

The files that ``kilter plan -o`` and ``--json`` write can be read.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.limits import MOST_TABLE_BYTES
from kilter.files.raw import read_bytes
from kilter.files.reader_guard import reader_guard
from kilter.files.strict_json import parse_json
from kilter.files.table_rows import decoded_table, table_rows
from kilter.tell.csv_cells import name_of_cell

__all__ = ["read_sequence"]


def read_sequence(path: Path) -> list[list[str]]:
    """Read an assembly sequence: the names of the parts that each step adds, in order.

    Raises `InputError` if the file cannot be read or has no valid sequence; the error names the
    file.
    """
    data = read_bytes(path, most=MOST_TABLE_BYTES)
    with reader_guard(path):
        if path.suffix.lower() == ".json":
            return _json_steps(parse_json(data))
        text = decoded_table(data)
        return _csv_steps(text) if path.suffix.lower() == ".csv" else _text_steps(text)


def _text_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a text file: a part name in each line."""
    lines = [line.strip() for line in text.splitlines()]
    return [[line] for line in lines if line and not line.startswith("#")]


def _csv_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a CSV table: a step in each row."""
    rows = table_rows(text)
    _, header = next(rows, (0, []))
    if "part" not in header:
        raise InputError("the table has no column 'part'", hint="name it in the first line")
    column = header.index("part")
    cells = [row[column] if column < len(row) else "" for _, row in rows]
    return [[name_of_cell(name.strip()) for name in cell.split(";")] for cell in cells]


def _json_steps(data: Any) -> list[list[str]]:
    """Steps of an assembly sequence in JSON data: a list, or the answer of `kilter plan`."""
    steps = data
    if isinstance(data, dict):
        steps = data.get("steps")
        if isinstance(steps, list):
            steps = [entry.get("parts") if isinstance(entry, dict) else None for entry in steps]
    if not isinstance(steps, list) or not steps:
        raise InputError(
            "the file has no sequence",
            hint="give a list of names, or the output of 'kilter plan --json'",
        )
    order = [[step] if isinstance(step, str) else step for step in steps]
    for step in order:
        if not isinstance(step, list) or not all(isinstance(name, str) for name in step):
            raise InputError(f"a step is {step!r:.40}", hint="give names, or lists of names")
    return order
