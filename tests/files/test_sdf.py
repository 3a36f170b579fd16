"""SDF models and worlds: poses and frames, shapes, joints, friction, includes and faults."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kilter
from kilter.errors import InputError

# ruff: noqa: E501 (a row of a table is a line)

BOX = "<collision name='c'>{inner}<geometry><box><size>1 2 3</size></box></geometry></collision>"
PLANE = """<model name='floor'><static>1</static><link name='l'><collision name='c'><geometry>
<plane><normal>0 0 1</normal></plane></geometry></collision></link></model>"""


def box(inner: str = "") -> str:
    return BOX.format(inner=inner)


def world(text: str, **attributes: str) -> str:
    return f"<sdf version='1.9'><world name='w'>{text}</world></sdf>"


def read(folder: Path, text: str, name: str = "w.sdf") -> kilter.Assembly:
    (folder / name).write_text(text)
    return kilter.load(folder / name)


def place(assembly: kilter.Assembly, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Position and rotation matrix of a part."""
    part = assembly.parts[assembly.names.index(name)]
    return part.pose.position, part.pose.matrix


def turn(axis: int, degrees: float) -> np.ndarray:
    cos, sin = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix = np.eye(3)
    matrix[[i, j], [i, j]] = cos
    matrix[i, j], matrix[j, i] = -sin, sin
    return matrix


def test_poses_of_model_link_and_collision_are_multiplied(tmp_path):
    text = f"""<model name='m'><pose>1 2 3 0 0 {np.pi / 2!r}</pose>
    <link name='l'><pose degrees='true'>1 0 0 30 0 0</pose>{box("<pose>0 0 1 0 0 0</pose>")}</link></model>"""
    position, matrix = place(read(tmp_path, world(text)), "m")
    expected = turn(2, 90) @ turn(0, 30)
    assert matrix == pytest.approx(expected, abs=1e-12)
    assert position == pytest.approx([1, 3, 3] + expected @ [0, 0, 1], abs=1e-12)


def test_angles_are_those_about_fixed_axes_and_quaternions_are_read(tmp_path):
    text = f"""<model name='a'><pose degrees='1'>0 0 9 20 30 40</pose><link name='l'>{box()}</link></model>
    <model name='b'><pose rotation_format='quat_xyzw'>0 0 3 0 0 .6 .8</pose><link name='l'>{box()}</link></model>"""
    found = read(tmp_path, world(text))
    assert place(found, "a")[1] == pytest.approx(turn(2, 40) @ turn(1, 30) @ turn(0, 20), abs=1e-12)
    angle = 2 * np.rad2deg(np.arctan2(0.6, 0.8))
    assert place(found, "b")[1] == pytest.approx(turn(2, angle), abs=1e-12)


def test_frames_relative_to_links_joints_models_and_the_world(tmp_path):
    text = f"""<frame name='spot'><pose>5 0 0 0 0 0</pose></frame>
    <model name='m'><pose relative_to='spot'>0 1 0 0 0 0</pose>
      <link name='a'><pose>0 0 1 0 0 0</pose>{box()}</link>
      <frame name='f' attached_to='a'><pose degrees='1'>0 0 2 0 0 90</pose></frame>
      <link name='b'><pose relative_to='f'>3 0 0 0 0 0</pose>{box()}</link>
      <joint name='j' type='fixed'><pose>0 0 7 0 0 0</pose><parent>a</parent><child>b</child></joint>
      <link name='c'><pose relative_to='j'/>{box()}</link>
      <model name='n'><pose relative_to='a'>0 0 20 0 0 0</pose>
        <link name='d'><pose relative_to='__model__'>0 0 1 0 0 0</pose>{box()}</link></model>
    </model>"""
    found = read(tmp_path, world(text))
    assert place(found, "m::a")[0] == pytest.approx([5, 1, 1])
    assert place(found, "m::b")[0] == pytest.approx([5, 4, 3])
    assert place(found, "m::c")[0] == pytest.approx([5, 4, 10])
    assert place(found, "m::n")[0] == pytest.approx([5, 1, 22])


def test_a_placement_frame_stands_where_the_pose_says(tmp_path):
    text = f"""<model name='m' placement_frame='top'><pose degrees='1'>0 0 9 0 0 90</pose>
      <link name='l'><pose>4 0 0 0 0 0</pose>{box()}</link>
      <frame name='top' attached_to='l'><pose>1 0 0 0 0 0</pose></frame></model>"""
    # the frame lies 5 along x of the model, which is turned to y
    assert place(read(tmp_path, world(text)), "m")[0] == pytest.approx([0, -1, 9])


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        ("<box><size>1 2 3</size></box>", 6),
        ("<sphere><radius>2</radius></sphere>", 32 / 3 * np.pi),
        ("<cylinder><radius>1</radius><length>3</length></cylinder>", 3 * np.pi),
        ("<capsule><radius>1</radius><length>3</length></capsule>", (3 + 4 / 3) * np.pi),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", 8 * np.pi),
    ],
)
def test_volumes_of_shapes(shape, volume, tmp_path):
    text = f"<model name='m'><link name='l'><collision name='c'><geometry>{shape}</geometry></collision></link></model>"
    assert read(tmp_path, world(text)).geometry.volume[0] == pytest.approx(volume, rel=0.02)


def test_mass_centre_and_inertia_in_a_turned_frame(tmp_path):
    inertial = """<inertial><pose degrees='1'>.1 0 0 0 0 90</pose><mass>2</mass>
    <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>"""
    found = read(
        tmp_path, world(f"<model name='m'><link name='l'>{inertial}{box()}</link></model>")
    )
    part = found.parts[0]
    assert part.given_mass == 2
    assert part.center_of_mass == pytest.approx([0.1, 0, 0])
    assert part.inertia == pytest.approx([2, 1, 2.5, 0, 0, 0], abs=1e-12)


@pytest.mark.parametrize(("mu", "stable"), [(0.58, True), (0.57, False)])
def test_a_box_on_a_ramp_holds_by_the_lesser_friction(mu, stable, tmp_path):
    """On a ramp of 30 degrees the limit is tan 30 deg = .57735."""
    rough = f"<surface><friction><ode><mu>{mu}</mu><mu2>2</mu2></ode></friction></surface>"
    side = "<geometry><box><size>{0} {0} 1</size></box></geometry>"
    middle = " ".join(f"{x!r}" for x in (turn(1, 30) @ [0.3, 0, 1]).tolist())
    text = f"""<model name='ramp'><static>true</static><pose degrees='1'>0 0 0 0 30 0</pose><link name='l'>
    <collision name='c'>{side.format(9)}</collision></link></model>
    <model name='m'><pose degrees='1'>{middle} 0 30 0</pose><link name='l'>
    <collision name='c'>{rough}{side.format(2)}</collision></link></model>"""
    verdict = kilter.check(read(tmp_path, world(text)), assume="drawn")
    assert verdict.stable is stable


def test_a_plane_holds_and_a_static_model_is_held(tmp_path):
    text = f"{PLANE}<model name='m'><pose>0 0 1.5 0 0 0</pose><link name='l'>{box()}</link></model>"
    found = read(tmp_path, world(text))
    assert [part.name for part in found.parts if part.grounded] == ["floor"]
    assert kilter.check(found).stable


HINGE = """<model name='door'>{self}<link name='frame'>{box}</link>
<link name='leaf'><pose>1 0 0 0 0 0</pose>{box}</link>
<joint name='j' type='{kind}'><pose>-.5 0 0 0 0 0</pose><parent>frame</parent><child>leaf</child>
<axis><xyz>{axis}</xyz><limit><lower>-1</lower><upper>{upper}</upper></limit>
<dynamics><friction>.25</friction></dynamics></axis></joint>
<joint name='w' type='fixed'><parent>world</parent><child>frame</child></joint></model>"""


@pytest.mark.parametrize(
    ("kind", "upper", "limits"),
    [("revolute", "2", (-1, 2)), ("continuous", "2", None), ("revolute", "1e16", (-1, 1e16))],
)
def test_a_hinge_has_its_axis_limits_and_friction(kind, upper, limits, tmp_path):
    text = HINGE.format(box=box(), kind=kind, axis="0 0 1", upper=upper, self="")
    joint, ground = read(tmp_path, f"<sdf version='1.7'>{text}</sdf>").joints
    assert joint.parts == ("door::leaf", "door::frame")
    assert joint.kind == "revolute"
    assert joint.point == pytest.approx([0.5, 0, 0])
    assert joint.axis == pytest.approx([0, 0, 1])
    assert joint.friction == 0.25
    assert joint.limits == (limits if limits is None else pytest.approx(limits))
    assert ground.parts == ("door::frame", "ground")


def test_a_hinge_holds_across_its_axis_only(tmp_path):
    for axis, stable in (("0 0 1", True), ("0 1 0", False)):
        text = HINGE.format(box=box(), kind="revolute", axis=axis, upper="2", self="")
        assert kilter.check(read(tmp_path, f"<sdf version='1.7'>{text}</sdf>")).stable is stable


def test_links_of_a_model_touch_only_with_self_collide(tmp_path):
    text = f"""{PLANE}<model name='m'>{{self}}<link name='a'><pose>0 0 1.5 0 0 0</pose>{box()}</link>
    <link name='b'><pose>0 0 4.5 0 0 0</pose>{box()}</link></model>"""
    apart = read(tmp_path, world(text.format(self="")))
    assert any("do not touch each other" in note for note in apart.notes)
    assert kilter.check(apart, assume="drawn").moving == ["m::b"]
    both = read(tmp_path, world(text.format(self="<self_collide>true</self_collide>")))
    assert kilter.check(both).stable


def test_includes_are_read_from_folders_beside_the_file(tmp_path, monkeypatch):
    folder = tmp_path / "crate"
    folder.mkdir()
    (folder / "model.config").write_text("<model><sdf version='1.6'>new.sdf</sdf></model>")
    model = f"<sdf version='1.6'><model name='crate'><pose>0 0 5 0 0 0</pose><link name='l'>{box()}</link></model></sdf>"
    (folder / "new.sdf").write_text(model)
    text = world(
        "<include><uri>model://crate</uri></include>"
        "<include><name>other</name><uri>crate/new.sdf</uri><pose>3 0 0 0 0 0</pose><static>1</static></include>"
        "<include><uri>model://absent</uri></include>"
    )
    found = read(tmp_path, text)
    assert found.names == ("crate", "other")
    assert place(found, "crate")[0] == pytest.approx([0, 0, 5])
    assert place(found, "other")[0] == pytest.approx([3, 0, 0])
    assert [part.grounded for part in found.parts] == [False, True]
    assert any(
        "'model://absent'" in note and "GZ_SIM_RESOURCE_PATH" in note for note in found.notes
    )
    away = tmp_path / "elsewhere"
    away.mkdir()
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path))
    assert read(away, world("<include><uri>model://crate</uri></include>")).names == ("crate",)


def test_a_mesh_in_a_scale_and_an_absent_mesh(tmp_path):
    import trimesh

    trimesh.creation.box((1, 1, 1)).export(tmp_path / "cube.stl")
    mesh = "<collision name='{0}'><geometry><mesh><uri>{0}</uri><scale>1 2 3</scale></mesh></geometry></collision>"
    text = f"<model name='m'><link name='l'>{mesh.format('cube.stl')}{mesh.format('no.stl')}</link></model>"
    found = read(tmp_path, world(text))
    assert found.geometry.volume[0] == pytest.approx(6)
    assert any("mesh file is absent ('no.stl')" in note for note in found.notes)


def test_faults_that_simulators_tolerate(tmp_path):
    text = f"\n<?xml version='1.0'?><!-- two -- hyphens -->{world('<plugin/><gz:odd/>' + f'<model name={chr(39)}m{chr(39)}><link name={chr(39)}l{chr(39)} gz:type={chr(39)}x{chr(39)}>{box()}</link></model>')}"
    assert read(tmp_path, text).names == ("m",)
    still = world(f"<gravity>0 0 0</gravity><model name='m'><link name='l'>{box()}</link></model>")
    found = read(tmp_path, still)
    assert found.gravity.tolist() == [0, 0, -9.8]
    assert any("no gravity" in note for note in found.notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no link has a shape; give its links <collision>"),
        (
            f"<model name='m'><pose>1 2</pose><link name='l'>{box()}</link></model>",
            "a pose is '1 2'; give 6 numbers",
        ),
        (
            f"<model name='m'><pose relative_to='no'/><link name='l'>{box()}</link></model>",
            "the frame 'no' is unknown",
        ),
        (
            f"<model name='m'><link name='a'><pose relative_to='b'/>{box()}</link><link name='b'><pose relative_to='a'/>{box()}</link></model>",
            "its pose depends on itself",
        ),
        (
            f"<model name='m'><link name='l'>{box()}</link><link name='l'>{box()}</link></model>",
            "two elements have this name",
        ),
        (
            "<model name='m'><link name='l'><collision name='c'><geometry><box><size>1 a 2</size></box></geometry></collision></link></model>",
            "size is '1 a 2'",
        ),
        ("<include><uri>w.sdf</uri></include>", "no link has a shape"),
    ],
)
def test_wrong_files(text, message, tmp_path):
    with pytest.raises(InputError, match=message):
        read(tmp_path, world(text))


def test_a_model_that_includes_itself(tmp_path):
    with pytest.raises(InputError, match="includes itself"):
        read(
            tmp_path,
            "<sdf version='1.9'><model name='m'><include><name>x</name><uri>w.sdf</uri></include></model></sdf>",
        )


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(at=st.integers(0, 10**6), put=st.binary(max_size=8), cut=st.booleans())
def test_damaged_files_are_read_or_refused(tmp_path_factory, at, put, cut):
    data = world(
        PLANE + HINGE.format(box=box(), kind="revolute", axis="0 0 1", upper="2", self="")
    ).encode()
    at %= len(data)
    path = tmp_path_factory.getbasetemp() / "damaged.sdf"
    path.write_bytes(data[:at] if cut else data[:at] + put + data[at + len(put) :])
    try:
        kilter.load(path)
    except InputError as error:
        message = str(error)
    else:
        message = f"{path}: "
    assert message.startswith(f"{path}: ")
