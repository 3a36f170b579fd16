"""Values of USD attributes: numbers, vectors and tokens; a wrong type is a sentence.

A file may give an attribute of a schema another type, or no value.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, visible


def paths_above(path: str) -> list[str]:
    """A path of a prim, and the paths above it.

    Examples
    --------
    >>> paths_above("/World/table/leg")
    ['/World/table/leg', '/World/table', '/World']
    """
    words = path.strip("/").split("/")
    return ["/" + "/".join(words[:count]) for count in range(len(words), 0, -1)]


def place_of(attribute: Any) -> str:
    """Path of an attribute, for messages."""
    return visible(str(attribute.GetPath()))[-80:]


def number_of(attribute: Any, default: float | None = None) -> float:
    """The number in an attribute; `default` if it has no value, else an error.

    Raises `InputError` if the value is no number, or NaN.
    """
    return float(array_of(attribute, (), None if default is None else np.array(default)))


def size_of(attribute: Any, *, may_be_zero: bool = False) -> float:
    """The length in an attribute, a finite number above zero.

    Raises `InputError` if it has another value.
    """
    size = number_of(attribute)
    if not 0 <= size < np.inf or (size == 0 and not may_be_zero):
        raise InputError(f"{place_of(attribute)} is {size:g}", hint="give a length above zero")
    return size


def vector_of(attribute: Any, count: int, default: Any = None) -> Array:
    """The vector of `count` numbers in an attribute; `default` if it has no value."""
    return array_of(attribute, (count,), default)


def quaternion_of(attribute: Any) -> Array:
    """The quaternion w x y z in an attribute; that of no rotation if it has no value.

    Raises `InputError` if the value is no quaternion, or has a number that is not finite.
    """
    value = attribute.Get() if attribute else None
    if value is None:
        return np.array([1.0, 0.0, 0.0, 0.0])
    if not hasattr(value, "GetImaginary"):
        raise _wrong_type(attribute)
    numbers = np.array([value.GetReal(), *value.GetImaginary()], dtype=np.float64)
    if not np.isfinite(numbers).all():
        raise InputError(f"{place_of(attribute)} has a number that is not finite")
    return numbers


def _wrong_type(attribute: Any) -> InputError:
    """Error for an attribute whose value has another type than in its schema."""
    return InputError(
        f"{place_of(attribute)} has a value that is no {attribute.GetTypeName()}",
        hint="give a value of this type",
    )


def require_finite_transform(prim: Any) -> None:
    """Verify that the transform of a prim has finite numbers; USD ignores some that are not.

    Raises `InputError` if a number is not finite, or if a value has another type.
    """
    from pxr import UsdGeom

    for operation in UsdGeom.Xformable(prim).GetOrderedXformOps():
        attribute = operation.GetAttr()
        value = attribute.Get()
        if value is None:
            continue
        if hasattr(value, "GetImaginary"):
            quaternion_of(attribute)
        elif not np.isfinite(array_of(attribute, np.shape(value))).all():
            raise InputError(f"{place_of(attribute)} has a number that is not finite")


def array_of(attribute: Any, shape: tuple[int, ...], default: Any = None) -> Array:
    """The numbers in an attribute; -1 in `shape` stands for any length.

    Raises `InputError` if the attribute has no value and there is no default, if the value has
    another type or shape, or if it contains NaN.
    """
    value = attribute.Get() if attribute else None
    value = default if value is None else value
    if value is None:
        raise InputError(f"{place_of(attribute)} has no value", hint="give the attribute a value")
    try:
        numbers = np.array(value, dtype=np.float64)
        if -1 in shape and not numbers.size:
            numbers = numbers.reshape([max(length, 0) for length in shape])
        fits = numbers.ndim == len(shape) and all(
            wanted in (-1, length) for length, wanted in zip(numbers.shape, shape, strict=True)
        )
    except (TypeError, ValueError, OverflowError):
        fits = False
    if not fits or isinstance(value, str):
        raise _wrong_type(attribute)
    if np.isnan(numbers).any():
        raise InputError(f"{place_of(attribute)} has a number that is not finite")
    return numbers


def token_of(attribute: Any, known: Collection[str], default: str) -> str:
    """The word in an attribute, one of the known words; `default` if it has no value.

    Raises `InputError` if it is another word.
    """
    value = attribute.Get() if attribute else None
    if value is None:
        return default
    if not isinstance(value, str) or value not in known:
        raise InputError(
            f"{place_of(attribute)} is {visible(str(value))!r:.40}",
            hint=f"use {', '.join(known)}",
        )
    return value
