"""Answers for agents in at most 4 kB, with the name of the resource that has the whole answer.

The most important keys are kept. Then the longest list is halved until the text is short enough;
`left_out` counts the removed entries. Times are left out, so equal questions have equal answers.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

from kilter.tell.scene_words import scene_order

LIMIT = 4000
"""Largest size of the text of an answer [bytes]."""
DIGITS = 6
"""Significant digits of numbers in a short answer."""
NOISE = 1e-12
"""Numbers up to this size come from rounding, so they are 0 in a short answer."""
WORDS = 300
"""Largest number of characters of a text in a shortened answer."""

KEYS: dict[str, tuple[str, ...]] = {
    "check": (
        "sentence", "verdict", "level", "stable", "summary", "moving", "assume", "ladder",
        "open_pairs", "if_joined", "nearest", "units", "warnings",
    ),
    "contacts": ("patches", "overlaps", "open_pairs", "bodies", "rejected", "units", "warnings"),
    "margin": (
        "sentence", "verdict", "level", "tilt_deg", "tilt_down", "friction", "load_factor",
        "improvements", "pushes", "units", "warnings",
    ),
    "hold": (
        "sentence", "verdict", "level", "least", "fewest", "supports", "open_pairs", "units",
        "warnings",
    ),
    "plan": (
        "sentence", "found", "verdict", "level", "holds_max", "steps", "impossible", "base",
        "units", "warnings",
    ),
    "scene": (
        "sentence", "at_rest", "level", "counts", "moved", "objects", "geometry", "units",
        "warnings",
    ),
    "settle": (
        "sentence", "state", "level", "moved", "leaves", "widest_gap", "deepest_overlap", "parts",
        "depth", "why", "before", "after", "units", "warnings",
    ),
    "transport": (
        "sentence", "carried", "verdict", "level", "limits", "cases", "units", "warnings",
    ),
}  # fmt: skip
"""Keys of a short answer; an answer that is not listed keeps all of its keys."""
ENTRIES: dict[tuple[str, str], tuple[str, ...]] = {
    ("contacts", "patches"): ("parts", "kind", "area", "gap", "normal"),
    ("margin", "pushes"): ("part", "direction", "force"),
    ("plan", "steps"): ("parts", "direction", "held", "verdict", "level"),
    ("scene", "objects"): (
        "name",
        "state",
        "level",
        "gap",
        "other",
        "move",
        "motion",
        "if_held",
        "way",
    ),
    ("transport", "limits"): ("name", "g", "acceleration", "upper", "how"),
}
"""Keys of the entries of some lists."""


def short_text(verb: str, answer: Mapping[str, Any], resource: str) -> str:
    """The text of a short answer.

    Examples
    --------
    >>> short_text("hold", {"sentence": "It holds.", "seconds": 0.1}, "kilter://answers/hold-1")
    '{"sentence":"It holds.","complete":"kilter://answers/hold-1"}'
    """
    data = _chosen(verb, answer)
    left_out: dict[str, int] = {}
    while True:
        text = _json({**data, **({"left_out": left_out} if left_out else {}), "complete": resource})
        if len(text.encode()) <= LIMIT:
            return text
        key = max(data, key=lambda name: len(_json(data[name])))
        value = data[key]
        if isinstance(value, list) and value:
            kept = len(value) // 2
            left_out[key] = left_out.get(key, 0) + len(value) - kept
            data[key] = value[:kept]
        elif isinstance(value, str) and len(value) > WORDS:
            data[key] = value[: WORDS - 3] + "..."
        else:
            left_out[key] = left_out.get(key, 0) + 1
            del data[key]


def _chosen(verb: str, answer: Mapping[str, Any]) -> dict[str, Any]:
    """The important keys of an answer, with rounded numbers."""
    data = dict(answer)
    if verb == "check":
        data["moving"] = [
            {"part": part["name"], "motion": part["motion"]}
            for part in data["parts"]
            if part["moves"]
        ]
    if verb == "scene":
        data["objects"] = [_object(entry) for entry in scene_order(data["objects"])]
    if verb == "margin":
        data["pushes"] = sorted(data["pushes"], key=lambda push: _force(push["force"]))
    keys = KEYS.get(verb, tuple(data))
    chosen = {key: data[key] for key in keys if key in data and key != "seconds"}
    for (of, key), names in ENTRIES.items():
        if of == verb and key in chosen:
            chosen[key] = [{n: e[n] for n in names if n in e} for e in chosen[key]]
    return {key: _rounded(value) for key, value in chosen.items() if value not in (None, [], {})}


def _object(entry: Mapping[str, Any]) -> dict[str, Any]:
    """An object of a scene without empty keys; its move is a position, since it does not turn."""
    kept = {key: value for key, value in entry.items() if value not in (None, [], {})}
    if "move" in kept:
        kept["move"] = kept["move"]["position"]
    return kept


def _force(force: float | None) -> float:
    return math.inf if force is None else force


def _rounded(value: Any) -> Any:
    """A JSON value with all numbers rounded to `DIGITS` digits."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if abs(value) > NOISE else 0.0
    if isinstance(value, Mapping):
        return {key: _rounded(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(entry) for entry in value]
    return value


def complete_text(answer: Any) -> str:
    """The text of a whole answer without its times, the same for equal questions."""
    return json.dumps(_untimed(answer), ensure_ascii=False, indent=1) + "\n"


def _untimed(value: Any) -> Any:
    """A JSON value without the keys "seconds"."""
    if isinstance(value, Mapping):
        return {key: _untimed(entry) for key, entry in value.items() if key != "seconds"}
    return [_untimed(entry) for entry in value] if isinstance(value, list) else value


def resource_name(verb: str, arguments: Mapping[str, Any]) -> str:
    """Name of the resource with the whole answer to a call, from the call itself.

    The last digits of numbers differ between computers, so the answer itself gives no name.
    """
    call = json.dumps([verb, arguments], sort_keys=True)
    return f"kilter://answers/{verb}-{hashlib.sha256(call.encode()).hexdigest()[:12]}"


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
