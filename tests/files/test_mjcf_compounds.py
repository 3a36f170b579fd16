"""A compound stays a compound in a written MJCF file, with the friction of its geoms."""

from xml.etree import ElementTree

import numpy as np
import pytest

import kilter
from kilter.files.own.kilter_json import from_dict
from kilter.files.robots.mjcf import hull_notes

mujoco = pytest.importorskip("mujoco")

BIN = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <body name="bin" pos="0 0 .01">
      <freejoint/>
      <geom type="box" size=".2 .15 .01" friction="{mu}" priority="{rank}"/>
      <geom type="box" size=".01 .15 .1" pos=".19 0 .11"/>
      <geom type="box" size=".01 .15 .1" pos="-.19 0 .11"/>
      <geom type="box" size=".18 .01 .1" pos="0 .14 .11"/>
      <geom type="box" size=".18 .01 .1" pos="0 -.14 .11"/>
    </body>
    <body name="cube" pos="0 0 .05"><freejoint/><geom type="box" size=".03 .03 .03"/></body>
    <body name="rod" pos=".08 0 .08"><freejoint/><geom type="capsule" size=".02 .04"/></body>
  </worldbody>
</mujoco>
"""


def read(text: str) -> kilter.Assembly:
    return kilter.load(mujoco.MjSpec.from_string(text))


def drift(text: str, names: list[str], seconds: float = 2.0) -> float:
    """Largest way of some bodies in a simulation [m]."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.xpos.copy()
    while data.time < seconds:
        mujoco.mj_step(model, data)
    rows = [model.body(name).id for name in names]
    return float(np.linalg.norm(data.xpos - start, axis=1)[rows].max())


def test_a_bin_keeps_its_five_boxes_and_the_cube_in_it_stays():
    scene = read(BIN.format(mu=1, rank=0))
    text = scene.to_mjcf()
    kinds = [geom.get("type") for geom in ElementTree.fromstring(text).iter("geom")]
    assert sorted(kinds) == ["box"] * 7 + ["capsule"]
    assert hull_notes(scene) == []
    assert drift(text, ["bin", "cube"]) < 1e-3


def test_the_hull_of_a_bin_throws_the_cube_out_and_a_note_says_so():
    scene = read(BIN.format(mu=1, rank=0))
    shape = scene["bin"].shape
    merged = kilter.Mesh(shape.vertices, shape.triangles)
    parts = [
        kilter.Part(p.name, merged if p.name == "bin" else p.shape, p.pose, grounded=p.grounded)
        for p in scene.parts
    ]
    merged_scene = kilter.Assembly(parts, gravity=scene.gravity, friction=1.0)
    text = merged_scene.to_mjcf()
    assert drift(text, ["cube"], 0.5) > 1e-2
    assert hull_notes(merged_scene) == [
        "MuJoCo closes the hollows of meshes without convex pieces: 'bin'"
    ]
    assert "<!-- MuJoCo closes the hollows" in text


@pytest.mark.parametrize("first", ["bin", "cube"])
def test_a_geom_keeps_the_friction_of_its_own_pair(first):
    text = BIN.format(mu=0.25, rank=1)
    if first == "cube":  # the cube before the bin: the pieces of a pair are turned
        start, end = text.index('<body name="cube"'), text.index('<body name="rod"')
        cube = text[start:end]
        text = (text[:start] + text[end:]).replace('<body name="bin"', cube + '<body name="bin"')
    model = mujoco.MjModel.from_xml_string(read(text).to_mjcf())
    found = {}
    for k in range(model.npair):
        ends = {model.geom(model.pair_geom1[k]).name, model.geom(model.pair_geom2[k]).name}
        found[frozenset(ends)] = model.pair_friction[k, 0]
    assert found[frozenset({"bin/0", "cube"})] == 0.25
    assert all(found.get(frozenset({f"bin/{k}", "cube"}), 1.0) == 1.0 for k in range(1, 5))


def test_a_compound_of_compounds_is_written_with_all_its_shapes():
    text = """
    <mujoco><worldbody><body name="dumbbell" pos="0 0 1"><freejoint/>
      <geom type="capsule" size=".01 .1" quat=".70710678 0 .70710678 0"/>
      <geom type="sphere" size=".05" pos=".1 0 0"/>
      <geom type="cylinder" size=".05 .02" pos="-.1 0 0"/>
    </body></worldbody></mujoco>
    """
    geoms = list(ElementTree.fromstring(read(text).to_mjcf()).iter("geom"))
    assert [geom.get("type") for geom in geoms] == ["capsule", "sphere", "cylinder"]
    again, once = (read(each).geometry for each in (read(text).to_mjcf(), text))
    assert np.allclose(again.center, once.center, rtol=0, atol=1e-12)
    assert again.volume == pytest.approx(once.volume, rel=1e-12)


def test_bodies_that_a_scene_excludes_stay_excluded():
    text = BIN.format(mu=1, rank=0).replace(
        "</mujoco>", '<contact><exclude body1="cube" body2="rod"/></contact></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(read(text).to_mjcf())
    signs = {(s >> 16, s & 0xFFFF) for s in model.exclude_signature.tolist()}
    assert {tuple(sorted((model.body("cube").id, model.body("rod").id)))} == signs


def test_a_kilter_file_keeps_the_shapes_of_a_compound(tmp_path):
    text = BIN.format(mu=0.25, rank=1).replace(
        "</body>", '<geom type="capsule" size=".02 .05" pos="0 0 .3"/></body>', 1
    )
    scene = read(text)
    path = tmp_path / "bin.kilter.json"
    kilter.dump(scene, path)
    again = kilter.load(path)
    mine, own = again["bin"].shape, scene["bin"].shape
    assert mine == own
    assert mine.members == own.members
    assert mine.member_pieces == own.member_pieces
    assert again.to_mjcf() == scene.to_mjcf()
    kilter.dump(again, tmp_path / "again.kilter.json")
    assert (tmp_path / "again.kilter.json").read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("member", "words"),
    [
        ({}, "has 0 shapes; give exactly one of box, cylinder, sphere and mesh"),
        ({"box": [1, 1, 1], "sphere": {"radius": 1}}, "has 2 shapes; give exactly one of box"),
        ({"prism": 1}, r"unknown key 'mesh.members\[0\].prism'"),
    ],
)
def test_a_wrong_shape_of_a_compound_is_a_sentence(member, words):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    mesh = {"vertices": corners, "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]}
    part = {"name": "a", "mesh": {**mesh, "members": [member]}}
    with pytest.raises(kilter.InputError, match=words):
        from_dict({"kilter": 1, "parts": [part]})
