"""Random linkages against the energy along exact motions, closed by Newton's method."""

from __future__ import annotations

from random_linkages import random_linkage

import kilter
from kilter import Assembly, Verdict
from kilter.arrays import Array

FLAT = 1e-5
"""Largest second derivative that counts as 0, over the largest or 1 [-]."""


def expected(curvatures: Array) -> str:
    """State by the exact second derivatives: balanced, free or minimum."""
    size = FLAT * max(1.0, float(abs(curvatures).max(initial=0.0)))
    if (curvatures < -size).any():
        return "balanced"
    return "free" if (curvatures < size).any() else "minimum"


def verified(assembly: Assembly) -> Verdict:
    verdict = kilter.check(assembly)
    assert kilter.verify(assembly, verdict.proof()).holds
    return verdict


def linkage(seed: int) -> str:
    """Result for a linkage: right, open or wrong."""
    made = random_linkage(seed)
    curvatures = made.curvatures()
    verdict = verified(made.assembly)
    found, wanted = verdict.second_order_answer, expected(curvatures)
    if found is None:
        return "right" if not len(curvatures) else "wrong"
    word = "balanced" if wanted == "balanced" else "stable"
    if found.state == "open":
        return "open" if verdict.verdict in (word, "potentially-stable") else "wrong"
    return "right" if (found.state, verdict.verdict) == (wanted, word) else "wrong"
