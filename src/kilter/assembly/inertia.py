"""Stated moments of inertia: six numbers of a symmetric tensor, and their validation.

The numbers are xx, yy, zz, xy, xz, yz of the tensor about the centre of mass,

    I = integral of (|r|^2 E - r r^T) dm,    so that xy = -integral of x y dm [kg x length unit^2].

A body has principal moments a <= b <= c with a > 0 and c <= a + b, since a + b - c is twice the
integral of the square of a coordinate.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly.assembly_tolerances import INERTIA_ROUNDING, THIN_INERTIA
from kilter.errors import InputError
from kilter.validate import finite, in_range

__all__ = ["inertia_fault", "inertia_matrix", "inertia_numbers", "valid_inertia"]


def inertia_matrix(numbers: Array) -> Array:
    """The symmetric matrix of xx, yy, zz, xy, xz, yz, shape (3, 3).

    Examples
    --------
    >>> inertia_matrix(np.array([1, 2, 3, 4, 5, 6])).tolist()
    [[1, 4, 5], [4, 2, 6], [5, 6, 3]]
    """
    matrix: Array = numbers[np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])]
    return matrix


def inertia_numbers(matrix: Array) -> Array:
    """The numbers xx, yy, zz, xy, xz, yz of a symmetric matrix, shape (6,)."""
    return matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def inertia_fault(matrix: Array) -> str:
    """The reason why no body has this inertia; empty if a body can have it.

    Examples
    --------
    >>> inertia_fault(np.diag([1.0, 1.0, 1.0])), inertia_fault(np.diag([1.0, 1.0, 3.0]))
    ('', 'its principal moments are 1, 1, 3: the largest exceeds the sum of the others')
    """
    moments = np.linalg.eigvalsh(matrix)
    words = f"its principal moments are {', '.join(f'{moment:.4g}' for moment in moments)}"
    if not moments[0] > THIN_INERTIA * abs(moments[2]):
        return f"{words}: the least is not positive"
    if moments[2] > (1 + INERTIA_ROUNDING) * (moments[0] + moments[1]):
        return f"{words}: the largest exceeds the sum of the others"
    return ""


def valid_inertia(values: Any) -> Array:
    """Copy six numbers of an inertia that a body can have to a read-only array.

    Raises `InputError` if there are not six finite numbers, or no body has this inertia.
    """
    numbers = finite(values, (6,), "inertia")
    in_range(numbers, "inertia")
    fault = inertia_fault(inertia_matrix(numbers))
    if fault:
        raise InputError(
            f"inertia is {numbers.tolist()}, but {fault}",
            hint="give xx, yy, zz, xy, xz, yz about the centre of mass",
        )
    return numbers
