"""COMPAS assemblies: names, supports, polygons, faults."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from kilter.errors import InputError
from kilter.files import load
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS


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


def test_blocks_are_parts_in_the_order_of_their_keys(write) -> None:
    data = compas({k: {"block": block(float(k))} for k in ("10", "2", "0")})
    assembly = load(write("a.json", data), units="cm", density=2000)
    assert assembly.names == ("0", "2", "10")
    assert assembly.units == "cm"
    assert assembly.geometry.mass == pytest.approx([2e-3] * 3)
    assert not any(part.grounded for part in assembly.parts)


def test_names_that_blocks_share_give_way_to_keys(write) -> None:
    blocks = {"0": block(name="Block"), "1": block(1, name="Block"), "2": block(2, name="key")}
    assembly = load(write("a.json", compas({k: {"block": b} for k, b in blocks.items()})))
    assert assembly.names == ("0", "1", "key")


@pytest.mark.parametrize("mark", ["node", "block", "default"])
def test_supports_are_held(mark: str, write) -> None:
    own = {"is_support": True} if mark == "block" else {}
    nodes = {"0": {"block": block(**own)}, "1": {"block": block(1), "is_support": False}}
    if mark == "node":
        nodes["0"]["is_support"] = True
    defaults = {"default_node_attributes": {"is_support": mark == "default"}}
    assembly = load(write("a.json", compas(nodes, **defaults)))
    assert [part.grounded for part in assembly.parts] == [True, False]


def test_older_files_say_datatype_and_value(write) -> None:
    graph = {"node": {"0": {"block": block()["data"]}}}
    data = {"datatype": "compas_assembly.datastructures/Assembly", "value": {"graph": graph}}
    assert load(write("a.json", data)).geometry.volume == pytest.approx([1])


def test_interfaces_of_the_file_are_noted(write) -> None:
    edge = {"0": {"1": {"interfaces": [{}, {}]}, "2": {"interface": None}}}
    data = compas({"0": {"block": block()}}, edge=edge)
    assert load(write("a.json", data)).notes == ("2 interfaces of the file are not used",)


def broken(**change: Any) -> dict[str, Any]:
    data = block(name="stone")
    data["data"] |= change
    return compas({"0": {"block": data}})


FAULTS = [
    (compas({}), "without blocks; export the assembly"),
    ({"dtype": "compas.geometry/Point", "data": [0, 0, 0]}, "without blocks"),
    (compas({"7": {}}), "part '7': the node has no block with vertices"),
    (compas({"7": 5}), "part '7': the node has no block"),
    (broken(vertex={"0": {"x": None}}), "part 'stone': vertex 0 is [None, 0.0, 0.0]; give three"),
    (broken(vertex={"0": {"x": True}}), "part 'stone': vertex 0 is [True"),
    (broken(vertex={"0": {"x": float("nan")}}, face={}), "part 'stone': vertex 0 is [nan"),
    (broken(face={"0": [0, 1, 99]}), "part 'stone': face 0 names vertex 99, which is not there"),
    (broken(face={"0": [0, 1]}), "part 'stone': face 0 has 2 corners"),
    (broken(face={"0": 5}), "part 'stone': face 0 is no list"),
]


@pytest.mark.parametrize(("data", "message"), FAULTS, ids=range(len(FAULTS)))
def test_a_fault_names_file_and_block(data: Any, message: str, write) -> None:
    path: Path = write("a.json", data)
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert caught.value.hint
