"""The answer of second order in words: minimum, free, balanced or open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.tell.numbers import COMPUTED, number, plain

FRICTION = {
    None: "unless friction holds {them}",
    "open": "unless friction holds {them}",
    "holds": "but friction holds {them}",
    "falls": "with friction, too",
}
NAMED = 3
"""Largest number of parts that are named."""


def balanced_sentence(parts: Sequence[str], within: str = "", rolling: str | None = None) -> str:
    """Return the sentence of an assembly that balances but falls after the slightest push.

    Examples
    --------
    >>> balanced_sentence(["b"])[:60]
    'Balanced: it cannot start to move by itself, but the slighte'
    """
    them = "it" if len(parts) == 1 else "them"
    if rolling == "holds":
        return (
            f"Stable{within}: friction holds {_names(parts)} against small pushes. Without "
            f"friction the slightest push makes {them} fall."
        )
    falls = f"makes {_names(parts)} fall"
    friction = f"unless friction holds {them}"
    if rolling == "falls":
        friction = f"and friction cannot hold {them}, because no contact needs to slip"
    return (
        f"Balanced{within}: it cannot start to move by itself, but the slightest push {falls}, "
        f"{friction}."
    )


def push_open_sentence(parts: Sequence[str], why: str, within: str = "") -> str:
    """Return the sentence of an assembly that a small push may make roll, rock or swing on.

    Examples
    --------
    >>> push_open_sentence(["b"], "its forces are not unique")
    'Potentially stable: forces that hold it exist, but a small push may make b roll, rock or \
swing on: its forces are not unique.'
    """
    return (
        f"Potentially stable{within}: forces that hold it exist, but a small push may make "
        f"{_names(parts)} roll, rock or swing on: {why}."
    )


def second_order_words(answer: Mapping[str, Any]) -> str:
    """Return the second-order (curvature) result in words, with its rate or its reason.

    Examples
    --------
    >>> second_order_words({"state": "minimum", "free": 0, "rate": None})
    'a strict minimum of its energy: small pushes do not move it away'
    >>> second_order_words({"state": "free", "motion": {"b": []}})
    'neutral: without friction a push can move b, and no weight or load resists it'
    >>> second_order_words({"state": "balanced", "rate": 0.5, "motion": {"b": [], "c": []}})
    'balanced: the slightest push makes b and c fall, unless friction holds them; a deviation \
grows by a factor of 2.7 in 2 s or less (computed, not proved)'
    """
    state = answer["state"]
    if state == "minimum":
        more = []
        if answer["rate"]:
            more.append(f"it swings at {number(answer['rate'], 3)} rad/s or faster, {COMPUTED}")
        if answer["free"]:
            spins = "1 spin changes" if answer["free"] == 1 else f"{answer['free']} spins change"
            more.append(f"{spins} no energy")
        words = "a strict minimum of its energy: small pushes do not move it away"
        return f"{words} ({'; '.join(more)})" if more else words
    if state == "free":
        names = _names(list(answer["motion"]))
        return (
            f"neutral: without friction a push can move {names}, and no weight or load resists it"
        )
    if state == "balanced":
        rate = answer["rate"]
        grows = ""
        if rate:
            seconds = number(1 / rate, 3)
            grows = f"; a deviation grows by a factor of 2.7 in {seconds} s or less ({COMPUTED})"
        names = _names(list(answer["motion"]))
        them = "it" if len(answer["motion"]) == 1 else "them"
        friction = FRICTION[answer.get("rolling")].format(them=them)
        return f"balanced: the slightest push makes {names} fall, {friction}{grows}"
    return f"open: {answer.get('left_open') or answer['why']}"


def is_shown(answer: Mapping[str, Any] | None, require: str) -> bool:
    """Return whether the result of second order matters to the reader.

    Open motions along which only flat faces slide are not shown, unless level strict is required.

    Examples
    --------
    >>> is_shown({"state": "open", "bending": []}, "proved")
    False
    """
    if answer is None:
        return False
    return answer["state"] != "open" or bool(answer["bending"]) or require == "strict"


def _names(parts: Sequence[str]) -> str:
    """Return the first `NAMED` names, and how many names follow."""
    shown = [plain(name) for name in parts[:NAMED]]
    if len(parts) > NAMED:
        return f"{', '.join(shown)} and {len(parts) - NAMED} more"
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)
