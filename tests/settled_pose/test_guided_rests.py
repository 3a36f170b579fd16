"""Parts on joints come to rest at limits, by friction and by springs of the joints: closed forms.

A drawer of weight W on a rail that falls by the angle t is pulled along it by W sin t.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Joint, Part, Pose, scene, settle
from kilter.rigid import rotation_between

MASS, ANGLE = 2.0, np.radians(30)
PULL = MASS * 9.81 * np.sin(ANGLE)
"""Weight of the drawer along its rail [N]."""
ALONG = np.array([np.cos(ANGLE), 0, -np.sin(ANGLE)])
HELD = Part("case", Box([1, 1, 0.1]), [0, 0, -9], grounded=True)


def on_rail(**guide: Any) -> Assembly:
    """A drawer on a tilted rail, drawn at the position 0."""
    tray = Part("drawer", Box([0.4, 0.4, 0.1]), mass=MASS)
    rail = Joint(("drawer", "ground"), "prismatic", axis=ALONG, **guide)
    return Assembly([HELD, tray], joints=[rail])


def way_along(answer: kilter.Settled) -> float:
    """Way of the drawer along its rail; it has no other."""
    shift = answer.movement[1, :3]
    along = float(shift @ ALONG)
    assert shift == pytest.approx(along * ALONG, abs=1e-8)
    return along


@pytest.mark.parametrize(
    ("share", "limits", "way"),
    [(1.001, None, 0.0), (1.001, (-0.1, 0.3), 0.0), (0.999, (-0.1, 0.3), 0.3), (0, (0, 0.2), 0.2)],
)
@pytest.mark.slow
def test_a_drawer_stays_by_friction_or_slides_to_its_stop(share, limits, way):
    answer = settle(on_rail(friction=share * PULL, limits=limits))
    assert answer.at_rest
    assert way_along(answer) == pytest.approx(way, abs=1e-8)
    assert kilter.verify(answer.assembly, answer.proof()).holds
    if limits is not None:  # positions count from the new pose
        left = np.array(limits) - way
        assert answer.assembly.joints[0].limits == pytest.approx(left, abs=1e-8)


@pytest.mark.parametrize("wall", [False, True])
def test_a_drawer_without_a_stop_leaves_unless_a_wall_ends_its_way(wall):
    """The wall stands across the rail, .75 from the near face of the drawer."""
    drawn = on_rail(friction=0.999 * PULL)
    if wall:
        turn = rotation_between([1, 0, 0], ALONG)
        tray = replace(drawn.parts[1], pose=Pose([0, 0, 0], turn))
        end = Part("wall", Box([0.1, 2, 2]), Pose(ALONG, turn), grounded=True)
        drawn = replace(drawn, parts=[HELD, tray, end])
    answer = settle(drawn)
    assert answer.at_rest == wall
    if wall:
        assert way_along(answer) == pytest.approx(0.75, abs=1e-7)
    else:
        assert (answer.state, answer.leaves, answer.rounds) == ("falls", ("drawer",), 16)


@pytest.mark.parametrize("start", [-0.05, 0.45])
@pytest.mark.slow
def test_a_drawer_that_is_drawn_beyond_a_stop_is_pushed_to_it(start):
    """Its limits are [0, .4]; from below it slides on to the upper one, unless friction holds."""
    limits = (-start, 0.4 - start)
    end = settle(on_rail(limits=limits))
    assert end.at_rest
    assert way_along(end) + start == pytest.approx(0.4, abs=1e-8)
    held = settle(on_rail(limits=limits, friction=2 * PULL))
    assert held.at_rest
    assert way_along(held) + start == pytest.approx(np.clip(start, 0, 0.4), abs=1e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize("stiffness", [5.0, 100.0, 1000.0])
@pytest.mark.slow
def test_a_drawer_on_a_spring_rests_where_the_spring_carries_it(stiffness):
    answer = settle(on_rail(stiffness=stiffness, rest=0.02))
    assert answer.at_rest
    assert way_along(answer) == pytest.approx(0.02 + PULL / stiffness, abs=1e-9)
    assert kilter.verify(answer.assembly, answer.proof()).holds
    # a second run has nothing to do
    assert settle(answer.assembly).distance.max() <= 1e-9


@pytest.mark.slow
def test_a_spring_and_friction_stop_the_drawer_where_both_carry_it():
    answer = settle(on_rail(stiffness=100.0, rest=0.02, friction=1.0))
    assert answer.at_rest
    assert way_along(answer) == pytest.approx(0.02 + (PULL - 1.0) / 100.0, abs=1e-6)


@pytest.mark.slow
def test_a_flap_on_a_sprung_hinge_hangs_where_the_torques_agree():
    """The angle a from the drawn pose satisfies k a = m g (L / 2) cos a."""
    flap = Part("flap", Box([0.4, 0.4, 0.02]), [0.2, 0, 0], mass=1.0)
    hinge = Joint(("flap", "ground"), "revolute", point=[0, 0, 0], axis=[0, 1, 0], stiffness=3.0)
    answer = settle(Assembly([HELD, flap], joints=[hinge]))
    assert answer.at_rest
    angle = float(answer.movement[1, 4])
    assert 3.0 * angle == pytest.approx(9.81 * 0.2 * np.cos(angle), abs=1e-8)


@pytest.mark.parametrize(
    ("angle", "count"), [(45, 1), (90, 1), (170, 1), (30, 2), (45, 2), (90, 2)]
)
@pytest.mark.slow
def test_bars_on_free_hinges_hang_straight_down(angle, count):
    """Bars with hinges .1 beyond their ends, a second one below the first, drawn in a line."""
    turn = np.radians(angle)
    along = np.array([np.sin(turn), 0, -np.cos(turn)])
    pose = rotation_between([0, 0, -1], along)
    bar = Box([0.1, 0.1, 0.8])
    bars = [Part(name, bar, Pose((k + 0.5) * along, pose)) for k, name in enumerate("ab")]
    hinges = [
        Joint(parts, "revolute", point=k * along, axis=[0, 1, 0])
        for k, parts in enumerate([("a", "ground"), ("b", "a")])
    ]
    answer = settle(Assembly([HELD, *bars[:count]], joints=hinges[:count]))
    assert answer.at_rest
    centers = [answer.assembly[name].pose.position for name in "ab"[:count]]
    below = -(np.arange(count)[:, None] + 0.5) * [0, 0, 1]
    assert np.allclose(centers, below, rtol=0, atol=1e-8)
    assert kilter.verify(answer.assembly, answer.proof()).holds


@pytest.mark.parametrize("limit", [0.4, 1.5])
@pytest.mark.slow
def test_a_flap_on_a_hinge_falls_to_its_limit(limit):
    flap = Part("flap", Box([0.4, 0.4, 0.02]), [0.2, 0, 0], mass=1.0)
    hinge = Joint(
        ("flap", "ground"), "revolute", point=[0, 0, 0], axis=[0, 1, 0], limits=(-1.0, limit)
    )
    answer = settle(Assembly([HELD, flap], joints=[hinge]))
    assert answer.at_rest
    assert answer.movement[1, 4] == pytest.approx(limit, abs=1e-8)


DRAWER = """
<mujoco><worldbody>
  <body name="cabinet" euler="0 {tilt} 0">
    <geom type="box" size=".3 .3 .02" pos="0 0 -.2"/>
    <body name="drawer"><joint name="rail" type="slide" axis="1 0 0" range="-.05 .12"
        limited="true" frictionloss="{friction}" damping="1"/>
      <geom type="box" size=".2 .2 .01" mass="2" friction=".9"/></body>
  </body>
  <body name="cube" pos="{x} 0 {z}" euler="0 {tilt} 0"><freejoint/>
    <geom type="box" size=".02 .02 .02" mass=".5" friction=".9"/></body>
</worldbody></mujoco>"""


@pytest.mark.quick(1)
@pytest.mark.parametrize(("share", "way"), [(1.01, 0.0), (0.99, 0.12)])
def test_a_drawer_takes_its_contents_along(share, way):
    """The friction of the rail carries both weights, or both go to the stop.

    So in MuJoCo, where friction of joints creeps.
    """
    tilt = np.radians(20)
    up = 0.03 + 1e-9
    mujoco = pytest.importorskip("mujoco")
    text = DRAWER.format(
        tilt=20, friction=share * 2.5 * 9.81 * np.sin(tilt), x=up * np.sin(tilt),
        z=up * np.cos(tilt),
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    answer = kilter.settle_states(model, model.qpos0[None])
    assert answer.states[0].rests
    start, end = model.qpos0, answer.qpos[0]
    assert end[0] == pytest.approx(way, abs=1e-7)
    along = np.array([np.cos(tilt), 0, -np.sin(tilt)])
    assert end[1:4] - start[1:4] == pytest.approx(way * along, abs=1e-5)
    data = mujoco.MjData(model)
    data.qpos[:] = end
    while data.time < 1:
        mujoco.mj_step(model, data)
    assert data.qpos[0] == pytest.approx(way, abs=1e-2)


@pytest.mark.parametrize(("length", "angle", "way"), [(0.09, 50, 0), (0.09, 70, 0), (0.15, 50, 1)])
@pytest.mark.slow
def test_a_plank_slides_down_in_a_drawer_that_it_need_not_push(length, angle, way):
    """It leans on the wall behind; a longer one does not fit, and pushes the drawer to its stop.

    A wall that presses it would move the drawer, so it lies in the drawer, or leans at the stop.
    """
    turn = np.radians(angle)
    along = np.array([np.cos(turn), 0, -np.sin(turn)])
    leaning = Pose(length / 2 * abs(along) + [0.01, 0, 0.02], rotation_between([1, 0, 0], along))
    parts = [
        Part("wall", Box([0.1, 0.4, 0.3]), [-0.05, 0, 0.15], grounded=True),
        Part("drawer", Box([0.12, 0.3, 0.01]), [0.06, 0, -0.005], mass=3),
        Part("front", Box([0.01, 0.3, 0.03]), [0.115, 0, 0.015], mass=0.5),
        Part("plank", Box([length, 0.1, 0.004]), leaning, mass=0.01),
    ]
    rail = Joint(("drawer", "ground"), "prismatic", axis=[1, 0, 0], limits=(-0.001, 0.02))
    one = Joint(("drawer", "front"), "fixed")
    answer = settle(Assembly(parts, joints=[rail, one], friction=0.95))
    assert answer.at_rest
    assert answer.movement[1, 0] == pytest.approx(0.02 * way, abs=1e-8)
    flat = answer.movement[3, 4] == pytest.approx(-turn, abs=1e-6)
    assert flat == (way == 0)
    assert kilter.verify(answer.assembly, answer.proof()).holds


@pytest.mark.slow
def test_a_scene_counts_the_stops_as_settle_does():
    drawn = on_rail(limits=(-0.1, 0.3))
    report, answer = scene(drawn, settle=True), settle(drawn)
    assert report.at_rest
    assert report.assembly["drawer"].pose == answer.assembly["drawer"].pose
    assert report.assembly.joints[0].limits == answer.assembly.joints[0].limits


def test_the_least_motion_closes_a_joint_at_its_stop():
    near = on_rail(limits=(-0.1, 1e-4))
    answer = settle(near, nearest=True, reach=1e-3)
    assert answer.at_rest
    assert way_along(answer) == pytest.approx(1e-4, abs=1e-8)
    loose = replace(near, joints=[near.joints[0].without("limits")])
    assert not settle(loose, nearest=True, reach=1e-3).at_rest
