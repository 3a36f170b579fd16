"""The question where a box stands on a pile, the decision, and the checks of its proofs.

Proposed forces and motions come from known loads, from known motions or from a program. Whatever
their source, they are checked here from the geometry and the weights alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.analysis.placing.piles.pile_contacts import Touching
from kilter.analysis.placing.piles.pile_state import PileState
from kilter.analysis.placing.piles.pile_statics import rectangle_corners
from kilter.arrays import Array, Index, Mask
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE

__all__ = [
    "FALLS",
    "OPEN",
    "STANDS",
    "PlaceDecision",
    "PlaceQuestion",
    "ask_places",
    "check_carried",
    "check_falls",
]

OPEN, STANDS, FALLS = 0, 1, 2
"""States of a place."""


@dataclass(eq=False)
class PlaceDecision:
    """States of places, and their proofs."""

    state: Index
    """Shape (m,)."""
    forces: dict[int, tuple[Array, Index, Array, Array]] = field(default_factory=dict)
    """For each place that stands: forces at the corners of the contacts of the pile [N], and
    boxes, points and forces of the contact of the new box [N]."""
    motions: dict[int, tuple[Array | None, Array]] = field(default_factory=dict)
    """For each place that falls: fields of heights of the boxes of the pile, and of the new box."""
    steps: dict[str, int] = field(default_factory=dict)
    """Number of places that each step decided."""
    programs: int = 0

    def count(self, step: str, number: int) -> None:
        """Add to the number of places that a step decided."""
        self.steps[step] = self.steps.get(step, 0) + number


@dataclass(frozen=True, slots=True, eq=False)
class PlaceQuestion:
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


def ask_places(pile: PileState, size: Array, weight: float, touch: Touching) -> PlaceQuestion:
    """The question of a box at places, with the corners of its contacts side by side."""
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
    return PlaceQuestion(
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


def check_carried(
    asked: PlaceQuestion,
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


def check_falls(asked: PlaceQuestion, number: Index, plane: Array, closing: Array) -> Mask:
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
