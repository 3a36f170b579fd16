"""Numbers of the answer of `kilter.check`, in millimetres, against statics and dynamics by hand."""

import json
import math

import numpy as np
import pytest
import stranger

import kilter
from kilter import Assembly, Box, Joint, Part, Pose, Prism
from kilter.scenes.pieces import block

G = 9.81
TABLE = block("table", [-3000, -1000, -1000], [0, 1000, 0], grounded=True)
PAST = block("past", [-400, -500, 0], [600, 500, 1000], density=500.0)
"""A cube whose centre is .1 m past the edge of the table."""
SHELF = block("shelf", [-2000, -500, 0], [-1000, 500, 1000], density=1500.0)


def test_a_cube_past_the_edge_turns_about_it():
    assembly = Assembly([TABLE, PAST, SHELF], units="mm")
    verdict = kilter.check(assembly)
    answer = verdict.to_dict()
    table, past, shelf = answer["parts"]
    assert [part["mass"] for part in answer["parts"]] == pytest.approx([6000, 500, 1500])
    assert answer["density"] == {"given": [500, 1500], "default": None}
    # the centre is at (.1, .5) from the edge, and moves at right angles to this arm
    turn = 0.1 * G / (1 / 6 + 0.1**2)
    assert past["acceleration"] == pytest.approx([0, 0, -0.1 * turn, 0, turn, 0], abs=1e-9)
    radius = math.sqrt(3) / 2
    assert past["relative"] == pytest.approx([0.1 * turn / G, radius * turn / G])
    assert shelf["acceleration"] == pytest.approx([0] * 6, abs=1e-9)
    assert table["relative"] == [0, 0]
    # kappa^2 = power of gravity / (g^2 x mass of all free parts)
    power = 500 * G * 0.1 * turn
    assert answer["instability"] == pytest.approx(math.sqrt(power / (2000 * G**2)))
    # a shift of the centre by 1 mm downwards is the greatest that (9) admits
    assert answer["z"] == pytest.approx(-500)
    assert past["displacement"] == pytest.approx([0, 0, -1, 0, 1 / 100, 0], abs=1e-9)
    # two cubes on level faces: three level motions each; one gains what lifts the other, so the
    # motions without power span all but one of 12 dimensions
    assert answer["contacts"] == {"pairs": 2, "patches": 2, "points": 8}
    assert answer["neutral"] == {"two_sided": 3 + 3, "one_sided": 12 - 1 - 6}
    proof = json.loads(json.dumps(verdict.proof()))
    opening, in_millimetres = stranger.opening_and_power(proof)
    assert opening >= -answer["certificate"]["violation"] - 1e-15
    # the motion has a speed of 1 mm/s, and the power is that at 1 m/s
    assert answer["certificate"]["power"] == pytest.approx(in_millimetres)
    assert kilter.verify(assembly, proof).to_dict()["power"] == pytest.approx(in_millimetres)
    speed = np.linalg.norm(proof["motion"]["past"] * np.repeat([1, radius * 1000], 3))
    assert speed == pytest.approx(1)


@pytest.mark.parametrize("at", [-300, 300])
def test_a_beam_on_two_ridges_presses_on_each_by_its_lever(at):
    """Ridges at x = -1000 and 2000; a beam of 100 kg with its centre at `at`."""
    ridge = [[-100, -100], [100, -100], [0, 0]]
    left, right = (
        Part(name, Prism(ridge, 400.0), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", -1000), ("right", 2000))
    )
    beam = Part("beam", Box([5000, 200, 200]), [at, 0, 100], density=500.0)
    forces = kilter.check(Assembly([left, right, beam], units="mm", friction=0.5)).to_dict()[
        "forces"
    ]
    weight = 100 * G
    for patch, x, share in zip(
        forces["patches"], (-1000, 2000), ((2000 - at) / 3000, (at + 1000) / 3000), strict=True
    ):
        assert patch["parts"][1] == "beam"
        assert patch["resultant"] == pytest.approx([0, 0, share * weight], abs=1e-6)
        assert patch["normal_force"] == pytest.approx(share * weight)
        assert patch["center"] == pytest.approx([x, 0, 0], abs=1e-6)
        assert np.sum(patch["forces"], axis=0) == pytest.approx(patch["resultant"], abs=1e-9)
        assert np.array(patch["points"])[:, [0, 2]] == pytest.approx(
            np.tile([x, 0], (len(patch["points"]), 1)), abs=1e-9
        )
        assert np.abs(np.array(patch["points"])[:, 1]).max() == pytest.approx(100)


@pytest.mark.slow
def test_a_block_that_only_a_squeeze_holds_falls_freely():
    """Between vertical walls nothing presses it against them: its motion has all of the power."""
    friction = kilter.check(kilter.example("squeezed-block"), require="proved").to_dict()[
        "friction"
    ]
    assert friction["witness"]["power"] == pytest.approx(1)
    assert friction["witness"]["residual"] <= 1e-9
    seating = friction["seating"]
    # as the springs of the contacts give way, none of the weight is borne, up to a hundredth
    assert seating["residual"] == pytest.approx(1, abs=1e-2)
    assert seating["direction"][-1][2] == pytest.approx(-G, rel=1e-2)
    rests = kilter.check(Assembly([TABLE, SHELF], units="mm"), down=[0.3, 0, -1], friction=0.5)
    assert rests.to_dict()["friction"]["seating"]["residual"] <= 1e-9


@pytest.mark.slow
def test_the_motion_of_a_balanced_ball_is_a_fall_along_the_ball_below():
    """A pendulum upside down: u^2 / (R + r) is what the centre sinks by to second order."""
    below = Part("below", kilter.Sphere(300.0), Pose([0, 0, 0]), grounded=True)
    above = Part("above", kilter.Sphere(100.0), Pose([0, 0, 400]))
    second = kilter.check(Assembly([below, above], units="mm")).to_dict()["second_order"]
    motion = np.array(second["motion"]["above"])
    assert motion[2] == pytest.approx(0, abs=1e-9)
    assert np.linalg.norm(motion[:2]) > 0.5 * np.linalg.norm(motion) / 100  # it does not only spin
    # two level shifts of the centre, and three turns about it, cost nothing to first order
    assert second["neutral"] == 5


MOMENT = 1.2 * G * 300
"""Moment of a beam of 1.2 kg whose centre is 300 mm beside its hinge [N mm]."""


@pytest.mark.parametrize(
    ("more", "held", "known"),
    [
        ({"limits": [-1, 0]}, True, {"stop": -MOMENT}),
        ({"limits": [0, 1]}, False, {}),
        ({"friction": 1.01 * MOMENT}, True, {"friction": -MOMENT}),
        ({"friction": 0.99 * MOMENT}, False, {}),
        ({"stiffness": 10 * MOMENT, "rest": -0.1}, True, {"spring": -MOMENT}),
        (
            {"stiffness": 10 * MOMENT, "rest": -0.09, "friction": 0.2 * MOMENT},
            True,
            {"spring": -0.9 * MOMENT, "friction": -0.1 * MOMENT},
        ),
    ],
)
def test_a_beam_on_a_hinge_is_held_by_its_stop_its_friction_or_its_spring(more, held, known):
    """It turns downwards about +y; the torques are those on the beam, the first part."""
    beam = Part("beam", Box([600, 100, 40]), [300, 0, 0], density=500.0)
    hinge = Joint(("beam", "ground"), "revolute", point=[0, 0, 0], axis=[0, 1, 0], **more)
    assembly = Assembly([beam], units="mm", joints=[hinge])
    answer = kilter.check(assembly, require="equilibrium").to_dict()
    assert (answer["verdict"] != "unstable") is held
    assert {key: answer["joints"][0][key] for key in more} == more
    if held:
        (torques,) = answer["forces"]["joints"]
        expected = dict.fromkeys(("stop", "friction", "spring"), 0.0) | known
        assert {key: torques[key] for key in expected} == pytest.approx(expected, abs=1e-6)
