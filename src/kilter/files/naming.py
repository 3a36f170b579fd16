"""Names of parts: make them distinct, fill in missing names, sort them by their numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from kilter.assembly.part import GROUND

__all__ = ["distinct", "fill_names", "natural_key", "tails"]


def distinct(names: Sequence[str]) -> list[str]:
    """Make names distinct by appending a number to every repeated name.

    The name "ground" is reserved, so it always gets a number.

    Examples
    --------
    >>> distinct(["bolt", "nut", "bolt", "bolt"])
    ['bolt', 'nut', 'bolt_2', 'bolt_3']
    >>> distinct(["bolt", "bolt", "bolt_2"])  # a number that is in use is skipped
    ['bolt', 'bolt_3', 'bolt_2']
    >>> distinct(["ground", "bolt"])
    ['ground_2', 'bolt']
    """
    taken = set(names)
    count = Counter([GROUND])
    result = []
    for name in names:
        count[name] += 1
        label = name
        if count[name] > 1:
            while (label := f"{name}_{count[name]}") in taken:
                count[name] += 1
            taken.add(label)
        result.append(label)
    return result


def tails(paths: Sequence[tuple[str, ...]]) -> list[str]:
    """Shorten paths to their last components, as far as they stay distinct, joined by "/".

    Examples
    --------
    >>> tails([("left", "nut"), ("right", "nut"), ("right", "rod"), ("plate",), ("plate",)])
    ['left/nut', 'right/nut', 'rod', 'plate', 'plate']
    >>> tails([("a", "plate"), ("plate",)])  # a whole path is kept, although others end with it
    ['a/plate', 'plate']
    """
    unique = list(dict.fromkeys(paths))
    length = {path: len(path) for path in unique}
    # paths with the same last components form a group; longer ends divide it, until it has one path
    pending = dict.fromkeys(unique, 0)
    for count in range(1, max(map(len, unique), default=0) + 1):
        ends = {
            path: (group, path[-count]) for path, group in pending.items() if len(path) >= count
        }
        sizes = Counter(ends.values())
        groups = {end: k for k, end in enumerate(sizes)}
        length |= {path: count for path, end in ends.items() if sizes[end] == 1}
        pending = {path: groups[end] for path, end in ends.items() if sizes[end] > 1}
    return ["/".join(path[len(path) - length[path] :]) for path in paths]


def fill_names(names: Sequence[str | None], stem: str) -> list[str]:
    """Distinct names for all bodies; missing names are made from `stem`, the name of the file.

    Examples
    --------
    >>> fill_names([None], "plate"), fill_names([None, "nut", None], "plate")
    (['plate'], ['plate_1', 'nut', 'plate_3'])
    """
    if len(names) == 1:
        return [names[0] or stem]
    return distinct([name or f"{stem}_{k}" for k, name in enumerate(names, start=1)])


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """Key for sorting names so that "part-10" follows "part-9".

    Examples
    --------
    >>> sorted(["part10", "part2", "b", "1"], key=natural_key)
    ['1', 'b', 'part2', 'part10']
    """
    pieces = re.split(r"([0-9]+)", name)
    # a number is compared by length, then by digits: int() rejects very long numbers
    key = [
        (0, len(p.lstrip("0")), p.lstrip("0")) if p.isdecimal() else (1, 0, p.casefold())
        for p in pieces
        if p
    ]
    return [*key, (2, 0, name)]
