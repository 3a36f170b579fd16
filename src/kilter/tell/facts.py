"""Facts of every kind of answer: pairs of a term and its words.

The terminal, notebooks and pages show these facts and no others. The functions read the data of
an answer (its `to_dict()`, which `--json` prints), not the objects that produced it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from kilter.errors import some
from kilter.tell.check_facts import (
    Answer,
    Fact,
    balance_phrase,
    check_facts,
    gravity_phrase,
    joint_facts,
    parts_phrase,
    touching_phrase,
)
from kilter.tell.margin_facts import margin_facts
from kilter.tell.numbers import number, plain, vector
from kilter.tell.place_words import packing_facts, place_facts
from kilter.tell.plan_words import hold_facts, order_facts
from kilter.tell.region_facts import orient_facts, region_facts
from kilter.tell.scene_words import scene_facts, settle_facts
from kilter.tell.transport_facts import transport_facts
from kilter.tell.why_words import why_facts

KIND_OF_KEY = {
    "creep": "why",
    "held_steps": "plan",
    "candidates": "hold",
    "kilter": "assembly",
    "rotation": "orient",
    "facets": "region",
    "tilt_deg": "margin",
    "alpha": "transport",
    "histogram": "contacts",
    "walls": "check-plan",
    "heaviest": "place",
    "objects": "scene",
    "closed_level": "settle",
    "reasons": "verify",
    "certificate": "check",
}
"""Keys that each occur in the answers of a single command, with this kind of answer."""


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
"""Terms that a terminal shows only with `--verbose`, by kind of answer."""


def kind_of(answer: Answer) -> str:
    """Return the kind of an answer: the name of its command, or "assembly" for an assembly file.

    Raises `ValueError` if no known kind of answer has these keys.

    Examples
    --------
    >>> kind_of({"histogram": {}})
    'contacts'
    """
    for key, kind in KIND_OF_KEY.items():
        if key in answer:
            return kind
    raise ValueError(f"this is no answer of kilter: its only keys are {', '.join(answer)}")


def facts(answer: Answer, *, brief: bool = False) -> list[Fact]:
    """Return the lines below an answer's sentence, each a term and its words.

    An empty term continues the term before it.

    Arguments: `answer`: data of an answer (`to_dict()`), or of an assembly
    (`kilter.files.to_dict`).

    Examples
    --------
    >>> facts({"kilter": 1, "units": "mm", "parts": [{"name": "a", "grounded": True}]})
    [('parts', '1, held: a'), ('units', 'mm')]
    """
    kind = kind_of(answer)
    details = DETAILS.get(kind, ()) if brief else ()
    rows, term = [], ""
    for name, words in _FACTS_OF_KIND[kind](answer):
        term = name or term
        if term not in details:
            rows.append((name, words))
    return rows


def _contacts_facts(answer: Answer) -> list[Fact]:
    tolerance = answer["tolerance"]
    gap = f"{number(tolerance['gap'], 3)} {answer['units']}"
    touching = touching_phrase(gap, tolerance["angle_deg"], tolerance["clearance"], answer["units"])
    return [("touching", touching), *joint_facts(answer)]


def _verify_facts(answer: Answer) -> list[Fact]:
    """Return why `kilter verify` rejected a proof, or the figures and options of a valid proof."""
    if answer["reasons"]:
        return [("" if k else "because", words) for k, words in enumerate(answer["reasons"])]
    figure = (
        balance_phrase(answer["residual"])
        if answer["residual"] is not None
        else f"a motion that gains {answer['power']:.4g} W at 1 m/s"
    )
    rows = [("proof", figure)]
    rows += [("" if k else "notes", words) for k, words in enumerate(answer["notes"])]
    held = [plain(name) for name in answer["held"]]
    rows.append(("held", some(held) or "joints to the ground"))
    rows.append(("gravity", gravity_phrase(answer)))
    if answer["options"]:
        options = ", ".join(_option(name, value) for name, value in answer["options"].items())
        rows.append(("read with", options))
    limits, unit = answer["tolerance"], answer["units"]
    gap = f"{limits['gap']:g} {unit}" if limits["gap"] else f"{limits['relative_gap']:g} of a part"
    degrees = math.degrees(limits["angle"])
    return [*rows, ("touching", touching_phrase(gap, degrees, limits.get("clearance"), unit))]


def _option(name: str, value: Any) -> str:
    """Return a reading option in words; the name alone if its value is `True`."""
    words = name.replace("_", "-")
    if name == "entries":
        sizes = {key: len(entry) for key, entry in value.items() if isinstance(entry, list | dict)}
        return ", ".join(f"{many} {key.replace('_', ' ')}" for key, many in sizes.items()) or words
    return words if value is True else f"{words} {value}"


def _assembly_facts(answer: Answer) -> list[Fact]:
    """Return the lines about an assembly file: parts, units, gravity and so on."""
    rows = [("parts", parts_phrase(answer["parts"])), ("units", answer.get("units", "m"))]
    if "gravity" in answer:
        rows.append(("gravity", f"{vector(answer['gravity'])} m/s^2"))
    if answer.get("friction"):
        friction = number(answer["friction"])
        rows.append(("friction", f"{friction} at contacts without a given coefficient"))
    rows += joint_facts(answer)
    for key in ("loads", "contacts"):
        if answer.get(key):
            rows.append((key, f"{len(answer[key])} given"))
    return rows


_FACTS_OF_KIND: dict[str, Callable[[Answer], list[Fact]]] = {
    "assembly": _assembly_facts,
    "check": check_facts,
    "check-plan": packing_facts,
    "contacts": _contacts_facts,
    "hold": hold_facts,
    "margin": margin_facts,
    "transport": transport_facts,
    "orient": orient_facts,
    "place": place_facts,
    "plan": order_facts,
    "region": region_facts,
    "scene": scene_facts,
    "settle": settle_facts,
    "verify": _verify_facts,
    "why": why_facts,
}
