"""The remedy `--settle`: the verdict on the pose at rest, where overlaps or near misses decide.

It is tried for small assemblies with shallow overlaps only, since a search costs several conic
programs, and a deep overlap is meant or a mistake of another kind.
"""

from __future__ import annotations

from kilter.analysis.settled_pose.settle import settle
from kilter.analysis.verdict.remedies import Remedy
from kilter.analysis.verdict.verdict import Verdict
from kilter.errors import KilterError

MOST_PARTS, MOST_POINTS = 40, 400
"""Largest numbers of parts and contact points for which the pose at rest is searched for."""
DEEPEST = 0.02
"""Largest depth of an open overlap for which it is searched for [sizes of the smaller part]. Near
deep overlaps many features are close to each other, and the search takes long."""
CLOSABLE = ("overlap", "near")
"""Kinds of open pairs that a movement of parts can decide."""


def settle_remedy(verdict: Verdict) -> Remedy | None:
    """The verdict on the pose at rest near the drawn pose; None if it was not tried or found."""
    assembly, contacts = verdict.assembly, verdict.contact_set
    kinds = {pair.kind for pair in contacts.open_pairs}
    small = len(assembly) <= MOST_PARTS and len(contacts.points) <= MOST_POINTS
    if verdict.verdict != "undecided" or not kinds & set(CLOSABLE) or not small:
        return None
    left_open = {frozenset(pair.ends) for pair in contacts.open_pairs}
    size = assembly.geometry.size
    deep = (
        overlap.depth > DEEPEST * size[list(overlap.ends)].min()
        for overlap in contacts.overlaps
        if frozenset(overlap.ends) in left_open
    )
    if any(deep):
        return None
    try:
        answer = settle(
            assembly, contacts=contacts, require="equilibrium", effort=0.0, nearest=True
        )
    except KilterError:
        return None
    if answer.state != "at-rest" or answer.settled_verdict is None:
        return None
    moved = float(answer.distance.max(initial=0.0))
    return Remedy("--settle", answer.settled_verdict.verdict, answer.level, moved, assembly.units)
