"""Validation of user input: numbers, arrays of a given shape, sizes within range."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.errors import InputError

LARGEST = 1e100
"""Numbers with a size above this, or below its inverse, are rejected [any unit]."""


def number(value: Any, what: str, *, lowest: float = -np.inf, above: bool = False) -> float:
    """Convert a value to a finite float that is at least `lowest`; raises if it is not.

    Parameters
    ----------
    value : Any
    what : str
        Name of the value for the message.
    lowest : float
        Least allowed value.
    above : bool
        Exclude `lowest` itself.

    Raises
    ------
    InputError
        If the value is not such a number.
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


def whole(value: int, what: str) -> int:
    """Validate a whole number from 1 on.

    Raises `InputError` if it is no such number; `what` names it.

    Examples
    --------
    >>> whole(3, "processes")
    3
    """
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{what} is {value!r:.40}", hint="give a whole number from 1 on")
    return value


def name_list(value: Any, what: str = "the names") -> list[str]:
    """A name, or an iterable of names, as a list; raises an error for other types.

    Raises `InputError` if the value is not text, or an iterable of texts.

    Examples
    --------
    >>> name_list("C1"), name_list(("C1", "C2"))
    (['C1'], ['C1', 'C2'])
    """
    names = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    wrong = [name for name in names if not isinstance(name, str)]
    if wrong:
        raise InputError(f"{what}: {wrong[0]!r:.40} is no text", hint="give a name, or a list")
    return names


def in_range(values: Any, what: str, *, tiny: bool = False) -> None:
    """Raise an error if a number is larger than 1e100 or smaller than 1e-100.

    Arguments: `tiny`: allow small numbers; for positions, of which only the differences need a
    size. Raises `InputError` if a number is not zero and its size is above 1e100 or below 1e-100.
    """
    size = float(np.abs(values).max(initial=0.0))
    if size > LARGEST or (0 < size < 1 / LARGEST and not tiny):
        raise InputError(
            f"{what} is of size {size:g}, out of range",
            hint="check its unit: sizes from 1e-100 to 1e100 are allowed",
        )


def frozen(values: ArrayLike, shape: tuple[int, ...] | None = None, what: str = "") -> Array:
    """Copy values to a read-only float64 array; raises for another shape or other types.

    Raises `InputError` if the values are not numbers, or have another shape.
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
    """Copy finite values to a read-only float64 array; raises for another shape, inf or NaN.

    Raises `InputError` if a number is not finite, or for the reasons of `frozen`.
    """
    array = frozen(values, shape, what)
    if not np.isfinite(array).all():
        raise InputError(f"{what} is {array.tolist()}", hint="give finite numbers")
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int, ...]) -> bool:
    """True if a shape equals the wanted shape, in which -1 allows any length."""
    return len(shape) == len(wanted) and all(
        n in (-1, m) for n, m in zip(wanted, shape, strict=True)
    )
