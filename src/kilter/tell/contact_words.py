"""What is said of contacts beside their list: overlaps, and parts that touch nothing.

From the data of an answer: `overlaps` and `nearest` of `kilter contacts --json`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some, some_names
from kilter.tell.numbers import number

__all__ = ["copy_warnings", "gap_words", "lone_warnings", "overlap_warnings"]

Entry = Mapping[str, Any]
FEW = 3
"""So many misplaced copies are named."""
LISTED = 20
"""So many overlaps are named."""
ROUND = 0.005
"""An accuracy up to this fraction of a gap is not told: the gap has three digits."""


def overlap_warnings(overlaps: Sequence[Entry], units: str) -> list[str]:
    """Pairs that share volume, a line each.

    Examples
    --------
    >>> one = {"parts": ["a", "b"], "why": "overlap", "depth": 2.0, "volume": 0.5}
    >>> overlap_warnings([one], "mm")
    ["'a' and 'b' overlap, 2 mm deep, volume 0.5 mm^3; an overlap is not a contact"]
    """
    found = []
    for one in overlaps[:LISTED]:
        first, second = one["parts"]
        size = "" if one["volume"] is None else f", volume {one['volume']:.3g} {units}^3"
        found.append(
            f"{first!r} and {second!r} {one['why']}, {one['depth']:.3g} {units} deep{size}; "
            "an overlap is not a contact"
        )
    more = len(overlaps) - LISTED
    return [*found, *([f"{more} more pairs overlap"] if more > 0 else [])]


def copy_warnings(odd: Sequence[tuple[str, Sequence[str], str]]) -> list[str]:
    """Parts that overlap others, and a copy of each that overlaps nothing: a line in all.

    Examples
    --------
    >>> copy_warnings([("foot_2", ["body", "head"], "foot_1")])
    ["is 'foot_2' placed right? it overlaps 'body', 'head', and its copy 'foot_1' overlaps nothing"]
    """
    if not odd:
        return []
    words = [
        f"is {part!r} placed right? it overlaps {some_names(others)}, and its copy {copy!r} "
        "overlaps nothing"
        for part, others, copy in odd
    ]
    return ["; ".join(words[:FEW]) + (f"; {len(words) - FEW} more like it" * (len(words) > FEW))]


def lone_warnings(nearest: Sequence[Entry], units: str) -> list[str]:
    """Parts that touch nothing, with what is nearest to them; held ones apart.

    Examples
    --------
    >>> top = {"part": "top", "nearest": "base", "gap": 0.25, "accuracy": 0.0, "grounded": False}
    >>> lone_warnings([top], "mm")
    ["touches nothing: 'top' (0.25 mm from 'base')"]
    """
    found = []
    for held, words in ((False, "touches nothing"), (True, "held, but touches nothing")):
        alone = [one for one in nearest if one["grounded"] == held]
        if alone:
            found.append(f"{words}: {some([_lone(one, units) for one in alone])}")
    return found


def _lone(one: Entry, units: str) -> str:
    if one["nearest"] is None:
        return repr(one["part"])
    return f"{one['part']!r} ({gap_words(one, units)} from {one['nearest']!r})"


def gap_words(one: Entry, units: str) -> str:
    """A gap, with its accuracy where that is not small.

    Examples
    --------
    >>> gap_words({"gap": 0.25, "accuracy": 0.01}, "mm")
    '0.25 mm, to within 0.01,'
    """
    gap, accuracy = one["gap"], one["accuracy"]
    words = f"{number(gap, 3)} {units}"
    return words if accuracy <= ROUND * gap else f"{words}, to within {number(accuracy, 1)},"
