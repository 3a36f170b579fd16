"""Data of the ladder of assumptions on a page: its rows, and the bodies of joined parts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kilter.show.packing import readable
from kilter.tell.body_words import body_words
from kilter.tell.ladder_words import condition, ladder_facts
from kilter.tell.numbers import number

if TYPE_CHECKING:
    from kilter.assembly import Assembly

Answer = Mapping[str, Any]
NOT_DECIDED = "not decided yet"
"""Words of a row that would have taken too long."""


def build_ladder(check: Answer, assembly: Assembly) -> dict[str, Any]:
    """JSON data of the rung of an answer, the rows of its ladder, and its bodies.

    `parts` of a body are indices, and `loose` states that it touches neither a floor nor a held
    part.
    """
    return {
        "assume": check["assume"],
        "rows": [
            {
                "assume": row["assume"],
                "friction": row["friction"],
                "name": _row_name(row),
                "condition": condition(row),
                "holds": row["level"] is not None,
                "words": readable(words) if row["decided"] else NOT_DECIDED,
            }
            for row, (_, words) in zip(check["ladder"], ladder_facts(check), strict=True)
        ],
        "bodies": [
            {
                "parts": [assembly.index[name] for name in body["parts"]],
                "loose": not body["on_floor"],
                "words": readable(body_words(body, assembly.units)),
            }
            for body in check["bodies"]
        ],
    }


def _row_name(row: Answer) -> str:
    """The rung of a row, or the friction that the row assumes."""
    mu = row["friction"]
    return str(row["assume"]) if mu is None else f"friction {number(mu)}"
