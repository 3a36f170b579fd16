"""Run solver calls outside the main thread, so that Ctrl-C ends them at once.

Python handles a signal only between two of its own steps, and a solver call is a single step,
however long it takes. So a long call runs in a separate thread while the main thread waits for it
and can handle signals. On a signal the solver is stopped and the interruption propagates. The
computed result is the same.

A call that holds the interpreter lock prevents every other thread from handling signals. If that
may last, the call runs in a separate process.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from typing import Any

from kilter.errors import SolverError
from kilter.pipes import can_start, end_process, end_with_parent, receive, send, start_process

__all__ = ["DEAF", "LONG", "call_apart", "run_aside", "serve"]

LONG = 20_000
"""Number of matrix entries above which a solver call may take a second."""
DEAF = 300_000
"""Number of matrix entries above which the set-up of a solver may block Ctrl-C for half a second.
"""
ENDS = 0.2
"""Time that an interrupted solver gets to stop [s]."""


def run_aside(run: Callable[[], None], stop: Callable[[], None]) -> None:
    """Call `run` in a thread and wait; on an interruption, call `stop` and raise it again.

    Outside the main thread, which alone receives signals, `run` is called directly.

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

    def run_and_keep_failure() -> None:
        try:
            run()
        except BaseException as error:
            failure.append(error)

    thread = threading.Thread(target=run_and_keep_failure, daemon=True)
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


def call_apart(function: Callable[..., Any], *given: Any) -> Any:
    """Call a module-level function in a child process that Ctrl-C can end; return its result.

    Outside the main thread, and if Python cannot be started, the function is called directly.

    Raises `SolverError` if the process broke down.

    Examples
    --------
    >>> import math
    >>> call_apart(math.hypot, 3.0, 4.0)
    5.0
    """
    if threading.current_thread() is not threading.main_thread() or not can_start():
        return function(*given)
    process = start_process(__name__)
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        send(process.stdin, (function, given))
        failure, answer = receive(process.stdout)
    except (EOFError, OSError) as error:
        raise SolverError("a solver's process broke down", status="failed") from error
    finally:
        end_process(process)
    if failure is not None:
        raise failure
    return answer


def serve() -> None:
    """Run a single call in the child process, and send its exception (or None) and result."""
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl-C reaches all processes of a terminal; the caller ends this process
    incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # output printed by a solver must not mix with the answer
    end_with_parent()
    try:
        function, given = receive(incoming)
    except EOFError:
        return
    failure, answer = None, None
    try:
        answer = function(*given)
    except Exception as error:
        failure = error
    send(outgoing, (failure, answer))
