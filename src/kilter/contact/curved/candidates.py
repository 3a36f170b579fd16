"""Candidate contacts of two surfaces, as arrays, before the extent of their faces is tested."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns
from kilter.contact.contact_tolerances import FIT_PLAY

__all__ = [
    "CIRCLE", "LINE", "POINT", "SAME", "Candidates", "FormLimits", "dot", "make_candidates",
    "without_along",
]  # fmt: skip


POINT, LINE, CIRCLE, SAME = range(4)
"""Forms of contact; SAME means that both surfaces lie on each other, as a shaft and its hole."""


@dataclass(frozen=True, slots=True, eq=False)
class FormLimits(Rows):
    """Tolerances that decide whether surfaces coincide, are parallel, or touch with clearance.

    Attributes
    ----------
    gap : ndarray, shape (n,)
        Largest difference of coinciding surfaces [length unit].
    closed : ndarray, shape (n,)
        Widest gap that counts as closed, at least `gap` [length unit].
    angle : ndarray, shape (n,)
        Largest angle between parallel lines [rad].
    share : ndarray, shape (n,)
        Position at which a fit is closed: 0 at the core of the first surface, 1 at the core of the
        second [-].
    """

    gap: Array
    closed: Array
    angle: Array
    share: Array

    def fits(self, play: Array, radius: Array) -> Mask:
        """Mask of radial plays that count as a loose fit: wider than the gap tolerance."""
        result: Mask = (play > self.gap) & (play <= np.maximum(self.closed, FIT_PLAY * radius))
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Candidates(Rows):
    """Possible contacts of pairs of surfaces (point, line, circle or whole face), one per row.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Row of the pair of surfaces.
    form : ndarray of int, shape (n,)
        POINT, LINE, CIRCLE or SAME.
    at : ndarray, shape (n, 3)
        The point, a point of the line, or the centre of the circle, half-way in the gap.
    along : ndarray, shape (n, 3)
        Direction of the line, or axis of the circle. Of a point on the rim of i it is the direction
        in which the point leaves i; 0 for a point inside the face, which leaves along the normal.
    normal : ndarray, shape (n, 3)
        Unit normal from i to j. Of a circle: its components away from the axis and along it.
    radius : ndarray, shape (n,)
        Radius of the circle, or of the rim on which a point lies [length unit].
    gap, slope, swing : ndarray, shape (n,)
        Gap at `at` [length unit]; its rise along a line [-]; its largest deviation from the mean
        around a circle [length unit].
    play : ndarray, shape (n,)
        Gap all around a fit that only a clearance closes; 0: no such fit [length unit].
    bend : ndarray, shape (n,)
        Radius at which the gap opens beside the contact [length unit].
    rim : ndarray, shape (n,)
        Of a circle that is the end of a face: 1 if that face is i, 2 if it is j; else 0. The same
        for the tip of a face.
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
    rim: Array = columns()


def make_candidates(
    row: Index, form: int, at: Array, normal: Array, gap: Array, **more: Array
) -> Candidates:
    """Build candidate contacts of the same form; fields that are not given are zero."""
    count = len(row)
    zero, zeros = np.zeros(count), np.zeros((count, 3))
    return Candidates(
        row=row,
        form=np.full(count, form),
        at=at,
        along=more.get("along", zeros),
        normal=normal,
        radius=more.get("radius", zero),
        gap=gap,
        slope=more.get("slope", zero),
        swing=more.get("swing", zero),
        play=more.get("play", zero),
        bend=more.get("bend", zero),
        rim=more.get("rim", zero),
    )


def dot(a: Array, b: Array) -> Array:
    """Dot products of rows, shape (n,)."""
    result: Array = np.einsum("ij,ij->i", a, b)
    return result


def without_along(v: Array, axis: Array) -> Array:
    """Components of vectors perpendicular to unit axes, shape (n, 3)."""
    result: Array = v - dot(v, axis)[:, None] * axis
    return result
