"""Contacts between exact curved faces: candidates, what their faces cover, patches.

Which surfaces come near is asked by their boxes; where they touch by formulas
(`kilter.contact.tangency`); whether their faces reach there by their triangles
(`kilter.contact.trim`); the points by `kilter.contact.rounds`. The formulas know nothing of
triangles, so two tessellations of one cylinder that cross each other are still one contact.

Two radii that differ by up to the gap tolerance touch. A peg that is thinner has a gap all
around, and lies in its hole along a line; one that is thicker interferes, which is an overlap
and no contact. Surfaces recognised in a mesh are known to their sagitta only: the tolerance
of their pairs is raised by it, and a warning says so.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kilter.contact.broad import Boxes, facets_in, joins
from kilter.contact.contact_set import Overlap, PossibleContacts, Rejected
from kilter.contact.facets import Facets
from kilter.contact.rounds import (
    AROUND,
    STEP,
    Spots,
    angles_between,
    arcs_of,
    ring,
    shell,
    socket,
    unrolled_overlap,
)
from kilter.contact.tangency import CIRCLE, LINE, POINT, SAME, Forms, Planes, meeting, on_planes
from kilter.contact.trim import (
    TURN,
    Bands,
    bands_of,
    common_spans,
    covered,
    frame_of,
    slices,
    unrolled,
)
from kilter.contact.patches import Patches
from kilter.geometry import Geometry
from kilter.rigid import cross
from kilter.surfaces import CYLINDER, KINDS, SPHERE

__all__ = ["CurvedContacts", "find_curved", "on_flat", "without_repeats"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

INTERFERENCE = 0.1
"""A peg that is thicker than its hole by more than this part of its radius is not meant for it."""
ALIKE = 1e-3
"""A line at the rim of a flat patch belongs to it where their normals differ by less."""
NAMED = ("sphere", "torus", "cone", "cylinder")
"""A patch is named after the first of these that touches in it."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvedContacts:
    """Patches of curved contact, struct of arrays as in `ContactSet`.

    Attributes
    ----------
    pair : ndarray of int, shape (P,)
        Row of the pair of parts.
    surface : ndarray of int, shape (P, 2)
        Curved surfaces of part a and b; -1: a flat face.
    normal, area, gap, kind, accuracy, start, points, normals
        As in `ContactSet`.
    zone : ndarray, shape (P,)
        Triangles may touch within so far of the contact [length unit].
    unknown : ndarray of int, shape (m, 3)
        Row of the pair, and curved surfaces of a and b (-1: flat faces) without a formula.
    possible : PossibleContacts
        Outer rows of the patches whose points lie inside the true cone of forces.
    rejected, overlaps, warnings
        As in `ContactSet`.
    """

    pair: Index
    surface: Index
    normal: Array
    area: Array
    gap: Array
    kind: NDArray[np.str_]
    accuracy: Array
    zone: Array
    start: Index
    points: Array
    normals: Array
    unknown: Index
    possible: PossibleContacts
    rejected: tuple[Rejected, ...]
    overlaps: tuple[Overlap, ...]
    warnings: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.pair)


@dataclass(frozen=True, slots=True, eq=False)
class _Pairs:
    """Candidates: row of the pair of parts, surface i, its partner, whether i is part b's."""

    pair: Index
    i: Index
    j: Index
    turned: Mask

    def take(self, rows: Index | Mask) -> _Pairs:
        return _Pairs(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(slots=True, eq=False)
class _Made:
    """Patches as they are found: one row each, points in blocks."""

    pair: list[int] = field(default_factory=list)
    surface: list[tuple[int, int]] = field(default_factory=list)
    area: list[float] = field(default_factory=list)
    gap: list[tuple[float, float]] = field(default_factory=list)
    zone: list[float] = field(default_factory=list)
    size: list[float] = field(default_factory=list)
    spots: list[Spots] = field(default_factory=list)
    turned: list[bool] = field(default_factory=list)
    rejected: list[Rejected] = field(default_factory=list)
    overlaps: list[Overlap] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class _Scene:
    """What all steps need."""

    geometry: Geometry
    facets: Facets
    boxes: Boxes
    pairs: Index
    gap: Array
    margin: Array
    angle: float

    def face(self, row: int) -> Array:
        """Triangles of a curved surface, shape (m, 3, 3)."""
        geometry = self.geometry
        return geometry.vertices[geometry.triangles[geometry.surfaces.triangles_of(row)]]

    def flat(self, facet: int) -> Array:
        """Triangles of a flat face, shape (m, 3, 3)."""
        facets = self.facets
        corners = facets.corners[facets.corner_start[facet] : facets.corner_start[facet + 1]]
        points = self.geometry.vertices[corners]
        if not facets.convex[facet]:
            return points.reshape(-1, 3, 3)
        count = len(points)
        k = np.arange(1, count - 1)
        return points[np.column_stack([0 * k, k, k + 1])]


def find_curved(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    pairs: Index,
    gap: Array,
    margin: Array,
    angle: float,
) -> CurvedContacts:
    """Contacts of curved faces of pairs of parts.

    Parameters
    ----------
    pairs : ndarray of int, shape (n, 2)
        Parts a and b whose boxes come near.
    gap, margin : ndarray, shape (n,)
        Gap tolerance, and the distance up to which a pair is looked at [length unit].
    angle : float
        Angle tolerance [rad].
    """
    scene = _Scene(geometry, facets, boxes, pairs, gap, margin, angle)
    made, unknown, raised = _Made(), np.empty((0, 3), dtype=np.int64), 0
    owners = np.diff(geometry.surfaces.start) > 0
    rows = np.flatnonzero(owners[pairs].any(axis=1))
    if len(rows):
        both, flat = _candidates(scene, rows)
        made, unknown = _touching(scene, both, flat)
        doubt = geometry.surfaces.doubt
        raised = len({p for p, s in zip(made.pair, made.surface, strict=True)
                      if max(doubt[k] if k >= 0 else 0.0 for k in s) > gap[p]})  # fmt: skip
    return _packed(scene, made, unknown, raised)


# candidates ---------------------------------------------------------------------------


def _candidates(scene: _Scene, rows: Index) -> tuple[_Pairs, _Pairs]:
    """Pairs of curved surfaces, and of curved surfaces and flat facets, whose boxes meet."""
    geometry, boxes = scene.geometry, scene.boxes
    low, high, some = _surface_boxes(scene)
    a, b = scene.pairs[rows].T
    grow = scene.margin[rows]
    box_low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow[:, None]
    box_high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow[:, None]

    def surfaces(part: Index) -> tuple[Index, Index]:
        start = geometry.surfaces.start
        count = np.diff(start)[part]
        owner = np.repeat(np.arange(len(part)), count)
        row = np.arange(len(owner)) + np.repeat(start[part] - (np.cumsum(count) - count), count)
        keep = some[row] & (low[row] <= box_high[owner]).all(axis=1)
        keep &= (high[row] >= box_low[owner]).all(axis=1)
        return owner[keep], row[keep]

    def flats(part: Index) -> tuple[Index, Index]:
        owner, facet = facets_in(scene.facets, boxes, part, box_low, box_high)
        keep = ~scene.facets.curved[facet]
        return owner[keep], facet[keep]

    def joined(one: tuple[Index, Index], other: tuple[Index, Index], plane: bool) -> Iterator[_Pairs]:
        box_i = low[one[1]], high[one[1]]
        box_j = (
            (boxes.facet_low[other[1]], boxes.facet_high[other[1]])
            if plane
            else (low[other[1]], high[other[1]])
        )
        for pair, x, y in joins(one[0], box_i, other[0], box_j, grow):
            yield _Pairs(rows[pair], one[1][x], other[1][y], np.zeros(len(x), dtype=bool))

    round_a, round_b = surfaces(a), surfaces(b)
    both = _joined(list(joined(round_a, round_b, False)))
    forth = _joined(list(joined(round_a, flats(b), True)))
    back = _joined(list(joined(round_b, flats(a), True)))
    back = _Pairs(back.pair, back.i, back.j, ~back.turned)
    return both, _joined([forth, back])


def _joined(found: list[_Pairs]) -> _Pairs:
    none = np.empty(0, dtype=np.int64)
    found = [*found, _Pairs(none, none, none, np.empty(0, dtype=bool))]
    return _Pairs(
        *(np.concatenate([getattr(f, name) for f in found]) for name in _Pairs.__slots__)
    )


def _surface_boxes(scene: _Scene) -> tuple[Array, Array, Mask]:
    """Boxes of curved surfaces in the frame of the boxes, and which have triangles."""
    geometry, surfaces = scene.geometry, scene.geometry.surfaces
    low = np.full((len(surfaces), 3), np.inf)
    high = -low
    some = np.diff(surfaces.triangle_start) > 0
    points = geometry.vertices[geometry.triangles[surfaces.triangle]] @ scene.boxes.frame.T
    first = surfaces.triangle_start[:-1][some]
    if len(first):
        low[some] = np.minimum.reduceat(points.min(axis=1), first)
        high[some] = np.maximum.reduceat(points.max(axis=1), first)
    sagitta = surfaces.sagitta[:, None]
    return low - sagitta, high + sagitta, some


# where they touch ---------------------------------------------------------------------


def _touching(scene: _Scene, both: _Pairs, flat: _Pairs) -> tuple[_Made, Index]:
    surfaces, facets = scene.geometry.surfaces, scene.facets
    made = _Made()
    limit = scene.gap[both.pair] + surfaces.doubt[both.i] + surfaces.doubt[both.j]
    angle = np.full(len(both.i), scene.angle)
    forms, unknown = meeting(surfaces, both.i, both.j, limit, angle)
    planes = Planes(facets.normal[flat.j], facets.origin[flat.j])
    flat_limit = scene.gap[flat.pair] + surfaces.doubt[flat.i]
    flats = on_planes(surfaces, flat.i, planes, np.full(len(flat.i), scene.angle))
    near = _within(scene, both, forms, limit)
    shells = near & (forms.form == SAME) & (surfaces.kind[both.i[forms.row]] != SPHERE)
    _shells(scene, made, both, forms.take(np.flatnonzero(shells)), limit)
    _each(scene, made, both, forms.take(np.flatnonzero(near & ~shells)), limit, False)
    near = _within(scene, flat, flats, flat_limit)
    _each(scene, made, flat, flats.take(np.flatnonzero(near)), flat_limit, True)
    return made, _unknown(scene, both, flat, unknown)


def _within(scene: _Scene, pairs: _Pairs, forms: Forms, limit: Array) -> Mask:
    """Forms whose gap may come within the margin where the parts overlap."""
    pair = pairs.pair[forms.row]
    a, b = scene.pairs[pair].T
    boxes = scene.boxes
    low = np.maximum(boxes.part_low[a], boxes.part_low[b])
    high = np.minimum(boxes.part_high[a], boxes.part_high[b])
    middle = (low + high) / 2 @ boxes.frame
    half = np.linalg.norm(high - low, axis=1) / 2
    margin = np.maximum(scene.margin[pair], limit[forms.row])
    line = forms.form == LINE
    t = np.where(line, np.einsum("ij,ij->i", middle - forms.at, forms.along), 0.0)
    there = forms.gap + forms.slope * t
    spread = np.where(line, np.abs(forms.slope) * half, forms.swing)
    surfaces = scene.geometry.surfaces
    near: Mask = np.abs(there) <= margin + spread
    same = forms.form == SAME
    size = surfaces.radius[pairs.i[forms.row]]
    wide = INTERFERENCE * np.where(size > 0, size, half) + np.where(same, forms.slope, 0.0) * half
    near |= same & (np.abs(forms.gap) <= wide)
    around = (same | (forms.form == CIRCLE)) & (forms.swing > np.maximum(wide, margin))
    return near & ~around


def _unknown(scene: _Scene, both: _Pairs, flat: _Pairs, unknown: Mask) -> Index:
    """Row of the pair and surfaces of candidates without a formula."""
    surfaces = scene.geometry.surfaces
    k = np.flatnonzero(unknown)
    free = np.flatnonzero(surfaces.kind[flat.i] == len(KINDS) - 1)
    free = free[np.unique(np.column_stack([flat.pair, flat.i])[free], axis=0, return_index=True)[1]]
    turned = flat.turned[free]
    i = flat.i[free]
    flats = np.column_stack([flat.pair[free], np.where(turned, -1, i), np.where(turned, i, -1)])
    return np.concatenate([np.column_stack([both.pair[k], both.i[k], both.j[k]]), flats])


def _each(
    scene: _Scene, made: _Made, pairs: _Pairs, forms: Forms, limit: Array, plane: bool
) -> None:
    """Points, lines, circles and sockets, one by one."""
    for k in range(len(forms.row)):
        row = int(forms.row[k])
        one = forms.take(np.array([k]))
        _place(scene, made, pairs, row, one, float(limit[row]), plane)


def _place(
    scene: _Scene, made: _Made, pairs: _Pairs, row: int, form: Forms, limit: float, plane: bool
) -> None:
    i, j, pair = int(pairs.i[row]), int(pairs.j[row]), int(pairs.pair[row])
    surfaces = scene.geometry.surfaces
    slack = float(scene.geometry.slack[scene.pairs[pair]].max())
    faces = [
        (scene.face(i), float(surfaces.sagitta[i]) + limit),
        (scene.flat(j), np.inf)
        if plane
        else (scene.face(j), float(surfaces.sagitta[j]) + limit),
    ]
    what = int(form.form[0])
    gap = float(form.gap[0])
    reach = abs(gap) + float(form.swing[0])
    low, high = gap - float(form.swing[0]), gap + float(form.swing[0])
    if what == POINT:
        spots = _at_point(form, faces, reach, limit)
    elif what == LINE:
        spots, low, high = _along(form, faces, reach + scene.angle * float(
            scene.geometry.size[scene.pairs[pair]].min()), limit)  # fmt: skip
    elif what == CIRCLE:
        spots = _around(form, faces, reach, limit)
    else:
        spots = socket(form.at[0], float(surfaces.radius[i]), faces[0][0], faces[1][0],
                       float(max(surfaces.sagitta[[i, j]])))  # fmt: skip
    if spots is None:
        return
    if not plane and what in (SAME, CIRCLE):
        low, high = _gaps(scene, i, j, spots.points, float(form.swing[0]), limit)
    zone = limit + float(np.sqrt(2 * form.bend[0] * (limit + 2 * slack)))
    names = (i, -1) if plane else (i, j)
    turned = bool(pairs.turned[row])
    if what == SAME and surfaces.hollow[i]:  # the normals of a socket are those of the ball
        names, turned = (j, i), not turned
    _keep(scene, made, pair, names, (low, high), limit, spots, zone, turned)


_Face = tuple[Array, float]


def _at_point(form: Forms, faces: list[_Face], reach: float, grow: float) -> Spots | None:
    at, normal = form.at, form.normal
    for triangles, sagitta in faces:
        depth = 1e300 if not np.isfinite(sagitta) else sagitta + reach
        if not covered(triangles, at, normal, depth, grow)[0]:
            return None
    none = np.empty((0, 3))
    return Spots(at, normal, none, none, 0.0)


def _along(
    form: Forms, faces: list[_Face], reach: float, grow: float
) -> tuple[Spots | None, float, float]:
    at, along, normal = form.at[0], form.along[0], form.normal[0]
    spans = np.array([[-np.inf, np.inf]])
    for triangles, sagitta in faces:
        mine = slices(triangles, (at, along, normal), sagitta + reach, grow)
        spans = common_spans(spans, mine)
    if not len(spans) or spans.max() - spans.min() <= 2 * grow:
        return None, 0.0, 0.0
    ends = np.array([spans.min(), spans.max()])
    gaps = form.gap[0] + form.slope[0] * ends
    none = np.empty((0, 3))
    points = at + ends[:, None] * along
    spots = Spots(points, np.tile(normal, (2, 1)), none, none, 0.0)
    return spots, float(gaps.min()), float(gaps.max())


def _around(form: Forms, faces: list[_Face], reach: float, grow: float) -> Spots | None:
    center, axis, radius = form.at[0], form.along[0], float(form.radius[0])
    out, up = (float(x) for x in form.normal[0, :2])
    u, v = (x[0] for x in frame_of(axis[None]))

    def inside(angle: Array) -> Mask:
        away = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
        points, normals = center + radius * away, out * away + up * axis
        held = np.ones(len(angle), dtype=bool)
        for triangles, sagitta in faces:
            depth = 1e300 if not np.isfinite(sagitta) else sagitta + reach
            held &= covered(triangles, points, normals, depth, grow)
        return held

    arcs = arcs_of(inside)
    return ring(center, axis, radius, (out, up), arcs) if arcs else None


def _keep(
    scene: _Scene,
    made: _Made,
    pair: int,
    names: tuple[int, int],
    gap: tuple[float, float],
    limit: float,
    spots: Spots,
    zone: float,
    turned: bool,
) -> None:
    """A patch where the gap is within tolerance, else a near pair or an overlap."""
    low, high = gap
    a, b = (int(k) for k in scene.pairs[pair])
    if low <= limit and high >= -limit:
        made.pair.append(pair)
        made.surface.append(names[::-1] if turned else names)
        made.area.append(spots.area)
        made.gap.append(gap)
        made.zone.append(zone)
        radius = float(scene.geometry.surfaces.radius[names[0]])
        made.size.append(max(radius, float(np.ptp(spots.points, axis=0).max())))
        made.spots.append(spots)
        made.turned.append(turned)
    elif low > 0:
        made.rejected.append(Rejected((a, b), low, 0.0, "gap above the tolerance"))
    elif high < 0:
        depth = -high
        made.overlaps.append(Overlap((a, b), None, depth, "interfere"))
        made.rejected.append(
            Rejected((a, b), high, 0.0, "penetrates by more than the gap tolerance")
        )


# cylinders in cylinders, cones in cones -----------------------------------------------


def _shells(scene: _Scene, made: _Made, pairs: _Pairs, forms: Forms, limit: Array) -> None:
    """Surfaces in their own counterparts, unrolled about the axis of the solid one."""
    if not len(forms.row):
        return
    surfaces = scene.geometry.surfaces
    first, second = pairs.i[forms.row], pairs.j[forms.row]
    used, place = np.unique(np.concatenate([first, second]), return_inverse=True)
    bands = bands_of(scene.geometry, used)
    mine, other = place.reshape(2, -1)
    for k in range(len(forms.row)):
        i, j = int(first[k]), int(second[k])
        turned = bool(pairs.turned[forms.row[k]]) ^ bool(surfaces.hollow[i])
        solid, hollow = (i, j) if not surfaces.hollow[i] else (j, i)
        x, y = (mine[k], other[k]) if solid == i else (other[k], mine[k])
        found = _shell(scene, bands, (solid, hollow), (int(x), int(y)))
        if found is None:
            continue
        spots, (bottom, top) = found
        bound = float(limit[forms.row[k]])
        off = _off(scene, solid, hollow, bottom, top)
        gap = _gaps(scene, solid, hollow, spots.points, off, bound)
        pair = int(pairs.pair[forms.row[k]])
        if top - bottom <= 2 * bound:
            a, b = (int(p) for p in scene.pairs[pair])
            why = "thinner than twice the gap tolerance"
            made.rejected.append(Rejected((a, b), gap[0], 0.0, why))
            continue
        zone = bound + float(np.ptp(spots.points, axis=0).max())
        _keep(scene, made, pair, (solid, hollow), gap, bound, spots, zone, turned)


def _gaps(
    scene: _Scene, i: int, j: int, points: Array, off: float, limit: float
) -> tuple[float, float]:
    """Range of the gap between surfaces i and j at points half-way between them.

    Surfaces in their own counterparts touch all over only where their cores are one; where
    they are farther apart (`off`) than the tolerance, the face is in the way on one side
    (that depth is given) or away from it.
    """
    s = scene.geometry.surfaces
    rows = np.ones(len(points), dtype=np.int64)
    gaps = s.distance(i * rows, points) + s.distance(j * rows, points)
    low, high = float(gaps.min()), float(gaps.max())
    if off <= limit:
        return low, high
    return (low, low) if low < -limit else (high, high)


def _off(scene: _Scene, i: int, j: int, bottom: float, top: float) -> float:
    """Least distance of the axis of j from that of i between two heights of i."""
    s = scene.geometry.surfaces
    apart = []
    for height in (bottom, top):
        center = s.point[i] + height * s.axis[i]
        to = center - s.point[j]
        apart.append(to - (to @ s.axis[j]) * s.axis[j])
    step = apart[1] - apart[0]
    share = float(np.clip(-(apart[0] @ step) / max(float(step @ step), 1e-300), 0, 1))
    return float(np.linalg.norm(apart[0] + share * step))


def _shell(
    scene: _Scene, bands: Bands, names: tuple[int, int], at: tuple[int, int]
) -> tuple[Spots, tuple[float, float]] | None:
    """Points where two coaxial faces lie on each other, and between which heights."""
    s, (i, j), (x, y) = scene.geometry.surfaces, names, at
    axis = s.axis[i]
    turn = 1.0 if float(axis @ s.axis[j]) > 0 else -1.0
    shift = float((s.point[j] - s.point[i]) @ axis)
    ends = sorted((shift + turn * float(bands.low[y]), shift + turn * float(bands.high[y])))
    bottom, top = max(float(bands.low[x]), ends[0]), min(float(bands.high[x]), ends[1])
    if top <= bottom:
        return None
    u, v = frame_of(s.axis[[i, j]])
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
        exact = _unfilled(scene, names, zero, turn, shift, radius or abs(bottom) + abs(top))
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


def _common_arcs(
    one: tuple[float, float], other: tuple[float, float]
) -> list[tuple[float, float]]:
    """Arcs (begin, width) in both of two arcs."""
    if one[1] >= TURN - 1e-6:
        return [other]
    if other[1] >= TURN - 1e-6:
        return [one]
    found = []
    start = (other[0] - one[0]) % TURN
    for begin in (start - TURN, start):
        low, high = max(begin, 0.0), min(begin + other[1], one[1])
        if high > low + 1e-9:
            found.append((one[0] + low, high - low))
    return found


def _filled(
    arcs: list[tuple[float, float]], step: float, bottom: float, top: float, cone: bool
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Angles and heights at both ends of arcs, and those of outer rows between."""
    angles = [angles_between(begin, width, step) for begin, width in arcs]
    between = []
    for angle, (_, width) in zip(angles, arcs, strict=True):
        closed = np.append(angle, angle[0] + TURN) if width >= TURN - 1e-6 else angle
        between.append((closed[1:] + closed[:-1]) / 2)
    made = []
    for some in (np.concatenate(angles), np.concatenate(between)):
        made.append((np.tile(some, 2), np.repeat([bottom, top], len(some))))
    return made[0], made[1]


def _unfilled(
    scene: _Scene, names: tuple[int, int], zero: float, turn: float, shift: float, scale: float
) -> tuple[Array, Array, float] | None:
    """Corners of the overlap of faces that are no whole bands, and its area."""
    owner, angle, height, tip = unrolled(scene.geometry, np.array(names))
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


# patches ------------------------------------------------------------------------------


def without_repeats(
    curved: CurvedContacts, patches: Patches, tolerance: Array
) -> CurvedContacts:
    """Without lines and points at the rim of a flat patch of the same pair: a fillet's seam."""
    keep = np.ones(len(curved), dtype=bool)
    for patch in np.flatnonzero(np.isin(curved.pair, patches.pair)):
        pair = int(curved.pair[patch])
        span = slice(curved.start[patch], curved.start[patch + 1])
        points, normals = curved.points[span], curved.normals[span]
        first, last = np.searchsorted(patches.pair, [pair, pair + 1])
        for flat in range(int(first), int(last)):
            corners = patches.points[patches.start[flat] : patches.start[flat + 1]]
            alike = np.abs(normals - patches.normal[flat]).max() <= ALIKE
            if alike and on_flat(points, corners, patches.normal[flat], 2 * tolerance[pair]).all():
                keep[patch] = False
    return curved if keep.all() else _chosen(curved, np.flatnonzero(keep))


def _chosen(curved: CurvedContacts, rows: Index) -> CurvedContacts:
    """Some of the patches."""
    count = np.diff(curved.start)[rows]
    start = np.concatenate([[0], np.cumsum(count)])
    points = np.repeat(curved.start[rows] - start[:-1], count) + np.arange(int(start[-1]))
    by_patch = ("pair", "surface", "normal", "area", "gap", "kind", "accuracy", "zone")
    changed = {name: getattr(curved, name)[rows] for name in by_patch}
    by_point = {name: getattr(curved, name)[points] for name in ("points", "normals")}
    return dataclasses.replace(curved, **changed, **by_point, start=start)


def on_flat(points: Array, corners: Array, normal: Array, slack: float) -> Mask:
    """Points within `slack` of a flat convex patch."""
    level = np.abs((points - corners[0]) @ normal) <= slack
    along = np.roll(corners, -1, axis=0) - corners
    length = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    side = cross(along[None], points[:, None] - corners[None]) @ normal / length
    if float((cross(along, corners.mean(axis=0) - corners) @ normal).sum()) < 0:
        side = -side  # the corners turn the other way
    inside: Mask = level & (side >= -slack).all(axis=1)
    return inside


def _packed(scene: _Scene, made: _Made, unknown: Index, raised: int) -> CurvedContacts:
    """The patches as arrays, ordered by pair, normals from a to b."""
    order = np.argsort(np.array(made.pair, dtype=np.int64), kind="stable")
    pair = np.array(made.pair, dtype=np.int64)[order]
    spots = [made.spots[k] for k in order]
    sign = [-1.0 if made.turned[k] else 1.0 for k in order]
    none = [np.empty((0, 3))]
    count = np.array([len(s.points) for s in spots], dtype=np.int64)
    normals = np.concatenate([*(t * s.normals for s, t in zip(spots, sign, strict=True)), *none])
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    surface = np.array(made.surface, dtype=np.int64).reshape(-1, 2)[order]
    accuracy = scene.geometry.accuracy[scene.pairs[pair]].sum(axis=1)
    size = np.array(made.size)[order] if made.size else np.empty(0)
    outer = np.array([len(s.outer_points) for s in spots], dtype=np.int64)
    parts = np.repeat(scene.pairs[pair], outer, axis=0)
    possible = PossibleContacts(
        part_a=parts[:, 0],
        part_b=parts[:, 1],
        points=np.concatenate([*(s.outer_points for s in spots), *none]),
        normals=np.concatenate(
            [*(t * s.outer_normals for s, t in zip(spots, sign, strict=True)), *none]
        ),
        two_sided=np.zeros(len(parts), dtype=bool),
        mu=np.zeros(len(parts)),
    )
    return CurvedContacts(
        pair=pair,
        surface=surface,
        normal=_means(normals, start),
        area=np.array(made.area)[order] if made.area else np.empty(0),
        gap=np.array(made.gap).reshape(-1, 2)[order],
        kind=np.array([_name(scene, row) for row in surface.tolist()], dtype="<U11"),
        accuracy=accuracy / size if len(size) else np.empty(0),
        zone=np.array(made.zone)[order] if made.zone else np.empty(0),
        start=start,
        points=np.concatenate([*(s.points for s in spots), *none]),
        normals=normals,
        unknown=unknown,
        possible=possible,
        rejected=tuple(made.rejected),
        overlaps=tuple(made.overlaps),
        warnings=_warnings(raised),
    )


def _means(normals: Array, start: Index) -> Array:
    """Unit mean normal of each patch; the first one where they cancel."""
    if len(start) == 1:
        return np.empty((0, 3))
    total = np.add.reduceat(normals, start[:-1], axis=0)
    count = np.diff(start)[:, None]
    length = np.linalg.norm(total, axis=1)[:, None]
    mean: Array = np.where(
        length > 1e-9 * count, total / np.maximum(length, 1e-300), normals[start[:-1]]
    )
    return mean


def _name(scene: _Scene, surface: list[int]) -> str:
    kinds = {KINDS[scene.geometry.surfaces.kind[k]] for k in surface if k >= 0}
    return next(name for name in NAMED if name in kinds)


def _warnings(raised: int) -> tuple[str, ...]:
    if not raised:
        return ()
    pairs = "1 pair" if raised == 1 else f"{raised} pairs"
    return (
        f"curved faces recognised in meshes: the gap tolerance of {pairs} was raised to the height "
        "of the arcs over their triangles; a clearance or interference below that is not seen",
    )
