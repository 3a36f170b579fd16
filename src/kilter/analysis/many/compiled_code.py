"""`compiled`: functions on arrays that numba compiles; without numba they are plain Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

numba: Any
try:
    import numba
except ImportError:  # the extra kilter[fast] is not installed
    numba = None

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Compile a function at its first call; its machine code is kept on disk if possible.

    A division by zero gives an infinity or NaN, which no comparison of a proof accepts.
    """
    if numba is None:
        return function
    try:
        made = numba.njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # no folder for the machine code can be written
        made = numba.njit(error_model="numpy")(function)
    return cast(Function, made)
