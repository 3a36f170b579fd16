"""Solid: a shape bounded by exact faces (planes, cylinders, cones, spheres, tori), and Surface.

The triangles of a solid, with corners on the exact faces, serve for pictures, for the broad phase
and for the extent of each face. Volume, centre and inertia are those of the exact solid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from kilter.arrays import TINY, Array, Index, cross
from kilter.errors import InputError
from kilter.rigid import Pose, quaternion_to_matrix, unit
from kilter.validate import frozen, number
from kilter.values.value import Value

SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus"]


@dataclass(frozen=True, slots=True, eq=False)
class Surface(Value):
    """An exact surface (plane, cylinder, cone, sphere or torus) of a face, in its part's frame.

    Arguments: `point` (3,) [length unit]; `axis` (3,); `radius` [length unit]; `tube` [length
    unit]; `half_angle` [rad].
    """

    kind: SurfaceKind
    point: Any
    axis: Any = (0.0, 0.0, 1.0)
    radius: float = 0.0
    tube: float = 0.0
    half_angle: float = 0.0
    hollow: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", frozen(self.point, (3,)))
        object.__setattr__(self, "axis", unit(self.axis, "axis of a surface"))


@dataclass(frozen=True, slots=True, eq=False)
class Solid(Value):
    """A solid with exact faces, as read from a CAD file, in the part's own frame.

    Arguments: `vertices` (V, 3) [length unit]; `triangles` (T, 3); `triangle_surface` (T,);
    `volume` [length unit^3]; `centroid` (3,) [length unit]; `second_moment` (3, 3) [length unit^5];
    `sagitta` [length unit]; `accuracy` [length unit]; `holes` (h, 2, 3); `uncertainty` [length
    unit]. Raises `InputError` if the arrays are inconsistent.
    """

    vertices: Any
    triangles: Any
    surfaces: tuple[Surface, ...]
    triangle_surface: Any
    volume: float
    centroid: Any
    second_moment: Any
    sagitta: float = 0.0
    accuracy: float = 0.0
    holes: Any = ()
    stand_in: bool = False
    uncertainty: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, (-1, 3)))
        holes = np.array(self.holes, dtype=np.float64).reshape(-1, 2, 3)
        holes.flags.writeable = False
        object.__setattr__(self, "holes", holes)
        for name, shape in (("triangles", (-1, 3)), ("triangle_surface", (-1,))):
            array = np.array(getattr(self, name), dtype=np.int64).reshape(shape)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        object.__setattr__(self, "surfaces", tuple(self.surfaces))
        object.__setattr__(self, "centroid", frozen(self.centroid, (3,)))
        object.__setattr__(self, "second_moment", frozen(self.second_moment, (3, 3)))
        volume = number(self.volume, "volume of a solid", lowest=0, above=True)
        object.__setattr__(self, "volume", volume)
        corners = self.triangles
        if corners.size and not 0 <= corners.min() <= corners.max() < len(self.vertices):
            raise InputError(
                "a triangle of a solid names a missing vertex", hint="use indices of vertices"
            )
        if len(self.triangle_surface) != len(self.triangles):
            raise InputError(
                f"a solid has {len(self.triangles)} triangles, but "
                f"{len(self.triangle_surface)} entries in triangle_surface",
                hint="give an entry for each triangle",
            )
        if len(self.triangle_surface) and (
            self.triangle_surface.max() >= len(self.surfaces) or self.triangle_surface.min() < -1
        ):
            raise InputError(
                "a triangle of a solid names a missing surface",
                hint="use indices of surfaces, or -1",
            )

    def __repr__(self) -> str:
        return f"<Solid: {len(self.surfaces)} surfaces, {len(self.triangles)} triangles>"


def height(surface: Surface, points: Array) -> Array:
    """Signed distance of points from an exact surface [length unit], shape (n,).

    It is positive in the direction of a plane's axis, and outside of the other surfaces,
    independently of `hollow`. For a cone it is the distance from the infinite line along its side.

    Examples
    --------
    >>> ball = Surface("sphere", [0, 0, 1], radius=2)
    >>> height(ball, np.array([[0, 0, 1], [0, 0, 4.0]]))
    array([-2.,  1.])
    """
    relative = points - surface.point
    if surface.kind == "sphere":
        return np.asarray(np.linalg.norm(relative, axis=1) - surface.radius)
    along = relative @ surface.axis
    if surface.kind == "plane":
        return np.asarray(along)
    across = np.linalg.norm(relative - along[:, None] * surface.axis, axis=1)
    if surface.kind == "cylinder":
        return np.asarray(across - surface.radius)
    if surface.kind == "cone":
        cos, sin = np.cos(surface.half_angle), np.sin(surface.half_angle)
        return np.asarray(across * cos - along * sin)
    return np.asarray(np.hypot(across - surface.radius, along) - surface.tube)


def outward(surface: Surface, points: Array) -> Array:
    """Gradient of `height` at points: normals of an exact surface of any length, shape (n, 3)."""
    relative = points - surface.point
    if surface.kind == "sphere":
        return np.asarray(relative)
    if surface.kind == "plane":
        return np.broadcast_to(surface.axis, points.shape)
    along = relative @ surface.axis
    across = relative - along[:, None] * surface.axis
    if surface.kind == "cylinder":
        return np.asarray(across)
    length = np.maximum(np.linalg.norm(across, axis=1), TINY)[:, None]
    if surface.kind == "cone":
        cos, sin = np.cos(surface.half_angle), np.sin(surface.half_angle)
        return np.asarray(across / length * cos - surface.axis * sin)
    return np.asarray(relative - across / length * surface.radius)


def facing(surface: Surface, vertices: Array, triangles: Index) -> Surface:
    """Copy of a surface with its material on the side that the triangles of the face show.

    The axis of a plane is directed outwards; `hollow` is set for other surfaces.

    Arguments: `vertices` (V, 3); `triangles` (T, 3): triangles, counterclockwise seen from outside
    of the material.
    """
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    turn = float((cross(q - p, r - p) * outward(surface, (p + q + r) / 3)).sum())
    if surface.kind == "plane":
        return surface if turn >= 0 else replace(surface, axis=-surface.axis)
    return replace(surface, hollow=turn < 0)


def same_surface(a: Surface, b: Surface, *, length: float, angle: float) -> bool:
    """Whether two exact surfaces coincide within tolerances, with material on the same side.

    Arguments: `length`: largest difference of radii and positions [length unit]; `angle`: largest
    difference of half angles and directions of axes [rad].
    """
    if a.kind != b.kind or a.hollow != b.hollow:
        return False
    if max(abs(a.radius - b.radius), abs(a.tube - b.tube)) > length:
        return False
    step = b.point - a.point
    if a.kind == "plane":
        step = (step @ a.axis) * a.axis
    elif a.kind == "cylinder":
        step = step - (step @ a.axis) * a.axis
    if float(np.linalg.norm(step)) > length:
        return False
    if a.kind == "sphere":
        return True
    sine = float(np.linalg.norm(np.cross(a.axis, b.axis)))
    # the two halves of a double cone have opposite axes
    opposite = a.kind == "cone" and float(a.axis @ b.axis) < 0
    return sine <= angle and abs(a.half_angle - b.half_angle) <= angle and not opposite


def move_surface(surface: Surface, pose: Pose) -> Surface:
    """An exact surface after a rotation and translation by a pose."""
    return replace(
        surface, point=pose.apply(surface.point[None])[0], axis=pose.matrix @ surface.axis
    )


def move_solid(solid: Solid, pose: Pose) -> Solid:
    """A solid after a rotation and translation by a pose."""
    turn = quaternion_to_matrix(pose.rotation)
    largest = float(np.abs(solid.vertices).max(initial=0.0) + np.abs(pose.position).max())
    return replace(
        solid,
        vertices=pose.apply(solid.vertices),
        surfaces=tuple(move_surface(surface, pose) for surface in solid.surfaces),
        centroid=pose.apply(solid.centroid[None])[0],
        second_moment=turn @ solid.second_moment @ turn.T,
        accuracy=max(solid.accuracy, largest * 2.0**-52),
        holes=_move_boxes(solid.holes, turn, pose.position),
    )


def _move_boxes(boxes: Array, turn: Array, step: Array) -> Array:
    """Boxes that enclose given boxes after a rotation and a translation, shape (n, 2, 3)."""
    middle, half = boxes.mean(axis=1) @ turn.T + step, np.ptp(boxes, axis=1) / 2 @ np.abs(turn).T
    return np.stack([middle - half, middle + half], axis=1)


def scale_solid(solid: Solid, factor: float) -> Solid:
    """A solid with every length multiplied by a positive factor."""
    if factor == 1.0:
        return solid
    surfaces = tuple(
        replace(s, point=s.point * factor, radius=s.radius * factor, tube=s.tube * factor)
        for s in solid.surfaces
    )
    return replace(
        solid,
        vertices=solid.vertices * factor,
        surfaces=surfaces,
        volume=solid.volume * factor**3,
        centroid=solid.centroid * factor,
        second_moment=solid.second_moment * factor**5,
        sagitta=solid.sagitta * factor,
        accuracy=solid.accuracy * factor,
        holes=solid.holes * factor,
        uncertainty=solid.uncertainty * factor,
    )
