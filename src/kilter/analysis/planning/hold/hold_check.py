"""Verify a file about the fewest supports or straps: that they hold, and that fewer do not.

Each proof is judged by itself (`kilter.analysis.verification`). This module verifies that each is
about the candidates and the load that it names, that one set of straps holds every load of the
code, and that the motions exclude every smaller set. The shares are computed anew.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.planning.hold.least_straps import (
    LoadCase,
    load_cases,
    smallest_set,
    strap_powers,
)
from kilter.analysis.planning.hold.supported import shares_of
from kilter.analysis.smallest_set import least_cover
from kilter.arrays import Array
from kilter.assembly import Assembly, Strap
from kilter.contact import ContactSet
from kilter.contact.supports import Support, with_supports
from kilter.errors import InputError
from kilter.mechanics.bundle import apply_change
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.program import build_program

About = Mapping[str, Any]


def wrong_hold(
    assembly: Assembly, contacts: ContactSet, bundle: About, verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why valid proofs about sets of supports do not prove the fewest."""
    rules = bundle["rules"]
    candidates = [Support.from_dict(item) for item in rules["candidates"]]
    for item in candidates:
        item.require_of(assembly)
    held: list[tuple[frozenset[int], About]] = []
    falling: list[tuple[frozenset[int], About]] = []
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        present = frozenset(entry["supports"])
        if entry["change"] != _change(assembly, candidates, present):
            yield f"{entry['about']}: its supports differ from the candidates that it names"
            continue
        if entry["about"] not in FALLS or (verdict == "unstable") != FALLS[entry["about"]]:
            yield f"it states {entry['about']!r:.40}, but its proof gives the verdict {verdict}"
            continue
        if FALLS[entry["about"]] and not entry["proof"]["motion"].keys() <= set(assembly.names):
            yield f"{entry['about']}: its motion names a part that the assembly does not have"
            continue
        (falling if FALLS[entry["about"]] else held).append((present, entry))
    shares = [_shares(assembly, contacts, candidates, *item) for item in falling]
    least = len(candidates) + 1 if not held else rules["least"]
    if len(held) > 1 or (held and len(held[0][0]) < least):
        yield "it has no proof that the fewest supports hold it"
    if least_cover(shares, min(least - 1, len(candidates))) is not None:
        yield f"fewer than {least} supports may be enough"


FALLS = {"held": False, "not fewer": True}
"""Subjects of the proofs of a fixture, and whether the state of such a proof falls."""


def _change(
    assembly: Assembly, candidates: Sequence[Support], present: frozenset[int]
) -> dict[str, Any]:
    """Change of an assembly that adds a subset of the candidate supports, as data for its file."""
    chosen = [candidates[k] for k in sorted(present)]
    gripped = {support.part for support in chosen if support.kind == "grip"}
    return {
        "held": [name for name in assembly.names if name in gripped],
        "supports": [support.to_dict() for support in chosen if support.kind != "grip"],
    }


def _shares(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: Sequence[Support],
    present: frozenset[int],
    entry: About,
) -> dict[int, float]:
    """Fraction of the work of a proved motion that each absent candidate support would take."""
    every = with_supports(
        assembly, contacts, [support for support in candidates if support.kind != "grip"]
    )
    program = build_program(*apply_change(assembly, contacts, entry["change"]), possible=True)
    motion = np.zeros((len(program.names), 6))
    number = {name: k for k, name in enumerate(program.names)}
    for name, six in entry["proof"]["motion"].items():
        motion[number[name]] = six
    proof = check_motion(program, motion)
    return shares_of(candidates, build_program(*every), len(contacts.patch_mu), proof, present)


def wrong_lashing(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> list[str]:
    """Reasons why valid proofs about sets of straps do not prove the fewest."""
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
