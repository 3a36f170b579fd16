"""Least loads of hands and supports: closed forms, no larger than the loads of any proof."""

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Support
from kilter.analysis.planning.hold.least_loads import least_loads
from kilter.analysis.planning.order.explained import explain
from kilter.contact import contacts
from kilter.mechanics.program import build_program
from kilter.scenes.arches import arch


def beyond_the_edge(distance: float) -> Assembly:
    table = Part("table", Box(2, 1, 1), [-1, 0, -0.5], grounded=True)
    board = Part("board", Box(2, 1, 0.2), [distance, 0, 0.1], mass=2)
    return Assembly([table, board])


@pytest.mark.parametrize("distance", [0.1, 0.5])
def test_a_grip_and_an_edge_share_a_weight(distance):
    """The edge carries N and the hand (W - N, N d); least at N = W/(1 + d^2/r^2)."""
    assembly = beyond_the_edge(distance)
    weight, radius = 2 * float(np.linalg.norm(assembly.gravity)), np.linalg.norm([1, 0.5, 0.1])
    pressed = weight / (1 + (distance / radius) ** 2)
    (grip,) = kilter.hold(assembly).supports
    assert grip.force == pytest.approx([0, 0, weight - pressed], abs=1e-5 * weight)
    assert grip.torque == pytest.approx([0, -pressed * distance, 0], abs=1e-5 * weight)


def test_a_prop_carries_the_moment_about_the_edge():
    """The ledge presses at its edge, 1.25 m from the prop: W .5/1.25, and not more."""
    ledge = Part("ledge", Box(1, 1, 1), [-0.5, 0, -0.5], grounded=True)
    beam = Part("beam", Box(2, 1, 0.2), [0.5, 0, 0.1], mass=2)
    prop = Support("prop", "beam", [1.25, 0, 0])
    answer = kilter.hold(Assembly([ledge, beam]), candidates=[prop], require="equilibrium")
    (support,) = answer.supports
    weight = 2 * float(np.linalg.norm(answer.assembly.gravity))
    assert support.force == pytest.approx([0, 0, weight * 0.5 / 1.25], abs=1e-5 * weight)
    assert support.torque is None


def test_a_magnet_carries_no_more_than_it_must():
    """Its pull may be 50 N, but the weight that hangs on it is 20 N: no less, and no more."""
    table = Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)
    hung = Part("hung", Box(1, 1, 1), [0, 0, 3], mass=2)
    magnet = Support("magnet", "hung", [0, 0, 3.5], [0, 0, -1], mu=0.2, capacity=50.0)
    answer = kilter.hold(Assembly([table, hung]), candidates=[magnet], require="equilibrium")
    (support,) = answer.supports
    weight = 2 * float(np.linalg.norm(answer.assembly.gravity))
    assert support.force == pytest.approx([0, 0, weight], abs=1e-6)


def test_a_part_that_stands_needs_nothing_of_a_hand():
    table = Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)
    box = Part("box", Box(1, 1, 1), [0, 0, 0.5])
    assembly = Assembly([table, box])
    found = least_loads(build_program(assembly, contacts(assembly)), [1])
    assert found is not None
    assert not found.hands.any()


def test_hands_of_a_plan_carry_at_most_what_the_proof_gives_them():
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False))
    smaller = 0
    for step, support in zip(order.steps, explain(order).supports, strict=True):
        program, forces = step.state.program, step.state.forces
        if not support.hands or forces is None:
            continue
        load = program.wrenches(forces.forces, forces.friction) + program.applied
        load[:, :3] += program.mass[:, None] * program.gravity
        names = [hand.part for hand in support.hands]
        at = [program.names.index(name) for name in names]
        scale = np.ones((len(at), 6))
        scale[:, 3:] /= program.radius[at, None]
        before = float(((load[at] * scale) ** 2).sum())
        least = np.array([[*hand.force, *hand.torque] for hand in support.hands]) * scale
        assert all(hand.least for hand in support.hands)
        after = float((least**2).sum())
        assert after <= before * (1 + 1e-6)
        smaller += after < 0.9 * before
    assert smaller
