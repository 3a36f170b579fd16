"""Numbers of the answer of `kilter.contacts`, in millimetres, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tubes import pin, tube

import kilter
from kilter import Assembly, Bond, Box, Part, Pose, Prism
from kilter.scenes.pieces import block

BASE = block("base", [-50, -50, -10], [50, 50, 0], grounded=True)


def answered(*parts: Part, **more: object) -> dict:
    return kilter.contacts(Assembly(list(parts), units="mm", **more)).to_dict()


@pytest.mark.parametrize("gap", [0.0, 1e-4, -2e-4])
def test_a_patch_under_a_plate(gap: float) -> None:
    """A plate of 20 x 30 x 10, `gap` above its base, glued by 0.5 N/mm^2."""
    plate = block("plate", [0, 0, gap], [20, 30, 10 + gap])
    answer = answered(
        BASE, plate, friction=0.25, bonds=[Bond(("base", "plate"), pull_per_area=0.5)]
    )
    (patch,) = answer["patches"]
    assert patch["area"] == pytest.approx(20 * 30, rel=1e-12)
    assert [patch["gap"], *patch["gap_range"]] == pytest.approx([gap] * 3, abs=1e-12)
    assert patch["normal"] == pytest.approx([0, 0, 1], abs=1e-12)
    assert (patch["mu"], patch["pull"]) == (0.25, pytest.approx(0.5 * 600))
    corners = sorted([x, y, gap / 2] for x in (0, 20) for y in (0, 30))
    assert np.array(sorted(patch["points"])) == pytest.approx(np.array(corners), abs=1e-9)
    size = math.hypot(20, 30, 10)
    assert answer["sizes"] == pytest.approx([size, math.hypot(100, 100, 10)])
    edges = [math.nan if edge is None else edge for edge in answer["histogram"]["edges"]]
    (bin_,) = np.flatnonzero(answer["histogram"]["counts"])
    assert not gap / size < edges[bin_] - 1e-15
    assert not gap / size > edges[bin_ + 1] + 1e-15


def test_a_patch_under_a_tilted_plate_states_its_least_and_its_largest_gap() -> None:
    turn, low = math.radians(0.02), 1e-5
    height = low + 5 * (math.cos(turn) + math.sin(turn))
    quaternion = [math.cos(turn / 2), 0, math.sin(turn / 2), 0]
    (patch,) = answered(BASE, Part("plate", Box([10] * 3), Pose([0, 0, height], quaternion)))[
        "patches"
    ]
    expected = [low, low + 10 * math.sin(turn)]
    assert patch["gap_range"] == pytest.approx(expected, abs=1e-9)
    assert patch["gap"] == pytest.approx(expected[1], abs=1e-9)


@pytest.mark.parametrize(("degrees", "gap"), [(0.0, 1e-3), (0.5, 2e-3)])
def test_a_pair_that_is_rejected_states_its_gap_and_its_angle(degrees: float, gap: float) -> None:
    turn = math.radians(degrees)
    height = gap + 5 * (math.cos(turn) + math.sin(turn))
    quaternion = [math.cos(turn / 2), 0, math.sin(turn / 2), 0]
    answer = answered(BASE, Part("cube", Box([10] * 3), Pose([0, 0, height], quaternion)))
    (rejected,), (pair,) = answer["rejected"], answer["open_pairs"]
    assert rejected["angle_deg"] == pytest.approx(degrees, abs=1e-9)
    # the gap of a tilted face is measured across both faces
    assert rejected["gap"] == pytest.approx(gap, rel=1e-4)
    assert pair["gap"] == pytest.approx(gap, rel=1e-4)


def test_a_cube_that_is_sunk_into_its_base_and_one_above_it() -> None:
    sunk = block("sunk", [-40, -40, -2], [-20, -30, 8])
    above = block("above", [0, 0, 3], [10, 10, 10])
    answer = answered(BASE, sunk, above)
    (overlap,), (pair,) = answer["overlaps"], answer["open_pairs"]
    assert overlap["volume"] == pytest.approx(20 * 10 * 2)
    assert overlap["share"] == pytest.approx(2 / 10)
    assert overlap["depth"] == pytest.approx(2)
    assert (pair["volume"], pair["depth"]) == (overlap["volume"], overlap["depth"])
    (alone,) = answer["nearest"]
    assert alone["gap"] == pytest.approx(3)
    assert 0 <= abs(alone["gap"] - 3) <= alone["accuracy"] < 1e-9


def test_a_pin_in_a_ring_has_its_radius_its_clearance_and_the_length_of_the_ring() -> None:
    ring = tube("ring", 5.0, 10.0, 20.0, [3, 0, 10], grounded=True)
    answer = answered(ring, pin("pin", 4.9, 40.0, [3, 0, 15]))
    (fit,) = answer["fits"]
    assert (fit["radius"], fit["clearance"], fit["length"]) == pytest.approx((4.9, 0.1, 20))
    assert np.abs(fit["axis"]) == pytest.approx([0, 0, 1])
    assert np.cross(np.subtract(fit["point"], [3, 0, 0]), [0, 0, 1]) == pytest.approx([0] * 3)
    (alone,) = [one for one in answer["nearest"] if one["part"] == "pin"]
    assert abs(alone["gap"] - 0.1) <= alone["accuracy"] < 0.05


def test_ridges_that_cross_at_a_point_are_named_with_it() -> None:
    lower = Part("lower", Prism([[-1, -1], [1, -1], [0, 0]], 2.0), Pose([7, 5, 1]), grounded=True)
    turned = Pose([7, 5.5, 1], [math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
    upper = Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), turned)
    verdict = kilter.check(Assembly([lower, upper], units="mm")).to_dict()
    patches = answered(lower, upper)["patches"]
    assert patches[0]["points"] == [pytest.approx([7, 5.5, 1])]
    assert patches[0]["normal"] == pytest.approx([0, 0, 1])
    assert verdict["contacts"] == {"pairs": 1, "patches": 1, "points": 1}
    beside = answered(lower, Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), Pose([7, 5, 1])))
    (odd,) = beside["unsupported"]
    assert odd["point"][::2] == pytest.approx([7, 1])
    assert 4 <= odd["point"][1] <= 6
