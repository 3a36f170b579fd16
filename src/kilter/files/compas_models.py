"""Convert models and problems of compas_dem to the graph that the reader of COMPAS files reads.

    BlockModel  elements {guid: Block}, tree (groups), graph.node {index: {"element": guid}},
                graph.edge {u: {v: {"contacts": [...]}}}, materials, transformation
    Problem     guid of its model, boundary conditions, contact properties

The index of a node is the number by which a problem names a block. The pose of a block is the
product of the transformations of the model, of the groups around the block, and of the block.

References
----------
compas_dem 0.6, `models.BlockModel`, `problem.Problem`; compas_model 0.9, `models.Model`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly import Assembly, Load, Part
from kilter.errors import InputError
from kilter.files.complaints import parse_json
from kilter.files.interfaces import as_dict, inner
from kilter.files.limits import is_file, read_bytes

_HINT = "write the model again with compas.json_dump"
_MOST_BESIDE = 1000
"""Number of files beside a problem in which its model is looked for."""
_UNREAD = {
    "displacements": "prescribed displacements",
    "joint_model": "the joint model (stiffness)",
    "c": "cohesion",
    "t_c": "tensile strength",
}
"""Entries of a problem that are not read, and their names in the note."""


def is_model(content: dict[str, Any]) -> bool:
    """Whether the content of a COMPAS object is a model of compas_model: elements and a graph."""
    return isinstance(content.get("elements"), dict) and "graph" in content


def is_problem(data: Any) -> bool:
    """Whether a JSON value is a serialised problem of compas_dem."""
    content = as_dict(inner(data))
    return "model_id" in content and "boundary_conditions" in content


def split_problem(data: Any, folder: Path | None) -> tuple[Any, dict[str, Any] | None]:
    """The serialised model and the content of the problem in a JSON value; None without a problem.

    A list may have a model and its problem. The model of a problem alone is looked for in the
    folder. Raises `InputError` if no model has the guid that the problem names.
    """
    listed = data if isinstance(data, list) else [data]
    problems = [as_dict(inner(entry)) for entry in listed if is_problem(entry)]
    if not problems:
        return data, None
    if len(problems) > 1:
        raise InputError(f"the file has {len(problems)} problems", hint="write a file for each")
    problem, models = problems[0], [entry for entry in listed if not is_problem(entry)]
    guid = str(problem["model_id"])
    if not models and folder is not None:
        models = list(_models_beside(folder, guid))
    fitting = [model for model in models if str(as_dict(model).get("guid", guid)) == guid]
    if fitting:
        return fitting[0], problem
    what = f"the problem is about the model {guid:.60}"
    if models:
        raise InputError(
            f"{what}, the file has another model", hint="give the model of the problem"
        )
    raise InputError(
        f"{what}, and no .json file beside it has this model",
        hint="write the model with compas.json_dump into the same folder",
    )


def _models_beside(folder: Path, guid: str) -> Iterator[Any]:
    """The JSON values in a folder whose guid is the given one."""
    for path in sorted(folder.glob("*.json"))[:_MOST_BESIDE]:
        data = read_bytes(path) if is_file(path) else b""
        if guid.encode() in data and b'"elements"' in data:
            value = as_dict(parse_json(data))
            if str(value.get("guid")) == guid:
                yield value


def graph_of_model(content: dict[str, Any]) -> dict[str, Any]:
    """The graph of a model with the blocks in its nodes, as in a file of compas_assembly.

    A node has the keys `block`, `is_support`, and `placement`, its pose, shape (4, 4). Raises
    `InputError` if the model has no block, or an element is no block.
    """
    graph = as_dict(inner(content["graph"]))
    elements = {str(key): as_dict(inner(one)) for key, one in content["elements"].items()}
    materials = {str(k): as_dict(inner(v)) for k, v in as_dict(content.get("materials")).items()}
    placements = _placements(content, elements)
    nodes: dict[str, Any] = {}
    for key, node in as_dict(graph.get("node")).items():
        guid = str(as_dict(node).get("element"))
        element = elements.get(guid, {})
        if element.get("geometry") is None and element:
            continue  # a group
        material = materials.get(str(element.get("material")), {})
        block = dict(as_dict(inner(element.get("geometry"))))
        block["attributes"] = {"name": element.get("name"), "density": material.get("density")}
        nodes[str(key)] = {
            "block": block,
            "is_support": element.get("is_support") is True,
            "placement": placements.get(guid, np.eye(4)),
        }
    if not nodes:
        raise InputError("the model has no blocks", hint=_HINT)
    return {"node": nodes, "edge": graph.get("edge")}


def _placements(content: dict[str, Any], elements: dict[str, Any]) -> dict[str, Array]:
    """The pose of each element in the tree of a model, shape (4, 4), by guid."""
    found: dict[str, Array] = {}
    root = as_dict(as_dict(inner(content.get("tree"))).get("root"))
    open_nodes = [(root, _matrix(content.get("transformation")))]
    while open_nodes:
        node, around = open_nodes.pop()
        guid = str(node.get("element"))
        if guid in elements:
            with np.errstate(over="ignore", invalid="ignore"):  # the mesh refuses such vertices
                around = around @ _matrix(elements[guid].get("transformation"))
            found[guid] = around
        open_nodes += [(as_dict(child), around) for child in node.get("children") or ()]
    return found


def _matrix(transformation: Any) -> Array:
    """The matrix of a serialised COMPAS transformation, shape (4, 4); that of None is 1."""
    content = inner(transformation)
    if content is None:
        return np.eye(4)
    matrix = np.array(as_dict(content).get("matrix"), dtype=np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise InputError("a transformation has no matrix of 4 x 4 numbers", hint=_HINT)
    return matrix


def with_problem(
    assembly: Assembly, blocks: dict[str, tuple[Part, dict[str, Array]]], problem: dict[str, Any]
) -> Assembly:
    """The assembly of a model with the loads and the friction of a problem.

    Arguments: `blocks`: part and corners of the faces, in place, of each block by the key by which
    the problem names it. Forces are in N, lengths in the unit of the model; weights are kilter's,
    9.81 m/s^2. Raises `InputError` if the problem names an unknown block or face.
    """
    loads: list[Load] = []
    unread: list[str] = []
    for group in problem.get("boundary_conditions") or ():
        entries = as_dict(inner(group))
        unread += [key for key in ("displacements",) if entries.get(key)]
        for force in entries.get("body_forces") or ():
            loads += _body_force(assembly, as_dict(inner(force)))
        for kind, make in (("point_loads", _point_load), ("surface_loads", _surface_load)):
            for entry in entries.get(kind) or ():
                load = as_dict(inner(entry))
                key = str(load.get("block_index"))
                if key not in blocks:
                    raise InputError(f"the problem loads the unknown block {key:.40}", hint=_HINT)
                loads.append(make(*blocks[key], load))
    properties = as_dict(inner(problem.get("contact_properties")))
    law = as_dict(inner(properties.get("contact_model")))
    unread += [key for key in ("joint_model",) if properties.get(key)]
    unread += [key for key in ("c", "t_c") if law.get(key)]
    names = ", ".join(_UNREAD[key] for key in dict.fromkeys(unread))
    notes = [f"the problem also has {names}, which kilter does not use"] if names else []
    mu = law.get("mu")
    return replace(
        assembly,
        loads=loads,
        friction=assembly.friction if mu is None else mu,
        notes=[*assembly.notes, *notes],
    )


def _body_force(assembly: Assembly, entry: dict[str, Any]) -> list[Load]:
    """The force of an acceleration [m/s^2] on the mass of each free part."""
    acceleration = _vector(entry.get("acceleration"))
    free = [(p, m) for p, m in zip(assembly.parts, assembly.geometry.mass, strict=True)]
    return [Load(part.name, mass * acceleration) for part, mass in free if not part.grounded]


def _point_load(part: Part, faces: dict[str, Array], entry: dict[str, Any]) -> Load:
    """A force [N] at a point, or at the centre of mass with a moment."""
    force = _vector(entry.get("force") or (0, 0, 0))
    if entry.get("point") is not None:
        return Load(part.name, force, point=_vector(entry["point"]))
    return Load(part.name, force, _vector(entry.get("moment") or (0, 0, 0)))


def _surface_load(part: Part, faces: dict[str, Array], entry: dict[str, Any]) -> Load:
    """The force of a load per area [N / length unit^2] at the centroid of a face of a block."""
    key = str(entry.get("face_index"))
    if key not in faces:
        what = f"the problem loads the unknown face {key:.40} of block {part.name!r}"
        raise InputError(what, hint=_HINT)
    corners, after = faces[key], np.roll(faces[key], -1, axis=0)
    middle = corners.mean(axis=0)
    area = np.linalg.norm(cross(corners - middle, after - middle), axis=1) / 2
    if not 0 < area.sum() < np.inf:
        raise InputError(
            f"the loaded face {key:.40} of block {part.name!r} has no area", hint=_HINT
        )
    point = area @ (corners + after + middle) / (3 * area.sum())
    return Load(part.name, _vector(entry.get("load")) * area.sum(), point=point)


def _vector(value: Any) -> Array:
    """Three numbers of a problem; COMPAS writes a vector or a point as an object."""
    found = np.array(inner(value), dtype=np.float64)
    if found.shape != (3,):
        raise InputError(f"a load of the problem is {value!s:.60}, not three numbers", hint=_HINT)
    return found
