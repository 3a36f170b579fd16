"""The next step to take after an answer, as a command."""

from __future__ import annotations

import re
from dataclasses import dataclass

from kilter.tell.check_facts import Answer
from kilter.tell.facts import kind_of
from kilter.tell.ladder_words import DRAWN, JOINED, ladder_step
from kilter.tell.margin_facts import moved_by_least
from kilter.tell.numbers import near_zero, number
from kilter.tell.open_words import MOVABLE


@dataclass(frozen=True, slots=True)
class NextStep:
    """A command that the user may run next, and its purpose."""

    words: tuple[str, ...]
    why: str


HOLD = NextStep(("hold",), "finds the fewest supports that hold it")
MARGIN = NextStep(
    ("margin",),
    "finds how far it may tilt, how little friction it needs and how much load it withstands",
)
ROUGH = NextStep(
    ("margin", "--friction", "0.3"), "finds the margins if its contacts have this friction"
)
VIEW = NextStep(("view",), "shows its motion and its contact forces in 3D in the browser")
CONTACTS = NextStep(
    ("contacts",), "lists contacts and near pairs, and why the near pairs do not touch"
)
AFTER_CHECK = {
    "stable": MARGIN,
    "settles": MARGIN,
    "potentially-stable": VIEW,
    "balanced": VIEW,
    "unstable": HOLD,
    "undecided": CONTACTS,
}
FALL = NextStep(("view",), "shows its fall after a push, and its contact forces, in the browser")
BRICK = NextStep(("margin", "--improve"), "finds a brick to add or to remove so that it stands")
STRONGER = NextStep(
    ("margin",), "finds the bond strength that it needs, and which bonds fail first"
)
PLAN = NextStep(("plan",), "finds an order in which it can be put together")
CARRIED = NextStep(
    ("transport", "--code", "en12195"), "decides whether it stays on a truck that brakes and turns"
)
ALONE = NextStep(
    ("check",),
    "decides whether the assembly stands without the part: if it falls, no place is left",
)
SETTLED = NextStep(
    ("scene", "--settle"), "brings floating and overlapping objects to rest, and proves it"
)
PLAYED = NextStep(
    ("check", "--assume", "play"), "decides it after its parts move within their play"
)
BODIES = NextStep(("contacts",), "lists its bodies: the parts that touch, and the loose parts")
SETTLE = NextStep(("settle",), "brings the parts to rest, or names those that leave or do not fit")
MENDED = ("floats", "overlaps", "falls")
"""States of objects that may come to rest elsewhere."""
FLOATS = ("touches nothing: ", "touch no other part: ")
"""Begin of the warnings about free parts, and about groups of them, that lie on nothing."""
CHECK = NextStep(
    ("check",),
    "decides whether it stays together under gravity; if nothing is held, add --ground NAME or "
    "--floor",
)


def next_step(
    answer: Answer, name: str, *, bricks: bool = False, straps: bool = False
) -> NextStep | None:
    """Return the command that is most useful after an answer; None if there is none.

    Examples
    --------
    >>> next_step({"histogram": {}}, "wall").words
    ('check',)
    >>> next_step({"held_steps": 0, "found": True}, "wall").words
    ('plan', '-o', 'wall.html')
    """
    kind = kind_of(answer)
    upward = _upward_axis(answer) if kind in ("check", "contacts") else None
    if upward is not None:
        return NextStep(("check", "--up", upward), f"decides it if {upward} points up in the file")
    if kind == "check":
        return _after_check(answer, bricks)
    if kind == "orient":
        down = tuple(number(round(c, 9), 9) for c in answer["down"])
        turned = NextStep(("check", "--down", *down), "decides whether it holds in this direction")
        return turned if answer["found"] else HOLD
    if kind == "region":
        widest = NextStep(("orient",), "finds the direction with the widest margin")
        return HOLD if answer["kind"] == "none" else widest
    if kind == "transport":
        if answer["verdict"] == "unstable":
            return HOLD
        asked = answer["cases"] or answer["speed"]
        return _held_against(answer, straps=straps) if asked else CARRIED
    if kind == "margin":
        if answer["level"] == "proved" and moved_by_least(answer):
            return ROUGH
        return NextStep(("report", "-o", f"{name}.html"), "writes all answers to an offline page")
    if kind == "plan":
        shown = NextStep(("plan", "-o", f"{name}.html"), "writes a page that plays the steps")
        return shown if answer["found"] else None
    if kind == "hold":
        if answer["verdict"] == "impossible" and not answer["base"]:
            code = ("--code", answer["code"]) if answer["code"] else ()
            return NextStep(("hold", *code, "--floor"), "puts a floor under it; nothing is held")
        return PLAN if answer["verdict"] == "held" and answer["straps"] is None else None
    if kind == "contacts":
        return CHECK
    if kind == "place" and answer["at"] is None:
        if answer["best"] is None:
            return ALONE
        place = (number(near_zero(answer["best"][axis])) for axis in "xy")
        return NextStep(("place", "--at", *place), "finds the level there, and the heaviest mass")
    if kind == "scene" and not answer["settled"]:
        faults = any(entry["state"] in MENDED for entry in answer["objects"])
        return SETTLED if faults else None
    return None


def _held_against(answer: Answer, *, straps: bool) -> NextStep | None:
    """The search for supports, or for straps, under the question that is not carried; else None.

    Only straps are searched for a rule, and beside straps of the assembly. A carrier that turns has
    no such command. Arguments: `straps`: whether the command names a file of straps.
    """
    failed = next((case for case in answer["cases"] if case["verdict"] == "unstable"), None)
    if failed is None:
        return None
    if answer["code"]:
        ahead = (f"{near_zero(x):.15g}" for x in answer["forward"])
        words: tuple[str, ...] = ("hold", "--code", answer["code"], "--forward", *ahead)
        holds = "that hold it in every direction"
    elif any(failed["angular_velocity"]) or any(failed["angular_acceleration"]):
        return None
    else:
        words = ("hold", "--accelerate", *(f"{near_zero(x):.15g}" for x in failed["acceleration"]))
        holds = "that hold it then"
    if straps:
        return NextStep(words, f"finds the fewest of these straps {holds}")
    if answer["code"] or answer["straps"]:
        listed = "of the list straps.json; 'kilter example straps.json' writes such a list"
        return NextStep(
            (*words, "--straps", "straps.json"), f"finds the fewest straps {holds}, {listed}"
        )
    return NextStep(words, f"finds the fewest supports, or straps of --straps, {holds}")


def _upward_axis(answer: Answer) -> str | None:
    """Return the axis that a warning proposes as the upward axis; None without such a warning."""
    found = (re.search(r"give --up (-?[xyz])", text) for text in answer.get("warnings", ()))
    return next((match[1] for match in found if match), None)


def _after_check(answer: Answer, bricks: bool) -> NextStep:
    """Return the next command after a check: a rung that holds, or a picture if it balances."""
    if answer["verdict"] == "unstable" and answer["bonds"]:
        return BRICK if bricks else STRONGER
    if answer["verdict"] == "balanced":
        return FALL
    step = ladder_step(answer["ladder"])
    if step is not None and answer["assume"] == DRAWN:
        options, when = step
        return NextStep(("check", *options), f"decides it {when}")
    rows = [row for row in answer["ladder"] if row["friction"] is None]
    later = [row["assume"] for row in rows if not row["decided"]]
    # a lower rung has fewer joints, so an assembly that falls with all joints falls there, too
    joined_falls = any(row["assume"] == JOINED and row["verdict"] == "unstable" for row in rows)
    if later and not joined_falls and answer["assume"] == DRAWN:
        asked = later[-1]  # fewer bodies are decided sooner
        return NextStep(("check", "--assume", asked), f"decides the row {asked}")
    if answer["ladder"] and answer["level"] is None:
        return BODIES
    moves = any(pair["kind"] in MOVABLE for pair in answer["open_pairs"])
    if moves and answer["level"] is None:
        return PLAYED if answer["assume"] == DRAWN else SETTLE
    if answer["verdict"] == "unstable" and any(w.startswith(FLOATS) for w in answer["warnings"]):
        return SETTLED
    return AFTER_CHECK[answer["verdict"]]
