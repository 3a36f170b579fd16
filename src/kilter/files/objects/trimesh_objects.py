"""Convert trimesh meshes, scenes and primitives to assemblies, and an assembly to a scene.

The nodes of a scene are the parts, with their names. A box, cylinder or sphere of
`trimesh.primitives` keeps its exact faces. trimesh stores float64 always: if every coordinate is
a float32 number, the mesh has the accuracy of float32.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.formats import agreed_units, assembly_of
from kilter.files.meshes.placed import FileBodies, distinct, fill_names, transform_mesh
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, surface

_UNITS = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("cm", "centimeter", "centimeters", "centimetre"), "cm"),
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre"), "mm"),
    **dict.fromkeys(("in", "inch", "inches"), "in"),
}
_ACCEPTED = "give a trimesh.Trimesh or a trimesh.Scene of meshes"


def read(value: Any, choices: FormatOptions) -> Assembly:
    """Convert a trimesh Trimesh or Scene to a kilter assembly.

    Raises
    ------
    InputError
        If the object is neither, has no mesh, or states other units than `choices.units`.
    """
    if hasattr(value, "geometry") and hasattr(value, "graph"):
        rows = [
            (str(node), value.geometry[name], np.asarray(place, dtype=np.float64))
            for node in value.graph.nodes_geometry
            for place, name in [value.graph[node]]
        ]
    elif hasattr(value, "vertices") and hasattr(value, "faces"):
        rows = [(_name(value), value, np.eye(4))]
    else:
        raise InputError(f"a trimesh {type(value).__name__} is not a mesh", hint=_ACCEPTED)
    solid = [row for row in rows if len(getattr(row[1], "faces", ()))]
    if not solid:
        raise InputError(f"the trimesh {type(value).__name__} has no faces", hint=_ACCEPTED)
    stated = _UNITS.get(str(value.units or "").lower())
    ignored = len(rows) - len(solid)
    notes = [f"{ignored} objects without faces are ignored"] if ignored else []
    shapes = [_shape(mesh, place) for _, mesh, place in solid]
    if len(shapes) == 1 and isinstance(shapes[0][0], Mesh):
        bodies = FileBodies((solid[0][0] or None,), (shapes[0][0],), units=stated)
        return assembly_of(bodies, units=choices.units)
    names = fill_names(distinct([name for name, _, _ in solid]), "part")
    parts = [Part(name, shape, pose) for name, (shape, pose) in zip(names, shapes, strict=True)]
    return Assembly(parts, units=agreed_units(stated, choices.units), notes=notes)


def _name(mesh: Any) -> str:
    """The name that a mesh has in its metadata."""
    return str(mesh.metadata.get("name") or "")


def _shape(mesh: Any, place: Array) -> tuple[Shape, Pose]:
    """Shape of a mesh that is placed by a 4 x 4 matrix, and the pose of its part."""
    exact = _primitive(mesh)
    if exact is not None:
        try:
            return exact, Pose.of(place @ np.asarray(mesh.primitive.transform))
        except InputError:  # a scaled or mirrored primitive is read as a mesh
            pass
    corners = np.asarray(mesh.vertices, dtype=np.float64)
    with np.errstate(over="ignore"):
        single = corners.astype(np.float32)
    shape = Mesh(single if np.array_equal(single, corners) else corners, np.asarray(mesh.faces))
    return transform_mesh(shape, place), Pose()


def _primitive(mesh: Any) -> Shape | None:
    """The exact box, cylinder or sphere of a `trimesh.primitives` object; else None."""
    kinds = [kind.__name__ for kind in type(mesh).__mro__ if "primitives" in kind.__module__]
    primitive: Any = getattr(mesh, "primitive", None)
    if "Box" in kinds:
        return Box(primitive.extents)
    if "Cylinder" in kinds:
        return Cylinder(float(primitive.radius), float(primitive.height))
    if "Sphere" in kinds:
        return Sphere(float(primitive.radius))
    return None


def scene_of(assembly: Assembly) -> Any:
    """Convert an assembly to a `trimesh.Scene` with a node for each part, in its length unit.

    Raises
    ------
    InputError
        If trimesh is not installed.
    """
    try:
        import trimesh
    except ImportError:
        raise InputError("trimesh is not installed", hint="pip install 'kilter[trimesh]'") from None
    scene = trimesh.Scene()
    for part in assembly.parts:
        vertices, triangles = surface(part.shape)
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = part.pose.matrix, part.pose.position
        mesh = trimesh.Trimesh(vertices, triangles, process=False)
        mesh.metadata["name"] = part.name
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name, transform=place)
    scene.units = assembly.units
    return scene
