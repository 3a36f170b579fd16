"""Open pairs in words: their state, the deciding pairs, and the options that decide them.

An open pair is a pair of parts whose geometry does not determine how they touch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import shell_words, some
from kilter.tell.numbers import number
from kilter.tell.words import VERDICTS

Pair = Mapping[str, Any]
MOVABLE = ("overlap", "near", "clearance")
"""Kinds of open pairs that a movement of parts can decide."""
TILT = "tilted"
"""Word in the reason of a pair whose faces are not parallel; no gap tolerance closes it."""


def pair_words(pair: Pair, units: str) -> str:
    """Return a phrase about two parts whose contact is undecided, and how they lie.

    Examples
    --------
    >>> pair = {"parts": ["a", "b"], "kind": "near", "gap": 0.25, "depth": None, "why": ""}
    >>> pair_words(pair, "mm")
    "'a' and 'b' (0.25 mm apart)"
    """
    a, b = pair["parts"]
    return f"{a!r} and {b!r} ({lie_words(pair, units)})"


def lie_words(pair: Pair, units: str) -> str:
    """Return how the two parts of an open (undecided) pair lie: near, overlapping and so on."""
    kind, gap, depth = pair["kind"], pair["gap"], pair["depth"]
    if kind == "overlap":
        return "they overlap" if depth is None else f"they overlap by {number(depth, 3)} {units}"
    if kind == "clearance":
        return f"{number(gap, 3)} {units} of clearance"
    if kind == "near":
        if not gap or TILT in pair["why"]:
            return str(pair["why"])
        word = "apart" if gap > 0 else "deep in each other"
        return f"{number(abs(gap), 3)} {units} {word}"
    if kind == "unexamined":
        return "their contacts were not examined: the time limit was reached"
    if kind == "free-form":
        return "a curved contact of a kind that is not modelled yet"
    return "only edges or corners touch"


def undecided_sentence(open_pairs: Sequence[Pair], units: str, *, more: Sequence[str] = ()) -> str:
    """Return the sentence of an assembly whose verdict depends on undecided contacts.

    It falls as drawn, but holds if its open pairs are joined.

    Parameters
    ----------
    open_pairs : sequence of mapping
        Open pairs of the answer; the sentence names those that decide.
    units : str
        Length unit.
    more : sequence of str
        Further reasons.

    Examples
    --------
    >>> pair = {"parts": ["a", "b"], "kind": "overlap", "gap": None, "depth": 2.0}
    >>> undecided_sentence([{**pair, "decides": True}], "mm")
    "Undecided: as drawn it falls; it would hold if 'a' and 'b' (they overlap by 2 mm) were \
joined."
    """
    words = [pair_words(pair, units) for pair in open_pairs if pair["decides"]]
    if len(words) > 1:
        hold = f"it would hold if these {len(words)} pairs were joined: {some(words)}"
    else:
        hold = f"it would hold if {some(words)} were joined"
    return f"Undecided: {'; '.join(['as drawn it falls', hold, *more])}."


def deciding_option(pair: Pair) -> str:
    """Return the option that decides a pair: parts move within their play, or are joined by name.

    Examples
    --------
    >>> deciding_option({"parts": ["a", "b"], "kind": "near"})
    '--assume play'
    >>> deciding_option({"parts": ["a", "b c"], "kind": "free-form"})
    '--fasten a "b c"'
    """
    if pair["kind"] == "unexamined":
        return "a longer --time-limit"
    if pair["kind"] in MOVABLE:
        return "--assume play"
    return f"--fasten {shell_words(pair['parts'])}"


def open_facts(answer: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the lines about undecided pairs: their number by kind, and options that decide them.

    Examples
    --------
    >>> pairs = [{"kind": "near"}, {"kind": "overlap"}, {"kind": "near"}]
    >>> open_facts({"open_pairs": pairs, "if_joined": None})
    [('open pairs', '3: 2 near, 1 overlap')]
    """
    pairs, joined = answer["open_pairs"], answer["if_joined"]
    if not pairs:
        return []
    kinds = [pair["kind"] for pair in pairs]
    counted = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    facts = [("open pairs", f"{len(kinds)}: {counted}")]
    if joined is not None:
        least = "a smallest set was not searched for"
        if joined["smallest"]:
            least = "no smaller set of open pairs is enough"
        elif joined["irreducible"]:
            least = "all these pairs are needed, but joining other pairs may be enough, too"
        facts.append(("if joined", f"{VERDICTS[joined['verdict']].lower()}; {least}"))
    return facts
