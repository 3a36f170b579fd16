"""Facts of the answer of transport: accelerations, motions of a question, speed of a path."""

from __future__ import annotations

from collections.abc import Sequence

from kilter.errors import some
from kilter.tell.check_facts import Answer, Fact, joint_facts
from kilter.tell.numbers import COMPUTED, number, plain, vector

UNKNOWN = {
    "failed": "not known: the solver failed",
    "time": "not known: the time limit was reached",
    "none": "none is carried",
}
"""Words of a limit without a value."""
SAME_A0 = 1 - 1e-6
"""Share of a spectral acceleration above which a second one is not named [-]."""
NAMED = 2
"""Largest number of parts whose first motion is described."""


def transport_sentence(answer: Answer) -> str:
    """Return the sentence about an assembly on a moving carrier (`kilter transport`)."""
    if answer["cases"]:
        return _case_sentence(answer)
    if answer["speed"] is not None or "path" in answer["missing"]:
        return _path_sentence(answer)
    if answer["verdict"] == "unstable":
        return "It falls at rest already, so it carries no acceleration."
    least = least_limit(answer)
    if least is None:
        why = UNKNOWN[answer["missing"].get("least", "failed")]
        return f"The least horizontal acceleration is {why}."
    opened = "If its open pairs carry no force, it" if answer["open_pairs"] else "It"
    if least["g"] is None:
        return f"{opened} carries every horizontal acceleration up to 100 g."
    verb = "is proved to hold" if answer["level"] == "proved" else "can hold"
    size = f"{number(least['g'])} g ({number(least['upper'])} m/s^2)"
    return (
        f"{opened} {verb} under every horizontal acceleration of its carrier up to {size}; the "
        f"weakest direction is {_axis(least['direction'])}."
    )


def least_limit(answer: Answer) -> Answer | None:
    """Return the limit of the weakest horizontal direction; None if it is not known."""
    return next((limit for limit in answer["limits"] if limit["least"]), None)


def transport_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of `kilter transport`, each a term and its words."""
    facts = joint_facts(answer)
    if answer["mu_range"] is not None:
        low, high = (number(end) for end in answer["mu_range"])
        facts.append(("worst case", f"friction of {low} to {high} times each mu; limits at {low}"))
    first = least_limit(answer)
    if first is not None and first["motion"]:
        facts.append(("first", motions(first["motion"])))
    for limit in answer["limits"]:
        if not limit["least"]:
            facts.append((limit["name"], _limit(limit)))
    for entry in answer["alpha"]:
        facts.append((f"alpha0 {entry['name']}", _collapse(entry, answer["fc"])))
    for name, why in answer["missing"].items():
        facts.append((name, UNKNOWN[why]))
    for case in answer["cases"]:
        facts.append((case["name"], _case(case)))
    path = answer["speed"]
    if path is not None:
        facts += _path(path)
    if answer["limits"] and answer["level"] == "equilibrium":
        facts.append(("level", "forces that hold it exist up to each limit, and none beyond it"))
    return facts


def motions(first: Sequence[Answer]) -> str:
    """Return how the first few parts start to move, in words.

    Examples
    --------
    >>> motions([{"part": "box", "words": "slides +x"}])
    'box slides +x'
    """
    phrases = [f"{plain(entry['part'])} {entry['words']}" for entry in first[:NAMED]]
    more = len(first) - len(phrases)
    return ", ".join(phrases) + (f" and {more} more" if more else "")


def _limit(limit: Answer) -> str:
    """Return the largest safe acceleration along an axis, in words."""
    if limit["g"] is None:
        return "unlimited (100 g were tried)"
    words = f"{number(limit['g'])} g ({number(limit['upper'])} m/s^2)"
    return f"{words}; then {motions(limit['motion'])}" if limit["motion"] else words


def _collapse(entry: Answer, fc: float) -> str:
    """Return a collapse multiplier with its participating mass, in words."""
    if entry["alpha0"] is None:
        return "unlimited (100 was tried)"
    if entry["a0"] is None:
        return f"{number(entry['alpha0'])}; its mechanism is not known"
    words = f"{number(entry['alpha0'])}, M* {number(entry['participating_mass'])} kg"
    words += "" if entry["unique"] else f" (not unique: the largest that was {COMPUTED})"
    words += f", e* {number(entry['e'])}, a0* {number(entry['a0'])} m/s^2 at FC {number(fc)}"
    if entry["a0_moving"] < SAME_A0 * entry["a0"]:
        words += f" ({number(entry['a0_moving'])} m/s^2 with the mass of moving parts alone)"
    return words


def _case(case: Answer) -> str:
    """Return a motion of the carrier that the user gave, in words."""
    words = f"{number(case['g'])} g, {case['verdict'].replace('-', ' ')}"
    if any(case["angular_velocity"]) or any(case["angular_acceleration"]):
        words = case["verdict"].replace("-", " ")
    level = case["level"]
    words += "" if level is None else f", level {level}"
    factor = case["factor"]
    if factor is None:
        return words
    start = f"; then {motions(case['motion'])}" if case["motion"] else ""
    return f"{words}; forces that hold it exist up to {number(factor)} times this motion{start}"


def _case_sentence(answer: Answer) -> str:
    """Return whether the parts stay in place under the given accelerations, in a sentence."""
    about = "the accelerations of " + answer["code"] if answer["code"] else "this acceleration"
    rigid = "In rigid statics under" if answer["code"] else "Under"
    if answer["carried"]:
        return f"Carried: {rigid.lower()} {about} it holds, level {answer['level']}."
    falls = [case for case in answer["cases"] if case["verdict"] == "unstable"]
    if falls:
        names = some([case["name"] for case in falls]) if answer["code"] else ""
        where = f" ({names})" if names else ""
        moving = motions(falls[0]["motion"])
        start = f": {moving}" if moving else ""
        return f"Not carried: no forces can hold it {rigid.lower()} {about}{where}{start}."
    if answer["carried"] is None:
        why = "open pairs decide it" if answer["open_pairs"] else "a limit of the work was reached"
        return f"Undecided for {about}: {why}."
    return (
        f"Forces that hold it exist under {about}, but it reaches only the level "
        f"{answer['level']}, not {answer['require']}."
    )


def _path_sentence(answer: Answer) -> str:
    """Return by which factor the speed along a path may change, in words."""
    path = answer["speed"]
    if path is None:
        why = answer["missing"]["path"]
        if why == "none":
            return "At a pose of the path a part moves even at rest, so it moves at every speed."
        return f"The speed of the path is {UNKNOWN[why]}."
    if path["factor"] is None:
        return f"The path is carried at every speed up to 100 times as fast ({COMPUTED})."
    where = "" if path["between_samples"] else " at its samples"
    factor = number(path["factor"])
    carried = "Carried" if answer["carried"] else "Not carried"
    return (
        f"{carried}: the path may run {factor} times as fast{where} ({COMPUTED}); faster, a part "
        f"moves first at {number(path['time'])} s."
    )


def _path(path: Answer) -> list[Fact]:
    """Return the lines about a path of the carrier, each a term and its words."""
    facts = [("samples", f"{path['samples']} in {number(path['duration'])} s")]
    if path["moves"]:
        facts.append(("first", f"{some([plain(name) for name in path['moves']])} moves"))
    if path["slowest"] > 0:
        facts.append(
            (
                "least",
                f"{number(path['slowest'])} times as fast; if slower, a part slides down",
            )
        )
    return facts


def _axis(direction: Sequence[float]) -> str:
    """Return the name of a frame axis along a direction, else the direction itself.

    Examples
    --------
    >>> _axis([-1.0, 0, 0]), _axis([0.6, 0.8, 0])
    ('-x', '(0.6, 0.8, 0)')
    """
    for name, value in zip("xyz", direction, strict=True):
        if abs(value) > 1 - 1e-9:
            return f"{'+' if value > 0 else '-'}{name}"
    return vector(direction)
