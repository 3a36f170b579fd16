"""Idle contacts: fewer contacts admit more motions, so stability without them is enough."""

from __future__ import annotations

import copy
from typing import Any

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.second_order.answer.second_order_answer import SecondOrder

FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
WALL = Part("wall", Box([1, 10, 10]), Pose([-1.5, 0, 5]), grounded=True)
BALL = Part("ball", Sphere(1.0), Pose([0, 0, 1]))


def second_of(assembly: Assembly) -> SecondOrder:
    second = kilter.check(assembly).second_order_answer
    assert second is not None
    return second


def test_a_ball_beside_a_wall_is_free_away_from_it() -> None:
    second = second_of(Assembly([FLOOR, WALL, BALL]))
    assert (second.state, second.neutral, second.free, len(second.idle)) == ("free", 5, 5, 1)
    assert second.motion is not None
    assert second.motion[2, 0] > 0.1  # the wall is to its left


def changed(proof: dict[str, Any], **entries: Any) -> dict[str, Any]:
    other = copy.deepcopy(proof)
    other["second_order"] |= entries
    other["digest"] = digest_of(other)
    return other


@pytest.mark.slow
def test_what_shifts_as_a_whole_is_free_past_contacts_that_it_does_not_open() -> None:
    """A ball in a box whose walls all touch it: the walls move along with it."""
    walls = [
        Part(f"wall {k}", Box([0.2, 3, 1] if k < 2 else [1.6, 0.2, 1]), Pose([*at, 0.5]))
        for k, at in enumerate([(-0.9, 0), (0.9, 0), (0, -0.9), (0, 0.9)])
    ]
    ball = Part("ball", Sphere(0.8), Pose([0, 0, 0.8]))
    for parts in ([FLOOR, *walls, ball], [FLOOR, WALL, *walls[1:2], ball]):
        assembly = Assembly(parts)
        found = kilter.check(assembly)
        assert found.second_order_answer is not None
        assert found.second_order_answer.state == "free", found.second_order_answer.why
        assert kilter.verify(assembly, found.proof()).holds


def test_contacts_of_unknown_features_are_left_out_too() -> None:
    """A part on given contacts without features, on a part at rest: both slide together."""
    touch = kilter.GivenContact(("low", "high"), [[0.3, 0, 1]], [1, 0, 0])
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    high = Part("high", Box([1, 1, 1]), Pose([1.0, 0, 0.5]))
    assembly = Assembly([FLOOR, low, high], contacts=[touch])
    found = kilter.check(assembly)
    assert found.second_order_answer is not None
    assert found.second_order_answer.state == "free", found.second_order_answer.why
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    if "motion" in proof["second_order"] and "idle" in proof["second_order"]:
        apart = {"low": [1.0, 0, 0, 0, 0, 0], "high": [0.5, 0, 0, 0, 0, 0]}
        assert not kilter.verify(assembly, changed(proof, motion=apart)).holds
