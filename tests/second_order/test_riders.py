"""Flat parts that ride on a turning part, and sharp edges, count in a small push."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Prism
from kilter.assembly.interactions import FrictionPair


def turntable(place: float, tilt: float = 0.1) -> Assembly:
    """A box on a hinged disc under tilted gravity; uphill it is an inverted pendulum."""
    parts = [
        Part("base", Box([4, 4, 1]), Pose([0, 0, -1.5]), grounded=True),
        Part("disc", Cylinder(1.2, 0.2)),
        Part("box", Box([0.2, 0.2, 0.2]), Pose([place, 0, 0.2])),
    ]
    hinge = Joint(("disc", "ground"), "revolute", point=[0, 0, 0], axis=[0, 0, 1])
    gravity = 9.81 * np.array([np.sin(tilt), 0, -np.cos(tilt)])
    return Assembly(parts, gravity=gravity, friction=0.5, joints=[hinge])


def test_a_box_uphill_on_a_turntable_is_not_stable() -> None:
    found = kilter.check(turntable(-0.8))
    assert found.level == "equilibrium"
    assert kilter.verify(turntable(-0.8), found.proof(), require="equilibrium").holds


def prism_on_its_edge(*, beside: bool) -> Assembly:
    """A prism on its edge; on request beside a box that friction holds on a ramp."""
    slope = [np.cos(0.1), 0, np.sin(0.1), 0]
    up = np.array([np.sin(0.2), 0, np.cos(0.2)])
    parts = [
        Part("table", Box([60, 60, 1]), Pose([0, 0, -0.5]), grounded=True),
        Part("prism", Prism([[0, 0], [1, 1], [-1, 1]], 1.0)),
    ]
    ramp = Part("ramp", Box([4, 4, 1]), Pose([9, 0, 3], slope), grounded=True)
    rider = Part("rider", Box([1, 1, 1]), Pose(np.array([9, 0, 3]) + up, slope))
    pairs = [FrictionPair(("rider", "ramp"), 0.5)]
    return Assembly([*parts, ramp, rider], friction_pairs=pairs) if beside else Assembly(parts)


@pytest.mark.parametrize("beside", [False, True])
def test_a_prism_on_its_edge_is_not_stable_whatever_stands_beside_it(beside: bool) -> None:
    found = kilter.check(prism_on_its_edge(beside=beside))
    assert found.level == "equilibrium"
