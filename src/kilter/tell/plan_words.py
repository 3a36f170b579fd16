"""The answer of `kilter plan` in words: its sentence, its facts, its steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import some_names
from kilter.tell.numbers import count, force, number, plain, vector

# The answer of `kilter hold` (a fixture) in words: its sentence, its facts, its supports.


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
    size = ""
    if support["force"] is not None:
        size = f"least load {force(math.hypot(*support['force']))}"
        turned = 0.0 if support["torque"] is None else math.hypot(*support["torque"])
        size += f" and {force(turned)} m" if turned > 0.0 else ""
    return support["kind"], support["part"], place, size


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


# Facts of one step of a plan: path, touched parts, held parts with their reasons, level.


LEVELS = {
    "proved": "they cannot start to move, that is proved",
    "settles": "the friction that their own weight creates holds them",
    "equilibrium": "forces that hold them exist",
}
"""Meaning of a level for the standing parts."""
LISTED = 6
"""Largest number of names in a list."""
NO_SHARE = 1e-6
"""A force below this share of the weight of a part is shown as next to nothing [-]."""


def step_facts(step: Answer, hands: Sequence[Answer]) -> list[tuple[str, str]]:
    """Return the lines about a step of an assembly sequence, each a term and its words.

    Arguments: `hands`: held parts, each with ``part``, ``force`` [N] and ``torque`` [N m] or None,
    ``weight`` [N] and ``radius`` [m] of the part, ``least``: whether no smaller load suffices, and
    ``falls``: the parts that fall without this hand.
    """
    path = "no path was found"
    if step["direction"] is not None:
        path = f"along {vector(step['direction'], 3)}"
    pieces = len(step["path"]) - 1
    if pieces > 1:
        path += f", the last of {count(pieces, 'straight piece')}"
    if step["over"] is not None:
        path += f", over the thread of {some_names([step['over']])}"
    rows = [("comes in", path), ("touches", some_names(step["touches"], LISTED))]
    if step["rubs"]:
        rows.append(("slides along", some_names(step["rubs"], LISTED)))
    if step["grips"]:
        rows.append(("first grip", some_names(step["grips"], LISTED)))
    if step["releases"]:
        rows.append(("then release", some_names(step["releases"], LISTED)))
    rows += [(f"hold {some_names([hand['part']])}", hand_phrase(hand)) for hand in hands]
    if step["fails"]:
        return [*rows, ("fails", "; ".join(step["fails"]))]
    return [*rows, ("standing parts", f"{LEVELS[step['level']]} ({step['level']})")]


def hand_phrase(hand: Answer) -> str:
    """Return the force that a hand carries, and the parts that would move without the hand.

    Examples
    --------
    >>> hand_phrase({"force": None, "falls": ["b", "a"]})
    "without it 2 parts would move: 'b', 'a'"
    >>> load = {"force": 2.0, "torque": 1e-9, "weight": 1.0, "radius": 0.1}
    >>> hand_phrase({**load, "least": True, "falls": []})
    'its least load is 2 N'
    >>> hand_phrase({**load, "least": False, "falls": []})
    'it may carry 2 N'
    """
    phrases = []
    if hand["force"] is not None:
        small = NO_SHARE * hand["weight"]
        carried = force(hand["force"]) if hand["force"] > small else "next to nothing"
        if hand["torque"] > small * hand["radius"]:
            carried += f" and {force(hand['torque'])} m"
        phrases.append(f"{'its least load is' if hand['least'] else 'it may carry'} {carried}")
    falls = hand["falls"]
    if falls:
        move = count(len(falls), "part")
        phrases.append(f"without it {move} would move: {some_names(falls, LISTED)}")
    elif not phrases:
        phrases.append("the standing parts may not need it")
    return "; ".join(phrases)
