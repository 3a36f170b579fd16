"""The answer of `kilter why` in words: its sentence, its facts, and a line for each object."""

from __future__ import annotations

from kilter.errors import some, some_names
from kilter.tell.check_facts import Answer, Fact, gravity_phrase
from kilter.tell.numbers import Name, count, number, plain

WHY_HEAD = ("body", "state", "deepest contact [m]")
"""Heads of the table of bodies."""
SHOWN = 3
"""Largest number of bodies that a sentence names."""
SETTLED = 1e-6
"""Movement in a simulation that is no creep [m]."""
FAST = 1e-2
"""Speed above which a body that the contacts hold has not come to rest, and does not creep
[m/s]."""
BETTER = 0.5
"""Settings are named if a simulation moves less than this share of that of the model [-]."""


def why_sentence(answer: Answer) -> str:
    """Return the sentence about a state of an engine.

    Examples
    --------
    >>> answer = {"objects": [{"name": "a", "state": "holds", "speed": 0.0}], "state": "holds",
    ...           "factor": 38.06, "level": "proved", "require": "settles", "creep": []}
    >>> why_sentence(answer)
    'Holds with up to 38.06 times gravity (level proved): a motion is creep of soft contacts.'
    >>> why_sentence(answer | {"objects": []})
    'No body moves freely: all are held.'
    """
    objects, state = answer["objects"], answer["state"]
    if not objects:
        return "No body moves freely: all are held."
    mine = [entry for entry in objects if entry["state"] == state]
    names = some_names([entry["name"] for entry in mine], SHOWN)
    if state is None:
        return "Undecided: the numbers carry no proof of rest, and none of a motion."
    if state == "holds":
        return _holding_sentence(answer)
    if state == "falls":
        first = next((entry["motion"] for entry in mine if entry["motion"]), None)
        words = f"Falls: no forces at the engine's contacts balance {names}"
        if first is not None and len(mine) == 1:
            words += f", which {first}"
        return f"{words}."
    if state == "pushed-out":
        deepest = max(mine, key=lambda entry: float(entry["unexplained"]))
        return (
            f"Pushed out by {_metres(deepest['unexplained'])}: {plain(deepest['name'])} is "
            f"{_metres(deepest['depth'])} deep in {plain(deepest['other'])}, and its contact "
            "parameters explain "
            f"{_metres(max(deepest['depth'] - deepest['unexplained'], 0.0))} of it."
        )
    entry = mine[0]
    if len(mine) == 1 and entry["height"] is not None:
        return f"Floats: {names} is {_metres(entry['height'])} from {plain(entry['other'])}."
    verbs = ("Floats", "is") if len(mine) == 1 else ("Float", "are")
    return f"{verbs[0]}: {names} {verbs[1]} in contact with nothing that is held."


def _holding_sentence(answer: Answer) -> str:
    """Return the sentence about a state that holds, with the setting that reduces its creep."""
    factor = answer["factor"]
    share = "at any gravity" if factor is None else f"with up to {number(factor, 4)} times gravity"
    if factor is not None and factor < 1:
        share = "as given"
    words = f"Holds {share} (level {answer['level']}): a motion is creep of soft contacts."
    fastest = max(answer["objects"], key=lambda entry: float(entry["speed"]))
    if fastest["speed"] > FAST:
        at = f"{plain(fastest['name'])} still moves at {number(fastest['speed'], 3)} m/s"
        words = f"Holds {share} (level {answer['level']}), but {at}: it has not come to rest."
    if not answer["creep"]:
        return words
    own = answer["creep"][0]["distance"]
    seconds = number(answer["seconds_simulated"], 3)
    if own <= SETTLED:
        return f"{words} In {seconds} s of simulation from rest nothing moves."
    best = min(answer["creep"], key=lambda entry: float(entry["distance"]))
    moved = f"{words} In {seconds} s from rest it moves by {_metres(own)}"
    if best["distance"] > BETTER * own:
        return f"{moved}, and no tried setting of the solver halves this."
    return f"{moved}, with {best['setting']} by {_metres(best['distance'])}."


def _metres(length: float) -> str:
    """Return a length in words."""
    return f"{number(length, 3)} m"


def why_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence, each a term and its words."""
    facts: list[Fact] = []
    held = [plain(name) for name in answer["held_by_motors"]]
    if held:
        facts.append(("held", f"{some(held)}: bodies with motors"))
    for k, entry in enumerate(answer["presses"]):
        unit = "N" if entry["kind"] == "prismatic" else "N m"
        words = f"{plain(entry['name'])} with {number(abs(entry['force']), 4)} {unit} of its motor"
        facts.append(("" if k else "presses", words))
    facts.append(("contacts", f"{count(answer['contacts'], 'point')} of the engine"))
    for k, entry in enumerate(answer["creep"]):
        words = f"{entry['setting']}: {_metres(entry['distance'])}"
        if entry["name"] is not None and entry["distance"] > SETTLED:
            words += f" ({plain(entry['name'])})"
        facts.append(("" if k else "simulated", words))
    return [*facts, ("gravity", gravity_phrase(answer))]


def why_cells(entry: Answer) -> list[str]:
    """Return the cells of a body: its name, its state in words, and its deepest contact."""
    state = entry["state"] or "open"
    words = entry["motion"] or state
    if state == "falls":
        words = f"falls: {entry['motion']}"
    elif state == "floats" and entry["height"] is not None:
        words = f"floats, {_metres(entry['height'])} from {plain(entry['other'])}"
    elif state == "pushed-out":
        words = f"pushed out by {_metres(entry['unexplained'])}"
    deepest = ""
    if entry["depth"] is not None:
        deepest = f"{number(entry['depth'], 3)} in {plain(entry['other'])}"
    return [Name(entry["name"]), words, deepest]
