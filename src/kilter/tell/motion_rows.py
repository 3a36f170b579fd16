"""Rows of the moving parts of an answer, in which parts with equal motions share a row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.tell.name_groups import grouped, names_words, stem
from kilter.tell.numbers import Name

MOST_MOTIONS = 12
"""Largest number of rows about moving parts in the brief text of an answer."""

Part = Mapping[str, Any]


def motion_of(part: Part) -> str:
    """Return how a part starts to move, or its slow motion if no part moves fast enough."""
    return str(part["motion"] if part["moves"] else part["slow_motion"])


def motion_rows(parts: Sequence[Part], *, by_proof: bool = False) -> list[Sequence[str]]:
    """Return the names and the motions of parts, as at most `MOST_MOTIONS` rows of two cells.

    Parts whose names differ only in numbers share a row if their motions are equal; if the rows
    are too many, so do all parts with equal motions. Falls of equal length are equal motions.
    `by_proof`: whether the parts that the motion of the proof moves have rows of their own.

    Examples
    --------
    >>> lid = {"name": "lid", "motion": "tips about +y", "moves": True}
    >>> drawers = [{"name": f"drawer_{k}", "motion": f"falls 18 mm onto panel_{k}",
    ...             "below": f"panel_{k}", "moves": True} for k in range(8)]
    >>> motion_rows([*drawers, lid])
    [('drawer_* (8 parts)', 'each falls 18 mm onto panel_* (8 parts)'), ('lid', 'tips about +y')]
    """

    def motion(part: Part) -> object:
        """Common properties of the parts in a row."""
        return _without_target(part), by_proof and part["moved_by_proof"]

    groups = grouped(parts, lambda part: (motion(part), stem(part["name"])))
    if len(groups) > MOST_MOTIONS:
        groups = grouped(parts, motion)
    shown = len(groups) if len(groups) <= MOST_MOTIONS else MOST_MOTIONS - 1
    rows = [_row(group) for group in groups[:shown]]
    more = sum(map(len, groups[shown:]))
    return [*rows, (f"and {more} more (--verbose lists all)", "")] if more else rows


def _without_target(part: Part) -> str:
    """Return the motion of a part without the name of the part onto which it falls."""
    return motion_of(part).removesuffix(part.get("below") or "")


def _row(group: Sequence[Part]) -> Sequence[str]:
    """Return the cells of a row: the names of the parts, and their common motion."""
    first = group[0]
    if len(group) == 1:
        return Name(first["name"]), motion_of(first)
    below = [part["below"] for part in group if part.get("below")]
    words = f"each {_without_target(first)}{names_words(below)}"
    return names_words(part["name"] for part in group), words
