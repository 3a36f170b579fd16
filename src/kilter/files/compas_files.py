"""Read COMPAS assemblies in JSON: a graph whose nodes are blocks, each a mesh of polygons.

A block without a name, or with the name of another block, is named by the key of its node. Blocks
marked as supports are held. A block may state its density. The files have no units. With
``contacts="file"`` the interfaces of the file are the contacts (`kilter.files.interfaces`). A list
of meshes, or a single mesh, is an assembly too: parts without a name are named by their position
in the list. Models and problems of compas_dem are converted by `kilter.files.compas_models`.

References
----------
compas_assembly, `datastructures.Assembly`; its serialisation is ``{"dtype", "data"}``; in files
of 2021 ``{"dtype", "value": {"data", "datatype"}}`` or ``{"data", "datatype"}``, with the nodes
in the assembly itself.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.compas_models import graph_of_model, is_model, split_problem, with_problem
from kilter.files.interfaces import as_dict, contacts_of, inner, interfaces_of, kind
from kilter.files.meshes.placed import natural_key, text_accuracy
from kilter.files.reader_guard import reader_guard
from kilter.shape.primitives import Mesh
from kilter.units import metres_per_unit

_HINT = "export the assembly with compas_assembly again"


def is_compas(data: Any) -> bool:
    """Whether a JSON value is a serialised COMPAS object, or a list of them.

    Examples
    --------
    >>> is_compas({"dtype": "compas_assembly.datastructures/Assembly", "data": {}})
    True
    >>> is_compas([{"dtype": "compas.datastructures/Mesh", "data": {}}])
    True
    >>> is_compas({"kilter": 1}), is_compas({"data": {}}), is_compas([1])
    (False, False, False)
    """
    if isinstance(data, list):
        return bool(data) and all(isinstance(entry, dict) and is_compas(entry) for entry in data)
    return isinstance(data, dict) and str(kind(data)).startswith("compas")


def from_compas(
    data: Any,
    *,
    units: str | None = None,
    source: str = "",
    contacts: str | None = None,
    folder: Path | None = None,
) -> Assembly:
    """Build the assembly of a COMPAS file.

    Arguments: `contacts`: "file": the interfaces of the file are the contacts, and contacts are not
    detected. `folder`: folder in which the model of a problem is looked for. Raises `InputError` if
    the value is not an assembly of blocks, or a block is damaged; the error names it.
    """
    with reader_guard(source):
        data, problem = split_problem(data, folder)
        nodes, graph = _graph(data)
        defaults = as_dict(graph.get("default_node_attributes") or graph.get("node_attributes"))
        keys = sorted(nodes, key=natural_key)
        blocks = {key: _block(key, nodes[key]) for key in keys}
        names = _names(blocks, {key: _name_beside_data(nodes[key]) for key in keys})
        corners = {key: _vertices(names[key], blocks[key]) for key in keys}
        accuracy = text_accuracy(np.concatenate([_rows(corners[key]) for key in keys]))
        for key in keys:
            corners[key] = _in_place(corners[key], nodes[key].get("placement"))
        parts = {
            key: Part(
                names[key],
                _mesh(names[key], blocks[key], corners[key], accuracy),
                grounded=_is_support(nodes[key], defaults, blocks[key]),
                density=as_dict(blocks[key].get("attributes")).get("density"),
            )
            for key in keys
        }
        interfaces = interfaces_of(graph)
        used = contacts_of(interfaces, parts) if contacts == "file" else []
        notes = [_interfaces_note(len(interfaces))] if interfaces and contacts is None else []
        assembly = Assembly(
            list(parts.values()),
            units=units or "m",
            source=source,
            notes=notes,
            contacts=used,
            detect=contacts != "file",
        )
        if problem is None:
            return assembly
        faces = {key: _polygons(blocks[key], corners[key]) for key in keys}
        return with_problem(assembly, {key: (parts[key], faces[key]) for key in keys}, problem)


def _in_place(corners: dict[str, list[float]], placement: Array | None) -> dict[str, list[float]]:
    """Vertices of a block in its pose, shape (4, 4), by vertex key; None leaves them."""
    if placement is None or np.array_equal(placement, np.eye(4)):
        return corners
    with np.errstate(over="ignore", invalid="ignore"):  # the mesh refuses such vertices
        rows = _rows(corners) @ placement[:3, :3].T + placement[:3, 3]
    return dict(zip(corners, rows.tolist(), strict=True))


def _polygons(block: dict[str, Any], corners: dict[str, list[float]]) -> dict[str, Array]:
    """Corners of each face of a block, shape (n, 3), by face key."""
    return {key: np.array([corners[str(c)] for c in face]) for key, face in block["face"].items()}


def _interfaces_note(count: int) -> str:
    """A note that the contact interfaces stored in the file are not used."""
    return (
        f"the file has {count} interfaces, which are not used: contacts are detected from the "
        "geometry; --contacts file uses the interfaces (in Python contacts='file')"
    )


def _graph(data: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """The graph of an assembly: its nodes by key, and the whole graph as a dict."""
    meshes = data if isinstance(data, list) else [data]
    if all("vertex" in as_dict(inner(mesh)) for mesh in meshes):
        return {str(k): {"block": mesh} for k, mesh in enumerate(meshes)}, {}
    if isinstance(data, list):
        raise InputError("the list has COMPAS objects that are not meshes", hint=_HINT)
    content = as_dict(inner(data))
    if is_model(content):
        graph = graph_of_model(content)
        return graph["node"], graph
    graph = as_dict(inner(content["graph"])) if "graph" in content else content
    nodes = graph.get("node")
    if not isinstance(nodes, dict) or not nodes:
        raise InputError(f"the COMPAS {kind(data)!r} has no blocks", hint=_HINT)
    return nodes, graph


def _block(key: str, node: Any) -> dict[str, Any]:
    """The data of the block that a node holds; raises `InputError` if it has no mesh."""
    block = as_dict(inner(node.get("block"))) if isinstance(node, dict) else {}
    if not isinstance(block.get("vertex"), dict) or not isinstance(block.get("face"), dict):
        raise InputError("the node has no block with vertices and faces", part=key, hint=_HINT)
    return block


def _name_beside_data(node: dict[str, Any]) -> Any:
    """Name of a block that COMPAS 2 stores beside the block's data; None without a name."""
    return as_dict(node.get("block")).get("name")


def _names(blocks: dict[str, dict[str, Any]], beside: dict[str, Any]) -> dict[str, str]:
    """Part name for each node: the name of its block if that is unique, else the node's key.

    Arguments: `beside`: `_name_beside_data` of each node key, used if the block has no attribute
    `name`.
    """
    given = {}
    for key, block in blocks.items():
        name = as_dict(block.get("attributes")).get("name") or beside[key]
        given[key] = name.strip() if isinstance(name, str) and name.strip() else key
    count = Counter(given.values())
    return {key: name if count[name] == 1 else key for key, name in given.items()}


def _vertices(name: str, block: dict[str, Any]) -> dict[str, list[float]]:
    """Coordinates of the vertices of a block, by vertex key."""
    start = {"x": 0.0, "y": 0.0, "z": 0.0, **as_dict(block.get("default_vertex_attributes"))}
    corners = {}
    for key, vertex in block["vertex"].items():
        values = {**start, **vertex} if isinstance(vertex, dict) else {}
        xyz = [values.get(axis) for axis in "xyz"]
        try:
            if not all(type(v) in (int, float) for v in xyz):
                raise ValueError
            corners[str(key)] = [float(v) for v in xyz if v is not None]
        except (ValueError, OverflowError):
            what = f"vertex {key!s:.40} is {xyz!r:.80}"
            raise InputError(what, part=name, hint="give three numbers") from None
    return corners


def _rows(corners: dict[str, list[float]]) -> Any:
    """Coordinates of all vertices, shape (n, 3)."""
    return np.array(list(corners.values()), dtype=np.float64).reshape(-1, 3)


def _mesh(name: str, block: dict[str, Any], corners: dict[str, list[float]], accuracy: Any) -> Mesh:
    """Build the mesh of a block; raises `InputError` if a face is invalid."""
    row = {key: k for k, key in enumerate(corners)}
    faces = []
    for key, face in block["face"].items():
        cycle = face if isinstance(face, list) else []
        missing = [corner for corner in cycle if str(corner) not in row]
        if missing or not cycle:
            what = f"names the unknown vertex {missing[0]!r:.40}" if missing else "is not a list"
            raise InputError(f"face {key:.40} {what}", part=name, hint=_HINT)
        faces.append([row[str(corner)] for corner in cycle])
    vertices = _rows(corners)
    try:
        return Mesh(vertices, faces, accuracy=accuracy(vertices))
    except InputError as error:
        raise error.located(part=name) from None


def _is_support(node: dict[str, Any], defaults: dict[str, Any], block: dict[str, Any]) -> bool:
    """Whether the file marks a block as a support: in its node, the node defaults or the block."""
    of_block = as_dict(block.get("attributes")).get("is_support")
    return (node.get("is_support", defaults.get("is_support")) or of_block) is True


# Write an assembly as a COMPAS JSON file: a block of vertices and faces for each part.


def to_compas(assembly: Assembly) -> str:
    """The text of the COMPAS file of an assembly, in its length unit and its current poses.

    Held parts are supports. Curved faces become triangles, and the density of a block is its mass
    over the volume within them [kg/m^3]. Friction, loads, joints, bonds and the
    direction of gravity have no place in such a file.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> from kilter.files.compas_files import from_compas
    >>> cube = Assembly([Part("cube", Box(1, 1, 1), grounded=True)])
    >>> from_compas(json.loads(to_compas(cube))).geometry.mass.tolist()
    [1000.0]
    """
    geometry, cubic_metres = assembly.geometry, metres_per_unit(assembly.units) ** 3
    nodes: dict[str, Any] = {}
    for k, part in enumerate(assembly.parts):
        first, last = geometry.vertex_start[k : k + 2].tolist()
        rows = slice(*geometry.triangle_start[k : k + 2].tolist())
        corners = geometry.vertices[first:last]
        faces = geometry.triangles[rows] - first
        attributes: dict[str, Any] = {"name": part.name}
        a, b, c = np.moveaxis((corners - corners.mean(axis=0))[faces], 1, 0)
        volume = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6 * cubic_metres
        if volume > 0:  # a sheet has no volume
            attributes["density"] = float(geometry.mass[k]) / volume
        block = {
            "attributes": attributes,
            "vertex": {
                str(i): dict(zip("xyz", corner.tolist(), strict=True))
                for i, corner in enumerate(corners)
            },
            "face": {str(i): face for i, face in enumerate(faces.tolist())},
        }
        nodes[str(k)] = {
            "is_support": bool(part.grounded),
            "block": {"dtype": "compas_assembly.datastructures/Block", "data": block},
        }
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    data = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}
    return json.dumps(data, ensure_ascii=False, allow_nan=False)
