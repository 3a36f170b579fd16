"""Building blocks of scenes: parts of simple shapes, rotations, solids of grid cells."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, Feature, GivenContact, Joint, Load, Part
from kilter.errors import InputError
from kilter.rigid import Pose, unit
from kilter.shape.primitives import Box, Mesh, Prism
from kilter.shape.solid import Solid, Surface


def block(name: str, low: ArrayLike, high: ArrayLike, **properties: Any) -> Part:
    """Build a box-shaped part from two opposite corners in the world frame [length unit].

    Examples
    --------
    >>> block("C", [0, 0, 0], [2, 1, 1]).pose.position
    array([1. , 0.5, 0.5])
    """
    a, b = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    return Part(name, Box(b - a), Pose((a + b) / 2), **properties)


def floor(
    low: Sequence[float], high: Sequence[float], *, top: float = 0.0, name: str = "floor"
) -> Part:
    """Build a held slab of thickness 1 from (x, y) `low` to `high`, with its top at z = `top`."""
    return block(name, [*low, top - 1.0], [*high, top], grounded=True)


def prism(name: str, polygon: Any, depth: float = 1.0, **properties: Any) -> Part:
    """Build a part that is a prism: a polygon in the x-z plane of the world, extruded along y."""
    return Part(name, Prism(polygon, depth), **properties)


def turn(axis: ArrayLike, degrees: float) -> Array:
    """Quaternion (w, x, y, z) of a right-handed rotation about `axis` by `degrees`.

    Examples
    --------
    >>> turn([0, 0, 2], 180).round(12)
    array([0., 0., 0., 1.])
    """
    half = np.radians(degrees) / 2
    return np.array([np.cos(half), *(np.sin(half) * unit(axis, "axis"))])


def compose(second: ArrayLike, first: ArrayLike) -> Array:
    """Quaternion of the rotation `first` followed by the rotation `second`.

    Examples
    --------
    >>> compose(turn([0, 1, 0], 20), turn([0, 1, 0], -20)).round(12)
    array([1., 0., 0., 0.])
    """
    a, b = np.asarray(second, dtype=np.float64), np.asarray(first, dtype=np.float64)
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *vector])


def turned_parts(parts: Sequence[Part], rotation: ArrayLike) -> list[Part]:
    """Rotate parts about the world's origin by a quaternion (w, x, y, z)."""
    pose = Pose(rotation=rotation)
    return [
        dataclasses.replace(
            part,
            pose=Pose(
                pose.apply([part.pose.position])[0], compose(pose.rotation, part.pose.rotation)
            ),
        )
        for part in parts
    ]


def tube(
    name: str,
    bore: float,
    outer: float,
    height: float,
    at: ArrayLike = (0.0, 0.0, 0.0),
    *,
    sides: int = 48,
    **properties: Any,
) -> Part:
    """Build a part that is a tube about z, with exact cylinders and two flat ends.

    Arguments: `bore`, `outer`: radii [length unit]; `height`: extent along z [length unit]; `at`
    (3,): middle of the tube [length unit].

    Examples
    --------
    >>> round(tube("ring", 1, 2, 4).shape.volume / np.pi, 12)
    12.0
    """
    angle = np.arange(sides) * (2 * np.pi / sides)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [
        np.column_stack([radius * circle, np.full(sides, z)])
        for radius in (bore, outer)
        for z in (-height / 2, height / 2)
    ]
    k, j = np.arange(sides), (np.arange(sides) + 1) % sides
    low_in, high_in, low_out, high_out = (k + n * sides for n in range(4))
    a, b, c, d = (j + n * sides for n in range(4))
    quads = [
        (low_in, high_in, b, a),  # the bore, with normals towards the axis
        (low_out, c, d, high_out),
        (high_in, high_out, d, b),
        (low_in, a, c, low_out),
    ]
    triangles = np.concatenate(
        [np.column_stack(three) for p, q, r, s in quads for three in ((p, q, r), (p, r, s))]
    )
    surface = np.repeat([0, 1, 2, 3], 2 * sides)
    area = np.pi * (outer**2 - bore**2)
    volume = area * height
    across = volume * ((outer**2 + bore**2) / 4)
    faces = [
        Surface("cylinder", [0, 0, 0], [0, 0, 1], radius=bore, hollow=True),
        Surface("cylinder", [0, 0, 0], [0, 0, 1], radius=outer),
        Surface("plane", [0, 0, height / 2], [0, 0, 1]),
        Surface("plane", [0, 0, -height / 2], [0, 0, -1]),
    ]
    solid = Solid(
        np.concatenate(rings),
        triangles,
        tuple(faces),
        surface,
        volume,
        [0, 0, 0],
        np.diag([across, across, volume * height**2 / 12]),
        sagitta=outer * (1 - np.cos(np.pi / sides)),
    )
    return Part(name, solid, Pose(at), **properties)


def ring(inner: float, outer: float, depth: float) -> Mesh:
    """Mesh of a square frame with a square hole; `inner`, `outer` are half widths in x and z.

    Examples
    --------
    >>> len(ring(1, 2, 1).vertices)
    32
    """
    lines = [-outer, -inner, inner, outer]
    solid = np.ones((3, 1, 3), dtype=bool)
    solid[1, 0, 1] = False
    return cells(lines, [-depth / 2, depth / 2], lines, solid)


def cells(xs: ArrayLike, ys: ArrayLike, zs: ArrayLike, solid: ArrayLike) -> Mesh:
    """Mesh of the union of the cells of a grid that are marked as `solid`.

    Parameters
    ----------
    xs, ys, zs : array_like
        Ascending coordinates of the grid planes [length unit].
    solid : array_like of bool, shape (len(xs) - 1, len(ys) - 1, len(zs) - 1)
        Whether a cell is filled. Filled cells must not meet along an edge only.

    Raises
    ------
    InputError
        If `solid` does not fit the grid, or no cell is filled.

    Examples
    --------
    >>> cells([0, 1, 2], [0, 1], [0, 1, 2], [[[1, 1]], [[1, 0]]])
    Mesh(16 vertices, 28 triangles)
    """
    grid = [np.asarray(line, dtype=np.float64) for line in (xs, ys, zs)]
    filled = np.asarray(solid, dtype=bool)
    if filled.shape != tuple(len(line) - 1 for line in grid) or not filled.any():
        raise InputError(
            f"cells of shape {filled.shape} do not fit the grid",
            hint="give a truth value for each cell between the coordinates, at least one True",
        )
    quads = np.concatenate([_sides(filled, axis) for axis in range(3)])
    shape = tuple(len(line) for line in grid)
    rows = np.ravel_multi_index(tuple(np.moveaxis(quads, -1, 0)), shape)
    used, faces = np.unique(rows, return_inverse=True)
    corners = np.unravel_index(used, shape)
    vertices = np.column_stack([line[k] for line, k in zip(grid, corners, strict=True)])
    faces = faces.reshape(-1, 4)
    return Mesh(vertices, np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]))


def _sides(filled: Mask, axis: int) -> Index:
    """Outer faces across an axis of the filled grid cells, as grid corners, shape (n, 4, 3)."""
    padding = [(1, 1) if k == axis else (0, 0) for k in range(3)]
    steps = np.diff(np.pad(filled.astype(np.int8), padding), axis=axis)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = np.zeros((4, 3), dtype=np.int64)
    corners[[1, 2], u] = 1
    corners[[2, 3], v] = 1
    inward = np.argwhere(steps == 1)[:, None, :] + corners[::-1]
    outward = np.argwhere(steps == -1)[:, None, :] + corners
    return np.concatenate([inward, outward])


# Rigid motion of a whole assembly, which changes no verdict.


def moved(
    assembly: Assembly, rotation: ArrayLike = (1, 0, 0, 0), shift: ArrayLike = (0, 0, 0)
) -> Assembly:
    """Rotate an assembly about the origin, then shift it, with its gravity, loads and contacts.

    Arguments: `rotation` (4,): quaternion (w, x, y, z); `shift` (3,): shift, world frame [length
    unit]. Raises `InputError` if the assembly is planar and the rotation is not about y.

    Examples
    --------
    >>> from kilter.scenes.pieces import turn
    >>> from kilter.scenes.stacks import tower
    >>> moved(tower(1), turn([0, 1, 0], 90)).down.round(12) + 0
    array([-1.,  0.,  0.])
    """
    pose = Pose(shift, rotation)
    matrix = pose.matrix
    if assembly.planar:
        require_about_y(matrix)
    gravity = matrix @ assembly.gravity
    if assembly.planar:
        gravity[1] = 0.0
    return dataclasses.replace(
        assembly,
        parts=[_moved_part(part, pose) for part in assembly.parts],
        gravity=gravity,
        loads=[_moved_load(load, pose) for load in assembly.loads],
        contacts=[
            dataclasses.replace(
                c,
                points=pose.apply(c.points),
                normal=matrix @ c.normal,
                feature=moved_features(c, lambda v: matrix @ v, lambda p: pose.apply([p])[0], 1.0),
            )
            for c in assembly.contacts
        ],
        joints=[_moved_joint(joint, pose) for joint in assembly.joints],
        bonds=[
            bond
            if bond.points is None
            else dataclasses.replace(
                bond, points=pose.apply(bond.points), normal=matrix @ bond.normal
            )
            for bond in assembly.bonds
        ],
        straps=[
            dataclasses.replace(
                strap,
                path=list(zip(strap.parts, pose.apply(strap.points), strict=True)),
            )
            for strap in assembly.straps
        ],
    )


def require_about_y(matrix: Array) -> None:
    """Raise `InputError` if a rotation matrix is not about y, for a planar assembly."""
    if abs(matrix[1, 1] - 1.0) > 1e-12:
        raise InputError("the turn leaves the x-z plane of a planar assembly", hint="turn about y")


def _moved_part(part: Part, pose: Pose) -> Part:
    position = pose.apply([part.pose.position])[0]
    return dataclasses.replace(
        part, pose=Pose(position, compose(pose.rotation, part.pose.rotation))
    )


def _moved_load(load: Load, pose: Pose) -> Load:
    point = None if load.point is None else pose.apply([load.point])[0]
    return Load(load.part, pose.matrix @ load.force, pose.matrix @ load.torque, point)


def _moved_joint(joint: Joint, pose: Pose) -> Joint:
    point = None if joint.point is None else pose.apply([joint.point])[0]
    return joint.moved(point, pose.matrix)


def moved_features(
    contact: GivenContact,
    turned: Callable[[Array], Array],
    moved: Callable[[Array], Array],
    factor: float,
) -> tuple[Feature, Feature] | None:
    """Touching features of a contact after a rotation, shift and scaling; None without features.

    `turned` maps directions, `moved` maps points; the surfaces are `factor` times as large.
    """
    if contact.feature is None:
        return None
    a, b = (
        Feature(
            feature.kind,
            None if feature.along is None else turned(feature.along),
            feature.curvature / factor,
            None if feature.point is None else moved(feature.point),
            None if feature.axis is None else turned(feature.axis),
        )
        for feature in contact.feature
    )
    return a, b
