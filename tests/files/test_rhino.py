"""Rhino files: meshes, blocks, bodies without meshes, units, damage."""

import numpy as np
import pytest

import kilter
from kilter import InputError

rhino3dm = pytest.importorskip("rhino3dm", reason="pip install 'kilter[rhino]'")

QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def cube(x=0.0, y=0.0, z=0.0, triangles=False):
    mesh = rhino3dm.Mesh()
    for corner in np.ndindex(2, 2, 2):
        mesh.Vertices.Add(*(np.array([x, y, z]) + corner))
    for quad in QUADS:
        if triangles:
            mesh.Faces.AddFace(quad[0], quad[1], quad[2])
            mesh.Faces.AddFace(quad[0], quad[2], quad[3])
        else:
            mesh.Faces.AddFace(*quad)
    return mesh


def named(name):
    attributes = rhino3dm.ObjectAttributes()
    attributes.Name = name
    return attributes


@pytest.fixture
def model():
    made = rhino3dm.File3dm()
    made.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Centimeters
    return made


def written(model, tmp_path):
    path = tmp_path / "a.3dm"
    assert model.Write(str(path), 8)
    return path


def test_meshes_are_parts_with_their_names_and_units(model, tmp_path):
    model.Objects.AddMesh(cube(), named("low"))
    model.Objects.AddMesh(cube(z=1, triangles=True), named("high"))
    found = kilter.load(written(model, tmp_path), ground=["low"])
    assert found.names == ("low", "high")
    assert found.units == "cm"
    assert found.geometry.volume == pytest.approx([1, 1])
    assert kilter.check(found).level is not None
    beside = kilter.load(written(model, tmp_path), ground=["low"]).with_pose("high", [0.6, 0, 0])
    assert kilter.check(beside).level is None


def test_a_body_without_a_name_has_that_of_its_layer(model, tmp_path):
    layer = rhino3dm.Layer()
    layer.Name = "walls"
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = model.Layers.Add(layer)
    model.Objects.AddMesh(cube(), attributes)
    assert kilter.load(written(model, tmp_path)).names == ("walls",)


def test_blocks_are_placed_where_their_instances_are(model, tmp_path):
    index = model.InstanceDefinitions.Add(
        "stone", "", "", "", rhino3dm.Point3d(0, 0, 0), (cube(),), (named("stone"),)
    )
    block = model.InstanceDefinitions.FindIndex(index)
    for k in range(2):
        place = rhino3dm.Transform.Translation(3.0 * k, 0, 5)
        model.Objects.AddInstanceObject(rhino3dm.InstanceReference(block.Id, place))
    found = kilter.load(written(model, tmp_path))
    assert found.geometry.center == pytest.approx(np.array([[0.5, 0.5, 5.5], [3.5, 0.5, 5.5]]))


def test_what_is_left_out_is_noted(model, tmp_path):
    model.Objects.AddMesh(cube(), named("low"))
    ball = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 3), 1)
    model.Objects.AddBrep(rhino3dm.Brep.CreateFromSphere(ball), named("ball"))
    model.Objects.AddPoint(rhino3dm.Point3d(0, 0, 0))
    found = kilter.load(written(model, tmp_path))
    assert found.names == ("low",)
    assert any("bodies without a render mesh are left out: 1 (ball)" in n for n in found.notes)
    assert any("other objects that are left out: 1" in n for n in found.notes)


def test_a_unit_that_kilter_has_not_is_a_sentence(model, tmp_path):
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Feet
    model.Objects.AddMesh(cube())
    with pytest.raises(InputError, match="the file is in feet; use one of Millimeters"):
        kilter.load(written(model, tmp_path))


def test_a_file_without_bodies_has_no_faces(model, tmp_path):
    model.Objects.AddPoint(rhino3dm.Point3d(0, 0, 0))
    with pytest.raises(InputError, match="no faces"):
        kilter.load(written(model, tmp_path))


@pytest.mark.slow
def test_two_hundred_damaged_files_give_a_sentence(model, tmp_path):
    model.Objects.AddMesh(cube(), named("low"))
    model.Objects.AddMesh(cube(z=1), named("high"))
    whole = written(model, tmp_path).read_bytes()
    rng = np.random.default_rng(3)
    path = tmp_path / "damaged.3dm"
    refused = 0
    for k in range(200):
        data = bytearray(whole)
        if k % 2:
            data = data[: rng.integers(len(data))]
        else:
            for at in rng.integers(len(data), size=rng.integers(1, 30)):
                data[at] = rng.integers(256)
        path.write_bytes(bytes(data))
        try:
            kilter.load(path)
            message = f"{path}: "
        except InputError as error:
            message, refused = str(error), refused + 1
        assert message.startswith(f"{path}: ")
    assert 50 < refused < 200
