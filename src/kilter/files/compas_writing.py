"""Write an assembly as a COMPAS JSON file: a block of vertices and faces for each part."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.units import metres_per_unit

__all__ = ["to_compas"]


def to_compas(assembly: Assembly) -> str:
    """The text of the COMPAS file of an assembly, in its length unit and its current poses.

    Held parts are supports. Curved faces become triangles, and the density of a block is its mass
    over the volume within them [kg/m^3]. Friction, loads, joints, bonds and the
    direction of gravity have no place in such a file.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> from kilter.files.compas import from_compas
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
