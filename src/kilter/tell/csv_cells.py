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
from kilter.tell.check_facts import Answer
from kilter.tell.numbers import angle, number, plain, vector
from kilter.tell.tables import Table

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


# Table of the places of rest: direction of gravity, supporting parts, state, limits of tilt.


REST_SIGNS = {
    "minimum": "strict minimum",
    "free": "slides or rolls freely",
    "balanced": "only balances",
    "open": "open",
}
"""Words of the states of rest, the safest first."""
HEAD = ("gravity", "lies on", "rest", "tilt", "energy to tip", "righting moment", "swing")
"""Column heads; the swing is a period [s], or a rate [1/s] if the period is not known."""


def rest_table(region: Answer) -> Table:
    """Return the table of resting positions in a region, the strict minima of energy first.

    Examples
    --------
    >>> corner = {"down": [0, 0, -1], "on": ["floor"], "state": "minimum", "tilt_deg": 35.3,
    ...           "rate": None, "well": None}
    >>> rest_table({"rests": [corner]}).rows(1)
    [['(0, 0, -1)', 'floor', 'strict minimum', '35.3 deg', '', '', '']]
    """
    order = {state: k for k, state in enumerate(REST_SIGNS)}
    rests = sorted(region["rests"], key=lambda rest: order[rest["state"]])
    return Table("", HEAD, rests, _row)


def _row(rest: Answer) -> Sequence[str]:
    """Return the cells of a resting position, in the order of `HEAD`."""
    well = rest["well"] or {}
    tilt = rest["tilt_deg"] if rest["state"] == "minimum" else None
    tilt = well.get("over_deg", tilt) if well else tilt
    period = well.get("period")
    return [
        vector(rest["down"], 3),
        ", ".join(plain(name) for name in rest["on"]),
        REST_SIGNS[rest["state"]],
        angle(tilt) if tilt else "",
        _measure(well.get("barrier"), "J"),
        _measure(well.get("stiffness"), "N m/rad"),
        _measure(period, "s") if period else _measure(rest["rate"], "1/s"),
    ]


def _measure(value: float | None, unit: str) -> str:
    return "" if value is None else f"{number(value, 4)} {unit}"
