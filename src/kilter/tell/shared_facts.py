"""Facts that several kinds of answers share: parts, joints, gravity, tolerances, equilibrium."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some
from kilter.tell.numbers import number, plain, shortened, vector

__all__ = [
    "Answer",
    "Fact",
    "balance_phrase",
    "bond_words",
    "gravity_phrase",
    "instability_phrase",
    "joint_facts",
    "parts_phrase",
    "touching_phrase",
]

Answer = Mapping[str, Any]
Fact = tuple[str, str]


def parts_phrase(parts: Sequence[Answer]) -> str:
    """Return the number of parts and the names of the held parts."""
    held = [plain(part["name"]) for part in parts if part.get("grounded")]
    return f"{len(parts)}, held: {some(held) or 'none (joints to the ground)'}"


def gravity_phrase(answer: Answer) -> str:
    """Return the size and the direction of gravity."""
    size = math.hypot(*answer["gravity"])
    along = [component / size for component in answer["gravity"]]
    return f"{number(size)} m/s^2 along {vector(along)}"


def bond_words(share: float, fail: Sequence[Sequence[str]]) -> str:
    """Return the fraction of their strength that bonds need, and the bonds that fail first.

    Examples
    --------
    >>> bond_words(0.75, [("arm", "post")])
    '0.75 times their strength is needed; arm on post fails first'
    """
    if share == 0.0:
        return "no bond strength is needed: it holds without bonds"
    words = f"{number(share)} times their strength is needed"
    if not fail:
        return words
    names = some([f"{plain(a)} on {plain(b)}" for a, b in fail], 3)
    return f"{words}; {names} fail{'s' if len(fail) == 1 else ''} first"


def joint_facts(answer: Answer, *, listed: bool = False) -> list[Fact]:
    """Return a line for each kind of joint, with the number of such joints.

    `listed`: whether a table of the answer names the joints that options made.
    """
    facts: list[Fact] = []
    joints = [joint for joint in answer.get("joints", ()) if not (listed and joint.get("why"))]
    short = shortened(dict.fromkeys(name for joint in joints for name in joint["parts"]))
    for kind in dict.fromkeys(joint["kind"] for joint in joints):
        pairs = [
            " - ".join(short[name] for name in joint["parts"])
            for joint in joints
            if joint["kind"] == kind
        ]
        facts.append(("" if facts else "joints", f"{len(pairs)} {kind}: {some(pairs)}"))
    return facts


def touching_phrase(gap: str, degrees: float, clearance: float | None, unit: str) -> str:
    """Return the tolerances with which faces count as touching, in words."""
    words = f"gap up to {gap}, angle up to {number(degrees, 3)} deg"
    if clearance is None:
        return words
    return f"{words}, clearances up to {number(clearance, 3)} {unit} counted as closed"


def balance_phrase(residual: float) -> str:
    """Return the largest residual of the force balance of the parts, in words."""
    how = f"to {residual:.1e} of its weight" if residual else "exactly"
    return f"contact forces that balance every part {how}"


def instability_phrase(answer: Answer) -> str:
    """Return z, the optimum of the displacement program, and kappa, the rate of fall."""
    words = f"z = {number(answer['z'])} kg {answer['units']} (displacement program, gravity 1)"
    if answer["instability"] is not None:
        words += f", kappa = {number(answer['instability'])} (0 stable, 1 free fall)"
    return words
