"""The answer of `kilter hold` (a fixture) in words: its sentence, its facts, its supports."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, force, plain, vector

__all__ = ["hold_facts", "hold_sentence", "support_cells"]

Answer = Mapping[str, Any]


def hold_sentence(answer: Answer) -> str:
    """Return a sentence or two about supports that hold an assembly (`kilter hold`)."""
    least, noun = answer["least"], _noun(answer)
    candidates = count(answer["candidates"], "candidate")
    if answer["verdict"] == "held":
        return _held_sentence(answer, candidates)
    if answer["verdict"] == "impossible":
        if not answer["candidates"]:
            return "It falls, and no candidate support exists."
        every = "with its only candidate" if answer["candidates"] == 1 else f"with all {candidates}"
        if answer["code"]:
            return f"No set of {candidates} holds in {_directions(answer)}: that is proved."
        return f"It falls even {every} as {noun}s: it is proved that a motion remains free."
    proved = f"It is proved that at least {count(least, noun)} must be used"
    why = "the effort limit was reached"
    if answer["interrupted"]:
        why = "the search was interrupted"
    elif answer["time_limit"] is not None:
        why = "the time limit was reached"
    elif answer["exhausted"] and answer["most"] is not None and least > answer["most"]:
        return f"{proved}, but no more than {answer['most']} are allowed."
    elif answer["exhausted"]:
        why = f"for some sets of {noun}s it is undecided whether they hold it"
    return f"No sufficient {noun}s were found: {why}. {proved}."


def _noun(answer: Answer) -> str:
    """Return the noun of the candidates: support or strap."""
    return "support" if answer["straps"] is None else "strap"


def _directions(answer: Answer) -> str:
    """Return the words for the directions of the code."""
    return f"all {len(answer['cases'])} directions of {answer['code']}"


def _held_sentence(answer: Answer, candidates: str) -> str:
    """Return the sentence about supports that hold the assembly, at the required level or below."""
    noun, least = _noun(answer), answer["least"]
    held = len(answer["supports"] or answer["straps"] or ())
    if answer["why"] == "balanced":
        return "Balanced with nothing held: the slightest push makes it fall."
    if not answer["holds"]:
        with_supports = f"with {count(held, noun)}" if held else "with nothing held"
        where = f" in {_directions(answer)}" if answer["code"] else ""
        first = f"Forces that hold it exist {with_supports}{where} (level {answer['level']})"
        if noun == "strap":
            return f"{first}, and it is proved that fewer straps are not enough."
        if not answer["exhausted"]:
            return f"{first}. A higher level was not found within the {_limit(answer)}."
        return f"{first}; no set of {noun}s that was tried reaches the level {answer['require']}."
    where = f" in {_directions(answer)}" if answer["code"] else ""
    if not held:
        return f"It holds by itself{where}: nothing must be held."
    first = f"It holds with {count(held, noun)} of {candidates}{where} (level {answer['level']})"
    if answer["fewest"]:
        return f"{first}. It is proved that fewer {noun}s are not enough."
    if least == 0 or answer["require"] != "equilibrium":
        return f"{first}. No smaller set that was tried reaches this level, but this is no proof."
    return f"{first}. It is proved that at least {count(least, noun)} must be used."


def _limit(answer: Answer) -> str:
    """Return the limit that ended an incomplete search."""
    return "effort" if answer["time_limit"] is None else "time limit"


def hold_facts(answer: Answer) -> list[tuple[str, str]]:
    """Return the lines below the sentence of `kilter hold`, each a term and its words."""
    rows = [("level", answer["level"] or "none"), ("base", some_names(answer["base"]) or "none")]
    motions = answer["motions"]
    if answer["verdict"] == "impossible":  # a motion that a support stops is no reason
        motions = [motion for motion in motions if not motion["stopped_by"]]
    for k, motion in enumerate(motions):
        by = some_names(motion["stopped_by"], 4) or "no candidate"
        words = f"{some_names(motion['moving'], 3)} would move; stopped by {by}"
        rows.append(("" if k else "because", words))
    for case in answer["cases"]:
        along = vector(case["acceleration"])
        rows.append((case["name"], f"acceleration {along} m/s²: level {case['level'] or 'none'}"))
    for strap in answer["straps"] or ():
        rows.append((f"strap {strap['candidate']}", _strap_words(strap)))
    sets, candidates = count(answer["judged"], "set"), count(answer["candidates"], "candidate")
    return [*rows, ("search", f"{sets} of {_noun(answer)}s judged, {candidates}")]


def _strap_words(strap: Answer) -> str:
    """Return the parts of a chosen strap with its tension, or with its pull and capacity."""
    parts = " - ".join(plain(name) for name in strap["parts"])
    if strap["tension"] is not None:
        return f"{parts}, tension {force(strap['tension'])}"
    pull = "" if strap["pull"] is None else f", pull {force(strap['pull'])}"
    return f"{parts}{pull} of {force(strap['capacity'])}"


def support_cells(support: Answer, units: str) -> tuple[str, str, str, str]:
    """Return the table cells of a support: kind, part, place and force."""
    place = "" if support["point"] is None else f"at {vector(support['point'])} {units}"
    if support["on"]:
        place += f", on {support['on']}"
    size = "" if support["force"] is None else force(math.hypot(*support["force"]))
    return support["kind"], support["part"], place, size
