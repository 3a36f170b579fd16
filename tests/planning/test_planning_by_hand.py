"""Numbers of the answers of `kilter.plan` and `kilter.hold`, in millimetres, by hand."""

import math

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose, Prism, Strap, Support
from kilter.scenes.pieces import block

G = 9.81


@pytest.mark.parametrize("at", [200, 350])
def test_a_prop_carries_a_plank_by_its_lever(at):
    """A plank of 1.2 kg with its centre at x = 100 lies on a ridge at -100 and on the prop."""
    triangle = [[-100, -100], [100, -100], [0, 0]]
    ridge = Part("ridge", Prism(triangle, 400.0), Pose([-100, 0, 0]), grounded=True)
    plank = Part("plank", Box([600, 200, 20]), [100, 0, 10], density=500.0)
    prop = Support("prop", "plank", [at, 0, 0])
    assembly = Assembly([ridge, plank], units="mm", friction=0.3)
    answer = kilter.hold(assembly, candidates=[prop], most=3).to_dict()
    (support,) = answer["supports"]
    assert support["force"] == pytest.approx([0, 0, 1.2 * G * 200 / (at + 100)], abs=1e-9)
    assert support["point"] == [at, 0, 0]
    assert (answer["candidates"], answer["most"], answer["least"]) == (1, 3, 1)


def test_a_magnet_pulls_with_the_weight_along_its_direction():
    table = block("table", [-500, -500, -10], [500, 500, 0], grounded=True)
    hung = Part("hung", Box([100, 100, 100]), [0, 0, 300], mass=0.7)
    magnet = Support("magnet", "hung", [0, 0, 350], [0, 0, -1], mu=0.2, capacity=9.0)
    (support,) = kilter.hold(
        Assembly([table, hung], units="mm"), candidates=[magnet], require="equilibrium"
    ).to_dict()["supports"]
    assert support["force"] == pytest.approx([0, 0, 0.7 * G], abs=1e-9)
    assert (support["capacity"], support["mu"], support["direction"]) == (9.0, 0.2, [0, 0, -1])


@pytest.mark.parametrize("up", [250, 400])
def test_a_strap_pulls_against_a_load_by_its_slope(up):
    """Without friction the level part of the pull is the load, whatever the strap lifts."""
    table = block("table", [-2000, -2000, -10], [2000, 2000, 0], grounded=True)
    cube = Part("cube", Box([500, 500, 500]), [0, 0, 250], mass=100)
    strap = Strap([("ground", [2000, 0, up]), ("cube", [250, 0, 250])], capacity=700.0)
    load = Load("cube", force=[-300, 0, 0])
    assembly = Assembly([table, cube], units="mm", loads=[load])
    answer = kilter.hold(assembly, straps=[strap], require="equilibrium").to_dict()
    (found,) = answer["straps"]
    assert found["pull"] == pytest.approx(300 * math.hypot(1750, up - 250) / 1750)
    assert (found["candidate"], found["capacity"], found["tension"]) == (1, 700, None)


def test_no_order_exists_for_a_cube_that_turns_about_an_edge():
    """The stated motion is a turn about the edge at x = 0, the centre being 100 past it."""
    table = block("table", [-3000, -1000, -1000], [0, 1000, 0], grounded=True)
    past = block("past", [-400, -500, 0], [600, 500, 1000], density=500.0)
    impossible = kilter.plan(Assembly([table, past], units="mm")).to_dict()["impossible"]
    (motions,) = impossible["motions"]
    motion = np.array(motions["past"])
    turn = 1 / math.hypot(100, math.sqrt(3) * 500)  # the fastest part moves by 1 mm
    assert motion == pytest.approx(turn * np.array([0, 0, -100, 0, 1, 0]), abs=1e-9)


COUNTERWEIGHT = Assembly(
    [
        block("base", [-500, -500, -10], [0, 500, 0], grounded=True),
        Part("plank", Box([600, 200, 20]), [100, 0, 10], density=500.0),
        Part("weight", Box([100, 100, 100]), [-150, 0, 70], mass=2.0),
    ],
    units="mm",
)
"""A plank of 1.2 kg with its centre 100 mm past the edge, held down by 2 kg 150 mm behind it."""


def test_a_plank_is_held_until_its_counterweight_lies_on_it():
    plan = kilter.plan(COUNTERWEIGHT).to_dict()
    assert [step["parts"] for step in plan["steps"]] == [["plank"], ["weight"]]
    # while the weight is put down; the part that moves is carried in any case
    assert [step["held"] for step in plan["steps"]] == [[], ["plank"]]
    assert (plan["held_steps"], plan["holds_max"], plan["turns"]) == (1, 1, 0)
    for step in plan["steps"]:
        assert step["down"] == [0, 0, -1]
        path = np.array(step["path"])
        assert path[-1] == pytest.approx([0, 0, 0])
        moved = path[-1] - path[-2]
        assert moved / np.linalg.norm(moved) == pytest.approx(step["direction"])
    without = kilter.plan(COUNTERWEIGHT, kilter.PlanRules(hold=0)).to_dict()
    assert (without["verdict"], without["impossible"]["holds"]) == ("impossible", 0)
