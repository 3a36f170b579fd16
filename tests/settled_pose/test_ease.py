"""Parts at rest that slide on to where they need little friction (`ease`)."""

from dataclasses import replace

import numpy as np
import pytest

from kilter import Assembly, Box, Part, Pose, settle
from kilter.rigid import rotation_between

SLOPE = np.radians(5)
ALONG = np.array([np.cos(SLOPE), 0.0, -np.sin(SLOPE)])
UPWARD = np.array([np.sin(SLOPE), 0.0, np.cos(SLOPE)])


def on_a_slope(gap):
    """A box that friction holds on a slope, with a gap to a wall below it."""
    turn = rotation_between([0, 0, 1], UPWARD)
    beyond = (0.15 + gap) * ALONG + 0.1 * UPWARD
    ramp = Part("ramp", Box(2, 1, 0.1), Pose(-0.05 * UPWARD, turn), grounded=True)
    wall = Part("wall", Box(0.1, 1, 0.2), Pose(beyond, turn), grounded=True)
    box = Part("box", Box(0.2, 0.2, 0.2), Pose(0.1 * UPWARD, turn))
    return Assembly([ramp, wall, box], friction=0.5)


@pytest.mark.parametrize(("gap", "way"), [(0.01, 0.01), (0.2, 0.0)])
@pytest.mark.slow
def test_a_box_slides_to_a_wall_that_is_near_and_stays_otherwise(gap, way):
    drawn = on_a_slope(gap)
    assert settle(drawn).distance == pytest.approx([0, 0, 0], abs=1e-8)
    answer = settle(drawn, ease=True)
    assert answer.at_rest
    assert answer.movement[2, :3] == pytest.approx(way * ALONG, abs=1e-7)
    assert answer.distance[:2].tolist() == [0.0, 0.0]


@pytest.mark.slow
def test_a_box_that_stays_leaves_those_beside_it_alone():
    """A box beside one that would slide away stays too, and a box elsewhere slides to its wall."""
    alone, near = on_a_slope(0.2), on_a_slope(0.01)
    turn = alone["box"].pose.rotation
    upper = Part("upper", Box(0.1, 0.1, 0.1), Pose(0.25 * UPWARD, turn))
    others = [
        replace(part, name=f"other {part.name}", pose=Pose([0, 5, 0]) @ part.pose)
        for part in near.parts
    ]
    parts = [*alone.parts, upper, *others]
    answer = settle(Assembly(parts, friction=0.5), ease=True)
    assert answer.at_rest
    way = dict(zip(answer.drawn.names, answer.distance.tolist(), strict=True))
    assert way == pytest.approx(dict.fromkeys(way, 0.0) | {"other box": 0.01}, abs=1e-7)
