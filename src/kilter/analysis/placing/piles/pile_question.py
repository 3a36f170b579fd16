"""The question where a box stands on a pile, the decision, and the checks of its proofs.

Proposed forces and motions come from known loads, from known motions or from a program. Whatever
their source, they are checked here from the geometry and the weights alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.placing.piles.pile_contacts import BoxRows, Touching
from kilter.analysis.placing.piles.pile_state import PileState
from kilter.analysis.placing.piles.pile_statics import rectangle_corners
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact import detect
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT, ForceRows

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


# Places of a box on a pile with friction: the remaining places as programs in Coulomb's cones.


NEW = "new box"
"""Name of the box that is put down."""


def rough_program(assembly: Assembly) -> tuple[Program, bool]:
    """The program of a pile with friction, and whether it has no open pairs."""
    contacts = detect.contacts(assembly)
    return build_program(assembly, contacts), not contacts.open_pairs


def decide_rough(
    rough: tuple[Program, bool],
    boxes: BoxRows,
    mu: float,
    new: BoxRows,
    touch: Touching,
    decision: PlaceDecision,
) -> None:
    """Decide the places that the steps without friction leave open, or only exclude without it.

    Arguments: `mu` [-].
    """
    alone = np.zeros(len(decision.state), dtype=bool)
    alone[[row for row, proof in decision.motions.items() if proof[0] is None]] = True
    exact = np.where(touch.may_carry, touch.drop, 0.0) == 0.0
    alone &= ~touch.beside.any(axis=1) & ~touch.doubtful & exact.all(axis=1)
    rows = np.flatnonzero((decision.state != STANDS) & ~alone)
    decision.state[rows] = OPEN
    program, is_certain = rough
    certain = is_certain & ~touch.unsure & ~touch.doubtful
    for row in rows.tolist():
        decision.motions.pop(row, None)
        low = np.append(touch.corner[row], touch.height[row])
        placed = BoxRows(low + new.low, low + new.high, new.mass)
        judgement = judge(_with_box(program, boxes, mu, placed, touch, row))
        decision.programs += 1
        if judgement.stable:
            decision.state[row] = STANDS
        elif judgement.stable is False and certain[row]:
            decision.state[row] = FALLS
    decision.count("cones", int((decision.state[rows] != OPEN).sum()))


def _with_box(
    program: Program,
    boxes: BoxRows,
    mu: float,
    new: BoxRows,
    touch: Touching,
    row: int,
) -> Program:
    """The program with a further box at a place."""
    low, high = new.low[0], new.high[0]
    below = np.flatnonzero(touch.carries[row])
    middle = touch.height[row] - touch.drop[row, below] / 2
    flat = rectangle_corners(touch.low[row, below], touch.high[row, below])
    level = np.broadcast_to(middle[:, None, None], (len(below), 4, 1))
    up = np.array([0.0, 0.0, 1.0])
    faces = [(below, np.concatenate([flat, level], axis=2), np.tile(up, (len(below), 1)))]
    beside = np.flatnonzero(touch.beside[row])
    if len(beside):
        faces.append((beside, *_sides(boxes, beside, low, high)))
    part = np.concatenate([np.repeat(face[0], 4) for face in faces])
    count, number = len(part), len(program.names)
    zeros = np.zeros(count)
    rows = ForceRows(
        part_a=part,
        part_b=np.full(count, number),
        point=np.concatenate([face[1].reshape(-1, 3) for face in faces]),
        normal=np.concatenate([np.repeat(face[2], 4, axis=0) for face in faces]),
        kind=np.full(count, CONTACT),
        two_sided=zeros > 0,
        angular=zeros > 0,
        mu=np.full(count, mu),
        source=np.full(count, -1),
        doubt=zeros,
        pull=zeros,
        tied=zeros > 0,
        shear=np.full(count, np.nan),
        capacity=np.full(count, np.inf),
    )
    mass = float(new.mass[0])
    square = (high - low) ** 2
    inertia = mass / 12 * np.diag(square.sum() - square)
    free = program.with_rows(
        names=(*program.names, NEW),
        free=np.append(program.free, True),
        center=np.concatenate([program.center, new.center]),
        mass=np.append(program.mass, mass),
        inertia=np.concatenate([program.inertia, inertia[None]]),
        radius=np.append(program.radius, new.radius),
        applied=np.concatenate([program.applied, np.zeros((1, 6))]),
        clamp=np.concatenate([program.clamp, np.zeros((1, 6))]),
        tolerance=np.append(program.tolerance, TOLERANCE),
    )
    return free.with_force_rows(ForceRows.join([program.force_rows, rows]))


def _sides(boxes: BoxRows, which: Index, low: Array, high: Array) -> tuple[Array, Array]:
    """Corners, shape (k, 4, 3), and normals of the contacts of sides, from boxes to a new box."""
    corners, normals = np.zeros((len(which), 4, 3)), np.zeros((len(which), 3))
    for row, k in enumerate(which.tolist()):
        apart = np.maximum(boxes.low[k, :2] - high[:2], low[:2] - boxes.high[k, :2])
        axis = int(apart.argmax())
        other = 1 - axis
        is_right = low[axis] + high[axis] > boxes.low[k, axis] + boxes.high[k, axis]
        ends = (boxes.high[k, axis], low[axis]) if is_right else (boxes.low[k, axis], high[axis])
        from_low, to_high = np.maximum(boxes.low[k], low), np.minimum(boxes.high[k], high)
        plane = rectangle_corners(from_low[[other, 2]], to_high[[other, 2]])
        corners[row, :, axis] = (ends[0] + ends[1]) / 2
        corners[row][:, [other, 2]] = plane
        normals[row, axis] = 1.0 if is_right else -1.0
    return corners, normals
