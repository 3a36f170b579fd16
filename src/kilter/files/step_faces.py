"""Triangulate the faces of a solid from a STEP file.

OCCT triangulates them, with common corners along shared edges. A face that its mesher leaves out is
triangulated by `kilter.files.unmeshed`, with the edge corners of its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.files.occt import failures, inside
from kilter.files.step_surfaces import is_plain
from kilter.files.unmeshed import cut_face

__all__ = ["StepFace", "cut_faces", "size_of"]


@dataclass(frozen=True, slots=True, eq=False)
class StepFace:
    """A triangulated face of a STEP solid; triangles are counterclockwise seen from outside."""

    shape: Any
    nodes: Array
    """Shape (n, 3)."""
    parameters: Array
    """Parameters of the nodes if the kind of surface is unknown, shape (n, 2); else shape (0,
    2)."""
    triangles: Index
    """Shape (m, 3)."""
    edges: list[tuple[Any, Index]]
    """Each edge with the nodes along it."""


def size_of(shape: Any) -> float:
    """The diagonal of the bounding box of a shape [length unit]; 0 for an empty shape."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    return 0.0 if box.IsVoid() else float(np.sqrt(box.SquareExtent()))


def cut_faces(shape: Any, deflection: float, turn: float) -> tuple[list[StepFace], int]:
    """Triangulate the faces of a solid; also count the faces for which this fails.

    Arguments: `deflection`: largest distance of a triangle from its face [sizes of the solid];
    `turn`: angular deflection for OCCT [rad]. Returns `lost`: number of faces that could not be
    triangulated.
    """
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    size = size_of(shape)
    if not size > 0:
        raise InputError("the solid has no faces", hint="repair it in the program that made it")
    BRepTools.Clean_s(shape)
    BRepMesh_IncrementalMesh(shape, deflection * size, False, turn, False)
    shapes = [TopoDS.Face(face) for face in inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)]
    faces: list[StepFace | None] = [_occt_mesh(face) for face in shapes]
    left = [k for k, face in enumerate(faces) if face is None]
    if left:
        known = _polygons(shapes)
        for k in left:
            faces[k] = _own_mesh(shapes[k], known, turn)
    kept = [face for face in faces if face is not None]
    return kept, len(faces) - len(kept)


def _own_mesh(face: Any, known: list[tuple[Any, Array]], turn: float) -> StepFace | None:
    """Triangulate a face without OCCT's mesher; None if that fails."""
    from OCP.TopAbs import TopAbs_Orientation

    try:
        cut = cut_face(face, known, turn)
    except failures():
        return None
    if cut is None:
        return None
    triangles = cut.triangles
    if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        triangles = triangles[:, ::-1]
    parameters = np.empty((0, 2)) if is_plain(face) else cut.parameters
    return StepFace(face, cut.nodes, parameters, triangles, cut.edges)


def _polygons(faces: list[Any]) -> list[tuple[Any, Array]]:
    """All edges of triangulated faces, each with the parameters of its corners along the edge."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    place = TopLoc_Location()
    polygons = []
    for face in faces:
        mesh = BRep_Tool.Triangulation_s(face, place)
        if mesh is None:
            continue
        for edge in map(TopoDS.Edge, inside(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, place)
            if polygon is not None and polygon.HasParameters():
                rows = range(1, polygon.NbNodes() + 1)
                polygons.append((edge, np.array([polygon.Parameter(k) for k in rows])))
    return polygons


def _occt_mesh(face: Any) -> StepFace | None:
    """The triangles that OCCT has stored for a face; None if there are none."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None or not mesh.NbTriangles():
        return None
    numbers = range(1, mesh.NbNodes() + 1)
    nodes = np.array([mesh.Node(k).Coord() for k in numbers]).reshape(-1, 3)
    if not place.IsIdentity():
        move = place.Transformation()
        matrix = np.array([[move.Value(i, j) for j in range(1, 5)] for i in range(1, 4)])
        nodes = nodes @ matrix[:, :3].T + matrix[:, 3]
    hidden = mesh.HasUVNodes() and not is_plain(face)
    pairs = [mesh.UVNode(k).Coord() for k in numbers] if hidden else []
    corners = [mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)]
    triangles = np.array(corners, dtype=np.int64).reshape(-1, 3) - 1
    if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        triangles = triangles[:, ::-1]
    edges = []
    for edge in map(TopoDS.Edge, inside(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
        polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, place)
        if polygon is not None:
            rows = [polygon.Node(k) for k in range(1, polygon.NbNodes() + 1)]
            edges.append((edge, np.array(rows, dtype=np.int64) - 1))
    return StepFace(face, nodes, np.array(pairs).reshape(-1, 2), triangles, edges)
