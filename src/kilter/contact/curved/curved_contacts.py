"""Contacts between exact curved faces: candidates, what their faces cover, patches.

Which surfaces come near is asked by their boxes; where they touch by formulas
(`kilter.contact.curved.tangency`); whether their faces reach there by their triangles
(`kilter.contact.curved.coverage`); the points by `kilter.contact.curved.contact_points`.
The formulas know nothing of triangles, so two tessellations of one
cylinder that cross each other are still one contact.

Two radii that differ by up to the gap tolerance touch. A peg that is thinner has a gap all
around, and lies in its hole along a line; one that is thicker interferes, which is an overlap
and no contact. Surfaces recognised in a mesh are known to their sagitta only: the tolerance
of their pairs is raised by it, and a warning says so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.arrays import Array, Index, Mask, across, ragged
from kilter.assembly.surfaces import KINDS, SPHERE
from kilter.contact.broad import facets_in, joins
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import INTERFERENCE
from kilter.contact.curved.candidates import CIRCLE, LINE, POINT, SAME, Allowed, Forms
from kilter.contact.curved.contact_points import Spots, arcs_of, ring, socket
from kilter.contact.curved.coverage import common_spans, slices
from kilter.contact.curved.curved_patches import (
    CurvedContacts,
    Found,
    Limits,
    Made,
    Pairs,
    keep,
    packed,
)
from kilter.contact.curved.on_planes import Planes, on_planes
from kilter.contact.curved.rim_points import rims_on_planes
from kilter.contact.curved.shells import gaps_between, touching_shells
from kilter.contact.curved.tangency import meeting
from kilter.shape.covering import covered

__all__ = ["find_curved"]


def find_curved(search: ContactSearch) -> CurvedContacts:
    """Contacts of curved faces of the pairs of a search."""
    geometry, pairs = search.geometry, search.pairs
    made, unknown, raised = Made(), np.empty((0, 3), dtype=np.int64), 0
    owners = np.diff(geometry.surfaces.start) > 0
    rows = np.flatnonzero(owners[pairs].any(axis=1))
    if len(rows):
        both, flat = _candidates(search, rows)
        made, unknown = _touching(search, both, flat)
        doubt = geometry.surfaces.doubt
        raised = len(
            {
                one.pair
                for one in made.found
                if max(doubt[k] if k >= 0 else 0.0 for k in one.surface)
                > search.limits.gap[one.pair]
            }
        )
    return packed(search, made, unknown, raised)


# candidates ---------------------------------------------------------------------------


def _candidates(search: ContactSearch, rows: Index) -> tuple[Pairs, Pairs]:
    """Pairs of curved surfaces, and of curved surfaces and flat facets, whose boxes meet."""
    geometry, boxes = search.geometry, search.boxes
    low, high, some = _surface_boxes(search)
    a, b = search.pairs[rows].T
    grow = search.limits.margin[rows]
    box_low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow[:, None]
    box_high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow[:, None]

    def surfaces(part: Index) -> tuple[Index, Index]:
        owner, row = ragged(geometry.surfaces.start, part)
        keep = some[row] & (low[row] <= box_high[owner]).all(axis=1)
        keep &= (high[row] >= box_low[owner]).all(axis=1)
        return owner[keep], row[keep]

    def flats(part: Index) -> tuple[Index, Index]:
        owner, facet = facets_in(search.facets, boxes, part, box_low, box_high)
        keep = ~search.facets.curved[facet]
        return owner[keep], facet[keep]

    def joined(
        one: tuple[Index, Index], other: tuple[Index, Index], plane: bool
    ) -> Iterator[Pairs]:
        box_i = low[one[1]], high[one[1]]
        box_j = (
            (boxes.facet_low[other[1]], boxes.facet_high[other[1]])
            if plane
            else (low[other[1]], high[other[1]])
        )
        for pair, x, y in joins(one[0], box_i, other[0], box_j, grow):
            yield Pairs(rows[pair], one[1][x], other[1][y], np.zeros(len(x), dtype=bool))

    round_a, round_b = surfaces(a), surfaces(b)
    both = Pairs.join(joined(round_a, round_b, False))
    forth = Pairs.join(joined(round_a, flats(b), True))
    back = Pairs.join(joined(round_b, flats(a), True))
    back = Pairs(back.pair, back.i, back.j, ~back.turned)
    return both, Pairs.join([forth, back])


def _surface_boxes(search: ContactSearch) -> tuple[Array, Array, Mask]:
    """Boxes of curved surfaces in the frame of the boxes, and which have triangles."""
    geometry, surfaces = search.geometry, search.geometry.surfaces
    low = np.full((len(surfaces), 3), np.inf)
    high = -low
    some = np.diff(surfaces.triangle_start) > 0
    points = search.boxes.turned[geometry.triangles[surfaces.triangle]]
    first = surfaces.triangle_start[:-1][some]
    if len(first):
        low[some] = np.minimum.reduceat(points.min(axis=1), first)
        high[some] = np.maximum.reduceat(points.max(axis=1), first)
    sagitta = surfaces.sagitta[:, None]
    return low - sagitta, high + sagitta, some


# where they touch ---------------------------------------------------------------------


def _touching(search: ContactSearch, both: Pairs, flat: Pairs) -> tuple[Made, Index]:
    surfaces, facets = search.geometry.surfaces, search.facets
    made = Made()
    doubt = surfaces.doubt[both.i] + surfaces.doubt[both.j]
    limits = _limits(search, both, doubt)
    angle = np.full(len(both.i), search.angle)
    allowed = Allowed(limits.gap, limits.closed, angle, 0 * angle)
    forms, unknown = meeting(surfaces, both.i, both.j, allowed, search.geometry.grounded)
    planes = Planes(facets.normal[flat.j], facets.origin[flat.j])
    flat_limits = _limits(search, flat, surfaces.doubt[flat.i])
    level = np.full(len(flat.i), search.angle)
    flats = Forms.join(
        [
            on_planes(surfaces, flat.i, planes, level),
            rims_on_planes(search.geometry, flat.i, planes, level),
        ]
    )
    near = _within(search, both, forms, limits.gap)
    shells = near & (forms.form == SAME) & (surfaces.kind[both.i[forms.row]] != SPHERE)
    touching_shells(search, made, both, forms.take(np.flatnonzero(shells)), limits)
    _each(search, made, both, forms.take(np.flatnonzero(near & ~shells)), limits, False)
    near = _within(search, flat, flats, flat_limits.gap)
    _each(search, made, flat, flats.take(np.flatnonzero(near)), flat_limits, True)
    return made, _unknown(search, both, flat, unknown)


def _limits(search: ContactSearch, pairs: Pairs, doubt: Array) -> Limits:
    """Limits of candidates, raised by how far their surfaces may be from the truth."""
    limits = search.limits
    return Limits(limits.gap[pairs.pair] + doubt, limits.closed[pairs.pair] + doubt)


def _within(search: ContactSearch, pairs: Pairs, forms: Forms, limit: Array) -> Mask:
    """Forms whose gap may come within the margin where the parts overlap."""
    pair = pairs.pair[forms.row]
    a, b = search.pairs[pair].T
    boxes = search.boxes
    low = np.maximum(boxes.part_low[a], boxes.part_low[b])
    high = np.minimum(boxes.part_high[a], boxes.part_high[b])
    middle = (low + high) / 2 @ boxes.frame
    half = np.linalg.norm(high - low, axis=1) / 2
    margin = np.maximum(search.limits.margin[pair], limit[forms.row])
    line = forms.form == LINE
    t = np.where(line, np.einsum("ij,ij->i", middle - forms.at, forms.along), 0.0)
    there = forms.gap + forms.slope * t
    spread = np.where(line, np.abs(forms.slope) * half, forms.swing)
    surfaces = search.geometry.surfaces
    near: Mask = np.abs(there) <= margin + spread
    same = forms.form == SAME
    size = surfaces.radius[pairs.i[forms.row]]
    wide = INTERFERENCE * np.where(size > 0, size, half) + np.where(same, forms.slope, 0.0) * half
    near |= same & (np.abs(forms.gap) <= wide)
    around = (same | (forms.form == CIRCLE)) & (forms.swing > np.maximum(wide, margin))
    # a fit: what lies off by more than its play lies beside it; a tilted axis is asked later
    aside = np.linalg.norm(middle - forms.at, axis=1) + half
    fits = (forms.play > 0) & (forms.swing <= forms.play + margin + forms.slope * aside)
    possible: Mask = np.where(forms.play > 0, fits, near & ~around)
    return possible


def _unknown(search: ContactSearch, both: Pairs, flat: Pairs, unknown: Mask) -> Index:
    """Row of the pair and surfaces of candidates without a formula."""
    surfaces = search.geometry.surfaces
    k = np.flatnonzero(unknown)
    free = np.flatnonzero(surfaces.kind[flat.i] == len(KINDS) - 1)
    free = free[np.unique(np.column_stack([flat.pair, flat.i])[free], axis=0, return_index=True)[1]]
    turned = flat.turned[free]
    i = flat.i[free]
    flats = np.column_stack([flat.pair[free], np.where(turned, -1, i), np.where(turned, i, -1)])
    return np.concatenate([np.column_stack([both.pair[k], both.i[k], both.j[k]]), flats])


def _each(
    search: ContactSearch, made: Made, pairs: Pairs, forms: Forms, limits: Limits, plane: bool
) -> None:
    """Points, lines, circles and sockets, one by one."""
    for k in range(len(forms.row)):
        row = int(forms.row[k])
        one = forms.take(np.array([k]))
        _place(search, made, pairs, row, one, limits.of(row), plane)


def _place(
    search: ContactSearch,
    made: Made,
    pairs: Pairs,
    row: int,
    form: Forms,
    limits: tuple[float, float],
    plane: bool,
) -> None:
    limit, closed = limits
    play = float(form.play[0])
    i, j, pair = int(pairs.i[row]), int(pairs.j[row]), int(pairs.pair[row])
    surfaces = search.geometry.surfaces
    slack = float(search.geometry.slack[search.pairs[pair]].max())
    faces = [
        (search.face(i), float(surfaces.sagitta[i]) + limit),
        (search.flat(j), np.inf) if plane else (search.face(j), float(surfaces.sagitta[j]) + limit),
    ]
    what = int(form.form[0])
    gap = float(form.gap[0])
    reach = abs(gap) + float(form.swing[0])
    low, high = gap - float(form.swing[0]), gap + float(form.swing[0])
    if what == POINT:
        spots = _at_point(form, faces, reach, limit)
    elif what == LINE:
        spots, low, high = _along(form, faces, reach + search.angle * float(
            search.geometry.size[search.pairs[pair]].min()), limit)  # fmt: skip
    elif what == CIRCLE:
        spots = _around(form, faces, reach, limit)
    else:
        radius = float(surfaces.radius[[i, j]].mean() if play > 0 else surfaces.radius[i])
        spots = socket(form.at[0], radius, faces[0][0], faces[1][0],
                       float(max(surfaces.sagitta[[i, j]])))  # fmt: skip
    if spots is None:
        return
    if not plane and what in (SAME, CIRCLE):
        off = limit if play > 0 else float(form.swing[0])
        low, high = gaps_between(search, i, j, spots.points, off, limit)
    bend = float(form.bend[0]) or float(search.geometry.size[search.pairs[pair]].min())
    near = max(limit, abs(gap), play)
    zone = near + float(np.sqrt(2 * bend * (near + 2 * slack)))
    names = (i, -1) if plane else (i, j)
    turned = bool(pairs.turned[row])
    if what == SAME and surfaces.hollow[i]:  # the normals of a socket are those of the ball
        names, turned = (j, i), not turned
    inside = (spots.points.mean(axis=0)[None], spots.normals[:1]) if what == LINE else None
    found = Found(pair, names, (low, high), limit, spots, zone, turned, closed, play, inside)
    keep(search, made, found)


_Face = tuple[Array, float]


def _at_point(form: Forms, faces: list[_Face], reach: float, grow: float) -> Spots | None:
    at, normal = form.at, form.normal
    side = form.along if form.along.any() else normal
    rim = float(form.radius[0]) / 2  # in the plane of a rim its face is no nearer to the axis
    for (triangles, sagitta), upright, least in zip(faces, (side, normal), (rim, 0.0), strict=True):
        depth = 1e300 if not np.isfinite(sagitta) else max(sagitta + reach, least)
        if not covered(triangles, at, upright, depth, grow)[0]:
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
    u, v = across(axis)

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
