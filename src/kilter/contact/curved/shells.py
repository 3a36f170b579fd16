"""Cylinders in cylinders and cones in cones: faces unrolled about one axis.

A clearance closes a shaft that is thinner than its hole: the two are then taken for one surface
of their mean radius, about the axis of the shaft, or of the hole where the shaft is held.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly.surfaces import CYLINDER, Surfaces
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import FULL_TURN
from kilter.contact.curved.candidates import Forms
from kilter.contact.curved.coaxial_faces import SharedRegion, shared_region
from kilter.contact.curved.contact_points import AROUND, STEP, Spots, angles_between, shell
from kilter.contact.curved.coverage import TURN, bands_of
from kilter.contact.curved.curved_patches import Found, Limits, Made, Pairs, keep
from kilter.contact.gaps import THIN, Rejected
from kilter.rigid import quaternion_to_matrix, rotation_between

__all__ = ["gaps_between", "touching_shells"]


def touching_shells(
    search: ContactSearch, made: Made, pairs: Pairs, forms: Forms, limits: Limits
) -> None:
    """Surfaces in their own counterparts, unrolled about the axis of the solid one."""
    if not len(forms.row):
        return
    surfaces = search.geometry.surfaces
    first, second = pairs.i[forms.row], pairs.j[forms.row]
    used, place = np.unique(np.concatenate([first, second]), return_inverse=True)
    bands = bands_of(search.geometry, used)
    mine, other = place.reshape(2, -1)
    for k in range(len(forms.row)):
        i, j = int(first[k]), int(second[k])
        turned = bool(pairs.turned[forms.row[k]]) ^ bool(surfaces.hollow[i])
        solid, hollow = (i, j) if not surfaces.hollow[i] else (j, i)
        at = (mine[k], other[k]) if solid == i else (other[k], mine[k])
        region = shared_region(search.geometry, bands, (solid, hollow), (int(at[0]), int(at[1])))
        if region is None:
            continue
        pair, play = int(pairs.pair[forms.row[k]]), float(forms.play[k])
        bound, closed = limits.of(int(forms.row[k]))
        held = search.geometry.grounded[surfaces.part[[solid, hollow]]]
        moves = play > 0 and bool(held[0] and not held[1])
        spots = _spots(surfaces, (solid, hollow), region, moves=moves)
        off = _off(search, solid, hollow, region.bottom, region.top)
        gap = gaps_between(search, solid, hollow, spots.points, bound if play > 0 else off, bound)
        if region.top - region.bottom <= 2 * bound:
            a, b = (int(p) for p in search.pairs[pair])
            made.rejected.append(Rejected((a, b), gap[0], 0.0, THIN))
            continue
        zone = max(bound, play) + float(np.ptp(spots.points, axis=0).max())
        inside = _at(surfaces, (solid, hollow), region.inside)
        found = Found(pair, (solid, hollow), gap, bound, spots, zone, turned)
        keep(search, made, replace(found, closed=closed, play=play, inside=inside))


def _off(search: ContactSearch, i: int, j: int, bottom: float, top: float) -> float:
    """Least distance of the axis of j from that of i between two heights of i."""
    s = search.geometry.surfaces
    apart = []
    for height in (bottom, top):
        center = s.point[i] + height * s.axis[i]
        to = center - s.point[j]
        apart.append(to - (to @ s.axis[j]) * s.axis[j])
    step = apart[1] - apart[0]
    share = float(np.clip(-(apart[0] @ step) / max(float(step @ step), TINY), 0, 1))
    return float(np.linalg.norm(apart[0] + share * step))


def _sizes(s: Surfaces, i: int, j: int) -> tuple[float, float]:
    """The mean radius of two cylinders (0 of cones), the half angle of a cone (0: cylinder)."""
    if s.kind[i] == CYLINDER:
        return float(s.radius[i] + s.radius[j]) / 2, 0.0
    return 0.0, float(s.half_angle[i])


def _at(s: Surfaces, names: tuple[int, int], region: tuple[Array, Array]) -> tuple[Array, Array]:
    """Points and outward normals at angles and heights about the first of two surfaces."""
    (i, j), (angle, height) = names, region
    radius, alpha = _sizes(s, i, j)
    spots = shell(s.point[i], s.axis[i], alpha, radius, (angle, height), None)
    return spots.points, spots.normals


def _spots(s: Surfaces, names: tuple[int, int], region: SharedRegion, *, moves: bool) -> Spots:
    """Contact points of a region about the axis of the first surface; `moves`: of the second."""
    i, j = names
    radius, alpha = _sizes(s, i, j)
    cone = s.kind[i] != CYLINDER
    step = TURN / AROUND if cone else STEP
    filled, outer = _filled(region.arcs, step, region.bottom, region.top)
    whole = region.corners is None
    corners = filled if region.corners is None else region.corners
    given = (outer if cone else filled) if (cone or not whole) else None
    spots = shell(s.point[i], s.axis[i], alpha, radius, corners, given)
    slant = (region.bottom + region.top) / 2 * np.tan(alpha) / np.cos(alpha)
    spots = replace(spots, area=region.area * (radius + slant))
    return _about_second(s, names, region, spots) if moves else spots


def _about_second(s: Surfaces, names: tuple[int, int], region: SharedRegion, spots: Spots) -> Spots:
    """Points about the first axis moved with it to the second."""
    i, j = names
    axis, other = s.axis[i], s.axis[j]
    other = other if float(axis @ other) > 0 else -other
    middle = s.point[i] + (region.bottom + region.top) / 2 * axis
    shift = s.point[j] - s.point[i]
    if s.kind[i] == CYLINDER:
        apart = middle - s.point[j]
        shift = -(apart - (apart @ other) * other)
    turn = quaternion_to_matrix(rotation_between(axis, other))

    def moved(points: Array) -> Array:
        return np.asarray(middle + shift + (points - middle) @ turn.T)

    return Spots(
        moved(spots.points), spots.normals @ turn.T,
        moved(spots.outer_points), spots.outer_normals @ turn.T, spots.area,
    )  # fmt: skip


def _filled(
    arcs: list[tuple[float, float]], step: float, bottom: float, top: float
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Angles and heights at both ends of arcs, and those of outer rows between."""
    angles = [angles_between(begin, width, step) for begin, width in arcs]
    between = []
    for angle, (_, width) in zip(angles, arcs, strict=True):
        closed = np.append(angle, angle[0] + TURN) if width >= TURN - FULL_TURN else angle
        between.append((closed[1:] + closed[:-1]) / 2)
    made = []
    for some in (np.concatenate(angles), np.concatenate(between)):
        made.append((np.tile(some, 2), np.repeat([bottom, top], len(some))))
    return made[0], made[1]


def gaps_between(
    search: ContactSearch, i: int, j: int, points: Array, off: float, limit: float
) -> tuple[float, float]:
    """Range of the gap between surfaces i and j at points half-way between them.

    Surfaces in their own counterparts touch all over only where their cores are one; where
    they are farther apart (`off`) than the tolerance, the face is in the way on one side
    (that depth is given) or away from it.
    """
    s = search.geometry.surfaces
    rows = np.ones(len(points), dtype=np.int64)
    gaps = s.distance(i * rows, points) + s.distance(j * rows, points)
    low, high = float(gaps.min()), float(gaps.max())
    if off <= limit:
        return low, high
    return (low, low) if low < -limit else (high, high)
