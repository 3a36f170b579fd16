"""Upright prisms: parts with a horizontal convex top, and the part that is put down on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry

__all__ = ["PlacedPrism", "Top", "edges_of", "find_tops", "placed_prism", "shifted", "swept"]

UPRIGHT = 1e-6
"""Largest relative difference of volume between an upright prism and a part [-]; a larger value
accepts parts whose sides lean."""


@dataclass(frozen=True, eq=False)
class Top:
    """The horizontal top of an upright prism of an assembly."""

    part: int
    polygon: shapely.Geometry
    """Convex, in the plane x, y."""
    low: float
    high: float
    """Heights of bottom and top [length unit]."""
    upright: bool
    """False for a part of another form: its bounding box stands for it, and nothing is known
    about places on it."""

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Normals and offsets of the edges of the polygon (`edges_of`)."""
        return edges_of(shapely.get_coordinates(self.polygon)[:-1])


@dataclass(frozen=True, eq=False)
class PlacedPrism:
    """The part that is put down: an upright convex prism."""

    footprint: Array
    """Corners of its underside, counterclockwise, relative to the centre of mass, shape (n, 2)."""
    below: float
    above: float
    """Distance of the centre of mass from the underside and from the top [length unit]."""
    mass: float
    """[kg]"""
    inertia: Array
    """About the centre of mass [kg x length unit^2], shape (3, 3)."""
    radius: float
    """Bounding radius [length unit]."""

    @property
    def height(self) -> float:
        """Height of the prism [length unit]."""
        return self.below + self.above

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Normals and offsets of the edges of the footprint, about the centre (`edges_of`)."""
        return edges_of(self.footprint)

    @property
    def size(self) -> float:
        """Larger extent of the footprint along x or y [length unit]."""
        return float(np.ptp(self.footprint, axis=0).max())


def find_tops(assembly: Assembly) -> list[Top]:
    """The top of each part; the vertical is the z axis."""
    return [_top(assembly.geometry, k) for k in range(len(assembly.parts))]


def _top(geometry: Geometry, k: int) -> Top:
    vertices = geometry.vertices[geometry.vertex_part == k]
    low, high = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    hull = shapely.convex_hull(shapely.multipoints(vertices[:, :2]))
    upright = _is_upright(vertices, hull.area, float(geometry.volume[k]))
    curved = geometry.surfaces.start[k + 1] > geometry.surfaces.start[k]
    return Top(k, hull, low, high, upright and not curved)


def _is_upright(vertices: Array, area: float, volume: float) -> bool:
    """Whether vertices and volume are those of an upright convex prism."""
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    size = max(float(np.ptp(vertices, axis=0).max()), 1e-300)
    ends = np.minimum(vertices[:, 2] - low, high - vertices[:, 2])
    if (ends > UPRIGHT * size).any():
        return False
    box = area * float(high - low)
    return bool(abs(volume - box) <= UPRIGHT * max(volume, box))


def placed_prism(assembly: Assembly) -> PlacedPrism | None:
    """The only part of an assembly as a prism to put down; None if it is no upright prism."""
    geometry = assembly.geometry
    top = _top(geometry, 0)
    if not top.upright:
        return None
    center = geometry.center[0]
    ring = shapely.normalize(shapely.Polygon(top.polygon)).exterior
    corners = np.array(ring.coords)[:-1] - center[:2]
    if not shapely.is_ccw(ring):
        corners = corners[::-1]
    return PlacedPrism(
        corners,
        float(center[2] - top.low),
        float(top.high - center[2]),
        float(geometry.mass[0]),
        geometry.inertia[0],
        float(geometry.radius[0]),
    )


def shifted(footprint: Array, place: Sequence[float]) -> shapely.Geometry:
    """The underside of the part with its centre at a place."""
    return shapely.polygons(footprint + np.asarray(place))


def swept(footprint: Array, low: Array, high: Array, *, union: bool) -> shapely.Geometry:
    """The points under the part for some place of a rectangle (`union`), or for each place.

    The part is convex, so the corners of the rectangle decide.
    """
    corners = [(u, v) for u in (low[0], high[0]) for v in (low[1], high[1])]
    if union:
        points = np.concatenate([footprint + corner for corner in corners])
        return shapely.convex_hull(shapely.multipoints(points))
    return shapely.intersection_all([shifted(footprint, corner) for corner in corners])


def edges_of(ring: Array) -> tuple[Array, Array]:
    """Outward unit normals A, shape (n, 2), and offsets b, shape (n,), of a convex polygon.

    Its corners, shape (n, 2), are in either order; the polygon is the set A p <= b.

    Examples
    --------
    >>> normals, offsets = edges_of(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]))
    >>> (normals[1] + 0.0).tolist(), float(offsets[1])
    ([1.0, 0.0], 2.0)
    """
    along = np.roll(ring, -1, axis=0) - ring
    length = np.linalg.norm(along, axis=1)
    ring, along = ring[length > 0], along[length > 0] / length[length > 0, None]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    offsets = np.einsum("ij,ij->i", normals, ring)
    inward = float((normals @ ring.mean(axis=0) - offsets).sum()) > 0
    return (-normals, -offsets) if inward else (normals, offsets)
