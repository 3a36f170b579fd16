"""A plan judged again from its file: its order and its ways, apart from the search.

That each state holds is judged with its forces (`kilter.analysis.verification`). Here: that the
states follow one another, one part more each; that every part touches what stands; that nothing
stops it on its way; and, where no order without holds exists, that the parts which fall alone are
all that are not reached.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.planning.part_sets import bits_of
from kilter.analysis.planning.sweeps import Sweeps
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError, some_names
from kilter.rigid import unit

__all__ = ["wrong_order"]

About = Mapping[str, Any]


def wrong_order(assembly: Assembly, contacts: ContactSet, entries: Sequence[About]) -> list[str]:
    """Why what the proofs of a plan are about is no order, or no impossibility.

    Raises
    ------
    InputError
        If an entry has not the form of one.
    """
    try:
        steps = [one for one in entries if one.get("about") == "step"]
        falling = [one for one in entries if one.get("about") == "falls alone"]
        reasons = _wrong_steps(assembly, contacts, steps) if steps else []
        if steps and not any(one.get("about") == "whole" for one in entries):
            reasons.append("the finished assembly has no proof")
        return reasons + (_wrong_closure(assembly, falling) if falling else [])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"a step of the plan is not of its form ({error})", hint="make it anew with --proof"
        ) from None


def _wrong_steps(assembly: Assembly, contacts: ContactSet, steps: Sequence[About]) -> list[str]:
    sweeps, reasons = Sweeps(contacts), []
    standing = {part.name for part in assembly if part.grounded}
    touching = {
        frozenset((assembly.names[a], assembly.names[b])) for a, b in contacts.patch_parts.tolist()
    } | {frozenset(joint.parts) for joint in assembly.joints}
    for number, step in enumerate(steps, 1):
        parts, change = step["parts"], step["change"]
        moved = [assembly.index_of(part) for part in parts]
        said = some_names(parts)
        if standing.intersection(parts) or len(set(parts)) < len(parts) or not parts:
            reasons.append(f"step {number}: {said} stands already")
        if set(change["without"]) != set(assembly.names) - standing:
            reasons.append(f"step {number}: its state is not what stands before it")
        if not _hang_on(standing, parts, touching):
            reasons.append(f"step {number}: {said} touches nothing that stands")
        there = bits_of(np.array([name in standing for name in assembly.names], dtype=bool))
        if step["over"] is not None:
            there &= ~(1 << assembly.index_of(step["over"]))
        if any(_stopped(assembly, sweeps, part, there, step["legs"]) for part in moved):
            reasons.append(f"step {number}: something is in the way of {said}")
        standing.update(parts)
    missing = set(assembly.names) - standing
    if missing:
        reasons.append(f"{min(missing)!r} is never put in")
    return reasons


def _hang_on(standing: set[str], parts: Sequence[str], touching: set[frozenset[str]]) -> bool:
    """Whether all of some parts touch what stands, or one another of those that do."""
    there, left = set(standing), set(parts)
    while left:
        near = {p for p in left if any(frozenset((p, other)) in touching for other in there)}
        if not near:
            return False
        there |= near
        left -= near
    return True


def _stopped(assembly: Assembly, sweeps: Sweeps, part: int, there: int, legs: Any) -> bool:
    """Whether any of a set of parts is in the way, piece by piece."""
    start = np.zeros(3)
    others = [k for k in range(len(assembly)) if there >> k & 1 and k != part]
    for vector, length in legs:
        x, y, z = (float(one) for one in unit(np.array(vector, dtype=float)).round(12))
        distance = np.inf if length is None else float(length)
        if any(
            sweeps.pair_stops(part, other, (x, y, z), distance=distance, start=start)
            for other in others
        ):
            return True
        if np.isinf(distance):
            return False
        start = start + distance * np.array([x, y, z])
    return True


def _wrong_closure(assembly: Assembly, falling: Sequence[About]) -> list[str]:
    alone = {one["part"] for one in falling}
    base = {part.name for part in assembly if part.grounded}
    reached = set(assembly.names) - alone
    for one in falling:
        change = one["change"]
        there = set(assembly.names) - set(change["without"])
        if there != reached | {one["part"]} or set(change["held"]) != reached - base:
            return [f"{one['part']!r} does not fall alone on all that is reached"]
    return []
