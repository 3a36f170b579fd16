"""Clusters that do not touch each other: each alone, and joined."""

from __future__ import annotations

import numpy as np
import pytest
from places import case_of, moved, side_by_side

import kilter
from kilter import Assembly, Pose
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.parts.cluster_states import joined_state

KNOWN = ["02", "03", "07", "25", "26", "34", "35", "37", "38"]
"""Cases whose state is known on both sides of their limits."""


def answer(assembly: Assembly, *, effort: float = 1.0) -> SecondOrder:
    second = kilter.check(assembly, effort=effort).second_order_answer
    assert second is not None
    return second


def drawn(seed: int, count: int = 4) -> tuple[list[Assembly], list[str]]:
    """Random known cases with their states."""
    random = np.random.default_rng(seed)
    made, states = [], []
    for number in random.choice(KNOWN, count):
        case = case_of(number)
        above = case.limit is not None and random.random() < 0.5
        limit = 0.0 if case.limit is None else case.limit
        made.append(case.build(limit + (0.05 if above else -0.05)))
        states.append(case.above if above else case.state)
    return made, states


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_row_of_known_cases_has_the_state_of_the_worst(seed: int) -> None:
    made, states = drawn(seed)
    alone = [answer(one) for one in made]
    row = side_by_side(made)
    second = answer(row)
    assert [one.state for one in second.clusters] == states
    assert second.state == joined_state(states)
    for count in ("neutral", "free", "blocked", "undecided"):
        assert getattr(second, count) == sum(getattr(one, count) for one in alone)
    elsewhere = moved(row, Pose([3.0, -2.0, 5.0], [0.5, 0.3, -0.7, 0.41]), 37.0)
    assert answer(elsewhere).state == second.state
    names = [one.names[k] for one, s in zip(made, alone, strict=True) for k in s.moving]
    if all(state == second.state for state in states):
        assert len(second.moving) == len(names)
