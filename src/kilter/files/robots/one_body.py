"""Combine the shapes of a rigid body into a single shape.

A single shape keeps its exact faces. The triangles of several shapes are united by manifold3d;
they may overlap or be separate.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from kilter.arrays import Array, Index
from kilter.assembly import Part
from kilter.errors import InputError
from kilter.files.limits import Tally
from kilter.rigid import Pose, matrix_to_quaternion
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, hull_surface, surface

# Pairs of parts that are near each other, whose friction and filters a scene states.


REACH = 2.0
"""Distance of two parts up to which their friction is read [sums of their radii]; a larger value
gives more friction pairs."""
MOST_PAIRS = 10_000_000
"""Largest number of near pairs; parts that all lie at the same place have many."""
AT_ONCE = 128
"""Number of parts whose neighbours are found together; it bounds the memory."""


def near_pairs(parts: Sequence[Part], reach: float) -> tuple[Index, Index]:
    """Pairs of parts whose bounding spheres overlap after enlargement by the factor `reach`.

    Raises `InputError` if there are too many pairs.
    """
    points = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    middle = np.array([(p.min(axis=0) + p.max(axis=0)) / 2 for p in points])
    radius = np.array(
        [np.linalg.norm(p - m, axis=1).max() for p, m in zip(points, middle, strict=True)]
    )
    half = reach * radius
    boxes = shapely.box(*(middle[:, :2] - half[:, None]).T, *(middle[:, :2] + half[:, None]).T)
    tree = shapely.STRtree(boxes)
    tally = Tally("pairs of near parts", MOST_PAIRS)
    rows = []
    for start in range(0, len(parts), AT_ONCE):
        a, b = tree.query(boxes[start : start + AT_ONCE], predicate="intersects")
        a = a + start
        a, b = a[a < b], b[a < b]
        close = np.linalg.norm(middle[a] - middle[b], axis=1) <= reach * (radius[a] + radius[b])
        tally.add(int(close.sum()))
        rows.append(np.column_stack([a[close], b[close]]))
    pairs = np.concatenate(rows).astype(np.int64)
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return pairs[order, 0], pairs[order, 1]


def held_note(robots: int, bodies: int) -> str:
    """Note about held robots.

    Examples
    --------
    >>> held_note(1, 9)
    'held: robot of 9 bodies with motors; --loose-robots frees them'
    """
    kind = "robot of" if robots == 1 else f"{robots} robots,"
    each, them = ("body", "it") if bodies == 1 else ("bodies", "them")
    return f"held: {kind} {bodies} {each} with motors; --loose-robots frees {them}"


def compose(outer: Pose, inner: Pose) -> Pose:
    """Pose that applies the inner pose first, then the outer pose.

    Examples
    --------
    >>> compose(Pose([0, 0, 1]), Pose([1, 0, 0]))
    Pose(position=(1, 0, 1), rotation=(1, 0, 0, 0))
    """
    turn = outer.matrix @ inner.matrix
    return Pose(outer.apply([inner.position])[0], matrix_to_quaternion(turn))


def one_body(
    shapes: Sequence[tuple[Shape, Pose]],
    name: str,
    notes: list[str],
    pieces: Sequence[int] = (),
) -> tuple[Shape, Pose]:
    """Unite shapes to the single shape of a part, and return its pose.

    Returns `pose`: pose of the shape in the frame of the body. Raises `InputError` if there are
    several shapes and each is a flat mesh.
    """
    if len(shapes) == 1:
        return shapes[0]
    import manifold3d

    solids, hulls, flat = [], 0, 0
    piece_of: dict[int, int] = {}
    for (shape, pose), piece in zip(shapes, pieces or [0] * len(shapes), strict=True):
        vertices, triangles = surface(shape)
        solid = _manifold(vertices, triangles, pose)
        if solid is None:
            try:
                solid = _manifold(*hull_surface(vertices), pose)
                hulls += 1
            except InputError:
                flat += 1
        if solid is not None:
            solids.append(solid.as_original())
            piece_of[solids[-1].original_id()] = piece
    effects = {"open shapes replaced by their convex hulls": hulls, "flat shapes left out": flat}
    notes += [f"part {name!r}: {what}: {n} of {len(shapes)}" for what, n in effects.items() if n]
    if not solids:
        raise InputError("all of its meshes are flat", hint="give closed solids")
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    # a run is a range of triangles of the same solid; its limits count corners
    runs = np.diff(np.asarray(mesh.run_index)) // 3
    numbers = np.repeat([piece_of[k] for k in mesh.run_original_id], runs)
    triangles = np.asarray(mesh.tri_verts).astype(np.int64)
    mesh_of = Mesh(vertices, triangles, pieces=numbers, members=shapes, member_pieces=pieces)
    return mesh_of, Pose()


def capsule(radius: float, height: float) -> Shape:
    """A cylinder about z with its middle at the origin, and a half-ball at each end.

    Arguments: `radius` [m]; `height`: length of the cylinder [m]; 0 for a ball.
    """
    ball = Sphere(radius)
    if not height > 0:
        return ball
    ends = [(ball, Pose([0, 0, z])) for z in (-height / 2, height / 2)]
    return one_body([(Cylinder(radius, height), Pose()), *ends], "capsule", [])[0]


def ellipsoid(radii: Sequence[float] | Array) -> Mesh:
    """An ellipsoid about the origin with three radii [m], as a mesh."""
    vertices, triangles = surface(Sphere(1.0))
    return Mesh(vertices * np.asarray(radii), triangles)


SPACIOUS = 4.0
"""Margin of the table for an infinite plane around the parts [sizes of all parts]."""


def plane_table(name: str, pose: Pose, half: Array, parts: Sequence[Part]) -> Part:
    """A held table whose top is a plane, the plane z = 0 of a pose.

    Arguments: `half` (2,): half lengths along x and y of the pose [m]; 0: large enough for `parts`.
    """
    points = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    corners = np.vstack(points) if points else np.zeros((1, 3))
    size = float(np.ptp(corners, axis=0).max()) or 1.0
    local = np.abs((corners - pose.position) @ pose.matrix)[:, :2].max(axis=0)
    half = np.where(half > 0, half, local + SPACIOUS * size)
    return Part(
        name,
        Box([2 * half[0], 2 * half[1], size]),
        compose(pose, Pose([0, 0, -size / 2])),
        grounded=True,
        density=1000.0,
        table=True,
        geometry="collider",
    )


def _manifold(vertices: Array, triangles: Index, pose: Pose) -> Any:
    """Convert a mesh in a pose to a solid of the library manifold3d; None if it is not closed."""
    import manifold3d

    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(pose.apply(vertices)),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
    )
    mesh.merge()
    solid = manifold3d.Manifold(mesh)
    return solid if solid.status() == manifold3d.Error.NoError else None
