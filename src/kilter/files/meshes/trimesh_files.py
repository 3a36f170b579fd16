"""Read PLY and COLLADA files (.ply, .dae) with trimesh, and pycollada for the latter.

trimesh cuts polygons as fans, which folds a polygon that is not convex: such a file is rejected.
Broken references in COLLADA are rejected, too. PLY states no unit and no names.
"""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.files.file_tolerances import FOLDED, SAME_UNIT
from kilter.files.limits import (
    DEEPEST,
    MOST_PARTS,
    Tally,
    read_bytes,
    require_count,
    require_few_entries,
)
from kilter.files.meshes.placed import (
    FileBodies,
    distinct,
    scale_mesh,
    text_accuracy,
    transform_mesh,
)
from kilter.files.reader_guard import reason_of
from kilter.shape.primitives import Mesh
from kilter.units import METRES

ENDINGS = {".ply": "trimesh", ".dae": "collada"}
"""The package that each ending needs, beside trimesh."""


def read_with_trimesh(path: Path) -> FileBodies:
    """Read the meshes of a PLY or COLLADA file.

    Raises `InputError` if a package is not installed, a polygon is not convex, or the file has too
    many meshes or triangles, or is damaged.
    """
    ending = path.suffix.lower()
    missing = [name for name in ("trimesh", ENDINGS[ending]) if not importlib.util.find_spec(name)]
    if missing:
        raise InputError(
            f"{ending} files need {missing[0]}, which is not installed",
            hint="pip install 'kilter[meshes]', or export GLB, 3MF or OBJ",
        )
    import trimesh

    data = read_bytes(path)
    units, factor = _collada_unit(data) if ending == ".dae" else (None, 1.0)
    more: dict[str, Any] = {"ignore_broken": False} if ending == ".dae" else {}
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=ending[1:], process=False, **more)
    except Exception as error:  # the libraries raise exceptions of every kind for damaged files
        raise InputError(
            f"damaged {ending[1:].upper()}: {reason_of(error)}", hint="export it anew"
        ) from None
    named = [
        (str(node), scene.geometry[name], np.asarray(place, dtype=np.float64))
        for node in scene.graph.nodes_geometry
        for place, name in [scene.graph[node]]
    ]
    rows = [row for row in named if len(getattr(row[1], "faces", ()))]
    tally = Tally()
    for _, mesh, _ in rows:
        tally.add(len(mesh.faces))
    corners = [np.asarray(mesh.vertices).reshape(-1) for _, mesh, _ in rows]
    accuracy = text_accuracy(np.concatenate([*corners, np.empty(0)]))
    shapes = []
    for name, mesh, place in rows:
        vertices, faces = np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces)
        _require_unfolded(vertices, faces, name)
        shape = Mesh(vertices, faces, accuracy=accuracy(vertices))
        shapes.append(scale_mesh(transform_mesh(shape, place), factor))
    names: Sequence[str | None] = distinct([name for name, _, _ in rows])
    if ending != ".dae":
        names = [None] * len(rows)
    ignored = len(named) - len(rows)
    notes = (f"{ignored} objects without triangles are ignored",) if ignored else ()
    return FileBodies(tuple(names), tuple(shapes), units=units, notes=notes)


def _require_unfolded(vertices: Array, faces: Index, name: str) -> None:
    """Raise `InputError` if two triangles at an edge lie on each other."""
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(length > 0, length, 1.0)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], np.repeat(np.arange(len(faces)), 3)[order]
    same = (edges[1:] == edges[:-1]).all(axis=1)
    cosine = np.einsum("ek,ek->e", normal[owner[1:][same]], normal[owner[:-1][same]])
    if (cosine < FOLDED - 1).any():
        raise InputError(
            "a polygon is not convex, or two triangles lie on each other",
            part=name,
            hint="cut its polygons into triangles",
        )


def _collada_unit(data: bytes) -> tuple[str, float]:
    """Length unit of a COLLADA file, and the factor to it.

    Raises `InputError` if the file places too many meshes, or nodes contain themselves.
    """
    require_few_entries(data)
    root = ElementTree.fromstring(data)
    for element in root.iter():
        element.tag = str(element.tag).rpartition("}")[2]
    nodes = {f"#{node.get('id')}": node for node in root.iter("node")}
    known: dict[str, int] = {}

    def count(node: ElementTree.Element, depth: int) -> int:
        """Number of meshes that a node places."""
        if depth > DEEPEST:
            raise InputError(f"nodes are nested deeper than {DEEPEST}", hint="export it anew")
        total = len(list(node.iter("instance_geometry"))) + len(list(node.iter("node")))
        for link in node.iter("instance_node"):
            key = link.get("url", "")
            if key in nodes and key not in known:
                known[key] = count(nodes[key], depth + 1)
            total += known.get(key, 0)
        return total

    placed = sum(count(scene, 0) for scene in root.iter("visual_scene"))
    require_count("placed meshes", placed, MOST_PARTS)
    unit = root.find("asset/unit")
    metres = float("1" if unit is None else unit.get("meter", "1"))
    if not 0 < metres < np.inf:
        raise InputError(f"the length unit is {metres:g} m", hint="export it anew")
    same = [name for name, size in METRES.items() if abs(metres / size - 1) <= SAME_UNIT]
    return (same[0], 1.0) if same else ("m", metres)
