"""Exact solids of revolution about z, with profiles of lines and arcs.

If the profile is traversed with the material on its left, Gauss's theorem gives

    volume = pi int rho^2 dz,             int z dV = pi int z rho^2 dz,
    int z^2 dV = pi int z^2 rho^2 dz,     int x^2 dV = pi / 4 int rho^4 dz,

Each integral uses Gauss-Legendre nodes on every line or arc and is exact to rounding.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index
from kilter.assembly import Part
from kilter.rigid import Pose
from kilter.shape.solid import Solid, Surface

NODES = 40
"""Nodes of the quadrature on a line or arc."""
SIDES, CUTS = 48, 12
"""Number of triangles around the axis, and along an arc."""


def turned_part(
    name: str, profile: Sequence[Sequence[float]], at: ArrayLike = (0, 0, 0), **properties: Any
) -> Part:
    """A part with the faces of revolution of a profile about z.

    Parameters
    ----------
    name : str
    profile : sequence
        Points (rho, z) [length unit] with the material on the left: outwards on the lower side,
        upwards on the outer side. A point ``(rho, z, q, h)`` ends an arc of less than 180 degrees
        about (q, h). The profile begins and ends on the axis, or is closed.
    at : array_like, shape (3,)
        Position of the origin [length unit].

    Examples
    --------
    >>> dome = turned_part("dome", [(0, 0), (1, 1, 0, 1), (0, 1)]).shape
    >>> round(dome.volume / np.pi, 12), round(float(dome.centroid[2]), 12)  # 2/3, 5/8
    (0.666666666667, 0.625)
    """
    points = [np.array(profile[0][:2], dtype=float)]
    surfaces, labels, moments = [], [], np.zeros(4)
    for k, step in enumerate(profile[1:]):
        start, end = points[-1], np.array(step[:2], dtype=float)
        center = np.array(step[2:], dtype=float) if len(step) > 2 else None
        moments += _moments(start, end, center)
        surfaces.append(_surface(start, end, center))
        share = np.linspace(0, 1, 1 + (1 if center is None else CUTS))[1:]
        points += [*_curve(start, end, center, share)[0][:-1], end]
        labels += [k] * len(share)
    volume, first, upright, across = moments
    middle = first / volume
    upright -= volume * middle**2
    vertices, triangles, label = _triangulate(np.array(points), np.array(labels))
    bulge = _bulge(np.array(points), [step[2:] for step in profile[1:]])
    solid = Solid(
        vertices, triangles, tuple(surfaces), label, volume, [0, 0, middle],
        np.diag([across, across, upright]), sagitta=bulge,
    )  # fmt: skip
    return Part(name, solid, Pose(at), **properties)


def _curve(start: Array, end: Array, center: Array | None, share: Array) -> tuple[Array, Array]:
    """Points of a line or an arc at shares (n,) of its length, and their derivatives, (n, 2)."""
    if center is None:
        return start + share[:, None] * (end - start), np.tile(end - start, (len(share), 1))
    radius = float(np.linalg.norm(start - center))
    first, last = (float(np.arctan2(*(p - center)[::-1])) for p in (start, end))
    sweep = (last - first + np.pi) % (2 * np.pi) - np.pi
    angle = first + share * sweep
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    along = sweep * radius * np.column_stack([-out[:, 1], out[:, 0]])
    return center + radius * out, along


def _moments(start: Array, end: Array, center: Array | None) -> Array:
    """Contributions of a line or an arc to the volume and to int z, int z^2, int x^2 dV."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    (rho, z), (_, rise) = (rows.T for rows in _curve(start, end, center, (node + 1) / 2))
    each = np.stack([rho**2, z * rho**2, z**2 * rho**2, rho**4 / 4])
    result: Array = np.pi / 2 * each @ (rise * weight)
    return result


def _surface(start: Array, end: Array, center: Array | None) -> Surface:
    """The exact surface of revolution of a line or an arc."""
    out, up = end - start
    upwards = np.array([0.0, 0.0, 1.0])
    if center is not None:
        at, along = _curve(start, end, center, np.array([0.5]))
        apart = at[0] - center
        hollow = bool(along[0, 0] * apart[1] > along[0, 1] * apart[0])
        radius = float(np.linalg.norm(start - center))
        place = [0.0, 0.0, center[1]]
        if center[0] == 0:
            return Surface("sphere", place, radius=radius, hollow=hollow)
        return Surface("torus", place, upwards, float(center[0]), radius, hollow=hollow)
    if up == 0:
        return Surface("plane", [0.0, 0.0, start[1]], -np.sign(out) * upwards)
    if out == 0:
        place = [0.0, 0.0, start[1]]
        return Surface("cylinder", place, upwards, radius=float(start[0]), hollow=bool(up < 0))
    apex = [0.0, 0.0, start[1] - start[0] * up / out]
    half = float(np.arctan(abs(out / up)))
    return Surface("cone", apex, np.sign(up / out) * upwards, half_angle=half, hollow=bool(up < 0))


def _triangulate(points: Array, labels: Index) -> tuple[Array, Index, Index]:
    """Vertices, triangles (counterclockwise seen from outside), and the face of each triangle."""
    closed = bool((points[0] == points[-1]).all())
    rings = points[:-1] if closed else points
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    place: list[Index] = []
    corners: list[Array] = []
    for rho, z in rings:
        place.append(len(corners) + np.arange(SIDES) * (rho > 0))
        here = np.column_stack([rho * np.cos(angle), rho * np.sin(angle), np.full(SIDES, z)])
        corners += [*(here if rho > 0 else here[:1])]
    triangles, label = [], []
    for k, face in enumerate(labels):
        low, high = place[k], place[(k + 1) % len(place)]
        along = np.roll(low, -1), np.roll(high, -1)
        if rings[k][0] > 0:
            triangles += [*np.column_stack([low, along[0], high])]
            label += [face] * SIDES
        if rings[(k + 1) % len(place)][0] > 0:
            triangles += [*np.column_stack([along[0], along[1], high])]
            label += [face] * SIDES
    return np.array(corners), np.array(triangles), np.array(label)


def _bulge(points: Array, arcs: Sequence[Sequence[float]]) -> float:
    """Largest distance of the exact faces from the triangles [length unit]."""
    around = float(points[:, 0].max()) * (1 - np.cos(np.pi / SIDES))
    radii = [np.linalg.norm(points - np.array(arc), axis=1).max() for arc in arcs if len(arc)]
    return float(around + max(radii, default=0.0) * (1 - np.cos(np.pi / (2 * CUTS))))
