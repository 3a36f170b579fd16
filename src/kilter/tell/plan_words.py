"""The answer of `kilter plan` in words: its sentence, its facts, its steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, number, vector

__all__ = ["order_facts", "order_sentence", "step_cells"]

Answer = Mapping[str, Any]


def order_sentence(answer: Answer) -> str:
    """Return a sentence or two about an assembly sequence (`kilter plan`)."""
    fewer = _without_holds(answer)
    if answer["found"] and not answer["steps"]:
        return "Every part is held, so that no step is needed."
    if answer["found"]:
        held = answer["held_steps"]
        words = "with nothing held"
        if held:
            most = count(answer["holds_max"], "part")
            words = f"with at most {most} held at once (in {count(held, 'step')})"
        if answer["turns"]:
            times = {1: "once", 2: "twice"}.get(answer["turns"], f"{answer['turns']} times")
            words += f", turned {times}"
        given = "in this order, " if answer["given"] else ""
        steps = count(len(answer["steps"]), "step")
        first = f"It can be put together {given}in {steps}, {words}."
        return " ".join(filter(None, [first, fewer, _least(answer), _finished_sentence(answer)]))
    if answer["verdict"] == "undecided":
        return (
            "No order was found, because it is undecided whether the finished assembly holds"
            f"{_open(answer)}."
        )
    if answer["verdict"] == "impossible":
        return fewer
    if answer["given"]:
        return _failing(answer)
    why = "the effort limit was reached"
    if answer["search"]["exhausted"]:
        why = "all tried directions are exhausted"
    elif answer["interrupted"]:
        why = "the search was interrupted"
    elif answer["time_limit"] is not None:
        why = "the time limit was reached"
    most = count(answer["search"]["hold"], "part")
    first = (
        f"No order was found with up to {most} held: {why}. This does not prove that none exists."
    )
    return f"{first} {fewer}" if fewer else first


def _finished_sentence(answer: Answer) -> str:
    """Return a sentence if the finished assembly only balances; else an empty text."""
    if answer["finished"]["verdict"] != "balanced":
        return ""
    return "The finished assembly is balanced: the slightest push makes it fall."


def _open(answer: Answer) -> str:
    """Return the undecided (open) pairs of an answer in words."""
    pairs = [" and ".join(pair["parts"]) for pair in answer["open_pairs"]]
    return f"; open pairs: {some_names(pairs)}" if pairs else ""


def _failing(answer: Answer) -> str:
    """Return the sentence about a given order that fails: its first failing step, and the rest."""
    failing = [(k, step) for k, step in enumerate(answer["steps"], 1) if step["fails"]]
    number, step = failing[0]
    why = "; ".join(step["fails"])
    more = f" {count(len(failing) - 1, 'further step')} fail." if len(failing) > 1 else ""
    outcome = "fails" if answer["verdict"] == "fails" else "was not confirmed"
    return f"This order {outcome} at step {number}, {some_names(step['parts'])}: {why}.{more}"


def _least(answer: Answer) -> str:
    """Return whether the quantity that a plan minimises is proved to be least.

    The text is empty if the quantity is zero, or if the first sentences state its proof already.
    """
    fewest, most = answer["fewest"], answer["holds_max"]
    stated = fewest["what"] == "holds" and most == 1 and answer["impossible"]
    if answer["given"] or stated or not (answer["turns"] if fewest["what"] == "turns" else most):
        return ""
    allowed = answer["search"]["hold"]
    held = f"up to {count(allowed, 'part')}" if allowed else "nothing"
    quantity = {
        "holds": "parts held at once",
        "held-steps": "steps with held parts",
        "turns": f"turns with {held} held",
    }[fewest["what"]]
    return {
        "always": f"It is proved that no order has fewer {quantity}.",
        "as-tried": f"Along the directions that were tried no order has fewer {quantity}.",
        None: f"Whether an order has fewer {quantity} was not determined.",
    }[fewest["least"]]


def _without_holds(answer: Answer) -> str:
    """Return the sentence that no order of assembly exists, or none without further held parts."""
    impossible = answer["impossible"]
    if impossible is None:
        return ""
    names = some_names(impossible["parts"])
    if impossible["kind"] == "falls":
        where = ""
        if answer["assumes"]["carried"] is not None:
            where = " at rest or at a required acceleration of its carrier"
        return f"No order exists, because the finished assembly falls{where}: {names} would move."
    if impossible["kind"] == "locking":
        first = "It is proved that no order exists, whatever the paths and whatever is held:"
        if len(impossible["parts"]) > 1:
            return f"{first} of {names} none can move before another of them has left."
        return f"{first} {names} cannot move."
    if impossible["kind"] == "exhaustion":
        most = impossible["holds"]
        held = f"up to {count(most, 'part')}" if most else "nothing"
        return (
            f"It is proved that with {held} held no order exists, whatever the paths: at some step "
            f"{names} would move."
        )
    subject = "it" if len(impossible["parts"]) == 1 else "they"
    return (
        "It is proved that with nothing held no order exists, whatever the paths: "
        f"{names} would fall from the parts on which {subject} can be put."
    )


def order_facts(answer: Answer) -> list[tuple[str, str]]:
    """Return the lines below the sentence of `kilter plan`, each a term and its words."""
    search, assumes = answer["search"], answer["assumes"]
    tried = ", ".join(
        word if isinstance(word, str) else vector(word) for word in assumes["directions"]
    )
    rows = [("base", some_names(answer["base"]))]
    if answer["level"] is not None:
        words = f"{answer['level']}: the lowest level of the steps and of the finished assembly"
        finished = answer["finished"]["level"]
        if any(step["level"] != finished for step in answer["steps"]):
            words += f" ({finished})"
        if answer["found"] and not answer["holds"]:
            words += f" (required: {answer['require']})"
        rows.append(("level", words))
    if answer["best"]:
        rows.append(("best so far", f"these can be put in last: {some_names(answer['best'], 8)}"))
    if assumes["carried"] is not None:
        rows.append(("carried", _carried(assumes["carried"])))
    rows.append(("directions", tried))
    if assumes["screws"]:
        rows.append(("screws", some_names([" in ".join(pair) for pair in assumes["screws"]], 4)))
    sizes = ", ".join(count(search[f"{word}s"], word) for word in ("state", "program", "sweep"))
    return [*rows, ("search", sizes)]


def _carried(acceleration: float | Sequence[float]) -> str:
    """Return the acceleration that every state of a plan carries, in words.

    Examples
    --------
    >>> _carried(3.0), _carried([3.0, 0, 0])
    ('3 m/s^2 in every horizontal direction', '(3, 0, 0) m/s^2')
    """
    if isinstance(acceleration, Sequence):
        return f"{vector(acceleration)} m/s^2"
    return f"{number(acceleration)} m/s^2 in every horizontal direction"


def step_cells(step: Answer) -> tuple[str, str, str, str]:
    """Return the table cells of a plan step: direction, held and released parts, level."""
    held = f"hold {some_names(step['held'])}" if step["held"] else ""
    freed = f"release {some_names(step['releases'])}" if step["releases"] else ""
    along = "" if step["direction"] is None else f"along {vector(step['direction'], 3)}"
    return along, held, freed, "; ".join(step["fails"]) or step["level"]
