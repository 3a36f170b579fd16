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
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    import threadpoolctl

__all__ = ["VARIABLES", "make_no_threads", "on_one_thread"]

Given = ParamSpec("Given")
Result = TypeVar("Result")

Numbers = list[tuple[Any, int]]
"""Libraries, and how many threads each is given."""
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

    A call within another one, on the same thread, finds it set and costs nothing. The number is
    that of the whole process: of calls on several threads the first sets it, and the last that
    ends puts back what was.
    """

    @wraps(function)
    def limited(*given: Given.args, **named: Given.kwargs) -> Result:
        if _running.inside:
            return function(*given, **named)
        _running.inside = True
        try:
            before = _limit.begin()
            try:
                return function(*given, **named)
            finally:
                _limit.end(before)
        finally:
            _running.inside = False

    return limited


class _Limit:
    """One thread from the first call that begins to the last that ends, whichever these are.

    Libraries on OpenMP have a number for each thread, which every call sets and puts back.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls = 0
        self._shared: Numbers = []

    def begin(self) -> Numbers:
        """Set one thread; what the caller itself has to put back."""
        with self._lock:
            libraries = _libraries().lib_controllers
            own = [(one, one.get_num_threads()) for one in libraries if _of_each(one)]
            if self._calls == 0:
                others = [one for one in libraries if not _of_each(one)]
                self._shared = [(one, one.get_num_threads()) for one in others]
                _set([(one, 1) for one in others])
            self._calls += 1
            _set([(one, 1) for one, _ in own])
            return own

    def end(self, own: Numbers) -> None:
        with self._lock:
            self._calls -= 1
            _set(own + ([] if self._calls else self._shared))

    def begin_anew(self) -> None:
        """In a process that was just forked: of all calls it has at most that which forked it."""
        self._lock = threading.Lock()
        if self._calls and not _running.inside:
            _set(self._shared)
        self._calls = int(_running.inside)


def _of_each(library: Any) -> bool:
    """Whether each thread has a number of its own."""
    return "openmp" in (library.user_api, getattr(library, "threading_layer", None))


def _set(numbers: Numbers) -> None:
    for library, number in numbers:
        # newer ones of threadpoolctl hear the thread alone that was the first to set a number
        release = getattr(library, "clear_controlling_thread", None)
        if release is not None:
            release(force=True)
        library.set_num_threads(number)
        if release is not None:
            release(force=True)


_limit = _Limit()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_limit.begin_anew)


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
