"""Numbers of the answer of `kilter.transport`, in millimetres, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.analysis.transport.carrier import CarrierMotion
from kilter.analysis.transport.carrier_path import CarrierPath
from kilter.scenes.pieces import block

G = 9.81
TIPS = np.array([50, 100]) / 150
"""Accelerations along x and y at which the box of 100 x 200 x 300 tips [g]."""
BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 300]), [0, 0, 150], density=2000.0)
HIGH = Assembly([BASE, BOX], units="mm", friction=0.8)
LOW = Assembly([BASE, Part("low", Box([200, 200, 20]), [0, 0, 10])], units="mm", friction=0.4)


@pytest.mark.slow
def test_a_box_tips_along_each_axis() -> None:
    answer = kilter.transport(HIGH).to_dict()
    assert answer["gravity"] == G
    expected = {"x": TIPS[0], "y": TIPS[1], "z": 1.0}
    # the sense of the tilt, and its turn per length moved: the fastest part moves by 1 mm
    radius = math.hypot(50, 100, 150)
    for limit in answer["limits"][:6]:
        sign, axis = limit["name"]
        sign = 1.0 if sign == "+" else -1.0
        assert limit["direction"] == [sign * (axis == one) for one in "xyz"]
        if limit["name"] == "+z":
            assert (limit["acceleration"], limit["upper"], limit["g"]) == (None, None, None)
            continue
        share = expected[axis]
        assert limit["g"] == pytest.approx(share, rel=2e-7)
        assert limit["acceleration"] == pytest.approx(share * G, rel=2e-7)
        assert limit["upper"] == pytest.approx(share * G, rel=2e-7)
        assert 0 <= limit["limit"]["gap"] <= 2e-7
        assert limit["limit"]["residual"] <= 1e-9
        if axis == "x":
            turn = 1 / math.hypot(50, 150, radius)
            moved = turn * np.array([-150 * sign, 0, 50, 0, -sign, 0])
            assert limit["limit"]["mechanism"]["box"] == pytest.approx(moved, abs=1e-6)
    least = answer["limits"][6]
    assert np.abs(least["direction"]) == pytest.approx([1, 0, 0], abs=1e-6)
    assert least["g"] == pytest.approx(TIPS[0], rel=1e-6)
    polar = answer["polar"]
    assert np.abs(polar["axes"]) == pytest.approx(np.eye(3)[:2])
    points, normals = np.array(polar["points"]), np.array(polar["normals"])
    # it tips over any side of its base, or slides
    inside = np.maximum(np.abs(points / TIPS).max(axis=1), np.linalg.norm(points, axis=1) / 0.8)
    assert inside == pytest.approx(np.ones(len(points)), rel=1e-6)
    corners = np.array([[x, y] for x in (-1, 1) for y in (-1, 1)]) * TIPS
    assert polar["reach"] == pytest.approx((normals @ corners.T).max(axis=1), rel=1e-5)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))
    # between its points the boundary is at most `gap` outside of the straight line
    assert 0 <= polar["gap"] < 0.05


@pytest.mark.slow
def test_the_gap_of_the_boundary_is_that_of_a_circle() -> None:
    """A slab slides at mu in every direction: points and tangents of a circle."""
    polar = kilter.transport(LOW).to_dict()["polar"]
    count = len(polar["points"])
    assert np.linalg.norm(polar["points"], axis=1) == pytest.approx([0.4] * count, rel=1e-6)
    assert polar["reach"] == pytest.approx([0.4] * count, rel=1e-6)
    # a corner of the tangents, from the chord between the points beside it
    angle = math.pi / count
    assert polar["gap"] == pytest.approx(0.4 * (1 / math.cos(angle) - math.cos(angle)), rel=1e-4)


@pytest.mark.slow
def test_a_carrier_that_turns_or_brakes() -> None:
    """The box stands 1 m from an axis about which the carrier turns at 1 rad/s: 1 m/s^2."""
    turn = CarrierMotion([0, 0, 0], [0, 0, 1.0], [0, 0, 0], [-1000, 0, 0])
    (case,) = kilter.transport(HIGH, turn=turn).to_dict()["cases"]
    assert case["factor"] == pytest.approx(TIPS[0] * G, rel=1e-6)
    assert (case["angular_velocity"], case["about"]) == ([0, 0, 1], [-1000, 0, 0])
    answer = kilter.transport(HIGH, code="en12195", mu_range=(0.9, 1.1)).to_dict()
    assert answer["mu_range"] == [0.9, 1.1]
    for case, axis, size in zip(answer["cases"], "xxyy", (0.8, 0.5, 0.5, 0.5), strict=True):
        assert case["g"] == pytest.approx(size)
        assert np.linalg.norm(case["acceleration"]) == pytest.approx(size * G)
        assert case["factor"] == pytest.approx(TIPS["xy".index(axis)] / size, rel=1e-6)
        assert case["carried"] is (case["factor"] > 1)
        assert case["limit"]["residual"] <= 1e-9
        assert case["limit"]["gap"] <= 2e-7


def test_a_path_of_two_accelerations() -> None:
    """A slab slides beyond mu g; the squared speed factor multiplies the acceleration."""
    time, along = np.array([0.0, 0.5, 2.0]), np.array([1.0, 2.0, 4.0])
    none = np.zeros((3, 3))
    path = CarrierPath(
        time, np.repeat(np.eye(3)[None], 3, axis=0), along[:, None] * [1.0, 0, 0], none, none,
        np.zeros(3), True,
    )  # fmt: skip
    speed = kilter.transport(LOW, path=path).to_dict()["speed"]
    expected = np.sqrt(0.4 * G / along)
    assert speed["factors"] == pytest.approx(expected, rel=1e-6)
    assert (speed["factor"], speed["lower"]) == pytest.approx((expected[2], expected[2]), rel=1e-6)
    assert speed["lower"] <= speed["factor"]
    assert (speed["samples"], speed["duration"], speed["time"]) == (3, 2.0, 2.0)
    assert (speed["times"], speed["slowest"]) == ([0.0, 0.5, 2.0], 0.0)
