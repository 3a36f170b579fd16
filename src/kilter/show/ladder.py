"""Data of the ladder of assumptions on a page: its rows, and the bodies of joined parts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kilter.show.packing import readable
from kilter.tell.ladder_words import condition, ladder_facts
from kilter.tell.numbers import angle, count, mass, number, shortened

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
    names = shortened(assembly.names)
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
                "words": readable(body_words(body, names, assembly.units)),
            }
            for body in check["bodies"]
        ],
    }


def _row_name(row: Answer) -> str:
    """The rung of a row, or the friction that the row assumes."""
    mu = row["friction"]
    return str(row["assume"]) if mu is None else f"friction {number(mu)}"


def body_words(body: Answer, names: Mapping[str, str], units: str) -> str:
    """A body of joined parts in words: its largest part, and its place.

    Examples
    --------
    >>> led = {"name": "LED_2", "parts": ["LED_2"], "on_floor": False, "nearest": "board"}
    >>> led |= {"distance": 0.035, "below": "board", "fall": 0.035}
    >>> body_words(led, {}, "mm")
    'LED_2, 0.035 mm above board'
    >>> body_words(led | {"below": "desk", "fall": 18.0}, {}, "mm")
    'LED_2, 0.035 mm from board; falls 18 mm onto desk'
    """

    def short(name: str) -> str:
        return names.get(name, name)

    others = len(body["parts"]) - 1
    words = short(body["name"]) + (f" and {count(others, 'other')}" if others else "")
    if body["on_floor"]:
        tips = body["tilt_deg"]
        return f"{words}, {mass(body['mass'])}" + (
            f", tips at {angle(tips)}" if tips is not None else ""
        )
    near, below = body["nearest"], body["below"]
    if below is not None and below == near:
        return f"{words}, {number(body['fall'], 3)} {units} above {short(below)}"
    places = [] if near is None else [f"{number(body['distance'], 3)} {units} from {short(near)}"]
    if below is not None:
        places.append(f"falls {number(body['fall'], 3)} {units} onto {short(below)}")
    return f"{words}, {'; '.join(places) or 'nothing is near it'}"
