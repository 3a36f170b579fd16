"""Models of MuJoCo, and assemblies as scenes of it: read, written, and simulated."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.scenes import scene
from kilter.scenes.stacks import block_on_slope

pytest.importorskip("mujoco")

import mujoco

Agree = Callable[..., kilter.Assembly]


def text(world: str, rest: str = "") -> str:
    return f"<mujoco>{rest}<worldbody>{world}</worldbody></mujoco>"


def body(name: str, at: str, geom: str, joint: str = "<freejoint/>", rest: str = "") -> str:
    return f'<body name="{name}" pos="{at}">{joint}<geom {geom}/>{rest}</body>'


FLOOR = '<geom name="floor" type="plane" size="0 0 1"/>'
BOX = 'type="box" size=".5 .5 .5"'
SCENES = {
    "a box on a plane": (text(FLOOR + body("box", "0 0 .5", BOX)), "stable"),
    "in the air": (text(FLOOR + body("box", "0 0 .6", BOX)), "unstable"),
    "a cylinder and a ball": (
        text(
            FLOOR
            + body("post", "0 0 1", 'type="cylinder" size=".3 1" mass="7"')
            + body("ball", "0 0 2.2", 'type="sphere" size=".2"')
        ),
        "stable",
    ),
    "an arm that swings": (
        text(body("arm", "0 0 0", 'type="box" size=".5 .1 .1" pos=".5 0 0"',
                  '<joint type="hinge" axis="0 1 0"/>')),
        "unstable",
    ),
    "an arm that hangs": (
        text(body("arm", "0 0 0", 'type="box" size=".1 .1 .5" pos="0 0 -.5"',
                  '<joint type="hinge" axis="0 1 0"/>')),
        "stable",
    ),
    "a table of five geoms": (
        text(
            FLOOR
            + body(
                "table",
                "0 0 0",
                'type="box" size="1 1 .1" pos="0 0 .9"',
                rest="".join(
                    f'<geom type="box" size=".1 .1 .4" pos="{x} {y} .4"/>'
                    for x in (-0.8, 0.8)
                    for y in (-0.8, 0.8)
                ),
            )
        ),
        "stable",
    ),
}  # fmt: skip


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_a_model_and_its_file_give_the_same_answer(agree: Agree, name: str) -> None:
    made, verdict = SCENES[name]
    model = mujoco.MjModel.from_xml_string(made)
    found = agree(model, lambda path: path.write_text(made), "scene.xml", verdict)
    for part in found.parts:
        if not part.grounded:
            k = found.index_of(part.name)
            assert found.geometry.mass[k] == pytest.approx(model.body(part.name).mass[0])
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            assert np.allclose(found.geometry.center[k], data.body(part.name).xipos)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("slope", "verdict"), [(0.29, True), (0.31, False)])
def test_two_geoms_rub_with_the_greater_of_their_coefficients(slope: float, verdict: bool) -> None:
    made = text(
        '<geom type="box" size="2 2 .5" pos="0 0 -.5" friction=".1"/>'
        + body("block", "0 0 .5", f'{BOX} friction=".3"'),
        f'<option gravity="{np.sin(np.arctan(slope))} 0 {-np.cos(np.arctan(slope))}"/>',
    )
    found = kilter.load(mujoco.MjModel.from_xml_string(made))
    assert found.friction == 0.3
    assert kilter.check(found).stable is verdict
    slick = made.replace('friction=".3"', 'friction=".3" condim="1"')
    slick = slick.replace('friction=".1"', 'friction=".1" condim="1"')
    assert kilter.load(mujoco.MjModel.from_xml_string(slick)).friction == 0


def test_the_pose_is_that_of_a_keyframe_or_of_the_data() -> None:
    keys = '<keyframe><key name="down" qpos="0 0 .5 1 0 0 0"/><key name="up" qpos="0 0 3 1 0 0 0"/>'
    made = text(FLOOR + body("box", "0 0 9", BOX), keys + "</keyframe>")
    model = mujoco.MjModel.from_xml_string(made)
    for options, height in (({}, 0.5), ({"keyframe": "up"}, 3.0)):
        found = kilter.load(model, **options)
        assert found.geometry.center[found.index_of("box"), 2] == pytest.approx(height)
    assert "first keyframe, 'down'" in kilter.load(model).notes[0]
    data = mujoco.MjData(model)
    data.qpos[2] = 0.7
    assert kilter.load((model, data))["box"].pose.position[2] == pytest.approx(0.7)
    with pytest.raises(InputError, match="there is no keyframe 'dwn'; did you mean 'down'"):
        kilter.load(model, keyframe="dwn")


def test_what_is_not_counted_is_said() -> None:
    made = text(
        body("arm", "0 0 0", 'type="box" size=".5 .1 .1"',
             '<joint name="j" axis="0 1 0" stiffness="3" range="-1 1" limited="true"/>'),
        '<compiler angle="radian"/><actuator><motor joint="j"/></actuator>',
    )  # fmt: skip
    found = kilter.load(mujoco.MjModel.from_xml_string(made))
    assert found.notes == ("ignored: 1 motors",)
    assert found.joints[0].guide == {"limits": [-1.0, 1.0], "stiffness": 3.0, "rest": 0.0}


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (lambda: mujoco.MjOption(), "a mujoco MjOption is not a model; give an MjModel"),
        (
            lambda: mujoco.MjModel.from_xml_string(
                text(
                    body(
                        "b",
                        "0 0 0",
                        BOX,
                        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>',
                    )
                )
            ),
            "part 'b': it has 2 joints; give it a single hinge",
        ),
    ],
)
def test_what_is_no_model_or_has_no_likeness_is_refused(value: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        kilter.load(value())


def test_a_file_that_mujoco_refuses_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.xml"
    path.write_text("<mujoco><worldbody><geom size='-1'/></worldbody></mujoco>")
    with pytest.raises(InputError, match=r"bad\.xml: MuJoCo rejects it: "):
        kilter.load(path)


# out ------------------------------------------------------------------------------------


def simulated(assembly: kilter.Assembly, seconds: float = 1.0) -> np.ndarray:
    """Displacement of each free part in a MuJoCo simulation [m]."""
    model = mujoco.MjModel.from_xml_string(assembly.to_mjcf())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.xipos.copy()
    while data.time < seconds:
        mujoco.mj_step(model, data)
    free = [model.body(part.name).id for part in assembly.parts if not part.grounded]
    return np.linalg.norm(data.xipos - start, axis=1)[free]


@pytest.mark.parametrize("name", ["tower", "box-pile", "paper-figure-8", "arch"])
def test_masses_poses_and_inertia_are_those_of_the_assembly(name: str) -> None:
    made = dataclasses.replace(scene(name), units="cm")
    model = mujoco.MjModel.from_xml_string(made.to_mjcf())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for k, part in enumerate(made.parts):
        own = model.body(part.name)
        assert own.mass[0] == pytest.approx(made.geometry.mass[k], rel=1e-12)
        assert np.allclose(data.body(part.name).xipos, made.geometry.center[k] / 100, atol=1e-12)
        turn = data.body(part.name).ximat.reshape(3, 3)
        inertia = turn @ np.diag(own.inertia) @ turn.T
        size = np.abs(made.geometry.inertia[k]).max() * 1e-4
        assert np.allclose(inertia, made.geometry.inertia[k] * 1e-4, atol=1e-9 * size)
    again = kilter.load(model)
    assert again.names == made.names
    assert np.allclose(again.geometry.center * 100, made.geometry.center, rtol=0, atol=1e-4)


def test_what_stands_stands_and_what_falls_falls() -> None:
    assert kilter.check(scene("tower")).stable
    assert simulated(scene("tower")).max() < 5e-3  # sinking of cubes of 1 m in soft contacts
    falls = scene("inverted-triangle")
    assert not kilter.check(falls).stable
    assert simulated(falls).max() > 10 * simulated(scene("tower")).max()


@pytest.mark.parametrize(("friction", "stands"), [(0.45, False), (0.55, True)])
def test_a_block_on_a_slope_slides_below_its_friction_alone(friction: float, stands: bool) -> None:
    made = block_on_slope(np.degrees(np.arctan(0.5)), friction=friction)
    assert kilter.check(made).stable is stands
    assert bool(simulated(made).max() < 0.05) is stands


def test_joints_hold_as_they_do_here() -> None:
    arm = kilter.Part("arm", kilter.Box([1, 0.2, 0.2]), kilter.Pose([0.5, 0, 0]))
    for joint, stands in (
        (kilter.Joint(("arm", "ground")), True),
        (kilter.Joint(("arm", "ground"), "revolute", point=[0, 0, 0], axis=[0, 1, 0]), False),
        (kilter.Joint(("arm", "ground"), "revolute", point=[0, 0, 0], axis=[0, 0, 1]), True),
        (kilter.Joint(("arm", "ground"), "spherical", point=[0, 0, 0]), False),
    ):
        made = kilter.Assembly([arm], joints=[joint])
        assert kilter.check(made).stable is stands
        assert bool(simulated(made, 0.5).max() < 0.02) is stands
        again = kilter.load(mujoco.MjModel.from_xml_string(made.to_mjcf()))
        kinds = {"fixed": 1, "revolute": 2, "spherical": 1}
        assert len(again.joints) == kinds[joint.kind]
        assert kilter.check(again).stable is stands


def test_what_mjcf_has_no_word_for_is_refused() -> None:
    with pytest.raises(InputError, match="no loads and no straps of known tension; remove them"):
        scene("books").to_mjcf()
    box = kilter.Part("box", kilter.Box([1, 1, 1]))
    slide = kilter.Joint(("box", "ground"), "prismatic", axis=[1, 0, 0])
    with pytest.raises(InputError, match="MJCF has no prismatic joint"):
        kilter.Assembly([box], joints=[slide]).to_mjcf()


FILTERED = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1"/>
    <body name="base" pos="0 0 .5"><freejoint/>
      <geom type="box" size=".5 .5 .5"/>
      <body name="arm" pos="0 0 .9"><joint type="hinge" axis="0 1 0"/>
        <geom type="box" size=".2 .2 .5"/></body>
    </body>
    <body name="ghost" pos="3 0 .4"><freejoint/>
      <geom type="box" size=".5 .5 .5" contype="2" conaffinity="2"/></body>
    <body name="a" pos="-3 0 .5"><freejoint/><geom type="box" size=".5 .5 .5"/></body>
    <body name="b" pos="-3 0 1.4"><freejoint/><geom type="box" size=".5 .5 .5"/></body>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
</mujoco>
"""


def test_pairs_that_the_model_filters_do_not_touch() -> None:
    """The pairs of `mj_collision`: child and parent, bits of geoms, and excluded pairs are none."""
    model = mujoco.MjModel.from_xml_string(FILTERED)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bodies = model.geom_bodyid[data.contact.geom]
    names = {0: "floor"} | {k: model.body(k).name for k in range(1, model.nbody)}
    expected = {frozenset((names[int(a)], names[int(b)])) for a, b in bodies}
    assembly = kilter.load(model)
    contacts = kilter.contacts(assembly)
    touching = {frozenset(patch.parts) for patch in contacts}
    overlapping = {frozenset(assembly.names[k] for k in pair.ends) for pair in contacts.overlaps}
    assert touching | overlapping == expected
    assert expected == {frozenset(("base", "floor")), frozenset(("a", "floor"))}
    assert any("filters: " in note for note in assembly.notes)
    everything = kilter.contacts(kilter.load(model, contacts="geometry"))
    assert {"arm", "ghost", "b"} <= {
        assembly.names[k] for p in everything.overlaps for k in p.parts
    }


def test_a_filtered_floor_carries_nothing() -> None:
    report = kilter.scene(kilter.load(mujoco.MjModel.from_xml_string(FILTERED)))
    assert (report["ghost"].state, report["ghost"].motion) == ("falls", "nothing is below it")
    assert (report["b"].state, report["b"].other) == ("floats", "floor")
