"""Ctrl-C, or a request to end: one line and exit code 130 within a second, whatever is computed.

Python raises `KeyboardInterrupt` between two of its own steps, and one call of a solver is one
step, however long. Solvers of large programs are told to stop (`kilter.solvers.interrupts`);
for every other call a thread is told of the signal at once, by the interpreter itself, and ends
the process where the main thread has not heard of it within `GRACE`. No file is half written
then: each is put in its place whole, by one step of the system.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NoReturn

from kilter.cli.exit_codes import INTERRUPTED

__all__ = ["end_interrupted", "interruptible"]

GRACE = 0.6
"""What the main thread is given to hear a signal [s]."""
SIGNALS = (signal.SIGINT, signal.SIGTERM)
OURS = (signal.SIG_DFL, signal.SIG_IGN, signal.default_int_handler)
"""What a process begins with; a program that listens by itself goes on doing so."""


@contextmanager
def interruptible(*, alone: bool) -> Iterator[None]:
    """Signals end a command, also one that a script started with them ignored.

    Parameters
    ----------
    alone : bool
        The process is that of the command, and may be ended.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    inherited = {one: signal.getsignal(one) for one in SIGNALS}
    heard = [-GRACE]

    def hear(number: int, frame: Any) -> NoReturn:
        heard[0] = time.monotonic()
        raise KeyboardInterrupt

    for one in SIGNALS:
        if inherited[one] in OURS:
            signal.signal(one, hear)
    watched = _watch(heard) if alone and os.name == "posix" else None
    try:
        yield
    finally:
        if watched is not None:
            signal.set_wakeup_fd(-1)
        for one, handler in inherited.items():  # what has its answer is not interrupted any more
            signal.signal(one, signal.SIG_IGN if alone else handler)


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
            if heard[0] < since:
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
