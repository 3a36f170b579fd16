"""Warnings about overlaps and about parts that touch nothing.

The functions read the data of an answer: `overlaps` and `nearest` of `kilter contacts --json`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some, some_names
from kilter.tell.name_groups import grouped, pattern, stem
from kilter.tell.numbers import count, number

Entry = Mapping[str, Any]
FEW = 3
"""Largest number of misplaced copies, and of overlaps in one line, that a warning names."""
NAMED = 5
"""Largest number of parts, or groups of parts, that a warning names."""
LISTED = 4
"""Largest number of overlaps that have a warning each."""
ROUND = 0.005
"""An accuracy below this fraction of a gap is not shown, since the gap has three digits [-]."""


def overlap_warnings(overlaps: Sequence[Entry], units: str) -> list[str]:
    """Return a warning for each pair of parts that occupy the same space; one line for many pairs.

    Examples
    --------
    >>> overlap = {"parts": ["a", "b"], "why": "overlap", "depth": 2.0, "volume": 0.5}
    >>> overlap_warnings([overlap], "mm")
    ["'a' and 'b' overlap, 2 mm deep, volume 0.5 mm^3; an overlap is not a contact"]
    >>> overlap_warnings([overlap] * 4 + [overlap | {"depth": 3.0}], "mm")
    ["5 pairs overlap: 'a' and 'b' (3 mm deep), 'a' and 'b' (2 mm deep), 'a' and 'b' (2 mm deep) \
and 2 more; an overlap is not a contact"]
    """
    if len(overlaps) > LISTED:
        deepest = sorted(overlaps, key=lambda overlap: -overlap["depth"])
        pairs = ["{!r} and {!r}".format(*overlap["parts"]) for overlap in deepest]
        words = [
            f"{pair} ({overlap['depth']:.3g} {units} deep)"
            for pair, overlap in zip(pairs, deepest, strict=True)
        ]
        return [f"{len(words)} pairs overlap: {some(words, FEW)}; an overlap is not a contact"]
    lines = []
    for overlap in overlaps:
        first, second = overlap["parts"]
        size = "" if overlap["volume"] is None else f", volume {overlap['volume']:.3g} {units}^3"
        lines.append(
            f"{first!r} and {second!r} {overlap['why']}, {overlap['depth']:.3g} {units} deep{size};"
            " an overlap is not a contact"
        )
    return lines


def copy_warnings(odd: Sequence[tuple[str, Sequence[str], str]]) -> list[str]:
    """Return a warning about parts that overlap although identical parts do not; at most one item.

    Arguments: `odd`: name of the part, names of the parts that it overlaps, and name of an equal
    part that overlaps nothing.

    Examples
    --------
    >>> copy_warnings([("foot_2", ["body"], "foot_1")])
    ["is 'foot_2' in the right place? it overlaps 'body', but its copy 'foot_1' overlaps nothing"]
    """
    if not odd:
        return []
    words = [
        f"is {part!r} in the right place? it overlaps {some_names(others)}, but its copy {copy!r} "
        "overlaps nothing"
        for part, others, copy in odd
    ]
    more = f"; {len(words) - FEW} more parts overlap, but their copies do not" * (len(words) > FEW)
    return ["; ".join(words[:FEW]) + more]


def lone_warnings(nearest: Sequence[Entry], units: str) -> list[str]:
    """Return warnings about free parts, and about held parts, that touch nothing.

    Examples
    --------
    >>> top = {"part": "top", "nearest": "base", "gap": 0.25, "accuracy": 0.0, "grounded": False}
    >>> lone_warnings([top], "mm")
    ["touches nothing: 'top' (0.25 mm from 'base')"]
    >>> lone_warnings([top | {"part": f"LED_{k}", "gap": 0.25 + k} for k in range(3)], "mm")
    ["touches nothing: 'LED_*' (3 parts, 0.25 to 2.25 mm from 'base')"]
    """
    warnings = []
    for held, words in ((False, "touches nothing"), (True, "is held, but touches nothing")):
        entries = [entry for entry in nearest if entry["grounded"] == held]
        groups = grouped(entries, lambda entry: (stem(entry["part"]), stem(entry["nearest"] or "")))
        if groups:
            alone = [_lone_parts(group, units) for group in groups[:NAMED]]
            more = len(entries) - sum(map(len, groups[:NAMED]))
            warnings.append(f"{words}: {some(alone, len(alone), len(alone) + more)}")
    return warnings


def group_warnings(groups: Sequence[Sequence[str]]) -> list[str]:
    """Return a warning about groups of parts that touch no part outside their group.

    Examples
    --------
    >>> group_warnings([["nut", "bolt"], ["cap", "pin"]])
    ["touch no other part: the group ('nut', 'bolt'), the group ('cap', 'pin')"]
    """
    named = [f"the group ({some_names(names)})" for names in groups]
    return [f"touch no other part: {some(named, FEW)}"] if named else []


def _lone_parts(entries: Sequence[Entry], units: str) -> str:
    """Return the name of parts that touch nothing, with their gaps to the nearest parts."""
    name = repr(pattern([entry["part"] for entry in entries]))
    about = [count(len(entries), "part")] * (len(entries) > 1)
    if entries[0]["nearest"] is not None:
        ends = [f(entries, key=lambda entry: float(entry["gap"])) for f in (min, max)]
        other = pattern([entry["nearest"] for entry in entries])
        about.append(f"{range_words(*(gap_words(end, units) for end in ends))} from {other!r}")
    return f"{name} ({', '.join(about)})" if about else name


def range_words(least: str, most: str) -> str:
    """Return a range of two lengths with the same unit, or a single length if both are equal.

    Examples
    --------
    >>> range_words("2 mm", "3 mm"), range_words("2 mm", "2 mm")
    ('2 to 3 mm', '2 mm')
    """
    return least if least == most else f"{least.rpartition(' ')[0]} to {most}"


def gap_words(entry: Entry, units: str) -> str:
    """Return a gap with its unit, and its accuracy if that is not negligible.

    Examples
    --------
    >>> gap_words({"gap": 0.25, "accuracy": 0.01}, "mm")
    '0.25 +/- 0.01 mm'
    """
    gap, accuracy = entry["gap"], entry["accuracy"]
    spread = "" if accuracy <= ROUND * gap else f" +/- {number(accuracy, 1)}"
    return f"{number(gap, 3)}{spread} {units}"
