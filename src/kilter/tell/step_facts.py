"""What one step of a plan says: which way, what is touched, what is held and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, force, vector

__all__ = ["hand_phrase", "step_facts"]

Answer = Mapping[str, Any]
LEVELS = {
    "proved": "it cannot start to move, that is proved",
    "settles": "its own weight makes the friction that holds it",
    "equilibrium": "forces that hold it exist",
}
"""What a level says of what stands."""
LISTED = 6
"""Names of a list that are shown."""
NO_SHARE = 1e-6
"""A force below this part of the weight of a part is what rounding leaves of none [-]."""


def step_facts(step: Answer, hands: Sequence[Answer]) -> list[tuple[str, str]]:
    """Terms of a step and what they are, in words.

    Parameters
    ----------
    step : mapping
        An entry of `steps` of a plan.
    hands : sequence of mapping
        ``part``, ``force`` [N] and ``torque`` [N m] or None, ``weight`` [N] and ``radius`` [m] of
        the part, ``falls``.
    """
    way = "no way was found"
    if step["direction"] is not None:
        way = f"along {vector(step['direction'], 3)}"
    pieces = len(step["path"]) - 1
    if pieces > 1:
        way += f", the last of {count(pieces, 'straight piece')}"
    if step["over"] is not None:
        way += f", over the thread of {some_names([step['over']])}"
    found = [("comes in", way), ("touches", some_names(step["touches"], LISTED))]
    if step["rubs"]:
        found.append(("slides along", some_names(step["rubs"], LISTED)))
    if step["grips"]:
        found.append(("first grip", some_names(step["grips"], LISTED)))
    if step["releases"]:
        found.append(("then let go", some_names(step["releases"], LISTED)))
    found += [(f"hold {some_names([hand['part']])}", hand_phrase(hand)) for hand in hands]
    if step["fails"]:
        return [*found, ("fails", "; ".join(step["fails"]))]
    return [*found, ("what stands", f"{LEVELS[step['level']]} ({step['level']})")]


def hand_phrase(hand: Answer) -> str:
    """What a hand carries, and why it is needed.

    Examples
    --------
    >>> hand_phrase({"force": None, "falls": ["b", "a"]})
    "without it 2 parts would move: 'b', 'a'"
    >>> hand_phrase({"force": 2.0, "torque": 1e-9, "weight": 1.0, "radius": 0.1, "falls": []})
    'it may carry 2 N'
    """
    said = []
    if hand["force"] is not None:
        least = NO_SHARE * hand["weight"]
        carried = force(hand["force"]) if hand["force"] > least else "next to nothing"
        if hand["torque"] > least * hand["radius"]:
            carried += f" and {force(hand['torque'])} m"
        said.append(f"it may carry {carried}")
    falls = hand["falls"]
    if falls:
        move = count(len(falls), "part")
        said.append(f"without it {move} would move: {some_names(falls, LISTED)}")
    elif not said:
        said.append("what stands may hold without it")
    return "; ".join(said)
