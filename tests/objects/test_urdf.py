"""Robots of URDF: joints, masses, and guides of files."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import random_turn

import kilter
from kilter import Assembly, InputError
from kilter.cli import main
from kilter.contact import contacts
from kilter.files.own.kilter_json import from_dict, to_dict
from kilter.mechanics.locked_parts import merge_parts
from kilter.mechanics.program import build_program
from kilter.rigid import Pose

POSIX = pytest.mark.skipif(os.name != "posix", reason="pipes, links or signals of POSIX")

LINK = """<link name="{name}"><inertial><mass value="{mass}"/><origin xyz="{center}"/></inertial>
<collision><origin xyz="{at}"/><geometry>{shape}</geometry></collision></link>"""
JOINT = """<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/>
<child link="{child}"/>
<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>"""


def link(name: str, shape: str, mass: float = 1.0, at: str = "0 0 0", center: str = "0 0 0") -> str:
    return LINK.format(name=name, shape=shape, mass=mass, at=at, center=center)


def joint(
    parent: str, child: str, kind: str, xyz: str, rpy: str = "0 0 0", axis: str = "0 0 1"
) -> str:
    return JOINT.format(parent=parent, child=child, kind=kind, xyz=xyz, rpy=rpy, axis=axis)


def robot(tmp_path: Path, *elements: str, name: str = "robot.urdf") -> Path:
    path = tmp_path / name
    path.write_text(f'<robot name="r">{"".join(elements)}</robot>')
    return path


BASE = link("base", '<box size="1 1 1"/>', 10)


def test_a_box_on_its_base_and_the_same_parts_of_ones_own(tmp_path):
    path = robot(tmp_path, BASE, link("box", '<box size=".5 .5 .5"/>', 2),
                 joint("base", "box", "floating", "0 0 .75"))  # fmt: skip
    found = kilter.load(path)
    assert kilter.check(found).stable
    own = kilter.Assembly(
        [
            kilter.Part("base", kilter.Box([1, 1, 1]), mass=10, center_of_mass=[0] * 3,
                        grounded=True),
            kilter.Part("box", kilter.Box([0.5] * 3), kilter.Pose([0, 0, 0.75]), mass=2,
                        center_of_mass=[0] * 3),
        ]
    )  # fmt: skip
    one, two = kilter.check(found).to_dict(), kilter.check(own).to_dict()
    assert (one.pop("assume"), two.pop("assume")) == ("play", "drawn")  # by the file
    assert {**one, "seconds": 0} == {**two, "seconds": 0}


@pytest.mark.parametrize(
    ("kind", "axis", "stable"),
    [
        ("fixed", "0 0 1", True),
        ("revolute", "1 0 0", True),
        ("continuous", "0 1 0", False),
        ("prismatic", "1 0 0", False),
        ("prismatic", "0 1 0", True),
    ],
)
def test_an_arm_at_the_side_is_held_as_its_joint_holds(tmp_path, kind, axis, stable):
    """The frame is turned by 90 degrees about y, so the arm along its z is along the world's x."""
    arm = link("arm", '<cylinder radius=".1" length="1"/>', 3, "0 0 .5", "0 0 .5")
    path = robot(
        tmp_path, BASE, arm, joint("base", "arm", kind, "1.2 0 0", f"0 {np.pi / 2} 0", axis)
    )
    found = kilter.load(path)
    assert kilter.check(found).stable is stable
    assert np.allclose(np.abs(found["arm"].pose.matrix[:, 2]), [1, 0, 0], atol=1e-6)
    assert bool(found.notes) is (kind != "fixed")


def test_links_near_a_joint_do_not_touch_and_points_are_no_shapes(tmp_path):
    """The cover is fixed to the arm, which a joint connects to the base; the marker is a point."""
    arm = link("arm", '<cylinder radius=".1" length="1"/>', 3, "0 0 .4", "0 0 .4")
    path = robot(
        tmp_path,
        BASE,
        arm,
        link("cover", '<box size=".3 .3 .3"/>', 1),
        link("marker", '<box size="0 0 0.0"/>', 1),
        joint("base", "arm", "continuous", "0.5 0 0", f"0 {np.pi / 2} 0", "0 1 0"),
        joint("arm", "cover", "fixed", "0 0 0"),
        joint("cover", "marker", "fixed", "0 0 0"),
    )
    found = kilter.load(path)
    assert found.names == ("base", "arm", "cover")
    assert {frozenset(each.parts) for each in found.contacts} == {
        frozenset(pair) for pair in (("base", "arm"), ("base", "cover"), ("arm", "cover"))
    }
    assert kilter.check(found).verdict == "unstable"


@pytest.mark.parametrize(("contacts", "verdict"), [(None, "unstable"), ("geometry", "undecided")])
def test_links_that_overlap_at_their_joint_do_not_touch(tmp_path, contacts, verdict):
    arm = link("arm", '<cylinder radius=".1" length="1"/>', 3, "0 0 .4", "0 0 .4")
    place = "0.5 0 0", f"0 {np.pi / 2} 0", "0 1 0"
    path = robot(tmp_path, BASE, arm, joint("base", "arm", "continuous", *place))
    assert kilter.check(kilter.load(path, contacts=contacts)).verdict == verdict


def test_a_base_that_floats_stands_on_the_floor_or_tips(tmp_path):
    for reach, stable in ((0.4, True), (3.5, False)):
        arm = link("arm", '<box size=".2 .2 .2"/>', 10)
        path = robot(tmp_path, BASE, arm, joint("base", "arm", "fixed", f"{reach} 0 2"))
        assert kilter.check(kilter.load(path)).stable
        found = kilter.load(path, base="floating", floor=True)
        assert not any(part.grounded for part in found.parts if part.name != "floor")
        assert kilter.check(found).stable is stable


def test_frames_are_passed_over_and_hold_what_is_fixed_to_them(tmp_path):
    path = robot(tmp_path, '<link name="world"/><link name="tool"/>', BASE,
                 link("hand", '<sphere radius=".1"/>'), joint("world", "base", "fixed", "0 0 5"),
                 joint("base", "tool", "fixed", "0 0 1"), joint("tool", "hand", "fixed", "0 0 1"),
                 name="robot.xml")  # fmt: skip
    found = kilter.load(path)
    assert found.names == ("base", "hand")
    assert found["hand"].pose.position == pytest.approx([0, 0, 7])
    assert [one.parts for one in found.joints] == [("base", "ground"), ("hand", "base")]
    assert kilter.check(found).stable
    loose = kilter.load(path, base="floating")
    assert [one.parts for one in loose.joints] == [("hand", "base")]


def test_meshes_are_found_beside_the_file_and_in_packages(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    folder = tmp_path / "thing_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "meshes").mkdir()
    trimesh.creation.box((1000, 1000, 1000)).export(folder / "meshes" / "cube.stl")
    for name in ("../meshes/cube.stl", "package://thing_description/meshes/cube.stl"):
        shape = f'<mesh filename="{name}" scale=".001 .001 .001"/>'
        path = robot(folder / "urdf", link("cube", shape, 4))
        found = kilter.load(path)
        assert found.geometry.volume[0] == pytest.approx(1)
        assert found.geometry.mass[0] == 4


@POSIX
def test_a_pipe_is_not_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.stl")
    for name in ("pipe.stl", "package://pipe.stl", "package://somewhere/pipe.stl"):
        if name.startswith("package://some"):
            (tmp_path / "somewhere").mkdir()
            (tmp_path / "pipe.stl").rename(tmp_path / "somewhere" / "pipe.stl")
        shape = f'<mesh filename="{name}"/>'
        with pytest.raises(InputError, match=r"'pipe\.stl' is not a regular file; name a file"):
            kilter.load(robot(tmp_path, link("cube", shape)))


def test_a_mass_of_zero_is_a_note(tmp_path):
    found = kilter.load(robot(tmp_path, link("base", '<box size="1 1 1"/>', 0)))
    assert found.notes[0] == "the mass of 'base' is 0, so it has its density"
    assert found.notes[1:] == ("the robot is its held root link: --base floating frees it",)
    assert found.geometry.mass.tolist() == [1000.0]


def test_a_capsule_is_a_cylinder_with_round_ends(tmp_path):
    found = kilter.load(robot(tmp_path, link("a", '<capsule radius=".5" length="2"/>')))
    exact = np.pi * (0.5**2 * 2 + 4 / 3 * 0.5**3)
    assert found.geometry.volume[0] == pytest.approx(exact, rel=0.01)


def test_several_shapes_of_a_link_are_one_part(tmp_path):
    two = """<link name="ell"><collision><geometry><box size="2 1 1"/></geometry></collision>
    <collision><origin xyz=".5 0 .5"/><geometry><box size="1 1 2"/></geometry></collision></link>"""
    found = kilter.load(robot(tmp_path, two))
    assert found.geometry.volume[0] == pytest.approx(3)


@pytest.mark.parametrize(
    ("elements", "words"),
    [
        ([""], "the robot has no links"),
        (['<link name="a"/>'], "no link has a shape; give its links <collision>"),
        ([link("a", '<cone radius="1"/>')], "part 'a': a shape has the type 'cone'; give a box"),
        ([link("a", '<box size="1 1"/>')], "part 'a': size of <box> is '1 1'; give 3 numbers"),
        (
            [link("a", '<mesh filename="a.wrl"/>')],
            r"part 'a': mesh files of type \.wrl cannot be read; write",
        ),
        ([BASE, joint("base", "arm", "fixed", "0 0 0")], "the child 'arm' of the joint .* is not"),
        (
            [
                BASE,
                '<link name="b"/>',
                link("a", '<box size="1 1 1"/>'),
                joint("base", "b", "revolute", "0 0 0"),
                joint("b", "a", "revolute", "0 0 0"),
            ],
            "part 'a': 2 moving joints connect it to 'base' over links without shapes; give",
        ),
        (
            [BASE, link("a", '<box size="1 1 1"/>'), joint("base", "a", "planar", "0 0 0")],
            "part 'a': its joint has the type planar; use one of fixed",
        ),
        ([BASE, BASE], "part 'base': two links have this name; rename a link"),
        (
            [BASE, link("a", '<box size="1 1 1"/>'), *[joint("base", "a", "fixed", "0 0 0")] * 2],
            "part 'a': it is the child of two joints; a robot is a tree",
        ),
        (
            [BASE, link("a", '<box size="1 1 1"/>')],
            "the robot has 2 roots: 'base', 'a'; join them to a single root",
        ),
        ([joint("base", "base", "fixed", "0 0 0"), BASE], "'base': its joints form a loop"),
        ([link("a", '<box size="1 1 1"/>', mass=-1)], "part 'a': mass is -1"),
        ([link("a", '<box size="1 1 1"/>', mass=float("nan"))], "value of <mass> is 'nan'"),
    ],
)
def test_what_the_format_has_not_is_told(tmp_path, elements, words):
    with pytest.raises(InputError, match=r"robot\.urdf: .*" + words):
        kilter.load(robot(tmp_path, *elements))


@pytest.mark.parametrize("name", ["robot.urdf", "robot.urdf.xacro"])
@pytest.mark.parametrize(
    "element",
    [
        link("base", '<box size="${w} 1 1"/>'),
        BASE + '<x:property xmlns:x="http://www.ros.org/wiki/xacro" name="w" value="1"/>',
        link("base", '<mesh filename="$(find robot)/base.stl"/>'),
    ],
)
def test_a_template_of_xacro_says_how_it_is_expanded(tmp_path, element, name):
    with pytest.raises(InputError, match=r"a template of xacro.* \(xacro robot\.xacro > robot"):
        kilter.load(robot(tmp_path, element, name=name))


def test_an_expanded_template_with_elements_of_a_simulator_is_read(tmp_path):
    others = '<gazebo reference="base"><material>Blue</material></gazebo><unknown/>'
    assert kilter.load(robot(tmp_path, BASE, others)).names == ("base",)


def test_a_base_is_fixed_or_floating_and_xml_is_of_one_of_two_kinds(tmp_path):
    with pytest.raises(InputError, match="the base is 'loose'; use fixed or floating"):
        kilter.load(robot(tmp_path, BASE), base="loose")
    path = tmp_path / "x.xml"
    path.write_text("<html/>")
    with pytest.raises(InputError, match="the root element is 'html'; MJCF begins with"):
        kilter.load(path)
    path.write_text("<robot")
    with pytest.raises(InputError, match=r"x\.xml: the XML is invalid"):
        kilter.load(path)


@pytest.mark.slow
def test_the_command_asks_the_same_and_its_proof_is_verified(tmp_path):
    arm = link("arm", '<box size=".2 .2 .2"/>', 10)
    path = robot(tmp_path, BASE, arm, joint("base", "arm", "fixed", "3.5 0 2"))
    proof = str(tmp_path / "proof.json")
    for base, code in (("fixed", 0), ("floating", 1)):
        words = ["check", str(path), "--base", base, "--floor", "--quiet", "--proof", proof]
        assert main(words) == code
        assert main(["verify", str(path), proof, "--quiet"]) == 0


BOX = '<collision><geometry><box size="{size}"/></geometry></collision>'


def words(values: object) -> str:
    return " ".join(f"{value:.17g}" for value in np.ravel(np.asarray(values, dtype=float)))


def origin(rng: np.random.Generator) -> str:
    return f'<origin xyz="{words(rng.normal(size=3))}" rpy="{words(rng.uniform(-1.5, 1.5, 3))}"/>'


def inertial(rng: np.random.Generator) -> str:
    """A random mass at a random place, with the inertia of a random body."""
    mass, second = rng.uniform(0.1, 20), np.diag(rng.uniform(0.01, 1, 3))
    turn = Pose([0, 0, 0], random_turn(rng)).matrix
    i = turn @ (np.trace(second) * np.eye(3) - second) @ turn.T
    six = {"ixx": i[0, 0], "ixy": i[0, 1], "ixz": i[0, 2], "iyy": i[1, 1], "iyz": i[1, 2],
           "izz": i[2, 2]}  # fmt: skip
    tensor = " ".join(f'{key}="{value:.17g}"' for key, value in six.items())
    return f'<inertial>{origin(rng)}<mass value="{mass:.17g}"/><inertia {tensor}/></inertial>'


def random_robot(seed: int) -> tuple[str, dict[str, str]]:
    """A robot that floats, and the top link of the group under fixed joints of each link."""
    rng = np.random.default_rng(seed)
    top = {"base": "base"}
    text = ['<link name="world"/>']
    text.append(
        '<joint name="j" type="floating"><parent link="world"/><child link="base"/></joint>'
    )
    for k in range(7):
        name = f"link-{k}" if k else "base"
        kind = str(rng.choice(["fixed", "fixed", "revolute", "prismatic"]))
        parent = str(rng.choice(list(top)))
        shape = BOX.format(size=words(rng.uniform(0.1, 1, 3)))
        bare = k > 0 and kind == "fixed" and rng.random() < 0.5
        text.append(f'<link name="{name}">{inertial(rng)}{"" if bare else shape}</link>')
        if k:
            text.append(
                f'<joint name="j{k}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
                f'{origin(rng)}<axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>'
            )
            top[name] = top[parent] if kind == "fixed" else name
    return f'<robot name="r">{"".join(text)}</robot>', top


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(30))
def test_bodies_have_the_masses_that_mujoco_reads(seed, tmp_path):
    """Links joined by fixed joints are one body of MuJoCo: mass, centre and inertia to 1e-9."""
    mujoco = pytest.importorskip("mujoco")
    text, top = random_robot(seed)
    (tmp_path / "r.urdf").write_text(text)
    assembly = kilter.load(tmp_path / "r.urdf", base="floating")
    tops = sorted(set(top.values()))
    program = build_program(assembly, contacts(assembly))
    groups = [tops.index(top[name]) for name in assembly.names]
    merged = merge_parts(program, np.array(groups))
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    assert model.nbody == len(tops) + 1
    for k, name in enumerate(tops):
        body = model.body(name).id
        axes = data.ximat[body].reshape(3, 3)
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        assert merged.mass[k] == pytest.approx(model.body_mass[body], rel=1e-9)
        assert np.allclose(merged.center[k], data.xipos[body], rtol=0, atol=1e-9)
        assert np.allclose(merged.inertia[k], inertia, rtol=0, atol=1e-9 * np.abs(inertia).max())


HINGE = (
    '<joint name="{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>'
)
MASS = '<inertial><mass value="2"/>{}</inertial>'


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ('<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>', []),
        ('<inertia ixx="1" iyy="1" izz="3"/>', ["no body has the inertia of 'a', so that of its"]),
        ('<inertia ixx="-1" iyy="1" izz="1"/>', ["no body has the inertia of 'a', so that of its"]),
    ],
)
def test_an_inertia_that_no_body_has_is_replaced_by_that_of_the_shape(tmp_path, inertia, words):
    path = tmp_path / "r.urdf"
    path.write_text(
        f'<robot><link name="a">{MASS.format(inertia)}{BOX.format(size="1 1 1")}</link></robot>'
    )
    found = kilter.load(path, base="floating")
    assert np.allclose(found.geometry.inertia[0], np.eye(3) / 3)
    assert [note[: len(word)] for note, word in zip(found.notes, words, strict=True)] == words


def test_links_fixed_to_a_frame_without_a_shape_are_one_body(tmp_path):
    """Two boxes and a mass on a frame that floats; a mass that turns without a shape is named."""
    box = BOX.format(size="1 1 1")
    path = tmp_path / "r.urdf"
    path.write_text(
        "<robot>"
        + '<link name="frame"/>'
        + "".join(f'<link name="{name}">{MASS.format("")}{box}</link>' for name in "ab")
        + "".join(f'<link name="{name}">{MASS.format("")}</link>' for name in ("load", "rotor"))
        + "".join(HINGE.format(child=n, kind="fixed", parent="frame") for n in ("a", "b", "load"))
        + HINGE.format(child="rotor", kind="continuous", parent="a")
        + "</robot>"
    )
    floating = kilter.load(path, base="floating")
    assert [joint.parts for joint in floating.joints] == [("b", "a")]
    assert [part.mass for part in floating] == [4.0, 2.0]
    assert floating.notes == ("no shape moves with these links, so their mass is ignored: 'rotor'",)
    held = kilter.load(path)
    assert [joint.parts for joint in held.joints] == [("a", "ground"), ("b", "ground")]
    assert [part.mass for part in held] == [2.0, 2.0]


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


HINGE_FILES = '<joint name="j" axis="0 1 0" {}/>'
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
def test_a_hinge_of_mjcf_holds_by_its_limits_friction_and_spring(tmp_path, name):
    pytest.importorskip("mujoco")
    joint, rest, expected = IN_MJCF[name]
    found = mjcf(tmp_path, HINGE_FILES.format(joint), rest)
    assert found.notes == ()
    assert word(found) == expected


def test_positions_of_mjcf_count_from_the_keyframe_and_in_the_unit_of_the_compiler(tmp_path):
    pytest.importorskip("mujoco")
    joint = HINGE_FILES.format('range="-90 60" stiffness="3" springref="30" ref="10"')
    key = f'<keyframe><key name="k" qpos="{math.radians(60)}"/></keyframe>'
    (drawn,) = mjcf(tmp_path, joint, compiler='angle="degree"').joints
    assert drawn.limits == pytest.approx([math.radians(-100), math.radians(50)])
    assert drawn.rest == pytest.approx(math.radians(20))
    at_end = mjcf(tmp_path, joint, key, compiler='angle="degree"')
    assert at_end.joints[0].limits == pytest.approx([math.radians(-150), 0.0])
    assert at_end.joints[0].rest == pytest.approx(math.radians(-30))
    weak = HINGE_FILES.format('range="-90 60" stiffness=".001"')
    assert word(mjcf(tmp_path, weak, key, compiler='angle="degree"')) == "stable"
    assert word(mjcf(tmp_path, weak, compiler='angle="degree"')) == "unstable"


def test_guides_of_other_joints_of_mjcf_are_ignored_with_a_note(tmp_path):
    pytest.importorskip("mujoco")
    ball = mjcf(tmp_path, '<joint type="ball" range="0 1" stiffness="2" frictionloss="1"/>')
    assert ball.notes == ("ignored: 1 springs, 1 joint limits, 3 joint frictions",)
    both = mjcf(tmp_path, '<joint type="slide" axis="0 1 0" range="0 1"/>' + HINGE_FILES.format(""))
    assert both.joints[0].kind == "cylindrical"
    assert both.notes == ("ignored: 1 joint limits",)


LINKS = """<link name="{}"><inertial><mass value="2"/><origin xyz="{at}"/></inertial>
<collision><origin xyz="{at}"/><geometry><box size="1 .2 .2"/></geometry></collision></link>"""


def urdf(tmp_path: Path, kind: str, inner: str, axis: str = "0 1 0") -> Assembly:
    """An arm along x beside a held base, on a joint at the origin."""
    path = tmp_path / "arm.urdf"
    path.write_text(
        f'<robot name="r">{LINKS.format("base", at="-2 0 0")}{LINKS.format("arm", at=".5 0 0")}'
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
def test_a_joint_of_urdf_holds_by_its_limits_and_friction(tmp_path, name):
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
def test_a_lift_of_urdf_stands_on_its_lower_stop(tmp_path, inner, expected):
    assert word(urdf(tmp_path, "prismatic", inner, axis="0 0 1")) == expected


def test_wrong_limits_of_urdf_are_ignored_with_a_note_and_wrong_friction_is_refused(tmp_path):
    crossed = urdf(tmp_path, "revolute", '<limit lower="1" upper="-1"/>')
    assert "the limits of the joint 'j' are ignored: the lower is above the upper" in crossed.notes
    for inner in ('<dynamics friction="-1"/>', '<limit lower="x" upper="1"/>'):
        with pytest.raises(InputError, match="arm"):
            urdf(tmp_path, "revolute", inner)


GUIDE: dict[str, Any] = {"limits": [-0.5, 0.0], "friction": 0.25, "stiffness": 3.5, "rest": -0.125}


def test_a_kilter_file_keeps_limits_friction_and_springs(tmp_path):
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


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("verb", "words"),
    [
        ("region", "region leaves out the friction and springs of 1 joint"),
        ("orient", "orient leaves out the friction and springs of 1 joint"),
        ("plan", "plan leaves out the friction and springs of 1 joint"),
        ("hold", "hold leaves out the friction and springs of 1 joint"),
    ],
)
def test_commands_without_joint_forces_say_so(verb, words):
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


def test_a_scene_of_mujoco_cannot_state_guides_between_free_bodies():
    data = {
        "kilter": 1,
        "parts": [{"name": "lid", "box": [1, 1, 1]}],
        "joints": [{"parts": ["lid", "ground"], "kind": "revolute", "point": [0, 0, 0],
                    "axis": [1, 0, 0], **GUIDE}],
    }  # fmt: skip
    with pytest.raises(InputError, match="MJCF has no limits"):
        from_dict(data).to_mjcf()
