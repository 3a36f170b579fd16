"""Candidate contacts of two surfaces, as arrays, before their faces are asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns
from kilter.contact.contact_tolerances import FIT_PLAY

__all__ = [
    "CIRCLE", "LINE", "POINT", "SAME", "Allowed", "Forms", "dot", "make_forms", "without_along",
]  # fmt: skip


POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME: one surface in its own counterpart."""


@dataclass(frozen=True, slots=True, eq=False)
class Allowed(Rows):
    """What counts as one surface, as closed, as parallel, of each pair of surfaces, shape (n,).

    Attributes
    ----------
    gap : ndarray, shape (n,)
        Surfaces that differ by up to this are one [length unit].
    closed : ndarray, shape (n,)
        The widest gap that counts as closed, at least `gap` [length unit].
    angle : ndarray, shape (n,)
        Lines up to this are parallel [rad].
    share : ndarray, shape (n,)
        Where a fit is closed, from the core of the first surface (0) to that of the second (1).
    """

    gap: Array
    closed: Array
    angle: Array
    share: Array

    def fits(self, play: Array, radius: Array) -> Mask:
        """Where play above the gap tolerance is that of a fit, or is closed, shape (n,)."""
        result: Mask = (play > self.gap) & (play <= np.maximum(self.closed, FIT_PLAY * radius))
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Forms(Rows):
    """Candidate contacts, one row each.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Row of the pair of surfaces.
    form : ndarray of int, shape (n,)
        POINT, LINE, CIRCLE or SAME.
    at : ndarray, shape (n, 3)
        The point; a point of the line; the centre of the circle, half-way in the gap.
    along : ndarray, shape (n, 3)
        Direction of the line, axis of the circle; of a point on the rim of i, the direction
        in which it leaves i (0: a point within its face, which leaves along the normal).
    normal : ndarray, shape (n, 3)
        Unit, from i to j. Of a circle: its components away from the axis and along it.
    radius : ndarray, shape (n,)
        Of the circle; of the rim that a point lies on [length unit].
    gap, slope, swing : ndarray, shape (n,)
        The gap at `at`; its rise along a line [-]; how much it varies about its mean
        around a circle [length unit].
    play : ndarray, shape (n,)
        The gap all around a fit that only a clearance closes; 0: not of that kind.
    bend : ndarray, shape (n,)
        Radius by which the gap opens beside the contact [length unit].
    """

    row: Index
    form: Index
    at: Array = columns(3)
    along: Array = columns(3)
    normal: Array = columns(3)
    radius: Array = columns()
    gap: Array = columns()
    slope: Array = columns()
    swing: Array = columns()
    play: Array = columns()
    bend: Array = columns()


def make_forms(row: Index, form: int, at: Array, normal: Array, gap: Array, **more: Array) -> Forms:
    """Candidates of one form; what is left out is zero."""
    count = len(row)
    zero, none = np.zeros(count), np.zeros((count, 3))
    return Forms(
        row=row,
        form=np.full(count, form),
        at=at,
        along=more.get("along", none),
        normal=normal,
        radius=more.get("radius", zero),
        gap=gap,
        slope=more.get("slope", zero),
        swing=more.get("swing", zero),
        play=more.get("play", zero),
        bend=more.get("bend", zero),
    )


def dot(a: Array, b: Array) -> Array:
    """Dot products of rows, shape (n,)."""
    result: Array = np.einsum("ij,ij->i", a, b)
    return result


def without_along(v: Array, axis: Array) -> Array:
    """Vectors less what they have along unit axes, shape (n, 3)."""
    result: Array = v - dot(v, axis)[:, None] * axis
    return result
