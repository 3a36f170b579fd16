"""Cells of CSV tables that no spreadsheet program runs as a formula.

Spreadsheet programs run a cell that begins with ``=``, ``+``, ``-`` or ``@``, so such a text gets
an apostrophe in front. Numbers, and lists of numbers, stay as they are.

References
----------
RFC 4180. OWASP, CSV Injection.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence
from typing import Any

from kilter.errors import visible

RUNS = re.compile(r"'*[=+\-@\t\r\n]")
"""Beginning of a cell that a spreadsheet program may run, with the apostrophes in front of it."""
NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)(e[-+]?\d+)?", re.IGNORECASE | re.ASCII)


def safe_cell(value: Any) -> Any:
    """The value of a cell: a text gets visible characters, and an apostrophe before a formula.

    Names in a list are separated by ";", and each is such a text.

    Examples
    --------
    >>> safe_cell("=SUM(A1)"), safe_cell("bolt"), safe_cell("-1.5e-3"), safe_cell(-2.0)
    ("'=SUM(A1)", 'bolt', '-1.5e-3', -2.0)
    >>> safe_cell("@a\\tb"), safe_cell("'=1"), safe_cell("-1 0 2;0 0 0")
    ("'@a\\\\tb", "''=1", '-1 0 2;0 0 0')
    >>> safe_cell(["=a", "b"])
    "'=a;b"
    """
    if isinstance(value, list | tuple):
        return ";".join(map(safe_cell, value))
    if not isinstance(value, str) or is_numeric(value):
        return value
    return visible(f"'{value}" if RUNS.match(value) else value)


def is_numeric(text: str) -> bool:
    """Whether a text is a number, or several with a space or ";" between them."""
    return all(map(NUMBER.fullmatch, text.replace(";", " ").split(" ")))


def name_of_cell(text: str) -> str:
    """The name that `safe_cell` wrote, except for replaced characters.

    Examples
    --------
    >>> [name_of_cell(safe_cell(name)) for name in ("=a", "'=a", "'a", "-5", "@")]
    ['=a', "'=a", "'a", '-5', '@']
    """
    return text[1:] if text.startswith("'") and RUNS.match(text) else text


def csv_text(rows: Iterable[Sequence[Any]]) -> str:
    """Rows as CSV text; the cells are those of `safe_cell`.

    Examples
    --------
    >>> print(csv_text([["part", "mu"], ["=1, 2", 0.5]]), end="")
    part,mu
    "'=1, 2",0.5
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(safe_cell, row) for row in rows)
    return text.getvalue()
