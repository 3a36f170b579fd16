"""The answer of `kilter place` in words: its sentence and its facts."""

from __future__ import annotations

from kilter.tell.check_facts import Answer, Fact
from kilter.tell.levels import holds
from kilter.tell.numbers import COMPUTED, Name, count, near_zero, number, plain

# The answer of `kilter check-plan` in words: its sentence, facts and table of items.


PACKING_HEAD = ("item", "name", "verdict", "rests on")
"""Heads of the table of items."""


def packing_sentence(answer: Answer) -> str:
    """Return the sentence about a packing plan.

    Examples
    --------
    >>> packing_sentence({"first": None, "stands": True, "items": [{}, {}]})
    'The pile stands after each of its 2 items.'
    """
    items = answer["items"]
    over = answer.get("overload")
    if over is not None and (answer["first"] is None or over["after"] <= answer["first"]):
        return (
            f"Item {over['after']}, {_quoted(items[over['after'] - 1]['name'])}, overloads "
            f"{_quoted(over['item'])}: its top must carry {number(over['load'])} kg, and its limit "
            f"is {number(over['max_load'])} kg."
        )
    if answer["first"] is not None:
        item = items[answer["first"] - 1]
        return f"Item {answer['first']}, {_quoted(item['name'])}, falls: {answer['why']}."
    if answer["stands"]:
        return f"The pile stands after each of its {count(len(items), 'item')}."
    verdicts = [item["verdict"] for item in items]
    if "undecided" in verdicts:
        k = verdicts.index("undecided")
        return f"After item {k + 1}, {_quoted(items[k]['name'])}, the pile is undecided."
    k, item = next(
        (k, item) for k, item in enumerate(items, 1) if not holds(item["level"], answer["require"])
    )
    return (
        f"After item {k}, {_quoted(item['name'])}, the pile stands only at the level "
        f"{item['level']}; the level {answer['require']} is required."
    )


def packing_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of a packing plan, each a term and its words."""
    facts: list[Fact] = []
    if answer["order"]:
        facts.append(("order", answer["order"]))
    standing = sum(item["level"] is not None for item in answer["items"])
    facts.append(("stands", f"after {standing} of {count(len(answer['items']), 'item')}"))
    if answer["level"] is not None:
        facts.append(("level", answer["level"]))
    facts.append(("friction", number(answer["friction"])))
    for item in answer["items"]:
        if item["max_load"] is not None and item["top_load"] is not None:
            load, limit = number(item["top_load"]), number(item["max_load"])
            facts.append(
                (f"load on {plain(item['name'])}", f"at least {load} kg; its limit is {limit} kg")
            )
    walls = answer["walls"]
    if walls is not None:
        x, y = (number(size) for size in walls["inner_size"])
        inside = f"smooth walls around the pile, {x} x {y} {answer['units']} inside"
        facts.append(
            (
                "with walls",
                f"between {inside}, each item stands: the plan lacks these parts"
                if walls["stands"]
                else f"also between {inside}, item {walls['first']} falls",
            )
        )
        lean = "a pile in a roll container leans on its walls"
        facts.append(
            (
                "missing",
                f"the plan names no walls; if {lean}, give their size with --walls "
                "or their parts with --held",
            )
        )
    for entry in answer["carried"]:
        size = "up to 100 g" if entry["g"] is None else f"{number(entry['g'])} g"
        facts.append((f"carried {entry['direction']}", size))
    return facts


def item_cells(entry: tuple[int, Answer]) -> list[str]:
    """Return the cells of an item: its number, name, verdict and the parts on which it rests."""
    k, item = entry
    rests = ", ".join(
        f"{plain(part['part'])} {100 * part['share']:.0f} %" for part in item["support"]
    )
    return [str(k), Name(item["name"]), str(item["verdict"]), rests or "nothing"]


def _quoted(name: str) -> str:
    """Return a name in quotes, shortened for a sentence."""
    return f"'{plain(name)}'"


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
