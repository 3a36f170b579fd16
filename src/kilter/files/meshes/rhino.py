"""Read Rhino files (.3dm) with rhino3dm: meshes, and the render meshes of Breps and extrusions.

Rhino keeps a mesh beside each exact body for its pictures. A body without such a mesh is left out
with a note. Blocks are read at the places of their instances. The name of a body is that of its
object, else of its layer.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import DEEPEST, MOST_PARTS, Tally, read_bytes, require_count
from kilter.files.meshes.placed import SINGLE, FileBodies, distinct, join_meshes, transform_mesh
from kilter.shape.primitives import Mesh

UNITS = {"Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Inches": "in"}
"""Length unit for each unit of Rhino that kilter has."""


def read_rhino(path: Path) -> FileBodies:
    """Read the meshes of a Rhino file, in its own length unit.

    Raises `InputError` if rhino3dm is not installed, the unit is unknown to kilter, or the file is
    damaged or places too many bodies.
    """
    if importlib.util.find_spec("rhino3dm") is None:
        raise InputError(
            "Rhino files need rhino3dm, which is not installed",
            hint="pip install 'kilter[rhino]', or export STEP",
        )
    import rhino3dm

    read: Any = rhino3dm.File3dm.FromByteArray  # its stub asks for a list of bytes
    model = read(read_bytes(path))
    if model is None:
        raise InputError("damaged 3DM", hint="save it anew in Rhino")
    unit = str(model.Settings.ModelUnitSystem.name)
    if unit not in UNITS and unit not in ("None", "Unset"):
        raise InputError(f"the file is in {unit.lower()}", hint=f"use one of {', '.join(UNITS)}")
    content = _RhinoObjects(model)
    names, shapes = [], []
    for name, mesh, place in content.bodies():
        names.append(name)
        shapes.append(transform_mesh(mesh, place))
    return FileBodies(
        tuple(distinct(names)), tuple(shapes), units=UNITS.get(unit), notes=content.notes()
    )


class _RhinoObjects:
    """The objects of a Rhino file; it also counts the objects that are left out."""

    def __init__(self, model: Any) -> None:
        self.model = model
        self.by_id = {str(one.Attributes.Id): one for one in model.Objects}
        self.blocks = {str(one.Id): one for one in model.InstanceDefinitions}
        self.without_mesh: list[str] = []
        self.others = 0
        self.count, self.tally = 0, Tally()

    def bodies(self) -> Iterator[tuple[str, Mesh, Array]]:
        """Name, mesh and pose, shape (4, 4), of each body at the top and in instances of blocks."""
        for one in self.model.Objects:
            if one.Attributes.Mode.name != "InstanceDefinitionObject":
                yield from self._placed(one, np.eye(4), 0)

    def notes(self) -> tuple[str, ...]:
        """Notes about the objects that are left out."""
        notes = []
        if self.without_mesh:
            names = ", ".join(dict.fromkeys(self.without_mesh[:5]))
            notes.append(
                f"bodies without a render mesh are left out: {len(self.without_mesh)} ({names}); "
                "shade the view in Rhino and save the file without 'Save small', or export STEP"
            )
        if self.others:
            notes.append(f"curves, points and other objects that are left out: {self.others}")
        return tuple(notes)

    def _placed(self, one: Any, place: Array, depth: int) -> Iterator[tuple[str, Mesh, Array]]:
        """The bodies of an object, in an outer pose, shape (4, 4)."""
        self.count += 1
        require_count("objects", self.count, MOST_PARTS)
        kind = type(one.Geometry).__name__
        if kind == "InstanceReference":
            block = self.blocks.get(str(one.Geometry.ParentIdefId))
            if depth > DEEPEST or block is None:
                raise InputError("damaged 3DM: a block contains itself, or is absent",
                                 hint="save it anew in Rhino")  # fmt: skip
            inner = np.array(one.Geometry.Xform.ToFloatArray(True), dtype=np.float64).reshape(4, 4)
            for key in block.GetObjectIds():
                if str(key) in self.by_id:
                    yield from self._placed(self.by_id[str(key)], place @ inner, depth + 1)
            return
        meshes = _meshes_of(one.Geometry, kind)
        if meshes is None:
            self.others += 1
        elif not meshes or None in meshes:
            self.without_mesh.append(self._name(one))
        else:
            for mesh in meshes:
                self.tally.add(len(mesh.Faces))
            parts = [_mesh(mesh) for mesh in meshes]
            yield self._name(one), parts[0] if len(parts) == 1 else join_meshes(parts), place

    def _name(self, one: Any) -> str:
        """Name of an object, else of its layer."""
        layers, index = self.model.Layers, int(one.Attributes.LayerIndex)
        layer = str(layers[index].Name) if 0 <= index < len(layers) else ""
        return str(one.Attributes.Name) or layer or "body"


def _meshes_of(geometry: Any, kind: str) -> list[Any] | None:
    """The meshes of a body; the result is None if the object is no body.

    A face without a render mesh has the entry None.
    """
    import rhino3dm

    if kind == "Mesh":
        return [geometry]
    if kind == "Brep":
        return [face.GetMesh(rhino3dm.MeshType.Any) for face in geometry.Faces]
    if kind == "Extrusion":
        return [geometry.GetMesh(rhino3dm.MeshType.Any)]
    return None


def _mesh(mesh: Any) -> Mesh:
    """Convert a mesh; a triangle is a quadrangle whose last two corners are equal."""
    vertices = np.array([[p.X, p.Y, p.Z] for p in mesh.Vertices], dtype=np.float64).reshape(-1, 3)
    faces = [
        corners if corners[2] != corners[3] else corners[:3]
        for corners in (tuple(mesh.Faces[k]) for k in range(len(mesh.Faces)))
    ]
    accuracy = SINGLE * float(np.abs(vertices).max(initial=0.0))
    return Mesh(vertices, faces, accuracy=accuracy)
