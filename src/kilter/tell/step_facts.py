"""Facts of one step of a plan: path, touched parts, held parts with their reasons, level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, force, vector

__all__ = ["hand_phrase", "step_facts"]

Answer = Mapping[str, Any]
LEVELS = {
    "proved": "they cannot start to move, that is proved",
    "settles": "the friction that their own weight creates holds them",
    "equilibrium": "forces that hold them exist",
}
"""Meaning of a level for the standing parts."""
LISTED = 6
"""Largest number of names in a list."""
NO_SHARE = 1e-6
"""A force below this share of the weight of a part is shown as next to nothing [-]."""


def step_facts(step: Answer, hands: Sequence[Answer]) -> list[tuple[str, str]]:
    """Return the lines about a step of an assembly sequence, each a term and its words.

    Arguments: `hands`: held parts, each with ``part``, ``force`` [N] and ``torque`` [N m] or None,
    ``weight`` [N] and ``radius`` [m] of the part, and ``falls``: the parts that fall without this
    hand.
    """
    path = "no path was found"
    if step["direction"] is not None:
        path = f"along {vector(step['direction'], 3)}"
    pieces = len(step["path"]) - 1
    if pieces > 1:
        path += f", the last of {count(pieces, 'straight piece')}"
    if step["over"] is not None:
        path += f", over the thread of {some_names([step['over']])}"
    rows = [("comes in", path), ("touches", some_names(step["touches"], LISTED))]
    if step["rubs"]:
        rows.append(("slides along", some_names(step["rubs"], LISTED)))
    if step["grips"]:
        rows.append(("first grip", some_names(step["grips"], LISTED)))
    if step["releases"]:
        rows.append(("then release", some_names(step["releases"], LISTED)))
    rows += [(f"hold {some_names([hand['part']])}", hand_phrase(hand)) for hand in hands]
    if step["fails"]:
        return [*rows, ("fails", "; ".join(step["fails"]))]
    return [*rows, ("standing parts", f"{LEVELS[step['level']]} ({step['level']})")]


def hand_phrase(hand: Answer) -> str:
    """Return the force that a hand may carry, and the parts that would move without the hand.

    Examples
    --------
    >>> hand_phrase({"force": None, "falls": ["b", "a"]})
    "without it 2 parts would move: 'b', 'a'"
    >>> hand_phrase({"force": 2.0, "torque": 1e-9, "weight": 1.0, "radius": 0.1, "falls": []})
    'it may carry 2 N'
    """
    phrases = []
    if hand["force"] is not None:
        least = NO_SHARE * hand["weight"]
        carried = force(hand["force"]) if hand["force"] > least else "next to nothing"
        if hand["torque"] > least * hand["radius"]:
            carried += f" and {force(hand['torque'])} m"
        phrases.append(f"it may carry {carried}")
    falls = hand["falls"]
    if falls:
        move = count(len(falls), "part")
        phrases.append(f"without it {move} would move: {some_names(falls, LISTED)}")
    elif not phrases:
        phrases.append("the standing parts may not need it")
    return "; ".join(phrases)
