"""Mesh files: STL, OBJ, GLB and 3MF, their names, units and faults."""

import base64
import io
import json
import re
import struct
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from kilter.errors import InputError
from kilter.loading import load

# ruff: noqa: E501 (a row of a table is a line)


def moved(x: float = 0, y: float = 0, z: float = 0) -> np.ndarray:
    return trimesh.transformations.translation_matrix([x, y, z])


def scene(node_names: bool = False) -> trimesh.Scene:
    """Three bolts and a plate, with names of objects or of nodes."""
    found = trimesh.Scene()
    for k in range(3):
        found.add_geometry(
            trimesh.creation.box((1, 1, 1)),
            geom_name=f"g{k}" if node_names else "bolt",
            node_name=f"screw {k}" if node_names else None,
            transform=moved(3 * k),
        )
    found.add_geometry(trimesh.creation.box((2, 2, 2)), geom_name="plate", transform=moved(0, 9))
    return found


def refused(path: Path, **options: Any) -> InputError:
    with pytest.raises(InputError) as caught:
        load(path, **options)
    assert str(caught.value).startswith(f"{path}: "), str(caught.value)
    assert caught.value.hint
    return caught.value


# STL -----------------------------------------------------------------------------------


def test_a_binary_stl(write):
    data = trimesh.creation.box((0.1, 0.2, 0.3)).export(file_type="stl")
    assembly = load(write("Plate.STL", data), units="mm")
    assert assembly.names == ("Plate",)
    assert assembly.units == "mm"
    assert assembly.geometry.volume == pytest.approx([0.006])
    assert assembly.geometry.accuracy == pytest.approx([0.15 * 2**-24], rel=1e-6)
    assert assembly.geometry.single.all()


def test_bodies_of_a_binary_stl_are_taken_apart_although_they_touch(write):
    boxes = [trimesh.creation.box((1, 1, 1), transform=moved(0, 0, k)) for k in range(3)]
    data = trimesh.util.concatenate(boxes).export(file_type="stl")
    assembly = load(write("stack.stl", data))
    assert assembly.names == ("stack_1", "stack_2", "stack_3")
    assert assembly.geometry.volume == pytest.approx([1, 1, 1])


def ascii_stl(*solids: tuple[str, trimesh.Trimesh], number: str = "{!r}") -> str:
    lines = []
    for name, mesh in solids:
        lines.append(f"solid {name}")
        for triangle in mesh.triangles.tolist():
            rows = [" ".join(number.format(x) for x in corner) for corner in triangle]
            rows = ["facet normal 0 0 0", "outer loop", *(f"  vertex {row}" for row in rows)]
            lines += [*rows, "endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"


def test_solids_of_an_ascii_stl_keep_their_names(write):
    text = ascii_stl(
        ("base", trimesh.creation.box((2, 2, 2))),
        ("", trimesh.creation.box((1, 1, 1), transform=moved(5))),
        ("Bolzen Ä", trimesh.creation.box((1, 1, 1), transform=moved(9))),
    )
    assembly = load(write("a.stl", text))
    assert assembly.names == ("base", "a_2", "Bolzen Ä")
    assert assembly.geometry.volume == pytest.approx([8, 1, 1])


def test_one_solid_of_an_ascii_stl_takes_the_name_of_the_file(write):
    text = ascii_stl(("OpenSCAD_Model", trimesh.creation.box((2, 2, 2))))
    assert load(write("base.stl", text.upper().replace("E-", "e-"))).names == ("base",)


def test_an_ascii_stl_whose_corners_make_no_whole_facets_is_refused(write):
    text = "solid a\nfacet normal 0 0 1\n" + "vertex 0 0 1\n" * 4 + "endfacet\nendsolid a\n"
    with pytest.raises(InputError, match="4 corners are not a multiple of 3"):
        load(write("a.stl", text))


def test_an_ascii_stl_with_exponents_is_as_exact_as_its_digits(write):
    box = trimesh.creation.box((1 / 3, 1 / 7, 30 / 7))
    assembly = load(write("a.stl", ascii_stl(("a", box), number="{:.6e}")))
    assert assembly.geometry.accuracy == pytest.approx([0.5e-6])


STL_FAULTS = [
    (b"solid", "not an STL file: too short"),
    (bytes(84) + bytes(20), "no faces"),
    (bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(100), "the header states 4000000000 triangles"),
    (b"solid x" + bytes(73) + struct.pack("<I", 3) + bytes(100), "the header states 3 triangles, the file"),
    (b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0", "line 5: vertex is '1 0'"),
    (b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n", "last solid has no 'endsolid'"),
    (b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid", "has 1 corners"),
    (ascii_stl(("x", trimesh.creation.box())).replace("-0.5", "nan").encode(), "has the corner [nan, nan"),
    (b"", "the file is empty"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "message"), STL_FAULTS, ids=range(len(STL_FAULTS)))
def test_a_damaged_stl(data, message, write):
    assert message in str(refused(write("a.stl", data)))


def test_a_binary_stl_with_a_corner_that_is_not_finite(write):
    data = bytearray(trimesh.creation.box().export(file_type="stl"))
    data[84 + 50 + 12 : 84 + 50 + 16] = struct.pack("<f", float("nan"))
    assert "triangle 1 has the corner [nan" in str(refused(write("a.stl", bytes(data))))


def test_bytes_after_the_last_triangle_are_noted(write):
    data = trimesh.creation.box().export(file_type="stl") + b"more"
    assert load(write("a.stl", data)).notes == ("bytes after the last triangle are ignored",)


# GLB -----------------------------------------------------------------------------------


def test_a_glb_names_its_parts_by_node(write):
    assembly = load(write("a.glb", scene(node_names=True).export(file_type="glb")))
    assert assembly.names == ("screw 0", "screw 1", "screw 2", "plate")
    assert assembly.units == "m"
    assert assembly.geometry.center[:, 0] == pytest.approx([0, 3, 6, 0])
    assert assembly.geometry.single.all()


def gltf(edit: Any = None, mesh: trimesh.Trimesh | None = None) -> bytes:
    """A GLB file of a box with an edited header."""
    data = trimesh.Scene(mesh or trimesh.creation.box()).export(file_type="glb")
    size = int.from_bytes(data[12:16], "little")
    header, rest = json.loads(data[20 : 20 + size]), data[20 + size :]
    if edit:
        edit(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    return head + text + rest


def test_nodes_above_tell_parts_of_one_name_apart(write):
    def edit(header: dict[str, Any]) -> None:
        header["nodes"] = [
            {"name": "left", "children": [2, 3]},
            {"name": "right", "translation": [5, 0, 0], "children": [4, 5]},
            {"name": "bolt", "mesh": 0},
            {"name": "nut", "mesh": 0, "translation": [2, 0, 0]},
            {"name": "bolt", "mesh": 0},
            {"name": "bolt", "mesh": 0, "translation": [0, 3, 0]},
        ]
        header["scenes"] = [{"nodes": [0, 1]}]

    names = load(write("a.glb", gltf(edit))).names
    assert names == ("left/bolt", "nut", "right/bolt", "right/bolt_2")


def test_instances_of_a_mesh_stand_where_their_nodes_put_them(write):
    def edit(header: dict[str, Any]) -> None:
        header["nodes"] = [
            {"mesh": 0, "name": "bolt", "children": [1, 2]},
            {"mesh": 0, "name": "bolt", "translation": [3, 0, 0], "scale": [2, 1, 1]},
            {"mesh": 0, "translation": [0, 5, 0], "rotation": [0, 0, 1, 0], "scale": [1, -1, 1]},
        ]
        header["meshes"][0]["name"] = "nut"
        header["scenes"] = [{"nodes": [0]}]

    assembly = load(write("a.glb", gltf(edit)))
    assert assembly.names == ("bolt", "bolt/bolt", "nut")
    assert assembly.geometry.volume == pytest.approx([1, 2, 1])
    assert assembly.geometry.center[1:] == pytest.approx(np.array([[3, 0, 0], [0, 5, 0]]))
    assert not assembly.geometry.warnings  # a mirrored mesh still faces outwards


def test_primitives_of_one_mesh_are_one_part(write):
    def edit(header: dict[str, Any]) -> None:
        first = header["meshes"][0]["primitives"][0]
        corners = header["accessors"][first["indices"]]
        half = {**corners, "count": 18}
        header["accessors"] += [half, {**half, "byteOffset": 72}]
        header["meshes"][0]["primitives"] = [{**first, "indices": 2}, {**first, "indices": 3}]

    assembly = load(write("a.glb", gltf(edit)))
    assert len(assembly.parts) == 1
    assert assembly.geometry.volume == pytest.approx([1])


def test_a_nameless_glb_takes_the_name_of_the_file(write):
    def edit(header: dict[str, Any]) -> None:
        header["nodes"] = [{"mesh": 0}]
        header["scenes"] = [{"nodes": [0]}]
        del header["meshes"][0]["name"]

    assert load(write("box.glb", gltf(edit))).names == ("box",)


def text_gltf(folder: Path, inside: bool) -> Path:
    """The scene as .gltf, its buffers beside it or inside it."""
    for name, content in scene(node_names=True).export(file_type="gltf").items():
        (folder / name).write_bytes(content)
    path = folder / "model.gltf"
    header = json.loads(path.read_bytes())
    for buffer in header["buffers"] if inside else ():
        data = base64.b64encode((folder / buffer["uri"]).read_bytes()).decode()
        buffer["uri"] = f"data:application/octet-stream;base64,{data}"
    path.write_text(json.dumps(header))
    return path


@pytest.mark.parametrize("inside", [False, True])
def test_a_text_gltf_is_the_same_as_its_glb(inside, write):
    glb = load(write("a.glb", scene(node_names=True).export(file_type="glb")))
    found = load(text_gltf(write("x", b"").parent, inside))
    assert found.names == glb.names
    assert found.units == "m"
    for a, b in zip(found.parts, glb.parts, strict=True):
        assert np.array_equal(a.shape.vertices, b.shape.vertices)
        assert np.array_equal(a.shape.triangles, b.shape.triangles)


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("../secret.bin", "leads out of the folder"),
        ("none.bin", "no such file"),
        (None, "buffer 0 of the glTF has no content"),
        ("data:;base64,AAAA", "numbers end at byte"),
        ("data:;base64,A", "damaged"),
    ],
)
def test_a_text_gltf_with_faulty_buffers(uri, message, write):
    path = text_gltf(write("x", b"").parent, False)
    header = json.loads(path.read_bytes())
    for buffer in header["buffers"]:
        buffer["uri"] = uri
    path.write_text(json.dumps(header))
    assert message in str(refused(path))


def test_units_asked_for_a_glb_win_over_the_standard(write):
    assembly = load(write("a.glb", gltf()), units="mm")
    assert assembly.units == "mm"
    assert assembly.geometry.volume == pytest.approx([1])
    assert assembly.notes == ("the units of this format are m; the given units mm are used",)


GLB_EDITS = [
    (
        lambda h: h.update(extensionsRequired=["KHR_draco_mesh_compression"]),
        "compressed with KHR_draco",
    ),
    (lambda h: h["buffers"][0].update(uri="a.bin"), "meshes are in other files"),
    (lambda h: h["accessors"][1].update(count=10**12), "numbers end at byte"),
    (lambda h: h["accessors"][1].update(count=-1), "damaged GLB"),
    (lambda h: h["accessors"][0].update(count=35), "35 corners are not a multiple of 3"),
    (lambda h: h["accessors"][1].update(count=4), "names vertex"),
    (lambda h: h["accessors"][0].update(componentType=5126), "not integers"),
    (lambda h: h["nodes"][-1].update(mesh=7), "damaged GLB: mesh 7 of"),
    (lambda h: h["nodes"][-1].update(children=[len(h["nodes"]) - 1]), "has two parent nodes"),
    (lambda h: h["nodes"][-1].update(translation=[0, 0, float("nan")]), "is not finite"),
    (lambda h: h["meshes"][0]["primitives"][0].update(mode=0), "no faces"),
    (lambda h: h.update(meshes={}), "damaged GLB"),
    (lambda h: h.update(nodes=[5]), "damaged GLB: nodes.0: input should be"),
    (lambda h: h["scenes"][0].update(nodes=[-1]), "damaged GLB: scenes.0.nodes.0"),
    (lambda h: h["accessors"][1].update(type="VEC2"), "is of type 'VEC2', not VEC3"),
    (lambda h: h["accessors"][1].update(bufferView=9), "buffer view 9 of"),
    (lambda h: h["accessors"][1].pop("componentType"), "componentType: field required"),
    (lambda h: h["nodes"][-1].update(rotation=[0, 0, 1]), "rotation: list should have at least"),
]


@pytest.mark.quick(15)
@pytest.mark.parametrize(("edit", "message"), GLB_EDITS, ids=range(len(GLB_EDITS)))
def test_a_faulty_glb(edit, message, write):
    assert message in str(refused(write("a.glb", gltf(edit))))


def test_a_glb_with_a_vertex_that_is_not_finite(write):
    data = bytearray(gltf(lambda h: h["nodes"][-1].update(name="lid")))
    data[-96:-92] = struct.pack("<f", float("inf"))
    error = refused(write("a.glb", bytes(data)))
    assert error.part == "lid"
    assert "vertex 0 is [inf" in error.what


# 3MF -----------------------------------------------------------------------------------


def model(body: str, unit: str = 'unit="millimeter"') -> bytes:
    """A 3MF file of objects and items given as XML."""
    space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    production = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        text = f'<model {unit} xmlns="{space}" xmlns:p="{production}">{body}</model>'
        archive.writestr("3D/3dmodel.model", text)
        other = f'<model xmlns="{space}"><resources>{xml_object("7", "far")}</resources></model>'
        archive.writestr("3D/Objects/other.model", other)
    return stream.getvalue()


def xml_object(key: str, name: str = "", size: float = 1.0) -> str:
    box = trimesh.creation.box((size, size, size))
    corners = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in box.vertices.tolist())
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in box.faces.tolist())
    title = f'name="{name}"' if name else ""
    mesh = f"<mesh><vertices>{corners}</vertices><triangles>{faces}</triangles></mesh>"
    return f'<object id="{key}" {title}>{mesh}</object>'


def built(*items: str, objects: str) -> str:
    return f"<resources>{objects}</resources><build>{''.join(items)}</build>"


def item(key: str, x: float = 0) -> str:
    return f'<item objectid="{key}" transform="1 0 0 0 1 0 0 0 1 {x} 0 0"/>'


def test_a_3mf_of_another_program(write):
    assembly = load(write("a.3mf", scene().export(file_type="3mf")))
    assert assembly.names == ("bolt", "bolt_1", "bolt_2", "plate")
    assert assembly.units == "mm"
    assert assembly.geometry.center[:, 0] == pytest.approx([0, 3, 6, 0])


def test_instances_of_a_3mf_object_are_numbered(write):
    body = built(item("1"), item("1", 5), objects=xml_object("1", "bolt"))
    assembly = load(write("a.3mf", model(body)))
    assert assembly.names == ("bolt", "bolt_2")
    assert assembly.geometry.center[:, 0] == pytest.approx([0, 5])


def test_components_of_a_3mf_object_are_parts(write):
    path = 'p:path="/3D/Objects/other.model"'
    components = f'<component objectid="1"/><component objectid="7" {path} transform="0 1 0 -1 0 0 0 0 1 4 0 0"/>'
    objects = (
        xml_object("1")
        + f'<object id="2" name="pair"><components>{components}</components></object>'
    )
    assembly = load(write("a.3mf", model(built(item("2", 1), objects=objects))))
    assert assembly.names == ("pair", "far")
    assert assembly.geometry.center[:, 0] == pytest.approx([1, 5])


UNITS = [("micron", "mm", 1e-9), ("centimeter", "cm", 1), ("foot", "in", 12**3), ("meter", "m", 1)]


@pytest.mark.parametrize(("unit", "units", "volume"), [*UNITS, ("", "mm", 1), ("inch", "in", 1)])
def test_units_of_a_3mf(unit, units, volume, write):
    text = f'unit="{unit}"' if unit else ""
    path = write("a.3mf", model(built(item("1"), objects=xml_object("1")), text))
    assembly = load(path)
    assert assembly.names == ("a",)
    assert assembly.units == units
    assert assembly.geometry.volume == pytest.approx([volume])
    assert load(path, units=units).units == units
    other = "m" if units != "m" else "mm"
    message = f"the file is in {units}, but the units given are {other}"
    assert message in refused(path, units=other).what


def circular() -> str:
    components = '<components><component objectid="1"/></components>'
    return built(item("1"), objects=f'<object id="1">{components}</object>')


THREEMF_FAULTS = [
    (b"PK\x03\x04 no zip", "the file is damaged: File is not a zip file"),
    (model(built(item("1"), objects=xml_object("1")))[:-40], "the file is damaged: "),
    (model("<resources>"), "the file is damaged: mismatched tag"),
    (model(built(item("9"), objects=xml_object("1"))), "object '9' is not in 3D/3dmodel.model"),
    (model(built(item("1"), objects=xml_object("1")), 'unit="ell"'), "unit 'ell' is not a unit of 3MF"),
    (model(circular()), "object '1' contains itself"),
    (model(built(objects=xml_object("1"))), "no faces"),
    (model(built(item("1", float("nan")), objects=xml_object("1"))), "transform is '1 0 0"),
    (model(built(item("1"), objects=xml_object("1", "lid").replace('v1="', 'v1="99', 1))), "part 'lid': face"),
    (model(built(item("1"), objects=xml_object("1", "lid").replace('x="-0.5"', 'x="nan"', 1))), "part 'lid': vertex 0 is [nan"),
    (model(built(item("1"), objects=xml_object("1", "lid").replace('x="-0.5"', 'x="wide"', 1))), "part 'lid': damaged 3MF"),
    (model(built(item("1"), objects=xml_object("1", "lid").replace(' x="-0.5"', "", 1))), "part 'lid': damaged 3MF"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "message"), THREEMF_FAULTS, ids=range(len(THREEMF_FAULTS)))
def test_a_damaged_3mf(data, message, write):
    assert message in str(refused(write("a.3mf", data)))


def test_a_zip_without_a_model(write):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("readme.txt", "hello")
    assert "not a 3MF file" in str(refused(write("a.3mf", stream.getvalue())))


# every kind ----------------------------------------------------------------------------


def text_gltf_in_itself() -> bytes:
    """The scene as .gltf with its buffers inside."""
    with TemporaryDirectory() as folder:
        return text_gltf(Path(folder), inside=True).read_bytes()


GOOD = {
    ".gltf": text_gltf_in_itself(),
    ".stl": trimesh.creation.box().export(file_type="stl"),
    ".glb": gltf(),
    ".ply": trimesh.creation.box().export(file_type="ply", encoding="ascii"),
    ".off": trimesh.creation.box().export(file_type="off").encode(),
    ".3mf": model(built(item("1"), objects=xml_object("1", "lid"))),
    ".obj": trimesh.creation.box().export(file_type="obj").encode(),
    ".json": b'{"kilter": 1, "parts": [{"name": "C1", "box": [1, 1, 1]}]}',
}


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(
    suffix=st.sampled_from(sorted(GOOD)),
    at=st.integers(0),
    put=st.binary(min_size=1, max_size=4),
    cut=st.booleans(),
)
def test_damage_anywhere_gives_no_other_exception(suffix, at, put, cut, tmp_path_factory):
    data = GOOD[suffix]
    at %= len(data)
    path = tmp_path_factory.getbasetemp() / f"damaged{suffix}"
    path.write_bytes(data[:at] if cut else data[:at] + put + data[at + len(put) :])
    try:
        load(path)
    except InputError as error:
        message = str(error)
    else:
        message = f"{path}: "
    assert message.startswith(f"{path}: ")


@pytest.mark.parametrize(("name", "kind"), [("a.dxf", ".dxf"), ("noending", "(no ending)")])
def test_an_unknown_ending_lists_what_is_read(name, kind, write):
    message = str(refused(write(name, "x")))
    assert (
        f"cannot read files of type {kind}; give .json, .obj, .stl, .3mf, .glb, .gltf, .ply, .off, .dae, .3dm,"
        in message
    )
    endings = ".step, .stp, .igs, .iges, .fcstd, .xml, .mjcf, .urdf, .sdf, .world, .usda, .usdc, .usd, .usdz, .ldr, .mpd, .txt, .csv"
    assert f"{endings}, or a folder" in message


@pytest.mark.parametrize(
    ("name", "export"),
    [
        ("frame.SLDASM", "export the file from SolidWorks: .* a STEP file"),
        ("frame.asm.7", "export the file from Creo"),
        ("frame.f3d", "Fusion"),
        ("house.skp", "SketchUp: .* OBJ"),
        ("scene.blend", "Blender: .* glTF"),
    ],
)
def test_a_native_format_names_the_export_of_its_program(name, export, write):
    message = str(refused(write(name, "x")))
    assert "is the native format of a CAD program" in message
    assert re.search(export, message)


def test_a_folder_of_native_files_names_the_export(write):
    folder = write("frame.SLDPRT", "x").parent
    assert "export the parts from SolidWorks" in refused(folder).hint


@pytest.mark.parametrize("name", ["plate.stl", "plate.json", "plate", "plate.step"])
def test_a_missing_file_names_the_nearest(name, write):
    near = write("plates.stl", b"x")
    assert f"no such file; did you mean {near.name!r}?" in str(refused(near.with_name(name)))


@pytest.mark.parametrize("source", ["", None, 5, "a\0b"])
def test_what_is_no_path(source):
    with pytest.raises(InputError):
        load(source)


def test_a_file_without_rights(write, monkeypatch):
    def refuse(_: Path, mode: str) -> bytes:
        raise PermissionError(13, "Permission denied")

    path = write("a.stl", GOOD[".stl"])
    monkeypatch.setattr(Path, "open", refuse)  # the superuser may read every file
    assert "cannot be read: Permission denied; check" in str(refused(path))


def test_density_of_meshes(write):
    assembly = load(write("a.stl", GOOD[".stl"]), density=7850, units="m")
    assert assembly.geometry.mass == pytest.approx([7850])


def test_a_part_named_ground_is_refused_with_the_file(write):
    assert "the name 'ground' is reserved" in str(refused(write("ground.stl", GOOD[".stl"])))


TIP = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def test_objects_keep_their_names(write, obj_box):
    text = "mtllib absent.mtl\no base plate\n" + obj_box(2) + "usemtl red\no Bolzen Ä\n"
    assembly = load(write("a.obj", text + obj_box(1, (5, 0, 0), 9)))
    assert assembly.names == ("base plate", "Bolzen Ä")
    assert assembly.geometry.volume == pytest.approx([8, 1])
    assert assembly.units == "m"
    assert not any(part.grounded for part in assembly.parts)
    assert assembly.source.endswith("a.obj")


def test_nothing_is_printed_about_an_absent_material(write, capfd):
    load(write("a.obj", "mtllib absent.mtl\nusemtl red\n" + TIP))
    assert capfd.readouterr() == ("", "")


def test_objects_of_one_name_are_numbered(write, obj_box):
    text = "".join(f"o bolt\n{obj_box(1, (3 * k, 0, 0), 8 * k + 1)}" for k in range(3))
    assert load(write("a.obj", text)).names == ("bolt", "bolt_2", "bolt_3")


def test_a_group_that_is_taken_up_again_goes_on(write):
    vertices, faces = TIP.split("f", 1)
    faces = ("f" + faces).strip().split("\n")
    text = f"g a\n{vertices}{faces[0]}\ng b\ng a\n" + "\n".join(faces[1:])
    assembly = load(write("a.obj", text))
    assert assembly.names == ("a",)
    assert assembly.geometry.volume == pytest.approx([1 / 6])


def test_groups_within_objects_are_no_parts(write, obj_box):
    head, tail = obj_box().split("f ", 1)
    assert load(write("a.obj", f"o box\n{head}g bottom\nf {tail}")).names == ("box",)


def test_a_file_without_names_takes_its_own(write, obj_box):
    assert load(write("Block 7.obj", obj_box())).names == ("Block 7",)


def test_separate_bodies_without_names_are_taken_apart(write, obj_box):
    assembly = load(write("wall.obj", obj_box() + obj_box(1, (0, 0, 1), 9)))
    assert assembly.names == ("wall_1", "wall_2")
    assert assembly.geometry.volume == pytest.approx([1, 1])


def test_every_form_of_a_corner(write):
    text = "v 0 0 0 1 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nvp 0\ns off\n"
    text += "f -4 -2 -3\nf 1/1 2/1 4/1\nf 2/1/1 3/1/1 4/1/1\nf 1//1 4//1 \\\n 3//1 # last\nl 1 2\n"
    assembly = load(write("a.OBJ", text.replace("\n", "\r\n")))
    assert assembly.geometry.volume == pytest.approx([1 / 6])


def test_a_concave_polygon_is_cut_right(write):
    corners = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
    rows = [f"v {x} {y} {z}" for z in (0, 1) for x, y in corners]
    sides = [f"f {k + 1} {(k + 1) % 5 + 1} {(k + 1) % 5 + 6} {k + 6}" for k in range(5)]
    text = "\n".join([*rows, "f 5 4 3 2 1", "f 6 7 8 9 10", *sides])
    assert load(write("a.obj", text)).geometry.volume == pytest.approx([8])


def test_vertices_may_follow_the_faces(write):
    vertices, faces = TIP.split("f", 1)
    assert load(write("a.obj", "f" + faces + vertices)).names == ("a",)


def test_a_file_that_is_not_utf8(write):
    assert load(write("a.obj", b"o Gr\xfc\xdfe\n" + TIP.encode())).names == ("Grüße",)


def test_a_name_with_the_sign_of_a_comment(write):
    assert load(write("a.obj", "# made by hand\no part #3\n" + TIP)).names == ("part #3",)


FAULTS = [
    (
        "v nan 0 0\n" + TIP.replace("f 1 3 2", "f 1 3 2"),
        "line 2: vertex 1 is [nan, 0.0, 0.0]; give",
    ),
    (TIP + "v 0 inf 0\n", "line 10: vertex 5 is [0.0, inf, 0.0]; give finite"),
    (TIP + "f 1 2 9\n", "line 10: the face names vertex 9, the file has 4; vertices are numbered"),
    (TIP + "f 1 2 0\n", "line 10: the face names vertex 0, the file has 4"),
    (TIP + "f 1 2 -5\n", "line 10: the face names vertex -5, the file has 4"),
    (TIP + "f 1 2\n", "line 10: face is '1 2'; name three or more"),
    (TIP + "f 1 2 x\n", "line 10: face is '1 2 x'; name three"),
    (TIP + "f 1 2 1.5\n", "line 10: face is '1 2 1.5'"),
    ("v 1 2\n" + TIP, "line 2: vertex is '1 2'; give three numbers"),
    ("v 1,5 2 3\n" + TIP, "line 2: vertex is '1,5 2 3'; give three"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_a_fault_names_file_object_and_line(text, message, write):
    path = write("a.obj", "o tip\n" + text)
    with pytest.raises(InputError) as caught:
        load(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert message in said
    assert caught.value.part in ("tip", None)
    assert caught.value.part == "tip" or "vertex 5" in said  # a vertex that no face uses


@pytest.mark.parametrize("text", ["# nothing\n", "v 0 0 0\n", "hello world\n"])
def test_a_file_without_faces(text, write):
    with pytest.raises(InputError, match=r"a\.obj: no faces; export solids"):
        load(write("a.obj", text))
