"""Ctrl-C, or a request to end: one line and exit code 130 within a second, whatever is computed.

Python raises `KeyboardInterrupt` between two of its own steps, and one call of a solver is one
step, however long. Solvers of large programs are told to stop (`kilter.solvers.interrupts`);
for every other call a thread is told of the signal at once, by the interpreter itself, and ends
the process where the main thread has not heard of it within `GRACE`. No file is half written
then: each is put in its place whole, by one step of the system.

What is raised may also get lost: in an import Python and numpy make another error of it, and in
a callback (`__del__`, of a weak reference) it is printed and forgotten. So a process of its own
ends at once where a module is being loaded, and where an interruption was dropped.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import NoReturn

from kilter.cli.exit_codes import INTERRUPTED

__all__ = ["end_interrupted", "interruptible"]

GRACE = 0.6
"""What the main thread is given to hear a signal; what comes again before is the same [s]."""
SIGNALS = (signal.SIGINT, signal.SIGTERM)
OURS = (signal.SIG_DFL, signal.SIG_IGN, signal.default_int_handler)
"""What a process begins with; a program that listens by itself goes on doing so."""


@contextmanager
def interruptible(*, alone: bool) -> Iterator[Callable[[], bool]]:
    """Signals end a command, also one that a script started with them ignored.

    Parameters
    ----------
    alone : bool
        The process is that of the command, and may be ended.

    Yields
    ------
    callable
        Whether a signal was heard, whatever became of what it raised.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    inherited = {one: signal.getsignal(one) for one in SIGNALS}
    heard: list[float] = []

    def hear(number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if heard and now - heard[-1] < GRACE:
            return
        if alone and (heard or _is_loading(frame)):
            end_interrupted()
        heard.append(now)
        raise KeyboardInterrupt

    watched = _watch(heard) if alone and os.name == "posix" else None
    if alone:
        sys.unraisablehook = _end_where_dropped
    try:
        for one in SIGNALS:
            if inherited[one] in OURS:
                signal.signal(one, hear)
        yield lambda: bool(heard)
    finally:
        if watched is not None:
            signal.set_wakeup_fd(-1)
        for one, handler in inherited.items():  # what has its answer is not interrupted any more
            signal.signal(one, signal.SIG_IGN if alone else handler)


def _is_loading(frame: FrameType | None) -> bool:
    """Whether a module is being loaded."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib."):
            return True
        frame = frame.f_back
    return False


def _end_where_dropped(dropped: sys.UnraisableHookArgs) -> None:
    """End the process where an interruption fell into what cannot pass it on."""
    if issubclass(dropped.exc_type, KeyboardInterrupt):
        end_interrupted()
    sys.__unraisablehook__(dropped)


def _watch(heard: list[float]) -> int:
    """A thread that ends the process where a signal is not heard in time; where it is told."""
    told, telling = os.pipe()
    os.set_blocking(telling, False)
    signal.set_wakeup_fd(telling, warn_on_full_buffer=False)

    def listen() -> None:
        while True:
            os.read(told, 64)
            since = time.monotonic() - GRACE  # what was heard just before was the same
            time.sleep(GRACE)
            if not heard or heard[-1] < since:
                end_interrupted()

    threading.Thread(target=listen, daemon=True).start()
    return telling


def end_interrupted() -> NoReturn:
    """Say so, and end the process without waiting for what still runs in it."""
    for one in SIGNALS:
        with suppress(ValueError):  # not the main thread, which hears nothing any more
            signal.signal(one, signal.SIG_IGN)
    writing = sys.modules.get("kilter.files.writing")
    for beside in tuple(writing.UNDER_WAY) if writing is not None else ():
        with suppress(OSError):
            os.unlink(beside)
    with suppress(OSError, ValueError):
        clear = "\r\x1b[K" if sys.stderr.isatty() else ""
        print(f"{clear}kilter: interrupted", file=sys.stderr, flush=True)
    os._exit(INTERRUPTED)
