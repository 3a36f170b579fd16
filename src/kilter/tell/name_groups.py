"""Groups of names that differ only in their numbers: "drawer_*" for drawer_1 to drawer_8."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from kilter.errors import some
from kilter.tell.numbers import count, plain

Item = TypeVar("Item")
NUMBERS = re.compile(r"(\d+)")
"""Numbers within a name."""
MANY = 3
"""Least number of names that differ only in their numbers and become one group."""
FEW = 3
"""Largest number of names and groups that a list shows."""


def stem(name: str) -> str:
    """Return a name with "*" in the place of each number.

    Examples
    --------
    >>> stem("drawer_12")
    'drawer_*'
    """
    return NUMBERS.sub("*", name)


def grouped(items: Iterable[Item], key: Callable[[Item], object]) -> list[list[Item]]:
    """Divide items into groups with equal keys; groups of less than `MANY` become single items.

    Examples
    --------
    >>> grouped(["LED_1", "knob_1", "LED_2", "LED_7", "knob_2"], stem)
    [['LED_1', 'LED_2', 'LED_7'], ['knob_1'], ['knob_2']]
    """
    groups: dict[object, list[Item]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return [
        part
        for group in groups.values()
        for part in ([group] if len(group) >= MANY else [[item] for item in group])
    ]


def pattern(names: Sequence[str]) -> str:
    """Return the common form of names with one stem; "*" stands for the numbers that differ.

    Examples
    --------
    >>> pattern(["brick-2-1", "brick-2-3"])
    'brick-2-*'
    """
    pieces = [NUMBERS.split(name) for name in names]
    return "".join(same[0] if len({*same}) == 1 else "*" for same in zip(*pieces, strict=True))


def group_words(names: Sequence[str], noun: str = "part") -> str:
    """Return the name of a group with one stem, with the number of its members.

    Examples
    --------
    >>> group_words(["LED_1", "LED_2", "LED_7"]), group_words(["knob_1"])
    ('LED_* (3 parts)', 'knob_1')
    """
    if len(names) == 1:
        return plain(names[0])
    return f"{plain(pattern(names))} ({count(len(names), noun)})"


def names_words(names: Iterable[str], noun: str = "part") -> str:
    """Return a list of names as words: groups, the first `FEW`, and the number of other names.

    Examples
    --------
    >>> names_words(["LED_1", "knob", "LED_2", "LED_7", "lid", "key", "pin"])
    'LED_* (3 parts), knob, lid and 2 more'
    """
    groups = grouped(dict.fromkeys(names), stem)
    shown = groups[:FEW]
    more = sum(map(len, groups)) - sum(map(len, shown))
    return some([group_words(group, noun) for group in shown], len(shown), len(shown) + more)
