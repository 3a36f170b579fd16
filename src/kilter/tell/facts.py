"""What an answer says beside its sentence: terms, and what they are in words.

Every voice says these and no others: the terminal, a notebook, the page. They are read from
the answer as data (its `to_dict()`, which `--json` prints), never from what made it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from kilter.errors import some
from kilter.tell.check_facts import check_facts
from kilter.tell.hold_words import hold_facts
from kilter.tell.improve_words import improve_facts
from kilter.tell.margin_facts import margin_facts
from kilter.tell.numbers import number, plain, vector
from kilter.tell.plan_words import order_facts
from kilter.tell.region_facts import orient_facts, region_facts
from kilter.tell.shared_facts import (
    Answer,
    Fact,
    balance_phrase,
    gravity_phrase,
    joint_facts,
    parts_phrase,
    touching_phrase,
)

__all__ = ["facts", "kind_of"]

TELLING = {
    "held_steps": "plan",
    "candidates": "hold",
    "tried": "improve",
    "kilter": "assembly",
    "rotation": "orient",
    "facets": "region",
    "tilt_deg": "margin",
    "histogram": "contacts",
    "reasons": "verify",
    "certificate": "check",
}
"""A key that only one kind of answer has; the first that is there tells the kind."""


DETAILS = {
    "check": (
        *("mass", "gravity", "contacts", "proof", "guarantee", "seated"),
        *("instability", "neutral", "seconds"),
    ),
    "orient": ("proof", "instability", "programs"),
    "region": ("programs",),
    "plan": ("directions", "search"),
    "hold": ("search",),
}
"""What an answer rests on; a terminal says it where it is asked for."""


def kind_of(answer: Answer) -> str:
    """Which answer it is, as the commands are called; or an assembly.

    Raises
    ------
    ValueError
        If it is none of them.

    Examples
    --------
    >>> kind_of({"histogram": {}})
    'contacts'
    """
    for key, kind in TELLING.items():
        if key in answer:
            return kind
    raise ValueError(f"no answer of kilter has only the keys {', '.join(answer)}")


def facts(answer: Answer, *, brief: bool = False) -> list[Fact]:
    """Terms of an answer and what they are, in words; an empty term goes on with the last.

    Parameters
    ----------
    answer : mapping
        The data of an answer (`to_dict()`), or of an assembly (`kilter.files.to_dict`).
    brief : bool
        Without those that the answer rests on (`DETAILS`).

    Examples
    --------
    >>> facts({"kilter": 1, "units": "mm", "parts": [{"name": "a", "grounded": True}]})
    [('parts', '1, held: a'), ('units', 'mm')]
    """
    kind = kind_of(answer)
    details = DETAILS.get(kind, ()) if brief else ()
    found, term = [], ""
    for name, words in _TELLERS[kind](answer):
        term = name or term
        if term not in details:
            found.append((name, words))
    return found


def _contacts(answer: Answer) -> list[Fact]:
    tolerance = answer["tolerance"]
    gap = f"{number(tolerance['gap'], 3)} {answer['units']}"
    touching = touching_phrase(gap, tolerance["angle_deg"], tolerance["clearance"], answer["units"])
    return [("touching", touching), *joint_facts(answer)]


def _verify(answer: Answer) -> list[Fact]:
    if not answer["holds"]:
        return [("" if k else "because", words) for k, words in enumerate(answer["reasons"])]
    figure = (
        balance_phrase(answer["residual"])
        if answer["residual"] is not None
        else f"a motion that gains {answer['power']:.4g} W at 1 m/s"
    )
    found = [("proof", figure)]
    found += [("" if k else "notes", words) for k, words in enumerate(answer["notes"])]
    held = [plain(name) for name in answer["held"]]
    found.append(("held", some(held) or "joints to the ground"))
    found.append(("gravity", gravity_phrase(answer)))
    if answer["options"]:
        found.append(("read with", ", ".join(_option(*one) for one in answer["options"].items())))
    limits, unit = answer["tolerance"], answer["units"]
    gap = f"{limits['gap']:g} {unit}" if limits["gap"] else f"{limits['relative_gap']:g} of a part"
    degrees = math.degrees(limits["angle"])
    return [*found, ("touching", touching_phrase(gap, degrees, limits.get("clearance"), unit))]


def _option(name: str, value: Any) -> str:
    """An option that a file was read with; `True` is its name alone."""
    words = name.replace("_", "-")
    return words if value is True else f"{words} {value}"


def _assembly(answer: Answer) -> list[Fact]:
    found = [("parts", parts_phrase(answer["parts"])), ("units", answer.get("units", "m"))]
    if "gravity" in answer:
        found.append(("gravity", f"{vector(answer['gravity'])} m/s^2"))
    if answer.get("friction"):
        found.append(("friction", f"{number(answer['friction'])} where none is given"))
    found += joint_facts(answer)
    for key in ("loads", "contacts"):
        if answer.get(key):
            found.append((key, f"{len(answer[key])} given"))
    return found


_TELLERS: dict[str, Callable[[Answer], list[Fact]]] = {
    "assembly": _assembly,
    "check": check_facts,
    "contacts": _contacts,
    "hold": hold_facts,
    "improve": improve_facts,
    "margin": margin_facts,
    "orient": orient_facts,
    "plan": order_facts,
    "region": region_facts,
    "verify": _verify,
}
