"""COMPAS assemblies: names, supports, polygons, faults."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from kilter import Assembly, Box, Part, Sphere
from kilter.errors import InputError
from kilter.files.compas_files import from_compas, to_compas
from kilter.loading import load
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS, Mesh


def block(z: float = 0, **attributes: Any) -> dict[str, Any]:
    corners = {
        str(k): {"x": x, "y": y, "z": c + z} for k, (x, y, c) in enumerate(BOX_CORNERS.tolist())
    }
    faces = {str(k): quad for k, quad in enumerate(BOX_QUADS.tolist())}
    data = {"attributes": attributes, "vertex": corners, "face": faces}
    return {"dtype": "compas_assembly.datastructures/Block", "data": data}


def compas(nodes: dict[str, Any], **graph: Any) -> dict[str, Any]:
    inner = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, **graph}}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": inner}}


def test_blocks_are_parts_in_the_order_of_their_keys(write):
    data = compas({k: {"block": block(float(k))} for k in ("10", "2", "0")})
    assembly = load(write("a.json", data), units="cm", density=2000)
    assert assembly.names == ("0", "2", "10")
    assert assembly.units == "cm"
    assert assembly.geometry.mass == pytest.approx([2e-3] * 3)
    assert not any(part.grounded for part in assembly.parts)


def test_names_that_blocks_share_give_way_to_keys(write):
    blocks = {"0": block(name="Block"), "1": block(1, name="Block"), "2": block(2, name="key")}
    assembly = load(write("a.json", compas({k: {"block": b} for k, b in blocks.items()})))
    assert assembly.names == ("0", "1", "key")


@pytest.mark.parametrize("mark", ["node", "block", "default"])
def test_supports_are_held(mark, write):
    own = {"is_support": True} if mark == "block" else {}
    nodes = {"0": {"block": block(**own)}, "1": {"block": block(1), "is_support": False}}
    if mark == "node":
        nodes["0"]["is_support"] = True
    defaults = {"default_node_attributes": {"is_support": mark == "default"}}
    assembly = load(write("a.json", compas(nodes, **defaults)))
    assert [part.grounded for part in assembly.parts] == [True, False]


def test_older_files_say_datatype_and_value(write):
    graph = {"node": {"0": {"block": block()["data"]}}}
    data = {"datatype": "compas_assembly.datastructures/Assembly", "value": {"graph": graph}}
    assert load(write("a.json", data)).geometry.volume == pytest.approx([1])


def test_files_of_2021_hold_the_nodes_in_the_assembly(write):
    node = {"node": {"0": {"block": block()}, "1": {"block": block(1)}}}
    kind = "compas_assembly.datastructures/Assembly"
    files = [
        {"dtype": kind, "value": {"data": node, "datatype": kind}},
        {"data": node, "datatype": kind},
    ]
    found = [load(write(f"{k}.json", data)) for k, data in enumerate(files)]
    assert [assembly.names for assembly in found] == [("0", "1")] * 2
    assert found[0].geometry.volume == pytest.approx([1, 1])


def test_a_list_of_meshes_is_an_assembly(write):
    mesh = {"dtype": "compas.datastructures/Mesh", "data": block(2, name="lid")["data"]}
    assembly = load(write("a.json", [block(), block(1), mesh]))
    assert assembly.names == ("0", "1", "lid")
    assert assembly.geometry.center[:, 2] == pytest.approx([0, 1, 2])
    assert load(write("b.json", mesh)).names == ("lid",)


def test_a_list_of_other_objects_is_refused(write):
    point = {"dtype": "compas.geometry/Point", "data": [0, 0, 0]}
    with pytest.raises(InputError, match="not meshes"):
        load(write("a.json", [block(), point]))


def test_densities_of_blocks_are_theirs(write):
    nodes = {"0": {"block": block(density=2.5)}, "1": {"block": block(1, density=None)}}
    assembly = load(write("a.json", compas(nodes)), density=3)
    assert assembly.geometry.mass == pytest.approx([2.5, 3])


@pytest.mark.parametrize("density", [0, -1, "heavy", float("inf"), [1], True])
def test_a_density_that_is_none_is_refused(density, write):
    with pytest.raises(InputError, match="part 'stone': density is"):
        load(write("a.json", compas({"0": {"block": block(name="stone", density=density)}})))


# interfaces ------------------------------------------------------------------------------

FRAME = {"dtype": "compas.geometry/Frame", "data": {"xaxis": [1, 0, 0], "yaxis": [0, 1, 0]}}
DOWN = {"xaxis": [0, 1, 0], "yaxis": [1, 0, 0]}
CORNERS = [[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]]


def stacked(edge: dict[str, Any], u: str = "0", v: str = "1") -> dict[str, Any]:
    nodes = {"0": {"block": block(), "is_support": True}, "1": {"block": block(1)}}
    return compas(nodes, edge={u: {v: edge}, v: {}})


def faced(frame: Any, points: Any = CORNERS) -> dict[str, Any]:
    data = {"points": points, "frame": frame}
    return {"dtype": "compas_assembly.datastructures/Interface", "data": data}


@pytest.mark.parametrize("frame", [FRAME, DOWN, None], ids=["up", "down", "none"])
@pytest.mark.parametrize("ends", [("0", "1"), ("1", "0")], ids=["upwards", "downwards"])
def test_an_interface_pushes_the_blocks_apart(frame, ends, write):
    """The sense of the frame and of the edge has no effect, since writers differ."""
    path = write("a.json", stacked({"interfaces": [faced(frame)]}, *ends))
    assembly = load(path, contacts="file")
    assert not assembly.detect
    (contact,) = assembly.contacts
    assert contact.parts == ends
    assert contact.normal.tolist() == [0, 0, 1 if ends == ("0", "1") else -1]
    assert contact.points.tolist() == CORNERS
    assert load(path, contacts="geometry").contacts == ()


@pytest.mark.parametrize("edge", [
    {"interface": faced(FRAME)},
    {"interface": faced(FRAME)["data"], "interfaces": None},
    {"interface_points": CORNERS, "interface_uvw": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    {"interfaces": [faced(FRAME, [{"dtype": "compas.geometry/Point", "data": p}
                                  for p in CORNERS])]},
])  # fmt: skip
def test_older_interfaces(edge, write):
    (contact,) = load(write("a.json", stacked(edge)), contacts="file").contacts
    assert contact.points.tolist() == CORNERS
    assert contact.normal.tolist() == [0, 0, 1]


def test_interfaces_of_the_file_are_noted(write):
    path = write("a.json", stacked({"interfaces": [faced(FRAME)]}))
    (note,) = load(path).notes
    assert note.startswith("the file has 1 interfaces")
    assert "--contacts file" in note
    assert not load(path).contacts
    assert not load(path, contacts="file").notes


@pytest.mark.parametrize(("edge", "words"), [
    ({"interfaces": []}, "has no interfaces; leave contacts='file' out"),
    ({"interfaces": [faced(FRAME, [])]}, "of '0' and '1' has no valid corners"),
    ({"interfaces": [faced(FRAME, [[0, 0], [1]])]}, "no valid corners"),
    ({"interfaces": [faced(FRAME, [[0, 0, float("nan")]])]}, "no valid corners"),
    ({"interfaces": [faced({"xaxis": [1, 0, 0], "yaxis": [2, 0, 0]})]}, "no valid corners"),
    ({"interfaces": [faced({"xaxis": 5, "yaxis": [2, 0, 0]})]}, "no valid corners"),
])  # fmt: skip
def test_interfaces_that_cannot_be_used_are_refused(edge, words, write):
    with pytest.raises(InputError, match=words):
        load(write("a.json", stacked(edge)), contacts="file")


def test_an_interface_of_a_block_that_is_not_there(write):
    data = compas({"0": {"block": block()}}, edge={"0": {"9": {"interface": faced(FRAME)}}})
    with pytest.raises(InputError, match="names the unknown block '9'"):
        load(write("a.json", data), contacts="file")


def broken(**change: Any) -> dict[str, Any]:
    data = block(name="stone")
    data["data"] |= change
    return compas({"0": {"block": data}})


FAULTS = [
    (compas({}), "has no blocks; export the assembly"),
    ({"dtype": "compas.geometry/Point", "data": [0, 0, 0]}, "has no blocks"),
    (compas({"7": {}}), "part '7': the node has no block with vertices"),
    (compas({"7": 5}), "part '7': the node has no block"),
    (broken(vertex={"0": {"x": None}}), "part 'stone': vertex 0 is [None, 0.0, 0.0]; give three"),
    (broken(vertex={"0": {"x": True}}), "part 'stone': vertex 0 is [True"),
    (broken(vertex={"0": {"x": float("nan")}}, face={}), "part 'stone': vertex 0 is [nan"),
    (broken(face={"0": [0, 1, 99]}), "part 'stone': face 0 names the unknown vertex 99"),
    (broken(face={"0": [0, 1]}), "part 'stone': face 0 has 2 corners"),
    (broken(face={"0": 5}), "part 'stone': face 0 is not a list"),
]


@pytest.mark.parametrize(("data", "message"), FAULTS, ids=range(len(FAULTS)))
def test_a_fault_names_file_and_block(data, message, write):
    path: Path = write("a.json", data)
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert caught.value.hint


@pytest.mark.parametrize(("units", "per_metre"), [("m", 1), ("mm", 1000), ("in", 1 / 0.0254)])
def test_a_written_assembly_keeps_its_masses_in_every_unit(units, per_metre):
    """A ball becomes triangles, which enclose less than it: its density makes up for that."""
    table = Part("table", Box([2 * per_metre] * 3), grounded=True, density=700.0)
    ball = Part("ball", Sphere(0.1 * per_metre), [0, 0, 1.1 * per_metre], density=500.0)
    corners = [[0, 0, 0], [per_metre, 0, 0], [0, per_metre, 0]]
    sheet = Part("sheet", Mesh(corners, [[0, 1, 2]]), [9 * per_metre, 0, 0], grounded=True)
    text = to_compas(Assembly([table, ball, sheet], units=units))
    nodes = json.loads(text)["data"]["graph"]["data"]["node"]
    stated = [node["block"]["data"]["attributes"].get("density") for node in nodes.values()]
    assert stated[0] == pytest.approx(700)
    assert 500 < stated[1] < 520
    assert stated[2] is None
    masses = from_compas(json.loads(text), units=units).geometry.mass[:2]
    assert masses == pytest.approx([700 * 8, 500 * 4 / 3 * math.pi * 0.1**3], rel=1e-9)
