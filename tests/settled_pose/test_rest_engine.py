"""Rules of the engine that brings bodies to rest: a closed form, or both sides of each limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Load, Mesh, Part, Pose, settle
from kilter.analysis.settled_pose import closing_motion, rest_engine
from kilter.analysis.settled_pose.candidate_points import CandidatePoints
from kilter.analysis.settled_pose.closing_motion import sunk_depths
from kilter.analysis.settled_pose.descent import Descent
from kilter.analysis.settled_pose.rest_search import SearchResult
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.shape.primitives import hull_surface

FLOOR = Part("floor", Box([2, 2, 0.1]), [0, 0, -0.05], grounded=True)
WALL = Part("wall", Box([0.1, 2, 1]), [-0.05, 0, 0.5], grounded=True)
LONG, WIDE = 0.2, 0.05


def leaning(tilt: float, sunk: float, gap: float, friction: float) -> Assembly:
    """A rod, tilted by an angle [rad], sunk into the floor, and apart from the wall by a gap."""
    turn = Rotation.from_rotvec([0, -tilt, 0])
    half = np.array([WIDE, WIDE, LONG]) / 2
    reach = np.abs(turn.as_matrix()) @ half
    pose = Pose([reach[0] + gap, 0, reach[2] - sunk], turn.as_quat(scalar_first=True))
    return Assembly([FLOOR, WALL, Part("rod", Box(2 * half), pose)], friction=friction)


# steps ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("friction", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("tilt", [0.4, 0.8, 1.1])
@pytest.mark.parametrize("gap", [0.0, 1e-5])
def test_a_step_leads_into_no_overlap_also_if_its_sliding_is_not_found(friction, tilt, gap):
    """The openings of sliding contacts may not converge; the foot was led .67 of the step deep."""
    sunk, stride = 1e-4, 1e-2
    bodies = rigid_bodies(leaning(tilt, sunk, gap, friction), ())
    points = CandidatePoints.of(bodies).near(bodies, 3 * stride)
    program = Descent.of(bodies, points, np.array([False, True]), 1.0, 1.0)
    step = program.step(np.array([0, stride]), points.gap <= 1.5 * stride)
    assert step is not None
    room = points.gap + program.normal @ step[1]
    assert room.min() >= -1.01 * sunk


@pytest.mark.parametrize("tilt", [0.2, 0.3, 0.4, 0.5])
@pytest.mark.parametrize("change", [-1e-6, 0.0, 1e-6])
def test_overlaps_that_friction_all_but_wedges_open_without_friction(tilt, change):
    """A rod is sunk into both sides of a slot, at the angle of friction; it turned by 4 rad."""
    sunk, stride = 1e-3, 1e-2
    half = np.cos(tilt) / 2 - sunk
    walls = [Part(f"wall {s}", Box([0.2, 1, 2]), [s * (half + 0.1), 0, 0], grounded=True)
             for s in (-1, 1)]  # fmt: skip
    turn = Rotation.from_rotvec([0, tilt, 0]).as_quat(scalar_first=True)
    rod = Part("rod", Box([1, 0.2, 1e-4]), Pose([0, 0, 0], turn))
    bodies = rigid_bodies(Assembly([*walls, rod], friction=np.tan(tilt) * (1 + change)), ())
    points = CandidatePoints.of(bodies).near(bodies, 3 * stride)
    program = Descent.of(bodies, points, np.array([False, True]), 1.0, 1.0)
    step = program.step(np.array([0, stride]), points.gap <= 1.5 * stride)
    assert step is not None
    assert np.abs(step).max() <= 3 * stride
    assert (points.gap + program.normal @ step[1]).min() >= -0.01 * sunk


# sunk groups ------------------------------------------------------------------------------------


def stone() -> Assembly:
    """A stone on the floor that leans on a held can and on a free frustum, sunk by at most .3 mm.

    It has a pose at rest within .3 mm, and another one after tipping by 16 deg.
    """
    corners = [[0.04966, 0.04686, 0.01172], [0.07205, 0.02625, 0.06004],
               [0.09892, 0.05755, 0.04462], [0.10199, 0.04749, 0.03091],
               [0.09558, 0.03882, -0.00023], [0.05143, 0.07704, 0.04701]]  # fmt: skip
    frustum = [[-0.0009, -0.0032, -0.0001], [0.0302, -0.0166, -0.0001], [0.0601, -0.0006, -0.0001],
               [0.0662, 0.0327, -0.0001], [0.044, 0.0583, -0.0001], [0.0102, 0.0569, -0.0001],
               [-0.0098, 0.0295, -0.0001], [0.0095, 0.0059, 0.0469], [0.0296, -0.0028, 0.0469],
               [0.0489, 0.0075, 0.0469], [0.0529, 0.029, 0.0469], [0.0386, 0.0456, 0.0469],
               [0.0167, 0.0446, 0.0469], [0.0038, 0.027, 0.0469]]  # fmt: skip
    can = Part("can", Cylinder(0.018127, 0.026857), [0.05183, 0.07751, 0.01324], grounded=True)
    free = [
        Part(name, Mesh(*hull_surface(np.array(points))))
        for name, points in (("frustum", frustum), ("stone", corners))
    ]
    return Assembly([FLOOR, can, *free], friction=0.946)


def test_a_sunk_stone_comes_to_rest_where_it_is():
    answer = settle(stone(), require="equilibrium")
    assert answer.at_rest
    assert answer.rounds == 0
    assert {way.how for ways in answer.ways for way in ways} == {"pushed-out"}
    bodies = rigid_bodies(stone(), ())
    depth = sunk_depths(bodies, CandidatePoints.of(bodies).near(bodies, 1e-3))[bodies.of_part]
    assert (answer.distance <= 3 * depth).all()
    assert kilter.verify(answer.assembly, answer.proof()).holds


def test_a_heavy_bin_moves_less_than_what_is_sunk_into_it():
    """A cube is sunk between a bin of 20 times its mass and a held block: the cube moves."""
    sunk = 1e-4
    bin_ = Part("bin", Box([0.4, 0.4, 0.02]), [0, 0, 0.01], mass=20.0)
    cube = Part("cube", Box([0.1, 0.1, 0.1]), [0, 0, 0.07 - sunk], mass=1.0)
    answer = settle(Assembly([FLOOR, bin_, cube], friction=0.5))
    assert answer.at_rest
    assert answer.movement[1:, 2] == pytest.approx([0.0, sunk], abs=1e-8)


def test_a_light_bin_on_the_floor_stays_where_a_heavy_cube_is_sunk_into_its_side():
    """The cube is sunk a hundred times deeper than the bin, which only touches the floor there."""
    bin_ = [Part("base", Box([0.4, 0.4, 0.02]), [0, 0, 0.01 - 1e-5], mass=1.0),
            Part("side", Box([0.02, 0.4, 0.2]), [-0.19, 0, 0.12 - 1e-5], mass=0.5)]  # fmt: skip
    cube = Part("cube", Box([0.1, 0.1, 0.1]), [-0.13 - 1e-3, 0, 0.07 - 2e-5], mass=20.0)
    drawn = Assembly([FLOOR, *bin_, cube], friction=0.5)
    answer = settle(replace(drawn, joints=[Joint(("base", "side"), "fixed")]))
    assert answer.at_rest
    assert answer.movement[[1, 3], 0] == pytest.approx([0.0, 1e-3], abs=1e-4)


def test_a_light_plate_moves_at_most_three_times_its_sunk_depth():
    """A block of 150 times its mass is sunk into its rib ten times deeper than it is itself.

    By mass alone the plate would move five times its depth.
    """
    low, deep = 1e-5, 1e-4
    plate = [Part("plate", Box([0.2, 0.2, 0.02]), [0, 0, 0.01 - low], mass=1.0),
             Part("rib", Box([0.02, 0.2, 0.1]), [-0.09, 0, 0.07 - low], mass=0.1)]  # fmt: skip
    block = Part("block", Box([0.1, 0.1, 0.1]), [-0.03 - deep, 0, 0.07 - 2 * low], mass=150.0)
    joint = Joint(("plate", "rib"), "fixed")
    answer = settle(Assembly([FLOOR, *plate, block], joints=[joint], friction=0.3))
    assert answer.at_rest
    assert answer.distance[1] <= 3 * low
    assert answer.movement[[1, 3], 0] @ [-1, 1] == pytest.approx(deep, abs=1e-8)


@pytest.mark.parametrize(("many", "searches"), [(2, 2), (1, 1)])
def test_the_least_motion_of_many_bodies_is_not_repeated(many, searches, monkeypatch):
    """The search moves the only body by more than three times its depth, so it is repeated."""
    bodies = rigid_bodies(Assembly([FLOOR, Part("cube", Box([0.1, 0.1, 0.1]), [0, 0, 0.05])]), ())
    found = []

    def far(bodies, **asked):
        found.append(asked["inertia"])
        return SearchResult("at-rest", bodies.moved(np.array([[0.0] * 6, [1e-3] + [0.0] * 5])), 1)

    monkeypatch.setattr(closing_motion, "MANY", many)
    monkeypatch.setattr(closing_motion, "search_rest", far)
    closing_motion.least_motion(bodies, 1e-2, CandidatePoints.of(bodies).near, np.array([0, 1e-4]))
    assert len(found) == searches


def test_sunk_depths_are_summed_down_to_the_ground():
    """Two boxes on the floor are sunk into each other; a third lies on one of them."""
    box = Box([0.1, 0.1, 0.1])
    parts = [Part("left", box, [0, 0, 0.05 - 1e-4]), Part("right", box, [0.099, 0, 0.05 - 2e-4]),
             Part("top", box, [-0.03, 0, 0.15 - 5e-4])]  # fmt: skip
    bodies = rigid_bodies(Assembly([FLOOR, *parts]), ())
    points = CandidatePoints.of(bodies).near(bodies, 1e-3)
    depth = sunk_depths(bodies, points)
    assert depth == pytest.approx([0.0, 1.1e-3, 1.2e-3, 1.5e-3], rel=1e-6)


@pytest.mark.parametrize(("overhang", "state"), [(0.49, "at-rest"), (0.51, "partly")])
@pytest.mark.slow
def test_a_sunk_stack_rests_or_falls_on_both_sides_of_its_edge(overhang, state):
    sunk = 3e-4
    table = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)
    low = Part("low", Box([1, 1, 1]), [1.5, 0, 0.5 - sunk])
    upper = Part("upper", Box([1, 1, 1]), [1.5 + overhang, 0, 1.5 - 2 * sunk])
    answer = settle(Assembly([table, low, upper], friction=0.8), require="equilibrium")
    assert answer.state == state
    if state == "at-rest":
        assert answer.movement[1:, 2] == pytest.approx([sunk, 2 * sunk], abs=1e-8)
    else:
        assert answer.leaves == ("upper",)


def test_overlaps_deeper_than_those_of_soft_contacts_are_pushed_out_by_the_engine():
    """A cube in a table by .04 of its size moves up as sunk, one by .2 as an overlap: the same."""
    for depth in (0.04, 0.2):
        table = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)
        cube = Part("cube", Box([1, 1, 1]), [0, 0, 0.5 - depth])
        answer = settle(Assembly([table, cube]))
        assert answer.at_rest
        assert answer.movement[1, :3] == pytest.approx([0, 0, depth], abs=1e-8)


def test_the_engine_searches_again_if_the_verification_refuses_the_least_motion(monkeypatch):
    """The least motion leaves the box .1 above the table: a fault that the verification finds."""
    from kilter.analysis.settled_pose import rest_engine as module

    run = module.least_motion

    def lifts(bodies, reach, near, depth):
        found = run(bodies, reach, near, depth)
        return replace(
            found, bodies=found.bodies.moved(np.array([[0.0] * 6, [0, 0, 0.1, 0, 0, 0]]))
        )

    monkeypatch.setattr(module, "least_motion", lifts)
    drawn = Assembly([FLOOR, Part("cube", Box([0.1, 0.1, 0.1]), [0, 0, 0.05 - 1e-4])])
    answer = settle(drawn)
    assert answer.at_rest
    assert answer.movement[1] == pytest.approx([0, 0, 1e-4, 0, 0, 0], abs=1e-9)
    assert kilter.scene(drawn, settle=True).at_rest


# groups -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", [8.0, 12.0, 20.0])
def test_a_jammed_rod_turns_little_more_than_it_must(tilt):
    """A rod of 100 mm between walls 88 mm apart turns until it fits; it was turned by 177 deg."""
    walls = [Part(f"wall {s}", Box([0.02, 0.2, 0.4]), [s * 0.054, 0, 0], grounded=True)
             for s in (-1, 1)]  # fmt: skip
    turn = Rotation.from_euler("y", tilt, degrees=True).as_quat(scalar_first=True)
    rod = Part("rod", Box([0.1, 0.05, 0.01]), Pose([0, 0, 0], turn))
    [way] = settle(Assembly([*walls, rod])).ways[2]
    diagonal = np.hypot(0.1, 0.01)
    needed = np.degrees(np.arccos(0.088 / diagonal) + np.arctan(0.1)) - tilt
    assert way.how == "pushed-out"
    assert needed <= way.angle_deg <= 1.25 * needed


# steps without a descent ------------------------------------------------------------------------


def cube_on_floor(*loads: Load) -> tuple[rest_engine._State, rest_engine._Last]:
    """A cube that rests on the floor and counts as moving, and its last step."""
    drawn = Assembly([FLOOR, Part("cube", Box([0.1, 0.1, 0.1]), [0, 0, 0.05])], loads=loads)
    bodies = rigid_bodies(drawn, ())
    state = rest_engine._begin(bodies, kilter.contacts(drawn), lambda stage: None)
    last = rest_engine._Last(bodies, np.array([-1, 1]), state.stride, np.zeros(2), np.zeros(2))
    return state, last


def test_a_step_that_is_taken_back_is_no_descent():
    state, last = cube_on_floor()
    state.bodies = state.bodies.moved(np.array([[0.0] * 6, [0, 0, -0.01, 0, 0, 0]]))
    points = rest_engine._points(state, 1e-3)
    lowest = np.array([0.0, 0.01])
    assert rest_engine._taken_back(state, last, points, lowest)
    assert state.bodies.center[1] == pytest.approx([0, 0, 0.05])
    assert lowest.tolist() == [0.0, 0.0]
    assert not rest_engine._taken_back(state, last, rest_engine._points(state, 1e-3), lowest)


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("steps", [rest_engine.STANDS, rest_engine.STANDS + 1])
def test_a_body_without_a_load_stands_still_after_some_steps_without_a_descent(loaded, steps):
    """The first step sets the height, from which no further one descends."""
    state, last = cube_on_floor(*[Load("cube", force=[1, 0, 0])][:loaded])
    lowest, stalled = np.full(2, -np.inf), np.zeros(2, dtype=np.int64)
    for _ in range(steps):
        rest_engine._count_stalls(state, last.island, lowest, stalled)
    assert state.asleep[1] == (steps > rest_engine.STANDS and not loaded)


@pytest.mark.slow
def test_bodies_that_do_not_touch_a_tipping_plate_change_nothing_of_its_way():
    """A box at rest that the plate comes near does not shorten its steps."""
    table = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)
    step = Part("step", Box([1, 1, 0.5]), [-1, 0, 0.25], grounded=True)
    plate = Part("plate", Box([1.2, 0.5, 0.1]), [-0.47, 0, 0.55])
    others = [Part("rests", Box([1, 1, 1]), [0.9, -1, 0.5]),
              Part("floats", Box([1, 1, 1]), [1, 1, 0.51])]  # fmt: skip
    alone, beside = (
        settle(Assembly([table, step, plate, *more], friction=1.0), require="equilibrium")
        for more in ([], others)
    )
    assert alone.at_rest
    assert beside.at_rest
    assert beside.movement[2] == pytest.approx(alone.movement[2], abs=1e-6)
    assert beside.movement[3] == pytest.approx(np.zeros(6), abs=1e-9)


@pytest.mark.parametrize(("tilt", "yaw"), [(15, 25), (30, 3), (30, 25), (45, 10)])
@pytest.mark.slow
def test_a_coin_that_leans_on_a_wall_rolls_until_its_axis_is_square_to_the_wall(tilt, yaw):
    """Its weight is balanced on two points of its rims only if its centre is above their line.

    By symmetry that holds if the axis lies in the plane across the wall, and other poses roll on.
    """
    turn = Rotation.from_euler("xz", [90 - tilt, yaw], degrees=True)
    axis = turn.as_matrix()[:, 2]
    deep, high = (0.5 * np.sqrt(1 - axis[k] ** 2) + 0.05 * abs(axis[k]) + 1e-3 for k in (1, 2))
    pose = Pose([0, -deep, high], turn.as_quat(scalar_first=True))
    ground = Part("floor", Box(10, 10, 1), [0, 0, -0.5], grounded=True)
    wall = Part("wall", Box(4, 1, 4), [0, 0.5, 2], grounded=True)
    coin = Part("coin", Cylinder(0.5, 0.1), pose)
    answer = kilter.settle(Assembly([ground, wall, coin], friction=0.7), require="equilibrium")
    assert answer.state == "at-rest"
    assert answer.rounds < 40
    axis = answer.assembly["coin"].pose.matrix[:, 2]
    assert abs(axis[0]) < 1e-6
    assert abs(axis[2]) > 0.1
