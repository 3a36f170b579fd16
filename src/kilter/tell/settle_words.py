"""The answer of `kilter settle` in words: its sentence, its facts and its table."""

from __future__ import annotations

from kilter.errors import some_names
from kilter.tell.numbers import NO_ANGLE, count, number, plain
from kilter.tell.shared_facts import Answer, Fact

__all__ = ["moved_cells", "moved_head", "moved_words", "settle_facts", "settle_sentence"]

SHOWN = 3
"""Largest number of parts that a sentence names."""


def moved_words(answer: Answer) -> str:
    """Return the largest movement as words, such as ".41 mm and .0057 deg"."""
    distance = max((entry["distance"] for entry in answer["moved"]), default=0.0)
    angle = max((entry["angle_deg"] for entry in answer["moved"]), default=0.0)
    words = f"{number(distance, 3)} {answer['units']}"
    return f"{words} and {number(angle, 3)} deg" if angle > NO_ANGLE else words


def settle_sentence(answer: Answer) -> str:
    """Return the sentence about the pose at rest.

    Examples
    --------
    >>> moved = [{"part": "a", "distance": 0.41, "angle_deg": 0.0}]
    >>> answer = {"state": "at-rest", "level": "settles", "moved": moved, "units": "mm", "why": ""}
    >>> settle_sentence(answer | {"parts": []})
    'At rest after moving 0.41 mm: level settles.'
    >>> settle_sentence(answer | {"state": "falls", "parts": ["a"]})
    "The assembly falls: no forces balance 'a' at the points within reach."
    """
    names = some_names(answer["parts"], SHOWN)
    if answer["state"] == "at-rest":
        if not answer["moved"]:
            return f"At rest as drawn: level {answer['level']}."
        return f"At rest after moving {moved_words(answer)}: level {answer['level']}."
    if answer["state"] == "falls":
        points = answer["why"].partition(" at the points ")[2] or "within reach"
        return f"The assembly falls: no forces balance {names} at the points {points}."
    if answer["state"] == "does-not-fit":
        depth = f"{number(answer['depth'], 3)} {answer['units']}"
        return f"The parts do not fit: small motions leave {names} overlapping by {depth}."
    return f"No pose at rest was found: {answer['why']}."


def settle_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence, each a term and its words."""
    units = answer["units"]
    facts: list[Fact] = []
    if answer["state"] == "at-rest":
        facts.append(("moved", f"{count(len(answer['moved']), 'part')}, reach "
                      f"{number(answer['reach'], 3)} {units}"))  # fmt: skip
        facts.append(
            (
                "closed",
                f"gaps up to {number(answer['widest_gap'], 3)} {units} at the carrying points, "
                f"deepest overlap {number(answer['deepest_overlap'], 3)} {units}",
            )
        )
        facts.append(("carries", count(len(answer["carries"]), "pair") + " of parts touch"))
        rest = f"{answer['before']} as drawn, {answer['after']} at rest"
        if answer["after_asked"] != answer["require"]:
            rest += f" (levels above {answer['after_asked']} were not asked)"
        facts.append(("verdict", rest))
        facts.append(("closed points", f"level {answer['closed_level']} on these alone"))
    else:
        facts.append(("reach", f"{number(answer['reach'], 3)} {units}"))
        facts.append(("verdict", f"{answer['before']} as drawn"))
        if answer["state"] == "falls":
            facts.append(("meaning", "this is no proof that the assembly falls"))
    if answer["dropped"]:
        facts.append(("dropped", f"{number(answer['dropped'], 3)} {units}"))
    facts.append(("rounds", str(answer["rounds"])))
    return facts


def moved_head(answer: Answer) -> list[str]:
    """Return the heads of the table of moved parts."""
    return ["part", f"moved [{answer['units']}]", "turned [deg]"]


def moved_cells(entry: Answer) -> list[str]:
    """Return the cells of a moved part: its name, its movement and its rotation."""
    angle = entry["angle_deg"] if entry["angle_deg"] > NO_ANGLE else 0.0
    return [plain(entry["part"]), number(entry["distance"], 3), number(angle, 3)]
