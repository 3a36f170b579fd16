"""The ladder of assumptions in words: the sentence, its rows, and the next command."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some
from kilter.tell.numbers import count, number, plain
from kilter.tell.words import VERDICTS

Row = Mapping[str, Any]
Fact = tuple[str, str]
DRAWN, JOINED = "drawn", "joined"
"""The rung that assumes nothing, and the rung that joins all parts that touch."""
IF = {
    DRAWN: "as drawn",
    "play": "after its parts move within their play",
    "fits": "if the pairs that look fastened are joined",
    JOINED: "if its touching parts are joined",
}
"""Condition of each rung."""
TOUCHES = "touching"
"""Reason of the joints between parts that touch or overlap."""
STANDS = ("stable", "settles")
"""Verdicts of which a sentence says that the assembly stands."""
NAMED = 3
"""Number of falling parts that a sentence names."""
UNDECIDED = {
    "size": "a search for its pose at rest takes long",
    "work": "the search for its pose at rest did not end",
}
"""Reasons for which a row is not decided."""


def condition(row: Row) -> str:
    """Return the condition of a row.

    Examples
    --------
    >>> condition({"assume": "joined", "friction": None})
    'if its touching parts are joined'
    >>> condition({"assume": "drawn", "friction": 0.3})
    'with friction 0.3'
    """
    words = IF[row["assume"]]
    if row["friction"] is None:
        return words
    rubs = f"with friction {number(row['friction'])}"
    return rubs if row["assume"] == "drawn" else f"{rubs}, {words}"


def holding_row(ladder: Sequence[Row]) -> Row | None:
    """Return the lowest row on which the assembly stands; else the lowest with equilibrium.

    Friction assumes less than joints between all parts that touch.

    Examples
    --------
    >>> row = {"friction": None, "verdict": "stable", "level": "proved"}
    >>> holding_row([{**row, "assume": "joined"}, {**row, "assume": "drawn", "friction": 0.3}])
    {'friction': 0.3, 'verdict': 'stable', 'level': 'proved', 'assume': 'drawn'}
    """
    ladder = sorted(ladder, key=lambda row: row["assume"] == JOINED)
    held = [row for row in ladder if row["verdict"] in STANDS]
    held = held or [row for row in ladder if row["level"] is not None]
    return held[0] if held else None


def rung_sentence(
    sentence: str, *, assume: str, moved: float, joined: int, units: str, holds: bool
) -> str:
    """Return the sentence of a verdict with the assumptions of its rung.

    Arguments: `moved`: longest way of a part [length unit]; `joined`: number of joints that the
    rung added; `holds`: whether the verdict has a level.

    Examples
    --------
    >>> rung_sentence("Stable: it cannot start to move.", assume="joined", moved=0.0, joined=3,
    ...               units="mm", holds=True)
    'Stable only if its touching parts are joined (3 joints): it cannot start to move.'
    """
    only = "only if" if holds else "even if"
    words = []
    if assume == JOINED and joined:
        words.append(f"{only} its touching parts are joined ({count(joined, 'joint')})")
    elif assume == "fits" and joined:
        words.append(f"{only} the pairs that look fastened are joined ({count(joined, 'joint')})")
    if moved:
        words.append(f"after moving at most {number(moved, 3)} {units} within its play")
    verdict, colon, rest = sentence.partition(":")
    comma = "," if "," in verdict else ""
    return f"{verdict}{comma} {', '.join(words)}{colon}{rest}" if words else sentence


def assumed_words(joints: int, moved: float, units: str) -> str:
    """Return a note about the joints and the movement that a rung assumes; empty without them.

    Examples
    --------
    >>> assumed_words(14, 0.5, "mm")
    'assumed: 14 joints between its parts, and movements of at most 0.5 mm within its play'
    """
    words = [f"{count(joints, 'joint')} between its parts"] if joints else []
    words += [f"movements of at most {number(moved, 3)} {units} within its play"] if moved else []
    return f"assumed: {', and '.join(words)}" if words else ""


def ladder_sentence(
    ladder: Sequence[Row], verdict: str, *, assume: str, joined: tuple[str, str] = ("", "")
) -> str | None:
    """Return the sentence of an answer with a ladder; None if its own sentence says enough.

    It states the lowest rung that holds and the parts that fall as drawn, or else the parts that
    fall on every rung. `joined`: words about the joined bodies that stand and about the loose
    bodies (`kilter.tell.body_words.joined_words`).

    Examples
    --------
    >>> row = {"friction": None, "verdict": "unstable", "level": None, "decided": True}
    >>> rows = [{**row, "assume": "drawn", "falls": 1, "names": ["lid"]},
    ...         {**row, "assume": "joined", "verdict": "stable", "level": "proved", "falls": 0}]
    >>> ladder_sentence(rows, "unstable", assume="drawn", joined=("one body of 2 parts", ""))
    'Unstable as drawn; it stands if its touching parts are joined: one body of 2 parts. \
As drawn 1 part falls: lid.'
    >>> rows[1] |= {"verdict": "unstable", "level": None, "falls": 1, "names": ["pin"]}
    >>> rows[0] |= {"falls": 2, "names": ["lid", "pin"]}
    >>> ladder_sentence(rows, "unstable", assume="drawn")
    'Unstable: 1 part falls: pin, even if its touching parts are joined (as drawn 2 parts fall: \
lid, pin).'
    """
    if not ladder or assume != "drawn":
        return None
    drawn, best = ladder[0], holding_row(ladder)
    standing, loose = joined
    if best is not None:
        stands = "it stands" if best["verdict"] in STANDS else "forces that hold it exist"
        falls = f" As drawn {fall_words(drawn)}." if drawn["falls"] else ""
        bodies = ""
        if best["assume"] == JOINED and standing:
            bodies = f": {standing}" + (f". {loose}" if loose else "")
        return f"{VERDICTS[verdict]} as drawn; {stands} {condition(best)}{bodies}.{falls}"
    begin = VERDICTS[verdict]
    known = [row for row in ladder if row["falls"]]
    top = min(known, key=lambda row: row["falls"], default=None)
    row = next((row for row in known if row["assume"] == JOINED), None)
    words = ". ".join(filter(None, joined))
    if not all(row["decided"] for row in ladder):
        if row is None:
            then = f" If its touching parts are joined: {words}." if words else ""
            return f"{begin} as drawn: {fall_words(drawn)}.{then}"
        falls = fall_words(min(drawn, row, key=lambda row: row["falls"] or math.inf))
        then = f" Joined: {words}." if words else ""
        if verdict != "unstable":
            return f"{begin} as drawn; even {condition(row)}, {falls}.{then}"
        return f"{begin}, even {condition(row)}: {falls}.{then}"
    if verdict != "unstable" and all(row["verdict"] == "unstable" for row in ladder[1:]):
        then = f" Joined: {words}." if words else ""
        falls = fall_words(top or drawn)
        return f"{begin} as drawn; unstable on every other assumption: {falls}.{then}"
    if top is None or top["falls"] >= drawn["falls"]:
        then = f" Joined: {words}." if words else ""
        return f"{begin} as drawn and on every other assumption: {fall_words(drawn)}.{then}"
    then = f" Joined: {words}." if words and top["assume"] == JOINED else ""
    return (
        f"{begin}: {fall_words(top)}, even {condition(top)} (as drawn {fall_words(drawn)}).{then}"
    )


def fall_words(row: Row) -> str:
    """Return how many parts fall on a row, with the names of the largest."""
    many = row["falls"]
    if not many:
        return "which parts fall is not known"
    names = [plain(name) for name in row["names"]]
    verb = "part falls" if many == 1 else "parts fall"
    least = "" if row.get("decided", True) else "at least "
    return f"{least}{many} {verb}: {some(names, NAMED, many)}"


def ladder_facts(answer: Mapping[str, Any]) -> list[Fact]:
    """Return a line for each rung: its condition, the verdict, and the parts that fall.

    Examples
    --------
    >>> row = {"assume": "fits", "friction": None, "verdict": "unstable", "level": None,
    ...        "decided": True, "falls": 1, "names": ["lid"]}
    >>> ladder_facts({"ladder": [row]})
    [('fits', 'unstable: 1 part falls: lid')]
    >>> ladder_facts({"ladder": [{**row, "decided": False, "falls": 0, "why": "size"}]})
    [('fits', 'not decided, since a search for its pose at rest takes long: --assume fits')]
    """
    facts = []
    for row in answer.get("ladder", ()):
        name = row["assume"] if row["friction"] is None else f"mu {number(row['friction'])}"
        if not row["decided"] and not row["falls"]:
            reason = UNDECIDED[row["why"] or "work"]
            words = f"not decided, since {reason}: {' '.join(_options(row))}"
        elif row["level"] is not None:
            words = VERDICTS[row["verdict"]].lower()
        else:
            words = f"{row['verdict']}: {fall_words(row)}"
        facts.append((name, words))
    return facts


def ladder_step(ladder: Sequence[Row]) -> tuple[tuple[str, ...], str] | None:
    """Return the options of the lowest rung that holds, and their meaning; None without one.

    Examples
    --------
    >>> row = {"assume": "joined", "friction": None, "verdict": "stable", "level": "proved"}
    >>> ladder_step([row])
    (('--assume', 'joined'), 'if its touching parts are joined')
    """
    best = holding_row(ladder)
    if best is None:
        return None
    return _options(best), condition(best)


def _options(row: Row) -> tuple[str, ...]:
    """Return the options that ask for a row."""
    words = () if row["assume"] == DRAWN else ("--assume", row["assume"])
    return words if row["friction"] is None else (*words, "--friction", number(row["friction"]))
