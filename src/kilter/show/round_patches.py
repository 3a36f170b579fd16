"""Contact patches on round faces, drawn as rings with surfaces between them.

The contact points of a cylinder or cone lie on circles about a common axis a, and their normals
have a constant inclination, n.a = const. With m the normalised component of n across the axis, a
circle has

    R = (x - y).(m_x - m_y) / |m_x - m_y|^2        centre x - R m_x, for any two of its points

It is drawn through its points. The widest gap between neighbours stays open if it exceeds `OPEN`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array, Index

if TYPE_CHECKING:
    from kilter.contact import ContactSet


OPEN = np.radians(125.0)
"""Angle between neighbouring points on a circle above which no contact is drawn between them [rad].
"""
FINE = np.radians(7.5)
"""Angle between the drawn points of an arc [rad]."""
ALIKE = 1e-3
"""Tolerance for equal normals [-], and for equal heights along the axis [size of the patch]."""


@dataclass(frozen=True, slots=True, eq=False)
class RoundPatches:
    """Rings along all contact patches on round faces, as arrays to draw.

    `points` (M, 3); `patch` (M,), the patch of each point; `lines` (L, 2) and `triangles` (T, 3),
    indices of points.
    """

    points: Array
    patch: Index
    lines: Index
    triangles: Index


def round_patches(contacts: ContactSet) -> RoundPatches:
    """Rings and surfaces of all contact patches on round faces.

    Patches whose points are on no circle are left out.
    """
    points, patch, lines, triangles = [np.zeros((0, 3))], [], [np.zeros((0, 2), int)], []
    count = 0
    starts = contacts.patch_start
    leans = np.linalg.norm(
        contacts.normals - np.repeat(contacts.patch_normal, np.diff(starts), axis=0), axis=1
    )
    owner = np.repeat(np.arange(len(contacts)), np.diff(starts))
    for p in np.unique(owner[leans > ALIKE]).tolist():
        start, end = starts[p], starts[p + 1]
        rings = _rings(contacts.points[start:end], contacts.normals[start:end])
        for k, ring in enumerate(rings):
            row = np.arange(count, count + len(ring))
            lines.append(np.column_stack([row[:-1], row[1:]]))
            if k and len(rings[k - 1]) == len(ring):
                before = row - len(ring)
                triangles.append(np.column_stack([before[:-1], before[1:], row[1:]]))
                triangles.append(np.column_stack([before[:-1], row[1:], row[:-1]]))
                # the straight sides of a patch that is not closed around the axis
                lines.append(np.array([[before[0], row[0]], [before[-1], row[-1]]]))
            points.append(ring)
            patch += [p] * len(ring)
            count += len(ring)
    return RoundPatches(
        np.concatenate(points),
        np.array(patch, dtype=np.int64),
        np.concatenate(lines),
        np.concatenate(triangles) if triangles else np.zeros((0, 3), dtype=np.int64),
    )


def _rings(points: Array, normals: Array) -> list[Array]:
    """Polygons along the circles of a round patch, from one end of its axis to the other.

    Returns an empty list if the patch is not round: fewer than three points, normals of varying
    inclination, or points off their circle.

    Examples
    --------
    >>> angle = np.radians([0, 90, 180, 270])
    >>> around = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    >>> [ring] = _rings(2 * around, around)
    >>> bool(np.allclose(np.linalg.norm(ring, axis=1), 2)), len(ring)
    (True, 49)
    >>> _rings(2 * around, np.eye(3)[[2, 2, 2, 2]])
    []
    """
    if len(points) < 3:
        return []
    _, spread, axes = np.linalg.svd(normals - normals.mean(axis=0))
    axis = axes[2]
    if spread[1] < ALIKE or spread[2] > ALIKE:
        return []
    across = normals - np.outer(normals @ axis, axis)
    size = np.linalg.norm(across, axis=1)
    if size.min() < ALIKE:
        return []
    across = across / size[:, None]
    angle = np.arctan2(across @ axes[1], across @ axes[0])
    height = (points - points.mean(axis=0)) @ axis
    order = np.argsort(height, kind="stable")
    steps = np.diff(height[order]) > ALIKE * float(np.ptp(points, axis=0).max())
    groups = np.split(order, np.flatnonzero(steps) + 1)
    rings = [_ring(points[g], across[g], angle[g], axes) for g in groups]
    return [] if any(ring is None for ring in rings) else [r for r in rings if r is not None]


def _ring(points: Array, across: Array, angle: Array, axes: Array) -> Array | None:
    """Polygon along a circle, shape (k, 3); None if the points lie on no common circle.

    `across`: unit normals across the axis; `angle`: angles of the points about it [rad]; `axes`:
    the two directions across the axis, and the axis.
    """
    order = np.argsort(angle, kind="stable")
    points, across, angle = points[order], across[order], angle[order]
    gaps = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    apart = across - across[0]
    far = int(np.linalg.norm(apart, axis=1).argmax())
    if np.linalg.norm(apart[far]) < ALIKE:
        return None
    radius = float((points[far] - points[0]) @ apart[far] / (apart[far] @ apart[far]))
    center = points[0] - radius * across[0]
    if np.abs(center + radius * across - points).max() > 10 * ALIKE * abs(radius):
        return None
    widest = int(gaps.argmax())
    closed = gaps[widest] <= OPEN
    first = 0 if closed else (widest + 1) % len(angle)
    sweep = 2 * np.pi if closed else 2 * np.pi - gaps[widest]
    steps = max(round(sweep / FINE), 1)
    drawn = angle[first] + np.linspace(0.0, sweep, steps + 1)
    return np.asarray(
        center + radius * (np.outer(np.cos(drawn), axes[0]) + np.outer(np.sin(drawn), axes[1]))
    )
