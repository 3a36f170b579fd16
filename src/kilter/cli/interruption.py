"""End a command on Ctrl-C or a signal, with a message and exit code 130 within a second.

Python raises `KeyboardInterrupt` only between two bytecodes, and a long call of a solver is a
single bytecode. Solvers of large programs receive a request to stop (`kilter.solvers.clarabel`).
For every other call a thread watches the signals through the wakeup descriptor of the interpreter.
It ends the process if the main thread has not handled a signal within `GRACE`. No file is half
written then, since every file is moved into its place as a whole.

The exception may also get lost. During an import, Python and numpy convert it into another error.
In a callback (`__del__`, weak references) Python prints and drops it. So a process that belongs to
the command ends at once if a module is being loaded or if an interruption was dropped.
"""

from __future__ import annotations

import errno
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
from kilter.errors import visible

# Facts that the running command knows so far, for the message of an interruption.


_FACTS: dict[str, str] = {}
_STEPS: list[str] = []


def begin_facts() -> None:
    """Forget the facts of an earlier question."""
    _FACTS.clear()
    _STEPS.clear()


def remember_fact(subject: str, words: str) -> None:
    """Keep a fact as a clause. Of several facts with the same subject, the first is kept."""
    _FACTS.setdefault(subject, words)


def remember_step(words: str) -> None:
    """Keep the name of the step that runs now."""
    _STEPS[:] = [words]


def interruption_words() -> str:
    """Sentence about an interruption, with the step that was running and the known facts.

    Examples
    --------
    >>> begin_facts()
    >>> interruption_words()
    'interrupted'
    >>> remember_step("near pairs")
    >>> remember_fact("parts", "it has 3 parts, 1 of them held")
    >>> interruption_words()
    'interrupted in the step "near pairs"; known so far: it has 3 parts, 1 of them held'
    >>> begin_facts()
    """
    step = "".join(f' in the step "{words}"' for words in _STEPS)
    known = known_words()
    return visible(f"interrupted{step}{'; ' if known else ''}{known}")


def known_words() -> str:
    """Clause about the known facts; empty without facts."""
    return f"known so far: {', '.join(_FACTS.values())}" if _FACTS else ""


GRACE = 0.6
"""Time that the main thread has to handle a signal; signals within it count as a single signal [s].
"""
SIGNALS = (signal.SIGINT, signal.SIGTERM)
REPLACED = (signal.SIG_DFL, signal.SIG_IGN, signal.default_int_handler)
"""Default handlers, which are replaced. A handler of the calling program stays in force."""


@contextmanager
def interruptible(*, alone: bool) -> Iterator[Callable[[], bool]]:
    """Handle signals while a command runs, even if the calling script ignores them.

    Yields function that returns whether a signal has arrived.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    inherited = {number: signal.getsignal(number) for number in SIGNALS}
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
        sys.unraisablehook = _end_if_dropped
    try:
        for number in SIGNALS:
            if inherited[number] in REPLACED:
                signal.signal(number, hear)
        yield lambda: bool(heard)
    finally:
        if watched is not None:
            signal.set_wakeup_fd(-1)
        for number, handler in inherited.items():
            # the answer is complete, so a late signal must not change the exit code
            signal.signal(number, signal.SIG_IGN if alone else handler)


def _is_loading(frame: FrameType | None) -> bool:
    """Whether a Python module is being imported in a stack frame or its callers."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib."):
            return True
        frame = frame.f_back
    return False


def _end_if_dropped(dropped: sys.UnraisableHookArgs) -> None:
    """End the process if Python dropped a KeyboardInterrupt in a callback."""
    if issubclass(dropped.exc_type, KeyboardInterrupt):
        end_interrupted()
    sys.__unraisablehook__(dropped)


def _watch(heard: list[float]) -> int:
    """Start a thread that ends the process if the main thread does not handle a signal in time.

    Arguments: `heard`: times at which the main thread handled signals [s]. Returns descriptor to
    which the interpreter writes the signals.
    """
    receiver, sender = os.pipe()
    os.set_blocking(sender, False)
    signal.set_wakeup_fd(sender, warn_on_full_buffer=False)

    def listen() -> None:
        while True:
            os.read(receiver, 64)
            since = time.monotonic() - GRACE  # a signal handled just before counts as this signal
            time.sleep(GRACE)
            if not heard or heard[-1] < since:
                end_interrupted()

    threading.Thread(target=listen, daemon=True).start()
    return sender


def end_interrupted() -> NoReturn:
    """Print the facts known so far, remove unfinished files, and end the process at once."""
    for number in SIGNALS:
        with suppress(ValueError):  # only the main thread may set handlers
            signal.signal(number, signal.SIG_IGN)
    # the module may be half imported at this moment
    for unfinished in tuple(getattr(sys.modules.get("kilter.files.writing"), "UNDER_WAY", ())):
        with suppress(OSError):
            os.unlink(unfinished)
    with suppress(OSError, ValueError):
        clear = "\r\x1b[K" if sys.stderr.isatty() else ""
        print(f"{clear}kilter: {interruption_words()}", file=sys.stderr, flush=True)
    os._exit(INTERRUPTED)


# Standard streams: replace closed streams by empty ones, and recognise full ones.


FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""Error numbers of the system if a stream accepts no more data."""


def open_closed_streams() -> None:
    """Replace standard streams that are closed at the start of the process by empty streams.

    Otherwise the first opened file would get the number of a closed stream, and the output of
    libraries.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115


def is_full(error: OSError) -> bool:
    """Whether an error comes from a full disk or another stream that accepts no more data.

    Such an error names no file.
    """
    return error.filename is None and error.errno in FULL
