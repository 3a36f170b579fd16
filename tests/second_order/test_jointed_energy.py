"""Random linkages: `jointed_energy.py` compares them with their energy."""

from __future__ import annotations

from collections import Counter

import pytest
from jointed_energy import expected, linkage
from random_linkages import random_linkage


@pytest.mark.slow
def test_verdicts_agree_with_the_energy_along_exact_motions() -> None:
    results = Counter(linkage(seed) for seed in range(1000, 1030))
    assert results["wrong"] == 0
    assert results["right"] >= 28


def test_the_random_cases_fall_and_stay() -> None:
    states = Counter(expected(random_linkage(seed).curvatures()) for seed in range(12))
    assert states["balanced"] >= 2
    assert states["free"] + states["minimum"] >= 2
