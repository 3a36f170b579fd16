"""Equilibrium of a pile of boxes without friction, as arrays, and the check of its proofs.

Boxes on a level base push each other up, and no force along x or y exists: of all boxes that push
each other along x, nothing pushes the first one back. So a box has three equations, and a motion of
it is an affine field of heights, w(x, y) = a + b x + c y:

    sum of the forces at its contacts = its weight,  both moments about its centre = 0
    w of the upper box >= w of the lower box at the corners of each contact

Horizontal motions, each box away from the origin as in a similarity, open all contacts of sides
without power: so a field of heights is a motion of the whole pile.

Both checks have the criteria and tolerances of `kilter.mechanics.certificate`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.analysis.placing.piles.pile_contacts import BoxRows, joined_boxes
from kilter.arrays import Array, Index, Mask
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE, UNITS_IN_LAST_PLACE


@dataclass(frozen=True, slots=True, eq=False)
class PileContacts:
    """Contacts between boxes of a pile."""

    lower: Index
    """The lower box of each contact, shape (c,)."""
    upper: Index
    """The upper box of each contact, shape (c,)."""
    low: Array
    """The least corner of the rectangle of each contact [length unit], shape (c, 2)."""
    high: Array
    """The greatest corner of this rectangle [length unit], shape (c, 2)."""
    sure: Mask
    """False for contacts that may carry a force, but without a certain area, shape (c,)."""
    unsure: Index
    """Pairs of near boxes that may transmit any force and torque, shape (u, 2)."""

    @classmethod
    def none(cls) -> PileContacts:
        """No contacts."""
        index = np.empty(0, dtype=np.int64)
        return cls(
            index, index, np.empty((0, 2)), np.empty((0, 2)), index > 0, np.empty((0, 2), np.int64)
        )

    def join(self, more: PileContacts) -> PileContacts:
        """The contacts of both, in order."""
        return PileContacts(
            *(
                np.concatenate([getattr(self, name), getattr(more, name)])
                for name in ("lower", "upper", "low", "high", "sure", "unsure")
            )
        )

    @property
    def corners(self) -> Array:
        """Corners of each rectangle, shape (c, 4, 2)."""
        return rectangle_corners(self.low, self.high)


def rectangle_corners(low: Array, high: Array) -> Array:
    """Corners of rectangles, anticlockwise, shape (..., 4, 2)."""
    x = np.stack([low[..., 0], high[..., 0], high[..., 0], low[..., 0]], axis=-1)
    y = np.stack([low[..., 1], low[..., 1], high[..., 1], high[..., 1]], axis=-1)
    return np.stack([x, y], axis=-1)


@dataclass(eq=False)
class PileStatics:
    """Equations of the free boxes of a pile.

    Box j of the pile has the rows 3 (j - 1) to 3 j: force, and moments about its centre over its
    radius. Contact c has the columns 4 c to 4 c + 4, a corner each.
    """

    boxes: BoxRows
    contacts: PileContacts
    weight: Array
    """[N]; that of the base is 0, shape (n,)."""
    center: Array = field(init=False)
    radius: Array = field(init=False)

    def __post_init__(self) -> None:
        self.center = self.boxes.center
        self.radius = self.boxes.radius

    @property
    def columns(self) -> int:
        """Number of corners of all contacts."""
        return 4 * len(self.contacts.lower)

    def levers(self, box: Index, point: Array) -> Array:
        """Force and moments, over the radius, of a unit force up at points on boxes, (..., 3)."""
        arm = (point - self.center[box, :2]) / self.radius[box][..., None]
        return np.concatenate([np.ones((*arm.shape[:-1], 1)), arm], axis=-1)

    def entries(self, possible: bool = False) -> tuple[Index, Index, Array]:
        """Row, column and value of the entries of the matrix; forces in N, rows in N.

        If `possible` is true, contacts without a certain area carry too.
        """
        contacts = self.contacts
        points = contacts.corners.reshape(-1, 2)
        rows, columns, values = [], [], []
        for ends, sign in ((contacts.upper, 1.0), (contacts.lower, -1.0)):
            box = np.repeat(ends, 4)
            chosen = np.flatnonzero((box > 0) & np.repeat(contacts.sure | possible, 4))
            lever = sign * self.levers(box[chosen], points[chosen])
            rows.append((3 * (box[chosen] - 1)[:, None] + np.arange(3)).ravel())
            columns.append(np.repeat(chosen, 3))
            values.append(lever.ravel())
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(values)

    def wrenches(self, forces: Array) -> Array:
        """Sum of the forces and moments on each box, shape (m, n, 3), of forces, shape (m, 4 c)."""
        from scipy.sparse import csr_array

        rows, columns, values = self.entries()
        matrix = csr_array(
            (values, (rows, columns)), shape=(3 * (len(self.boxes) - 1), self.columns)
        )
        total = np.zeros((len(forces), len(self.boxes), 3))
        total[:, 1:] = (matrix @ forces.T).T.reshape(len(forces), -1, 3)
        return total

    def sums(self, forces: Array) -> Array:
        """Sum of the forces on each box [N], shape (m, n)."""
        count = len(self.boxes)
        per = np.abs(forces).reshape(len(forces), -1, 4).sum(axis=2)
        total = np.zeros((len(forces), count))
        for ends in (self.contacts.upper, self.contacts.lower):
            np.add.at(total.T, ends, per.T)
        return total

    def balanced(self, forces: Array, load: Array, added: Array) -> Mask:
        """Whether forces prove that the pile carries a load, shape (m,).

        Arguments: `forces` (m, 4 c): at the corners of the contacts [N]; `load` (m, n, 3): further
        wrenches on the boxes: force up [N], moments over the radius [N]; `added` (m, n): sum of the
        forces of this load [N].
        """
        push = (forces >= 0).all(axis=1)
        uncertain = np.repeat(~self.contacts.sure, 4)
        push &= ~(forces[:, uncertain] > 0).any(axis=1)
        imbalance = self.wrenches(forces) + load
        imbalance[:, :, 0] -= self.weight
        size = np.sqrt((imbalance**2).sum(axis=2))[:, 1:]
        weight = self.weight[1:]
        sums = (self.sums(forces) + added)[:, 1:]
        total = weight.sum() + np.abs(load[:, :, 0]).sum(axis=1)
        balanced = size <= TOLERANCE * weight + UNITS_IN_LAST_PLACE * sums
        balanced &= sums <= RULED_OUT * total[:, None]
        result: Mask = push & balanced.all(axis=1)
        return result

    def openings(self, motion: Array) -> Array:
        """Opening of each corner of all contacts, the uncertain too, shape (..., 4 c)."""
        contacts = self.contacts
        points = contacts.corners
        up = heights_of(motion[..., contacts.upper, :], points)
        down = heights_of(motion[..., contacts.lower, :], points)
        opening: Array = (up - down).reshape(*motion.shape[:-2], -1)
        return opening

    def sizes(self, motion: Array) -> Array:
        """Size of the motion of each box: the speed of its centre, or angle x radius, (..., n)."""
        speed = heights_of(motion, self.center[:, None, :2])[..., 0]
        turn = (motion[..., 1:] ** 2).sum(axis=-1) * self.radius**2
        size: Array = np.sqrt(speed**2 + turn)
        return size

    def power(self, motion: Array) -> Array:
        """Power of the weights in motions, shape (..., n, 3) [N]."""
        power: Array = -heights_of(motion, self.center[:, None, :2])[..., 0] @ self.weight
        return power

    def excluded(self, motion: Array) -> Mask:
        """Boxes that a motion moves against an unsure neighbour: shape (u,)."""
        a, b = self.contacts.unsure.T
        relative = motion[a] - motion[b]
        size = np.abs(relative[:, 0]) + np.abs(relative[:, 1:]).sum(axis=1) * self.radius[a]
        moves: Mask = size > 0
        return moves

    def with_box(self, box: BoxRows, contacts: PileContacts, weight: float) -> PileStatics:
        """The pile with a further box and its contacts."""
        return PileStatics(
            joined_boxes(self.boxes, box),
            self.contacts.join(contacts),
            np.append(self.weight, weight),
        )


def heights_of(motion: Array, points: Array) -> Array:
    """Fields of heights, shape (..., k, 3), at points, shape (k, q, 2) each: shape (..., k, q)."""
    value: Array = (
        motion[..., 0, None]
        + motion[..., 1, None] * points[..., 0]
        + motion[..., 2, None] * points[..., 1]
    )
    return value
