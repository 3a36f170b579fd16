"""Several shapes that are one rigid body: one alone keeps its exact faces, more are united.

The union is that of their triangles, cut by manifold3d: shapes may overlap or stand apart.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.rigid import Pose, matrix_to_quaternion
from kilter.shape.primitives import Mesh, Shape, surface

__all__ = ["combined", "one_body"]


def combined(outer: Pose, inner: Pose) -> Pose:
    """First the inner pose, then the outer one.

    Examples
    --------
    >>> combined(Pose([0, 0, 1]), Pose([1, 0, 0]))
    Pose(position=(1, 0, 1), rotation=(1, 0, 0, 0))
    """
    turn = outer.matrix @ inner.matrix
    return Pose(outer.apply([inner.position])[0], matrix_to_quaternion(turn))


def one_body(shapes: Sequence[tuple[Shape, Pose]]) -> tuple[Shape, Pose]:
    """The shape of a body made of shapes in its frame, and the pose of that shape in it.

    Raises
    ------
    InputError
        If shapes that are to be united are not closed.
    """
    if len(shapes) == 1:
        return shapes[0]
    import manifold3d

    solids = [_solid(*surface(shape), pose) for shape, pose in shapes]
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    return Mesh(vertices, np.asarray(mesh.tri_verts).astype(np.int64)), Pose()


def _solid(vertices: Array, triangles: Index, pose: Pose) -> object:
    import manifold3d

    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(pose.apply(vertices)),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
    )
    mesh.merge()
    solid = manifold3d.Manifold(mesh)
    if solid.status() != manifold3d.Error.NoError:
        raise InputError(
            "a mesh among several shapes of one body is not closed", hint="close it, or part them"
        )
    return solid
