"""The answer of `kilter scene` in words: its sentence, its facts, and a line for each object."""

from __future__ import annotations

from kilter.errors import some, some_names
from kilter.tell.check_facts import Answer, Fact, gravity_phrase
from kilter.tell.levels import holds
from kilter.tell.numbers import NO_ANGLE, Name, count, number, plain

SCENE_HEAD = ("object", "state")
"""Heads of the table of objects."""
ORDER = ("falls", "floats", "overlaps", "open", "at-rest", "held")
"""Order of the states in the table: faults first."""
GEOMETRY = {
    "collider": "the colliders",
    "visual": "the visual shapes (there are no colliders)",
    "as-drawn": "the shapes of the file",
}
"""Words for the geometry of parts."""


def object_words(entry: Answer, units: str) -> str:
    """Return the state of an object in words.

    Examples
    --------
    >>> entry = {"state": "floats", "gap": 0.11, "other": "ramekin", "if_held": []}
    >>> object_words(entry, "m")
    'floats by 0.11 m above ramekin'
    """
    state, other = entry["state"], entry.get("other")
    size = "" if entry.get("gap") is None else f"{number(abs(entry['gap']), 3)} {units}"
    name = "" if other is None else plain(other)
    if state == "at-rest":
        words = f"at rest, level {entry['level']}"
    elif state == "floats":
        words = f"floats by {size} above {name}"
    elif state == "overlaps":
        words = f"overlaps {name} by {size}"
        if entry.get("geometry") == "visual":
            words += " (its visual shape)"
    elif state == "falls":
        words = f"falls: {entry['motion']}" if entry.get("motion") else "falls"
    elif state == "open":
        words = "open"
        if entry.get("gap") is not None:
            words = f"open: {size} from {name}, which may touch or not"
        elif name:
            words = f"open: its contact with {name} is not determined"
    else:
        words = state
    if entry["if_held"]:
        names = some([plain(other) for other in entry["if_held"]], 3)
        stays = "stays" if len(entry["if_held"]) == 1 else "stay"
        words += f" (if {names} {stays} as drawn)"
    way = way_words(entry.get("way", ()), units)
    return f"{words}; {way}" if way else words


def scene_sentence(answer: Answer) -> str:
    """Return the sentence about a scene.

    Examples
    --------
    >>> at_rest = {"state": "at-rest", "level": "proved"}
    >>> scene_sentence({"objects": [at_rest] * 2, "require": "settles", "level": "proved"})
    'All 2 free objects are at rest (level proved).'
    >>> scene_sentence({"objects": [{"state": "floats"}], "require": "settles"})
    'The free object floats.'
    >>> scene_sentence({"objects": [at_rest], "require": "strict", "level": "proved"})
    'The free object is at rest, but below the required level strict.'
    """
    free = [entry for entry in answer["objects"] if entry["state"] != "held"]
    if not free:
        return "Every object is held."
    counts = {state: sum(entry["state"] == state for entry in free) for state in ORDER}
    verbs = {"floats": "float", "overlaps": "overlap", "falls": "fall"}
    faults = [
        f"{counts[state]} {state if counts[state] == 1 else verb}"
        for state, verb in verbs.items()
        if counts[state]
    ]
    if counts["open"]:
        faults.append(f"{counts['open']} {'is' if counts['open'] == 1 else 'are'} open")
    objects = count(len(free), "free object")
    if faults and len(free) == 1:
        return f"The free object {faults[0].removeprefix('1 ')}."
    if faults:
        at_rest = f"{counts['at-rest']} of {objects} {_are(counts['at-rest'])} at rest"
        return f"{at_rest}: {', '.join(faults)}."
    lower = sum(not holds(entry["level"], answer["require"]) for entry in free)
    if lower and len(free) == 1:
        return f"The free object is at rest, but below the required level {answer['require']}."
    if lower:
        return (
            f"All {objects} are at rest, but {lower} {'does' if lower == 1 else 'do'} not reach "
            f"the required level {answer['require']}."
        )
    moved = f", after moving at most {_farthest(answer)}" if answer.get("moved") else ""
    if len(free) == 1:
        return f"The free object is at rest (level {answer['level']}){moved}."
    return f"All {objects} are at rest (level {answer['level']}){moved}."


def states_sentence(answer: Answer) -> str:
    """Return the sentence about settled states.

    Examples
    --------
    >>> counts = {"at-rest": 3, "partly": 1}
    >>> states_sentence({"states": [{}] * 4, "counts": counts, "rests": 7, "free": 8})
    '3 of 4 states at rest (1 partly); 7 of 8 objects at rest.'
    """
    counts = answer["counts"]
    others = [f"{many} {word}" for word, many in counts.items() if word != "at-rest"]
    more = f" ({', '.join(others)})" if others else ""
    states = count(len(answer["states"]), "state")
    objects = count(answer["free"], "object")
    whole = counts.get("at-rest", 0)
    return f"{whole} of {states} at rest{more}; {answer['rests']} of {objects} at rest."


def _farthest(answer: Answer) -> str:
    """Return the largest movement of an object of a scene in words."""
    return f"{number(max(answer['moved'].values()), 3)} {answer['units']}"


def _are(many: int) -> str:
    return "is" if many == 1 else "are"


def scene_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of a scene, each a term and its words."""
    held = [plain(entry["name"]) for entry in answer["objects"] if entry["state"] == "held"]
    geometry = [
        f"{GEOMETRY[kind]} of {count(many, 'part')}" for kind, many in answer["geometry"].items()
    ]
    clusters = count(answer["clusters"], "cluster")
    moved: list[Fact] = []
    if answer["moved"]:
        far = _farthest(answer)
        moved = [("moved", f"{count(len(answer['moved']), 'object')} by up to {far}")]
    return [
        ("held", some(held) or "no part (joints to the ground)"),
        *moved,
        ("judged", f"{clusters} of touching objects, each by itself"),
        ("geometry", "; ".join(geometry)),
        ("gravity", gravity_phrase(answer)),
        ("friction", number(answer["friction"])),
    ]


def scene_order(objects: list[Answer]) -> list[Answer]:
    """Return the objects with faults first, each state in the order of the file."""
    return sorted(objects, key=lambda entry: ORDER.index(entry["state"]))


def object_cells(entry: Answer) -> list[str]:
    """Return the cells of an object: its name and its state in words."""
    return [Name(entry["name"]), str(entry["words"])]


# The answer of `kilter settle` in words: its sentence, its facts and its table.


SHOWN = 3
"""Largest number of parts that a sentence names."""


WAYS = {
    "pushed-out": "pushed out by",
    "fell": "fell",
    "tipped": "tipped",
    "slid": "slid",
    "rolled": "rolled",
}
"""Words for the kinds of movement."""
TURNS = ("tipped", "rolled")
"""Kinds of movement whose angle is stated instead of their length."""


def way_words(way: list[Answer], units: str) -> str:
    """Return the way of a part in words.

    Examples
    --------
    >>> way = [{"how": "fell", "distance": 0.1, "angle_deg": 0.0},
    ...        {"how": "tipped", "distance": 0.03, "angle_deg": 31.2},
    ...        {"how": "slid", "distance": 0.002, "angle_deg": 0.0}]
    >>> way_words(way, "m")
    'fell 0.1 m, tipped 31.2 deg, slid 0.002 m'
    """
    pieces = []
    for piece in way:
        turned = piece["how"] in TURNS and piece["angle_deg"] > NO_ANGLE
        length = f"{number(piece['distance'], 3)} {units}"
        size = f"{number(piece['angle_deg'], 3)} deg" if turned else length
        pieces.append(f"{WAYS[piece['how']]} {size}")
    return ", ".join(pieces)


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
    >>> answer = {"state": "at-rest", "level": "settles", "moved": moved, "units": "mm", "why": "",
    ...           "parts": [], "leaves": [], "nearest": False, "rests": 1, "depth": 0}
    >>> settle_sentence(answer)
    'At rest after moving at most 0.41 mm: level settles.'
    >>> settle_sentence(answer | {"state": "falls", "leaves": ["a"], "rests": 0})
    "'a' leaves the scene."
    >>> settle_sentence(answer | {"state": "partly", "leaves": ["a", "b"]})
    "1 part is at rest: level settles. 'a', 'b' leave the scene."
    >>> settle_sentence(answer | {"state": "falls", "parts": ["a"], "nearest": True})
    "The assembly falls: no forces balance 'a' at the points within reach."
    """
    names = some_names(answer["parts"], SHOWN)
    if answer["state"] == "at-rest":
        if not answer["moved"]:
            return f"At rest as drawn: level {answer['level']}."
        return f"At rest after moving at most {moved_words(answer)}: level {answer['level']}."
    if answer["state"] == "falls" and not answer["leaves"]:
        points = answer["why"].partition(" at the points ")[2] or "within reach"
        return f"The assembly falls: no forces balance {names} at the points {points}."
    words = _without_rest(answer)
    if answer["rests"]:
        words.insert(0, f"{count(answer['rests'], 'part')} {_are(answer['rests'])} at rest: level "
                        f"{answer['level']}.")  # fmt: skip
    return " ".join(words)


def leaving_words(answer: Answer) -> str:
    """Return a clause about the parts that leave the scene; empty if none does.

    Examples
    --------
    >>> leaving_words({"leaves": ["a", "b"]})
    "'a', 'b' leave the scene"
    """
    names = answer["leaves"]
    verb = "leaves" if len(names) == 1 else "leave"
    return f"{some_names(names, SHOWN)} {verb} the scene" if names else ""


def _without_rest(answer: Answer) -> list[str]:
    """Return a sentence about the parts that leave the scene, and about those without a pose."""
    leaving = leaving_words(answer)
    words = [f"{leaving}."] if leaving else []
    names = some_names(answer["parts"], SHOWN)
    if answer["depth"] and not answer["rests"]:
        depth = f"{number(answer['depth'], 3)} {answer['units']}"
        words.append(f"The parts do not fit: {names} overlap by {depth}.")
    elif answer["parts"] or not words:
        words.append(f"No pose at rest was found{' of ' + names if names else ''}: "
                     f"{answer['why']}.")  # fmt: skip
    return words


def settle_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence, each a term and its words."""
    units = answer["units"]
    facts: list[Fact] = []
    if answer["rests"]:
        facts.append(("moved", count(len(answer["moved"]), "part")))
        facts.append(
            (
                "closed",
                f"gaps up to {number(answer['widest_gap'], 3)} {units} at the carrying points, "
                f"deepest overlap {number(answer['deepest_overlap'], 3)} {units}",
            )
        )
        facts.append(("carries", count(len(answer["carries"]), "pair") + " of parts touch"))
        facts.append(("verdict", f"{answer['before']} as drawn, {answer['after']} at rest"))
        facts.append(("closed points", f"level {answer['closed_level']} on these alone"))
    else:
        facts.append(("verdict", f"{answer['before']} as drawn"))
        if answer["state"] == "falls" and answer["nearest"]:
            facts.append(("meaning", "this is no proof that the assembly falls"))
    if answer["reach"] is not None:
        facts.append(("reach", f"{number(answer['reach'], 3)} {units}"))
    facts.append(("rounds", str(answer["rounds"])))
    return facts


def moved_head(answer: Answer) -> list[str]:
    """Return the heads of the table of moved parts."""
    head = ["part", f"moved [{answer['units']}]", "turned [deg]"]
    return head if answer["nearest"] else [*head, "way"]


def moved_cells(answer: Answer, entry: Answer) -> list[str]:
    """Return the cells of a moved part: its name, its movement, its rotation and its way."""
    angle = entry["angle_deg"] if entry["angle_deg"] > NO_ANGLE else 0.0
    cells = [plain(entry["part"]), number(entry["distance"], 3), number(angle, 3)]
    if answer["nearest"]:
        return cells
    words = way_words(entry["way"], answer["units"])
    left = "leaves the scene" if entry["part"] in answer["leaves"] else ""
    return [*cells, "; ".join(filter(None, [words, left]))]
