"""Idle contacts: fewer contacts admit more motions, so stability without them is enough."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from random_rests import groove, random_rest

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.second_order.answer.second_order_answer import SecondOrder

FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
WALL = Part("wall", Box([1, 10, 10]), Pose([-1.5, 0, 5]), grounded=True)
BALL = Part("ball", Sphere(1.0), Pose([0, 0, 1]))


def second_of(assembly: Assembly) -> SecondOrder:
    second = kilter.check(assembly).second_order
    assert second is not None
    return second


def test_a_ball_beside_a_wall_is_free_away_from_it() -> None:
    second = second_of(Assembly([FLOOR, WALL, BALL]))
    assert (second.state, second.neutral, second.free, len(second.idle)) == ("free", 5, 5, 1)
    assert second.motion is not None
    assert second.motion[2, 0] > 0.1  # the wall is to its left


@pytest.mark.slow
def test_two_that_touch_in_a_groove_are_free() -> None:
    rng, count = np.random.default_rng(4), 0
    while count < 5:
        parts = groove(rng)
        if len(parts) == 4:
            assert second_of(Assembly(parts)).state == "free"
            count += 1


@pytest.mark.slow
def test_what_is_idle_and_all_that_keeps_it_is_no_minimum() -> None:
    """Over the edge of a table only a stop without force keeps a box."""
    table = Part("table", Box([2, 2, 1]), Pose([-1, 0, -0.5]), grounded=True)
    box = Part("box", Box([2, 1, 1]), Pose([0, 0, 0.5]))
    stop = Part("stop", Box([1, 2, 2]), Pose([1.5, 0, 0]), grounded=True)
    assert second_of(Assembly([table, box, stop])).state == "free"
    assert len(second_of(Assembly([table, box, stop])).idle) == 0
    assert second_of(Assembly([table, box])).state == "balanced"


def changed(proof: dict[str, Any], **entries: Any) -> dict[str, Any]:
    other = copy.deepcopy(proof)
    other["second_order"] |= entries
    other["digest"] = digest_of(other)
    return other


@pytest.mark.slow
def test_proofs_without_idle_contacts_are_judged_again() -> None:
    assembly = Assembly([FLOOR, WALL, BALL])
    proof = kilter.check(assembly).proof()
    assert kilter.verify(assembly, proof).holds
    own = proof["second_order"]
    [idle] = own["idle"]
    six = np.array(own["motion"]["ball"])

    def holds(**entries: Any) -> bool:
        return kilter.verify(assembly, changed(proof, **entries)).holds

    assert holds(motion={"ball": (2 * six).tolist()})
    assert not holds(motion={"ball": (-six).tolist()})  # into the wall
    assert not holds(motion={"ball": (0 * six).tolist()})
    assert not holds(motion={"ball": [*six[:2], 0.1, 0, 0, 0]})  # up
    assert not holds(motion={"ball": [0, 0, 0, 0, 0, 1.0]})  # a spin
    assert not holds(motion={"floor": six.tolist()})
    assert not holds(idle=[])
    assert not holds(idle=[1 - idle])  # the floor
    assert not holds(idle=[0, 1])
    assert not holds(idle=[7])
    assert not holds(state="minimum")
    assert not holds(state="balanced")
    assert not holds(neutral=4, free=4)
    short = copy.deepcopy(proof)
    del short["second_order"]["idle"]
    short["digest"] = digest_of(short)
    assert not kilter.verify(assembly, short).holds


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(14))
def test_random_rests_are_decided_and_proved(seed: int) -> None:
    kind, assembly = random_rest(seed)
    verdict = kilter.check(assembly)
    second = verdict.second_order
    if second is not None and second.state == "open":
        assert "is open" in second.why, kind
    assert kilter.verify(assembly, verdict.proof()).holds


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
        assert found.second_order is not None
        assert found.second_order.state == "free", found.second_order.why
        assert kilter.verify(assembly, found.proof()).holds


def test_contacts_of_unknown_features_are_left_out_too() -> None:
    """A part on given contacts without features, on a part at rest: both slide together."""
    touch = kilter.GivenContact(("low", "high"), [[0.3, 0, 1]], [1, 0, 0])
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    high = Part("high", Box([1, 1, 1]), Pose([1.0, 0, 0.5]))
    assembly = Assembly([FLOOR, low, high], contacts=[touch])
    found = kilter.check(assembly)
    assert found.second_order is not None
    assert found.second_order.state == "free", found.second_order.why
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    if "motion" in proof["second_order"] and "idle" in proof["second_order"]:
        apart = {"low": [1.0, 0, 0, 0, 0, 0], "high": [0.5, 0, 0, 0, 0, 0]}
        assert not kilter.verify(assembly, changed(proof, motion=apart)).holds
