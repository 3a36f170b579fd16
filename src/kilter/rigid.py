"""Rotations, poses, and the checks of the numbers they are made of.

    x_world = R x_part + t,     R from the unit quaternion (w, x, y, z)

Angles are radians. A twist is (linear, angular), a wrench (force, torque).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.errors import InputError

__all__ = [
    "Pose",
    "frozen",
    "in_range",
    "number",
    "quaternion_to_matrix",
    "rotation_between",
    "skew",
    "unit",
]


def frozen(values: ArrayLike, shape: tuple[int, ...] | None = None) -> Array:
    """A read-only float64 copy of `values`.

    Raises
    ------
    InputError
        If the values are not numbers of the given shape (-1 = any length).
    """
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            f"expected numbers, got {repr(values)[:80]}", hint="give a list of numbers"
        ) from None
    if shape is not None and array.shape != shape and not _fits(array.shape, shape):
        wanted = " x ".join("n" if n == -1 else str(n) for n in shape)
        raise InputError(f"expected {wanted} numbers, got shape {array.shape}")
    array.flags.writeable = False
    return array


LARGEST = 1e100
"""Numbers above this, or below its inverse, are taken for mistakes."""


def number(value: Any, what: str, *, lowest: float = -np.inf, above: bool = False) -> float:
    """`value` as a finite float, at least (or above) `lowest`, and in range.

    Raises
    ------
    InputError
        If it is none; it names `what`.
    """
    bound = f"{'above' if above else 'at least'} {lowest:g}" if lowest > -np.inf else "finite"
    hint = f"give a number {bound}" if lowest > -np.inf else "give a finite number"
    if isinstance(value, bool | str) or value is None:
        raise InputError(f"{what} is {value!r}", hint=hint)
    result = float(value)
    if not np.isfinite(result) or result < lowest or (above and result == lowest):
        raise InputError(f"{what} is {result:g}", hint=hint)
    in_range(result, what)
    return result


def in_range(values: Any, what: str) -> None:
    """Refuse numbers so large or small that no digit of an answer would be right.

    Raises
    ------
    InputError
        If a number is not zero and its size is above 1e100 or below 1e-100.
    """
    size = float(np.abs(values).max())
    if size > LARGEST or 0 < size < 1 / LARGEST:
        raise InputError(
            f"{what} is of size {size:g}, out of range",
            hint="check its unit: sizes from 1e-100 to 1e100 are read",
        )


def _fits(shape: tuple[int, ...], wanted: tuple[int, ...]) -> bool:
    return len(shape) == len(wanted) and all(
        n in (-1, m) for n, m in zip(wanted, shape, strict=True)
    )


def skew(v: ArrayLike) -> Array:
    """Cross-product matrices: ``skew(v) @ u == cross(v, u)``; shape (..., 3, 3).

    Examples
    --------
    >>> skew([1.0, 2.0, 3.0]) @ [1.0, 2.0, 3.0]
    array([0., 0., 0.])
    """
    v = np.asarray(v, dtype=np.float64)
    matrix = np.zeros((*v.shape, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -v[..., 2], v[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = v[..., 2], -v[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -v[..., 1], v[..., 0]
    return matrix


def unit(v: ArrayLike, what: str = "direction") -> Array:
    """The unit vector along `v`, shape (3,).

    Raises
    ------
    InputError
        If the vector is zero or not finite.
    """
    v = frozen(v, (3,))
    largest = float(np.abs(v).max())
    if not np.isfinite(largest) or largest == 0.0:
        raise InputError(
            f"{what} is {v.tolist()}", hint="give three finite numbers, not all of them zero"
        )
    if not 1e-150 < largest < 1e150:  # its square would be out of range
        v = frozen(v / largest)
    length = float(np.linalg.norm(v))
    # a unit vector stays the same to the last digit, so that it survives being written
    return v if abs(length - 1.0) <= 4e-16 else frozen(v / length)


def quaternion_to_matrix(quaternion: ArrayLike) -> Array:
    """Rotation matrices, shape (..., 3, 3), from quaternions (w, x, y, z) of any length.

    Examples
    --------
    >>> quaternion_to_matrix([2.0, 0.0, 0.0, 0.0])
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """
    q = np.asarray(quaternion, dtype=np.float64)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotation_between(a: ArrayLike, b: ArrayLike) -> Array:
    """Quaternion (w, x, y, z) of the least turn that takes direction `a` to `b`.

    A half turn about x (or about z where `a` lies along x) where they are opposite.

    Examples
    --------
    >>> rotation_between([0, 0, 1], [0, 0, -1])
    array([0., 1., 0., 0.])
    """
    a, b = unit(a), unit(b)
    q = np.array([1.0 + a @ b, *np.cross(a, b)])
    if np.linalg.norm(q) < 1e-12:
        axis = np.array([1.0, 0, 0]) if abs(a[0]) < 0.9 else np.array([0, 0, 1.0])
        axis = axis - (axis @ a) * a
        q = np.array([0.0, *axis])
    return q / float(np.linalg.norm(q))


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Position [length unit] and rotation (unit quaternion w x y z) of a part.

    Raises
    ------
    InputError
        If a number is not finite or the quaternion is zero.

    Examples
    --------
    >>> Pose(position=[0, 0, 5]).apply([[1, 0, 0]])
    array([[1., 0., 5.]])
    """

    position: Any = field(default=(0.0, 0.0, 0.0))
    rotation: Any = field(default=(1.0, 0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        position, rotation = frozen(self.position, (3,)), frozen(self.rotation, (4,))
        if not math.isfinite(sum(position.tolist()) + sum(rotation.tolist())):
            raise InputError("pose has a number that is not finite", hint="give finite numbers")
        if not rotation.any():
            raise InputError("rotation is the zero quaternion", hint="no turn is [1, 0, 0, 0]")
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rotation", rotation)

    @property
    def matrix(self) -> Array:
        """Rotation matrix, shape (3, 3)."""
        return quaternion_to_matrix(self.rotation)

    def apply(self, points: ArrayLike) -> Array:
        """Points of the part, shape (n, 3), in the world frame."""
        moved: Array = np.asarray(points, dtype=np.float64) @ self.matrix.T + self.position
        return moved
