"""An order of assembly from a file: a name a line, a table, or JSON.

    text    one name a line; empty lines and what begins with # do not count
    CSV     a head with a column `part`; several parts in one cell, joined by ;, move as one
    JSON    a list of names, or of lists of names that move as one; or the answer of
            ``kilter plan --json``

What ``kilter plan -o`` and ``--json`` write is read back.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.raw import read_bytes
from kilter.files.strict_json import parse_json

__all__ = ["read_sequence"]


def read_sequence(path: Path) -> list[list[str]]:
    """The names of each step, in order.

    Raises
    ------
    InputError
        If the file cannot be read or is none of these; it names the file.
    """
    data = read_bytes(path)
    try:
        if path.suffix.lower() == ".json":
            return _of_json(parse_json(data))
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"not UTF-8 at byte {error.start}", hint="save it as UTF-8") from None
        return _of_table(text) if path.suffix.lower() == ".csv" else _of_lines(text)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _of_lines(text: str) -> list[list[str]]:
    lines = [line.strip() for line in text.splitlines()]
    return [[line] for line in lines if line and not line.startswith("#")]


def _of_table(text: str) -> list[list[str]]:
    rows = csv.DictReader(io.StringIO(text))
    if "part" not in (rows.fieldnames or ()):
        raise InputError("the table has no column 'part'", hint="name it in the first line")
    return [[name.strip() for name in (row["part"] or "").split(";")] for row in rows]


def _of_json(data: Any) -> list[list[str]]:
    steps = data
    if isinstance(data, dict):
        found = data.get("steps")
        steps = [one.get("parts") if isinstance(one, dict) else None for one in found or ()]
    if not isinstance(steps, list) or not steps:
        raise InputError("no sequence is in it", hint="give a list of names, or 'plan --json'")
    order = [[one] if isinstance(one, str) else one for one in steps]
    for one in order:
        if not isinstance(one, list) or not all(isinstance(name, str) for name in one):
            raise InputError(f"a step is {one!r:.40}", hint="give names, or lists of names")
    return order
