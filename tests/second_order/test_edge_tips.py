"""Parts exactly above an edge of a flat face tip at a small push, at any number of parts."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose

TABLE = Part("table", Box([20, 9, 1]), Pose([0, 0, -0.5]), grounded=True)


@pytest.mark.parametrize(("inside", "verdict"), [(0.0, "potentially-stable"), (1e-3, "stable")])
def test_a_box_on_a_slope_tips_if_its_weight_acts_above_its_lower_edge(
    inside: float, verdict: str
) -> None:
    """Its energy falls by W h (1 - cos phi): friction holds its edge, not its tilt."""
    slope = np.arctan(0.3)
    down = 9.81 * np.array([np.sin(slope - inside), 0, -np.cos(slope - inside)])
    box = Part("box", Box([2 * 0.3, 2, 2]), Pose([0, 0, 1]))
    found = kilter.check(Assembly([TABLE, box], friction=0.6, gravity=down))
    assert found.verdict == verdict
    if inside == 0.0:
        assert "edge" in found.sentence


@pytest.mark.parametrize("mu", [0.0, 0.5])
@pytest.mark.parametrize(("off", "verdict"), [(1.0, "potentially-stable"), (0.99, "stable")])
def test_the_top_of_a_high_stack_tips_as_that_of_a_low_one(
    off: float, verdict: str, mu: float
) -> None:
    stack = [Part(f"b{k}", Box([2, 2, 1]), Pose([0, 0, k + 0.5])) for k in range(24)]
    top = Part("top", Box([2, 2, 1]), Pose([off, 0, 24.5]))
    assert kilter.check(Assembly([TABLE, *stack, top], friction=mu)).verdict == verdict


@pytest.mark.parametrize(
    ("beside", "verdict"),
    [
        (Part("wall", Box([1, 4, 4]), Pose([1.5, 0, 2]), grounded=True), "stable"),
        (Part("roof", Box([4, 4, 1]), Pose([2, 0, 2.5]), grounded=True), "potentially-stable"),
        (Part("weight", Box([1, 1, 1]), Pose([-0.5, 0, 2.5])), "stable"),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_what_touches_a_box_above_an_edge_counts(beside: Part, verdict: str) -> None:
    """The box turns down to the right: a roof above its right half opens, a wall stops it."""
    shelf = Part("shelf", Box([4, 4, 1]), Pose([-2, 0, -0.5]), grounded=True)
    box = Part("box", Box([2, 2, 2]), Pose([0, 0, 1]))
    turn = [np.cos(0.1), 0, np.sin(0.1), 0]
    along = np.array([np.sin(0.2), 0, np.cos(0.2)])
    ramp = Part("ramp", Box([4, 4, 1]), Pose([30, 0, 0], turn), grounded=True)
    rider = Part("rider", Box([1, 1, 1]), Pose(np.array([30, 0, 0]) + along, turn))
    found = kilter.check(Assembly([shelf, box, beside, ramp, rider], friction=0.5))
    assert found.verdict == verdict


def test_the_overhanging_brick_at_the_end_of_a_wall_tips() -> None:
    """The rows are half a brick apart, so that the last brick of the top row is above an edge."""
    floor = Part("floor", Box([19, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    bricks = [
        Part(f"{row} {k}", Box([2, 1, 1]), Pose([2 * k + row % 2, 0, row + 0.5]))
        for row in range(6)
        for k in range(-2, 2)
    ]
    found = kilter.check(Assembly([floor, *bricks], friction=0.5))
    assert found.verdict == "potentially-stable"
    assert "5 1" in found.sentence
