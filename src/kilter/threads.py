"""One thread for linear algebra: the same bits with any number of cores, and no waiting.

Sums that several threads share come out in another order than those of one, so that their
last bits depend on the machine. The matrices here are small as well: threads that wait for
one another on a busy machine take twenty times longer than one alone.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    import threadpoolctl

__all__ = ["VARIABLES", "make_no_threads", "on_one_thread"]

Given = ParamSpec("Given")
Result = TypeVar("Result")

VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Where libraries of linear algebra look, when they are loaded, for how many threads to make."""


def make_no_threads() -> None:
    """Have libraries that are loaded from now on make no threads, here and in child processes.

    For a program before it loads numpy: threads that are made cost a fifth of a second, also
    where nothing is given to them. What the environment says already stays.
    """
    for name in VARIABLES:
        os.environ.setdefault(name, "1")


def on_one_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """The function, with one thread for linear algebra while it runs; as before afterwards.

    A call within another one, on the same thread, finds it set and costs nothing.
    """

    @wraps(function)
    def limited(*given: Given.args, **named: Given.kwargs) -> Result:
        if _running.inside:
            return function(*given, **named)
        _running.inside = True
        try:
            with _libraries().limit(limits=1):
                return function(*given, **named)
        finally:
            _running.inside = False

    return limited


class _Running(threading.local):
    """Whether this thread is inside a call that needs one thread."""

    inside = False


_running = _Running()


@cache
def _libraries() -> threadpoolctl.ThreadpoolController:
    """The libraries of linear algebra that numpy and scipy have loaded."""
    import threadpoolctl

    if not all(os.environ.get(name) == "1" for name in VARIABLES):
        import scipy.linalg  # noqa: F401  (its own library is loaded with it)

    return threadpoolctl.ThreadpoolController()
