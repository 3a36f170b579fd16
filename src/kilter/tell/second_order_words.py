"""Second order in a mechanic's words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.tell.numbers import number, plain

__all__ = ["balanced_sentence", "second_order_words"]

NAMED = 3
"""Parts that are named; more are counted."""


def balanced_sentence(parts: Sequence[str], within: str = "") -> str:
    """The verdict on what is stable to first order and falls to second.

    Examples
    --------
    >>> balanced_sentence(["b"])[:60]
    'Balanced: it cannot start to move by itself, but the slighte'
    """
    return (
        f"Balanced{within}: it cannot start to move by itself, but the slightest push makes "
        f"{_names(parts)} fall, unless friction holds {'it' if len(parts) == 1 else 'them'}."
    )


def second_order_words(answer: Mapping[str, Any]) -> str:
    """What the answer of second order says.

    Examples
    --------
    >>> second_order_words({"state": "minimum", "free": 0, "rate": None})
    'a strict minimum of its energy: small pushes do not move it away'
    >>> second_order_words({"state": "free", "motion": {"b": []}})
    'neutral: b can move freely, at no cost'
    """
    state = answer["state"]
    if state == "minimum":
        more = []
        if answer["rate"]:
            more.append(f"it swings at {number(answer['rate'], 3)} rad/s or faster")
        if answer["free"]:
            spins = "1 spin costs" if answer["free"] == 1 else f"{answer['free']} spins cost"
            more.append(f"{spins} nothing")
        words = "a strict minimum of its energy: small pushes do not move it away"
        return f"{words} ({'; '.join(more)})" if more else words
    if state == "free":
        return f"neutral: {_names(list(answer['motion']))} can move freely, at no cost"
    if state == "balanced":
        rate = answer["rate"]
        grows = f"; it grows {number(rate, 3)} times e a second" if rate else ""
        names = _names(list(answer["motion"]))
        return f"balanced: the slightest push makes {names} fall, unless friction holds it{grows}"
    return f"open: {answer['why']}"


def _names(parts: Sequence[str]) -> str:
    shown = [plain(name) for name in parts[:NAMED]]
    if len(parts) > NAMED:
        return f"{', '.join(shown)} and {len(parts) - NAMED} more"
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)
