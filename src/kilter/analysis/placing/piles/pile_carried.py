"""Places at which known loads prove that the pile carries a box.

The points under a box at which its full weight is carried are the parts of its contacts within the
polygons of the tops. If its centre is a mean of such points, and of the resultants of patterns that
lie in its contacts, the same mean of their forces carries it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.analysis.placing.piles.pile_hulls import fan_weights, surround
from kilter.analysis.placing.piles.pile_question import (
    OPEN,
    STANDS,
    PlaceDecision,
    PlaceQuestion,
    check_carried,
)
from kilter.analysis.placing.piles.pile_state import Pattern
from kilter.analysis.placing.piles.pile_statics import rectangle_corners
from kilter.arrays import Array, Index, Mask
from kilter.contact.common.polygons import clip_convex

IN_CONTACT = 1e-12
"""Rounding of a point in a contact rectangle, over the size of the box [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """Parts of contacts within the polygons of the tops below: t convex polygons."""

    place: Index
    box: Index
    """Row of the place among those asked, and the box below, shape (t,)."""
    points: Array
    count: Index
    """Corners, padded, shape (t, w, 2); no corners if the part is empty."""
    entry: Index
    sides: Index
    """Entries at the corners of the polygon of each box, padded, and their number, shape (n, q)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Loads:
    """Loads under boxes at places, and the entries that carry them.

    `line` is the place of each load on a box, at a point with a force [N]; `mix`, shape (m, e), has
    the force of each entry at each place.
    """

    line: Index
    box: Index
    point: Array
    force: Array
    mix: csr_array


def carry(asked: PlaceQuestion, decision: PlaceDecision, among: Mask | None = None) -> None:
    """Decide open places by known loads; the mask `among`, shape (m,), restricts the places."""
    if asked.pile.forces is None:
        return
    is_open = decision.state == OPEN
    rows = np.flatnonzero(is_open if among is None else is_open & among)
    if not len(rows):
        return
    parts = _carried_parts(asked, rows)
    width = parts.points.shape[1]
    points, valid, source = _side_by_side(asked, rows, parts)
    patterns = [p for p in asked.pile.carried.patterns if p.most >= asked.weight]
    for pattern in patterns:
        at = pattern.resultant - asked.center[rows]
        points = np.concatenate([points, at[:, None]], axis=1)
        valid = np.concatenate([valid, _in_contact(asked, rows, pattern)[:, None]], axis=1)
    if not valid.any():
        return
    found = surround(points, valid)
    inside = np.flatnonzero(found.inside)
    if not len(inside):
        return
    force = found.weight[inside] * asked.weight
    loads = _loads(asked, parts, patterns, (source[inside], width), found.which[inside], force)
    _keep_proved(asked, decision, rows[inside], loads)


def _carried_parts(asked: PlaceQuestion, rows: Index) -> _Parts:
    """The part of each contact at which the weight of the box is carried."""
    carried, touch = asked.pile.carried, asked.touch
    place, box = np.nonzero(touch.carries[rows])
    polygons = {k: carried.polygon(k, asked.weight) for k in np.unique(box).tolist()}
    widest = max((len(entries) for entries in polygons.values()), default=0)
    entry = np.zeros((len(asked.pile.statics.boxes), max(widest, 3)), dtype=np.int64)
    sides = np.zeros(len(entry), dtype=np.int64)
    for k, entries in polygons.items():
        sides[k] = len(entries)
        entry[k, : len(entries)] = entries
        entry[k, len(entries) :] = entries[-1] if len(entries) else 0
    usable = sides[box] >= 3
    place, box = place[usable], box[usable]
    low, high = touch.low[rows[place], box], touch.high[rows[place], box]
    points, count = clip_convex(
        rectangle_corners(low, high),
        np.full(len(place), 4),
        carried.point[entry[box]],
        sides[box],
    )
    return _Parts(place, box, points, np.where(count >= 3, count, 0), entry, sides)


def _side_by_side(asked: PlaceQuestion, rows: Index, parts: _Parts) -> tuple[Array, Mask, Index]:
    """Corners of all parts of a place side by side, relative to its centre, and the source.

    Returns `points, valid` (m, k w, 2): a place has up to k parts of up to w corners; `source` (m,
    k): the part of each block of corners.
    """
    m, width = len(rows), parts.points.shape[1]
    per_place = np.bincount(parts.place, minlength=m)
    first = np.cumsum(per_place) - per_place
    slot = np.arange(len(parts.place)) - first[parts.place]
    most = int(per_place.max(initial=0))
    points, valid = np.zeros((m, most, width, 2)), np.zeros((m, most, width), dtype=bool)
    source = np.full((m, most), -1)
    center = asked.center[rows[parts.place]]
    points[parts.place, slot] = parts.points - center[:, None]
    valid[parts.place, slot] = np.arange(width) < parts.count[:, None]
    source[parts.place, slot] = np.arange(len(parts.place))
    return points.reshape(m, -1, 2), valid.reshape(m, -1), source


def _in_contact(asked: PlaceQuestion, rows: Index, pattern: Pattern) -> Mask:
    """Places at which all loads of a pattern lie in contacts of the box, shape (m,)."""
    touch, slack = asked.touch, IN_CONTACT * asked.radius
    at = rows[:, None], pattern.boxes
    lies = touch.carries[at]
    lies &= (touch.low[at] <= pattern.points + slack).all(axis=2)
    lies &= (touch.high[at] >= pattern.points - slack).all(axis=2)
    return np.asarray(lies.all(axis=1))


def _loads(
    asked: PlaceQuestion,
    parts: _Parts,
    patterns: list[Pattern],
    blocks: tuple[Index, int],
    which: Index,
    force: Array,
) -> _Loads:
    """Loads on the pile at m places, from up to three points of each.

    Arguments: `blocks` (m, k): the part of each block of points, and the number of points of a
    block; `which` (m, 3): numbers of the points: blocks of parts, then patterns; `force` (m, 3):
    force at each [N].
    """
    carried = asked.pile.carried
    source, width = blocks
    first_pattern = source.shape[1] * width
    line, corner = np.nonzero(which < first_pattern)
    chosen = which[line, corner]
    part = source[line, chosen // width]
    point, box, load = parts.points[part, chosen % width], parts.box[part], force[line, corner]
    corners, share = fan_weights(point, carried.point[parts.entry[box]], parts.sides[box])
    loads = [(line, box, point, load)]
    used = [(np.repeat(line, 3), parts.entry[box[:, None], corners].ravel(),
             (load[:, None] * share).ravel())]  # fmt: skip
    for k, pattern in enumerate(patterns):
        line, corner = np.nonzero(which == first_pattern + k)
        load, size = force[line, corner], len(pattern.boxes)
        used.append((line, np.full(len(line), pattern.entry), load))
        loads.append(
            (
                np.repeat(line, size),
                np.tile(pattern.boxes, len(line)),
                np.tile(pattern.points, (len(line), 1)),
                np.outer(load, pattern.shares).ravel(),
            )
        )
    line, box, point, load = (np.concatenate(arrays) for arrays in zip(*loads, strict=True))
    row, entry, value = (np.concatenate(arrays) for arrays in zip(*used, strict=True))
    mix = csr_array((value, (row, entry)), shape=(len(which), len(carried.most)))
    order = np.argsort(line, kind="stable")
    return _Loads(line[order], box[order], point[order], load[order], mix)


def _keep_proved(asked: PlaceQuestion, decision: PlaceDecision, rows: Index, loads: _Loads) -> None:
    """Check the forces that carry loads at places, and keep those that are proofs."""
    pile = asked.pile
    assert pile.forces is not None
    forces = np.maximum(pile.forces + (loads.mix @ pile.carried.change).toarray(), 0.0)
    proved = check_carried(asked, rows, forces, loads.line, loads.box, loads.point, loads.force)
    start = np.searchsorted(loads.line, np.arange(len(rows) + 1))
    for k in np.flatnonzero(proved).tolist():
        own = slice(start[k], start[k + 1])
        decision.forces[int(rows[k])] = (
            forces[k], loads.box[own], loads.point[own], loads.force[own],
        )  # fmt: skip
    decision.state[rows[proved]] = STANDS
    decision.count("carried", int(proved.sum()))
