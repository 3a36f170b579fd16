"""What a fixture says: its sentence, its facts, its supports."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, force, vector

__all__ = ["hold_facts", "hold_sentence", "support_cells"]

Answer = Mapping[str, Any]


def hold_sentence(answer: Answer) -> str:
    """A fixture in a sentence or two; the sentence itself is not needed."""
    least = answer["least"]
    candidates = count(answer["candidates"], "candidate")
    if answer["verdict"] == "held":
        return _held_sentence(answer, candidates)
    if answer["verdict"] == "impossible":
        if not answer["candidates"]:
            return "It falls, and there is no candidate that could hold it."
        every = "the one candidate is" if answer["candidates"] == 1 else f"all {candidates} are"
        return f"Not even {every} enough, that is proved: a motion is stopped by none."
    why = "the effort was spent"
    if answer["interrupted"]:
        why = "it was interrupted"
    elif answer["time_limit"] is not None:
        why = f"the time limit of {answer['time_limit']:g} s was met"
    elif answer["exhausted"] and answer["most"] is not None and least > answer["most"]:
        return (
            f"{least} or more supports are needed, that is proved; no more than "
            f"{answer['most']} were asked for."
        )
    elif answer["exhausted"]:
        why = "of some sets of supports it is undecided whether they hold it"
    return f"No supports were found: {why}. {least} or more are needed, that is proved."


def _held_sentence(answer: Answer, candidates: str) -> str:
    """The sentence if supports were found, at the required level or below it."""
    held, least = len(answer["supports"]), answer["least"]
    if answer["why"] == "balanced":
        return "Balanced with nothing held: the slightest push makes it fall."
    if not answer["holds"]:
        with_supports = f"with {count(held, 'support')}" if held else "with nothing held"
        return (
            f"Forces that hold it exist {with_supports} (level {answer['level']}); no set of "
            f"supports that was tried reaches the level {answer['require']}."
        )
    if not held:
        return "It holds by itself: nothing must be held."
    first = f"It holds with {count(held, 'support')} of {candidates} (level {answer['level']})"
    if answer["fewest"]:
        return f"{first}; fewer are not enough, that is proved."
    if least == 0 or answer["require"] != "equilibrium":
        return f"{first}. No smaller set that was tried reaches this level; that is not proved."
    return f"{first}; {least} or more are needed, that is proved."


def hold_facts(answer: Answer) -> list[tuple[str, str]]:
    """Terms of a fixture and what they are, in words."""
    found = [("level", answer["level"] or "none"), ("base", some_names(answer["base"]) or "none")]
    for k, motion in enumerate(answer["motions"]):
        by = some_names(motion["stopped_by"], 4) or "nothing"
        words = f"{some_names(motion['moving'], 3)} would move, stopped by {by}"
        found.append(("" if k else "because", words))
    sets = count(answer["judged"], "set")
    return [*found, ("search", f"{sets} of {count(answer['candidates'], 'candidate')}")]


def support_cells(support: Answer, units: str) -> tuple[str, str, str, str]:
    """Kind, part, place and force of a support."""
    place = "" if support["point"] is None else f"at {vector(support['point'])} {units}"
    if support["on"]:
        place += f", on {support['on']}"
    size = "" if support["force"] is None else force(math.hypot(*support["force"]))
    return support["kind"], support["part"], place, size
