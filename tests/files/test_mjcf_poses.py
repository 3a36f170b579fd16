"""New poses in a copy of the user's own MJCF file: all other text stays byte for byte."""

import difflib
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main

mujoco = pytest.importorskip("mujoco")

MESH = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
OWN = """<mujoco model="own">
  <!-- <key name="rest"/> </mujoco> is a comment -->
  <compiler autolimits="true"/>
  <option timestep="0.001" integrator="implicitfast" cone="elliptic"/>
  <asset><mesh name="m" file="m.obj"/></asset>
  <default><geom friction="0.7 0.01 0.002"/></default>
  <worldbody>
    <light name="lamp" pos="0 0 3"/>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <geom name="seen" type="mesh" mesh="m" pos="1 1 1" contype="0" conaffinity="0"/>
    <body name="a" pos="0 0 .05" euler="0 0 30"><freejoint name="fa"/>
      <geom type="box" size=".03 .03 .03"/></body>
    <body pos='.2 0 .04' name='b'><freejoint/><geom type="box" size=".03 .03 .03"/></body>
    <body name="arm" pos="1 0 .5"><joint name="j" axis="0 0 1" damping="1"/>
      <geom type="box" size=".1 .1 .1"/></body>
  </worldbody>
  <actuator><position name="motor" joint="j" kp="20"/></actuator>
  <sensor><jointpos joint="j"/></sensor>
{keys}</mujoco>
"""
SUNK = 1e-3
"""Largest way by which boxes sink into soft contacts [m]."""
KEYS = """  <keyframe>
    <key name="home" time="2" qpos="0 0 .06 1 0 0 0 .3 0 .05 1 0 0 0 .4"
         qvel="1 0 0 0 0 0 0 0 0 0 0 0 0" ctrl=".4"/>
  </keyframe>
"""


def scene(folder: Path, keys: str = "", text: str = OWN) -> Path:
    path = folder / "own.xml"
    path.write_text(text.replace("{keys}", keys))
    (folder / "m.obj").write_text(MESH)
    return path


def changes(before: Path, after: Path) -> list[str]:
    """The added and removed lines."""
    lines = (path.read_bytes().decode().splitlines() for path in (before, after))
    return [line for line in difflib.ndiff(*lines) if line[0] in "+-"]


def drift(path: Path, key: str | None = None) -> float:
    """Largest way of the bodies a and b in 2 s of MuJoCo [m]."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if key is not None:
        mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    mujoco.mj_forward(model, data)
    start = data.xpos.copy()
    while data.time < 2:
        mujoco.mj_step(model, data)
    rows = [model.body(name).id for name in "ab"]
    return float(np.linalg.norm(data.xpos - start, axis=1)[rows].max())


def settle(*words: object) -> int:
    return main(["settle", *map(str, words), "--ground", "arm", "--quiet"])


def test_the_bodies_move_and_all_other_text_stays(tmp_path, capsys):
    own, out = scene(tmp_path), tmp_path / "out.xml"
    assert settle(own, "-o", out) == 0
    lines = changes(own, out)
    assert [line[2:].strip()[:16] for line in lines if line[0] == "+"] == [
        '<body name="a" p',
        '<body pos="0.2 0',
    ]
    assert drift(out) < SUNK
    # the orientation of a body that only fell is that of the user
    assert 'name="a" pos="0 0 0.03" euler="0 0 30"' in out.read_text()
    assert kilter.load(out)["a"].pose.position[2] == pytest.approx(0.03, abs=1e-9)
    capsys.readouterr()


def test_a_new_keyframe_is_added_and_an_existing_one_is_replaced(tmp_path, capsys):
    own, out, again = scene(tmp_path), tmp_path / "out.xml", tmp_path / "again.xml"
    assert settle(own, "--keyframe", "rest", "-o", out) == 0
    assert {line[0] for line in changes(own, out)} == {"+"}
    model = mujoco.MjModel.from_xml_path(str(out))
    assert model.key("rest").qpos.reshape(-1)[[2, 9]] == pytest.approx([0.03, 0.03], abs=1e-9)
    assert drift(out, "rest") < SUNK
    assert settle(out, "--keyframe", "rest", "-o", again) == 0
    assert again.read_text().count("<key name=") == 2  # one of them in the comment
    capsys.readouterr()


def test_the_first_keyframe_is_that_of_the_pose(tmp_path, capsys):
    own, out = scene(tmp_path, KEYS), tmp_path / "out.xml"
    assert settle(own, "-o", out) == 0
    key = mujoco.MjModel.from_xml_path(str(out)).key("home")
    assert key.qpos[:3].tolist() == pytest.approx([0, 0, 0.03], abs=1e-9)
    assert (key.time[0], key.ctrl[0], key.qpos[-1]) == (2, 0.4, 0.4)
    assert not key.qvel.any()
    assert drift(out, "home") < SUNK
    # a new keyframe has the controls of the keyframe of the pose
    assert settle(own, "--keyframe", "rest", "-o", out) == 0
    model = mujoco.MjModel.from_xml_path(str(out))
    assert [model.key(k).name for k in range(model.nkey)] == ["home", "rest"]
    assert model.key("rest").ctrl[0] == 0.4
    assert model.key("home").qpos[2] == 0.06
    capsys.readouterr()


def test_a_state_is_written_into_the_named_keyframe(tmp_path, capsys):
    own, out = scene(tmp_path, KEYS), tmp_path / "out.xml"
    qpos = [0.5, 0, 0.2, 1, 0, 0, 0, 0.3, 0, 0.03, 1, 0, 0, 0, 0.4]
    np.save(tmp_path / "S.npy", qpos)
    for name, keys in (("rest", ["home", "rest"]), ("home", ["home"])):
        words = ("--state", tmp_path / "S.npy", "--keyframe", name)
        assert settle(own, *words, "-o", out) == 0
        model = mujoco.MjModel.from_xml_path(str(out))
        assert [model.key(k).name for k in range(model.nkey)] == keys
        assert model.key(name).qpos[:3] == pytest.approx([0.5, 0, 0.03], abs=1e-9)
    capsys.readouterr()


def test_line_ends_and_a_file_without_lines_stay(tmp_path, capsys):
    out = tmp_path / "out.xml"
    own = scene(tmp_path)
    own.write_bytes(own.read_bytes().replace(b"\n", b"\r\n"))
    assert settle(own, "--keyframe", "rest", "-o", out) == 0
    data = out.read_bytes()
    assert data.count(b"\n") == data.count(b"\r\n")
    own.write_bytes(own.read_bytes().replace(b"\r\n", b" "))
    assert settle(own, "--keyframe", "rest", "-o", out) == 0
    assert out.read_bytes().startswith(own.read_bytes()[: -len(b"</mujoco> ")])
    capsys.readouterr()


def test_assets_and_included_files_are_found_from_another_folder(tmp_path, capsys):
    (tmp_path / "there" / "assets").mkdir(parents=True)
    (tmp_path / "else").mkdir()
    text = OWN.replace("<default>", '<include file="defaults.xml"/><default>')
    own = scene(tmp_path / "there", text=text.replace("autolimits", 'meshdir="assets" autolimits'))
    (tmp_path / "there" / "m.obj").rename(tmp_path / "there" / "assets" / "m.obj")
    (tmp_path / "there" / "defaults.xml").write_text('<mujoco><size memory="10M"/></mujoco>')
    out = tmp_path / "else" / "out.xml"
    assert settle(own, "-o", out) == 0
    text = out.read_text()
    assert '<include file="../there/defaults.xml"/>' in text
    assert 'meshdir="../there/assets"' in text
    assert drift(out) < SUNK
    assert sorted(path.name for path in (tmp_path / "else").iterdir()) == ["out.xml"]
    capsys.readouterr()


def test_bodies_that_another_file_or_a_frame_states_get_a_keyframe(tmp_path, capsys):
    own, out = scene(tmp_path), tmp_path / "out.xml"
    body = '<body name="c" pos="-.3 0 .04"><freejoint/><geom type="box" size=".03 .03 .03"/></body>'
    framed = own.read_text().replace(
        "</worldbody>", f'<frame pos="0 .1 .1">{body}</frame></worldbody>'
    )
    own.write_text(framed)
    assert main(["settle", str(own), "--ground", "arm", "-o", str(out)]) == 0
    assert (
        "out.xml: pose at rest: its new keyframe 'rest' has the new poses"
        in capsys.readouterr().err
    )
    assert drift(out, "rest") < SUNK
    (tmp_path / "part.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    own.write_text(OWN.replace("{keys}", '  <include file="part.xml"/>\n'))
    assert settle(own, "-o", out) == 0
    assert drift(out, "rest") < SUNK
    capsys.readouterr()


def test_a_keyframe_of_an_included_file_is_not_replaced(tmp_path, capsys):
    own = scene(tmp_path, '  <include file="keys.xml"/>\n')
    (tmp_path / "keys.xml").write_text(f"<mujoco>{KEYS}</mujoco>")
    assert settle(own, "--keyframe", "home", "-o", tmp_path / "out.xml") == 2
    error = capsys.readouterr().err
    assert "the keyframe 'home' is in an included file; give the name of a new one" in error
    assert not (tmp_path / "out.xml").exists()


def test_poses_alone_are_a_row_of_qpos(tmp_path, capsys):
    own, out = scene(tmp_path, KEYS), tmp_path / "rest.npy"
    assert settle(own, "-o", out) == 0
    rows = np.load(out)
    assert rows.shape == (1, 15)
    assert rows[0] == pytest.approx(
        [0, 0, 0.03, 1, 0, 0, 0, 0.3, 0, 0.03, 1, 0, 0, 0, 0.4], abs=1e-9
    )
    assert main(["scene", str(own), "--state", str(out), "--ground", "arm", "--quiet"]) == 0
    # of other files: position and quaternion of each part
    tower = tmp_path / "t.kilter.json"
    kilter.dump(kilter.example("tower"), tower)
    assert main(["settle", str(tower), "-o", str(out), "--quiet"]) == 0
    parts = kilter.example("tower").parts
    wanted = [[*part.pose.position, *part.pose.rotation] for part in parts]
    assert np.allclose(np.load(out), wanted, rtol=0, atol=1e-9)
    capsys.readouterr()


def test_a_settled_scene_is_written_into_the_own_file_too(tmp_path, capsys):
    own, out = scene(tmp_path), tmp_path / "out.xml"
    words = ["scene", str(own), "--settle", "--ground", "arm", "--keyframe", "rest", "-o", str(out)]
    assert main(words) == 0
    assert drift(out, "rest") < SUNK
    capsys.readouterr()
