"""Limits, friction and springs of joints as MJCF, URDF and kilter files state them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter import Assembly, InputError
from kilter.files.kilter_json import from_dict, to_dict

WEIGHT = 2.0 * 9.81
ARM = '<geom type="box" size=".5 .1 .1" pos=".5 0 0" mass="2"/>'
"""An arm of 1 m and 2 kg along x, with the torque WEIGHT / 2 about the y axis at its end."""


def mjcf(tmp_path: Path, joint: str, rest: str = "", compiler: str = 'angle="radian"') -> Assembly:
    path = tmp_path / "arm.xml"
    path.write_text(
        f"<mujoco><compiler {compiler}/>{rest}<worldbody>"
        f'<body name="arm">{joint}{ARM}</body></worldbody></mujoco>'
    )
    return kilter.load(path)


def word(assembly: Assembly) -> str:
    verdict = kilter.check(assembly)
    assert kilter.verify(assembly, verdict.proof()).holds
    return verdict.verdict


HINGE = '<joint name="j" axis="0 1 0" {}/>'
IN_MJCF = {
    "at its upper limit": ('range="-1 0"', "", "stable"),
    "at its lower limit": ('range="0 1"', "", "unstable"),
    "not limited": ('range="-1 0" limited="false"', "", "unstable"),
    "limits off": ('range="-1 0"', '<option><flag limit="disable"/></option>', "unstable"),
    "friction below": (f'frictionloss="{0.499 * WEIGHT}"', "", "unstable"),
    "friction above": (f'frictionloss="{0.501 * WEIGHT}"', "", "stable"),
    "friction off": (f'frictionloss="{0.501 * WEIGHT}"',
                     '<option><flag frictionloss="disable"/></option>', "unstable"),
    "spring": (f'stiffness="{WEIGHT}" springref="-.5"', "", "stable"),
    "loose spring": (f'stiffness="{WEIGHT}" springref="-.49"', "", "unstable"),
    "spring off": (f'stiffness="{WEIGHT}" springref="-.5"',
                   '<option><flag spring="disable"/></option>', "unstable"),
    "spring and friction": (
        f'stiffness="{WEIGHT}" springref="-.49" frictionloss="{0.011 * WEIGHT}"', "", "stable"),
    "spring pulls into the limit": (f'stiffness="{WEIGHT}" springref=".2" range="-1 0"', "",
                                    "stable"),
}  # fmt: skip


@pytest.mark.parametrize("name", IN_MJCF)
def test_a_hinge_of_mjcf_holds_by_its_limits_friction_and_spring(tmp_path: Path, name: str) -> None:
    pytest.importorskip("mujoco")
    joint, rest, expected = IN_MJCF[name]
    found = mjcf(tmp_path, HINGE.format(joint), rest)
    assert found.notes == ()
    assert word(found) == expected


def test_positions_of_mjcf_count_from_the_keyframe_and_in_the_unit_of_the_compiler(
    tmp_path: Path,
) -> None:
    pytest.importorskip("mujoco")
    joint = HINGE.format('range="-90 60" stiffness="3" springref="30" ref="10"')
    key = f'<keyframe><key name="k" qpos="{math.radians(60)}"/></keyframe>'
    (drawn,) = mjcf(tmp_path, joint, compiler='angle="degree"').joints
    assert drawn.limits == pytest.approx([math.radians(-100), math.radians(50)])
    assert drawn.rest == pytest.approx(math.radians(20))
    at_end = mjcf(tmp_path, joint, key, compiler='angle="degree"')
    assert at_end.joints[0].limits == pytest.approx([math.radians(-150), 0.0])
    assert at_end.joints[0].rest == pytest.approx(math.radians(-30))
    weak = HINGE.format('range="-90 60" stiffness=".001"')
    assert word(mjcf(tmp_path, weak, key, compiler='angle="degree"')) == "stable"
    assert word(mjcf(tmp_path, weak, compiler='angle="degree"')) == "unstable"


def test_guides_of_other_joints_of_mjcf_are_ignored_with_a_note(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    ball = mjcf(tmp_path, '<joint type="ball" range="0 1" stiffness="2" frictionloss="1"/>')
    assert ball.notes == ("ignored: 1 springs, 1 joint limits, 3 joint frictions",)
    both = mjcf(tmp_path, '<joint type="slide" axis="0 1 0" range="0 1"/>' + HINGE.format(""))
    assert both.joints[0].kind == "cylindrical"
    assert both.notes == ("ignored: 1 joint limits",)


LINK = """<link name="{}"><inertial><mass value="2"/><origin xyz="{at}"/></inertial>
<collision><origin xyz="{at}"/><geometry><box size="1 .2 .2"/></geometry></collision></link>"""


def urdf(tmp_path: Path, kind: str, inner: str, axis: str = "0 1 0") -> Assembly:
    """An arm along x beside a held base, on a joint at the origin."""
    path = tmp_path / "arm.urdf"
    path.write_text(
        f'<robot name="r">{LINK.format("base", at="-2 0 0")}{LINK.format("arm", at=".5 0 0")}'
        f'<joint name="j" type="{kind}"><parent link="base"/><child link="arm"/>'
        f'<axis xyz="{axis}"/>{inner}</joint></robot>'
    )
    return kilter.load(path)


IN_URDF = {
    "at its upper limit": ("revolute", '<limit lower="-1" upper="0" effort="1" velocity="1"/>',
                           "stable"),
    "at its lower limit": ("revolute", '<limit lower="0" upper="1"/>', "unstable"),
    "upper limit alone": ("revolute", '<limit lower="-1"/>', "stable"),
    "limit without ends": ("revolute", '<limit effort="1" velocity="1"/>', "unstable"),
    "continuous": ("continuous", '<limit lower="-1" upper="0"/>', "unstable"),
    "friction below": ("revolute", f'<dynamics friction="{0.499 * WEIGHT}"/>', "unstable"),
    "friction above": ("continuous", f'<dynamics friction="{0.501 * WEIGHT}"/>', "stable"),
}  # fmt: skip


@pytest.mark.parametrize("name", IN_URDF)
def test_a_joint_of_urdf_holds_by_its_limits_and_friction(tmp_path: Path, name: str) -> None:
    kind, inner, expected = IN_URDF[name]
    assert word(urdf(tmp_path, kind, inner)) == expected


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        ('<limit lower="0" upper="1"/>', "stable"),
        ('<limit lower="-1" upper="0"/>', "unstable"),
        (f'<dynamics friction="{1.01 * WEIGHT}"/>', "stable"),
        (f'<dynamics friction="{0.99 * WEIGHT}"/>', "unstable"),
        (f'<limit lower="-.1" upper="1"/><dynamics friction="{1.01 * WEIGHT}"/>', "stable"),
    ],
)
def test_a_lift_of_urdf_stands_on_its_lower_stop(tmp_path: Path, inner: str, expected: str) -> None:
    assert word(urdf(tmp_path, "prismatic", inner, axis="0 0 1")) == expected


def test_wrong_limits_of_urdf_are_ignored_with_a_note_and_wrong_friction_is_refused(
    tmp_path: Path,
) -> None:
    crossed = urdf(tmp_path, "revolute", '<limit lower="1" upper="-1"/>')
    assert "the limits of the joint 'j' are ignored: the lower is above the upper" in crossed.notes
    for inner in ('<dynamics friction="-1"/>', '<limit lower="x" upper="1"/>'):
        with pytest.raises(InputError, match="arm"):
            urdf(tmp_path, "revolute", inner)


GUIDE: dict[str, Any] = {"limits": [-0.5, 0.0], "friction": 0.25, "stiffness": 3.5, "rest": -0.125}


def test_a_kilter_file_keeps_limits_friction_and_springs(tmp_path: Path) -> None:
    data = {
        "kilter": 1, "units": "mm",
        "parts": [{"name": "lid", "box": [1, 1, 1]}],
        "joints": [{"parts": ["lid", "ground"], "kind": "prismatic", "axis": [1, 0, 0], **GUIDE}],
    }  # fmt: skip
    assembly = from_dict(data)
    assert assembly.joints[0].guide == GUIDE
    kilter.dump(assembly, tmp_path / "lid.kilter.json")
    again = kilter.load(tmp_path / "lid.kilter.json")
    assert again.joints[0].guide == GUIDE
    assert to_dict(again)["joints"] == to_dict(assembly)["joints"]
    for wrong in ({"limits": [0]}, {"friction": -1}, {"stiffness": "3"}, {"rest": None}):
        joint = {**data["joints"][0], **wrong}  # type: ignore[index]
        with pytest.raises(InputError):
            from_dict({**data, "joints": [joint]})


@pytest.mark.parametrize(
    ("verb", "words"),
    [
        ("region", "region leaves out the friction and springs of 1 joint"),
        ("orient", "orient leaves out the friction and springs of 1 joint"),
        ("plan", "plan leaves out the friction and springs of 1 joint"),
        ("hold", "hold leaves out the friction and springs of 1 joint"),
        ("settle", "settle leaves out the friction, springs and limits of 1 joint"),
    ],
)
def test_commands_without_joint_forces_say_so(verb: str, words: str) -> None:
    data = {
        "kilter": 1,
        "parts": [
            {"name": "lid", "box": [1, 1, 1]},
            {"name": "base", "box": [1, 1, 1], "grounded": True, "pose": {"position": [0, 0, -1]}},
        ],
        "joints": [{"parts": ["lid", "base"], "kind": "prismatic", "axis": [1, 0, 0], **GUIDE}],
    }
    assembly = from_dict(data)
    answer = getattr(kilter, verb)(assembly)
    assert words in answer.to_dict()["warnings"]
    if verb in ("region", "plan", "hold"):
        assert kilter.verify(assembly, answer.proof()).holds


def test_a_scene_of_mujoco_cannot_state_guides_between_free_bodies() -> None:
    data = {
        "kilter": 1,
        "parts": [{"name": "lid", "box": [1, 1, 1]}],
        "joints": [{"parts": ["lid", "ground"], "kind": "revolute", "point": [0, 0, 0],
                    "axis": [1, 0, 0], **GUIDE}],
    }  # fmt: skip
    with pytest.raises(InputError, match="MJCF has no limits"):
        from_dict(data).to_mjcf()
