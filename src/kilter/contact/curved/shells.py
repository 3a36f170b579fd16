"""Contacts of coaxial cylinders or cones that fit into each other, by unrolled faces.

A clearance closes a shaft that is thinner than its hole: both are then treated as a single surface
of their mean radius, about the axis of the shaft, or of the hole if the shaft is held.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly.surfaces import CYLINDER, Surfaces
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import FULL_TURN
from kilter.contact.curved.candidates import Candidates
from kilter.contact.curved.coaxial_faces import SharedRegion, shared_region
from kilter.contact.curved.contact_points import AROUND, STEP, PatchPoints, angles_between, shell
from kilter.contact.curved.coverage import TURN, bands_of
from kilter.contact.curved.curved_patches import (
    CandidateLimits,
    CurvedPatch,
    PatchBuilder,
    SurfacePairs,
    classify,
)
from kilter.contact.gaps import THIN, RejectedPair
from kilter.rigid import quaternion_to_matrix, rotation_between

__all__ = ["gaps_between", "touching_shells"]


def touching_shells(
    search: ContactSearch,
    builder: PatchBuilder,
    pairs: SurfacePairs,
    candidates: Candidates,
    limits: CandidateLimits,
) -> None:
    """Add contacts of coaxial faces that fit into each other, such as shaft and bore.

    Each candidate is unrolled about the axis of its solid surface; regions shorter than twice the
    gap tolerance are rejected as too thin.
    """
    if not len(candidates.row):
        return
    surfaces = search.geometry.surfaces
    first, second = pairs.i[candidates.row], pairs.j[candidates.row]
    used, place = np.unique(np.concatenate([first, second]), return_inverse=True)
    bands = bands_of(search.geometry, used)
    band_i, band_j = place.reshape(2, -1)
    for k in range(len(candidates.row)):
        i, j = int(first[k]), int(second[k])
        turned = bool(pairs.turned[candidates.row[k]]) ^ bool(surfaces.hollow[i])
        solid, hollow = (i, j) if not surfaces.hollow[i] else (j, i)
        band_rows = (band_i[k], band_j[k]) if solid == i else (band_j[k], band_i[k])
        region = shared_region(
            search.geometry, bands, (solid, hollow), (int(band_rows[0]), int(band_rows[1]))
        )
        if region is None:
            continue
        pair, play = int(pairs.pair[candidates.row[k]]), float(candidates.play[k])
        bound, closed = limits.of(int(candidates.row[k]))
        held = search.geometry.grounded[surfaces.part[[solid, hollow]]]
        # a fit closes at the free part, so that its weight does not rotate it; else at the shaft
        moves = play > 0 and bool(held[0] and not held[1])
        spots = _region_points(surfaces, (solid, hollow), region, moves=moves)
        off = _axis_distance(search, solid, hollow, region.bottom, region.top)
        gap = gaps_between(search, solid, hollow, spots.points, bound if play > 0 else off, bound)
        if region.top - region.bottom <= 2 * bound:
            a, b = (int(p) for p in search.pairs[pair])
            builder.rejected.append(RejectedPair((a, b), gap[0], 0.0, THIN))
            continue
        zone = max(bound, play) + float(np.ptp(spots.points, axis=0).max())
        inside = _points_in_region(surfaces, (solid, hollow), region.inside)
        patch = CurvedPatch(pair, (solid, hollow), gap, bound, spots, zone, turned)
        classify(search, builder, replace(patch, closed=closed, play=play, inside=inside))


def _axis_distance(search: ContactSearch, i: int, j: int, bottom: float, top: float) -> float:
    """Least distance between the axes of two surfaces, between two heights on the first axis.

    In the length unit.
    """
    s = search.geometry.surfaces
    offsets = []
    for height in (bottom, top):
        center = s.point[i] + height * s.axis[i]
        delta = center - s.point[j]
        offsets.append(delta - (delta @ s.axis[j]) * s.axis[j])
    step = offsets[1] - offsets[0]
    share = float(np.clip(-(offsets[0] @ step) / max(float(step @ step), TINY), 0, 1))
    return float(np.linalg.norm(offsets[0] + share * step))


def _radius_and_angle(s: Surfaces, i: int, j: int) -> tuple[float, float]:
    """Mean radius of two cylinders (0 for cones), and half angle of a cone (0 for cylinders)."""
    if s.kind[i] == CYLINDER:
        return float(s.radius[i] + s.radius[j]) / 2, 0.0
    return 0.0, float(s.half_angle[i])


def _points_in_region(
    s: Surfaces, names: tuple[int, int], region: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Points and outward normals on surface i at given angles and heights about its axis.

    `names` holds the surfaces i and j.
    """
    (i, j), (angle, height) = names, region
    radius, alpha = _radius_and_angle(s, i, j)
    spots = shell(s.point[i], s.axis[i], alpha, radius, (angle, height), None)
    return spots.points, spots.normals


def _region_points(
    s: Surfaces, names: tuple[int, int], region: SharedRegion, *, moves: bool
) -> PatchPoints:
    """Contact points with normals on the region over which two coaxial surfaces lie together.

    If `moves`, the points are moved to the axis of the second surface.
    """
    i, j = names
    radius, alpha = _radius_and_angle(s, i, j)
    cone = s.kind[i] != CYLINDER
    step = TURN / AROUND if cone else STEP
    filled, outer = _arc_corners(region.arcs, step, region.bottom, region.top)
    whole = region.corners is None
    corners = filled if region.corners is None else region.corners
    # a whole band of a cylinder is exact; other regions need points around the true region
    outer_region = (outer if cone else filled) if (cone or not whole) else None
    spots = shell(s.point[i], s.axis[i], alpha, radius, corners, outer_region)
    # the area of a cone grows with its distance from the apex
    slant = (region.bottom + region.top) / 2 * np.tan(alpha) / np.cos(alpha)
    spots = replace(spots, area=region.area * (radius + slant))
    return _about_second(s, names, region, spots) if moves else spots


def _about_second(
    s: Surfaces, names: tuple[int, int], region: SharedRegion, spots: PatchPoints
) -> PatchPoints:
    """Move the contact points of a fit from the axis of the first surface to that of the second."""
    i, j = names
    axis, second_axis = s.axis[i], s.axis[j]
    second_axis = second_axis if float(axis @ second_axis) > 0 else -second_axis
    middle = s.point[i] + (region.bottom + region.top) / 2 * axis
    shift = s.point[j] - s.point[i]
    if s.kind[i] == CYLINDER:
        offset = middle - s.point[j]
        shift = -(offset - (offset @ second_axis) * second_axis)
    turn = quaternion_to_matrix(rotation_between(axis, second_axis))

    def moved(points: Array) -> Array:
        return np.asarray(middle + shift + (points - middle) @ turn.T)

    return PatchPoints(
        moved(spots.points), spots.normals @ turn.T,
        moved(spots.outer_points), spots.outer_normals @ turn.T, spots.area,
    )  # fmt: skip


def _arc_corners(
    arcs: list[tuple[float, float]], step: float, bottom: float, top: float
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Angles and heights of contact points at the ends of arcs, and of points between them.

    The auxiliary points span a cone of forces that contains the true one.
    """
    angles = [angles_between(begin, width, step) for begin, width in arcs]
    between = []
    for angle, (_, width) in zip(angles, arcs, strict=True):
        closed = np.append(angle, angle[0] + TURN) if width >= TURN - FULL_TURN else angle
        between.append((closed[1:] + closed[:-1]) / 2)
    inner, outer = (
        (np.tile(row, 2), np.repeat([bottom, top], len(row)))
        for row in (np.concatenate(angles), np.concatenate(between))
    )
    return inner, outer


def gaps_between(
    search: ContactSearch, i: int, j: int, points: Array, off: float, limit: float
) -> tuple[float, float]:
    """Least and greatest gap of two surfaces at the points half-way between them [length unit].

    Surfaces in their own counterparts touch all over only if their cores coincide. If the cores are
    farther apart (`off`) than the tolerance, the face penetrates on one side, and that depth is
    returned, or stands apart.
    """
    s = search.geometry.surfaces
    rows = np.ones(len(points), dtype=np.int64)
    gaps = s.distance(i * rows, points) + s.distance(j * rows, points)
    low, high = float(gaps.min()), float(gaps.max())
    if off <= limit:
        return low, high
    return (low, low) if low < -limit else (high, high)
