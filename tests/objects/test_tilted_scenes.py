"""Proved verdicts of random bodies on tilted floors do not contradict a simulation."""

from __future__ import annotations

import pytest

pytest.importorskip("mujoco")

from tilted_scenes import outcome

JUDGED = {0: "stable", 3: "stable", 6: "stable", 15: "stable", 11: "unstable", 13: "unstable"}
"""Scenes with a proved verdict; `benchmarks/tilted_in_mujoco.py` has 200 scenes."""
OPEN = (5, 12)
"""Scenes without a proved verdict."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*JUDGED, *OPEN])
def test_a_proved_verdict_is_that_of_the_simulation(seed: int) -> None:
    found = outcome(seed)
    assert not found.wrong
    assert found.verdict == JUDGED.get(seed, "potentially-stable")
