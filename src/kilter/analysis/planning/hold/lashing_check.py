"""Verify a file about the fewest straps: that the straps hold every load, and fewer do not.

Each proof is judged by itself (`kilter.analysis.verification`). This module verifies that each
is about the candidates and the load that it names, that one set of straps holds every load of the
code, and that the motions exclude every smaller set.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.planning.hold.lashing import LoadCase, load_cases
from kilter.analysis.planning.hold.least_straps import smallest_set, strap_powers
from kilter.arrays import Array
from kilter.assembly import Assembly, Strap
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import AGREES

__all__ = ["wrong_lashing"]


def wrong_lashing(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> list[str]:
    """Reasons why valid proofs about sets of straps do not prove the fewest straps."""
    rules = bundle["rules"]
    candidates = [_strap_of(data) for data in rules["candidates"]]
    code = rules.get("code")
    try:
        cases = load_cases(assembly, *(() if code is None else (code["name"], code["forward"])))
    except InputError as error:
        return [f"its code has no loads: {error}"]
    named = {case.name: case for case in cases}
    held: list[tuple[str, list[int]]] = []
    rows: list[Array] = []
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        chosen, case = entry["chosen"], named.get(entry.get("case", ""))
        if case is None:
            return ["a proof names no direction of the code"]
        if sorted(set(chosen)) != chosen or not all(0 <= k < len(candidates) for k in chosen):
            return ["a set of straps names no candidates"]
        if fault := _other_load(entry["change"], case, [candidates[k] for k in chosen]):
            return [fault]
        if verdict != "unstable":
            held.append((case.name, chosen))
            continue
        motion = np.zeros((len(assembly.parts), 6))
        for name, six in entry["proof"]["motion"].items():
            motion[assembly.index_of(name)] = six
        rows.append(strap_powers(case.assembly, contacts, candidates, motion))
    powers = np.array(rows).reshape(-1, 1 + len(candidates))
    least, _ = smallest_set(powers)
    reasons: list[str] = []
    if least < rules["least"]:
        reasons.append(f"its motions do not exclude every set of {least} straps")
    if not held and least <= len(candidates):
        reasons.append("it has no straps that hold, and its motions do not exclude every set")
    if any(len(chosen) > rules["least"] for _, chosen in held):
        reasons.append("its straps are more than the least number that it states")
    if held and {name for name, _ in held} != set(named):
        reasons.append("its straps are not proved to hold in every direction of the code")
    if any(chosen != held[0][1] for _, chosen in held):
        reasons.append("its proofs hold different sets of straps")
    return reasons


def _other_load(change: Mapping[str, Any], case: LoadCase, straps: Sequence[Strap]) -> str:
    """Reason why a change is not that of a load with these straps; empty if it is."""
    expected = case.change(straps)
    if change.keys() != expected.keys() or change["straps"] != expected["straps"]:
        return "the straps of a proof differ from the candidates that it names"
    if "gravity" in expected:
        gravity = case.assembly.gravity
        apart = float(np.linalg.norm(np.asarray(change["gravity"]) - gravity))
        if apart > AGREES * float(np.linalg.norm(gravity)):
            return "the gravity of a proof is not that of its direction of the code"
    return ""


def _strap_of(data: Mapping[str, Any]) -> Strap:
    """The strap of JSON data."""
    return Strap(**{**data, "path": [tuple(point) for point in data["path"]]})
