"""Rates of vertices, mass and centre of mass by the sizes of a part.

Boxes have the sizes x, y and z, which grow to both sides of the centre; cylinders a radius and a
height, prisms a depth, spheres a radius. A given mass or centre of mass stays.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly import Assembly, Part
from kilter.assembly.geometry import Geometry
from kilter.shape.primitives import Box, Cylinder, Prism, Sphere


def size_names(part: Part) -> tuple[str, ...]:
    """Names of the sizes of a part by which a limit has derivatives."""
    kinds = {Box: ("x", "y", "z"), Cylinder: ("radius", "height"), Prism: ("depth",)}
    kinds[Sphere] = ("radius",)
    return kinds.get(type(part.shape), ())


def _stretch(part: Part, size: str) -> tuple[Array, float]:
    """Mask of the own axes that a size stretches, shape (3,), and the value of the size."""
    shape = part.shape
    if isinstance(shape, Box):
        axis = "xyz".index(size)
        return np.eye(3)[axis], float(shape.size[axis])
    if isinstance(shape, Prism):
        return np.array([0.0, 1.0, 0.0]), shape.depth
    if isinstance(shape, Sphere):
        return np.ones(3), shape.radius
    assert isinstance(shape, Cylinder)
    if size == "radius":
        return np.array([1.0, 1.0, 0.0]), shape.radius
    return np.array([0.0, 0.0, 1.0]), shape.height


def size_rates(assembly: Assembly, number: int, size: str) -> tuple[Array, Array, float]:
    """Rates per unit of a size: of the part's vertices, (V, 3), of its centre, (3,), of its mass.

    Units: [-], [-], [kg/length unit].
    """
    part, geometry = assembly.parts[number], assembly.geometry
    mask, value = _stretch(part, size)
    turn, origin = part.pose.matrix, np.asarray(part.pose.position)
    growth = turn @ np.diag(mask / value) @ turn.T
    own = slice(geometry.vertex_start[number], geometry.vertex_start[number + 1])
    moved = (geometry.vertices[own] - origin) @ growth.T
    center = np.zeros(3)
    if part.center_of_mass is None:
        center = growth @ (geometry.center[number] - origin)
    mass = 0.0 if part.given_mass is not None else part.mass * float(mask.sum()) / value
    return moved, center, mass


def vertex_gradient(
    geometry: Geometry, part: Part, number: int, by_mass: float, by_center: Array
) -> Array:
    """Derivative by each vertex, through mass and centre of mass, shape (V, 3).

    Arguments: derivatives by the mass, and by the centre, (3,). A given mass or centre stays.
    """
    start, end = geometry.vertex_start[number : number + 2]
    center, volume = geometry.center[number], float(geometry.volume[number])
    span = slice(geometry.triangle_start[number], geometry.triangle_start[number + 1])
    triangles = geometry.triangles[span] - start
    corners = geometry.vertices[start:end][triangles] - center
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    volumes = np.einsum("ij,ij->i", a, cross(b, c)) / 6
    density = 0.0 if part.given_mass is not None else part.mass / volume
    pull = np.zeros(3) if part.center_of_mass is not None else by_center
    middle = corners.sum(axis=1) / 4
    by_volume = by_mass * density + middle @ pull / volume
    total = np.zeros((end - start, 3))
    for k, (first, second) in enumerate(((b, c), (c, a), (a, b))):
        np.add.at(total, triangles[:, k], by_volume[:, None] * cross(first, second) / 6)
        np.add.at(total, triangles[:, k], np.outer(volumes, pull) / (4 * volume))
    return total
