"""Triangulate a face that the mesher of OCCT leaves out, in its parameter plane.

The corners along an edge are those of the neighbouring face, so that the triangles of both meet.
Along a seam, or if neither face has corners, they follow the turn of the edge. The outline in the
parameter plane, scaled to lengths, is filled by a Delaunay triangulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, angle_between
from kilter.errors import InputError
from kilter.files.cad.step_surfaces import failures, inside, is_plain
from kilter.files.file_tolerances import CUT_AREA, OTHER_SIDE, SEWN

STEPS = 10
"""Number of grid steps inside a free-form face, along each parameter; more give finer triangles."""
LOOKS = 33
"""Number of points of an edge at which its direction is evaluated."""


@dataclass(frozen=True, slots=True, eq=False)
class CutFace:
    """A triangulated face with the surface parameters of its nodes."""

    nodes: Array
    """Shape (n, 3)."""
    parameters: Array
    """Parameters of the nodes on the surface, shape (n, 2)."""
    triangles: Index
    """Triangles, counterclockwise in the parameter plane, shape (m, 3)."""
    edges: list[tuple[Any, Index]]
    """Each edge of the face with the nodes along it."""


def cut_face(face: Any, known: list[tuple[Any, Array]], turn: float) -> CutFace | None:
    """Triangulate a face; None if its outline crosses itself or does not close.

    Arguments: `known`: edges of the neighbouring faces, each with the edge parameters of the
    corners along it; `turn`: largest angle between the edge directions at neighbouring corners
    [rad].
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    loops: list[Index] = []
    edges: list[tuple[Any, Index]] = []
    points: list[Array] = []
    count = 0
    for wire in inside(face, TopAbs_ShapeEnum.TopAbs_WIRE):
        outline = _wire_edges(TopoDS.Wire(wire), face, known, turn)
        if not outline:
            return None
        first, loop = count, []
        for number, (edge, uv, turned) in enumerate(outline):
            rows = np.arange(count, count + len(uv) - 1)
            count += len(uv) - 1
            following = first if number == len(outline) - 1 else count
            along = np.append(rows, following)
            points.append(uv[:-1])
            loop.append(rows)
            edges.append((edge, along[::-1] if turned else along))
        loops.append(np.concatenate(loop))
    if not loops or count < 3:
        return None
    surface = BRepAdaptor_Surface(face)
    parameters = np.vstack(points)
    mesh = _fill_outline(parameters, loops, _stretch(surface, parameters), _grid(surface, turn))
    if mesh is None:
        return None
    parameters, triangles = mesh
    nodes = np.array([surface.Value(u, v).Coord() for u, v in parameters.tolist()])
    return CutFace(nodes.reshape(-1, 3), parameters, triangles, edges)


def _wire_edges(
    wire: Any, face: Any, known: list[tuple[Any, Array]], turn: float
) -> list[tuple[Any, Array, bool]]:
    """Edges of a closed outline in order, each as (edge, points, reversed).

    The points are the corners along the edge in the parameter plane of the face; `reversed` tells
    that the wire runs against the sense of the edge. The list is empty if the edges of the wire
    are not connected.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d
    from OCP.BRepTools import BRepTools_WireExplorer
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum

    edges = []
    explorer = BRepTools_WireExplorer(wire, face)
    while explorer.More():
        edge = explorer.Current()
        curve = BRepAdaptor_Curve2d(edge, face)
        values = next((v for other, v in known if other.IsSame(edge)), None)
        if values is None:
            values = _corner_parameters(edge, curve, turn)
        uv = np.array([curve.Value(t).Coord() for t in values.tolist()]).reshape(-1, 2)
        turned = edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        edges.append((edge, uv[::-1] if turned else uv, turned))
        explorer.Next()
    count = len(list(inside(wire, TopAbs_ShapeEnum.TopAbs_EDGE)))
    return edges if len(edges) == count else []


def _corner_parameters(edge: Any, curve: Any, turn: float) -> Array:
    """Equidistant parameters along an edge, which turns by about `turn` [rad] between them."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    first, last = curve.FirstParameter(), curve.LastParameter()
    if BRep_Tool.Degenerated_s(edge):
        return np.linspace(first, last, max(2, int(np.ceil(2 * np.pi / turn)) + 1))
    space = BRepAdaptor_Curve(edge)
    samples = np.linspace(first, last, LOOKS).tolist()
    places = np.array([space.Value(t).Coord() for t in samples])
    step = np.diff(places, axis=0)
    step = step[step.any(axis=1)]
    angle = float(angle_between(step[1:], step[:-1]).sum())
    return np.linspace(first, last, int(np.ceil(angle / turn)) + 2)


def _stretch(surface: Any, parameters: Array) -> Array:
    """Length on the surface for a unit of each parameter, at the middle of a face, shape (2,)."""
    from OCP.gp import gp_Pnt, gp_Vec

    u, v = (parameters.min(axis=0) + parameters.max(axis=0)) / 2
    along_u, along_v = gp_Vec(), gp_Vec()
    surface.D1(u, v, gp_Pnt(), along_u, along_v)
    length = np.array([along_u.Magnitude(), along_v.Magnitude()])
    return np.where(length > 0, length, 1.0)


def _grid(surface: Any, turn: float) -> Array:
    """Steps of both surface parameters for inner points, shape (2,); infinite if straight."""
    kind = str(surface.GetType().name).removeprefix("GeomAbs_")
    if kind == "Plane":
        return np.array([np.inf, np.inf])
    if kind in ("Cylinder", "Cone"):
        return np.array([turn, np.inf])
    if kind in ("Sphere", "Torus"):
        return np.array([turn, turn])
    spans = (
        surface.LastUParameter() - surface.FirstUParameter(),
        surface.LastVParameter() - surface.FirstVParameter(),
    )
    return np.array(spans) / STEPS


def _fill_outline(
    parameters: Array, loops: list[Index], stretch: Array, step: Array
) -> tuple[Array, Index] | None:
    """Triangulate the inside of an outline in the parameter plane; None if it is invalid.

    Arguments: `parameters` (n, 2): corners of the outline; `stretch` (2,): lengths per unit of the
    parameters; `step` (2,): parameter steps of the inner points; infinite for none. Returns
    `parameters` (m, 2): corners, followed by inner points; `triangles` (k, 3): triangles,
    counterclockwise.
    """
    import shapely

    flat = parameters * stretch
    if not np.isfinite(flat).all():
        return None
    rings = sorted(loops, key=lambda loop: -shapely.Polygon(flat[loop]).area)
    outline = shapely.Polygon(flat[rings[0]], [flat[ring] for ring in rings[1:]])
    if not outline.is_valid or not outline.area > 0:
        return None
    inner = _points_inside(outline, step * stretch)
    if len(inner):
        points = np.vstack([flat, inner])
        triangles = _delaunay(points, outline, loops)
        if triangles is not None:
            return points / stretch, triangles
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    row_of = {tuple(p): k for k, p in enumerate(flat.tolist())}
    named = [[row_of.get(tuple(p), -1) for p in piece] for piece in corners.tolist()]
    cut = np.array(named, dtype=np.int64).reshape(-1, 3)
    return None if (cut < 0).any() or not len(cut) else (parameters, _counterclockwise(flat, cut))


def _points_inside(outline: Any, step: Array) -> Array:
    """Grid points inside an outline, away from its boundary by half a step, shape (n, 2)."""
    import shapely

    if not np.isfinite(step).all():
        return np.empty((0, 2))
    x0, y0, x1, y1 = outline.bounds
    x, y = np.meshgrid(
        np.arange(x0 + step[0], x1, step[0]), np.arange(y0 + step[1], y1, step[1]), indexing="ij"
    )
    grid = np.column_stack([x.ravel(), y.ravel()])
    if not len(grid):
        return grid
    spots = shapely.points(grid)
    away = shapely.distance(outline.boundary, spots) > step.min() / 2
    inner: Array = grid[shapely.contains(outline, spots) & away]
    return inner


def _delaunay(points: Array, outline: Any, loops: list[Index]) -> Index | None:
    """Delaunay triangles inside an outline; None if they do not fill it."""
    import shapely
    from scipy.spatial import Delaunay

    cut = np.asarray(Delaunay(points).simplices, dtype=np.int64)
    middle = shapely.points(points[cut].mean(axis=1))
    cut = _counterclockwise(points, cut[shapely.contains(outline, middle)])
    p, q, r = (points[cut[:, k]] for k in range(3))
    area = ((q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]).sum() / 2
    sides = {frozenset(side) for t in cut.tolist() for side in zip(t, t[1:] + t[:1], strict=True)}
    rims = [
        frozenset((int(a), int(b))) for n in loops for a, b in zip(n, np.roll(n, -1), strict=True)
    ]
    whole = abs(area - outline.area) <= CUT_AREA * outline.area
    return cut if whole and all(side in sides for side in rims) else None


def _counterclockwise(points: Array, triangles: Index) -> Index:
    """The plane triangles with every clockwise triangle reversed."""
    p, q, r = (points[triangles[:, k]] for k in range(3))
    right = (q - p)[:, 0] * (r - p)[:, 1] < (q - p)[:, 1] * (r - p)[:, 0]
    turned = triangles.copy()
    turned[right] = turned[right][:, ::-1]
    return turned


# Triangulate the faces of a solid from a STEP file.


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


# Repairs of a damaged shape; the checks of the reader decide whether a repair is right.


def sewn_shape(shape: Any) -> Any:
    """The shape with its faces sewn to a single shell by OCCT; None if that fails."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.ShapeFix import ShapeFix_Shape, ShapeFix_Solid
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    fixed = ShapeFix_Shape(shape)
    fixed.Perform()
    sewing = BRepBuilderAPI_Sewing(SEWN * size_of(shape))
    sewing.Add(fixed.Shape())
    sewing.Perform()
    shells = list(inside(sewing.SewedShape(), TopAbs_ShapeEnum.TopAbs_SHELL))
    if len(shells) != 1:
        return None
    return ShapeFix_Solid().SolidFromShell(TopoDS.Shell(shells[0]))


def with_other_sides(shape: Any) -> Any:
    """The shape with too large spherical faces replaced by their complements; None without any.

    A face is too large if it has more than half of its sphere.

    Whether the result is right is decided by the checks of the reader.
    """
    from OCP.BRepTools import BRepTools_ReShape
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    change, count = BRepTools_ReShape(), 0
    for face in map(TopoDS.Face, inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)):
        other = _other_side(face)
        if other is not None:
            change.Replace(face, other)
            count += 1
    return change.Apply(shape) if count else None


def _other_side(face: Any) -> Any:
    """The complement on the sphere of a face with more than half of it; None for other faces."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_SphericalSurface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.ShapeFix import ShapeFix_Face
    from OCP.TopoDS import TopoDS

    adaptor = BRepAdaptor_Surface(face)
    if adaptor.GetType() != GeomAbs_SurfaceType.GeomAbs_Sphere:
        return None
    sphere = adaptor.Sphere()
    whole, area = 4.0 * np.pi * sphere.Radius() ** 2, _area(face)
    outline = _outline(face)
    if outline is None or area < whole / 2.0:
        return None
    surface = Geom_SphericalSurface(sphere.Position(), sphere.Radius())
    # OCCT draws the edges in the parameters of the new surface at the first call, and keeps them
    for wire in (outline, TopoDS.Wire(outline.Reversed())):
        made = BRepBuilderAPI_MakeFace(surface, wire, False)
        if not made.IsDone():
            return None
        fix = ShapeFix_Face(made.Face())
        fix.Perform()
        other = fix.Face()
        if abs(_area(other) - (whole - area)) <= OTHER_SIDE * whole:
            return other.Oriented(face.Orientation()).Reversed()
    return None


def _outline(face: Any) -> Any:
    """The outer boundary of a face as a wire without seams; None if it is not a single wire."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeWire
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    wires = list(inside(face, TopAbs_ShapeEnum.TopAbs_WIRE))
    edges = map(TopoDS.Edge, inside(face, TopAbs_ShapeEnum.TopAbs_EDGE))
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        if not (BRep_Tool.Degenerated_s(edge) or BRep_Tool.IsClosed_s(edge, face)):
            wire.Add(edge)
    return wire.Wire() if len(wires) == 1 and wire.IsDone() else None


def _area(shape: Any) -> float:
    """Area of the faces of a shape [length unit^2]."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, properties, OTHER_SIDE**2)
    return abs(float(properties.Mass()))
