"""A solver's call beside the main thread, so that Ctrl-C ends it at once.

Python hands a signal on between two of its own steps, and a call of a solver is one step,
however long it takes. So a call that may take long runs in a thread of its own while the main
thread waits where it hears signals; on one, the solver is told to stop and the interruption
goes on as ever. What is computed is the same.

A call that keeps the interpreter to itself meanwhile lets no other thread hear anything either.
Where that may last, it runs in a process of its own.
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
"""Entries of a matrix from which on a call may take a second."""
DEAF = 300_000
"""Entries from which on setting a solver up may keep the interpreter for half a second."""
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


def call_apart(function: Callable[..., Any], *given: Any) -> Any:
    """What a function of a module answers in a process of its own; it ends on an interruption.

    In any other thread than the main one, and where Python cannot be started, it is just called.

    Parameters
    ----------
    function : callable
        Named in a module, for `pickle`.
    given
        For it; pickled, as is its answer, or what it raises.

    Raises
    ------
    SolverError
        If the process broke down.

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
    """Answer one call: what it raises, or None, and its answer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of all in a terminal: who asks ends this
    incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints is no answer
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
