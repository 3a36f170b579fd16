"""Round rims of flat faces, which triangles replace by inscribed polygons.

The forces of the circumscribed polygon bound the answer from the other side.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER, FREE, SPHERE, Surfaces
from kilter.contact.contact_set import PossibleContacts
from kilter.contact.contact_tolerances import RIM_LEVEL
from kilter.contact.patches import Patches

__all__ = ["Force", "coaxial_clear", "possible_forces", "radius_at", "rim_contacts", "rims_clear"]

Force = tuple[int, int, Array, Array]
"""Parts a and b, point, and unit direction of a force."""


def possible_forces(forces: list[Force], *, two_sided: bool) -> PossibleContacts:
    """Convert a list of forces to `PossibleContacts` without friction."""
    count = len(forces)
    return PossibleContacts(
        part_a=np.array([a for a, _, _, _ in forces], dtype=np.int64),
        part_b=np.array([b for _, b, _, _ in forces], dtype=np.int64),
        points=np.array([point for _, _, point, _ in forces]).reshape(count, 3),
        normals=np.array([normal for _, _, _, normal in forces]).reshape(count, 3),
        two_sided=np.full(count, two_sided),
        mu=np.zeros(count),
        degenerate=np.full(count, -1),
    )


def rims_clear(
    geometry: Geometry, vertex: Index, normal: Array, off: Array, tolerance: Array
) -> Mask:
    """Mask of corners whose whole circle stays in front of a plane, shape (n,).

    A corner v of the rim of a cylinder or cone lies `off` in front of a plane with unit `normal` n.
    The lowest point of the rim, a circle about c with radius rho across the axis, is lower by (v -
    c).n + rho |n across the axis|.
    """
    s = geometry.surfaces
    if not len(s):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex)
    _, rho, away = s.polar(surface, geometry.vertices[vertex])
    normal_across = (
        normal - np.einsum("ij,ij->i", normal, s.axis[surface])[:, None] * s.axis[surface]
    )
    drop = rho * (np.einsum("ij,ij->i", away, normal) + np.linalg.norm(normal_across, axis=1))
    clear: Mask = exact & (off - drop > tolerance)
    return clear


def _rims_at(geometry: Geometry, vertex: Index) -> tuple[Index, Mask]:
    """Curved surface at each corner (-1: none), and mask of exact cylinders and cones."""
    s = geometry.surfaces
    surface_of_vertex = np.full(len(geometry.vertices), -1)
    curved_triangles = np.flatnonzero(geometry.triangle_surface >= 0)
    surface_of_vertex[geometry.triangles[curved_triangles]] = geometry.triangle_surface[
        curved_triangles, None
    ]
    surface = surface_of_vertex[vertex]
    exact = (surface >= 0) & np.isin(s.kind[surface], (CYLINDER, CONE)) & (s.doubt[surface] == 0)
    return surface, exact


def coaxial_clear(geometry: Geometry, vertex: Index, tolerance: Array) -> Mask:
    """Mask of coaxial rims whose true circles keep a distance from each other, shape (n,).

    Circles about the same axis, with radii r and s, a height h apart, have the distance hypot(r -
    s, h).

    Parameters
    ----------
    vertex : ndarray of int, shape (n, 2, 2)
        Both ends of the chord of part a, and of the chord of part b; twice the corner for a corner.
    tolerance : ndarray, shape (n,)
        Largest gap of touching rims [length unit].
    """
    s = geometry.surfaces
    if not len(s) or not len(vertex):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex.reshape(-1))
    surface = surface.reshape(-1, 2, 2)
    clear: Mask = exact.reshape(-1, 4).all(axis=1) & (surface[:, :, 0] == surface[:, :, 1]).all(
        axis=1
    )
    first, second = surface[:, :, 0].T
    axis, base = s.axis[first], s.point[first]
    clear &= np.linalg.norm(cross(axis, s.axis[second]), axis=1) <= RIM_LEVEL
    relative = geometry.vertices[vertex] - base[:, None, None]
    height = np.einsum("nkei,ni->nke", relative, axis)
    radial = relative - height[..., None] * axis[:, None, None]
    radius = np.linalg.norm(radial, axis=3)
    axis_offset = s.point[second] - base
    axis_offset = axis_offset - np.einsum("ni,ni->n", axis_offset, axis)[:, None] * axis
    for value in (height, radius):  # each chord must lie in a circle about the axis
        clear &= (np.ptp(value, axis=2) <= tolerance[:, None]).all(axis=1)
    apart = np.hypot(*(value[:, 0, 0] - value[:, 1, 0] for value in (height, radius)))
    clear &= apart - np.linalg.norm(axis_offset, axis=1) > tolerance
    result: Mask = clear
    return result


def rim_contacts(geometry: Geometry, flat: Patches) -> PossibleContacts:
    """Possible forces at the round rim of a flat patch, on a polygon that contains the rim.

    The contact area of a flat patch with a round rim is larger than the polygon of its corners.

    The corners of a patch on the rim are moved outwards, so that the polygon contains the circle.
    """
    s = geometry.surfaces
    forces: list[Force] = []
    is_round = np.diff(s.start) > 0
    for patch in np.flatnonzero(is_round[flat.parts].any(axis=1)):
        a, b = (int(k) for k in flat.parts[patch])
        corners, normal = flat.corners(int(patch)), flat.normal[patch]
        for part in (a, b):
            for surface in range(int(s.start[part]), int(s.start[part + 1])):
                rim = _rim(s, surface, normal, corners)
                if rim is None:
                    continue
                offsets, stretch = rim
                forces.extend(
                    (a, b, point + (stretch - 1) * offset, normal)
                    for point, offset in zip(corners, offsets, strict=True)
                    if offset.any()
                )
    return possible_forces(forces, two_sided=False)


def _rim(s: Surfaces, surface: int, normal: Array, corners: Array) -> tuple[Array, float] | None:
    """Radial vectors to the corners of a patch on a rim, and the factor that encloses the rim.

    Radii times this factor give a polygon that contains the circle.

    The vector is 0 for corners that are not on the rim; None if the surface has no rim in this
    plane.
    """
    kind, axis, center = int(s.kind[surface]), s.axis[surface], s.point[surface]
    if kind == SPHERE:
        axis = normal
    if kind == FREE or s.hollow[surface] or abs(float(axis @ normal)) < 1 - RIM_LEVEL:
        return None
    height = float((corners[0] - center) @ axis)
    radius = radius_at(s, surface, height)
    if radius is None:
        return None
    offsets = corners - center
    offsets = offsets - np.outer(offsets @ axis, axis)
    sagitta = min(float(s.sagitta[surface]), radius / 2)
    off = radius - np.linalg.norm(offsets, axis=1)
    on_rim = (off <= sagitta + RIM_LEVEL * radius) & (off >= -RIM_LEVEL * radius)
    if not on_rim.any() or sagitta <= 0:
        return None
    return np.where(on_rim[:, None], offsets, 0.0), radius / (radius - sagitta)


def radius_at(s: Surfaces, surface: int, height: float) -> float | None:
    """Radius of the circle in which a plane at `height` cuts a surface; None without a circle.

    The plane is perpendicular to the axis.
    """
    kind, radius = int(s.kind[surface]), float(s.radius[surface])
    if kind == CYLINDER:
        return radius
    if kind == CONE:
        cut = height * float(np.tan(s.half_angle[surface]))
    elif kind == SPHERE:
        cut = float(np.sqrt(max(radius**2 - height**2, 0.0)))
    else:
        tube = float(s.tube[surface])
        near = abs(height) <= tube * (1 + RIM_LEVEL)
        cut = radius + float(np.sqrt(max(tube**2 - height**2, 0.0))) if near else 0.0
    return cut if cut > 0 else None
