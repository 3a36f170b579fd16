"""Bodies of parts that touch or overlap, in words: their support, their nearest parts, falls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some
from kilter.tell.contact_words import range_words
from kilter.tell.name_groups import FEW, grouped, pattern, stem
from kilter.tell.numbers import count, number, plain

SAME_WAY = 1e-3
"""A fall differs from the distance of the nearest part by at most this, if it is below [-]."""

Entry = Mapping[str, Any]


def body_sentences(bodies: Sequence[Entry], units: str) -> list[str]:
    """Return sentences about the bodies of an answer: those that stand, and the loose bodies.

    Without a floor and without held parts, all bodies but the heaviest are loose.

    Examples
    --------
    >>> board = {"name": "board", "parts": ["board", "chip"], "on_floor": True, "tilt_deg": 40.0}
    >>> leds = [{"name": f"LED_{k}", "parts": [f"LED_{k}"], "on_floor": False, "nearest": "board",
    ...          "distance": 0.035, "below": "board", "fall": 0.035} for k in range(14)]
    >>> print(*body_sentences([board, *leds], "mm"), sep="\\n")
    Bodies of parts that touch or overlap: 15. On a floor or held: board (2 parts, tips at 40 deg).
    14 loose bodies: LED_* (14 bodies, 0.035 mm above board).
    """
    if not bodies:
        return []
    standing = [body for body in bodies if body["on_floor"]]
    loose = [body for body in bodies if not body["on_floor"]][0 if standing else 1 :]
    words = some([_standing_words(body) for body in standing or bodies[:1]], FEW)
    which = "On a floor or held" if standing else "The heaviest"
    lines = [f"Bodies of parts that touch or overlap: {len(bodies)}. {which}: {words}."]
    if loose:
        groups = grouped(loose, lambda body: (stem(body["name"]), stem(body["nearest"] or "")))
        shown = [_loose_words(group, units) for group in groups[:FEW]]
        more = len(loose) - sum(map(len, groups[:FEW]))
        number_of = "1 loose body" if len(loose) == 1 else f"{len(loose)} loose bodies"
        lines.append(f"{number_of}: {some(shown, len(shown), len(shown) + more)}.")
    return lines


def joined_words(bodies: Sequence[Entry], units: str, *, holds: bool | None) -> tuple[str, str]:
    """Return words about the bodies that stand, and a sentence about the loose bodies.

    Arguments: `holds`: whether the joined parts hold; None if this is not decided.

    Examples
    --------
    >>> board = {"name": "board", "parts": ["board", "chip"], "on_floor": True, "tilt_deg": 40.0}
    >>> led = {"name": "LED", "parts": ["LED"], "on_floor": False, "nearest": "board",
    ...        "distance": 0.035, "below": "board", "fall": 0.035}
    >>> joined_words([board, led], "mm", holds=True)
    ('one body of 2 parts, which tips at 40 deg', '1 loose body falls 0.035 mm and rests')
    >>> joined_words([board, led, led], "mm", holds=None)[1]
    '2 loose bodies are 0.035 mm above board'
    >>> joined_words([board, {**led, "nearest": "wall"}], "mm", holds=False)[1]
    'LED falls 0.035 mm onto board'
    """
    standing = [body for body in bodies if body["on_floor"]]
    loose = [body for body in bodies if not body["on_floor"]]
    if not standing:
        return "", ""
    parts = len(standing[0]["parts"])
    first = f"one body of {parts} parts" if parts > 1 else plain(standing[0]["name"])
    words = first if len(standing) == 1 else f"{len(standing)} bodies on the floor"
    tilt = standing[0]["tilt_deg"]
    if tilt is not None:
        tips = f"tips at {number(tilt, 3)} deg" if tilt else "does not stand as drawn"
        words += f", which {tips}{_rest_words(standing[0])}"
    if not loose:
        return words, ""
    falls = [body["fall"] for body in loose]
    known = [fall for fall in falls if fall is not None]
    many = len(loose) > 1
    name = f"{len(loose)} loose bodies" if many else "1 loose body"
    if holds and len(known) == len(falls):
        verbs = "fall {} and rest" if many else "falls {} and rests"
        return words, f"{name} {verbs.format(_range(known, units))}"
    if not many and known and not _is_above(loose[0]):
        return words, f"{plain(loose[0]['name'])} {support_words(loose[0], units)}"
    gaps = [body["distance"] for body in loose if body["distance"] is not None]
    if not gaps:
        return words, f"{name} {'touch' if many else 'touches'} nothing"
    where = "above" if all(map(_is_above, loose)) else "from"
    others = {body["nearest"] for body in loose}
    other = plain(others.pop()) if len(others) == 1 else "the nearest parts"
    return words, f"{name} {'are' if many else 'is'} {_range(gaps, units)} {where} {other}"


def _rest_words(body: Entry) -> str:
    """Return how far a body that tips as it stands tips over, and on what it rests; else nothing.

    Examples
    --------
    >>> _rest_words({"rest_deg": 0.62, "rests_on": ["screw", "case"]})
    ': it tips over by 0.62 deg and then rests on screw, case'
    """
    if body.get("rest_deg") is None:
        return ""
    feet = some([plain(name) for name in body["rests_on"]], FEW)
    return f": it tips over by {number(body['rest_deg'], 2)} deg and then rests on {feet}"


def _range(values: Sequence[float], units: str) -> str:
    """Return the least and the largest of lengths in words."""
    return range_words(*(f"{number(f(values), 3)} {units}" for f in (min, max)))


def body_words(body: Entry, units: str) -> str:
    """Return a body and its place: its parts if it stands, else its nearest part and its fall.

    Examples
    --------
    >>> led = {"name": "LED_2", "on_floor": False, "nearest": "board", "distance": 0.035}
    >>> body_words({**led, "below": "board", "fall": 0.035}, "mm")
    'LED_2 (0.035 mm above board)'
    >>> body_words({**led, "below": "desk", "fall": 18.0}, "mm")
    'LED_2 (0.035 mm from board); falls 18 mm onto desk'
    """
    if body["on_floor"]:
        return _standing_words(body)
    words = _loose_words([body], units)
    return words if _is_above(body) else f"{words}; {support_words(body, units)}"


def _standing_words(body: Entry) -> str:
    """Return the name of a body that stands, with its number of parts and its tilt."""
    about = [count(len(body["parts"]), "part")]
    if body["tilt_deg"] is not None:
        tilt = number(body["tilt_deg"], 3)
        about.append(f"tips at {tilt} deg" if body["tilt_deg"] else "tips as it stands")
    return f"{plain(body['name'])} ({', '.join(about)})"


def _loose_words(bodies: Sequence[Entry], units: str) -> str:
    """Return the common name of loose bodies, with their distances from the nearest parts."""
    name = plain(pattern([body["name"] for body in bodies]))
    about = [f"{len(bodies)} bodies"] * (len(bodies) > 1)
    if bodies[0]["nearest"] is not None:
        distances = [body["distance"] for body in bodies]
        where = "above" if all(map(_is_above, bodies)) else "from"
        other = plain(pattern([body["nearest"] for body in bodies]))
        about.append(f"{_range(distances, units)} {where} {other}")
    return f"{name} ({', '.join(about)})" if about else name


def _is_above(body: Entry) -> bool:
    """Whether the nearest part of a loose body is the part below it, at the same distance."""
    if body["below"] is None or body["below"] != body["nearest"]:
        return False
    return bool(abs(body["fall"] - body["distance"]) <= SAME_WAY * body["distance"])


def support_words(body: Entry, units: str) -> str:
    """Return the support of a body in words: a floor, or the part onto which it falls.

    Examples
    --------
    >>> support_words({"on_floor": False, "below": "board", "fall": 0.035}, "mm")
    'falls 0.035 mm onto board'
    """
    if body["on_floor"]:
        return "on a floor, or held"
    if body["below"] is None:
        return "nothing below it"
    return f"falls {number(body['fall'], 3)} {units} onto {plain(body['below'])}"
