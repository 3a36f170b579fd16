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
MOST_LINES = 12
"""Largest number of lines about bodies."""
FALLING = 2
"""Number of falling bodies that a sentence names."""

Entry = Mapping[str, Any]


def body_sentences(bodies: Sequence[Entry], units: str) -> list[str]:
    """Return lines about the bodies of an answer: their number, and a line for each.

    Loose bodies whose names differ in numbers only share a line. Without a floor and without held
    parts, all bodies but the heaviest are loose.

    Examples
    --------
    >>> board = {"name": "board", "parts": ["board", "chip"], "on_floor": True, "tilt_deg": 40.0}
    >>> leds = [{"name": f"LED_{k}", "parts": [f"LED_{k}"], "on_floor": False, "nearest": "board",
    ...          "distance": 0.035, "below": "board", "fall": 0.035} for k in range(14)]
    >>> print(*body_sentences([board, *leds], "mm"), sep="\\n")
    Bodies of parts that touch or overlap: 15, of which 14 are loose.
    board (2 parts): on a floor or held, tips at 40 deg
    LED_* (14 bodies): 0.035 mm above board
    """
    if not bodies:
        return []
    standing = [body for body in bodies if body["on_floor"]]
    inner = {name for body in bodies for name in body["parts"]}
    afloat = not standing and all(body["below"] in {None, *inner} for body in bodies)
    loose = [body for body in bodies if not body["on_floor"]][1 if afloat else 0 :]
    head = f"Bodies of parts that touch or overlap: {len(bodies)}"
    head += f", of which {len(loose)} {'is' if len(loose) == 1 else 'are'} loose" if loose else ""
    groups = [[body] for body in (bodies[:1] if afloat else standing)]
    groups += grouped(loose, lambda body: (stem(body["name"]), stem(body["nearest"] or "")))
    shown = groups if len(groups) < MOST_LINES else groups[: MOST_LINES - 2]
    lines = [_group_words(group, units) for group in shown]
    if afloat:
        lines[0] = f"{_names_words(bodies[:1])}: the heaviest"
    more = len(bodies) - sum(map(len, shown))
    return [f"{head}.", *lines, *([f"and {more} more"] if more else [])]


def _group_words(bodies: Sequence[Entry], units: str) -> str:
    """Return the common name of bodies, with their number, and their place."""
    return f"{_names_words(bodies)}: {_place_words(bodies, units)}"


def _names_words(bodies: Sequence[Entry]) -> str:
    """Return the common name of bodies with their number, or a body with its number of parts."""
    name = plain(pattern([body["name"] for body in bodies]))
    many = f"{len(bodies)} bodies" if len(bodies) > 1 else count(len(bodies[0]["parts"]), "part")
    return f"{name} ({many})"


def _place_words(bodies: Sequence[Entry], units: str) -> str:
    """Return the support of bodies with a common name, or their nearest parts and falls."""
    body = bodies[0]
    if body["on_floor"]:
        return f"on a floor or held{_tilt_words(body)}"
    words, above = [], all(map(_is_above, bodies))
    if body["nearest"] is not None and body["fall"] != 0.0:
        other = plain(pattern([entry["nearest"] for entry in bodies]))
        gaps = _range([entry["distance"] for entry in bodies], units)
        words.append(f"{gaps} {'above' if above else 'from'} {other}")
    if not above and all(entry["below"] is not None for entry in bodies):
        words.append(_falls_words(bodies, units))
    words = ["; ".join(words)] if words else ["touches nothing"]
    return " and ".join(filter(None, [*words, _rest_words(body) if len(bodies) == 1 else ""]))


def _falls_words(bodies: Sequence[Entry], units: str) -> str:
    """Return the support of a body, or the range of the falls of several bodies.

    Examples
    --------
    >>> pins = [{"on_floor": False, "below": f"hole_{k}", "fall": k} for k in range(1, 4)]
    >>> _falls_words(pins, "mm"), _falls_words(pins[:1], "mm")
    ('fall 1 to 3 mm onto hole_*', 'falls 1 mm onto hole_1')
    >>> _falls_words([{**pin, "fall": 0.0} for pin in pins], "mm")
    'touch hole_* in a way that is not modelled'
    """
    if len(bodies) == 1:
        return support_words(bodies[0], units)
    names, falls = [body["below"] for body in bodies], [body["fall"] for body in bodies]
    onto = plain(pattern(names)) if len({*map(stem, names)}) == 1 else "other parts"
    if not any(falls):
        return f"touch {onto} in a way that is not modelled"
    return f"fall {_range(falls, units)} onto {onto}"


def _tilt_words(body: Entry) -> str:
    """Return the tilt of a body as the end of a clause; nothing if it is not known."""
    if body["tilt_deg"] is None:
        return ""
    if body["tilt_deg"]:
        return f", tips at {number(body['tilt_deg'], 3)} deg"
    return f", {_rest_words(body) or 'tips as it stands'}"


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
    >>> lid = {**led, "name": "lid", "nearest": "wall", "below": "floor", "fall": 40.0}
    >>> joined_words([{**board, "tilt_deg": 0.0}, {**board, "name": "post"}, lid, led], "mm",
    ...              holds=False)
    ('2 bodies on the floor, of which board does not stand as drawn', '2 loose bodies: \
lid falls 40 mm onto floor, LED falls 0.035 mm onto board')
    """
    standing = [body for body in bodies if body["on_floor"]]
    loose = [body for body in bodies if not body["on_floor"]]
    words = _standing_words(standing) if standing else ""
    return words, _loose_words(loose, units, holds=holds) if loose else ""


def _standing_words(standing: Sequence[Entry]) -> str:
    """Return the bodies on a floor, with those that tip over, or the least tilt of a body."""
    known = [body for body in standing if body["tilt_deg"] is not None]
    tipping = [body for body in known if not body["tilt_deg"]]
    parts = len(standing[0]["parts"])
    words = f"one body of {parts} parts" if parts > 1 else plain(standing[0]["name"])
    which = "which"
    if len(standing) > 1:
        words = f"{len(standing)} bodies on the floor"
        names = some([plain(body["name"]) for body in tipping or known[:1]], FEW)
        which = f"of which {names}"
    if tipping:
        verb = "does" if len(tipping) == 1 else "do"
        rest = _rest_words(tipping[0]) if len(tipping) == 1 else ""
        return f"{words}, {which} {verb} not stand as drawn" + (f": it {rest}" if rest else "")
    if len(standing) == 1 and known:
        return f"{words}, which tips at {number(known[0]['tilt_deg'], 3)} deg"
    return words


def _loose_words(loose: Sequence[Entry], units: str, *, holds: bool | None) -> str:
    """Return a sentence about loose bodies: their falls, or their distances from other parts."""
    falls = [body["fall"] for body in loose if body["fall"] is not None]
    many = len(loose) > 1
    name = f"{len(loose)} loose bodies" if many else "1 loose body"
    if holds and len(falls) == len(loose):
        verbs = "fall {} and rest" if many else "falls {} and rests"
        return f"{name} {verbs.format(_range(falls, units))}"
    others = {body["nearest"] for body in loose}
    above = all(map(_is_above, loose))
    if falls and not above and (not many or (len(others) > 1 and len(loose) < MOST_LINES)):
        largest = [f"{plain(body['name'])} {_fall_words(body, units)}" for body in loose]
        return f"{name}: {some(largest, FALLING)}" if many else largest[0]
    gaps = [body["distance"] for body in loose if body["distance"] is not None]
    if not gaps:
        return f"{name} {'touch' if many else 'touches'} nothing"
    other = plain(others.pop()) if len(others) == 1 else "the nearest parts"
    where = "above" if above else "from"
    return f"{name} {'are' if many else 'is'} {_range(gaps, units)} {where} {other}"


def _fall_words(body: Entry, units: str) -> str:
    """Return the support of a loose body, and its rest if it then tips over on a floor."""
    return " and ".join(filter(None, [support_words(body, units), _rest_words(body)]))


def _rest_words(body: Entry) -> str:
    """Return how far a body tips over, and on which of its parts it rests; nothing if it stands.

    Examples
    --------
    >>> case = {"rest_deg": 0.62, "rests_on": ["screw", "case"], "parts": ["case", "lid", "screw"]}
    >>> _rest_words(case)
    'tips over by 0.62 deg and then rests on its parts screw, case'
    >>> _rest_words({**case, "parts": ["case"]})
    'tips over by 0.62 deg and then rests'
    """
    if body.get("rest_deg") is None:
        return ""
    words = f"tips over by {number(body['rest_deg'], 2)} deg and then rests"
    if len(body["parts"]) == 1:
        return words
    feet = [plain(name) for name in body["rests_on"]]
    return f"{words} on its {'part' if len(feet) == 1 else 'parts'} {some(feet, FEW)}"


def _range(values: Sequence[float], units: str) -> str:
    """Return the least and the largest of lengths in words."""
    return range_words(*(f"{number(f(values), 3)} {units}" for f in (min, max)))


def body_words(body: Entry, units: str) -> str:
    """Return a body and its place: its support if it stands, else its nearest part and its fall.

    Examples
    --------
    >>> led = {"name": "LED_2", "parts": ["LED_2"], "on_floor": False, "nearest": "board",
    ...        "distance": 0.035}
    >>> body_words({**led, "below": "board", "fall": 0.035}, "mm")
    'LED_2 (1 part): 0.035 mm above board'
    >>> body_words({**led, "below": "desk", "fall": 18.0}, "mm")
    'LED_2 (1 part): 0.035 mm from board; falls 18 mm onto desk'
    """
    return _group_words([body], units)


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
    >>> support_words({"on_floor": False, "below": "board", "fall": 0.0}, "mm")
    'touches board in a way that is not modelled'
    """
    if body["on_floor"]:
        return "on a floor, or held"
    if body["below"] is None:
        return "nothing below it"
    if not body["fall"]:
        return f"touches {plain(body['below'])} in a way that is not modelled"
    return f"falls {number(body['fall'], 3)} {units} onto {plain(body['below'])}"
