"""Numbers of the answer of `kilter.margin`, in millimetres, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from margins import program_of

import kilter
from kilter import Assembly, Box, Part, Prism
from kilter.analysis.margins.pushes import find_push
from kilter.analysis.margins.uncertainty import Ranges
from kilter.scenes.pieces import block

G = 9.81
WEIGHT = 0.1 * 0.2 * 0.3 * 2000 * G
MU = 0.8
BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 300]), [0, 0, 150], density=2000.0)
TIPS = math.degrees(math.atan(50 / 150))


def answered(*parts: Part, **more: object) -> dict:
    assembly = Assembly([BASE, *parts], units="mm", friction=MU)
    return kilter.margin(assembly, **more).to_dict()


def near(limit: dict) -> dict[str, float]:
    """Tolerance of a value that has been proved from both sides: the distance of these sides."""
    assert limit["residual"] <= 1e-9
    assert 0 <= limit["gap"] <= 2e-7
    return {"rel": limit["gap"] + limit["residual"]}


@pytest.mark.slow
def test_a_box_tips_over_its_lower_edge() -> None:
    """The edge is 50 mm from the centre of mass, which is 150 mm above it."""
    answer = answered(BOX, push=[1, 0, 0], about=[0, 1, 0])
    limit = answer["tilt_limit"]
    assert answer["tilt_deg"] == pytest.approx(TIPS, **near(limit))
    assert TIPS * (1 - 1e-6) <= answer["tilt_lower_deg"] <= TIPS * (1 + 1e-9)
    sine, down = math.sin(math.radians(TIPS)), answer["tilt_down"]
    assert [abs(down[0]), down[1]] == pytest.approx([sine, 0], abs=1e-8)
    assert down[2] == pytest.approx(-math.cos(math.radians(TIPS)))
    assert answer["about"]["tilt_deg"] == pytest.approx(TIPS, **near(answer["about"]["limit"]))
    assert answer["load_factor"] == pytest.approx([-1 / 3, 1 / 3], rel=2e-7)
    (push,) = answer["pushes"]
    # the shortest push is across the arm from the edge to the centre
    arm = math.hypot(50, 150)
    assert push["force"] == pytest.approx(WEIGHT * 50 / arm, **near(push["limit"]))
    assert push["lower"] == pytest.approx(push["force"], rel=1e-6)
    assert push["lower"] <= WEIGHT * 50 / arm * (1 + 1e-9)
    assert np.abs(push["direction"]) == pytest.approx([150 / arm, 0, 50 / arm], abs=1e-6)
    assert push["direction"][2] > 0
    # mechanisms turn about the edge; shift and turn times radius have the length 1 mm together
    turn = 1 / math.hypot(arm, math.hypot(50, 100, 150))
    about = answer["about"]["limit"]
    for limit in (answer["tilt_limit"], push["limit"], about, *answer["load_limits"]):
        near(limit)
        moved = np.array(limit["mechanism"]["box"])
        sense = math.copysign(1, moved[4])
        expected = turn * np.array([150 * sense, 0, 50, 0, sense, 0])
        assert moved == pytest.approx(expected, abs=1e-6)
    # it stands without friction
    assert (answer["friction"], answer["friction_limit"]["lower"]) == (0, 0)


def test_a_box_that_lies_over_by_45_degrees_has_its_way_back_as_a_negative_tilt() -> None:
    answer = answered(BOX, down=[1, 0, -1])
    assert answer["down"] == pytest.approx([math.sqrt(0.5), 0, -math.sqrt(0.5)])
    assert answer["tilt_deg"] == pytest.approx(TIPS - 45, rel=1e-6)
    assert TIPS - 45 - 1e-6 <= answer["tilt_upper_deg"] <= TIPS - 45 + 1e-5
    # the nearest direction that holds is at the angle at which the box tips
    assert answer["tilt_down"][0] == pytest.approx(math.sin(math.radians(TIPS)), rel=1e-6)


@pytest.mark.slow
def test_the_worst_case_of_a_box_has_the_least_base_and_the_greatest_height() -> None:
    ranges = Ranges(mass=(0.9, 1.1), center=5.0, mu=(0.5, 1.2))
    answer = answered(BOX, push=[1, 0, 0], pushed=[], ranges=ranges)["uncertainty"]
    least = (50 - 5) / (150 + 5)
    assert math.tan(math.radians(answer["tilt_deg"])) == pytest.approx(least, rel=1e-6)
    assert answer["load_factor"] == pytest.approx([-least, least], rel=1e-6)
    x, _, z = answer["worst"]["box"]["shift"]
    assert (abs(x), z) == (5, 5)
    assert answer["worst"]["box"]["mass_factor"] in (0.9, 1.1)  # the tilt is the same for both
    assert answer["corners"] == 2 * 2**3  # two masses and two shifts along each axis
    assert (answer["mass"], answer["com"], answer["mu"]) == ([0.9, 1.1], 5.0, [0.5, 1.2])


@pytest.mark.slow
def test_the_worst_case_of_normals_takes_their_angle_from_that_of_friction() -> None:
    low = Part("low", Box([100, 100, 50]), [0, 0, 25])
    ranges = Ranges(mass=(1.0, 1.0), center=0.0, mu=(0.5, 1.0), normal_deg=2.0)
    answer = answered(low, pushed=[], ranges=ranges)["uncertainty"]
    expected = math.degrees(math.atan(0.5 * MU)) - 2
    assert answer["normal_deg"] == 2
    assert 0 < answer["tilt_deg"] <= expected + 1e-6
    assert answer["tilt_deg"] == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
def test_a_slab_that_slides_has_mu_as_its_limit_and_a_bracket_from_zero() -> None:
    slab = Part("slab", Box([200, 200, 20]), [0, 0, 10])
    answer = answered(slab, push=[1, 0, 0], pushed=[], bracket=True)
    assert answer["load_factor"] == pytest.approx([-MU, MU], rel=1e-6)
    # without dilation it slides at mu, too, and without friction at once
    assert answer["load_factor_bracket"]["least"] == pytest.approx([-MU, 0], abs=1e-6)
    assert answer["load_factor_bracket"]["greatest"] == pytest.approx([0, MU], abs=1e-6)
    leaning = answered(slab, down=[0.3, 0, -1], pushed=[])
    assert leaning["friction"] == pytest.approx(0.3, rel=1e-6)
    assert leaning["friction_limit"]["lower"] == pytest.approx(0.3, rel=1e-3)
    assert leaning["friction_limit"]["lower"] <= 0.3 * (1 + 1e-9)
    assert leaning["friction_limit"]["residual"] <= 1e-9


@pytest.mark.slow
def test_the_load_at_the_end_of_a_plank() -> None:
    """A plank reaches 200 mm beyond the edge of its table, and a cube stands with 150 mm beyond."""
    plank = Part("plank", Box([1000, 100, 20]), [200, 0, 10], density=500.0)  # up to x = 700
    cube = Part("cube", Box([50, 50, 50]), [650, 0, 45], mass=0.1)
    answer = answered(plank, cube, loads=True, require="settles")
    found = {one["part"]: one for one in answer["loads"]}
    # about the edge at x = 500
    limit = (1.0 * 0.1 * 0.02 * 500 * G * 300 - 0.1 * G * 150) / 150
    assert found["cube"]["load"] == pytest.approx(limit, rel=1e-6)
    assert found["cube"]["mass"] == pytest.approx(limit / G, rel=1e-6)
    assert limit <= found["cube"]["beyond"] * (1 + 1e-9) <= limit * 1.001
    assert found["cube"]["residual"] <= 1e-9
    settles = answer["at_level"]["loads"]["cube"]
    assert settles["inside"] <= limit * (1 + 1e-6)
    assert limit * (1 - 1e-3) <= settles["outside"]
    assert settles["inside"] == pytest.approx(limit, rel=1e-2)
    # straight down on the plank itself means at its centre, which the table carries
    assert found["plank"]["load"] is None


@pytest.mark.slow
def test_a_box_settles_up_to_each_limit_of_equilibrium() -> None:
    """A box on a table has a single way to stand: forces of equilibrium are those of rest."""
    answer = answered(BOX, push=[1, 0, 0], about=[0, 1, 0], require="settles", loads=True)
    limits, arm = answer["at_level"], math.hypot(50, 150)
    expected = {
        "tilt_deg": TIPS, "about_deg": TIPS, "pushes": WEIGHT * 50 / arm, "load_factor": 1 / 3,
    }  # fmt: skip
    for key, value in expected.items():
        found = limits[key]
        found = found[1] if key == "load_factor" else found["box"] if key == "pushes" else found
        assert found["inside"] == pytest.approx(value, rel=1e-3), key
        assert found["inside"] <= value * (1 + 1e-9), key
        assert found["outside"] >= value * (1 - 1e-9), key
    assert limits["friction"]["inside"] == 0


@pytest.mark.parametrize("angle", [1e-3, 2e-5, 5e-6])
def test_a_push_above_a_hundred_thousand_weights_is_unlimited(angle: float) -> None:
    """A board that is pushed up a slope of this angle less than that at which friction jams it."""
    steep = math.pi / 2 - math.atan(MU) - angle
    high, aside = 200.0, 200.0 / math.tan(steep)
    board = Prism([(0, 0), (1000, 0), (1000 + aside, high), (0, high)], 1000)
    wall = Prism([(1000, 0), (4000, 0), (4000, high), (1000 + aside, high)], 1000)
    parts = [
        block("base", [-5000, -5000, -10], [5000, 5000, 0], grounded=True),
        Part("board", board, density=2000.0),
        Part("wall", wall, grounded=True),
    ]
    assembly = Assembly(parts, units="mm", friction=MU)
    push = find_push(program_of(assembly), 1, np.array([1.0, 0.0, 0.0]))
    most = 1 / math.tan(angle)
    expected = most * assembly["board"].mass * G if most < 1e5 else math.inf
    assert push.force == pytest.approx(expected, rel=1e-6)
