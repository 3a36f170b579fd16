"""Candidate contacts of two surfaces, as arrays, before their faces are asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Rows, columns

__all__ = [
    "CIRCLE", "LINE", "POINT", "SAME", "Forms", "dot", "make_forms", "without_along",
]  # fmt: skip


POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME: one surface in its own counterpart."""


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
