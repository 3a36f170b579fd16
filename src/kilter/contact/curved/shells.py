"""Cylinders in cylinders and cones in cones: faces unrolled about one axis."""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, across
from kilter.assembly.surfaces import CYLINDER
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import FULL_TURN, LEAST_ARC
from kilter.contact.curved.candidates import Forms
from kilter.contact.curved.contact_points import (
    AROUND,
    STEP,
    Spots,
    angles_between,
    shell,
    unrolled_overlap,
)
from kilter.contact.curved.coverage import TURN, Bands, bands_of, unrolled
from kilter.contact.curved.curved_patches import Found, Made, Pairs, keep
from kilter.contact.gaps import THIN, Rejected

__all__ = ["gaps_between", "touching_shells"]


def touching_shells(
    search: ContactSearch, made: Made, pairs: Pairs, forms: Forms, limit: Array
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
        x, y = (mine[k], other[k]) if solid == i else (other[k], mine[k])
        found = _shell(search, bands, (solid, hollow), (int(x), int(y)))
        if found is None:
            continue
        spots, (bottom, top) = found
        bound = float(limit[forms.row[k]])
        off = _off(search, solid, hollow, bottom, top)
        gap = gaps_between(search, solid, hollow, spots.points, off, bound)
        pair = int(pairs.pair[forms.row[k]])
        if top - bottom <= 2 * bound:
            a, b = (int(p) for p in search.pairs[pair])
            made.rejected.append(Rejected((a, b), gap[0], 0.0, THIN))
            continue
        zone = bound + float(np.ptp(spots.points, axis=0).max())
        found_here = Found(pair, (solid, hollow), gap, bound, spots, zone, turned)
        keep(search, made, found_here)


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


def _shell(
    search: ContactSearch, bands: Bands, names: tuple[int, int], at: tuple[int, int]
) -> tuple[Spots, tuple[float, float]] | None:
    """Points where two coaxial faces lie on each other, and between which heights."""
    s, (i, j), (x, y) = search.geometry.surfaces, names, at
    axis = s.axis[i]
    turn = 1.0 if float(axis @ s.axis[j]) > 0 else -1.0
    shift = float((s.point[j] - s.point[i]) @ axis)
    ends = sorted((shift + turn * float(bands.low[y]), shift + turn * float(bands.high[y])))
    bottom, top = max(float(bands.low[x]), ends[0]), min(float(bands.high[x]), ends[1])
    if top <= bottom:
        return None
    u, v = across(s.axis[[i, j]])
    zero = float(np.arctan2(u[1] @ v[0], u[1] @ u[0]))
    begin = zero + turn * float(bands.begin[y])
    begin = begin - float(bands.width[y]) if turn < 0 else begin
    arcs = _common_arcs(
        (float(bands.begin[x]), float(bands.width[x])), (begin, float(bands.width[y]))
    )
    if not arcs:
        return None
    cone = s.kind[i] != CYLINDER
    step = TURN / AROUND if cone else STEP
    radius = 0.0 if cone else float(s.radius[i] + s.radius[j]) / 2
    alpha = float(s.half_angle[i]) if cone else 0.0
    region, outer = _filled(arcs, step, bottom, top, cone)
    whole = bool(bands.whole[x] and bands.whole[y])
    width = sum(w for _, w in arcs)
    slant = (bottom + top) / 2 * np.tan(alpha) / np.cos(alpha)
    area = width * (top - bottom) * (radius + slant)
    if not whole:
        exact = _unfilled(search, names, zero, turn, shift, radius or abs(bottom) + abs(top))
        if exact is None:
            return None
        if not cone:
            outer = region
        angles, heights, size = exact
        region = angles, heights
        area = size * (radius + slant)
    given = outer if (cone or not whole) else None
    spots = shell(s.point[i], axis, alpha, radius, region, given)
    return _sized(spots, area), (bottom, top)


def _sized(spots: Spots, area: float) -> Spots:
    return Spots(spots.points, spots.normals, spots.outer_points, spots.outer_normals, area)


def _common_arcs(one: tuple[float, float], other: tuple[float, float]) -> list[tuple[float, float]]:
    """Arcs (begin, width) in both of two arcs."""
    if one[1] >= TURN - FULL_TURN:
        return [other]
    if other[1] >= TURN - FULL_TURN:
        return [one]
    found = []
    start = (other[0] - one[0]) % TURN
    for begin in (start - TURN, start):
        low, high = max(begin, 0.0), min(begin + other[1], one[1])
        if high > low + LEAST_ARC:
            found.append((one[0] + low, high - low))
    return found


def _filled(
    arcs: list[tuple[float, float]], step: float, bottom: float, top: float, cone: bool
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


def _unfilled(
    search: ContactSearch,
    names: tuple[int, int],
    zero: float,
    turn: float,
    shift: float,
    scale: float,
) -> tuple[Array, Array, float] | None:
    """Corners of the overlap of faces that are no whole bands, and its area."""
    owner, angle, height, tip = unrolled(search.geometry, np.array(names))
    angle[owner == 1] = zero + turn * angle[owner == 1]
    height[owner == 1] = shift + turn * height[owner == 1]
    if tip.any():
        angle, height, owner = _without_tips(angle, height, owner, tip)
    one, other = ((angle[owner == k], height[owner == k]) for k in (0, 1))
    angles, heights, area = unrolled_overlap(one, other, scale)
    if area <= 0:
        return None
    around = np.round(np.remainder(angles, TURN), 9)
    _, first, group = np.unique(around, return_index=True, return_inverse=True)
    low = np.full(len(first), np.inf)
    high = -low
    np.minimum.at(low, group.reshape(-1), heights)
    np.maximum.at(high, group.reshape(-1), heights)
    return np.tile(angles[first], 2), np.concatenate([low, high]), area


def _without_tips(
    angle: Array, height: Array, owner: Index, tip: Mask
) -> tuple[Array, Array, Index]:
    """Triangles at the apex of a cone as two, so that they fill their rectangle."""
    angle, height = angle.copy(), height.copy()
    rows = np.flatnonzero(tip)
    more_angle, more_height = [], []
    for row in rows:
        apex = int(np.abs(height[row]).argmin())
        p, q = (k for k in range(3) if k != apex)
        angle[row, apex] = angle[row, p]
        more_angle.append([angle[row, p], angle[row, q], angle[row, q]])
        more_height.append([height[row, apex], height[row, apex], height[row, q]])
    return (
        np.concatenate([angle, np.array(more_angle).reshape(-1, 3)]),
        np.concatenate([height, np.array(more_height).reshape(-1, 3)]),
        np.concatenate([owner, owner[rows]]),
    )


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
