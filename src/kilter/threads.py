"""One thread for linear algebra: the same bits with any number of cores, and no waiting.

Sums that several threads share come out in another order than those of one, so that their
last bits depend on the machine. The matrices here are small as well: threads that wait for
one another on a busy machine take twenty times longer than one alone.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

import threadpoolctl

__all__ = ["on_one_thread"]

Given = ParamSpec("Given")
Result = TypeVar("Result")


def on_one_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """The function, with one thread for linear algebra while it runs; as before afterwards."""

    @wraps(function)
    def limited(*given: Given.args, **named: Given.kwargs) -> Result:
        with _libraries().limit(limits=1):
            return function(*given, **named)

    return limited


@cache
def _libraries() -> threadpoolctl.ThreadpoolController:
    """The libraries of linear algebra that numpy and scipy have loaded."""
    import scipy.linalg  # noqa: F401  (its own library is loaded with it)

    return threadpoolctl.ThreadpoolController()
