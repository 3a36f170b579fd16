"""What a plan rests on: forces that balance, hands that are needed, and what must come first."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.planning.order.explained import explain
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor


@pytest.fixture(scope="module")
def built() -> Any:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False))
    return order, explain(order)


@pytest.mark.slow
def test_hands_and_ground_carry_the_weight_of_what_stands(built: Any) -> None:
    order, found = built
    assembly = order.states.assembly
    grounded, mass = assembly.geometry.grounded, assembly.geometry.mass
    for step, support in zip(order.steps, found.supports, strict=True):
        held = np.isin(assembly.names, step.held)
        free = step.state.present & ~grounded & ~held
        weight = float(mass[free | held].sum()) * assembly.gravity
        first, second = grounded[support.parts].T
        ground = support.forces[first].sum(axis=0) - support.forces[second].sum(axis=0)
        hands = sum((hand.force for hand in support.hands), np.zeros(3))
        assert np.linalg.norm(weight + ground + hands) < 1e-6 * np.linalg.norm(weight) + 1e-9


def test_a_hand_is_there_because_something_falls_without_it(built: Any) -> None:
    order, found = built
    assert sum(len(support.hands) for support in found.supports) == order.held_steps > 0
    for step, support in zip(order.steps, found.supports, strict=True):
        assert tuple(hand.part for hand in support.hands) == step.held
        for hand in support.hands:
            present = [n for n, on in zip(step.state.names, step.state.present, strict=True) if on]
            without = order.states.of(present, [name for name in step.held if name != hand.part])
            assert without.stable is False
            assert hand.falls == tuple(without.moving) != ()


def test_a_plank_that_would_tip_is_carried_whole_by_its_hand() -> None:
    # it reaches out so far that it tips, until a weight stands on its other end
    table = Part("table", Box([4, 2, 1]), Pose([-2, 0, -0.5]), grounded=True)
    plank = Part("plank", Box([4, 2, 1]), Pose([1, 0, 0.5]))
    weight = Part("weight", Box([1, 2, 10]), Pose([-0.5, 0, 6]))
    order = kilter.plan(Assembly([table, plank, weight]))
    assert [step.part for step in order.steps] == ["plank", "weight"]
    [hand] = explain(order).supports[1].hands
    assert (hand.part, hand.falls) == ("plank", ("plank",))
    assert hand.torque is not None
    # all of it, since nothing presses a part that is held: its weight, and no torque
    assert np.allclose(hand.force, [0, 0, 8 * 1000 * 9.81])
    assert np.allclose(hand.torque, 0, atol=1e-6)


def test_a_tower_is_put_up_from_below_and_nothing_else_is_asked() -> None:
    found = explain(kilter.plan(scene("tower")))
    pairs = {(one.before, one.after, one.why) for one in found.needs}
    cubes = [f"cube-{k}" for k in range(1, 6)]
    assert pairs == {(a, b, "way") for k, a in enumerate(cubes) for b in cubes[k + 1 :]}


@pytest.mark.slow
def test_what_was_asked_for_is_among_the_needs() -> None:
    order = kilter.plan(scene("wall"), kilter.PlanRules(before=[("brick-0-3", "brick-0-2")]))
    [asked] = [one for one in explain(order).needs if one.why == "asked"]
    assert (asked.before, asked.after) == ("brick-0-3", "brick-0-2")


def test_parts_that_move_as_one_stop_as_one() -> None:
    made = [block("plate", [0, 0, 0], [3, 2, 1]), block("knob", [1, 0.5, 1], [2, 1.5, 2])]
    lid = block("lid", [0, 0, 2], [3, 2, 3])
    whole = Assembly([floor([-1, -1], [4, 3]), *made, lid])
    order = kilter.plan(whole, kilter.PlanRules(groups=[["plate", "knob"]]))
    assert [step.parts for step in order.steps] == [("plate", "knob"), ("lid",)]
    [need] = explain(order).needs
    assert (need.before, need.after) == ("plate", "lid")
