"""Solid: a part bounded by exact faces (planes, cylinders, cones, spheres, tori), and Surface.

Its triangles are for pictures, for the broad phase and for the extent of each face: their
corners lie on the exact faces. Volume, centre and inertia are those of the exact solid.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kilter.errors import InputError
from kilter.rigid import frozen, number, unit

__all__ = ["Solid", "Surface", "SurfaceKind"]

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

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, (-1, 3)))
        for name, shape in (("triangles", (-1, 3)), ("triangle_surface", (-1,))):
            array = np.array(getattr(self, name), dtype=np.int64).reshape(shape)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        object.__setattr__(self, "surfaces", tuple(self.surfaces))
        object.__setattr__(self, "centroid", frozen(self.centroid, (3,)))
        object.__setattr__(self, "second_moment", frozen(self.second_moment, (3, 3)))
        volume = number(self.volume, "volume of a solid", lowest=0, above=True)
        object.__setattr__(self, "volume", volume)
        if len(self.triangle_surface) != len(self.triangles):
            raise InputError("a solid has not one surface a triangle", hint="list one a triangle")
        if len(self.triangle_surface) and (
            self.triangle_surface.max() >= len(self.surfaces) or self.triangle_surface.min() < -1
        ):
            raise InputError("a solid names a surface it has not", hint="name them by position")
