"""Parts that roll, tip over an edge, or ride on a turning part."""

from dataclasses import replace

import numpy as np
import pytest
from balance_cases import GRIP, ROLLING, Case

import kilter
from kilter import Assembly, Box, Cylinder, FrictionPair, Joint, Part, Pose, Prism, Sphere
from kilter.mechanics.program import Program, build_program
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.motions.rolling import Rolling, find_rolling, rolling_shifts

OFF = 1e-6


def rolling_case(number: str) -> Case:
    return next(case for case in ROLLING if case.number == number)


def rolled(assembly: Assembly) -> tuple[Program, Rolling]:
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return program, find_rolling(program, features_of(program, contacts), assembly)


def in_the_plane(assembly: Assembly, mu: float = GRIP) -> Assembly:
    """Each pair of parts on its first contact, in the plane y = 0."""
    first = {one.parts: one for one in reversed(assembly.contacts)}
    contacts = list(first.values())
    return Assembly(assembly.parts, contacts=contacts, friction=mu, planar=True, detect=False)


@pytest.mark.parametrize("number", ["R1", "R3", "R7", "R8"])
def test_in_the_plane_both_sides_of_a_limit_are_proved(number):
    case = rolling_case(number)
    assert case.limit is not None
    for off, state in ((-OFF, "holds"), (OFF, "falls")):
        _, found = rolled(in_the_plane(case.build(case.limit + off)))
        assert (found.state, found.dimension) == (state, 1)


@pytest.mark.parametrize(("number", "state"), [("R4", "falls"), ("R5", "holds")])
def test_a_ball_rolls_off_a_ball_and_back_in_a_bowl(number, state):
    assert rolled(in_the_plane(rolling_case(number).build(0.0)))[1].state == state


@pytest.mark.parametrize("number", ["R2", "R3", "R6"])
def test_in_space_falling_is_proved_above_a_limit_and_nothing_below(number):
    """Below it the energy rises, but its rolling depends on the path, which is not modelled."""
    case = rolling_case(number)
    assert case.limit is not None
    assert rolled(case.build(case.limit + OFF))[1].state == "falls"
    below = rolled(case.build(case.limit - OFF))[1]
    assert below.state == "open"
    assert below.why == "its rolling depends on the path, which is not modelled"
    assert below.curvature > -1e-9


@pytest.mark.slow
def test_a_board_across_a_cylinder_rolls_one_way_in_space_too():
    """It rests on two points; a squeeze along their line changes neither result."""
    case = rolling_case("R1")
    assert case.limit is not None
    for off, state in ((-OFF, "holds"), (OFF, "falls")):
        board = case.build(case.limit + off)
        _, found = rolled(board)
        assert (found.state, found.dimension) == (state, 1)
        proof = kilter.check(board).proof()
        assert proof["second_order"]["rolling"] == state
        assert kilter.verify(board, proof).holds


def test_a_hook_falls_over_sideways_in_space():
    """Its limit is for its own plane; across the plane it rolls on its thin wire."""
    case = rolling_case("R8")
    assert case.limit is not None
    assert rolled(case.build(case.limit - 0.1))[1].state == "falls"


def test_a_board_on_two_rollers_does_not_roll():
    _, found = rolled(rolling_case("R9").build(0.0))
    assert (found.state, found.dimension) == ("open", 0)
    assert "not unique" in found.why


@pytest.mark.parametrize("h", [0.3, 0.6, 0.9])
def test_the_energy_of_a_rocking_stone_curves_as_its_height_does(h):
    """Rolled by p on a hill of radius R, it has turned by p (R + r) / r."""
    hill, stone = 1.0, 2.0

    def height(p: float) -> float:
        return (hill + stone) * np.cos(p) - (stone - h) * np.cos(p * (hill + stone) / stone)

    step = 1e-3
    curved = (height(step) - 2 * height(0.0) + height(-step)) / step**2
    turn = (hill + stone) / stone  # of the stone, for each of p
    program, found = rolled(in_the_plane(rolling_case("R3").build(h)))
    free = int(np.flatnonzero(program.free)[0])
    unit = float(program.weight[free] * program.radius[free])
    own = found.curvature * unit / found.motion[free, 4] ** 2
    assert own == pytest.approx(float(program.weight[free]) * curved / turn**2, rel=1e-5)


@pytest.mark.parametrize(("mu", "state"), [(0.4, "open"), (0.45, "holds")])
def test_what_slips_at_once_is_not_said_to_hold(mu, state):
    """A weeble on a slope of .4 needs a coefficient of tan(.4) = .423."""
    assert rolled(in_the_plane(rolling_case("R7").build(0.5), mu))[1].state == state


@pytest.mark.slow
def test_a_check_says_whether_friction_holds():
    board = rolling_case("R1")
    low, high = (kilter.check(in_the_plane(board.build(h))) for h in (0.9, 1.1))
    for verdict in (low, high):
        assert verdict.second_order_answer is not None
        assert verdict.second_order_answer.state == "balanced"
    assert low.to_dict()["second_order"]["rolling"] == "holds"
    assert "friction holds b against small pushes" in low.sentence
    assert high.to_dict()["second_order"]["rolling"] == "falls"
    assert "friction cannot hold it" in high.sentence
    assert kilter.check(in_the_plane(board.build(0.9)), require="strict").stable
    assert not kilter.check(in_the_plane(board.build(1.1)), require="strict").stable
    slick = kilter.check(in_the_plane(board.build(0.9), 0.0))
    assert slick.to_dict()["second_order"]["rolling"] is None
    assert "unless friction holds it" in slick.sentence


@pytest.mark.parametrize(("play", "expected"), [(0.0, 0.0), (1e-14, 0.0), (1e-3, 1e3)])
def test_equal_curvatures_shift_no_contact_up_to_their_rounding(play, expected):
    """A ball in a socket of nearly one radius: the inverse of the difference of curvatures."""
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    ball = Part("ball", Sphere(1), Pose([0, 0, 1]))
    assembly = Assembly([floor, ball], friction=0.5)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    features = features_of(program, contacts)
    round_side = features.curvature_a + features.curvature_b
    close = replace(features, curvature_a=round_side, curvature_b=-round_side * (1 - play))
    found = rolling_shifts(program, close)
    assert np.abs(found).max() == pytest.approx(expected, rel=1e-6)


TABLE = Part("table", Box([20, 9, 1]), Pose([0, 0, -0.5]), grounded=True)


@pytest.mark.parametrize(("inside", "verdict"), [(0.0, "potentially-stable"), (1e-3, "stable")])
def test_a_box_on_a_slope_tips_if_its_weight_acts_above_its_lower_edge(inside, verdict):
    """Its energy falls by W h (1 - cos phi): friction holds its edge, not its tilt."""
    slope = np.arctan(0.3)
    down = 9.81 * np.array([np.sin(slope - inside), 0, -np.cos(slope - inside)])
    box = Part("box", Box([2 * 0.3, 2, 2]), Pose([0, 0, 1]))
    found = kilter.check(Assembly([TABLE, box], friction=0.6, gravity=down))
    assert found.verdict == verdict
    if inside == 0.0:
        assert "edge" in found.sentence


@pytest.mark.parametrize("mu", [0.0, 0.5])
@pytest.mark.parametrize(("off", "verdict"), [(1.0, "potentially-stable"), (0.99, "stable")])
def test_the_top_of_a_high_stack_tips_as_that_of_a_low_one(off, verdict, mu):
    stack = [Part(f"b{k}", Box([2, 2, 1]), Pose([0, 0, k + 0.5])) for k in range(24)]
    top = Part("top", Box([2, 2, 1]), Pose([off, 0, 24.5]))
    assert kilter.check(Assembly([TABLE, *stack, top], friction=mu)).verdict == verdict


@pytest.mark.quick("roof-potentially-stable")
@pytest.mark.parametrize(
    ("beside", "verdict"),
    [
        (Part("wall", Box([1, 4, 4]), Pose([1.5, 0, 2]), grounded=True), "stable"),
        (Part("roof", Box([4, 4, 1]), Pose([2, 0, 2.5]), grounded=True), "potentially-stable"),
        (Part("weight", Box([1, 1, 1]), Pose([-0.5, 0, 2.5])), "stable"),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_what_touches_a_box_above_an_edge_counts(beside, verdict):
    """The box turns down to the right: a roof above its right half opens, a wall stops it."""
    shelf = Part("shelf", Box([4, 4, 1]), Pose([-2, 0, -0.5]), grounded=True)
    box = Part("box", Box([2, 2, 2]), Pose([0, 0, 1]))
    turn = [np.cos(0.1), 0, np.sin(0.1), 0]
    along = np.array([np.sin(0.2), 0, np.cos(0.2)])
    ramp = Part("ramp", Box([4, 4, 1]), Pose([30, 0, 0], turn), grounded=True)
    rider = Part("rider", Box([1, 1, 1]), Pose(np.array([30, 0, 0]) + along, turn))
    found = kilter.check(Assembly([shelf, box, beside, ramp, rider], friction=0.5))
    assert found.verdict == verdict


def test_the_overhanging_brick_at_the_end_of_a_wall_tips():
    """The rows are half a brick apart, so that the last brick of the top row is above an edge."""
    floor = Part("floor", Box([19, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    bricks = [
        Part(f"{row} {k}", Box([2, 1, 1]), Pose([2 * k + row % 2, 0, row + 0.5]))
        for row in range(6)
        for k in range(-2, 2)
    ]
    found = kilter.check(Assembly([floor, *bricks], friction=0.5))
    assert found.verdict == "potentially-stable"
    assert "5 1" in found.sentence


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


def test_a_box_uphill_on_a_turntable_is_not_stable():
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


@pytest.mark.quick(1)
@pytest.mark.parametrize("beside", [False, True])
def test_a_prism_on_its_edge_is_not_stable_whatever_stands_beside_it(beside):
    found = kilter.check(prism_on_its_edge(beside=beside))
    assert found.level == "equilibrium"
