"""Write an assembly as a COMPAS JSON file: a block of vertices and faces for each part."""

from __future__ import annotations

import json
from typing import Any

from kilter.assembly import Assembly

__all__ = ["to_compas"]


def to_compas(assembly: Assembly) -> str:
    """The text of the COMPAS file of an assembly, in its length unit and its current poses.

    Held parts are supports. Curved faces become triangles. Friction, loads, joints, bonds and the
    direction of gravity have no place in such a file.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> from kilter.files.compas import from_compas
    >>> cube = Assembly([Part("cube", Box(1, 1, 1), grounded=True)])
    >>> from_compas(json.loads(to_compas(cube))).geometry.mass.tolist()
    [1000.0]
    """
    geometry = assembly.geometry
    nodes: dict[str, Any] = {}
    for k, part in enumerate(assembly.parts):
        first, last = geometry.vertex_start[k : k + 2].tolist()
        rows = slice(*geometry.triangle_start[k : k + 2].tolist())
        corners = geometry.vertices[first:last].tolist()
        faces = (geometry.triangles[rows] - first).tolist()
        attributes: dict[str, Any] = {"name": part.name}
        attributes["density"] = float(geometry.mass[k] / geometry.volume[k])
        block = {
            "attributes": attributes,
            "vertex": {
                str(i): dict(zip("xyz", corner, strict=True)) for i, corner in enumerate(corners)
            },
            "face": {str(i): face for i, face in enumerate(faces)},
        }
        nodes[str(k)] = {
            "is_support": bool(part.grounded),
            "block": {"dtype": "compas_assembly.datastructures/Block", "data": block},
        }
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    data = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}
    return json.dumps(data, ensure_ascii=False, allow_nan=False)
