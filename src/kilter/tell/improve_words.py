"""What an improvement says: its sentence, its facts, the changes that were tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.tell.numbers import number, plain

__all__ = ["HEAD", "change_cells", "improve_facts", "improve_sentence"]

Answer = Mapping[str, Any]

HEAD = ("change", "brick", "cell", "layer", "strength then needed")
"""Over the changes that were tried."""
NEAR = 1e-3
"""Shares this near to 1 are told with more digits [-]."""
VERBS = {"add": "add", "remove": "take away"}


def improve_sentence(answer: Answer) -> str:
    """What to change, in a sentence.

    Examples
    --------
    >>> best = {"what": "add", "name": "2x6-21", "corner": [4, 19, 0], "layer": 0, "cells": [6, 2]}
    >>> falls = {"verdict": "unstable", "share": 1.0055, "best": {**best, "share": 0.9}}
    >>> improve_sentence(falls | {"stands": True})
    'It falls: its studs would need 100.6 % of their strength. Add a brick of 6 x 2 in layer 0 at \
cell (4, 19), and it stands with 90 %.'
    """
    best, share = answer["best"], answer["share"]
    falls = answer["verdict"] == "unstable"
    needed = "no strength of its studs is enough" if share is None else _needs(share, falls)
    first = f"It {'falls' if falls else 'stands'}: {needed}."
    if best is None:
        return f"{first} None of the changes that were tried lowers that."
    change = _change(best)
    if not falls:
        return f"{first} {change}, and {_few(best['share'])} is needed."
    if answer["stands"]:
        return f"{first} {change}, and it stands with {_percent(best['share'])}."
    return f"{first} No one brick is enough; the most helps: {change[0].lower()}{change[1:]}."


def _needs(share: float, falls: bool) -> str:
    if share == 0.0:
        return "no pull of its studs is needed"
    return f"its studs {'would need' if falls else 'need'} {_percent(share)} of their strength"


def _few(share: float) -> str:
    return _percent(share) if share else "no pull"


def _change(one: Answer) -> str:
    """A change in words."""
    a, b = one["cells"]
    x, y, _ = one["corner"]
    where = f"in layer {number(one['layer'], 4)} at cell ({x}, {y})"
    if one["what"] == "remove":
        return f"Take away {plain(one['name'])} {where}"
    return f"Add a brick of {a} x {b} {where}"


def _percent(share: float) -> str:
    """A share in percent, with the digits that tell it from 1."""
    return f"{number(100 * share, 4 if abs(share - 1) > NEAR else 7)} %"


def change_cells(one: Answer) -> Sequence[str]:
    """The cells of a change in a table."""
    a, b = one["cells"]
    x, y, _ = one["corner"]
    brick = plain(one["name"]) if one["what"] == "remove" else f"{a} x {b}"
    share = "no strength is enough" if one["share"] is None else _percent(one["share"])
    return VERBS[one["what"]], brick, f"({x}, {y})", number(one["layer"], 4), share


def improve_facts(answer: Answer) -> list[tuple[str, str]]:
    """Terms of an improvement and what they are."""
    found = [("bricks", str(answer["bricks"]))]
    if answer["weakest"] is not None:
        first, second = answer["weakest"]
        found.append(("weakest", f"the studs between {plain(first)} and {plain(second)}"))
    return found
