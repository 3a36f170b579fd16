"""Faces about a common axis: the region that two of them share, and shafts in holes.

Cylinders and cones are unrolled about the axis of the first: an angle and a height give the
position of a point. Faces on the same axis have no common region, whatever their radii, if they lie
beside each other around it or above each other along it.

Parts of the same volume, radius and inertia (by its trace) count as copies. Bolts that all overlap
their nuts are modelled so; if only one of two feet overlaps, it is misplaced.

A shaft and its hole share an axis; their radii determine the fit. The shaft is thicker
(interference: a press fit, or a thread drawn as a cylinder), equally thick within the gap tolerance
(size on size), or thinner (a clearance, which holds nothing).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    across,
    columns,
    cross,
    extents,
    lengths,
    ragged,
    ratio,
)
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER
from kilter.contact.common.gaps import Tolerance
from kilter.contact.common.patches import Overlap, PairRecord
from kilter.contact.contact_tolerances import (
    ANGLE,
    FIT_LENGTH,
    FULL_TURN,
    INTERFERENCE,
    LEAST_ARC,
    SAME_SHAPE,
)
from kilter.contact.curved.contact_points import TURN, Bands, bands_of, unrolled, unrolled_overlap
from kilter.tell.record import InPython, Vector, key

BLOCK = 1_000_000
"""Number of pairs of a shaft and a hole that are compared at once."""
SHARES = (0.19, 0.5, 0.83)
"""Fractions of arcs and heights at which a region is sampled [-]; chosen off the usual borders of
triangles."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedRegion:
    """The region over which two coaxial faces touch, by angle and height about the first axis."""

    arcs: list[tuple[float, float]]
    """Arcs around the axis [rad]."""
    bottom: float
    top: float
    """Heights above the point of the first surface [length unit]."""
    corners: tuple[Array, Array] | None
    """Corners of the common part, if a face is not a whole band; `arcs` then contains the common
    part. Every angle occurs twice, with its least and its greatest height."""
    area: float
    """Area in angle and height [rad x length unit]."""

    @property
    def inside(self) -> tuple[Array, Array]:
        """Angles [rad] and heights of sample points inside the region, shape (n,) each."""
        share = np.array(SHARES)
        if self.corners is None:  # whole bands: the arcs are the region
            angle = np.concatenate([begin + width * share for begin, width in self.arcs])
            height = self.bottom + (self.top - self.bottom) * share
            return np.repeat(angle, len(height)), np.tile(height, len(angle))
        angle, low, high = self.corners[0], *np.split(self.corners[1], 2)
        half = len(angle) // 2
        return angle[:half], (low + high) / 2


def shared_region(
    geometry: Geometry, bands: Bands, surfaces: tuple[int, int], band_rows: tuple[int, int]
) -> SharedRegion | None:
    """The region over which two coaxial surfaces lie on each other; None if they do not.

    `surfaces`: rows of the two surfaces; their axes coincide except for a small rotation.
    `band_rows`: rows of the two surfaces in `bands`.
    """
    s, (i, j), (x, y) = geometry.surfaces, surfaces, band_rows
    axis = s.axis[i]
    sense = 1.0 if float(axis @ s.axis[j]) > 0 else -1.0
    height_offset = float((s.point[j] - s.point[i]) @ axis)
    ends = sorted(
        (height_offset + sense * float(bands.low[y]), height_offset + sense * float(bands.high[y]))
    )
    bottom, top = max(float(bands.low[x]), ends[0]), min(float(bands.high[x]), ends[1])
    if top <= bottom:
        return None
    u, v = across(s.axis[[i, j]])
    # angle of the second surface's zero direction in the frame of the first
    angle_offset = float(np.arctan2(u[1] @ v[0], u[1] @ u[0]))
    begin = angle_offset + sense * float(bands.begin[y])
    # an opposite axis reverses the direction of angles, so the arc ends where it began
    begin = begin - float(bands.width[y]) if sense < 0 else begin
    arcs = _common_arcs(
        (float(bands.begin[x]), float(bands.width[x])), (begin, float(bands.width[y]))
    )
    if not arcs:
        return None
    if bands.whole[x] and bands.whole[y]:
        area = sum(width for _, width in arcs) * (top - bottom)
        return SharedRegion(arcs, bottom, top, None, area)
    scale = float(max(s.radius[[i, j]].max(), 0.0)) or abs(bottom) + abs(top)
    overlap = _partial_overlap(geometry, surfaces, angle_offset, sense, height_offset, scale)
    if overlap is None:
        return None
    angles, heights, area, filled = overlap
    if filled:  # one set of points, however both faces are meshed
        return SharedRegion(arcs, float(heights.min()), float(heights.max()), None, area)
    return SharedRegion(arcs, bottom, top, (angles, heights), area)


def _common_arcs(
    first: tuple[float, float], second: tuple[float, float]
) -> list[tuple[float, float]]:
    """Arcs (begin, width) that belong to both of two given arcs [rad]."""
    if first[1] >= TURN - FULL_TURN:
        return [second]
    if second[1] >= TURN - FULL_TURN:
        return [first]
    arcs = []
    start = (second[0] - first[0]) % TURN
    # the second arc may meet the first at both of its ends
    for begin in (start - TURN, start):
        low, high = max(begin, 0.0), min(begin + second[1], first[1])
        if high > low + LEAST_ARC:
            arcs.append((first[0] + low, high - low))
    return arcs


def _partial_overlap(
    geometry: Geometry,
    surfaces: tuple[int, int],
    angle_offset: float,
    sense: float,
    height_offset: float,
    scale: float,
) -> tuple[Array, Array, float, bool] | None:
    """Overlap of two coaxial faces with irregular outlines: angles, heights, area, form; or None.

    Angles are in rad. A face is no whole band about the axis, and yet the overlap may be one.

    Angles and heights of the second surface are transformed to the frame of the first by `sense`,
    `angle_offset` and `height_offset`. None if there is no overlap.
    """
    owner, angle, height, tip = unrolled(geometry, np.array(surfaces))
    angle[owner == 1] = angle_offset + sense * angle[owner == 1]
    height[owner == 1] = height_offset + sense * height[owner == 1]
    if tip.any():
        angle, height, owner = _without_tips(angle, height, owner, tip)
    first, second = ((angle[owner == k], height[owner == k]) for k in (0, 1))
    angles, heights, area, filled = unrolled_overlap(first, second, scale)
    if area <= 0:
        return None
    reduced = np.round(np.remainder(angles, TURN), 9)
    _, representative, group = np.unique(reduced, return_index=True, return_inverse=True)
    low = np.full(len(representative), np.inf)
    high = -low
    np.minimum.at(low, group.reshape(-1), heights)
    np.maximum.at(high, group.reshape(-1), heights)
    return np.tile(angles[representative], 2), np.concatenate([low, high]), area, filled


def _without_tips(
    angle: Array, height: Array, owner: Index, tip: Mask
) -> tuple[Array, Array, Index]:
    """Triangles in angle and height; a triangle at the apex of a cone becomes a rectangle.

    A triangle at the apex covers a rectangle of angle and height, which takes two triangles.

    The angle of the apex is undefined: unrolled, the apex is a whole side of the rectangle.
    """
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


def odd_copies(
    geometry: Geometry, overlaps: Sequence[Overlap], tested: Iterable[Overlap]
) -> list[tuple[int, list[int], int]]:
    """Parts that overlap others although an identical part elsewhere overlaps nothing.

    `overlaps`: all overlaps of the assembly. `tested`: overlaps whose parts are tested.
    Returns (part, overlapped parts, copy) by position.
    """
    overlapped: dict[int, list[int]] = {}
    for overlap in tested:
        for part, partner in (overlap.ends, overlap.ends[::-1]):
            overlapped.setdefault(part, []).append(partner)
    if not overlapped:
        return []
    is_clear = np.ones(len(geometry.mass), dtype=bool)
    is_clear[[part for overlap in overlaps for part in overlap.ends]] = False
    gyration_squared = ratio(np.trace(geometry.inertia, axis1=1, axis2=2), geometry.mass)
    shape = np.column_stack([np.abs(geometry.volume), geometry.radius**3, gyration_squared**1.5])
    odd = []
    for part in sorted(overlapped):
        alike = np.abs(shape - shape[part]) <= SAME_SHAPE * shape[part]
        copies = np.flatnonzero(is_clear & alike.all(axis=1))
        if len(copies):
            odd.append((part, sorted(overlapped[part]), int(copies[0])))
    return odd


class Fit(PairRecord, kw_only=False):
    """A shaft of the first part in a hole of the second part, about the same axis; world frame."""

    point: Vector
    """Middle of the fit [length unit]."""
    axis: Vector
    """Unit axis."""
    radius: float
    """Radius of the shaft [length unit]."""
    interference: InPython[float]
    """Radius of the shaft minus that of the hole [length unit]; negative: a clearance."""
    length: float
    """Length along the axis [length unit]."""
    doubt: InPython[float]
    """Largest interference that the gap tolerance explains [length unit]."""

    @property
    def tight(self) -> bool:
        """Whether the shaft is thicker than its hole by more than the gap tolerance."""
        return self.interference > self.doubt

    @property
    @key
    def clearance(self) -> float:
        """Radius of the hole minus that of the shaft [length unit]."""
        return -self.interference

    @property
    @key
    def fit(self) -> Literal["interference", "clearance", "size on size"]:
        """Kind of the fit."""
        if self.tight:
            return "interference"
        return "clearance" if self.interference < -self.doubt else "size on size"


@dataclass(frozen=True, slots=True, eq=False)
class _Cylinders(Rows):
    """Cylindrical faces, solid or hollow, each from `low` to `high` along its axis; by part."""

    row: Index
    part: Index
    point: Array = columns(3)
    axis: Array = columns(3)
    radius: Array = columns()
    hollow: Mask = columns()
    doubt: Array = columns()
    low: Array = columns()
    high: Array = columns()

    def beside(self, ends: Index) -> tuple[Index, Index, Index]:
        """Every solid face of the first beside every hollow face of the second of two parts.

        `ends`, shape (n, 2). Returns the row of `ends`, and the two rows of faces.
        """
        of_solid, of_hollow = (np.flatnonzero(self.hollow == hollow) for hollow in (False, True))
        parts = np.arange(ends.max() + 2)
        pair, i = ragged(np.searchsorted(self.part[of_solid], parts), ends[:, 0])
        face, j = ragged(np.searchsorted(self.part[of_hollow], parts), ends[pair, 1])
        return pair[face], of_solid[i[face]], of_hollow[j]

    def blocks(self, ends: Index) -> list[Index]:
        """Divide pairs of parts, shape (n, 2), into blocks of at most about `BLOCK` rows."""
        solid, hollow = (
            np.bincount(self.part[self.hollow == side], minlength=ends.max() + 1)
            for side in (False, True)
        )
        block = np.cumsum(solid[ends[:, 0]] * hollow[ends[:, 1]]) // BLOCK
        return np.split(ends, np.flatnonzero(np.diff(block)) + 1)


def coaxial_fits(
    assembly: Assembly,
    pairs: Iterable[tuple[int, int]],
    tolerance: Tolerance,
    *,
    thickest: float = INTERFERENCE,
    thinnest: float = 0.0,
) -> list[Fit]:
    """Find shafts in holes among pairs of parts, if they are about equally thick.

    `tolerance`: tolerance of the gap, the clearance and the angle. `thickest`: largest
    interference, as a fraction of the radius of the shaft [-].
    """
    geometry, surfaces = assembly.geometry, assembly.geometry.surfaces
    rounds = set(surfaces.part[surfaces.kind == CYLINDER].tolist())
    candidates = {(int(min(pair)), int(max(pair))) for pair in pairs if rounds.issuperset(pair)}
    if not candidates:
        return []
    both = np.array([ends for a, b in sorted(candidates) for ends in ((a, b), (b, a))])
    cylinders = _cylinders_of(geometry, np.unique(both))
    result: list[Fit] = []
    for ends in cylinders.blocks(both):
        result += _fits_of(geometry, cylinders, ends, tolerance, (thickest, thinnest))
    return result


def is_tube(assembly: Assembly, fit: Fit) -> bool:
    """Whether the shaft of a fit is hollow: it has a thinner bore about the same axis."""
    bores = _cylinders_of(assembly.geometry, np.array([fit.ends[0]]))
    apart = bores.point - fit.point
    offset = lengths(apart - np.outer(apart @ fit.axis, fit.axis))
    sine = lengths(cross(bores.axis, fit.axis[None]))
    is_bore = bores.hollow & (bores.radius < fit.radius)
    return bool((is_bore & (np.maximum(offset / fit.radius, sine) < ANGLE)).any())


def _fits_of(
    geometry: Geometry,
    cylinders: _Cylinders,
    ends: Index,
    tolerance: Tolerance,
    widest: tuple[float, float],
) -> Iterator[Fit]:
    """Yield the fit of each pair of a shaft and a hole, if they have one.

    A stepped shaft has several fits: the tightest counts, and of these the longest.

    `ends`, shape (n, 2): parts of shaft and hole. `widest` holds the largest interference and
    clearance as fractions of the radius [-].
    """
    pair, i, j = cylinders.beside(ends)
    gap = tolerance.gap_of(geometry.size[ends].min(axis=1))
    radius, doubt = cylinders.radius, cylinders.doubt
    interference, limit = radius[i] - radius[j], gap[pair] + doubt[i] + doubt[j]
    thickest, thinnest = (share * radius[i] for share in widest)
    clearance = np.maximum(tolerance.clearance or 0.0, thinnest)
    equal = np.flatnonzero((-limit - clearance <= interference) & (interference <= thickest))
    pair, i, j = pair[equal], i[equal], j[equal]
    interference, limit = interference[equal], limit[equal]
    axis, apart = cylinders.axis[i], cylinders.point[j] - cylinders.point[i]
    along = np.einsum("ij,ij->i", apart, axis)
    offset = lengths(apart - along[:, None] * axis)
    sine = lengths(cross(axis, cylinders.axis[j]))
    # the axes must coincide up to the play of the fit
    coaxial = (sine <= tolerance.angle) & (offset <= limit + np.abs(interference))
    # ends of the hole along the axis of the shaft, which may point the other way
    sense = np.einsum("ij,ij->i", axis, cylinders.axis[j])
    hole = along + sense * cylinders.low[j], along + sense * cylinders.high[j]
    low = np.maximum(cylinders.low[i], np.minimum(*hole))
    high = np.minimum(cylinders.high[i], np.maximum(*hole))
    coaxial &= high - low > FIT_LENGTH * radius[i]
    middle = cylinders.point[i] + axis * ((low + high) / 2)[:, None]
    rows = np.flatnonzero(coaxial)
    if not len(rows):
        return
    used, at = np.unique(cylinders.row[[i[rows], j[rows]]], return_inverse=True)
    bands, at = bands_of(geometry, used), at.reshape(2, -1)
    done = -1
    for n in np.lexsort((low[rows] - high[rows], interference[rows] <= limit[rows], pair[rows])):
        k = rows[n]
        names = (int(used[at[0, n]]), int(used[at[1, n]])), (int(at[0, n]), int(at[1, n]))
        if pair[k] == done or shared_region(geometry, bands, *names) is None:
            continue
        done = pair[k]
        shaft, length = i[k], float(high[k] - low[k])
        size, tight, parts = float(radius[shaft]), float(interference[k]), ends[done].tolist()
        yield Fit(tuple(parts), middle[k], axis[k], size, tight, length, float(limit[k]))


def _cylinders_of(geometry: Geometry, parts: Index) -> _Cylinders:
    """Cylindrical faces of parts, exact or recognised in their meshes, with their extents.

    `parts`, shape (n,): ascending.
    """
    s = geometry.surfaces
    _, rows = ragged(s.start, parts)
    rows = rows[s.kind[rows] == CYLINDER]
    owner, place = ragged(s.triangle_start, rows)
    corners = geometry.vertices[geometry.triangles[s.triangle[place]]] - s.point[rows[owner], None]
    height = np.einsum("tki,ti->tk", corners, s.axis[rows[owner]])
    low, high = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    lowest, highest = extents(height)
    np.minimum.at(low, owner, lowest)
    np.maximum.at(high, owner, highest)
    part, point, axis, radius, hollow, doubt = (
        values[rows] for values in (s.part, s.point, s.axis, s.radius, s.hollow, s.doubt)
    )
    return _Cylinders(rows, part, point, axis, radius, hollow, doubt, low, high)
