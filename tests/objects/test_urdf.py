"""URDF robots: poses of links from their joints, and a fixed or floating base."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.cli import main

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


def test_a_box_on_its_base_and_the_same_parts_of_ones_own(tmp_path: Path) -> None:
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
def test_an_arm_at_the_side_is_held_as_its_joint_holds(
    tmp_path: Path, kind: str, axis: str, stable: bool
) -> None:
    """The frame is turned by 90 degrees about y, so the arm along its z is along the world's x."""
    arm = link("arm", '<cylinder radius=".1" length="1"/>', 3, "0 0 .5", "0 0 .5")
    path = robot(
        tmp_path, BASE, arm, joint("base", "arm", kind, "1.2 0 0", f"0 {np.pi / 2} 0", axis)
    )
    found = kilter.load(path)
    assert kilter.check(found).stable is stable
    assert np.allclose(np.abs(found["arm"].pose.matrix[:, 2]), [1, 0, 0], atol=1e-6)
    assert bool(found.notes) is (kind != "fixed")


def test_links_near_a_joint_do_not_touch_and_points_are_no_shapes(tmp_path: Path) -> None:
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
def test_links_that_overlap_at_their_joint_do_not_touch(
    tmp_path: Path, contacts: Any, verdict: str
) -> None:
    arm = link("arm", '<cylinder radius=".1" length="1"/>', 3, "0 0 .4", "0 0 .4")
    place = "0.5 0 0", f"0 {np.pi / 2} 0", "0 1 0"
    path = robot(tmp_path, BASE, arm, joint("base", "arm", "continuous", *place))
    assert kilter.check(kilter.load(path, contacts=contacts)).verdict == verdict


def test_a_base_that_floats_stands_on_the_floor_or_tips(tmp_path: Path) -> None:
    for reach, stable in ((0.4, True), (3.5, False)):
        arm = link("arm", '<box size=".2 .2 .2"/>', 10)
        path = robot(tmp_path, BASE, arm, joint("base", "arm", "fixed", f"{reach} 0 2"))
        assert kilter.check(kilter.load(path)).stable
        found = kilter.load(path, base="floating", floor=True)
        assert not any(part.grounded for part in found.parts if part.name != "floor")
        assert kilter.check(found).stable is stable


def test_frames_are_passed_over_and_hold_what_is_fixed_to_them(tmp_path: Path) -> None:
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


def test_meshes_are_found_beside_the_file_and_in_packages(tmp_path: Path) -> None:
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
def test_a_pipe_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    for name in ("pipe.stl", "package://pipe.stl", "package://somewhere/pipe.stl"):
        if name.startswith("package://some"):
            (tmp_path / "somewhere").mkdir()
            (tmp_path / "pipe.stl").rename(tmp_path / "somewhere" / "pipe.stl")
        shape = f'<mesh filename="{name}"/>'
        with pytest.raises(InputError, match=r"'pipe\.stl' is not a regular file; name a file"):
            kilter.load(robot(tmp_path, link("cube", shape)))


def test_a_mass_of_zero_is_a_note(tmp_path: Path) -> None:
    found = kilter.load(robot(tmp_path, link("base", '<box size="1 1 1"/>', 0)))
    assert found.notes[0] == "the mass of 'base' is 0, so it has its density"
    assert found.notes[1:] == ("the robot is its held root link: --base floating frees it",)
    assert found.geometry.mass.tolist() == [1000.0]


def test_a_capsule_is_a_cylinder_with_round_ends(tmp_path: Path) -> None:
    found = kilter.load(robot(tmp_path, link("a", '<capsule radius=".5" length="2"/>')))
    exact = np.pi * (0.5**2 * 2 + 4 / 3 * 0.5**3)
    assert found.geometry.volume[0] == pytest.approx(exact, rel=0.01)


def test_several_shapes_of_a_link_are_one_part(tmp_path: Path) -> None:
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
            [link("a", '<mesh filename="a.dae"/>')],
            r"part 'a': mesh files of type \.dae cannot be read; write",
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
def test_what_the_format_has_not_is_told(tmp_path: Path, elements: list[str], words: str) -> None:
    with pytest.raises(InputError, match=r"robot\.urdf: .*" + words):
        kilter.load(robot(tmp_path, *elements))


def test_a_base_is_fixed_or_floating_and_xml_is_of_one_of_two_kinds(tmp_path: Path) -> None:
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
def test_the_command_asks_the_same_and_its_proof_is_verified(tmp_path: Path) -> None:
    arm = link("arm", '<box size=".2 .2 .2"/>', 10)
    path = robot(tmp_path, BASE, arm, joint("base", "arm", "fixed", "3.5 0 2"))
    proof = str(tmp_path / "proof.json")
    for base, code in (("fixed", 0), ("floating", 1)):
        words = ["check", str(path), "--base", base, "--floor", "--quiet", "--proof", proof]
        assert main(words) == code
        assert main(["verify", str(path), proof, "--quiet"]) == 0
