"""Bodies of a file, and how to place, scale and join their meshes together with their accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.rigid import Pose
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, scale_solid
from kilter.units import metres_per_unit

__all__ = ["FileBodies", "join_meshes", "scale_mesh", "transform_mesh"]


@dataclass(frozen=True, slots=True, eq=False)
class FileBodies:
    """Meshes or solids of a file with names and poses, in the file's own length unit."""

    names: tuple[str | None, ...]
    shapes: tuple[Mesh | Solid, ...]
    """Shapes in their own frames; instances of a shape are the same object."""
    poses: tuple[Pose, ...] = ()
    """Transforms from the frame of each shape to the frame of the file; empty if the frames are
    the same."""
    units: str | None = None
    """Length unit; None if the file states none."""
    by_standard: bool = False
    """Whether the unit is fixed by the standard of the format, and not stated in the file."""
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    """Names of the bodies that the options leave out."""
    densities: tuple[float | None, ...] = ()
    """Density that the file states for each body [kg/m^3]; empty if it states none."""
    colors: tuple[str | None, ...] = ()
    """Colour of each body ("#rrggbb"); empty if the file states none."""
    materials: tuple[str | None, ...] = ()
    layers: tuple[str | None, ...] = ()
    """Names of the material and of the layer of each body; empty if the file states none."""

    @property
    def places(self) -> tuple[Pose, ...]:
        """Pose of each shape in the frame of the file, also if `poses` is empty."""
        return self.poses or (Pose(),) * len(self.shapes)

    @property
    def stated(self) -> list[dict[str, Any]]:
        """Density, colour, material and layer of each body, as keyword arguments of `Part`."""
        none = (None,) * len(self.shapes)
        columns = (self.densities, self.colors, self.materials, self.layers)
        keys = ("density", "color", "material", "layer")
        rows = zip(*(column or none for column in columns), strict=True)
        return [dict(zip(keys, row, strict=True)) for row in rows]

    def in_units(self, units: str) -> list[tuple[Mesh | Solid, Pose]]:
        """Shapes and poses converted to the length unit `units`."""
        factor = metres_per_unit(self.units or units) / metres_per_unit(units)
        converted = {
            id(shape): scale_mesh(shape, factor)
            if isinstance(shape, Mesh)
            else scale_solid(shape, factor)
            for shape in self.shapes
        }
        return [
            (converted[id(shape)], Pose(pose.position * factor, pose.rotation))
            for shape, pose in zip(self.shapes, self.places, strict=True)
        ]


def transform_mesh(mesh: Mesh, matrix: Array) -> Mesh:
    """The mesh after a linear transform, given as a 4 x 4 matrix for column vectors.

    A reflection also reverses the triangles, so that their normals still point outwards.

    Examples
    --------
    >>> tip = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> transform_mesh(tip, np.diag([-1.0, 1, 1, 1])).triangles
    array([[2, 1, 0]])
    """
    if np.array_equal(matrix, np.eye(4)):
        return mesh
    linear, step = matrix[:3, :3], matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(linear) < 0 else mesh.triangles
    largest = np.abs(mesh.vertices).max(axis=0, initial=0.0)
    # the error of a sum of coordinates has the relative size of the error of its terms
    relative = mesh.accuracy / (float(largest.max()) or 1.0)
    accuracy = relative * float((np.abs(linear) @ largest + np.abs(step)).max())
    corners = mesh.vertices @ linear.T + step
    return Mesh(corners, triangles, accuracy=accuracy, pieces=mesh.pieces)


def scale_mesh(mesh: Mesh, factor: float) -> Mesh:
    """The mesh with every length multiplied by a factor."""
    if factor == 1.0:
        return mesh
    return Mesh(
        mesh.vertices * factor,
        mesh.triangles,
        accuracy=mesh.accuracy * factor,
        pieces=mesh.pieces,
    )


def join_meshes(meshes: Sequence[Mesh]) -> Mesh:
    """Join meshes to a single mesh, with the largest of their coordinate errors."""
    if len(meshes) == 1:
        return meshes[0]
    start = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + n for m, n in zip(meshes, start[:-1], strict=True)]),
        accuracy=max(mesh.accuracy for mesh in meshes),
    )
