"""Places of a box on a pile with friction: the remaining places as programs in Coulomb's cones.

Forces without friction are also forces with friction. A box that tips off alone, turning about a
line through its own contacts, slides nowhere, so its motion is a proof with friction too if nothing
is beside it. Every other place is decided as `kilter.check` decides it, from rows in closed form.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.placing.piles.pile_contacts import BoxRows, Touching
from kilter.analysis.placing.piles.pile_question import FALLS, OPEN, STANDS, PlaceDecision
from kilter.analysis.placing.piles.pile_statics import rectangle_corners
from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.contact import detect
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT, ForceRows

__all__ = ["decide_rough", "rough_program"]

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
