"""The answer of `kilter place` in words: its sentence and its facts."""

from __future__ import annotations

from kilter.tell.numbers import COMPUTED, count, near_zero, number
from kilter.tell.shared_facts import Answer, Fact

__all__ = ["place_facts", "place_sentence"]


def place_sentence(answer: Answer) -> str:
    """Return the sentence about the places of a part.

    Examples
    --------
    >>> answer = {"at": None, "best": None, "units": "m", "undecided": False}
    >>> place_sentence(answer)
    'There is no place at which the part stands.'
    >>> place_sentence(answer | {"undecided": True})
    'No place is proved to stand, but some places are open.'
    """
    at, units = answer["at"], answer["units"]
    if at is None:
        best = answer["best"]
        if best is None and answer["undecided"]:
            return "No place is proved to stand, but some places are open."
        if best is None:
            return "There is no place at which the part stands."
        x, y, height = (number(near_zero(best[key])) for key in ("x", "y", "height"))
        where = f"x {x}, y {y}, height {height}"
        return (
            f"The part stands best with its centre at {where} {units}: {number(best['margin'])} "
            f"{units} from the nearest place that is not proved to stand."
        )
    where = f"at x {number(at['x'])}, y {number(at['y'])} {units}"
    if at["verdict"] == "unstable":
        moving = ", ".join(repr(name) for name in at["moving"][:3])
        return f"The part does not stand {where}: {moving} would move."
    if at["verdict"] == "undecided":
        return f"It is undecided whether the part stands {where}."
    return f"The part stands {where}: {at['verdict']}."


def _limits(answer: Answer) -> str:
    """Return the limits of mass and centre for which the answer holds; empty if both are given.

    Examples
    --------
    >>> _limits({"mass": [5, 8], "center_within": 0.1})
    'every mass of 5 to 8 kg and every centre within 10 % of the middle'
    """
    low, high = answer["mass"]
    share = answer["center_within"]
    words = [f"every mass of {number(low)} to {number(high)} kg"] if low < high else []
    if share:
        words.append(f"every centre within {number(100 * share)} % of the middle")
    return " and ".join(words)


def place_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence about places, each a term and its words."""
    facts: list[Fact] = []
    at, units = answer["at"], answer["units"]
    if at is not None:
        facts.append(("height", f"{number(at['height'])} {units} (centre of the part)"))
        if at["unlimited"]:
            facts.append(("heaviest", f"any mass is carried there ({COMPUTED})"))
        elif at["heaviest"] is not None:
            heaviest = f"{number(at['heaviest'])} kg are" if at["heaviest"] else "no mass is"
            facts.append(("heaviest", f"{heaviest} carried there ({COMPUTED})"))
    limits = _limits(answer)
    if limits:
        facts.append(("part", limits))
    for level in reversed(answer["levels"]):
        area = f"{number(level['area'])} {units}^2 in {count(len(level['stands']), 'polygon')}"
        left = f"; open {number(level['open_strip'])} {units}^2" if level["open_strip"] else ""
        facts.append((f"height {number(level['height'])}", f"stands on {area}{left}"))
    if answer["level"] is not None:
        facts.append(("level", answer["level"]))
    return facts
