"""Answers as text for a terminal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

from kilter.errors import visible
from kilter.tell.check_facts import Answer
from kilter.tell.facts import facts
from kilter.tell.numbers import Name, count, plain, shortened
from kilter.tell.tables import Table, moving_table, sentences, tables

LISTED = 20
"""Largest number of rows of a list in a terminal; --json gives all rows."""
WIDE = 400
"""Largest number of characters of each sentence after the first."""
COLUMN = 50
"""Largest number of characters of a cell that widens its column."""


def text_of(answer: Answer, *more: Table, brief: bool = False) -> str:
    """Return an answer as plain text: sentence, moving parts, facts and tables.

    Examples
    --------
    >>> print(text_of({"reasons": ["z is above 0"], "holds": False}))
    The proof does not hold.
    <BLANKLINE>
    because  z is above 0
    """
    moving = moving_table(answer, brief=brief)
    first, *rest = sentences(answer)
    blocks = [
        [first, *(plain(line, WIDE) for line in rest)],
        [] if moving is None else listed(replace(moving, complete=True)),
        aligned(facts(answer, brief=brief)),
        *(listed(table) for table in (*tables(answer), *more)),
    ]
    return "\n\n".join("\n".join(lines) for lines in blocks if lines)


def listed(table: Table) -> list[str]:
    """Return a table as lines: title, first rows, and the number of rows left out."""
    rows = table.rows(LISTED)
    head = [table.head] if rows and table.head else []
    more = len(table.items) - len(rows)
    return [
        table.title,
        *aligned([*head, *rows], "  "),
        *([f"  and {more} more (--json lists all)"] if more else []),
    ]


def aligned(rows: Sequence[Sequence[str]], indent: str = "") -> list[str]:
    """Return table rows as lines in which the columns are aligned, but for very long cells.

    Examples
    --------
    >>> aligned([("a", "b"), ("long", "c")])
    ['a     b', 'long  c']
    """
    short = shortened(cell for row in rows for cell in row if isinstance(cell, Name))
    shown = [[short.get(cell) or visible(cell) for cell in row] for row in rows]
    columns = zip(*shown, strict=True)
    widths = [max((w for w in map(len, column) if w <= COLUMN), default=0) for column in columns]
    return [
        (indent + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in shown
    ]


def suggestions_text(suggestions: Sequence[Answer]) -> str:
    """Return the text of `kilter check --suggest-joints`: the pairs that look fastened."""
    if not suggestions:
        return "No pair looks fastened: no parts overlap, and no shaft fills a hole."
    firm = sum(_joint_kind(entry) == "fixed" for entry in suggestions)
    lines = [
        f"{count(len(suggestions), 'pair')} may be fastened; none is joined automatically"
        + (f" (--fasten-suggested joins {firm}):" if firm else ":")
    ]
    short = shortened(name for entry in suggestions[:LISTED] for name in entry["parts"])
    for entry in suggestions[:LISTED]:
        first, second = (short[name] for name in entry["parts"])
        slides = _joint_kind(entry) not in ("fixed", None)
        rigidly = "   (rigidly), or add this joint to the file:" if slides else ""
        lines += [
            f"  {entry['kind']}: {first} in {second}: {entry['why']}",
            f"    {entry['option']}{rigidly}",
            *([] if entry["joint"] is None else [f"    {json.dumps(entry['joint'])}"]),
        ]
    more = len(suggestions) - LISTED
    return "\n".join([*lines, *([f"  and {more} more (--json lists all)"] if more > 0 else [])])


def _joint_kind(suggestion: Answer) -> str | None:
    """Return the kind of joint that a suggestion proposes; None if it proposes no joint."""
    joint = suggestion["joint"]
    return None if joint is None else joint["kind"]


# The answer of `kilter doctor` as text, for a terminal and for a bug report.


def health_text(answer: Answer) -> str:
    """Return the text of `kilter doctor`: a sentence, then each item with its state and its remedy.

    Examples
    --------
    >>> broken = {"name": "HiGHS", "state": "broken", "found": "no answer", "remedy": "try again"}
    >>> print(health_text({"works": False, "looks": [broken]}))
    kilter does not work here: HiGHS.
    <BLANKLINE>
    HiGHS  broken  no answer; try again
    """
    broken = [look["name"] for look in answer["looks"] if look["state"] == "broken"]
    head = "kilter works here."
    if broken:
        head = f"kilter does not work here: {', '.join(broken)}."
    rows = [
        (look["name"], look["state"], "; ".join(filter(None, (look["found"], look["remedy"]))))
        for look in answer["looks"]
    ]
    return "\n".join([head, "", *aligned(rows)])
