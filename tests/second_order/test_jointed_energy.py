"""Random linkages and rolling chains: `jointed_energy.py` compares them with their energy."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from jointed_energy import FAMILIES, expected
from random_linkages import random_linkage
from random_rolling import random_chain


@pytest.mark.slow
@pytest.mark.parametrize("family", ["linkages", "rolling chains"])
def test_verdicts_agree_with_the_energy_along_exact_motions(family: str) -> None:
    results = Counter(FAMILIES[family](seed) for seed in range(1000, 1030))
    assert results["wrong"] == 0
    assert results["right"] >= 28


@pytest.mark.parametrize("build", [random_linkage, random_chain])
def test_the_random_cases_fall_and_stay(build) -> None:
    states = Counter(expected(build(seed).curvatures()) for seed in range(12))
    assert states["balanced"] >= 2
    assert states["free"] + states["minimum"] >= 2


def test_a_disc_that_rolls_on_a_disc_follows_a_circle_about_its_centre() -> None:
    """Radii R and r: after the arc s the centre is at the height (R + r) cos(s / R) - R."""
    chain = random_chain(0)
    chain.ground, chain.faces, chain.centers, chain.masses = 0.5, [(2.0, 0.0)], [0.5], [1.0]
    arc = 0.3
    assert chain.energy(np.array([arc])) == pytest.approx(2.5 * np.cos(arc / 2.0) - 2.0)
