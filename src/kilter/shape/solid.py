"""Solid: a part bounded by exact faces (planes, cylinders, cones, spheres, tori), and Surface.

Its triangles are for pictures, for the broad phase and for the extent of each face: their
corners lie on the exact faces. Volume, centre and inertia are those of the exact solid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from kilter.arrays import TINY, Array, Index, cross
from kilter.errors import InputError
from kilter.rigid import Pose, quaternion_to_matrix, unit
from kilter.validate import frozen, number

__all__ = [
    "Solid",
    "Surface",
    "SurfaceKind",
    "facing",
    "height",
    "moved_solid",
    "moved_surface",
    "outward",
    "scaled_solid",
]


SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus"]


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """The exact surface that a face lies on, in the frame of its part.

    Parameters
    ----------
    kind : {"plane", "cylinder", "cone", "sphere", "torus"}
    point : array_like, shape (3,)
        A point of the plane or of the axis of the cylinder; the apex of the cone; the centre
        of the sphere or torus [length unit].
    axis : array_like, shape (3,)
        Unit: the outward normal of the plane; the axis of the cylinder or torus; from the
        apex into the cone. Of no meaning for a sphere.
    radius : float
        Of the cylinder or sphere; of the centre line of the torus [length unit].
    tube : float
        Radius of the tube of the torus [length unit].
    half_angle : float
        Between the axis and the side of the cone [rad].
    hollow : bool
        The material lies outside of the surface: a hole, a socket.
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
class Solid:
    """A solid with exact faces, in the part's own frame.

    Parameters
    ----------
    vertices : array_like, shape (V, 3)
        Corners of the triangles, on the exact faces [length unit].
    triangles : array_like of int, shape (T, 3)
        Turning left seen from outside; closed.
    surfaces : sequence of Surface
    triangle_surface : array_like of int, shape (T,)
        The surface that each triangle lies on; -1 where it is on none of the kinds above.
    volume : float
        [length unit^3]
    centroid : array_like, shape (3,)
    second_moment : array_like, shape (3, 3)
        Integral of x x^T about the centroid [length unit^5].
    sagitta : float
        The greatest distance of a triangle from its face [length unit].
    accuracy : float
        How far a coordinate may be from the truth [length unit].
    holes : array_like, shape (h, 2, 3)
        Boxes, lower and upper corner, in which faces are missing; none of a sound solid.
    stand_in : bool
        The triangles are not its faces but bound it: nothing of its surface is known.
    uncertainty : float
        How far points may be off by what the file states of itself [length unit]; not counted
        in `accuracy`, which is that of the numbers.

    Raises
    ------
    InputError
        If the arrays do not fit together.
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
            raise InputError("a solid names a corner it has not", hint="name them by position")
        if len(self.triangle_surface) != len(self.triangles):
            raise InputError("a solid has not one surface a triangle", hint="list one a triangle")
        if len(self.triangle_surface) and (
            self.triangle_surface.max() >= len(self.surfaces) or self.triangle_surface.min() < -1
        ):
            raise InputError("a solid names a surface it has not", hint="name them by position")

    def __repr__(self) -> str:
        return f"<Solid: {len(self.surfaces)} surfaces, {len(self.triangles)} triangles>"


def height(surface: Surface, points: Array) -> Array:
    """How far points are outside of a surface, negative inside, shape (n,) [length unit].

    Along the axis of a plane, away from the axis of a cylinder or cone, from the centre of a
    sphere, from the tube of a torus; `hollow` does not count. Of a cone it is the distance to
    the whole line that its side is a part of.

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
    """Directions in which `height` grows, shape (n, 3), of any length."""
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
    """The surface turned as triangles on it are: a plane's axis outward, `hollow` as it is.

    Parameters
    ----------
    surface : Surface
    vertices : ndarray, shape (V, 3)
    triangles : ndarray, shape (T, 3)
        Turning left seen from outside of the material.
    """
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    turn = float((cross(q - p, r - p) * outward(surface, (p + q + r) / 3)).sum())
    if surface.kind == "plane":
        return surface if turn >= 0 else replace(surface, axis=-surface.axis)
    return replace(surface, hollow=turn < 0)


def moved_surface(surface: Surface, pose: Pose) -> Surface:
    """The surface after a pose."""
    return replace(
        surface, point=pose.apply(surface.point[None])[0], axis=pose.matrix @ surface.axis
    )


def moved_solid(solid: Solid, pose: Pose) -> Solid:
    """The solid after a pose."""
    turn = quaternion_to_matrix(pose.rotation)
    largest = float(np.abs(solid.vertices).max(initial=0.0) + np.abs(pose.position).max())
    return replace(
        solid,
        vertices=pose.apply(solid.vertices),
        surfaces=tuple(moved_surface(surface, pose) for surface in solid.surfaces),
        centroid=pose.apply(solid.centroid[None])[0],
        second_moment=turn @ solid.second_moment @ turn.T,
        accuracy=max(solid.accuracy, largest * 2.0**-52),
        holes=_moved_boxes(solid.holes, turn, pose.position),
    )


def _moved_boxes(boxes: Array, turn: Array, step: Array) -> Array:
    """Boxes, shape (n, 2, 3), around boxes after a turn and a step."""
    middle, half = boxes.mean(axis=1) @ turn.T + step, np.ptp(boxes, axis=1) / 2 @ np.abs(turn).T
    return np.stack([middle - half, middle + half], axis=1)


def scaled_solid(solid: Solid, factor: float) -> Solid:
    """The solid with every length times a factor above zero."""
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
