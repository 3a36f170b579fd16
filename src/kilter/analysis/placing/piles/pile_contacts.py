"""Contacts of axis-parallel boxes in closed form: where a box lands, and what it touches there.

A box is lowered straight down. It passes beside a box of the pile if their overlap from above is at
most the gap tolerance of the pair, and lands on the highest top below it. Its contacts there are
rectangles, and the tolerances are those of `kilter.contact.common.gaps` and
`kilter.contact.open_pairs`:

    carries      both faces are within the gap tolerance, and the rectangle is wider than twice it
    may carry    also thinner rectangles, whose edges may carry
    unsure       faces nearer than the loose tolerance that do not touch: any force and torque
    beside       touching sides; without friction and walls they carry no force (`pile_statics`)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask
from kilter.contact.contact_tolerances import GAP, LOOSE_GAP, MEETS_EXACTLY, THICKNESS

THIN = 2.0
"""A contact narrower than this many gap tolerances is no area of contact [-]."""
ACCURACY = 2.0**-52
"""Accuracy of a coordinate over the largest coordinate of its part [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class BoxRows:
    """Axis-parallel boxes as arrays; row 0 is the held base."""

    low: Array
    high: Array
    """Corners with the least and the greatest coordinates [length unit], shape (n, 3)."""
    mass: Array
    """[kg], shape (n,); that of the base is unused."""

    def __len__(self) -> int:
        return len(self.mass)

    @property
    def center(self) -> Array:
        """Centres of mass, shape (n, 3)."""
        return (self.low + self.high) / 2

    @property
    def size(self) -> Array:
        """Diagonals, the size that tolerances are relative to, shape (n,) [length unit]."""
        diagonal: Array = np.linalg.norm(self.high - self.low, axis=1)
        return diagonal

    @property
    def radius(self) -> Array:
        """Bounding radii, shape (n,) [length unit]."""
        return self.size / 2

    @property
    def thickness(self) -> Array:
        """Twice the volume over the surface, shape (n,) [length unit]."""
        inverse: Array = (1.0 / (self.high - self.low)).sum(axis=1)
        return 1.0 / inverse

    @property
    def accuracy(self) -> Array:
        """Rounding error of the coordinates, shape (n,) [length unit]."""
        largest: Array = np.maximum(np.abs(self.low), np.abs(self.high)).max(axis=1)
        return ACCURACY * largest


def joined_boxes(boxes: BoxRows, more: BoxRows) -> BoxRows:
    """The boxes of both, in order."""
    return BoxRows(
        *(
            np.concatenate([getattr(boxes, name), getattr(more, name)])
            for name in ("low", "high", "mass")
        )
    )


@dataclass(frozen=True, slots=True, eq=False)
class Touching:
    """Contacts of a box at m places with the n boxes of a pile."""

    corner: Array
    """Corner of the box with the least coordinates [length unit], shape (m, 2)."""
    height: Array
    """Height of its underside [length unit], shape (m,)."""
    low: Array
    high: Array
    """Rectangle in which the box and a box of the pile overlap from above, shape (m, n, 2)."""
    carries: Mask
    may_carry: Mask
    beside: Mask
    near: Mask
    """As in the docstring of the module, shape (m, n); `near` pairs are unsure."""
    doubtful: Mask
    """Edges or corners meet (this matters with friction only), shape (m,)."""
    drop: Array
    """Height of the underside over each top [length unit], shape (m, n)."""

    @property
    def unsure(self) -> Mask:
        """Places at which a near pair is unsure, shape (m,)."""
        return np.asarray(self.near.any(axis=1))


def touching(boxes: BoxRows, size: Array, corner: Array) -> Touching:
    """Lower a box onto the pile at many places, and find its contacts.

    Parameters
    ----------
    boxes : BoxRows
    size : ndarray, shape (3,)
        Size of the new box [length unit].
    corner : ndarray, shape (m, 2)
        Places of its corner with the least coordinates; they lie within the base.
    """
    low = np.maximum(corner[:, None], boxes.low[None, :, :2])
    high = np.minimum(corner[:, None] + size[:2], boxes.high[None, :, :2])
    over = high - low
    new = BoxRows(np.zeros((1, 3)), size[None], np.ones(1))
    farthest = float(boxes.high.max() + size.max())
    smaller = np.minimum(boxes.size, new.size[0])
    thin = THICKNESS * np.minimum(boxes.thickness, new.thickness[0])
    rounding = 2 * (boxes.accuracy + ACCURACY * farthest)
    gap = np.maximum(np.minimum(GAP * smaller, thin), rounding)
    loose = np.maximum(LOOSE_GAP * smaller, gap)

    narrow = over.min(axis=2)
    top = boxes.high[:, 2]
    height = np.where(narrow > gap, top, -np.inf).max(axis=1)
    drop = height[:, None] - top
    meets = narrow >= -gap
    level = np.abs(drop) <= gap
    # two edges that meet part sideways, so without friction they carry nothing
    may_carry = np.asarray((narrow > MEETS_EXACTLY * smaller) & level)
    carries = may_carry & (narrow >= THIN * gap)
    unsure = (drop > gap) & (drop <= loose) & (narrow > THIN * gap)

    # sides: the gap along one axis, the overlap along the other and along the vertical
    tall = np.minimum(top, height[:, None] + size[2]) - np.maximum(boxes.low[:, 2], height[:, None])
    beside = np.zeros_like(carries)
    meets_side = np.zeros_like(carries)
    for axis in (0, 1):
        apart, along = -over[..., axis], np.minimum(over[..., 1 - axis], tall)
        touches = (np.abs(apart) <= gap) & (along >= -gap)
        wide = along >= THIN * gap
        beside |= touches & wide
        meets_side |= touches & ~wide & ~level
        unsure |= (apart > gap) & (apart <= loose) & wide
    # an underside of the pile level with the top of the new box, above its edge
    under = np.abs(boxes.low[:, 2] - height[:, None] - size[2]) <= loose
    overhung = under & (narrow > MEETS_EXACTLY * smaller)
    unsure |= overhung
    doubtful = (meets_side & ~beside) | (meets & ((level & ~carries) | (under & ~overhung)))
    return Touching(
        corner,
        height,
        low,
        high,
        carries,
        may_carry,
        beside,
        unsure,
        doubtful.any(axis=1),
        drop,
    )
