"""What a plan says: its sentence, its facts, its steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, vector

__all__ = ["order_facts", "order_sentence", "step_cells"]

Answer = Mapping[str, Any]


def order_sentence(answer: Answer) -> str:
    """A plan in a sentence or two.

    Parameters
    ----------
    answer : mapping
        Data of a plan; the sentence itself is not needed.
    """
    fewer = _without_holds(answer)
    if answer["found"]:
        held = answer["held_steps"]
        words = "with nothing held"
        if held:
            most = count(answer["holds_max"], "part")
            words = f"with at most {most} held at once, in {count(held, 'step')}"
        if answer["turns"]:
            times = {1: "once", 2: "twice"}.get(answer["turns"], f"{answer['turns']} times")
            words += f", turned {times}"
        given = "in this order, " if answer["given"] else ""
        steps = count(len(answer["steps"]), "step")
        first = f"It can be put together {given}in {steps}, {words}."
        return " ".join(filter(None, [first, fewer, _least(answer), _finished(answer)]))
    if answer["verdict"] == "undecided":
        return f"No order: whether the finished assembly holds is undecided{_open(answer)}."
    if answer["verdict"] == "impossible":
        return fewer
    if answer["given"]:
        return _failing(answer)
    why = "the effort was spent"
    if answer["search"]["exhausted"]:
        why = "none is left of the directions that were tried"
    elif answer["interrupted"]:
        why = "it was interrupted"
    elif answer["time_limit"] is not None:
        why = f"the time limit of {answer['time_limit']:g} s was met"
    most = count(answer["search"]["hold"], "part")
    first = f"No order was found with up to {most} held: {why}; that proves nothing."
    return f"{first} {fewer}" if fewer else first


def _finished(answer: Answer) -> str:
    """A sentence about the finished assembly, if it is only balanced."""
    if answer["finished"]["verdict"] != "balanced":
        return ""
    return "The finished assembly is balanced: the slightest push makes it fall."


def _open(answer: Answer) -> str:
    """The open pairs of an answer, in words."""
    pairs = [" and ".join(pair["parts"]) for pair in answer["open_pairs"]]
    return f"; open pairs: {some_names(pairs)}" if pairs else ""


def _failing(answer: Answer) -> str:
    """What fails in an order that was given: its first step that does, and how many more."""
    failing = [(k, step) for k, step in enumerate(answer["steps"], 1) if step["fails"]]
    number, step = failing[0]
    why = "; ".join(step["fails"])
    more = f" {count(len(failing) - 1, 'further step')} fail." if len(failing) > 1 else ""
    sure = "cannot be kept to" if answer["verdict"] == "fails" else "was not confirmed"
    return f"This order {sure}: step {number}, {some_names(step['parts'])}: {why}.{more}"


def _least(answer: Answer) -> str:
    """How surely nothing has less, where it is more than nothing and that is not said yet."""
    fewest, most = answer["fewest"], answer["holds_max"]
    said = fewest["what"] == "holds" and most == 1 and answer["impossible"]
    if answer["given"] or said or not (answer["turns"] if fewest["what"] == "turns" else most):
        return ""
    allowed = answer["search"]["hold"]
    held = f"up to {count(allowed, 'part')}" if allowed else "nothing"
    what = {
        "holds": "parts at once",
        "held-steps": "held steps",
        "turns": f"turns with {held} held",
    }[fewest["what"]]
    return {
        "always": f"No order has fewer {what}.",
        "as-tried": f"Along the ways that were tried no order has fewer {what}.",
        None: f"Whether fewer {what} are enough was not found out.",
    }[fewest["least"]]


def _without_holds(answer: Answer) -> str:
    impossible = answer["impossible"]
    if impossible is None:
        return ""
    if impossible["kind"] == "falls":
        return (
            "There is no order: the finished assembly does not hold by itself, "
            f"{some_names(impossible['parts'])} would move."
        )
    if impossible["kind"] == "locking":
        return (
            "There is no order, whatever the paths and whatever is held: of "
            f"{some_names(impossible['parts'])} none can move before another one has left."
            if len(impossible["parts"]) > 1
            else "There is no order, whatever the paths and whatever is held: "
            f"{some_names(impossible['parts'])} cannot move."
        )
    if impossible["kind"] == "exhaustion":
        most = impossible["holds"]
        held = f"up to {count(most, 'part')}" if most else "nothing"
        return (
            f"With {held} held there is no order, whatever the paths: each has a step that "
            f"needs more, else {some_names(impossible['parts'])} would move."
        )
    return (
        "With nothing held there is no order, whatever the paths: "
        f"{some_names(impossible['parts'])} cannot stand on what can be reached."
    )


def order_facts(answer: Answer) -> list[tuple[str, str]]:
    """Terms of a plan and what they are, in words."""
    search, assumes = answer["search"], answer["assumes"]
    tried = ", ".join(one if isinstance(one, str) else vector(one) for one in assumes["directions"])
    found = [("base", some_names(answer["base"]))]
    if answer["level"] is not None:
        words = answer["level"]
        if answer["found"] and not answer["holds"]:
            words += f" (asked for: {answer['require']})"
        found.append(("level", f"{words}: the lowest level of its states"))
    if answer["best"]:
        found.append(("best so far", f"these can come last: {some_names(answer['best'], 8)}"))
    found.append(("directions", tried))
    if assumes["screws"]:
        found.append(("screws", some_names([" in ".join(pair) for pair in assumes["screws"]], 4)))
    sizes = ", ".join(count(search[f"{one}s"], one) for one in ("state", "program", "sweep"))
    return [*found, ("search", sizes)]


def step_cells(step: Answer) -> tuple[str, str, str, str]:
    """Direction, held parts, what is gripped and let go, and the level of a step."""
    held = f"hold {some_names(step['held'])}" if step["held"] else ""
    freed = f"let go {some_names(step['releases'])}" if step["releases"] else ""
    along = "" if step["direction"] is None else f"along {vector(step['direction'], 3)}"
    return along, held, freed, "; ".join(step["fails"]) or step["level"]
