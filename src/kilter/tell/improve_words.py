"""The answer of `kilter improve` in words: its sentence, its facts, the tried changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.tell.numbers import number, plain

__all__ = ["HEAD", "change_cells", "improve_facts", "improve_sentence"]

Answer = Mapping[str, Any]

HEAD = ("change", "brick", "cell", "layer", "strength needed after it")
"""Column heads of the table of changes that were tried."""
NEAR = 1e-3
"""Shares within this distance of 1 are shown with more digits [-]."""
VERBS = {"add": "add", "remove": "remove"}


def improve_sentence(answer: Answer) -> str:
    """Return sentences about the present state of an assembly and the best change to it.

    Examples
    --------
    >>> best = {"what": "add", "name": "2x6-21", "corner": [4, 19, 0], "layer": 0, "cells": [6, 2]}
    >>> falls = {"verdict": "unstable", "share": 1.0055, "best": {**best, "share": 0.9}}
    >>> improve_sentence(falls | {"stands": True})
    'It falls: its studs would need 100.6 % of their strength. Add a brick of 6 x 2 in layer 0 at \
cell (4, 19): then it stands and needs 90 %.'
    """
    best, share = answer["best"], answer["share"]
    falls = answer["verdict"] == "unstable"
    needed = "no strength of its studs is enough" if share is None else _needs(share, falls)
    first = f"It {'falls' if falls else 'stands'}: {needed}."
    if best is None:
        return f"{first} No change that was tried lowers this need."
    change = _change_words(best)
    if not falls:
        return f"{first} {change}: then it needs {_need_words(best['share'])}."
    if answer["stands"]:
        return f"{first} {change}: then it stands and needs {_need_words(best['share'])}."
    return (
        f"{first} No single brick is enough. The best change is: {change[0].lower()}{change[1:]}."
    )


def _needs(share: float, falls: bool) -> str:
    """Return how much of the strength of the studs an assembly needs, in words."""
    if share == 0.0:
        return "its studs need not pull"
    return f"its studs {'would need' if falls else 'need'} {_percent(share)} of their strength"


def _need_words(share: float) -> str:
    return _percent(share) if share else "no pull of its studs"


def _change_words(change: Answer) -> str:
    """Return a proposed change of the assembly as an instruction to the user."""
    a, b = change["cells"]
    x, y, _ = change["corner"]
    place = f"in layer {number(change['layer'], 4)} at cell ({x}, {y})"
    if change["what"] == "remove":
        return f"Remove {plain(change['name'])} {place}"
    return f"Add a brick of {a} x {b} {place}"


def _percent(share: float) -> str:
    """Return a fraction in percent, with enough digits to distinguish it from 100 %."""
    return f"{number(100 * share, 4 if abs(share - 1) > NEAR else 7)} %"


def change_cells(change: Answer) -> Sequence[str]:
    """Return the table cells of a change, in the order of `HEAD`."""
    a, b = change["cells"]
    x, y, _ = change["corner"]
    brick = plain(change["name"]) if change["what"] == "remove" else f"{a} x {b}"
    share = "no strength is enough" if change["share"] is None else _percent(change["share"])
    return VERBS[change["what"]], brick, f"({x}, {y})", number(change["layer"], 4), share


def improve_facts(answer: Answer) -> list[tuple[str, str]]:
    """Return the lines below the sentence of `kilter improve`, each a term and its words."""
    rows = [("bricks", str(answer["bricks"]))]
    if answer["weakest"] is not None:
        first, second = answer["weakest"]
        rows.append(("weakest", f"the studs between {plain(first)} and {plain(second)}"))
    return rows
