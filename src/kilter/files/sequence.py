"""Read an assembly sequence from text, CSV or JSON.

    text    one part name per line; empty lines and lines that begin with # are ignored
    CSV     a table with a column `part`; a cell with several parts, separated by ;, is one step
    JSON    a list of part names, or of lists of names that are one step; or the answer of
            ``kilter plan --json``

The files that ``kilter plan -o`` and ``--json`` write can be read.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.raw import read_bytes
from kilter.files.strict_json import parse_json
from kilter.tell.csv_cells import name_of_cell

__all__ = ["read_sequence"]


def read_sequence(path: Path) -> list[list[str]]:
    """Read an assembly sequence: the names of the parts that each step adds, in order.

    Raises
    ------
    InputError
        If the file cannot be read or has no valid sequence; the error names the file.
    """
    data = read_bytes(path)
    try:
        if path.suffix.lower() == ".json":
            return _json_steps(parse_json(data))
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"not UTF-8 at byte {error.start}", hint="save it as UTF-8") from None
        return _csv_steps(text) if path.suffix.lower() == ".csv" else _text_steps(text)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _text_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a text file: a part name in each line."""
    lines = [line.strip() for line in text.splitlines()]
    return [[line] for line in lines if line and not line.startswith("#")]


def _csv_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a CSV table: a step in each row."""
    rows = csv.DictReader(io.StringIO(text))
    if "part" not in (rows.fieldnames or ()):
        raise InputError("the table has no column 'part'", hint="name it in the first line")
    return [[name_of_cell(name.strip()) for name in (row["part"] or "").split(";")] for row in rows]


def _json_steps(data: Any) -> list[list[str]]:
    """Steps of an assembly sequence in JSON data: a list, or the answer of `kilter plan`."""
    steps = data
    if isinstance(data, dict):
        entries = data.get("steps")
        steps = [e.get("parts") if isinstance(e, dict) else None for e in entries or ()]
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
