"""Shapes of the geoms of a MuJoCo model.

A mesh that can touch other geoms is its convex hull, since MuJoCo collides hulls; a mesh that only
is visible keeps its triangles, and so does that of a distance field. A height field is the closed
solid between its triangles and its base. MuJoCo divides each of its cells along the diagonal from
(x, y) to (x + dx, y + dy).
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.errors import InputError
from kilter.files.limits import Tally
from kilter.files.objects.mujoco_snapshot import Snapshot
from kilter.files.robots.one_body import capsule, ellipsoid
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, hull_surface

PLANE, FIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH, DISTANCES = range(9)
"""MuJoCo's numbers for the kinds of geoms."""
CONVEX = 1e-6
"""Largest difference of the volumes of a convex mesh and of its hull, over that of the hull [-]."""
MOST_POINTS = 250_000
"""Largest number of points of all height fields; each makes four triangles."""


class GeomShapes:
    """Shapes of the geoms of a model; equal geoms share a shape."""

    def __init__(self, model: Snapshot, collides: Mask) -> None:
        self.model, self.collides = model, collides
        self.hulls = 0
        """Number of geoms whose mesh is replaced by its hull."""
        self._points = Tally("points of height fields", MOST_POINTS)
        self._known: dict[tuple[float, ...], Shape] = {}
        self._hollow: set[int] = set()
        """Meshes that differ from their hulls."""

    def placed(self, geom: int) -> tuple[Shape, Pose]:
        """Shape of a geom, and its pose relative to its body."""
        model = self.model
        kind, size = int(model.geom_type[geom]), tuple(model.geom_size[geom].tolist())
        if kind == FIELD:
            self._points.add(int(np.prod(self._grid(geom))))
        key: tuple[float, ...] = (kind, *size)
        if kind in (FIELD, MESH, DISTANCES):
            hulled = kind == MESH and bool(self.collides[geom])
            key = (kind, int(model.geom_dataid[geom]), hulled)
        if key not in self._known:
            self._known[key] = self._shape(geom, kind, size)
        if kind == MESH and self.collides[geom]:
            self.hulls += int(model.geom_dataid[geom]) in self._hollow
        return self._known[key], Pose(model.geom_pos[geom], model.geom_quat[geom])

    def _shape(self, geom: int, kind: int, size: tuple[float, ...]) -> Shape:
        """Shape of a geom of a kind with the sizes of MuJoCo, mostly half lengths."""
        if kind == SPHERE:
            return Sphere(size[0])
        if kind == CYLINDER:
            return Cylinder(size[0], 2 * size[1])
        if kind == BOX:
            return Box([2 * length for length in size])
        if kind == CAPSULE:
            return capsule(size[0], 2 * size[1])
        if kind == ELLIPSOID:
            return ellipsoid(size)
        number = int(self.model.geom_dataid[geom])
        if kind in (MESH, DISTANCES) and number >= 0:
            mesh = self._mesh(number)
            return self._hull(number, mesh) if kind == MESH and self.collides[geom] else mesh
        if kind == FIELD:
            return self._height_field(geom)
        raise InputError("it has a geom of an unknown kind", hint="replace it by a mesh")

    def _mesh(self, number: int) -> Mesh:
        """A mesh of the model."""
        model = self.model
        first, count = int(model.mesh_vertadr[number]), int(model.mesh_vertnum[number])
        start, faces = int(model.mesh_faceadr[number]), int(model.mesh_facenum[number])
        corners = np.array(model.mesh_vert[first : first + count], dtype=np.float32)
        return Mesh(corners, np.array(model.mesh_face[start : start + faces]))

    def _hull(self, number: int, mesh: Mesh) -> Mesh:
        """The convex hull that MuJoCo collides; the mesh itself if it is convex, or flat."""
        start = int(self.model.mesh_graphadr[number])
        points = mesh.vertices
        if start >= 0:  # the graph begins with two counts and the addresses of the edges
            count = int(self.model.mesh_graph[start])
            chosen = self.model.mesh_graph[start + 2 + count : start + 2 + 2 * count]
            points = points[np.asarray(chosen, dtype=np.int64)]
        try:
            hull = Mesh(*hull_surface(points), accuracy=mesh.accuracy)
        except InputError:
            return mesh
        own, whole = _volume(mesh), _volume(hull)
        if own > 0 and abs(whole - own) <= CONVEX * whole:
            return mesh
        self._hollow.add(number)
        return hull

    def _grid(self, geom: int) -> tuple[int, int]:
        """Numbers of rows and columns of the height field of a geom."""
        number = int(self.model.geom_dataid[geom])
        return int(self.model.hfield_nrow[number]), int(self.model.hfield_ncol[number])

    def _height_field(self, geom: int) -> Mesh:
        """The solid below the height field of a geom, down to its base."""
        number, (rows, columns) = int(self.model.geom_dataid[geom]), self._grid(geom)
        half_x, half_y, top, base = self.model.hfield_size[number].tolist()
        first = int(self.model.hfield_adr[number])
        heights = np.array(self.model.hfield_data[first : first + rows * columns], dtype=np.float64)
        x, y = np.linspace(-half_x, half_x, columns), np.linspace(-half_y, half_y, rows)
        return _solid(x, y, top * heights.reshape(rows, columns), -base)


def _solid(x: Array, y: Array, heights: Array, base: float) -> Mesh:
    """The closed mesh between heights (rows, columns) at x (columns,), y (rows,) and a base."""
    rows, columns = heights.shape
    grid = np.stack([*np.meshgrid(x, y), heights], axis=-1).reshape(-1, 3)
    index = np.arange(rows * columns).reshape(rows, columns)
    here, right = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
    back, far = index[1:, :-1].ravel(), index[1:, 1:].ravel()
    above = np.vstack([np.column_stack([here, right, far]), np.column_stack([here, far, back])])
    edge: Index = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    foot = rows * columns + np.arange(len(edge))
    following, below = np.roll(edge, -1), np.roll(foot, -1)
    sides = np.vstack(
        [np.column_stack([edge, foot, below]), np.column_stack([edge, below, following])]
    )
    under = grid[edge] * [1.0, 1.0, 0.0] + [0.0, 0.0, base]
    floor = np.column_stack([np.full(len(foot), foot[-1] + 1), below, foot])
    points = np.vstack([grid, under, [x.mean(), y.mean(), base]])
    return Mesh(points, np.vstack([above, sides, floor]))


def _volume(mesh: Mesh) -> float:
    """Volume enclosed by the triangles of a mesh."""
    corners = mesh.vertices[mesh.triangles] - mesh.vertices.mean(axis=0)
    return float(np.linalg.det(corners).sum() / 6)
