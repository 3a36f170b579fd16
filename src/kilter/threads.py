"""Limit linear algebra to a single thread, so that results do not depend on the machine.

Several threads sum in a different order than a single thread, so that the last bits depend on the
number of cores. The matrices of kilter are also small. On a busy machine, several threads wait for
each other and take up to twenty times longer than a single thread.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    import threadpoolctl


Given = ParamSpec("Given")
Result = TypeVar("Result")

Numbers = list[tuple[Any, int]]
"""Pairs of a library and its number of threads."""
VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Environment variables from which libraries read their number of threads when they are loaded."""


def make_no_threads() -> None:
    """Set the environment so that libraries create no threads, here and in child processes.

    Call it before numpy is loaded. Creating the threads takes a fifth of a second, even if they
    are never used. Variables that are already set keep their values.
    """
    for name in VARIABLES:
        os.environ.setdefault(name, "1")


def on_one_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Decorate a function so that its linear algebra runs on a single thread.

    A nested call on the same thread costs nothing. The setting applies to the whole process: among
    calls on several threads, the first call sets it and the last call restores the former value.
    """

    @wraps(function)
    def limited(*given: Given.args, **named: Given.kwargs) -> Result:
        """Call the decorated function with linear algebra on a single thread."""
        # a nested call on the same thread finds the limit in place
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
    """Limit of linear algebra to a single thread while any decorated function runs.

    Libraries on OpenMP have a separate number for each calling thread, so that every call sets and
    restores it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls = 0
        self._shared: Numbers = []

    def begin(self) -> Numbers:
        """Set a single thread at the start of a call; returns the numbers that it restores."""
        with self._lock:
            libraries = _libraries().lib_controllers
            per_thread = [
                (library, library.get_num_threads())
                for library in libraries
                if _is_per_thread(library)
            ]
            if self._calls == 0:
                others = [library for library in libraries if not _is_per_thread(library)]
                self._shared = [(library, library.get_num_threads()) for library in others]
                _set([(library, 1) for library in others])
            self._calls += 1
            _set([(library, 1) for library, _ in per_thread])
            return per_thread

    def end(self, per_thread: Numbers) -> None:
        """Restore the thread numbers of a call, and those of the process after the last call."""
        with self._lock:
            self._calls -= 1
            _set(per_thread + ([] if self._calls else self._shared))

    def begin_anew(self) -> None:
        """Correct the number of running calls in a forked process.

        Only the call that forked can still be running there.
        """
        self._lock = threading.Lock()
        if self._calls and not _running.inside:
            _set(self._shared)
        self._calls = int(_running.inside)


def _is_per_thread(library: Any) -> bool:
    """True if a library has a separate number of threads for each calling thread."""
    return "openmp" in (library.user_api, getattr(library, "threading_layer", None))


def _set(numbers: Numbers) -> None:
    """Set the numbers of threads of libraries."""
    for library, number in numbers:
        # newer versions of threadpoolctl accept changes only from the thread of the first change
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
    """Flag of each thread: True inside a call of a decorated function."""

    inside = False


_running = _Running()


@cache
def _libraries() -> threadpoolctl.ThreadpoolController:
    """Controller of the linear algebra libraries that numpy and scipy have loaded."""
    import threadpoolctl

    if not all(os.environ.get(name) == "1" for name in VARIABLES):
        import scipy.linalg  # noqa: F401  (loads the library that scipy contains)

    return threadpoolctl.ThreadpoolController()
