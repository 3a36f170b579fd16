"""A solver's call beside the main thread, so that Ctrl-C ends it at once.

Python hands a signal on between two of its own steps, and a call of a solver is one step,
however long it takes. So a call that may take long runs in a thread of its own while the main
thread waits where it hears signals; on one, the solver is told to stop and the interruption
goes on as ever. What is computed is the same.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

__all__ = ["LONG", "run_aside"]

LONG = 20_000
"""Entries of a matrix from which on a call may take a second."""
ENDS = 0.2
"""What a solver that was told to stop is given to do so [s]."""


def run_aside(run: Callable[[], None], stop: Callable[[], None]) -> None:
    """Call `run` in a thread and wait for it; on an interruption call `stop`, then pass it on.

    In any other thread than the main one, which hears no signals, it is just called.

    Examples
    --------
    >>> done = []
    >>> run_aside(lambda: done.append("ran"), lambda: done.append("stopped"))
    >>> done
    ['ran']
    """
    if threading.current_thread() is not threading.main_thread():
        run()
        return
    failure: list[BaseException] = []

    def kept() -> None:
        try:
            run()
        except BaseException as error:
            failure.append(error)

    thread = threading.Thread(target=kept, daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(1.0)
    except BaseException:
        stop()
        thread.join(ENDS)
        raise
    if failure:
        raise failure[0]
