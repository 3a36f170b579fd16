"""Random round assemblies: `round_energy.py` compares them with their energy."""

from __future__ import annotations

from collections import Counter

import pytest
from round_energy import compared


@pytest.mark.slow
@pytest.mark.parametrize("block", range(3))
def test_random_rounds_have_no_contradiction(block: int) -> None:
    states = Counter(compared(seed) for seed in range(100 + 30 * block, 130 + 30 * block))
    assert min(states["minimum"], states["balanced"]) >= 3
    assert states["open"] == 0
