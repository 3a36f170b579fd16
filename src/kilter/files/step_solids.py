"""A solid of a STEP file as a `Solid`: triangles on its faces, exact surfaces, exact moments.

Faces are cut into triangles one by one along shared edges, and the corners on an edge are made
one by the edge, not by their coordinates, so that the surface is closed. Volume, centre and
second moment are integrals over the faces as the file has them, to a relative error of 1e-10.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, connected
from kilter.assembly.geometry import polyhedron_moments
from kilter.errors import InputError
from kilter.files.checked_solid import checked
from kilter.files.file_tolerances import DEFLECTION, INTEGRAL, SAME_FACE, TURN
from kilter.files.step_surfaces import face_surface, is_plain, points_of_face
from kilter.shape.solid import Solid, Surface, facing, height

__all__ = ["read_solid"]


GRID: Array = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
"""Where on a triangle its distance from its face is measured."""


def read_solid(shape: Any) -> Solid:
    """The solid that a TopoDS_Solid is, in its own frame.

    Raises
    ------
    InputError
        If its faces do not close, or cannot be cut into triangles.
    """
    faces = list(_meshed(shape))
    vertices, triangles, owner = _welded(faces)
    if not len(triangles):
        raise InputError("the solid has no faces", hint="heal it where it was made")
    start = np.array([0, len(triangles)])
    volume, center, _, _ = polyhedron_moments(vertices, triangles, start)
    if volume[0] < 0:
        triangles = triangles[:, ::-1]
    surfaces, lies_on, sagitta, off = _surfaces(faces, vertices, triangles, owner)
    solid = Solid(
        vertices,
        triangles,
        tuple(surfaces),
        lies_on,
        *_exact_moments(shape, center[0]),
        sagitta=sagitta,
        accuracy=max(off, float(np.abs(vertices).max()) * 2.0**-52),
    )
    return checked(solid)


def _exact_moments(shape: Any, about: Array) -> tuple[float, Array, Array]:
    """Volume, centroid and second moment about it, by adaptive integrals over the faces."""
    from OCP.BRepGProp import BRepGProp
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps

    found = GProp_GProps(gp_Pnt(*about.tolist()))
    BRepGProp.VolumeProperties_s(shape, found, INTEGRAL)
    sign = 1.0 if found.Mass() >= 0 else -1.0
    center, moments = found.CentreOfMass(), found.MatrixOfInertia()
    inertia = np.array([[moments.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    second = sign * (np.trace(inertia) / 2 * np.eye(3) - inertia)
    return sign * found.Mass(), np.array([center.X(), center.Y(), center.Z()]), second


# triangles ------------------------------------------------------------------------------


@dataclass(slots=True, eq=False)
class _Face:
    """A face cut into triangles; `edges` are (edge, corners along it).

    `parameters` of the corners are there where the kind of surface must be found out.
    """

    shape: Any
    nodes: Array
    parameters: Array
    triangles: Index
    edges: list[tuple[Any, Index]]


def _meshed(shape: Any) -> Iterator[_Face]:
    """The faces of a solid, cut into triangles that turn left seen from outside."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    size = float(np.sqrt(box.SquareExtent()))
    BRepMesh_IncrementalMesh(shape, DEFLECTION * size, False, TURN, False)
    for face in _inside(shape, TopAbs_ShapeEnum.TopAbs_FACE):
        yield _face(TopoDS.Face(face))


def _inside(shape: Any, kind: Any) -> Iterator[Any]:
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _face(face: Any) -> _Face:
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None:
        raise InputError("a face cannot be cut into triangles", hint="heal it where it was made")
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
    for edge in map(TopoDS.Edge, _inside(face, TopAbs_ShapeEnum.TopAbs_EDGE)):
        polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, place)
        if polygon is not None:
            rows = [polygon.Node(k) for k in range(1, polygon.NbNodes() + 1)]
            edges.append((edge, np.array(rows, dtype=np.int64) - 1))
    return _Face(face, nodes, np.array(pairs).reshape(-1, 2), triangles, edges)


def _welded(faces: list[_Face]) -> tuple[Array, Index, Index]:
    """Vertices, triangles and the face of each, corners on shared edges made one.

    Every corner of a face is a node of a graph, and so are the corners along each edge of the
    solid and its vertices; what is connected is one vertex.
    """
    starts = np.cumsum([0, *(len(face.nodes) for face in faces)])
    pairs, count = _shared(faces, starts)
    label = connected(count, *pairs.T)
    nodes = np.concatenate([face.nodes for face in faces])
    rows = np.concatenate([f.triangles + n for f, n in zip(faces, starts[:-1], strict=True)])
    owner = np.repeat(np.arange(len(faces)), [len(face.triangles) for face in faces])
    _, first, place = np.unique(label[: len(nodes)], return_index=True, return_inverse=True)
    triangles = place[rows].astype(np.int64)
    proper = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    used, compact = np.unique(triangles[proper], return_inverse=True)
    return nodes[first][used], compact.reshape(-1, 3).astype(np.int64), owner[proper]


def _shared(faces: list[_Face], starts: Index) -> tuple[Index, int]:
    """Pairs of nodes of the graph that are one corner, and how many nodes there are."""
    from OCP.BRep import BRep_Tool
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
    from OCP.TopExp import TopExp

    known: ShapeMap = ShapeMap()
    node_of: dict[int, int] = {}
    count = int(starts[-1])
    pairs: list[Index] = []
    for face, start in zip(faces, starts.tolist(), strict=False):
        for edge, corners in face.edges:
            ends = [known.Add(TopExp.FirstVertex_s(edge)), known.Add(TopExp.LastVertex_s(edge))]
            for end in ends:
                if end not in node_of:
                    node_of[end], count = count, count + 1
            here = corners + start
            if BRep_Tool.Degenerated_s(edge):
                along = np.full(len(here), node_of[ends[0]])
            else:
                key = known.Add(edge)
                if key not in node_of:
                    node_of[key], count = count, count + len(here)
                along = np.arange(len(here)) + node_of[key]
                along[[0, -1]] = node_of[ends[0]], node_of[ends[1]]
            pairs.append(np.column_stack([here, along]))
    return np.concatenate(pairs) if pairs else np.empty((0, 2), dtype=np.int64), count


# surfaces -------------------------------------------------------------------------------


def _surfaces(
    faces: list[_Face], vertices: Array, triangles: Index, owner: Index
) -> tuple[list[Surface], Index, float, float]:
    """Surfaces, that of each triangle, the sagitta, and how far corners are off surfaces."""
    found: list[Surface] = []
    of_face = np.full(len(faces), -1)
    sagitta, off = 0.0, 0.0
    for k, face in enumerate(faces):
        own = triangles[owner == k]
        if not len(own):
            continue
        surface, gap = _one_surface(face, vertices[own])
        sagitta = max(sagitta, gap)
        if surface is not None:
            of_face[k] = len(found)
            found.append(facing(surface, vertices, own))
            off = max(off, float(np.abs(height(surface, vertices[own].reshape(-1, 3))).max()))
    size = float(np.ptp(vertices, axis=0).max())
    return *_merged(found, of_face[owner], triangles, size), sagitta, off


def _one_surface(face: _Face, corners: Array) -> tuple[Surface | None, float]:
    """The surface of a face, and the greatest distance of its triangles from it."""
    amid = np.empty((0, 3))
    if len(face.parameters):
        amid = points_of_face(face.shape, face.parameters[face.triangles].mean(axis=1))
    surface = face_surface(face.shape, face.nodes, amid)
    if surface is not None:
        grid = np.einsum("gk,tkx->tgx", GRID, corners).reshape(-1, 3)
        return surface, float(np.abs(height(surface, grid)).max())
    if not len(amid):
        return None, 0.0
    return None, float(np.linalg.norm(face.nodes[face.triangles].mean(axis=1) - amid, axis=1).max())


def _merged(
    surfaces: list[Surface], lies_on: Index, triangles: Index, size: float
) -> tuple[list[Surface], Index]:
    """Surfaces of faces that meet made one where they are the same (halves of a cylinder)."""
    pairs = _neighbours(lies_on, triangles)
    parent = list(range(len(surfaces)))

    def root(k: int) -> int:
        while parent[k] != k:
            k = parent[k]
        return k

    for a, b in pairs.tolist():
        if root(a) != root(b) and _same(surfaces[a], surfaces[b], SAME_FACE * size):
            parent[max(root(a), root(b))] = min(root(a), root(b))
    roots = np.array([root(k) for k in range(len(surfaces))], dtype=np.int64)
    kept, place = np.unique(roots, return_inverse=True)
    merged = np.where(lies_on >= 0, place[lies_on], -1) if len(surfaces) else lies_on
    return [surfaces[k] for k in kept.tolist()], merged


def _neighbours(lies_on: Index, triangles: Index) -> Index:
    """Pairs of surfaces with an edge in common, shape (n, 2)."""
    ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    on = np.repeat(lies_on, 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, on = ends[order], on[order]
    meet = (ends[1:] == ends[:-1]).all(axis=1) & (on[1:] != on[:-1])
    meet &= (on[1:] >= 0) & (on[:-1] >= 0)
    return np.unique(np.sort(np.column_stack([on[1:], on[:-1]])[meet], axis=1), axis=0)


def _same(a: Surface, b: Surface, within: float) -> bool:
    if a.kind != b.kind or a.hollow != b.hollow:
        return False
    numbers = max(abs(a.radius - b.radius), abs(a.tube - b.tube))
    if numbers > within or abs(a.half_angle - b.half_angle) > SAME_FACE:
        return False
    step = b.point - a.point
    if a.kind in ("plane", "cylinder"):
        step = step @ a.axis * a.axis if a.kind == "plane" else np.cross(step, a.axis)
    turned = 0.0 if a.kind == "sphere" else float(np.linalg.norm(np.cross(a.axis, b.axis)))
    return float(np.linalg.norm(step)) <= within and turned <= SAME_FACE
