"""The answer of `kilter check-plan` in words: its sentence, facts and table of items."""

from __future__ import annotations

from kilter.tell.levels import holds
from kilter.tell.numbers import Name, count, number, plain
from kilter.tell.shared_facts import Answer, Fact

__all__ = ["PACKING_HEAD", "item_cells", "packing_facts", "packing_sentence"]

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
