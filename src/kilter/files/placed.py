"""Bodies of files put in place: turned, scaled, joined; their accuracy goes with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.rigid import Pose
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, Surface, scaled_solid
from kilter.units import metres_per_unit

__all__ = ["FileBodies", "joined", "placed", "scaled"]


@dataclass(frozen=True, slots=True, eq=False)
class FileBodies:
    """What a file of meshes, or of solids, holds, in its own unit.

    Attributes
    ----------
    names : tuple of str or None
    shapes : tuple of Mesh or Solid
        In their own frames; one that is used several times is the same object.
    poses : tuple of Pose
        From the frame of the shape to that of the file; none where the two are one.
    units : str or None
        None where the file states no unit.
    by_standard : bool
        The unit is that of the format, not one that the file states.
    notes : tuple of str
    left_out : tuple of str
        Names of bodies that were left out as asked.
    """

    names: tuple[str | None, ...]
    shapes: tuple[Mesh | Solid, ...]
    poses: tuple[Pose, ...] = ()
    units: str | None = None
    by_standard: bool = False
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    def sealed(self) -> FileBodies:
        """The same, its arrays read-only: those that come from another process are not."""
        for value in (*self.shapes, *self.poses, *(s for x in self.shapes for s in _surfaces(x))):
            for name in value.__slots__:
                array = getattr(value, name)
                if isinstance(array, np.ndarray):
                    array.flags.writeable = False
        return self

    @property
    def places(self) -> tuple[Pose, ...]:
        """The pose of each shape."""
        return self.poses or (Pose(),) * len(self.shapes)

    def in_units(self, units: str) -> list[tuple[Mesh | Solid, Pose]]:
        """Shapes and poses with lengths in `units`; of a file without a unit as they are."""
        factor = metres_per_unit(self.units or units) / metres_per_unit(units)
        own = {
            id(shape): scaled(shape, factor)
            if isinstance(shape, Mesh)
            else scaled_solid(shape, factor)
            for shape in self.shapes
        }
        return [
            (own[id(shape)], Pose(pose.position * factor, pose.rotation))
            for shape, pose in zip(self.shapes, self.places, strict=True)
        ]


def _surfaces(shape: Mesh | Solid) -> tuple[Surface, ...]:
    return shape.surfaces if isinstance(shape, Solid) else ()


def placed(mesh: Mesh, matrix: Array) -> Mesh:
    """The mesh moved by a 4 x 4 matrix (columns); a mirror image keeps its outside outside.

    Examples
    --------
    >>> tip = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> placed(tip, np.diag([-1.0, 1, 1, 1])).triangles
    array([[2, 1, 0]])
    """
    if np.array_equal(matrix, np.eye(4)):
        return mesh
    linear, step = matrix[:3, :3], matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(linear) < 0 else mesh.triangles
    largest = np.abs(mesh.vertices).max(axis=0, initial=0.0)
    # what the coordinates are off by, relative to the largest, holds for the sums they enter
    relative = mesh.accuracy / (float(largest.max()) or 1.0)
    accuracy = relative * float((np.abs(linear) @ largest + np.abs(step)).max())
    return Mesh(mesh.vertices @ linear.T + step, triangles, accuracy=accuracy)


def scaled(mesh: Mesh, factor: float) -> Mesh:
    """The mesh with every length times a factor."""
    if factor == 1.0:
        return mesh
    return Mesh(mesh.vertices * factor, mesh.triangles, accuracy=mesh.accuracy * factor)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one."""
    if len(meshes) == 1:
        return meshes[0]
    start = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + n for m, n in zip(meshes, start[:-1], strict=True)]),
        accuracy=max(mesh.accuracy for mesh in meshes),
    )
