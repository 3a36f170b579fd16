"""Parts on a grid: the state is independent of order and place (`grid_rests.py`)."""

from __future__ import annotations

import numpy as np
import pytest
from grid_rests import differs, looked_at
from random_grids import random_grid


def test_each_is_made_alike_by_its_seed() -> None:
    one, other = (random_grid(3).parts for _ in range(2))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.pose.position, b.pose.position)


def test_two_states_differ_and_an_open_one_is_told() -> None:
    free = ("free", 3, 3)
    assert differs(free, free) == ""
    assert "elsewhere" in differs(free, ("balanced", 3, 0))
    assert "elsewhere" in differs(free, ("free", 4, 4))
    assert "one order" in differs(free, ("open", 3, 3))


@pytest.mark.slow
def test_some_are_of_one_state_wherever_they_are() -> None:
    states = set()
    for seed in range(8):
        key, wrong, _ = looked_at(random_grid(seed, boxes=True), seed)
        states.add(key[0])
        assert not wrong, (seed, wrong)
    assert {"free", "balanced"} <= states


@pytest.mark.slow
@pytest.mark.parametrize("block", range(2))
@pytest.mark.parametrize("boxes", [True, False])
def test_random_grids_have_no_contradiction(block: int, boxes: bool) -> None:
    """At most one of six assemblies of boxes, or two of six of outlines, is open."""
    opens = 0
    for seed in range(5000 + 6 * block, 5006 + 6 * block):
        key, wrong, _ = looked_at(random_grid(seed, boxes=boxes), seed)
        assert not wrong, (seed, wrong)
        opens += key[0] == "open"
    assert opens <= (1 if boxes else 2)
