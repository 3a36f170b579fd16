"""Programs of the places that no known load and no known motion decides.

A program is solved for the outermost places of a group on the same tops. Its forces, or its motion,
then decide most other places of the group.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.placing.piles.pile_carried import carry
from kilter.analysis.placing.piles.pile_falls import fall_with_pile
from kilter.analysis.placing.piles.pile_hulls import absolute_plane, surround
from kilter.analysis.placing.piles.pile_program import PlaceAnswer
from kilter.analysis.placing.piles.pile_question import (
    FALLS,
    OPEN,
    STANDS,
    PlaceDecision,
    PlaceQuestion,
    check_carried,
    check_falls,
)
from kilter.analysis.placing.piles.pile_state import Pattern
from kilter.analysis.placing.piles.pile_statics import heights_of
from kilter.arrays import TINY, Array, Index, Mask

__all__ = ["solve_open_places"]

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
