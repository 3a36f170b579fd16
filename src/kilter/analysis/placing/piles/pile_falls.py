"""Places at which a box falls: it tips off alone, or a known motion of the pile has power.

A box whose centre lies beside all its contacts turns about the nearest of them, while the pile
rests. In a motion of the pile the box falls as far as its contacts permit: to the upper envelope of
the heights of the contact points at its centre, which is the highest of the triangles around it.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.placing.piles.pile_hulls import (
    absolute_plane,
    plane_through,
    surround,
    surrounding_triangles,
)
from kilter.analysis.placing.piles.pile_question import (
    FALLS,
    OPEN,
    PlaceDecision,
    PlaceQuestion,
    check_falls,
)
from kilter.analysis.placing.piles.pile_statics import heights_of
from kilter.arrays import Index
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE

__all__ = ["fall_with_pile", "tip_alone"]

WIDEST_ENVELOPE = 20
"""Number of contact points of a box up to which motions of the pile are tried; all triangles of
them are."""


def tip_alone(asked: PlaceQuestion, decision: PlaceDecision) -> None:
    """Places whose centre lies beside the hull of all contact points."""
    found = surround(asked.points, asked.valid)
    rows = np.flatnonzero(~found.inside & ~asked.unsure)
    away = found.away[rows]
    height = -np.einsum("mqi,mi->mq", asked.points[rows], away)
    height = np.where(asked.valid[rows], height, np.inf)
    depth = np.minimum(height.min(axis=1), asked.radius)
    # the field falls at the centre, and is 0 at the nearest contact point
    size = np.hypot(depth, asked.radius)
    size = np.where(np.abs(away).sum(axis=1) > 0, size, depth)
    closing = np.maximum(-(height - depth[:, None]).min(axis=1, initial=0.0), 0.0)
    holds = (depth > TOLERANCE * size) & (depth >= RULED_OUT * closing)
    for row, direction, low in zip(
        rows[holds].tolist(), away[holds], depth[holds].tolist(), strict=True
    ):
        decision.motions[row] = (
            None,
            np.array([direction @ asked.center[row] - low, -direction[0], -direction[1]]),
        )
    decision.state[rows[holds]] = FALLS
    decision.count("tips alone", int(holds.sum()))


def fall_with_pile(asked: PlaceQuestion, decision: PlaceDecision, which: Index) -> None:
    """Places that fall by some of the known motions of the pile, by number."""
    pile = asked.pile
    motions = pile.motions
    which = which[motions.sure[which]]
    rows = np.flatnonzero((decision.state == OPEN) & ~asked.unsure)
    many = asked.valid[rows].sum(axis=1) > WIDEST_ENVELOPE
    rows = rows[~many]
    if not len(which) or not len(rows):
        return
    used = int(asked.valid[rows].sum(axis=1).max(initial=0))
    points, valid = asked.points[rows, :used], asked.valid[rows, :used]
    box = asked.box[rows, :used]
    place, corner, weight = surrounding_triangles(points, valid)
    if not len(place):
        return
    rows_with, start = np.unique(place, return_index=True)
    best_power = np.full(len(rows), -np.inf)
    best = np.zeros((len(rows), 2), dtype=np.int64)
    heights = {}
    for k in which.tolist():
        at = points + asked.center[rows][:, None]
        height = heights_of(motions.motion[k][box], at[..., None, :])[..., 0]
        heights[k] = height
        value = (height[place[:, None], corner] * weight).sum(axis=1)
        top = np.maximum.reduceat(value, start)
        power = motions.power[k] - asked.weight * top
        better = power > best_power[rows_with]
        improved = rows_with[better]
        best_power[improved] = power[better]
        best[improved, 0] = k
        # the triangle of the envelope
        is_top = value >= np.repeat(top, np.diff(np.append(start, len(value))))
        triangle = np.full(len(rows), -1)
        triangle[place[is_top][::-1]] = np.flatnonzero(is_top)[::-1]
        best[improved, 1] = triangle[improved]
    falling = np.flatnonzero(best_power > 0)
    if not len(falling):
        return
    chosen = np.stack([heights[k][row] for row, k in zip(falling, best[falling, 0], strict=True)])
    triangle = best[falling, 1]
    support = corner[triangle]
    plane = plane_through(
        points[falling[:, None], support], np.take_along_axis(chosen, support, axis=1)
    )
    under = chosen - (plane[:, :1] + np.einsum("mqi,mi->mq", points[falling], plane[:, 1:]))
    lift = np.where(valid[falling], under, -np.inf).max(axis=1)
    plane[:, 0] += np.maximum(lift, 0.0)
    holds = check_falls(asked, best[falling, 0], plane, np.zeros(len(falling)))
    for row, k, field_ in zip(
        rows[falling[holds]].tolist(), best[falling[holds], 0].tolist(), plane[holds], strict=True
    ):
        decision.motions[row] = motions.motion[k], absolute_plane(field_, asked.center[row])
    decision.state[rows[falling[holds]]] = FALLS
    decision.count("falls with the pile", int(holds.sum()))
