"""Answers as text for a terminal."""

from __future__ import annotations

import json
from collections.abc import Sequence

from kilter.tell.facts import facts
from kilter.tell.numbers import count, plain, shortened
from kilter.tell.shared_facts import Answer
from kilter.tell.tables import Name, Table, moving_table, sentences, tables

__all__ = [
    "LISTED",
    "aligned",
    "listed",
    "solids_hint",
    "suggestions_hint",
    "suggestions_text",
    "text_of",
]

LISTED = 20
"""Rows of a list that are shown; --json gives all."""
WIDE = 400
"""Characters of the sentence about the fastest parts."""


def text_of(answer: Answer, *more: Table, brief: bool = False) -> str:
    """An answer: its sentence, what moves, its facts, its lists, and `more` lists.

    Parameters
    ----------
    answer : mapping
    *more : Table
    brief : bool
        Without the facts that an answer rests on.

    Examples
    --------
    >>> print(text_of({"reasons": ["z is above 0"], "holds": False}))
    The proof does not hold.
    <BLANKLINE>
    because  z is above 0
    """
    moving = moving_table(answer)
    first, *rest = sentences(answer)
    blocks = [
        [first, *(plain(line, WIDE) for line in rest)],
        [] if moving is None else listed(moving),
        aligned(facts(answer, brief=brief)),
        *(listed(table) for table in (*tables(answer), *more)),
    ]
    return "\n\n".join("\n".join(lines) for lines in blocks if lines)


def listed(table: Table) -> list[str]:
    """A list: its title, the first rows, and how many more there are."""
    rows = table.rows(LISTED)
    head = [table.head] if rows and table.head else []
    more = len(table.items) - len(rows)
    return [
        table.title,
        *aligned([*head, *rows], "  "),
        *([f"  and {more} more (--json lists all)"] if more else []),
    ]


def aligned(rows: Sequence[Sequence[str]], indent: str = "") -> list[str]:
    """Rows with their columns aligned to the left.

    Examples
    --------
    >>> aligned([("a", "b"), ("long", "c")])
    ['a     b', 'long  c']
    """
    short = shortened(cell for row in rows for cell in row if isinstance(cell, Name))
    shown = [[short[cell] if isinstance(cell, Name) else cell for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    return [
        (indent + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in shown
    ]


def suggestions_hint(kinds: Sequence[str]) -> str:
    """That pairs look as if they were fastened, by their kinds; nothing where none do.

    Examples
    --------
    >>> suggestions_hint(["thread", "thread", "overlap"]).strip()
    '3 pairs look fastened (2 thread, 1 overlap): --fasten-suggested joins them, \
--suggest-joints lists them.'
    """
    if not kinds:
        return ""
    counted = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    verb, them = ("looks", "it") if len(kinds) == 1 else ("look", "them")
    return (
        f"\n\n{count(len(kinds), 'pair')} {verb} fastened ({counted}): --fasten-suggested joins "
        f"{them}, --suggest-joints lists {them}."
    )


def solids_hint(*, friction: bool) -> str:
    """What solids of CAD leave out that an unstable verdict may hang on.

    Examples
    --------
    >>> solids_hint(friction=True).strip()
    'No file of solids says what is screwed or glued: --fasten A B joins two parts that touch, \
--fasten "*" "*" all that do.'
    """
    rubs = "" if friction else " None says how parts rub: --friction 0.3 counts friction."
    return (
        "\n\nNo file of solids says what is screwed or glued: --fasten A B joins two parts that "
        f'touch, --fasten "*" "*" all that do.{rubs}'
    )


def suggestions_text(suggestions: Sequence[Answer]) -> str:
    """The list of `kilter check --suggest-joints`."""
    if not suggestions:
        return "No pair looks as if it were fastened: none overlaps, and no shaft fills a hole."
    firm = sum(_kind(one) == "fixed" for one in suggestions)
    lines = [
        f"{count(len(suggestions), 'pair')} may be fastened; nothing is joined by itself"
        + (f" (--fasten-suggested joins {firm}):" if firm else ":")
    ]
    short = shortened(name for one in suggestions[:LISTED] for name in one["parts"])
    for one in suggestions[:LISTED]:
        first, second = (short[name] for name in one["parts"])
        slides = _kind(one) not in ("fixed", None)
        firmly = "   (firmly), or as a joint of the file:" if slides else ""
        lines += [
            f"  {one['kind']}: {first} in {second}: {one['why']}",
            f"    {one['option']}{firmly}",
            *([] if one["joint"] is None else [f"    {json.dumps(one['joint'])}"]),
        ]
    more = len(suggestions) - LISTED
    return "\n".join([*lines, *([f"  and {more} more (--json lists all)"] if more > 0 else [])])


def _kind(suggestion: Answer) -> str | None:
    """The kind of joint that is suggested; None where none is."""
    joint = suggestion["joint"]
    return None if joint is None else joint["kind"]
