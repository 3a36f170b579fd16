"""The next step to take after an answer, as a command."""

from __future__ import annotations

from dataclasses import dataclass

from kilter.tell.facts import kind_of
from kilter.tell.numbers import number
from kilter.tell.shared_facts import Answer

__all__ = ["NextStep", "next_step"]


@dataclass(frozen=True, slots=True)
class NextStep:
    """A command without its file and the options of reading, and what it tells."""

    words: tuple[str, ...]
    why: str


HOLD = NextStep(("hold",), "the least that must be held so that it stays")
MARGIN = NextStep(("margin",), "by how much it holds: tilt, friction, loads")
VIEW = NextStep(("view",), "the motion and the forces in space, in the browser")
CONTACTS = NextStep(("contacts",), "what touches, what came near, and why it does not count")
AFTER_CHECK = {
    "stable": MARGIN,
    "settles": MARGIN,
    "potentially-stable": VIEW,
    "balanced": VIEW,
    "unstable": HOLD,
    "undecided": CONTACTS,
}
FALL = NextStep(("view",), "how it falls where it is pushed, and the forces, in the browser")
BRICK = NextStep(
    ("improve",), "which brick to add or to take away; margin: how much stronger studs had to be"
)
STRONGER = NextStep(("margin",), "how much stronger its bonds would have to be, and which give way")
PLAN = NextStep(("plan",), "in which order it can be put together")
LOADS = NextStep(("margin", "--loads"), "what each brick still takes, and the push that it resists")
CHECK = NextStep(("check",), "whether it stays together under gravity")


def next_step(answer: Answer, name: str, *, bricks: bool = False) -> NextStep | None:
    """What to ask next; None where nothing follows.

    Parameters
    ----------
    answer : mapping
        The data of an answer.
    name : str
        What a file that is written is called, without its ending.
    bricks : bool
        Whether it is a model of bricks.

    Examples
    --------
    >>> next_step({"histogram": {}}, "wall").words
    ('check',)
    >>> next_step({"held_steps": 0, "found": True}, "wall").words
    ('plan', '-o', 'wall.html')
    """
    kind = kind_of(answer)
    if kind == "check":
        return _after_check(answer, bricks)
    if kind == "orient":
        down = tuple(number(c, 9) for c in answer["down"])
        turned = NextStep(("check", "--down", *down), "what is guaranteed as it is turned")
        return turned if answer["found"] else HOLD
    if kind == "region":
        widest = NextStep(("orient",), "of these the one with the widest margin")
        return HOLD if answer["kind"] == "none" else widest
    if kind == "margin":
        return NextStep(("report", "-o", f"{name}.html"), "all of it on one page that can be sent")
    if kind == "plan":
        shown = NextStep(("plan", "-o", f"{name}.html"), "a page that plays the steps")
        return shown if answer["found"] else None
    if kind == "improve":
        return None if answer["verdict"] == "unstable" else LOADS
    if kind == "hold":
        return PLAN if answer["verdict"] == "held" else None
    return CHECK if kind == "contacts" else None


def _after_check(answer: Answer, bricks: bool) -> NextStep:
    """What falls is mended, what only balances is looked at."""
    if answer["verdict"] == "unstable" and answer["bonds"]:
        return BRICK if bricks else STRONGER
    if answer["verdict"] == "balanced":
        return FALL
    return AFTER_CHECK[answer["verdict"]]
