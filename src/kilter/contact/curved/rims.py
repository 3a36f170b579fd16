"""Round rims of flat faces, given as inscribed polygons.

The circumscribed polygon bounds the answer from the other side.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER, FREE, SPHERE, Surfaces
from kilter.contact.contact_set import PossibleContacts
from kilter.contact.contact_tolerances import RIM_LEVEL
from kilter.contact.patches import Patches

__all__ = ["Force", "coaxial_clear", "possible_forces", "rim_contacts", "rims_clear"]

Force = tuple[int, int, Array, Array]
"""Parts a and b, point, direction."""


def possible_forces(forces: list[Force], *, two_sided: bool) -> PossibleContacts:
    """Forces as arrays."""
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
    """Corners on a round rim that as a whole stays in front of a plane, shape (n,).

    A corner v of the rim of a cylinder or cone lies `off` in front of a plane with unit
    `normal` n; the lowest point of the circle about c, of radius rho, across the axis, by
    (v - c).n + rho |n across the axis| lower.
    """
    s = geometry.surfaces
    if not len(s):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex)
    _, rho, away = s.polar(surface, geometry.vertices[vertex])
    across = normal - np.einsum("ij,ij->i", normal, s.axis[surface])[:, None] * s.axis[surface]
    drop = rho * (np.einsum("ij,ij->i", away, normal) + np.linalg.norm(across, axis=1))
    clear: Mask = exact & (off - drop > tolerance)
    return clear


def _rims_at(geometry: Geometry, vertex: Index) -> tuple[Index, Mask]:
    """A curved surface that each corner lies on (-1: none), and whether it is an exact rim."""
    s = geometry.surfaces
    of = np.full(len(geometry.vertices), -1)
    round_ = np.flatnonzero(geometry.triangle_surface >= 0)
    of[geometry.triangles[round_]] = geometry.triangle_surface[round_, None]
    surface = of[vertex]
    exact = (surface >= 0) & np.isin(s.kind[surface], (CYLINDER, CONE)) & (s.doubt[surface] == 0)
    return surface, exact


def coaxial_clear(geometry: Geometry, vertex: Index, tolerance: Array) -> Mask:
    """Chords of rims of one axis whose true circles stay clear of each other, shape (n,).

    Circles about one axis, of radii r and s, a height h apart, are hypot(r - s, h) apart.

    Parameters
    ----------
    vertex : ndarray of int, shape (n, 2, 2)
        Both ends of the chord of part a, and of that of part b; of a corner, twice the corner.
    tolerance : ndarray, shape (n,)
    """
    s = geometry.surfaces
    if not len(s) or not len(vertex):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex.reshape(-1))
    surface = surface.reshape(-1, 2, 2)
    clear: Mask = exact.reshape(-1, 4).all(axis=1) & (surface[:, :, 0] == surface[:, :, 1]).all(
        axis=1
    )
    one, other = surface[:, :, 0].T
    axis, base = s.axis[one], s.point[one]
    clear &= np.linalg.norm(cross(axis, s.axis[other]), axis=1) <= RIM_LEVEL
    out = geometry.vertices[vertex] - base[:, None, None]
    height = np.einsum("nkei,ni->nke", out, axis)
    across = out - height[..., None] * axis[:, None, None]
    radius = np.linalg.norm(across, axis=3)
    aside = s.point[other] - base
    aside = aside - np.einsum("ni,ni->n", aside, axis)[:, None] * axis
    for value in (height, radius):  # each chord lies in one circle
        clear &= (np.ptp(value, axis=2) <= tolerance[:, None]).all(axis=1)
    apart = np.hypot(*(value[:, 0, 0] - value[:, 1, 0] for value in (height, radius)))
    clear &= apart - np.linalg.norm(aside, axis=1) > tolerance
    result: Mask = clear
    return result


def rim_contacts(geometry: Geometry, flat: Patches) -> PossibleContacts:
    """Corners of the circumscribed polygon where a flat patch ends at the rim of a round face."""
    s = geometry.surfaces
    forces: list[Force] = []
    round_part = np.diff(s.start) > 0
    for patch in np.flatnonzero(round_part[flat.parts].any(axis=1)):
        a, b = (int(k) for k in flat.parts[patch])
        corners, normal = flat.corners(int(patch)), flat.normal[patch]
        for part in (a, b):
            for surface in range(int(s.start[part]), int(s.start[part + 1])):
                rim = _rim(s, surface, normal, corners)
                if rim is None:
                    continue
                out, stretch = rim
                forces.extend(
                    (a, b, point + (stretch - 1) * away, normal)
                    for point, away in zip(corners, out, strict=True)
                    if away.any()
                )
    return possible_forces(forces, two_sided=False)


def _rim(s: Surfaces, surface: int, normal: Array, corners: Array) -> tuple[Array, float] | None:
    """From the centre of the rim to corners on it (else 0), and how far the circle reaches."""
    kind, axis, center = int(s.kind[surface]), s.axis[surface], s.point[surface]
    if kind == SPHERE:
        axis = normal
    if kind == FREE or s.hollow[surface] or abs(float(axis @ normal)) < 1 - RIM_LEVEL:
        return None
    height = float((corners[0] - center) @ axis)
    radius = _radius_at(s, surface, height)
    if radius is None:
        return None
    out = corners - center
    out = out - np.outer(out @ axis, axis)
    sagitta = min(float(s.sagitta[surface]), radius / 2)
    off = radius - np.linalg.norm(out, axis=1)
    rim = (off <= sagitta + RIM_LEVEL * radius) & (off >= -RIM_LEVEL * radius)
    if not rim.any() or sagitta <= 0:
        return None
    return np.where(rim[:, None], out, 0.0), radius / (radius - sagitta)


def _radius_at(s: Surfaces, surface: int, height: float) -> float | None:
    """Radius of the circle that a plane across the axis cuts out of a surface."""
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
