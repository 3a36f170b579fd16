"""Checks of what users hand over: numbers, arrays of a shape, sizes within range."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.errors import InputError

__all__ = ["LARGEST", "finite", "frozen", "in_range", "number"]

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
    try:
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} is {repr(value)[:80]}", hint=hint) from None
    if not np.isfinite(result) or result < lowest or (above and result == lowest):
        raise InputError(f"{what} is {result:g}", hint=hint)
    in_range(result, what)
    return result


def in_range(values: Any, what: str, *, tiny: bool = False) -> None:
    """Refuse numbers so large or small that no digit of an answer would be right.

    Parameters
    ----------
    values : array_like
    what : str
    tiny : bool
        However small they may be: places, where the size is asked of the differences.

    Raises
    ------
    InputError
        If a number is not zero and its size is above 1e100 or below 1e-100.
    """
    size = float(np.abs(values).max(initial=0.0))
    if size > LARGEST or (0 < size < 1 / LARGEST and not tiny):
        raise InputError(
            f"{what} is of size {size:g}, out of range",
            hint="check its unit: sizes from 1e-100 to 1e100 are read",
        )


def frozen(values: ArrayLike, shape: tuple[int, ...] | None = None, what: str = "") -> Array:
    """A read-only float64 copy of `values`.

    Raises
    ------
    InputError
        If the values are not numbers of the given shape (-1 = any length); it names `what`.
    """
    name = f"{what}: " if what else ""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"{name}expected numbers, got {repr(values)[:80]}", hint="give a list of numbers"
        ) from None
    if shape is not None and array.shape != shape and not _fits(array.shape, shape):
        wanted = " x ".join("n" if n == -1 else str(n) for n in shape)
        raise InputError(f"{name}expected {wanted} numbers, got shape {array.shape}")
    array.flags.writeable = False
    return array


def finite(values: ArrayLike, shape: tuple[int, ...], what: str) -> Array:
    """`frozen`, and every number finite.

    Raises
    ------
    InputError
        As `frozen`; or if a number is not finite; it names `what`.
    """
    array = frozen(values, shape, what)
    if not np.isfinite(array).all():
        raise InputError(f"{what} is {array.tolist()}", hint="give finite numbers")
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int, ...]) -> bool:
    return len(shape) == len(wanted) and all(
        n in (-1, m) for n, m in zip(wanted, shape, strict=True)
    )
