"""Shapes of USD prims: cubes, spheres, cylinders, capsules, cones and meshes.

The transform of a prim is split into a rotation and lengths along its axes. Then cubes, and spheres
and round cylinders with equal lengths, keep their exact shapes. Other shapes become meshes. A mesh
is its polygons as drawn: subdivision is not applied.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index, cross
from kilter.errors import InputError
from kilter.files.file_tolerances import FLAT_POLYGON, STRAIGHT_AXES
from kilter.files.meshes.placed import transform_mesh
from kilter.files.robots.one_body import capsule
from kilter.files.usd.usd_values import array_of, size_of, token_of
from kilter.rigid import Pose, matrix_to_quaternion
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, surface

Single = NDArray[np.float32]


CONE_SIDES = 64
"""Number of sides of the pyramid that represents a cone."""
AXES = {"X": np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
        "Y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
        "Z": np.eye(3)}  # fmt: skip
"""For each axis token, the rotation of the z axis onto this axis."""


def rigid_part(matrix: Array) -> Pose:
    """Pose of a frame without its scale: its origin, and the rotation nearest to its axes.

    Raises `InputError` if the matrix is singular or not finite.
    """
    linear = matrix[:3, :3]
    if not np.isfinite(matrix).all() or abs(np.linalg.det(linear)) == 0.0:
        raise InputError(
            "its transform is singular or not finite", hint="give it a scale other than 0"
        )
    lengths = np.linalg.norm(linear, axis=0)
    axes = linear / lengths
    if np.abs(axes.T @ axes - np.eye(3)).max() > STRAIGHT_AXES:
        u, _, v = np.linalg.svd(linear)
        axes = u @ v
    if np.linalg.det(axes) < 0:
        axes = -axes
    return Pose(matrix[:3, 3], matrix_to_quaternion(axes))


def shape_of_prim(prim: Any, matrix: Array) -> tuple[Shape, Pose]:
    """Shape of a prim, and its pose, after a transform.

    Arguments: `matrix` (4, 4): transform of the prim to the frame of its object, for column vectors
    [length unit]. Raises `InputError` if the shape is of another kind, or its data are invalid.
    """
    from pxr import UsdGeom

    if prim.IsA(UsdGeom.Mesh):
        return transform_mesh(_mesh(UsdGeom.Mesh(prim)), matrix), Pose()
    kind = prim.GetTypeName()
    pose, lengths = rigid_part(matrix), np.linalg.norm(matrix[:3, :3], axis=0)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = pose.matrix * lengths, pose.position
    straight = np.abs(np.abs(frame[:3, :3]) - np.abs(matrix[:3, :3])).max()
    exact = straight <= STRAIGHT_AXES * lengths.max()
    if kind == "Cube":
        size = size_of(UsdGeom.Cube(prim).GetSizeAttr())
        if exact:
            return Box(size * lengths), pose
        return _meshed(Box([size] * 3), np.eye(3), matrix)
    if kind == "Sphere":
        radius = size_of(UsdGeom.Sphere(prim).GetRadiusAttr())
        if exact and np.ptp(lengths) <= STRAIGHT_AXES * lengths.max():
            return Sphere(radius * float(lengths[0])), pose
        return _meshed(Sphere(radius), np.eye(3), matrix)
    if kind not in ("Cylinder", "Capsule", "Cone"):
        raise InputError(
            f"its shape {prim.GetName()!r} is a {kind}",
            hint="use a mesh, cube, sphere, cylinder, capsule or cone",
        )
    entry = getattr(UsdGeom, kind)(prim)
    radius = size_of(entry.GetRadiusAttr())
    height = size_of(entry.GetHeightAttr(), may_be_zero=kind == "Capsule")
    turn = AXES[token_of(entry.GetAxisAttr(), AXES, "Z")]
    along = np.abs(turn.T) @ lengths
    if kind == "Cylinder" and exact and abs(along[0] - along[1]) <= STRAIGHT_AXES * along.max():
        upright = Pose(pose.position, matrix_to_quaternion(pose.matrix @ turn))
        return Cylinder(radius * float(along[0]), height * float(along[2])), upright
    if kind == "Cylinder":
        return _meshed(Cylinder(radius, height), turn, matrix)
    if kind == "Cone":
        return _meshed(_cone(radius, height), turn, matrix)
    return _meshed(capsule(radius, height), turn, matrix)


def _meshed(shape: Shape, turn: Array, matrix: Array) -> tuple[Shape, Pose]:
    """A shape, turned and transformed, as a mesh."""
    whole = np.eye(4)
    whole[:3, :3] = turn
    return transform_mesh(Mesh(*surface(shape)), matrix @ whole), Pose()


def _cone(radius: float, height: float) -> Mesh:
    """A cone about z with its middle at the origin, as a pyramid with many sides."""
    angle = np.arange(CONE_SIDES) * (2 * np.pi / CONE_SIDES)
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    corners = np.vstack([np.column_stack([rim, np.full(CONE_SIDES, -height / 2)]),
                         [[0, 0, height / 2]]])  # fmt: skip
    k = np.arange(CONE_SIDES)
    sides = np.column_stack([k, (k + 1) % CONE_SIDES, np.full(CONE_SIDES, CONE_SIDES)])
    return Mesh(corners, [*sides.tolist(), k[::-1].tolist()])


def _mesh(entry: Any) -> Mesh:
    """The polygons of a mesh prim as triangles, in its own frame.

    Raises `InputError` if the counts and indices of its faces do not agree.
    """
    points = array_of(entry.GetPointsAttr(), (-1, 3), ()).astype(np.float32)
    counts = array_of(entry.GetFaceVertexCountsAttr(), (-1,), ()).astype(np.int64)
    corners = array_of(entry.GetFaceVertexIndicesAttr(), (-1,), ()).astype(np.int64)
    name = entry.GetPrim().GetName()
    if not len(counts):
        raise InputError(f"the mesh {name!r} has no faces", hint="export it anew")
    wrong = counts.min() < 3 or counts.sum() != len(corners)
    if wrong or corners.min() < 0 or corners.max() >= len(points):
        raise InputError(f"the faces of the mesh {name!r} are inconsistent", hint="export it anew")
    faces = _faces(points, counts, corners)
    if entry.GetOrientationAttr().Get() == "leftHanded":
        faces = [face[::-1] for face in faces]
    return Mesh(points, faces)


def _faces(points: Single, counts: Index, corners: Index) -> list[list[int]]:
    """The polygons of a mesh as lists of corners; polygons that are not flat become fans."""
    if (counts == 3).all():
        return corners.reshape(-1, 3).tolist()
    ends = np.cumsum(counts)
    faces: list[list[int]] = []
    for begin, end in zip((ends - counts).tolist(), ends.tolist(), strict=True):
        face = corners[begin:end]
        if len(face) > 3 and _is_bent(points[face].astype(np.float64)):
            faces += [[int(face[0]), int(b), int(c)] for b, c in pairwise(face[1:])]
        else:
            faces.append(face.tolist())
    return faces


def _is_bent(corners: Array) -> bool:
    """Whether the corners of a polygon are not in a plane, to the accuracy of single numbers."""
    around = corners - corners.mean(axis=0)
    normal = cross(around, np.roll(around, -1, axis=0)).sum(axis=0)
    size = float(np.linalg.norm(normal))
    if size == 0.0:
        return False
    away = np.abs(around @ (normal / size)).max()
    return bool(away > FLAT_POLYGON * np.abs(corners).max())
