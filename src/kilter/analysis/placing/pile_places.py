"""Decide at many places at once whether a pile carries a further box there, without friction.

The steps, each on all places that are still open:

1. no: the centre lies beside all contacts of the box, so the box tips off alone;
2. yes: the centre is a mean of places at which the full weight is carried, on one top or several
   (the polygons and patterns of `kilter.analysis.placing.pile_state`);
3. no: a known motion of the pile, under which the box falls as far as its contacts permit, has
   power. This depth is the upper envelope of the heights of the contact points at the centre;
4. a program of one open place. Its forces are a new point or pattern, its motion a new motion, for
   steps 2 and 3 on the other open places.

Every yes has forces and every no a motion that `PileStatics` checks independently of the solver.
Other places stay open.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from kilter.analysis.placing.pile_contacts import Touching
from kilter.analysis.placing.pile_hulls import fan_weights, surround, surrounding_triangles
from kilter.analysis.placing.pile_program import PlaceAnswer
from kilter.analysis.placing.pile_state import PileState
from kilter.analysis.placing.pile_statics import heights_of, rectangle_corners
from kilter.arrays import TINY, Array, Index, Mask
from kilter.contact.planar.polygons import clip_convex
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE

__all__ = ["FALLS", "OPEN", "STANDS", "Decision", "decide_places", "lowest_planes"]

OPEN, STANDS, FALLS = 0, 1, 2
"""States of a place."""
WIDEST_ENVELOPE = 20
"""Number of contact points of a box up to which step 3 is tried; all triangles of them are."""
WHOLE = 1 - 1e-6
"""Share of the weight from which the forces of a program are checked as a proof [-]."""
IN_CONTACT = 1e-12
"""Rounding of a point in a contact rectangle, over the size of the box [-]."""


@dataclass(eq=False)
class Decision:
    """States of places, and their proofs.

    Attributes
    ----------
    state : ndarray of int, shape (m,)
    forces : dict
        For each place that stands: forces at the corners of the contacts of the pile [N], and
        boxes, points and forces of the contact of the new box [N].
    motions : dict
        For each place that falls: fields of heights of the boxes of the pile, and of the new box.
    steps : dict of int
        Number of places that each step decided.
    programs : int
    """

    state: Index
    forces: dict[int, tuple[Array, Index, Array, Array]] = field(default_factory=dict)
    motions: dict[int, tuple[Array | None, Array]] = field(default_factory=dict)
    steps: dict[str, int] = field(default_factory=dict)
    programs: int = 0

    def count(self, step: str, number: int) -> None:
        """Add to the number of places that a step decided."""
        self.steps[step] = self.steps.get(step, 0) + number


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    """A box, its places and its contact points, padded to equal number.

    `points`, shape (m, 4 k, 2), are the corners of all contacts that may carry, relative to the
    centre; `box` and `valid`, shape (m, 4 k); `sure` marks those of an area, and
    `unsure`, shape (m,), places with an unsure pair.
    """

    pile: PileState
    touch: Touching
    center: Array
    radius: float
    weight: float
    points: Array
    box: Index
    valid: Mask
    sure: Mask
    unsure: Mask


def decide_places(
    pile: PileState, size: Array, weight: float, touch: Touching, *, programs: bool = True
) -> Decision:
    """Decide the places of a box.

    Parameters
    ----------
    pile : PileState
        What its programs find is added to it.
    size : ndarray, shape (3,)
        [length unit]
    weight : float
        [N]
    touch : Touching
        Contacts of the box at the m places.
    programs : bool
        Whether to solve programs (step 4).
    """
    asked = _question(pile, size, weight, touch)
    decision = Decision(np.zeros(len(touch.corner), dtype=np.int64))
    _tip_alone(asked, decision)
    _carry(asked, decision)
    _fall_with_pile(asked, decision, np.arange(len(pile.motions.power)))
    if programs:
        _by_programs(asked, decision)
    return decision


def _question(pile: PileState, size: Array, weight: float, touch: Touching) -> _Question:
    place, box = np.nonzero(touch.may_carry)
    m = len(touch.corner)
    count = np.bincount(place, minlength=m)
    slot = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count)
    most = int(count.max(initial=1))
    center = touch.corner + size[:2] / 2
    corners = rectangle_corners(touch.low[place, box], touch.high[place, box])
    points = np.zeros((m, most, 4, 2))
    points[place, slot] = corners - center[place][:, None]
    boxes = np.zeros((m, most), dtype=np.int64)
    boxes[place, slot] = box
    valid = np.zeros((m, most), dtype=bool)
    valid[place, slot] = True
    sure = np.zeros((m, most), dtype=bool)
    sure[place, slot] = touch.carries[place, box]
    return _Question(
        pile,
        touch,
        center,
        float(np.linalg.norm(size)) / 2,
        weight,
        points.reshape(m, -1, 2),
        np.repeat(boxes, 4, axis=1),
        np.repeat(valid, 4, axis=1),
        np.repeat(sure, 4, axis=1),
        touch.unsure,
    )


# step 1 --------------------------------------------------------------------------------------


def _tip_alone(asked: _Question, decision: Decision) -> None:
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
        decision.motions[row] = None, np.array(
            [direction @ asked.center[row] - low, -direction[0], -direction[1]]
        )
    decision.state[rows[holds]] = FALLS
    decision.count("tips alone", int(holds.sum()))


# step 2 --------------------------------------------------------------------------------------


def _carry(asked: _Question, decision: Decision, among: Mask | None = None) -> None:
    """Places whose centre is a mean of places at which the weight is carried.

    `among`, shape (m,), restricts the places.
    """
    pile, touch = asked.pile, asked.touch
    if pile.forces is None:
        return
    rows = np.flatnonzero((decision.state == OPEN) & (True if among is None else among))
    if not len(rows):
        return
    carried = pile.carried
    place, box = np.nonzero(touch.carries[rows])
    place = rows[place]
    polygons = {int(k): carried.polygon(int(k), asked.weight) for k in np.unique(box)}
    widest = max((len(entries) for entries in polygons.values()), default=0)
    entry = np.zeros((len(pile.statics.boxes), max(widest, 3)), dtype=np.int64)
    sides = np.zeros(len(entry), dtype=np.int64)
    for k, entries in polygons.items():
        sides[k] = len(entries)
        entry[k, : len(entries)] = entries
        entry[k, len(entries) :] = entries[-1] if len(entries) else 0
    usable = sides[box] >= 3
    place, box = place[usable], box[usable]
    rectangle = rectangle_corners(touch.low[place, box], touch.high[place, box])
    points, count = clip_convex(
        rectangle, np.full(len(place), 4), carried.point[entry[box]], sides[box]
    )
    count = np.where(count >= 3, count, 0)

    # points of a place side by side, then its patterns
    width = points.shape[1]
    number = np.searchsorted(rows, place)
    per_place = np.bincount(number, minlength=len(rows))
    slot = np.arange(len(place)) - np.repeat(np.cumsum(per_place) - per_place, per_place)
    most = int(per_place.max(initial=0))
    patterns = [p for p in carried.patterns if carried.most[p[0]] >= asked.weight]
    around = np.zeros((len(rows), most * width + len(patterns), 2))
    valid = np.zeros(around.shape[:2], dtype=bool)
    source = np.full((len(rows), most), -1)
    if len(place):
        block = around[:, : most * width].reshape(len(rows), most, width, 2)
        block[number, slot] = points - asked.center[place][:, None]
        valid_block = valid[:, : most * width].reshape(len(rows), most, width)
        valid_block[number, slot] = np.arange(width) < count[:, None]
        around[:, : most * width] = block.reshape(len(rows), -1, 2)
        valid[:, : most * width] = valid_block.reshape(len(rows), -1)
        source[number, slot] = np.arange(len(place))
    slack = IN_CONTACT * asked.radius
    for k, (_, boxes, at, _) in enumerate(patterns):
        in_contact = touch.carries[rows[:, None], boxes]
        in_contact &= (touch.low[rows[:, None], boxes] <= at + slack).all(axis=2)
        in_contact &= (touch.high[rows[:, None], boxes] >= at - slack).all(axis=2)
        valid[:, most * width + k] = in_contact.all(axis=1)
        around[:, most * width + k] = carried.point[patterns[k][0]] - asked.center[rows]
    if not valid.any():
        return
    found = surround(around, valid)
    inside = np.flatnonzero(found.inside)
    if not len(inside):
        return
    which, weight = found.which[inside], found.weight[inside]
    _prove_carried(
        asked, decision, rows[inside], which, weight * asked.weight,
        (source[inside], width, most, box, points, entry, sides, patterns),
    )  # fmt: skip


def _prove_carried(
    asked: _Question, decision: Decision, rows: Index, which: Index, force: Array, of: tuple
) -> None:
    """Write the forces of places from those of the entries, and check them."""
    source, width, most, box, points, entry, sides, patterns = of
    pile, carried = asked.pile, asked.pile.carried
    statics = pile.statics
    m = len(rows)
    line, corner = np.nonzero(which < most * width)
    chosen = which[line, corner]
    incidence = source[line, chosen // width]
    at = points[incidence, chosen % width]
    on = box[incidence]
    corners, share = fan_weights(at, carried.point[entry[on]], sides[on])
    of_load = force[line, corner]
    lines = [np.repeat(line, 3)]
    entries = [entry[on[:, None], corners].ravel()]
    values = [(of_load[:, None] * share).ravel()]
    load_line, load_box, load_at, load_force = [line], [on], [at], [of_load]
    for k, (number, boxes, places, shares) in enumerate(patterns):
        line, corner = np.nonzero(which == most * width + k)
        lines.append(line)
        entries.append(np.full(len(line), number))
        values.append(force[line, corner])
        load_line.append(np.repeat(line, len(boxes)))
        load_box.append(np.tile(boxes, len(line)))
        load_at.append(np.tile(places, (len(line), 1)))
        load_force.append(np.outer(force[line, corner], shares).ravel())
    mix = csr_array(
        (np.concatenate(values), (np.concatenate(lines), np.concatenate(entries))),
        shape=(m, len(carried.most)),
    )
    assert pile.forces is not None
    forces = pile.forces + (mix @ carried.change).toarray()
    loads = tuple(np.concatenate(part) for part in (load_line, load_box, load_at, load_force))
    proved = _check_carried(asked, rows, np.maximum(forces, 0.0), *loads)
    order = np.argsort(loads[0], kind="stable")
    load_line, load_box, load_at, load_force = (part[order] for part in loads)
    start = np.searchsorted(load_line, np.arange(m + 1))
    for k in np.flatnonzero(proved).tolist():
        part = slice(start[k], start[k + 1])
        decision.forces[int(rows[k])] = forces[k], load_box[part], load_at[part], load_force[part]
    decision.state[rows[proved]] = STANDS
    decision.count("carried", int(proved.sum()))


def _check_carried(
    asked: _Question,
    rows: Index,
    forces: Array,
    line: Index,
    box: Index,
    at: Array,
    force: Array,
) -> Mask:
    """Whether forces balance the pile and the box at places `rows`, shape (m,).

    The loads act at points `at` of boxes, at the place ``rows[line]``.
    """
    statics, touch, m = asked.pile.statics, asked.touch, len(rows)
    place = rows[line]
    low, high = touch.low[place, box], touch.high[place, box]
    at = np.clip(at, low, high)
    valid = touch.carries[place, box] & (force >= 0)
    arm = (at - asked.center[place]) / asked.radius
    sums = [np.bincount(line, force * a, minlength=m) for a in (np.ones(len(arm)), *arm.T)]
    total = np.bincount(line, np.abs(force), minlength=m)
    imbalance = np.sqrt((sums[0] - asked.weight) ** 2 + sums[1] ** 2 + sums[2] ** 2)
    own = imbalance <= TOLERANCE * np.maximum(asked.weight, total)
    own &= np.bincount(line, ~valid, minlength=m) == 0
    count = len(statics.boxes)
    load = np.zeros((m, count, 3))
    np.add.at(load, (line, box), -force[:, None] * statics.levers(box, at))
    added = np.zeros((m, count))
    np.add.at(added, (line, box), np.abs(force))
    result: Mask = own & statics.balanced(forces, load, added)
    return result


# step 3 --------------------------------------------------------------------------------------


def _fall_with_pile(asked: _Question, decision: Decision, which: Index) -> None:
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
    plane = _plane_through(
        points[falling[:, None], support], np.take_along_axis(chosen, support, axis=1)
    )
    under = chosen - (plane[:, :1] + np.einsum("mqi,mi->mq", points[falling], plane[:, 1:]))
    lift = np.where(valid[falling], under, -np.inf).max(axis=1)
    plane[:, 0] += np.maximum(lift, 0.0)
    holds = _check_falls(asked, best[falling, 0], plane, np.zeros(len(falling)))
    for row, k, field_ in zip(
        rows[falling[holds]].tolist(), best[falling[holds], 0].tolist(), plane[holds], strict=True
    ):
        decision.motions[row] = motions.motion[k], _absolute(field_, asked.center[row])
    decision.state[rows[falling[holds]]] = FALLS
    decision.count("falls with the pile", int(holds.sum()))


def _check_falls(asked: _Question, number: Index, plane: Array, closing: Array) -> Mask:
    """Whether motions of the pile, by number, and planes of the box about its centre are proofs.

    `closing` is by how much each closes a contact of the box. The weight of all boxes that move at
    all counts as moving, which is on the safe side.
    """
    motions = asked.pile.motions
    size = np.maximum(
        motions.size[number],
        np.hypot(plane[:, 0], np.linalg.norm(plane[:, 1:], axis=1) * asked.radius),
    )
    power = motions.power[number] - asked.weight * plane[:, 0]
    weight = motions.weight[number] + asked.weight
    closing = np.maximum(motions.violation[number], closing)
    holds: Mask = (power > TOLERANCE * weight * size) & (power >= RULED_OUT * closing * weight)
    return holds & np.isfinite(plane).all(axis=1)


def _plane_through(points: Array, heights: Array) -> Array:
    """Fields (a, b, c) through three points each, shape (m, 3)."""
    one, two = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    det = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    det = np.where(np.abs(det) > TINY, det, np.inf)
    up_one, up_two = heights[:, 1] - heights[:, 0], heights[:, 2] - heights[:, 0]
    b = (up_one * two[:, 1] - up_two * one[:, 1]) / det
    c = (up_two * one[:, 0] - up_one * two[:, 0]) / det
    a = heights[:, 0] - b * points[:, 0, 0] - c * points[:, 0, 1]
    return np.stack([a, b, c], axis=1)


def _absolute(plane: Array, center: Array) -> Array:
    """A field about a centre as a field about the origin."""
    return np.array([plane[0] - plane[1:] @ center, plane[1], plane[2]])


def lowest_planes(points: Array, heights: Array, center: Array) -> Array:
    """The planes above heights at points that are lowest at a centre, about the origin.

    Parameters
    ----------
    points : ndarray, shape (q, 2)
        Relative to the centre.
    heights : ndarray, shape (k, q)
    center : ndarray, shape (2,)

    Returns
    -------
    ndarray, shape (k, 3)
        NaN if the centre is outside of the hull of the points.
    """
    _, corner, weight = surrounding_triangles(points[None], np.ones((1, len(points)), dtype=bool))
    if not len(corner):
        return np.full((len(heights), 3), np.nan)
    best = (heights[:, corner] * weight).sum(axis=2).argmax(axis=1)
    support = corner[best]
    planes = _plane_through(points[support], np.take_along_axis(heights, support, axis=1))
    under = heights - planes[:, :1] - planes[:, 1:] @ points.T
    planes[:, 0] += np.maximum(under.max(axis=1), 0.0)
    return np.stack([_absolute(plane, center) for plane in planes])


# step 4 --------------------------------------------------------------------------------------


def _by_programs(asked: _Question, decision: Decision) -> None:
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
            _carry(asked, decision, asked.touch.carries[:, tops].any(axis=1))
        if len(pile.motions.power) > known:
            _fall_with_pile(asked, decision, np.arange(known, len(pile.motions.power)))


def _largest_group(asked: _Question, rows: Index) -> Index:
    """The largest group of open places on the same tops."""
    carries = np.packbits(asked.touch.carries[rows], axis=1)
    _, group, count = np.unique(carries, axis=0, return_inverse=True, return_counts=True)
    return rows[group.reshape(-1) == count.argmax()]


def _outermost(center: Array) -> list[int]:
    """The outermost places of a group along both diagonals: at most four."""
    along = center @ np.array([[1.0, 1.0], [1.0, -1.0]])
    return list(dict.fromkeys([*along.argmax(axis=0).tolist(), *along.argmin(axis=0).tolist()]))


def _solve_place(asked: _Question, decision: Decision, row: int) -> bool:
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


def _ask_program(asked: _Question, row: int, chosen: Mask, possible: bool) -> PlaceAnswer:
    """Solve the program of a place with the chosen contact points."""
    center = asked.center[row]
    points = asked.points[row, chosen] + center
    program = asked.pile.program(possible)
    return program.solve(asked.box[row, chosen], points, center, asked.radius, asked.weight)


def _accept_forces(asked: _Question, decision: Decision, row: int, answer: PlaceAnswer) -> bool:
    """Check the forces that a program proposes for a place, and keep them."""
    pile, sure = asked.pile, asked.sure[row]
    box, points = asked.box[row, sure], asked.points[row, sure] + asked.center[row]
    line = np.zeros(len(box), dtype=np.int64)
    forces = answer.forces[None]
    if not _check_carried(asked, np.array([row]), forces, line, box, points, answer.pushes)[0]:
        return False
    decision.state[row] = STANDS
    decision.forces[row] = answer.forces, box, points, answer.pushes
    decision.count("programs", 1)
    if pile.forces is not None:
        _remember(asked, answer.forces, box, points, answer.pushes)
    return True


def _accept_motion(asked: _Question, decision: Decision, row: int, answer: PlaceAnswer) -> None:
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
    if _check_falls(asked, number, plane[None], np.zeros(1))[0]:
        decision.state[row] = FALLS
        decision.motions[row] = motion, _absolute(plane, center)
        decision.count("programs", 1)


def _remember(asked: _Question, forces: Array, box: Index, points: Array, pushes: Array) -> None:
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
        pile.carried.patterns.append((number, boxes, places, shares))
