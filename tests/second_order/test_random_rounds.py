"""Random round assemblies: `round_energy.py` compares them with their energy."""

from __future__ import annotations

from collections import Counter

import pytest
from random_rounds import beside, random_round
from round_energy import RADII, compared, decided, survived

import kilter
from kilter.second_order.parts.cluster_states import joined_state


@pytest.mark.slow
def test_minima_rise_and_balanced_ones_fall() -> None:
    states = Counter(compared(seed, RADII[1:2]) for seed in (0, 4, 5, 6))
    assert states == {"minimum": 2, "balanced": 2}


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [(4, 5), (6, 4)])
def test_clusters_rise_and_fall_as_their_energy_does_together(seeds: tuple[int, int]) -> None:
    """Two clusters as one problem, by direct minimisation, and each alone."""
    made = [random_round(seed) for seed in seeds]
    together = beside(*made)
    alone = [decided(one)[0].state for one in made]
    second = kilter.check(together.assembly).second_order_answer
    assert second is not None
    assert [one.state for one in second.clusters] == alone
    assert second.state == joined_state(alone) == survived(together, 0, RADII[1:2])


@pytest.mark.slow
@pytest.mark.parametrize("block", range(3))
def test_random_rounds_have_no_contradiction(block: int) -> None:
    states = Counter(compared(seed) for seed in range(100 + 30 * block, 130 + 30 * block))
    assert min(states["minimum"], states["balanced"]) >= 3
    assert states["open"] == 0
