"""The kilter file: every shape and entry is written and read back."""

# ruff: noqa: E501 (a part is a line, as in the file)
import io
import itertools
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kilter.assembly import Assembly, Feature, FrictionPair, GivenContact, Joint, Load, Part
from kilter.assembly.part import Brick
from kilter.errors import InputError
from kilter.files import dump, from_dict, schema, to_dict
from kilter.loading import load
from kilter.rigid import Pose, unit
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Sphere

TETRAHEDRON = (
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
)


def full() -> Assembly:
    """An assembly with every kind of shape and entry."""
    single = np.array(TETRAHEDRON[0], dtype=np.float32) * np.float32(0.1)
    return Assembly(
        [
            Part("table", Box([0.1, 2, 3]), grounded=True),
            Part("C2", Cylinder(0.3, 7), Pose([1, 0, -0.0], [0.5, 0.1, 0, 0]), density=7850),
            Part(
                "C3",
                Sphere(2 / 3),
                Pose([0, 0, 5]),
                mass=0.25,
                center_of_mass=[1, 2, 3],
                inertia=[0.1, 0.2, 1 / 7, 1 / 30, -0.01, 0.02],
            ),
            Part("C4", Prism([[0, 0], [4, 0], [1, 1], [0, 3]], 1), Pose(rotation=[0, 1, 0, 0])),
            Part("C5", Mesh(*TETRAHEDRON)),
            Part("C6", Mesh(single, TETRAHEDRON[1])),
            Part("C7", Mesh(*TETRAHEDRON, accuracy=1e-4)),
            Part("C8", Box([16, 32, 9.6]), brick=Brick((2, 4))),
            Part("C9", Box([8, 8, 3.2]), brick=Brick((1, 1), plates=1, color=4)),
        ],
        units="in",
        gravity=[0, 1 / 3, -9.81],
        friction=0.2,
        friction_pairs=[FrictionPair(("C2", "C3"), 0.7)],
        loads=[Load("C2", force=[1, 2, 3]), Load("C3", torque=[0, 0, 0.1], point=[1, 1, 1])],
        contacts=[
            GivenContact(("table", "C2"), [[0, 0, 0], [1, 0, 0]], [0.1, 0.2, 0.7], 0.4),
            GivenContact(
                ("C2", "C3"),
                [[0, 0, 0]],
                [0, 0, 2],
                feature=(Feature("face", [1, 3, 0], (1 / 3, -2)), Feature("edge", [3, 1, 0], 0.7)),
            ),
            GivenContact(
                ("C2", "C4"),
                [[0, 0, 0]],
                [0, 0, 2],
                feature=[
                    Feature("vertex"),
                    Feature("face", None, 0.1, [0, 0, 1 / 3], [0, 0, 3]),
                ],
            ),
        ],
        joints=[
            Joint(("C5", "ground")),
            Joint(("C5", "C6"), "fixed", [0, 0, 1], [1, 2, 3]),
            Joint(("C5", "C7"), "revolute", [0, 0, 1], [1, 2, 3]),
            Joint(("C4", "C6"), "prismatic", axis=[0, 2, 3]),
            Joint(("ground", "C3"), "cylindrical", [1 / 3, 0, 0], [1, 1, 1]),
            Joint(("C2", "C6"), "spherical", [0.1, 0.2, 0.3]),
        ],
        detect=False,
    )


def test_everything_reads_back_to_the_last_digit(tmp_path):
    path = tmp_path / "a.kilter.json"
    dump(full(), path)
    again = load(path)
    assert to_dict(again) == to_dict(full())
    assert again.source == str(path)
    assert [part.brick for part in again.parts] == [part.brick for part in full().parts]
    assert (
        [p.shape.accuracy for p in again.parts[4:7]]
        == [  # type: ignore[union-attr]
            p.shape.accuracy
            for p in full().parts[4:7]  # type: ignore[union-attr]
        ]
    )
    assert again.parts[5].shape.accuracy == pytest.approx(0.1 * 2**-24)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("brick", "says"),
    [
        ({"cells": [2, 0]}, "cells of a brick are (2, 0)"),
        ({"cells": [2, 4], "plates": 0}, "height of a brick in plates is 0"),
        ({"cells": [2, 4], "color": -1}, "colour of a brick is -1"),
        ({"cells": [2, 4], "colour": 1}, "did you mean 'color'?"),
        ({"cells": [2]}, "brick"),
    ],
)
def test_a_brick_that_is_none(brick, says):
    part = {"name": "C1", "box": [16, 32, 9.6], "brick": brick}
    with pytest.raises(InputError) as caught:
        from_dict({"kilter": 1, "parts": [part]})
    assert says in str(caught.value)
    assert "C1" in str(caught.value)


def test_a_brick_is_a_box():
    part = {"name": "C1", "sphere": {"radius": 1}, "brick": {"cells": [2, 4]}}
    with pytest.raises(InputError, match="give a box, or no brick"):
        from_dict({"kilter": 1, "parts": [part]})


def test_a_planar_assembly_reads_back(tmp_path):
    assembly = Assembly([Part("C1", Prism([[0, 0], [4, 0], [4, 3]], 1))], planar=True)
    dump(assembly, tmp_path / "a.json")
    assert load(tmp_path / "a.json").planar


def test_defaults_are_left_out():
    assert to_dict(Assembly([Part("C1", Sphere(1))])) == {
        "kilter": 1,
        "units": "m",
        "parts": [{"name": "C1", "sphere": {"radius": 1.0}}],
    }


names = st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(
    lambda s: s != "ground"
)
number = st.floats(-1e9, 1e9)
vector = st.tuples(number, number, number)
length = st.floats(1e-6, 1e9)
side = st.floats(1e-3, 1e3)
direction = vector.filter(lambda v: float(np.linalg.norm(v)) > 1e-3)
mesh = st.builds(
    lambda scale, shift: Mesh(np.array(TETRAHEDRON[0]) * scale + shift, TETRAHEDRON[1]),
    length,
    vector,
)
shape = st.one_of(
    st.builds(Box, st.tuples(length, length, length)),
    st.builds(Cylinder, length, length),
    st.builds(Sphere, length),
    st.builds(lambda a, b, d: Prism([[0, 0], [a, 0], [0, b]], d), side, side, length),
    mesh,
)
pose = st.builds(Pose, vector, st.tuples(number, number, number, number).filter(any))
part = st.builds(
    Part,
    names,
    shape,
    pose,
    st.booleans(),
    st.none() | length,
    st.none() | length,
    st.none() | vector,
)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    st.lists(part, min_size=1, max_size=4, unique_by=lambda p: p.name),
    direction,
    st.sampled_from(["m", "cm", "mm", "in"]),
)
def test_any_assembly_reads_back(parts, gravity, units):
    assembly = Assembly(
        parts,
        units=units,
        gravity=gravity,
        contacts=[
            GivenContact((a.name, b.name), [[0, 0, 1]], gravity)
            for a, b in itertools.pairwise(parts)
        ],
    )
    written = to_dict(assembly)
    assert to_dict(from_dict(json.loads(json.dumps(written)), folder=".", source="")) == written


@given(direction)
def test_a_unit_normal_stays_as_written(normal):
    n = unit(normal).tolist()
    entry = {"parts": ["a", "b"], "points": [[0, 0, 0]], "normal": n}
    parts = [{"name": name, "box": [1, 1, 1]} for name in "ab"]
    data = {"kilter": 1, "parts": parts, "contacts": [entry]}
    assert from_dict(data).contacts[0].normal.tolist() == n


def test_a_normal_of_another_length_is_made_one():
    entry = {"parts": ["a", "b"], "points": [[0, 0, 0]], "normal": [0, 0, 2]}
    parts = [{"name": name, "box": [1, 1, 1]} for name in "ab"]
    data = {"kilter": 1, "parts": parts, "contacts": [entry]}
    assert from_dict(data).contacts[0].normal.tolist() == [0, 0, 1]


def test_the_file_of_the_interface(write):
    write("c1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    data = {
        "kilter": 1, "units": "mm", "gravity": [0, 0, -9.81], "friction": 0.0,
        "parts": [
            {"name": "C1", "mesh": "c1.obj", "grounded": True},
            {"name": "C2", "box": [40, 20, 10], "pose": {"position": [0, 0, 5], "rotation": [1, 0, 0, 0]}, "density": 7850},
            {"name": "C3", "mesh": {"vertices": TETRAHEDRON[0], "faces": TETRAHEDRON[1]}, "mass": 0.25, "center_of_mass": [1, 2, 3]},
            {"name": "C4", "polygon": [[0, 0], [4, 0], [4, 3]], "depth": 1},
            {"name": "C5", "cylinder": {"radius": 2, "height": 10}},
            {"name": "C6", "sphere": {"radius": 2}},
        ],
        "friction_pairs": [{"parts": ["C1", "C2"], "mu": 0.3}],
        "loads": [{"part": "C2", "point": [0, 0, 10], "force": [0, 0, -5], "torque": [0, 0, 0]}],
        "contacts": [{"parts": ["C1", "C2"], "points": [[0, 0, 0]], "normal": [0, 0, 1], "mu": 0.3}],
        "joints": [{"parts": ["C2", "C3"], "kind": "fixed"}],
        "planar": False,
    }  # fmt: skip
    assembly = load(write("a.kilter.json", data))
    assert assembly.names == ("C1", "C2", "C3", "C4", "C5", "C6")
    assert assembly.units == "mm"
    assert assembly.geometry.mass[1] == pytest.approx(7850 * 40 * 20 * 10 * 1e-9)


def test_inline_faces_may_be_quads_and_concave():
    corners = [[0, 0], [4, 0], [4, 3], [2, 1], [0, 3]]  # a concave polygon
    vertices = [[x, y, z] for z in (0, 1) for x, y in corners]
    sides = [[k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5] for k in range(5)]
    faces = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], *sides]
    data = {"kilter": 1, "parts": [{"name": "V", "mesh": {"vertices": vertices, "faces": faces}}]}
    assert from_dict(data).geometry.volume[0] == pytest.approx(8)


@pytest.mark.parametrize(
    "name", ["Größe 2", 'a"b\\c', "a/b", "零件", "tab\there", "🧱", "C 1", "*"]
)
def test_names_of_any_kind(name, tmp_path):
    assembly = Assembly([Part(name, Sphere(1))])
    dump(assembly, tmp_path / "a.json")
    assert load(tmp_path / "a.json").names == (name,)


def test_null_is_absent():
    part = {"name": "C1", "box": [1, 1, 1], "density": None, "pose": None, "mesh": None}
    assert from_dict({"kilter": 1, "parts": [part]}).parts[0].density is None


def test_a_file_begins_with_a_byte_order_mark(write):
    text = '\ufeff{"kilter": 1, "parts": [{"name": "C1", "box": [1, 1, 1]}]}'
    assert load(write("a.json", text)).names == ("C1",)


def test_standard_input(write, monkeypatch):
    path = write(
        "c1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    monkeypatch.chdir(path.parent)
    data = {"kilter": 1, "parts": [{"name": "C1", "mesh": "c1.obj"}]}
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(json.dumps(data).encode())))
    assert load("-").source == "standard input"


def test_the_schema_knows_every_key_that_is_written():
    data, found = to_dict(full()) | {"planar": False}, schema()
    assert set(data) <= set(found["properties"])
    part = found["$defs"]["PartEntry"]["properties"]
    assert {key for entry in data["parts"] for key in entry} <= set(part)


def test_importing_the_layer_is_light():
    code = "import sys, kilter.files; print([m for m in ('pydantic', 'trimesh', 'shapely', 'scipy') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# density and units ---------------------------------------------------------------------


def test_density_fills_what_has_neither_density_nor_mass(write):
    parts = [
        {"name": "none", "box": [1, 1, 1]},
        {"name": "density", "box": [1, 1, 1], "density": 5},
        {"name": "mass", "box": [1, 1, 1], "mass": 5},
    ]
    assembly = load(write("a.json", {"kilter": 1, "parts": parts}), density=7)
    assert assembly.geometry.mass.tolist() == [7, 5, 5]


def test_units_that_differ_from_the_file_are_refused(write):
    path = write(
        "a.json", {"kilter": 1, "units": "mm", "parts": [{"name": "C1", "box": [1, 1, 1]}]}
    )
    assert load(path, units="mm").units == "mm"
    with pytest.raises(
        InputError, match=r"a\.json: the file is in mm, but the units given are m; leave"
    ):
        load(path, units="m")


@pytest.mark.parametrize("density", [-1, 0, float("nan"), "heavy", True])
def test_a_density_that_is_none(density, write):
    path = write("a.json", {"kilter": 1, "parts": [{"name": "C1", "box": [1, 1, 1]}]})
    with pytest.raises(InputError, match=r"density is .*; give a number above 0"):
        load(path, density=density)


def test_unknown_units_are_refused_before_reading():
    with pytest.raises(InputError, match="unknown units 'ft'; use one of"):
        load("absent.stl", units="ft")


# meshes named by parts -----------------------------------------------------------------


def test_a_mesh_file_is_read_once_and_in_the_units_of_the_assembly(write, tmp_path):
    import trimesh

    (tmp_path / "m").mkdir()
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "m" / "c.glb")
    parts = [{"name": n, "mesh": "m/c.glb"} for n in "ab"]
    assembly = load(write("a.json", {"kilter": 1, "units": "mm", "parts": parts}))
    assert assembly.geometry.volume == pytest.approx([1e9, 1e9])
    assert assembly.parts[0].shape is assembly.parts[1].shape


def test_several_objects_of_a_mesh_file_are_one_part(write, obj_box):
    write("two.obj", "o a\n" + obj_box() + "o b\n" + obj_box(1, (3, 0, 0), 9))
    assembly = load(write("a.json", {"kilter": 1, "parts": [{"name": "P", "mesh": "two.obj"}]}))
    assert assembly.geometry.volume == pytest.approx([2])
    assert assembly.notes == ("mesh 'two.obj' holds 2 objects, read as a single part",)


# writing -------------------------------------------------------------------------------


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    path.write_text("old")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(InputError, match=r"a\.json: cannot be written: No space left on device;"):
        dump(full(), path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(os.name != "posix", reason="rights and links of POSIX")
def test_a_file_is_replaced_with_its_rights_and_through_a_link(tmp_path):
    path, link = tmp_path / "a.json", tmp_path / "link.json"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    dump(full(), link)
    assert link.is_symlink()
    assert load(path).names == full().names
    assert path.stat().st_mode & 0o777 == 0o640


def test_one_part_a_line(tmp_path):
    dump(full(), tmp_path / "a.json")
    lines = (tmp_path / "a.json").read_text(encoding="utf-8").split("\n")
    assert sum('"name"' in line for line in lines) == len(full().parts)
    assert all(line.count('"name"') <= 1 for line in lines)


@pytest.mark.parametrize("where", ["absent/a.json", "."])
def test_where_nothing_can_be_written(where, tmp_path):
    with pytest.raises(InputError, match=r"cannot be written: .*; check the folder"):
        dump(full(), tmp_path / where)


def test_a_name_that_is_no_text(tmp_path):
    with pytest.raises(InputError, match=r"a\.json: cannot be written: .*; give names of valid"):
        dump(Assembly([Part("a\ud800", Sphere(1))]), tmp_path / "a.json")
    assert not list(tmp_path.iterdir())
