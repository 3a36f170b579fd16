"""Programs of the places that no known load and no known motion decides.

A program is solved for the outermost places of a group on the same tops. Its forces, or its motion,
then decide most other places of the group.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.placing.piles.pile_carried import carry
from kilter.analysis.placing.piles.pile_contacts import Touching
from kilter.analysis.placing.piles.pile_hulls import (
    absolute_plane,
    plane_through,
    surround,
    surrounding_triangles,
)
from kilter.analysis.placing.piles.pile_program import PlaceAnswer
from kilter.analysis.placing.piles.pile_question import (
    FALLS,
    OPEN,
    STANDS,
    PlaceDecision,
    PlaceQuestion,
    ask_places,
    check_carried,
    check_falls,
)
from kilter.analysis.placing.piles.pile_state import Pattern, PileState
from kilter.analysis.placing.piles.pile_statics import heights_of
from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE

# Places at which a box falls: it tips off alone, or a known motion of the pile has power.


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


WHOLE = 1 - 1e-6
"""Share of the weight from which the forces of a program are checked as a proof [-]."""


def solve_open_places(asked: PlaceQuestion, decision: PlaceDecision) -> None:
    """Solve programs of open places until none is left; the answers decide further places."""
    tried = np.zeros(len(decision.state), dtype=bool)
    pile = asked.pile
    while True:
        rows = np.flatnonzero((decision.state == OPEN) & ~tried)
        if not len(rows):
            return
        group = _largest_group(asked, rows)
        known = len(pile.motions.power)
        found = False
        for row in _outermost(asked.center[group]):
            tried[group[row]] = True
            found |= _solve_place(asked, decision, int(group[row]))
        if found:
            tops = np.flatnonzero(asked.touch.carries[group[0]])
            carry(asked, decision, np.asarray(asked.touch.carries[:, tops].any(axis=1)))
        if len(pile.motions.power) > known:
            fall_with_pile(asked, decision, np.arange(known, len(pile.motions.power)))


def _largest_group(asked: PlaceQuestion, rows: Index) -> Index:
    """The largest group of open places on the same tops."""
    carries = np.packbits(asked.touch.carries[rows], axis=1)
    _, group, count = np.unique(carries, axis=0, return_inverse=True, return_counts=True)
    largest: Index = rows[group.reshape(-1) == count.argmax()]
    return largest


def _outermost(center: Array) -> list[int]:
    """The outermost places of a group along both diagonals: at most four."""
    along = center @ np.array([[1.0, 1.0], [1.0, -1.0]])
    return list(dict.fromkeys([*along.argmax(axis=0).tolist(), *along.argmin(axis=0).tolist()]))


def _solve_place(asked: PlaceQuestion, decision: PlaceDecision, row: int) -> bool:
    """Decide a place by a program; return whether forces were found that others may use.

    A motion must exclude the contacts that may carry too. If there are any, it comes from a second
    program, which is the only one if the centre lies beside the certain contacts.
    """
    pile = asked.pile
    points, sure, valid = asked.points[row], asked.sure[row], asked.valid[row]
    only_sure = bool((sure == valid).all() and pile.statics.contacts.sure.all())
    if only_sure or surround(points[None], sure[None]).inside[0]:
        decision.programs += 1
        answer = _ask_program(asked, row, sure, possible=False)
        if answer.share >= WHOLE and _accept_forces(asked, decision, row, answer):
            return pile.forces is not None
        if only_sure:
            _accept_motion(asked, decision, row, answer)
            return False
    decision.programs += 1
    _accept_motion(asked, decision, row, _ask_program(asked, row, valid, possible=True))
    return False


def _ask_program(asked: PlaceQuestion, row: int, chosen: Mask, possible: bool) -> PlaceAnswer:
    """Solve the program of a place with the chosen contact points."""
    center = asked.center[row]
    points = asked.points[row, chosen] + center
    program = asked.pile.program(possible)
    return program.solve(asked.box[row, chosen], points, center, asked.radius, asked.weight)


def _accept_forces(
    asked: PlaceQuestion, decision: PlaceDecision, row: int, answer: PlaceAnswer
) -> bool:
    """Check the forces that a program proposes for a place, and keep them."""
    pile, sure = asked.pile, asked.sure[row]
    box, points = asked.box[row, sure], asked.points[row, sure] + asked.center[row]
    line = np.zeros(len(box), dtype=np.int64)
    forces = answer.forces[None]
    if not check_carried(asked, np.array([row]), forces, line, box, points, answer.pushes)[0]:
        return False
    decision.state[row] = STANDS
    decision.forces[row] = answer.forces, box, points, answer.pushes
    decision.count("programs", 1)
    if pile.forces is not None:
        _remember(asked, answer.forces, box, points, answer.pushes)
    return True


def _accept_motion(
    asked: PlaceQuestion, decision: PlaceDecision, row: int, answer: PlaceAnswer
) -> None:
    """Check the motion that a program proposes for a place, and keep it."""
    pile, valid, center = asked.pile, asked.valid[row], asked.center[row]
    if not np.isfinite(answer.motion).all() or asked.unsure[row]:
        return
    scale = max(float(pile.statics.sizes(answer.motion).max(initial=0.0)), TINY)
    if not (pile.add_motion(answer.motion) and pile.motions.sure[-1]):
        return
    at, motion = asked.points[row, valid], pile.motions.motion[-1]
    height = heights_of(motion[asked.box[row, valid]], (at + center)[:, None])[:, 0]
    plane = answer.plane / scale
    plane = np.array([plane[0] + plane[1:] @ center, plane[1], plane[2]])
    plane[0] += max(float((height - plane[0] - at @ plane[1:]).max(initial=0.0)), 0.0)
    number = np.array([len(pile.motions.power) - 1])
    if check_falls(asked, number, plane[None], np.zeros(1))[0]:
        decision.state[row] = FALLS
        decision.motions[row] = motion, absolute_plane(plane, center)
        decision.count("programs", 1)


def _remember(
    asked: PlaceQuestion, forces: Array, box: Index, points: Array, pushes: Array
) -> None:
    """Keep the forces of a program as a point, or as a pattern on several tops."""
    pile = asked.pile
    assert pile.forces is not None
    boxes = np.unique(box[pushes > 0])
    change = (forces - pile.forces) / asked.weight
    total = np.array([pushes[box == k].sum() for k in boxes])
    places = np.array([pushes[box == k] @ points[box == k] for k in boxes]) / total[:, None]
    shares = total / total.sum()
    number = pile.carried.add(shares @ places, asked.weight, change)
    if len(boxes) == 1:
        pile.carried.points.setdefault(int(boxes[0]), []).append(number)
    else:
        resultant = shares @ places
        pattern = Pattern(number, asked.weight, resultant, boxes, places, shares)
        pile.carried.patterns.append(pattern)


# Decide at many places at once whether a pile carries a further box there, without friction.


def decide_places(
    pile: PileState, size: Array, weight: float, touch: Touching, *, programs: bool = True
) -> PlaceDecision:
    """Decide the places of a box.

    Arguments: `size` (3,) [length unit]; `weight` [N].
    """
    asked = ask_places(pile, size, weight, touch)
    decision = PlaceDecision(np.zeros(len(touch.corner), dtype=np.int64))
    tip_alone(asked, decision)
    carry(asked, decision)
    fall_with_pile(asked, decision, np.arange(len(pile.motions.power)))
    if programs:
        solve_open_places(asked, decision)
    return decision
