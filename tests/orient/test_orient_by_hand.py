"""Numbers of the answers of `kilter.orient` and `kilter.region`, in millimetres, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Part
from kilter.scenes.pieces import block

WALLS = [
    block("floor", [-100, -100, -100], [200, 200, 0], grounded=True),
    block("left", [-100, -100, 0], [0, 200, 200], grounded=True),
    block("back", [0, -100, 0], [200, 0, 200], grounded=True),
]
CUBE = block("cube", [0, 0, 0], [100, 100, 100], density=2000.0)
HALF = math.degrees(math.asin(1 / math.sqrt(3)))
"""Angle between the axis of the corner and its walls."""


def found(*parts: Part, ask=kilter.orient) -> dict:
    return ask(Assembly([*WALLS, *parts], units="mm")).to_dict()


def test_a_cube_rests_in_a_corner_with_its_axis_along_gravity() -> None:
    answer = found(CUBE)
    assert answer["down"] == pytest.approx([-1 / math.sqrt(3)] * 3, abs=1e-9)
    assert answer["tilt_margin_deg"] == pytest.approx(HALF, abs=1e-6)
    assert answer["region"]["half_angle_deg"] == pytest.approx(HALF, abs=1e-6)
    w, *xyz = answer["rotation"]
    turn = Rotation.from_quat([*xyz, w])
    assert turn.apply(answer["down"]) == pytest.approx([0, 0, -1])
    # the least turn: about an axis across both directions, by the angle between them
    assert turn.magnitude() == pytest.approx(math.acos(1 / math.sqrt(3)))
    assert (answer["z"], answer["instability"]) == (0, 0)
    assert answer["residual"] <= 1e-9


@pytest.mark.slow
def test_a_cube_that_floats_beside_it_falls_in_every_direction() -> None:
    """Of 2 kg beside 2 kg in the corner: z = -2 |g| by the 1-norm, kappa^2 = 2 / 4."""
    answer = found(CUBE, block("floater", [120, 120, 120], [220, 220, 220], density=2000.0))
    nearest = answer["nearest"]
    # per freedom at most 1 mm: the load of the floater is -z = 2 kg (|gx| + |gy| + |gz|)
    assert nearest["diamond"]["value"] == pytest.approx(-2)
    assert np.abs(nearest["diamond"]["direction"]).sum() == pytest.approx(1)
    for name in ("sphere", "diamond"):
        motion = np.array(nearest[name]["motion"])
        assert np.abs(motion).max() <= 1 + 1e-9
        gained = 2 * (motion[3:, :3] @ nearest[name]["direction"]).sum()
        assert gained == pytest.approx(-nearest[name]["value"])
    # the 1-norm is least on the sphere along an axis
    assert nearest["sphere"]["value"] == pytest.approx(-2)
    assert np.linalg.norm(nearest["sphere"]["direction"]) == pytest.approx(1)
    kappa = nearest["kappa"]
    assert kappa["value"] == pytest.approx(math.sqrt(0.5), abs=1e-6)
    assert math.sqrt(0.5) - 1e-3 <= kappa["bound"] <= math.sqrt(0.5)
    fallen = np.array(kappa["motion"])
    assert fallen[4, :3] == pytest.approx(9.81 * np.array(kappa["direction"]), abs=1e-6)
    assert fallen[3] == pytest.approx([0] * 6, abs=1e-6)
    assert answer["instability"] == pytest.approx(math.sqrt(0.5))
    # at the named orientation only the floater falls, at g
    cube, floater = answer["parts"][3:]
    assert floater["acceleration"] == pytest.approx([*(9.81 * np.array(answer["down"])), 0, 0, 0])
    assert (floater["mass"], floater["relative"]) == (2, pytest.approx([1, 0]))
    assert cube["acceleration"] == pytest.approx([0] * 6, abs=1e-9)
    assert floater["displacement"][:3] == pytest.approx(answer["down"], abs=1e-9)
    assert answer["z"] == pytest.approx(-2)


def test_a_second_cube_at_a_gap_has_the_region_of_the_corner_if_it_is_joined() -> None:
    near = block("near", [100.01, 0, 0], [200.01, 100, 100])
    answer = found(CUBE, near, ask=kilter.region)
    (pair,) = answer["open_pairs"]
    assert pair["gap"] == pytest.approx(1e-2)
    joined = answer["if_joined"]
    for key in ("rays", "facets"):
        assert np.array(sorted(joined[key])) == pytest.approx(-np.eye(3), abs=1e-6)
    assert (joined["lines"], joined["equations"]) == ([], [])
    assert joined["half_angle_deg"] == pytest.approx(HALF, abs=1e-6)


def test_a_second_cube_in_a_channel_has_the_region_of_the_channel_if_it_is_joined() -> None:
    """Walls on both sides along x: gravity lies in the plane of x and z, not upward."""
    right = block("right", [100, -100, 0], [200, 300, 200], grounded=True)
    parts = [WALLS[0], WALLS[1], right, CUBE, block("near", [0, 100.01, 0], [100, 200.01, 100])]
    joined = kilter.region(Assembly(parts, units="mm")).to_dict()["if_joined"]
    assert np.abs(joined["lines"]) == pytest.approx(np.array([[1, 0, 0]]), abs=1e-9)
    assert np.abs(joined["equations"]) == pytest.approx(np.array([[0, 1, 0]]), abs=1e-9)
    for key in ("rays", "facets"):
        assert np.array(joined[key]) == pytest.approx(np.array([[0, 0, -1]]), abs=1e-9)
