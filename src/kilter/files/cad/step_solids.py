"""Read a solid of a STEP file as a `Solid`: triangles, exact surfaces, exact moments.

Each face is triangulated separately along shared edges. Corners are merged by the edge that they
are on, not by their coordinates, so that the surface is closed. Volume, centre and second moment
are integrals over the exact faces, with a relative error of 1e-10.

The following attempts are made until the triangles close and enclose the volume of the faces:

1. the solid as in the file
2. with coarser triangles, since OCCT fails on short edges with fine triangles
3. with the other side of the outline of large spherical faces
4. repaired by OCCT, with fine and then with coarse triangles

If all fail, the result is a solid with holes. Without usable faces, their convex hull or the
bounding box of the solid is a stand-in. A note reports the uncertainty, and `kilter.contact` counts
the contacts concerned as undecided.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from kilter.arrays import Array, Index, connected
from kilter.assembly.mesh_surface import close_holes, closed_moments, polyhedron_moments
from kilter.errors import InputError
from kilter.files.cad.checked_solid import checked_solid
from kilter.files.cad.step_faces import StepFace, cut_faces, sewn_shape, with_other_sides
from kilter.files.cad.step_surfaces import face_surface, failures, inside, points_of_face, shape_map
from kilter.files.file_tolerances import (
    COARSE,
    COARSE_TURN,
    DEFLECTION,
    HOLLOW,
    INTEGRAL,
    SAME_FACE,
    TURN,
    VOLUME,
)
from kilter.shape.closed import open_edges
from kilter.shape.primitives import hull_surface
from kilter.shape.solid import Solid, Surface, facing, height, same_surface

GRID: Array = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
"""Barycentric coordinates at which the distance of a triangle from its face is measured."""


class ReadSolid(NamedTuple):
    """A solid as read, or None without a volume, and a note on how it differs from the file."""

    solid: Solid | None
    note: str = ""


def read_solid(shape: Any) -> ReadSolid:
    """Read a TopoDS_Solid in its own frame; a damaged solid is repaired as far as possible."""
    best: Solid | None = None
    for how, attempt, fineness in _attempts(shape):
        try:
            faces, lost = cut_faces(attempt, *fineness)
            solid, inwards = _solid(attempt, faces, lost)
            if not len(solid.holes):
                return ReadSolid(checked_solid(solid), how or (_INWARDS if inwards else ""))
        except failures(InputError):
            continue
        if best is None or len(solid.holes) < len(best.holes):
            best = solid
    if best is not None:
        return ReadSolid(best, _HOLES)
    return stand_in(shape)


_INWARDS = (
    "its faces pointed inwards and were reversed; OCCT may have taken the wrong side of a round "
    "face: verify its volume"
)
_REPAIRED = "repaired by OCCT, its faces did not close"
_OTHER_SIDE = (
    "a spherical face had the wrong side of its outline and lay on another face; the other side is "
    "used: verify its volume"
)
_HOLES = (
    "its faces do not close: its volume is that of the existing faces with the holes filled, and "
    "its contacts at the holes are unknown"
)


def _attempts(shape: Any) -> Iterator[tuple[str, Any, tuple[float, float]]]:
    """Yield ways to read a solid: a note, the shape, and the fineness of its triangles."""
    yield "", shape, (DEFLECTION, TURN)
    yield "", shape, (COARSE, COARSE_TURN)
    for note, repair in ((_OTHER_SIDE, with_other_sides), (_REPAIRED, sewn_shape)):
        try:
            repaired = repair(shape)
        except failures():
            continue
        if repaired is not None:
            yield note, repaired, (DEFLECTION, TURN)
            yield note, repaired, (COARSE, COARSE_TURN)


def _solid(shape: Any, faces: list[StepFace], lost: int) -> tuple[Solid, bool]:
    """Build a solid from triangulated faces; also return whether its faces pointed inwards.

    Returns `solid`: with holes if the faces do not close; `inwards`: whether the faces pointed
    inwards; they are reversed.
    """
    vertices, triangles, owner = _weld_faces(faces)
    if not len(triangles):
        raise InputError("the solid has no faces", hint="repair it in the program that made it")
    whole = close_holes(vertices, triangles, open_edges(vertices, triangles))
    moments = closed_moments(whole)
    inwards = moments[0] < 0
    if inwards:
        triangles = triangles[:, ::-1]
        moments = -moments[0], moments[1], -moments[2]
    surfaces, lies_on, sagitta, off = _surfaces(faces, vertices, triangles, owner)
    if whole.holes:
        moments = _plausible_moments(vertices, moments)
    elif not lost:
        moments = _exact_moments(shape, moments[1])
    solid = Solid(
        vertices,
        triangles,
        tuple(surfaces),
        lies_on,
        *moments,
        sagitta=sagitta,
        accuracy=max(off, float(np.abs(vertices).max()) * 2.0**-52),
        holes=np.array(whole.holes),
    )
    return solid, inwards


_Moments = tuple[float, Array, Array]
"""Volume, centroid and second moment about the centroid."""


def _plausible_moments(vertices: Array, moments: _Moments) -> _Moments:
    """Volume, centroid and second moment of a surface with filled holes, or of its hull.

    The hull is used if no body can have the moments of the surface.
    """
    hull = _hull(vertices)
    volume, _, second = moments
    spread = np.linalg.eigvalsh(second)
    inside = volume <= hull.volume * (1 + VOLUME)
    if inside and volume > HOLLOW * hull.volume and spread[0] > 0:
        return moments
    return hull.volume, hull.centroid, hull.second_moment


def _hull(points: Array) -> Solid:
    """The convex hull of points, which replaces a solid that cannot be read.

    Raises `InputError` if the points lie in a plane.
    """
    vertices, triangles = hull_surface(points)
    volume, center, second, _ = polyhedron_moments(
        vertices, triangles, np.array([0, len(triangles)])
    )
    no_surface = np.full(len(triangles), -1)
    return Solid(
        vertices, triangles, (), no_surface, volume[0], center[0], second[0], stand_in=True
    )


def stand_in(shape: Any) -> ReadSolid:
    """The convex hull or the bounding box of a solid that cannot be read, as its replacement."""
    try:
        return ReadSolid(_hull(_corners(shape)), _STANDS_IN)
    except failures(InputError):
        return ReadSolid(None)


_STANDS_IN = (
    "its faces cannot be used: mass and centre are those of their convex hull, and its contacts "
    "are unknown"
)


def _corners(shape: Any) -> Array:
    """Vertices of a shape and of its triangles; those of its bounding box if there are too few."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    vertices = map(TopoDS.Vertex, inside(shape, TopAbs_ShapeEnum.TopAbs_VERTEX))
    sets = [np.array([BRep_Tool.Pnt_s(vertex).Coord() for vertex in vertices]).reshape(-1, 3)]
    sets += [face.nodes for face in cut_faces(shape, DEFLECTION, TURN)[0]]
    points = np.vstack(sets)
    if len(points) > 3:
        return points
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    ends = np.array([box.CornerMin().Coord(), box.CornerMax().Coord()])
    return np.array(np.meshgrid(*ends.T)).reshape(3, -1).T


def _exact_moments(shape: Any, about: Array) -> tuple[float, Array, Array]:
    """Volume, centroid and second moment about the centroid of a shape with exact faces.

    They are integrated adaptively over the faces.

    `about`: a point near the centroid; it reduces cancellation.
    """
    from OCP.BRepGProp import BRepGProp
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps(gp_Pnt(*about.tolist()))
    BRepGProp.VolumeProperties_s(shape, properties, INTEGRAL)
    sign = 1.0 if properties.Mass() >= 0 else -1.0
    center, moments = properties.CentreOfMass(), properties.MatrixOfInertia()
    inertia = np.array([[moments.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    second = sign * (np.trace(inertia) / 2 * np.eye(3) - inertia)
    return sign * properties.Mass(), np.array([center.X(), center.Y(), center.Z()]), second


def _weld_faces(faces: list[StepFace]) -> tuple[Array, Index, Index]:
    """Merge the triangles of adjacent faces at their common edges.

    The nodes of a graph are all corners of faces, the corners along each edge of the solid, and
    its vertices. Connected nodes become one vertex.
    """
    starts = np.cumsum([0, *(len(face.nodes) for face in faces)])
    pairs, count = _corner_graph(faces, starts)
    label = connected(count, *pairs.T)
    nodes = np.concatenate([face.nodes for face in faces])
    rows = np.concatenate([f.triangles + n for f, n in zip(faces, starts[:-1], strict=True)])
    owner = np.repeat(np.arange(len(faces)), [len(face.triangles) for face in faces])
    _, first, place = np.unique(label[: len(nodes)], return_index=True, return_inverse=True)
    triangles = place[rows].astype(np.int64)
    proper = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    used, compact = np.unique(triangles[proper], return_inverse=True)
    return nodes[first][used], compact.reshape(-1, 3).astype(np.int64), owner[proper]


def _corner_graph(faces: list[StepFace], starts: Index) -> tuple[Index, int]:
    """Edges, shape (m, 2), and number of nodes of the graph that joins corners on common edges.

    `starts`: the first node of each face, then the number of nodes of all faces.
    """
    from OCP.BRep import BRep_Tool
    from OCP.TopExp import TopExp

    known = shape_map()
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
    faces: list[StepFace], vertices: Array, triangles: Index, owner: Index
) -> tuple[list[Surface], Index, float, float]:
    """The exact surfaces of a solid, and the surface on which each triangle lies.

    Returns `lies_on` (m,): surface of each triangle, or -1; `sagitta`: largest distance of a
    triangle from its face [length unit]; `off`: largest distance of a corner from its surface
    [length unit].
    """
    surfaces: list[Surface] = []
    of_face = np.full(len(faces), -1)
    sagitta, off = 0.0, 0.0
    for k, face in enumerate(faces):
        rows = triangles[owner == k]
        if not len(rows):
            continue
        surface, gap = _surface_and_sagitta(face, vertices[rows])
        sagitta = max(sagitta, gap)
        if surface is not None:
            of_face[k] = len(surfaces)
            surfaces.append(facing(surface, vertices, rows))
            off = max(off, float(np.abs(height(surface, vertices[rows].reshape(-1, 3))).max()))
    size = float(np.ptp(vertices, axis=0).max())
    return *_merge_surfaces(surfaces, of_face[owner], triangles, size), sagitta, off


def _surface_and_sagitta(face: StepFace, corners: Array) -> tuple[Surface | None, float]:
    """Exact surface of a face, if known, and the largest distance of its triangles from it.

    `corners`: the corners of its triangles, shape (m, 3, 3).
    """
    middles = np.empty((0, 3))
    if len(face.parameters):
        middles = points_of_face(face.shape, face.parameters[face.triangles].mean(axis=1))
    surface = face_surface(face.shape, face.nodes, middles)
    if surface is not None:
        grid = np.einsum("gk,tkx->tgx", GRID, corners).reshape(-1, 3)
        return surface, float(np.abs(height(surface, grid)).max())
    if not len(middles):
        return None, 0.0
    offset = face.nodes[face.triangles].mean(axis=1) - middles
    return None, float(np.linalg.norm(offset, axis=1).max())


def _merge_surfaces(
    surfaces: list[Surface], lies_on: Index, triangles: Index, size: float
) -> tuple[list[Surface], Index]:
    """Merge equal surfaces of adjacent faces, such as the two halves of a cylinder.

    Arguments: `lies_on` (m,): surface of each triangle, or -1; `triangles` (m, 3); `size`: size of
    the solid [length unit]. Returns `lies_on` (m,).
    """
    if not surfaces:
        return surfaces, lies_on
    pairs = _neighbours(lies_on, triangles)
    same = np.array(
        [
            same_surface(surfaces[a], surfaces[b], length=SAME_FACE * size, angle=SAME_FACE)
            for a, b in pairs.tolist()
        ],
        dtype=bool,
    )
    label = connected(len(surfaces), *pairs[same].T)
    _, first = np.unique(label, return_index=True)
    merged = np.where(lies_on >= 0, label[lies_on], -1)
    return [surfaces[k] for k in first.tolist()], merged


def _neighbours(lies_on: Index, triangles: Index) -> Index:
    """Pairs of different surfaces whose triangles share an edge, shape (n, 2)."""
    ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    on = np.repeat(lies_on, 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, on = ends[order], on[order]
    meet = (ends[1:] == ends[:-1]).all(axis=1) & (on[1:] != on[:-1])
    meet &= (on[1:] >= 0) & (on[:-1] >= 0)
    return np.unique(np.sort(np.column_stack([on[1:], on[:-1]])[meet], axis=1), axis=0)
