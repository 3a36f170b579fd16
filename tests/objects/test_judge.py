"""States of MuJoCo, judged with its own contacts: closed forms on both sides, and simulations."""

import pytest

pytest.importorskip("mujoco")

import copy
import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import kilter
from kilter import InputError
from kilter.cli import main

FLOOR = '<geom name="table" type="plane" size="2 2 .1"/>'
BOX = '<geom type="box" size=".05 .05 .05"/>'


def loose(name: str, at: str, geom: str = BOX, turn: str = "0 0 0") -> str:
    return f'<body name="{name}" pos="{at}" euler="{turn}"><freejoint/>{geom}</body>'


def scene(world: str, rest: str = "", option: str = "") -> str:
    return f"<mujoco><option {option}/><worldbody>{world}</worldbody>{rest}</mujoco>"


def made(text: str, steps: int = 0, ctrl: Any = None) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    if ctrl is not None:
        data.ctrl[:] = ctrl
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return model, data


def judged(text: str, steps: int = 0, ctrl: Any = None, **options: Any) -> kilter.Judged:
    return kilter.judge(*made(text, steps, ctrl), **options)


def ramp(degrees: float, mu: float = 0.5) -> str:
    """A cube that stands 2 um deep on a slope."""
    at = (0.05 - 2e-6) * np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])
    turn = f"0 {degrees} 0"
    rough = f'friction="{mu}"'
    cube = loose("cube", f"{at[0]} 0 {at[1]}", BOX.replace("/>", f" {rough}/>"), turn)
    return scene(f'<geom name="ramp" type="plane" size="1 1 .1" euler="{turn}" {rough}/>{cube}')


PAD = """<body name="{0}" pos="{1} 0 .2"><joint name="{0}" type="slide" axis="1 0 0"/>
<geom type="box" size=".01 .02 .02" mass=".1" friction="{2}"/></body>"""


def pinch(mu: float = 0.7) -> str:
    """A part of 45 g between two pads on slides, each with a motor."""
    part = f'<geom type="box" size=".02 .01 .01" mass=".045" friction="{mu}"/>'
    pads = PAD.format("left", -0.03, mu) + PAD.format("right", 0.03, mu)
    motors = '<actuator><motor joint="left"/><motor joint="right"/></actuator>'
    return scene(pads + loose("part", "0 0 .2", part), motors)


# a state that holds or falls ---------------------------------------------------------------------


def test_a_ramp_holds_below_the_angle_of_its_friction_and_falls_above():
    assert np.degrees(np.arctan(0.5)) == pytest.approx(26.565, abs=1e-3)
    holds, falls = judged(ramp(26.5)), judged(ramp(26.6))
    assert (holds.state, holds.level, holds.factor) == ("holds", "proved", np.inf)
    assert holds.holds
    assert (falls.state, falls.level, falls.factor) == ("falls", None, 0)
    assert "slides down" in falls.sentence
    assert falls.objects[0].other == "ramp"


def test_the_pinch_holds_by_twice_the_friction_over_the_weight():
    answer = judged(pinch(), ctrl=[12, -12], require="equilibrium")
    assert answer.factor == pytest.approx(2 * 0.7 * 12 / (0.045 * 9.81), rel=1e-8)
    assert answer.state == "holds"
    assert [(each.name, each.force) for each in answer.presses] == [("left", 12), ("right", -12)]
    assert not answer.held_by_motors
    assert "38.06 times gravity" in answer.sentence


def test_the_pinch_needs_a_friction_of_its_weight_over_twice_the_force():
    least = 0.045 * 9.81 / 24
    assert least == pytest.approx(0.01839375)
    assert judged(pinch(least * (1 + 1e-6)), ctrl=[12, -12]).state == "holds"
    assert judged(pinch(least * (1 - 1e-6)), ctrl=[12, -12]).state == "falls"


def test_pads_with_unequal_forces_move_and_pads_without_force_are_held():
    assert judged(pinch(), ctrl=[12, -12.1]).state == "falls"
    assert judged(pinch(), ctrl=[-1, 1]).state == "falls"
    resting = judged(pinch(), ctrl=[0, 0])
    assert set(resting.held_by_motors) == {"left", "right"}
    loose = judged(pinch(), ctrl=[0, 0], loose_robots=True)
    assert (loose.state, loose.held_by_motors) == ("falls", ())


@pytest.mark.slow
def test_a_pinch_on_a_hand_holds_by_the_same_factor():
    """Fingers on a robot: the hand has a motor and is held, the fingers press."""
    part = '<geom type="box" size=".02 .01 .01" mass=".045" friction=".7"/>'
    hand = '<joint name="arm" type="slide" axis="0 0 1"/><geom type="sphere" size=".01"/>'
    fingers = PAD.format("left", -0.03, 0.7) + PAD.format("right", 0.03, 0.7)
    motors = "".join(f'<motor joint="{name}"/>' for name in ("arm", "left", "right"))
    world = f'<body name="hand" pos="0 0 .1">{hand}{fingers}</body>' + loose("part", "0 0 .3", part)
    text = scene(world, f"<actuator>{motors}</actuator>")
    answer = judged(text, ctrl=[0, 12, -12])
    assert answer.held_by_motors == ("hand",)
    assert answer.factor == pytest.approx(2 * 0.7 * 12 / (0.045 * 9.81), rel=1e-8)


def test_a_stack_that_overhangs_falls_past_the_edge_although_it_is_sunk():
    def stack(offset: float) -> kilter.Judged:
        return judged(scene(FLOOR + loose("low", "0 0 .0499") + loose("top", f"{offset} 0 .1497")))

    assert stack(0.0499).state == "holds"
    falls = stack(0.0501)
    assert falls.state == "falls"
    assert [entry.name for entry in falls.objects if entry.state == "falls"] == ["top"]


def test_a_stack_at_rest_holds_at_any_gravity():
    text = scene(FLOOR + "".join(loose(f"b{k}", f"0 0 {0.05 + 0.1 * k}") for k in range(4)))
    for steps in (0, 1000):
        answer = judged(text, steps)
        assert (answer.state, answer.level, answer.factor) == ("holds", "proved", np.inf)
        assert answer.contacts == 16
    assert max(entry.depth or 0 for entry in answer.objects) > 1e-5


# floating and too deep ---------------------------------------------------------------------------


def test_a_floating_body_has_its_height():
    answer = judged(scene(FLOOR + loose("low", "0 0 .05") + loose("high", "0 0 .16")))
    assert answer.state == "floats"
    low, high = answer.objects
    assert (low.state, low.height) == ("holds", None)
    assert (high.state, high.other) == ("floats", "low")
    assert high.height == pytest.approx(0.01, abs=1e-9)
    assert answer.sentence == "Floats: 'high' is 0.01 m from low."


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_a_deep_body_is_pushed_out_by_the_depth_that_its_load_does_not_explain(cone):
    """The depth that carries the load is that of the simulation at rest."""
    text = scene(FLOOR + loose("can", "0 0 .05"), option=f'cone="{cone}"')
    model, data = made(text, 2000)
    rest = 0.05 - float(data.qpos[2])
    for depth in (0.0, 0.3 * rest, rest, 1.5 * rest):
        data.qpos[2] = 0.05 - depth
        assert kilter.judge(model, data).state == "holds"
    data.qpos[2] = 0.036
    answer = kilter.judge(model, data)
    [can] = answer.objects
    assert (answer.state, can.state, can.other) == ("pushed-out", "pushed-out", "table")
    assert can.depth == pytest.approx(0.014)
    assert can.unexplained == pytest.approx(0.014 - rest, abs=2 * rest)
    # the simulation agrees: it moves up to the depth at rest
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert 0.05 - data.qpos[2] == pytest.approx(rest, rel=1e-3)


def test_bodies_that_float_together_are_named():
    answer = judged(scene(FLOOR + loose("a", "0 0 .06") + loose("b", "0 0 .15999")))
    assert [entry.state for entry in answer.objects] == ["floats", "floats"]
    assert answer.sentence == "Float: 'a', 'b' are in contact with nothing that is held."


def test_stiff_contacts_explain_less():
    soft, stiff = '<geom type="box" size=".05 .05 .05" solref="{} 1"/>', "0 0 .0495"
    assert judged(scene(FLOOR + loose("a", stiff, soft.format(0.06)))).state == "holds"
    assert judged(scene(FLOOR + loose("a", stiff, soft.format(0.004)))).state == "pushed-out"


# forces and mechanisms ---------------------------------------------------------------------------


@pytest.mark.slow
def test_applied_forces_count_in_each_way_of_the_engine():
    mu, weight = 0.5, 1.0 * 9.81
    cube = '<geom type="box" size=".05 .05 .05" mass="1" friction=".5"/>'
    text = scene(FLOOR.replace("/>", ' friction=".5"/>') + loose("cube", "0 0 .05", cube))
    model, data = made(text)
    for share, state in ((0.9999, "holds"), (1.0001, "falls")):
        data.xfrc_applied[1] = [share * mu * weight, 0, 0, 0, 0.05 * share * mu * weight, 0]
        assert kilter.judge(model, data).state == state
        data.xfrc_applied[:] = 0
        data.qfrc_applied[:] = [0, share * mu * weight, 0, -0.05 * share * mu * weight, 0, 0]
        assert kilter.judge(model, data).state == state
        data.qfrc_applied[:] = 0
    # a force against gravity limits its factor from below only: half of the weight is carried
    data.xfrc_applied[1] = [0.25 * mu * weight, 0, -weight, 0, 0.05 * 0.25 * mu * weight, 0]
    assert kilter.judge(model, data).state == "holds"


def test_the_factor_of_gravity_of_a_lift():
    """A body on a slide, pushed up by 30 N against the stop at its upper end; it weighs 9.81 N."""
    slide = '<joint type="slide" axis="0 0 1" limited="true" range="-1 0"/>'
    text = scene(f'<body name="lift">{slide}<geom type="sphere" size=".1" mass="1"/></body>')
    model, data = made(text)
    data.qfrc_applied[0] = 30
    assert kilter.judge(model, data).factor == pytest.approx(30 / 9.81, rel=1e-8)
    data.qfrc_applied[0] = 9.7
    assert kilter.judge(model, data).state == "falls"


def test_gravity_compensation_carries_a_body():
    ball = '<geom type="sphere" size=".1" mass="1"/>'
    text = scene(f'<body name="a" gravcomp="1"><freejoint/>{ball}</body>')
    answer = judged(text)
    assert answer.state == "holds"
    assert answer.factor == pytest.approx(1)


@pytest.mark.parametrize("joints", ["one", "three"])
def test_joints_carry_and_let_move(joints):
    """A plate on a vertical slide falls; on horizontal slides, also with a hinge, it stays."""
    level = '<joint type="slide" axis="1 0 0"/>'
    if joints == "three":
        level += '<joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 0 1"/>'
    plate = '<body name="plate">{}<geom type="box" size=".1 .1 .01"/></body>'
    assert judged(scene(plate.format(level))).state == "holds"
    upright = level + '<joint type="slide" axis="0 0 1"/>'
    assert judged(scene(plate.format(upright))).state == "falls"


def test_a_door_held_by_a_weld_falls_without_it():
    hinge = '<joint type="hinge" axis="0 1 0" pos="-.2 0 0"/>'
    door = f'<body name="lid">{hinge}<geom type="box" size=".2 .1 .01"/></body>'
    weld = '<equality><weld name="w" body1="lid"/></equality>'
    assert judged(scene(door)).state == "falls"
    model, data = made(scene(door, weld))
    assert kilter.judge(model, data).state == "holds"
    data.eq_active[0] = 0
    assert kilter.judge(model, data).state == "falls"


def test_a_robot_is_held_and_one_that_stands_on_legs_is_rigid():
    arm = '<body name="arm" pos="0 0 .2"><joint name="j" type="hinge" axis="0 1 0"/>' \
        '<geom type="box" size=".2 .02 .02" pos=".2 0 0"/></body>'  # fmt: skip
    text = scene(FLOOR + arm + loose("cube", ".2 0 .05"), '<actuator><motor joint="j"/></actuator>')
    answer = judged(text)
    assert answer.held_by_motors == ("arm",)
    assert answer.state == "holds"
    hip = '<joint name="{0}" type="hinge" axis="0 1 0" pos="0 0 .1"/>'
    bone = '<geom type="box" size=".01 .05 .1" mass=".1"/>'
    leg = '<body name="{0}" pos="{1} 0 -.1">' + hip + bone + "</body>"
    trunk = '<geom type="box" size=".1 .05 .01"/>' + leg.format("l", -0.08) + leg.format("r", 0.08)
    motors = '<actuator><motor joint="l"/><motor joint="r"/></actuator>'
    walker = judged(scene(FLOOR + loose("trunk", "0 0 .2", trunk), motors))
    assert walker.state == "holds"
    assert not walker.held_by_motors
    limp = judged(scene(FLOOR + loose("trunk", "0 0 .2", trunk)))
    assert limp.level in (None, "equilibrium")


def test_round_bodies_are_not_claimed_to_stay_where_they_roll():
    ball = '<geom type="ellipsoid" size=".03 .05 .04"/>'
    egg = judged(scene(FLOOR + loose("egg", "0 0 .04", ball)), 100)
    assert egg.level in (None, "equilibrium")
    can = '<geom type="cylinder" size=".03 .05"/>'
    assert judged(scene(FLOOR + loose("can", "0 0 .05", can)), 500).level == "proved"


def test_contacts_with_torsional_friction_are_named():
    geom = '<geom type="box" size=".05 .05 .05" condim="4"/>'
    assert "torsional" in judged(scene(FLOOR + loose("a", "0 0 .05", geom))).warnings[0]


# the state and the answer ------------------------------------------------------------------------


def test_data_and_model_stay_as_they_are():
    model, data = made(scene(FLOOR + loose("a", "0 0 .06") + loose("b", "0 0 .15")), 30)
    before, margin = copy.copy(data), model.geom_margin.copy()
    kilter.judge(model, data, creep=0.05)
    for name in ("qpos", "qvel", "qacc", "xpos", "time", "ctrl"):
        assert np.array_equal(getattr(before, name), getattr(data, name))
    assert np.array_equal(model.geom_margin, margin)
    assert data.ncon == before.ncon


@pytest.mark.slow
def test_creep_of_a_pinch_is_measured_and_the_best_setting_named():
    model, data = made(pinch(), 300, [12, -12])
    answer = kilter.judge(model, data, creep=0.5)
    own, *others = answer.creep
    assert (own.setting, own.name) == ("as is", "part")
    # the engine's own motion, by hand
    data.qvel[:] = 0
    start = data.xipos.copy()
    for _ in range(250):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    way = np.linalg.norm(data.xipos - start, axis=1)[3]
    assert own.distance == pytest.approx(way, rel=0.05)
    best = min(others, key=lambda entry: entry.distance)
    assert best.distance < 0.05 * own.distance
    assert f"with {best.setting} by" in answer.sentence


def test_a_body_that_still_moves_is_named():
    model, data = made(scene(FLOOR + loose("a", "0 0 .05")), 500)
    data.qvel[0] = 0.3
    answer = kilter.judge(model, data)
    assert answer.objects[0].speed == pytest.approx(0.3)
    assert "a still moves at 0.3 m/s" in answer.sentence


def test_a_scene_without_loose_bodies_holds():
    answer = judged(scene(FLOOR))
    assert (answer.state, answer.objects, answer.assembly) == ("holds", (), None)
    assert answer.sentence == "No body moves freely: all are held."
    with pytest.raises(InputError, match="nothing to prove"):
        answer.proof()


def test_wrong_arguments_are_named():
    model, data = made(scene(FLOOR + loose("a", "0 0 .05")))
    with pytest.raises(InputError, match="judge got str and MjData"):
        kilter.judge("a.xml", data)
    with pytest.raises(InputError, match="creep is"):
        kilter.judge(model, data, creep=-1)
    with pytest.raises(InputError, match="no gravity"):
        judged(scene(FLOOR + loose("a", "0 0 .05"), option='gravity="0 0 0"'))
    with pytest.raises(TypeError, match="neither true nor false"):
        bool(kilter.judge(model, data))


# the command -------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    low = loose("low", "0 0 .05")
    Path("scene.xml").write_text(scene(FLOOR + low + loose("top", ".02 0 .15")))
    return tmp_path


@pytest.mark.slow
def test_the_command_has_the_exit_codes_of_its_states(folder, capsys):
    assert main(["why", "scene.xml", "--steps", "200", "--quiet"]) == 0
    assert "Holds at any gravity" in capsys.readouterr().out
    states = np.tile(made(Path("scene.xml").read_text())[1].qpos, (3, 1))
    states[1, 7] = 0.06  # past the edge
    states[2, 9] = 0.2  # in the air
    np.save("s.npy", states)
    for row, code, state in ((0, 0, "holds"), (1, 1, "falls"), (2, 1, "floats")):
        words = ["why", "scene.xml", "--state", f"s.npy:{row}", "--json"]
        assert main(words) == code
        assert json.loads(capsys.readouterr().out)["state"] == state
    Path("pinch.xml").write_text(
        pinch().replace(
            "</mujoco>", '<keyframe><key name="grip" ctrl="12 -12"/></keyframe></mujoco>'
        )
    )
    words = ["why", "pinch.xml", "--keyframe", "grip", "--creep", "0.05"]
    assert main(words) == 3
    assert "presses    left with 12 N" in capsys.readouterr().out
    assert main([*words, "--require", "equilibrium"]) == 0


@pytest.mark.slow
def test_the_proof_of_the_command_is_recomputed_from_its_contacts(folder, capsys):
    words = ["--proof", "p.json", "--contacts", "c.kilter.json"]
    assert main(["why", "scene.xml", "--steps", "20", *words]) == 0
    assert "contacts     written to c.kilter.json" in capsys.readouterr().out
    assert main(["verify", "c.kilter.json", "p.json"]) == 0


def test_wrong_usage_of_the_command_has_a_sentence(folder, capsys):
    Path("other.xml").write_text("<robot/>")
    for words, said in (
        (["other.xml"], "no MJCF file"),
        (["none.xml"], "no such file"),
        (["scene.xml", "--steps", "-1"], "--steps is -1"),
        (["scene.xml", "--creep", "1e9"], "--creep is 1e+09"),
        (["scene.xml", "--keyframe", "a"], "there is no keyframe 'a'"),
        (["scene.xml", "--state", "none.npy"], "none.npy"),
        (["scene.xml", "--state", "s.npy", "--keyframe", "a"], "--keyframe and --state"),
        (["scene.xml", "--require", "x"], "x"),
    ):
        assert main(["why", *words]) == 2
        assert said in capsys.readouterr().err
